//! The batch methods on a short-period motion whose truth is known: exact recovery, information, damping, colour, and what
//! they say when they cannot.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::Normal;
use common::short_period::{NAMES, ShortPeriod};
use phugoid_estimators::Model;
use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate};
use phugoid_identification::batch::{
    BatchError, BatchFit, BatchParameter, Bias, EquationErrorSettings, Flown, InitialState, Manoeuvre, Noise,
    OptimiserSettings, OutputChannel, ProcessNoise, Structure, Unknown, WithInputs, by_surfaces, equation_error,
    filter_error, output_error, predict,
};
use phugoid_identification::options::Likelihood;

/// Stable: short period of 6.2 rad/s, damping 0.41.
pub(crate) const STABLE: [f64; 6] = [-1.4, -1.5, -6.3, -0.75, -3.7, -12.8];
pub(crate) const SD: [f64; 3] = [0.1, 0.005, 0.2];
pub(crate) const STEP_S: f64 = 0.02;

pub(crate) struct Data {
    pub(crate) time: Vec<f64>,
    pub(crate) inputs: Vec<[f64; 1]>,
    pub(crate) outputs: Vec<[f64; 3]>,
}

/// The elevator of a doublet that starts at `delay_s`, rad.
fn doublet(t: f64, delay_s: f64) -> f64 {
    match t - delay_s {
        s if s < 0.0 => 0.0,
        s if s < 0.6 => 0.02,
        s if s < 1.2 => -0.02,
        _ => 0.0,
    }
}

/// A flight of `samples` with a doublet that starts at `delay_s`; `noise` gives the error of each output in turn.
pub(crate) fn fly(samples: usize, delay_s: f64, noise: impl FnMut(usize) -> f64) -> Data {
    fly_in_turning_air(samples, |t| doublet(t, delay_s), || 0.0, noise)
}

/// A flight of `samples`; `gust` gives the elevator (rad) that would move the aircraft as the air does, sample by sample, which nobody records.
fn fly_in_turning_air(
    samples: usize,
    elevator: impl Fn(f64) -> f64,
    mut gust: impl FnMut() -> f64,
    mut noise: impl FnMut(usize) -> f64,
) -> Data {
    let time: Vec<f64> = (0..samples).map(|k| STEP_S * k as f64).collect();
    let inputs: Vec<[f64; 1]> = time.iter().map(|t| [elevator(*t)]).collect();
    let mut x = [0.4, -0.01];
    let mut outputs = Vec::new();
    for recorded in &inputs {
        let acting = [recorded[0] + gust()];
        let mut lin = phugoid_estimators::LinearizedOutputs::ZERO;
        ShortPeriod.linearized_outputs(&x, &STABLE, &acting, &mut lin);
        outputs.push(std::array::from_fn(|i| lin.outputs[i] + noise(i)));
        let input = IntervalInput { from: acting, to: acting, hold: InputHold::Zero };
        x = simulate(&ShortPeriod, &x, &STABLE, &input, STEP_S, 1.0);
    }
    Data { time, inputs, outputs }
}

pub(crate) fn white(seed: u64) -> impl FnMut(usize) -> f64 {
    let mut normal = Normal::new(seed);
    move |i| SD[i] * normal.next()
}

/// A model with its inputs, for as long as the test runs.
pub(crate) fn flown<'a, M, I, const N: usize, const R: usize>(model: &'a M, inputs: &'a [I]) -> &'a dyn Flown<N, R>
where
    WithInputs<'a, M, I>: Flown<N, R>,
{
    Box::leak(Box::new(WithInputs { model, inputs }))
}

pub(crate) fn manoeuvre<'a>(name: &'a str, data: &'a Data) -> Manoeuvre<'a, 2, 3> {
    Manoeuvre {
        name,
        plant: flown(&ShortPeriod, &data.inputs),
        first: 0,
        time_s: &data.time,
        hold: InputHold::Zero,
        outputs: &data.outputs,
        initial_state: None,
    }
}

