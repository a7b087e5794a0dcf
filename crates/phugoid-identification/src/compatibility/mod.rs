//! Data compatibility: do the measurements of a flight agree with the kinematics of a rigid body, and with which errors
//! of the sensors do they?
//!
//! The kinematic equations, driven by accelerometers and rate gyroscopes, give airspeed, flow angles and attitude
//! without any aerodynamics. Their difference from what was measured is the work of biases, scale factors, delays,
//! positions and wind, which [`output_error`] estimates with standard errors (Klein & Morelli, chapter 10; Jategaonkar,
//! chapter 10). Each has a wide prior; an error that the data do not determine stays at its prior, and the result says
//! so.

mod correction;
mod input_noise;
mod kinematics;
mod reconstruction;
mod signals;
mod skew;
mod unknowns;

use serde::{Deserialize, Serialize};

use phugoid_flight_data::record::Record;

use crate::batch::{
    BatchParameter, Bias, InitialState, Manoeuvre, OptimiserSettings, OutputChannel, OutputFit, Structure, UnknownKind,
    output_error,
};
use crate::core::error::EstimateError;
use crate::core::options::Likelihood;
pub use correction::{ChannelCorrection, Corrections};
use kinematics::{Kinematics, OUTPUTS, STATES};
pub use reconstruction::Reconstructed;
pub(crate) use signals::differentiated;
use signals::{Signals, signals};
pub use skew::{InputSkew, input_skew};
pub use unknowns::Group;
use unknowns::UNKNOWNS;

/// Which errors of the sensors a compatibility check estimates, and what is known of the installation.
#[derive(Clone, Debug, PartialEq)]
pub struct CompatibilityOptions {
    /// Groups of errors that are estimated in addition to the biases, which always are.
    pub groups: Vec<Group>,
    /// Known distance of the vanes of alpha and beta ahead of the centre of gravity, m.
    pub vanes_x: [f64; 2],
    /// Acceleration of gravity at the place of the flight, m/s^2, positive.
    pub gravity: f64,
}

impl Default for CompatibilityOptions {
    /// Biases, scale factors of the air data and delays; vanes at the centre of gravity; standard gravity.
    fn default() -> Self {
        Self { groups: vec![Group::AirDataScales, Group::Delays], vanes_x: [0.0; 2], gravity: 9.80665 }
    }
}

/// The estimate of one error of the sensors, with its standard error and a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensorError {
    /// Name of the unknown, e.g. `bias_alpha`, `scale_true_airspeed` or `delay_theta`.
    pub name: String,
    /// SI unit, `-` for a pure number.
    pub unit: String,
    /// Estimate, in `unit`.
    pub value: f64,
    /// One-sigma error, corrected for the colour of the residuals and for the noise of the inertial sensors.
    pub std_error: f64,
    /// One sigma of what was expected beforehand.
    pub prior_std: f64,
    /// How many standard errors the estimate is away from zero: `|value| / std_error`.
    pub significance: f64,
    /// Whether the error should be taken out of the record.
    pub verdict: SensorVerdict,
}

/// What an estimated error of a sensor means for the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorVerdict {
    /// More than two standard errors from zero: correct it.
    Significant,
    /// The data determine it, and it is not different from zero: nothing has to be corrected.
    None,
    /// The manoeuvre says little beyond what was expected beforehand: the error is still above 0.7 of the prior's.
    NotIdentifiable,
}

impl SensorVerdict {
    /// The verdict in words, as reports show it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Significant => "significant",
            Self::None => "none found",
            Self::NotIdentifiable => "not identifiable from this manoeuvre",
        }
    }
}

/// The result of a compatibility check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compatibility {
    /// Source of the record, e.g. its file name.
    pub source: String,
    /// The unknowns that were estimated, in the order of the parameters of the kinematic model.
    pub errors: Vec<SensorError>,
    /// Corrections for the significant errors: apply them with [`Corrections::apply`].
    pub corrections: Corrections,
    /// How the reconstructed outputs, errors of the sensors included, follow the measured ones.
    pub fit: Vec<OutputFit>,
    /// Times of the samples in [`reconstructed`](Self::reconstructed), s.
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// The motion at the centre of gravity that follows from the inertial sensors and the estimated errors.
    #[serde(skip)]
    pub reconstructed: Vec<Reconstructed>,
    /// Warnings about the result in sentences; read them before you use the numbers.
    pub notes: Vec<String>,
}

