//! Terms in the flap (equations 2.28 to 2.30 of the thesis): flown as what they add to the coefficients, and estimated as terms
//! of a further input.

use phugoid_flight_data::record::Channel;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// Flap deflection from 9 s on, rad, and the derivatives that are flown, per radian.
const FLAP: f64 = 0.2;
const FLOWN: [(&str, f64); 3] = [("CL", 0.4), ("CD", 0.06), ("Cm", -0.05)];
const EXTENDED_S: f64 = 9.0;

#[test]
fn a_flap_is_flown_as_constants_and_estimated_as_an_input() {
    let scenario = include_str!("../../../../scenarios/f16-calm.toml");
    let added: Vec<String> = FLOWN.iter().map(|(name, slope)| format!("{name} = {:?}", slope * FLAP)).collect();
    // A damage stands in place of the increments from the start, which go on here.
    let (_, increments) = scenario.split_once("[increments]\n").unwrap();
    let increments = increments.lines().take_while(|line| line.starts_with('d')).collect::<Vec<_>>().join(", ");
    let scenario = format!(
        "{scenario}\n[[damage]]\nat = \"{EXTENDED_S} s\"\nincrements = {{ {increments} }}\nconstants = {{ {} }}\n",
        added.join(", ")
    );
    let flight = fly(&Scenario::parse(&scenario, "flap").unwrap()).unwrap();
    let mut record = flight.measured;
    let flap = record.time.iter().map(|time| if *time < EXTENDED_S - 1e-9 { 0.0 } else { FLAP }).collect();
    let pattern = record.channel("elevator").unwrap().clone();
    record.channels.push(Channel { name: "flap".into(), values: flap, ..pattern });

    let mut text =
        ModelFile::text("f16-model").unwrap().replace("base = \"f16\"", "base = \"f16\"\ninputs = [\"flap\"]");
    for (coefficient, _) in FLOWN {
        let list = format!("\n{coefficient} = [\"alpha\"");
        assert!(text.contains(&list), "{coefficient}");
        text = text.replace(&list, &format!("{list}, \"flap\""));
    }
    let parameters = FLOWN.map(|(name, _)| format!("d{name}_flap = {{ bounds = [-1, 1] }}\n")).concat();
    text = text.replace("[parameters]", &format!("[parameters]\n{parameters}#"));
    let model = ModelFile::parse("flap.toml", &text).unwrap();
    for method in [Method::Smpe, Method::OutputError] {
        let options =
            EstimateOptions { method: Some(method), change_detection: Some(false), ..EstimateOptions::default() };
        let found = estimate(&record, &model, &options, &mut |_| ()).unwrap();
        for (name, slope) in FLOWN {
            let p = found.parameter(&format!("d{name}_flap")).unwrap();
            println!("{method} {}: {:.4} +- {:.4}, flown {slope}", p.name, p.value, 2.0 * p.corrected_std_error);
            assert!((p.value - slope).abs() < 3.0 * p.corrected_std_error, "{method} {}: {}", p.name, p.value);
            assert!(p.corrected_std_error < 0.1 * slope.abs(), "{method} {}: {}", p.name, p.corrected_std_error);
        }
    }
}
