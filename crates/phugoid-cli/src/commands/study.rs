//! `phugoid study`.

use std::fmt::Write as _;

use clap::ValueEnum as _;
use clap::builder::PossibleValue;
use phugoid_evaluation::accuracy::{AccuracyStudy, StudyError, accuracy};
use phugoid_evaluation::convergence::{ConvergenceStudy, convergence};
use phugoid_evaluation::damage::{DamageStudy, damage};
use phugoid_evaluation::health::{FailureStudy, HealthyStudy, Stick, failures, healthy};
use phugoid_evaluation::ledger::Ledger;
use phugoid_evaluation::published::{
    CALM_MODEL, CALM_SCENARIO, DAMAGE_MODEL, DAMAGE_SCENARIO, FAILURE_SCENARIO, HEALTH_MODEL, HEALTHY_SCENARIO,
    THESIS_DOUBLET, THESIS_MODEL, THESIS_SINE,
};
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::scenario::Scenario;
use serde::Serialize;

use super::runs::Runs;
use crate::arguments::{self, StudyName};
use crate::failure::Failure;
use crate::output::{Table, deliver, significant};

/// One short-period cycle (4.17 s; the 3-2-1-1 ends after 4.2 s) and two after the input starts at 0.5 s, and the end.
const CHECKPOINTS_S: [f64; 3] = [0.5 + 4.2, 0.5 + 8.4, 20.0];

/// After the first rudder and the first aileron doublet, and the end.
const LATERAL_CHECKPOINTS_S: [f64; 2] = [10.0, 20.0];

/// After the first elevator, rudder and aileron input, and the end.
const SIX_CHECKPOINTS_S: [f64; 2] = [15.0, 30.0];

/// Times after the damage at which the estimates are looked at: 1, 2 and 4.2 s, and the end.
const RECOVERY_S: [f64; 4] = [1.0, 2.0, 4.2, 10.0];

/// A coefficient counts as found while its relative error is smaller than this.
const TOLERANCE: f64 = 0.05;

pub(crate) fn run(arguments: &arguments::Study) -> Result<(), Failure> {
    match arguments.study {
        StudyName::CalmAir => {
            let scenario = Scenario::parse(CALM_SCENARIO, "f16-calm").map_err(Failure::input)?;
            let model = ModelFile::parse("f16-model", CALM_MODEL).map_err(Failure::input)?;
            let study = accurate(&scenario, &model, arguments, &CHECKPOINTS_S, &["f16-calm", "f16-model"])?;
            result(arguments, &study, accuracy_text)
        }
        StudyName::Lateral => built_in("f16-lateral", &LATERAL_CHECKPOINTS_S, arguments),
        StudyName::Six => built_in("f16-six", &SIX_CHECKPOINTS_S, arguments),
        StudyName::Accuracy => {
            let words = [arguments.scenario.as_deref(), arguments.model.as_deref()].map(Option::unwrap_or_default);
            let (scenario, model) = (super::simulate::scenario(words[0])?, super::estimate::model(words[1])?);
            let mut at: Vec<f64> = arguments.at.iter().map(|t| t.si()).collect();
            if at.is_empty() {
                at.push(scenario.duration.si());
            }
            let duration = scenario.duration.si();
            if let Some(outside) = at.iter().find(|t| !(0.0..=duration).contains(*t)) {
                return Err(Failure::input(format!(
                    "--at {outside} s lies outside the flight, which lasts {duration} s: choose a time in it"
                )));
            }
            let study = accurate(&scenario, &model, arguments, &at, &words)?;
            result(arguments, &study, accuracy_text)
        }
        StudyName::Damage => result(arguments, &damaged(arguments)?, damage_text),
        StudyName::Detection => {
            result(arguments, &super::detection::detected(arguments)?, super::detection::detection_text)
        }
        StudyName::Recovery => {
            result(arguments, &super::recovery::recovered(arguments)?, super::recovery::recovery_text)
        }
        StudyName::Health => result(arguments, &health(arguments)?, health_text),
        StudyName::ThesisSize => {
            let studies = [thesis_size(THESIS_DOUBLET)?, thesis_size(THESIS_SINE)?];
            result(arguments, &studies, |studies| studies.iter().map(convergence_text).collect::<Vec<_>>().join("\n"))
        }
    }
}

/// Prints the result, unless this process made its runs for others.
fn result<S: Serialize>(arguments: &arguments::Study, study: &S, text: impl Fn(&S) -> String) -> Result<(), Failure> {
    if arguments.keeping.is_part() {
        return super::runs::helped();
    }
    deliver(study, arguments.delivery.json, arguments.delivery.out.as_deref(), || text(study))
}

