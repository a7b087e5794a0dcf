//! The channels of a record that the search looks at, and a segment of them at a rate that keeps the regressions fast.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
use crate::preparation::commanded;
use crate::preparation::noise::measure_noise;

/// Highest rate of the samples that regressions take, Hz: well above the modes that they are about.
const RATE_HZ: f64 = 50.0;
/// Longest part of a segment that regressions take, s.
pub(crate) const LONGEST_S: f64 = 120.0;

/// Channels from which the dynamic pressure can be computed, the best first.
const SPEEDS: [&str; 4] = ["true_airspeed", "equivalent_airspeed", "calibrated_airspeed", "indicated_airspeed"];
/// Every channel that the search uses, apart from surfaces and airspeeds.
const MOTIONS: [&str; 10] = ["alpha", "beta", "theta", "phi", "p", "q", "r", "ax", "ay", "az"];

/// The finite values of one channel with their times.
#[derive(Clone)]
pub(crate) struct Sampled {
    pub(crate) time: Vec<f64>,
    pub(crate) values: Vec<f64>,
    /// Standard deviation of the noise, SI; 0 where it cannot be measured.
    pub(crate) noise: f64,
}

impl Sampled {
    /// Index range of the values from one time to another, both included.
    pub(crate) fn range(&self, from_s: f64, to_s: f64) -> std::ops::Range<usize> {
        let first = self.time.partition_point(|t| *t < from_s - 1e-9);
        first..self.time.partition_point(|t| *t <= to_s + 1e-9).max(first)
    }

    /// The values from one time to another.
    pub(crate) fn between(&self, from_s: f64, to_s: f64) -> &[f64] {
        &self.values[self.range(from_s, to_s)]
    }
}

/// One sigma. Where a recorder's steps would decide it they must be small beside the range: a surface that only steps
/// between a few positions, in a simulation, has no noise.
fn noise(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let measured = measure_noise(values).filter(|n| !n.quantised || n.std < 0.02 * (high - low));
    measured.map_or(0.0, |n| n.std)
}

/// The channels of a record by name.
pub(crate) struct Signals<'a> {
    pub(crate) record: &'a Record,
    channels: BTreeMap<&'static str, Sampled>,
    speed: Option<&'static str>,
}

impl<'a> Signals<'a> {
    pub(crate) fn of(record: &'a Record) -> Self {
        let mut channels = BTreeMap::new();
        for name in Axes::SURFACES.into_iter().chain(SPEEDS).chain(MOTIONS) {
            let Some(channel) = record.channel(name).filter(|c| c.values.len() == record.time.len()) else { continue };
            let (time, values): (Vec<f64>, Vec<f64>) =
                record.time.iter().zip(&channel.values).filter(|(_, v)| v.is_finite()).map(|(t, v)| (*t, *v)).unzip();
            if values.len() < 4 {
                continue;
            }
            let noise = noise(&values);
            channels.insert(name, Sampled { time, values, noise });
        }
        let speed = SPEEDS.into_iter().find(|name| channels.contains_key(name));
        Self { record, channels, speed }
    }

    pub(crate) fn channel(&self, name: &str) -> Option<&Sampled> {
        self.channels.get(name)
    }

    pub(crate) fn has_surface(&self) -> bool {
        Axes::SURFACES.iter().any(|name| self.channels.contains_key(name))
    }

    /// The airspeed, and what kind it is.
    pub(crate) fn speed(&self) -> Option<(&'static str, &Sampled)> {
        self.speed.and_then(|name| Some((name, self.channels.get(name)?)))
    }

