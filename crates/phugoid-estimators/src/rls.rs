//! Recursive least squares on a regression without derivatives.
//!
//! Rows `z = w theta + n` come from [`regression`](crate::regression). With columns scaled to their prior standard
//! deviation, `psi = w/sigma`, `e = (z - w theta)/sigma` and `C` starting at the prior,
//!
//! ```text
//! theta <- theta + C psi^T e/(1 + v),     C <- C - (C psi^T)(psi C)/(1 + v),     v = psi C psi^T
//! ```
//!
//! `C` is kept as `U D U^T` ([`ud`](crate::ud)). Without forgetting the estimate is that of batch least squares with
//! the prior on the same rows.
//!
//! **Forgetting** lets information fade as `e^{-lambda t}`, only while something moves, and towards the prior, not
//! towards nothing: `C^-1 <- e^{-lambda h} C^-1 + (1 - e^{-lambda h}) C0^-1`, the second term column by column in turn.
//! So `C` cannot wind up beyond the prior (to within `lambda h p`), and a quiet hour costs nothing.
//!
//! **Bounds.** `std_error` is `sqrt(C_jj)` with the given noise levels. The rows' noise is coloured (the filter, the
//! smoothed states), so `corrected_std_error` is the larger of it and the sandwich estimate over blocks of time.
//!
//! **Limits.** Noise in the regressors biases every regression, and what the state source makes of it is the
//! limit: RMSE is a multiple of the Cramer-Rao bound. An unmeasured gust goes into the angle of attack. docs/methods.md
//! has the numbers.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::regression::{MeasuredStates, Regression};
//! use phugoid_estimators::rls::RecursiveLeastSquares;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let rows = Regression::new(Lag, MeasuredStates::new(&Lag), settings)?;
//! let mut method = RecursiveLeastSquares::new(rows);
//! let mut estimate = method.estimate();
//! for sample in &flight(20.0, |_| 3.0) {
//!     estimate = method.update(sample);
//! }
//! // The noise of the measured state makes the regression a little wrong: that is its limit.
//! assert!((estimate.parameters[0] - 3.0).abs() < 0.1);
//! assert!((estimate.parameters[1] - 2.0).abs() < 0.1);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

use crate::bounded::{limited, unit};
use crate::estimate::{Estimate, Estimator, Inspect, Phase};
use crate::innovation::{Innovations, RowPhase};
use crate::kernels::dot;
use crate::model::Sample;
use crate::regression::{Claim, Frame, Row, RowSource, Taken};
use crate::supervisor::colour::Colour;
use crate::ud::Ud;

/// Recursive least squares on the rows of `F`, a [`Regression`](crate::regression::Regression): `R` outputs, room for
/// `P` columns.
///
/// Columns of [`Estimate`] are the model's parameters in its order, then one per biased output.
pub struct RecursiveLeastSquares<F, const R: usize, const P: usize> {
    rows: F,
    theta: [f64; P],
    /// Columns scaled to the prior standard deviation.
    covariance: Ud<P>,
    colour: Colour<P>,
    colour_started_s: f64,
    /// Time forgotten in the running block of the colour correction, s.
    colour_forgotten_s: f64,
    next_restored: usize,
    innovations: Innovations<R>,
    surfaces: [f64; P],
    phase: Phase,
}