/// Accuracy of the built-in model on the built-in scenario of the same name.
fn built_in(name: &str, at: &[f64], arguments: &arguments::Study) -> Result<(), Failure> {
    let scenario = super::simulate::scenario(name)?;
    let model = super::estimate::model(name)?;
    result(arguments, &accurate(&scenario, &model, arguments, at, &[name])?, accuracy_text)
}

/// The failure for a study that cannot be run: an input error, or a task without an answer.
pub(crate) fn failure(error: StudyError) -> Failure {
    match error {
        StudyError::Flight(error) => super::simulate::failure(error),
        StudyError::Estimate(_) | StudyError::Unsuitable(_) => Failure::input(error),
        StudyError::CramerRao(_) => Failure::impossible(error),
        StudyError::Ledger(_) => Failure::Output(error.to_string()),
    }
}

/// Makes the runs of a study with a bar, and with the store of `--store`. `sources` are the files and the names of what is built in
/// that decide on them.
pub(super) fn with_ledger<T>(
    arguments: &arguments::Study,
    runs: u32,
    sources: &[&str],
    study: impl FnOnce(&dyn Ledger) -> Result<T, StudyError>,
) -> Result<T, Failure> {
    let name = arguments.study.to_possible_value();
    let runs = Runs {
        what: "flying",
        study: name.as_ref().map_or("study", PossibleValue::get_name),
        count: runs as usize,
        sources: sources.to_vec(),
    };
    study(runs.ledger(&arguments.keeping)?.as_ref()).map_err(failure)
}

fn accurate(
    scenario: &Scenario,
    model: &ModelFile,
    arguments: &arguments::Study,
    at: &[f64],
    sources: &[&str],
) -> Result<AccuracyStudy, Failure> {
    let options = EstimateOptions { method: arguments.method, ..EstimateOptions::causal() };
    let runs = arguments.runs;
    with_ledger(arguments, runs, sources, |ledger| accuracy(scenario, model, &options, runs as usize, at, ledger))
}

fn damaged(arguments: &arguments::Study) -> Result<DamageStudy, Failure> {
    let scenario = Scenario::parse(DAMAGE_SCENARIO, "f16-damage").map_err(Failure::input)?;
    let model = ModelFile::parse("f16-damage-model", DAMAGE_MODEL).map_err(Failure::input)?;
    let runs = arguments.runs;
    with_ledger(arguments, runs, &[], |ledger| damage(&scenario, &model, runs as usize, &RECOVERY_S, ledger))
}

/// The study of the health monitor: false alarms and detected failures.
#[derive(Serialize)]
struct HealthStudies {
    healthy: HealthyStudy,
    failures: [FailureStudy; 2],
}

fn health(arguments: &arguments::Study) -> Result<HealthStudies, Failure> {
    let read = |text, name: &str| Scenario::parse(text, name).map_err(Failure::input);
    let (flight, failing) = (read(HEALTHY_SCENARIO, "f16-healthy")?, read(FAILURE_SCENARIO, "f16-failure")?);
    let model = ModelFile::parse("f16-health-model", HEALTH_MODEL).map_err(Failure::input)?;
    let runs = arguments.runs as usize;
    with_ledger(arguments, 3 * arguments.runs, &[], |ledger| {
        Ok(HealthStudies {
            healthy: healthy(&flight, &model, runs, ledger)?,
            failures: [
                failures(&failing, &model, Stick::Pilot, runs, ledger)?,
                failures(&failing, &model, Stick::Calm, runs, ledger)?,
            ],
        })
    })
}

fn health_text(study: &HealthStudies) -> String {
    let healthy = &study.healthy;
    let mut text = format!("{} healthy flights, {:.2} h monitored\n\n", healthy.runs, healthy.hours);
    let mut table =
        Table::new(&["accepted per hour", "flights with a false alarm", "promised", "found per flight, 95 %"]);
    for alarms in &healthy.false_alarms {
        table.row([
            significant(alarms.accepted_per_hour, 2),
            alarms.flights.to_string(),
            significant(alarms.promised, 3),
            format!("{} to {}", significant(alarms.interval[0], 3), significant(alarms.interval[1], 3)),
        ]);
    }
    text.push_str(&table.render());
    let _ = writeln!(
        text,
        "  called healthy at their end: {}\n\nFailures, one false alarm in 100 h accepted\n",
        healthy.called_healthy
    );
    let mut table = Table::new(&[
        "stick",
        "flights",
        "early flags",
        "missed",
        "latency",
        "90 %",
        "onset error",
        "90 %",
        "onset covered",
        "width",
        "named",
        "wrongly",
    ]);
    for failures in &study.failures {
        table.row([
            if failures.stick == Stick::Pilot { "pilot" } else { "3-2-1-1, rest" }.to_owned(),
            failures.runs.to_string(),
            failures.false_alarms.to_string(),
            failures.missed.to_string(),
            format!("{:.2} s", failures.latency_median_s),
            format!("{:.2} s", failures.latency_90_percent_s),
            format!("{:.3} s", failures.onset_error_median_s),
            format!("{:.3} s", failures.onset_error_90_percent_s),
            format!("{:.1} %", 100.0 * failures.onset_coverage),
            format!("{:.2} s", failures.onset_width_median_s),
            format!("{} of {}", failures.named, failures.failed),
            failures.wrongly_named.to_string(),
        ]);
    }
    text.push_str(&table.render());
    text
}

