//! The connections that are open: so many at most, and which one is closed for a new one.

use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use tokio::task::AbortHandle;

/// Connections at one time, ...
const AT_ONCE: usize = 128;
/// ... and of one address. For one more an older one of that address is closed.
const OF_ONE_ADDRESS: usize = 64;
/// A younger connection is not closed for a new one, so that its request can be read first, ...
const YOUNG: Duration = Duration::from_millis(500);
/// ... unless there are so many.
const AT_ALL: usize = 512;

/// The open connections; clones share them.
#[derive(Clone, Default)]
pub(super) struct Connections(Arc<Mutex<Open>>);

#[derive(Default)]
struct Open {
    next: u64,
    /// By number, so the oldest come first.
    open: BTreeMap<u64, Connection>,
}

struct Connection {
    from: IpAddr,
    since: Instant,
    stage: Stage,
    /// Its task; closing the connection is to end that.
    task: Option<AbortHandle>,
}

/// What a connection does. The first stage is the first to be closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    /// No request has come.
    Silent,
    /// It does not take what is sent to it.
    Stuck,
    /// It is being answered.
    Answered,
}

/// A place among the open connections, free again when it is dropped.
pub(super) struct Place {
    connections: Connections,
    number: u64,
}

impl Connections {
    /// A place for a new connection. Others are closed for it if there are too many.
    pub(super) fn place(&self, from: IpAddr, now: Instant) -> Place {
        let mut open = self.lock();
        open.make_room(from, now);
        let number = open.next;
        open.next += 1;
        open.open.insert(number, Connection { from, since: now, stage: Stage::Silent, task: None });
        Place { connections: self.clone(), number }
    }

    fn lock(&self) -> MutexGuard<'_, Open> {
        // No code panics while it holds the lock, and the map is whole between its calls.
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Open {
    fn make_room(&mut self, from: IpAddr, now: Instant) {
        let mut of_address: HashMap<IpAddr, usize> = HashMap::new();
        self.open.values().for_each(|connection| *of_address.entry(connection.from).or_default() += 1);
        let of_this = of_address.get(&from).copied().unwrap_or_default();
        let largest = of_address.into_iter().max_by_key(|(_, count)| *count).map(|(address, _)| address);
        let address = match self.open.len() {
            _ if of_this >= OF_ONE_ADDRESS => Some(from),
            open if open >= AT_ONCE => largest,
            _ => None,
        };
        let Some(address) = address else { return };
        let full = self.open.len() >= AT_ALL;
        let may_go = |connection: &Connection| {
            connection.from == address && (full || now.saturating_duration_since(connection.since) >= YOUNG)
        };
        let candidates = self.open.iter().filter(|(_, connection)| may_go(connection));
        let worst =
            candidates.min_by_key(|(number, connection)| (connection.stage, **number)).map(|(number, _)| *number);
        if let Some(task) = worst.and_then(|number| self.open.remove(&number)).and_then(|connection| connection.task) {
            task.abort();
        }
    }
}

impl Place {
    /// Says which task serves the connection.
    pub(super) fn is_served_by(connections: &Connections, number: u64, task: AbortHandle) {
        match connections.lock().open.get_mut(&number) {
            Some(connection) => connection.task = Some(task),
            // It was closed before.
            None => task.abort(),
        }
    }

    /// The number of the place.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Says what the connection does now.
    pub(super) fn reaches(&self, stage: Stage) {
        if let Some(connection) = self.connections.lock().open.get_mut(&self.number) {
            connection.stage = stage;
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.connections.lock().open.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(last: u8) -> IpAddr {
        [10, 0, 0, last].into()
    }

    fn numbers(connections: &Connections) -> Vec<u64> {
        connections.lock().open.keys().copied().collect()
    }

    #[test]
    fn for_a_new_connection_the_oldest_silent_one_goes_then_a_stuck_one() {
        let (connections, start) = (Connections::default(), Instant::now());
        let mut places: Vec<Place> = (0..64).map(|_| connections.place(address(1), start)).collect();
        places.iter().for_each(|place| place.reaches(Stage::Answered));
        places[7].reaches(Stage::Stuck);
        places[9].reaches(Stage::Silent);
        places[8].reaches(Stage::Silent);
        // None is old enough yet.
        places.push(connections.place(address(1), start));
        assert_eq!(connections.lock().open.len(), 65);
        let later = start + YOUNG;
        for gone in [8, 9, 64, 7, 0] {
            places.push(connections.place(address(1), later));
            places.last().unwrap().reaches(Stage::Answered);
            assert!(!numbers(&connections).contains(&gone), "{gone}: {:?}", numbers(&connections));
        }
        // Another address has places of its own.
        places.push(connections.place(address(2), later));
        assert!(numbers(&connections).contains(&1));
        drop(places);
        assert!(numbers(&connections).is_empty());
    }

    #[test]
    fn many_addresses_take_from_the_one_with_most() {
        let (connections, start) = (Connections::default(), Instant::now());
        let mut places: Vec<Place> = (0..60).map(|_| connections.place(address(1), start)).collect();
        places.extend((0..68).map(|k| connections.place(address(2 + k % 34), start)));
        let later = start + YOUNG;
        places.push(connections.place(address(200), later));
        assert_eq!((numbers(&connections).len(), numbers(&connections)[0]), (128, 1));
        // However young they are, there is an end.
        places.extend((0..1000).map(|k| connections.place(address((k % 250) as u8), later)));
        assert!(numbers(&connections).len() <= AT_ALL);
    }
}
