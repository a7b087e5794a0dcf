//! Instructions per update, for callgrind:
//!
//! ```text
//! cargo build --release -p phugoid-estimators --example estimator_instructions
//! valgrind --tool=callgrind --toggle-collect='*measured_updates*' target/release/examples/estimator_instructions 5 ekf
//! ```
//!
//! The first argument is the number of parameters (4, 5, 11 or 24). After it, in any order: the method (smpe, ekf, rls,
//! fourier, implicit-sign, super-twisting; smpe without), `wide` for room for 24, `off` for no change detection, `learn` for
//! noise levels and process noise that are learnt (smpe and ekf). Prints
//! how many updates were measured (divide the total by it) and, run without callgrind, the time of the fastest hundred
//! of them.

#[path = "../tests/methods/mod.rs"]
mod methods;
#[path = "../tests/plants/mod.rs"]
mod plants;
#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use methods::{METHODS, Run, with_method};
use phugoid_estimators::settings::{EstimatorSettings, NoiseLearning, ProcessNoise};
use phugoid_estimators::{Estimator, Sample};
use synthetic::{Synthetic, flight, priors};

const WARM_UP: usize = 300;
const MEASURED: usize = 2000;
/// The fastest batch is the time on a core of one's own, whatever else the machine does meanwhile.
const BATCH: usize = 100;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let method = METHODS.into_iter().find(|name| has(name)).unwrap_or("smpe");
    let (detection, learn) = (!has("off"), has("learn"));
    match (arguments.first().map(String::as_str), has("wide")) {
        (Some("4"), false) => measure::<6, 4>(method, 4, detection, learn),
        (Some("4"), true) => measure::<6, 24>(method, 4, detection, learn),
        (Some("11"), false) => measure::<7, 11>(method, 11, detection, learn),
        (Some("11"), true) => measure::<7, 24>(method, 11, detection, learn),
        (Some("24"), _) => measure::<6, 24>(method, 24, detection, learn),
        (_, false) => measure::<6, 5>(method, 5, detection, learn),
        (_, true) => measure::<6, 24>(method, 5, detection, learn),
    }
}

fn measure<const R: usize, const P: usize>(method: &str, parameters: usize, detection: bool, learn: bool) {
    let model = Synthetic::<P>::new(parameters);
    let mut settings = match EstimatorSettings::<4, R, P>::automatic(&priors(parameters), [0.01; R], 0.01) {
        Ok(settings) => settings,
        Err(error) => return eprintln!("{error}"),
    };
    if !detection {
        settings.change_detection = None;
    }
    if learn {
        // As in the longitudinal motion: gusts move two states, and what the model lacks a third one.
        let shared = [true, true, false, false];
        settings.noise_learning = Some(NoiseLearning { shared, ..NoiseLearning::from_white([0.005; R]) });
        settings.process_noise = ProcessNoise::adaptive([1e-4, 1e-4, 0.0, 1e-4]);
    }
    let samples = flight::<R, P>(&model, WARM_UP + MEASURED);
    println!("{method}, p = {parameters} of P = {P}, R = {R}");
    with_method(method, model, settings, Measured { samples: &samples });
}

struct Measured<'a, const R: usize> {
    samples: &'a [Sample<[f64; 1], R>],
}

impl<const R: usize, const P: usize> Run<R, P> for Measured<'_, R> {
    fn run(&mut self, mut estimator: impl Estimator<R, P, Input = [f64; 1]>) {
        for sample in &self.samples[..WARM_UP] {
            estimator.update(sample);
        }
        let mut last = 0.0;
        let mut best = f64::INFINITY;
        for batch in self.samples[WARM_UP..].chunks(BATCH) {
            let start = std::time::Instant::now();
            last = measured_updates(&mut estimator, batch);
            best = best.min(start.elapsed().as_secs_f64() / batch.len() as f64);
        }
        println!("fastest batch of {BATCH}: {:.3} us per update", best * 1e6);
        println!("{MEASURED} updates measured; last first parameter {last}");
    }
}

#[inline(never)]
fn measured_updates<const R: usize, const P: usize>(
    estimator: &mut impl Estimator<R, P, Input = [f64; 1]>,
    samples: &[Sample<[f64; 1], R>],
) -> f64 {
    let mut last = 0.0;
    for sample in samples {
        last = estimator.update(sample).parameters[0];
    }
    last
}
