//! The cases with published figures, embedded.

/// F-16 in calm air at 20,000 ft and 675 ft/s, 3-2-1-1 of 1.5 deg, realistic sensors.
pub const CALM_SCENARIO: &str = include_str!("../../../scenarios/f16-calm.toml");
/// What its estimator is told.
pub const CALM_MODEL: &str = include_str!("../../../scenarios/f16-model.toml");
/// A doublet of 0.05 deg without sensor noise.
pub const THESIS_DOUBLET: &str = include_str!("../../../scenarios/f16-thesis-doublet.toml");
/// A sine of 0.05 deg at 1 Hz without sensor noise.
pub const THESIS_SINE: &str = include_str!("../../../scenarios/f16-thesis-sine.toml");
/// What the estimator is told in both.
pub const THESIS_MODEL: &str = include_str!("../../../scenarios/f16-thesis-model.toml");
/// Damage at 10 s under a pilot's random stick.
pub const DAMAGE_SCENARIO: &str = include_str!("../../../scenarios/f16-damage.toml");
/// What its estimator is told.
pub const DAMAGE_MODEL: &str = include_str!("../../../scenarios/f16-damage-model.toml");
/// Gusts, actuators and poor sensors.
pub const GUST_SCENARIO: &str = include_str!("../../../scenarios/f16-gust-actuators.toml");
/// What its estimator is told.
pub const GUST_MODEL: &str = include_str!("../../../scenarios/f16-gust-model.toml");
/// A failure at 10 s, for the health monitor.
pub const FAILURE_SCENARIO: &str = include_str!("../../../scenarios/f16-failure.toml");
/// Scenario of the same aircraft without any change of its coefficients.
pub const HEALTHY_SCENARIO: &str = include_str!("../../../scenarios/f16-healthy.toml");
/// What their estimator and monitor are told.
pub const HEALTH_MODEL: &str = include_str!("../../../scenarios/f16-health-model.toml");

/// The F-16 with five increments and six sensor biases: what the study of change detection tells its estimator.
pub const F16_MODEL: &str = include_str!("../../../data/models/f16.toml");
