//! The repair of the two-parameter law: as many surfaces as parameters, of full rank.
//!
//! One instant gives one equation per measured rate, however many surfaces are made of it. Here the equations of many
//! instants are kept. Between two samples `x' = f + Phi theta` gives a row without any derivative (a Kreisselmeier filter;
//! for the exact motion `z = Ups theta` up to the quadrature, trapezoidal, of order `h^2`),
//!
//! ```text
//! z   <- e^{-w h} z   + x_{k+1} - x_k - integral of f
//! Ups <- e^{-w h} Ups + integral of Phi
//! W   <- e^{-h/m} W + h sum_i psi_i^T psi_i,   Y <- e^{-h/m} Y + h sum_i psi_i^T z_i/scale_i      psi_i = Ups_i R/scale_i
//! s   = W phi - Y,   phi = theta/R                                     one surface per parameter
//! ```
//!
//! with `R` the half widths of the bounds. `s = W (phi - phi_true)` is zero only at the truth once `W` has full rank. The law
//! is the thesis's switching law on it. Along the eigenvectors `q_i` of `W` (eigenvalues `w_i`) the surfaces
//! `sigma_i = q_i^T s` do not disturb one another,
//!
//! ```text
//! phi' in - sum_i K_i w_i q_i Sgn(sigma_i),   K_i = 2/T / (w_i + floor)     gain from the bounds
//! ```
//!
//! and the implicit Euler step, in which the sign is that at the *end* of the step, is a proximal step in closed form:
//! `q_i^T phi` moves towards `sigma_i = 0` by at most `h K_i w_i`, and stops there.
//!
//! What can be said, without noise and for constant parameters, `V = 1/2 |phi - phi_true|^2`:
//! * *V never increases, at any step, gain and rank of W.* No component of the error grows; one of which the data say nothing
//!   (`w_i = 0`) stays.
//! * *No chatter.* A surface that is reached is left no more.
//! * *Reaching in finite time.* Every component with `w_i` above the floor shrinks by at least `h/T` per step: from anywhere
//!   inside the bounds (at most `2 sqrt(p)` away) in at most `2 sqrt(p) T`. That is how the bounds fix the gain.
//!
//! In noise it is least squares over the memory `m`: no better. It claims no covariance.

use super::claim::{verdict, without_covariance};
use super::eigen::symmetric;
use super::error::ThesisError;
use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::{Estimate, Estimator, Phase};
use phugoid_estimators::{Input, LinearizedRates, Model, Sample};

/// Eigenvalues below this part of the largest are rounding.
const ROUNDING: f64 = 1e-13;

/// Settings of the extended law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtendedSettings<const N: usize, const P: usize> {
    /// Start values of the model's parameters.
    pub parameters: [f64; P],
    /// Lower and upper bound of each; equal ones hold the parameter where it is.
    pub bounds: [[f64; 2]; P],
    /// Typical size of each state: its row enters divided by this. State units, positive.
    pub scale: [f64; N],
    /// `w`, forgetting rate of the row filter, 1/s.
    pub filter_rate: f64,
    /// `m`, memory of the accumulated equations, s. Infinite: nothing is forgotten.
    pub memory_s: f64,
    /// `T`, time in which the whole range from bound to bound is crossed, s.
    pub reaching_time_s: f64,
    /// Directions whose eigenvalue of `W` is below this part of the sum of all move more slowly in proportion.
    pub relative_floor: f64,
    /// The same, absolute, in scaled state units squared times seconds: what noise alone accumulates.
    pub floor: f64,
    /// How the input goes from one sample to the next.
    pub input_hold: InputHold,
    /// Longest interval that gives a row, s: the trapezoid errs by its square. After a longer one the filter starts again.
    pub maximum_gap_s: f64,
}

impl<const N: usize, const P: usize> ExtendedSettings<N, P> {
    /// Everything from start values, bounds and the sizes of the states: `w` = 3 1/s, no forgetting, and from bound to bound in
    /// 0.1 s.
    pub fn new(parameters: [f64; P], bounds: [[f64; 2]; P], scale: [f64; N]) -> Self {
        Self {
            parameters,
            bounds,
            scale,
            filter_rate: 3.0,
            memory_s: f64::INFINITY,
            reaching_time_s: 0.1,
            relative_floor: 1e-6,
            floor: 0.0,
            input_hold: InputHold::Zero,
            maximum_gap_s: 0.05,
        }
    }

