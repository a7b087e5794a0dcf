//! What a store says of each log, as a document that another program can show beside the log.
//!
//! The list `diagnostics` has the form of what the analyzers of Flight Review 2 give: an identifier, a sentence, a severity, the
//! time by the clock of the autopilot, and evidence whose `type` says which fields it has (`crates/converter/src/diagnostics/mod.rs`
//! of <https://github.com/PX4/flight-review-rs>, 2026). A server that shows these documents needs the types of evidence of
//! [`Evidence`] beside its own.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::key::VERSION;
use crate::logs::LogRow;
use crate::row::Row;
use crate::statistics::cause::Together;
use crate::statistics::tell::{Airframe, Course, Findings, Point, Set, Shape, one_for_each_path, rows_of};

/// Number of the form of the document. It changes when a field changes its name, type or meaning.
pub const FORM: u32 = 1;

/// What is known of one log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    /// Always `phugoid`.
    pub analyzer: &'static str,
    /// Version of the program that wrote the document. The version that estimated is in `set`.
    pub analyzer_version: &'static str,
    /// [`FORM`].
    pub form: u32,
    /// The log.
    pub log: LogRow,
    /// What was estimated, with which model and method.
    pub set: Set,
    /// What the times count from.
    pub clock: Clock,
    /// What was found: the results of its segments in their order, then what the other flights say of them.
    pub diagnostics: Vec<Diagnostic>,
}

/// What the times of a document count from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// The moment at which the autopilot was switched on, as in its log.
    Autopilot,
    /// Time zero of the log's record: the log has no such clock, or the row was written before it was kept.
    Record,
}

/// How much a diagnostic matters to whoever looks at the log. Nothing here is certain enough of a fault to be called critical.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// Worth looking at.
    Warning,
}

/// One thing that is known of a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnostic {
    /// What kind it is, as a word: that of the evidence.
    pub id: &'static str,
    /// A sentence for the reader.
    pub summary: String,
    /// How much it matters.
    pub severity: Severity,
    /// Its beginning, microseconds by [`Document::clock`].
    pub timestamp_us: u64,
    /// Its end; none of something that has no end in the log.
    pub end_timestamp_us: Option<u64>,
    /// The numbers behind the sentence.
    pub evidence: Evidence,
}

/// The numbers behind a diagnostic, told apart by `type`. Values and bounds are in `unit`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type")]
pub enum Evidence {
    /// The estimates of a segment.
    AerodynamicDerivatives {
        /// Number of the manoeuvre from 1; 0 for the whole flight.
        segment: i64,
        /// What moved.
        input: Option<String>,
        /// What the result is worth: `sound`, `provisional`, `doubtful`, `refused`.
        status: String,
        /// Words of the reasons against it.
        reasons: Vec<String>,
        /// Median true airspeed, m/s.
        airspeed_m_s: Option<f64>,
        /// Median angle of attack, rad.
        alpha_rad: Option<f64>,
        /// The derivatives, without offsets and biases.
        derivatives: Vec<Derivative>,
    },
    /// A log or a segment without numbers.
    AerodynamicDerivativesMissing {
        /// Number of the segment; none where the whole log was refused.
        segment: Option<i64>,
        /// Why, as a word.
        refusal: String,
    },
    /// A derivative of this flight lies apart from those of the other flights of its airframe.
    DerivativeDisagrees {
        /// Number of the segment.
        segment: i64,
        /// Name of the derivative.
        parameter: String,
        /// Its unit.
        unit: String,
        /// The estimate.
        value: f64,
        /// Distance from the course of the other flights, standard errors.
        sigmas: Option<f64>,
    },
    /// A derivative of the airframe steps at this flight, has drifted up to it, or differs from that of other airframes. The last
    /// two stand with the last flight of the airframe.
    DerivativeChanged {
        /// The airframe.
        airframe: String,
        /// Name of the derivative.
        parameter: String,
        /// Its unit.
        unit: String,
        /// What it does.
        change: ChangeKind,
        /// Size of the step, drift per flight (or hour), or distance from the other airframes.
        size: f64,
        /// One standard error of the size.
        std_error: f64,
        /// Rate of false findings at which it would just be one.
        rate: Option<f64>,
    },
    /// What explains the steps, the drifts or the distance of all derivatives of the airframe together. It stands with the flight of
    /// the step, or with the last flight.
    AirframeExplained {
        /// The airframe.
        airframe: String,
        /// What is explained, in words.
        what: String,
        /// The causes that explain all of it, the likeliest first.
        causes: Vec<Explained>,
    },
}

