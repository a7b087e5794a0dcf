//! The adopted changes of a run: the estimate before each and after it.

use phugoid_estimators::{ChangeState, Estimate};

use super::task::RunChange;
use crate::core::estimation::ChangeOutcome;
use crate::core::options::Opens;

/// Follows the estimates and notes what each adopted change has changed.
#[derive(Default)]
pub(super) struct Changes {
    /// Value and corrected standard error by column when no change was in doubt last.
    undoubted: Vec<[f64; 2]>,
    found: Vec<RunChange>,
}

impl Changes {
    /// Takes an estimate as it is shown, of which `columns` are in use. `opens` is what an adopted change has opened.
    pub(super) fn look<const P: usize>(&mut self, estimate: &Estimate<P>, time_s: f64, columns: usize, opens: Opens) {
        let now = || -> Vec<[f64; 2]> {
            estimate.parameters[..columns]
                .iter()
                .zip(&estimate.corrected_std_error[..columns])
                .map(|(value, std)| [*value, *std])
                .collect()
        };
        match estimate.status.change {
            ChangeState::Adopted => {
                let before = if self.undoubted.is_empty() { now() } else { self.undoubted.clone() };
                if let Some(last) = self.found.last_mut() {
                    last.after.clone_from(&before);
                }
                let outcome = ChangeOutcome::OnProbation;
                self.found.push(RunChange { time_s, interval_s: None, opens, outcome, before, after: now() });
            }
            ChangeState::RolledBack => self.settle(ChangeOutcome::RolledBack),
            ChangeState::Steady => self.settle(ChangeOutcome::Confirmed),
            ChangeState::InDoubt | ChangeState::OnProbation => {}
        }
        if matches!(estimate.status.change, ChangeState::Steady | ChangeState::OnProbation) {
            self.undoubted.clear();
            let values = estimate.parameters[..columns].iter().zip(&estimate.corrected_std_error[..columns]);
            self.undoubted.extend(values.map(|(value, std)| [*value, *std]));
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
