//! Sequence numbers of MAVLink: which frames were lost, came twice, or came in another order.

use std::collections::VecDeque;

/// How far back a sequence number may lie and still count as a lost frame that came late: half of the 256 numbers.
const REACH: u8 = 128;

/// Follows the sequence numbers of one component.
#[derive(Clone, Debug, Default)]
pub struct Sequence {
    /// The newest sequence number, and its index in a count that does not wrap.
    newest: Option<(u8, u64)>,
    /// Indices that have not come, oldest first, each with the arrival (ns) of the frame that showed the gap.
    missing: VecDeque<(u64, u64)>,
}

/// Where a frame belongs among the frames of its component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Index in a count that does not wrap.
    pub index: u64,
    /// How it follows the frames before it.
    pub order: Order,
}

/// How a frame follows those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// It is the next one.
    Next,
    /// It is ahead; so many frames before it are missing.
    After(u64),
    /// It is one of the missing frames, which came late.
    Reordered,
    /// It had come before, or is older than the numbers can tell.
    Duplicate,
}

impl Sequence {
    /// Takes the sequence number of a frame that arrived at this time, ns. The times must not decrease.
    ///
    /// ```
    /// use phugoid_live::mavlink::sequence::{Order, Sequence};
    ///
    /// let mut sequence = Sequence::default();
    /// let orders = [254, 0, 255, 255].map(|number| sequence.take(number, 0).order);
    /// assert_eq!(orders, [Order::Next, Order::After(1), Order::Reordered, Order::Duplicate]);
    /// ```
    pub fn take(&mut self, number: u8, arrival_ns: u64) -> Place {
        let Some((newest, index)) = self.newest else {
            self.newest = Some((number, u64::from(REACH)));
            return Place { index: u64::from(REACH), order: Order::Next };
        };
        let ahead = number.wrapping_sub(newest);
        if ahead != 0 && ahead <= REACH {
            let next = index + u64::from(ahead);
            self.missing.extend((index + 1..next).map(|place| (place, arrival_ns)));
            // A number this far back would be taken for a new one, so the frame cannot come late any more.
            while self.missing.front().is_some_and(|(place, _)| place + u64::from(REACH) <= next) {
                self.missing.pop_front();
            }
            self.newest = Some((number, next));
            let order = if ahead == 1 { Order::Next } else { Order::After(u64::from(ahead) - 1) };
            return Place { index: next, order };
        }
        let behind = u64::from(newest.wrapping_sub(number));
        let place = index.saturating_sub(behind);
        let order = match self.missing.iter().position(|(missing, _)| *missing == place) {
            Some(found) => {
                self.missing.remove(found);
                Order::Reordered
            }
            None => Order::Duplicate,
        };
        Place { index: place, order }
    }

    /// The latest arrival, ns, at or after `since_ns`, of a frame that showed a gap before `index`; `None` if no frame
    /// before `index` is missing since then.
    pub fn latest_gap(&self, index: u64, since_ns: u64) -> Option<u64> {
        self.missing.iter().filter(|(place, shown)| *place < index && *shown >= since_ns).map(|(_, shown)| *shown).max()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_duplicates_and_another_order() {
        let mut sequence = Sequence::default();
        let mut order = |number| sequence.take(number, 0).order;
        assert_eq!(order(253), Order::Next);
        assert_eq!(order(254), Order::Next);
        assert_eq!(order(1), Order::After(2));
        assert_eq!(order(0), Order::Reordered);
        assert_eq!(order(0), Order::Duplicate);
        assert_eq!(order(1), Order::Duplicate);
        assert_eq!(order(2), Order::Next);
        assert_eq!(order(255), Order::Reordered);
    }

    #[test]
    fn gaps_are_forgotten_in_time() {
        let mut sequence = Sequence::default();
        sequence.take(0, 0);
        let late = sequence.take(2, 1_000);
        assert_eq!(sequence.latest_gap(late.index, 0), Some(1_000));
        assert_eq!(sequence.latest_gap(late.index, 1_001), None);
        assert_eq!(sequence.latest_gap(late.index - 1, 0), None);
        sequence.take(1, 1_500);
        assert_eq!(sequence.latest_gap(late.index, 0), None);
        // However long it runs with gaps, what it keeps is bounded.
        for k in 0..10_000_u64 {
            sequence.take((k * 3) as u8, k);
        }
        assert!(sequence.missing.len() <= 128);
    }
}
