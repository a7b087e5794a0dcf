//! Reception over UDP and TCP.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use super::outlet::{LOOK, Outlet, Run};
#[cfg(target_os = "linux")]
use super::own_socket;
use super::peers::{FURTHER, PEERS, Peers, Place};
use super::stream::{DATAGRAM, pieces, waits};
use super::{FURTHER_SENDERS, SenderSpec};
use crate::arrival::Content;

/// Time before a lost connection is tried again.
const RETRY_AFTER: Duration = Duration::from_secs(1);

/// Receives datagrams that are sent to an address; only those of `wanted`, if that is given, are told apart. The second
/// value is that address with the port that the operating system chose, if 0 was asked for.
pub(super) fn udp(address: &SocketAddr, wanted: Option<SenderSpec>) -> io::Result<(Run, SocketAddr)> {
    let socket = UdpSocket::bind(address)?;
    socket.set_read_timeout(Some(LOOK))?;
    let here = socket.local_addr()?;
    let run: Run = Box::new(move |outlet| {
        let mut reception = Reception { bytes: vec![0; DATAGRAM], peers: Peers::new(wanted, Instant::now()), outlet };
        if let Err(error) = reception.run(&socket) {
            outlet.put(0, Content::Closed(format!("receiving failed: {error}")));
        }
    });
    Ok((run, here))
}

/// The reception of datagrams.
struct Reception<'a> {
    bytes: Vec<u8>,
    peers: Peers,
    outlet: &'a Outlet,
}

/// Datagrams that are taken at once from the socket of all senders, before that of the one in use is looked at.
#[cfg(target_os = "linux")]
const AT_ONCE: usize = 64;
/// Datagrams of the sender in use that may still be at the socket of all when it gets its own: no buffer holds more.
#[cfg(target_os = "linux")]
const BEFORE: usize = 65_536;
/// For so long the socket of all is left alone once strangers have sent more than is passed on of them. What comes
/// meanwhile and does not fit into its buffer the operating system throws away, at a cost that is not this program's: to
/// take a flood out only to throw it away would leave the estimation waiting for a processor.
#[cfg(target_os = "linux")]
const REST: Duration = Duration::from_millis(20);

impl Reception<'_> {
    /// Receives until the source has to end.
    #[cfg(not(target_os = "linux"))]
    fn run(&mut self, socket: &UdpSocket) -> io::Result<()> {
        while !self.outlet.stopped() && self.take(socket, 1)?.is_some() {}
        Ok(())
    }

    /// The same, with a socket of its own for the sender in use.
    #[cfg(target_os = "linux")]
    fn run(&mut self, socket: &UdpSocket) -> io::Result<()> {
        socket.set_nonblocking(true)?;
        let mut own: Option<(SocketAddr, Option<UdpSocket>)> = None;
        // Until then the socket of all is left alone.
        let mut rests_until: Option<Instant> = None;
        while !self.outlet.stopped() {
            let used = self.outlet.attention.pinned().and_then(|origin| self.peers.address(origin));
            if own.as_ref().map(|(address, _)| *address) != used {
                own = used.map(|address| (address, own_socket::open(socket, address).ok()));
                // What came before has to go before.
                if own.is_some() && self.take(socket, BEFORE)?.is_none() {
                    return Ok(());
                }
            }
            let its = own.as_ref().and_then(|(_, its)| its.as_ref());
            let Some(of_own) = its.map_or(Ok(Some(0)), |its| self.take(its, usize::MAX))? else { return Ok(()) };
            let rest = rests_until.map(|until| until.saturating_duration_since(Instant::now()));
            if let (Some(its), Some(rest)) = (its, rest.filter(|rest| !rest.is_zero())) {
                own_socket::wait(&[its], rest);
                continue;
            }
            let thrown_away = self.outlet.attention.thrown_away();
            let Some(of_all) = self.take(socket, AT_ONCE)? else { return Ok(()) };
            rests_until = (self.outlet.attention.thrown_away() > thrown_away).then(|| Instant::now() + REST);
            if of_own + of_all == 0 {
                let sockets: Vec<&UdpSocket> = std::iter::once(socket).chain(its).collect();
                own_socket::wait(&sockets, LOOK);
            }
        }
        Ok(())
    }

    /// Takes datagrams until there is none, but no more than `most`; gives their number, or `None` if the source has to
    /// end.
    fn take(&mut self, socket: &UdpSocket, most: usize) -> io::Result<Option<usize>> {
        for taken in 0..most {
            if self.outlet.stopped() {
                return Ok(None);
            }
            match socket.recv_from(&mut self.bytes) {
                Ok((read, from)) => {
                    if !self.pass(read, from) {
                        return Ok(None);
                    }
                }
                Err(error) if waits(&error) => return Ok(Some(taken)),
                // Linux reports here that an earlier packet of this socket found no receiver.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(error) => return Err(error),
            }
        }
        Ok(Some(most))
    }

    /// Passes a datagram of `read` bytes on; false if the source has to end.
    fn pass(&mut self, read: usize, from: SocketAddr) -> bool {
        let origin = match self.peers.place(from, Instant::now(), &self.outlet.attention) {
            Place::Nowhere => return true,
            Place::Known(origin) => origin,
            Place::New(origin) => {
                let name = if origin == FURTHER { FURTHER_SENDERS.to_owned() } else { format!("udp {from}") };
                if !self.outlet.put(origin, Content::Opened(name)) {
                    return false;
                }
                origin
            }
        };
        let datagram = self.bytes.get(..read).unwrap_or_default().to_vec();
        self.outlet.put(origin, Content::Datagram(datagram))
    }
}