/// A cause that explains what the derivatives of an airframe do together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explained {
    /// The cause and its size, in words.
    pub cause: String,
    /// Probability of what it leaves unexplained; none where the sentence says that no cause explains it.
    pub p_value: Option<f64>,
}

/// What a derivative of an airframe does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeKind {
    /// It changes at this flight.
    Step,
    /// It changes from flight to flight.
    Drift,
    /// It is another one than that of the other airframes.
    Apart,
}

/// One estimate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Derivative {
    /// Name.
    pub parameter: String,
    /// Unit.
    pub unit: String,
    /// Estimate.
    pub value: Option<f64>,
    /// Lower bound, two standard errors with everything.
    pub lower: Option<f64>,
    /// Upper bound.
    pub upper: Option<f64>,
    /// How well it is known: `converged`, ...
    pub status: Option<String>,
}

/// The documents of all logs that have rows of the findings' set, in the order of their hashes. Rows and logs are those that the
/// findings were made of.
pub fn documents(rows: &[Row], logs: &[LogRow], findings: &Findings) -> Vec<Document> {
    let (logs, _) = one_for_each_path(logs);
    let mut by_log: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows_of(rows, &logs, &findings.set) {
        if let Some(hash) = row.source_sha256.as_deref() {
            by_log.entry(hash).or_default().push(row);
        }
    }
    let mut said = of_the_fleet(findings);
    let document = |log: &LogRow| {
        let rows = by_log.get(log.log_sha256.as_str())?;
        let zero_us = rows.iter().find_map(|row| row.clock_at_zero_us);
        let mut diagnostics = of_segments(rows);
        for Said { segment, id, summary, evidence } in said.remove(log.log_sha256.as_str()).unwrap_or_default() {
            let (timestamp_us, end_timestamp_us) = times(rows.iter().find(|row| row.segment == Some(segment)).copied());
            let severity = Severity::Warning;
            diagnostics.push(Diagnostic { id, summary, severity, timestamp_us, end_timestamp_us, evidence });
        }
        Some(Document {
            analyzer: "phugoid",
            analyzer_version: VERSION,
            form: FORM,
            log: log.clone(),
            set: findings.set.clone(),
            clock: if zero_us.is_some() { Clock::Autopilot } else { Clock::Record },
            diagnostics,
        })
    };
    logs.into_iter().filter_map(document).collect()
}

/// What the other flights say of a segment of a log.
struct Said {
    segment: i64,
    id: &'static str,
    summary: String,
    evidence: Evidence,
}

/// What the fleet says of each log, by its hash.
fn of_the_fleet(findings: &Findings) -> BTreeMap<&str, Vec<Said>> {
    let mut said: BTreeMap<&str, Vec<Said>> = BTreeMap::new();
    let mut say = |point: &'_ Point, hash, id, summary, evidence| {
        let said: &mut Vec<Said> = said.entry(hash).or_default();
        said.push(Said { segment: point.segment, id, summary, evidence });
    };
    for airframe in &findings.airframes {
        for together in &airframe.together {
            if let Some(point) = place_of(airframe, together) {
                let (summary, evidence) = explanation(airframe, together, findings.over.unit());
                say(point, point.log_sha256.as_str(), "airframe_explained", summary, evidence);
            }
        }
        for course in &airframe.courses {
            for point in course.points.iter().filter(|point| point.disagrees) {
                let (summary, evidence) = disagreement(airframe, course, point);
                say(point, point.log_sha256.as_str(), "derivative_disagrees", summary, evidence);
            }
            for (point, summary, evidence) in changes(airframe, course, findings) {
                say(point, point.log_sha256.as_str(), "derivative_changed", summary, evidence);
            }
        }
    }
    said
}

