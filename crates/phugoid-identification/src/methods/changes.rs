//! The adopted changes of a run: the estimate before each and after it.

use std::collections::VecDeque;

use phugoid_estimators::ChangeState;

use super::snapshot::{Column, Snapshot};
use super::task::RunChange;
use crate::core::estimation::ChangeOutcome;
use crate::core::options::Opens;

/// A change is suspected some time after it happened, and until then the filter learns from the changed aircraft: what it was before
/// is told from so long before the suspicion, s. Of 24 damages of the F-16 (`f16-damage`, seeds 1 to 24) three were suspected 0.3 to
/// 0.5 s late, and their last values before it were up to ten claimed standard errors off.
const SUSPECTED_LATE_S: f64 = 1.0;
/// Estimates are remembered this far apart, s.
const REMEMBERED_S: f64 = 0.25;

/// Follows the estimates and notes what each adopted change has changed.
#[derive(Default)]
pub(super) struct Changes {
    /// What was estimated when no change was in doubt last.
    undoubted: Snapshot,
    /// The same at earlier times, s, in order: the first one is the last that is older than [`SUSPECTED_LATE_S`].
    earlier: VecDeque<(f64, Snapshot)>,
    /// What was estimated before the change that is suspected; none while none is.
    before_suspicion: Option<Snapshot>,
    found: Vec<RunChange>,
}

impl Changes {
    /// Takes an estimate: its columns, and the state of the change detection. `opens` is what an adopted change has opened.
    pub(super) fn look(
        &mut self,
        change: ChangeState,
        time_s: f64,
        opens: Opens,
        columns: impl Iterator<Item = Column> + Clone,
    ) {
        let now = || Snapshot::of(columns.clone());
        match change {
            ChangeState::Adopted => {
                // A given change was not suspected: the values of the sample before it are those before it.
                let before = self
                    .before_suspicion
                    .take()
                    .unwrap_or_else(|| if self.undoubted.is_empty() { now() } else { self.undoubted.clone() });
                if let Some(last) = self.found.last_mut() {
                    last.after.clone_from(&before);
                }
                let outcome = ChangeOutcome::OnProbation;
                self.found.push(RunChange { time_s, interval_s: None, opens, outcome, before, after: now() });
                self.earlier.clear();
            }
            ChangeState::RolledBack => self.settle(ChangeOutcome::RolledBack),
            ChangeState::Steady => self.settle(ChangeOutcome::Confirmed),
            ChangeState::InDoubt => {
                if self.before_suspicion.is_none() {
                    self.before_suspicion = self.earlier.front().map(|(_, values)| values.clone());
                }
            }
            ChangeState::OnProbation => {}
        }
        if matches!(change, ChangeState::Steady | ChangeState::OnProbation) {
            self.before_suspicion = None;
            self.undoubted.renew(columns);
            self.remember(time_s);
        }
    }

    /// Keeps what is estimated now for later, and lets go of what is older than is needed.
    fn remember(&mut self, time_s: f64) {
        while self.earlier.get(1).is_some_and(|(then_s, _)| time_s - then_s >= SUSPECTED_LATE_S) {
            self.earlier.pop_front();
        }
        if self.earlier.back().is_none_or(|(then_s, _)| time_s - then_s >= REMEMBERED_S) {
            self.earlier.push_back((time_s, self.undoubted.clone()));
        }
    }

    fn settle(&mut self, outcome: ChangeOutcome) {
        if let Some(last) = self.found.last_mut().filter(|last| last.outcome == ChangeOutcome::OnProbation) {
            last.outcome = outcome;
        }
    }

    /// Another filter has taken the place of the running one, which has found so many changes in the same flight: with
    /// the right levels of the residuals the others are none.
    pub(super) fn keep(&mut self, adoptions: usize) {
        let mut standing = self.found.iter_mut().filter(|change| change.outcome.stands());
        for change in standing.by_ref().skip(adoptions) {
            change.outcome = ChangeOutcome::RolledBack;
        }
    }

    /// Gives the changes out, the last one with the latest estimate.
    pub(super) fn take(&mut self) -> Vec<RunChange> {
        if let Some(last) = self.found.last_mut() {
            last.after.clone_from(&self.undoubted);
        }
        std::mem::take(&mut self.found)
    }
}