    fn check(&self, count: usize) -> Result<(), ThesisError> {
        for [lower, upper] in self.bounds[..count].iter().copied() {
            if !(lower.is_finite() && upper.is_finite() && lower <= upper) {
                return Err(ThesisError::Bounds { lower, upper });
            }
        }
        for value in self.scale {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ThesisError::Setting { name: "scale", value });
            }
        }
        // Infinite memory is allowed.
        if self.memory_s.is_nan() || self.memory_s <= 0.0 {
            return Err(ThesisError::Setting { name: "memory_s", value: self.memory_s });
        }
        let floors = [("relative_floor", self.relative_floor), ("floor", self.floor)];
        let positive = [
            ("filter_rate", self.filter_rate),
            ("reaching_time_s", self.reaching_time_s),
            ("maximum_gap_s", self.maximum_gap_s),
        ];
        let wrong_floor = floors.into_iter().find(|(_, value)| !(*value >= 0.0 && value.is_finite()));
        let wrong = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        match wrong_floor.or(wrong) {
            Some((name, value)) => Err(ThesisError::Setting { name, value }),
            None => Ok(()),
        }
    }
}

/// The extended law, for any number of parameters of a model `M` with the known input `I` whose states are all measured. What it
/// keeps depends on states and parameters only, not on the number of outputs.
pub struct ExtendedLaw<M, I, const N: usize, const P: usize> {
    model: M,
    settings: ExtendedSettings<N, P>,
    /// Output that measures each state.
    output: [usize; N],
    count: usize,
    /// Half widths of the bounds.
    range: [f64; P],
    phi: [f64; P],
    /// Last complete frame: time, states, input.
    last: Option<(f64, [f64; N], I)>,
    last_s: f64,
    z: [f64; N],
    upsilon: [[f64; P]; N],
    information: [[f64; P]; P],
    target: [f64; P],
    surfaces: [f64; P],
    eigenvalues: [f64; P],
    phase: Phase,
}

impl<M, I: Copy, const N: usize, const P: usize> ExtendedLaw<M, I, N, P> {
    /// Sets the law up; the second frame that measures all states gives the first row.
    ///
    /// # Errors
    /// A state that no output measures, bounds out of order or infinite, or a setting out of its range.
    pub fn new<const R: usize>(model: M, settings: ExtendedSettings<N, P>) -> Result<Self, ThesisError>
    where
        M: Model<N, R, P, Input = I>,
    {
        let count = model.parameter_count().min(P);
        settings.check(count)?;
        let mut output = [0; N];
        for (index, slot) in output.iter_mut().enumerate() {
            *slot =
                model.measuring_output(index).filter(|&o| o < R).ok_or(ThesisError::NotMeasured { state: index })?;
        }
        let mut range = [0.0; P];
        let mut phi = [0.0; P];
        for j in 0..count {
            range[j] = 0.5 * (settings.bounds[j][1] - settings.bounds[j][0]);
            if range[j] > 0.0 {
                phi[j] = settings.parameters[j] / range[j];
            }
        }
        Ok(Self {
            model,
            settings,
            output,
            count,
            range,
            phi,
            last: None,
            last_s: f64::NEG_INFINITY,
            z: [0.0; N],
            upsilon: [[0.0; P]; N],
            information: [[0.0; P]; P],
            target: [0.0; P],
            surfaces: [0.0; P],
            eigenvalues: [0.0; P],
            phase: Phase::Starting,
        })
    }

    /// `W`, scaled by the half widths of the bounds.
    pub fn information(&self) -> &[[f64; P]; P] {
        &self.information
    }

    /// Eigenvalues `w_i` of `W`, in no order; the first as many as the model has parameters. One that is zero: a combination
    /// of parameters of which the data say nothing.
    pub fn eigenvalues(&self) -> &[f64; P] {
        &self.eigenvalues
    }

    /// `s`, one surface per parameter, before the last step.
    pub fn surfaces(&self) -> &[f64; P] {
        &self.surfaces
    }

    fn parameters(&self) -> [f64; P] {
        let free = |j: usize| self.range[j] > 0.0;
        core::array::from_fn(|j| if free(j) { self.phi[j] * self.range[j] } else { self.settings.parameters[j] })
    }

    fn states<const R: usize>(&self, sample: &Sample<I, R>) -> Option<[f64; N]> {
        let x: [f64; N] = core::array::from_fn(|i| sample.outputs[self.output[i]]);
        x.iter().all(|value| value.is_finite()).then_some(x)
    }

    fn advance<const R: usize>(&mut self, sample: &Sample<I, R>)
    where
        M: Model<N, R, P, Input = I>,
    {
        self.last_s = sample.time_s;
        let Some(x) = self.states(sample) else {
            self.phase = Phase::Predicting;
            return;
        };
        let before = self.last.replace((sample.time_s, x, sample.input));
        let row = before.filter(|(time_s, ..)| sample.time_s - time_s <= self.settings.maximum_gap_s);
        let filtered = row.is_some_and(|(time_s, from, input)| {
            let to_input = match self.settings.input_hold {
                InputHold::Zero => input,
                InputHold::Linear => sample.input,
            };
            self.filter::<R>(sample.time_s - time_s, [&from, &x], [&input, &to_input])
        });
        if filtered {
            let interval_s = sample.time_s - before.map_or(sample.time_s, |(time_s, ..)| time_s);
            self.accumulate(interval_s);
            self.phase = self.reach(interval_s);
        } else {
            // An empty filter is exact from here on; what was accumulated stays.
            self.z = [0.0; N];
            self.upsilon = [[0.0; P]; N];
            self.phase = if before.is_some() { Phase::Rejected } else { Phase::Starting };
        }
    }

