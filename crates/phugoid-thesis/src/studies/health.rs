//! Health monitoring, what the thesis is for: the flag against its promise, one failure in full, and many.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::health::HealthOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::monitor::monitor;

use crate::entry::Entry;
use crate::result::Reproduction;
use crate::result::Requirement;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::health::{FailureStudy, Stick, failures, healthy};
use phugoid_evaluation::published::{FAILURE_SCENARIO, HEALTH_MODEL, HEALTHY_SCENARIO};
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// The entries of this group.
pub(crate) const ENTRIES: &[Entry] = &[
    Entry { id: "health/healthy", title: "Healthy flights: false alarms against the promise", run: healthy_flights },
    Entry { id: "health/failure", title: "A failure in flight: deviation, flag and onset", run: one_failure },
    Entry { id: "health/statistics", title: "Many failures: missed, latency, onset", run: many_failures },
];

/// Healthy flights of a minute in the report; `phugoid study health` flies more.
const HEALTHY_RUNS: usize = 12;
/// Failures in the report, by stick; `phugoid study health` flies more of them too.
const FAILURE_RUNS: usize = 25;
/// Accepted false alarms per flight hour.
const RATE: f64 = 0.01;

const PUBLISHED: &str = "The thesis is written for vehicle health monitoring: coefficients estimated in flight are to be compared \
                         with those that are expected, so that damage or icing is noticed. It shows no such comparison.";

fn scenario(text: &str, name: &str) -> Result<Scenario, StudyError> {
    Scenario::parse(text, name).map_err(|error| StudyError::Flight(error.into()))
}

fn model() -> Result<ModelFile, StudyError> {
    ModelFile::parse("f16-health-model", HEALTH_MODEL).map_err(StudyError::unsuitable)
}

fn blank(id: &str) -> Reproduction {
    Reproduction {
        id: id.to_owned(),
        title: ENTRIES.iter().find(|e| e.id == id).map_or_else(String::new, |e| e.title.to_owned()),
        place: "abstract and chapter 1".to_owned(),
        published: PUBLISHED.to_owned(),
        ..Reproduction::default()
    }
}

