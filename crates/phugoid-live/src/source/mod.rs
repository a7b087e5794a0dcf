//! Where data come from: UDP, TCP, a serial line, standard input, or a replay.

mod network;
mod outlet;
#[cfg(target_os = "linux")]
mod own_socket;
mod peers;
mod replay;
mod sender;
mod serial;
mod spec;
mod stream;

use std::io;

pub use outlet::Outlet;
use outlet::Run;
pub use replay::{Pace, Replay, ReplayError};
pub use sender::{SenderError, SenderSpec};
pub use spec::{SourceSpec, SpecError};
use stream::read_all;

/// Name of the sender that stands for all senders which are not told apart. It is never used.
pub(crate) const FURTHER_SENDERS: &str = "further senders, which are not told apart";

/// A source that has been opened and can be run once.
pub struct Source {
    run: Run,
    /// Name for people, such as `udp://127.0.0.1:14550`.
    pub name: String,
    mapped: bool,
}

impl Source {
    /// Opens a source. If port 0 was asked for, the name has the port that the operating system chose.
    ///
    /// # Errors
    /// What the operating system says: an address in use, a device that is missing or is no serial line.
    pub fn open(spec: &SourceSpec) -> io::Result<Self> {
        Self::open_for(spec, None)
    }

    /// The same for one sender alone, if one is given: others that send to the same port are counted and not used.
    ///
    /// # Errors
    /// As [`Source::open`].
    pub fn open_for(spec: &SourceSpec, sender: Option<&SenderSpec>) -> io::Result<Self> {
        let wanted = sender.cloned();
        let (run, spec): (Run, SourceSpec) = match spec {
            SourceSpec::Udp(address) => {
                let (run, here) = network::udp(address, wanted)?;
                (run, SourceSpec::Udp(here))
            }
            SourceSpec::TcpListen(address) => {
                let (run, here) = network::tcp_listen(address, wanted)?;
                (run, SourceSpec::TcpListen(here))
            }
            SourceSpec::Tcp(address) => (network::tcp_connect(address.clone()), spec.clone()),
            SourceSpec::Serial { device, baud } => {
                let (port, peer) = (serial::open(device, *baud)?, spec.to_string());
                (Box::new(move |outlet| read_all(port, &peer, outlet)), spec.clone())
            }
            SourceSpec::StandardInput => {
                (Box::new(|outlet| read_all(io::stdin().lock(), "standard input", outlet)), spec.clone())
            }
        };
        Ok(Self { run, name: spec.to_string(), mapped: false })
    }

    /// True if the rows that come have canonical channel names and SI units already, as those of a flight record have
    /// that is replayed ([`Replay::flight`]). The column mappings of a model file must not be applied to them once
    /// more.
    pub fn is_mapped(&self) -> bool {
        self.mapped
    }

    /// Receives until the source ends, or until the stop of the outlet is set or nobody takes the arrivals any more.
    pub fn run(self, outlet: &Outlet) {
        (self.run)(outlet);
    }
}

impl From<Replay> for Source {
    fn from(replay: Replay) -> Self {
        let (name, mapped) = (replay.name().to_owned(), replay.is_mapped());
        Self { run: Box::new(move |outlet| replay.run(outlet)), name, mapped }
    }
}
