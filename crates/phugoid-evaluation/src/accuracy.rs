//! Accuracy study: many flights of one scenario, each with its own sensor noise. The errors of the estimates and the
//! standard errors that they claim are compared with the Cramer-Rao bound.

use phugoid_identification::axes::Axes;
use phugoid_identification::estimate::{CAPACITY, EstimateError, EstimateOptions, capacity, estimate};
use phugoid_identification::estimation::{Estimation, EventKind};
use phugoid_identification::lateral::LateralModel;
use phugoid_identification::longitudinal::LongitudinalModel;
use phugoid_identification::model_file::{InputHold, ModelFile, Parameter, Role};
use phugoid_identification::motion::{Motion, MotionModel};
use phugoid_identification::output::Output;
use phugoid_identification::prepare::{Prepared, prepare};
use phugoid_identification::six::SixModel;
use serde::{Deserialize, Serialize};

use crate::cramer_rao::{Between, Bound, CramerRaoError, Experiment, Knowledge};
use crate::ledger::{Ledger, LedgerError, recorded};
use crate::monte_carlo::{Accuracy, Outcome};
use phugoid_simulation::flight::{Flight, FlightError, fly, sense};
use phugoid_simulation::scenario::Scenario;
use phugoid_simulation::sensing::specification;

/// Room for parameters of the longitudinal motion in the bound; the model's own count decides how many are used.
const LONGITUDINAL_CAPACITY: usize = capacity(Axes::Longitudinal);

/// Accuracy at one time of the flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checkpoint {
    /// Time of the checkpoint from the start of the record, s.
    pub time_s: f64,
    /// Parameters in the model's order.
    pub parameters: Vec<Accuracy>,
}

/// Result of an accuracy study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AccuracyStudy {
    /// Name of the scenario that was flown.
    pub scenario: String,
    /// Name of the model file.
    pub model: String,
    /// Name of the estimator.
    pub method: String,
    /// Number of runs; run `i` has the scenario's seed plus `i`.
    pub runs: usize,
    /// Accuracy at each time asked for.
    pub checkpoints: Vec<Checkpoint>,
    /// Runs in which a sudden change was believed to have happened.
    pub runs_with_changes: usize,
}

