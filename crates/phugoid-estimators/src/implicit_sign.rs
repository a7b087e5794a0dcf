//! Teaching mode: the sliding law with a sign on a least-squares surface.
//!
//! The surface of parameter `i` is `s_i = theta_LS,i - theta_i`, the law `theta_i' = K R_i sgn(s_i)`, its sign
//! evaluated implicitly:
//!
//! ```text
//! theta_i <- theta_i + clip(s_i, +- h K R_i)
//! ```
//!
//! It cannot chatter, it reaches in finite time, and it moves a parameter through its half range in `1/K` seconds at
//! most. **What it is:** recursive least squares with a limited rate. Once the surface is reached the two are equal, so
//! its accuracy is that of [`rls`](crate::rls), a multiple of the Cramer-Rao bound. While it is not reached its
//! distance is part of the bounds.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::regression::{MeasuredStates, Regression};
//! use phugoid_estimators::implicit_sign::ImplicitSign;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let rows = Regression::new(Lag, MeasuredStates::new(&Lag), settings)?;
//! let mut method = ImplicitSign::new(rows, 2.0)?;
//! let mut estimate = method.estimate();
//! for sample in &flight(20.0, |_| 3.0) {
//!     estimate = method.update(sample);
//! }
//! // The noise of the measured state makes the regression a little wrong: that is its limit.
//! assert!((estimate.parameters[0] - 3.0).abs() < 0.1);
//! assert!((estimate.parameters[1] - 2.0).abs() < 0.1);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

use crate::bounded::limited;
use crate::estimate::{Estimate, Estimator, Inspect};
use crate::innovation::Innovations;
use crate::model::Sample;
use crate::regression::{RowSource, Taken};
use crate::rls::RecursiveLeastSquares;
use crate::settings::SettingsError;

/// The implicit-sign law; type parameters as [`RecursiveLeastSquares`].
pub struct ImplicitSign<F, const R: usize, const P: usize> {
    least_squares: RecursiveLeastSquares<F, R, P>,
    theta: [f64; P],
    surfaces: [f64; P],
    reaching_rate: f64,
}

impl<F, const R: usize, const P: usize> ImplicitSign<F, R, P>
where
    F: RowSource<R, P>,
{
    /// Follows the least-squares solution of these rows. `reaching_rate` is `K`, half ranges per second: 2 is the rule.
    /// The half range of a parameter is twice its prior standard deviation.
    ///
    /// # Errors
    /// [`SettingsError::Setting`] if the rate is not positive and finite.
    pub fn new(rows: F, reaching_rate: f64) -> Result<Self, SettingsError> {
        if !(reaching_rate > 0.0 && reaching_rate.is_finite()) {
            return Err(SettingsError::Setting { name: "reaching_rate", value: reaching_rate });
        }
        let least_squares = RecursiveLeastSquares::new(rows);
        Ok(Self { theta: *least_squares.parameters(), surfaces: [0.0; P], least_squares, reaching_rate })
    }

    /// The estimate that holds after the last sample.
    pub fn estimate(&self) -> Estimate<P> {
        self.least_squares.estimate_of(&self.theta)
    }
}

impl<F, const R: usize, const P: usize> Estimator<R, P> for ImplicitSign<F, R, P>
where
    F: RowSource<R, P>,
{
    type Input = F::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        if self.least_squares.update_with(sample, |_| {}) == Taken::Next {
            let frame = self.least_squares.rows().frame();
            let reach = frame.interval_s * self.reaching_rate;
            for j in 0..frame.columns.count() {
                let limit = reach * 2.0 * frame.columns.std[j];
                self.surfaces[j] = self.least_squares.parameters()[j] - self.theta[j];
                self.theta[j] += limited(self.surfaces[j], -limit, limit);
            }
        }
        self.estimate()
    }

    /// Of the least squares that it follows.
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        self.least_squares.covariance(out);
    }
}

impl<F, const R: usize, const P: usize> Inspect<R, P> for ImplicitSign<F, R, P>
where
    F: RowSource<R, P>,
{
    fn column_count(&self) -> usize {
        self.least_squares.column_count()
    }

    fn prior_std(&self) -> &[f64; P] {
        self.least_squares.prior_std()
    }

    fn innovations(&self) -> &Innovations<R> {
        self.least_squares.innovations()
    }

    fn surfaces(&self) -> [f64; P] {
        self.surfaces
    }

    fn restarts(&self) -> u32 {
        self.least_squares.restarts()
    }
}
