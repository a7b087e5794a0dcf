//! `phugoid export-fmu`.

use std::path::PathBuf;

use clap::Args;

use super::aircraft::FlightCondition;
use super::help::examples_and_exit_codes;

/// Writes an aircraft in trim as an FMU (FMI 3.0), which other programs simulate
///
/// The FMU is for model exchange and for co-simulation. Its inputs are throttle and positions of the surfaces, and the motion of
/// the air; what it computes is what `phugoid simulate` computes. It carries the files of the aircraft and a library, which
/// `cargo build --release -p phugoid-fmi` builds.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid export-fmu --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30 --out f16.fmu
  phugoid export-fmu --aircraft jet.toml --altitude 4300m --speed 105m/s --out jet.fmu
  phugoid export-fmu --aircraft jsbsim/aircraft/c182 --altitude 5000ft --speed 120kt --out c182.fmu"
))]
pub(crate) struct ExportFmu {
    #[command(flatten)]
    pub(crate) condition: FlightCondition,
    /// The FMU to write
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Library of Phugoid for FMI 3.0; may be repeated, once for each kind of machine on which the FMU is to run [default: that
    /// of the environment variable PHUGOID_FMI_LIBRARY, or the one beside this program]
    #[arg(long = "library", value_name = "FILE")]
    pub(crate) libraries: Vec<PathBuf>,
    /// Print one JSON document (SI units and radians) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}