pub(crate) fn structure(start: [f64; 6], noise: impl Fn(usize) -> Noise) -> Structure<2, 3> {
    let outputs = ["w", "q", "az"];
    Structure {
        parameters: NAMES.iter().zip(start).map(|(name, value)| BatchParameter::free(*name, value)).collect(),
        states: ["w", "q"].map(InitialState::free),
        outputs: std::array::from_fn(|i| OutputChannel::new(outputs[i], noise(i))),
        maximum_step_s: 1.0,
        maximum_gap_s: f64::INFINITY,
        likelihood: Likelihood::Gaussian,
    }
}

pub(crate) fn known(i: usize) -> Noise {
    Noise::Known(SD[i])
}

type Flights<'a> = [Manoeuvre<'a, 2, 3>];

fn fit(manoeuvres: &Flights<'_>, structure: &Structure<2, 3>) -> Result<BatchFit, BatchError> {
    output_error::<2, 3>(manoeuvres, structure, &OptimiserSettings::default())
}

#[test]
fn output_error_recovers_exact_data_exactly() {
    let mut data = fly(300, 0.5, |_| 0.0);
    // A constant error, a lost frame and a lost value.
    data.outputs.iter_mut().for_each(|y| y[2] += 0.3);
    data.outputs[40] = [f64::NAN; 3];
    data.outputs[70][1] = f64::NAN;
    let mut structure = structure(STABLE.map(|v| 0.7 * v), known);
    structure.outputs[2].bias = Bias::Shared(f64::INFINITY);
    let settings = OptimiserSettings { step_tolerance: 1e-9, ..OptimiserSettings::default() };
    let found = output_error::<2, 3>(&[manoeuvre("exact", &data)], &structure, &settings).unwrap();
    for (j, truth) in STABLE.iter().enumerate() {
        assert!((found.parameters[j] / truth - 1.0).abs() < 1e-8, "{}: {}", NAMES[j], found.parameters[j]);
    }
    assert!((found.unknown("bias of az").unwrap().value - 0.3).abs() < 1e-8);
    assert!((found.unknown("initial w").unwrap().value - 0.4).abs() < 1e-8);
    assert!((found.manoeuvres[0].biases[2] - 0.3).abs() < 1e-8);
}

/// A part of a flight from its beginning on needs no inputs that end where it does: equation error beside a filter solves a flight in parts.
#[test]
fn a_part_from_the_beginning_is_a_flight_that_ends_there() {
    let whole = fly(300, 0.5, white(3));
    let cut = Data {
        time: whole.time[..200].to_vec(),
        inputs: whole.inputs[..200].to_vec(),
        outputs: whole.outputs[..200].to_vec(),
    };
    let part = Manoeuvre { time_s: &whole.time[..200], outputs: &whole.outputs[..200], ..manoeuvre("part", &whole) };
    let structure = structure(STABLE.map(|v| 0.7 * v), |_| Noise::Estimated);
    let settings = EquationErrorSettings::automatic(STEP_S);
    let of = |m: Manoeuvre<'_, 2, 3>| equation_error(&[m], &structure, &settings).unwrap().fit.parameters;
    assert_eq!(of(part), of(manoeuvre("cut", &cut)));
}

/// Independent data: the information of all together is the sum of the single ones, so that the variance of each
/// parameter is below that of every single one; by the sum exactly, for initial states are each manoeuvre's own.
#[test]
fn several_manoeuvres_add_their_information() {
    let flights = [fly(300, 0.5, white(1)), fly(200, 1.0, white(2))];
    let structure = structure(STABLE, known);
    let single = |name: &'static str, data: &Data| {
        // At the same point: no step, so that linearisations agree.
        let settings = OptimiserSettings { step_tolerance: 1e9, ..OptimiserSettings::default() };
        let states = Some([0.4, -0.01]);
        let m = Manoeuvre { initial_state: states, ..manoeuvre(name, data) };
        (output_error::<2, 3>(&[m], &structure, &settings).unwrap(), m.initial_state)
    };
    let settings = OptimiserSettings { step_tolerance: 1e9, ..OptimiserSettings::default() };
    let both: Vec<_> = ["a", "b"]
        .iter()
        .zip(&flights)
        .map(|(name, data)| Manoeuvre { initial_state: Some([0.4, -0.01]), ..manoeuvre(name, data) })
        .collect();
    let all = output_error::<2, 3>(&both, &structure, &settings).unwrap();
    let parts = [single("a", &flights[0]).0, single("b", &flights[1]).0];
    let inverse = |fit: &BatchFit| {
        nalgebra::DMatrix::from_fn(6, 6, |i, j| fit.covariance[i][j]).try_inverse().expect("a covariance")
    };
    let sum = inverse(&parts[0]) + inverse(&parts[1]);
    let difference = (inverse(&all) - &sum).norm() / sum.norm();
    assert!(difference < 1e-7, "{difference}");
    for (j, unknown) in all.unknowns.iter().take(6).enumerate() {
        assert!(parts.iter().all(|p| unknown.std_error < p.unknowns[j].std_error), "{}", unknown.name);
    }
    assert!(all.unknown("initial w in b").is_some());
}

