//! Reception over UDP and TCP.

use std::io::{self, Read};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::outlet::{LOOK, Outlet, Run};
#[cfg(target_os = "linux")]
use super::own_socket;
use super::peers::{FURTHER, PEERS, Peers, Place};
use super::stream::{DATAGRAM, pieces, until_end, waits};
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

/// A connection that gives no samples may be closed for another one once it has been open for this long: a sender that works has
/// given some by then.
const PATIENCE: Duration = Duration::from_secs(5);

/// Waits for connections, each of which is a sender of its own. The second value is the address on which it listens.
/// A connection of another one than `wanted`, if that is given, is closed at once.
pub(super) fn tcp_listen(address: &SocketAddr, wanted: Option<SenderSpec>) -> io::Result<(Run, SocketAddr)> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    let here = listener.local_addr()?;
    let run: Run = Box::new(move |outlet| accept_all(&listener, wanted.as_ref(), PATIENCE, outlet));
    Ok((run, here))
}

fn accept_all(listener: &TcpListener, wanted: Option<&SenderSpec>, patience: Duration, outlet: &Outlet) {
    let mut places = Places::new(patience);
    // The connection that waits for a place. Those behind it wait in the operating system, with what they have sent.
    let mut waiting: Option<(TcpStream, SocketAddr)> = None;
    while !outlet.stopped() {
        let (stream, from) = match waiting.take().map_or_else(|| listener.accept(), Ok) {
            Ok(accepted) => accepted,
            Err(error) => {
                if !waits(&error) {
                    // For example too many open files. Later connections may succeed.
                    outlet.put(FURTHER, Content::Closed(format!("a connection failed: {error}")));
                    std::thread::sleep(RETRY_AFTER);
                }
                std::thread::sleep(LOOK / 4);
                continue;
            }
        };
        if wanted.is_some_and(|wanted| !wanted.is(from)) {
            outlet.attention.throw_away();
            continue;
        }
        let Some(place) = places.free(outlet.attention.pinned()) else {
            waiting = Some((stream, from));
            std::thread::sleep(LOOK / 4);
            continue;
        };
        let usable = stream.set_nonblocking(false).and_then(|()| stream.set_read_timeout(Some(LOOK)));
        // One that cannot be read is closed.
        if usable.is_ok() {
            places.take(place, stream, from, outlet);
        }
    }
}

/// The connections that are open. There are as many as senders that are told apart, so that a stranger's, which cost nothing, must
/// not keep a place from the aircraft.
struct Places {
    places: Vec<Option<Connection>>,
    patience: Duration,
}

/// One of them, which a thread reads.
struct Connection {
    thread: std::thread::JoinHandle<()>,
    stream: TcpStream,
    opened: Instant,
    state: Arc<ConnectionState>,
}

/// What the thread of a connection and that of all places tell each other.
#[derive(Default)]
struct ConnectionState {
    /// When data came last, ms after the connection was opened.
    heard_ms: AtomicU64,
    /// The place is needed.
    gives_way: AtomicBool,
}

impl Places {
    fn new(patience: Duration) -> Self {
        let mut places = Vec::new();
        places.resize_with(usize::from(PEERS), || None);
        Self { places, patience }
    }

    /// The number of a place for a new connection; `None` if all are taken and none gives way. Of the connections that give no
    /// samples, and have had the time for it, the one gives way that has been silent longest: never the `pinned` one.
    fn free(&mut self, pinned: Option<u16>) -> Option<usize> {
        let is_free = |place: &Option<Connection>| place.as_ref().is_none_or(|c| c.thread.is_finished());
        if let Some(free) = self.places.iter().position(is_free) {
            return Some(free);
        }
        let silent = |(place, connection): (usize, &Option<Connection>)| {
            let connection = connection.as_ref()?;
            let open = connection.opened.elapsed();
            let heard = Duration::from_millis(connection.state.heard_ms.load(Ordering::Relaxed));
            (open >= self.patience && pinned.map(usize::from) != Some(place))
                .then(|| (open.saturating_sub(heard), place))
        };
        let (_, place) = self.places.iter().enumerate().filter_map(silent).max()?;
        let connection = self.places.get_mut(place)?.take()?;
        connection.state.gives_way.store(true, Ordering::Relaxed);
        // It ends the reading, and fails if the other side has closed already, which ends it too.
        let _ = connection.stream.shutdown(Shutdown::Both);
        // The end of this connection has to be in the queue before the beginning of the next one with its number.
        let _ = connection.thread.join();
        Some(place)
    }

