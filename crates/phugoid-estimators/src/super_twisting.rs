//! Teaching mode: dynamic regressor extension and mixing with an implicit super-twisting law.
//!
//! The rows of [`regression`](crate::regression) are summed with memory, `W = sum psi^T psi`, `Y = sum psi^T z`, and
//! the determinant makes one scalar equation per parameter of them (S. Aranovskiy et al., IEEE TAC 62, 2017): `adj(W) Y
//! = det(W) theta`. The surface is what is left of it, each parameter in half ranges, and the super-twisting law drives
//! it to zero with a continuous signal (A. Levant, 1993), evaluated implicitly:
//!
//! ```text
//! s  = D^2/(D^2 + 1) i_j/(1 + i_j) (W^-1 Y - theta)_j          D = det W, i_j = 1/[W^-1]_jj, in units of the prior's information
//! s+ + h k1 |s+|^(1/2) sgn(s+) + h^2 k2 sgn(s+) = s - h v,      v+ = v + h k2 sgn(s+),      theta+ = theta + s - s+
//! ```
//!
//! The finite reaching time holds for exact equations. With noise it is least squares of the same rows with a lag:
//! nothing is gained over [`rls`](crate::rls), and nothing is known of the error. **There are no bounds: the standard
//! errors are infinite.**
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::regression::{MeasuredStates, Regression};
//! use phugoid_estimators::super_twisting::SuperTwisting;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let rows = Regression::new(Lag, MeasuredStates::new(&Lag), settings)?;
//! let mut method = SuperTwisting::new(rows);
//! let mut estimate = method.estimate();
//! for sample in &flight(20.0, |_| 3.0) {
//!     estimate = method.update(sample);
//! }
//! assert!((estimate.parameters[0] - 3.0).abs() < 0.2);
//! // This law knows nothing of its error.
//! assert!(estimate.std_error[0].is_infinite());
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

use crate::bounded::{limited, unit};
use crate::dense::Cholesky;
use crate::estimate::{Estimate, Estimator, Inspect, ParameterStatus, Phase, Status};
use crate::innovation::{Innovations, RowPhase};
use crate::kernels::{add_scaled, dot};
use crate::model::Sample;
use crate::regression::{RowSource, Taken};

/// `k1`, half ranges^(1/2)/s, and `k2`, half ranges/s^2.
const GAINS: [f64; 2] = [2.0, 1.0];

/// The super-twisting law; type parameters as [`RecursiveLeastSquares`](crate::rls::RecursiveLeastSquares).
pub struct SuperTwisting<F, const R: usize, const P: usize> {
    rows: F,
    theta: [f64; P],
    /// `v`, half ranges per second.
    speed: [f64; P],
    /// `W` and `Y`, columns scaled to the prior standard deviation, `Y` about the prior's start values.
    information: [[f64; P]; P],
    score: [f64; P],
    innovations: Innovations<R>,
    surfaces: [f64; P],
    moved: [bool; P],
    phase: Phase,
}

