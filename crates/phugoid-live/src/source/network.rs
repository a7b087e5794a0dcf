//! UDP and TCP.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::Duration;

use super::outlet::{LOOK, Run};
use super::stream::{DATAGRAM, pieces, waits};
use crate::arrival::Content;

/// Peers that are told apart at one time.
const PEERS: u16 = 64;
/// Before a lost connection is tried again.
const AGAIN: Duration = Duration::from_secs(1);

/// Datagrams to an address; the second is where it listens: the port is the system's choice if 0 was asked for.
pub(super) fn udp(address: &SocketAddr) -> io::Result<(Run, SocketAddr)> {
    let socket = UdpSocket::bind(address)?;
    socket.set_read_timeout(Some(LOOK))?;
    let here = socket.local_addr()?;
    let run: Run = Box::new(move |outlet| {
        let mut bytes = vec![0; DATAGRAM];
        let mut peers: Vec<SocketAddr> = Vec::new();
        let mut next = 0;
        while !outlet.stopped() {
            match socket.recv_from(&mut bytes) {
                Ok((read, from)) => {
                    let origin = match peers.iter().position(|peer| *peer == from) {
                        Some(known) => known,
                        None => {
                            // A sender that restarts often has many ports: the oldest of them makes room.
                            let place = next % usize::from(PEERS);
                            next += 1;
                            match peers.get_mut(place) {
                                Some(peer) => *peer = from,
                                None => peers.push(from),
                            }
                            if !outlet.put(place as u16, Content::Opened(format!("udp {from}"))) {
                                return;
                            }
                            place
                        }
                    };
                    let datagram = bytes.get(..read).unwrap_or_default().to_vec();
                    if !outlet.put(origin as u16, Content::Datagram(datagram)) {
                        return;
                    }
                }
                Err(error) if waits(&error) => {}
                // Linux tells so that an earlier answer found no receiver.
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

/// A connection to a server, again and again.
pub(super) fn tcp_connect(address: String) -> Run {
    Box::new(move |outlet| {
        let mut said = false;
        while !outlet.stopped() {
            match TcpStream::connect(&address) {
                Ok(mut stream) => {
                    said = false;
                    if stream.set_read_timeout(Some(LOOK)).is_err()
                        || !outlet.put(0, Content::Opened(format!("tcp {address}")))
                    {
                        return;
                    }
                    pieces(&mut stream, 0, outlet);
                }
                Err(error) => {
                    let reason = format!("tcp {address} cannot be reached ({error}); it is tried again every second");
                    if !said && !outlet.put(0, Content::Closed(reason)) {
                        return;
                    }
                    said = true;
                }
            }
            std::thread::sleep(AGAIN);
        }
    })
}

/// Connections of senders, each a peer of its own; the second is where it listens.
pub(super) fn tcp_listen(address: &SocketAddr) -> io::Result<(Run, SocketAddr)> {
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
                        // Such as too many open files: the next one may go well.
                        outlet.put(0, Content::Closed(format!("a connection failed: {error}")));
                        std::thread::sleep(AGAIN);
                    }
                    std::thread::sleep(LOOK / 4);
                    continue;
                }
            };
            let free = |thread: &Option<std::thread::JoinHandle<()>>| {
                thread.as_ref().is_none_or(std::thread::JoinHandle::is_finished)
            };
            // More than can be told apart are refused: the connection is closed.
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
