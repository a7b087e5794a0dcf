//! `phugoid tune`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::help::examples_and_exit_codes;
use super::keeping::Keeping;
use super::number::whole;

/// Chooses the settings of an estimator by a rule and by a search, and tests both on runs that the search does not use
///
/// The rule computes all settings from the bounds, the noise, the sample time and the expected input. The search starts
/// from the rule and minimises the mean, over all training runs, of three costs: the logarithm of the time until each
/// estimate stays within 5 % of its true value (as a fraction of the record), the logarithm of its final error (in
/// units of 5 %), and, for estimators with bounds, a penalty on bounds that are wide or do not contain the true value.
/// Each scenario is run with several sets of true values and several noises.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid tune smpe                                    built-in flights; writes phugoid-tuned.toml
  phugoid tune thesis-law --rule-only                  the settings of the rule and their cost
  phugoid tune model-reference --scenario first-order/1 --hold-out second-order/2
  phugoid tune smpe --scenario mine.toml --model jet.toml --runs 8 --budget 500
  phugoid tune smpe --state tuning.state               stop with Ctrl-C, run again to continue"
))]
pub(crate) struct Tune {
    /// Method to tune
    #[arg(value_enum)]
    pub(crate) method: TunedMethod,
    /// Tune on this: a scenario or case file, or the name of a built-in one (f16-calm, first-order/1); may be repeated
    /// [default: a few built-in ones]
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) scenario: Vec<String>,
    /// Test the settings on this, which the search does not use: given as for --scenario; may be repeated. The true
    /// values and the noises always differ from those of the search [default: built-in ones, or those of --scenario]
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) hold_out: Vec<String>,
    /// Model that the estimator uses with scenario files: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Runs of each scenario, each with its own true values and noise, for the search and for the test
    #[arg(long, value_name = "NUMBER", default_value_t = 6, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) runs: u32,
    /// Number of sets of settings to try, including the rule's; the search tries whole generations
    #[arg(long, value_name = "EVALUATIONS", default_value_t = 180, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) budget: u32,
    /// Seed of the search
    #[arg(long, value_name = "NUMBER", default_value_t = 1, allow_negative_numbers = true, value_parser = whole::<u64>)]
    pub(crate) seed: u64,
    /// Write the state of the search to this file after every generation, and continue from it if the file exists
    #[arg(long, value_name = "FILE")]
    pub(crate) state: Option<PathBuf>,
    /// Compute and test the settings of the rule only, without a search
    #[arg(long, conflicts_with_all = ["budget", "state", "seed"])]
    pub(crate) rule_only: bool,
    /// File for the chosen settings
    #[arg(long, value_name = "FILE", default_value = "phugoid-tuned.toml")]
    pub(crate) out: PathBuf,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) keeping: Keeping,
}

/// Methods whose settings can be tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TunedMethod {
    /// Sliding-mode parameter estimator, on flights; writes an `estimator` section for model files
    Smpe,
    /// The sliding-mode law of the thesis, on cases with one unknown parameter
    ThesisLaw,
    /// The model-reference law (state-error form), on plants
    ModelReference,
}