/// From some of these the pure Gauss-Newton step makes things worse: damping is used, and leads to the same minimum.
#[test]
fn damping_rescues_a_bad_start() {
    let data = fly(400, 0.5, white(3));
    let good = fit(&[manoeuvre("good", &data)], &structure(STABLE, known)).unwrap();
    let mut damped = 0;
    for bad in
        [[-0.5, 0.0, 0.0, 0.0, -1.0, -4.0], [-3.0, 5.0, 10.0, -2.0, -8.0, -30.0], [-1.0, 0.0, -5.0, 0.1, -2.0, -10.0]]
    {
        let rescued = fit(&[manoeuvre("bad", &data)], &structure(bad, known)).unwrap();
        println!("{bad:?}: {:?}", rescued.iterations);
        damped += rescued.iterations.iter().filter(|i| i.damping > 0.0).count();
        assert!(rescued.iterations.windows(2).all(|i| i[1].cost < i[0].cost), "every accepted step lowers the cost");
        for (a, b) in good.unknowns.iter().zip(&rescued.unknowns) {
            assert!((a.value - b.value).abs() < 5e-3 * a.std_error, "{}: {} {}", a.name, a.value, b.value);
        }
    }
    assert!(damped > 0, "a pure Gauss-Newton step would have done everywhere");
}

#[test]
fn estimated_noise_is_the_noise_there_is() {
    let data = fly(2000, 0.5, white(4));
    let found = fit(&[manoeuvre("noise", &data)], &structure(STABLE.map(|v| 0.8 * v), |_| Noise::Estimated)).unwrap();
    for (estimated, truth) in found.noise_std.iter().zip(SD) {
        // Four standard errors, 1/sqrt(2 n) each.
        assert!((estimated / truth - 1.0).abs() < 4.0 / (2.0 * 2000.0_f64).sqrt(), "{estimated} {truth}");
    }
    assert!(found.manoeuvres[0].outputs.iter().all(|o| o.white && o.lag_one.abs() < 0.1));
}

/// Residuals with a correlation time of 0.2 s (ten samples): the inverse of the information claims far too much, the
/// corrected errors hold. 200 runs.
#[test]
fn corrected_errors_hold_where_residuals_are_coloured() {
    const RUNS: usize = 200;
    let structure = structure(STABLE, |_| Noise::Estimated);
    let (mut claimed, mut corrected) = ([0; 6], [0; 6]);
    for run in 0..RUNS {
        let mut normal = Normal::new(1000 + run as u64);
        let (decay, mut state) = ((-0.1_f64).exp(), [0.0; 3]);
        let start: [f64; 3] = std::array::from_fn(|_| normal.next());
        state.copy_from_slice(&start);
        let colour = move |i: usize| {
            state[i] = decay * state[i] + (1.0 - decay * decay).sqrt() * normal.next();
            SD[i] * state[i]
        };
        let data = fly(600, 0.5, colour);
        let found = fit(&[manoeuvre("coloured", &data)], &structure).unwrap();
        for (j, unknown) in found.unknowns.iter().take(6).enumerate() {
            let error = (unknown.value - STABLE[j]).abs();
            claimed[j] += usize::from(error <= 2.0 * unknown.std_error);
            corrected[j] += usize::from(error <= 2.0 * unknown.corrected_std_error);
        }
    }
    println!("of {RUNS}: claimed {claimed:?}, corrected {corrected:?}");
    for j in 0..6 {
        assert!(claimed[j] < RUNS * 7 / 10, "{}: {}", NAMES[j], claimed[j]);
        assert!(corrected[j] >= RUNS * 17 / 20, "{}: {}", NAMES[j], corrected[j]);
    }
}

