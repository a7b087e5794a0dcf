//! Plants of a user's own, given by formulas, run as cases.

use phugoid_thesis::case_file::Case;
use phugoid_thesis::plant_case::published_case;
use phugoid_thesis::result::{Behaviour, Reproduction};

/// The example of the documents.
const EXAMPLE: &str = include_str!("../../../../scenarios/own-plant.toml");

fn run(text: &str) -> Reproduction {
    Case::parse(text, "test.toml").unwrap().run("test").unwrap()
}

fn behaviour<'a>(result: &'a Reproduction, method: &str) -> Option<&'a Behaviour> {
    result.outcomes.iter().find(|outcome| outcome.method == method).map(|outcome| &outcome.behaviour)
}

#[test]
fn the_example_runs_with_all_methods_and_the_flagship_finds_its_parameters() {
    let result = run(EXAMPLE);
    assert_eq!(behaviour(&result, "flagship"), Some(&Behaviour::Converges));
    assert_eq!(behaviour(&result, "extended law"), Some(&Behaviour::Converges));
    assert!(behaviour(&result, "printed law, implicit").is_some());
    let flagship = &result.outcomes[0];
    for (found, truth) in flagship.parameters.iter().zip([16.0, 3.0]) {
        assert!((found.end / truth - 1.0).abs() < 1e-6, "{} {}", found.name, found.end);
    }
    let states = result.charts.iter().find(|chart| chart.name == "states").unwrap();
    assert!(states.caption.contains("v' = (u - k*x - c*v*abs(v)) / m"), "{}", states.caption);
}

/// A plant of the thesis written as formulas gives what the thesis's plant gives, with every method.
#[test]
fn a_plant_of_the_thesis_as_formulas_is_that_plant() {
    for (id, built_in, own) in [
        (
            "second-order-nonlinear/1",
            "type = \"second-order-nonlinear\"",
            "type = \"own\"\nstates = [\"x\", \"v\"]\nparameters = [\"a1\", \"a2\"]\nrates.x = \"v\"\nrates.v = \"-a2*v - a1*x^2 + u\"",
        ),
        (
            "first-order/1",
            "type = \"first-order\"",
            "type = \"own\"\nstates = [\"x\"]\nparameters = [\"a\"]\nrates.x = \"-a*x + u\"",
        ),
    ] {
        let expected = published_case(id).unwrap().run(id).unwrap();
        let text = phugoid_thesis::case_text(id).unwrap();
        assert!(text.contains(built_in));
        let found = run(&text.replace(built_in, own));
        assert_eq!(found.outcomes.len(), expected.outcomes.len());
        for (found, expected) in found.outcomes.iter().zip(&expected.outcomes) {
            assert_eq!((&found.method, found.behaviour), (&expected.method, expected.behaviour), "{id}");
            if found.behaviour != Behaviour::Converges {
                continue;
            }
            for (a, b) in found.parameters.iter().zip(&expected.parameters) {
                assert!((a.end / b.end - 1.0).abs() < 1e-6, "{id} {}: {} {}", found.method, a.end, b.end);
                assert_eq!(a.converged_s, b.converged_s, "{id} {}", found.method);
            }
        }
    }
}

/// With the position alone the flagship finds the spring and the drag, and the result says which methods do not run.
#[test]
fn outputs_that_leave_a_state_out_leave_the_flagship() {
    let result = run(&EXAMPLE.replace("\n[parameters.k]", "outputs.position = \"x\"\n\n[parameters.k]"));
    assert_eq!(result.outcomes.len(), 1);
    assert_eq!(behaviour(&result, "flagship"), Some(&Behaviour::Converges));
    assert!(
        result.difference.contains("need every state measured, and `outputs` does not give v"),
        "{}",
        result.difference
    );
}

#[test]
fn mistakes_are_answered_with_what_to_write() {
    for (from, to, words) in [
        ("c*v*abs(v)", "c*v*abbs(v)", "character 16: unknown function `abbs`: did you mean `abs`?"),
        ("c*v*abs(v)", "c*c*v", "is not linear in the unknown parameters"),
        ("[parameters.c]", "[parameters.cc]", "the plant has no parameter `cc`: did you mean `c`?"),
        ("rates.x", "rats.x", "unknown field `rats`: did you mean `rates`?"),
    ] {
        let error = Case::parse(&EXAMPLE.replace(from, to), "mine.toml").unwrap_err().to_string();
        assert!(error.contains(words) && error.contains("mine.toml"), "{to}: {error}");
    }
    let no_number = EXAMPLE.replace("c*v*abs(v)", "c*v*ln(x)");
    let error = Case::parse(&no_number, "mine.toml").unwrap().run("mine").unwrap_err().to_string();
    assert!(error.contains("is no number"), "{error}");
    let escapes = EXAMPLE.replace("- c*v*abs(v)", "+ c*v*v*v*20");
    let error = Case::parse(&escapes, "mine.toml").unwrap().run("mine").unwrap_err().to_string();
    assert!(error.contains("the plant escapes at"), "{error}");
}
