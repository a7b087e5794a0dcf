//! The published cases with the F-16.
#![allow(clippy::unwrap_used)] // in helpers of tests: what goes wrong there fails the test

use phugoid_estimators::thesis::ThesisForm;
use phugoid_studies::reproduction::aircraft_case::{
    AircraftCase, LawForm, LawSettings, Method, MethodSettings, Surface, fly, run_method,
};
use phugoid_studies::reproduction::result::Role;
use phugoid_studies::settling::settled_at;

const FIRST: &str = include_str!("../../../scenarios/thesis/dcm-alpha-1.toml");

/// Flagship and damped law find the first case's increment within half a second of the input, as the thesis's law did, with
/// either sign of the truth; what the flagship claims covers its error.
#[test]
fn the_first_case_is_found_in_time_with_either_sign() {
    let other_sign = FIRST
        .replace("= -0.0015", "= 0.0015")
        .replace("= -0.003", "= 0.0005")
        .replace("upper = -0.0005", "upper = 0.003");
    for text in [FIRST, &other_sign] {
        let case = AircraftCase::parse(text, "dcm-alpha/1").unwrap();
        let flight = fly(&case).unwrap();
        let truth = case.truth("dCm_alpha");
        let told = case.parameters["dCm_alpha"];
        let law = LawSettings {
            parameter: "dCm_alpha",
            form: LawForm::Solved(ThesisForm::Damped),
            surface: Surface::Own,
            bounds: [told.lower, told.upper],
            start: told.start(),
            lambda: told.lambda,
            eta: told.damping,
        };
        let damped = MethodSettings { name: "damped".to_owned(), role: Role::Mended, method: Method::Law(law) };
        for method in [MethodSettings::flagship(&case).unwrap(), damped] {
            let run = run_method(&case, &flight, &method).unwrap();
            let values = &run.parameters[0].values;
            assert!(
                (values[250] / told.start() - 1.0).abs() < 0.02,
                "{}: nothing to learn before the input",
                method.name
            );
            let settled = settled_at(&run.time_s, values, truth, 0.05);
            assert!(settled.is_some_and(|t| t > 3.0 && t <= 3.5), "{}: {settled:?}", method.name);
        }
    }
}
