//! What to fly so that the derivatives become known: `cargo run -p phugoid --example input_design`.
//!
//! Four kinds of input for the elevator are scaled until the aircraft moves as far as it may; the Cramer-Rao bound says, before
//! anyone flies, how well an estimator could know each derivative afterwards. The best one is then flown and estimated.

#![allow(clippy::expect_used, clippy::panic)] // an example may stop

use phugoid::parts::Surface;
use phugoid::parts::design::fit::{Limits, fitted};
use phugoid::parts::design::modes::ModeFrequencies;
use phugoid::parts::design::predict::{predict, ranked};
use phugoid::parts::design::{Kind, Request, shape};
use phugoid::{Error, EstimateOptions, Model, Scenario, estimate};

fn main() -> Result<(), Error> {
    let calm = Scenario { sample_rate: "50 Hz".parse().expect("a frequency"), ..Scenario::named("f16-calm")? };
    let model = Model::named("f16-model")?;
    let request = Request {
        surfaces: vec![Surface::Elevator],
        duration_s: 12.0,
        lead_s: 1.0,
        sample_rate_hz: 50.0,
        band_hz: None,
        linear_sweep: false,
    };
    // At most 2 deg of angle of attack and 0.3 g from the trim; the input is tuned to the short period.
    let limits = Limits { alpha: 2_f64.to_radians(), load_factor: 0.3, ..Limits::default() };
    let modes = ModeFrequencies::of_scenario(&calm)?;

    let mut candidates = Vec::new();
    for kind in Kind::ALL {
        let input = fitted(&shape(kind, &request, &modes)?, &calm, &limits)?;
        let prediction = predict(&input, &model)?;
        candidates.push((kind, input, prediction));
    }
    let candidates = ranked(candidates);

    println!("{:<10} {:>9} {:>14} {:>14}", "input", "peak deg", "dCm_alpha +-", "dCm_q +-");
    for (kind, input, prediction) in &candidates {
        let peak = input.design.inputs[0].peak().to_degrees();
        let bound = |name: &str| prediction.parameters.iter().find(|p| p.name == name).map(|p| 2.0 * p.std_error);
        let [alpha, q] = ["dCm_alpha", "dCm_q"].map(|name| bound(name).expect("the model has it"));
        println!("{:<10} {peak:>9.2} {alpha:>14.5} {q:>14.5}", kind.name());
        assert!(input.excursions.alpha <= limits.alpha * 1.001 && input.excursions.load_factor <= 0.3 * 1.001);
    }
    let (best, worst) = (&candidates[0], &candidates[candidates.len() - 1]);
    assert!(best.2.score < worst.2.score);

    // The flight of the best input, and what an estimator makes of it.
    let (kind, input, prediction) = best;
    let result = estimate(&input.flight.measured, &model, &EstimateOptions::default())?;
    println!("\nflown: {}", kind.name());
    for predicted in &prediction.parameters {
        let found = result.parameter(&predicted.name).expect("the model has it");
        println!("{:<10} {:>10.5} +- {:.5}", found.name, found.value, found.bound());
        // No estimator can know more than the Cramer-Rao bound allows; a good one comes close.
        assert!((0.8..1.6).contains(&(found.corrected_std_error / predicted.std_error)), "{}", found.name);
    }
    Ok(())
}
