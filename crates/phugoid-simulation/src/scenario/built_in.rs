//! The scenarios that the binary carries.

use super::{Scenario, ScenarioError};

/// The scenarios that are built in: name and text.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("f16-calm", include_str!("../../../../scenarios/f16-calm.toml")),
    ("f16-lateral", include_str!("../../../../scenarios/f16-lateral.toml")),
    ("f16-six", include_str!("../../../../scenarios/f16-six.toml")),
    ("f16-thesis-doublet", include_str!("../../../../scenarios/f16-thesis-doublet.toml")),
    ("f16-thesis-sine", include_str!("../../../../scenarios/f16-thesis-sine.toml")),
    ("f16-thesis-gust", include_str!("../../../../scenarios/thesis/f16-thesis-gust.toml")),
    ("f16-damage", include_str!("../../../../scenarios/f16-damage.toml")),
    ("f16-gust-actuators", include_str!("../../../../scenarios/f16-gust-actuators.toml")),
    ("f16-failure", include_str!("../../../../scenarios/f16-failure.toml")),
    ("f16-healthy", include_str!("../../../../scenarios/f16-healthy.toml")),
    ("f16-recovery", include_str!("../../../../scenarios/f16-recovery.toml")),
    ("hfb320", include_str!("../../../../scenarios/hfb320.toml")),
];

/// A built-in scenario by name.
pub fn built_in(name: &str) -> Option<Result<Scenario, ScenarioError>> {
    BUILT_IN.iter().find(|(n, _)| *n == name).map(|(n, text)| Scenario::parse(text, n))
}
