//! The standard atmosphere against table I of the standard, as a model in DAVE-ML carries it from 1 km below to 85.5 km above
//! the sea.

use phugoid_aircraft::daveml::Model;
use phugoid_flight_dynamics::standard_atmosphere::standard_atmosphere;

use crate::shared_data::shared_file;

/// Entries that the model's author typed wrongly, altitude (m) and variable: those beside them in the table show it.
const MISTYPED: [(f64, &str); 3] = [(36_000.0, "t_amb_C"), (45_000.0, "p_p0"), (83_000.0, "p_p0")];

#[test]
fn the_standard_atmosphere_is_the_published_table() {
    let Some(file) = shared_file("daveml/atmos_76.dml") else { return };
    let text = std::fs::read_to_string(&file).unwrap();
    let between = |text: &str, a: &str, b: &str| text.split(a).nth(1).unwrap().split(b).next().unwrap().to_owned();
    let altitudes: Vec<f64> =
        between(&text, "<bpVals>", "</bpVals>").split(',').map(|word| word.trim().parse().unwrap()).collect();
    assert_eq!(altitudes.len(), 101);
    let model = Model::open(&file).unwrap();
    let input = model.input_position("alt_ft").unwrap();
    let outputs = ["t_amb_C", "p_p0", "sigma"].map(|name| (name, model.position(name).unwrap()));
    let mut evaluator = model.evaluator();
    let mut mistyped = 0;
    for altitude in altitudes {
        evaluator.set(input, altitude / 0.3048);
        evaluator.run();
        let air = standard_atmosphere(altitude);
        for (name, position) in outputs {
            let published = evaluator.get(position);
            // Half a unit of the last of five digits is up to 5e-5, of the third decimal 5e-4 K; twice that.
            let difference = match name {
                // Above 80 km the table of the model has the molecular-scale temperature, up to 0.07 K more.
                "t_amb_C" if altitude > 80_000.0 => (air.temperature - 273.15 - published).abs() / 0.07,
                "t_amb_C" => (air.temperature - 273.15 - published).abs() / 1e-3,
                "p_p0" => (air.pressure / 101_325.0 / published - 1.0).abs() / 1e-4,
                _ => (air.density / 1.225 / published - 1.0).abs() / 1e-4,
            };
            if MISTYPED.contains(&(altitude, name)) {
                assert!(difference > 50.0, "{altitude} {name} is right after all");
                mistyped += 1;
            } else {
                assert!(difference < 1.0, "{altitude} {name}: {published} {air:?}");
            }
        }
    }
    assert_eq!(mistyped, 3);
}