impl Compatibility {
    /// The estimated error with this name; `None` if it was not estimated.
    pub fn error(&self, name: &str) -> Option<&SensorError> {
        self.errors.iter().find(|e| e.name == name)
    }

    /// The reconstructed channel of this name: what was true, without the errors of its sensor.
    pub fn channel(&self, name: &str) -> Option<&Reconstructed> {
        self.reconstructed.iter().find(|c| c.name == name)
    }
}

/// Checks the kinematic consistency of a record and estimates the errors of its sensors.
///
/// Needs the channels `true_airspeed`, `theta`, `q`, `ax` and `az`; `alpha` and all lateral ones are used where they
/// are there. Without `alpha` the angle of attack is reconstructed from the rest.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::compatibility::{CompatibilityOptions, SensorVerdict, compatibility};
/// let mut flight = Record::open("examples/flight.csv")?;
/// for channel in flight.channels.iter_mut().filter(|channel| channel.name == "q") {
///     channel.values.iter_mut().for_each(|q| *q += 0.01); // a rate gyroscope with a constant error, rad/s
/// }
/// // Only constant errors are looked for: no scale factors and no delays.
/// let options = CompatibilityOptions { groups: Vec::new(), ..CompatibilityOptions::default() };
/// let result = compatibility(&flight, &options)?;
/// let bias = result.error("bias_q").ok_or("not estimated")?;
/// assert_eq!(bias.verdict, SensorVerdict::Significant);
/// assert!((bias.value - 0.01).abs() < 0.001, "{bias:?}");
/// let corrected = result.corrections.apply(&flight);
/// assert!((flight.require("q")?.values[0] - corrected.require("q")?.values[0] - bias.value).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EstimateError`]: a missing channel, too few samples, unknowns that cannot be told apart.
pub fn compatibility(record: &Record, options: &CompatibilityOptions) -> Result<Compatibility, EstimateError> {
    let Signals { time, inputs, outputs, start, present, lateral, mut notes } = signals(record)?;
    let has = |name: &str| present.iter().any(|p| p == name);
    let wanted = |spec: &unknowns::Spec| {
        let asked = spec.group == Group::Biases || options.groups.contains(&spec.group);
        let horizontal = spec.group != Group::Wind || has("north") && has("east") && has("psi") && has("altitude");
        asked && horizontal && has(spec.channel)
    };
    let parameters: Vec<BatchParameter> = UNKNOWNS
        .iter()
        .map(|spec| {
            let start = match spec.name {
                "vane_alpha_x" => options.vanes_x[0],
                "vane_beta_x" => options.vanes_x[1],
                _ => 0.0,
            };
            let free = BatchParameter::free(spec.name, start);
            BatchParameter { prior_std: Some(spec.prior_std), fixed: !wanted(spec), ..free }
        })
        .collect();
    // A state that nothing measures is held at its start value.
    let state = |name: &str, free: bool| InitialState { name: name.to_owned(), free };
    let structure: Structure<STATES, OUTPUTS> = Structure {
        parameters,
        states: [
            state("u", true),
            state("v", lateral),
            state("w", true),
            state("phi", has("phi")),
            state("theta", true),
            state("psi", has("psi")),
            state("north", has("north")),
            state("east", has("east")),
            state("altitude", has("altitude")),
        ],
        outputs: std::array::from_fn(|i| OutputChannel {
            name: signals::OUTPUT_CHANNELS[i].to_owned(),
            noise: signals::noise(&outputs, i),
            bias: Bias::None,
        }),
        maximum_step_s: 0.05,
        maximum_gap_s: f64::INFINITY,
        likelihood: Likelihood::Gaussian,
    };
    let model = Kinematics { gravity: options.gravity };
    let manoeuvre = Manoeuvre {
        name: &record.source,
        model: &model,
        time_s: &time,
        inputs: &inputs,
        hold: phugoid_estimators::discretization::InputHold::Linear,
        outputs: &outputs,
        initial_state: Some(start),
    };
    let fit = output_error::<_, _, STATES, OUTPUTS>(&[manoeuvre], &structure, &OptimiserSettings::default())
        .map_err(|e| EstimateError::Model(format!("data compatibility: {e}")))?;
    let flight = input_noise::Flight {
        model: &model,
        time: &time,
        inputs: &inputs,
        outputs: &outputs,
        maximum_step_s: structure.maximum_step_s,
    };
    let by_input_noise = flight.input_noise(&fit);
    let errors: Vec<SensorError> = fit
        .unknowns
        .iter()
        .enumerate()
        .filter_map(|(i, unknown)| {
            let UnknownKind::Parameter { index } = unknown.kind else { return None };
            let spec = &UNKNOWNS[index];
            let std_error = unknown.corrected_std_error.hypot(by_input_noise[(i, i)].sqrt()).min(spec.prior_std);
            let significance = unknown.value.abs() / std_error;
            let verdict = match significance {
                _ if std_error > 0.7 * spec.prior_std => SensorVerdict::NotIdentifiable,
                s if s > 2.0 => SensorVerdict::Significant,
                _ => SensorVerdict::None,
            };
            Some(SensorError {
                name: spec.name.to_owned(),
                unit: spec.unit.to_owned(),
                value: unknown.value,
                std_error,
                prior_std: spec.prior_std,
                significance,
                verdict,
            })
        })
        .collect();
    // The notes of output error are about models of aircraft and are left out: kinematic equations always integrate
    // freely.
    notes.extend(confused(
        &fit.correlation(),
        &fit.unknowns.iter().map(|u| (u.kind, u.name.as_str())).collect::<Vec<_>>(),
    ));
    let reconstructed = reconstruction::reconstruct(&model, &time, &inputs, &fit, &present);
    Ok(Compatibility {
        source: record.source.clone(),
        corrections: corrections(&errors, options),
        errors,
        fit: fit.manoeuvres.first().map(|m| m.outputs.clone()).unwrap_or_default(),
        time_s: time,
        reconstructed,
        notes,
    })
}

