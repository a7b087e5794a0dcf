//! A fighter's lateral-directional motion, linear about level flight, with the flight control system that stabilises it.

use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate};
use phugoid_estimators::settings::ParameterPrior;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model, Sample};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::normal;

/// States `beta` (rad), `phi` (rad), `p`, `r` (rad/s); inputs aileron and rudder (rad); outputs `beta`, `phi`, `p`, `r`,
/// `ay` (m/s2). Parameters in the order of [`NAMES`].
#[derive(Clone, Copy, Debug)]
pub struct Fighter;

pub const PARAMETERS: usize = 12;
pub const NAMES: [&str; PARAMETERS] = [
    "CY_beta",
    "CY_rudder",
    "Cl_beta",
    "Cl_p",
    "Cl_r",
    "Cl_aileron",
    "Cl_rudder",
    "Cn_beta",
    "Cn_p",
    "Cn_r",
    "Cn_aileron",
    "Cn_rudder",
];
pub const TRUTH: [f64; PARAMETERS] =
    [-0.34, 0.37, -0.076, -0.39, 0.05, -0.039, 0.008, 0.16, -0.086, -0.45, -0.0023, -0.053];
/// Textbook values of its class and how far off they may be.
const START: [[f64; 2]; PARAMETERS] = [
    [-0.6, 0.8],
    [0.15, 0.3],
    [-0.08, 0.15],
    [-0.45, 0.5],
    [0.1, 0.3],
    [-0.15, 0.2],
    [0.01, 0.05],
    [0.1, 0.15],
    [-0.03, 0.2],
    [-0.15, 0.3],
    [0.0, 0.05],
    [-0.07, 0.1],
];
/// One sigma of `beta`, `phi`, `p`, `r`, `ay` as a data sheet gives it.
pub const NOISE: [f64; 5] = [8.7e-4, 8.7e-4, 3.5e-4, 3.5e-4, 0.02];

const SPEED: f64 = 210.0;
const ALPHA: f64 = 0.04;
/// `qbar S/m`, `qbar S b/Ixx`, `qbar S b/Izz`.
const SIDE: f64 = 62.6;
const ROLL: f64 = 322.0;
const YAW: f64 = 48.9;
/// `b/2V`, s.
const HALF_SPAN_TIME: f64 = 0.0311;

pub fn priors() -> [ParameterPrior; PARAMETERS] {
    START.map(|[start, std]| ParameterPrior::absolute(start, std))
}

/// The regressors of CY, Cl and Cn.
fn regressors([beta, _, p, r]: &[f64; 4], [aileron, rudder]: &[f64; 2]) -> [[f64; PARAMETERS]; 3] {
    let (p, r) = (p * HALF_SPAN_TIME, r * HALF_SPAN_TIME);
    let mut rows = [[0.0; PARAMETERS]; 3];
    rows[0][..2].copy_from_slice(&[*beta, *rudder]);
    rows[1][2..7].copy_from_slice(&[*beta, p, r, *aileron, *rudder]);
    rows[2][7..].copy_from_slice(&[*beta, p, r, *aileron, *rudder]);
    rows
}

impl Model<4, 5, PARAMETERS> for Fighter {
    type Input = [f64; 2];

    fn parameter_count(&self) -> usize {
        PARAMETERS
    }

    fn rates(&self, x: &[f64; 4], theta: &[f64; PARAMETERS], u: &[f64; 2]) -> [f64; 4] {
        let mut lin = LinearizedRates::ZERO;
        self.linearized_rates(x, theta, u, &mut lin);
        lin.rates
    }

    fn linearized_rates(
        &self,
        x: &[f64; 4],
        theta: &[f64; PARAMETERS],
        u: &[f64; 2],
        out: &mut LinearizedRates<4, PARAMETERS>,
    ) {
        let [_, phi, p, r] = *x;
        let rows = regressors(x, u);
        let scale = [SIDE / SPEED, ROLL, YAW];
        *out = LinearizedRates::ZERO;
        out.rates = [9.81 / SPEED * phi + ALPHA * p - r, p + ALPHA * r, 0.0, 0.0];
        out.state_jacobian[0] = [0.0, 9.81 / SPEED, ALPHA, -1.0];
        out.state_jacobian[1] = [0.0, 0.0, 1.0, ALPHA];
        for ((state, row), scale) in [0, 2, 3].into_iter().zip(rows).zip(scale) {
            out.regressors[state] = row.map(|w| w * scale);
            out.rates[state] += row.iter().zip(theta).map(|(w, t)| w * t * scale).sum::<f64>();
        }
        let t = HALF_SPAN_TIME;
        out.state_jacobian[0][0] += scale[0] * theta[0];
        out.state_jacobian[2] = [ROLL * theta[2], 0.0, ROLL * t * theta[3], ROLL * t * theta[4]];
        out.state_jacobian[3] = [YAW * theta[7], 0.0, YAW * t * theta[8], YAW * t * theta[9]];
    }

