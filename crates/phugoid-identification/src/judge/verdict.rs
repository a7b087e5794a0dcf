//! The verdict on an estimation, in sentences.

use phugoid_estimators::DetectorState;
use phugoid_estimators::verdict::Readiness;
use phugoid_flight_data::statistics::constant;

use crate::batch::{Unknown, UnknownKind};
use crate::core::axes::Axes;
use crate::core::estimation::{
    AdoptedChange, BatchReport, ChangeOutcome, ChangedParameter, FinalStatus, History, ParameterResult, ReasonCode,
    Signal, VerdictReason, headline,
};
use crate::core::number::significant;
use crate::core::options::Opens;
use crate::core::output::Output;
use crate::core::term::Variable;
use crate::judge::contradiction::{Spread, colour};
use crate::judge::{physics, systematic};
use crate::methods::{BegunAgain, Run, Task};
use crate::model_file::{ModelFile, Role};
use crate::motion::Motion;

/// Theil's coefficient up to which a prediction counts as good (Jategaonkar, Flight Vehicle System Identification, ch.
/// 11).
const GOOD_PREDICTION: f64 = 0.3;

/// Fewest of the measured values that lie in their prediction intervals where the bounds hold: 95 % are expected, and
/// errors that stay the same for a second leave only some tens of independent ones in a record, of which 85 % or more lie
/// within in 99 of 100 cases.
const LEAST_WITHIN: f64 = 0.85;
/// Correlation from which two parameters are said to be indistinguishable.
const INDISTINGUISHABLE: f64 = 0.99;
/// Correlation from which two parameters are said to depend on each other.
const CORRELATED: f64 = 0.95;
pub(crate) fn verdict<M: Motion<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    parameters: &[ParameterResult],
    correlation: &[Vec<f64>],
    run: &Run<R>,
    reasons: &[VerdictReason],
    history: &History,
    adopted: &[AdoptedChange],
) -> Vec<String> {
    let mut sentences: Vec<String> = headline(reasons).into_iter().collect();
    // What keeps a result waiting is told below with the parameters, unless nothing moved at all.
    let told = |r: &&VerdictReason| r.is_against() || r.code == ReasonCode::NoExcitation;
    sentences.extend(reasons.iter().filter(told).map(|reason| reason.sentence.clone()));
    sentences.extend(still_surfaces(task.file, &task.prepared.known));
    sentences.extend(physics::aircraft::remark(task));
    let contradicted = reasons.iter().any(|reason| reason.code == ReasonCode::Contradiction);
    let pairs = pairs(parameters, correlation);
    if run.excited {
        excitation(parameters, &pairs, &mut sentences);
        tell_pairs(parameters, &pairs, &mut sentences);
        slopes_beyond_bends(task.file, parameters, correlation, &mut sentences);
        advice(parameters, &mut sentences);
        changes(parameters, run, contradicted, adopted, &mut sentences);
        residuals(&history.residuals, run, &mut sentences);
        sentences.extend(run.begun_again.as_ref().map(|begun| begun_again(task.file, run, begun)));
    }
    noise(task, run, &mut sentences);
    if let Some(report) = &run.batch {
        batch(report, &mut sentences);
    }
    if run.excited {
        sentences.push(task.file.uncertainty.sentence(run.follows_constants));
        sentences.extend(systematic::learnt(&run.learnt, task.file.uncertainty.learns));
        sentences.extend(run.said_of_base.clone().or_else(|| task.file.not_in_bounds_of_base()));
        sentences.extend(systematic::sentence(parameters));
    }
    sentences.extend(task.prepared.notes.iter().map(|n| format!("{}.", capitalised(n))));
    let unchecked = run.no_second_answer.as_ref();
    sentences.extend(unchecked.map(|why| {
        format!("No method of another kind stands beside these values, as one does by default, so that none has confirmed them: {why}.")
    }));
    sentences
}

