//! What a record has for a model: channels, speeds, and how dense the air was.

use phugoid_flight_data::channels;
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;

use super::answers::DraftedAxes;
use super::command::Surface;

/// Density of the air, and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Density {
    /// The channel `air_density`.
    Channel,
    /// The standard atmosphere at the channel `altitude`.
    Altitude,
    /// Constant, kg/m^3, from dynamic pressure and true airspeed.
    Pressure(f64),
    /// Constant, kg/m^3, from static pressure and temperature.
    Static(f64),
}

/// A speed that is recorded in the place of the true airspeed, and its name.
pub(super) const OTHER_SPEEDS: [&str; 3] = ["equivalent_airspeed", "calibrated_airspeed", "indicated_airspeed"];

/// The channels of a record and their medians, SI.
pub(super) struct Contents<'a> {
    record: &'a Record,
    /// Surfaces whose positions were made of their commands.
    commanded: Vec<&'static str>,
    pub(super) density: Option<Density>,
}

impl<'a> Contents<'a> {
    /// `commanded` are the surfaces whose positions were made of their commands.
    pub(super) fn of(record: &'a Record, commanded: &[&'static Surface]) -> Self {
        let commanded = commanded.iter().map(|surface| surface.channels.name).collect();
        let mut contents = Self { record, commanded, density: None };
        let (speed, pressure) = (contents.middle("true_airspeed"), contents.middle("dynamic_pressure"));
        let (statics, temperature) = (contents.middle("static_pressure"), contents.middle("temperature"));
        contents.density = if contents.has("air_density") {
            Some(Density::Channel)
        } else if let (Some(speed), Some(pressure)) = (speed.filter(|v| *v > 0.0), pressure.filter(|q| *q > 0.0)) {
            Some(Density::Pressure(2.0 * pressure / (speed * speed)))
        } else if contents.has("altitude") {
            Some(Density::Altitude)
        } else if let (Some(pressure), Some(temperature)) = (statics, temperature) {
            let density = phugoid_flight_data::airspeed::density(pressure, temperature);
            density.is_finite().then_some(Density::Static(density))
        } else {
            None
        };
        contents
    }

    /// Whether the record has a channel with values.
    pub(super) fn has(&self, name: &str) -> bool {
        self.values(name).next().is_some()
    }

    fn values(&self, name: &str) -> impl Iterator<Item = f64> {
        let values = self.record.channel(name).map(|channel| channel.values.as_slice()).unwrap_or_default();
        values.iter().copied().filter(|value| value.is_finite())
    }

    /// The median of a channel, SI; `None` without values.
    pub(super) fn middle(&self, name: &str) -> Option<f64> {
        median(&mut self.values(name).collect::<Vec<_>>())
    }

    /// Median step of the record, s.
    pub(super) fn sample_time(&self) -> f64 {
        self.record.sample_time_s()
    }

    /// The smallest and the largest value of a channel, SI; `None` without values.
    pub(super) fn ends(&self, name: &str) -> Option<[f64; 2]> {
        let ends = |[low, high]: [f64; 2], v: f64| [low.min(v), high.max(v)];
        let [low, high] = self.values(name).fold([f64::INFINITY, f64::NEG_INFINITY], ends);
        (low <= high).then_some([low, high])
    }

    /// The largest less the smallest value of a channel, SI.
    pub(super) fn range(&self, name: &str) -> Option<f64> {
        let [low, high] = self.ends(name)?;
        Some(high - low).filter(|range| range.is_finite())
    }

    /// Whether a channel is one of the reader, and was not made here of a command.
    pub(super) fn is_recorded(&self, name: &str) -> bool {
        self.has(name) && !self.commanded.contains(&name)
    }

    /// The range of a channel over its median.
    pub(super) fn spread(&self, name: &str) -> Option<f64> {
        Some(self.range(name)? / self.middle(name)?).filter(|spread| spread.is_finite())
    }

    /// Header of the column that became a channel.
    pub(super) fn header(&self, name: &str) -> Option<&str> {
        let quality = self.record.quality.channels.iter().find(|channel| channel.name == name)?;
        Some(quality.header.as_str()).filter(|header| !header.is_empty())
    }

    /// The header by which a mapping finds the command of a surface.
    pub(super) fn header_of_command(&self, surface: &'a Surface) -> &str {
        surface.channels.header(self.record)
    }

    /// The airspeed in the place of a true one.
    pub(super) fn other_speed(&self) -> Option<&'static str> {
        OTHER_SPEEDS.into_iter().find(|name| !self.has("true_airspeed") && self.has(name))
    }

    /// The channels that a model of these axes cannot do without.
    pub(super) fn lacks(&self, axes: DraftedAxes) -> Vec<String> {
        let mut needed = vec!["true_airspeed"];
        if axes.has_longitudinal() {
            needed.extend(["theta", "q", "elevator"]);
        }
        if axes.has_lateral() {
            needed.extend(["phi", "p", "r"]);
        }
        if axes == DraftedAxes::Lateral {
            needed.extend(["alpha", "theta", "q", "ax", "az"]);
        }
        let there = |name: &&str| self.has(name) || (**name == *"true_airspeed" && self.other_speed().is_some());
        let mut missing: Vec<String> = needed.into_iter().filter(|name| !there(name)).map(str::to_owned).collect();
        if axes.has_lateral() && !self.has("aileron") && !self.has("rudder") {
            missing.push("aileron or rudder".to_owned());
        }
        missing
    }
}

/// A header that is read as this channel.
pub(super) fn header_of(name: &str) -> String {
    let suffix = channels::by_name(name).map_or("", |spec| spec.quantity.si_suffix());
    if suffix.is_empty() { name.to_owned() } else { format!("{name}_{suffix}") }
}
