//! From a flight to derivatives with bounds: `cargo run -p phugoid --example quick_start [FLIGHT MODEL]`.
//!
//! Without arguments it takes `flight.csv` beside this file: 10 s of the simulated F-16 with realistic sensors, in which four
//! derivatives differ from the tables by -0.2, -2, 0.4 and 0.1.

#![allow(clippy::expect_used, clippy::panic)] // an example may stop

use phugoid::{Error, EstimateOptions, Model, Record, estimate, inspect};

const TRUTH: [(&str, f64); 4] = [("dCm_alpha", -0.2), ("dCm_q", -2.0), ("dCL_alpha", 0.4), ("dCD_alpha", 0.1)];

fn main() -> Result<(), Error> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let (record, model) = match given.as_slice() {
        [flight, model] => {
            let model = Model::open(model)?;
            (model.open_record(flight)?, model)
        }
        _ => (Record::open(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/flight.csv"))?, Model::named("f16-model")?),
    };

    // What the flight holds, before anything is estimated.
    let found = inspect(&record, Some(&model));
    for manoeuvre in &found.found.manoeuvres {
        println!("{:.2} to {:.2} s: {}", manoeuvre.from_s, manoeuvre.to_s, manoeuvre.words());
    }

    let result = estimate(&record, &model, &EstimateOptions::default())?;
    println!("\n{:<12} {:>10} {:>10}", "parameter", "estimate", "bound");
    for parameter in &result.parameters {
        println!("{:<12} {:>10.5} {:>10.5}", parameter.name, parameter.value, parameter.bound());
    }
    result.verdict.iter().for_each(|sentence| println!("{sentence}"));

    if given.is_empty() {
        for (name, truth) in TRUTH {
            let estimate = result.parameter(name).expect("the model has it");
            // A bound is two standard errors: one error in twenty may be larger, hardly any twice as large.
            assert!((estimate.value - truth).abs() < 2.0 * estimate.bound(), "{name}: {estimate:?}");
            assert!(estimate.bound() < 0.1 * truth.abs(), "{name} is not known to a tenth: {estimate:?}");
        }
        assert!(!found.found.manoeuvres.is_empty());
    }
    Ok(())
}
