//! Runs a batch method over a record, and puts its result into the form of a causal run.

use std::ops::Range;

use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::{ParameterStatus, Phase, Status};
use phugoid_flight_data::record::Record;

use super::air_data::{WithAirData, with_air_data};
use super::constants::systematic;
use super::readiness::ColumnVerdict;
use super::settings::{sample_time, shared_settings};
use super::task::{BySurfaces, ColumnRun, Run, Task};
use crate::batch::{
    self, BatchError, BatchFit, BatchParameter, Bias, Equation, EquationErrorSettings, InitialState, Manoeuvre,
    ManoeuvreFit, Noise, OptimiserSettings, OutputChannel, ProcessNoise, Structure, Unknown, UnknownKind, with_outputs,
};
use crate::core::error::EstimateError;
use crate::core::estimation::{BatchReport, OtherValue, Prediction, PredictionInterval, SecondAnswer, Signal};
use crate::core::method::Method;
use crate::core::options::{Band, CAPACITY};
use crate::core::systematic::SystematicPart;
use crate::model_file::{ByPowers, Parameter, Role};
use crate::motion::MotionModel;
use crate::preparation::air_data::smoothed;
use crate::preparation::excitation::Excitation;
use crate::preparation::prepare::prepare;
use crate::preparation::prepared::Prepared;

/// One sigma over what was known beforehand below which a parameter counts as known, and the observability below which
/// it counts as not excited: the same as for the causal methods.
const CONVERGED: f64 = 0.1;
const EXCITED: f64 = 0.5;

/// Runs a batch method on the record of the task and on the further records of its options, and predicts another record
/// if the options name one.
pub(super) fn run_batch<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let Task { prepared, file, options, health, .. } = *task;
    let method = task.method();
    if health.is_some() {
        return Err(EstimateError::MonitorNeedsCausal { method });
    }
    if !excited::<M, N, R>(task) {
        let [movers, manoeuvre] = M::AXES.excitation_words();
        return Err(EstimateError::NoExcitation { method, movers, manoeuvre });
    }
    progress(0.0);
    let further = prepare_all::<M, N, R>(task, &options.further)?;
    let manoeuvres: Vec<Manoeuvre<'_, N, R>> = std::iter::once(manoeuvre::<M, N, R>("the record", prepared))
        .chain(
            options
                .further
                .iter()
                .zip(&further)
                .map(|(record, prepared)| manoeuvre::<M, N, R>(&record.source, prepared)),
        )
        .collect();
    let structure = structure::<M, N, R>(task)?;
    let regression = EquationErrorSettings::automatic(sample_time(&prepared.time));
    let band = if method.is_in_band() { Some(band::<M, N, R>(task, structure.maximum_gap_s)?) } else { None };
    let Solved { mut fit, equations, second_answer, no_second_answer, structure, flown } =
        solve::<M, N, R>(task, (&manoeuvres, &further), structure, (&regression, band))?;
    let measured_angles = flown.is_some();
    let manoeuvres = match &flown {
        Some(flown) => with_outputs(&manoeuvres, flown),
        None => manoeuvres,
    };
    let systematic = match task.follows_constants() {
        true => systematic::<M, N, R>(task, &manoeuvres, &structure, (&regression, band), &fit),
        false => None,
    };
    if task.follows_constants() && systematic.is_none() {
        fit.notes.push(
            "what errors of the declared constants do to the estimate could not be worked out, because a simulation, a \
             filter or a regression with one of them off by its uncertainty has no answer: the bounds hold the powers of the scales, and \
             nothing of lags, timing, accelerometers, centre of gravity and thrust"
                .to_owned(),
        );
    }
    let prediction = match &options.predict {
        Some(record) => Some(predict::<M, N, R>(task, record, &structure, &fit)?),
        None => None,
    };
    let Some(own) = fit.manoeuvres.first() else {
        return Err(EstimateError::Model("the batch method gave no fit of the record".to_owned()));
    };
    let run = Run {
        columns: file
            .estimated()
            .zip(prepared.by_powers(file))
            .map(|(p, by_powers)| {
                let place = structure.parameters.iter().position(|own| own.name == p.name);
                let followed = systematic.as_ref().zip(place).and_then(|(all, place)| all.of(place));
                column::<M, N, R>(p, &fit, followed, &by_powers, task)
            })
            .collect(),
        predicted: rows(&own.fitted),
        residuals: rows(&own.residuals),
        log_density: Vec::new(),
        phases: own.residuals.iter().map(|e| phase(e)).collect(),
        consistency: Vec::new(),
        events: Vec::new(),
        covariance: covariance::<M, N, R>(task, &fit),
        status: Status::default(),
        detector: None,
        changes: Vec::new(),
        noise: None,
        excited: true,
        health: None,
        batch: Some(report(&fit, measured_angles, equations, prediction)),
        third_answer: None,
        by_surfaces: BySurfaces::default(),
        second_answer,
        no_second_answer,
        disputed: None,
        begun_again: None,
        said_of_base: None,
        follows_constants: systematic.is_some(),
        learnt: Vec::new(),
    };
    progress(1.0);
    Ok(run)
}

