//! A verdict per parameter, at any time: whether its estimate can be used, with the reason.
//!
//! What a flight-test engineer asks of an estimate, in the order in which the answers rule one another out:
//!
//! 1. *Does the method claim a bound at all?* The teaching modes do not.
//! 2. *Does the model contradict the flight?* If more than [`CONTRADICTED`] of an output's recent rows were rejected, the
//!    bounds were learnt from the rest alone.
//! 3. *Is a change in doubt, or the parameter at its limit?*
//! 4. *Excitation*: the bound with every other parameter known, `1/sqrt((C^-1)_jj)`, against the prior. If even that bound
//!    is wide, the input does not move this parameter's regressor.
//! 5. *Collinearity*: the variance inflation factor `C_jj (C^-1)_jj`, by how much the variance grows because the others are
//!    unknown as well (V. Klein, E. A. Morelli, *Aircraft System Identification*, AIAA 2006, section 5.4; more than
//!    [`INFLATED`] is the customary limit). If the bound is wide and inflated, the data know a combination alone.
//! 6. *Convergence*: the bound is small against the prior, and the estimate has not moved more than the bound allows over
//!    the last seconds.
//!
//! Residual whiteness (lag-one correlation of the normalised innovations over the last [`MEMORY_S`] seconds) is given
//! beside: it belongs to an output, not to a parameter, and the corrected bounds already allow for correlation over
//! short times.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//! use phugoid_estimators::smpe::Smpe;
//! use phugoid_estimators::verdict::{Readiness, VerdictMonitor};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let mut estimator = Smpe::new(Lag, settings)?;
//! let mut monitor = VerdictMonitor::new();
//! let mut estimate = estimator.estimate();
//! for sample in &flight(10.0, |_| 3.0) {
//!     estimate = estimator.update(sample);
//!     monitor.update(&estimate, &estimator);
//! }
//! let verdict = monitor.verdict(&estimate, &estimator);
//! assert_eq!(verdict.parameters[0].readiness, Readiness::Ready);
//! assert!(verdict.parameters[0].bound_over_prior < 0.1);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod collinearity;
mod whiteness;

pub use collinearity::Collinearity;
pub use whiteness::{CONTRADICTED, MEMORY_S, Whiteness};

use crate::estimate::{ChangeState, Estimate, Inspect, ParameterStatus, Phase};

/// Variance inflation beyond which two or more parameters are said to be collinear.
pub const INFLATED: f64 = 10.0;
/// The bound with all others known has to be below this part of the prior, or the parameter is not excited: the data
/// have said less than the prior did. (`1/sqrt 2`: data and prior say equally much.)
const EXCITED: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// Correlation from which another parameter is named as a partner.
const PARTNER: f64 = 0.7;
/// The estimate is compared with that of one to two of these ago, s.
const SETTLING_S: f64 = 1.0;
/// Correlated errors of one estimator at two times differ by less than this many of the older sigma, if nothing is
/// wrong: `var(difference) = var(old) - var(new)`, and three sigma of it.
const SETTLED: f64 = 3.0;

/// Whether a parameter can be used, and if not, whether waiting may help.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Readiness {
    /// The input does not excite this parameter, or not apart from others: waiting longer with the same input does not
    /// help.
    #[default]
    NotIdentifiable,
    /// The bound is still shrinking, or the estimate still moves: wait, or move the aircraft more.
    Improving,
    /// The bound is small, the estimate no longer moves, and nothing contradicts it: it can be used.
    Ready,
    /// The bound is small, but something contradicts the estimate: see the reason.
    Doubtful,
}

impl Readiness {
    /// Its word in results: that of its serialised form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Ready => "ready",
            Self::Improving => "improving",
            Self::NotIdentifiable => "not_identifiable",
            Self::Doubtful => "doubtful",
        }
    }
}

impl core::fmt::Display for Readiness {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.word())
    }
}

/// The reason for a [`Readiness`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reason {
    /// The bound is still about that of the prior even if all others were known.
    #[default]
    NotExcited,
    /// The data know a combination with other parameters alone.
    Collinear,
    /// The method gives no bound.
    NoBound,
    /// The bound is not small yet.
    WideBound,
    /// The estimate has moved further than its bound allowed.
    Moving,
    /// The bound is small and the estimate no longer moves.
    Settled,
    /// A sudden change is suspected.
    ChangeInDoubt,
    /// It lies at one of its declared limits.
    AtLimit,
    /// Too many rows of an output were rejected.
    ModelContradicted,
    /// The estimator has stopped, because its estimate was no longer finite.
    Diverged,
}

/// The verdict on one column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParameterVerdict {
    /// Whether the parameter can be used.
    pub readiness: Readiness,
    /// The reason for that.
    pub reason: Reason,
    /// Bound over prior, one sigma each; 1 where nothing has been learnt. NaN without a prior.
    pub bound_over_prior: f64,
    /// The same if all other columns were known: what the excitation of this regressor alone gives.
    pub excitation: f64,
    /// Variance inflation factor, at least 1.
    pub variance_inflation: f64,
    /// The columns it is most correlated with, the strongest first.
    pub partners: [Option<Partner>; 2],
}

/// A column whose error goes with that of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partner {
    /// Index of the column.
    pub column: usize,
    /// Correlation of the two errors, -1 to 1.
    pub correlation: f64,
}

/// The verdict on the whole estimate at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict<const R: usize, const P: usize> {
    /// Per column; those not in use are `NotIdentifiable`.
    pub parameters: [ParameterVerdict; P],
    /// Condition number of the correlation matrix in the 1-norm: 1 where all are independent; infinite if it cannot be
    /// inverted.
    pub condition: f64,
    /// Whiteness of the residuals, per output.
    pub whiteness: [Whiteness; R],
}

