//! `phugoid campaign`.

use std::path::PathBuf;

use clap::Args;
use phugoid_fleet::shard::Shard;

use super::delivery::Delivery;
use super::fleet::Engine;
use super::help::examples_and_exit_codes;

/// Flies scenarios with something varied, estimates each flight by several methods, and scores them against the truth
///
/// What is in the store already is neither flown nor estimated again. docs/fleet.md describes the file.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid campaign noise.toml --store study                      on all cores
  phugoid campaign noise.toml --store study --shard 3/8          a part of it, on one of eight machines
  phugoid campaign noise.toml --store study --json"
))]
pub(crate) struct Campaign {
    /// File of the campaign
    #[arg(value_name = "FILE.toml")]
    pub(crate) file: PathBuf,
    /// Folder of the store; a new one is made. It may be that of a fleet
    #[arg(long, value_name = "DIR")]
    pub(crate) store: PathBuf,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(crate) workers: Option<u16>,
    /// The i-th of n parts of the campaign, for arrays of jobs on several machines with one store
    #[arg(long, value_name = "i/n", default_value_t)]
    pub(crate) shard: Shard,
    /// What does the work: local, threads of this program; ray, a task of Ray for each block, on this machine or on the cluster at
    /// ray://HOST:PORT, by the Python package (pip install "phugoid[fleet]"), with python3 or what PHUGOID_PYTHON names
    #[arg(long, value_name = "ENGINE", default_value_t)]
    pub(crate) engine: Engine,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}