/// Pairs of unknowns that the manoeuvre does not tell apart.
fn confused(correlation: &[Vec<f64>], unknowns: &[(UnknownKind, &str)]) -> Vec<String> {
    let is_parameter = |i: usize| matches!(unknowns[i].0, UnknownKind::Parameter { .. });
    let mut found = Vec::new();
    for (i, row) in correlation.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(i) {
            if value.abs() > 0.95 && is_parameter(i) && is_parameter(j) {
                found.push(format!(
                    "{} and {} are hardly told apart (correlation {value:.3}): trust their combination, not each alone",
                    unknowns[j].1, unknowns[i].1
                ));
            }
        }
    }
    found
}

/// The significant errors as corrections; known vane positions too.
fn corrections(errors: &[SensorError], options: &CompatibilityOptions) -> Corrections {
    let value = |name: &str| {
        errors.iter().find(|e| e.name == name && e.verdict == SensorVerdict::Significant).map_or(0.0, |e| e.value)
    };
    let mut corrections = Corrections {
        vane_alpha_x: options.vanes_x[0],
        vane_beta_x: options.vanes_x[1],
        accelerometer_x: value("accelerometer_x"),
        accelerometer_z: value("accelerometer_z"),
        ..Corrections::default()
    };
    if options.groups.contains(&Group::VanePositions) {
        (corrections.vane_alpha_x, corrections.vane_beta_x) = (value("vane_alpha_x"), value("vane_beta_x"));
    }
    for channel in ["ax", "ay", "az", "p", "q", "r", "true_airspeed", "alpha", "beta", "phi", "theta", "psi"] {
        let delay = match channel {
            "phi" | "theta" | "psi" => "delay_attitude".to_owned(),
            other => format!("delay_{other}"),
        };
        let mut c = ChannelCorrection {
            bias: value(&format!("bias_{channel}")),
            scale: value(&format!("scale_{channel}")),
            delay_s: value(&delay),
        };
        if ["ax", "ay", "az", "p", "q", "r"].contains(&channel) {
            // True = (1 - scale) measured - bias there: the same in this form.
            (c.bias, c.scale) = (c.bias / (1.0 - c.scale), 1.0 / (1.0 - c.scale) - 1.0);
        }
        if c != ChannelCorrection::default() {
            corrections.channels.insert(channel.to_owned(), c);
        }
    }
    corrections
}
