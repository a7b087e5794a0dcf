//! `phugoid tune`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::help::examples_and_exit_codes;

/// Chooses the settings of an estimator: by rule, and by a search that is judged on runs it has not seen
///
/// The rule sets everything from bounds, noise, sample time and expected input. The search starts from the rule and lowers
/// the mean over all training runs of: the logarithm of the time until each estimate stays within 5 % of its truth (as a part
/// of the record), the logarithm of its final error (in units of 5 %), and, for estimators that claim bounds, a penalty on
/// bounds that are wide or do not hold the truth. Each scenario is run with several truths and noises.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid tune smpe                                    built-in flights; writes phugoid-tuned.toml
  phugoid tune thesis-law --rule-only                  what the rule says, and how good it is
  phugoid tune model-reference --scenario first-order/1 --hold-out second-order/2
  phugoid tune smpe --scenario mine.toml --model jet.toml --runs 8 --budget 500
  phugoid tune smpe --state tuning.state               stop it (Ctrl-C), run it again: it goes on"
))]
pub(crate) struct Tune {
    /// What is tuned
    #[arg(value_enum)]
    pub(crate) method: TunedMethod,
    /// Tune on this: a scenario or case file, or the name of a built-in one (f16-calm, first-order/1)
    /// [default: a few built-in ones]
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) scenario: Vec<String>,
    /// Judge by this, which the search does not see: as --scenario. Its runs have other truths and noises in any case
    /// [default: built-in ones, or those of --scenario]
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) hold_out: Vec<String>,
    /// What the estimator is told of the aircraft of scenario files: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Runs of each scenario, each with its own truth and noise, for tuning and for judging
    #[arg(long, value_name = "NUMBER", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) runs: u32,
    /// Settings to try, the rule's included; a number of whole generations is tried
    #[arg(long, value_name = "EVALUATIONS", default_value_t = 180, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) budget: u32,
    /// Seed of the search
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Keep the state of the search in this file, written after every generation, and go on from it if it is there
    #[arg(long, value_name = "FILE")]
    pub(crate) state: Option<PathBuf>,
    /// Say what the rule gives, and search nothing
    #[arg(long, conflicts_with_all = ["budget", "state", "seed"])]
    pub(crate) rule_only: bool,
    /// File for the settings
    #[arg(long, value_name = "FILE", default_value = "phugoid-tuned.toml")]
    pub(crate) out: PathBuf,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Methods whose settings can be tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TunedMethod {
    /// Sliding-mode parameter estimator, on flights; writes an `estimator` section for model files
    Smpe,
    /// The thesis's sliding law, on cases with one unknown parameter
    ThesisLaw,
    /// The model-reference law (state-error form), on plants
    ModelReference,
}
