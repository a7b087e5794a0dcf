//! Which condition decides what becomes of a method, in numbers.

use crate::laws::{Diagnostics, Evaluation, ThesisForm};
use phugoid_estimators::{LinearizedRates, Model};
use phugoid_identification::longitudinal::STATES;

use super::case::{AircraftCase, PARAMETERS};
use super::law::{LawForm, LawSettings, Surface};
use super::method::{Method, MethodRun, NamedMethod, ParameterRun};
use super::reference::Reference;
use crate::plant_case::verdict::{AWAY, TOLERANCE};
use phugoid_evaluation::statistics::median;

const ROOM: usize = PARAMETERS.len();

/// The condition that decides what became of a method, as a sentence with its numbers.
pub(super) fn condition(case: &AircraftCase, reference: &Reference, method: &NamedMethod, run: &MethodRun) -> String {
    match &method.method {
        Method::Flagship(_) => flagship(case, reference, run),
        Method::Laws(laws) => {
            let sentences = laws.iter().zip(&run.parameters).map(|(law, found)| {
                if laws.len() > 1 {
                    format!("{}: {}", law.parameter, decisive(case, reference, law, found, run))
                } else {
                    of_law(case, reference, law, found, run)
                }
            });
            let mut sentences: Vec<String> = sentences.collect();
            if ["dCm_alpha", "dCm_q"].iter().all(|name| laws.iter().any(|law| law.parameter == *name)) {
                sentences.push(
                    "dCm_alpha and dCm_q share one surface: one equation for two numbers at every instant".to_owned(),
                );
            }
            sentences.join(". ")
        }
    }
}

fn flagship(case: &AircraftCase, reference: &Reference, run: &MethodRun) -> String {
    let claims: Vec<String> = run
        .parameters
        .iter()
        .filter_map(|p| {
            let at = case.published.converged_s(&p.name).or(reference.input_starts_s.map(|start| start + 1.0))?;
            let k = run.time_s.partition_point(|&t| t <= at + 1e-9).saturating_sub(1);
            let claimed = p.std_errors.as_ref()?.get(k)? / case.truth(&p.name).abs();
            Some(format!("{} {:.2} % at {at:.2} s", p.name, 100.0 * claimed))
        })
        .collect();
    format!(
        "the information in the record decides: for the noise that it is told its one-sigma claims are {}",
        claims.join(", ")
    )
}

/// What decides for one of several laws that run together, and how it ends, in a few words: the rest is told where the law
/// runs alone.
fn decisive(
    case: &AircraftCase,
    reference: &Reference,
    law: &LawSettings,
    found: &ParameterRun,
    run: &MethodRun,
) -> String {
    let slopes = slopes(case, reference, law);
    let z = slopes.get(from_input(reference, run)..).unwrap_or_default();
    let why = match law.form {
        LawForm::AsPrinted(Evaluation::Delayed) => {
            format!(
                "an error grows by |z|/eta = {:.0e} per sample",
                median(z.iter().map(|z| z.abs()).collect()) / law.eta
            )
        }
        LawForm::AsPrinted(Evaluation::Implicit) => {
            format!("z > 0, against the printed sign, at {:.0} % of the samples", percent(z, |z| *z > 0.0))
        }
        LawForm::Solved(ThesisForm::Damped) => format!("eta = {:.0e} damps", law.eta),
        LawForm::Solved(_) => format!("|z| < eta at {:.1} % of the samples", percent(z, |z| z.abs() < law.eta)),
    };
    match leaves(law, found).and_then(|k| run.time_s.get(k)) {
        Some(time) => format!("{why}, outside the bounds by far from {time:.2} s"),
        None => format!("{why}, {}", late(case, reference, law, found, run)),
    }
}

fn from_input(reference: &Reference, run: &MethodRun) -> usize {
    let start = reference.input_starts_s.unwrap_or(0.0);
    run.time_s.partition_point(|&t| t < start)
}

/// The first sample at which the estimate is [`AWAY`] half widths from the middle of its bounds.
fn leaves(law: &LawSettings, found: &ParameterRun) -> Option<usize> {
    let [lower, upper] = law.bounds;
    let out = |value: &f64| value.is_nan() || (value - 0.5 * (lower + upper)).abs() > AWAY * 0.5 * (upper - lower);
    found.values.iter().position(out)
}

/// How often the estimate is right from the published time on, or from a second after the input: published or not, there is
/// enough motion for every coefficient then.
fn late(
    case: &AircraftCase,
    reference: &Reference,
    law: &LawSettings,
    found: &ParameterRun,
    run: &MethodRun,
) -> String {
    let truth = case.truth(law.parameter);
    let start = reference.input_starts_s.unwrap_or(0.0);
    let late = run.time_s.partition_point(|&t| t < case.published.converged_s(law.parameter).unwrap_or(start + 1.0));
    format!(
        "within 5 % at {:.0} % of the samples from {:.2} s on",
        percent(&found.values[late..], |value| (value - truth).abs() <= TOLERANCE * truth.abs()),
        run.time_s.get(late).copied().unwrap_or(f64::NAN)
    )
}

