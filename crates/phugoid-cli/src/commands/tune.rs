//! `phugoid tune`.

use std::fmt::Write as _;
use std::path::Path;

use phugoid_evaluation::tune::state::StateError;
use phugoid_evaluation::tune::{
    Pair, Part, RunName, Score, Setting, TuneError, TuneOptions, Tuning, scores, tune, write_settings,
};
use phugoid_identification::model_file::ModelFile;
use phugoid_thesis::tune::material::{Material, Method, prepare, read};
use serde::Serialize;

use super::runs::{Runs, bar};
use crate::arguments::{self, TunedMethod};
use crate::failure::Failure;
use crate::output::{Table, json, print, significant};

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    tuning: &'a Tuning,
    conclusion: Option<String>,
    settings_path: &'a Path,
}

pub(crate) fn run(arguments: &arguments::Tune) -> Result<(), Failure> {
    let method = match arguments.method {
        TunedMethod::Smpe => Method::Smpe,
        TunedMethod::ThesisLaw => Method::ThesisLaw,
        TunedMethod::ModelReference => Method::ModelReference,
    };
    let model = arguments.model.as_deref().map(super::estimate::model).transpose()?;
    let [standard_training, standard_held_out] = method.standard();
    let training = match arguments.scenario.as_slice() {
        [] => materials(standard_training.iter().copied(), model.as_ref())?,
        named => materials(named.iter().map(String::as_str), model.as_ref())?,
    };
    let held_out = match (arguments.hold_out.as_slice(), arguments.scenario.is_empty()) {
        ([], true) => materials(standard_held_out.iter().copied(), model.as_ref())?,
        ([], false) => training.clone(),
        (named, _) => materials(named.iter().map(String::as_str), model.as_ref())?,
    };
    let is_part = arguments.keeping.is_part();
    if !is_part {
        writable(&arguments.out)?;
    }
    let runs = arguments.runs as usize;
    let flown = bar("flying", (training.len() + held_out.len()) * runs);
    let tunable = prepare(method, &training, &held_out, runs, &flown).map_err(failure)?;
    drop(flown);
    let options = TuneOptions {
        budget: if arguments.rule_only { 0 } else { arguments.budget as usize },
        seed: arguments.seed,
        state: arguments.state.clone(),
    };
    let sources = arguments.scenario.iter().chain(&arguments.hold_out).chain(&arguments.model).map(String::as_str);
    let count = scores(tunable.as_ref(), &options);
    let runs = Runs { what: "tuning", study: "tune", count, sources: sources.collect() };
    let tuning = tune(tunable.as_ref(), &options, runs.ledger(&arguments.keeping)?.as_ref()).map_err(failure)?;
    if is_part {
        return super::runs::helped();
    }
    write_settings(&tuning, &arguments.out).map_err(|e| Failure::writing(&arguments.out, e))?;
    let conclusion = tuning.held_out.as_ref().map(|comparison| comparison.sentence());
    if arguments.json {
        return print(&json(&Document { tuning: &tuning, conclusion, settings_path: &arguments.out })?);
    }
    print(&text(&tuning, tunable.runs(Part::HeldOut), conclusion.as_deref(), &arguments.out))
}

/// Checks before the search that the file of `--out` can be written, without changing or creating it.
fn writable(file: &Path) -> Result<(), Failure> {
    let new = !file.exists();
    let mut options = std::fs::OpenOptions::new();
    let opened = options.append(true).create(true).open(file).map(|_| ());
    opened.and_then(|()| if new { std::fs::remove_file(file) } else { Ok(()) }).map_err(|e| Failure::writing(file, e))
}

fn materials<'a>(wanted: impl Iterator<Item = &'a str>, model: Option<&ModelFile>) -> Result<Vec<Material>, Failure> {
    wanted.map(|wanted| read(wanted, model).map_err(Failure::input)).collect()
}

fn failure(error: TuneError) -> Failure {
    match error {
        TuneError::Study(error) => super::study::failure(error),
        TuneError::State(StateError::Unwritable { .. }) | TuneError::Ledger(_) => Failure::Output(error.to_string()),
        _ => Failure::input(error),
    }
}