/// The flight with which it is told what explains an airframe.
fn place_of<'a>(airframe: &'a Airframe, together: &Together) -> Option<&'a Point> {
    let points = || airframe.courses.iter().flat_map(|course| &course.points);
    let by_place = |a: &&Point, b: &&Point| a.at.total_cmp(&b.at);
    match together.at {
        Some(at) => points().filter(|point| point.at >= at).min_by(by_place),
        None => points().max_by(by_place),
    }
}

fn explanation(airframe: &Airframe, together: &Together, unit: &str) -> (String, Evidence) {
    let lines = together.lines(unit);
    let what = together.words(unit);
    let causes: Vec<&str> = lines.iter().map(|(words, _)| words.as_str()).collect();
    let summary = format!("{}, {what}, all derivatives together: {}.", airframe.name, causes.join("; or "));
    let causes = lines.iter().map(|(words, p)| Explained { cause: words.clone(), p_value: *p }).collect();
    (summary, Evidence::AirframeExplained { airframe: airframe.name.clone(), what, causes })
}

fn disagreement(airframe: &Airframe, course: &Course, point: &Point) -> (String, Evidence) {
    let sigmas = point.sigmas.map(|sigmas| format!(" by {:.1} standard errors", sigmas.abs())).unwrap_or_default();
    let summary = format!(
        "{} is {} {} here, which lies apart from the other flights of {}{sigmas}.",
        course.parameter,
        short(point.value),
        course.unit,
        airframe.name
    );
    let evidence = Evidence::DerivativeDisagrees {
        segment: point.segment,
        parameter: course.parameter.clone(),
        unit: course.unit.clone(),
        value: point.value,
        sigmas: point.sigmas,
    };
    (summary, evidence)
}

/// Step, drift and distance of a course, with the flight at which each is told.
fn changes<'a>(
    airframe: &'a Airframe,
    course: &'a Course,
    findings: &Findings,
) -> impl Iterator<Item = (&'a Point, String, Evidence)> {
    let evidence = |change, size, std_error, rate| Evidence::DerivativeChanged {
        airframe: airframe.name.clone(),
        parameter: course.parameter.clone(),
        unit: course.unit.clone(),
        change,
        size,
        std_error,
        rate,
    };
    let words = |what: String, size: f64, std_error: f64, per: &str| {
        let Course { parameter, unit, .. } = course;
        let name = &airframe.name;
        format!("{parameter} of {name} {what}: {} +- {} {unit}{per} (two sigma).", short(size), short(2.0 * std_error))
    };
    let last = course.points.last();
    let changed = match course.shape {
        Shape::Step => course.step.and_then(|step| {
            let point = course.points.iter().find(|point| point.at >= step.at)?;
            let summary = words("steps at this flight".to_owned(), step.size, step.std_error, "");
            Some((point, summary, evidence(ChangeKind::Step, step.size, step.std_error, course.change_rate)))
        }),
        Shape::Drift => course.drift.zip(last).map(|(drift, point)| {
            let per = format!(" per {}", findings.over.unit());
            let summary = words("drifts".to_owned(), drift.size, drift.std_error, &per);
            (point, summary, evidence(ChangeKind::Drift, drift.size, drift.std_error, course.change_rate))
        }),
        Shape::Steady | Shape::TooFew => None,
    };
    let apart = course.apart.filter(|_| course.is_outlier).zip(last).map(|(apart, point)| {
        let std_error = (apart.distance / apart.sigmas).abs();
        let summary = words("differs from that of the other airframes".to_owned(), apart.distance, std_error, "");
        (point, summary, evidence(ChangeKind::Apart, apart.distance, std_error, course.apart_rate))
    });
    changed.into_iter().chain(apart)
}

