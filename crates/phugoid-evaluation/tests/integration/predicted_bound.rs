//! The bound that a record gives of a model (`phugoid inspect --model`), against the one of the flight that was simulated, with its truth.
#![allow(clippy::unwrap_used, clippy::panic)] // tests may

use phugoid_evaluation::accuracy::bound;
use phugoid_identification::inspect::model_support;
use phugoid_identification::manoeuvres::{Settings, find};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::{fly, sense};
use phugoid_simulation::scenario::Scenario;

#[test]
fn the_bound_from_a_record_is_that_of_the_flight() {
    let scenario = Scenario::named("f16-calm").unwrap();
    let model = ModelFile::named("f16-model").unwrap();
    let flight = fly(&scenario).unwrap();
    let record = sense(&flight.truth, &scenario, scenario.seed).unwrap();
    let found = find(&record, &Settings::default());
    let support = model_support(&record, &found, &model);
    // The first manoeuvre begins with the flight.
    let (first, segment) = (&found.manoeuvres[0], &support.segments[0]);
    assert_eq!((first.from_s, segment.manoeuvres.as_slice()), (record.time[0], &[1][..]));
    let truth = bound(&flight, &model, &[first.to_s]).unwrap().remove(0);
    assert_eq!(segment.parameters.len(), truth.std_error.len());
    for (parameter, bound) in segment.parameters.iter().zip(&truth.std_error) {
        let ratio = parameter.bound.std_error / bound;
        println!(
            "{:12} {:.3e} from the record, {bound:.3e} of the flight",
            parameter.bound.name, parameter.bound.std_error
        );
        // The noise is the model file's in both; the fitted motion stands for the true one, and was within a thousandth.
        assert!((0.99..1.01).contains(&ratio), "{}: {ratio}", parameter.bound.name);
    }
}
