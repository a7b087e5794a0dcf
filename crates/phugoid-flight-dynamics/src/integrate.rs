//! Integration of ordinary differential equations `x' = f(t, x)` on vectors of fixed length: the classical Runge-Kutta
//! step of order four, and the adaptive pair of Dormand and Prince. Neither allocates.

use crate::scalar::Scalar;

/// One step of the classical fourth-order Runge-Kutta method: `x(t + h)` from `x(t)`.
///
/// Local error O(h^5), global error O(h^4) as long as `f` is smooth within the step; an input that switches should do
/// so at a step boundary. W. Kutta, Z. Math. Phys. 46 (1901) 435.
///
/// ```
/// use phugoid_flight_dynamics::integrate::rk4_step;
/// let decayed = rk4_step(|_, x: &[f64; 1]| [-x[0]], 0.0, &[1.0], 0.1);
/// assert!((decayed[0] - (-0.1_f64).exp()).abs() < 1e-7);
/// ```
#[inline]
pub fn rk4_step<const N: usize>(
    mut f: impl FnMut(f64, &[f64; N]) -> [f64; N],
    t: f64,
    x: &[f64; N],
    h: f64,
) -> [f64; N] {
    let k1 = f(t, x);
    let k2 = f(t + 0.5 * h, &core::array::from_fn(|i| x[i] + 0.5 * h * k1[i]));
    let k3 = f(t + 0.5 * h, &core::array::from_fn(|i| x[i] + 0.5 * h * k2[i]));
    let k4 = f(t + h, &core::array::from_fn(|i| x[i] + h * k3[i]));
    core::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

// Tableau of the embedded pair 5(4): J. R. Dormand, P. J. Prince, "A family of embedded Runge-Kutta formulae",
// J. Comp. Appl. Math. 6 (1980) 19, table 2 (RK5(4)7M).
const C: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; 7] = [
    [0.0; 6],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Fifth-order minus fourth-order weights: the error estimate per step length.
const E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Continuous extension of order four: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I,
/// 2nd ed. 1993, section II.6, as in their code DOPRI5.
const D: [f64; 7] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// Adaptive integration with the Dormand-Prince pair 5(4), PI step control and dense output.
///
/// A step is accepted when the root mean square over the components of
/// `error_i / (absolute_i + relative max(|x_i|, |x_i new|))` is at most one. The step length follows the PI controller
/// of Hairer and Wanner (Solving ODEs II, section IV.2) with beta = 0.04.
///
/// ```
/// use phugoid_flight_dynamics::integrate::DormandPrince;
///
/// // A harmonic oscillator over one period is back where it began.
/// let solver = DormandPrince::with_tolerances(1e-10, 1e-12);
/// let end = solver.integrate(|_, x: &[f64; 2]| [x[1], -x[0]], 0.0, &[1.0, 0.0], std::f64::consts::TAU)?;
/// assert!((end[0] - 1.0).abs() < 1e-8 && end[1].abs() < 1e-8);
/// # Ok::<(), phugoid_flight_dynamics::integrate::IntegrationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DormandPrince<const N: usize> {
    /// Relative tolerance of the local error per step, a pure number.
    pub relative_tolerance: f64,
    /// Absolute tolerance per step and component, in the component's unit.
    pub absolute_tolerance: [f64; N],
    /// Longest step, in units of `t`; infinite for none.
    pub maximum_step: f64,
    /// Most steps (accepted and rejected) between the start and the last output.
    pub maximum_steps: usize,
}

/// How many steps and evaluations an integration took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IntegrationCost {
    /// Steps whose error was within the tolerance.
    pub accepted_steps: usize,
    /// Steps that were tried again with a shorter length.
    pub rejected_steps: usize,
    /// Evaluations of the right-hand side.
    pub evaluations: usize,
}

/// Why an integration stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntegrationError {
    /// The tolerance cannot be met: the step has shrunk to the resolution of the time. The solution may have a pole or a
    /// jump here, or the tolerance lies below the rounding error.
    StepSizeTooSmall {
        /// Time that the solution has reached, the unit of `t`.
        time: f64,
        /// Step length that was rejected.
        step: f64,
    },
    /// More steps than allowed. The problem may be stiff for an explicit method.
    TooManySteps {
        /// Time that the solution has reached, the unit of `t`.
        time: f64,
        /// Steps taken, equal to the number allowed.
        steps: usize,
    },
    /// The right-hand side is not a finite number at the start of a step.
    NotFinite {
        /// Time at which the right-hand side was evaluated.
        time: f64,
        /// Index of the first component that is not finite.
        component: usize,
    },
    /// An output time lies before the one that precedes it (or before the start), or is not a number.
    TimeNotIncreasing {
        /// The output time that was asked for.
        time: f64,
        /// The output time (or start) that precedes it.
        previous: f64,
    },
    /// A tolerance that is negative, not a number, or zero together with the other one; or a longest step that is not
    /// positive.
    InvalidTolerance {
        /// Index of the component whose tolerance is wrong, from zero.
        component: usize,
    },
}