fn prepare_all<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    records: &[Record],
) -> Result<Vec<Prepared<M, N, R>>, EstimateError> {
    records.iter().map(|record| prepare(record, task.file)).collect()
}

pub(crate) fn manoeuvre<'a, M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    name: &'a str,
    prepared: &'a Prepared<M, N, R>,
) -> Manoeuvre<'a, N, R> {
    Manoeuvre {
        name,
        plant: prepared,
        first: 0,
        time_s: &prepared.time,
        // The input of the model says itself whether it is held between samples.
        hold: InputHold::Linear,
        outputs: &prepared.outputs,
        initial_state: None,
    }
}

/// What is unknown, from the model file: parameters inside their bounds and without priors (the likelihood decides),
/// sensor biases with theirs and for each record anew, initial states free at the start and after gaps.
///
/// Output error and equation error estimate the noise, as their residuals hold turbulence and model error too. Filter
/// error has the process noise for those, and takes the file's noise levels where it gives any: the data hardly
/// determine both together.
pub(super) fn structure<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
) -> Result<Structure<N, R>, EstimateError> {
    let Task { prepared, file, options, noise, .. } = *task;
    let [lowest, highest] = [f64::NEG_INFINITY, f64::INFINITY];
    let parameters = file.estimated().filter(|p| !matches!(p.role, Role::Bias(_)));
    let parameters = parameters.map(|p| {
        let [lower, upper] = p.bounds.unwrap_or([lowest, highest]);
        let prior_std = (p.is_nuisance() && p.prior_std.is_finite()).then_some(p.prior_std);
        BatchParameter { prior_std, lower, upper, ..BatchParameter::free(p.name.as_str(), p.start) }
    });
    let bias = |row: usize| {
        let of = |p: &&Parameter| matches!(p.role, Role::Bias(output) if M::AXES.row(output) == Some(row));
        file.estimated().find(of).map_or(Bias::None, |p| match options.further.as_slice() {
            [] => Bias::Shared(p.prior_std),
            _ => Bias::PerManoeuvre(p.prior_std),
        })
    };
    let names = M::AXES.outputs();
    let outputs = std::array::from_fn(|row| OutputChannel {
        name: names[row].name().to_owned(),
        noise: match (task.method(), noise[row].measured) {
            (Method::FilterError, false) => Noise::Known(noise[row].std),
            _ => Noise::Estimated,
        },
        bias: bias(row),
    });
    let settings = shared_settings::<M, N, R, CAPACITY>(prepared, file, options, noise)?;
    Ok(Structure {
        parameters: parameters.collect(),
        states: std::array::from_fn(|i| InitialState::free(names[i].name())),
        outputs,
        maximum_step_s: settings.maximum_step_s,
        maximum_gap_s: settings.maximum_gap_s,
        likelihood: options.likelihood,
    })
}

