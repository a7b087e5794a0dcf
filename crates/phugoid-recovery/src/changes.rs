//! What was known before the changes that an estimator adopted, and is now.

use phugoid_identification::estimation::EventKind;
use phugoid_identification::session::LiveParameter;

use crate::scale::Scale;

/// What was estimated at one moment.
#[derive(Clone, Debug)]
pub(crate) struct Known {
    /// Value and random part of the standard error of each parameter: what two moments share does not count in a difference.
    pub(crate) parameters: Vec<[f64; 2]>,
    /// Airspeed, m/s, and altitude, m.
    pub(crate) flown: [f64; 2],
}

impl Known {
    pub(crate) fn new(parameters: &[LiveParameter], flown: [f64; 2]) -> Self {
        let random = |parameter: &LiveParameter| {
            let (all, shared) = (parameter.std_error, parameter.systematic_std);
            [parameter.value, (all * all - shared * shared).max(0.0).sqrt()]
        };
        Self { parameters: parameters.iter().map(random).collect(), flown }
    }
}

/// The estimates before and after the changes that were adopted last.
#[derive(Default)]
pub(crate) struct Changes {
    /// Outside a doubt, now.
    now: Option<Known>,
    /// Before the doubt that is open, or was last.
    before_doubt: Option<Known>,
    /// Before the first of the last adoptions that followed one another.
    before: Option<Known>,
    adopted_s: Option<f64>,
    /// Number of adopted changes that stand.
    standing: u32,
}

impl Changes {
    /// Adoptions that follow one another so closely are of one change, s at full size.
    const CHAIN_S: f64 = 15.0;

    /// Notes an event of the estimator at a time (s), before what is known after it.
    pub(crate) fn event(&mut self, kind: EventKind, time_s: f64, scale: Scale) {
        match kind {
            EventKind::InDoubt => self.before_doubt.clone_from(&self.now),
            EventKind::Adopted => {
                let follows = self.adopted_s.is_some_and(|at| scale.time(time_s - at) < Self::CHAIN_S);
                if !follows || self.before.is_none() {
                    self.before.clone_from(&self.before_doubt);
                }
                self.adopted_s = Some(time_s);
                self.standing += 1;
            }
            EventKind::RolledBack => {
                self.before = None;
                self.standing = self.standing.saturating_sub(1);
            }
            _ => {}
        }
    }

    /// Whether a change was adopted, and not taken back: one that is taken back leaves those before it.
    pub(crate) fn has_adopted(&self) -> bool {
        self.standing > 0
    }

    /// Notes what is known outside a doubt.
    pub(crate) fn note(&mut self, now: Known) {
        self.now = Some(now);
    }

    /// What was known before the last changes, and what is known after them; none where none was adopted.
    pub(crate) fn before_and_after(&self) -> Option<(&Known, &Known)> {
        self.before.as_ref().zip(self.now.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second change that is taken back leaves the first, and the first taken back leaves none.
    #[test]
    fn what_is_taken_back_leaves_the_changes_before_it() {
        let mut changes = Changes::default();
        let mut then = |kind, time_s| {
            changes.event(kind, time_s, Scale::of_lengths(1.0));
            changes.has_adopted()
        };
        assert!(then(EventKind::Adopted, 10.0) && then(EventKind::Adopted, 11.0));
        assert!(then(EventKind::RolledBack, 12.0));
        assert!(!then(EventKind::RolledBack, 13.0) && !then(EventKind::RolledBack, 14.0));
    }
}
