//! The command line: the list of the commands, and the options of the program without a command. The arguments of each
//! command stand in a file of its own.

#[cfg(feature = "live")]
pub(crate) mod address;
mod aircraft;
#[cfg(feature = "fleet")]
mod campaign;
mod check;
mod compare;
mod compatibility;
mod completions;
mod delivery;
mod design;
mod estimate;
mod export_fmu;
mod field;
#[cfg(feature = "fleet")]
pub(crate) mod fleet;
mod fly;
mod help;
pub(crate) mod init;
mod inspect;
mod keeping;
mod linearize;
pub(crate) mod live;
mod method;
mod monitor;
mod number;
mod reading;
mod regress;
mod reproduce;
mod simulate;
mod study;
mod trim;
mod tune;
mod view;

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};
use phugoid_identification::method::Method;

pub(crate) use aircraft::{AircraftChoice, FlightCondition, TablesName};
#[cfg(feature = "fleet")]
pub(crate) use campaign::Campaign;
pub(crate) use check::Check;
pub(crate) use compare::Compare;
pub(crate) use compatibility::{Compatibility, SensorGroup};
pub(crate) use completions::{Completions, Man};
pub(crate) use delivery::PictureFormat;
pub(crate) use design::{Design, InputKind, SurfaceName};
pub(crate) use estimate::{AxesForm, Estimate, Export, ExportForm, FlowAngleSource, Truth};
pub(crate) use export_fmu::ExportFmu;
pub(crate) use field::Field;
#[cfg(feature = "fleet")]
pub(crate) use fleet::Fleet;
pub(crate) use fly::Fly;
pub(crate) use init::{ClassName, Init};
pub(crate) use inspect::Inspect;
pub(crate) use keeping::Keeping;
pub(crate) use linearize::Linearize;
pub(crate) use monitor::Monitor;
pub(crate) use reading::{Deleting, Further, Moment, check_variable};
pub(crate) use regress::Regress;
pub(crate) use reproduce::Reproduce;
pub(crate) use simulate::Simulate;
pub(crate) use study::{Study, StudyName};
pub(crate) use trim::Trim;
pub(crate) use tune::{Tune, TunedMethod};
pub(crate) use view::View;

pub(crate) use help::EXIT_CODES;

use help::examples_and_exit_codes;
use method::causal_method;

/// Estimates an aircraft's aerodynamic coefficients from a flight, in real time or afterwards.
///
/// Without a command it flies the nonlinear F-16 with realistic sensors, estimates the aerodynamic increments that it
/// was given, sample by sample as an on-board computer would, and writes a report with figures.
#[derive(Debug, Parser)]
#[command(name = "phugoid", version, args_conflicts_with_subcommands = true, after_help = examples_and_exit_codes(
    "  phugoid                                          fly the F-16, estimate, write phugoid-report/
  phugoid --seed 7 --json                          another noise, the result as JSON
  phugoid estimate flight.csv --model jet.toml     your own flight
  phugoid trim --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30"
))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) demonstration: Demonstration,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Trim(Trim),
    Linearize(Linearize),
    ExportFmu(ExportFmu),
    Check(Check),
    Simulate(Simulate),
    Inspect(Inspect),
    Init(Init),
    Estimate(Estimate),
    Regress(Regress),
    Monitor(Monitor),
    Fly(Fly),
    Study(Study),
    Field(Field),
    #[cfg(feature = "fleet")]
    Fleet(Fleet),
    #[cfg(feature = "fleet")]
    Campaign(Campaign),
    Compare(Compare),
    Reproduce(Reproduce),
    Tune(Tune),
    Design(Design),
    Compatibility(Compatibility),
    View(View),
    Live(live::Live),
    Completions(Completions),
    Man(Man),
}

/// Options of `phugoid` without a command: the demonstration flight.
#[derive(Debug, Args)]
pub(crate) struct Demonstration {
    /// Seed of the sensor noise [default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = number::whole::<u64>)]
    pub(crate) seed: Option<u64>,
    /// Estimator [default: the one that the model file names, smpe]
    #[arg(long, value_parser = causal_method())]
    pub(crate) method: Option<Method>,
    /// Folder for the report [default: phugoid-report]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Also write the figures to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

impl Demonstration {
    /// The folder for the report.
    pub(crate) fn folder(&self) -> &Path {
        self.out.as_deref().unwrap_or(Path::new("phugoid-report"))
    }
}
