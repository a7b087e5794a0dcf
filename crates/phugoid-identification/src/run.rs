//! The estimator over the samples of a record, and what it said at each of them.

use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::smpe::{
    ChangeDetection, ChangePrior, DetectorReport, ParameterPrior, ProcessNoise, ReReaching, Smpe, SmpeSettings,
};
use phugoid_estimators::{ChangeState, DetectorState, Estimate, Estimator, ParameterStatus, Phase, Sample, Status};

use crate::axes::Axes;
use crate::error::EstimateError;
use crate::estimation::Event;
use crate::excitation::Excitation;
use crate::health::HealthOptions;
use crate::longitudinal::{LongitudinalInput, LongitudinalModel, OUTPUTS, STATES, row};
use crate::model_file::{Base, ModelFile, Parameter, Role};
use crate::monitor::{HealthRun, Monitoring};
use crate::noise::{NoiseLevel, measure_noise};
use crate::options::{CAPACITY, EstimateOptions};
use crate::prepare::Prepared;

/// Everything that one run gave, by sample and by column.
#[derive(Debug)]
pub(crate) struct Run {
    /// One per estimated parameter, in the order of the columns.
    pub(crate) columns: Vec<ColumnRun>,
    pub(crate) predicted: Vec<[f64; OUTPUTS]>,
    pub(crate) residuals: Vec<[f64; OUTPUTS]>,
    pub(crate) phases: Vec<Phase>,
    pub(crate) events: Vec<Event>,
    /// Of the parameters at the end, row and column as in `columns`.
    pub(crate) covariance: Vec<Vec<f64>>,
    /// At the end.
    pub(crate) status: Status,
    pub(crate) detector: Option<DetectorReport>,
    /// True if any motion was visible above the noise.
    pub(crate) excited: bool,
    /// What the health monitor said, if one was asked for.
    pub(crate) health: Option<HealthRun>,
}

/// What one run gave of one parameter.
#[derive(Clone, Debug)]
pub(crate) struct ColumnRun {
    /// By sample.
    pub(crate) values: Vec<f64>,
    /// By sample, corrected for the colour of the residuals.
    pub(crate) std_errors: Vec<f64>,
    /// By sample.
    pub(crate) surfaces: Vec<f64>,
    /// The rest: at the end.
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    pub(crate) corrected_std_error: f64,
    pub(crate) observability: f64,
    pub(crate) status: ParameterStatus,
    pub(crate) change_sensitivity: f64,
}

/// Rooms of the smaller estimators that are compiled in beside [`CAPACITY`]: unused room costs time in every update, and
/// an estimator that is full has loops of constant length (five parameters take 1.95 us in room for five and 2.57 us in
/// room for 24; benches/update.rs). Five is the longitudinal increments of a database; eleven those with six biases, or
/// a whole longitudinal build-up.
const SMALL_ROOM: usize = 5;
const MIDDLE_ROOM: usize = 11;