    fn linearized_outputs(
        &self,
        x: &[f64; 4],
        theta: &[f64; PARAMETERS],
        u: &[f64; 2],
        out: &mut LinearizedOutputs<4, 5, PARAMETERS>,
    ) {
        *out = LinearizedOutputs::ZERO;
        let [row, ..] = regressors(x, u);
        for k in 0..4 {
            out.outputs[k] = x[k];
            out.state_jacobian[k][k] = 1.0;
        }
        out.parameter_jacobian[4] = row.map(|w| SIDE * w);
        out.outputs[4] = row.iter().zip(theta).map(|(w, t)| SIDE * w * t).sum();
        out.state_jacobian[4][0] = SIDE * theta[0];
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }
}

/// Gains of the flight control system, radians of surface per rad/s or rad.
#[derive(Clone, Copy, Debug)]
pub struct Gains {
    pub aileron_p: f64,
    pub aileron_phi: f64,
    pub rudder_r: f64,
    pub rudder_beta: f64,
}

impl Gains {
    /// One to three 1/s of roll damping, bank hold in half of the flights, 0.6 to 2 1/s of yaw damping, sideslip
    /// feedback in half of them.
    pub fn drawn(rng: &mut Pcg64Mcg) -> Self {
        let (aileron, rudder) = (ROLL * TRUTH[5].abs(), YAW * TRUTH[11].abs());
        let mut between = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
        let [p, phi, r, beta] = [between(1.0, 3.0), between(0.5, 2.0), between(0.6, 2.0), between(0.3, 1.0)];
        let half = |draw: f64| if draw < 0.5 { 0.0 } else { 1.0 };
        let [holds, feeds] = [half(between(0.0, 1.0)), half(between(0.0, 1.0))];
        Self {
            aileron_p: p / aileron,
            aileron_phi: holds * phi / aileron,
            rudder_r: r / rudder,
            rudder_beta: feeds * beta * YAW * TRUTH[7] / rudder,
        }
    }
}

/// Doublets of the pilot: rudder at 2 s and 10 s, ailerons at `ailerons_s` and 6 s later, amplitudes in rad.
fn pilot(time_s: f64, ailerons_s: f64) -> [f64; 2] {
    let doublet = |from_s: f64, half_s: f64| match (time_s - from_s) / half_s {
        since if (0.0..1.0).contains(&since) => 1.0,
        since if (1.0..2.0).contains(&since) => -1.0,
        _ => 0.0,
    };
    let aileron = doublet(ailerons_s, 1.0) + doublet(ailerons_s + 6.0, 0.7);
    [0.07 * aileron, 0.12 * (doublet(2.0, 0.8) + doublet(10.0, 0.6))]
}

/// The derivatives that hold at a sideslip: `CY_beta`, `Cl_beta` and `Cn_beta` lose the part `bend` of themselves at 0.1
/// rad.
fn bent([beta, ..]: &[f64; 4], bend: f64) -> [f64; PARAMETERS] {
    let mut theta = TRUTH;
    for j in [0, 2, 7] {
        theta[j] *= 1.0 - bend * beta.abs() / 0.1;
    }
    theta
}

/// A flight of the stabilised aircraft: the pilot's doublets, feedback of the true motion, actuators of 20 rad/s, noise
/// of `noise` times the data sheet; `bend` as in [`bent`]. The surfaces are recorded without noise and run straight between
/// the samples.
pub fn stabilised(
    gains: &Gains,
    ailerons_s: f64,
    duration_s: f64,
    step_s: f64,
    noise: f64,
    bend: f64,
    rng: &mut Pcg64Mcg,
) -> Vec<Sample<[f64; 2], 5>> {
    const FINE: usize = 10;
    let (mut x, mut u) = ([0.0; 4], [0.0; 2]);
    let mut out = Vec::new();
    let samples = (duration_s / step_s).round() as usize;
    for k in 0..samples {
        let time_s = k as f64 * step_s;
        let mut lin = LinearizedOutputs::ZERO;
        Fighter.linearized_outputs(&x, &bent(&x, bend), &u, &mut lin);
        let outputs = core::array::from_fn(|i| lin.outputs[i] + noise * NOISE[i] * normal(rng));
        out.push(Sample { time_s, input: u, outputs });
        for fine in 0..FINE {
            let h = step_s / FINE as f64;
            let [beta, phi, p, r] = x;
            let [aileron, rudder] = pilot(time_s + fine as f64 * h, ailerons_s);
            let asked = [
                aileron + gains.aileron_p * p + gains.aileron_phi * phi,
                rudder + gains.rudder_r * r - gains.rudder_beta * beta,
            ];
            let mut next = u;
            for (next, asked) in next.iter_mut().zip(asked) {
                *next += 20.0 * h * (asked.clamp(-0.35, 0.35) - *next);
            }
            x = simulate(
                &Fighter,
                &x,
                &bent(&x, bend),
                &IntervalInput { from: u, to: next, hold: InputHold::Linear },
                h,
                h,
            );
            u = next;
        }
    }
    out
}
