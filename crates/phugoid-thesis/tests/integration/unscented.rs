//! Does an unscented filter earn a place beside the extended one? Written here from the textbook (S. Julier and J. Uhlmann, 2004;
//! scaled sigma points; additive noise) for any model, dense, and compared with the product's joint extended filter on the same
//! samples with the same priors. docs/methods.md quotes what this prints.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate};
use phugoid_estimators::ekf::JointEkf;
use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::{Estimator, LinearizedOutputs, Model, Sample};
use phugoid_evaluation::published::{CALM_MODEL, CALM_SCENARIO};
use phugoid_identification::axes::Axes;
use phugoid_identification::longitudinal::{LongitudinalModel, OUTPUTS, STATES};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::prepare::prepare;
use phugoid_simulation::flight::{fly, sense};
use phugoid_simulation::scenario::Scenario;
use phugoid_thesis::plants::{FirstOrder, SecondOrderNonlinear};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

const RUNS: u64 = 40;

/// Room for parameters: no model here has more than four.
const ROOM: usize = 4;

/// Spread of the sigma points, `n (alpha^2 - 1)` with `kappa = 0`: the points lie `alpha sqrt(n)` standard deviations out.
const ALPHA: f64 = 0.5;
/// Best for a normal distribution.
const BETA: f64 = 2.0;

/// Replaces the states of a model by those after an interval of this length, s.
type Propagate<'a, I> = &'a dyn Fn(&mut [f64], &IntervalInput<I>, f64);

/// What the filter knows of a model. States and parameters come in one vector, states first.
struct Plant<'a, I> {
    propagate: Propagate<'a, I>,
    /// The outputs at an instant.
    outputs: &'a dyn Fn(&[f64], &I) -> Vec<f64>,
}

/// The filter: mean and covariance of states and parameters in one vector.
struct Unscented<I> {
    z: Vec<f64>,
    p: Vec<Vec<f64>>,
    /// Variance per second that is added to each state.
    process: Vec<f64>,
    noise_std: Vec<f64>,
    hold: InputHold,
    before: (f64, I),
}

/// Lower Cholesky factor.
fn cholesky(a: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j { sum.max(1e-300).sqrt() } else { sum / l[j][j] };
        }
    }
    l
}

impl<I: Copy> Unscented<I> {
    /// The sigma points with the weights of mean and covariance.
    fn points(&self) -> Vec<(Vec<f64>, f64, f64)> {
        let n = self.z.len();
        let spread = ALPHA * ALPHA * n as f64;
        let lambda = spread - n as f64;
        let l = cholesky(&self.p);
        let mut points = vec![(self.z.clone(), lambda / spread, lambda / spread + 1.0 - ALPHA * ALPHA + BETA)];
        for j in 0..n {
            for sign in [1.0, -1.0] {
                let point = (0..n).map(|i| self.z[i] + sign * spread.sqrt() * l[i][j]).collect();
                points.push((point, 0.5 / spread, 0.5 / spread));
            }
        }
        points
    }

