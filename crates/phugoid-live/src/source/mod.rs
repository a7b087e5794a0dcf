//! Where data come from.

mod network;
mod replay;
mod serial;
mod spec;

use std::io::{self, Read};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use crate::arrival::{Arrival, Clock, Content};
use crate::stop::Stop;
pub use replay::{Pace, Replay, ReplayError};
pub use spec::{SourceSpec, SpecError};

/// How often a source that hears nothing looks whether it is to stop.
const LOOK: Duration = Duration::from_millis(100);
/// The largest datagram.
const DATAGRAM: usize = 65_536;
/// Peers that are told apart at one time.
const PEERS: u16 = 64;

/// Where a source puts what arrives, and how it hears that it is to stop.
#[derive(Clone)]
pub struct Outlet {
    queue: SyncSender<Arrival>,
    stop: Arc<Stop>,
    clock: Clock,
}

impl Outlet {
    /// An outlet into a queue.
    pub fn new(queue: SyncSender<Arrival>, stop: Arc<Stop>, clock: Clock) -> Self {
        Self { queue, stop, clock }
    }

    fn stopped(&self) -> bool {
        self.stop.asked().is_some()
    }

    /// Puts what has just arrived; false when nobody wants more. It waits where the estimation is behind: then the operating
    /// system's buffers hold what comes.
    fn put(&self, origin: u16, content: Content) -> bool {
        self.pass(self.clock.stamp(origin, content))
    }

    fn pass(&self, arrival: Arrival) -> bool {
        !self.stopped() && self.queue.send(arrival).is_ok()
    }
}

/// Receives until its source ends or is stopped.
type Run = Box<dyn FnOnce(&Outlet) + Send>;

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

/// Passes on a stream until its end.
fn read_all(mut input: impl Read, peer: &str, outlet: &Outlet) {
    if !outlet.put(0, Content::Opened(peer.to_owned())) {
        return;
    }
    pieces(&mut input, 0, outlet);
}

/// Passes on the pieces of one peer's stream, and why it ended.
fn pieces(input: &mut impl Read, origin: u16, outlet: &Outlet) {
    let mut bytes = vec![0; DATAGRAM];
    let reason = loop {
        match input.read(&mut bytes) {
            Ok(0) => break "the end of the data".to_owned(),
            Ok(read) => {
                let piece = bytes.get(..read).unwrap_or_default().to_vec();
                if !outlet.put(origin, Content::Piece(piece)) {
                    return;
                }
            }
            Err(error) if waits(&error) => {
                if outlet.stopped() {
                    return;
                }
            }
            Err(error) => break format!("reading failed: {error}"),
        }
    };
    outlet.put(origin, Content::Closed(reason));
}

/// Nothing there yet, or interrupted: no error.
fn waits(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
