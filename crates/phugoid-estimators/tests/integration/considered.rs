//! Considered constants: the errors that they leave in the estimate, against a dense covariance of state, parameters and
//! constants under the gain that ignores the constants, and against flights in which the constants really are wrong.

use crate::plants;

use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, step, sub_steps};
use phugoid_estimators::ekf::{ConsideringEkf, JointEkf};
use phugoid_estimators::settings::{
    ChangePrior, EkfSettings, EstimatorSettings, OutputInput, ParameterPrior, ProcessNoise, SettingsError,
};
use phugoid_estimators::smpe::{ConsideringSmpe, Smpe};
use phugoid_estimators::supervisor::learnt::LearningRule;
use phugoid_estimators::{
    ChangeState, ConstantEffects, Estimator, Inspect, LinearizedOutputs, LinearizedRates, Model, Sample,
};
use plants::*;
use rand::RngExt;

const N: usize = 2;
const R: usize = 3;
const OWN: usize = 6;
/// Six parameters and three biases, in room for eleven.
const COLUMNS: usize = OWN + R;
const P: usize = 11;
const K: usize = 5;
/// States and columns of the filter, and with the constants.
const J: usize = N + COLUMNS;
const L: usize = J + K;

/// The lag of the vane and the scale of the elevator, which the flight itself can tell.
const LEARNABLE: [usize; 2] = [1, 4];

type Flight = Vec<Sample<[f64; 1], R>>;

/// The short period with five constants: scale and lag of the vane, moment of inertia, mass, scale of the elevator as it
/// is recorded.
#[derive(Clone, Copy, Debug)]
struct Uncertain(ShortPeriod);

const JET6: Uncertain = Uncertain(ShortPeriod { parameters: OWN, ..JET });

impl<const P: usize> Model<N, R, P> for Uncertain {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        OWN
    }

    fn rates(&self, x: &[f64; N], theta: &[f64; P], u: &[f64; 1]) -> [f64; N] {
        Model::<N, R, P>::rates(&self.0, x, theta, u)
    }

    fn linearized_rates(&self, x: &[f64; N], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<N, P>) {
        Model::<N, R, P>::linearized_rates(&self.0, x, theta, u, out);
    }

    fn linearized_outputs(&self, x: &[f64; N], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<N, R, P>) {
        self.0.linearized_outputs(x, theta, u, out);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        Some(state)
    }

    fn constant_count(&self) -> usize {
        K
    }

    fn learnable_constants(&self) -> &[usize] {
        &LEARNABLE
    }

    fn constant_effects<const K: usize>(
        &self,
        x: &[f64; N],
        theta: &[f64; P],
        u: &[f64; 1],
        out: &mut ConstantEffects<N, R, K>,
    ) {
        let [alpha_rate, q_rate] = Model::<N, R, P>::rates(self, x, theta, u);
        let lift = theta[2] * x[0] + theta[5];
        out.outputs[0][0] = x[0];
        out.outputs[0][1] = -alpha_rate;
        out.rates[1][2] = -q_rate;
        out.rates[0][3] = x[1] - alpha_rate;
        out.outputs[2][3] = self.0.lift_acceleration * lift;
        out.rates[1][4] = -self.0.moment_acceleration * theta[3] * u[0];
    }
}

const START: [f64; OWN] = [-0.35, -10.0, 6.5, -0.8, 0.0, 0.0];
const START_SD: [f64; OWN] = [0.3, 10.0, 2.5, 0.6, 0.02, 0.05];
const BIAS_SD: [f64; R] = [0.004, 0.002, 0.2];

fn automatic() -> EstimatorSettings<N, R, P> {
    let priors: [ParameterPrior; OWN] = core::array::from_fn(|j| ParameterPrior::absolute(START[j], START_SD[j]));
    EstimatorSettings::automatic(&priors, JET_NOISE, 0.01).unwrap().with_biases(BIAS_SD)
}

fn settings() -> EstimatorSettings<N, R, P> {
    let mut settings = automatic();
    settings.reaching_limit = f64::INFINITY;
    settings.rejection_limit = f64::INFINITY;
    settings.ekf.gate = f64::INFINITY;
    settings.change_detection = None;
    settings.process_noise = ProcessNoise::fixed([2e-6, 5e-6]);
    settings.start_window_s = 0.0;
    settings.correct_first_sample = false;
    settings.clip_factor = f64::INFINITY;
    settings
}