impl core::fmt::Display for IntegrationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::StepSizeTooSmall { time, step } => write!(
                f,
                "integration stopped at t = {time}: a step of {step:e} still misses the tolerance; loosen it, or look for \
                 a pole or a jump of the right-hand side here"
            ),
            Self::TooManySteps { time, steps } => write!(
                f,
                "integration stopped at t = {time} after {steps} steps, the most allowed; raise the limit, or suspect a \
                 stiff problem"
            ),
            Self::NotFinite { time, component } => {
                write!(f, "the derivative of component {component} is not finite at t = {time}")
            }
            Self::TimeNotIncreasing { time, previous } => {
                write!(f, "output time {time} comes after {previous}: give the output times in increasing order")
            }
            Self::InvalidTolerance { component } => write!(
                f,
                "tolerance of component {component}: relative and absolute have to be finite, not negative and not both \
                 zero, and the longest step positive"
            ),
        }
    }
}

impl core::error::Error for IntegrationError {}

impl<const N: usize> DormandPrince<N> {
    /// The same absolute tolerance for every component, no longest step, at most 100,000 steps.
    pub fn with_tolerances(relative: f64, absolute: f64) -> Self {
        Self {
            relative_tolerance: relative,
            absolute_tolerance: [absolute; N],
            maximum_step: f64::INFINITY,
            maximum_steps: 100_000,
        }
    }

    /// The solution at `end`, not before `start_time`.
    ///
    /// # Errors
    /// See [`IntegrationError`].
    pub fn integrate(
        &self,
        f: impl FnMut(f64, &[f64; N]) -> [f64; N],
        start_time: f64,
        start: &[f64; N],
        end: f64,
    ) -> Result<[f64; N], IntegrationError> {
        let mut last = *start;
        self.integrate_to_times(f, start_time, start, &[end], |_, x| last = *x)?;
        Ok(last)
    }

    /// Hands the solution at each of `times` (in increasing order, not before `start_time`) to `output`. The last time
    /// is landed on and `f` is never asked beyond it. The others do not shorten the steps: there the solution comes
    /// from the continuous extension, of order four.
    ///
    /// # Errors
    /// See [`IntegrationError`]; `output` has then been called for the times before the one reached.
    pub fn integrate_to_times(
        &self,
        mut f: impl FnMut(f64, &[f64; N]) -> [f64; N],
        start_time: f64,
        start: &[f64; N],
        times: &[f64],
        mut output: impl FnMut(f64, &[f64; N]),
    ) -> Result<IntegrationCost, IntegrationError> {
        self.check()?;
        let mut cost = IntegrationCost::default();
        let mut stepper: Option<Stepper<N>> = None;
        let Some(&end) = times.last() else { return Ok(cost) };
        let mut previous = start_time;
        for &time in times {
            if time.partial_cmp(&previous).is_none_or(|order| order.is_lt()) {
                return Err(IntegrationError::TimeNotIncreasing { time, previous });
            }
            previous = time;
        }
        for &time in times {
            if time == start_time {
                output(time, start);
                continue;
            }
            let stepper = match &mut stepper {
                Some(s) => s,
                empty => empty.insert(self.begin(&mut f, start_time, start, end, &mut cost)?),
            };
            while stepper.time < time {
                self.advance(stepper, end, &mut f, &mut cost)?;
            }
            output(time, &stepper.at(time));
        }
        Ok(cost)
    }

    fn check(&self) -> Result<(), IntegrationError> {
        let relative = self.relative_tolerance;
        for (component, &absolute) in self.absolute_tolerance.iter().enumerate() {
            let tolerances = relative >= 0.0 && absolute >= 0.0 && relative + absolute > 0.0;
            if !(tolerances && (relative + absolute).is_finite() && self.maximum_step > 0.0) {
                return Err(IntegrationError::InvalidTolerance { component });
            }
        }
        Ok(())
    }

    /// First derivative and first step length (Hairer I, section II.4, "Starting step size").
    fn begin(
        &self,
        f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
        time: f64,
        x: &[f64; N],
        end: f64,
        cost: &mut IntegrationCost,
    ) -> Result<Stepper<N>, IntegrationError> {
        let derivative = f(time, x);
        cost.evaluations += 1;
        check_finite(time, &derivative)?;
        let scaled = |v: &[f64; N]| rms::<N>(|i| v[i] / self.scale(i, x[i], x[i]));
        let (d0, d1) = (scaled(x), scaled(&derivative));
        let longest = self.maximum_step.min(end - time);
        let h0 = if d0 < 1e-5 || d1 < 1e-5 { 1e-6 } else { 0.01 * d0 / d1 }.min(longest);
        let euler = core::array::from_fn(|i| x[i] + h0 * derivative[i]);
        let after = f(time + h0, &euler);
        cost.evaluations += 1;
        let d2 = rms::<N>(|i| (after[i] - derivative[i]) / self.scale(i, x[i], x[i])) / h0;
        let steepest = d1.max(d2);
        let h1 = if steepest <= 1e-15 { (h0 * 1e-3).max(1e-6) } else { Scalar::powf(0.01 / steepest, 0.2) };
        let step = if h1.is_finite() { (100.0 * h0).min(h1).min(longest) } else { h0 };
        Ok(Stepper {
            time,
            state: *x,
            derivative,
            step,
            previous_error: 1e-4,
            start: time,
            length: 0.0,
            interpolant: [[0.0; N]; 5],
        })
    }

