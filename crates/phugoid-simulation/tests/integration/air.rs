//! The air that scenarios fly through: turbulence, wind and the atmosphere, against formulas that are in print.

use std::f64::consts::{PI, TAU};

use phugoid_flight_dynamics::rigid_body::Angles;
use phugoid_simulation::course::Course;
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::Scenario;

const FOOT: f64 = 0.3048;
const SPEED: f64 = 675.0 * FOOT;

fn f16(seed: u64, duration: &str, tables: &str) -> Scenario {
    let text = format!(
        "name = \"air\"\nduration = \"{duration}\"\nsample_rate = \"25 Hz\"\nseed = {seed}\n\
         [aircraft]\ntype = \"f16\"\ncg = 0.30\n[condition]\naltitude = \"20000 ft\"\nspeed = \"675 ft/s\"\n{tables}"
    );
    Scenario::parse(&text, "air.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Velocity of the air in body axes at every sample, m/s: what the aircraft has over the still air less what it has over
/// the air that it feels.
fn gusts(scenario: &Scenario) -> Vec<[f64; 3]> {
    let (aircraft, trim) = trimmed_aircraft(scenario).unwrap();
    let mut course = Course::new(scenario, aircraft.as_ref(), None, &trim).unwrap();
    let body = |speed, alpha, beta| Angles::of(alpha, beta, 0.0, 0.0).body_velocity(speed);
    let mut gusts = Vec::new();
    for _ in 0..scenario.samples() {
        let (state, air) = (course.state(), course.sample(trim.controls()).air);
        let (over_still, felt) = (body(state.speed, state.alpha, state.beta), body(air.speed, air.alpha, air.beta));
        gusts.push(std::array::from_fn(|i| over_still[i] - felt[i]));
        course.advance(trim.controls()).unwrap();
    }
    gusts
}

/// One-sided density of von Karman's spectra over the angular frequency, per unit of variance (MIL-F-8785C, 3.7.1; scale
/// length 2500 ft): along the flight path, and across it.
fn von_karman(w: f64) -> [f64; 2] {
    let tau = 2500.0 * FOOT / SPEED;
    let a = (1.339 * tau * w).powi(2);
    [2.0 * tau / PI * (1.0 + a).powf(-5.0 / 6.0), tau / PI * (1.0 + 8.0 / 3.0 * a) * (1.0 + a).powf(-11.0 / 6.0)]
}

/// The same of Dryden's (3.7.2; scale length 1750 ft).
fn dryden(w: f64) -> [f64; 2] {
    let tau = 1750.0 * FOOT / SPEED;
    let a = (tau * w).powi(2);
    [2.0 * tau / PI / (1.0 + a), tau / PI * (1.0 + 3.0 * a) / (1.0 + a).powi(2)]
}

const SAMPLES: usize = 2048;
const RATE: f64 = 25.0;
const SIGMA: f64 = 0.5;
const SEEDS: u64 = 60;

/// Density of the gusts along x, y and z per unit of variance, and the frequency (rad/s), averaged over flights, in bins of
/// the periodogram with a Hann window; and the variances over that of the scenario.
fn flown(spectrum: &str) -> (Vec<(f64, [f64; 3])>, [f64; 3]) {
    let bins: Vec<usize> = (6..=64).collect();
    let mut density = vec![[0.0; 3]; bins.len()];
    let mut variance = [0.0; 3];
    for seed in 0..SEEDS {
        let scenario =
            f16(seed, "81.88 s", &format!("[turbulence]\nsigma = \"{SIGMA} m/s\"\nspectrum = \"{spectrum}\"\n"));
        let gusts = gusts(&scenario);
        assert_eq!(gusts.len(), SAMPLES);
        for axis in 0..3 {
            let mean_square = gusts.iter().map(|g| g[axis] * g[axis]).sum::<f64>() / SAMPLES as f64;
            variance[axis] += mean_square / (SIGMA * SIGMA) / SEEDS as f64;
            for (bin, density) in bins.iter().zip(&mut density) {
                let step = TAU * *bin as f64 / SAMPLES as f64;
                let (mut re, mut im) = (0.0, 0.0);
                for (k, gust) in gusts.iter().enumerate() {
                    let hann = 0.5 - 0.5 * (TAU * k as f64 / SAMPLES as f64).cos();
                    let (sin, cos) = (step * k as f64).sin_cos();
                    re += hann * gust[axis] * cos;
                    im -= hann * gust[axis] * sin;
                }
                // The window passes 3/8 of the power. Two sides, per rad/s: 2/(2 pi rate samples).
                let power = (re * re + im * im) / (0.375 * PI * RATE * SAMPLES as f64);
                density[axis] += power / (SIGMA * SIGMA) / SEEDS as f64;
            }
        }
    }
    let frequency = |bin: usize| TAU * RATE * bin as f64 / SAMPLES as f64;
    (bins.into_iter().map(frequency).zip(density).collect(), variance)
}

/// The flown density over a formula's in octaves of the frequency, for the three axes.
fn ratios(flown: &[(f64, [f64; 3])], formula: fn(f64) -> [f64; 2]) -> Vec<[f64; 3]> {
    let octave = |k: usize| 6 * (1 << k);
    (0..3)
        .map(|k| {
            let band = &flown[octave(k) - 6..octave(k + 1) - 6];
            std::array::from_fn(|axis| {
                let measured: f64 = band.iter().map(|(_, density)| density[axis]).sum();
                measured / band.iter().map(|(w, _)| formula(*w)[usize::from(axis > 0)]).sum::<f64>()
            })
        })
        .collect()
}

/// 60 flights of 82 s: a periodogram averaged over 60 flights and the 6, 12 and 24 bins of an octave, of which the window
/// joins neighbours, is good to 7, 5 and 3 % (one sigma). The filters are within 10 % of the spectra here.
#[test]
fn a_scenario_flies_the_spectrum_that_it_names() {
    let (density, variance) = flown("von-karman");
    for band in ratios(&density, von_karman) {
        assert!(band.iter().all(|ratio| (0.82..1.18).contains(ratio)), "von Karman: {band:?}");
    }
    // The filters leave out the end of the spectrum; the standard error of each is some 5 %.
    assert!(variance.iter().all(|ratio| (0.80..1.12).contains(ratio)), "{variance:?}");
    let (density, variance) = flown("dryden");
    for band in ratios(&density, dryden) {
        assert!(band.iter().all(|ratio| (0.85..1.15).contains(ratio)), "Dryden: {band:?}");
    }
    assert!(variance.iter().all(|ratio| (0.84..1.16).contains(ratio)), "{variance:?}");
    // The two differ by a quarter and more, so that the limits above tell which one is flown.
    let other = ratios(&density, von_karman);
    assert!(other.iter().flatten().any(|ratio| *ratio > 1.22), "{other:?}");
}

/// Nothing is said, and `dryden`, are one flight; another word is refused with the words that are known.
#[test]
fn the_spectrum_is_dryden_where_none_is_named() {
    let with =
        |line: &str| gusts(&f16(3, "2 s", &format!("[turbulence]\nintensity = \"light\"\nrates = true\n{line}")));
    assert_eq!(with(""), with("spectrum = \"dryden\"\n"));
    assert_ne!(with(""), with("spectrum = \"von-karman\"\n"));
    for word in ["\"karman\"", "\"von karman\"", "\"flat\"", "3"] {
        let text = format!(
            "name = \"a\"\nduration = \"1 s\"\nsample_rate = \"25 Hz\"\n[aircraft]\ntype = \"f16\"\n\
             [condition]\naltitude = \"20000 ft\"\nspeed = \"675 ft/s\"\n[turbulence]\nsigma = \"1 m/s\"\nspectrum = {word}\n"
        );
        let message = Scenario::parse(&text, "air.toml").unwrap_err().to_string();
        assert!(message.contains("spectrum = "), "{message}");
        assert!(message.contains("von-karman") || word == "3", "{message}");
    }
}
