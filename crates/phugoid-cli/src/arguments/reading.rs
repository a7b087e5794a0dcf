//! Options of all commands that read a recorded flight.

use std::path::PathBuf;

use clap::Args;
use phugoid_flight_data::deletion::Deletion;
use phugoid_flight_data::memory::Memory;

/// How flights are read.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// The most memory that reading a flight may take; a flight that needs more is refused, and the message says how
    /// much
    #[arg(long, value_name = "SIZE", default_value_t = Memory::default())]
    pub(crate) max_memory: Memory,
}

/// Values of the flight that are known to be bad.
#[derive(Debug, Args)]
pub(crate) struct Deleting {
    /// Take values that are known to be bad for missing, and list them with the reason in every result. Of one channel or
    /// several at one time, `alpha,beta@12.34s: bird strike`, or in a span, `alpha@12.3s..12.8s: ice`; without a channel,
    /// `12.5s..12.8s: dropout`, of all. Of the flight named first; may be repeated
    #[arg(long, value_name = "[CHANNEL@]TIME[..TIME]: REASON", allow_hyphen_values = true)]
    pub(crate) delete: Vec<Deletion>,
    /// The same from a TOML file: `[[delete]]` tables with `channel`, `at` (or `from` and `to`), `reason`, and `flight` (the
    /// name of its file) for another flight than the first
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) deletions: Option<PathBuf>,
}