    fn scale(&self, i: usize, a: f64, b: f64) -> f64 {
        // The smallest positive number keeps a component that is exactly zero and has no absolute tolerance out of 0/0.
        (self.absolute_tolerance[i] + self.relative_tolerance * a.abs().max(b.abs())).max(f64::MIN_POSITIVE)
    }

    /// One accepted step, at most to `end`.
    fn advance(
        &self,
        s: &mut Stepper<N>,
        end: f64,
        f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
        cost: &mut IntegrationCost,
    ) -> Result<(), IntegrationError> {
        const BETA: f64 = 0.04;
        const SAFETY: f64 = 0.9;
        let (time, x) = (s.time, s.state);
        let mut rejected = false;
        loop {
            if cost.accepted_steps + cost.rejected_steps >= self.maximum_steps {
                return Err(IntegrationError::TooManySteps { time, steps: self.maximum_steps });
            }
            let step = s.step.min(self.maximum_step);
            // Stretching a little avoids a last step of rounding size.
            let lands = time + 1.01 * step >= end;
            let h = if lands { end - time } else { step };
            if (rejected || !lands) && h <= 2.0 * f64::EPSILON * time.abs().max(f64::MIN_POSITIVE) {
                return Err(IntegrationError::StepSizeTooSmall { time, step: h });
            }
            let mut k = [s.derivative; 7];
            let mut new = x;
            for stage in 1..7 {
                new = core::array::from_fn(|i| x[i] + h * (0..stage).map(|j| A[stage][j] * k[j][i]).sum::<f64>());
                k[stage] = f(time + C[stage] * h, &new);
            }
            cost.evaluations += 6;
            let error = rms::<N>(|i| h * (0..7).map(|j| E[j] * k[j][i]).sum::<f64>() / self.scale(i, x[i], new[i]));
            // A step that leaves the finite numbers is retried at a tenth of its length.
            if !error.is_finite() || k[6].iter().any(|v| !v.is_finite()) {
                cost.rejected_steps += 1;
                rejected = true;
                s.step = 0.1 * h;
                continue;
            }
            let proportional = Scalar::powf(error.max(1e-10), 0.2 - 0.75 * BETA);
            if error > 1.0 {
                cost.rejected_steps += 1;
                rejected = true;
                s.step = h / (proportional / SAFETY).min(5.0);
                continue;
            }
            cost.accepted_steps += 1;
            s.record(new, h, if lands { end } else { time + h }, &k);
            let factor = (proportional / Scalar::powf(s.previous_error, BETA) / SAFETY).clamp(0.1, 5.0);
            s.step = if rejected { (h / factor).min(h) } else { h / factor };
            s.previous_error = error.max(1e-4);
            return Ok(());
        }
    }
}

/// The last accepted step and what the next one starts from.
struct Stepper<const N: usize> {
    time: f64,
    state: [f64; N],
    derivative: [f64; N],
    step: f64,
    previous_error: f64,
    start: f64,
    length: f64,
    interpolant: [[f64; N]; 5],
}

impl<const N: usize> Stepper<N> {
    fn record(&mut self, new: [f64; N], h: f64, end: f64, k: &[[f64; N]; 7]) {
        let old = self.state;
        let difference: [f64; N] = core::array::from_fn(|i| new[i] - old[i]);
        let left: [f64; N] = core::array::from_fn(|i| h * k[0][i] - difference[i]);
        self.interpolant = [
            old,
            difference,
            left,
            core::array::from_fn(|i| difference[i] - h * k[6][i] - left[i]),
            core::array::from_fn(|i| h * (0..7).map(|j| D[j] * k[j][i]).sum::<f64>()),
        ];
        self.start = self.time;
        self.length = h;
        self.time = end;
        self.state = new;
        self.derivative = k[6];
    }

    /// The solution within the last step.
    fn at(&self, time: f64) -> [f64; N] {
        if time == self.time {
            return self.state;
        }
        let s = (time - self.start) / self.length;
        let r = 1.0 - s;
        let c = &self.interpolant;
        core::array::from_fn(|i| c[0][i] + s * (c[1][i] + r * (c[2][i] + s * (c[3][i] + r * c[4][i]))))
    }
}

fn rms<const N: usize>(component: impl Fn(usize) -> f64) -> f64 {
    if N == 0 {
        return 0.0;
    }
    Scalar::sqrt((0..N).map(|i| component(i) * component(i)).sum::<f64>() / N as f64)
}

fn check_finite<const N: usize>(time: f64, derivative: &[f64; N]) -> Result<(), IntegrationError> {
    match derivative.iter().position(|v| !v.is_finite()) {
        Some(component) => Err(IntegrationError::NotFinite { time, component }),
        None => Ok(()),
    }
}
