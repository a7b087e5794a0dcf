//! What is proved about the sliding law (docs/theory.md), on the code itself: a plain regression `y = D theta`, no noise
//! in the data, rows of every size.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::RowPhase;
use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
use plants::{normal, seeded};
use rand::RngExt;

const P: usize = 3;

/// Two output rows `y = D theta` with `D` as the input; the state is idle.
struct Regression;

impl Model<1, 2, P> for Regression {
    type Input = [f64; 6];

    fn parameter_count(&self) -> usize {
        P
    }

    fn rates(&self, _: &[f64; 1], _: &[f64; P], _: &[f64; 6]) -> [f64; 1] {
        [0.0]
    }

    fn linearized_rates(&self, _: &[f64; 1], _: &[f64; P], _: &[f64; 6], out: &mut LinearizedRates<1, P>) {
        *out = LinearizedRates::ZERO;
    }

    fn linearized_outputs(&self, _: &[f64; 1], theta: &[f64; P], u: &[f64; 6], out: &mut LinearizedOutputs<1, 2, P>) {
        *out = LinearizedOutputs::ZERO;
        for i in 0..2 {
            out.parameter_jacobian[i].copy_from_slice(&u[3 * i..3 * i + 3]);
            out.outputs[i] = (0..P).map(|j| u[3 * i + j] * theta[j]).sum();
        }
    }

    fn measuring_output(&self, _: usize) -> Option<usize> {
        None
    }
}

/// `1/2 e^T C^-1 e` by Gaussian elimination.
fn lyapunov(covariance: &[[f64; P]; P], e: [f64; P]) -> f64 {
    let mut a = *covariance;
    let mut b = e;
    for k in 0..P {
        let best = (k..P).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, best);
        b.swap(k, best);
        for i in k + 1..P {
            let factor = a[i][k] / a[k][k];
            for j in k..P {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..P).rev() {
        b[k] = (b[k] - (k + 1..P).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    0.5 * (0..P).map(|i| e[i] * b[i]).sum::<f64>()
}

/// Runs one trial; gives (largest increase of V relative to V0, saturated rows, rejected rows, the bound on saturated).
fn trial(seed: u64, std: f64, rejection: f64) -> (f64, usize, usize, f64) {
    let mut rng = seeded(seed);
    let truth: [f64; P] = core::array::from_fn(|_| rng.random_range(-1.0..1.0));
    let prior = ParameterPrior { std, ..ParameterPrior::bounded(0.0, -1.0, 1.0) };
    let mut settings = EstimatorSettings::<1, 2, P>::automatic(&[prior; P], [1.0; 2], 0.01).unwrap();
    settings.change_detection = None;
    settings.rejection_limit = rejection;
    settings.clip_factor = f64::INFINITY;
    settings.start_window_s = 0.0;
    settings.start_trial_s = 0.0;
    let kappa = settings.reaching_limit;
    let mut smpe = Smpe::new(Regression, settings).unwrap();
    let v0 = 0.5 * truth.iter().map(|t| t * t / (std * std)).sum::<f64>();
    let mut v = v0;
    let (mut worst, mut saturated, mut rejected) = (f64::NEG_INFINITY, 0, 0);
    for k in 0..200 {
        // Rows from faint to overwhelming, often collinear.
        let size = 10.0_f64.powf(rng.random_range(-2.0..3.0));
        let direction: [f64; P] = core::array::from_fn(|_| normal(&mut rng));
        let input: [f64; 6] = core::array::from_fn(|i| size * (direction[i % 3] + 0.1 * normal(&mut rng)));
        let outputs = core::array::from_fn(|i| (0..P).map(|j| input[3 * i + j] * truth[j]).sum());
        let estimate = smpe.update(&Sample { time_s: 0.01 * f64::from(k), input, outputs });
        let mut covariance = [[0.0; P]; P];
        smpe.covariance(&mut covariance);
        let next = lyapunov(&covariance, core::array::from_fn(|j| estimate.parameters[j] - truth[j]));
        worst = worst.max((next - v) / v0);
        v = next;
        saturated += smpe.innovations().phase.iter().filter(|p| **p == RowPhase::Reaching).count();
        rejected += smpe.innovations().phase.iter().filter(|p| **p == RowPhase::Rejected).count();
    }
    (worst, saturated, rejected, 2.0 * v0 / (kappa * kappa))
}

#[test]
fn the_lyapunov_function_never_increases_and_reaching_is_finite() {
    let (mut saturated_in_all, mut rejected_in_all) = (0, 0);
    for seed in 0..300 {
        // From the rule's C0 = (R/2)^2 to one far too confident, which has to reach for long.
        let std = [0.5, 0.1, 0.02][seed as usize % 3];
        let rejection = if seed % 2 == 0 { f64::INFINITY } else { 6.0 };
        let (worst, saturated, rejected, bound) = trial(seed, std, rejection);
        // 1e-9: rounding of V itself, whose C^-1 has been through two hundred rows of up to 1e3.
        assert!(worst < 1e-9, "seed {seed}: V rose by {worst} of V0");
        assert!(saturated as f64 <= bound, "seed {seed}: {saturated} saturated rows, bound {bound}");
        saturated_in_all += saturated;
        rejected_in_all += rejected;
    }
    println!("{saturated_in_all} saturated and {rejected_in_all} rejected rows in 300 trials");
    assert!(saturated_in_all > 1000 && rejected_in_all > 1000, "the trials must exercise all three phases");
}

/// Theory, "bounds decide the gain": for a parameter inside its bounds and `C0 = (R/2)^2` no noise-free row exceeds
/// `2 sqrt(p)`, so the automatic rejection limit rejects none.
#[test]
fn nothing_inside_the_bounds_is_rejected() {
    for seed in 1000..1100 {
        let automatic = (2.0 * (P as f64).sqrt() + 2.0).max(6.0);
        let (_, _, rejected, _) = trial(seed, 0.5, automatic);
        assert_eq!(rejected, 0, "seed {seed}");
    }
}