/// The surfaces of which a parameter is wanted, and that have one value throughout. The motion may go on without them, but who
/// expects a moved surface has to know that the record has none.
fn still_surfaces(file: &ModelFile, known: &[Signal]) -> Option<String> {
    let wanted_by = |surface: &str| -> Vec<&str> {
        let is_of = |role: &Role| match role {
            Role::Term(_, term) => {
                term.powers().any(|(index, _)| Variable::ALL.get(index).is_some_and(|v| v.name() == surface))
            }
            _ => false,
        };
        file.estimated().filter(|p| is_of(&p.role)).map(|p| p.name.as_str()).collect()
    };
    let still = known.iter().filter(|signal| Axes::SURFACES.contains(&signal.name.as_str())).filter_map(|signal| {
        let value = constant(&signal.values)?;
        let wanted = wanted_by(&signal.name);
        (!wanted.is_empty()).then(|| {
            format!(
                "The {} has one value throughout, {} deg, so that this record cannot tell {}: if it was moved in flight, check its \
                 column in the file; if not, fix what follows from it (fixed = true) or fly with it moved.",
                signal.name,
                significant(value.to_degrees(), 4),
                wanted.join(", ")
            )
        })
    });
    let still: Vec<String> = still.collect();
    (!still.is_empty()).then(|| still.join(" "))
}

/// A level that was learnt and one that was given are said to differ from this ratio on.
const NOTEWORTHY: f64 = 2.0;

/// The sentences about noise levels: measured from the record, or learnt in flight and compared with those given.
fn noise<M: Motion<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
    sentences: &mut Vec<String>,
) {
    if let Some(report) = &run.batch {
        sentences.extend(noise_of_fit(M::AXES, report));
        return;
    }
    let used = || M::AXES.outputs().iter().zip(task.noise).enumerate().filter(|(_, (_, level))| level.std > 0.0);
    let list = |levels: &mut dyn Iterator<Item = (usize, f64)>| -> Vec<String> {
        levels
            .filter_map(|(row, std)| Some((M::AXES.outputs().get(row)?, std)))
            .map(|(output, std)| level(output, std))
            .collect()
    };
    let Some(learnt) = &run.noise else {
        let measured = list(&mut used().filter(|(_, (_, level))| level.measured).map(|(row, (_, l))| (row, l.std)));
        if !measured.is_empty() {
            sentences.push(format!("Noise levels measured from the record, one sigma: {}.", measured.join(", ")));
        }
        return;
    };
    let levels = list(&mut used().map(|(row, _)| (row, learnt.std[row])));
    sentences.push(format!("Levels of the residuals, learnt in flight, one sigma: {}.", levels.join(", ")));
    for (row, (output, given)) in used().filter(|(_, (_, level))| !level.measured) {
        let ratio = learnt.std[row] / given.std;
        if !(1.0 / NOTEWORTHY..=NOTEWORTHY).contains(&ratio) {
            sentences.push(format!(
                "The residual of {} is {ratio:.1} times the noise that the model file gives: {}.",
                output.name(),
                if ratio > 1.0 {
                    "a filter, lag, scale or bias of the sensor, turbulence, or a term that the model lacks; the bounds \
                     follow the residual"
                } else {
                    "the sensor is better than that; the bounds follow the residual"
                }
            ));
        }
    }
}

/// An output with its noise level, one sigma.
fn level(output: &Output, std: f64) -> String {
    format!("{} {std:.3e} {}", output.name(), output.unit())
}

/// The sentence about the noise of a fit in time: the levels of the outputs, and the process noise that filter error found. None where
/// the levels are those of equations or of a band.
fn noise_of_fit(axes: Axes, report: &BatchReport) -> Option<String> {
    if report.band.is_some() || !report.equations.is_empty() {
        return None;
    }
    let levels = axes.outputs().iter().zip(&report.noise_std).filter(|(_, std)| std.is_finite());
    let levels: Vec<String> = levels.map(|(output, std)| level(output, *std)).collect();
    let density = |unknown: &Unknown| match unknown.kind {
        UnknownKind::ProcessNoise { state } => {
            let state = axes.states().get(state)?;
            Some(format!("{} {:.3e} {}", state.name(), unknown.value, state.density_dimension().si_unit()))
        }
        _ => None,
    };
    let densities: Vec<String> = report.unknowns.iter().filter_map(density).collect();
    let found = match &densities[..] {
        [] => String::new(),
        densities => format!(" Spectral densities of the process noise that was found: {}.", densities.join(", ")),
    };
    (!levels.is_empty()).then(|| format!("Noise of the outputs, one sigma: {}.{found}", levels.join(", ")))
}