fn truth() -> [f64; P] {
    core::array::from_fn(|j| JET_TRUTH.get(j).copied().unwrap_or(0.0))
}

/// A flight with missing values.
fn flight(times: &[f64]) -> Flight {
    let mut flight = fly(&JET6, times, [0.01, 0.0], |_| truth(), |t| [elevator_3211(t)], JET_NOISE, &mut seeded(5));
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

type Dense<const D: usize> = [[f64; D]; D];

fn conjugate<const D: usize>(f: &Dense<D>, p: &Dense<D>) -> Dense<D> {
    let mut fp = [[0.0; D]; D];
    let mut out = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            fp[i][j] = (0..D).map(|k| f[i][k] * p[k][j]).sum();
        }
    }
    for i in 0..D {
        for j in 0..D {
            out[i][j] = (0..D).map(|k| fp[i][k] * f[j][k]).sum();
        }
    }
    out
}

/// The dense filter over state, parameters and biases, which ignores the constants, and beside it the covariance of its
/// errors and the constants under its gain.
struct Reference {
    settings: EstimatorSettings<N, R, P>,
    z: [f64; J],
    p: Dense<J>,
    /// What the errors really have.
    all: Dense<L>,
    /// The covariance of a filter that has the learnable constants among its parameters and ignores the others, linearised where this one
    /// is, and how far its estimate lies from this one's.
    learning: Dense<L>,
    apart: [f64; L],
    /// Rows inside the gate, and clipped ones that move the estimate by a fixed step.
    kappa: f64,
}

fn times<const D: usize>(f: &Dense<D>, x: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|i| (0..D).map(|j| f[i][j] * x[j]).sum())
}

impl Reference {
    fn new(
        settings: EstimatorSettings<N, R, P>,
        kappa: f64,
        variances: &[f64; K],
        sample: &Sample<[f64; 1], R>,
    ) -> Self {
        let (mut z, mut p, mut all) = ([0.0; J], [[0.0; J]; J], [[0.0; L]; L]);
        for j in 0..COLUMNS {
            let std = if j < OWN { START_SD[j] } else { BIAS_SD[j - OWN] };
            z[N + j] = if j < OWN { START[j] } else { 0.0 };
            p[N + j][N + j] = std * std;
            all[N + j][N + j] = std * std;
        }
        for k in 0..K {
            all[J + k][J + k] = variances[k];
        }
        let mut learning = all;
        for k in (0..K).filter(|k| !LEARNABLE.contains(k)) {
            learning[J + k][J + k] = 0.0;
        }
        let mut reference = Self { settings, z, p, all, learning, apart: [0.0; L], kappa };
        reference.start_state(sample);
        reference
    }

    fn state(&self) -> [f64; N] {
        [self.z[0], self.z[1]]
    }

    fn parameters(&self) -> [f64; P] {
        core::array::from_fn(|j| if j < COLUMNS { self.z[N + j] } else { 0.0 })
    }

    /// The state is read from channels: its error is their noise, less the errors of their biases and constants.
    fn start_state(&mut self, sample: &Sample<[f64; 1], R>) {
        for i in 0..N {
            self.z[i] = sample.outputs[i] - self.z[N + OWN + i];
        }
        let mut effects = ConstantEffects::<N, R, K>::ZERO;
        JET6.constant_effects(&self.state(), &self.parameters(), &sample.input, &mut effects);
        let mut f = [[0.0; J]; J];
        let mut g = [[0.0; L]; L];
        for i in 0..L {
            if i < N {
                g[i][N + OWN + i] = -1.0;
                for k in 0..K {
                    g[i][J + k] = -effects.outputs[i][k];
                }
            } else {
                g[i][i] = 1.0;
            }
        }
        for i in 0..J {
            f[i].copy_from_slice(&g[i][..J]);
        }
        self.p = conjugate(&f, &self.p);
        self.all = conjugate(&g, &self.all);
        self.learning = conjugate(&g, &self.learning);
        self.apart = times(&g, &self.apart);
        for i in 0..N {
            self.learning[i][i] += self.settings.noise_std[i].powi(2);
            let variance = self.settings.noise_std[i].powi(2);
            self.p[i][i] += variance;
            self.all[i][i] += variance;
        }
    }

