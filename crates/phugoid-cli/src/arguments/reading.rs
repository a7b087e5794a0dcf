//! Options of all commands that read a recorded flight.

use clap::Args;
use phugoid_flight_data::memory::Memory;

/// How flights are read.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// The most memory that reading a flight may take; a flight that needs more is refused, and the message says how
    /// much
    #[arg(long, value_name = "SIZE", default_value_t = Memory::default())]
    pub(crate) max_memory: Memory,
}
