//! Automated tuning: the settings of an estimator by rule, and better ones, if there are any, by search.
//!
//! The thesis names the tuning of its gains as its first open problem. Here every method has a rule that sets it from
//! bounds, noise, sample time and expected input ([`Setting::origin`] says where each comes from), and a search over the
//! same settings ([`search`]) that starts from the rule. A search can only look better on the runs that it saw, so what
//! counts is the comparison on runs that it did not see ([`comparison`]): other cases, other seeds, other truths.
//!
//! `docs/tuning.md` has rules, objective and measured gains.

pub mod comparison;
pub mod objective;
pub mod search;
pub mod setting;
pub mod smpe;
pub mod state;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use comparison::{Comparison, Pair, ScenarioDifference, Verdict};
pub use objective::Score;
pub use setting::{Range, Setting};

use crate::accuracy::StudyError;
use crate::ledger::{Ledger, LedgerError, recorded};
use search::Search;
use setting::{values_at, values_by_rule};
use state::{Problem, StateError};

/// Held-out runs of a scenario are numbered from here, so that they are never among the training runs of the same one.
pub const HELD_OUT_RUNS: u64 = 1_000_000;

/// Which runs: those that the search sees, or those that it does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Runs on which the search compares settings.
    Training,
    /// Runs that the search never sees; they tell whether the tuned settings are better in other flights too.
    HeldOut,
}

/// One run of a scenario or case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunName {
    /// Name of the scenario or plant case.
    pub scenario: String,
    /// Number of the run in it; every run has its own true values and its own noise.
    pub run: u64,
}

/// A method on a set of runs, ready to be tuned.
pub trait Tunable: Sync {
    /// Name of the method, e.g. `smpe`.
    fn method(&self) -> &'static str;

    /// What is searched, with the rule.
    fn settings(&self) -> &[Setting];

    /// The runs of a part, in a fixed order.
    fn runs(&self, part: Part) -> &[RunName];

    /// Scores one of them with the values of the settings. A run that fails is [`Score::FAILURE`].
    fn score(&self, values: &[f64], part: Part, run: usize) -> Score;

    /// Everything that decides the scores of the runs of a part in addition to settings and run names: fingerprints of files, by
    /// name.
    fn sources(&self, part: Part) -> BTreeMap<String, String>;

    /// The settings as the text of a file that a user can use, with a comment at its head.
    fn settings_file(&self, values: &[f64]) -> String;
}

/// How many settings are tried, with which random numbers, and where the search keeps its state.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneOptions {
    /// Settings to try, the rule's included; whole generations are tried. Zero: the rule only.
    pub budget: usize,
    /// Seed of the search's random numbers; the same seed gives the same result.
    pub seed: u64,
    /// File that holds the state of the search, written after every generation.
    pub state: Option<PathBuf>,
}

/// One setting, by rule and tuned.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// The setting with its limits and the value that the rule gives it.
    pub setting: Setting,
    /// Value that the search found, in the unit of the setting.
    pub tuned: f64,
}

/// The result of tuning one method: settings, objectives and the comparison on the held-out runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tuning {
    /// Name of the method that was tuned.
    pub method: &'static str,
    /// Settings by rule and tuned.
    pub settings: Vec<Choice>,
    /// Number of different settings that were tried, the rule's included.
    pub evaluations: usize,
    /// Number of generations of the search.
    pub generations: u64,
    /// Mean objective of the training runs with the rule.
    pub training_rule: f64,
    /// The same with the tuned settings.
    pub training_tuned: f64,
    /// Best mean objective after each generation.
    pub best_scores: Vec<f64>,
    /// Number of runs on which the search compared settings.
    pub training_runs: usize,
    /// Rule and tuned settings on the held-out runs; none if only the rule was asked for.
    pub held_out: Option<Comparison>,
    /// The rule on the held-out runs, if only the rule was asked for.
    pub rule_on_held_out: Vec<Score>,
    /// The tuned settings as a file.
    pub settings_file: String,
}

/// Why nothing could be tuned.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// Too few evaluations for two generations.
    #[error(
        "a budget of {budget} evaluations is too small: {settings} settings need at least {least} (two generations); use \
         --rule-only for the rule alone"
    )]
    Budget {
        /// Number of settings to try that was asked for.
        budget: usize,
        /// Number of settings that the method has.
        settings: usize,
        /// Smallest budget with which this many settings can be searched.
        least: usize,
    },
    /// No runs to tune on, or none held out.
    #[error("{0}")]
    NoRuns(String),
    /// The state file of the search could not be read or written, or belongs to another search.
    #[error(transparent)]
    State(#[from] StateError),
    /// A scenario cannot be run at all.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A score that is kept cannot be read or written.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
}

/// Number of scores that [`tune`] asks for: of the training runs in all generations and of the first and the last settings, and of
/// the held-out runs.
pub fn scores(tunable: &dyn Tunable, options: &TuneOptions) -> usize {
    let [training, held_out] = [Part::Training, Part::HeldOut].map(|part| tunable.runs(part).len());
    let size = Search::population_size(tunable.settings().len());
    let generations = options.budget / size;
    let settings = if generations > 0 { 2 } else { 1 };
    generations * size * training + 2 * training + settings * held_out
}

