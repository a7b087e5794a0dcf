//! Recursive Fourier-transform regression.
//!
//! Both sides of the equations of motion are transformed at a few frequencies, sample by sample, and least squares is
//! done there (E. A. Morelli, *Real-Time Parameter Estimation in the Frequency Domain*, JGCD 23, 2000). Noise above the
//! band never enters, and nothing is differentiated. With exponential forgetting `lambda`, `s = j omega - lambda` and
//! the transform referred to the present time,
//!
//! ```text
//! X(omega) = int_0^T x(t) e^{s(T-t)} dt          recursively:  X <- e^{sh} X + c0 x(t) + c1 x(t + h)
//! int_0^T x' e^{s(T-t)} dt = x(T) - x(0) e^{sT} + s X
//! ```
//!
//! The first two terms on the right are the **end-point term**. Where it is left out, as is usual, the record is taken
//! to end as it began; in the middle of a manoeuvre it does not, and the moment derivatives are useless until it does
//! ([`FourierSettings::end_point`](crate::settings::FourierSettings::end_point)). The noise of the two measurements in
//! it is common to all frequencies: here it is estimated along with the parameters, a nuisance of known variance.
//!
//! **Weights.** The noise of an equation at a frequency is `sigma^2 |s|^2` (dynamic) or `sigma^2` (algebraic) times the
//! length of the record; both follow from the given noise levels, and a residual larger than that raises them equation
//! by equation. Neighbouring frequencies closer than one over the record's length say the same: information is counted
//! once. Standard errors are those of this weighted least squares.
//!
//! **Forgetting** acts on the transforms. Without excitation information then fades to the prior's; the estimate stays.
//!
//! **Limits.** As [`rls`](crate::rls): the noise of the regressors. Nothing is learnt from below the band: slow
//! motion and trim. docs/methods.md has the numbers.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::regression::{MeasuredStates, Regression};
//! use phugoid_estimators::fourier::FourierRegression;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let rows = Regression::new(Lag, MeasuredStates::new(&Lag), settings)?;
//! let mut method = FourierRegression::new(rows)?;
//! let mut estimate = method.estimate();
//! for sample in &flight(20.0, |_| 3.0) {
//!     estimate = method.update(sample);
//! }
//! // The noise of the measured state makes the regression a little wrong: that is its limit.
//! assert!((estimate.parameters[0] - 3.0).abs() < 0.1);
//! assert!((estimate.parameters[1] - 2.0).abs() < 0.1);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod equation;
mod solve;

use equation::{Bins, Equation};
use solve::Solution;

use crate::estimate::{Estimate, Estimator, Inspect, Phase};
use crate::innovation::{Innovations, RowPhase};
use crate::kernels::dot;
use crate::model::{Model, Sample};
use crate::regression::{Claim, Regression, StateSource, Taken};
use crate::settings::SettingsError;

/// Recursive Fourier-transform regression: `N` states, `R` outputs, room for `P` columns, states from `S`.
///
/// Columns of [`Estimate`] are the model's parameters in its order, then one per biased output.
pub struct FourierRegression<M, S, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    flow: Regression<M, S, N, R, P>,
    bins: Bins,
    dynamic: [Equation<P>; N],
    algebraic: [Equation<P>; R],
    /// Left hand side and regressors of the algebraic equations at the last frame; NaN where not measured.
    last_z: [f64; R],
    last_w: [[f64; P]; R],
    solution: Solution<P>,
    solved_s: f64,
    innovations: Innovations<R>,
    phase: Phase,
}

