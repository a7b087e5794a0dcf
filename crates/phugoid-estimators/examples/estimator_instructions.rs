//! Instructions per update, for callgrind:
//!
//! ```text
//! cargo build --release -p phugoid-estimators --example estimator_instructions
//! valgrind --tool=callgrind --toggle-collect='*measured_updates*' target/release/examples/estimator_instructions 5
//! ```
//!
//! The argument is the number of parameters (5, 11 or 24), with `wide` after it in room for 24 and with `off` after it
//! without change detection. Prints how many updates were measured (divide the total by it) and, run without
//! callgrind, the time of the fastest hundred of them.

#[path = "../tests/plants/mod.rs"]
mod plants;
#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use phugoid_estimators::smpe::{ReReaching, Smpe, SmpeSettings};
use phugoid_estimators::{Estimator, Sample};
use synthetic::{Synthetic, flight, priors};

const WARM_UP: usize = 300;
const MEASURED: usize = 2000;
/// The fastest batch is the time on a core of one's own, whatever else the machine does meanwhile.
const BATCH: usize = 100;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let detection = !has("off");
    match (arguments.first().map(String::as_str), has("wide")) {
        (Some("11"), false) => measure::<7, 11>(11, detection),
        (Some("11"), true) => measure::<7, 24>(11, detection),
        (Some("24"), _) => measure::<6, 24>(24, detection),
        (_, false) => measure::<6, 5>(5, detection),
        (_, true) => measure::<6, 24>(5, detection),
    }
}

fn measure<const R: usize, const P: usize>(parameters: usize, detection: bool) {
    let model = Synthetic::<P>::new(parameters);
    let mut settings = match SmpeSettings::<4, R, P>::automatic(&priors(parameters), [0.01; R], 0.01) {
        Ok(settings) => settings,
        Err(error) => return eprintln!("{error}"),
    };
    if !detection {
        settings.re_reaching = ReReaching::Off;
    }
    let samples = flight::<R, P>(&model, WARM_UP + MEASURED);
    let mut estimator = match Smpe::new(model, settings) {
        Ok(estimator) => estimator,
        Err(error) => return eprintln!("{error}"),
    };
    for sample in &samples[..WARM_UP] {
        estimator.update(sample);
    }
    let mut last = 0.0;
    let mut best = f64::INFINITY;
    for batch in samples[WARM_UP..].chunks(BATCH) {
        let start = std::time::Instant::now();
        last = measured_updates(&mut estimator, batch);
        best = best.min(start.elapsed().as_secs_f64() / batch.len() as f64);
    }
    println!("fastest batch of {BATCH}: {:.3} us per update", best * 1e6);
    println!("{MEASURED} updates measured, p = {parameters} of P = {P}, R = {R}; last first parameter {last}");
}

#[inline(never)]
fn measured_updates<const R: usize, const P: usize>(
    estimator: &mut Smpe<Synthetic<P>, 4, R, P>,
    samples: &[Sample<[f64; 1], R>],
) -> f64 {
    let mut last = 0.0;
    for sample in samples {
        last = estimator.update(sample).parameters[0];
    }
    last
}