impl<F, const R: usize, const P: usize> SuperTwisting<F, R, P>
where
    F: RowSource<R, P>,
{
    /// The law on these rows. The memory of `W` and `Y` is the forgetting of their settings.
    pub fn new(rows: F) -> Self {
        Self {
            theta: rows.frame().columns.initial,
            speed: [0.0; P],
            information: [[0.0; P]; P],
            score: [0.0; P],
            innovations: Innovations::EMPTY,
            surfaces: [0.0; P],
            moved: [false; P],
            phase: Phase::Starting,
            rows,
        }
    }

    /// The estimate that holds after the last sample. Its standard errors are infinite.
    pub fn estimate(&self) -> Estimate<P> {
        let columns = &self.rows.frame().columns;
        let unknown = |j: usize| j < columns.count() && columns.std[j] > 0.0;
        let std_error = core::array::from_fn(|j| if unknown(j) { f64::INFINITY } else { 0.0 });
        Estimate {
            time_s: self.rows.frame().last_s,
            parameters: self.theta,
            std_error,
            corrected_std_error: std_error,
            observability: [0.0; P],
            parameter_status: core::array::from_fn(|j| {
                if !unknown(j) || !self.moved[j] {
                    ParameterStatus::NotExcited
                } else if self.theta[j] <= columns.clip_low[j] || self.theta[j] >= columns.clip_high[j] {
                    ParameterStatus::AtLimit
                } else {
                    ParameterStatus::Improving
                }
            }),
            status: Status { phase: self.phase, ..Status::default() },
        }
    }

    fn add_rows(&mut self, sample: &Sample<F::Input, R>) {
        let Self { rows, theta, information, score, innovations, .. } = self;
        let frame = rows.frame();
        let columns = &frame.columns;
        let p = columns.count();
        let fading = libm::exp(-frame.settings.forgetting_per_s * frame.interval_s);
        if fading < 1.0 && frame.excited {
            information.iter_mut().flatten().for_each(|w| *w *= fading);
            score.iter_mut().for_each(|y| *y *= fading);
        }
        *innovations = Innovations { predicted: frame.predicted, ..Innovations::EMPTY };
        for output in 0..R {
            if sample.outputs[output].is_finite() && !frame.believed[output].is_finite() {
                innovations.phase[output] = RowPhase::Rejected;
            }
        }
        rows.rows(|row| {
            // Once more, because the compiler does not see through the closure.
            let p = p.min(P);
            let mut psi = [0.0; P];
            for j in 0..p {
                psi[j] = row.w[j] * columns.std[j] / row.std;
            }
            let about = (row.z - dot(&row.w[..p], &columns.initial[..p])) / row.std;
            let predicted = dot(&row.w[..p], &theta[..p]);
            let e = (row.z - predicted) / row.std;
            if !(about.is_finite() && dot(&psi, &psi).is_finite()) {
                return;
            }
            for i in 0..p {
                add_scaled(&mut information[i][..p], psi[i], &psi[..p]);
            }
            add_scaled(&mut score[..p], about, &psi[..p]);
            if row.output < R {
                innovations.predicted[row.output] = row.known + predicted;
                innovations.whitened[row.output] = e;
                innovations.normalised[row.output] = e;
                innovations.variance[row.output] = row.std * row.std;
                innovations.phase[row.output] = RowPhase::Sliding;
            }
        });
        self.phase = if self.innovations.phase.contains(&RowPhase::Rejected) {
            Phase::Rejected
        } else if self.innovations.phase.contains(&RowPhase::Sliding) {
            Phase::Sliding
        } else {
            Phase::Predicting
        };
    }

    /// The surfaces, in half ranges; zero where nothing is known.
    fn surface(&self) -> [f64; P] {
        let columns = &self.rows.frame().columns;
        let p = columns.count();
        let mut surface = [0.0; P];
        let mut factor = self.information;
        // A column that no row has ever seen is no part of the mixture.
        for j in 0..p {
            if factor[j][j] <= 0.0 {
                factor[j][j] = 1.0;
            }
        }
        let Some(cholesky) = Cholesky::new(&mut factor, p) else { return surface };
        let determinant = 1.0 / (1.0 + libm::exp(-2.0 * cholesky.log_determinant()));
        let mut solution = self.score;
        cholesky.solve(&mut solution);
        for j in 0..p {
            if columns.std[j] <= 0.0 || self.information[j][j] <= 0.0 {
                continue;
            }
            // [W^-1]_jj is the squared length of column j of L^-1.
            let mut column = unit(j);
            cholesky.solve_lower(&mut column);
            let information = 1.0 / dot(&column[..p], &column[..p]);
            let left = columns.initial[j] + columns.std[j] * solution[j] - self.theta[j];
            let s = determinant * information / (1.0 + information) * left / (2.0 * columns.std[j]);
            surface[j] = if s.is_finite() { s } else { 0.0 };
        }
        surface
    }

    fn twist(&mut self) {
        let h = self.rows.frame().interval_s;
        let [k1, k2] = GAINS;
        let surface = self.surface();
        for j in 0..self.rows.frame().columns.count() {
            let s = surface[j];
            let half_range = 2.0 * self.rows.frame().columns.std[j];
            self.surfaces[j] = s * half_range;
            if s == 0.0 {
                self.speed[j] = 0.0;
                continue;
            }
            let b = s - h * self.speed[j];
            let left = if b.abs() <= h * h * k2 {
                self.speed[j] = s / h;
                0.0
            } else {
                let root = 0.5 * (libm::sqrt(h * h * k1 * k1 + 4.0 * (b.abs() - h * h * k2)) - h * k1);
                self.speed[j] += h * k2 * b.signum();
                b.signum() * root * root
            };
            let columns = &self.rows.frame().columns;
            self.theta[j] = limited(self.theta[j] + half_range * (s - left), columns.clip_low[j], columns.clip_high[j]);
            self.moved[j] = true;
        }
    }
}

impl<F, const R: usize, const P: usize> Estimator<R, P> for SuperTwisting<F, R, P>
where
    F: RowSource<R, P>,
{
    type Input = F::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        let std = self.rows.frame().columns.std;
        let own = self.rows.frame().columns.own();
        let spread = |row: &[f64; P]| (0..own).map(|j| row[j] * row[j] * std[j] * std[j]).sum();
        match self.rows.take(sample, &self.theta, spread) {
            Taken::Refused => self.phase = Phase::Rejected,
            Taken::Collected | Taken::First => {
                self.phase = Phase::Starting;
                self.innovations = Innovations::EMPTY;
            }
            Taken::Next => {
                self.add_rows(sample);
                self.twist();
            }
        }
        self.estimate()
    }

    /// Infinite for the unknown parameters: the law knows no covariance.
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        for j in 0..self.rows.frame().columns.count() {
            out[j][j] = if self.rows.frame().columns.std[j] > 0.0 { f64::INFINITY } else { 0.0 };
        }
    }
}

impl<F, const R: usize, const P: usize> Inspect<R, P> for SuperTwisting<F, R, P>
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