/// Tunes a method. `ledger` is told of each run that is scored ([`scores`] of them), from any thread, and may keep the scores, so that a
/// search that begins anew finds those of an earlier one.
///
/// # Errors
/// [`TuneError`]: the budget is too small, there are no runs, or the state file is damaged or of another problem.
pub fn tune(tunable: &dyn Tunable, options: &TuneOptions, ledger: &dyn Ledger) -> Result<Tuning, TuneError> {
    let settings = tunable.settings();
    let rule = values_by_rule(settings);
    let training = tunable.runs(Part::Training).len();
    if training == 0 {
        return Err(TuneError::NoRuns("nothing to tune on: give a --scenario".to_owned()));
    }
    let size = Search::population_size(settings.len());
    if options.budget > 0 && options.budget < 2 * size {
        let (budget, settings, least) = (options.budget, settings.len(), 2 * size);
        return Err(TuneError::Budget { budget, settings, least });
    }
    let generations = (options.budget / size) as u64;
    let problem = problem(tunable, options.seed);
    let mut search = match &options.state {
        Some(file) => state::read(file, &problem)?,
        None => None,
    }
    .unwrap_or_else(|| Search::new(settings.iter().zip(&rule).map(|(s, v)| s.place(*v)).collect(), options.seed));
    // What a state file tells is done.
    (0..search.generation as usize * size * training).for_each(|_| ledger.done());
    while search.generation < generations {
        let points = search.ask();
        let values: Vec<Vec<f64>> = points.iter().map(|point| values_at(settings, point)).collect();
        let scores = training_scores(tunable, &values, ledger)?;
        search.tell(points, &scores);
        if let Some(file) = &options.state {
            state::write(file, &problem, &search)?;
        }
    }

    let tuned = search.best().map_or_else(|| rule.clone(), |best| values_at(settings, &best.point));
    let both = training_scores(tunable, &[rule.clone(), tuned.clone()], ledger)?;
    let (by_rule, by_search) = (both[0], both[1]);
    // The start of the search is the rule through a logarithm and back; do not let rounding look like a gain.
    let tuned = if by_search < by_rule { tuned } else { rule.clone() };
    let held_out = |values: &[f64]| all_scores(tunable, &[values.to_vec()], Part::HeldOut, ledger);
    let rule_scores = held_out(&rule)?;
    let comparison = if generations > 0 {
        let tuned_scores = held_out(&tuned)?;
        let pairs =
            tunable.runs(Part::HeldOut).iter().zip(rule_scores.iter().zip(tuned_scores)).map(
                |(name, (rule, tuned))| Pair { scenario: name.scenario.clone(), run: name.run, rule: *rule, tuned },
            );
        Some(Comparison::of(pairs.collect()))
    } else {
        None
    };
    Ok(Tuning {
        method: tunable.method(),
        settings: settings.iter().zip(&tuned).map(|(s, v)| Choice { setting: s.clone(), tuned: *v }).collect(),
        evaluations: search.evaluations,
        generations: search.generation,
        training_rule: by_rule,
        training_tuned: by_search.min(by_rule),
        best_scores: search.best_scores,
        training_runs: training,
        rule_on_held_out: if comparison.is_none() { rule_scores } else { Vec::new() },
        held_out: comparison,
        settings_file: tunable.settings_file(&tuned),
    })
}

/// Mean objective of each set of values over the training runs.
fn training_scores(tunable: &dyn Tunable, values: &[Vec<f64>], ledger: &dyn Ledger) -> Result<Vec<f64>, LedgerError> {
    let runs = tunable.runs(Part::Training).len();
    let scores = all_scores(tunable, values, Part::Training, ledger)?;
    // Summed in the order of the runs: the same on any number of cores.
    Ok(scores
        .chunks(runs)
        .map(|of_one| of_one.iter().map(|score| score.objective).sum::<f64>() / runs as f64)
        .collect())
}

/// Scores of all runs of a part with each set of values, set by set; all in parallel.
fn all_scores(
    tunable: &dyn Tunable,
    values: &[Vec<f64>],
    part: Part,
    ledger: &dyn Ledger,
) -> Result<Vec<Score>, LedgerError> {
    let runs = tunable.runs(part);
    let inputs = format!("tuning of {}: {:?}", tunable.method(), tunable.sources(part));
    let place = |k: usize| (&values[k / runs.len().max(1)], k % runs.len().max(1));
    recorded(
        values.len() * runs.len(),
        &inputs,
        |k| {
            let (values, run) = place(k);
            format!("{} {} with {values:?}", runs[run].scenario, runs[run].run)
        },
        |k| {
            let (values, run) = place(k);
            Ok(tunable.score(values, part, run))
        },
        ledger,
    )
}

/// Everything that decides the scores of the search.
fn problem(tunable: &dyn Tunable, seed: u64) -> Problem {
    let mut problem: Problem = tunable.sources(Part::Training);
    let runs = tunable.runs(Part::Training).iter().map(|r| format!("{} {}", r.scenario, r.run)).collect::<Vec<_>>();
    problem.insert("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    problem.insert("method".to_owned(), tunable.method().to_owned());
    problem.insert("seed".to_owned(), seed.to_string());
    problem.insert("training runs".to_owned(), runs.join(", "));
    for setting in tunable.settings() {
        let range = match &setting.range {
            Range::Logarithmic { lower, upper } => format!("{lower:?} to {upper:?}"),
            Range::Choice { words } => words.join(" or "),
        };
        problem.insert(format!("range of {}", setting.name), format!("{range}, by rule {:?}", setting.rule));
    }
    problem
}

/// Writes the tuned settings to a file, whole or not at all.
///
/// # Errors
/// What the system says.
pub fn write_settings(tuning: &Tuning, file: &Path) -> std::io::Result<()> {
    phugoid_flight_data::output_file::write(file, &tuning.settings_file)
}
