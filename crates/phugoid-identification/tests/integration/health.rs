//! Expectations in model files, and a monitored record from end to end.
#![allow(clippy::unwrap_used, clippy::panic)]

use phugoid_identification::model_file::{Expectation, ModelFile};

const F16: &str = include_str!("../../../../data/models/f16.toml");
const HFB320: &str = include_str!("../../../../data/models/hfb320.toml");

fn with(section: &str) -> Result<ModelFile, String> {
    ModelFile::parse("mine.toml", &format!("{F16}\n{section}")).map_err(|e| e.to_string())
}

#[test]
fn expectations_come_from_the_section_or_from_the_start_values() {
    let model =
        with("[expected]\ndCm_q = { tolerance = 0.5 }\ndCL_alpha = { value = 0.1, tolerance = 0.2, failure_std = 1 }")
            .unwrap();
    let found = model.expectations();
    let dcm_q = Expectation { name: "dCm_q".to_owned(), value: 0.0, tolerance: 0.5, failure_std: None };
    assert_eq!(found.len(), 2);
    assert!(found.contains(&dcm_q));
    assert!(found.iter().any(|e| e.name == "dCL_alpha" && (e.value, e.failure_std) == (0.1, Some(1.0))));
    // Without the section: the tables, within a tenth of the prior sigma; a build-up within a tenth of itself. No biases.
    let found = with("").unwrap().expectations();
    assert_eq!(found.len(), 5);
    let dcm_alpha = found.iter().find(|e| e.name == "dCm_alpha").unwrap();
    assert!(dcm_alpha.value == 0.0 && (dcm_alpha.tolerance - 0.025).abs() < 1e-12);
    let hfb = ModelFile::parse("hfb320", HFB320).unwrap();
    let start = hfb.parameters.iter().find(|p| p.name == "CL_alpha").unwrap().start;
    let expected = hfb.expectations();
    let cl_alpha = expected.iter().find(|e| e.name == "CL_alpha").unwrap();
    assert!(cl_alpha.value == start && (cl_alpha.tolerance - 0.1 * start.abs()).abs() < 1e-12);
}

#[test]
fn mistakes_in_expectations_are_told_with_their_place() {
    let refused = |section: &str| with(section).unwrap_err();
    let message = refused("[expected]\ndCm_qq = { tolerance = 1 }");
    assert!(message.contains("did you mean `dCm_q`") && message.starts_with("mine.toml:"), "{message}");
    assert!(refused("[expected]\ndCm_q = { value = 1 }").contains("tolerance = 0.05"));
    assert!(refused("[expected]\ndCm_q = { tolerance = 0 }").contains("more than zero"));
    assert!(refused("[expected]\ndCm_q = { tolerence = 1 }").contains("did you mean `tolerance`"));
    assert!(refused("[expected]\ndCm_q = { tolerance = 1, value = 7 }").contains("outside its bounds"));
    assert!(refused("[expected]\nbias_alpha = { tolerance = 1 }").contains("not monitored"));
    assert!(refused("[expected]").contains("empty"));
    assert!(refused("[expected]\ndCm_q = 3").contains("table"));
}

#[test]
fn expectations_may_have_a_file_of_their_own() {
    let model = with("").unwrap();
    let found = model.parse_expected("expected.toml", "[expected]\ndCm_q = { tolerance = 0.5 }").unwrap();
    assert_eq!(found.len(), 1);
    let refused = |text: &str| model.parse_expected("expected.toml", text).unwrap_err().to_string();
    assert!(refused("").contains("[expected]"));
    assert!(refused("[expect]\n").contains("did you mean `expected`"));
    assert!(refused("[expected]\ndCm_q = { tolerance = 0.5").starts_with("expected.toml:2"));
}