/// The results of the segments of one log, in their order.
fn of_segments(rows: &[&Row]) -> Vec<Diagnostic> {
    let mut segments: BTreeMap<Option<i64>, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        segments.entry(row.segment).or_default().push(row);
    }
    let diagnostic = |rows: Vec<&Row>| {
        let first = *rows.first()?;
        let (timestamp_us, end_timestamp_us) = times(Some(first));
        let (id, summary, severity, evidence) = match &first.refusal {
            Some(refusal) => missing(first, refusal),
            None => estimated(first, &rows),
        };
        Some(Diagnostic { id, summary, severity, timestamp_us, end_timestamp_us, evidence })
    };
    segments.into_values().filter_map(diagnostic).collect()
}

fn missing(row: &Row, refusal: &str) -> (&'static str, String, Severity, Evidence) {
    let why = row.message.as_deref().unwrap_or(refusal);
    let evidence = Evidence::AerodynamicDerivativesMissing { segment: row.segment, refusal: refusal.to_owned() };
    let summary = format!("No aerodynamic derivatives{}: {why}", input_words(row));
    ("aerodynamic_derivatives_missing", summary, Severity::Info, evidence)
}

fn estimated(first: &Row, rows: &[&Row]) -> (&'static str, String, Severity, Evidence) {
    let derivative = |row: &&Row| {
        Some(Derivative {
            parameter: row.parameter.clone()?,
            unit: row.unit.clone().unwrap_or_default(),
            value: row.value,
            lower: row.lower,
            upper: row.upper,
            status: row.parameter_status.clone(),
        })
    };
    let derivatives: Vec<Derivative> =
        rows.iter().filter(|row| row.nuisance != Some(true)).filter_map(derivative).collect();
    let is_good = matches!(first.status.as_str(), "sound" | "provisional");
    // Numbers that the result itself warns of are left to the evidence, so that nobody reads them in a headline.
    let text = match (is_good, &first.message) {
        (true, _) => {
            let known = derivatives.iter().filter(|d| d.status.as_deref() == Some("converged")).filter_map(in_words);
            let known: Vec<String> = known.collect();
            match known.as_slice() {
                [] => "none has converged".to_owned(),
                known => known.join(", "),
            }
        }
        (false, Some(message)) => message.clone(),
        (false, None) => first.reasons.clone().unwrap_or_default(),
    };
    let summary = format!("Aerodynamic derivatives{} ({}): {text}", input_words(first), first.status);
    let reasons = first.reasons.as_deref().unwrap_or_default().split(',').filter(|word| !word.is_empty());
    let evidence = Evidence::AerodynamicDerivatives {
        segment: first.segment.unwrap_or_default(),
        input: first.input.clone(),
        status: first.status.clone(),
        reasons: reasons.map(str::to_owned).collect(),
        airspeed_m_s: first.airspeed_m_s,
        alpha_rad: first.alpha_rad,
        derivatives,
    };
    let severity = if is_good { Severity::Info } else { Severity::Warning };
    ("aerodynamic_derivatives", summary, severity, evidence)
}

/// ` from elevator 3-2-1-1`; nothing where the whole flight was taken.
fn input_words(row: &Row) -> String {
    row.input.as_ref().map(|input| format!(" from {input}")).unwrap_or_default()
}

/// `Cm_alpha -0.52 +- 0.03 1/rad`, with two standard errors.
fn in_words(d: &Derivative) -> Option<String> {
    let (value, upper) = d.value.zip(d.upper)?;
    Some(format!("{} {} +- {} {}", d.parameter, short(value), short(upper - value), d.unit).trim_end().to_owned())
}

/// Three digits of a number.
fn short(value: f64) -> String {
    let digits = format!("{value:.2e}");
    digits.parse::<f64>().map_or(digits, |rounded| rounded.to_string())
}

