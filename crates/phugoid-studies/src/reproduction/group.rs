//! Groups of cases: their titles, and what to read beside them.

/// Cases that belong together: the part of their ids before the slash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// The part of the id before the slash.
    pub id: &'static str,
    /// Title.
    pub title: &'static str,
    /// Headings of `docs/theory.md` to read beside its cases.
    pub theory: &'static [&'static str],
    /// Source files to read beside its cases, from the root of the repository.
    pub code: &'static [&'static str],
}

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
const AIRCRAFT_CODE: &[&str] = &[
    "crates/phugoid-studies/src/reproduction/aircraft_case/law.rs",
    "crates/phugoid-estimators/src/thesis/one_parameter.rs",
    "crates/phugoid-estimators/src/smpe/mod.rs",
];

/// All groups, in the order of the report.
pub const GROUPS: &[Group] = &[
    group("trim", "Trim", &[], &[]),
    group("gust", "Gusts", &[], &[]),
    group("first-order", "First-order plant", &[], &[]),
    group("first-order-nonlinear", "Nonlinear first-order plant", &[], &[]),
    group("second-order", "Second-order plant", &[], &[]),
    group("second-order-nonlinear", "Nonlinear second-order plant", &[], &[]),
    group("noise", "Nonlinear second-order plant in noise", &[], &[]),
    group("dcm-alpha", "F-16: static stability, dC_m_alpha", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("dcm-q", "F-16: pitch damping, dC_m_q", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("dcl-alpha", "F-16: lift slope, dC_L_alpha", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("dcd-alpha", "F-16: drag slope, dC_D_alpha", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("combined", "F-16: all four coefficients at once", AIRCRAFT_THEORY, AIRCRAFT_CODE),
    group("sensors", "F-16 with realistic sensors", &[], &[]),
    group("pilot", "A pilot's continuous input", &[], &[]),
    group("model-reference", "Comparison with a model-reference estimator", &[], &[]),
    group("laws", "The printed laws, studied", &[], &[]),
    group(
        "tuning",
        "Choosing the gains",
        &[],
        &["crates/phugoid-studies/src/tune/rule.rs", "crates/phugoid-studies/src/tune/objective.rs"],
    ),
    group("health", "Health monitoring", &[], &[]),
];

/// The group of an id.
pub fn group_of(id: &str) -> &'static Group {
    let name = id.split('/').next().unwrap_or(id);
    GROUPS.iter().find(|group| group.id == name).unwrap_or(&OWN)
}