    fn predict(&mut self, before: &Sample<[f64; 1], R>, sample: &Sample<[f64; 1], R>) {
        let input = IntervalInput { from: before.input, to: sample.input, hold: self.settings.input_hold };
        let interval_s = sample.time_s - before.time_s;
        let steps = sub_steps(interval_s, self.settings.maximum_step_s);
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            let h = interval_s * (part.to - part.from);
            let (mut a, mut b) = ([[0.0; N]; N], [[0.0; P]; N]);
            let (x, theta) = (self.state(), self.parameters());
            let after = step(&JET6, &x, &theta, &input, interval_s, part, OWN, &mut b, &mut a);
            // The effect of the constants on the rates half way acts for the whole step.
            let mut effects = ConstantEffects::<N, R, K>::ZERO;
            let middle = core::array::from_fn(|i| 0.5 * (x[i] + after[i]));
            JET6.constant_effects(&middle, &theta, &input.at(0.5 * (part.from + part.to)), &mut effects);
            let (mut f, mut g) = ([[0.0; J]; J], [[0.0; L]; L]);
            for i in 0..L {
                g[i][i] = 1.0;
                if i < N {
                    g[i][..N].copy_from_slice(&a[i]);
                    g[i][N..N + OWN].copy_from_slice(&b[i][..OWN]);
                    for k in 0..K {
                        let through = (0..N).map(|l| a[i][l] * effects.rates[l][k]).sum::<f64>();
                        g[i][J + k] = 0.5 * h * (through + effects.rates[i][k]);
                    }
                    self.z[i] = after[i];
                }
            }
            for i in 0..J {
                f[i].copy_from_slice(&g[i][..J]);
            }
            self.p = conjugate(&f, &self.p);
            self.all = conjugate(&g, &self.all);
            self.learning = conjugate(&g, &self.learning);
            self.apart = times(&g, &self.apart);
            for i in 0..N {
                self.learning[i][i] += self.settings.process_noise.variance_per_s[i] * h;
                let q = self.settings.process_noise.variance_per_s[i] * h;
                self.p[i][i] += q;
                self.all[i][i] += q;
            }
        }
    }

    fn correct(&mut self, y: [f64; R], input: [f64; 1]) {
        let z0 = self.z;
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        JET6.linearized_outputs(&self.state(), &self.parameters(), &input, &mut lin);
        let mut effects = ConstantEffects::<N, R, K>::ZERO;
        JET6.constant_effects(&self.state(), &self.parameters(), &input, &mut effects);
        for i in 0..R {
            if !y[i].is_finite() {
                continue;
            }
            let mut h = [0.0; J];
            h[..N].copy_from_slice(&lin.state_jacobian[i]);
            h[N..N + OWN].copy_from_slice(&lin.parameter_jacobian[i][..OWN]);
            h[N + OWN + i] = 1.0;
            let predicted = lin.outputs[i] + z0[N + OWN + i] + (0..J).map(|k| h[k] * (self.z[k] - z0[k])).sum::<f64>();
            let ph: [f64; J] = core::array::from_fn(|k| (0..J).map(|l| self.p[k][l] * h[l]).sum());
            let r = self.settings.noise_std[i].powi(2);
            let s = r + (0..J).map(|k| h[k] * ph[k]).sum::<f64>();
            let gain = ph.map(|value| value / s);
            let reach = self.kappa * s.sqrt();
            let innovation = (y[i] - predicted).clamp(-reach, reach);
            for k in 0..J {
                self.z[k] += gain[k] * innovation;
            }
            if innovation != y[i] - predicted {
                // The step does not depend on the size of the residual, nor then on the constants.
                continue;
            }
            // The filter that learns: its own gain, from where it is.
            let whole: [f64; L] = core::array::from_fn(|k| if k < J { h[k] } else { effects.outputs[i][k - J] });
            let ph = times(&self.learning, &whole);
            let s = r + (0..L).map(|k| whole[k] * ph[k]).sum::<f64>();
            let its = innovation - (0..L).map(|k| whole[k] * self.apart[k]).sum::<f64>();
            for k in 0..L {
                self.apart[k] += ph[k] / s * its - if k < J { gain[k] * innovation } else { 0.0 };
            }
            let f: Dense<L> =
                core::array::from_fn(|k| core::array::from_fn(|l| f64::from(u8::from(k == l)) - ph[k] / s * whole[l]));
            self.learning = conjugate(&f, &self.learning);
            for k in 0..L {
                for l in 0..L {
                    self.learning[k][l] += ph[k] * r * ph[l] / (s * s);
                }
            }
            // Joseph's form under the gain that ignores the constants.
            let (mut f, mut g) = ([[0.0; J]; J], [[0.0; L]; L]);
            for k in 0..L {
                g[k][k] = 1.0;
                if k < J {
                    for l in 0..L {
                        g[k][l] -= gain[k] * if l < J { h[l] } else { effects.outputs[i][l - J] };
                    }
                }
            }
            for k in 0..J {
                f[k].copy_from_slice(&g[k][..J]);
            }
            self.p = conjugate(&f, &self.p);
            self.all = conjugate(&g, &self.all);
            for k in 0..J {
                for l in 0..J {
                    self.p[k][l] += gain[k] * r * gain[l];
                    self.all[k][l] += gain[k] * r * gain[l];
                }
            }
        }
    }
}