/// Outputs whose residuals are not of one level over the band.
fn uneven(report: &BatchReport, sentences: &mut Vec<String>) {
    let fits = report.manoeuvres.iter().flat_map(|(_, fits)| fits).filter(|fit| !fit.white);
    let end = |lag_one: f64| if lag_one > 0.0 { "lower" } else { "upper" };
    let found: Vec<String> = fits.map(|fit| format!("{} at the {} end", fit.name, end(fit.lag_one))).collect();
    if !found.is_empty() {
        sentences.push(format!(
            "The spectrum of the residuals is not flat over the band, but largest: {}. That is model error, turbulence or a \
             lag of a sensor. The corrected standard errors allow for it.",
            found.join(", ")
        ));
    }
}

/// The sentences about a batch method: its notes, and how well its parameters predict another record.
fn batch(report: &BatchReport, sentences: &mut Vec<String>) {
    if let Some(band) = &report.band {
        let fits = report.manoeuvres.iter().flat_map(|(_, fits)| fits);
        let fits: Vec<String> = fits.map(|fit| format!("{} {:.3}", fit.name, fit.r_squared)).collect();
        let fits = if fits.is_empty() { String::new() } else { format!("; R^2 in it: {}", fits.join(", ")) };
        sentences.push(format!(
            "Only the motion from {band} was used ({} frequencies), so that biases and drifts do not count{fits}.",
            band.frequencies
        ));
    }
    sentences.extend(report.notes.iter().map(|n| format!("{}.", capitalised(n))));
    for equation in &report.equations {
        let idle: Vec<&str> = equation.terms.iter().filter(|t| !t.needed).map(|t| t.name.as_str()).collect();
        if !idle.is_empty() {
            sentences.push(format!(
                "The equation of {} does not need {}: leaving it out hardly changes the fit.",
                equation.left_sides.join(" and "),
                idle.join(", ")
            ));
        }
    }
    if let Some(prediction) = &report.prediction
        && let Some(worst) = prediction.fit.iter().max_by(|a, b| a.theil.total_cmp(&b.theil))
    {
        let verdict = if worst.theil <= GOOD_PREDICTION { "predicts" } else { "does not predict" };
        sentences.push(format!(
            "The estimate {verdict} {}: Theil's coefficient is at most {:.3} ({}), and up to {GOOD_PREDICTION} counts as good.",
            prediction.source, worst.theil, worst.name
        ));
        let narrow = prediction.intervals.iter().filter(|i| i.within < LEAST_WITHIN);
        if let Some(narrowest) = narrow.min_by(|a, b| a.within.total_cmp(&b.within)) {
            sentences.push(format!(
                "The bounds do not hold for {}: {:.0} % of {} lie within two sigma of the prediction, and 95 % are \
                 expected. Turbulence, another condition of flight or an effect that the model lacks does that.",
                prediction.source,
                100.0 * narrowest.within,
                narrowest.name
            ));
        }
    }
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |c| c.to_uppercase().chain(characters).collect())
}

/// Two parameters and their correlation.
type Pair = (f64, usize, usize);

