//! The comparison with the model-reference estimator.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use phugoid_studies::reproduction::case_file::Case;
use phugoid_studies::reproduction::entries;
use phugoid_studies::reproduction::result::{Cell, Reproduction};

fn run(id: &str) -> Reproduction {
    let entry = entries().into_iter().find(|entry| entry.id == id).unwrap();
    let result = (entry.run)(id, &|_| ()).unwrap_or_else(|error| panic!("{id}: {error}"));
    assert_eq!(result.id, id);
    for table in &result.tables {
        println!("{}", table.title);
        for row in &table.rows {
            let cells = row.iter().map(|cell| match cell {
                Cell::Number(value) => format!("{value:.3}"),
                Cell::Text(text) => format!("{text:48}"),
            });
            println!("  {}", cells.collect::<Vec<_>>().join("  "));
        }
    }
    println!("{}", result.difference);
    for requirement in &result.requirements {
        println!("{requirement:?}");
        assert!(requirement.met, "{id}: {requirement:?}");
    }
    result
}

#[test]
fn scenario_1_is_found_by_both_and_scenario_2_by_ours_alone() {
    let (first, second) = (run("model-reference/1"), run("model-reference/2"));
    assert_eq!((first.requirements.len(), second.requirements.len()), (2, 2));
    assert!(first.golden.rows.len() == 40 && second.golden.rows.len() == 40);
    // The same case twice is the same to the bit.
    assert_eq!(format!("{first:?}"), format!("{:?}", run("model-reference/1")));
}

#[test]
fn a_copy_with_other_numbers_runs_and_mistakes_are_told() {
    let text = include_str!("../../../scenarios/thesis/model-reference-1.toml");
    let copy = text.replace("dCm_q = -10", "dCm_q = -4").replace("duration = \"20 s\"", "duration = \"8 s\"");
    let result = Case::parse(&copy, "copy.toml").unwrap().run("copy").unwrap();
    assert_eq!(result.outcomes[0].parameters[0].truth, -4.0);
    assert!(result.outcomes[0].parameters[0].converged_s.is_some_and(|t| t < 3.2), "{:?}", result.outcomes[0]);
    for (from, to, says) in [
        ("training = [-3, 3]", "training = [0]", "comparison.training"),
        ("start = 0", "start = 13", "comparison.start 13"),
        ("bounds = [-12, 12]", "bounds = [12, -12]", "comparison.bounds 12 to -12"),
        ("dCm_q = -10", "dCm_q = -10\ndCm_alpha = -0.1", "dCm_alpha"),
        ("dCm_q = -10", "dCm_q = 0", "dCm_q"),
        ("lambda = 10", "lamda = 10", "did you mean `lambda`"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = Case::parse(&text.replace(from, to), "copy.toml").unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("copy.toml"), "{error}");
    }
}

/// A hundred truths of both signs; a tenth of a second each in an unoptimised build.
#[test]
fn over_random_truths_the_flagship_finds_most_and_soonest() {
    let result = run("model-reference/random");
    assert_eq!(result.requirements.len(), 4);
}
