//! The file of a plant case.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::plant::Plant;
use crate::published::Published;
use phugoid_simulation::quantity::{Frequency, Time};
use phugoid_simulation::scenario::{ScenarioError, nearest, parse_toml};

/// A proof-of-concept plant with unknown parameters, its input, and the settings of the laws.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlantCase {
    /// What it shows, in a few words.
    pub title: String,
    /// Length of the record, from the beginning of the input's time.
    pub duration: Time,
    /// Time between samples, of the input, the measurements and every estimator.
    pub sample_time: Time,
    /// Seed of the measurement noise.
    #[serde(default)]
    pub seed: u64,
    /// What the thesis says of it.
    #[serde(default)]
    pub published: Published,
    /// The plant, with the constants that its equation needs.
    pub plant: Plant,
    /// Its unknown parameters, by name.
    pub parameters: BTreeMap<String, Parameter>,
    /// The plant's input `u` as a function of time.
    pub input: Signal,
    /// Settings of the printed laws and of the flagship.
    pub estimator: Settings,
    /// Measurement noise; none if it is not given.
    pub noise: Option<Noise>,
}

/// An unknown parameter: its true value and what the estimators are told of it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// True value, with which the plant is simulated.
    pub truth: f64,
    /// Lower bound that the estimators are told.
    pub lower: f64,
    /// Upper bound that the estimators are told.
    pub upper: f64,
    /// Start value of the estimates.
    pub start: f64,
    /// `lambda` of the surface that carries this parameter in the printed laws, 1/s.
    pub lambda: f64,
}

/// Settings of the estimators beside those of each parameter.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// `eta` of the printed laws, in units of the surface's rate per unit of the parameter.
    pub eta: f64,
    /// Without noise: the one-sigma noise that the flagship is told, as a fraction of the root mean square of each state
    /// over the record. It needs one; with noise it is told the true one.
    #[serde(default = "default_assumed_noise")]
    pub assumed_noise: f64,
}

fn default_assumed_noise() -> f64 {
    1e-5
}

/// A known input over time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Signal {
    /// Zero before `at`, then `amplitude`.
    Step {
        /// Value of the input from the step on.
        amplitude: f64,
        /// Time of the step, from the start of the record.
        #[serde(default)]
        at: Time,
    },
    /// `amplitude * sin(2 pi frequency t)`.
    Sine {
        /// Amplitude of the sine, in the unit of the input.
        amplitude: f64,
        /// Frequency, in Hz or rad/s.
        frequency: Frequency,
    },
    /// `amplitude` for `width`, `-amplitude` for `width`, then zero.
    Doublet {
        /// Value in the first half.
        amplitude: f64,
        /// Time at which the first half begins, from the start of the record.
        #[serde(default)]
        at: Time,
        /// Duration of each of the two halves.
        width: Time,
    },
}

/// Band-limited white noise on every measured state: white, of variance `power / sample_time`, as of the block of that
/// name in Simulink.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Noise power (height of the spectral density), state unit squared times seconds.
    pub power: f64,
}

impl Signal {
    /// Value at a time, s.
    pub fn at(&self, time_s: f64) -> f64 {
        // A sample that was meant to lie on an edge lies on its right side.
        let t = time_s + 1e-9;
        match *self {
            Self::Step { amplitude, at } => {
                if t >= at.si() {
                    amplitude
                } else {
                    0.0
                }
            }
            Self::Sine { amplitude, frequency } => amplitude * (std::f64::consts::TAU * frequency.si() * time_s).sin(),
            Self::Doublet { amplitude, at, width } => match ((t - at.si()) / width.si()).floor() {
                0.0 => amplitude,
                1.0 => -amplitude,
                _ => 0.0,
            },
        }
    }
}