fn excitation(parameters: &[ParameterResult], pairs: &[Pair], sentences: &mut Vec<String>) {
    let wanted: Vec<&ParameterResult> =
        parameters.iter().filter(|p| !p.nuisance && p.status != FinalStatus::Fixed).collect();
    // A parameter that is only hidden by a correlated one does not lack excitation.
    let twin = |p: &ParameterResult| {
        let is = |i: usize| parameters[i].name == p.name;
        pairs.iter().any(|(r, i, j)| r.abs() >= INDISTINGUISHABLE && (is(*i) || is(*j)))
    };
    let with = |status: FinalStatus| -> Vec<&str> {
        let counts = |p: &&&ParameterResult| p.status == status && !(status == FinalStatus::NotExcited && twin(p));
        wanted.iter().filter(counts).map(|p| p.name.as_str()).collect()
    };
    let (converged, improving, silent, limited, doubtful) = (
        with(FinalStatus::Converged),
        with(FinalStatus::Improving),
        with(FinalStatus::NotExcited),
        with(FinalStatus::AtLimit),
        with(FinalStatus::InDoubt),
    );
    sentences.push(format!("{} of {} parameters have converged.", converged.len(), wanted.len()));
    if !doubtful.is_empty() {
        sentences.push(format!("In doubt, for the reasons named first: {}.", doubtful.join(", ")));
    }
    if !improving.is_empty() {
        sentences.push(format!("Still improving, more excitation would help: {}.", improving.join(", ")));
    }
    if !silent.is_empty() {
        let plural = if silent.len() == 1 { "its bound is" } else { "their bounds are" };
        sentences.push(format!(
            "Not excited: {}. The record says almost nothing here; {plural} still the one given beforehand.",
            silent.join(", ")
        ));
    }
    if !limited.is_empty() {
        sentences.push(format!(
            "At the limit: {}. The data want a value outside the bounds in the model file: widen them, or check the \
             aircraft data, units and signs.",
            limited.join(", ")
        ));
    }
}

/// What to fly for the parameters that more of the same input would not determine.
fn advice(parameters: &[ParameterResult], sentences: &mut Vec<String>) {
    let mut grouped: Vec<(&str, Vec<&str>)> = Vec::new();
    for parameter in parameters.iter().filter(|p| !p.nuisance) {
        let Some(readiness) = parameter.readiness.as_ref().filter(|r| r.verdict == Readiness::NotIdentifiable) else {
            continue;
        };
        let Some(advice) = readiness.advice.as_deref() else { continue };
        match grouped.iter_mut().find(|(known, _)| *known == advice) {
            Some((_, names)) => names.push(&parameter.name),
            None => grouped.push((advice, vec![&parameter.name])),
        }
    }
    sentences.extend(grouped.iter().map(|(advice, names)| format!("For {}: {advice}.", names.join(", "))));
}

/// Pairs of parameters of which the data determine only a combination, the worst first. The priors are uncorrelated, so
/// that every correlation comes from the data.
fn pairs(parameters: &[ParameterResult], correlation: &[Vec<f64>]) -> Vec<Pair> {
    let estimated = |i: usize| parameters[i].status != FinalStatus::Fixed;
    let mut found: Vec<Pair> = Vec::new();
    for (i, row) in correlation.iter().enumerate() {
        for (j, r) in row.iter().enumerate().skip(i + 1) {
            if r.abs() >= CORRELATED && estimated(i) && estimated(j) {
                found.push((*r, i, j));
            }
        }
    }
    found.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    found
}

fn tell_pairs(parameters: &[ParameterResult], found: &[Pair], sentences: &mut Vec<String>) {
    for &(r, i, j) in found {
        let (a, b) = (&parameters[i].name, &parameters[j].name);
        let known = |i: usize| parameters[i].status == FinalStatus::Converged;
        sentences.push(if r.abs() >= INDISTINGUISHABLE && !(known(i) && known(j)) {
            format!(
                "{a} and {b} cannot be told apart in this record (correlation {r:.4}): only a combination of them is \
                 known. Fix one of them, or fly a manoeuvre that moves their regressors differently."
            )
        } else {
            let digits = if r.abs() >= INDISTINGUISHABLE { 4 } else { 3 };
            format!("{a} and {b} are strongly correlated ({r:.digits$}): read them together.")
        });
    }
}

