//! `phugoid field`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_evaluation::field::truth::Split;
use phugoid_identification::method::Method;

use super::delivery::Delivery;
use super::estimate::FlowAngleSource;
use super::help::examples_and_exit_codes;
use super::method::method;
use super::number::whole;

/// Judges the estimates on foreign flights: aircraft of another simulator, recorded as a stranger would, with the truth
/// beside each record
///
/// Each flight goes the path of `phugoid estimate` with default settings. scripts/field/make.py makes the flights;
/// docs/field.md says what they are.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid field target/field                                     the flights to develop with
  phugoid field target/field --method smpe --method ekf          two methods
  phugoid field target/field --faults 1000                       with physical errors put in
  phugoid field target/field --only f15 --only turbulence        some of the flights
  phugoid field target/field --split look-once --out last.json   once, at the end"
))]
pub(crate) struct Field {
    /// Folder with the flights
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// Part of the field
    #[arg(long, value_enum, default_value_t = Part::Develop)]
    pub(crate) split: Part,
    /// Estimator; may be repeated [default: smpe]
    #[arg(long, value_parser = method())]
    pub(crate) method: Vec<Method>,
    /// Only flights whose aircraft, group or name contains this; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Vec<String>,
    /// Number of flights with a physical error put in, for the first method
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) faults: u32,
    /// Let a batch method take all noise for Gaussian, so that an outlier counts with the square of its residual. Without
    /// this a value counts the less the further from the model it is, or is left out where it stands alone
    #[arg(long)]
    pub(crate) gaussian: bool,
    /// Where output error has airspeed and the angles of attack and sideslip from
    #[arg(long, value_enum, value_name = "SOURCE", default_value_t)]
    pub(crate) flow_angles: FlowAngleSource,
    /// Look for missing terms instead: with the models of the field, and with each of their terms taken out. Needs a field
    /// made with --exact
    #[arg(long, conflicts_with_all = ["faults", "no_monitor", "gaussian"])]
    pub(crate) structure_study: bool,
    /// Draw errors from what the model files declare instead (`[uncertainty]`), and ask whether the bounds hold them: this
    /// number of flights without errors, with all of them, and with those of each quantity, for the first method
    #[arg(long, value_name = "N", conflicts_with_all = ["faults", "gaussian", "structure_study"],
          allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) drawn_errors: Option<u32>,
    /// With --drawn-errors: number of flights in which each error is tried by itself, to see whether the largest contributor
    /// is named
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, requires = "drawn_errors")]
    pub(crate) ranked: u32,
    /// Put all errors that the model files declare (`[uncertainty]`) into every flight, drawn from this seed: what is found of damage,
    /// and what is called converged, with errors that leave no trace in residuals
    #[arg(long, value_name = "SEED", allow_negative_numbers = true, value_parser = whole::<u64>, conflicts_with_all = ["structure_study", "drawn_errors"])]
    pub(crate) with_drawn: Option<u64>,
    /// Take in what a flight itself says of declared errors, as `learn = true` under `[uncertainty]` of a model file does
    #[arg(long)]
    pub(crate) learn: bool,
    /// Leave out the health monitor
    #[arg(long)]
    pub(crate) no_monitor: bool,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// Parts of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Part {
    /// Flights to develop with
    Develop,
    /// Flights to be looked at once, at the end
    LookOnce,
}

impl Part {
    pub(crate) fn split(self) -> Split {
        match self {
            Self::Develop => Split::Develop,
            Self::LookOnce => Split::LookOnce,
        }
    }
}
