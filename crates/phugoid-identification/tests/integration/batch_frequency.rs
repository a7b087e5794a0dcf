//! Equation error and output error in the frequency domain: against exact answers, against the same methods by sample,
//! against chance, and what they say where the band tells nothing.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::batch::{Data, SD, STABLE, STEP_S, flown, fly, known, manoeuvre, structure, white};
use crate::common;

use common::short_period::NAMES;
use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_identification::batch::{
    BatchError, BatchFit, BatchParameter, EquationErrorSettings, InitialState, Manoeuvre, Noise, OptimiserSettings,
    OutputChannel, Structure, bound, equation_error_frequency, output_error, output_error_frequency,
};
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::options::{Band, Likelihood};

const BAND: Band = Band { low_hz: 0.1, high_hz: 3.0 };
/// Twenty seconds, in which the short period of 1 Hz goes around twenty times.
const SAMPLES: usize = 1000;

fn settings() -> EquationErrorSettings {
    EquationErrorSettings::automatic(STEP_S)
}

fn by_outputs(data: &Data, band: Band) -> Result<BatchFit, BatchError> {
    let start = structure(STABLE.map(|v| 0.8 * v), |_| Noise::Estimated);
    output_error_frequency::<2, 3>(&[manoeuvre("flight", data)], &start, band, &OptimiserSettings::default())
}

fn by_equations(data: &Data, band: Band) -> Result<BatchFit, BatchError> {
    let start = structure([0.0; 6], |_| Noise::Estimated);
    let found = equation_error_frequency::<2, 3>(&[manoeuvre("flight", data)], &start, band, &settings())?;
    Ok(found.fit)
}

/// Noise of a part of that of the other tests: equation error corrects the noise of its states in the first order only.
fn quiet(seed: u64) -> Box<dyn FnMut(usize) -> f64> {
    let mut noise = white(seed);
    Box::new(move |i| 0.2 * noise(i))
}

/// Largest relative error of a moment derivative: the force derivatives cannot be told apart well in this motion.
fn worst_moment(parameters: &[f64]) -> f64 {
    worst(parameters, 3)
}

/// Largest relative error of the parameters from one on.
fn worst(parameters: &[f64], from: usize) -> f64 {
    parameters.iter().zip(STABLE).skip(from).map(|(p, truth)| (p / truth - 1.0).abs()).fold(0.0, f64::max)
}

/// Data without noise, with lost rows, a lost value and unequal intervals: output error simulates exactly what made them.
/// Equation error takes means over an interval, of rates that a step of the elevator bends: its error is of the order
/// (h omega)^2/12 = 0.001 of the terms (h = 20 ms, omega = 6.2/s), and more of the small Zq.
#[test]
fn exact_data_are_recovered() {
    let mut data = fly(SAMPLES, 0.5, |_| 0.0);
    data.outputs[40] = [f64::NAN; 3];
    data.outputs[70][1] = f64::NAN;
    let found = by_outputs(&data, BAND).unwrap();
    println!("output error {:.2e}", worst(&found.parameters, 0));
    assert!(worst(&found.parameters, 0) < 1e-6, "{:?}", found.parameters);
    let found = by_equations(&data, BAND).unwrap();
    println!("equation error {:?}", found.parameters);
    assert!(worst(&found.parameters, 0) < 0.02, "{:?}", found.parameters);
    let band = found.band.unwrap();
    // Two periods in 20 s, and 3 Hz: 59 frequencies.
    assert!(
        (band.low_hz - 0.1).abs() < 1e-9 && (band.high_hz - 3.0).abs() < 1e-9 && band.frequencies == 59,
        "{band:?}"
    );
}