/// The parameters by equation error from these samples of the task's record alone.
///
/// # Errors
/// Why the equations give no answer.
pub(super) fn equations_of<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    samples: Range<usize>,
) -> Result<Vec<OtherValue>, EstimateError> {
    let prepared = task.prepared;
    let part = manoeuvre::<M, N, R>("the record", prepared).part(samples);
    let settings = EquationErrorSettings::automatic(sample_time(&prepared.time));
    Ok(others(&batch::equation_error(&[part], &structure::<M, N, R>(task)?, &settings)?.fit))
}

/// The parameters from what the surfaces explain of the motion in these samples of the task's record, and by equation error.
///
/// # Errors
/// Why the equations give no answer.
pub(super) fn surfaces_of<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    samples: Range<usize>,
) -> Result<[Vec<OtherValue>; 2], EstimateError> {
    let prepared = task.prepared;
    let part = [manoeuvre::<M, N, R>("the record", prepared).part(samples.clone())];
    let settings = EquationErrorSettings::automatic(sample_time(&prepared.time));
    let structure = structure::<M, N, R>(task)?;
    let found = batch::equation_error(&part, &structure, &settings)?.fit;
    let surfaces = [prepared.surfaces().map(|signal| &signal.values[samples.clone()]).collect()];
    let unknowns = batch::by_surfaces(&part, &surfaces, &structure, &settings, &found)?;
    let regression = others(&found);
    Ok([others(&BatchFit { unknowns, ..found }), regression])
}

struct Solved<const N: usize, const R: usize> {
    fit: BatchFit,
    /// What was unknown in the end.
    structure: Structure<N, R>,
    /// The outputs by manoeuvre and sample if airspeed and flow angles were taken as measured.
    flown: Option<Vec<Vec<[f64; R]>>>,
    /// Of equation error.
    equations: Vec<Equation>,
    /// By equation error, of the other methods.
    second_answer: Option<SecondAnswer>,
    no_second_answer: Option<String>,
}

