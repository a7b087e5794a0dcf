//! Scenario files: a simulated flight, from the aircraft to the faults of its sensors.

mod air;
mod aircraft;
mod built_in;
mod damage;
mod draw;
mod earth;
mod failure;
mod ranges;
mod sensors;
mod wind;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use phugoid_flight_dynamics::earth::Earth;
use phugoid_flight_dynamics::increments::Increments;
use serde::Deserialize;

pub use self::air::{GustSettings, Spectrum, Turbulence};
pub use self::aircraft::{AircraftSettings, Condition, DamageWord, ModelError, RecordedSurfaces, TableFactors, Thrust};
pub use self::built_in::{BUILT_IN, built_in};
pub use self::damage::Damage;
pub use self::earth::{Attitude, EarthSettings, EarthShape};
pub use self::failure::{Failure, FailureKind};
pub use self::ranges::Ranges;
pub use self::sensors::{Sensor, Sensors};
pub use self::wind::{Aloft, Wind};
use crate::aircraft::AircraftError;
use crate::damaged::Effects;
use crate::manoeuvre::Manoeuvre;
use crate::quantity::{Frequency, Time};
pub use crate::text::{ScenarioError, nearest, parse_toml};

/// A simulated flight. Every quantity carries its unit: `altitude = "20000 ft"`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What it shows, in a few words.
    pub name: String,
    /// Duration of the flight from the trim to the last sample.
    pub duration: Time,
    /// Samples per second of the record; commands change at the samples too.
    pub sample_rate: Frequency,
    /// Seed of everything random: sensor noise, outliers, dropped frames, the pilot, turbulence, and what is drawn.
    #[serde(default)]
    pub seed: u64,
    /// The aircraft that flies, with its actuators and its engine.
    pub aircraft: AircraftSettings,
    /// Where the flight starts, in trim.
    pub condition: Condition,
    /// The planet that it goes over; a plane at rest if it is not given.
    pub earth: Option<EarthSettings>,
    /// In what the attitude is integrated.
    #[serde(default)]
    pub attitude: Attitude,
    /// Commands to the surfaces, added to their trim positions; several to one surface add up.
    #[serde(default)]
    pub manoeuvre: Vec<Manoeuvre>,
    /// Steady wind over the ground, at all altitudes or by altitude; calm if it is not given.
    pub wind: Option<Wind>,
    /// Single gusts along the body axes; several add up.
    #[serde(default)]
    pub gust: Vec<GustSettings>,
    /// Continuous turbulence, in addition to the gusts; none if it is not given.
    pub turbulence: Option<Turbulence>,
    /// How the aircraft that flies differs from its tables, in addition to the increments. No estimator is told of it.
    #[serde(default)]
    pub model_error: ModelError,
    /// Aerodynamic increments from the start of the flight, which the estimator has to find. Their forces and moments
    /// are zero at the trim point, so the trim does not depend on them.
    #[serde(default)]
    pub increments: Increments,
    /// Increments of the start that are drawn, in place of those above: `dCm_alpha = [-0.3, 0.1]`.
    #[serde(default)]
    pub increment_ranges: Ranges,
    /// What changes on the aircraft in flight, in place of all earlier changes: damage.
    #[serde(default)]
    pub damage: Vec<Damage>,
    /// Surfaces that stop to do what they are told.
    #[serde(default)]
    pub failure: Vec<Failure>,
    /// Sensors. A channel that is not named here is recorded as it is.
    #[serde(default)]
    pub sensors: Sensors,
    /// Folder of the scenario file, where relative paths start.
    #[serde(skip)]
    pub folder: PathBuf,
}

