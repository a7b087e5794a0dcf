//! theory: with an infinite boundary layer and without re-reaching the estimator *is* the joint extended Kalman filter
//! in separated form. A plain dense joint filter, written here from the textbook, must agree sample by sample.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod plants;

use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, step};
use phugoid_estimators::smpe::{ParameterPrior, ProcessNoise, ReReaching, Smpe, SmpeSettings};
use phugoid_estimators::{Estimator, LinearizedOutputs, Model, Sample};
use plants::*;

const N: usize = 2;
const R: usize = 3;
const P: usize = 7;
const J: usize = N + P;

/// Dense joint filter over `(alpha, q, 4 parameters, 3 biases)`.
struct Joint {
    z: [f64; J],
    p: [[f64; J]; J],
}

impl Joint {
    fn predict(&mut self, from: f64, to: f64, h: f64, q: [f64; N]) {
        let x = [self.z[0], self.z[1]];
        let theta: [f64; P] = core::array::from_fn(|j| self.z[N + j]);
        let input = IntervalInput { from: [from], to: [to], hold: InputHold::Zero };
        let (mut a, mut b) = ([[0.0; N]; N], [[0.0; P]; N]);
        let x = step(&JET, &x, &theta, &input, h, Part { from: 0.0, to: 1.0 }, 4, &mut b, &mut a);
        let mut f = [[0.0; J]; J];
        for i in 0..J {
            f[i][i] = 1.0;
        }
        for i in 0..N {
            f[i][..N].copy_from_slice(&a[i]);
            f[i][N..N + 4].copy_from_slice(&b[i][..4]);
            self.z[i] = x[i];
        }
        let mut fp = [[0.0; J]; J];
        let mut next = [[0.0; J]; J];
        for i in 0..J {
            for j in 0..J {
                fp[i][j] = (0..J).map(|k| f[i][k] * self.p[k][j]).sum();
            }
        }
        for i in 0..J {
            for j in 0..J {
                next[i][j] = (0..J).map(|k| fp[i][k] * f[j][k]).sum();
            }
        }
        for i in 0..N {
            next[i][i] += q[i] * h;
        }
        self.p = next;
    }

    fn correct(&mut self, y: [f64; R], elevator: f64) {
        let z0 = self.z;
        let theta: [f64; P] = core::array::from_fn(|j| z0[N + j]);
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        JET.linearized_outputs(&[z0[0], z0[1]], &theta, &[elevator], &mut lin);
        for i in 0..R {
            if !y[i].is_finite() {
                continue;
            }
            let mut h = [0.0; J];
            h[..N].copy_from_slice(&lin.state_jacobian[i]);
            h[N..N + 4].copy_from_slice(&lin.parameter_jacobian[i][..4]);
            h[N + 4 + i] = 1.0;
            let predicted = lin.outputs[i] + z0[N + 4 + i] + (0..J).map(|k| h[k] * (self.z[k] - z0[k])).sum::<f64>();
            let ph: [f64; J] = core::array::from_fn(|k| (0..J).map(|l| self.p[k][l] * h[l]).sum());
            let s = JET_NOISE[i] * JET_NOISE[i] + (0..J).map(|k| h[k] * ph[k]).sum::<f64>();
            for k in 0..J {
                self.z[k] += ph[k] / s * (y[i] - predicted);
            }
            for k in 0..J {
                for l in 0..J {
                    self.p[k][l] -= ph[k] * ph[l] / s;
                }
            }
        }
    }
}

#[test]
fn without_saturation_it_is_the_joint_kalman_filter() {
    let start = [-0.35, -10.0, 6.5, -0.8];
    let sd = [0.3, 10.0, 2.5, 0.6];
    let bias_sd = [0.004, 0.002, 0.2];
    let q = [2e-6, 5e-6];
    let priors: [ParameterPrior; 4] = core::array::from_fn(|j| ParameterPrior::absolute(start[j], sd[j]));
    let mut settings = SmpeSettings::<N, R, P>::automatic(&priors, JET_NOISE, 0.01).unwrap().with_biases(bias_sd);
    settings.reaching_limit = f64::INFINITY;
    settings.rejection_limit = f64::INFINITY;
    settings.re_reaching = ReReaching::Off;
    settings.process_noise = ProcessNoise::fixed(q);
    settings.start_window_s = 0.0;
    settings.correct_first_sample = false;
    settings.clip_factor = f64::INFINITY;
    let mut smpe = Smpe::new(JET, settings).unwrap();

    let truth: [f64; P] = core::array::from_fn(|j| if j < 4 { JET_TRUTH[j] } else { 0.0 });
    let mut flight =
        fly(&JET, &regular(2000, 0.01), [0.01, 0.0], |_| truth, |t| [elevator_3211(t)], JET_NOISE, &mut seeded(5));
    let mut rng = seeded(6);
    for sample in &mut flight[1..] {
        for i in 0..R {
            sample.outputs[i] += [0.003, -0.001, 0.1][i];
            if normal(&mut rng) > 2.0 {
                sample.outputs[i] = f64::NAN;
            }
        }
    }

    let mut joint: Option<Joint> = None;
    let mut before: Option<Sample<[f64; 1], R>> = None;
    let mut worst: f64 = 0.0;
    for sample in &flight {
        let estimate = smpe.update(sample);
        match (&mut joint, before) {
            (Some(joint), Some(before)) => {
                joint.predict(before.input[0], sample.input[0], sample.time_s - before.time_s, q);
                joint.correct(sample.outputs, sample.input[0]);
            }
            _ => {
                let mut z = [0.0; J];
                z[0] = sample.outputs[0];
                z[1] = sample.outputs[1];
                z[N..N + 4].copy_from_slice(&start);
                let mut p = [[0.0; J]; J];
                for j in 0..4 {
                    p[N + j][N + j] = sd[j] * sd[j];
                }
                for i in 0..R {
                    p[N + 4 + i][N + 4 + i] = bias_sd[i] * bias_sd[i];
                }
                // The state was read from the biased channel: its error is noise minus bias.
                for i in 0..N {
                    let variance = bias_sd[i] * bias_sd[i];
                    p[i][i] = JET_NOISE[i] * JET_NOISE[i] + variance;
                    p[i][N + 4 + i] = -variance;
                    p[N + 4 + i][i] = -variance;
                }
                joint = Some(Joint { z, p });
            }
        }
        before = Some(*sample);
        let joint = joint.as_ref().unwrap();
        for j in 0..P {
            let scale = if j < 4 { start[j].abs() } else { bias_sd[j - 4] };
            worst = worst.max((estimate.parameters[j] - joint.z[N + j]).abs() / scale);
            let sd = joint.p[N + j][N + j].sqrt();
            worst = worst.max((estimate.std_error[j] / sd - 1.0).abs());
        }
        let mut covariance = [[0.0; P]; P];
        smpe.covariance(&mut covariance);
        for i in 0..P {
            for j in 0..P {
                let size = (joint.p[N + i][N + i] * joint.p[N + j][N + j]).sqrt();
                worst = worst.max((covariance[i][j] - joint.p[N + i][N + j]).abs() / size);
            }
        }
    }
    println!("largest difference from the joint filter: {worst:.2e}");
    assert!(worst < 1e-8, "{worst}");
    // And it has learnt: this is no comparison of two filters that stand still.
    assert!((joint.unwrap().z[N] - JET_TRUTH[0]).abs() < 0.02);
}