    /// Carries the row filter over one interval. False if the model does not answer with numbers.
    fn filter<const R: usize>(&mut self, interval_s: f64, x: [&[f64; N]; 2], input: [&I; 2]) -> bool
    where
        M: Model<N, R, P, Input = I>,
    {
        let known = core::array::from_fn(|j| if self.range[j] > 0.0 { 0.0 } else { self.settings.parameters[j] });
        let decay = libm::exp(-self.settings.filter_rate * interval_s);
        for i in 0..N {
            self.z[i] = decay * self.z[i] + x[1][i] - x[0][i];
            self.upsilon[i].iter_mut().for_each(|u| *u *= decay);
        }
        let mut lin = LinearizedRates::<N, P>::ZERO;
        for end in 0..2 {
            self.model.linearized_rates(x[end], &known, input[end], &mut lin);
            for i in 0..N {
                self.z[i] -= 0.5 * interval_s * lin.rates[i];
                for j in 0..self.count {
                    self.upsilon[i][j] += 0.5 * interval_s * lin.regressors[i][j];
                }
            }
        }
        (self.z.iter().sum::<f64>() + self.upsilon.iter().flatten().sum::<f64>()).is_finite()
    }

    fn accumulate(&mut self, interval_s: f64) {
        let p = self.count;
        let decay = libm::exp(-interval_s / self.settings.memory_s);
        self.information[..p].iter_mut().for_each(|row| row[..p].iter_mut().for_each(|w| *w *= decay));
        self.target[..p].iter_mut().for_each(|y| *y *= decay);
        for i in 0..N {
            let psi: [f64; P] = core::array::from_fn(|j| self.upsilon[i][j] * self.range[j] / self.settings.scale[i]);
            for j in 0..p {
                self.target[j] += interval_s * psi[j] * self.z[i] / self.settings.scale[i];
                for k in 0..p {
                    self.information[j][k] += interval_s * psi[j] * psi[k];
                }
            }
        }
    }

    /// The proximal step.
    fn reach(&mut self, interval_s: f64) -> Phase {
        let p = self.count;
        for j in 0..p {
            let carried: f64 = (0..p).map(|k| self.information[j][k] * self.phi[k]).sum();
            self.surfaces[j] = carried - self.target[j];
        }
        let (eigenvalues, vectors) = symmetric(&self.information, p);
        self.eigenvalues = eigenvalues;
        let trace: f64 = eigenvalues[..p].iter().sum();
        let floor = self.settings.floor + self.settings.relative_floor * trace;
        let mut phase = Phase::Sliding;
        for i in 0..p {
            let w = eigenvalues[i];
            // A zero matrix has no direction to move in.
            if w <= ROUNDING * trace {
                continue;
            }
            let sigma: f64 = (0..p).map(|j| vectors[j][i] * self.surfaces[j]).sum();
            let limit = interval_s * 2.0 / self.settings.reaching_time_s * w / (w + floor);
            let distance = sigma / w;
            if distance.abs() > limit {
                phase = Phase::Reaching;
            }
            let step = distance.clamp(-limit, limit);
            for j in 0..p {
                self.phi[j] -= step * vectors[j][i];
            }
        }
        phase
    }

    fn estimate(&self) -> Estimate<P> {
        let theta = self.parameters();
        let verdicts = (0..self.count).filter(|&j| self.range[j] > 0.0).map(|j| {
            let excited = self.information[j][j] > self.settings.floor && self.phase == Phase::Sliding;
            (j, verdict(theta[j], self.settings.bounds[j], excited))
        });
        without_covariance(self.last_s, &theta, self.count, self.phase, verdicts)
    }
}

impl<M, I, const N: usize, const R: usize, const P: usize> Estimator<R, P> for ExtendedLaw<M, I, N, P>
where
    I: Input,
    M: Model<N, R, P, Input = I>,
{
    type Input = I;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        if !sample.time_s.is_finite() || sample.time_s <= self.last_s {
            self.phase = Phase::Rejected;
        } else {
            self.advance(sample);
        }
        self.estimate()
    }

    /// Infinite for the unknown parameters: the law knows no covariance.
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        *out = [[0.0; P]; P];
        for j in 0..self.count {
            if self.range[j] > 0.0 {
                out[j][j] = f64::INFINITY;
            }
        }
    }
}
