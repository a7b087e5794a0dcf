//! One sampling interval of a model: the RK4 step map with its exact derivatives.
//!
//! The derivatives are those of the *discrete* map (the chain rule through the four stages), not a discretisation of
//! the continuous ones: an estimator that linearises the map it really integrates stays exact for any step.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::Lag;
//! use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, simulate, step};
//!
//! // x' = -3 x + 2 u over 0.1 s, from x = 1 with u = 0: x = exp(-0.3), and so is dx/dx(0).
//! let input = IntervalInput { from: [0.0], to: [0.0], hold: InputHold::Zero };
//! let (mut sensitivity, mut transition) = ([[0.0; 2]], [[0.0]]);
//! let whole = Part { from: 0.0, to: 1.0 };
//! let x = step(&Lag, &[1.0], &[3.0, 2.0], &input, 0.1, whole, 2, &mut sensitivity, &mut transition);
//! assert!((x[0] - (-0.3_f64).exp()).abs() < 3e-5 && (transition[0][0] - x[0]).abs() < 1e-12);
//! // dx/da = -0.1 exp(-0.3)
//! assert!((sensitivity[0][0] + 0.1 * (-0.3_f64).exp()).abs() < 1e-4);
//! // Without derivatives, in steps of at most 0.01 s: more exact.
//! assert!((simulate(&Lag, &[1.0], &[3.0, 2.0], &input, 0.1, 0.01)[0] - (-0.3_f64).exp()).abs() < 1e-8);
//! ```

use crate::kernels::add_scaled;
use crate::model::{Input, LinearizedRates, Model};

/// What the known input does between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InputHold {
    /// Held at the value of the sample at the start of the interval (the left limit), as a sampled control does.
    /// A step in the input at a sample acts from that sample on.
    #[default]
    Zero,
    /// Interpolated linearly between the two samples: a recorded surface position.
    Linear,
}

/// The known input over one interval.
#[derive(Clone, Copy, Debug)]
pub struct IntervalInput<I> {
    /// At the start of the interval.
    pub from: I,
    /// Value of the input at the end of the interval.
    pub to: I,
    /// Whether the input is held or runs straight in between.
    pub hold: InputHold,
}

impl<I: Input> IntervalInput<I> {
    /// The input a fraction `s` in `[0, 1]` into the interval.
    #[inline]
    pub fn at(&self, s: f64) -> I {
        match self.hold {
            InputHold::Zero => self.from,
            InputHold::Linear => self.from.interpolate(&self.to, s),
        }
    }
}

/// Part of one interval, as fractions in `[0, 1]` of it.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Where the part starts, as a fraction of the interval.
    pub from: f64,
    /// Where the part ends, as a fraction of the interval.
    pub to: f64,
}

/// Splits an interval of `duration_s` into equal steps of at most `maximum_step_s`; at most `MAXIMUM_SUB_STEPS`.
pub fn sub_steps(duration_s: f64, maximum_step_s: f64) -> usize {
    if !(maximum_step_s > 0.0 && duration_s > maximum_step_s) {
        return 1;
    }
    // The small allowance keeps an interval that is one step but for rounding from being cut in two.
    let ratio = libm::ceil(duration_s / maximum_step_s - 1e-6);
    if ratio >= MAXIMUM_SUB_STEPS as f64 { MAXIMUM_SUB_STEPS } else { (ratio as usize).max(1) }
}

/// Most RK4 steps taken for one sampling interval: the bound on the work of a prediction.
pub const MAXIMUM_SUB_STEPS: usize = 64;

/// One RK4 step over a part of an interval, with its derivatives.
///
/// * `interval_s`: length of the whole interval, s; the step is `part.to - part.from` of it.
/// * `columns`: how many columns of `sensitivity` are in use. The first `model.parameter_count()` belong to the
///   model's parameters; further ones (sensor biases) only ride along with `A`.
/// * `sensitivity` (`U`): replaced by `A U + B`, with `A = dF/dx` and `B = dF/dtheta` of the step map `F`.
///   Start from zero to get `B` itself.
/// * `transition`: receives `A`.
///
/// Gives the state after the step.
#[inline]
#[allow(clippy::too_many_arguments)]
pub fn step<M, const N: usize, const R: usize, const P: usize>(
    model: &M,
    x: &[f64; N],
    theta: &[f64; P],
    input: &IntervalInput<M::Input>,
    interval_s: f64,
    part: Part,
    columns: usize,
    sensitivity: &mut [[f64; P]; N],
    transition: &mut [[f64; N]; N],
) -> [f64; N]
where
    M: Model<N, R, P>,
{
    let own = model.parameter_count();
    let rates = |point: &[f64; N], s: f64, lin: &mut LinearizedRates<N, P>| {
        model.linearized_rates(point, theta, &input.at(s), lin);
    };
    if columns >= P {
        step_of(rates, x, interval_s, part, own, P, sensitivity, transition)
    } else {
        step_of(rates, x, interval_s, part, own, columns, sensitivity, transition)
    }
}