fn solve<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    (manoeuvres, further): (&[Manoeuvre<'_, N, R>], &[Prepared<M, N, R>]),
    structure: Structure<N, R>,
    (regression, band): (&EquationErrorSettings, Option<Band>),
) -> Result<Solved<N, R>, EstimateError> {
    let method = task.method();
    let by_sample = || batch::equation_error(manoeuvres, &structure, regression);
    let equations = || match band {
        Some(band) => batch::equation_error_frequency(manoeuvres, &structure, band, regression),
        None => by_sample(),
    };
    // Differences give the likelihood of a filter, and an evaluation takes a tenth of a second: a fiftieth of a standard
    // error is enough.
    let step_tolerance = if method == Method::FilterError { 0.02 } else { 1e-3 };
    let search = OptimiserSettings { step_tolerance, ..OptimiserSettings::default() };
    let integrating = |manoeuvres: &[Manoeuvre<'_, N, R>], structure: &Structure<N, R>| match method {
        Method::FilterError => {
            let settings = shared_settings::<M, N, R, CAPACITY>(task.prepared, task.file, task.options, task.noise)
                .map_err(|e| BatchError::BadInput(e.to_string()))?;
            let process = ProcessNoise { density: settings.process_noise.variance_per_s, estimated: true };
            batch::filter_error(manoeuvres, structure, &process, &search)
        }
        _ => match band {
            Some(band) => batch::output_error_frequency(manoeuvres, structure, band, &search),
            None => batch::output_error(manoeuvres, structure, &search),
        },
    };
    if method.is_equation_error() {
        let found = equations()?;
        return Ok(Solved {
            fit: found.fit,
            structure,
            flown: None,
            equations: found.equations,
            second_answer: None,
            no_second_answer: None,
        });
    }
    // The values of the model file may lie beyond another minimum than the best one; those of the regression need no
    // start themselves and are biased by noise only.
    let (regressed, no_second_answer) = match equations() {
        Ok(found) => (Some(found), None),
        Err(error) => (None, Some(error.to_string())),
    };
    let by = if band.is_some() { Method::EquationErrorFrequency } else { Method::EquationError };
    let second_answer = regressed.as_ref().map(|found| SecondAnswer { method: by, values: others(&found.fit) });
    // A simulation needs constants too, which a band does not give.
    let regressed = if band.is_some() { by_sample().ok() } else { regressed };
    let cost = |fit: &BatchFit| fit.iterations.last().map_or(f64::INFINITY, |i| i.cost);
    let searched = |manoeuvres: &[Manoeuvre<'_, N, R>], structure: &Structure<N, R>| -> Result<BatchFit, BatchError> {
        let nearer = regressed.as_ref().map(|found| {
            let mut nearer = structure.clone();
            for (parameter, value) in nearer.parameters.iter_mut().zip(&found.fit.parameters) {
                parameter.start = value.clamp(parameter.lower, parameter.upper);
            }
            nearer
        });
        match (method, nearer) {
            (_, None) => integrating(manoeuvres, structure),
            // One search takes seconds, and one that starts from the regression cannot end above it.
            (Method::FilterError, Some(nearer)) => integrating(manoeuvres, &nearer).or_else(|failure| match failure {
                BatchError::BadInput(_) | BatchError::Singular { .. } => Err(failure),
                _ => integrating(manoeuvres, structure),
            }),
            (_, Some(nearer)) => match (integrating(manoeuvres, structure), integrating(manoeuvres, &nearer)) {
                (Ok(fit), Ok(other)) if cost(&other) < cost(&fit) - NOTICEABLE => Ok(noted(
                    other,
                    "a lower minimum was found from the values of equation error than from those of the model file",
                )),
                (Ok(fit), _) => Ok(fit),
                (Err(failure), Err(_)) => Err(failure),
                // A start helps against a search that loses itself, not where the data do not determine the parameters.
                (Err(failure @ (BatchError::BadInput(_) | BatchError::Singular { .. })), _) => Err(failure),
                (Err(_), Ok(fit)) => Ok(noted(
                    fit,
                    "from the start values of the model file no minimum was found: started from equation error",
                )),
            },
        }
    };
    let (fit, structure, flown) = match method {
        Method::OutputError => {
            let WithAirData { fit, structure, flown } =
                with_air_data::<M, N, R>(task, (manoeuvres, further), structure, searched)?;
            (fit, structure, flown)
        }
        _ => (searched(manoeuvres, &structure)?, structure, None),
    };
    Ok(Solved { fit, structure, flown, equations: Vec::new(), second_answer, no_second_answer })
}

/// The band that is asked for, or in which the record tells something.
fn band<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    maximum_gap_s: f64,
) -> Result<Band, EstimateError> {
    if let Some(band) = task.options.band {
        return Ok(band);
    }
    let prepared = task.prepared;
    let extra = |signal: &&Signal| task.file.extra_inputs.contains(&signal.name);
    let inputs = prepared.surfaces().chain(prepared.known.iter().filter(extra)).map(|s| s.values.as_slice());
    let outputs: Vec<Vec<f64>> = (0..R).map(|i| prepared.outputs.iter().map(|y| y[i]).collect()).collect();
    let found = batch::signal_band(&prepared.time, maximum_gap_s, &inputs.collect::<Vec<_>>(), &outputs);
    found.ok_or_else(|| {
        EstimateError::Model(
            "no band of frequencies was found in which both a control surface and an output move: the record has too few \
             samples between two gaps, or nothing moves beyond its noise. Give the band (LOW:HIGH in Hz), or take a method \
             in the time domain"
                .to_owned(),
        )
    })
}

fn others(fit: &BatchFit) -> Vec<OtherValue> {
    let parameters = fit.unknowns.iter().filter(|u| {
        matches!(u.kind, UnknownKind::Parameter { .. }) && !u.at_limit && u.corrected_std_error.is_finite()
    });
    let other = |u: &Unknown| OtherValue { name: u.name.clone(), value: u.value, std_error: u.corrected_std_error };
    parameters.map(other).collect()
}

/// Difference of two costs, in units of the logarithm of the likelihood, from which two minima are not the same one: the
/// searches end within a thousandth of a standard error of theirs.
const NOTICEABLE: f64 = 1e-2;

fn noted(mut fit: BatchFit, note: &str) -> BatchFit {
    fit.notes.push(note.to_owned());
    fit
}