impl Scenario {
    /// Reads the scenario file at this path, and the aircraft that it names; paths in it start from its folder.
    ///
    /// ```
    /// use phugoid_simulation::scenario::Scenario;
    /// let scenario = Scenario::open("../../scenarios/f16-damage.toml")?;
    /// assert_eq!(scenario.damage[0].at.si(), 10.0); // s
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ScenarioError`]: the file cannot be read, something in it is wrong, or its aircraft cannot be opened.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ScenarioError> {
        let file = path.as_ref();
        let text = std::fs::read_to_string(file)
            .map_err(|source| ScenarioError::Unreadable { file: file.to_owned(), source })?;
        let mut scenario = Self::parse(&text, &file.display().to_string())?;
        scenario.folder = file.parent().map(Path::to_owned).unwrap_or_default();
        scenario.aircraft.open(&scenario.folder).map_err(|source| ScenarioError::Aircraft {
            place: file.display().to_string(),
            source: Box::new(source),
        })?;
        Ok(scenario)
    }

    /// True values, at the end of the flight, of what a model file may ask for, by its names: the increments about the trim
    /// (`dCm_alpha`, ..., `dCn_rudder`), zero or not, the constant ones (`dCY_0`, ...), which are zero, and the sensors'
    /// constant errors (`bias_alpha`, ...), SI. Of an aircraft from a model file that flies as its file says, the values in
    /// that file (`Cm_alpha`, ...) as well; of one that is damaged in flight otherwise than by increments the sensors' errors alone:
    /// what such damage amounts to depends on the trim, and [`Flight::true_parameters_at`](crate::flight::Flight::true_parameters_at)
    /// has it.
    pub fn true_parameters(&self) -> BTreeMap<String, f64> {
        self.true_parameters_at(f64::INFINITY)
    }

    /// As [`true_parameters`](Self::true_parameters), at a time (s).
    pub fn true_parameters_at(&self, time: f64) -> BTreeMap<String, f64> {
        let mut truth = self.increments_and_biases_at(time);
        let damaged = self.damage.iter().any(|damage| damage.at.si() <= time && damage.has_effects());
        if damaged {
            truth.retain(|name, _| name.starts_with("bias_"));
        }
        truth
    }

    /// As [`true_parameters_at`](Self::true_parameters_at), without what damage amounts to beside increments.
    pub(crate) fn increments_and_biases_at(&self, time: f64) -> BTreeMap<String, f64> {
        let drawn = self.drawn();
        let increments = drawn.increments_at(time).named();
        let constants = ["dCL_0", "dCD_0", "dCm_0", "dCY_0", "dCl_0", "dCn_0"].map(|name| (name, 0.0));
        // What a measured damage changes is in no increment: that these are zero would not be true.
        let whole = self.aircraft.damage_in_flight().is_none();
        let named = increments.into_iter().chain(constants).filter(|_| whole).chain(drawn.sensors.biases());
        let of_model = self.aircraft.parameters(&self.folder).filter(|_| self.is_as_modelled()).unwrap_or_default();
        named.map(|(name, value)| (name.to_owned(), value)).chain(of_model).collect()
    }

    /// What is left out of the file of the aircraft and what is assumed, in sentences; empty for a built-in one.
    ///
    /// # Errors
    /// [`AircraftError`]: the aircraft cannot be opened.
    pub fn notes(&self) -> Result<Vec<String>, AircraftError> {
        if self.aircraft.file.is_none() {
            return Ok(Vec::new());
        }
        Ok(self.aircraft.aircraft(&self.folder)?.notes().to_vec())
    }

    /// Whether the aircraft flies as its data say: no increments, no damage in flight, no error of the model, nothing drawn.
    pub fn is_as_modelled(&self) -> bool {
        self.increments == Increments::default()
            && self.increment_ranges == Ranges::default()
            && self.damage.is_empty()
            && self.failure.is_empty()
            && self.model_error == ModelError::default()
    }

    /// The increments in force at a time (s). Where something is drawn, ask [`drawn`](Self::drawn) first.
    pub fn increments_at(&self, time: f64) -> Increments {
        let mut now = self.increments;
        for damage in self.damage.iter().filter(|damage| damage.at.si() <= time) {
            now = damage.after(&now, time);
        }
        now
    }

    /// What damage has changed at a time (s) beside the increments.
    pub fn effects_at(&self, time: f64) -> Effects {
        self.effects_of(&self.complete_effects(), time)
    }

    /// What each damage changes beside the increments once it is complete: read from the tables of the file once for a flight.
    pub(crate) fn complete_effects(&self) -> Vec<Effects> {
        self.damage.iter().map(Damage::effects).collect()
    }

    /// As [`effects_at`](Self::effects_at), from the [`complete_effects`](Self::complete_effects).
    pub(crate) fn effects_of(&self, complete: &[Effects], time: f64) -> Effects {
        let begun = self.damage.iter().zip(complete).filter(|(damage, _)| damage.at.si() <= time);
        begun.fold(Effects::NONE, |now, (damage, complete)| damage.effects_after(&now, complete, time))
    }

    /// Parses the text of a scenario; `place` is its name in messages.
    pub fn parse(text: &str, place: &str) -> Result<Self, ScenarioError> {
        let scenario: Self = parse_toml(text, place)?;
        scenario.check().map_err(|message| ScenarioError::OutOfRange { place: place.to_owned(), message })?;
        Ok(scenario)
    }

    /// The planet below the flight; none for a plane, and for an [`EarthSettings`] that [`check`](Self::check) refuses.
    pub fn earth_below(&self) -> Option<Earth> {
        self.earth?.earth().ok()
    }

    /// Number of samples, both ends included.
    pub fn samples(&self) -> usize {
        (self.duration.si() * self.sample_rate.si() + 1e-9) as usize + 1
    }

    /// What the manoeuvres ask of elevator, aileron and rudder at each sample, rad from trim.
    ///
    /// # Errors
    /// [`ScenarioError`]: a manoeuvre that cannot be flown, such as a recorded input that cannot be read.
    pub fn deflections(&self) -> Result<[Vec<f64>; 3], ScenarioError> {
        let time = self.times();
        let mut deflections = [vec![0.0; time.len()], vec![0.0; time.len()], vec![0.0; time.len()]];
        for manoeuvre in &self.manoeuvre {
            let added = manoeuvre.deflections(&time, self.seed, &self.folder)?;
            let sum = &mut deflections[manoeuvre.surface().index()];
            sum.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
        }
        Ok(deflections)
    }

    /// The times of the samples, s.
    fn times(&self) -> Vec<f64> {
        (0..self.samples()).map(|k| k as f64 / self.sample_rate.si()).collect()
    }

    /// The manoeuvres that move nothing in this flight, in sentences; empty without any.
    ///
    /// ```
    /// use phugoid_simulation::scenario::Scenario;
    /// let text = Scenario::named("f16-calm")?;
    /// assert!(text.manoeuvres_without_effect()?.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`deflections`](Self::deflections).
    pub fn manoeuvres_without_effect(&self) -> Result<Vec<String>, ScenarioError> {
        let (time, mut without) = (self.times(), Vec::new());
        for (index, manoeuvre) in self.manoeuvre.iter().enumerate() {
            if manoeuvre.deflections(&time, self.seed, &self.folder)?.iter().any(|deflection| *deflection != 0.0) {
                continue;
            }
            let why = match manoeuvre.start_s() {
                start if start >= self.duration.si() => {
                    format!("it begins at {start} s, and the flight ends at {} s", self.duration.si())
                }
                _ => "its deflections are zero at all samples".to_owned(),
            };
            without.push(format!("{} moves nothing: {why}", named(index, manoeuvre)));
        }
        Ok(without)
    }