/// Variances of the constants, of usual sizes: 3 %, 40 ms, 5 %, 3 %, 3 %.
const VARIANCES: [f64; K] = [9e-4, 1.6e-3, 2.5e-3, 9e-4, 9e-4];

/// Largest differences over the flight from the dense covariance: of the whole variances, relative, and of the
/// covariances of columns with constants, as correlations.
fn difference(
    mut estimator: impl Inspect<R, P, Input = [f64; 1]>,
    settings: EstimatorSettings<N, R, P>,
    kappa: f64,
    flight: &[Sample<[f64; 1], R>],
    restart_at: Option<usize>,
) -> [f64; 2] {
    let mut reference = Reference::new(settings, kappa, &VARIANCES, &flight[0]);
    let (mut whole, mut cross): (f64, f64) = (0.0, 0.0);
    let mut largest_part: f64 = 0.0;
    for (k, sample) in flight.iter().enumerate() {
        estimator.update(sample);
        if Some(k) == restart_at {
            reference.start_state(sample);
        } else if k > 0 {
            let before = &flight[k - 1];
            reference.predict(before, sample);
            let input = match settings.output_input {
                OutputInput::Current => sample.input,
                OutputInput::Previous => before.input,
            };
            reference.correct(sample.outputs, input);
        }
        if k == 0 {
            assert!(estimator.error_by_constant(0).is_none());
            continue;
        }
        let mut covariance = [[0.0; P]; P];
        estimator.covariance(&mut covariance);
        for j in 0..COLUMNS {
            let errors = estimator.error_by_constant(j).unwrap();
            assert_eq!(errors.len(), K);
            let part: f64 = errors.iter().zip(VARIANCES).map(|(error, variance)| error * error * variance).sum();
            let expected = reference.all[N + j][N + j];
            whole = whole.max(((covariance[j][j] + part) / expected - 1.0).abs());
            largest_part = largest_part.max(part / expected);
            for (k, (error, variance)) in errors.iter().zip(VARIANCES).enumerate() {
                let size = (expected * variance).sqrt();
                cross = cross.max((error * variance - reference.all[N + j][J + k]).abs() / size);
            }
        }
        assert!(estimator.error_by_constant(COLUMNS).is_none() && estimator.error_by_constant(P).is_none());
    }
    assert_eq!(estimator.restarts(), u32::from(restart_at.is_some()));
    // The constants matter: this is no comparison of zeros.
    assert!(largest_part > 0.5, "{largest_part}");
    [whole, cross]
}