impl<F, const R: usize, const P: usize> RecursiveLeastSquares<F, R, P>
where
    F: RowSource<R, P>,
{
    /// Least squares on these rows, from the prior; the first samples start the states.
    pub fn new(rows: F) -> Self {
        let columns = &rows.frame().columns;
        Self {
            theta: columns.initial,
            covariance: Ud::from_variances(&[1.0; P][..columns.count()]),
            colour: Colour::new(),
            colour_started_s: f64::NAN,
            colour_forgotten_s: 0.0,
            next_restored: 0,
            innovations: Innovations::EMPTY,
            surfaces: [0.0; P],
            phase: Phase::Starting,
            rows,
        }
    }

    /// Where the rows come from.
    pub fn rows(&self) -> &F {
        &self.rows
    }

    /// [`Estimator::update`] that gives each row of the sample to `observe` before it is used: for a batch solution of
    /// the same regression, or to look at it.
    pub fn update_observed(&mut self, sample: &Sample<F::Input, R>, observe: impl FnMut(&Row<P>)) -> Estimate<P> {
        self.update_with(sample, observe);
        self.estimate()
    }

    pub(crate) fn update_with(&mut self, sample: &Sample<F::Input, R>, mut observe: impl FnMut(&Row<P>)) -> Taken {
        let Self { rows, theta, covariance, .. } = self;
        let (std, p) = (rows.frame().columns.std, rows.frame().columns.count());
        let taken = rows.take(sample, theta, |row| {
            let scaled = core::array::from_fn(|j| if j < p { row[j] * std[j] } else { 0.0 });
            covariance.project(&scaled, 0.0).variance
        });
        match taken {
            Taken::Refused => self.phase = Phase::Rejected,
            Taken::Collected | Taken::First => {
                self.phase = Phase::Starting;
                self.innovations = Innovations::EMPTY;
                self.surfaces = [0.0; P];
            }
            Taken::Next => {
                self.forget();
                self.use_rows(sample, &mut observe);
                self.close_block();
            }
        }
        taken
    }

    /// Lets information fade towards the prior while something moves.
    fn forget(&mut self) {
        let Frame { settings, interval_s: h, columns, excited, .. } = self.rows.frame();
        let (rate, h, p) = (settings.forgetting_per_s, *h, columns.count());
        if !(rate > 0.0 && *excited && p > 0) {
            return;
        }
        self.covariance.scale(libm::exp(rate * h));
        self.colour_forgotten_s += h;
        // The prior's share of a whole round at once, for one column in turn: the estimate itself is not moved.
        let share = libm::exp(rate * h * p as f64) - 1.0;
        let row = unit(self.next_restored.min(p - 1));
        self.next_restored = if self.next_restored + 1 < p { self.next_restored + 1 } else { 0 };
        let projection = self.covariance.project(&row, 1.0 / share);
        self.covariance.update(&projection, 1.0 / share);
    }

    fn use_rows(&mut self, sample: &Sample<F::Input, R>, observe: &mut impl FnMut(&Row<P>)) {
        let Self { rows, theta, covariance, colour, innovations, surfaces, .. } = self;
        let frame = rows.frame();
        let columns = &frame.columns;
        let p = columns.count();
        *innovations = Innovations { predicted: frame.predicted, ..Innovations::EMPTY };
        for output in 0..R {
            if sample.outputs[output].is_finite() && !frame.believed[output].is_finite() {
                innovations.phase[output] = RowPhase::Rejected;
            }
        }
        surfaces[..p].fill(0.0);
        let mut used = false;
        rows.rows(|row| {
            // Once more, because the compiler does not see through the closure.
            let p = p.min(P);
            observe(row);
            let mut psi = [0.0; P];
            for j in 0..p {
                psi[j] = row.w[j] * columns.std[j] / row.std;
            }
            let predicted = dot(&row.w[..p], &theta[..p]);
            let e = (row.z - predicted) / row.std;
            let projection = covariance.project(&psi, 1.0);
            let nn = libm::sqrt(projection.variance);
            if !(e.is_finite() && nn.is_finite()) {
                return;
            }
            let gain = covariance.update(&projection, 1.0);
            let step = e / projection.variance;
            for j in 0..p {
                let moved = columns.std[j] * gain[j] * step;
                surfaces[j] += moved;
                theta[j] = limited(theta[j] + moved, columns.clip_low[j], columns.clip_high[j]);
            }
            colour.add(&psi[..p], e / nn);
            used = true;
            if row.output < R {
                innovations.predicted[row.output] = row.known + predicted;
                innovations.whitened[row.output] = e;
                innovations.normalised[row.output] = e / nn;
                innovations.variance[row.output] = row.std * row.std * projection.variance;
                innovations.phase[row.output] = RowPhase::Sliding;
            }
        });
        self.phase = if innovations.phase.contains(&RowPhase::Rejected) {
            Phase::Rejected
        } else if used {
            Phase::Sliding
        } else {
            Phase::Predicting
        };
    }

    fn close_block(&mut self) {
        let now = self.rows.frame().last_s;
        if self.colour_started_s.is_nan() {
            self.colour_started_s = now;
        }
        if now - self.colour_started_s >= self.rows.frame().colour_block_s - 1e-9 {
            self.colour_started_s = now;
            // Scores fade as information does, their squares twice as fast.
            let fading = libm::exp(-2.0 * self.rows.frame().settings.forgetting_per_s * self.colour_forgotten_s);
            self.colour_forgotten_s = 0.0;
            self.colour.fade(fading);
            self.colour.close_block(self.covariance.len(), |j| self.covariance.column(j));
        } else {
            self.colour.renew(self.covariance.len(), |j| self.covariance.column(j));
        }
    }

    /// The estimate that holds after the last sample.
    pub fn estimate(&self) -> Estimate<P> {
        self.estimate_of(&self.theta)
    }

    /// The same with the parameters of a law that follows the least-squares estimate: its distance from there is part
    /// of its bounds.
    pub(crate) fn estimate_of(&self, theta: &[f64; P]) -> Estimate<P> {
        let mut distance = [0.0; P];
        for j in 0..self.rows.frame().columns.count() {
            distance[j] = theta[j] - self.theta[j];
        }
        let claim = Claim {
            time_s: self.rows.frame().last_s,
            phase: self.phase,
            theta,
            variances: &self.covariance.variances(),
            inflation: self.colour.inflation(),
            distance: &distance,
        };
        claim.estimate(self.rows.frame())
    }

    /// The least-squares estimate, parameter units.
    pub(crate) fn parameters(&self) -> &[f64; P] {
        &self.theta
    }
}

impl<F, const R: usize, const P: usize> Estimator<R, P> for RecursiveLeastSquares<F, R, P>
where
    F: RowSource<R, P>,
{
    type Input = F::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        self.update_with(sample, |_| {});
        self.estimate()
    }

    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        self.covariance.write_dense(out);
        let columns = &self.rows.frame().columns;
        for i in 0..columns.count() {
            for j in 0..columns.count() {
                out[i][j] *= columns.std[i] * columns.std[j];
            }
        }
    }
}

impl<F, const R: usize, const P: usize> Inspect<R, P> for RecursiveLeastSquares<F, R, P>
where
    F: RowSource<R, P>,
{
    fn column_count(&self) -> usize {
        self.rows.frame().columns.count()
    }

    fn prior_std(&self) -> &[f64; P] {
        &self.rows.frame().columns.std
    }

    fn innovations(&self) -> &Innovations<R> {
        &self.innovations
    }

    fn surfaces(&self) -> [f64; P] {
        self.surfaces
    }

    fn restarts(&self) -> u32 {
        self.rows.frame().restarts
    }
}
