//! Recursive Fourier-transform regression.
//!
//! Both sides of the equations of motion are transformed at a few frequencies, sample by sample, and least squares is done
//! there (E. A. Morelli, *Real-Time Parameter Estimation in the Frequency Domain*, JGCD 23, 2000). Noise above the band never
//! enters, and nothing is differentiated. With exponential forgetting `lambda`, `s = j omega - lambda` and the transform
//! referred to the present time,
//!
//! ```text
//! X(omega) = int_0^T x(t) e^{s(T-t)} dt          recursively:  X <- e^{sh} X + c0 x(t) + c1 x(t + h)
//! int_0^T x' e^{s(T-t)} dt = x(T) - x(0) e^{sT} + s X
//! ```
//!
//! The first two terms on the right are the **end-point term**. Where it is left out, as is usual, the record is taken to end as it
//! began; in the middle of a manoeuvre it does not, and the moment derivatives are useless until it does
//! ([`FourierSettings::end_point`]). The noise of the two measurements in it is common to all frequencies: here it is estimated along
//! with the parameters, a nuisance of known variance.
//!
//! **Weights.** The noise of an equation at a frequency is `sigma^2 |s|^2` (dynamic) or `sigma^2` (algebraic) times the length of the
//! record; both follow from the given noise levels, and a residual larger than that raises them equation by equation. Neighbouring frequencies
//! closer than one over the record's length say the same: information is counted once. Standard errors are those of this
//! weighted least squares.
//!
//! **Forgetting** acts on the transforms. Without excitation information then fades to the prior's; the estimate stays.
//!
//! **Where it fails.** As [`rls`](crate::rls): the noise of the regressors. Nothing is learnt from below the band: slow motion and
//! trim. docs/methods.md has the numbers.

mod equation;
mod settings;
mod solve;

pub use settings::{FourierSettings, MAXIMUM_BINS};

use equation::{Bins, Equation};
use solve::Solution;

use crate::estimate::{Estimate, Estimator, Inspect, Phase};
use crate::innovation::{Innovations, RowPhase};
use crate::kernels::dot;
use crate::model::{Model, Sample};
use crate::regression::{Claim, Flow, StateSource, Taken};
use crate::settings::SettingsError;

/// Recursive Fourier-transform regression: `N` states, `R` outputs, room for `P` columns, states from `S`.
///
/// Columns of [`Estimate`] are the model's parameters in its order, then one per biased output.
pub struct FourierRegression<M, S, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    flow: Flow<M, S, N, R, P>,
    settings: FourierSettings<N, R, P>,
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
    /// Sets it up; the first samples start its states.
    ///
    /// # Errors
    /// [`SettingsError`]: what cannot be, and which.
    pub fn new(model: M, source: S, settings: FourierSettings<N, R, P>) -> Result<Self, SettingsError> {
        settings.check()?;
        let flow = Flow::new(model, source, settings.regression)?;
        let bins = Bins::new(settings.bins, settings.regression.forgetting_per_s, |m| settings.frequency_hz(m));
        let solution = Solution::prior(&flow.columns.initial, flow.columns.count);
        Ok(Self {
            flow,
            settings,
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

    /// The settings in force.
    pub fn settings(&self) -> &FourierSettings<N, R, P> {
        &self.settings
    }

    fn transform(&mut self) {
        let Self { flow, bins, dynamic, algebraic, last_z, last_w, settings, .. } = self;
        let columns = &flow.columns;
        let (own, all) = (columns.own, columns.count);
        bins.set_interval(flow.interval_s);
        for i in 0..N {
            let Some(output) = columns.output_of_state[i] else { continue };
            let x = [flow.measured_before[i], flow.measured_after[i]];
            let equation = &mut dynamic[i];
            if !(flow.is_dynamic(i) && x[0].is_finite() && x[1].is_finite()) {
                equation.skip(bins, all);
                continue;
            }
            equation.std = settings.regression.common.noise_std[output];
            let known = [flow.before.known[i], flow.after.known[i]];
            let (before, after) = (&flow.before.regressors[i], &flow.after.regressors[i]);
            equation.add_dynamic(bins, own, x, known, before, after, settings.end_point);
        }
        for output in 0..R {
            if !flow.is_algebraic(output) && !last_z[output].is_finite() {
                continue;
            }
            let z = flow.believed[output] - flow.outputs.outputs[output];
            let mut w = [0.0; P];
            w[..own].copy_from_slice(&flow.outputs.parameter_jacobian[output][..own]);
            if let Some(column) = columns.bias_of_output[output] {
                w[column] = 1.0;
            }
            let equation = &mut algebraic[output];
            equation.std = settings.regression.common.noise_std[output];
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
        // A new stretch: the gap before it has no length in the window, and is long in time. What is forgotten meanwhile is
        // nothing: no time passes in the transforms.
        for equation in self.dynamic.iter_mut().chain(&mut self.algebraic) {
            equation.close();
        }
    }

    fn look(&mut self, sample: &Sample<M::Input, R>) {
        let Self { flow, innovations, solution, .. } = self;
        let columns = &flow.columns;
        *innovations = Innovations { predicted: flow.predicted, ..Innovations::EMPTY };
        let mut used = false;
        for output in 0..R {
            if !sample.outputs[output].is_finite() {
                continue;
            }
            if !flow.believed[output].is_finite() {
                innovations.phase[output] = RowPhase::Rejected;
            } else if flow.is_algebraic(output) {
                let bias = columns.bias_of_output[output].map_or(0.0, |column| solution.theta[column]);
                let row = &flow.outputs.parameter_jacobian[output];
                let predicted =
                    flow.outputs.outputs[output] + dot(&row[..columns.own], &solution.theta[..columns.own]) + bias;
                let std = flow.settings.common.noise_std[output];
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
            time_s: self.flow.last_s(),
            phase: self.phase,
            theta: &self.solution.theta,
            variances: &core::array::from_fn(|j| self.solution.covariance[j][j]),
            inflation: &[1.0; P],
            distance: &[0.0; P],
        };
        claim.estimate(&self.flow.settings, &self.flow.columns)
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
        let std = flow.columns.std;
        let taken = flow
            .take(sample, &solution.theta.clone(), |row| solution.spread(&core::array::from_fn(|j| row[j] * std[j])));
        match taken {
            Taken::Refused => self.phase = Phase::Rejected,
            Taken::Collected | Taken::First => self.begin(taken == Taken::Collected),
            Taken::Next => {
                self.look(sample);
                self.transform();
                if sample.time_s - self.solved_s >= self.settings.solve_interval_s - 1e-9 {
                    self.solved_s = sample.time_s;
                    let Self { solution, flow, bins, dynamic, algebraic, settings, .. } = self;
                    solution.solve(bins, &flow.columns, dynamic, algebraic, settings.end_point);
                }
            }
        }
        self.estimate()
    }

    fn covariance(&self, out: &mut [[f64; P]; P]) {
        let columns = &self.flow.columns;
        *out = [[0.0; P]; P];
        for i in 0..columns.count {
            for j in 0..columns.count {
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
        self.flow.columns.count
    }

    fn prior_std(&self) -> &[f64; P] {
        &self.flow.columns.std
    }

    fn innovations(&self) -> &Innovations<R> {
        &self.innovations
    }

    fn restarts(&self) -> u32 {
        self.flow.restarts()
    }
}
