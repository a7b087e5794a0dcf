//! `--store`, `--shard` and `--engine` of the commands whose runs can be kept.

#[cfg(feature = "fleet")]
use std::path::PathBuf;

use clap::Args;
#[cfg(feature = "fleet")]
use phugoid_fleet::shard::Shard;

#[cfg(feature = "fleet")]
use super::fleet::Engine;

/// Where the runs of a command are kept, and who makes them: a program without stores has no such options.
#[derive(Debug, Args)]
pub(crate) struct Keeping {
    /// Folder of a store in which each run is kept, so that the same command goes on after a stop of any kind and makes nothing
    /// twice; a new one is made. It may be that of a fleet or of a campaign
    #[cfg(feature = "fleet")]
    #[arg(long, value_name = "DIR")]
    pub(crate) store: Option<PathBuf>,
    /// Begin with the i-th of n parts of the runs and then make what is still missing, for arrays of jobs on several machines with
    /// one store. The result is printed by the same command without this option
    #[cfg(feature = "fleet")]
    #[arg(long, value_name = "i/n", requires = "store")]
    pub(crate) shard: Option<Shard>,
    /// What makes the runs: local, threads of this program; ray, tasks of Ray with this program, on this machine or on the cluster at
    /// ray://HOST:PORT, by the Python package (pip install "phugoid[fleet]"), with python3 or what PHUGOID_PYTHON names [default:
    /// local]
    #[cfg(feature = "fleet")]
    #[arg(long, value_name = "ENGINE", requires = "store", conflicts_with = "shard")]
    pub(crate) engine: Option<Engine>,
}

impl Keeping {
    /// Whether this process helps others: they print the result.
    pub(crate) fn is_part(&self) -> bool {
        #[cfg(feature = "fleet")]
        return self.shard.is_some();
        #[cfg(not(feature = "fleet"))]
        return false;
    }
}