/// Predicts a record that was not used for the estimation.
fn predict<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    record: &Record,
    structure: &Structure<N, R>,
    fit: &BatchFit,
) -> Result<Prediction, EstimateError> {
    let prepared: Prepared<M, N, R> = prepare(record, task.file)?;
    let mut manoeuvre = [manoeuvre::<M, N, R>(&record.source, &prepared)];
    let air_data = match structure.states.iter().any(|state| state.measured) {
        true => smoothed(&prepared, task.file.aircraft.gravity, structure.maximum_gap_s),
        false => None,
    };
    if let Some(air_data) = &air_data {
        manoeuvre[0].outputs = &air_data.outputs;
    }
    let mut held = structure.clone();
    for channel in &mut held.outputs {
        channel.noise = Noise::Estimated;
    }
    let search = OptimiserSettings::default();
    let predicted = batch::predict(&manoeuvre, &held, &fit.parameters, &search)?;
    // Equation error knows the noise of its equations, and none of the outputs.
    let sigmas = match task.method() {
        method if method.is_equation_error() => None,
        _ => Some(batch::prediction_intervals(&manoeuvre, &held, fit, &predicted)?),
    };
    let Some(ManoeuvreFit { fitted, outputs, .. }) = predicted.manoeuvres.into_iter().next() else {
        return Err(EstimateError::Model("the prediction gave no fit".to_owned()));
    };
    let measured = M::AXES.outputs().iter().enumerate().filter(|(_, o)| task.file.outputs[o.index()]);
    let signals = |values: &dyn Fn(usize, usize) -> f64| -> Vec<Signal> {
        let of = |row: usize| (0..prepared.time.len()).map(|k| values(k, row)).collect();
        let signal = |(row, o): (usize, &crate::core::output::Output)| Signal {
            name: o.name().to_owned(),
            unit: o.unit().to_owned(),
            values: of(row),
        };
        measured.clone().map(signal).collect()
    };
    let interval = |sigmas: &[[f64; R]], row: usize, name: &str| {
        let std_error: Vec<f64> = sigmas.iter().map(|s| s[row]).collect();
        let away =
            prepared.outputs.iter().zip(&fitted).zip(&std_error).map(|((y, z), s)| ((y[row] - z[row]) / s).abs());
        let (count, within) = away
            .filter(|away| away.is_finite())
            .fold((0.0, 0.0), |(count, within), away| (count + 1.0, within + f64::from(away <= 2.0)));
        PredictionInterval { name: name.to_owned(), std_error, within: within / count }
    };
    let intervals = sigmas
        .as_ref()
        .and_then(|all| all.first())
        .map_or(Vec::new(), |sigmas| measured.clone().map(|(row, o)| interval(sigmas, row, o.name())).collect());
    Ok(Prediction {
        intervals,
        source: record.source.clone(),
        fit: outputs,
        measured: signals(&|k, row| prepared.outputs[k][row]),
        predicted: signals(&|k, row| fitted[k][row]),
        time_s: prepared.time.clone(),
    })
}

/// The unknown that stands for a parameter of the file; none where the method does not estimate it.
fn position<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    parameter: &Parameter,
    fit: &BatchFit,
) -> Option<usize> {
    let found = fit.unknowns.iter().position(|u| match (u.kind, &parameter.role) {
        (UnknownKind::Bias { output, .. }, Role::Bias(of)) => M::AXES.row(*of) == Some(output),
        (UnknownKind::Parameter { .. }, Role::Bias(_)) => false,
        (UnknownKind::Parameter { .. }, _) => u.name == parameter.name,
        _ => false,
    });
    // One that the band does not determine is none.
    found.filter(|&i| fit.unknowns[i].corrected_std_error.is_finite())
}

