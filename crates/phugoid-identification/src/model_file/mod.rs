//! The model file: an aircraft, its coefficient build-up and what is known beforehand, in TOML.
//!
//! The format is described in `docs/model-file.md`.

mod expected;
mod named;
mod parse;
mod section;

pub use expected::Expectation;
pub use named::ModelError;

use std::collections::BTreeMap;

use phugoid_flight_data::table::ColumnMapping;

use crate::core::axes::Axes;
use crate::core::method::Method;
use crate::core::output::{CHANNELS, Output, STATE_CHANNELS};
use crate::core::term::{Coefficient, Term};

/// What is wrong with a model file, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {message}\n    {line} | {}", excerpt.trim_end())]
pub struct ModelFileError {
    /// File or built-in name.
    pub file: Box<str>,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Dotted path of the key, e.g. `parameters.CL_alpha.start`.
    pub key: Box<str>,
    /// What was found, what was expected, what to do.
    pub message: Box<str>,
    /// The valid word nearest to a misspelt one.
    pub nearest: Option<Box<str>>,
    /// The line of the file.
    pub excerpt: Box<str>,
}

/// The aerodynamic database that the build-up is added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// None: the build-up is the whole coefficient.
    None,
    /// The F-16 of Stevens & Lewis; the build-up is made of increments about the reference point.
    F16,
}

/// The speed that normalises the pitch rate, `q_hat = q cbar / (2 V)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateSpeed {
    /// The actual airspeed.
    Actual,
    /// The reference speed of the model file.
    Reference,
}

/// A quantity that is constant or recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Constant, SI.
    Constant(f64),
    /// The channel with this canonical name.
    Channel(String),
}

/// Where the thrust comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Thrust {
    /// Constant (N) or recorded.
    Known(Source),
    /// Constant, from the trim at the reference point.
    Trim,
}

/// Where the air density comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum AirDensity {
    /// Constant (kg/m^3) or recorded.
    Known(Source),
    /// International standard atmosphere 1976 at the `altitude` channel.
    StandardAtmosphere,
    /// The air-data model of Stevens & Lewis (appendix A) at the `altitude` channel.
    BookAtmosphere,
}

/// The aircraft as a rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct AircraftData {
    /// Mass, kg.
    pub mass: Source,
    /// Moment of inertia about the body x axis, kg m^2; there where the axes need it.
    pub ixx: Option<Source>,
    /// Moment of inertia about the body y axis, kg m^2.
    pub iyy: Source,
    /// Moment of inertia about the body z axis, kg m^2; there where the axes need it.
    pub izz: Option<Source>,
    /// Product of inertia, integral of x z dm, kg m^2; there where the axes need it.
    pub ixz: Option<Source>,
    /// Wing reference area, m^2.
    pub wing_area: f64,
    /// Mean aerodynamic chord, m.
    pub mean_chord: f64,
    /// Wing span, m; there where the axes need it.
    pub wing_span: Option<f64>,
    /// Centre of gravity behind the leading edge of the mean chord, fraction of it. Only databases need it.
    pub cg: Option<f64>,
    /// Thrust, N.
    pub thrust: Thrust,
    /// Angle of the thrust line above the body x axis, rad.
    pub thrust_inclination: f64,
    /// Pitching moment per newton of thrust, m: positive where the thrust line passes below the centre of gravity.
    pub thrust_arm: f64,
    /// Air density, kg/m^3.
    pub air_density: AirDensity,
    /// Angular momentum of spinning rotors along body x, kg m^2/s, positive clockwise seen from behind.
    pub rotor_momentum: f64,
    /// Reference speed `V0`, m/s.
    pub reference_speed: Option<f64>,
    /// Acceleration of gravity, m/s^2.
    pub gravity: f64,
}

/// A component of the reference point about which increments are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceValue {
    /// Given, SI.
    Given(f64),
    /// From the level trim of the database at the reference speed and altitude.
    Trim,
    /// From the first sample of the record.
    FirstSample,
}

/// The reference point: terms are functions of `alpha - alpha_ref`, `elevator - elevator_ref`, and so on for aileron and
/// rudder; sideslip and rates count from zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Angle of attack, rad.
    pub alpha: ReferenceValue,
    /// Elevator, rad.
    pub elevator: ReferenceValue,
    /// Aileron, rad.
    pub aileron: ReferenceValue,
    /// Rudder, rad.
    pub rudder: ReferenceValue,
    /// Altitude of the trim, m.
    pub altitude: Option<f64>,
}

/// What a parameter multiplies.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// A term of the build-up.
    Term(Coefficient, Term),
    /// A constant in a coefficient that takes up model error.
    Offset(Coefficient),
    /// The constant error of a sensor.
    Bias(Output),
}

/// A parameter: name, role and what is known of it beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name, e.g. `CL_alpha`, `dCm_q`, `offset_Cm`, `bias_alpha`.
    pub name: String,
    /// What it multiplies.
    pub role: Role,
    /// Start value, SI, per radian where an angle is involved.
    pub start: f64,
    /// One sigma of what is known beforehand about its distance from the start value.
    pub prior_std: f64,
    /// Declared limits.
    pub bounds: Option<[f64; 2]>,
    /// One sigma of a plausible sudden change; none for the automatic rule.
    pub change_std: Option<f64>,
    /// True if it is known and not estimated.
    pub fixed: bool,
}

impl Parameter {
    /// True for parameters that only support the others: offsets and sensor biases.
    pub fn is_nuisance(&self) -> bool {
        !matches!(self.role, Role::Term(..))
    }

