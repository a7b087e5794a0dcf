//! Choices of one estimation, and how much this build has room for.

use std::collections::BTreeMap;

/// Parameters, sensor biases included, that this build has room for.
pub const CAPACITY: usize = 24;

/// Estimator to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The sliding-mode parameter estimator on a parallel model (docs/theory.md).
    #[default]
    Smpe,
}

/// Choices of one estimation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EstimateOptions {
    /// Estimator.
    pub method: Method,
    /// Look for sudden changes of the parameters; none: as the model file says.
    pub re_reaching: Option<bool>,
    /// True values by parameter name, where the flight was simulated.
    pub truth: BTreeMap<String, f64>,
}
