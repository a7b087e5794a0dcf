//! The true airspeed where a sender gives only an equivalent, calibrated or indicated one. It is computed if the
//! density of the air is known; without a density the channel stays missing.

use phugoid_flight_data::airspeed::{density, true_over_equivalent};

/// Channels from which it is computed: airspeeds, the best first, then the channels that give the density.
pub(crate) const SOURCES: [&str; 6] = [
    "equivalent_airspeed",
    "calibrated_airspeed",
    "indicated_airspeed",
    "air_density",
    "static_pressure",
    "temperature",
];
const SPEEDS: usize = 3;
/// A value of density, pressure or temperature is used for this long, s, as in a log.
const AIR_VALID_S: f64 = 5.0;
/// A missing density is reported only after this long, s, because the messages with pressure and temperature come less
/// often.
const REPORT_AFTER_S: f64 = 2.0;

/// Computes the true airspeed of each sample.
#[derive(Clone, Debug)]
pub(crate) struct TrueAirspeed {
    /// Index of `true_airspeed` in a sample.
    place: usize,
    /// Indices of [`SOURCES`] in a sample.
    sources: [usize; SOURCES.len()],
    /// Density that the model file states, kg/m^3.
    stated: Option<f64>,
    state: State,
}

#[derive(Clone, Debug, Default)]
struct State {
    /// The sender gives the true airspeed itself.
    given: bool,
    /// The best airspeed that has come, an index into [`SOURCES`].
    speed: Option<usize>,
    /// Time, s, and value of the last density, static pressure and temperature, SI.
    air: [Option<(f64, f64)>; 3],
    /// Time of the first airspeed without a density, s.
    missing_since_s: Option<f64>,
    /// That the density is missing has been reported.
    missing: bool,
    /// That the true airspeed is computed has been reported.
    computed: bool,
}

impl TrueAirspeed {
    /// For samples with these channels; `None` if `true_airspeed` is not among them.
    pub(crate) fn new(channels: &[String]) -> Option<Self> {
        let place = |name: &str| channels.iter().position(|channel| channel == name);
        let mut sources = [0; SOURCES.len()];
        for (slot, name) in sources.iter_mut().zip(SOURCES) {
            *slot = place(name)?;
        }
        Some(Self { place: place("true_airspeed")?, sources, stated: None, state: State::default() })
    }

    /// Sets the density that the model file states, kg/m^3.
    pub(crate) fn with_density(self, stated: Option<f64>) -> Self {
        Self { stated, ..self }
    }

    /// Forgets what was known of the flight before.
    pub(crate) fn restart(&mut self) {
        self.state = State::default();
    }

    /// A sentence that says what is missing, if another airspeed comes without a density.
    pub(crate) fn missing(&self) -> Option<String> {
        let speed = self.state.speed.and_then(|speed| SOURCES.get(speed))?;
        self.state
            .missing
            .then(|| format!("{speed} comes, but not the density of the air that would make it the true one"))
    }

    /// Fills in the true airspeed of a sample, m/s, if it can be computed. Messages for people go to `report`.
    pub(crate) fn fill(&mut self, time_s: f64, values: &mut [f64], report: &mut dyn FnMut(String)) {
        let state = &mut self.state;
        let at = |values: &[f64], place: usize| values.get(place).copied().filter(|value| value.is_finite());
        state.given |= at(values, self.place).is_some();
        if state.given {
            state.missing = false;
            return;
        }
        for (held, place) in state.air.iter_mut().zip(self.sources.iter().skip(SPEEDS)) {
            if let Some(value) = at(values, *place) {
                *held = Some((time_s, value));
            }
        }
        let came = |speed: &usize| self.sources.get(*speed).is_some_and(|place| at(values, *place).is_some());
        let best = (0..SPEEDS).find(came);
        state.speed = best.into_iter().chain(state.speed).min();
        let Some((speed, name)) = state.speed.and_then(|speed| Some((*self.sources.get(speed)?, SOURCES.get(speed)?)))
        else {
            return;
        };
        let [measured, pressure, temperature] = state
            .air
            .map(|held| held.filter(|(stamp, _)| time_s - stamp <= AIR_VALID_S).map_or(f64::NAN, |(_, value)| value));
        let (rho, from) = match self.stated {
            Some(stated) => (stated, "the density that the model file states"),
            None if measured > 0.0 => (measured, "the density of the air"),
            None => (density(pressure, temperature), "the density of static pressure and temperature"),
        };
        let factor = true_over_equivalent(rho);
        if factor.is_nan() {
            let since_s = *state.missing_since_s.get_or_insert(time_s);
            if !state.missing && time_s - since_s >= REPORT_AFTER_S {
                state.missing = true;
                report(advice(name));
            }
            return;
        }
        (state.missing, state.missing_since_s) = (false, None);
        if !state.computed {
            state.computed = true;
            report(format!("the true airspeed V is computed of {name} V_e and {from}: V = V_e sqrt(1.225 / rho)"));
        }
        if let (Some(value), Some(slot)) = (at(values, speed), values.get_mut(self.place)) {
            *slot = factor * value;
        }
    }
}

