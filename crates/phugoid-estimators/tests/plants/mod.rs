//! Small plants with analytic Jacobians, shared by the tests, the benchmark and the example.
#![allow(dead_code, unreachable_pub)]

pub mod fighter;

use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate};
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model, Sample};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Linear short period in absolute form: states `alpha` (rad), `q` (rad/s), input elevator (rad), outputs `alpha`, `q`,
/// `az` (m/s^2).
///
/// ```text
/// alpha' = q - (qbar S / m V) (CL0 + CLa alpha)
/// q'     = (qbar S c / Iyy) (Cm0 + Cma alpha + Cmq c q / 2V + Cmde de)
/// az     = -(qbar S / m) (CL0 + CLa alpha)
/// ```
/// about a level trim (the weight is part of the zero). Parameters: `Cma, Cmq, CLa, Cmde`, then the offsets `Cm0, CL0`.
#[derive(Clone, Copy, Debug)]
pub struct ShortPeriod {
    /// `qbar S / m`, m/s^2.
    pub lift_acceleration: f64,
    /// `qbar S c / Iyy`, 1/s^2.
    pub moment_acceleration: f64,
    /// m/s.
    pub airspeed: f64,
    /// `c / 2V`, s.
    pub half_chord_time: f64,
    /// 4, or 6 with the offsets.
    pub parameters: usize,
}

/// A business jet at 100 m/s: half the mass of a small transport, natural frequency about 1.4 rad/s.
pub const JET: ShortPeriod = ShortPeriod {
    lift_acceleration: 16.0,
    moment_acceleration: 3.17,
    airspeed: 100.0,
    half_chord_time: 0.0122,
    parameters: 4,
};

/// `Cma, Cmq, CLa, Cmde, Cm0, CL0` of that jet.
pub const JET_TRUTH: [f64; 6] = [-0.6, -20.0, 5.0, -1.2, 0.0, 0.0];

impl<const P: usize> Model<2, 3, P> for ShortPeriod {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        self.parameters
    }

    fn rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1]) -> [f64; 2] {
        let mut lin = LinearizedRates::ZERO;
        self.linearized_rates(x, theta, u, &mut lin);
        lin.rates
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<2, P>) {
        let [alpha, q] = *x;
        let lift = self.lift_acceleration / self.airspeed;
        let moment = self.moment_acceleration;
        let alpha_row = [0.0, 0.0, -lift * alpha, 0.0, 0.0, -lift];
        let q_row = [moment * alpha, moment * self.half_chord_time * q, 0.0, moment * u[0], moment, 0.0];
        let n = self.parameters;
        out.regressors[0][..n].copy_from_slice(&alpha_row[..n]);
        out.regressors[1][..n].copy_from_slice(&q_row[..n]);
        out.rates = [q, 0.0];
        for j in 0..n {
            out.rates[0] += alpha_row[j] * theta[j];
            out.rates[1] += q_row[j] * theta[j];
        }
        out.state_jacobian = [[-lift * theta[2], 1.0], [moment * theta[0], moment * self.half_chord_time * theta[1]]];
    }

    fn linearized_outputs(&self, x: &[f64; 2], theta: &[f64; P], _: &[f64; 1], out: &mut LinearizedOutputs<2, 3, P>) {
        let n = self.parameters;
        for row in &mut out.parameter_jacobian {
            row[..n].fill(0.0);
        }
        let az_row = [0.0, 0.0, -self.lift_acceleration * x[0], 0.0, 0.0, -self.lift_acceleration];
        out.parameter_jacobian[2][..n].copy_from_slice(&az_row[..n]);
        let az = (0..n).map(|j| az_row[j] * theta[j]).sum();
        out.outputs = [x[0], x[1], az];
        out.state_jacobian = [[1.0, 0.0], [0.0, 1.0], [-self.lift_acceleration * theta[2], 0.0]];
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }
}

/// First order, `x' = -a x + u`: outputs `x`, `x'`.
#[derive(Clone, Copy, Debug)]
pub struct FirstOrder;