/// Why a study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The scenario could not be flown.
    #[error(transparent)]
    Flight(#[from] FlightError),
    /// The flight could not be estimated with the model file.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The Cramer-Rao bound could not be computed.
    #[error("Cramer-Rao bound: {0}")]
    CramerRao(#[from] CramerRaoError),
    /// The study does not fit the model.
    #[error("{0}")]
    Unsuitable(String),
    /// What is kept of the study cannot be read or written.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
}

impl StudyError {
    /// Something that does not fit, in its own words.
    pub fn unsuitable(error: impl std::fmt::Display) -> Self {
        Self::Unsuitable(error.to_string())
    }
}

/// Flies `scenario` once, measures it `runs` times and estimates each measured flight with `model` and `options` (whose
/// truth is the flight's); compares with the truth and the Cramer-Rao bound at the times `at` (s). `ledger` is told of each run, from any
/// thread, and may keep its estimates; it has to know the scenario and the model.
///
/// # Errors
/// [`StudyError`]: the scenario cannot be flown, the model does not fit it, the bound does not exist.
pub fn accuracy(
    scenario: &Scenario,
    model: &ModelFile,
    options: &EstimateOptions,
    runs: usize,
    at: &[f64],
    ledger: &dyn Ledger,
) -> Result<AccuracyStudy, StudyError> {
    let flight = fly(scenario)?;
    let bounds = bound(&flight, model, at)?;
    let options = EstimateOptions { truth: flight.true_parameters.clone(), ..options.clone() };
    let seed = |run: usize| scenario.seed.wrapping_add(run as u64);
    let results = recorded(
        runs,
        &format!("accuracy at {at:?} s, {options:?}"),
        |run| format!("seed {}", seed(run)),
        |run| {
            let measured = sense(&flight.truth, scenario, seed(run))?;
            let estimation = estimate(&measured, model, &options, &mut |_| {})?;
            let adopted = estimation.events.iter().any(|e| e.kind == EventKind::Adopted);
            Ok::<_, StudyError>(Run { outcomes: outcomes(&estimation, at), adopted })
        },
        ledger,
    )?;
    let names: Vec<&str> = model.estimated().map(|p| p.name.as_str()).collect();
    let checkpoints = bounds
        .iter()
        .enumerate()
        .map(|(k, bound)| Checkpoint {
            time_s: bound.time_s,
            parameters: bound
                .std_error
                .iter()
                .zip(&names)
                .enumerate()
                .map(|(j, (cramer_rao, name))| {
                    let outcomes: Vec<Outcome> =
                        results.iter().filter_map(|run| run.outcomes.get(k)?.get(j)).copied().collect();
                    let truth = flight.true_parameters.get(*name).copied().unwrap_or(0.0);
                    Accuracy::of(name, truth, *cramer_rao, &outcomes)
                })
                .collect(),
        })
        .collect();
    Ok(AccuracyStudy {
        scenario: scenario.name.clone(),
        model: model.name.clone(),
        method: options.method.unwrap_or(model.estimator.method).to_string(),
        runs,
        checkpoints,
        runs_with_changes: results.iter().filter(|run| run.adopted).count(),
    })
}

/// What one run says.
#[derive(Serialize, Deserialize)]
struct Run {
    /// By time and parameter.
    outcomes: Vec<Vec<Outcome>>,
    /// Whether a sudden change was believed to have happened.
    adopted: bool,
}

/// Estimates at the last sample not after each of the times `at` (s), in the order of the parameters.
fn outcomes(estimation: &Estimation, at: &[f64]) -> Vec<Vec<Outcome>> {
    let time = &estimation.history.time_s;
    at.iter()
        .map(|&t| {
            let k = time.partition_point(|&s| s <= t + 1e-9).saturating_sub(1);
            let value = |values: &[f64]| values.get(k).copied().unwrap_or(f64::NAN);
            estimation
                .history
                .parameters
                .iter()
                .map(|p| Outcome { value: value(&p.value), corrected_std_error: value(&p.std_error) })
                .collect()
        })
        .collect()
}

/// The Cramer-Rao bound of a model's parameters on a flight, at each of the times `at` (s).
///
/// The noise is what the model file gives; the initial states are unknown, nothing is known of the parameters beforehand,
/// and there is no process noise.
///
/// # Errors
/// [`StudyError`]: the model needs a channel that the flight has not, sensor biases are asked for, no bound exists.
pub fn bound(flight: &Flight, model: &ModelFile, at: &[f64]) -> Result<Vec<Bound>, StudyError> {
    if model.estimated().any(|p| matches!(p.role, Role::Bias(_))) {
        let message = "sensor biases have no place in this bound: leave [biases] out";
        return Err(StudyError::Unsuitable(format!("model `{}`: {message}", model.source)));
    }
    bound_with_noise(flight, model, &|_| None, at)
}

/// As [`bound`], with the sensor biases of the model file, of which their priors are known, and with the noise (one sigma,
/// SI) of outputs for which the model file gives none.
///
/// # Errors
/// As [`bound`], but for the biases.
pub fn bound_with_noise(
    flight: &Flight,
    model: &ModelFile,
    noise: &dyn Fn(Output) -> Option<f64>,
    at: &[f64],
) -> Result<Vec<Bound>, StudyError> {
    match model.axes {
        Axes::Longitudinal => {
            Asked::<LongitudinalModel, _, _>::new(flight, model, noise)?.bound::<LONGITUDINAL_CAPACITY>(at)
        }
        Axes::LateralDirectional => Asked::<LateralModel, _, _>::new(flight, model, noise)?.bound::<CAPACITY>(at),
        Axes::All => Asked::<SixModel, _, _>::new(flight, model, noise)?.bound::<CAPACITY>(at),
    }
}

/// As [`bound`], with what the model file expects of sensor biases and offsets, and with the noise that there really is: that of the
/// scenario's sensors, and of a sensor without noise what the model file says. Where the aircraft is damaged in flight, from the
/// samples since the last damage.
///
/// # Errors
/// As [`bound`], but for the biases.
pub fn bound_of_flight(flight: &Flight, model: &ModelFile, at: &[f64]) -> Result<Vec<Bound>, StudyError> {
    let mut model = model.clone();
    for (output, noise) in Output::ALL.iter().zip(model.noise.iter_mut()) {
        let sensor = specification(&flight.scenario.sensors, output.name());
        if let Some(sensor) = sensor.filter(|sensor| sensor.noise > 0.0) {
            *noise = Some(sensor.noise);
        }
    }
    let Some(since) = flight.scenario.damage.last().map(|damage| damage.at.si()) else {
        return bound_with_noise(flight, &model, &|_| None, at);
    };
    let mut part = flight.clone();
    let first = part.truth.time.partition_point(|t| *t < since - 1e-9);
    part.truth.time.drain(..first);
    for channel in &mut part.truth.channels {
        channel.values.drain(..first);
    }
    bound_with_noise(&part, &model, &|_| None, at)
}

/// The parameters of a model in the order of [`Bound::std_error`]: terms and offsets, then biases.
pub fn in_order_of_bound(model: &ModelFile) -> Vec<&Parameter> {
    let is_bias = |p: &&Parameter| matches!(p.role, Role::Bias(_));
    model.estimated().filter(|p| !is_bias(p)).chain(model.estimated().filter(is_bias)).collect()
}

/// The flight, the sensors and the parameters that a bound is asked for.
struct Asked<M: Motion<N, R>, const N: usize, const R: usize> {
    source: String,
    prepared: Prepared<M, N, R>,
    initial_state: [f64; N],
    /// True values of the model's parameters.
    parameters: Vec<f64>,
    /// What is known of each beforehand, standard deviation in its unit; infinite for nothing.
    prior_std: Vec<f64>,
    noise_std: [f64; R],
    bias_std: [f64; R],
    between: Between,
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Asked<M, N, R> {
    fn new(flight: &Flight, model: &ModelFile, noise: &dyn Fn(Output) -> Option<f64>) -> Result<Self, StudyError> {
        let prepared = prepare::<M, N, R>(&flight.truth, model)?;
        let (mut parameters, mut prior_std) = (Vec::new(), Vec::new());
        let mut bias_std = [0.0; R];
        for parameter in model.estimated() {
            if let Role::Bias(output) = parameter.role {
                if let Some(row) = M::AXES.row(output) {
                    bias_std[row] = parameter.prior_std;
                }
                continue;
            }
            let known = flight.true_parameters.get(&parameter.name).copied();
            let Some(truth) = known.or(parameter.is_nuisance().then_some(0.0)) else {
                let what = format!(
                    "the true value of `{}` is not known: the scenario flies another aircraft. Take a scenario that flies the \
                     aircraft of the model ([aircraft] file = \"...\" in place of `type`, with its speed and altitude), whose \
                     `start` values are then the truth; phugoid simulate f16-calm --show prints one to begin with",
                    parameter.name
                );
                return Err(unsuitable(&model.source, &what));
            };
            parameters.push(truth);
            prior_std.push(if parameter.is_nuisance() { parameter.prior_std } else { f64::INFINITY });
        }
        let mut noise_std = [f64::INFINITY; R];
        for (row, output) in M::AXES.outputs().iter().enumerate().filter(|(_, o)| model.outputs[o.index()]) {
            let given = model.noise[output.index()].or_else(|| noise(*output));
            noise_std[row] = given.ok_or_else(|| {
                let what = format!("the noise of `{}` is needed: give it under [noise]", output.name());
                unsuitable(&model.source, &what)
            })?;
        }
        // A state need not be measured: its true value is in the flight.
        let mut initial_state = [f64::NAN; N];
        for (value, state) in initial_state.iter_mut().zip(M::AXES.states()) {
            let truth = flight.truth.channel(state.name()).and_then(|c| c.values.get(prepared.first));
            *value = truth.copied().unwrap_or(f64::NAN);
        }
        let between = match (prepared.hold, M::AXES) {
            (InputHold::Held, Axes::Longitudinal) => Between::Held,
            // The input knows itself what is held; a measured motion that is an input runs on between the samples.
            _ => Between::Interpolated,
        };
        let source = model.source.clone();
        Ok(Self { source, prepared, initial_state, parameters, prior_std, noise_std, bias_std, between })
    }

    /// The bound, computed with room for `P` parameters.
    fn bound<const P: usize>(&self, at: &[f64]) -> Result<Vec<Bound>, StudyError>
    where
        M: MotionModel<N, R, P>,
    {
        let count = self.parameters.len();
        if count > P {
            return Err(unsuitable(&self.source, &format!("there is room for {P} parameters")));
        }
        let mut parameters = [0.0; P];
        parameters[..count].copy_from_slice(&self.parameters);
        let mut knowledge = Knowledge::<R, P>::of_noise(self.noise_std);
        knowledge.bias_std = self.bias_std;
        knowledge.prior_std[..count].copy_from_slice(&self.prior_std);
        let experiment = Experiment {
            initial_state: self.initial_state,
            parameters,
            time_s: &self.prepared.time,
            inputs: &self.prepared.inputs,
            between: self.between,
        };
        Ok(experiment.bound(&self.prepared.model, &knowledge, at)?)
    }
}

fn unsuitable(source: &str, what: &str) -> StudyError {
    StudyError::Unsuitable(format!("model `{source}`: {what}"))
}
