//! What speaks against a result as a whole, and what that does to the parameters.

use phugoid_estimators::verdict::Readiness;
use phugoid_estimators::{ChangeState, Phase};
use phugoid_flight_data::plausibility::{Cause, Doubt};
use phugoid_flight_data::record::Record;

use crate::core::axes::{Axes, Group};
use crate::core::estimation::{
    EstimationStatus, EventKind, FinalStatus, History, ParameterReadiness, ParameterResult, ReasonCode, Signal,
    VerdictReason,
};
use crate::core::method::Method;
use crate::core::options::CAPACITY;
use crate::core::output::Output;
use crate::judge::contradiction::{self, AtEstimates, Unsettled};
use crate::judge::equations::Equations;
use crate::judge::{
    agreement, attitude, by_surfaces, constancy, disputed, explained, fit, input_noise, integrity, physics, smoothed,
};
use crate::methods::{BySurfaces, Run, Task};
use crate::model_file::{ModelFile, Role};
use crate::motion::MotionModel;

/// What output error has to add where residuals or equations speak against the model: its free simulation knows no
/// disturbance, and on foreign flights filter error answered where it was refused.
const WITHOUT_PROCESS_NOISE: &str = "Turbulence and what the model lacks do this to output error too: compare with \
                                     filter-error, which allows for both.";

/// The reasons why a result is not sound, the severest first.
#[allow(clippy::too_many_arguments)] // what a verdict rests on
pub(crate) fn reasons<M: MotionModel<N, R, CAPACITY>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    record: &Record,
    parameters: &[ParameterResult],
    correlation: &[Vec<f64>],
    run: &Run<R>,
    doubts: &[Doubt],
    history: &History,
    equations: Option<&Equations>,
) -> Vec<VerdictReason> {
    let mut found: Vec<VerdictReason> = Vec::new();
    let is_mirrored = |name: &str, value: f64, std_error: f64| {
        task.file.estimated().any(|p| p.name == name && physics::is_mirrored(&p.role, value, std_error))
    };
    if run.excited {
        found.extend(diverged(run));
        let learnt = learnt_groups(task.file, parameters);
        let unsettled_s = unsettled_stretches(run, &history.time_s);
        let noisier = || Equations::noisier(task, run);
        let at_estimates = equations.map(|equations| AtEstimates { equations, noisier: &noisier });
        let (time_s, residuals) = (&history.time_s, &history.residuals);
        let against = contradiction::reasons(time_s, residuals, at_estimates.as_ref(), &unsettled_s, &learnt);
        found.extend(against.into_iter().map(|reason| match task.method() {
            Method::OutputError | Method::OutputErrorFrequency => {
                VerdictReason { sentence: format!("{} {WITHOUT_PROCESS_NOISE}", reason.sentence), ..reason }
            }
            _ => reason,
        }));
        let vanes: Vec<Option<f64>> = M::AXES
            .outputs()
            .iter()
            .zip(task.noise)
            .map(|(output, noise)| matches!(output, Output::Alpha | Output::Beta).then_some(noise.std))
            .collect();
        let of_fit = |report| fit::reasons(task.method(), task.file, history, report, &vanes);
        found.extend(run.batch.iter().flat_map(of_fit));
        // SMPE and the EKF look for changes themselves.
        let is_constant = task.method().is_batch() || task.method().is_recursive_regression();
        found.extend(equations.filter(|_| is_constant).and_then(constancy::reason));
        found.extend(disputed::reason(task.file, run));
        let method = task.method();
        let is_constant = |name: &str| task.file.estimated().any(|p| p.name == name && p.role.is_constant());
        let against = |answer| agreement::reason(method, parameters, answer, is_constant);
        let witnesses = run.second_answer.iter().chain(&run.third_answer);
        let witnesses = witnesses.filter(|answer| !agreement::is_mirror_image(parameters, answer, is_mirrored));
        found.extend(witnesses.filter_map(against));
        let role = |name: &str| task.file.estimated().find(|p| p.name == name).map(|p| &p.role);
        let is_compared = |name: &str| role(name).is_some_and(by_surfaces::is_compared);
        let BySurfaces { values, bent } = &run.by_surfaces;
        let is_bent = |name: &str| matches!(role(name), Some(Role::Term(coefficient, _)) if bent.contains(coefficient));
        found.extend(by_surfaces::reason(method, parameters, values, is_compared, is_bent));
        found.extend(run.noise.and_then(|_| explained::reason(history)));
        found.extend(run.noise.and_then(|learnt| {
            let outputs = M::AXES.outputs().iter().zip(task.noise).zip(learnt.std);
            attitude::reason(outputs.map(|((output, noise), learnt)| (*output, noise.std, learnt)))
        }));
        found.extend(input_noise::reason(&task.prepared.surface_noise));
        found.extend(input_noise::wild(&task.prepared.wild_values));
        found.extend(smoothed::reason(task));
        found.extend(smoothed::too_slow(task));
        found.extend(smoothed::airspeed_too_slow(task));
        found.extend(integrity::reason(record, task));
        found.extend(unsettled(parameters, run));
    } else {
        found.push(no_excitation(M::AXES, &history.measured));
    }
    found.extend(doubts.iter().map(channel));
    let of_physics = physics::reasons(record, task, parameters, correlation, run.excited).into_iter();
    found.extend(
        of_physics.map(|reason| {
            agreement::of_sign(task.method(), parameters, run.second_answer.as_ref(), is_mirrored, reason)
        }),
    );
    found.sort_by_key(|reason| std::cmp::Reverse(reason.status));
    found
}

