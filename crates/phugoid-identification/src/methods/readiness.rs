//! Records since when the estimate of each parameter can be used.

use phugoid_estimators::verdict::{ParameterVerdict, Readiness, VerdictMonitor};
use phugoid_estimators::{Estimate, Inspect};

/// The verdict is renewed at this interval, s: it inverts a matrix, and no display needs it faster.
const RENEWAL_S: f64 = 0.1;

/// The verdict on one column at the end of the record.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ColumnVerdict {
    pub(crate) verdict: ParameterVerdict,
    /// Since when it has been ready without a break; none if it is not ready.
    pub(crate) ready_since_s: Option<f64>,
}

/// Computes the verdicts at intervals during a run.
pub(super) struct ReadinessWatch<const R: usize, const P: usize> {
    monitor: VerdictMonitor<R, P>,
    renewed_s: f64,
    /// The verdicts as they were at `renewed_s`.
    latest: [ColumnVerdict; P],
}

impl<const R: usize, const P: usize> ReadinessWatch<R, P> {
    pub(super) fn new() -> Self {
        Self { monitor: VerdictMonitor::new(), renewed_s: f64::NEG_INFINITY, latest: [ColumnVerdict::default(); P] }
    }

    /// After each sample from the first motion on; before it nothing is ready.
    pub(super) fn look<E: Inspect<R, P> + ?Sized>(&mut self, estimate: &Estimate<P>, estimator: &E) {
        self.monitor.update(estimate, estimator);
        if estimate.time_s - self.renewed_s >= RENEWAL_S - 1e-9 {
            self.renew(estimate, estimator);
        }
    }

    /// The verdicts per column as of now.
    pub(super) fn renew<E: Inspect<R, P> + ?Sized>(
        &mut self,
        estimate: &Estimate<P>,
        estimator: &E,
    ) -> &[ColumnVerdict] {
        self.renewed_s = estimate.time_s;
        let verdict = self.monitor.verdict(estimate, estimator);
        for (column, verdict) in self.latest.iter_mut().zip(verdict.parameters) {
            let ready = verdict.readiness == Readiness::Ready;
            let ready_since_s = ready.then(|| column.ready_since_s.unwrap_or(estimate.time_s));
            *column = ColumnVerdict { verdict, ready_since_s };
        }
        self.latest.get(..estimator.column_count()).unwrap_or_default()
    }

    /// The verdicts per column as last renewed, and when; before the first motion none.
    pub(super) fn latest(&self) -> (f64, &[ColumnVerdict; P]) {
        (self.renewed_s, &self.latest)
    }
}
