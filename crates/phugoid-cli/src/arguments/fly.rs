//! `phugoid fly`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_control::law::Form;
use phugoid_identification::method::Method;
use phugoid_recovery::flight::Control;

use super::help::examples_and_exit_codes;
use super::method::causal_method;
use super::number::whole;

/// Flies a damaged aircraft in closed loop: identified in flight, with gains from the estimate and its bounds
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid fly f16-recovery                         the built-in damage; writes phugoid-fly/
  phugoid fly f16-recovery --control fixed         with the gains of the undamaged aircraft
  phugoid fly mine.toml --model mine-model.toml --json
  phugoid study recovery --runs 1000               random damages with every control"
))]
pub(crate) struct Fly {
    /// Scenario file, or the name of a built-in one
    #[arg(value_name = "SCENARIO")]
    pub(crate) scenario: String,
    /// Where the gains come from
    #[arg(long, value_enum, default_value_t = ControlName::Adaptive)]
    pub(crate) control: ControlName,
    /// Form of the law
    #[arg(long, value_enum, default_value_t = FormName::Model)]
    pub(crate) form: FormName,
    /// Model that the adaptive control estimates with: a file, or the name of a built-in one
    #[arg(long, default_value = "f16-recovery-model")]
    pub(crate) model: String,
    /// Estimator of the adaptive control [default: ekf]
    #[arg(long, value_parser = causal_method())]
    pub(crate) method: Option<Method>,
    /// Add nothing to the pilot's input, however wide the bounds are
    #[arg(long)]
    pub(crate) no_excitation: bool,
    /// Seed of all random numbers, instead of the one in the scenario; of `--damage` the first seed of the study
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = whole::<u64>)]
    pub(crate) seed: Option<u64>,
    /// Put the damage of this number, counted from 0, of `phugoid study recovery` into the scenario
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = whole::<usize>)]
    pub(crate) damage: Option<usize>,
    /// Folder for the page, flight.html
    #[arg(long, value_name = "DIR", default_value = "phugoid-fly")]
    pub(crate) out: PathBuf,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Put the histories of the flight into the JSON document too
    #[arg(long, requires = "json")]
    pub(crate) history: bool,
}

/// Where gains come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ControlName {
    /// The estimate of the aircraft in flight and its bounds
    Adaptive,
    /// The undamaged aircraft
    Fixed,
    /// One set of gains that holds many damages
    Robust,
    /// The true aircraft: what could be reached at best
    Oracle,
}

impl From<ControlName> for Control {
    fn from(name: ControlName) -> Self {
        match name {
            ControlName::Adaptive => Self::Adaptive,
            ControlName::Fixed => Self::Fixed,
            ControlName::Robust => Self::Robust,
            ControlName::Oracle => Self::Oracle,
        }
    }
}

/// Forms of the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormName {
    /// Wanted less modelled angular acceleration
    Model,
    /// Wanted less measured angular acceleration, from where the surfaces are (INDI)
    Incremental,
}

impl From<FormName> for Form {
    fn from(name: FormName) -> Self {
        match name {
            FormName::Model => Self::Model,
            FormName::Incremental => Self::Incremental,
        }
    }
}
