//! The reference aircraft as the estimators see it: inputs, outputs and rates by sample.

use phugoid_flight_data::record::Record;
use phugoid_identification::longitudinal::{LongitudinalInput, LongitudinalModel, OUTPUTS, STATES};
use phugoid_identification::model_file::{ModelFile, Parameter, Role};
use phugoid_identification::prepare::prepare;

use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::flight::Flight;

/// The flight of the reference aircraft.
///
/// The sums of the printed surfaces go over p, q, r and over alpha, beta, V. In wings-level flight with the elevator alone
/// p, r and beta stay at zero ([`Reference::lateral`] says how exactly), so the sums are those over q and over alpha and V,
/// and the longitudinal motion is the whole of it.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The model that the estimators run.
    pub model: LongitudinalModel,
    /// Names of its parameters, in its order.
    pub names: Vec<String>,
    /// Their start values, per radian.
    pub starts: Vec<f64>,
    /// Times of the samples from the start of the record, s.
    pub time: Vec<f64>,
    /// Known input of the estimated model at each sample.
    pub inputs: Vec<LongitudinalInput>,
    /// Measured outputs per sample, SI; NaN where missing.
    pub outputs: Vec<[f64; OUTPUTS]>,
    /// True V, alpha, theta, q per sample, SI.
    pub states: Vec<[f64; STATES]>,
    /// True rates of V, alpha, theta, q per sample, SI: the thesis takes them as known.
    pub rates: Vec<[f64; STATES]>,
    /// V, alpha, theta, q as the sensors give them, per sample, SI; the true ones where the sensors are perfect.
    pub measured_states: Vec<[f64; STATES]>,
    /// Their rates as they follow from the sensors: of V and alpha from the accelerometers and gravity along the measured
    /// attitude, of theta the measured q, of q the measured pitch acceleration. Where there is no sensor of that, the
    /// difference from the last sample if q is noisy, and the true one if it is not.
    pub measured_rates: Vec<[f64; STATES]>,
    /// Largest magnitude of beta (rad), p and r (rad/s) in the flight.
    pub lateral: [f64; 3],
    /// First sample whose elevator is not that of the trim; none if it never moves.
    pub input_starts_s: Option<f64>,
}

impl Reference {
    /// From a flown case and the model that its estimators are told.
    ///
    /// # Errors
    /// [`StudyError`]: a channel is missing.
    pub fn new(flight: &Flight, model: &ModelFile) -> Result<Self, StudyError> {
        let prepared = prepare::<LongitudinalModel, _, _>(&flight.measured, model)?;
        let gravity = prepared.model.constants().gravity;
        let (states, rates) = states_and_rates(&flight.truth, values(&flight.truth, "qdot")?, prepared.first, gravity)?;
        let pitch_acceleration = pitch_acceleration(flight)?;
        let (measured_states, measured_rates) =
            states_and_rates(&flight.measured, &pitch_acceleration, prepared.first, gravity)?;
        let largest = |name| -> Result<f64, StudyError> {
            Ok(values(&flight.truth, name)?.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())))
        };
        let own = |parameter: &&Parameter| !matches!(parameter.role, Role::Bias(_));
        let elevator = values(&flight.truth, "elevator")?;
        let trim = flight.trim.elevator_rad;
        let moved = elevator.iter().position(|position| (position - trim).abs() > 1e-12);
        Ok(Self {
            model: prepared.model,
            names: model.estimated().filter(own).map(|p| p.name.clone()).collect(),
            starts: model.estimated().filter(own).map(|p| p.start).collect(),
            time: prepared.time,
            inputs: prepared.inputs,
            outputs: prepared.outputs,
            states,
            rates,
            measured_states,
            measured_rates,
            lateral: [largest("beta")?, largest("p")?, largest("r")?],
            input_starts_s: moved.and_then(|k| flight.truth.time.get(k).copied()),
        })
    }
}

/// V, alpha, theta, q by sample, SI, or their rates.
type States = Vec<[f64; STATES]>;

/// V, alpha, theta, q of a record from sample `first` on, and their rates.
fn states_and_rates(
    record: &Record,
    pitch_acceleration: &[f64],
    first: usize,
    gravity: f64,
) -> Result<(States, States), StudyError> {
    let [v, alpha, theta, q] = ["true_airspeed", "alpha", "theta", "q"].map(|name| values(record, name));
    let (v, alpha, theta, q, ax, az) = (v?, alpha?, theta?, q?, values(record, "ax")?, values(record, "az")?);
    let samples = first..record.time.len();
    let states = samples.clone().map(|k| [v[k], alpha[k], theta[k], q[k]]).collect();
    let rates = samples
        .map(|k| {
            // Specific force and gravity along the airspeed and across it, in the plane of symmetry.
            let (sin, cos) = alpha[k].sin_cos();
            let (gravity_along, gravity_across) = (theta[k] - alpha[k]).sin_cos();
            let along = ax[k] * cos + az[k] * sin - gravity * gravity_along;
            let across = az[k] * cos - ax[k] * sin + gravity * gravity_across;
            [along, q[k] + across / v[k], q[k], pitch_acceleration[k]]
        })
        .collect();
    Ok((states, rates))
}

/// The pitch acceleration that a law can be told: measured, or else true if q is known without error, or else the difference
/// of q from the last sample.
fn pitch_acceleration(flight: &Flight) -> Result<Vec<f64>, StudyError> {
    if let Some(measured) = flight.measured.channel("qdot") {
        return Ok(measured.values.clone());
    }
    let (measured, truth) = (values(&flight.measured, "q")?, values(&flight.truth, "q")?);
    if measured == truth {
        return Ok(values(&flight.truth, "qdot")?.to_vec());
    }
    let time = &flight.measured.time;
    let differences = measured.windows(2).zip(time.windows(2)).map(|(q, t)| (q[1] - q[0]) / (t[1] - t[0]));
    Ok(std::iter::once(0.0).chain(differences).collect())
}

fn values<'a>(record: &'a Record, name: &str) -> Result<&'a [f64], StudyError> {
    let channel = record.channel(name);
    channel
        .map(|channel| channel.values.as_slice())
        .ok_or_else(|| StudyError::Unsuitable(format!("{}: no channel `{name}`", record.source)))
}
