//! Where data come from.

mod network;
mod outlet;
mod replay;
mod serial;
mod spec;
mod stream;

use std::io;

pub use outlet::Outlet;
use outlet::Run;
pub use replay::{Pace, Replay, ReplayError};
pub use spec::{SourceSpec, SpecError};
use stream::read_all;

/// A source that has been opened.
pub struct Source {
    run: Run,
    /// What it is, as people call it: an address, a device.
    pub name: String,
}

impl Source {
    /// Opens a source. Its name has the address at which it listens: the port is the system's choice if 0 was asked for.
    ///
    /// # Errors
    /// What the operating system says, with what to do.
    pub fn open(spec: &SourceSpec) -> io::Result<Self> {
        let (run, spec): (Run, SourceSpec) = match spec {
            SourceSpec::Udp(address) => {
                let (run, here) = network::udp(address)?;
                (run, SourceSpec::Udp(here))
            }
            SourceSpec::TcpListen(address) => {
                let (run, here) = network::tcp_listen(address)?;
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
        Ok(Self { run, name: spec.to_string() })
    }

    /// Receives until the source ends or is stopped.
    pub fn run(self, outlet: &Outlet) {
        (self.run)(outlet);
    }
}

impl From<Replay> for Source {
    fn from(replay: Replay) -> Self {
        let name = replay.name().to_owned();
        Self { run: Box::new(move |outlet| replay.run(outlet)), name }
    }
}