/// Beginning and end of the segment of a row, microseconds. What has no segment begins with the log.
fn times(row: Option<&Row>) -> (u64, Option<u64>) {
    let zero_us = row.and_then(|row| row.clock_at_zero_us).unwrap_or_default() as f64;
    // Times before the clock began, which no autopilot writes, become zero.
    let at = |time_s: f64| (zero_us + 1e6 * time_s).round() as u64;
    (at(row.and_then(|row| row.from_s).unwrap_or_default()), row.and_then(|row| row.to_s).map(at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::tell::{Question, tell};

    fn row(hash: &str, value: f64) -> Row {
        Row {
            kind: "log".to_owned(),
            source_sha256: Some(hash.to_owned()),
            status: "sound".to_owned(),
            segment: Some(1),
            input: Some("elevator 3-2-1-1".to_owned()),
            from_s: Some(2.0),
            to_s: Some(9.5),
            clock_at_zero_us: Some(7_000_001),
            parameter: Some("Cm_alpha".to_owned()),
            unit: Some("1/rad".to_owned()),
            parameter_status: Some("converged".to_owned()),
            value: Some(value),
            std_error: Some(0.02),
            random_std: Some(0.002),
            lower: Some(value - 0.04),
            upper: Some(value + 0.04),
            ..Row::default()
        }
    }

    /// Eight flights, of which the seventh has another value, and one that was refused.
    fn store() -> (Vec<Row>, Vec<LogRow>) {
        let (mut rows, mut logs) = (Vec::new(), Vec::new());
        for flight in 0..9_u8 {
            let hash = format!("{flight:064}");
            rows.push(match flight {
                8 => Row { segment: None, parameter: None, ..row(&hash, 0.0) }
                    .refused(crate::row::Refusal::NoManoeuvre, "no surface moved"),
                6 => row(&hash, -0.9),
                _ => row(&hash, -0.5 + 0.001 * f64::from(flight % 3)),
            });
            rows.push(Row { parameter: Some("Cm_bias".to_owned()), nuisance: Some(true), ..row(&hash, 0.0) });
            if flight == 8 {
                rows.pop();
            }
            let path = format!("logs/{flight}.ulg");
            logs.push(LogRow { log_sha256: hash, path, airframe: "N17".to_owned(), ..LogRow::default() });
        }
        (rows, logs)
    }

    #[test]
    fn each_log_has_its_results_and_what_the_others_say_of_it() {
        let (rows, logs) = store();
        let findings = tell(&rows, &logs, &Question::default()).unwrap();
        let documents = documents(&rows, &logs, &findings);
        assert_eq!(documents.len(), 9);
        let ids = |k: usize| documents[k].diagnostics.iter().map(|d| d.id).collect::<Vec<_>>();
        assert_eq!(ids(0), ["aerodynamic_derivatives"]);
        assert_eq!(ids(6), ["aerodynamic_derivatives", "derivative_disagrees"]);
        assert_eq!(ids(8), ["aerodynamic_derivatives_missing"]);
        let first = serde_json::to_value(&documents[0].diagnostics[0]).unwrap();
        assert_eq!(first["timestamp_us"], 9_000_001);
        assert_eq!(first["end_timestamp_us"], 16_500_001);
        assert_eq!(first["severity"], "info");
        assert_eq!(first["evidence"]["type"], "AerodynamicDerivatives");
        assert_eq!(first["evidence"]["derivatives"].as_array().unwrap().len(), 1, "a bias is no derivative");
        assert_eq!(
            first["summary"],
            "Aerodynamic derivatives from elevator 3-2-1-1 (sound): Cm_alpha -0.5 +- 0.04 1/rad"
        );
        assert_eq!(documents[6].diagnostics[1].severity, Severity::Warning);
        // A log without a time has its beginning, and a document says which clock it means.
        assert_eq!(documents[8].diagnostics[0].timestamp_us, 7_000_001 + 2_000_000);
    }

    #[test]
    fn numbers_that_the_result_warns_of_stand_in_no_headline() {
        let (mut rows, logs) = store();
        rows[0].status = "doubtful".to_owned();
        rows[0].message = Some("The elevator is late.".to_owned());
        let findings = tell(&rows, &logs, &Question::default()).unwrap();
        let documents = documents(&rows, &logs, &findings);
        let warned = &documents[0].diagnostics[0];
        assert_eq!(warned.severity, Severity::Warning);
        assert_eq!(warned.summary, "Aerodynamic derivatives from elevator 3-2-1-1 (doubtful): The elevator is late.");
    }
}