#[test]
fn the_errors_of_constants_are_those_of_the_dense_covariance() {
    let flight = flight(&regular(1500, 0.01));
    let smpe = ConsideringSmpe::<_, N, R, P, K>::new(JET6, settings()).unwrap();
    let ekf = ConsideringEkf::<_, N, R, P, 8>::new(JET6, settings()).unwrap();
    let smpe = difference(smpe, settings(), f64::INFINITY, &flight, None);
    let ekf = difference(ekf, settings(), f64::INFINITY, &flight, None);
    println!("whole and cross: SMPE {smpe:?}, joint filter {ekf:?}");
    assert!(smpe.iter().chain(&ekf).all(|worst| *worst < 1e-10), "{smpe:?} {ekf:?}");
}

/// What the residuals say of lag and scale, applied to the estimate, is the filter that has both among its parameters: its estimate, its
/// covariance, and the constants themselves, at every sample. Parts of the constants add up to it, too.
fn from_the_filter_that_learns(
    mut estimator: impl Inspect<R, P, Input = [f64; 1]>,
    flight: &[Sample<[f64; 1], R>],
) -> f64 {
    let mut reference = Reference::new(settings(), f64::INFINITY, &VARIANCES, &flight[0]);
    let rule = LearningRule { most_left: f64::INFINITY, misfit: 1.0, farthest: f64::INFINITY, colour: false };
    let std = VARIANCES.map(f64::sqrt);
    let mut worst: f64 = 0.0;
    let mut least_left: f64 = 1.0;
    for (k, sample) in flight.iter().enumerate() {
        let estimate = estimator.update(sample);
        if k == 0 {
            assert!(estimator.evidence().is_none());
            continue;
        }
        reference.predict(&flight[k - 1], sample);
        reference.correct(sample.outputs, sample.input);
        let Some(learnt) = estimator.evidence().unwrap().learn(&std, &rule) else { continue };
        for (constant, value, left) in learnt.constants() {
            let expected = reference.learning[J + constant][J + constant].sqrt();
            worst = worst.max((left / expected - 1.0).abs());
            worst = worst.max((value - reference.apart[J + constant]).abs() / expected);
            least_left = least_left.min(left / std[constant]);
        }
        let mut covariance = [[0.0; P]; P];
        estimator.covariance(&mut covariance);
        for j in 0..COLUMNS {
            let errors = estimator.error_by_constant(j).unwrap();
            let column = learnt.column(errors);
            let of_declared: f64 = LEARNABLE
                .iter()
                .map(|constant| (learnt.error(&column, *constant, errors[*constant]) * std[*constant]).powi(2))
                .sum();
            let expected = reference.learning[N + j][N + j];
            worst = worst.max(((covariance[j][j] + column.variance + of_declared) / expected - 1.0).abs());
            let value = reference.z[N + j] + reference.apart[N + j];
            worst = worst.max((estimate.parameters[j] + column.shift - value).abs() / expected.sqrt());
        }
    }
    assert!(least_left < 0.5, "{least_left}");
    worst
}

#[test]
fn what_is_learnt_is_that_of_the_filter_that_learns() {
    let flight = flight(&regular(1500, 0.01));
    let smpe = from_the_filter_that_learns(ConsideringSmpe::<_, N, R, P, K>::new(JET6, settings()).unwrap(), &flight);
    let ekf = from_the_filter_that_learns(ConsideringEkf::<_, N, R, P, K>::new(JET6, settings()).unwrap(), &flight);
    println!("SMPE {smpe:e}, joint filter {ekf:e}");
    assert!(smpe < 1e-8 && ekf < 1e-8, "{smpe} {ekf}");
}

