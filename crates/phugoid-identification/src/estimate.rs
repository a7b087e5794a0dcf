//! From a flight record and a model file to parameters with bounds: the whole pipeline.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;

use crate::estimation::Estimation;
use crate::model_file::ModelFile;

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

/// Why an estimation could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// A channel that the model needs is not in the record.
    #[error("{0}")]
    MissingChannel(String),
}

/// Estimates the parameters of `model` from `record`, sample by sample as an on-board computer would.
/// `progress` is called with the fraction done, 0 to 1.
///
/// # Errors
/// [`EstimateError`]: a missing channel, too few samples, units that are certainly wrong, too many parameters.
pub fn estimate(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Estimation, EstimateError> {
    let _ = (model, options, record);
    progress(0.0);
    Err(EstimateError::MissingChannel("the pipeline is not connected yet".to_owned()))
}
