//! The senders of datagrams: which number each has, and whose datagrams are thrown away.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use super::SenderSpec;
use super::outlet::Attention;

/// Senders that are distinguished at one time.
pub(super) const PEERS: u16 = 64;
/// The number of all further senders together, and of those that are not asked for. None of them is ever used.
pub(super) const FURTHER: u16 = PEERS;
/// The place of a sender that has been silent for this long may be given to another one.
const SILENT: Duration = Duration::from_secs(10);
/// Datagrams a second that are passed on of senders which are not used, while the one that is used sends.
const STRANGERS_A_SECOND: u32 = 500;
/// The sender that is used counts as sending if it was heard within this time.
const SENDS: Duration = Duration::from_secs(2);

/// The senders of one socket.
pub(super) struct Peers {
    known: Vec<(SocketAddr, Instant)>,
    wanted: Option<SenderSpec>,
    further_said: bool,
    /// The second in which strangers are counted, and how many it had.
    strangers: (Instant, u32),
}

/// What becomes of a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// It is passed on under this number.
    Known(u16),
    /// The same, and the sender has to be announced.
    New(u16),
    /// It is thrown away.
    Nowhere,
}

impl Peers {
    pub(super) fn new(wanted: Option<SenderSpec>, now: Instant) -> Self {
        Self { known: Vec::new(), wanted, further_said: false, strangers: (now, 0) }
    }

    /// The place of a datagram of this sender.
    pub(super) fn place(&mut self, from: SocketAddr, now: Instant, attention: &Attention) -> Place {
        let pinned = attention.pinned();
        let (origin, is_new) = self.number(from, now, pinned);
        let used = pinned.and_then(|pinned| self.known.get(usize::from(pinned)));
        let is_used = pinned == Some(origin);
        let sends = used.is_some_and(|(_, heard)| now.saturating_duration_since(*heard) < SENDS);
        // Nobody is used yet, or it is silent: then another one may be the next.
        let may_be_used = is_used || (origin != FURTHER && !sends);
        if !may_be_used {
            if now.saturating_duration_since(self.strangers.0) >= Duration::from_secs(1) {
                self.strangers = (now, 0);
            }
            self.strangers.1 = self.strangers.1.saturating_add(1);
            if self.strangers.1 > STRANGERS_A_SECOND && !is_new {
                attention.throw_away();
                return Place::Nowhere;
            }
        }
        if is_new { Place::New(origin) } else { Place::Known(origin) }
    }

    /// The address of the sender with this number.
    #[cfg(target_os = "linux")]
    pub(super) fn address(&self, origin: u16) -> Option<SocketAddr> {
        self.known.get(usize::from(origin)).map(|(peer, _)| *peer)
    }

    /// The number of a sender, and whether it is a new one.
    fn number(&mut self, from: SocketAddr, now: Instant, pinned: Option<u16>) -> (u16, bool) {
        if let Some(known) = self.known.iter().position(|(peer, _)| *peer == from) {
            if let Some((_, heard)) = self.known.get_mut(known) {
                *heard = now;
            }
            return (known as u16, false);
        }
        if self.wanted.as_ref().is_some_and(|wanted| !wanted.is(from)) {
            return (FURTHER, !std::mem::replace(&mut self.further_said, true));
        }
        if self.known.len() < usize::from(PEERS) {
            self.known.push((from, now));
            return (self.known.len() as u16 - 1, true);
        }
        // A sender that restarts often uses many ports, so the one that has been silent longest is forgotten, but none
        // that is still sending, and not the one that is used.
        let free = |(place, (_, heard)): &(usize, &(SocketAddr, Instant))| {
            now.saturating_duration_since(*heard) >= SILENT && pinned != Some(*place as u16)
        };
        let oldest = self.known.iter().enumerate().filter(free).min_by_key(|(_, (_, heard))| *heard);
        let Some(place) = oldest.map(|(place, _)| place) else {
            return (FURTHER, !std::mem::replace(&mut self.further_said, true));
        };
        if let Some(peer) = self.known.get_mut(place) {
            *peer = (from, now);
        }
        (place as u16, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(port: u16) -> SocketAddr {
        SocketAddr::from(([10, 0, 0, 1], port))
    }

    #[test]
    fn a_sender_that_is_alive_keeps_its_place() {
        let (start, attention) = (Instant::now(), Attention::default());
        let mut peers = Peers::new(None, start);
        assert_eq!(peers.place(address(1), start, &attention), Place::New(0));
        // Ninety strangers, one after another, while the sender goes on.
        for k in 0..90_u16 {
            let now = start + Duration::from_millis(100) * u32::from(k);
            let place = peers.place(address(1000 + k), now, &attention);
            assert_eq!(
                place,
                if k < 63 {
                    Place::New(k + 1)
                } else if k == 63 {
                    Place::New(64)
                } else {
                    Place::Known(64)
                }
            );
            assert_eq!(peers.place(address(1), now, &attention), Place::Known(0));
        }
        // The place of one that was silent is given away, that of the used one never.
        attention.pin(Some(0));
        let later = start + Duration::from_secs(100);
        let places: Vec<Place> = (0..64).map(|k| peers.place(address(5000 + k), later, &attention)).collect();
        assert!(places[..63].iter().all(|place| matches!(place, Place::New(1..=63))), "{places:?}");
        assert_eq!(places[63], Place::Known(64));
        assert_eq!(peers.place(address(1), later, &attention), Place::Known(0));
    }

    #[test]
    fn a_flood_of_strangers_is_thrown_away_while_the_sender_sends() {
        let (start, attention) = (Instant::now(), Attention::default());
        let mut peers = Peers::new(None, start);
        peers.place(address(1), start, &attention);
        attention.pin(Some(0));
        let flood = |peers: &mut Peers, at: Duration| {
            let places = (0..10_000).map(|_| peers.place(address(2), start + at, &attention));
            places.filter(|place| *place != Place::Nowhere).count()
        };
        assert_eq!(flood(&mut peers, Duration::from_millis(1)), 500);
        assert_eq!(flood(&mut peers, Duration::from_millis(999)), 0);
        assert_eq!(attention.thrown_away(), 19_500);
        assert_eq!(peers.place(address(1), start + Duration::from_secs(1), &attention), Place::Known(0));
        assert_eq!(flood(&mut peers, Duration::from_millis(2100)), 500);
        // Once the sender is silent, somebody else may be the next.
        assert_eq!(flood(&mut peers, Duration::from_millis(3100)), 10_000);
    }

    #[test]
    fn only_the_sender_that_is_asked_for_has_a_place() {
        let (now, attention) = (Instant::now(), Attention::default());
        let mut peers = Peers::new(Some("10.0.0.1:7".parse().unwrap()), now);
        assert_eq!(peers.place(address(8), now, &attention), Place::New(FURTHER));
        assert_eq!(peers.place(address(9), now, &attention), Place::Known(FURTHER));
        assert_eq!(peers.place(address(7), now, &attention), Place::New(0));
    }
}
