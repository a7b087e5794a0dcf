//! `phugoid study`.

use clap::{Args, ValueEnum};
use phugoid_identification::method::Method;
use phugoid_simulation::quantity::Time;

use super::delivery::Delivery;
use super::help::examples_and_exit_codes;
use super::keeping::Keeping;
use super::method::method;
use super::number::whole;

/// Measures estimators on many simulated flights: errors against the Cramer-Rao bound, and detection of changes and
/// failures
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid study calm-air --runs 200        RMSE over Cramer-Rao bound, and coverage
  phugoid study lateral --runs 200         the same of the lateral-directional motion
  phugoid study six --runs 100             the same of all six coefficients together
  phugoid study thesis-size --json         0.05 deg doublet and sine without noise
  phugoid study damage --runs 100          detection and recovery after damage, coverage
  phugoid study recovery --runs 1000       damaged aircraft flown on, with four controls
  phugoid study health --runs 1000         false alarms, missed failures, onset
  phugoid study accuracy --scenario mine.toml --model mine-model.toml --at 5s --at 20s"
))]
pub(crate) struct Study {
    /// Study to run
    #[arg(value_enum)]
    pub(crate) study: StudyName,
    /// Number of runs, each with its own noise
    #[arg(long, default_value_t = 200, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) runs: u32,
    /// Scenario of the studies `accuracy` and `recovery`: a file, or the name of a built-in one
    #[arg(long, required_if_eq("study", "accuracy"))]
    pub(crate) scenario: Option<String>,
    /// Model of the studies `accuracy` and `recovery`: a file, or the name of a built-in one. It must state the noise of its
    /// outputs
    #[arg(long, required_if_eq("study", "accuracy"))]
    pub(crate) model: Option<String>,
    /// Estimator of the studies `calm-air`, `accuracy` and `recovery` [default: the one that the model file names, or smpe]
    #[arg(long, value_parser = method())]
    pub(crate) method: Option<Method>,
    /// Seed of the first damage of the study `recovery`
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = whole::<u64>)]
    pub(crate) seed: Option<u64>,
    /// Time at which the study `accuracy` compares the estimates, for example 5s; may be repeated [default: the end]
    #[arg(long, allow_hyphen_values = true, value_name = "TIME")]
    pub(crate) at: Vec<Time>,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
    #[command(flatten)]
    pub(crate) keeping: Keeping,
}

/// Built-in studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StudyName {
    /// F-16 in calm air with realistic sensors: accuracy against the Cramer-Rao bound
    CalmAir,
    /// The fifteen lateral-directional derivatives of the F-16 and three constants, from rudder and aileron doublets
    Lateral,
    /// All six coefficients of the F-16 at once, 24 derivatives, from all three surfaces
    Six,
    /// Inputs as small as the thesis used, without noise: time to converge
    ThesisSize,
    /// Five coefficients change at 10 s: detection and recovery
    Damage,
    /// Change detection: random damage found or missed, and false adoptions under errors of the model. RUNS damages and
    /// RUNS minutes of flight per line
    Detection,
    /// Random damages flown in closed loop with fixed, robust, adaptive and oracle gains. RUNS damages
    Recovery,
    /// Health monitor: false alarms in healthy flights, and random failures with two sticks
    Health,
    /// Accuracy against the Cramer-Rao bound for a scenario and a model file of your own
    Accuracy,
}