/// Jittering times that need sub-steps, an input that is interpolated and one that is held, and a state that is started
/// again while the parameters are kept.
#[test]
fn they_are_so_at_any_times_and_after_a_restart() {
    let mut rng = seeded(9);
    let mut times = vec![0.0];
    for k in 1..1400 {
        let step_s = match k {
            900 => 2.0,
            _ if k % 97 == 0 => 0.13,
            _ => 0.006 + 0.008 * rng.random::<f64>(),
        };
        times.push(times[k - 1] + step_s);
    }
    let mut flight = flight(&times);
    for i in 0..R {
        if flight[900].outputs[i].is_nan() {
            flight[900].outputs[i] = flight[901].outputs[i];
        }
    }
    for (input_hold, output_input) in
        [(InputHold::Zero, OutputInput::Current), (InputHold::Linear, OutputInput::Previous)]
    {
        let settings = EstimatorSettings { input_hold, output_input, ..settings() };
        let smpe = ConsideringSmpe::<_, N, R, P, K>::new(JET6, settings).unwrap();
        let ekf = ConsideringEkf::<_, N, R, P, K>::new(JET6, settings).unwrap();
        let smpe = difference(smpe, settings, f64::INFINITY, &flight, Some(900));
        let ekf = difference(ekf, settings, f64::INFINITY, &flight, Some(900));
        println!("{input_hold:?} {output_input:?}: SMPE {smpe:?}, joint filter {ekf:?}");
        assert!(smpe.iter().chain(&ekf).all(|worst| *worst < 1e-10), "{smpe:?} {ekf:?}");
    }
}

/// A row outside of the boundary layer moves the estimate by a step that the constants do not change.
#[test]
fn they_are_so_with_rows_that_reach() {
    let mut flight = flight(&regular(1500, 0.01));
    for (k, sample) in flight.iter_mut().enumerate().skip(5) {
        if k % 17 == 0 {
            sample.outputs[k % 3] += [5.0, 12.0][k % 2] * JET_NOISE[k % 3];
        }
    }
    let settings = EstimatorSettings { reaching_limit: 2.0, ..settings() };
    let smpe = ConsideringSmpe::<_, N, R, P, K>::new(JET6, settings).unwrap();
    let worst = difference(smpe, settings, 2.0, &flight, None);
    println!("whole and cross: {worst:?}");
    assert!(worst.iter().all(|worst| *worst < 1e-10), "{worst:?}");
}

/// The settings of the product, over everything that can happen to an estimate.
fn eventful() -> (EstimatorSettings<N, R, P>, Flight) {
    let mut settings = EstimatorSettings {
        reaching_limit: 3.0,
        rejection_limit: 8.0,
        ekf: EkfSettings { gate: 5.0, ..settings().ekf },
        change_detection: automatic().change_detection,
        start_window_s: 0.2,
        correct_first_sample: true,
        ..settings()
    };
    for prior in &mut settings.priors[..4] {
        prior.change_std = ChangePrior::Relative { fraction: 0.4, maximum: f64::INFINITY };
    }
    let mut times = regular(3000, 0.01);
    times[2600..].iter_mut().for_each(|t| *t += 5.0);
    let damaged = |t: f64| {
        let mut theta = truth();
        if t > 14.0 {
            theta[0] *= 0.4;
            theta[3] *= 0.5;
        }
        theta
    };
    let mut flight =
        fly(&JET6, &times, [0.01, 0.0], damaged, |t| [elevator_3211(t) + elevator_busy(t)], JET_NOISE, &mut seeded(3));
    for (k, sample) in flight.iter_mut().enumerate().skip(100) {
        if k % 61 == 0 {
            sample.outputs[k % 3] += 40.0 * JET_NOISE[k % 3];
        }
        if k % 50 == 7 {
            sample.outputs[k % 3] = f64::NAN;
        }
    }
    (settings, flight)
}

