//! The result of an estimation as text and as JSON.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use phugoid_flight_data::quality::QualityReport;
use phugoid_identification::batch::OutputFit;
use phugoid_identification::estimation::{
    AdoptedChange, BatchReport, EffectiveDerivative, Estimation, EstimationStatus, Event, FinalStatus, History, Offer,
    OtherValue, ParameterResult, PredictionInterval, Readiness, SecondAnswer, Signal, TotalDerivative, VerdictReason,
    headline,
};
use serde::Serialize;

use super::axes_form::Turned;
use super::offer;
use crate::output::{Table, significant, wrapped};

/// The result of an estimation as a JSON document. Angles in rad, everything else in SI, derivatives per rad.
#[derive(Debug, Serialize)]
pub(crate) struct Document<'a> {
    pub(crate) source: &'a str,
    pub(crate) model: &'a str,
    pub(crate) method: &'a str,
    pub(crate) samples: usize,
    pub(crate) sample_time_s: f64,
    /// What the result as a whole is worth, and why it is not sound.
    pub(crate) status: EstimationStatus,
    pub(crate) reasons: &'a [VerdictReason],
    pub(crate) parameters: &'a [ParameterResult],
    /// Matrix; rows and columns in the order of `parameters`.
    pub(crate) correlation: &'a [Vec<f64>],
    /// Sums of derivatives of which the flight may not determine the single terms.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub(crate) effective: &'a [EffectiveDerivative],
    /// Of increments to a database, the derivatives that they make with its slopes.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub(crate) totals: &'a [TotalDerivative],
    /// The derivatives in the axes of `--axes-form`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) turned: Option<&'a Turned>,
    /// Terms that were tried because the model may lack them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offer: Option<&'a Offer>,
    pub(crate) verdict: &'a [String],
    pub(crate) events: &'a [Event],
    /// The changes that were adopted, with the estimates before and after each.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub(crate) changes: &'a [AdoptedChange],
    /// The parameters by a method of another kind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) second_answer: Option<&'a SecondAnswer>,
    /// The parameters by a filter, where the second answer is that of equation error beside another batch method.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) third_answer: Option<&'a SecondAnswer>,
    /// The parameters from what the surfaces explain of the motion.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub(crate) by_surfaces: &'a [OtherValue],
    pub(crate) quality: &'a QualityReport,
    pub(crate) noise: Vec<Noise<'a>>,
    /// Path of the report, if one was written.
    pub(crate) report: Option<PathBuf>,
    /// Paths of the figures that were written.
    pub(crate) figures: Vec<PathBuf>,
    /// Fit and prediction of a batch method.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) batch: Option<&'a BatchReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) history: Option<&'a History>,
}

/// Standard deviation of the measurement noise of one output.
#[derive(Debug, Serialize)]
pub(crate) struct Noise<'a> {
    name: &'a str,
    unit: &'a str,
    sigma: f64,
}

impl<'a> Document<'a> {
    pub(crate) fn new(estimation: &'a Estimation, report: Option<PathBuf>, figures: Vec<PathBuf>) -> Self {
        let sigma = |signal: &Signal| signal.values.first().copied().unwrap_or(f64::NAN);
        Self {
            source: &estimation.source,
            model: &estimation.model,
            method: estimation.method.name(),
            samples: estimation.history.time_s.len(),
            sample_time_s: estimation.quality.sample_time_s,
            status: estimation.status,
            reasons: &estimation.reasons,
            parameters: &estimation.parameters,
            correlation: &estimation.correlation,
            effective: &estimation.effective,
            totals: &estimation.totals,
            turned: None,
            offer: estimation.offer.as_ref(),
            verdict: &estimation.verdict,
            events: &estimation.events,
            changes: &estimation.changes,
            second_answer: estimation.second_answer.as_ref(),
            third_answer: estimation.third_answer.as_ref(),
            by_surfaces: &estimation.by_surfaces,
            quality: &estimation.quality,
            noise: estimation.noise.iter().map(|s| Noise { name: &s.name, unit: &s.unit, sigma: sigma(s) }).collect(),
            report,
            figures,
            batch: estimation.batch.as_ref(),
            history: None,
        }
    }
}