/// A bias and a drift of a fifth of a period on w and az, of the size of the motion: the search by sample follows them with
/// the parameters, the one in the band does not.
#[test]
fn what_lies_below_the_band_does_not_count() {
    let straight = fly(SAMPLES, 0.5, quiet(3));
    let mut data = fly(SAMPLES, 0.5, quiet(3));
    for (t, y) in data.time.iter().zip(&mut data.outputs) {
        let drift = 1.0 + (std::f64::consts::TAU * t / 100.0).sin();
        y[0] += drift;
        y[2] += drift;
    }
    let start = structure(STABLE, |_| Noise::Estimated);
    let by_sample = output_error::<2, 3>(&[manoeuvre("flight", &data)], &start, &OptimiserSettings::default());
    let by_sample = by_sample.map_or(f64::INFINITY, |fit| worst_moment(&fit.parameters));
    for (name, of) in [("output", by_outputs as fn(&Data, Band) -> _), ("equation", by_equations)] {
        let (with, without) = (of(&data, BAND).unwrap(), of(&straight, BAND).unwrap());
        let found = worst_moment(&with.parameters);
        println!(
            "{name}: {found:.4}, without drift {:.4}; by sample {by_sample:.3}",
            worst_moment(&without.parameters)
        );
        for (a, b) in with.unknowns.iter().zip(&without.unknowns).take(6) {
            let moved = (a.value - b.value).abs() / b.corrected_std_error;
            assert!(moved < 0.5, "{name} error, {}: moved by {moved:.2} standard errors", a.name);
        }
        // The drift costs the search by sample three times what noise alone leaves in the band, at least.
        assert!(by_sample > 3.0 * found, "{name}: {by_sample} {found}");
    }
}

/// The rows of white noise are white and of its level: the level is found, and 99 of 100 fits are called white. Of 60 (20
/// flights, three outputs that a fit shares) more than three would be one chance in 300.
#[test]
fn the_level_in_the_band_is_that_of_the_noise() {
    let mut coloured = 0;
    for seed in 0..20 {
        let found = by_outputs(&fly(SAMPLES, 0.5, white(40 + seed)), BAND).unwrap();
        for (std, truth) in found.noise_std.iter().zip(SD) {
            // 118 coefficients: 6.5 % one sigma.
            assert!((std / truth - 1.0).abs() < 0.25, "{std} {truth}");
        }
        for fit in &found.manoeuvres[0].outputs {
            assert!(fit.lag_one.abs() < 0.5, "{fit:?}");
            coloured += usize::from(!fit.white);
        }
    }
    println!("{coloured} of 60 are called coloured");
    assert!(coloured <= 3, "{coloured}");
}

/// Mean claimed over actual standard deviation, and part of the truths within two of the claimed ones, over all
/// parameters.
fn by_chance(
    runs: u64,
    of: impl Fn(&Data) -> BatchFit,
    noise: impl Fn(u64) -> Box<dyn FnMut(usize) -> f64>,
) -> [f64; 2] {
    let fits: Vec<BatchFit> = (0..runs).map(|seed| of(&fly(SAMPLES, 0.5, noise(seed)))).collect();
    let (mut ratios, mut within) = (0.0, 0.0);
    for (j, truth) in STABLE.iter().enumerate() {
        let n = runs as f64;
        let errors: Vec<f64> = fits.iter().map(|fit| fit.unknowns[j].value - truth).collect();
        let actual = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
        let bias = errors.iter().sum::<f64>() / n / actual;
        let mean = |f: &dyn Fn(&BatchFit) -> f64| fits.iter().map(f).sum::<f64>() / n;
        let claimed = mean(&|fit| fit.unknowns[j].corrected_std_error);
        let plain = mean(&|fit| fit.unknowns[j].std_error);
        let inside = errors.iter().zip(&fits).filter(|(e, f)| e.abs() < 2.0 * f.unknowns[j].corrected_std_error);
        let inside = inside.count() as f64 / n;
        println!(
            "{:4} actual {actual:.4} bias {bias:+.2}; claimed {:.3}, by the information {:.3}; within {:.1} %",
            NAMES[j],
            claimed / actual,
            plain / actual,
            100.0 * inside
        );
        (ratios, within) = (ratios + claimed / actual / 6.0, within + inside / 6.0);
    }
    [ratios, within]
}

