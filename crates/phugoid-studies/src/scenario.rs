//! Scenario files: a simulated flight, from the aircraft to the faults of its sensors.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::sensors::SensorSpecification;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::manoeuvre::Manoeuvre;
use crate::quantity::{
    Acceleration, Angle, AngularAcceleration, AngularRate, Frequency, Length, Quantity, Speed, Time,
};

/// A simulated flight. Every quantity carries its unit: `altitude = "20000 ft"`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What it shows, in a few words.
    pub name: String,
    /// Length of the flight.
    pub duration: Time,
    /// Samples per second of the record; commands change at the samples too.
    pub sample_rate: Frequency,
    /// Seed of everything random: sensor noise, outliers, dropped frames, the pilot.
    #[serde(default)]
    pub seed: u64,
    /// Aircraft.
    pub aircraft: AircraftSettings,
    /// Where the flight starts, in trim.
    pub condition: Condition,
    /// Commands beside the trim.
    #[serde(default)]
    pub manoeuvre: Vec<Manoeuvre>,
    /// Gusts.
    #[serde(default)]
    pub gust: Vec<GustSettings>,
    /// Aerodynamic increments from the start: what the estimator has to find. They vanish at the trim point.
    #[serde(default)]
    pub increments: Increments,
    /// Increments that hold from a later time on, in place of all earlier ones: damage.
    #[serde(default)]
    pub damage: Vec<Damage>,
    /// Sensors. A channel that is not named here is recorded as it is.
    #[serde(default)]
    pub sensors: Sensors,
    /// Folder of the scenario file, where relative paths start.
    #[serde(skip)]
    pub folder: PathBuf,
}

/// The aircraft of a scenario.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AircraftSettings {
    /// Which aircraft.
    #[serde(rename = "type")]
    pub kind: AircraftKind,
    /// Which aerodynamic tables.
    #[serde(default)]
    pub tables: Tables,
    /// Centre of gravity, fraction of the mean aerodynamic chord.
    #[serde(default = "reference_cg")]
    pub cg: f64,
    /// Whether surfaces follow their commands through actuators (lag, rate and position limits) or at once.
    #[serde(default)]
    pub actuators: bool,
    /// Whether thrust stays as trimmed, or comes from the engine at fixed throttle.
    #[serde(default)]
    pub thrust: Thrust,
}

fn reference_cg() -> f64 {
    0.35
}

/// Aircraft that can be flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AircraftKind {
    /// F-16 of Stevens & Lewis.
    F16,
}

/// Aerodynamic tables of the F-16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tables {
    /// Stevens, Lewis & Johnson, 3rd edition.
    #[default]
    Book,
    /// Morelli's digitisation.
    Morelli,
}

/// What thrust does after the trim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Thrust {
    /// It stays as trimmed.
    #[default]
    Constant,
    /// The engine at the trim throttle: thrust follows Mach number and altitude.
    Engine,
}

/// Trim condition.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Altitude above sea level.
    pub altitude: Length,
    /// True airspeed.
    pub speed: Speed,
    /// Angle of climb, positive up.
    #[serde(default)]
    pub flight_path: Angle,
    /// Rate of turn about the vertical, positive to the right.
    #[serde(default)]
    pub turn_rate: AngularRate,
}

/// A gust of thesis equation 2.32: the air along a body axis rises as `1 - cos` and then stays.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GustSettings {
    /// Body axis: `x` forward, `y` right, `z` down.
    pub axis: phugoid_flight_dynamics::gust::BodyAxis,
    /// Final velocity of the air along the axis.
    pub amplitude: Speed,
    /// Duration of the rise.
    pub duration: Time,
    /// Beginning.
    #[serde(default)]
    pub start: Time,
}

/// Increments from a time on.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Damage {
    /// When.
    pub at: Time,
    /// What holds from then on.
    pub increments: Increments,
}

/// One sensor: `quantise(true value one delay ago + bias + noise [+ outlier])`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sensor<Q> {
    /// Standard deviation of white noise.
    pub noise: Q,
    /// Constant error.
    pub bias: Q,
    /// Size of the steps of the digital output.
    pub quantisation: Q,
    /// Age of what is measured.
    pub delay: Time,
    /// Rate of the sensor's own samples; between them there is no value. Every sample has one if it is not given.
    pub rate: Option<Frequency>,
    /// Probability that a value is an outlier.
    pub outliers: f64,
    /// Size of an outlier in standard deviations of the noise, either sign.
    pub outlier_size: f64,
    /// Probability that a value is missing.
    pub drops: f64,
}