/// A result that must not be used says so before any number; nothing for others.
pub(crate) fn first_line(reasons: &[VerdictReason]) -> String {
    headline(reasons).map_or_else(String::new, |first| wrapped(&first).replacen("  ", "", 1) + "\n")
}

/// The result of an estimation as text.
pub(crate) fn text(estimation: &Estimation, report: Option<&Path>, figures: &[PathBuf]) -> String {
    let mut text = first_line(&estimation.reasons);
    let time = &estimation.history.time_s;
    if let (Some(first), Some(last)) = (time.first(), time.last()) {
        let _ = writeln!(
            text,
            "{}\n{} samples from {} s to {} s, model `{}`, estimator {}\n",
            estimation.source,
            time.len(),
            significant(*first, 4),
            significant(*last, 4),
            estimation.model,
            estimation.method
        );
    }
    text.push_str(&totals(&estimation.totals));
    text.push_str(&parameters(estimation));
    text.push_str(
        "\nDerivatives per radian. Bounds are two standard errors, corrected for the\ncolour of the residuals.\n",
    );
    text.push_str(&systematic(estimation));
    paragraph(&mut text, "Not ready", not_ready(estimation));
    if let Some(report) = &estimation.batch {
        text.push_str(&batch(report));
    }
    paragraph(&mut text, "Verdict", estimation.verdict.iter().cloned());
    if let Some(found) = &estimation.offer {
        text.push_str(&offer::text(found));
    }
    let event = |e: &Event| format!("{:8.2} s  {}", e.time_s, e.message);
    paragraph(&mut text, "Events", estimation.events.iter().map(event));
    paragraph(&mut text, "Data quality", warnings(&estimation.quality));
    if let Some(report) = report {
        let _ = writeln!(text, "\nReport with figures: {}", report.display());
    }
    if let Some(folder) = figures.first().and_then(|f| f.parent()) {
        let _ = writeln!(text, "{} figure files in {}", figures.len(), folder.display());
    }
    text
}

/// The derivatives that increments make with the slopes of their database; empty of a model without one.
fn totals(totals: &[TotalDerivative]) -> String {
    let Some(first) = totals.first() else { return String::new() };
    let mut table = Table::with_words(
        &["derivative", "total", "+- 2 sigma", "database", "increment", "+- 2 sigma", "over", "verdict"],
        &[0, 6, 7],
    );
    for t in totals {
        let ([from, to], unit) = t.printed_range();
        table.row(vec![
            t.name.clone(),
            significant(t.value, 4),
            significant(2.0 * t.std_error, 3),
            significant(t.database, 4),
            significant(t.value - t.database, 3),
            significant(2.0 * t.increment_std_error, 3),
            format!("{} to {} {unit}", significant(from, 3), significant(to, 3)).trim_end().to_owned(),
            t.status.word().replace('_', " "),
        ]);
    }
    format!(
        "Total derivatives at alpha {} deg, elevator {} deg\n{}  Database: the secant over what was flown. The bound of a total \
         is for a database of the right\n  shape; that of an increment holds how much the slope changes over the range.\n\n",
        significant(first.reference_alpha.to_degrees(), 3),
        significant(first.reference_elevator.to_degrees(), 3),
        table.render()
    )
}

/// The bounds in their random and their systematic part, and what makes the latter; empty where nothing is declared.
fn systematic(estimation: &Estimation) -> String {
    let mut table = Table::with_words(&["parameter", "random", "systematic", "which comes from"], &[0, 3]);
    let mut any = false;
    for p in estimation.parameters.iter().filter(|p| p.systematic_std > 0.0) {
        any = true;
        table.row(vec![
            p.name.clone(),
            significant(2.0 * p.random_std(), 3),
            significant(2.0 * p.systematic_std, 3),
            p.contributors_in_words(3),
        ]);
    }
    if any { format!("\nParts of the bounds, +- 2 sigma\n{}", table.render()) } else { String::new() }
}

/// Text about fit and prediction of a batch method.
fn batch(report: &BatchReport) -> String {
    let mut text = String::new();
    for (name, fits) in &report.manoeuvres {
        let band = report.band.as_ref().map_or_else(String::new, |band| format!(" from {band}"));
        let _ = write!(text, "\nFit of {name}{band}\n{}", fit(fits));
    }
    if let Some(prediction) = &report.prediction {
        let _ = write!(text, "\nPrediction of {}, parameters held\n{}", prediction.source, fit(&prediction.fit));
        text.push_str(&intervals(&prediction.intervals));
    }
    text
}