/// [`step`] of a plant whose linearised rates at a state and at a fraction of the interval are given by `rates`.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn step_of<const N: usize, const P: usize>(
    rates: impl Fn(&[f64; N], f64, &mut LinearizedRates<N, P>),
    x: &[f64; N],
    interval_s: f64,
    part: Part,
    own: usize,
    columns: usize,
    sensitivity: &mut [[f64; P]; N],
    transition: &mut [[f64; N]; N],
) -> [f64; N] {
    let p = columns.min(P);
    let own = own.min(p);
    let h = interval_s * (part.to - part.from);
    let middle = 0.5 * (part.from + part.to);

    let mut lin = LinearizedRates::<N, P>::ZERO;
    // Stage point, and its derivatives by the state and the parameters at the start of the step.
    let mut point = *x;
    let mut by_state = [[0.0; N]; N];
    for i in 0..N {
        by_state[i][i] = 1.0;
    }
    let mut by_parameter = *sensitivity;
    // Weighted sums of the stage slopes.
    let mut slope = [0.0; N];
    let mut slope_by_state = [[0.0; N]; N];
    let mut slope_by_parameter = [[0.0; P]; N];
    let mut slope_row = [0.0; P];
    let mut next_by_parameter = [[0.0; P]; N];

    // Classical RK4: (position in the step, weight of the slope, step to the next stage point).
    const STAGES: [(f64, f64); 4] = [(1.0 / 6.0, 0.5), (1.0 / 3.0, 0.5), (1.0 / 3.0, 1.0), (1.0 / 6.0, 0.0)];
    let positions = [part.from, middle, middle, part.to];
    for (stage, (weight, next)) in STAGES.into_iter().enumerate() {
        rates(&point, positions[stage], &mut lin);
        let last = stage == 3;
        let mut next_by_state = [[0.0; N]; N];
        let ahead = next * h;
        for i in 0..N {
            let jacobian = &lin.state_jacobian[i];
            slope[i] += weight * lin.rates[i];

            let mut row = [0.0; N];
            if stage == 0 {
                // The first stage point is the start itself.
                row = *jacobian;
            } else {
                for k in 0..N {
                    for j in 0..N {
                        row[j] += jacobian[k] * by_state[k][j];
                    }
                }
            }
            for j in 0..N {
                slope_by_state[i][j] += weight * row[j];
                next_by_state[i][j] = ahead * row[j];
            }
            slope_row[..own].copy_from_slice(&lin.regressors[i][..own]);
            slope_row[own..p].fill(0.0);
            let row = &mut slope_row;
            for k in 0..N {
                add_scaled(&mut row[..p], jacobian[k], &by_parameter[k][..p]);
            }
            add_scaled(&mut slope_by_parameter[i][..p], weight, &row[..p]);
            if !last {
                next_by_parameter[i][..p].copy_from_slice(&sensitivity[i][..p]);
                add_scaled(&mut next_by_parameter[i][..p], ahead, &row[..p]);
            }
        }
        if !last {
            for i in 0..N {
                point[i] = x[i] + ahead * lin.rates[i];
                next_by_state[i][i] += 1.0;
            }
            by_state = next_by_state;
            for i in 0..N {
                by_parameter[i][..p].copy_from_slice(&next_by_parameter[i][..p]);
            }
        }
    }

    let mut after = *x;
    for i in 0..N {
        after[i] += h * slope[i];
        for j in 0..N {
            transition[i][j] = h * slope_by_state[i][j];
        }
        transition[i][i] += 1.0;
        for (u, s) in sensitivity[i][..p].iter_mut().zip(&slope_by_parameter[i][..p]) {
            *u += h * s;
        }
    }
    after
}

/// The state after one interval, by RK4 in equal steps of at most `maximum_step_s`, without derivatives.
pub fn simulate<M, const N: usize, const R: usize, const P: usize>(
    model: &M,
    x: &[f64; N],
    theta: &[f64; P],
    input: &IntervalInput<M::Input>,
    interval_s: f64,
    maximum_step_s: f64,
) -> [f64; N]
where
    M: Model<N, R, P>,
{
    let steps = sub_steps(interval_s, maximum_step_s);
    let h = interval_s / steps as f64;
    let mut x = *x;
    for k in 0..steps {
        let (from, to) = (k as f64 / steps as f64, (k + 1) as f64 / steps as f64);
        let middle = input.at(0.5 * (from + to));
        let k1 = model.rates(&x, theta, &input.at(from));
        let k2 = model.rates(&core::array::from_fn(|i| x[i] + 0.5 * h * k1[i]), theta, &middle);
        let k3 = model.rates(&core::array::from_fn(|i| x[i] + 0.5 * h * k2[i]), theta, &middle);
        let k4 = model.rates(&core::array::from_fn(|i| x[i] + h * k3[i]), theta, &input.at(to));
        x = core::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    x
}