impl<Q: Quantity> Sensor<Q> {
    /// The sensor in SI.
    pub fn specification(&self) -> SensorSpecification {
        SensorSpecification {
            noise: self.noise.si(),
            bias: self.bias.si(),
            sample_interval: self.rate.map_or(0.0, |rate| rate.si().recip()),
            delay: self.delay.si(),
            quantisation: self.quantisation.si(),
            outlier_probability: self.outliers,
            outlier_size: self.outlier_size * self.noise.si(),
            drop_probability: self.drops,
        }
    }
}

/// Sensors, by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sensors {
    /// Probability that a whole frame of air data and inertial sensors is missing. Altitude and surface positions, which
    /// the flight computer has from elsewhere, stay.
    pub drops: f64,
    /// True airspeed.
    pub true_airspeed: Sensor<Speed>,
    /// Angle of attack.
    pub alpha: Sensor<Angle>,
    /// Sideslip angle.
    pub beta: Sensor<Angle>,
    /// Roll angle.
    pub phi: Sensor<Angle>,
    /// Pitch angle.
    pub theta: Sensor<Angle>,
    /// Heading.
    pub psi: Sensor<Angle>,
    /// Roll rate.
    pub p: Sensor<AngularRate>,
    /// Pitch rate.
    pub q: Sensor<AngularRate>,
    /// Yaw rate.
    pub r: Sensor<AngularRate>,
    /// Pitch acceleration; not measured unless it is named.
    pub qdot: Option<Sensor<AngularAcceleration>>,
    /// Specific force, body x.
    pub ax: Sensor<Acceleration>,
    /// Specific force, body y.
    pub ay: Sensor<Acceleration>,
    /// Specific force, body z.
    pub az: Sensor<Acceleration>,
    /// Altitude.
    pub altitude: Sensor<Length>,
    /// Elevator position.
    pub elevator: Sensor<Angle>,
    /// Aileron position.
    pub aileron: Sensor<Angle>,
    /// Rudder position.
    pub rudder: Sensor<Angle>,
}

/// Why a scenario could not be read or flown.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("cannot read the scenario `{}`: {source}", .file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The text is not a scenario.
    #[error("{place}:{line}: {message}\n{excerpt}")]
    Invalid {
        /// File or name of the scenario.
        place: String,
        /// Line, from one.
        line: usize,
        /// What is wrong and what to write.
        message: String,
        /// The line itself.
        excerpt: String,
    },
    /// A value is out of range.
    #[error("{place}: {message}")]
    OutOfRange {
        /// File or name of the scenario.
        place: String,
        /// What is wrong and what to write.
        message: String,
    },
}

impl Scenario {
    /// Reads a scenario file.
    pub fn read(file: &Path) -> Result<Self, ScenarioError> {
        let text = std::fs::read_to_string(file)
            .map_err(|source| ScenarioError::Unreadable { file: file.to_owned(), source })?;
        let mut scenario = Self::parse(&text, &file.display().to_string())?;
        scenario.folder = file.parent().map(Path::to_owned).unwrap_or_default();
        Ok(scenario)
    }

    /// True values, at the end of the flight, of what a model file may ask for, by its names: the longitudinal increments
    /// about the trim (`dCm_alpha`, ..., `dCm_elevator`), zero or not, and the sensors' constant errors (`bias_alpha`, ...),
    /// SI.
    pub fn true_parameters(&self) -> BTreeMap<String, f64> {
        let last = self.damage.last().map_or(&self.increments, |damage| &damage.increments);
        let sensors = &self.sensors;
        let biases = [
            ("bias_true_airspeed", sensors.true_airspeed.bias.si()),
            ("bias_alpha", sensors.alpha.bias.si()),
            ("bias_theta", sensors.theta.bias.si()),
            ("bias_q", sensors.q.bias.si()),
            ("bias_ax", sensors.ax.bias.si()),
            ("bias_az", sensors.az.bias.si()),
            ("bias_qdot", sensors.qdot.map_or(0.0, |sensor| sensor.bias.si())),
        ];
        last.named_longitudinal().into_iter().chain(biases).map(|(name, value)| (name.to_owned(), value)).collect()
    }

    /// Parses the text of a scenario; `place` is its name in messages.
    pub fn parse(text: &str, place: &str) -> Result<Self, ScenarioError> {
        let scenario: Self = parse_toml(text, place)?;
        scenario.check().map_err(|message| ScenarioError::OutOfRange { place: place.to_owned(), message })?;
        Ok(scenario)
    }