/// The prediction intervals; empty where the method gives none.
fn intervals(intervals: &[PredictionInterval]) -> String {
    if intervals.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["prediction interval of", "median sigma", "measured within 2 sigma %"]);
    for i in intervals {
        table.row(vec![i.name.clone(), significant(i.median_std(), 3), format!("{:.1}", 100.0 * i.within)]);
    }
    format!("\n{}", table.render())
}

fn fit(fits: &[OutputFit]) -> String {
    let mut table = Table::new(&["output", "rms", "R^2", "Theil", "bias", "variance", "covariance", "white"]);
    for f in fits {
        table.row(vec![
            f.name.clone(),
            significant(f.rms, 3),
            format!("{:.4}", f.r_squared),
            format!("{:.4}", f.theil),
            format!("{:.2}", f.theil_bias),
            format!("{:.2}", f.theil_variance),
            format!("{:.2}", f.theil_covariance),
            if f.white { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table.render()
}

/// Appends a heading and the wrapped sentences below it; appends nothing if there are no sentences.
pub(crate) fn paragraph(text: &mut String, title: &str, lines: impl Iterator<Item = String>) {
    for (index, line) in lines.enumerate() {
        if index == 0 {
            let _ = writeln!(text, "\n{title}");
        }
        text.push_str(&wrapped(&line));
    }
}

/// The warnings of a quality report, each with its place.
pub(crate) fn warnings(quality: &QualityReport) -> impl Iterator<Item = String> + '_ {
    quality.warnings().map(|finding| match finding.place.as_str() {
        "" => finding.message.clone(),
        place => format!("{place}: {}", finding.message),
    })
}

/// Reasons why parameters are not ready, without those that only support others. The advice is part of the verdict.
fn not_ready(estimation: &Estimation) -> impl Iterator<Item = String> + '_ {
    estimation.parameters.iter().filter(|p| !p.nuisance).filter_map(|p| {
        let readiness = p.readiness.as_ref().filter(|r| r.verdict != Readiness::Ready)?;
        Some(format!("{}: {}, {}", p.name, readiness.verdict.word().replace('_', " "), readiness.reason))
    })
}

/// The table of parameters; sensor biases and other supporting parameters come last.
fn parameters(estimation: &Estimation) -> String {
    let truth_known = estimation.parameters.iter().any(|p| p.truth.is_some());
    let mut header = vec!["parameter", "estimate", "+- 2 sigma", "+- %"];
    if truth_known {
        header.extend(["truth", "error/sigma"]);
    }
    header.extend(["converged at", "verdict"]);
    let table = |nuisance: bool| {
        let mut table = Table::new(&header);
        let chosen: Vec<&ParameterResult> = estimation.parameters.iter().filter(|p| p.nuisance == nuisance).collect();
        for p in &chosen {
            let two_sigma = 2.0 * p.corrected_std_error;
            let fixed = p.status == FinalStatus::Fixed;
            let dash = || "-".to_owned();
            let percent = 100.0 * two_sigma / p.value.abs();
            let mut cells = vec![
                p.name.clone(),
                significant(p.value, 5),
                if fixed { dash() } else { significant(two_sigma, 3) },
                // Of a value that is zero but for rounding nothing is said.
                if fixed || p.value == 0.0 || percent > 1e6 { dash() } else { significant(percent, 3) },
            ];
            if truth_known {
                cells.push(p.truth.map_or_else(dash, |t| significant(t, 5)));
                let error = |t: f64| format!("{:+.1}", (p.value - t) / p.corrected_std_error);
                cells.push(p.truth.filter(|_| !fixed).map_or_else(dash, error));
            }
            cells.push(p.converged_at_s.map_or_else(dash, |t| format!("{t:.2} s")));
            cells.push(p.status.word().replace('_', " "));
            table.row(cells);
        }
        if chosen.is_empty() { String::new() } else { table.render() }
    };
    let (main, nuisance) = (table(false), table(true));
    if nuisance.is_empty() {
        main
    } else {
        format!("{main}\nSensor errors and offsets, estimated beside them\n{nuisance}")
    }
}