/// 120 runs: the actual standard deviation is known to 6 %, coverage over six correlated parameters to about 1.3 %.
#[test]
fn bounds_of_output_error_hold() {
    let [ratio, within] = by_chance(120, |data| by_outputs(data, BAND).unwrap(), |seed| Box::new(white(100 + seed)));
    println!("{ratio:.3} {within:.3}");
    assert!((0.9..1.2).contains(&ratio) && (0.93..=0.98).contains(&within), "{ratio} {within}");
    // And near the limit of all data: what is given up is what lies outside of the band.
    let data = fly(SAMPLES, 0.5, white(100));
    let all = bound::<2, 3>(&[manoeuvre("flight", &data)], &structure(STABLE, known), &STABLE).unwrap();
    let found = by_outputs(&data, BAND).unwrap();
    for (a, b) in all.iter().zip(&found.unknowns).take(6) {
        println!("{}: {:.3} times the Cramer-Rao bound", a.name, b.std_error / a.std_error);
    }
}

#[test]
fn bounds_of_equation_error_hold() {
    let [ratio, within] = by_chance(120, |data| by_equations(data, BAND).unwrap(), |seed| quiet(100 + seed));
    println!("{ratio:.3} {within:.3}");
    assert!((0.9..1.2).contains(&ratio) && (0.93..=0.98).contains(&within), "{ratio} {within}");
}

/// Noise with a correlation time of 0.2 s, whose spectrum falls to a tenth within the band.
#[test]
fn bounds_hold_with_coloured_noise() {
    let coloured = |seed: u64| -> Box<dyn FnMut(usize) -> f64> {
        let mut normal = common::Normal::new(500 + seed);
        let mut last = [0.0; 3];
        Box::new(move |i| {
            last[i] = 0.9 * last[i] + (1.0_f64 - 0.81).sqrt() * normal.next();
            SD[i] * last[i]
        })
    };
    let [ratio, within] = by_chance(120, |data| by_outputs(data, BAND).unwrap(), coloured);
    println!("{ratio:.3} {within:.3}");
    assert!((0.9..1.2).contains(&ratio) && (0.92..=0.98).contains(&within), "{ratio} {within}");
}

/// `x' = c + a x + b u`, and `x` is measured.
struct Lag;

impl<const P: usize> Model<1, 1, P> for Lag {
    type Input = [f64; 1];
    fn parameter_count(&self) -> usize {
        3
    }
    fn rates(&self, x: &[f64; 1], t: &[f64; P], u: &[f64; 1]) -> [f64; 1] {
        [t[0] + t[1] * x[0] + t[2] * u[0]]
    }
    fn linearized_rates(&self, x: &[f64; 1], t: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<1, P>) {
        *out = LinearizedRates::ZERO;
        out.rates = self.rates(x, t, u);
        out.state_jacobian = [[t[1]]];
        out.regressors[0][..3].copy_from_slice(&[1.0, x[0], u[0]]);
    }
    fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; P], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, P>) {
        *out = LinearizedOutputs::ZERO;
        out.outputs = *x;
        out.state_jacobian = [[1.0]];
    }
    fn measuring_output(&self, _state: usize) -> Option<usize> {
        Some(0)
    }
}

