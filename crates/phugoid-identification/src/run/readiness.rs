//! Since when each parameter may be believed.

use phugoid_estimators::verdict::{ParameterVerdict, Readiness, Verdict, VerdictMonitor};
use phugoid_estimators::{Estimate, Inspect};

/// The verdict is renewed at this interval, s: it inverts a matrix, and nobody reads faster.
const RENEWAL_S: f64 = 0.1;

/// The verdict on one column at the end of the record.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ColumnVerdict {
    pub(crate) verdict: ParameterVerdict,
    /// Since when it has been ready without a break; none if it is not ready.
    pub(crate) ready_since_s: Option<f64>,
}

/// Asks for the verdict as the record goes by.
pub(super) struct ReadinessWatch<const R: usize, const P: usize> {
    monitor: VerdictMonitor<R, P>,
    renewed_s: f64,
    ready_since_s: [Option<f64>; P],
}

impl<const R: usize, const P: usize> ReadinessWatch<R, P> {
    pub(super) fn new() -> Self {
        Self { monitor: VerdictMonitor::new(), renewed_s: f64::NEG_INFINITY, ready_since_s: [None; P] }
    }

    /// After each sample from the first motion on; before it nothing is ready.
    pub(super) fn look<E: Inspect<R, P>>(&mut self, estimate: &Estimate<P>, estimator: &E) {
        self.monitor.update(estimate, estimator);
        if estimate.time_s - self.renewed_s >= RENEWAL_S - 1e-9 {
            self.renew(estimate, estimator);
        }
    }

    fn renew<E: Inspect<R, P>>(&mut self, estimate: &Estimate<P>, estimator: &E) -> Verdict<R, P> {
        self.renewed_s = estimate.time_s;
        let verdict = self.monitor.verdict(estimate, estimator);
        for (since, parameter) in self.ready_since_s.iter_mut().zip(&verdict.parameters) {
            *since = (parameter.readiness == Readiness::Ready).then(|| since.unwrap_or(estimate.time_s));
        }
        verdict
    }

    /// The last word, per column.
    pub(super) fn finish<E: Inspect<R, P>>(mut self, estimate: &Estimate<P>, estimator: &E) -> Vec<ColumnVerdict> {
        let verdict = self.renew(estimate, estimator);
        verdict
            .parameters
            .iter()
            .zip(self.ready_since_s)
            .take(estimator.column_count())
            .map(|(verdict, ready_since_s)| ColumnVerdict { verdict: *verdict, ready_since_s })
            .collect()
    }
}