/// Counts runs for the progress.
fn counted<'a>(progress: &'a (dyn Fn(f64) + Sync), all: usize, done: &'a AtomicUsize) -> impl Fn() + Sync + 'a {
    move || progress((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / all as f64)
}

fn healthy_flights(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let done = AtomicUsize::new(0);
    let scenario = scenario(HEALTHY_SCENARIO, "f16-healthy")?;
    let study = healthy(&scenario, &model()?, HEALTHY_RUNS, &counted(progress, HEALTHY_RUNS, &done))?;
    let mut table = Table {
        title: format!("{} healthy flights, {:.2} h monitored", study.runs, study.hours),
        columns: vec![
            Column::new("accepted rate", "1/h"),
            Column::new("flights with a false alarm", ""),
            Column::new("promised at most", ""),
            Column::new("found per flight, lower 95 %", ""),
            Column::new("upper 95 %", ""),
        ],
        rows: Vec::new(),
    };
    let mut requirements = Vec::new();
    for alarms in &study.false_alarms {
        let cells = [alarms.accepted_per_hour, alarms.flights as f64, alarms.promised];
        table.rows.push(cells.into_iter().chain(alarms.interval).map(Cell::from).collect());
        requirements.push(Requirement {
            what: format!("false alarms are not more frequent than {} per hour", alarms.accepted_per_hour),
            limit: format!("{:.4} per flight, inside or above the 95 % interval", alarms.promised),
            found: format!(
                "{} of {} ({:.3} to {:.3})",
                alarms.flights, study.runs, alarms.interval[0], alarms.interval[1]
            ),
            met: alarms.promised >= alarms.interval[0],
        });
    }
    requirements.push(Requirement {
        what: "healthy flights are called healthy at their end".to_owned(),
        limit: "at least 90 %".to_owned(),
        found: format!("{} of {}", study.called_healthy, study.runs),
        met: study.called_healthy * 10 >= study.runs * 9,
    });
    Ok(Reproduction {
        reconstruction: "All of it: an F-16 whose increments lie anywhere within the tolerances, a random stick, sensors with \
                         noise of 0.8 to 1.25 times what the model file says, constant errors, outliers and dropped frames."
            .to_owned(),
        difference: "The promise is a bound, and a wide one: it holds for every healthy aircraft and every look. With few \
                     hours the count bounds only the higher rates; `phugoid study health --runs 1000` flies more."
            .to_owned(),
        requirements,
        golden: table.clone(),
        tables: vec![table],
        ..blank(id)
    })
}

fn one_failure(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let (scenario, model) = (scenario(FAILURE_SCENARIO, "f16-failure")?, model()?);
    let flight = fly(&scenario)?;
    progress(0.3);
    let options = HealthOptions { expected: model.expectations(), false_alarms_per_hour: RATE };
    let (estimation, report) =
        monitor(&flight.measured, &model, &EstimateOptions::default(), &options, &mut |f| progress(0.3 + 0.7 * f))?;
    let began = scenario.damage.last().map_or(f64::NAN, |d| d.at.si());
    let failure = report.failure.as_ref();
    let flagged = failure.map_or(f64::NAN, |f| f.flagged_at_s);
    let interval = failure.and_then(|f| f.onset_interval_s).unwrap_or([f64::NAN; 2]);
    let onset = failure.and_then(|f| f.onset_s).unwrap_or(f64::NAN);
    let named = failure.map_or_else(Vec::new, |f| f.parameters.clone());
    let time: Arc<[f64]> = report.history.time_s.clone().into();
    let instants = |labelled: bool| {
        let level = |label: &str, at: f64, meaning| Level::new(if labelled { label } else { "" }, at, meaning);
        vec![
            level("failure", began, Meaning::Truth),
            level("flag", flagged, Meaning::Command),
            level("onset, 95 %", interval[0], Meaning::Flagship),
            level("", interval[1], Meaning::Flagship),
        ]
        .into_iter()
        .filter(|l| l.at.is_finite())
        .collect::<Vec<_>>()
    };
    let mut panels = Vec::new();
    for (index, parameter) in report.parameters.iter().enumerate() {
        let Some(history) = estimation.history.parameters.iter().find(|p| p.name == parameter.name) else { continue };
        let healthy = [parameter.expected - parameter.tolerance, parameter.expected + parameter.tolerance];
        let band = |side: f64| -> Vec<f64> {
            history.value.iter().zip(&history.std_error).map(|(v, s)| v + side * 2.0 * s).collect()
        };
        let reach = 1.3 * (parameter.value - parameter.expected).abs() + 3.0 * parameter.tolerance;
        panels.push(Panel {
            y: Axis::new(&parameter.name, "1/rad").with_range(parameter.expected - reach, parameter.expected + reach),
            content: Content::Curves {
                curves: vec![
                    Curve {
                        label: "healthy".to_owned(),
                        meaning: Meaning::Bound,
                        x: Arc::clone(&time),
                        shape: Shape::Band { lower: vec![healthy[0]; time.len()], upper: vec![healthy[1]; time.len()] },
                    },
                    Curve {
                        label: "estimate, 2 sigma".to_owned(),
                        meaning: Meaning::Flagship,
                        x: Arc::clone(&time),
                        shape: Shape::Band { lower: band(-1.0), upper: band(1.0) },
                    },
                    Curve {
                        label: "estimate".to_owned(),
                        meaning: Meaning::Flagship,
                        x: Arc::clone(&time),
                        shape: Shape::Line(history.value.clone()),
                    },
                ],
                levels: Vec::new(),
                instants: instants(index == 0),
            },
        });
    }
    let evidence: Vec<f64> = report
        .history
        .evidence
        .iter()
        .map(|v| if v.is_finite() { v / std::f64::consts::LN_10 } else { f64::NAN })
        .collect();
    panels.push(Panel {
        y: Axis::new("Evidence", "log10 h"),
        content: Content::Curves {
            curves: vec![Curve {
                label: "evidence of a failure".to_owned(),
                meaning: Meaning::Flagship,
                x: Arc::clone(&time),
                shape: Shape::Step(evidence),
            }],
            levels: vec![Level::new("flag", report.threshold / std::f64::consts::LN_10, Meaning::Bound)],
            instants: instants(false),
        },
    });
    let column = |name: &str, unit: &str| Column::new(name, unit);
    let table = Table {
        title: "Coefficients".to_owned(),
        columns: vec![
            column("coefficient", ""),
            column("expected", "1/rad"),
            column("tolerance", "1/rad"),
            column("estimate at the end", "1/rad"),
            column("2 sigma", "1/rad"),
            column("named at", "s"),
        ],
        rows: report
            .parameters
            .iter()
            .map(|p| {
                let numbers = [p.expected, p.tolerance, p.value, 2.0 * p.corrected_std_error];
                let mut row = vec![Cell::from(p.name.as_str())];
                row.extend(numbers.map(Cell::from));
                row.push(Cell::from(p.diverged_at_s));
                row
            })
            .collect(),
    };
    let golden = Table {
        title: "Flag and onset".to_owned(),
        columns: ["failure", "flag", "onset", "onset, lower", "onset, upper"].map(|n| column(n, "s")).to_vec(),
        rows: vec![[began, flagged, onset, interval[0], interval[1]].map(Cell::from).to_vec()],
    };
    Ok(Reproduction {
        reconstruction: "All of it: at 10 s the F-16 loses static stability (dC_m_alpha 0.12) and elevator effectiveness \
                         (dC_m_elevator 0.10) while a pilot moves the stick; realistic sensors with constant errors."
            .to_owned(),
        difference: report.sentences.join(". "),
        requirements: vec![
            Requirement {
                what: "the failure is flagged, after it happened".to_owned(),
                limit: format!("after {began:.2} s, within 1 s"),
                found: format!("{flagged:.2} s"),
                met: (0.0..=1.0).contains(&(flagged - began)),
            },
            Requirement {
                what: "the onset lies in its interval".to_owned(),
                limit: format!("{began:.2} s"),
                found: format!("{onset:.2} s ({:.2} to {:.2} s)", interval[0], interval[1]),
                met: (interval[0]..=interval[1]).contains(&began),
            },
            Requirement {
                what: "a coefficient that failed is named, and none that did not".to_owned(),
                limit: "of dCm_alpha, dCm_elevator".to_owned(),
                found: named.join(", "),
                met: !named.is_empty() && named.iter().all(|n| ["dCm_alpha", "dCm_elevator"].contains(&n.as_str())),
            },
        ],
        tables: vec![table, golden.clone()],
        charts: vec![Chart {
            name: "health".to_owned(),
            title: "A failure at 10 s".to_owned(),
            caption: "Estimates in the band that counts as healthy, until the failure. The evidence rests on the innovations of \
                      the expected aircraft, not on the estimate; it stays where it was when the flag was raised."
                .to_owned(),
            x: Axis::new("Time", "s"),
            panels,
            columns: 2,
        }],
        golden,
        ..blank(id)
    })
}

fn many_failures(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let (scenario, model) = (scenario(FAILURE_SCENARIO, "f16-failure")?, model()?);
    let done = AtomicUsize::new(0);
    let study = |stick| failures(&scenario, &model, stick, FAILURE_RUNS, &counted(progress, 2 * FAILURE_RUNS, &done));
    let studies = [study(Stick::Pilot)?, study(Stick::Calm)?];
    let row = |study: &FailureStudy| {
        let word = match study.stick {
            Stick::Pilot => "pilot",
            Stick::Calm => "3-2-1-1, rest",
        };
        let numbers = [
            study.runs as f64,
            study.false_alarms as f64,
            study.missed as f64,
            study.latency_median_s,
            study.latency_90_percent_s,
            study.onset_error_median_s,
            study.onset_error_90_percent_s,
            100.0 * study.onset_coverage,
            study.onset_width_median_s,
            study.failed as f64,
            study.named as f64,
            study.wrongly_named as f64,
        ];
        let mut cells = vec![Cell::from(word)];
        cells.extend(numbers.map(Cell::from));
        cells
    };
    let table = Table {
        title: "Failures of one to three coefficients, two to six tolerances from the expected value".to_owned(),
        columns: [
            ("stick", ""),
            ("flights", ""),
            ("flag before the failure", ""),
            ("missed", ""),
            ("latency, median", "s"),
            ("latency, 90 %", "s"),
            ("onset error, median", "s"),
            ("onset error, 90 %", "s"),
            ("onset in its 95 % interval", "%"),
            ("width of the interval, median", "s"),
            ("coefficients failed", ""),
            ("named", ""),
            ("wrongly named", ""),
        ]
        .map(|(name, unit)| Column::new(name, unit))
        .to_vec(),
        rows: studies.iter().map(row).collect(),
    };
    let pilot = &studies[0];
    let sum = |count: fn(&FailureStudy) -> usize| -> usize { studies.iter().map(count).sum() };
    let (failed, named, wrongly) = (sum(|s| s.failed), sum(|s| s.named), sum(|s| s.wrongly_named));
    let false_alarms: usize = studies.iter().map(|s| s.false_alarms).sum();
    Ok(Reproduction {
        reconstruction: "All of it: failures at random times, of random coefficients, sizes and signs, in flights as in \
                         `health/healthy`; a random stick, or a 3-2-1-1 at 1 s and at 11 s with rest between."
            .to_owned(),
        difference: "While nothing moves a failure cannot be seen: with the 3-2-1-1 it is found when the stick moves again, and \
                     the interval of its onset covers the rest before."
            .to_owned(),
        requirements: vec![
            Requirement {
                what: "failures under a pilot's stick are found".to_owned(),
                limit: "at most 5 % missed".to_owned(),
                found: format!("{} of {} missed", pilot.missed, pilot.runs),
                met: pilot.missed * 20 <= pilot.runs,
            },
            Requirement {
                what: "no flag before the failure".to_owned(),
                limit: format!("none of {}", 2 * FAILURE_RUNS),
                found: format!("{false_alarms}"),
                met: false_alarms == 0,
            },
            Requirement {
                what: "the onset lies in its 95 % interval".to_owned(),
                limit: "at least 88 % with either stick".to_owned(),
                found: format!(
                    "{:.0} % and {:.0} %",
                    100.0 * studies[0].onset_coverage,
                    100.0 * studies[1].onset_coverage
                ),
                met: studies.iter().all(|s| s.onset_coverage >= 0.88),
            },
            Requirement {
                what: "coefficients that are named have failed".to_owned(),
                limit: "at most 5 % of the names are wrong".to_owned(),
                found: format!("{named} rightly named of {failed} failed, {wrongly} wrongly"),
                met: wrongly * 20 <= named + wrongly,
            },
        ],
        golden: table.clone(),
        tables: vec![table],
        ..blank(id)
    })
}