impl Signal {
    /// Refuses an input that never moves within a record of this length, s: nothing can be learnt from it.
    fn check(&self, duration_s: f64) -> Result<(), String> {
        let range = |ok: bool, what: String| if ok { Ok(()) } else { Err(what) };
        let (Self::Step { amplitude, .. } | Self::Sine { amplitude, .. } | Self::Doublet { amplitude, .. }) = *self;
        range(
            amplitude.is_finite() && amplitude != 0.0,
            format!("`input.amplitude` must be finite and not zero, found {amplitude}"),
        )?;
        match *self {
            Self::Step { at, .. } | Self::Doublet { at, .. } => range(
                (0.0..duration_s).contains(&at.si()),
                format!("`input.at` must lie between the start and the end of the record, {duration_s} s: found {at}"),
            )?,
            Self::Sine { frequency, .. } => {
                range(frequency.si() > 0.0, format!("`input.frequency` must be positive, found {frequency}"))?;
            }
        }
        match *self {
            Self::Doublet { width, .. } => range(width.si() > 0.0, "`input.width` must be positive".into()),
            _ => Ok(()),
        }
    }
}

impl PlantCase {
    /// Parses the text of a plant case; `place` is its name in messages.
    ///
    /// # Errors
    /// [`ScenarioError`]: with line and nearest word for what cannot be read, and what to write for what is out of range.
    pub fn parse(text: &str, place: &str) -> Result<Self, ScenarioError> {
        let case: Self = parse_toml(text, place)?;
        case.check().map_err(|message| ScenarioError::OutOfRange { place: place.to_owned(), message })?;
        Ok(case)
    }

    /// The unknown parameters with their names, in the plant's order.
    pub fn unknowns(&self) -> impl Iterator<Item = (&str, Parameter)> {
        self.plant.parameters().into_iter().filter_map(|name| Some((name, *self.parameters.get(name)?)))
    }

    /// Number of samples, both ends included.
    pub fn samples(&self) -> usize {
        (self.duration.si() / self.sample_time.si() + 1e-9) as usize + 1
    }

    fn check(&self) -> Result<(), String> {
        const MOST_SAMPLES: f64 = 2e6;
        let range = |ok: bool, what: String| if ok { Ok(()) } else { Err(what) };
        range(self.duration.si() > 0.0, "`duration` must be positive".into())?;
        range(self.sample_time.si() > 0.0, "`sample_time` must be positive".into())?;
        let samples = self.duration.si() / self.sample_time.si();
        range(
            (10.0..=MOST_SAMPLES).contains(&samples),
            format!("`duration` over `sample_time` is {samples}: need ten to two million samples"),
        )?;
        let names = self.plant.parameters();
        for name in self.parameters.keys().chain(self.published.converged_after.keys()) {
            let near = nearest(name, names.iter().copied());
            let hint = near.map_or_else(|| names.join(" and "), str::to_owned);
            range(
                names.contains(&name.as_str()),
                format!("the plant has no parameter `{name}`: did you mean `{hint}`?"),
            )?;
        }
        for name in &names {
            let Some(p) = self.parameters.get(*name) else {
                return Err(format!("`[parameters.{name}]` is missing: the plant needs {}", names.join(" and ")));
            };
            range(
                p.truth.is_finite() && p.truth != 0.0,
                format!("`parameters.{name}.truth` must be finite and not zero"),
            )?;
            range(
                p.lower < p.upper && (p.lower..=p.upper).contains(&p.start) && p.lower * p.upper > 0.0,
                format!(
                    "`parameters.{name}`: need lower <= start <= upper, lower < upper, and both bounds of one sign (the \
                     printed gain contains the square root of their ratio); found {} <= {} <= {}",
                    p.lower, p.start, p.upper
                ),
            )?;
            range(p.lambda > 0.0 && p.lambda.is_finite(), format!("`parameters.{name}.lambda` must be positive"))?;
        }
        range(self.estimator.eta > 0.0 && self.estimator.eta.is_finite(), "`estimator.eta` must be positive".into())?;
        range(
            self.estimator.assumed_noise > 0.0 && self.estimator.assumed_noise < 1.0,
            "`estimator.assumed_noise` is a fraction of the signal, between 0 and 1".into(),
        )?;
        range(
            self.noise.is_none_or(|noise| noise.power > 0.0 && noise.power.is_finite()),
            "`noise.power` must be positive; leave `[noise]` out for none".into(),
        )?;
        self.input.check(self.duration.si())
    }
}
