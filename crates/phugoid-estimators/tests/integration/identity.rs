//! theory: with an infinite boundary layer and without change detection the estimator *is* the joint extended Kalman filter
//! in separated form. A plain dense joint filter, written here from the textbook, must agree with it, and with the product's
//! joint filter, sample by sample.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, step, sub_steps};
use phugoid_estimators::ekf::JointEkf;
use phugoid_estimators::settings::{EkfSettings, EstimatorSettings, OutputInput, ParameterPrior, ProcessNoise};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{Inspect, LinearizedOutputs, Model, Sample};
use plants::*;
use rand::RngExt;

const N: usize = 2;
const R: usize = 3;
/// Room for two states, six parameters and three biases.
const J: usize = N + 6 + R;

type JetSample = Sample<[f64; 1], R>;

/// Dense joint filter over `(alpha, q, parameters, 3 biases)`.
struct Joint<const P: usize> {
    model: ShortPeriod,
    settings: EstimatorSettings<N, R, P>,
    z: [f64; J],
    p: [[f64; J]; J],
    /// Rows that were not used.
    rejected: usize,
    /// Rows whose innovation was clipped and that taught the covariance nothing.
    clipped: usize,
    /// Random walk of each parameter, variance per second.
    walk: [f64; P],
}

impl<const P: usize> Joint<P> {
    fn new(model: ShortPeriod, settings: EstimatorSettings<N, R, P>, walk: [f64; P], sample: &JetSample) -> Self {
        let (mut z, mut p) = ([0.0; J], [[0.0; J]; J]);
        let own = model.parameters;
        for j in 0..own {
            z[N + j] = settings.priors[j].initial;
            p[N + j][N + j] = settings.priors[j].std * settings.priors[j].std;
        }
        for i in 0..R {
            p[N + own + i][N + own + i] = settings.bias_std[i] * settings.bias_std[i];
        }
        let mut joint = Self { model, settings, z, p, rejected: 0, clipped: 0, walk };
        joint.start_state(sample);
        joint
    }

    /// The state is read from the biased channels: its error is noise minus the error of the bias, and it has to do with
    /// the parameters as far as the bias has.
    fn start_state(&mut self, sample: &JetSample) {
        let own = self.model.parameters;
        for i in 0..N {
            self.z[i] = sample.outputs[i] - self.z[N + own + i];
            for j in N..J {
                self.p[i][j] = -self.p[N + own + i][j];
                self.p[j][i] = self.p[i][j];
            }
        }
        for i in 0..N {
            for k in 0..N {
                self.p[i][k] = self.p[N + own + i][N + own + k];
            }
            self.p[i][i] += self.settings.noise_std[i] * self.settings.noise_std[i];
        }
    }

    fn parameters(&self) -> [f64; P] {
        core::array::from_fn(|j| if N + j < J { self.z[N + j] } else { 0.0 })
    }

    fn predict(&mut self, before: &JetSample, sample: &JetSample) {
        let input = IntervalInput { from: before.input, to: sample.input, hold: self.settings.input_hold };
        let interval_s = sample.time_s - before.time_s;
        let steps = sub_steps(interval_s, self.settings.maximum_step_s);
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            self.predict_part(&input, interval_s, part);
        }
    }

    fn predict_part(&mut self, input: &IntervalInput<[f64; 1]>, interval_s: f64, part: Part) {
        let own = self.model.parameters;
        let (mut a, mut b) = ([[0.0; N]; N], [[0.0; P]; N]);
        let x = [self.z[0], self.z[1]];
        let x = step(&self.model, &x, &self.parameters(), input, interval_s, part, own, &mut b, &mut a);
        let mut f = [[0.0; J]; J];
        for i in 0..J {
            f[i][i] = 1.0;
        }
        for i in 0..N {
            f[i][..N].copy_from_slice(&a[i]);
            f[i][N..N + own].copy_from_slice(&b[i][..own]);
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
            next[i][i] += self.settings.process_noise.variance_per_s[i] * interval_s * (part.to - part.from);
        }
        for j in 0..own {
            next[N + j][N + j] += self.walk[j] * interval_s * (part.to - part.from);
        }
        self.p = next;
    }

    fn correct(&mut self, y: [f64; R], input: [f64; 1]) {
        let own = self.model.parameters;
        let z0 = self.z;
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        self.model.linearized_outputs(&[z0[0], z0[1]], &self.parameters(), &input, &mut lin);
        for i in 0..R {
            if !y[i].is_finite() {
                continue;
            }
            let mut h = [0.0; J];
            h[..N].copy_from_slice(&lin.state_jacobian[i]);
            h[N..N + own].copy_from_slice(&lin.parameter_jacobian[i][..own]);
            h[N + own + i] = 1.0;
            let predicted = lin.outputs[i] + z0[N + own + i] + (0..J).map(|k| h[k] * (self.z[k] - z0[k])).sum::<f64>();
            let ph: [f64; J] = core::array::from_fn(|k| (0..J).map(|l| self.p[k][l] * h[l]).sum());
            let sigma = self.settings.noise_std[i];
            let s = sigma * sigma + (0..J).map(|k| h[k] * ph[k]).sum::<f64>();
            if ((y[i] - predicted) / s.sqrt()).abs() > self.settings.rejection_limit {
                self.rejected += 1;
                continue;
            }
            let reach = self.settings.reaching_limit * s.sqrt();
            let innovation = (y[i] - predicted).clamp(-reach, reach);
            for k in 0..J {
                self.z[k] += ph[k] / s * innovation;
            }
            if innovation != y[i] - predicted {
                self.clipped += 1;
                continue;
            }
            for k in 0..J {
                for l in 0..J {
                    self.p[k][l] -= ph[k] * ph[l] / s;
                }
            }
        }
    }
}