/// A gust that turns the air moves the aircraft and goes on while it moves (correlation time 0.5 s, as much as 0.2 degrees of elevator beside
/// doublets of 1.1): equation error takes what it leaves over for independent of the motion, and claims too little. What the
/// surfaces made of the motion knows nothing of it, and its bounds hold. 100 flights of 30 s.
#[test]
fn what_the_surfaces_made_is_not_bent_by_gusts_that_last() {
    const RUNS: usize = 100;
    let structure = structure(STABLE, |_| Noise::Estimated);
    let settings = EquationErrorSettings::automatic(STEP_S);
    let (mut held, mut held_by_surfaces) = ([0; 6], [0; 6]);
    for run in 0..RUNS {
        let mut normal = Normal::new(4000 + run as u64);
        let decay = (-STEP_S / 0.5_f64).exp();
        let mut state = normal.next();
        let gust = || {
            state = decay * state + (1.0 - decay * decay).sqrt() * normal.next();
            0.0035 * state
        };
        let elevator = |t: f64| doublet(t % 5.0, 0.5);
        let data = fly_in_turning_air(1500, elevator, gust, white(8000 + run as u64));
        let flight = [manoeuvre("gusts", &data)];
        let found = equation_error(&flight, &structure, &settings).unwrap().fit;
        let recorded: Vec<f64> = data.inputs.iter().map(|u| u[0]).collect();
        let again = by_surfaces(&flight, &[vec![&recorded]], &structure, &settings, &found).unwrap();
        for j in 0..6 {
            let holds = |u: &Unknown| usize::from((u.value - STABLE[j]).abs() <= 2.0 * u.corrected_std_error);
            held[j] += holds(&found.unknowns[j]);
            held_by_surfaces[j] += holds(&again[j]);
        }
    }
    println!("of {RUNS}: equation error {held:?}, by the surfaces {held_by_surfaces:?}");
    assert!(held_by_surfaces.iter().all(|n| *n >= RUNS * 17 / 20), "{held_by_surfaces:?}");
    // The derivatives of the pitching moment: M_w, M_q, M_elevator.
    assert!(held.iter().min().is_some_and(|n| *n < RUNS / 2), "{held:?}");
}

/// Without a motion of its own a surface tells nothing, and that is said.
#[test]
fn surfaces_that_rest_tell_no_parameters_apart() {
    let data = fly(300, 0.5, white(9));
    let flight = [manoeuvre("still", &data)];
    let structure = structure(STABLE, |_| Noise::Estimated);
    let settings = EquationErrorSettings::automatic(STEP_S);
    let found = equation_error(&flight, &structure, &settings).unwrap().fit;
    let still = vec![0.0; 300];
    let error = by_surfaces(&flight, &[vec![&still]], &structure, &settings, &found).unwrap_err();
    assert!(matches!(error, BatchError::Singular { .. }), "{error}");
    let broken = vec![f64::NAN; 300];
    assert!(by_surfaces(&flight, &[vec![&broken]], &structure, &settings, &found).is_err());
}

#[test]
fn a_prediction_holds_the_parameters() {
    let (flown, other) = (fly(400, 0.5, white(5)), fly(300, 1.5, white(6)));
    let structure = structure(STABLE.map(|v| 0.8 * v), known);
    let found = fit(&[manoeuvre("flown", &flown)], &structure).unwrap();
    let settings = OptimiserSettings::default();
    let predicted = predict::<2, 3>(&[manoeuvre("other", &other)], &structure, &found.parameters, &settings).unwrap();
    assert_eq!(predicted.parameters, found.parameters);
    assert_eq!(predicted.unknowns.len(), 2, "the initial state only");
    assert!(predicted.manoeuvres[0].outputs.iter().all(|o| o.white), "{:?}", predicted.manoeuvres[0].outputs);
    let wrong: Vec<f64> = found.parameters.iter().map(|v| 0.6 * v).collect();
    let poor = predict::<2, 3>(&[manoeuvre("other", &other)], &structure, &wrong, &settings).unwrap();
    let pairs = || predicted.manoeuvres[0].outputs.iter().zip(&poor.manoeuvres[0].outputs);
    assert!(pairs().all(|(good, bad)| bad.theil > good.theil && bad.r_squared < good.r_squared), "{poor:?}");
    assert!(pairs().any(|(good, bad)| bad.theil > 1.5 * good.theil), "{poor:?}");
}