    /// Reads a connection from now on, with the number of this place.
    fn take(&mut self, place: usize, stream: TcpStream, from: SocketAddr, outlet: &Outlet) {
        let (origin, outlet, opened) = (place as u16, outlet.clone(), Instant::now());
        let state = Arc::new(ConnectionState::default());
        let Ok(read) = stream.try_clone() else { return };
        let mut heard = Heard { stream: read, opened, state: Arc::clone(&state) };
        let spawned = std::thread::Builder::new().name("tcp peer".to_owned()).spawn(move || {
            if !outlet.put(origin, Content::Opened(format!("tcp {from}"))) {
                return;
            }
            let Some(mut reason) = until_end(&mut heard, origin, &outlet) else { return };
            if heard.state.gives_way.load(Ordering::Relaxed) {
                let open_s = opened.elapsed().as_secs_f64();
                reason = format!(
                    "closed, because all {PEERS} places are taken, another connection came, and this one has given no sample \
                     in {open_s:.1} s"
                );
            }
            outlet.put(origin, Content::Closed(reason));
        });
        if let (Ok(thread), Some(slot)) = (spawned, self.places.get_mut(place)) {
            *slot = Some(Connection { thread, stream, opened, state });
        }
    }
}

/// A stream that notes when data came.
struct Heard {
    stream: TcpStream,
    opened: Instant,
    state: Arc<ConnectionState>,
}

impl Read for Heard {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.stream.read(bytes)?;
        if read > 0 {
            let heard_ms = u64::try_from(self.opened.elapsed().as_millis()).unwrap_or(u64::MAX);
            self.state.heard_ms.store(heard_ms, Ordering::Relaxed);
        }
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::sync::mpsc;

    use super::*;
    use crate::arrival::{Arrival, Clock};
    use crate::stop::{Stop, Why};

    const SHORT: Duration = Duration::from_millis(300);

    /// The next arrival that fits. Others are passed over.
    fn wait_for(arrivals: &mpsc::Receiver<Arrival>, fits: impl Fn(&Arrival) -> bool) -> Arrival {
        loop {
            let arrival = arrivals.recv_timeout(Duration::from_secs(20)).unwrap();
            if fits(&arrival) {
                return arrival;
            }
        }
    }

    /// Strangers that take all places and say nothing keep the aircraft out for a moment alone, and never close its connection.
    #[test]
    fn a_connection_without_samples_gives_its_place_to_a_new_one() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        let here = listener.local_addr().unwrap();
        let (queue, arrivals) = mpsc::sync_channel(8192);
        let stop = Arc::new(Stop::default());
        let outlet = Outlet::new(queue, Arc::clone(&stop), Clock::start());
        let attention = outlet.attention();
        let source = std::thread::spawn(move || accept_all(&listener, None, SHORT, &outlet));
        let connect = || TcpStream::connect(here).unwrap();
        let mut aircraft = connect();
        let name = |stream: &TcpStream| format!("tcp {}", stream.local_addr().unwrap());
        let is_opened =
            |arrival: &Arrival, peer: &str| matches!(&arrival.content, Content::Opened(name) if name == peer);
        let used = wait_for(&arrivals, |arrival| is_opened(arrival, &name(&aircraft))).origin;
        attention.pin(Some(used));
        let idle: Vec<TcpStream> = (1..PEERS).map(|_| connect()).collect();
        // One of them was heard later than the others.
        let last = name(&idle[62]);
        wait_for(&arrivals, |arrival| is_opened(arrival, &last));
        // All have had their time then.
        std::thread::sleep(2 * SHORT);
        (&idle[0]).write_all(b"hello").unwrap();
        let heard = wait_for(&arrivals, |arrival| matches!(arrival.content, Content::Piece(_))).origin;

        // What it sends while it waits is not lost.
        let mut other = connect();
        other.write_all(b"time_s,alpha_deg\n").unwrap();
        let is_closed = |arrival: &Arrival| matches!(&arrival.content, Content::Closed(_));
        let closed = wait_for(&arrivals, is_closed);
        let Content::Closed(why) = &closed.content else { panic!("{closed:?}") };
        assert!(why.contains("all 64 places are taken") && why.contains("no sample"), "{why}");
        let opened = wait_for(&arrivals, |arrival| is_opened(arrival, &name(&other)));
        assert_eq!(opened.origin, closed.origin);
        let piece = wait_for(&arrivals, |arrival| matches!(arrival.content, Content::Piece(_)));
        assert_eq!((piece.origin, &piece.content), (opened.origin, &Content::Piece(b"time_s,alpha_deg\n".to_vec())));

        // All the silent ones go before the one that was heard, and the used one never does.
        let further: Vec<TcpStream> = (0..62).map(|_| connect()).collect();
        let mut gone = vec![closed.origin];
        while gone.len() < 63 {
            gone.push(wait_for(&arrivals, is_closed).origin);
        }
        assert!(!gone.contains(&used) && gone.iter().position(|origin| *origin == heard) == Some(62), "{gone:?}");
        aircraft.write_all(b"still here").unwrap();
        wait_for(&arrivals, |arrival| arrival.origin == used && matches!(arrival.content, Content::Piece(_)));
        stop.ask(Why::Over);
        source.join().unwrap();
        drop((idle, further));
    }
}