/// Of a coefficient that is two straight lines over a variable: what its slope is beyond the bend. The parameter that is named
/// like the derivative is the slope before it, wherever the aircraft has flown.
fn slopes_beyond_bends(
    file: &ModelFile,
    parameters: &[ParameterResult],
    correlation: &[Vec<f64>],
    sentences: &mut Vec<String>,
) {
    let named = |name: &str| parameters.iter().position(|parameter| parameter.name == name);
    for parameter in &file.parameters {
        let Role::Term(coefficient, term) = &parameter.role else { continue };
        let Some((variable, from)) = term.straight_above() else { continue };
        let is_line =
            |role: &Role| matches!(role, Role::Term(c, line) if c == coefficient && line.single() == Some(variable));
        let line = file.parameters.iter().find(|other| is_line(&other.role)).and_then(|line| named(&line.name));
        let (Some(line), Some(beyond)) = (line, named(&parameter.name)) else { continue };
        let (a, b) = (&parameters[line], &parameters[beyond]);
        let r = correlation.get(line).and_then(|row| row.get(beyond)).copied().unwrap_or(0.0);
        let [s, t] = [a, b].map(|p| p.corrected_std_error);
        let std = (s * s + t * t + 2.0 * r * s * t).max(0.0).sqrt();
        if !std.is_finite() {
            continue;
        }
        let is_angle = variable < Variable::ALL.len() && variable != Variable::Airspeed.index();
        let place = if is_angle { format!("{:.1} deg", from.to_degrees()) } else { significant(from, 3) };
        let name = Variable::ALL.get(variable).map_or("its variable", |variable| variable.name());
        sentences.push(format!(
            "{} is the slope where {name} is below {place}. Above, the slope is {} + {} = {} +- {} (two sigma).",
            a.name,
            a.name,
            b.name,
            significant(a.value + b.value, 4),
            significant(2.0 * std, 2),
        ));
    }
}

fn changes<const R: usize>(
    parameters: &[ParameterResult],
    run: &Run<R>,
    contradicted: bool,
    adopted: &[AdoptedChange],
    sentences: &mut Vec<String>,
) {
    sentences.extend(adopted.iter().map(|change| before_and_after(change, contradicted)));
    let unknown: Vec<&str> =
        parameters.iter().filter(|p| p.status == FinalStatus::Unknown).map(|p| p.name.as_str()).collect();
    if let (false, Some(change)) = (unknown.is_empty(), adopted.last()) {
        sentences.push(format!(
            "Unknown since {:.2} s: {}. The change re-opened them and nothing has excited them since; what they were \
             before need not hold any more.",
            change.time_s,
            unknown.join(", ")
        ));
    }
    let Some(detector) = run.detector else { return };
    if run.status.detector == DetectorState::Insensitive {
        let seen: Vec<String> = parameters
            .iter()
            .filter(|p| !p.nuisance && p.status != FinalStatus::Fixed)
            .zip(run.columns.iter().map(|c| c.change_sensitivity))
            .filter(|(_, s)| *s > 0.0)
            .map(|(p, s)| format!("{} {s:.3}", p.name))
            .collect();
        sentences.push(format!(
            "Model error (wander {:.2}): sudden changes smaller than this could not be told from it: {}. Terms may be \
             missing in the coefficient build-up; offsets = true under [coefficients] often helps.",
            detector.wander,
            seen.join(", ")
        ));
    }
}

/// Standard errors from which the difference of an estimate before and after a change is called one.
const CHANGED: f64 = 3.0;