/// The stretches in which the run was learning: from the first motion on, and around the changes that were not taken back.
fn unsettled_stretches<const R: usize>(run: &Run<R>, time_s: &[f64]) -> Unsettled {
    let doubted = |adopted_s: f64| {
        let doubts = run.events.iter().filter(|event| event.kind == EventKind::InDoubt).map(|event| event.time_s);
        doubts.filter(|doubted_s| *doubted_s <= adopted_s).fold(f64::NEG_INFINITY, f64::max)
    };
    let kept = run.changes.iter().filter(|change| change.outcome.stands()).map(|c| c.time_s);
    // Without a doubt on record the adoption is all that is known.
    let kept: Vec<[f64; 2]> = kept.map(|t| [Some(doubted(t)).filter(|d| d.is_finite()).unwrap_or(t), t]).collect();
    // A batch method has no densities, and does not learn as it goes.
    let first_motion = run.log_density.iter().position(|row| row.iter().any(|v| v.is_finite()));
    let learns_s = first_motion.and_then(|k| time_s.get(k).copied());
    Unsettled::new(&kept, time_s.first().zip(time_s.last()).map_or(0.0, |(first, last)| last - first), learns_s)
}

/// The groups of axes of which the flight has excited a parameter.
fn learnt_groups(file: &ModelFile, parameters: &[ParameterResult]) -> Vec<Group> {
    let untouched = [FinalStatus::NotExcited, FinalStatus::Fixed];
    let excited = parameters.iter().filter(|p| !untouched.contains(&p.status));
    excited
        .filter_map(|p| {
            let found = file.parameters.iter().find(|parameter| parameter.name == p.name)?;
            match &found.role {
                Role::Term(coefficient, _) => Some(coefficient.group()),
                _ => None,
            }
        })
        .collect()
}

/// Takes "converged" from the parameters that are not to be used, and from their readiness: from those that a missing term
/// concerns, and from all of them for any other reason.
pub(crate) fn demote(parameters: &mut [ParameterResult], reasons: &[VerdictReason]) {
    for parameter in parameters.iter_mut() {
        let Some(worst) = reasons.iter().find(|reason| reason.puts_in_doubt(&parameter.name)) else { continue };
        if parameter.status == FinalStatus::Converged {
            parameter.status = FinalStatus::InDoubt;
        }
        parameter.converged_at_s = None;
        if let Some(readiness) = parameter.readiness.as_mut() {
            put_in_doubt(readiness, worst.code);
        }
    }
}