/// The constant is named and gets no number with a bound; a and b are found, over a gap and with a bias of half the motion.
#[test]
fn a_constant_is_not_identifiable_in_the_band() {
    let mut normal = common::Normal::new(9);
    let (mut time, mut inputs, mut outputs) = (Vec::new(), Vec::new(), Vec::new());
    let mut x = 0.5;
    for k in 0..1500 {
        let t = 0.02 * f64::from(k);
        let u = if (t / 1.3).fract() < 0.5 { 1.0 } else { -1.0 };
        // A gap of two seconds, and one row in nine lost, unless the input steps there.
        let steps = [0.0, 0.5].iter().any(|at| ((t / 1.3).fract() - at).abs() < 0.05 || (t / 1.3).fract() > 0.95);
        if !(12.0..14.0).contains(&t) && (k % 9 != 4 || steps) {
            time.push(t);
            inputs.push([u]);
            outputs.push([x + 0.5 + 0.01 * normal.next()]);
        }
        // c = 1, a = -2, b = 3, the input held.
        let steady = (1.0 + 3.0 * u) / 2.0;
        x = steady + (x - steady) * f64::exp(-2.0 * 0.02);
    }
    let manoeuvre = Manoeuvre {
        name: "lag",
        plant: flown(&Lag, &inputs),
        first: 0,
        time_s: &time,
        hold: InputHold::Zero,
        outputs: &outputs,
        initial_state: None,
    };
    let names = ["c", "a", "b"];
    let structure = Structure {
        parameters: names.iter().zip([0.3, -1.0, 1.0]).map(|(n, v)| BatchParameter::free(*n, v)).collect(),
        states: [InitialState::free("x")],
        outputs: [OutputChannel::new("x", Noise::Estimated)],
        maximum_step_s: 0.02,
        maximum_gap_s: 0.5,
        likelihood: Likelihood::Robust,
    };
    let band = Band { low_hz: 0.0, high_hz: 3.0 };
    let search = OptimiserSettings::default();
    let by_outputs = output_error_frequency::<1, 1>(&[manoeuvre], &structure, band, &search).unwrap();
    let by_equations = equation_error_frequency::<1, 1>(&[manoeuvre], &structure, band, &settings()).unwrap().fit;
    assert!(by_equations.unknown("c").is_none());
    assert!(by_outputs.unknown("c").unwrap().corrected_std_error.is_infinite());
    for fit in [by_outputs, by_equations] {
        println!("{}: {:?}\n{:?}", fit.method, fit.unknowns, fit.notes);
        assert!(
            fit.notes.iter().any(|n| n.contains("not identifiable in the band") && n.contains(": c.")),
            "{:?}",
            fit.notes
        );
        for (name, truth) in [("a", -2.0), ("b", 3.0)] {
            let found = fit.unknown(name).unwrap();
            assert!((found.value - truth).abs() < 3.0 * found.corrected_std_error, "{} {found:?}", fit.method);
            assert!(found.corrected_std_error < 0.02 * truth.abs(), "{found:?}");
        }
    }
}

#[test]
fn a_band_that_the_record_does_not_have_is_refused_in_words() {
    let data = fly(100, 0.5, white(7));
    for of in [by_outputs as fn(&Data, Band) -> Result<BatchFit, BatchError>, by_equations] {
        // Two seconds: nothing below 1 Hz.
        let message = of(&data, Band { low_hz: 0.1, high_hz: 0.9 }).unwrap_err().to_string();
        assert!(message.contains("too short") && message.contains("0.900 Hz"), "{message}");
        let message = of(&data, Band { low_hz: 2.0, high_hz: 1.0 }).unwrap_err().to_string();
        assert!(message.contains("2 to 1 Hz"), "{message}");
        let message = of(&data, Band { low_hz: f64::NAN, high_hz: 1.0 }).unwrap_err().to_string();
        assert!(message.contains("NaN to 1 Hz"), "{message}");
    }
}

/// The whole way, with the band found from the record.
#[test]
fn the_f16_is_found_in_the_band_of_its_record() {
    for method in [Method::EquationErrorFrequency, Method::OutputErrorFrequency] {
        let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
        let found = estimate(&common::f16::fly(20.0, 0.026, 31), &common::f16::model(), &options, &mut |_| {}).unwrap();
        let batch = found.batch.as_ref().unwrap();
        println!("{method}: {:?}, {:?}", batch.band, batch.notes);
        for (name, truth) in common::f16::TRUTH {
            let p = found.parameters.iter().find(|p| p.name == name).unwrap();
            println!("{method} {name}: {:.4} +- {:.4}, truth {truth}, {}", p.value, p.corrected_std_error, p.status);
            assert!((p.value - truth).abs() < 4.0 * p.corrected_std_error, "{method} {name}: {}", p.value);
        }
        for fit in &batch.manoeuvres[0].1 {
            println!("{fit:?}");
        }
        for sentence in &found.verdict {
            println!("- {sentence}");
        }
        let band = batch.band.as_ref().unwrap();
        assert!((band.low_hz - 0.1).abs() < 0.01 && (0.5..6.0).contains(&band.high_hz), "{band:?}");
        assert_eq!(batch.equations.is_empty(), method != Method::EquationErrorFrequency);
    }
}