    /// Checks what the text of a file cannot show by itself, such as ranges and the order of damages.
    ///
    /// # Errors
    /// A sentence that names the entry that is wrong and what is expected of it.
    pub fn check(&self) -> Result<(), String> {
        // Some 700 bytes each while the flight is in memory.
        const MOST_SAMPLES: f64 = 2e6;
        let range = |ok: bool, what: &str| if ok { Ok(()) } else { Err(what.to_owned()) };
        range(self.duration.si() > 0.0, "`duration` must be positive")?;
        range(self.sample_rate.si() > 0.0, "`sample_rate` must be positive")?;
        let samples = self.duration.si() * self.sample_rate.si();
        range(samples <= MOST_SAMPLES, "`duration` times `sample_rate` is more than two million samples: shorten one")?;
        range(samples >= 1.0, "`duration` is shorter than one sample of `sample_rate`")?;
        self.aircraft.check()?;
        range((0.0..=1.0).contains(&self.sensors.drops), "`sensors.drops` is a probability, 0 to 1 (0.05, not 5)")?;
        for increments in std::iter::once(&self.increments).chain(self.damage.iter().map(|d| &d.increments)) {
            range(
                [increments.alpha_reference, increments.q_reference, increments.elevator_reference] == [0.0; 3],
                "increments of a scenario are about its trim point: leave the references out",
            )?;
            let named = increments.named();
            if let Some((name, value)) = named.into_iter().find(|(_, value)| !value.is_finite()) {
                return Err(format!("the increment `{name}` is {value}: expected a finite number, per radian"));
            }
        }
        range(
            self.damage.windows(2).all(|w| w[0].at < w[1].at),
            "the `[[damage]]` tables must be in the order of their times `at`",
        )?;
        range(
            self.damage.windows(2).all(|w| w[0].at.si() + w[0].over.si() <= w[1].at.si()),
            "one `[[damage]]` has to be over (`at` plus `over`) before the next one begins",
        )?;
        range(self.damage.iter().all(|d| d.over.si() >= 0.0), "`over` of a `[[damage]]` is a duration, not negative")?;
        for ranges in std::iter::once(&self.increment_ranges).chain(self.damage.iter().map(|d| &d.ranges)) {
            ranges.check()?;
        }
        let mut manoeuvres = self.manoeuvre.iter().enumerate();
        manoeuvres.try_for_each(|(index, m)| m.check().map_err(|why| format!("{}: {why}", named(index, m))))?;
        self.damage.iter().try_for_each(Damage::check)?;
        self.failure.iter().try_for_each(|failure| failure.check(self.aircraft.actuators))?;
        self.model_error.check()?;
        if let Some(turbulence) = &self.turbulence {
            turbulence.check()?;
        }
        if let Some(wind) = &self.wind {
            wind.profile()?;
        }
        if let Some(earth) = &self.earth {
            earth.earth()?;
        }
        range(
            self.condition.heading.si().abs() <= std::f64::consts::TAU,
            "`condition.heading` is from 0 to 360 deg, clockwise from north",
        )?;
        Ok(())
    }
}