impl<M, S, const N: usize, const R: usize, const P: usize> FourierRegression<M, S, N, R, P>
where
    M: Model<N, R, P>,
    S: StateSource<M::Input, N, R>,
{
    /// Fourier regression of these equations; the first samples start the states.
    ///
    /// # Errors
    /// [`SettingsError::Setting`] if the band, the number of bins or the time between solutions is impossible.
    pub fn new(flow: Regression<M, S, N, R, P>) -> Result<Self, SettingsError> {
        let settings = &flow.settings.fourier;
        settings.check(flow.settings.sample_time_s)?;
        let bins = Bins::new(settings.bins, flow.settings.regression.forgetting_per_s, |m| settings.frequency_hz(m));
        let solution = Solution::prior(&flow.frame.columns.initial, flow.frame.columns.count());
        Ok(Self {
            flow,
            bins,
            dynamic: [Equation::new(); N],
            algebraic: [Equation::new(); R],
            last_z: [f64::NAN; R],
            last_w: [[0.0; P]; R],
            solution,
            solved_s: f64::NEG_INFINITY,
            innovations: Innovations::EMPTY,
            phase: Phase::Starting,
        })
    }

    fn transform(&mut self) {
        let Self { flow, bins, dynamic, algebraic, last_z, last_w, .. } = self;
        let columns = &flow.frame.columns;
        let (own, all) = (columns.own(), columns.count());
        bins.set_interval(flow.frame.interval_s);
        for i in 0..N {
            let Some(output) = flow.output_of(i) else { continue };
            let x = [flow.measured_before[i], flow.measured_after[i]];
            let equation = &mut dynamic[i];
            if !(flow.is_dynamic(i) && x[0].is_finite() && x[1].is_finite()) {
                equation.skip(bins, all);
                continue;
            }
            equation.std = flow.settings.noise_std[output];
            let known = [flow.before.known[i], flow.after.known[i]];
            let (before, after) = (&flow.before.regressors[i], &flow.after.regressors[i]);
            equation.add_dynamic(bins, own, x, known, before, after, flow.settings.fourier.end_point);
        }
        for output in 0..R {
            if !flow.is_algebraic(output) && !last_z[output].is_finite() {
                continue;
            }
            let z = flow.frame.believed[output] - flow.outputs.outputs[output];
            let mut w = [0.0; P];
            w[..own].copy_from_slice(&flow.outputs.parameter_jacobian[output][..own]);
            if let Some(column) = columns.bias(output) {
                w[column] = 1.0;
            }
            let equation = &mut algebraic[output];
            equation.std = flow.settings.noise_std[output];
            if z.is_finite() && last_z[output].is_finite() {
                equation.add_algebraic(bins, all, [last_z[output], z], &last_w[output], &w);
            } else {
                equation.skip(bins, all);
            }
            last_z[output] = z;
            last_w[output] = w;
        }
    }

    fn begin(&mut self, collected: bool) {
        self.phase = Phase::Starting;
        self.innovations = Innovations::EMPTY;
        self.last_z = [f64::NAN; R];
        if collected {
            return;
        }
        // A new stretch: the gap before it has no length in the window, and is long in time. What is forgotten
        // meanwhile is nothing: no time passes in the transforms.
        for equation in self.dynamic.iter_mut().chain(&mut self.algebraic) {
            equation.close();
        }
    }

    fn look(&mut self, sample: &Sample<M::Input, R>) {
        let Self { flow, innovations, solution, .. } = self;
        let columns = &flow.frame.columns;
        *innovations = Innovations { predicted: flow.frame.predicted, ..Innovations::EMPTY };
        let mut used = false;
        for output in 0..R {
            if !sample.outputs[output].is_finite() {
                continue;
            }
            if !flow.frame.believed[output].is_finite() {
                innovations.phase[output] = RowPhase::Rejected;
            } else if flow.is_algebraic(output) {
                let bias = columns.bias(output).map_or(0.0, |column| solution.theta[column]);
                let row = &flow.outputs.parameter_jacobian[output];
                let predicted =
                    flow.outputs.outputs[output] + dot(&row[..columns.own()], &solution.theta[..columns.own()]) + bias;
                let std = flow.settings.noise_std[output];
                innovations.predicted[output] = predicted;
                innovations.whitened[output] = (sample.outputs[output] - predicted) / std;
                innovations.variance[output] =
                    std * std + solution.spread(&core::array::from_fn(|j| row[j] * columns.std[j]));
                innovations.normalised[output] =
                    (sample.outputs[output] - predicted) / libm::sqrt(innovations.variance[output]);
                innovations.phase[output] = RowPhase::Sliding;
                used = true;
            }
        }
        used |= self.dynamic.iter().any(Equation::is_open);
        self.phase = if self.innovations.phase.contains(&RowPhase::Rejected) {
            Phase::Rejected
        } else if used {
            Phase::Sliding
        } else {
            Phase::Predicting
        };
    }

    /// The estimate that holds after the last sample.
    pub fn estimate(&self) -> Estimate<P> {
        let claim = Claim {
            time_s: self.flow.frame.last_s,
            phase: self.phase,
            theta: &self.solution.theta,
            variances: &core::array::from_fn(|j| self.solution.covariance[j][j]),
            inflation: &[1.0; P],
            distance: &[0.0; P],
        };
        claim.estimate(&self.flow.frame)
    }
}

impl<M, S, const N: usize, const R: usize, const P: usize> Estimator<R, P> for FourierRegression<M, S, N, R, P>
where
    M: Model<N, R, P>,
    S: StateSource<M::Input, N, R>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        let Self { flow, solution, .. } = self;
        let std = flow.frame.columns.std;
        let taken = flow.advance(sample, &solution.theta.clone(), |row| {
            solution.spread(&core::array::from_fn(|j| row[j] * std[j]))
        });
        match taken {
            Taken::Refused => self.phase = Phase::Rejected,
            Taken::Collected | Taken::First => self.begin(taken == Taken::Collected),
            Taken::Next => {
                self.look(sample);
                self.transform();
                if sample.time_s - self.solved_s >= self.flow.settings.fourier.solve_interval_s - 1e-9 {
                    self.solved_s = sample.time_s;
                    let Self { solution, flow, bins, dynamic, algebraic, .. } = self;
                    solution.solve(bins, &flow.frame.columns, dynamic, algebraic, flow.settings.fourier.end_point);
                }
            }
        }
        self.estimate()
    }

    fn covariance(&self, out: &mut [[f64; P]; P]) {
        let columns = &self.flow.frame.columns;
        *out = [[0.0; P]; P];
        for i in 0..columns.count() {
            for j in 0..columns.count() {
                out[i][j] = self.solution.covariance[i][j] * columns.std[i] * columns.std[j];
            }
        }
    }
}

impl<M, S, const N: usize, const R: usize, const P: usize> Inspect<R, P> for FourierRegression<M, S, N, R, P>
where
    M: Model<N, R, P>,
    S: StateSource<M::Input, N, R>,
{
    fn column_count(&self) -> usize {
        self.flow.frame.columns.count()
    }

    fn prior_std(&self) -> &[f64; P] {
        &self.flow.frame.columns.std
    }

    fn innovations(&self) -> &Innovations<R> {
        &self.innovations
    }

    fn restarts(&self) -> u32 {
        self.flow.frame.restarts
    }
}