/// Connects to a server, and connects again whenever the connection is lost.
pub(super) fn tcp_connect(address: String) -> Run {
    Box::new(move |outlet| {
        let mut failure_reported = false;
        while !outlet.stopped() {
            match TcpStream::connect(&address) {
                Ok(mut stream) => {
                    failure_reported = false;
                    if stream.set_read_timeout(Some(LOOK)).is_err()
                        || !outlet.put(0, Content::Opened(format!("tcp {address}")))
                    {
                        return;
                    }
                    pieces(&mut stream, 0, outlet);
                }
                Err(error) => {
                    let reason = format!("tcp {address} cannot be reached ({error}); it is tried again every second");
                    if !failure_reported && !outlet.put(0, Content::Closed(reason)) {
                        return;
                    }
                    failure_reported = true;
                }
            }
            std::thread::sleep(RETRY_AFTER);
        }
    })
}

/// Waits for connections, each of which is a sender of its own. The second value is the address on which it listens.
/// A connection of another one than `wanted`, if that is given, is closed at once.
pub(super) fn tcp_listen(address: &SocketAddr, wanted: Option<SenderSpec>) -> io::Result<(Run, SocketAddr)> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    let here = listener.local_addr()?;
    let run: Run = Box::new(move |outlet| {
        let mut threads: Vec<Option<std::thread::JoinHandle<()>>> = Vec::new();
        threads.resize_with(usize::from(PEERS), || None);
        while !outlet.stopped() {
            let (mut stream, from) = match listener.accept() {
                Ok(accepted) => accepted,
                Err(error) => {
                    if !waits(&error) {
                        // For example too many open files. Later connections may succeed.
                        outlet.put(0, Content::Closed(format!("a connection failed: {error}")));
                        std::thread::sleep(RETRY_AFTER);
                    }
                    std::thread::sleep(LOOK / 4);
                    continue;
                }
            };
            if wanted.as_ref().is_some_and(|wanted| !wanted.is(from)) {
                outlet.attention.throw_away();
                continue;
            }
            let free = |thread: &Option<std::thread::JoinHandle<()>>| {
                thread.as_ref().is_none_or(std::thread::JoinHandle::is_finished)
            };
            // If all numbers are taken, the connection is closed.
            let Some(place) = threads.iter().position(free) else { continue };
            let usable = stream.set_nonblocking(false).and_then(|()| stream.set_read_timeout(Some(LOOK)));
            if usable.is_err() {
                continue;
            }
            let (origin, outlet) = (place as u16, outlet.clone());
            let spawned = std::thread::Builder::new().name("tcp peer".to_owned()).spawn(move || {
                if outlet.put(origin, Content::Opened(format!("tcp {from}"))) {
                    pieces(&mut stream, origin, &outlet);
                }
            });
            if let (Ok(thread), Some(slot)) = (spawned, threads.get_mut(place)) {
                *slot = Some(thread);
            }
        }
    });
    Ok((run, here))
}