/// Takes "ready" from a parameter, and says why.
pub(crate) fn put_in_doubt(readiness: &mut ParameterReadiness, why: ReasonCode) {
    if readiness.verdict == Readiness::Ready {
        readiness.verdict = Readiness::Doubtful;
        readiness.reason = why.clause().to_owned();
        readiness.ready_since_s = None;
    }
}

fn diverged<const R: usize>(run: &Run<R>) -> Option<VerdictReason> {
    (run.batch.is_none() && run.status.phase == Phase::Diverged).then(|| VerdictReason {
        code: ReasonCode::Diverged,
        status: EstimationStatus::Refused,
        concerns: Vec::new(),
        sentence:
            "The estimator diverged: its numbers are not finite, or its covariance is not one. Check units, signs \
                   and the start values of the model file."
                .to_owned(),
    })
}

/// Reasons to wait: there is nothing to say against the result, but the flight does not settle it.
fn unsettled<const R: usize>(parameters: &[ParameterResult], run: &Run<R>) -> Vec<VerdictReason> {
    let wanted = || parameters.iter().filter(|p| !p.nuisance && p.status != FinalStatus::Fixed);
    let names = |status: FinalStatus| -> Vec<String> {
        wanted().filter(|p| p.status == status).map(|p| p.name.clone()).collect()
    };
    let provisional = |code: ReasonCode, concerns: Vec<String>, sentence: String| VerdictReason {
        code,
        status: EstimationStatus::Provisional,
        concerns,
        sentence,
    };
    let mut found = Vec::new();
    if run.noise.is_some_and(|noise| noise.is_provisional) {
        let sentence = "The record ends before the noise levels of the outputs are known: two seconds after the first \
                        motion and a little more are needed. Until then bounds are provisional."
            .to_owned();
        found.push(provisional(ReasonCode::NoiseNotLearnt, Vec::new(), sentence));
    }
    if wanted().count() > 0 && names(FinalStatus::Converged).is_empty() {
        let sentence = "No parameter has converged: the record excites them too little or is too short.".to_owned();
        found.push(provisional(ReasonCode::NotConverged, Vec::new(), sentence));
    }
    let limited = names(FinalStatus::AtLimit);
    if !limited.is_empty() {
        let sentence = format!(
            "At the limit: {}. The data want a value outside the bounds in the model file: widen them, or check the \
             aircraft data, units and signs.",
            limited.join(", ")
        );
        found.push(provisional(ReasonCode::AtLimit, limited, sentence));
    }
    if run.status.change == ChangeState::InDoubt {
        let sentence = "The record ends while a sudden change of the parameters is suspected.".to_owned();
        found.push(provisional(ReasonCode::ChangeInDoubt, Vec::new(), sentence));
    }
    found
}

fn no_excitation(axes: Axes, measured: &[Signal]) -> VerdictReason {
    let [movers, manoeuvre] = axes.excitation_words();
    let mut sentence = format!(
        "No excitation: {movers} never move beyond their noise. Steady flight tells at \
         most sums of terms, so all parameters and their bounds are still those given beforehand. Fly {manoeuvre}."
    );
    if measured.iter().all(|signal| signal.values.windows(2).all(|pair| pair[0] == pair[1])) {
        sentence.push_str(" Every measured output is exactly constant: the recorder was frozen.");
    }
    VerdictReason {
        code: ReasonCode::NoExcitation,
        status: EstimationStatus::Provisional,
        concerns: Vec::new(),
        sentence,
    }
}

/// A channel that the reader's checks find implausible.
pub(crate) fn channel(doubt: &Doubt) -> VerdictReason {
    let (code, check) = match doubt.cause {
        Cause::Unit => (ReasonCode::Units, "units"),
        Cause::Sensor => (ReasonCode::Channel, "sensor"),
        Cause::Standing => (ReasonCode::Channel, "part of the record that is used"),
    };
    VerdictReason {
        code,
        status: EstimationStatus::Doubtful,
        concerns: doubt.channels.clone(),
        sentence: format!("Check the {check}: {}.", doubt.to_string().trim_end_matches('.')),
    }
}
