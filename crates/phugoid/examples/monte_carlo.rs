//! Many flights on all cores, against the claimed bounds: `cargo run -p phugoid --example monte_carlo`.
//!
//! The same manoeuvre is flown with other sensor noise each time. If the bounds are honest, the truth lies within them in about 95
//! of 100 flights, and the errors are as large as the estimator says.

#![allow(clippy::expect_used, clippy::panic)] // an example may stop

use phugoid::{Error, EstimateOptions, Estimation, Model, Scenario, estimate, simulate};
use rayon::prelude::*;

const FLIGHTS: u64 = 40;

fn main() -> Result<(), Error> {
    let calm = Scenario {
        duration: "10 s".parse().expect("a time"),
        sample_rate: "50 Hz".parse().expect("a frequency"),
        ..Scenario::named("f16-calm")?
    };
    let model = Model::named("f16-model")?;

    let fly_and_estimate = |seed: u64| -> Result<Estimation, Error> {
        let flight = simulate(&Scenario { seed, ..calm.clone() })?;
        let options = EstimateOptions { truth: flight.true_parameters, ..EstimateOptions::default() };
        estimate(&flight.measured, &model, &options)
    };
    // The seed alone decides what is random, so the numbers do not depend on the number of cores.
    let results = (0..FLIGHTS).into_par_iter().map(fly_and_estimate).collect::<Result<Vec<_>, _>>()?;

    println!("{FLIGHTS} flights on {} cores", rayon::current_num_threads());
    println!("{:<10} {:>8} {:>10} {:>12} {:>10}", "parameter", "truth", "rms error", "claimed rms", "covered");
    for (j, parameter) in results[0].parameters.iter().enumerate() {
        let truth = parameter.truth.expect("it was simulated");
        let mean = |f: &dyn Fn(&Estimation) -> f64| results.iter().map(f).sum::<f64>() / results.len() as f64;
        let rms = mean(&|r| (r.parameters[j].value - truth).powi(2)).sqrt();
        let claimed = mean(&|r| r.parameters[j].corrected_std_error.powi(2)).sqrt();
        let covered = mean(&|r| {
            let p = &r.parameters[j];
            f64::from((p.lower..=p.upper).contains(&truth))
        });
        println!("{:<10} {truth:>8} {rms:>10.5} {claimed:>12.5} {:>8.1} %", parameter.name, 100.0 * covered);
        assert!(covered >= 0.85, "{}: the truth is within the bounds in {covered} of the flights", parameter.name);
        assert!((0.6..1.5).contains(&(rms / claimed)), "{}: the errors are not those claimed", parameter.name);
    }
    Ok(())
}