/// Runs the estimator in the smallest room that holds the model; the numbers do not depend on the room.
pub(crate) fn run_smpe(
    prepared: &Prepared,
    file: &ModelFile,
    options: &EstimateOptions,
    noise: &[NoiseLevel; OUTPUTS],
    health: Option<&HealthOptions>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run, EstimateError> {
    let run = match file.estimated().count() {
        0..=SMALL_ROOM => run_in_room::<SMALL_ROOM>,
        columns if columns <= MIDDLE_ROOM => run_in_room::<MIDDLE_ROOM>,
        _ => run_in_room::<CAPACITY>,
    };
    run(prepared, file, options, noise, health, progress)
}

fn run_in_room<const ROOM: usize>(
    prepared: &Prepared,
    file: &ModelFile,
    options: &EstimateOptions,
    noise: &[NoiseLevel; OUTPUTS],
    health: Option<&HealthOptions>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run, EstimateError> {
    let settings = smpe_settings(prepared, file, options, noise)?;
    let set_up = |e: phugoid_estimators::smpe::SmpeError| EstimateError::Model(e.to_string());
    let mut smpe: Smpe<LongitudinalModel, STATES, OUTPUTS, ROOM> =
        Smpe::new(prepared.model.clone(), settings).map_err(set_up)?;
    let samples = prepared.time.len();
    let mut monitoring: Option<Monitoring<ROOM>> = match health {
        Some(health) => Some(Monitoring::new(&prepared.model, file, &settings, health)?),
        None => None,
    };
    let blank = ColumnRun {
        values: Vec::with_capacity(samples),
        std_errors: Vec::with_capacity(samples),
        surfaces: Vec::with_capacity(samples),
        value: 0.0,
        std_error: 0.0,
        corrected_std_error: 0.0,
        observability: 0.0,
        status: ParameterStatus::NotExcited,
        change_sensitivity: 0.0,
    };
    let mut run = Run {
        columns: vec![blank; smpe.column_count()],
        predicted: Vec::with_capacity(samples),
        residuals: Vec::with_capacity(samples),
        phases: Vec::with_capacity(samples),
        events: Vec::new(),
        covariance: Vec::new(),
        status: Status::default(),
        detector: None,
        excited: false,
        health: None,
    };
    let mut last = smpe.estimate();
    // Until something has moved the prior is all that is known of single parameters: steady flight tells sums of terms.
    let mut waiting = true;
    let mut excitation = excitation(prepared, noise);
    let mut watch = Watch { gap_s: settings.maximum_step_s.max(3.5 * settings.sample_time_s), ..Watch::default() };
    for k in 0..samples {
        let sample = sample_at(prepared, k);
        let mut estimate = smpe.update(&sample);
        let moved = excitation.update(sample.time_s, sample.input.elevator, &sample.outputs);
        run.excited |= moved;
        if waiting && moved {
            waiting = false;
            run.events.retain(|e| !e.is_of_detector());
            let from = prepared.time.partition_point(|t| *t < sample.time_s - LEAD_S - 1e-9);
            // In absolute form the sums that steady flight tells are worth keeping.
            if from > 0 && file.base != Base::None {
                // Forget what was taken for excitation before there was any.
                smpe = Smpe::new(prepared.model.clone(), settings).map_err(set_up)?;
                for i in from..=k {
                    estimate = smpe.update(&sample_at(prepared, i));
                }
                watch.restarts = smpe.restarts();
            }
        }
        if waiting {
            estimate = unmoved(estimate, &settings, smpe.column_count(), smpe.prior_sd());
        }
        if let Some(monitoring) = &mut monitoring {
            monitoring.update(&sample, &estimate, &smpe);
        }
        watch.look(&estimate, sample.time_s, smpe.restarts(), &mut run.events);
        for (j, column) in run.columns.iter_mut().enumerate() {
            column.values.push(estimate.parameters[j]);
            column.std_errors.push(estimate.corrected_std_error[j]);
            column.surfaces.push(smpe.surfaces()[j]);
        }
        let started = estimate.status.phase != Phase::Starting;
        run.predicted.push(if started { smpe.innovations().predicted } else { [f64::NAN; OUTPUTS] });
        run.residuals.push(smpe.innovations().normalised);
        run.phases.push(estimate.status.phase);
        last = estimate;
        if k % 64 == 0 {
            progress(k as f64 / samples as f64);
        }
    }
    let mut covariance = [[0.0; ROOM]; ROOM];
    if waiting {
        run.events.retain(|e| !e.is_of_detector());
        for (j, sd) in smpe.prior_sd().iter().enumerate().take(smpe.column_count()) {
            covariance[j][j] = sd * sd;
        }
    } else {
        smpe.covariance(&mut covariance);
    }
    let columns = run.columns.len();
    run.covariance = covariance[..columns].iter().map(|row| row[..columns].to_vec()).collect();
    let sensitivity = smpe.change_sensitivity();
    for (j, column) in run.columns.iter_mut().enumerate() {
        column.value = last.parameters[j];
        column.std_error = last.std_error[j];
        column.corrected_std_error = last.corrected_std_error[j];
        column.observability = last.observability[j];
        column.status = last.parameter_status[j];
        column.change_sensitivity = sensitivity[j];
    }
    run.status = last.status;
    run.health = monitoring.map(Monitoring::finish);
    run.detector = smpe.detector();
    progress(1.0);
    Ok(run)
}

/// How far before the first visible motion the estimation of increments starts, s.
const LEAD_S: f64 = 1.0;

fn sample_at(prepared: &Prepared, k: usize) -> Sample<LongitudinalInput, OUTPUTS> {
    Sample { time_s: prepared.time[k], input: prepared.inputs[k], outputs: prepared.outputs[k] }
}

fn excitation(prepared: &Prepared, noise: &[NoiseLevel; OUTPUTS]) -> Excitation {
    let start: Vec<f64> = prepared.inputs.iter().take(prepared.noise_samples()).map(|u| u.elevator).collect();
    let elevator_noise = measure_noise(&start).filter(|n| !n.quantised).map_or(0.0, |n| n.std);
    Excitation::new(noise.map(|n| n.std), elevator_noise, prepared.inputs[0].elevator)
}

/// The estimate before anything has moved: the prior.
fn unmoved<const ROOM: usize>(
    estimate: Estimate<ROOM>,
    settings: &SmpeSettings<STATES, OUTPUTS, ROOM>,
    columns: usize,
    prior_sd: &[f64; ROOM],
) -> Estimate<ROOM> {
    let mut prior = Estimate {
        parameters: [0.0; ROOM],
        std_error: [0.0; ROOM],
        corrected_std_error: [0.0; ROOM],
        observability: [0.0; ROOM],
        parameter_status: [ParameterStatus::NotExcited; ROOM],
        ..estimate
    };
    prior.status.change = ChangeState::Steady;
    for j in 0..columns {
        // Bias columns start at zero, as the unused entries of the settings do.
        prior.parameters[j] = settings.priors[j].initial;
        prior.std_error[j] = prior_sd[j];
        prior.corrected_std_error[j] = prior_sd[j];
    }
    prior
}

/// Settings of the estimator for a prepared record: the automatic rule with what the model file says.
///
/// # Errors
/// [`EstimateError::Model`] if the estimator refuses them.
pub(crate) fn smpe_settings<const ROOM: usize>(
    prepared: &Prepared,
    file: &ModelFile,
    options: &EstimateOptions,
    noise: &[NoiseLevel; OUTPUTS],
) -> Result<SmpeSettings<STATES, OUTPUTS, ROOM>, EstimateError> {
    let own = file.estimated().filter(|p| !matches!(p.role, Role::Bias(_)));
    let tuned = &file.estimator;
    let priors: Vec<ParameterPrior> = own
        .map(|p| {
            let prior = prior(p, file.base);
            ParameterPrior { sd: prior.sd * if p.is_nuisance() { 1.0 } else { tuned.prior_scale }, ..prior }
        })
        .collect();
    let mut settings = SmpeSettings::automatic(&priors, noise.map(|n| n.std), sample_time(&prepared.time))
        .map_err(|e| EstimateError::Model(e.to_string()))?;
    // The input knows itself what is held (`LongitudinalInput::controls_held`).
    settings.input_hold = InputHold::Linear;
    let mut biases = [0.0; OUTPUTS];
    for parameter in file.estimated() {
        if let Role::Bias(output) = parameter.role
            && let Some(row) = Axes::Longitudinal.row(output)
        {
            biases[row] = parameter.prior_std;
        }
    }
    settings = settings.with_biases(biases);
    settings.reaching_limit = tuned.reaching_limit.unwrap_or(settings.reaching_limit);
    // A row has to reach before it is rejected.
    settings.rejection_limit = (tuned.rejection_scale * settings.rejection_limit).max(settings.reaching_limit);
    settings.start_window_s = tuned.start_window_s.unwrap_or(settings.start_window_s);
    let states = Axes::Longitudinal.states();
    let density = std::array::from_fn(|i| {
        states.get(i).map_or(0.0, |o| file.process_noise.density[o.index()] * tuned.process_noise_scale)
    });
    let gust_rows = std::array::from_fn(|i| i == row::TRUE_AIRSPEED || i == row::ALPHA);
    settings.process_noise = if file.process_noise.adaptive {
        ProcessNoise::adaptive(density, gust_rows)
    } else {
        ProcessNoise::fixed(density)
    };
    if let (true, Some(gain)) = (file.process_noise.adaptive, tuned.adaptation_gain) {
        settings.process_noise.adaptation_gain = gain;
    }
    settings.re_reaching = if options.re_reaching.unwrap_or(file.re_reaching) {
        ReReaching::Safe(ChangeDetection::default())
    } else {
        ReReaching::Off
    };
    Ok(settings)
}

fn prior(parameter: &Parameter, base: Base) -> ParameterPrior {
    let [lower, upper] = parameter.bounds.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let quarter = 0.25 * (upper - lower);
    let change_sd = match (parameter.change_std, base) {
        _ if parameter.is_nuisance() => ChangePrior::None,
        (Some(std), _) => ChangePrior::Fixed(std),
        (None, Base::F16) => ChangePrior::Fixed(quarter.min(parameter.prior_std)),
        // In absolute form a sudden change is of the order of half the parameter, not of the start prior.
        (None, Base::None) => ChangePrior::Relative { fraction: 0.5, maximum: quarter },
    };
    ParameterPrior { initial: parameter.start, sd: parameter.prior_std, lower, upper, change_sd }
}

/// Median of the first fifty intervals, s: later ones must not change what was estimated before them.
fn sample_time(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).take(50).map(|w| w[1] - w[0]).collect();
    crate::noise::median(&mut steps).unwrap_or(f64::NAN)
}

impl Event {
    /// True for what the change detector said; before anything has moved it had nothing to speak of.
    fn is_of_detector(&self) -> bool {
        matches!(self.kind.as_str(), "in_doubt" | "re_reached" | "doubt_dropped" | "insensitive")
    }
}

/// Turns changes of the status into events.
#[derive(Default)]
struct Watch {
    gap_s: f64,
    last_s: Option<f64>,
    restarts: u32,
    in_doubt: bool,
    insensitive: bool,
}

impl Watch {
    fn look<const ROOM: usize>(
        &mut self,
        estimate: &Estimate<ROOM>,
        time_s: f64,
        restarts: u32,
        events: &mut Vec<Event>,
    ) {
        let mut say = |kind: &str, message: String| events.push(Event { time_s, kind: kind.to_owned(), message });
        if let Some(last) = self.last_s
            && time_s - last > self.gap_s
        {
            say("gap", format!("no sample for {:.3} s before this one", time_s - last));
        }
        self.last_s = Some(time_s);
        if restarts > self.restarts {
            say("restarted", "the state was started again from the measurements; the parameters were kept".to_owned());
        }
        self.restarts = restarts;
        let in_doubt = estimate.status.change == ChangeState::InDoubt;
        match estimate.status.change {
            ChangeState::ReReached => say(
                "re_reached",
                "the parameters changed: a challenger that allows for it explains the new data better, and was adopted"
                    .to_owned(),
            ),
            ChangeState::InDoubt if !self.in_doubt => say(
                "in_doubt",
                "a change of the parameters is suspected: bounds are widened until it is decided".to_owned(),
            ),
            ChangeState::Steady if self.in_doubt => {
                say("doubt_dropped", "the suspicion was dropped: the estimate was right all along".to_owned());
            }
            _ => {}
        }
        self.in_doubt = in_doubt;
        let insensitive = estimate.status.detector == DetectorState::Insensitive;
        if insensitive && !self.insensitive {
            say(
                "insensitive",
                "model error: this model's parameters wander so much without any change that only large changes can be \
                 told from it"
                    .to_owned(),
            );
        }
        self.insensitive = insensitive;
    }
}

/// The word for a parameter's status.
pub(crate) fn status_word(status: ParameterStatus) -> &'static str {
    match status {
        ParameterStatus::NotExcited => "not_excited",
        ParameterStatus::Improving => "improving",
        ParameterStatus::Converged => "converged",
        ParameterStatus::AtLimit => "at_limit",
    }
}

/// The word for a phase.
pub(crate) fn phase_word(phase: Phase) -> &'static str {
    match phase {
        Phase::Starting => "starting",
        Phase::Sliding => "sliding",
        Phase::Reaching => "reaching",
        Phase::Rejected => "rejected",
        Phase::Predicting => "predicting",
        Phase::Diverged => "diverged",
    }
}

#[cfg(test)]
mod tests;