/// Sixty seconds in which white noise moves the states too, `density` in squared units per second.
fn fly_in_gusts(density: [f64; 2], seed: u64) -> Data {
    let mut normal = Normal::new(seed);
    let mut data = fly(3000, 0.5, |_| 0.0);
    let mut x = [0.4, -0.01];
    for k in 0..data.time.len() {
        let mut lin = phugoid_estimators::LinearizedOutputs::ZERO;
        ShortPeriod.linearized_outputs(&x, &STABLE, &data.inputs[k], &mut lin);
        data.outputs[k] = std::array::from_fn(|i| lin.outputs[i] + SD[i] * normal.next());
        let input = IntervalInput { from: data.inputs[k], to: data.inputs[k], hold: InputHold::Zero };
        x = simulate(&ShortPeriod, &x, &STABLE, &input, STEP_S, 1.0);
        for (state, q) in x.iter_mut().zip(density) {
            *state += (q * STEP_S).sqrt() * normal.next();
        }
    }
    data
}

/// Gusts: output error takes them for measurement noise, filter error tells the two apart.
#[test]
fn filter_error_finds_both_noises() {
    let density = [2.0, 1e-3];
    let data = fly_in_gusts(density, 7);
    let structure = structure(STABLE.map(|v| 0.9 * v), |_| Noise::Estimated);
    let process = ProcessNoise { density: density.map(|q| 10.0 * q), estimated: true };
    let settings = OptimiserSettings::default();
    let found = filter_error::<2, 3>(&[manoeuvre("gusts", &data)], &structure, &process, &settings).unwrap();
    let truth: Vec<f64> = STABLE.into_iter().chain(SD).chain(density).collect();
    for (unknown, truth) in found.unknowns.iter().zip(&truth) {
        let error = (unknown.value - truth) / unknown.corrected_std_error;
        println!("{:20} {:10.4} {truth:10.4} {error:6.2} standard errors", unknown.name, unknown.value);
        // Eleven numbers: 3.5 sigma is passed by chance once in 200 such tests; the seed is fixed.
        assert!(error.abs() < 3.5, "{}", unknown.name);
    }
    assert!(found.manoeuvres[0].outputs.iter().all(|o| o.white), "{:?}", found.manoeuvres[0].outputs);
}

/// With a state of an exact flight taken as measured the answer stays exact: both sides of the accelerations are smoothed by
/// the same window. (Smoothing the state alone costs 12 % of Zq.)
#[test]
fn a_state_as_measured_gives_the_same_on_exact_data() {
    let data = fly(300, 0.5, |_| 0.0);
    let mut following = structure(STABLE.map(|v| 0.7 * v), |_| Noise::Estimated);
    following.states[0] = InitialState::measured("w");
    let settings = OptimiserSettings { step_tolerance: 1e-9, ..OptimiserSettings::default() };
    let found = output_error::<2, 3>(&[manoeuvre("exact", &data)], &following, &settings).unwrap();
    for (j, truth) in STABLE.iter().enumerate() {
        println!("{} {:.4} of {truth:.4}", NAMES[j], found.parameters[j]);
        assert!((found.parameters[j] / truth - 1.0).abs() < 1e-6, "{}: {}", NAMES[j], found.parameters[j]);
    }
    assert!(found.unknown("initial w").is_none() && found.unknown("initial q").is_some());
    let fitted: Vec<&str> = found.manoeuvres[0].outputs.iter().map(|fit| fit.name.as_str()).collect();
    assert_eq!(fitted, ["q", "az"], "the output that a state follows is not fitted");
    // With a second of it missing in the middle the state is integrated there.
    let mut torn = fly(300, 0.5, |_| 0.0);
    torn.outputs[100..150].iter_mut().for_each(|y| y[0] = f64::NAN);
    let found = output_error::<2, 3>(&[manoeuvre("torn", &torn)], &following, &settings).unwrap();
    for (j, truth) in STABLE.iter().enumerate() {
        assert!((found.parameters[j] / truth - 1.0).abs() < 1e-6, "{}: {}", NAMES[j], found.parameters[j]);
    }
}

