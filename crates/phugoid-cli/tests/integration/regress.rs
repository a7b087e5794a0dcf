//! `phugoid regress`: the terms of a coefficient from a flight.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};

#[test]
fn the_increments_of_a_simulated_flight_are_selected_and_written_as_a_model() {
    let folder = Folder::new("regress");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let base = ["regress", "measured.csv", "--model", "f16-model", "--coefficient", "Cm"];
    for criterion in ["pse", "press", "f"] {
        let json = phugoid(&folder.0, &[&base[..], &["--criterion", criterion, "--json"]].concat()).json();
        let terms = json["terms"].as_array().unwrap();
        let value = |name: &str| {
            let term = terms.iter().find(|t| t["parameter"] == name).unwrap_or_else(|| panic!("{criterion}: {json}"));
            (term["value"].as_f64().unwrap(), term["std_error"].as_f64().unwrap())
        };
        // Flown with -0.2 and -2 per rad. Noise in the regressors draws them towards zero by a tenth at the most.
        for (name, truth) in [("dCm_alpha", -0.2), ("dCm_q", -2.0)] {
            let (found, sigma) = value(name);
            assert!(
                (found - truth).abs() < 3.0 * sigma + 0.1 * f64::abs(truth),
                "{criterion} {name}: {found} +- {sigma}"
            );
        }
        assert!(terms.len() <= 4, "{criterion}: {json}");
    }
    let text = phugoid(&folder.0, &base).out;
    for words in ["partial F", "[coefficients]", "Cm = [\"1\"", "dCm_alpha = { start = -0."] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let wrong = |more: &[&str]| phugoid(&folder.0, &[&base[..], more].concat());
    assert!(wrong(&["--candidates", "alhpa"]).fails(3).contains("did you mean `alpha`?"));
    assert!(wrong(&["--up-to", "7"]).fails(3).contains("and there is room for"));
    let coefficient = phugoid(&folder.0, &["regress", "measured.csv", "--model", "f16-model", "--coefficient", "cm"]);
    assert!(coefficient.code == Some(2) && coefficient.err.contains("write one of CL, CD, Cm"), "{}", coefficient.err);
    let lateral = phugoid(&folder.0, &["regress", "measured.csv", "--model", "f16-model", "--coefficient", "Cn"]);
    assert!(lateral.fails(3).contains("has CL, CD, Cm"));
}