const START: [f64; 6] = [-0.35, -10.0, 6.5, -0.8, 0.0, 0.0];
const START_SD: [f64; 6] = [0.3, 10.0, 2.5, 0.6, 0.02, 0.05];
const BIAS_SD: [f64; R] = [0.004, 0.002, 0.2];

/// The estimator without anything that a Kalman filter has not.
fn plain_settings<const P: usize>(parameters: usize) -> EstimatorSettings<N, R, P> {
    let priors: [ParameterPrior; 6] = core::array::from_fn(|j| ParameterPrior::absolute(START[j], START_SD[j]));
    let mut settings =
        EstimatorSettings::automatic(&priors[..parameters], JET_NOISE, 0.01).unwrap().with_biases(BIAS_SD);
    settings.reaching_limit = f64::INFINITY;
    settings.rejection_limit = f64::INFINITY;
    settings.change_detection = None;
    settings.process_noise = ProcessNoise::fixed([2e-6, 5e-6]);
    settings.start_window_s = 0.0;
    settings.correct_first_sample = false;
    settings.clip_factor = f64::INFINITY;
    settings
}

fn flight<const P: usize>(times: &[f64]) -> Vec<JetSample> {
    let truth: [f64; P] = core::array::from_fn(|j| JET_TRUTH.get(j).copied().unwrap_or(0.0));
    let mut flight = fly(&JET, times, [0.01, 0.0], |_| truth, |t| [elevator_3211(t)], JET_NOISE, &mut seeded(5));
    let mut rng = seeded(6);
    for sample in &mut flight[1..] {
        for i in 0..R {
            sample.outputs[i] += [0.003, -0.001, 0.1][i];
            if normal(&mut rng) > 2.0 {
                sample.outputs[i] = f64::NAN;
            }
        }
    }
    flight
}

/// Largest difference of SMPE and of the joint filter over the flight from the plain one: of values in units of the prior,
/// of standard errors relative, of covariances as correlations. `restart_at` names the frame after a gap, from which the
/// state is started again.
fn difference<const P: usize>(
    model: ShortPeriod,
    settings: EstimatorSettings<N, R, P>,
    flight: &[JetSample],
    restart_at: Option<usize>,
) -> f64 {
    let walk = [0.0; P];
    let mut worst = difference_of(Smpe::new(model, settings).unwrap(), model, settings, walk, flight, restart_at);
    if settings.reaching_limit >= settings.rejection_limit {
        let gated =
            EstimatorSettings { ekf: EkfSettings { gate: settings.rejection_limit, ..settings.ekf }, ..settings };
        let ekf: JointEkf<_, N, R, P> = JointEkf::new(model, gated).unwrap();
        let of_ekf = difference_of(ekf, model, settings, walk, flight, restart_at);
        println!("SMPE {worst:.1e}, joint filter {of_ekf:.1e}");
        worst = worst.max(of_ekf);
    }
    worst
}

fn difference_of<E, const P: usize>(
    mut estimator: E,
    model: ShortPeriod,
    settings: EstimatorSettings<N, R, P>,
    walk: [f64; P],
    flight: &[JetSample],
    restart_at: Option<usize>,
) -> f64
where
    E: Inspect<R, P, Input = [f64; 1]>,
{
    let own = model.parameters;
    let columns = own + R;
    let mut joint = Joint::new(model, settings, walk, &flight[0]);
    let mut worst: f64 = 0.0;
    for (k, sample) in flight.iter().enumerate() {
        let estimate = estimator.update(sample);
        if Some(k) == restart_at {
            joint.start_state(sample);
        } else if k > 0 {
            let before = &flight[k - 1];
            joint.predict(before, sample);
            let input = match settings.output_input {
                OutputInput::Current => sample.input,
                OutputInput::Previous => before.input,
            };
            joint.correct(sample.outputs, input);
        }
        let mut covariance = [[0.0; P]; P];
        estimator.covariance(&mut covariance);
        for j in 0..columns {
            let scale = if j < own { START_SD[j] } else { BIAS_SD[j - own] };
            worst = worst.max((estimate.parameters[j] - joint.z[N + j]).abs() / scale);
            let std = joint.p[N + j][N + j].sqrt();
            worst = worst.max((estimate.std_error[j] / std - 1.0).abs());
            for i in 0..columns {
                let size = (joint.p[N + i][N + i] * joint.p[N + j][N + j]).sqrt();
                worst = worst.max((covariance[i][j] - joint.p[N + i][N + j]).abs() / size);
            }
        }
    }
    assert_eq!(estimator.restarts(), u32::from(restart_at.is_some()));
    assert_eq!(joint.rejected > 0, settings.rejection_limit.is_finite());
    assert_eq!(joint.clipped > 0, settings.reaching_limit < settings.rejection_limit);
    // And it has learnt: this is no comparison of two filters that stand still.
    assert!((joint.z[N] - JET_TRUTH[0]).abs() < 0.04, "{}", joint.z[N]);
    worst
}

