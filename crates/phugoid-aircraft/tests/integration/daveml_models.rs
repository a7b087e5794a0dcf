//! Models of others: every check case that they carry, and the same as it was written down apart from them.

use phugoid_aircraft::daveml::{Model, Role};
use phugoid_flight_dynamics::scalar::Dual;
use serde_json::Value;

use crate::shared_data::shared_file;

fn model(name: &str) -> Option<Model> {
    shared_file(name).map(|file| Model::open(file).unwrap_or_else(|error| panic!("{error}")))
}

/// Asserts that every shot of a model passes, internal values too, and answers how many there are.
fn all_pass(name: &str, model: &Model) -> usize {
    let report = model.check();
    let failures: Vec<String> = report
        .failures()
        .map(|(shot, signal)| {
            format!(
                "{name}, {}, {}: {} expected {} +- {}",
                shot.name, signal.id, signal.found, signal.expected, signal.tolerance
            )
        })
        .collect();
    assert!(failures.is_empty(), "{failures:#?}");
    assert_eq!(report.shots_passed(), report.shots.len());
    report.shots.len()
}

#[test]
fn all_shots_of_the_examples_pass() {
    for (name, shots) in [
        ("atmos_76", 42),
        ("comparison_functions", 5),
        ("fiveD_table", 9),
        ("limited_variableDef", 5),
        ("switch_logic", 14),
        ("twoD_ungridded", 4),
    ] {
        let Some(model) = model(&format!("daveml/{name}.dml")) else { return };
        assert_eq!(all_pass(name, &model), shots, "{name}");
    }
}

#[test]
fn all_shots_of_the_f16_pass() {
    for (name, shots) in [
        ("F16_aero", 16),
        ("F16_aero_2010_modJ_cg_included", 17),
        ("F16_control", 0),
        ("F16_gnc", 0),
        ("F16_inertia", 0),
        ("F16_prop", 9),
    ] {
        let Some(model) = model(&format!("checks/daveml_s119/{name}.dml")) else { return };
        assert_eq!(all_pass(name, &model), shots, "{name}");
        // One of them has `<math>` in a description, and is no XML.
        let repaired: &[u32] = if name == "F16_aero_2010_modJ_cg_included" { &[135] } else { &[] };
        assert_eq!(model.repaired_lines(), repaired, "{name}");
    }
}

#[test]
fn all_check_data_beside_the_f16_hold() {
    let mut compared = 0;
    for name in ["aero", "control", "gnc", "inertia", "prop"] {
        let Some(model) = model(&format!("checks/daveml_s119/F16_{name}.dml")) else { return };
        let Some(cases) = shared_file(&format!("checks/daveml_s119/F16_{name}_checkdata.json")) else { return };
        let cases: Value = serde_json::from_str(&std::fs::read_to_string(cases).unwrap()).unwrap();
        let mut evaluator = model.evaluator();
        for case in cases.as_array().unwrap() {
            evaluator.reset();
            for (input, signal) in case["checkInputs"].as_object().unwrap() {
                let position = model.input_position(input).unwrap();
                assert!(evaluator.set(position, signal["value"].as_f64().unwrap()));
            }
            evaluator.run();
            for list in ["internalValues", "checkOutputs"] {
                for (output, signal) in case[list].as_object().into_iter().flatten() {
                    let (expected, tolerance) = (signal["value"].as_f64().unwrap(), signal["tol"].as_f64());
                    let found = evaluator.get(model.position(output).unwrap());
                    assert!(
                        (found - expected).abs() <= tolerance.unwrap_or(1e-9),
                        "F16_{name}, {}, {output}: {found}, expected {expected}",
                        case["name"]
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn the_models_of_the_nesc_cases_read() {
    for name in ["brick_aero", "brick_inertia", "cannonball_aero", "cannonball_inertia"] {
        let Some(model) = model(&format!("nesc/models/{name}.dml")) else { return };
        assert_eq!(all_pass(name, &model), 0);
        let mut evaluator = model.evaluator();
        for position in model.input_positions() {
            assert!(evaluator.set(*position, 1.0));
        }
        evaluator.run();
        assert!(model.outputs().len() > 0, "{name}");
        assert!(model.output_positions().iter().all(|position| evaluator.get(*position).is_finite()), "{name}");
    }
}

#[test]
fn what_a_model_says_of_itself_is_read() {
    let Some(model) = model("checks/daveml_s119/F16_prop.dml") else { return };
    assert_eq!(model.header().name, "F-16 propulsion model (a la Stevens & Lewis)");
    assert_eq!(model.header().authors[0].0, "Bruce Jackson");
    let names: Vec<&str> = model.inputs().map(|variable| variable.id.as_str()).collect();
    assert_eq!(names, ["PWR", "ALT", "RMACH"]);
    let thrust = model.variable("thrustBodyForce_X").unwrap();
    assert_eq!((thrust.id.as_str(), thrust.units.as_str(), thrust.role), ("FEX", "lbf", Role::Computed));
    assert_eq!(model.variable("MIL_PWR").unwrap().role, Role::Constant);
    assert_eq!(model.functions().len(), 3);
    assert_eq!(model.outputs().len(), 6);
    assert!(model.input_position("FEX").is_err() && model.position("nothing").is_err());
}

/// Exact derivatives of all outputs of the F-16 by all inputs against differences.
#[test]
fn derivatives_are_exact() {
    let Some(model) = model("checks/daveml_s119/F16_aero.dml") else { return };
    let at = [300.0, 7.3, 2.1, 0.1, -0.2, 0.3, -3.0, 4.0, -5.0];
    let inputs = model.input_positions();
    assert_eq!(inputs.len(), at.len());
    let mut dual = model.evaluator_of::<Dual<9>>();
    for (k, (position, value)) in inputs.iter().zip(at).enumerate() {
        assert!(dual.set(*position, Dual::variable(value, k)));
    }
    dual.run();
    let mut plain = model.evaluator();
    for (k, changed) in inputs.iter().enumerate() {
        let mut with = |step: f64| {
            for (position, value) in inputs.iter().zip(at) {
                plain.set(*position, value);
            }
            plain.set(*changed, at[k] + step);
            plain.run();
            plain.values().to_vec()
        };
        let (above, below) = (with(1e-5), with(-1e-5));
        for position in model.output_positions() {
            let difference = (above[*position] - below[*position]) / 2e-5;
            let exact = dual.get(*position).derivatives[k];
            assert!((difference - exact).abs() < 1e-7, "{}: {exact}, {difference}", model.variables()[*position].id);
        }
    }
}