impl<const P: usize> Model<1, 2, P> for FirstOrder {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        1
    }

    fn rates(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1]) -> [f64; 1] {
        [-theta[0] * x[0] + u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<1, P>) {
        *out = LinearizedRates::ZERO;
        out.rates = [-theta[0] * x[0] + u[0]];
        out.state_jacobian = [[-theta[0]]];
        out.regressors[0][0] = -x[0];
    }

    fn linearized_outputs(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<1, 2, P>) {
        *out = LinearizedOutputs::ZERO;
        out.outputs = [x[0], -theta[0] * x[0] + u[0]];
        out.state_jacobian = [[1.0], [-theta[0]]];
        out.parameter_jacobian[1][0] = -x[0];
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state == 0).then_some(0)
    }
}

/// A quadratic spring, `x'' = -a2 x' - a1 x^2 + u`: outputs `x`, `x'`, `x''`.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticSpring;

impl<const P: usize> Model<2, 3, P> for QuadraticSpring {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        2
    }

    fn rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1]) -> [f64; 2] {
        [x[1], -theta[1] * x[1] - theta[0] * x[0] * x[0] + u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<2, P>) {
        *out = LinearizedRates::ZERO;
        out.rates = Model::<2, 3, P>::rates(self, x, theta, u);
        out.state_jacobian = [[0.0, 1.0], [-2.0 * theta[0] * x[0], -theta[1]]];
        out.regressors[1][..2].copy_from_slice(&[-x[0] * x[0], -x[1]]);
    }

    fn linearized_outputs(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<2, 3, P>) {
        let mut lin = LinearizedRates::ZERO;
        Model::<2, 3, P>::linearized_rates(self, x, theta, u, &mut lin);
        *out = LinearizedOutputs::ZERO;
        out.outputs = [x[0], x[1], lin.rates[1]];
        out.state_jacobian = [[1.0, 0.0], [0.0, 1.0], lin.state_jacobian[1]];
        out.parameter_jacobian[2] = lin.regressors[1];
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < 2).then_some(state)
    }
}

/// Measurement noise of the short-period outputs: 0.1 deg, 0.1 deg/s, 0.01 g.
pub const JET_NOISE: [f64; 3] = [0.001_745, 0.001_745, 0.0981];

/// Elevator, rad: a 3-2-1-1 of 0.7 s steps and 1.5 deg from 1 s on, repeated every 10 s.
pub fn elevator_3211(time_s: f64) -> f64 {
    let step = ((time_s % 10.0 - 1.0) / 0.7).floor();
    let sign = match step as i64 {
        _ if step < 0.0 => 0.0,
        0..=2 => 1.0,
        3..=4 => -1.0,
        5 => 1.0,
        6 => -1.0,
        _ => 0.0,
    };
    sign * 1.5_f64.to_radians()
}

/// Elevator, rad: a smooth, ever-present multi-sine of about 1 deg.
pub fn elevator_busy(time_s: f64) -> f64 {
    0.6_f64.to_radians() * ((0.9 * time_s).sin() + (2.3 * time_s + 1.0).sin() + (4.1 * time_s + 2.0).sin())
}

/// A normal deviate by Box and Muller: reproducible everywhere.
pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let a: f64 = rng.random::<f64>().max(1e-300);
    let b: f64 = rng.random();
    (-2.0 * a.ln()).sqrt() * (core::f64::consts::TAU * b).cos()
}

/// A seeded generator.
pub fn seeded(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

/// Flies a model with the input held over each interval and adds white noise.
/// `theta` may change with time.
#[allow(clippy::too_many_arguments)]
pub fn fly<M, const N: usize, const R: usize, const P: usize>(
    model: &M,
    times: &[f64],
    x0: [f64; N],
    theta: impl Fn(f64) -> [f64; P],
    input: impl Fn(f64) -> M::Input,
    noise_std: [f64; R],
    rng: &mut Pcg64Mcg,
) -> Vec<Sample<M::Input, R>>
where
    M: Model<N, R, P>,
{
    let mut x = x0;
    let mut out = Vec::new();
    for (k, &t) in times.iter().enumerate() {
        if k > 0 {
            let before = times[k - 1];
            let held = IntervalInput { from: input(before), to: input(t), hold: InputHold::Zero };
            x = simulate(model, &x, &theta(before), &held, t - before, 0.005);
        }
        let mut lin = LinearizedOutputs::ZERO;
        model.linearized_outputs(&x, &theta(t), &input(t), &mut lin);
        let outputs = core::array::from_fn(|i| lin.outputs[i] + noise_std[i] * normal(rng));
        out.push(Sample { time_s: t, input: input(t), outputs });
    }
    out
}

/// `n` regular times.
pub fn regular(n: usize, step_s: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 * step_s).collect()
}