fn text(tuning: &Tuning, held_out: &[RunName], conclusion: Option<&str>, file: &Path) -> String {
    let mut text = String::new();
    let _ = match tuning.generations {
        0 => writeln!(text, "{} by rule", tuning.method),
        generations => writeln!(
            text,
            "{}: {} settings tried in {generations} generations on {} runs",
            tuning.method, tuning.evaluations, tuning.training_runs
        ),
    };
    let shown = |setting: &Setting, value: f64| match setting.word(value) {
        "" => significant(value, 3),
        word => word.to_owned(),
    };
    text.push('\n');
    let searched = tuning.generations > 0;
    let mut settings =
        Table::new(if searched { &["setting", "rule", "tuned", "unit"] } else { &["setting", "rule", "unit"] });
    for choice in &tuning.settings {
        let setting = &choice.setting;
        let mut row = vec![setting.name.to_owned(), shown(setting, setting.rule)];
        if searched {
            row.push(shown(setting, choice.tuned));
        }
        row.push(setting.unit.to_owned());
        settings.row(row);
    }
    text.push_str(&settings.render());
    text.push_str("\nWhere the rule comes from\n");
    for choice in &tuning.settings {
        let _ = writeln!(text, "  {}: {}\n    {}", choice.setting.name, choice.setting.meaning, choice.setting.origin);
    }
    let _ = match searched {
        true => writeln!(
            text,
            "\nObjective on the training runs: {:.3} by rule, {:.3} tuned (lower is better; 0.1 is about 10 %)",
            tuning.training_rule, tuning.training_tuned
        ),
        false => writeln!(text, "\nObjective on the training runs: {:.3} (lower is better)", tuning.training_rule),
    };
    text.push_str("\nHeld-out runs, which the search did not see\n");
    let pairs: Vec<Pair> = match &tuning.held_out {
        Some(comparison) => comparison.pairs.clone(),
        // The rule alone: beside itself.
        None => held_out
            .iter()
            .zip(&tuning.rule_on_held_out)
            .map(|(name, rule)| Pair { scenario: name.scenario.clone(), run: name.run, rule: *rule, tuned: *rule })
            .collect(),
    };
    text.push_str(&by_scenario(&pairs, searched));
    if let Some(comparison) = &tuning.held_out {
        text.push_str("\nDifference of the objective, tuned less rule (negative is better)\n");
        let mut table = Table::new(&["scenario", "mean", "95 % interval"]);
        for s in &comparison.scenarios {
            let [lower, upper] = s.interval;
            let interval = if s.runs > 1 { format!("{lower:+.3} to {upper:+.3}") } else { "one run".to_owned() };
            table.row([s.scenario.clone(), format!("{:+.3}", s.mean_difference), interval]);
        }
        text.push_str(&table.render());
    }
    if let Some(conclusion) = conclusion {
        let _ = writeln!(text, "\n{conclusion}");
    }
    let _ = writeln!(text, "\nSettings: {}", file.display());
    text
}

/// Table of the means over the test runs of each scenario: one row for the rule, and the tuned settings below it.
fn by_scenario(pairs: &[Pair], searched: bool) -> String {
    let mut table = Table::new(&["scenario", "runs", "", "objective", "within 5 % after", "final error", "coverage"]);
    let mut scenarios: Vec<&str> = Vec::new();
    for pair in pairs {
        if !scenarios.contains(&pair.scenario.as_str()) {
            scenarios.push(&pair.scenario);
        }
    }
    for scenario in scenarios {
        let of = |get: fn(&Pair) -> Score| pairs.iter().filter(|p| p.scenario == scenario).map(get).collect::<Vec<_>>();
        let mut row = |name: &str, runs: String, word: &str, scores: &[Score]| {
            let count = scores.len() as f64;
            let mean = |value: &dyn Fn(&Score) -> f64| scores.iter().map(value).sum::<f64>() / count;
            let missed = scores.iter().filter(|s| !s.converged).count();
            let time = mean(&|s| s.time_to_5_percent_s.ln()).exp();
            let never = if missed > 0 { format!(" ({missed} not)") } else { String::new() };
            let coverage = scores.iter().all(|s| s.coverage.is_some());
            let coverage = coverage.then(|| mean(&|s| s.coverage.unwrap_or(f64::NAN)));
            table.row([
                name.to_owned(),
                runs,
                word.to_owned(),
                format!("{:.3}", mean(&|s| s.objective)),
                format!("{} s{never}", significant(time, 3)),
                format!("{} %", significant(100.0 * mean(&|s| s.final_error), 2)),
                coverage.map_or_else(|| "-".to_owned(), |c| format!("{:.1} %", 100.0 * c)),
            ]);
        };
        let rule = of(|p| p.rule);
        row(scenario, rule.len().to_string(), "rule", &rule);
        if searched {
            row("", String::new(), "tuned", &of(|p| p.tuned));
        }
    }
    table.render()
        + "  Means over the runs: of the times (geometric) until all parameters stay within 5 % of the truth, counted from the\n  \
           input; of the errors over the last tenth; coverage: truth within two claimed standard errors.\n"
}
