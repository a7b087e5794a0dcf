//! `phugoid monitor`.

use phugoid_flight_data::output_file;
use phugoid_flight_data::quality::QualityReport;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::estimation::Estimation;
use phugoid_identification::health::{Condition, FALSE_ALARMS_PER_HOUR, HealthOptions, HealthReport};
use phugoid_identification::model_file::{Expectation, ModelFile};
use phugoid_identification::monitor::monitor;
use serde::Serialize;

use super::deleting::Deletions;
use super::estimate::model;
use super::result::{paragraph, warnings};
use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, deliver, fixed, significant};
use crate::progress::Progress;

/// Runs the monitor; true if a coefficient has left its expected range.
pub(crate) fn run(arguments: &arguments::Monitor) -> Result<bool, Failure> {
    let model = model(&arguments.model)?;
    let expected = match &arguments.expected {
        Some(file) => expected(file, &model)?,
        None => model.expectations(),
    };
    let false_alarms_per_hour = arguments.false_alarms_per_hour.unwrap_or(FALSE_ALARMS_PER_HOUR);
    let record = {
        let _progress = Progress::spinner("reading");
        let deletions = Deletions::new(&arguments.deleting, &[&arguments.flight])?;
        let mut record = model
            .open_record_with(&arguments.flight, &arguments.reading.options(&arguments.flight)?)
            .map_err(Failure::input)?;
        deletions.apply(&mut record, &arguments.flight, true)?;
        record
    };
    let (estimation, report) = {
        let progress = Progress::new("monitoring");
        let health = HealthOptions { expected, false_alarms_per_hour };
        monitor(&record, &model, &EstimateOptions::default(), &health, &mut |done| progress.set(done))?
    };
    let figures = match &arguments.out {
        Some(folder) => write(folder, &report, &estimation)?,
        None => Vec::new(),
    };
    let document = Document::new(&report, &estimation.quality, arguments.history, &figures);
    deliver(&document, arguments.json, None, || text(&report, &estimation.quality, &figures))?;
    Ok(report.condition == Condition::Diverged)
}

/// Reads the table `expected` from the file of `--expected`.
fn expected(file: &Path, model: &ModelFile) -> Result<Vec<Expectation>, Failure> {
    let name = file.display().to_string();
    let text = std::fs::read_to_string(file)
        .map_err(|error| Failure::input(format!("cannot read the expectations `{name}`: {error}")))?;
    model.parse_expected(&name, &text).map_err(Failure::input)
}

/// Writes `health.json`, with the histories, and the estimation's report and gives the paths.
fn write(folder: &Path, report: &HealthReport, estimation: &Estimation) -> Result<Vec<PathBuf>, Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::writing(folder, e))?;
    let json = folder.join("health.json");
    let document = crate::output::json(&Document::new(report, &estimation.quality, true, &[]))?;
    output_file::write(&json, document).map_err(|e| Failure::writing(&json, e))?;
    let page = folder.join("report.html");
    let html = phugoid_report::html(estimation, &phugoid_report::HtmlOptions::default());
    output_file::write(&page, html).map_err(|e| Failure::writing(&page, e))?;
    Ok(vec![json, page])
}

/// The result as a JSON document. Derivatives per rad, everything else SI.
#[derive(Serialize)]
struct Document<'a> {
    source: &'a str,
    model: &'a str,
    condition: Condition,
    false_alarms_per_hour: f64,
    /// Whether that rate is promised for this flight, and what was checked.
    promise: &'a phugoid_identification::health::Promise,
    /// Flight time, hours, in which a healthy aircraft shows evidence as large as this at most once; null where no rate
    /// is promised.
    evidence_hours: Option<f64>,
    parameters: &'a [phugoid_identification::health::ParameterHealth],
    failure: Option<&'a phugoid_identification::health::FailureReport>,
    sentences: &'a [String],
    /// What the reader found, assumed and left out, and what was deleted.
    quality: &'a QualityReport,
    files: &'a [PathBuf],
    #[serde(skip_serializing_if = "Option::is_none")]
    history: Option<&'a phugoid_identification::health::HealthHistory>,
}

impl<'a> Document<'a> {
    fn new(report: &'a HealthReport, quality: &'a QualityReport, history: bool, files: &'a [PathBuf]) -> Self {
        Self {
            source: &report.source,
            model: &report.model,
            condition: report.condition,
            false_alarms_per_hour: report.false_alarms_per_hour,
            promise: &report.promise,
            evidence_hours: report.promise.holds.then(|| report.evidence.exp()),
            parameters: &report.parameters,
            failure: report.failure.as_ref(),
            sentences: &report.sentences,
            quality,
            files,
            history: history.then_some(&report.history),
        }
    }
}

/// The result as text.
fn text(report: &HealthReport, quality: &QualityReport, files: &[PathBuf]) -> String {
    let mut text = String::new();
    let time = &report.history.time_s;
    if let (Some(first), Some(last)) = (time.first(), time.last()) {
        let _ = writeln!(
            text,
            "{}\n{} samples from {} s to {} s, model `{}`, set to {} false alarms per flight hour{}\n",
            report.source,
            time.len(),
            significant(*first, 4),
            significant(*last, 4),
            report.model,
            report.false_alarms_per_hour,
            if report.promise.holds { "" } else { ", which are not promised" }
        );
    }
    let _ = writeln!(text, "  {}\n", report.condition.words().to_uppercase());
    let mut table = Table::new(&["parameter", "expected", "+-", "estimate", "+- 2 sigma", "outside", "verdict"]);
    for p in &report.parameters {
        let verdict = match p.diverged_at_s {
            Some(at) => format!("diverged at {at:.2} s"),
            None if !p.known => "not enough information".to_owned(),
            None if p.deviation.abs() > 2.0 && report.failure.is_some() => "outside by now".to_owned(),
            None if p.deviation.abs() > 2.0 => "outside, not certain".to_owned(),
            None => "as expected".to_owned(),
        };
        table.row([
            p.name.clone(),
            significant(p.expected, 4),
            significant(p.tolerance, 3),
            significant(p.value, 4),
            significant(2.0 * p.corrected_std_error, 3),
            if p.deviation == 0.0 { "-".to_owned() } else { format!("{} sigma", fixed(p.deviation, 1)) },
            verdict,
        ]);
    }
    text.push_str(&table.render());
    text.push_str("\nDerivatives per radian; estimates at the end of the record.\n");
    paragraph(&mut text, "Health", report.sentences.iter().cloned());
    paragraph(&mut text, "Data quality", warnings(quality));
    let mut last = None;
    let changes = time
        .iter()
        .zip(&report.history.condition)
        .filter(|(_, condition)| last.replace(**condition) != Some(**condition));
    let changes: Vec<String> = changes.map(|(t, condition)| format!("{t:8.2} s  {}", condition.words())).collect();
    const SHOWN: usize = 12;
    let more = changes.len().saturating_sub(SHOWN);
    paragraph(&mut text, "History", changes.into_iter().take(SHOWN));
    if more > 0 {
        let _ = writeln!(text, "  and {more} further changes (--json --history has them all)");
    }
    for file in files {
        let _ = writeln!(text, "{}{}", if file == &files[0] { "\nWritten: " } else { "         " }, file.display());
    }
    text
}
