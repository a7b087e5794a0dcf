//! Groups of cases: their titles, and what to read beside them.

/// Cases that belong together: the part of their ids before the slash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// The part of the id before the slash.
    pub id: &'static str,
    /// Title of the group in reports.
    pub title: &'static str,
    /// Headings of `docs/theory.md` to read beside its cases.
    pub theory: &'static [&'static str],
    /// Source files to read beside its cases, from the root of the repository.
    pub code: &'static [&'static str],
}

/// Where the estimators and the printed laws are explained.
const LAWS: &[&str] = &["SMPE: the sliding-mode parameter estimator", "The law as the thesis prints it"];
/// What a flight with noise can tell.
const SENSORS: &[&str] = &["SMPE: the sliding-mode parameter estimator", "Bounds", "The Cramer-Rao bound"];

const ONE_PARAMETER: &str = "crates/phugoid-thesis/src/laws/one_parameter.rs";
const TWO_PARAMETERS: &str = "crates/phugoid-thesis/src/laws/two_parameter.rs";
const EXTENDED: &str = "crates/phugoid-thesis/src/laws/extended.rs";
const SMPE: &str = "crates/phugoid-estimators/src/smpe/mod.rs";
const FLIGHT: &str = "crates/phugoid-simulation/src/flight.rs";

const fn group(
    id: &'static str,
    title: &'static str,
    theory: &'static [&'static str],
    code: &'static [&'static str],
) -> Group {
    Group { id, title, theory, code }
}

/// What stands for a case of a user's own, whose id has no known group.
const OWN: Group = group("own", "Cases of your own", &[], &[]);

/// To read beside the cases with the F-16.
const AIRCRAFT_THEORY: &[&str] =
    &["2. The aircraft as a model that is linear in its parameters", "10. The law as the thesis prints it"];
const AIRCRAFT_CODE: &[&str] = &["crates/phugoid-thesis/src/aircraft_case/law.rs", ONE_PARAMETER, SMPE];

/// All groups, in the order of the report.
pub const GROUPS: &[Group] = &[
    group("trim", "Trim", &[], &["crates/phugoid-flight-dynamics/src/trim.rs"]),
    group("gust", "Gusts", &[], &["crates/phugoid-flight-dynamics/src/gust.rs", FLIGHT]),
    group(
        "first-order",
        "First-order plant",
        LAWS,
        &["crates/phugoid-thesis/src/plants/first_order.rs", ONE_PARAMETER, SMPE],
    ),
    group(
        "first-order-nonlinear",
        "Nonlinear first-order plant",
        LAWS,
        &["crates/phugoid-thesis/src/plants/first_order_nonlinear.rs", ONE_PARAMETER, SMPE],
    ),
    group(
        "second-order",
        "Second-order plant",
        LAWS,
        &["crates/phugoid-thesis/src/plants/second_order.rs", TWO_PARAMETERS, EXTENDED, SMPE],
    ),
    group(
        "second-order-nonlinear",
        "Nonlinear second-order plant",
        LAWS,
        &["crates/phugoid-thesis/src/plants/second_order_nonlinear.rs", TWO_PARAMETERS, EXTENDED, SMPE],
    ),
    group(
        "noise",
        "Nonlinear second-order plant in noise",
        LAWS,
        &["crates/phugoid-thesis/src/plants/second_order_nonlinear.rs", TWO_PARAMETERS, SMPE],
    ),
    group("dcm-alpha", "F-16: static stability, dC_m_alpha", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("dcm-q", "F-16: pitch damping, dC_m_q", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("dcl-alpha", "F-16: lift slope, dC_L_alpha", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("dcd-alpha", "F-16: drag slope, dC_D_alpha", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("combined", "F-16: all four coefficients at once", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("sensors", "F-16 with realistic sensors", SENSORS, &["crates/phugoid-evaluation/src/cramer_rao.rs", SMPE]),
    group("pilot", "A pilot's continuous input", SENSORS, &["crates/phugoid-simulation/src/manoeuvre.rs", SMPE]),
    group(
        "model-reference",
        "Comparison with a model-reference estimator",
        &["SMPE: the sliding-mode parameter estimator"],
        &["crates/phugoid-thesis/src/model_reference.rs", SMPE],
    ),
    group(
        "laws",
        "The printed laws, studied",
        &["The law as the thesis prints it"],
        &[ONE_PARAMETER, TWO_PARAMETERS, "crates/phugoid-thesis/src/laws/diagnostics.rs"],
    ),
    group(
        "tuning",
        "Choosing the gains",
        &[],
        &["crates/phugoid-thesis/src/tune/rule.rs", "crates/phugoid-evaluation/src/tune/objective.rs"],
    ),
    group("health", "Health monitoring", &["Bounds"], &[]),
];

/// The group of an id.
pub fn group_of(id: &str) -> &'static Group {
    let name = id.split('/').next().unwrap_or(id);
    GROUPS.iter().find(|group| group.id == name).unwrap_or(&OWN)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn what_is_to_be_read_beside_a_case_exists() {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let theory = std::fs::read_to_string(root.join("docs/theory.md")).unwrap();
        let headings: Vec<&str> = theory.lines().filter(|line| line.starts_with('#')).collect();
        for group in GROUPS {
            for wanted in group.theory {
                assert!(headings.iter().any(|h| h.ends_with(wanted)), "{}: no heading `{wanted}`", group.id);
            }
            for file in group.code {
                assert!(root.join(file).is_file(), "{}: no file {file}", group.id);
            }
        }
    }
}