fn column<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    parameter: &Parameter,
    fit: &BatchFit,
    followed: Option<(f64, Vec<SystematicPart>)>,
    by_powers: &ByPowers,
    task: &Task<M, N, R>,
) -> ColumnRun {
    // What the method does not estimate, such as a bias in a band of frequencies, keeps its prior.
    let prior = (parameter.start, parameter.prior_std, parameter.prior_std, false);
    let (value, std_error, corrected, at_limit) = position::<M, N, R>(parameter, fit)
        .map(|i| &fit.unknowns[i])
        .map_or(prior, |u| (u.value, u.std_error, u.corrected_std_error, u.at_limit));
    let (systematic, systematic_parts) = followed.unwrap_or_else(|| (by_powers.std(value), by_powers.shares(value)));
    let samples = task.prepared.time.len();
    let corrected_with = corrected.hypot(systematic);
    let observability = (1.0 - (std_error / parameter.prior_std).powi(2)).max(0.0);
    let scale = match task.file.base {
        crate::model_file::Base::None if !parameter.is_nuisance() => parameter.prior_std.min(value.abs()),
        _ => parameter.prior_std,
    };
    // Equations are solved without limits: a value beyond them is told as one that lies at them.
    let is_beyond = parameter.bounds.is_some_and(|[low, high]| value < low || value > high);
    let status = if at_limit || is_beyond {
        ParameterStatus::AtLimit
    } else if observability < EXCITED {
        ParameterStatus::NotExcited
    } else if corrected <= CONVERGED * scale {
        ParameterStatus::Converged
    } else {
        ParameterStatus::Improving
    };
    ColumnRun {
        values: vec![value; samples],
        std_errors: vec![corrected_with; samples],
        learnt_shifts: Vec::new(),
        surfaces: vec![0.0; samples],
        value,
        std_error,
        corrected_std_error: corrected_with,
        systematic_std: systematic,
        systematic_parts,
        observability,
        status,
        change_sensitivity: 0.0,
        verdict: ColumnVerdict::default(),
    }
}

fn covariance<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    fit: &BatchFit,
) -> Vec<Vec<f64>> {
    let places: Vec<(Option<usize>, f64)> =
        task.file.estimated().map(|p| (position::<M, N, R>(p, fit), p.prior_std)).collect();
    let entry = |(a, std): (Option<usize>, f64), (b, _): (Option<usize>, f64), same: bool| match (a, b) {
        (Some(a), Some(b)) => fit.covariance[a][b],
        _ if same => std * std,
        _ => 0.0,
    };
    places
        .iter()
        .enumerate()
        .map(|(i, a)| places.iter().enumerate().map(|(j, b)| entry(*a, *b, i == j)).collect())
        .collect()
}

fn rows<const R: usize>(values: &[Vec<f64>]) -> Vec<[f64; R]> {
    values.iter().map(|row| std::array::from_fn(|i| row.get(i).copied().unwrap_or(f64::NAN))).collect()
}

/// Every sample that was used has the same phase.
fn phase(residuals: &[f64]) -> Phase {
    if residuals.iter().any(|e| e.is_finite()) { Phase::Sliding } else { Phase::Predicting }
}

fn excited<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> bool {
    let prepared = task.prepared;
    let mut excitation = Excitation::of(prepared, task.noise);
    (0..prepared.time.len()).any(|k| {
        let surfaces = prepared.surfaces().map(|signal| signal.values[k]);
        excitation.update(prepared.time[k], surfaces, &prepared.outputs[k]).any()
    })
}

fn report(
    fit: &BatchFit,
    measured_angles: bool,
    equations: Vec<Equation>,
    prediction: Option<Prediction>,
) -> BatchReport {
    let is_additional = |kind: UnknownKind| !matches!(kind, UnknownKind::Parameter { .. } | UnknownKind::Bias { .. });
    BatchReport {
        iterations: fit.iterations.len().saturating_sub(1),
        cost: fit.iterations.last().map_or(f64::NAN, |i| i.cost),
        noise_std: fit.noise_std.clone(),
        unknowns: fit.unknowns.iter().filter(|u| is_additional(u.kind)).cloned().collect(),
        manoeuvres: fit.manoeuvres.iter().map(|m| (m.name.clone(), m.outputs.clone())).collect(),
        equations,
        band: fit.band.clone(),
        measured_angles,
        prediction,
        notes: fit.notes.clone(),
    }
}
