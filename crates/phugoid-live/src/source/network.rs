//! Reception over UDP and TCP.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use super::outlet::{LOOK, Run};
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
        let mut bytes = vec![0; DATAGRAM];
        let mut peers = Peers::new(wanted, Instant::now());
        while !outlet.stopped() {
            match socket.recv_from(&mut bytes) {
                Ok((read, from)) => {
                    let origin = match peers.place(from, Instant::now(), &outlet.attention) {
                        Place::Nowhere => continue,
                        Place::Known(origin) => origin,
                        Place::New(origin) => {
                            let name = match origin {
                                FURTHER => FURTHER_SENDERS.to_owned(),
                                _ => format!("udp {from}"),
                            };
                            if !outlet.put(origin, Content::Opened(name)) {
                                return;
                            }
                            origin
                        }
                    };
                    let datagram = bytes.get(..read).unwrap_or_default().to_vec();
                    if !outlet.put(origin, Content::Datagram(datagram)) {
                        return;
                    }
                }
                Err(error) if waits(&error) => {}
                // Linux reports here that an earlier packet of this socket found no receiver.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(error) => {
                    outlet.put(0, Content::Closed(format!("receiving failed: {error}")));
                    return;
                }
            }
        }
    });
    Ok((run, here))
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