/// A manoeuvre in messages: its number in the file, counted from 1, its type and its surface.
fn named(index: usize, manoeuvre: &Manoeuvre) -> String {
    format!("`[[manoeuvre]]` number {} ({} of the {})", index + 1, manoeuvre.kind(), manoeuvre.surface().name())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALM: &str = include_str!("../../../scenarios/f16-calm.toml");

    #[test]
    fn every_built_in_scenario_reads() {
        for (name, _) in BUILT_IN {
            let scenario = built_in(name).unwrap().unwrap_or_else(|e| panic!("{e}"));
            assert!(scenario.samples() > 10);
        }
    }

    #[test]
    fn the_calm_scenario_is_the_published_case() {
        let s = built_in("f16-calm").unwrap().unwrap();
        assert_eq!(s.samples(), 2001);
        assert_eq!(s.condition.altitude.si(), 6096.0);
        assert_eq!((s.increments.dCm_alpha, s.increments.dCD_alpha), (-0.2, 0.1));
        assert!((s.sensors.alpha.noise.si() - 0.1_f64.to_radians()).abs() < 1e-15);
    }

    fn error(from: &str, to: &str) -> String {
        assert!(CALM.contains(from), "{from}");
        Scenario::parse(&CALM.replacen(from, to, 1), "calm.toml").unwrap_err().to_string()
    }

    #[test]
    fn mistakes_are_told_with_their_line_and_the_nearest_word() {
        let message = error("dCm_alpha", "dCm_alfa");
        assert!(message.contains("dCm_alfa") && message.contains("did you mean `dCm_alpha`"), "{message}");
        let line = CALM.lines().position(|l| l.starts_with("dCm_alpha")).unwrap() + 1;
        assert!(message.starts_with(&format!("calm.toml:{line}:")), "{message}");
        let message = error("\"675 ft/s\"", "675");
        assert!(message.contains("no unit") && message.contains("ft/s"), "{message}");
        let message = error("cg = 0.30", "cg = 30");
        assert!(message.contains("fraction"), "{message}");
        let message = error("type = \"f16\"", "type = \"f-16\"");
        assert!(message.contains("did you mean `f16`"), "{message}");
        let message = error("type = \"3-2-1-1\"", "type = \"3211\"");
        assert!(message.contains("did you mean `3-2-1-1`"), "{message}");
        assert!(Scenario::parse("", "empty.toml").unwrap_err().to_string().contains("missing field `name`"));
        let cut = CALM.find("675").unwrap();
        assert!(Scenario::parse(&CALM[..cut], "cut.toml").is_err());
    }

    /// A manoeuvre that is not flown would leave an estimate without excitation, and nobody would know why.
    #[test]
    fn manoeuvres_that_are_not_flown_are_refused_or_told() {
        let message = error("unit = \"0.6 s\"", "unit = \"0 s\"");
        assert!(
            message.contains("number 1 (3-2-1-1 of the elevator)") && message.contains("`unit` is 0 s"),
            "{message}"
        );
        let doublet =
            "type = \"doublet\"\nwidth = \"-1 s\"\nsurface = \"rudder\"\nstart = \"1 s\"\namplitude = \"1 deg\"\n";
        let text = format!("{CALM}\n[[manoeuvre]]\n{doublet}");
        let message = Scenario::parse(&text, "calm.toml").unwrap_err().to_string();
        assert!(
            message.contains("number 3 (doublet of the rudder)") && message.contains("`width` is -1 s"),
            "{message}"
        );
        let without = |from: &str, to: &str| {
            assert!(CALM.contains(from), "{from}");
            Scenario::parse(&CALM.replacen(from, to, 1), "calm.toml").unwrap().manoeuvres_without_effect().unwrap()
        };
        let late = without("start = \"0.5 s\"", "start = \"500 s\"");
        let said = "`[[manoeuvre]]` number 1 (3-2-1-1 of the elevator) moves nothing: it begins at 500 s, and the flight ends at 20 s";
        assert_eq!(late, [said]);
        let still = without("\"-1.5 deg\"", "\"0 deg\"");
        assert!(still.len() == 1 && still[0].contains("number 2") && still[0].contains("are zero"), "{still:?}");
        assert!(without("seed = 1", "seed = 2").is_empty());
    }

    /// `delta_e` is what many books call the elevator.
    #[test]
    fn the_symbol_of_a_surface_is_understood_in_increments() {
        let text = CALM.replace("dCm_q = -2.0", "dCm_q = -2.0\ndCm_delta_e = 0.15\ndCn_delta_r = -0.01");
        let increments = Scenario::parse(&text, "symbols.toml").unwrap().increments;
        assert_eq!((increments.dCm_elevator, increments.dCn_rudder), (0.15, -0.01));
        let text = CALM.replace("dCm_q = -2.0", "dCm_q = -2.0\ndCm_elevator = 0.15\ndCn_rudder = -0.01");
        assert_eq!(Scenario::parse(&text, "names.toml").unwrap().increments, increments);
    }

    proptest::proptest! {
        /// Whatever is cut off or typed into a scenario, the answer is a scenario or a message of a few lines.
        #[test]
        fn spoilt_scenarios_are_refused_in_words(at in 0..CALM.len(), cut in 0_usize..40, typed in "\\PC{0,6}") {
            let start = (0..=at).rev().find(|i| CALM.is_char_boundary(*i)).unwrap();
            let end = (at + cut..=CALM.len()).find(|i| CALM.is_char_boundary(*i)).unwrap_or(CALM.len());
            let text = format!("{}{typed}{}", &CALM[..start], &CALM[end..]);
            if let Err(error) = Scenario::parse(&text, "spoilt.toml") {
                proptest::prop_assert!(error.to_string().starts_with("spoilt.toml"));
            }
        }
    }
}