    /// What the record lacks for any estimation at all, one sentence each.
    pub(crate) fn missing(&self) -> Vec<String> {
        let mut reasons = Vec::new();
        let commands = commanded::alone(self.record);
        if !self.has_surface() && !commands.is_empty() {
            reasons.push(with_travel(&commands));
        } else if !self.has_surface() {
            reasons.push(
                "no control surface (elevator, aileron, rudder) was recorded: derivatives are learnt from what the \
                 surfaces do. A multirotor has none; an autopilot's log has them as its outputs to the servos"
                    .to_owned(),
            );
        }
        match self.speed {
            None => reasons.push(
                "no airspeed was recorded: forces and moments cannot be made coefficients, and no coefficient can be \
                 estimated. Speed over ground is no substitute in wind"
                    .to_owned(),
            ),
            Some("true_airspeed") => {}
            Some(other) => reasons.push(format!(
                "no true airspeed was recorded; what the flight can tell is judged by the {}, but an estimation needs \
                 `true_airspeed`",
                other.replace('_', " ")
            )),
        }
        reasons
    }

    /// A segment as regressions take it.
    pub(crate) fn window(&self, from_s: f64, to_s: f64) -> Window {
        let shortened = to_s - from_s > LONGEST_S;
        let to_s = to_s.min(from_s + LONGEST_S);
        let time = &self.record.time;
        let first = time.partition_point(|t| *t < from_s - 1e-9);
        let end = time.partition_point(|t| *t <= to_s + 1e-9).max(first);
        let step = self.record.sample_time_s();
        let block = if step > 0.0 { ((1.0 / RATE_HZ / step).round() as usize).max(1) } else { 1 };
        let mean = |values: &[f64]| {
            let (sum, n) = values.iter().filter(|v| v.is_finite()).fold((0.0, 0_u32), |(s, n), v| (s + v, n + 1));
            if n > 0 { sum / f64::from(n) } else { f64::NAN }
        };
        let blocks = |values: &[f64]| values[first..end].chunks(block).map(mean).collect::<Vec<f64>>();
        let mut channels: BTreeMap<&'static str, (Vec<f64>, f64)> = BTreeMap::new();
        for (name, sampled) in &self.channels {
            if let Some(channel) = self.record.channel(name) {
                channels.insert(name, (blocks(&channel.values), sampled.noise / (block as f64).sqrt()));
            }
        }
        if let Some(speed) = self.speed.and_then(|name| channels.get(name).cloned()) {
            channels.insert("speed", speed);
        }
        Window { time: blocks(time), channels, shortened }
    }
}

/// A segment, at most [`LONGEST_S`] long, with at most [`RATE_HZ`] samples a second: means of neighbouring samples.
pub(crate) struct Window {
    pub(crate) time: Vec<f64>,
    channels: BTreeMap<&'static str, (Vec<f64>, f64)>,
    pub(crate) shortened: bool,
}

impl Window {
    /// Values (NaN where missing) and one sigma of their noise; `speed` is the airspeed that there is.
    pub(crate) fn channel(&self, name: &str) -> Option<(&[f64], f64)> {
        self.channels
            .get(name)
            .filter(|(values, _)| values.iter().any(|v| v.is_finite()))
            .map(|(values, noise)| (values.as_slice(), *noise))
    }
}

/// How the commands of surfaces become positions.
fn with_travel(commands: &[(&'static str, &str)]) -> String {
    let headers: Vec<String> = commands.iter().map(|(_, header)| format!("`{header}`")).collect();
    let mut text = format!(
        "no position of a control surface (elevator, aileron, rudder) was recorded; the commands are there ({}), and an estimation \
         needs the angles that they stand for",
        headers.join(", ")
    );
    if let Some(((surface, header), others)) = commands.split_first() {
        let (scale, header) =
            (if *surface == "elevator" { -20 } else { 20 }, toml::Value::String((*header).to_owned()));
        let likewise: Vec<String> = others.iter().map(|(surface, _)| format!("--{surface}-travel")).collect();
        let also = if likewise.is_empty() { String::new() } else { format!(" (also {})", likewise.join(", ")) };
        text.push_str(&format!(
            ". Measure the deflection at full command (command 1), negative where it moves the trailing edge up (right aileron up, \
             rudder right). `phugoid init FLIGHT --{surface}-travel {scale}deg`{also} begins a model file with it; in a model file \
             that is there write [channels] {surface} = {{ header = {header}, scale = {scale}, unit = \"deg\" }}"
        ));
    }
    text
}