fn of_law(
    case: &AircraftCase,
    reference: &Reference,
    law: &LawSettings,
    found: &ParameterRun,
    run: &MethodRun,
) -> String {
    let from = from_input(reference, run);
    let left = leaves(law, found);
    // What is seen from inside means something as long as the estimated aircraft resembles one.
    let end = left.unwrap_or(run.time_s.len()).max(from);
    let inside: &[Diagnostics] = found.inside.as_deref().and_then(|all| all.get(from..end)).unwrap_or_default();
    let slopes = slopes(case, reference, law);
    let z = slopes.get(from..).unwrap_or_default();
    let step = reference.time.windows(2).next().map_or(f64::NAN, |t| t[1] - t[0]);
    let typical = median(z.iter().map(|z| z.abs()).collect());

    let mut parts =
        vec![format!("lambda h = {:.3}, eta = {:.0e}, median |z| = {typical:.1e}", law.lambda * step, law.eta)];
    let small = percent(z, |z| z.abs() < law.eta);
    match law.form {
        LawForm::AsPrinted(Evaluation::Delayed) => parts.push(format!(
            "with one sample of delay the loop multiplies an error by |z|/eta = {:.1e} per sample (median)",
            typical / law.eta
        )),
        LawForm::AsPrinted(Evaluation::Implicit) => parts.push(format!(
            "|z| < eta, where eta decides, at {small:.1} % of the samples; z > 0, where the printed sign is wrong and the law \
             has a pole at z = eta, at {:.0} %",
            percent(z, |z| *z > 0.0),
        )),
        LawForm::Solved(ThesisForm::Damped) => parts.push("eta damps and leaves no bias".to_owned()),
        LawForm::Solved(_) => {
            parts.push(format!("|z| < eta, where eta draws the estimate to zero, at {small:.1} % of the samples"));
        }
    }
    if law.surface != Surface::Own
        && let Some(ratio) = speed_over_alpha(reference, law, run, from..end)
    {
        parts.push(format!("the V part of the surface is {ratio:.1e} times its alpha part (rms)"));
    }
    match left.and_then(|k| run.time_s.get(k)) {
        Some(time) => {
            parts.push(format!("more than {AWAY} half widths outside the bounds at {time:.2} s for the first time"))
        }
        None if law.form == LawForm::Solved(ThesisForm::Damped) => {}
        None => parts.push(format!(
            "K between {:.1e} and {:.1e}; the reaching condition s s' <= -eta |s| holds at {:.0} % of the samples",
            inside.iter().map(|d| d.gain).fold(f64::INFINITY, f64::min),
            inside.iter().map(|d| d.gain).fold(f64::NEG_INFINITY, f64::max),
            percent(inside, |d| d.reaching <= 0.0),
        )),
    }
    parts.push(late(case, reference, law, found, run));
    parts.join("; ")
}

fn percent<T>(values: &[T], holds: impl Fn(&T) -> bool) -> f64 {
    100.0 * values.iter().filter(|value| holds(value)).count() as f64 / values.len().max(1) as f64
}

/// `z = dD/dtheta` of the law's surface along the true motion, in units of its channels.
fn slopes(case: &AircraftCase, reference: &Reference, law: &LawSettings) -> Vec<f64> {
    let Some(index) = reference.names.iter().position(|name| name == law.parameter) else { return Vec::new() };
    let mut theta = [0.0; ROOM];
    theta.iter_mut().zip(&reference.names).for_each(|(slot, name)| *slot = case.truth(name));
    let mut lin = LinearizedRates::<STATES, ROOM>::ZERO;
    let channels = law.surface.channels(law.parameter);
    let at = |(x, input)| {
        reference.model.linearized_rates(x, &theta, input, &mut lin);
        channels.iter().map(|&(i, scale)| x[i] * lin.regressors[i][index] / (scale * scale)).sum()
    };
    reference.states.iter().zip(&reference.inputs).map(at).collect()
}

/// How much more the speed's part of `E` weighs than that of the angle of attack, rms over samples; none where the surface
/// does not have both.
fn speed_over_alpha(
    reference: &Reference,
    law: &LawSettings,
    run: &MethodRun,
    samples: std::ops::Range<usize>,
) -> Option<f64> {
    let channels = law.surface.channels(law.parameter);
    let part = |wanted: usize| {
        let (i, scale) = *channels.iter().find(|(state, _)| *state == wanted)?;
        let pairs = run.states.get(samples.clone())?.iter().zip(reference.states.get(samples.clone())?);
        let energy = |(x, y): (&[f64; STATES], &[f64; STATES])| (x[i] * x[i] - y[i] * y[i]) / (2.0 * scale * scale);
        Some(pairs.map(energy).map(|e| e * e).sum::<f64>().sqrt())
    };
    let ratio = part(0)? / part(1)?;
    ratio.is_finite().then_some(ratio)
}