    fn update<const R: usize>(&mut self, plant: &Plant<'_, I>, sample: &Sample<I, R>) {
        let n = self.z.len();
        let input = IntervalInput { from: self.before.1, to: sample.input, hold: self.hold };
        let interval_s = sample.time_s - self.before.0;
        let mut points = self.points();
        for (point, ..) in &mut points {
            (plant.propagate)(point, &input, interval_s);
        }
        let mean = |values: &dyn Fn(&[f64]) -> f64| points.iter().map(|(z, w, _)| w * values(z)).sum::<f64>();
        self.z = (0..n).map(|i| mean(&|z| z[i])).collect();
        for i in 0..n {
            for j in 0..n {
                self.p[i][j] = points.iter().map(|(z, _, w)| w * (z[i] - self.z[i]) * (z[j] - self.z[j])).sum();
            }
        }
        for (k, variance_per_s) in self.process.iter().enumerate() {
            self.p[k][k] += variance_per_s * interval_s;
        }
        self.before = (sample.time_s, sample.input);

        let points = self.points();
        let outputs: Vec<Vec<f64>> = points.iter().map(|(z, ..)| (plant.outputs)(z, &sample.input)).collect();
        let mut y: [f64; R] = std::array::from_fn(|i| points.iter().zip(&outputs).map(|((_, w, _), y)| w * y[i]).sum());
        let covariance = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| -> f64 {
            (0..points.len()).map(|k| points[k].2 * a(k) * b(k)).sum()
        };
        let mut cross: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..R).map(|j| covariance(&|k| points[k].0[i] - self.z[i], &|k| outputs[k][j] - y[j])).collect())
            .collect();
        let mut yy: Vec<Vec<f64>> = (0..R)
            .map(|i| (0..R).map(|j| covariance(&|k| outputs[k][i] - y[i], &|k| outputs[k][j] - y[j])).collect())
            .collect();
        // Conditioning on one output after the other is conditioning on all.
        for i in 0..R {
            let sigma = self.noise_std[i];
            if !(sample.outputs[i].is_finite() && sigma.is_finite() && sigma > 0.0) {
                continue;
            }
            let s = yy[i][i] + sigma * sigma;
            let innovation = sample.outputs[i] - y[i];
            let (z_i, y_i): (Vec<f64>, Vec<f64>) = (cross.iter().map(|row| row[i]).collect(), yy[i].clone());
            for k in 0..n {
                self.z[k] += z_i[k] / s * innovation;
                for l in 0..n {
                    self.p[k][l] -= z_i[k] * z_i[l] / s;
                }
                for j in 0..R {
                    cross[k][j] -= z_i[k] * y_i[j] / s;
                }
            }
            for k in 0..R {
                y[k] += y_i[k] / s * innovation;
                for l in 0..R {
                    yy[k][l] -= y_i[k] * y_i[l] / s;
                }
            }
        }
    }
}

/// Errors over flights at some times: root mean square over the true value's size, and the part within two sigma.
#[derive(Default)]
struct Score {
    squares: f64,
    inside: f64,
    count: f64,
}

impl Score {
    fn add(&mut self, value: f64, std: f64, truth: f64) {
        let error = value - truth;
        self.squares += if error.is_finite() { (error / truth).powi(2) } else { 1e6 };
        self.inside += f64::from(error.abs() < 2.0 * std);
        self.count += 1.0;
    }

    fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }

    fn coverage(&self) -> f64 {
        self.inside / self.count
    }
}

