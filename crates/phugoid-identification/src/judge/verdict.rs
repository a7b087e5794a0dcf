//! The verdict on an estimation, in sentences.

use phugoid_estimators::DetectorState;
use phugoid_estimators::verdict::Readiness;
use phugoid_flight_data::plausibility::Doubt;

use crate::core::axes::Axes;
use crate::core::estimation::{BatchReport, EventKind, FinalStatus, History, ParameterResult, Signal};
use crate::methods::{Run, Task};
use crate::motion::Motion;

/// Theil's coefficient up to which a prediction counts as good (Jategaonkar, Flight Vehicle System Identification, ch.
/// 11).
const GOOD_PREDICTION: f64 = 0.3;
/// Correlation from which two parameters are said to be indistinguishable.
const INDISTINGUISHABLE: f64 = 0.99;
/// Correlation from which two parameters are said to depend on each other.
const CORRELATED: f64 = 0.95;
/// Share of an output's samples beyond six sigmas from which, if they also come in runs, the model is said to
/// contradict the flight. Sensors that throw single bad values do not make runs.
const CONTRADICTED: f64 = 0.05;
/// Lag-one correlation of clipped residuals from which they are called coloured.
const COLOURED: f64 = 0.4;

pub(crate) fn verdict<M: Motion<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    parameters: &[ParameterResult],
    correlation: &[Vec<f64>],
    run: &Run<R>,
    doubts: &[Doubt],
    history: &History,
) -> Vec<String> {
    let mut sentences = Vec::new();
    let pairs = pairs(parameters, correlation);
    if run.excited {
        contradiction(&history.residuals, &mut sentences);
        excitation(parameters, &pairs, &mut sentences);
        tell_pairs(parameters, &pairs, &mut sentences);
        advice(parameters, &mut sentences);
        changes(parameters, run, is_contradicted(&history.residuals), &mut sentences);
        residuals(&history.residuals, run, &mut sentences);
    } else {
        no_excitation(M::AXES, &history.measured, &mut sentences);
    }
    let measured: Vec<String> = M::AXES
        .outputs()
        .iter()
        .zip(task.noise)
        .filter(|(_, level)| level.measured)
        .map(|(o, level)| format!("{} {:.3e} {}", o.name(), level.std, o.unit()))
        .collect();
    if !measured.is_empty() && run.batch.is_none() {
        sentences.push(format!("Noise levels measured from the record, one sigma: {}.", measured.join(", ")));
    }
    if let Some(report) = &run.batch {
        batch(report, &mut sentences);
    }
    sentences.extend(doubts.iter().map(|d| format!("Check the units: {}.", d.to_string().trim_end_matches('.'))));
    sentences.extend(task.prepared.notes.iter().map(|n| format!("{}.", capitalised(n))));
    sentences
}

/// The sentences about a batch method: its notes, and how well its parameters predict another record.
fn batch(report: &BatchReport, sentences: &mut Vec<String>) {
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
    }
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |c| c.to_uppercase().chain(characters).collect())
}

/// Two parameters and their correlation.
type Pair = (f64, usize, usize);

fn no_excitation(axes: Axes, measured: &[Signal], sentences: &mut Vec<String>) {
    let [movers, manoeuvre] = axes.excitation_words();
    sentences.push(format!(
        "No excitation: {movers} never move beyond their noise. Steady flight tells at \
         most sums of terms, so all parameters and their bounds are still those given beforehand. Fly {manoeuvre}."
    ));
    if measured.iter().all(|signal| signal.values.windows(2).all(|pair| pair[0] == pair[1])) {
        sentences.push("Every measured output is exactly constant: the recorder was frozen.".to_owned());
    }
}

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
        sentences.push(format!("In doubt, since the model contradicts the flight: {}.", doubtful.join(", ")));
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

fn changes<const R: usize>(
    parameters: &[ParameterResult],
    run: &Run<R>,
    contradicted: bool,
    sentences: &mut Vec<String>,
) {
    let times: Vec<String> =
        run.events.iter().filter(|e| e.kind == EventKind::Adopted).map(|e| format!("{:.2} s", e.time_s)).collect();
    if !times.is_empty() {
        let (times, doubt) =
            (times.join(", "), if contradicted { ", or what contradicts the model looks like it" } else { "" });
        sentences.push(format!("The parameters changed in flight{doubt}: found at {times}."));
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

/// How the whitened residuals of one output are spread, once there are enough of them.
struct Spread {
    /// Number of samples that have a residual.
    present: usize,
    /// Number of residuals beyond six standard deviations.
    outliers: usize,
    /// Lag-one correlation, outliers clipped to three sigmas.
    colour: f64,
}

impl Spread {
    fn of(signal: &Signal) -> Option<Self> {
        Self::of_values(signal.values.iter().copied())
    }

    fn of_values(values: impl Iterator<Item = f64>) -> Option<Self> {
        let present: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        if present.len() < 20 {
            return None;
        }
        let core: Vec<f64> = present.iter().map(|v| v.clamp(-3.0, 3.0)).collect();
        let power: f64 = core.iter().map(|v| v * v).sum();
        let lagged: f64 = core.windows(2).map(|w| w[0] * w[1]).sum();
        Some(Self {
            present: present.len(),
            outliers: present.iter().filter(|v| v.abs() > 6.0).count(),
            colour: if power > 0.0 { lagged / power } else { 0.0 },
        })
    }

    fn contradicts(&self) -> bool {
        self.outliers as f64 > CONTRADICTED * self.present as f64 && self.colour > COLOURED
    }
}

/// Whether some output disagrees with its prediction so often, and in runs, that it is the model that is wrong. The
/// contradicting samples were rejected, so that bounds from the remaining samples alone are too small.
pub(crate) fn is_contradicted(residuals: &[Signal]) -> bool {
    residuals.iter().filter_map(Spread::of).any(|spread| spread.contradicts())
}

/// The lag-one correlation of an output's whitened residuals, if they are coloured.
pub(crate) fn colour(residuals: impl Iterator<Item = f64>) -> Option<f64> {
    Spread::of_values(residuals).map(|spread| spread.colour).filter(|colour| *colour > COLOURED)
}

fn contradiction(residuals: &[Signal], sentences: &mut Vec<String>) {
    let named: Vec<String> = residuals
        .iter()
        .filter_map(|signal| Spread::of(signal).filter(Spread::contradicts).map(|s| (signal, s)))
        .map(|(signal, s)| format!("{:.0} % of {}", 100.0 * s.outliers as f64 / s.present as f64, signal.name))
        .collect();
    if !named.is_empty() {
        sentences.push(format!(
            "The model contradicts this flight: more than six sigmas away are {}. Do not use these numbers, nor their \
             bounds. Look for a wrong unit, sign or time, a delay or an offset of a sensor, a wrong mass or geometry, or \
             noise levels that are too small.",
            named.join(", ")
        ));
    }
}

/// Outliers, and residuals that are not white.
fn residuals<const R: usize>(residuals: &[Signal], run: &Run<R>, sentences: &mut Vec<String>) {
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