    /// Unit as printed: `per rad`, `-`; that of the sensor for a bias.
    pub fn unit(&self) -> String {
        match &self.role {
            Role::Bias(output) => output.unit().to_owned(),
            Role::Term(_, term) => term.parameter_unit(),
            Role::Offset(_) => "-".to_owned(),
        }
    }
}

/// The process noise that stands for gusts and model error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise {
    /// Spectral densities of the rates of the states, by [`Output::index`]: airspeed (m^2/s^3), angles (rad^2/s), angular
    /// rates (rad^2/s^3). Those that are no states of the axes are not used.
    pub density: [f64; STATE_CHANNELS],
    /// True if a scale on all of them is learnt from the residuals.
    pub adaptive: bool,
}

/// The estimator's own settings where they differ from the automatic rule (`docs/tuning.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorTuning {
    /// Which estimator, where the command line does not say.
    pub method: Method,
    /// `kappa`: up to this normalised surface value a row slides; none for the rule, 3.
    pub reaching_limit: Option<f64>,
    /// Factor on the rule for `kappa2`, `max(6, 2 sqrt(p) + 2)`, beyond which a row is rejected; never below `kappa`.
    pub rejection_scale: f64,
    /// Factor on the start priors of the terms; sudden changes and nuisance columns keep theirs.
    pub prior_scale: f64,
    /// Factor on the process noise that the file gives (with adaptive noise: on its start).
    pub process_noise_scale: f64,
    /// Part of the information about the scale of the process noise that is forgotten per sample; none for the rule, 0.003. Only where
    /// it is adaptive.
    pub adaptation_gain: Option<f64>,
    /// Length of the median start, s; none for the rule, 0.2 s.
    pub start_window_s: Option<f64>,
}

impl Default for EstimatorTuning {
    fn default() -> Self {
        Self {
            method: Method::default(),
            reaching_limit: None,
            rejection_scale: 1.0,
            prior_scale: 1.0,
            process_noise_scale: 1.0,
            adaptation_gain: None,
            start_window_s: None,
        }
    }
}

/// How the input runs between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputHold {
    /// Held at the value of the earlier sample.
    Held,
    /// Straight line to the next sample.
    Interpolated,
}

/// A model file that has been read and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// File or built-in name.
    pub source: String,
    /// Aircraft, for reports.
    pub name: String,
    /// Axes that are estimated.
    pub axes: Axes,
    /// Database.
    pub base: Base,
    /// Normalisation of the pitch rate.
    pub rate_speed: RateSpeed,
    /// Rigid body.
    pub aircraft: AircraftData,
    /// Names of the extra input channels that terms may use.
    pub extra_inputs: Vec<String>,
    /// Headers of the user's file, by canonical channel name.
    pub channels: BTreeMap<String, ColumnMapping>,
    /// Which outputs are measured, by [`Output::index`]; only outputs of the axes are.
    pub outputs: [bool; CHANNELS],
    /// Measurement noise by [`Output::index`], one sigma, SI; none: measured from the record.
    pub noise: [Option<f64>; CHANNELS],
    /// Parameters: terms in the order of the file, then offsets, then biases. Fixed ones included.
    pub parameters: Vec<Parameter>,
    /// Reference point of increments.
    pub reference: Reference,
    /// Process noise.
    pub process_noise: ProcessNoise,
    /// Settings of the estimator beside the automatic rule.
    pub estimator: EstimatorTuning,
    /// How the input runs between samples.
    pub input: InputHold,
    /// True if a change of the parameters in flight is looked for.
    pub change_detection: bool,
    /// What the reader of the file should know: former spellings that were read as today's. Sentences without a full stop.
    pub notes: Vec<String>,
    /// The table `[expected]`, if there is one.
    pub expected: Option<Vec<Expectation>>,
}

impl ModelFile {
    /// Reads and checks a model file.
    ///
    /// # Errors
    /// The first thing found wrong, with file, line, column, key and the nearest valid word.
    pub fn parse(file: &str, text: &str) -> Result<Self, ModelFileError> {
        parse::parse(file, text)
    }

    /// Canonical names of the channels that the estimation reads.
    pub fn channels_used(&self) -> Vec<&str> {
        let mut used: Vec<&str> = self.axes.known_channels().to_vec();
        used.extend(self.measured().map(|o| -> &str { o.name() }));
        used.extend(self.extra_inputs.iter().map(String::as_str));
        let aircraft = &self.aircraft;
        let mut sources = vec![&aircraft.mass, &aircraft.iyy];
        sources.extend([&aircraft.ixx, &aircraft.izz, &aircraft.ixz].into_iter().flatten());
        match &aircraft.air_density {
            AirDensity::Known(source) => sources.push(source),
            AirDensity::StandardAtmosphere | AirDensity::BookAtmosphere => used.push("altitude"),
        }
        if let Thrust::Known(source) = &aircraft.thrust {
            sources.push(source);
        }
        used.extend(sources.into_iter().filter_map(|source| match source {
            Source::Channel(name) => Some(name.as_str()),
            Source::Constant(_) => None,
        }));
        used
    }

    /// The columns of a record that the file maps to channels by hand.
    pub fn columns(&self) -> Vec<ColumnMapping> {
        self.channels.values().cloned().collect()
    }

    /// Outputs that are measured, in the order of the motion's output vector.
    pub fn measured(&self) -> impl Iterator<Item = Output> {
        self.axes.outputs().iter().copied().filter(|o| self.outputs[o.index()])
    }

    /// Parameters that are estimated.
    pub fn estimated(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|p| !p.fixed)
    }
}
