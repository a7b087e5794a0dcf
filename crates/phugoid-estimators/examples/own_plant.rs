//! A plant of one's own on the bare estimators: `cargo run -p phugoid-estimators --example own_plant`.
//!
//! The rolling motion of an aircraft, `p' = Lp p + La a`: `p` is the roll rate (rad/s), `a` the aileron (rad), and the damping `Lp`
//! (1/s) and the effectiveness `La` (1/s^2) are unknown. The roll angle and the roll rate are measured. Everything above `main` is
//! what a flight computer would run: it needs no allocation and nothing of the standard library.
#![allow(clippy::expect_used)] // an example may stop

use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior, SettingsError};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};

/// States: roll angle (rad) and roll rate (rad/s).
const STATES: usize = 2;
/// Measured: both.
const OUTPUTS: usize = 2;
/// Room for the parameters: exactly as many as there are.
const PARAMETERS: usize = 2;

struct Roll;

impl Model<STATES, OUTPUTS, PARAMETERS> for Roll {
    /// The aileron, rad.
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        PARAMETERS
    }

    fn rates(&self, x: &[f64; 2], theta: &[f64; 2], u: &[f64; 1]) -> [f64; 2] {
        [x[1], theta[0] * x[1] + theta[1] * u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; 2], u: &[f64; 1], out: &mut LinearizedRates<2, 2>) {
        out.rates = self.rates(x, theta, u);
        out.state_jacobian = [[0.0, 1.0], [0.0, theta[0]]];
        out.regressors = [[0.0; 2], [x[1], u[0]]];
    }

    fn linearized_outputs(&self, x: &[f64; 2], _: &[f64; 2], _: &[f64; 1], out: &mut LinearizedOutputs<2, 2, 2>) {
        *out = LinearizedOutputs { outputs: *x, state_jacobian: [[1.0, 0.0], [0.0, 1.0]], ..LinearizedOutputs::ZERO };
    }

    /// Each state is measured by the output of the same number.
    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }
}

/// One sigma of the noise of roll angle (rad) and roll rate (rad/s).
const NOISE_STD: [f64; OUTPUTS] = [0.002, 0.005];
const SAMPLE_TIME_S: f64 = 0.02;

/// The estimator for a roll rate damping between -8 and 0 1/s and an effectiveness between 0 and 40 1/s^2.
fn estimator() -> Result<Smpe<Roll, STATES, OUTPUTS, PARAMETERS>, SettingsError> {
    let priors = [ParameterPrior::bounded(-4.0, -8.0, 0.0), ParameterPrior::bounded(20.0, 0.0, 40.0)];
    Smpe::new(Roll, EstimatorSettings::automatic(&priors, NOISE_STD, SAMPLE_TIME_S)?)
}

fn main() {
    let truth = [-2.5, 14.0];
    let mut estimator = estimator().expect("the settings are consistent");
    let (mut x, mut noise) = ([0.0; 2], Noise(1));
    println!("{:>6} {:>8} {:>8} {:>8} {:>8}", "time s", "Lp", "+-", "La", "+-");
    for k in 0..=500 {
        let time_s = SAMPLE_TIME_S * f64::from(k);
        // The aileron goes to one side and to the other, half a second each, from the first second on.
        let aileron = if k < 50 { 0.0 } else { [0.05, -0.05][(k / 25 % 2) as usize] };
        let outputs = [x[0] + NOISE_STD[0] * noise.next(), x[1] + NOISE_STD[1] * noise.next()];
        let estimate = estimator.update(&Sample { time_s, input: [aileron], outputs });
        let (theta, std_error) = (estimate.parameters, estimate.corrected_std_error);
        if k % 100 == 0 {
            let [lp, la] = [2.0 * std_error[0], 2.0 * std_error[1]];
            println!("{time_s:>6.2} {:>8.3} {lp:>8.3} {:>8.3} {la:>8.3}", theta[0], theta[1]);
        }
        if k == 500 {
            for j in 0..PARAMETERS {
                assert!((theta[j] - truth[j]).abs() < 3.0 * std_error[j], "parameter {j}: {}", theta[j]);
                assert!(std_error[j] < 0.03 * truth[j].abs(), "parameter {j} is not known: {}", std_error[j]);
            }
        }
        // The aircraft: exact over a sample, because the aileron is held.
        let (decay, settled) = ((truth[0] * SAMPLE_TIME_S).exp(), -truth[1] * aileron / truth[0]);
        let rate = settled + (x[1] - settled) * decay;
        x = [x[0] + settled * SAMPLE_TIME_S + (x[1] - settled) * (decay - 1.0) / truth[0], rate];
    }
}

/// Noise of variance one: the sum of twelve uniform numbers, less six.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