/// In gusts a simulated w is not the one that made the moments: its derivatives are wrong by many per cent, and those
/// with the measured one are not.
#[test]
fn a_state_as_measured_is_right_in_gusts() {
    let mut worst = [0.0_f64; 2];
    for seed in 0..10 {
        let data = fly_in_gusts([2.0, 0.0], 40 + seed);
        let simulated = structure(STABLE.map(|v| 0.9 * v), |_| Noise::Estimated);
        let mut following = simulated.clone();
        following.states[0] = InitialState::measured("w");
        for (worst, structure) in worst.iter_mut().zip([&simulated, &following]) {
            let found = fit(&[manoeuvre("gusts", &data)], structure).unwrap();
            for j in 3..6 {
                *worst = worst.max((found.parameters[j] / STABLE[j] - 1.0).abs());
            }
        }
    }
    println!(
        "largest relative error of Mw, Mq, Mde in ten flights: simulated {:.3}, as measured {:.3}",
        worst[0], worst[1]
    );
    assert!(worst[1] < 0.1 && worst[0] > 3.0 * worst[1], "{worst:?}");
}

#[test]
fn filter_error_refuses_a_state_as_measured() {
    let data = fly(300, 0.5, white(3));
    let mut following = structure(STABLE, |_| Noise::Estimated);
    following.states[0] = InitialState::measured("w");
    let process = ProcessNoise { density: [0.0; 2], estimated: true };
    let settings = OptimiserSettings::default();
    let refused = filter_error::<2, 3>(&[manoeuvre("calm", &data)], &following, &process, &settings);
    assert!(refused.unwrap_err().to_string().contains("cannot take the state w as measured"));
}

/// Without process noise the filter is a simulation: both methods agree. The initial state starts at a measured value and
/// ten sigmas wide instead of unknown, which is worth 1 % of the standard errors here.
#[test]
fn filter_error_without_process_noise_is_output_error() {
    let data = fly(500, 0.5, white(8));
    let structure = structure(STABLE.map(|v| 0.9 * v), known);
    let simulated = fit(&[manoeuvre("calm", &data)], &structure).unwrap();
    let process = ProcessNoise { density: [0.0; 2], estimated: true };
    let settings = OptimiserSettings::default();
    let filtered = filter_error::<2, 3>(&[manoeuvre("calm", &data)], &structure, &process, &settings).unwrap();
    for (a, b) in simulated.unknowns.iter().zip(&filtered.unknowns) {
        assert!((a.value - b.value).abs() < 0.05 * a.std_error, "{}: {} {}", a.name, a.value, b.value);
        assert!((a.std_error / b.std_error - 1.0).abs() < 0.02, "{}: {} {}", a.name, a.std_error, b.std_error);
    }
}

/// Noise in the states biases equation error towards zero, and smoothing helps.
#[test]
fn equation_error_is_biased_by_noise_in_the_states() {
    let rough = EquationErrorSettings { smooth_regressors: false, ..EquationErrorSettings::automatic(STEP_S) };
    let smooth = EquationErrorSettings::automatic(STEP_S);
    let mut mean = [[0.0; 6]; 2];
    for seed in 0..20 {
        let data = fly(300, 0.5, white(100 + seed));
        for (mean, settings) in mean.iter_mut().zip([&rough, &smooth]) {
            let found = equation_error::<2, 3>(&[manoeuvre("noisy", &data)], &structure([0.0; 6], known), settings);
            for (m, v) in mean.iter_mut().zip(found.unwrap().fit.parameters) {
                *m += v / 20.0;
            }
        }
    }
    let error = |m: &[f64; 6], j: usize| m[j] / STABLE[j] - 1.0;
    println!("relative errors, measured regressors {:?}", [0, 3].map(|j| error(&mean[0], j)));
    println!("relative errors, smoothed regressors {:?}", [0, 3].map(|j| error(&mean[1], j)));
    assert!(error(&mean[0], 0) < -0.02, "Zw is pulled towards zero: {}", error(&mean[0], 0));
    assert!(error(&mean[1], 0).abs() < 0.5 * error(&mean[0], 0).abs());
}