    /// Number of samples, both ends included.
    pub fn samples(&self) -> usize {
        (self.duration.si() * self.sample_rate.si() + 1e-9) as usize + 1
    }

    pub(crate) fn check(&self) -> Result<(), String> {
        // Some 700 bytes each while the flight is in memory.
        const MOST_SAMPLES: f64 = 2e6;
        let range = |ok: bool, what: &str| if ok { Ok(()) } else { Err(what.to_owned()) };
        range(self.duration.si() > 0.0, "`duration` must be positive")?;
        range(self.sample_rate.si() > 0.0, "`sample_rate` must be positive")?;
        let samples = self.duration.si() * self.sample_rate.si();
        range(samples <= MOST_SAMPLES, "`duration` times `sample_rate` is more than two million samples: shorten one")?;
        range(samples >= 1.0, "`duration` is shorter than one sample of `sample_rate`")?;
        range(
            (0.0..=1.0).contains(&self.aircraft.cg),
            "`aircraft.cg` is a fraction of the mean chord, 0 to 1 (0.30, not 30)",
        )?;
        range((0.0..=1.0).contains(&self.sensors.drops), "`sensors.drops` is a probability, 0 to 1 (0.05, not 5)")?;
        for increments in std::iter::once(&self.increments).chain(self.damage.iter().map(|d| &d.increments)) {
            range(
                [increments.alpha_reference, increments.q_reference, increments.elevator_reference] == [0.0; 3],
                "increments of a scenario are about its trim point: leave the references out",
            )?;
            let named = increments.named_longitudinal();
            if let Some((name, value)) = named.into_iter().find(|(_, value)| !value.is_finite()) {
                return Err(format!("the increment `{name}` is {value}: expected a finite number, per radian"));
            }
        }
        range(
            self.damage.windows(2).all(|w| w[0].at < w[1].at),
            "the `[[damage]]` tables must be in the order of their times `at`",
        )?;
        Ok(())
    }
}

/// Parses TOML; `place` is the name of the text in messages, which give the line and the nearest valid word.
pub(crate) fn parse_toml<T: DeserializeOwned>(text: &str, place: &str) -> Result<T, ScenarioError> {
    toml::from_str(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start).min(text.len());
        let before = text.get(..offset).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let excerpt = text.lines().nth(line - 1).unwrap_or_default();
        ScenarioError::Invalid {
            place: place.to_owned(),
            line,
            message: with_suggestion(error.message()),
            excerpt: format!("  {line} | {excerpt}"),
        }
    })
}

/// Adds the nearest valid word to serde's "unknown field `x`, expected one of `a`, `b`".
fn with_suggestion(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let (Some(found), true) = (quoted.next(), message.starts_with("unknown")) else { return message.to_owned() };
    let head = message.split(", expected").next().unwrap_or(message);
    let valid: Vec<&str> = quoted.collect();
    match nearest(found, valid.iter().copied()) {
        Some(word) => format!("{head}: did you mean `{word}`?"),
        None => format!("{head}: expected one of {}", valid.join(", ")),
    }
}

/// The valid word nearest to a misspelt one, if any is near.
pub fn nearest<'a>(word: &str, valid: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    valid
        .map(|v| (strsim::jaro_winkler(&word, &v.to_lowercase()), v))
        .filter(|(similarity, _)| *similarity > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, v)| v)
}

/// The scenarios that are built in: name and text.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("f16-calm", include_str!("../../../scenarios/f16-calm.toml")),
    ("f16-thesis-doublet", include_str!("../../../scenarios/f16-thesis-doublet.toml")),
    ("f16-thesis-sine", include_str!("../../../scenarios/f16-thesis-sine.toml")),
    ("f16-thesis-gust", include_str!("../../../scenarios/thesis/f16-thesis-gust.toml")),
    ("f16-damage", include_str!("../../../scenarios/f16-damage.toml")),
    ("f16-gust-actuators", include_str!("../../../scenarios/f16-gust-actuators.toml")),
    ("f16-failure", include_str!("../../../scenarios/f16-failure.toml")),
    ("f16-healthy", include_str!("../../../scenarios/f16-healthy.toml")),
];

/// A built-in scenario by name.
pub fn built_in(name: &str) -> Option<Result<Scenario, ScenarioError>> {
    BUILT_IN.iter().find(|(n, _)| *n == name).map(|(n, text)| Scenario::parse(text, n))
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
