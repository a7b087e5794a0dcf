//! Equation error beside a filter, on foreign flights.

use std::path::Path;

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, Method, StructureSearch, estimate};
use phugoid_identification::estimation::{Estimation, EstimationStatus, FinalStatus, ReasonCode, VerdictReason};
use phugoid_identification::model_file::ModelFile;

/// CL_elevator of JSBSim's `pc7`, by least squares on the exact aerodynamics of the flight, per rad.
const CL_ELEVATOR: f64 = 0.2692;

/// A flight that is trimmed again on the way (`scripts/field/make.py`, develop, `retrim`), in which nothing changes.
fn by(method: Method) -> Estimation {
    with(EstimateOptions { method: Some(method), ..EstimateOptions::default() })
}

fn with(options: EstimateOptions) -> Estimation {
    with_model(options, "")
}

/// The same, with lines added to the model file.
fn with_model(options: EstimateOptions, lines: &str) -> Estimation {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let text = std::fs::read_to_string(tests.join("field/develop/pc7/longitudinal.toml")).unwrap();
    let model = ModelFile::parse("longitudinal.toml", &format!("{text}\n{lines}\n")).unwrap();
    let record = Record::open(tests.join("second-answer/pc7-retrim.csv")).unwrap();
    let options = EstimateOptions { structure: StructureSearch::Never, ..options };
    estimate(&record, &model, &options, &mut |_| ()).unwrap()
}

/// A small force that the vane's noise can hide. With noise levels from filters a decade apart in their process noise, both filters gave the elevator
/// almost twice its lift here.
#[test]
fn the_filters_and_equation_error_agree_on_a_small_derivative() {
    for method in [Method::Smpe, Method::Ekf] {
        let found = by(method);
        let lift = found.parameter("CL_elevator").unwrap();
        assert!((lift.value - CL_ELEVATOR).abs() < 2.0 * lift.corrected_std_error, "{method}: {lift:?}");
        assert!((lift.value / CL_ELEVATOR - 1.0).abs() < 0.15, "{method}: {}", lift.value);
        assert_eq!(found.status, EstimationStatus::Sound, "{method}: {:?}", found.verdict);
    }
}

/// A model file that puts the process noise where none is (on the pitch angle alone): the filter gives the elevator twice its lift, with a random part of
/// the bound that does not hold it, and nothing in its residuals shows it. The equations of motion do.
#[test]
fn a_filter_that_is_wrong_is_in_doubt_by_equation_error() {
    let options = EstimateOptions { method: Some(Method::Smpe), ..EstimateOptions::default() };
    let found = with_model(options, "[process_noise]\ntheta = 1e-5\nadaptive = true");
    let lift = found.parameter("CL_elevator").unwrap();
    let off = (lift.value - CL_ELEVATOR).abs();
    assert!(off > 3.0 * lift.random_std(), "{} +- {}", lift.value, lift.random_std());

    assert_eq!(found.status, EstimationStatus::Doubtful, "{:?}", found.verdict);
    let reason = found.reasons.iter().find(|reason| reason.code == ReasonCode::MethodsDisagree).unwrap();
    assert!(reason.concerns.contains(&"CL_elevator".to_owned()), "{}", reason.sentence);
    assert!(reason.sentence.contains("by equation-error"), "{}", reason.sentence);
    assert!(found.parameters.iter().all(|p| p.status != FinalStatus::Converged));

    let second = found.second_answer.as_ref().unwrap();
    assert_eq!(second.method, Method::EquationError);
    let other = second.values.iter().find(|value| value.name == "CL_elevator").unwrap();
    assert!((other.value - CL_ELEVATOR).abs() < 2.0 * other.std_error, "{} +- {}", other.value, other.std_error);
}

/// Cm_elevator of JSBSim's `c310` after the change of the flight below, by least squares on the exact aerodynamics, per rad.
const C310_CM_ELEVATOR: f64 = -1.913;

/// A constant pitching moment that sets in at 28 s, while a pitch damper works (`scripts/field/make.py`, develop, the `c310`'s
/// `trim-shift`). One set of values for the whole flight makes the elevator look as if it did nothing (Cm_elevator -0.06 by equation
/// error, -0.18 by filter error; -1.9 is true), with bounds that do not hold it and equations that look constant. The filter finds
/// the change, and is the one that stands beside them.
#[test]
fn a_change_that_bends_a_batch_method_is_told_by_the_filter() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/second-answer");
    let model = ModelFile::open(tests.join("c310-longitudinal.toml")).unwrap();
    let record = Record::open(tests.join("c310-trim-shift.csv")).unwrap();
    for method in [Method::EquationError, Method::FilterError] {
        let by = |change_detection| {
            let options = EstimateOptions {
                method: Some(method),
                structure: StructureSearch::Never,
                change_detection,
                ..EstimateOptions::default()
            };
            estimate(&record, &model, &options, &mut |_| ()).unwrap()
        };
        let found = by(None);
        let elevator = found.parameter("Cm_elevator").unwrap();
        assert!(elevator.value - C310_CM_ELEVATOR > 10.0 * elevator.corrected_std_error, "{}", elevator.value);
        assert_eq!(found.status, EstimationStatus::Doubtful, "{method}: {:?}", found.verdict);
        let disagrees = |reason: &&VerdictReason| reason.code == ReasonCode::MethodsDisagree;
        let reason = found.reasons.iter().find(disagrees).unwrap();
        assert!(reason.concerns.contains(&"Cm_elevator".to_owned()), "{}", reason.sentence);
        assert!(reason.sentence.contains("by smpe") && reason.sentence.contains("in flight"), "{}", reason.sentence);
        let filter = found.third_answer.as_ref().or(found.second_answer.as_ref()).unwrap();
        assert_eq!(filter.method, Method::Smpe);
        let other = filter.values.iter().find(|value| value.name == "Cm_elevator").unwrap();
        assert!((other.value / C310_CM_ELEVATOR - 1.0).abs() < 0.1, "{} +- {}", other.value, other.std_error);
        // Whoever says that nothing changes is not told of changes; what the surfaces made of the motion is asked still.
        let of_elevator = |r: &&VerdictReason| r.concerns.contains(&"Cm_elevator".to_owned());
        let unchanging = by(Some(false));
        assert!(
            unchanging.reasons.iter().filter(disagrees).filter(of_elevator).all(|r| !r.sentence.contains("by smpe"))
        );
    }
}

/// What equation error says stands in the result, whether it agrees or not; beside a regression stands a filter, and beside a law
/// without bounds nothing.
#[test]
fn only_filters_have_equation_error_beside_them() {
    assert_eq!(by(Method::EquationError).second_answer.unwrap().method, Method::Smpe);
    assert_eq!(by(Method::Smpe).second_answer.unwrap().method, Method::EquationError);
    for regression in [Method::Rls, Method::Fourier] {
        assert_eq!(by(regression).second_answer.unwrap().method, Method::Smpe);
    }
    assert_eq!(by(Method::ModelReference).second_answer, None);
    // Nor has what a live session would have had.
    assert_eq!(with(EstimateOptions::causal()).second_answer, None);
}