#[test]
fn what_cannot_be_told_apart_is_named() {
    // No elevator at all, and a state that stays at zero.
    let mut data = fly(300, 1e9, white(9));
    let message = fit(&[manoeuvre("steady", &data)], &structure(STABLE, known)).unwrap_err().to_string();
    assert!(message.starts_with("Zde does not move any measured output"), "{message}");
    // An elevator that follows the pitch rate exactly: Mq and Mde, Zq and Zde act as one.
    data = fly(300, 0.5, white(10));
    let mut feedback = structure(STABLE, known);
    feedback.parameters.iter_mut().skip(3).for_each(|p| p.fixed = true);
    for (u, y) in data.inputs.iter_mut().zip(&data.outputs) {
        u[0] = 2.0 * y[1];
    }
    let settings = EquationErrorSettings { smooth_regressors: false, ..EquationErrorSettings::automatic(STEP_S) };
    let failure = equation_error::<2, 3>(&[manoeuvre("feedback", &data)], &feedback, &settings).unwrap_err();
    let BatchError::Singular { culprits } = &failure else { panic!("{failure}") };
    let names: Vec<&str> = culprits.iter().map(|(name, _)| name.as_str()).collect();
    assert!(names.len() == 2 && names.contains(&"Zq") && names.contains(&"Zde"), "{failure}");
    // One more of Zde is two less of Zq.
    let amount = |name: &str| culprits.iter().find(|(n, _)| n == name).unwrap().1;
    assert!((amount("Zq") / amount("Zde") + 2.0).abs() < 1e-6, "{failure}");
    assert!(failure.to_string().contains("cannot be told apart"), "{failure}");
}

#[test]
fn bad_input_is_refused_in_words() {
    let data = fly(50, 0.5, white(11));
    let says = |m: &Flights<'_>, s: &Structure<2, 3>, what: &str| {
        let message = fit(m, s).unwrap_err().to_string();
        assert!(message.contains(what), "{message}");
    };
    let good = structure(STABLE, known);
    let m = manoeuvre("x", &data);
    says(&[], &good, "no manoeuvre");
    says(&[Manoeuvre { time_s: &data.time[1..], ..m }], &good, "x: 49 times, 50 inputs and 50 outputs");
    let mut time = data.time.clone();
    time[7] = time[6];
    says(&[Manoeuvre { time_s: &time, ..m }], &good, "time 0.12 s of sample 7 does not increase");
    let nothing = vec![[f64::NAN; 3]; 50];
    says(&[Manoeuvre { outputs: &nothing, ..m }], &good, "no output has a value");
    let unmeasured: Vec<[f64; 3]> = data.outputs.iter().map(|y| [f64::NAN, y[1], y[2]]).collect();
    says(&[Manoeuvre { outputs: &unmeasured, ..m }], &good, "nothing measures the state w");
    says(&[m], &structure(STABLE, |_| Noise::Known(0.0)), "the noise of w is 0");
    let mut outside = good.clone();
    outside.parameters[3].upper = -1.0;
    says(&[m], &outside, "Mw starts at -0.75, outside [-inf, -1]");
    let mut short = good.clone();
    short.parameters.pop();
    says(&[m], &short, "the model has 6 parameters, the structure 5");
    let wild = structure([-1.4, -1.5, -6.3, 1e9, -3.7, -12.8], known);
    says(&[m], &wild, "the simulation with the start values diverges");
    assert!(predict::<2, 3>(&[m], &good, &[1.0], &OptimiserSettings::default()).is_err());
    let negative = ProcessNoise { density: [-1.0, 0.0], estimated: false };
    let failure = filter_error::<2, 3>(&[m], &good, &negative, &OptimiserSettings::default()).unwrap_err();
    assert!(failure.to_string().contains("process noise of w is -1"), "{failure}");
}

/// A bound that excludes the truth is where the estimate rests, and says so.
#[test]
fn bounds_hold() {
    let data = fly(400, 0.5, white(12));
    let mut bounded = structure(STABLE.map(|v| 0.8 * v), known);
    bounded.parameters[4].lower = -3.2;
    let found = fit(&[manoeuvre("bounded", &data)], &bounded).unwrap();
    let damping = found.unknown("Mq").unwrap();
    assert!(damping.at_limit && damping.value == -3.2, "{damping:?}");
    assert!(found.unknowns.iter().filter(|u| u.at_limit).count() == 1);
}
