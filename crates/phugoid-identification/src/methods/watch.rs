//! Turns changes of an estimator's status into events.

use phugoid_estimators::{ChangeState, DetectorState, Estimate};

use crate::core::estimation::{Event, EventKind};

/// Turns changes of the status into events.
#[derive(Default)]
pub(super) struct Watch {
    gap_s: f64,
    last_s: Option<f64>,
    pub(super) restarts: u32,
    in_doubt: bool,
    insensitive: bool,
}

impl Watch {
    /// A watch that reports a gap where the interval between two samples is longer than `gap_s`.
    pub(super) fn new(gap_s: f64) -> Self {
        Self { gap_s, ..Self::default() }
    }

    pub(super) fn look<const ROOM: usize>(
        &mut self,
        estimate: &Estimate<ROOM>,
        time_s: f64,
        restarts: u32,
        events: &mut Vec<Event>,
    ) {
        let mut say = |kind: EventKind, message: String| events.push(Event { time_s, kind, message });
        if let Some(last) = self.last_s
            && time_s - last > self.gap_s
        {
            say(EventKind::Gap, format!("no sample for {:.3} s before this one", time_s - last));
        }
        self.last_s = Some(time_s);
        if restarts > self.restarts {
            say(
                EventKind::Restarted,
                "the state was started again from the measurements; the parameters were kept".to_owned(),
            );
        }
        self.restarts = restarts;
        let in_doubt = estimate.status.change == ChangeState::InDoubt;
        match estimate.status.change {
            ChangeState::Adopted => say(
                EventKind::Adopted,
                "the parameters changed: a challenger that allows for it explains the new data better, and was adopted"
                    .to_owned(),
            ),
            ChangeState::RolledBack => say(
                EventKind::RolledBack,
                "the adopted change was taken back: the estimate from before it has predicted better".to_owned(),
            ),
            ChangeState::InDoubt if !self.in_doubt => say(
                EventKind::InDoubt,
                "a change of the parameters is suspected: bounds are widened until it is decided".to_owned(),
            ),
            ChangeState::Steady if self.in_doubt => {
                say(
                    EventKind::DoubtDropped,
                    "the suspicion was dropped: the estimate from before it still explains the data".to_owned(),
                );
            }
            _ => {}
        }
        self.in_doubt = in_doubt;
        let insensitive = estimate.status.detector == DetectorState::Insensitive;
        if insensitive && !self.insensitive {
            say(
                EventKind::Insensitive,
                "model error: this model's parameters wander so much without any change that only large changes can be \
                 told from it"
                    .to_owned(),
            );
        }
        self.insensitive = insensitive;
    }
}