/// Runs both filters over the flights; prints and gives `[EKF, UKF]` by checkpoint.
fn contest<M, const N: usize, const R: usize>(
    what: &str,
    model: &M,
    settings: EstimatorSettings<N, R, ROOM>,
    truth: &[f64],
    at_s: &[f64],
    flight: impl Fn(u64) -> Vec<Sample<M::Input, R>>,
) -> Vec<[Score; 2]>
where
    M: Model<N, R, ROOM> + Clone,
{
    let mut plain = settings;
    plain.start_window_s = 0.0;
    plain.correct_first_sample = false;
    plain.clip_factor = f64::INFINITY;
    plain.change_detection = None;
    let mut open = plain;
    open.ekf.gate = f64::INFINITY;
    let mut scores: Vec<[Score; 2]> = at_s.iter().map(|_| Default::default()).collect();
    let mut seconds = [0.0; 2];
    let split = |z: &[f64]| -> ([f64; N], [f64; ROOM]) {
        (std::array::from_fn(|k| z[k]), std::array::from_fn(|j| z.get(N + j).copied().unwrap_or(0.0)))
    };
    let plant = Plant {
        propagate: &|z, input, interval_s| {
            let (x, theta) = split(z);
            z[..N].copy_from_slice(&simulate(model, &x, &theta, input, interval_s, plain.maximum_step_s));
        },
        outputs: &|z, input| {
            let (x, theta) = split(z);
            let mut lin = LinearizedOutputs::<N, R, ROOM>::ZERO;
            model.linearized_outputs(&x, &theta, input, &mut lin);
            lin.outputs.to_vec()
        },
    };
    // Starts from the first sample, as the extended filter does with a start window of length zero.
    let start = |first: &Sample<M::Input, R>| {
        let measuring: Vec<usize> = (0..N).map(|k| model.measuring_output(k).unwrap()).collect();
        let priors = &plain.priors[..model.parameter_count()];
        let states = measuring.iter().map(|&output| [first.outputs[output], plain.noise_std[output]]);
        let start: Vec<[f64; 2]> = states.chain(priors.iter().map(|prior| [prior.initial, prior.std])).collect();
        let variance = |i: usize, j: usize| if i == j { start[i][1].powi(2) } else { 0.0 };
        Unscented {
            z: start.iter().map(|[value, _]| *value).collect(),
            p: (0..start.len()).map(|i| (0..start.len()).map(|j| variance(i, j)).collect()).collect(),
            process: plain.process_noise.variance_per_s.to_vec(),
            noise_std: plain.noise_std.to_vec(),
            hold: plain.input_hold,
            before: (first.time_s, first.input),
        }
    };
    for seed in 0..RUNS {
        let samples = flight(seed);
        let mut ekf: JointEkf<M, N, R, ROOM> = JointEkf::new(model.clone(), open).unwrap();
        let mut ukf = start(&samples[0]);
        let mut next = 0;
        for (k, sample) in samples.iter().enumerate() {
            let start = std::time::Instant::now();
            let estimate = ekf.update(sample);
            seconds[0] += start.elapsed().as_secs_f64();
            if k > 0 {
                let start = std::time::Instant::now();
                ukf.update(&plant, sample);
                seconds[1] += start.elapsed().as_secs_f64();
            }
            if next < at_s.len() && sample.time_s >= at_s[next] - 1e-9 {
                for (j, truth) in truth.iter().enumerate() {
                    scores[next][0].add(estimate.parameters[j], estimate.std_error[j], *truth);
                    scores[next][1].add(ukf.z[N + j], ukf.p[N + j][N + j].sqrt(), *truth);
                }
                next += 1;
            }
        }
    }
    for (at, [ekf, ukf]) in at_s.iter().zip(&scores) {
        println!(
            "{what:32} {at:5.1} s: rms error EKF {:8.4} UKF {:8.4} (ratio {:.3}); 2-sigma coverage {:.3} {:.3}",
            ekf.rms(),
            ukf.rms(),
            ukf.rms() / ekf.rms(),
            ekf.coverage(),
            ukf.coverage()
        );
    }
    println!("{what:32} time per update UKF/EKF {:.1} (dense and unoptimised)", seconds[1] / seconds[0]);
    scores
}

/// A plant of the thesis with its true parameters, zero where it has none, its input a square wave, its states measured.
fn fly_plant<M, const N: usize, const R: usize>(
    model: &M,
    truth: [f64; ROOM],
    noise_std: [f64; R],
    seed: u64,
) -> Vec<Sample<[f64; 1], R>>
where
    M: Model<N, R, ROOM, Input = [f64; 1]>,
{
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let input = |t: f64| [if (t * 0.7).fract() < 0.5 { 1.0 } else { 0.2 }];
    let mut x = [0.3; N];
    (0..500)
        .map(|k| {
            let t = 0.01 * f64::from(k);
            if k > 0 {
                let held = IntervalInput { from: input(t - 0.01), to: input(t), hold: InputHold::Zero };
                x = simulate(model, &x, &truth, &held, 0.01, 0.005);
            }
            let outputs = std::array::from_fn(|i| {
                let noise: f64 = StandardNormal.sample(&mut rng);
                if i < N { x[i] + noise_std[i] * noise } else { f64::NAN }
            });
            Sample { time_s: t, input: input(t), outputs }
        })
        .collect()
}