#[test]
fn without_saturation_it_is_the_joint_kalman_filter() {
    let worst = difference(JET, plain_settings::<7>(4), &flight::<7>(&regular(2000, 0.01)), None);
    println!("largest difference from the joint filter: {worst:.2e}");
    assert!(worst < 1e-8, "{worst}");
}

/// The same with nine columns in room for eleven, jittering times that need sub-steps now and then, an input that is
/// interpolated and one that is held, and a state that is started again while parameters and biases are kept.
#[test]
fn it_is_the_joint_kalman_filter_at_any_times_and_after_a_restart() {
    let offsets = ShortPeriod { parameters: 6, ..JET };
    let mut rng = seeded(9);
    let mut times = vec![0.0];
    for k in 1..1800 {
        let step_s = match k {
            1100 => 2.0,
            _ if k % 97 == 0 => 0.13,
            _ => 0.006 + 0.008 * rng.random::<f64>(),
        };
        times.push(times[k - 1] + step_s);
    }
    let mut flight = flight::<11>(&times);
    // The frame after the gap is whole.
    for i in 0..R {
        if flight[1100].outputs[i].is_nan() {
            flight[1100].outputs[i] = flight[1101].outputs[i];
        }
    }
    assert!(flight[1100].outputs.iter().all(|y| y.is_finite()));
    for (input_hold, output_input) in
        [(InputHold::Zero, OutputInput::Current), (InputHold::Linear, OutputInput::Previous)]
    {
        let settings = EstimatorSettings { input_hold, output_input, ..plain_settings::<11>(6) };
        let worst = difference(offsets, settings, &flight, Some(1100));
        println!("{input_hold:?} {output_input:?}: {worst:.2e}");
        assert!(worst < 1e-8, "{worst}");
    }
}

/// Without a reaching phase it is the joint filter with a gate.
#[test]
fn with_rejection_alone_it_is_the_gated_joint_filter() {
    let mut settings = plain_settings::<11>(6);
    settings.reaching_limit = 4.0;
    settings.rejection_limit = 4.0;
    let offsets = ShortPeriod { parameters: 6, ..JET };
    let mut flight = flight::<11>(&regular(2000, 0.01));
    for (k, sample) in flight.iter_mut().enumerate().skip(5) {
        if k % 17 == 0 {
            sample.outputs[k % 3] += 20.0 * JET_NOISE[k % 3];
        }
    }
    let worst = difference(offsets, settings, &flight, None);
    println!("largest difference from the gated joint filter: {worst:.2e}");
    assert!(worst < 1e-8, "{worst}");
}

/// With both phases it is the joint filter that clips its innovations at `kappa` and then leaves its covariance alone.
#[test]
fn with_reaching_it_is_the_joint_filter_with_clipped_innovations() {
    let mut settings = plain_settings::<11>(6);
    settings.reaching_limit = 2.0;
    settings.rejection_limit = 8.0;
    let offsets = ShortPeriod { parameters: 6, ..JET };
    let mut flight = flight::<11>(&regular(2000, 0.01));
    for (k, sample) in flight.iter_mut().enumerate().skip(5) {
        if k % 17 == 0 {
            sample.outputs[k % 3] += [5.0, 20.0][k % 2] * JET_NOISE[k % 3];
        }
    }
    let worst = difference(offsets, settings, &flight, None);
    println!("largest difference from the clipped joint filter: {worst:.2e}");
    assert!(worst < 1e-8, "{worst}");
}

/// Parameters that walk: the joint filter alone knows that.
#[test]
fn with_a_random_walk_it_is_the_joint_filter_of_parameters_that_walk() {
    let settings = plain_settings::<7>(4);
    let walk: [f64; 7] = core::array::from_fn(|j| if j < 4 { (0.05 * START_SD[j]).powi(2) } else { 0.0 });
    let tuned = EstimatorSettings { ekf: EkfSettings { gate: f64::INFINITY, parameter_walk_per_s: walk }, ..settings };
    let ekf: JointEkf<_, N, R, 7> = JointEkf::new(JET, tuned).unwrap();
    let worst = difference_of(ekf, JET, settings, walk, &flight::<7>(&regular(2000, 0.01)), None);
    println!("largest difference from the joint filter: {worst:.2e}");
    assert!(worst < 1e-8, "{worst}");
}
