//! A socket of its own for the sender that is used, so that a flood of others cannot fill its buffer.
//!
//! Linux gives a datagram to the socket that is connected to its sender before one that takes datagrams of all. So the
//! buffer of the connected one holds datagrams of that sender only.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::net::{AddressFamily, SocketFlags, SocketType, bind, connect, socket_with, sockopt};

/// A socket at the address of `all` that receives what `sender` sends.
///
/// # Errors
/// What the operating system says. The datagrams then go on coming at `all`.
pub(super) fn open(all: &UdpSocket, sender: SocketAddr) -> io::Result<UdpSocket> {
    let family = if sender.is_ipv4() { AddressFamily::INET } else { AddressFamily::INET6 };
    let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
    let own = socket_with(family, SocketType::DGRAM, flags, None)?;
    // Two sockets may have one address only while both allow it. Nobody else is to get the address so.
    sockopt::set_socket_reuseaddr(all, true)?;
    sockopt::set_socket_reuseaddr(&own, true)?;
    let bound = all.local_addr().and_then(|here| Ok(bind(&own, &here)?));
    let shut = sockopt::set_socket_reuseaddr(all, false).and_then(|()| sockopt::set_socket_reuseaddr(&own, false));
    bound?;
    shut?;
    connect(&own, &sender)?;
    Ok(own.into())
}

/// Waits until one of the sockets has a datagram, or for so long (less than a second).
pub(super) fn wait(sockets: &[&UdpSocket], longest: Duration) {
    let mut sockets: Vec<PollFd<'_>> = sockets.iter().map(|socket| PollFd::new(*socket, PollFlags::IN)).collect();
    let longest = Timespec { tv_sec: 0, tv_nsec: i64::from(longest.subsec_nanos()) };
    // Of an interruption by a signal no notice need be taken: the sockets are looked at next.
    let _ = poll(&mut sockets, Some(&longest));
}