#[test]
fn on_an_aircraft_an_unscented_filter_gains_little_and_only_early() {
    let scenario = Scenario::parse(CALM_SCENARIO, "f16-calm").unwrap();
    let file = ModelFile::parse("f16-model", CALM_MODEL).unwrap();
    let flight = fly(&scenario).unwrap();
    let prepared = prepare::<LongitudinalModel, _, _>(&flight.truth, &file).unwrap();
    let names: Vec<&str> = file.estimated().map(|p| p.name.as_str()).collect();
    let truth: Vec<f64> = names.iter().map(|name| flight.true_parameters[*name]).collect();
    let outputs = Axes::Longitudinal.outputs();
    let noise: [f64; OUTPUTS] = std::array::from_fn(|row| {
        let output = outputs[row].index();
        if file.outputs[output] { file.noise[output].unwrap() } else { f64::NAN }
    });
    let samples = |seed: u64| {
        let measured = sense(&flight.truth, &scenario, scenario.seed + seed).unwrap();
        let prepared = prepare::<LongitudinalModel, _, _>(&measured, &file).unwrap();
        (0..prepared.time.len())
            .map(|k| Sample { time_s: prepared.time[k], input: prepared.inputs[k], outputs: prepared.outputs[k] })
            .collect::<Vec<_>>()
    };
    // Allowed gain from one cycle (4.7 s) on: with the priors of the model file none beyond the scatter of the ratio of two nearly equal
    // filters; with priors of ten times the bounds, which no model file has, a tenth.
    for (what, factor, gain) in [("F-16 calm, p = 4", 1.0, 0.02), ("F-16 calm, prior ten times as wide", 10.0, 0.1)] {
        let priors: Vec<ParameterPrior> = file
            .estimated()
            .map(|p| {
                let [low, high] = p.bounds.unwrap();
                ParameterPrior::bounded(0.0, factor * low, factor * high)
            })
            .collect();
        let mut settings = EstimatorSettings::<STATES, OUTPUTS, ROOM>::automatic(&priors, noise, 0.01).unwrap();
        settings.input_hold = InputHold::Linear;
        let scores = contest(what, &prepared.model, settings, &truth, &[1.5, 2.5, 4.7, 20.0], samples);
        for [ekf, ukf] in &scores[2..] {
            assert!((ukf.rms() / ekf.rms() - 1.0).abs() < gain, "{} {}", ukf.rms(), ekf.rms());
        }
    }
}

/// Where the plant itself is nonlinear and little is known: the thesis's quadratic spring and first-order lag, priors of several
/// times the truth, coarse and fine sensors.
#[test]
fn an_unscented_filter_with_wide_priors() {
    for (what, noise) in [("coarse", 0.1), ("fine", 0.001)] {
        let wide = ParameterPrior::absolute(20.0, 20.0);
        let lag = EstimatorSettings::<1, 2, ROOM>::automatic(&[wide], [noise, 0.0], 0.01).unwrap();
        let of_lag =
            contest(&format!("x' = -a x + u, wide, {what}"), &FirstOrder, lag, &[3.0], &[0.2, 0.5, 1.0, 4.9], |seed| {
                fly_plant(&FirstOrder, [3.0, 0.0, 0.0, 0.0], [noise, 0.0], seed)
            });
        let spring = EstimatorSettings::<2, 3, ROOM>::automatic(
            &[wide, ParameterPrior::absolute(5.0, 5.0)],
            [noise, noise, 0.0],
            0.01,
        )
        .unwrap();
        let of_spring = contest(
            &format!("quadratic spring, wide, {what}"),
            &SecondOrderNonlinear,
            spring,
            &[4.0, 2.0],
            &[0.2, 0.5, 1.0, 4.9],
            |seed| fly_plant(&SecondOrderNonlinear, [4.0, 2.0, 0.0, 0.0], [noise, noise, 0.0], seed),
        );
        for scores in [of_lag, of_spring] {
            let [ekf, ukf] = &scores[3];
            assert!(ekf.rms().is_finite() && ukf.rms().is_finite());
        }
    }
}