/// What changed, from what to what, and what else could explain it.
fn before_and_after(change: &AdoptedChange, contradicted: bool) -> String {
    let time_s = change.time_s;
    if change.outcome == ChangeOutcome::ExplainedByTerm {
        return format!(
            "A change of the parameters was adopted at {time_s:.2} s, and is none: with what the model lacks it is not found, and \
             the record is predicted better."
        );
    }
    if !change.outcome.stands() {
        let why = if change.outcome == ChangeOutcome::WithdrawnAfterwards {
            "when the whole record was looked at again: it is not predicted better with the change"
        } else {
            "the estimate from before it has predicted better"
        };
        return format!("A change of the parameters was adopted at {time_s:.2} s and taken back: {why}.");
    }
    let mut changed: Vec<&ChangedParameter> = change.parameters.iter().filter(|p| p.sigmas().abs() > CHANGED).collect();
    changed.sort_by(|a, b| b.sigmas().abs().total_cmp(&a.sigmas().abs()));
    // A constant: the term `1` of a coefficient, or an offset.
    let is_constant = |p: &&ChangedParameter| p.name.ends_with("_0") || p.name.starts_with("offset");
    let trim_shift = change.opens == Opens::Constants
        || changed.first().is_some_and(is_constant) && {
            let rest = changed.iter().filter(|p| !is_constant(p));
            rest.map(|p| p.sigmas().abs()).fold(0.0, f64::max) < changed[0].sigmas().abs() / 2.0
        };
    if changed.is_empty() && change.opens == Opens::Constants {
        // The standard errors of a constant are mostly those of the derivatives, which are the same before and after.
        changed.extend(change.parameters.iter().max_by(|a, b| a.sigmas().abs().total_cmp(&b.sigmas().abs())));
    }
    let list: Vec<String> = changed
        .iter()
        .map(|p| {
            format!(
                "{} {:.4} ± {:.2e} -> {:.4} ± {:.2e} (by {:+.4} ± {:.2e})",
                p.name,
                p.before,
                2.0 * p.before_std,
                p.after,
                2.0 * p.after_std,
                p.after - p.before,
                2.0 * p.difference_std
            )
        })
        .collect();
    let what = if trim_shift {
        "A constant force or moment (a trim shift) set in"
    } else if contradicted {
        "The parameters changed in flight, or what contradicts the model looks like it"
    } else {
        "The parameters changed in flight"
    };
    let list = if list.is_empty() {
        format!("no single parameter has moved by more than {CHANGED} standard errors yet")
    } else {
        format!("before -> after, two sigma: {}", list.join("; "))
    };
    let state = match change.outcome {
        ChangeOutcome::OnProbation => {
            " It is on probation: not everything that was re-opened has been excited since, or the new estimate has not \
             yet predicted better for long enough."
        }
        ChangeOutcome::FoundAfterwards => " It was found when the whole record was looked at again, not in flight.",
        ChangeOutcome::Confirmed
        | ChangeOutcome::RolledBack
        | ChangeOutcome::WithdrawnAfterwards
        | ChangeOutcome::ExplainedByTerm => "",
    };
    let when = change
        .interval_s
        .map_or_else(String::new, |[from_s, to_s]| format!(" (it happened between {from_s:.1} and {to_s:.1} s)"));
    format!(
        "{what}: found at {time_s:.2} s{when}; {list}. A term that the model lacks, another flight condition, or a sensor error \
         that began then can look the same.{state}"
    )
}

/// What another start made of the run.
fn begun_again<const R: usize>(file: &ModelFile, run: &Run<R>, begun: &BegunAgain) -> String {
    let named = |(column, before): (usize, f64)| {
        let (parameter, now) = (file.estimated().nth(column)?, run.columns.get(column)?);
        let [before, now] = [before, now.value].map(|value| significant(value, 4));
        Some(format!(" From the `start` values {} came out as {before} in place of {now}.", parameter.name))
    };
    format!(
        "The filter was run a second time, from the values of equation error (with ten of their standard errors), because the record is \
         predicted better so than from the `start` values of the model file, by {:.0} nats.{}",
        begun.gain,
        begun.most.and_then(named).unwrap_or_default()
    )
}

/// Outliers, and residuals that are not white.
fn residuals<const R: usize>(residuals: &[Signal], run: &Run<R>, sentences: &mut Vec<String>) {
    // Residuals that were made of a band are coloured by that: what they tell is whether their spectrum is flat in it.
    if let Some(report) = run.batch.as_ref().filter(|report| report.band.is_some()) {
        uneven(report, sentences);
        return;
    }
    let samples = run.phases.len().max(1) as f64;
    let mut coloured = Vec::new();
    for signal in residuals {
        let Some(Spread { present, outliers, .. }) = Spread::of(signal) else { continue };
        if outliers > 0 && outliers as f64 > 0.002 * samples {
            sentences.push(format!(
                "{outliers} of {present} samples of {} lie more than six sigmas away and were taken for outliers.",
                signal.name
            ));
        }
        if let Some(colour) = colour(signal.values.iter().copied()) {
            coloured.push(format!("{} ({colour:.2})", signal.name));
        }
    }
    if !coloured.is_empty() {
        let allowed = if run.batch.is_some() { "as far as it reaches" } else { "shorter than half a second" };
        sentences.push(format!(
            "Coloured residuals (lag-one correlation): {}. That is model error, a sensor bias or lag, turbulence, or too \
             small a noise level. The corrected standard errors allow for colour {allowed}.",
            coloured.join(", ")
        ));
    }
}
