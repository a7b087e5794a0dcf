//! How many events may be said, so that nobody can fill the page and the disk with them.

use std::collections::BTreeMap;

use crate::event::LiveEventKind;

/// Events of one kind that may be said at once. Recognised columns are said one by one, so there may be many.
const AT_ONCE: u32 = 5;
const COLUMNS_AT_ONCE: u32 = 64;
/// After that one event of each kind may be said in this time of arrival, ns.
const EACH_NS: u64 = 1_000_000_000;

/// What may still be said of each kind: five events at once, and one a second.
#[derive(Debug, Default)]
pub(super) struct Quota(BTreeMap<LiveEventKind, Left>);

#[derive(Debug)]
struct Left {
    events: u32,
    /// Since when the next event is being earned, ns.
    since_ns: u64,
    /// Events that were not said since the last one that was.
    unsaid: u64,
}

impl Quota {
    /// Whether an event of this kind may be said at this time of arrival, ns. If so, the number of those that were not
    /// said before it; else it is counted.
    pub(super) fn take(&mut self, kind: LiveEventKind, now_ns: u64) -> Option<u64> {
        let most = if kind == LiveEventKind::Columns { COLUMNS_AT_ONCE } else { AT_ONCE };
        let left = self.0.entry(kind).or_insert(Left { events: most, since_ns: now_ns, unsaid: 0 });
        let earned = now_ns.saturating_sub(left.since_ns) / EACH_NS;
        left.events = most.min(left.events.saturating_add(u32::try_from(earned).unwrap_or(u32::MAX)));
        left.since_ns = if left.events == most { now_ns } else { left.since_ns.saturating_add(earned * EACH_NS) };
        match left.events.checked_sub(1) {
            Some(rest) => {
                left.events = rest;
                Some(std::mem::take(&mut left.unsaid))
            }
            None => {
                left.unsaid += 1;
                None
            }
        }
    }

    /// The kinds of which events were not said since the last one that was, with their number; they begin at 0 again.
    pub(super) fn unsaid(&mut self) -> Vec<(LiveEventKind, u64)> {
        let unsaid = self.0.iter_mut().map(|(kind, left)| (*kind, std::mem::take(&mut left.unsaid)));
        unsaid.filter(|(_, unsaid)| *unsaid > 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_at_once_and_one_a_second() {
        let mut quota = Quota::default();
        let said: Vec<Option<u64>> =
            (0..10_000_u64).map(|k| quota.take(LiveEventKind::Refused, k * 1_000_000)).collect();
        let said: Vec<(usize, u64)> = said.iter().enumerate().filter_map(|(k, said)| Some((k, (*said)?))).collect();
        assert_eq!(said[..6], [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (1000, 995)]);
        assert_eq!(said.len(), 14);
        assert!(said[6..].iter().all(|(_, unsaid)| *unsaid == 999));
        assert_eq!(quota.unsaid(), [(LiveEventKind::Refused, 999)]);
        // Each kind has its own.
        assert_eq!(quota.take(LiveEventKind::Origin, 10_000_000_000), Some(0));
        // What is not used is not saved beyond five.
        let late = (0..10).filter(|_| quota.take(LiveEventKind::Refused, 100_000_000_000).is_some());
        assert_eq!(late.count(), 5);
    }
}