/// Bit for bit the estimate of the filter that considers nothing: start, outliers, gaps, a doubt, a challenger that is
/// adopted, a known change.
#[test]
fn the_estimate_is_the_same_bit_for_bit() {
    let (settings, flight) = eventful();
    let mut pairs: [[Box<dyn Inspect<R, P, Input = [f64; 1]>>; 2]; 2] = [
        [
            Box::new(Smpe::<_, N, R, P>::new(JET6, settings).unwrap()),
            Box::new(ConsideringSmpe::<_, N, R, P, 8>::new(JET6, settings).unwrap()),
        ],
        [
            Box::new(JointEkf::<_, N, R, P>::new(JET6, settings).unwrap()),
            Box::new(ConsideringEkf::<_, N, R, P, 8>::new(JET6, settings).unwrap()),
        ],
    ];
    for [plain, considering] in &mut pairs {
        let mut adopted = 0;
        for (k, sample) in flight.iter().enumerate() {
            if k == 2300 {
                assert!(plain.reopen_now() && considering.reopen_now());
            }
            let (a, b) = (plain.update(sample), considering.update(sample));
            adopted += u32::from(a.status.change == ChangeState::Adopted);
            assert_eq!(a.parameters.map(f64::to_bits), b.parameters.map(f64::to_bits), "{k}");
            assert_eq!(a.corrected_std_error.map(f64::to_bits), b.corrected_std_error.map(f64::to_bits), "{k}");
            assert_eq!((a.status, a.parameter_status), (b.status, b.parameter_status));
            assert!(plain.error_by_constant(0).is_none());
        }
        println!("{adopted} adoptions, {} restarts", plain.restarts());
        assert!(adopted >= 2 && plain.restarts() == 1);
        for j in 0..COLUMNS {
            assert!(considering.error_by_constant(j).unwrap().iter().all(|error| error.is_finite()));
        }
    }
}

/// A challenger that is adopted brings the errors of its own course: after all of it they are those that flights with
/// wrong constants show.
#[test]
fn after_a_change_the_errors_are_those_that_wrong_constants_make() {
    let (settings, flight) = eventful();
    compare_with_reruns(settings, &flight, 0.3);
}

#[test]
fn the_errors_are_those_that_wrong_constants_make() {
    let flight = flight(&regular(2000, 0.01));
    compare_with_reruns(settings(), &flight, 0.1);
}

/// Runs the flight again with each constant but the lag (which would make the noise late as well) a little wrong, both ways, in the records and not in the filter's
/// covariances. `limit`: largest difference per sigma of the constant, in standard errors of the column. It is not zero
/// because another value of the constant moves the points at which the filter linearises as well; the noise of the
/// flight decides how far.
fn compare_with_reruns(settings: EstimatorSettings<N, R, P>, flight: &[Sample<[f64; 1], R>], limit: f64) {
    let run = |model: Uncertain, flight: &[Sample<[f64; 1], R>]| {
        let mut estimator = ConsideringSmpe::<_, N, R, P, K>::new(model, settings).unwrap();
        let mut last = None;
        for sample in flight {
            last = Some(estimator.update(sample));
        }
        let errors: Vec<Vec<f64>> = (0..COLUMNS).map(|j| estimator.error_by_constant(j).unwrap().to_vec()).collect();
        (last.unwrap(), errors)
    };
    let (end, errors) = run(JET6, flight);
    let jet = JET6.0;
    // The recorded value, or what the model takes for true, for a constant of `c`.
    let with = |constant: usize, c: f64| {
        let mut shifted = flight.to_vec();
        let mut model = jet;
        match constant {
            0 => shifted.iter_mut().for_each(|s| s.outputs[0] *= 1.0 + c),
            2 => model.moment_acceleration *= 1.0 + c,
            3 => model.lift_acceleration *= 1.0 + c,
            _ => shifted.iter_mut().for_each(|s| s.input[0] *= 1.0 + c),
        }
        run(Uncertain(model), &shifted).0
    };
    for k in [0, 2, 3, 4] {
        let c = 1e-4;
        let (up, down) = (with(k, c), with(k, -c));
        for j in 0..COLUMNS {
            // error = true - estimated
            let shown = -(up.parameters[j] - down.parameters[j]) / (2.0 * c);
            let difference = (errors[j][k] - shown).abs() * VARIANCES[k].sqrt() / end.std_error[j];
            println!("constant {k} column {j}: {:.4} and {shown:.4}, difference {difference:.3} sigma", errors[j][k]);
            assert!(difference < limit, "constant {k} column {j}");
        }
    }
}

#[test]
fn more_constants_than_room_are_refused() {
    let error = ConsideringSmpe::<_, N, R, P, 4>::new(JET6, settings()).err().unwrap();
    assert_eq!(error, SettingsError::Constants { needed: 5, capacity: 4 });
    assert!(error.to_string().contains("wants 5 constants considered, this estimator has room for 4"));
    // The plain filter takes the model as it is.
    assert!(Smpe::<_, N, R, P>::new(JET6, settings()).is_ok());
}