/// The error that follows if another airspeed is taken for the true one. From the standard atmosphere (ISO 2533), 1.112
/// kg/m^3 at 1000 m and 0.909 kg/m^3 at 3000 m; a coefficient is a force over the square of the speed.
pub(crate) const ERROR_WITHOUT_DENSITY: &str =
    "at 1000 m it is 5 % lower than V, which makes coefficients 10 % too large, at 3000 m 14 % and 35 %";

fn advice(speed: &str) -> String {
    format!(
        "{speed} is not the true airspeed V, and not taken for it: {ERROR_WITHOUT_DENSITY}. It becomes V with the density of the air: let air_density come, \
         or static_pressure and the temperature of the air (not a sensor's own), or state air_density in the model file; or, where the error \
         does not matter, map it: [channels] true_airspeed = {{ header = ... }}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANNELS: [&str; 7] = [
        "true_airspeed",
        "equivalent_airspeed",
        "calibrated_airspeed",
        "indicated_airspeed",
        "air_density",
        "static_pressure",
        "temperature",
    ];

    struct Filled {
        airspeed: TrueAirspeed,
        said: Vec<String>,
    }

    impl Filled {
        fn new(stated: Option<f64>) -> Self {
            let channels = CHANNELS.map(str::to_owned);
            Self { airspeed: TrueAirspeed::new(&channels).unwrap().with_density(stated), said: Vec::new() }
        }

        fn at(&mut self, time_s: f64, given: &[(&str, f64)]) -> f64 {
            let of = |name: &str| given.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value);
            let mut values = CHANNELS.map(of);
            self.airspeed.fill(time_s, &mut values, &mut |text| self.said.push(text));
            values[0]
        }
    }

    #[test]
    fn a_calibrated_airspeed_needs_the_density() {
        let mut filled = Filled::new(None);
        for k in 0..5 {
            assert!(filled.at(f64::from(k), &[("calibrated_airspeed", 50.0), ("static_pressure", 79_495.0)]).is_nan());
        }
        assert!(filled.said.len() == 1 && filled.said[0].contains("35 %"), "{:?}", filled.said);
        assert!(filled.airspeed.missing().is_some());
        // The standard atmosphere at 2000 m (ISO 2533) has 1.0065 kg/m^3.
        let v = filled.at(5.0, &[("calibrated_airspeed", 50.0), ("temperature", 275.15)]);
        assert!((v - 55.16).abs() < 0.01, "{v}");
        assert!(filled.airspeed.missing().is_none() && filled.said[1].contains("static pressure and temperature"));
        // The air's state stands for five seconds.
        assert!(filled.at(9.0, &[("calibrated_airspeed", 50.0)]) > 55.0);
        assert!(filled.at(9.5, &[("calibrated_airspeed", 50.0)]).is_nan());
        // What is measured itself comes before what is computed of others.
        assert_eq!(filled.at(10.0, &[("calibrated_airspeed", 50.0), ("air_density", 1.225 / 4.0)]), 100.0);
        assert!(filled.at(10.1, &[("temperature", 275.15)]).is_nan(), "no speed");
    }

    #[test]
    fn a_better_speed_is_kept_to() {
        let mut filled = Filled::new(Some(1.225 / 4.0));
        assert_eq!(filled.at(0.0, &[("indicated_airspeed", 40.0)]), 80.0);
        assert_eq!(filled.at(0.1, &[("indicated_airspeed", 40.0), ("equivalent_airspeed", 50.0)]), 100.0);
        assert!(filled.at(0.2, &[("indicated_airspeed", 40.0)]).is_nan());
        // A true one that is sent ends it.
        assert_eq!(filled.at(0.3, &[("true_airspeed", 99.0), ("equivalent_airspeed", 50.0)]), 99.0);
        assert!(filled.at(0.4, &[("equivalent_airspeed", 50.0)]).is_nan());
    }
}