fn thesis_size(scenario: &str) -> Result<ConvergenceStudy, Failure> {
    let scenario = Scenario::parse(scenario, "f16-thesis").map_err(Failure::input)?;
    let model = ModelFile::parse("f16-thesis-model", THESIS_MODEL).map_err(Failure::input)?;
    convergence(&scenario, &model, TOLERANCE).map_err(failure)
}

fn accuracy_text(study: &AccuracyStudy) -> String {
    let mut text =
        format!("{}\n{} runs, model `{}`, method {}\n", study.scenario, study.runs, study.model, study.method);
    for checkpoint in &study.checkpoints {
        let _ = writeln!(text, "\nAfter {:.2} s", checkpoint.time_s);
        let mut table = Table::new(&[
            "parameter",
            "truth",
            "bias",
            "RMSE",
            "Cramer-Rao",
            "percent",
            "RMSE/CRB",
            "claimed/CRB",
            "coverage",
        ]);
        for p in &checkpoint.parameters {
            table.row([
                p.name.clone(),
                significant(p.truth, 3),
                significant(p.bias, 3),
                significant(p.rmse, 3),
                significant(p.cramer_rao, 3),
                significant(100.0 * p.cramer_rao / p.truth.abs(), 3),
                format!("{:.3}", p.rmse_over_cramer_rao),
                format!("{:.3}", p.claimed / p.cramer_rao),
                format!("{:.1} %", 100.0 * p.coverage),
            ]);
        }
        text.push_str(&table.render());
    }
    let _ = writeln!(
        text,
        "\nCramer-Rao: the smallest standard error of any unbiased estimator, initial states unknown, no prior; in percent\n\
         of the truth beside it. Coverage: runs with the truth within two claimed standard errors.\n\
         Runs in which a sudden change was believed to have happened: {} of {}",
        study.runs_with_changes, study.runs
    );
    text
}

fn convergence_text(study: &ConvergenceStudy) -> String {
    let mut text = format!("{}, model `{}`\n", study.scenario, study.model);
    let within = format!("within {} % after", significant(100.0 * study.tolerance, 3));
    let mut table = Table::new(&["parameter", "truth", "estimate at the end", &within]);
    for p in &study.parameters {
        table.row([
            p.name.clone(),
            significant(p.truth, 3),
            significant(p.value, 8),
            p.reached_after_s.map_or_else(|| "never".to_owned(), |t| format!("{t:.2} s")),
        ]);
    }
    text.push_str(&table.render());
    let _ = writeln!(text, "  (counted from the start of the input at {:.2} s)", study.input_starts_s);
    text
}

fn damage_text(study: &DamageStudy) -> String {
    let mut text = format!(
        "{}\n{} runs, model `{}`, damage at {} s\n\n",
        study.scenario,
        study.runs,
        study.model,
        significant(study.damage_at_s, 3)
    );
    let seconds = |s: f64| if s.is_finite() { format!("{s:.2} s") } else { "never".to_owned() };
    let _ = writeln!(
        text,
        "  found after {} (median), {} (nine runs of ten)\n  missed in {} runs, {} false alarms before the damage, {} further changes after it",
        seconds(study.latency_median_s),
        seconds(study.latency_90_percent_s),
        study.missed,
        study.false_alarms,
        study.extra_changes
    );
    for at in &study.recovery {
        let _ = writeln!(text, "\n{} s after the damage", significant(at.after_s, 3));
        let mut table = Table::new(&["parameter", "truth", "median error", "RMSE", "coverage"]);
        for p in &at.parameters {
            table.row([
                p.name.clone(),
                significant(p.truth, 3),
                significant(p.median_error, 3),
                significant(p.rmse, 3),
                format!("{:.1} %", 100.0 * p.coverage),
            ]);
        }
        text.push_str(&table.render());
    }
    text.push_str("\nCoverage: runs with the truth after the damage within two claimed standard errors.\n");
    text
}