/// Watches an estimator and says, whenever asked, which parameters can be used. No allocation, bounded work;
/// [`Self::update`] is cheap, [`Self::verdict`] inverts one matrix of the columns in use.
#[derive(Clone, Copy, Debug)]
pub struct VerdictMonitor<const R: usize, const P: usize> {
    rows: [whiteness::RowMemory; R],
    last_s: f64,
    /// Estimates and bounds at the start of this interval of [`SETTLING_S`] and of the one before.
    anchors: [Anchor<P>; 2],
}

#[derive(Clone, Copy, Debug)]
struct Anchor<const P: usize> {
    time_s: f64,
    parameters: [f64; P],
    std_error: [f64; P],
}

impl<const R: usize, const P: usize> Default for VerdictMonitor<R, P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const R: usize, const P: usize> VerdictMonitor<R, P> {
    /// A monitor that has not seen a sample.
    pub fn new() -> Self {
        let anchor = Anchor { time_s: f64::NAN, parameters: [0.0; P], std_error: [f64::INFINITY; P] };
        Self { rows: [whiteness::RowMemory::NEW; R], last_s: f64::NAN, anchors: [anchor; 2] }
    }

    /// Takes what the estimator made of its last sample.
    pub fn update<E: Inspect<R, P> + ?Sized>(&mut self, estimate: &Estimate<P>, estimator: &E) {
        let interval_s = estimate.time_s - self.last_s;
        if estimate.time_s.is_finite() {
            self.last_s = estimate.time_s;
        }
        let innovations = estimator.innovations();
        for (row, (normalised, phase)) in
            self.rows.iter_mut().zip(innovations.normalised.iter().zip(&innovations.phase))
        {
            row.add(interval_s, *normalised, *phase);
        }
        let [now, _] = &self.anchors;
        // A change that was adopted is no failure to settle: begin again.
        let again = now.time_s.is_nan() || estimate.status.change == ChangeState::Adopted;
        if again || estimate.time_s - now.time_s >= SETTLING_S {
            let anchor = Anchor {
                time_s: estimate.time_s,
                parameters: estimate.parameters,
                std_error: estimate.corrected_std_error,
            };
            self.anchors = [anchor, if again { anchor } else { self.anchors[0] }];
        }
    }

    /// The verdict on `estimate`, the last one that the estimator gave.
    pub fn verdict<E: Inspect<R, P> + ?Sized>(&self, estimate: &Estimate<P>, estimator: &E) -> Verdict<R, P> {
        let count = estimator.column_count().min(P);
        let prior = estimator.prior_std();
        let mut covariance = [[0.0; P]; P];
        estimator.covariance(&mut covariance);
        let collinearity = Collinearity::of(&covariance, count);
        let whiteness = core::array::from_fn(|i| self.rows[i].whiteness());
        let contradicted = whiteness.iter().any(Whiteness::contradicts);
        let mut parameters = [ParameterVerdict::default(); P];
        for j in 0..count {
            let bound = estimate.corrected_std_error[j];
            let variance = covariance[j][j];
            let inflation = collinearity.variance_inflation[j];
            let mut verdict = ParameterVerdict {
                bound_over_prior: bound / prior[j],
                excitation: libm::sqrt(variance / inflation) / prior[j],
                variance_inflation: inflation,
                partners: collinearity.partners(j, PARTNER),
                ..ParameterVerdict::default()
            };
            (verdict.readiness, verdict.reason) = self.judge(estimate, j, &verdict, contradicted);
            parameters[j] = verdict;
        }
        Verdict { parameters, condition: collinearity.condition, whiteness }
    }

    fn judge(
        &self,
        estimate: &Estimate<P>,
        j: usize,
        verdict: &ParameterVerdict,
        contradicted: bool,
    ) -> (Readiness, Reason) {
        let bound = estimate.corrected_std_error[j];
        if estimate.status.phase == Phase::Diverged {
            (Readiness::Doubtful, Reason::Diverged)
        } else if !bound.is_finite() {
            (Readiness::NotIdentifiable, Reason::NoBound)
        } else if contradicted {
            (Readiness::Doubtful, Reason::ModelContradicted)
        } else if estimate.parameter_status[j] == ParameterStatus::AtLimit {
            (Readiness::Doubtful, Reason::AtLimit)
        } else if estimate.status.change == ChangeState::InDoubt {
            (Readiness::Doubtful, Reason::ChangeInDoubt)
        } else if estimate.parameter_status[j] == ParameterStatus::Converged {
            if self.has_settled(estimate, j) {
                (Readiness::Ready, Reason::Settled)
            } else {
                (Readiness::Improving, Reason::Moving)
            }
        // Without a prior (NaN) the ratios say nothing and the bound alone decides.
        } else if verdict.excitation > EXCITED {
            (Readiness::NotIdentifiable, Reason::NotExcited)
        } else if verdict.variance_inflation > INFLATED {
            (Readiness::NotIdentifiable, Reason::Collinear)
        } else {
            (Readiness::Improving, Reason::WideBound)
        }
    }

    /// True if the estimate is where the bound of one to two seconds ago allowed it to go.
    fn has_settled(&self, estimate: &Estimate<P>, j: usize) -> bool {
        let old = &self.anchors[1];
        let bound = estimate.corrected_std_error[j];
        let fallen = old.std_error[j] * old.std_error[j] - bound * bound;
        // Rounding, and bounds that were widened in between: the present bound counts at least.
        let allowed = SETTLED * libm::sqrt(fallen.max(bound * bound));
        (estimate.parameters[j] - old.parameters[j]).abs() <= allowed
    }
}
