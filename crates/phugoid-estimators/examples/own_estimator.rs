//! An estimator of one's own behind the trait of the others: `cargo run -p phugoid-estimators --example own_estimator`.
//!
//! A scalar Kalman filter for the parameter of `x' = -a x + u` from the measured `x` and `x'`: one row of regression per sample,
//! `u - x' = a x`. It is run beside SMPE, by the same function, on the same samples. Its regressor is the noisy `x`: where the noise
//! is not small, its estimate is biased, and that of SMPE is not.
#![allow(clippy::expect_used)] // an example may stop

use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{
    Estimate, Estimator, LinearizedOutputs, LinearizedRates, Model, ParameterStatus, Phase, Sample, Status,
};

/// `x' = -a x + u`; `a` (1/s) is unknown, `x` and `x'` are measured.
struct FirstOrder;

impl Model<1, 2, 1> for FirstOrder {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        1
    }

    fn rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1]) -> [f64; 1] {
        [u[0] - a[0] * x[0]]
    }

    fn linearized_rates(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1], out: &mut LinearizedRates<1, 1>) {
        (out.rates, out.state_jacobian, out.regressors) = (self.rates(x, a, u), [[-a[0]]], [[-x[0]]]);
    }

    fn linearized_outputs(&self, x: &[f64; 1], a: &[f64; 1], u: &[f64; 1], out: &mut LinearizedOutputs<1, 2, 1>) {
        out.outputs = [x[0], self.rates(x, a, u)[0]];
        (out.state_jacobian, out.parameter_jacobian) = ([[1.0], [-a[0]]], [[0.0], [-x[0]]]);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state == 0).then_some(0)
    }
}

/// The variance of `a` shrinks with every sample that has a regressor.
struct ScalarKalman {
    value: f64,
    variance: f64,
    prior_variance: f64,
    /// Variance of the noise of `u - x'`, 1/s^2.
    row_variance: f64,
}

impl Estimator<2, 1> for ScalarKalman {
    type Input = [f64; 1];

    fn update(&mut self, sample: &Sample<[f64; 1], 2>) -> Estimate<1> {
        let ([x, rate], [u]) = (sample.outputs, sample.input);
        // A value that is not finite was not measured: the estimate stays as it is.
        let complete = x.is_finite() && rate.is_finite();
        if complete {
            let gain = self.variance * x / (x * x * self.variance + self.row_variance);
            self.value += gain * (u - rate - x * self.value);
            self.variance *= 1.0 - gain * x;
        }
        let std_error = self.variance.sqrt();
        let parameter_status = match std_error / self.prior_variance.sqrt() {
            part if part < 0.1 => ParameterStatus::Converged,
            part if part < 0.7 => ParameterStatus::Improving,
            _ => ParameterStatus::NotExcited,
        };
        Estimate {
            time_s: sample.time_s,
            parameters: [self.value],
            std_error: [std_error],
            corrected_std_error: [std_error],
            observability: [1.0 - self.variance / self.prior_variance],
            parameter_status: [parameter_status],
            status: Status { phase: if complete { Phase::Sliding } else { Phase::Predicting }, ..Status::default() },
        }
    }

    fn covariance(&self, out: &mut [[f64; 1]; 1]) {
        out[0][0] = self.variance;
    }
}

/// What every estimator is given, its own or one of the crate's: 5 s at 100 Hz of `a = 3` under a square wave.
fn run(mut estimator: impl Estimator<2, 1, Input = [f64; 1]>, noise: f64) -> Estimate<1> {
    let (a, h, mut x, mut random) = (3.0, 0.01, 0.0, 5_u64);
    let mut uniform = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut last = None;
    for k in 0..=500_u32 {
        let u = if k / 50 % 2 == 0 { 1.0 } else { -1.0 };
        // Uniform noise of this standard deviation.
        let mut measure = |value: f64| value + 12_f64.sqrt() * noise * uniform();
        let outputs = [measure(x), measure(-a * x + u)];
        last = Some(estimator.update(&Sample { time_s: h * f64::from(k), input: [u], outputs }));
        x = u / a + (x - u / a) * (-a * h).exp();
    }
    last.expect("there are samples")
}

fn main() {
    println!("{:>6}  {:<14} {:>8} {:>8}", "noise", "estimator", "a", "+-");
    let mut errors = Vec::new();
    for noise in [0.001, 0.1] {
        // Noise of x' and a times the noise of x, with a about 3.
        let row_variance = (1.0 + 9.0) * noise * noise;
        let own = ScalarKalman { value: 5.0, variance: 4.0, prior_variance: 4.0, row_variance };
        let settings = EstimatorSettings::automatic(&[ParameterPrior::bounded(5.0, 1.0, 9.0)], [noise; 2], 0.01);
        let smpe = Smpe::new(FirstOrder, settings.expect("they are consistent")).expect("they suit the plant");
        for (name, estimate) in [("scalar Kalman", run(own, noise)), ("SMPE", run(smpe, noise))] {
            let (value, bound) = (estimate.parameters[0], 2.0 * estimate.corrected_std_error[0]);
            println!("{noise:>6}  {name:<14} {value:>8.4} {bound:>8.4}");
            assert_eq!(estimate.parameter_status[0], ParameterStatus::Converged, "{name}");
            errors.push((value - 3.0).abs() / bound);
        }
    }
    let [own_quiet, smpe_quiet, own_noisy, smpe_noisy] = errors[..] else { unreachable!("four runs") };
    assert!(own_quiet < 1.5 && smpe_quiet < 1.5 && smpe_noisy < 1.5, "{errors:?}");
    assert!(own_noisy > 3.0, "noise in the regressor must show as a bias: {errors:?}");
}
