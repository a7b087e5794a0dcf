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
    #[error("{}", missing_channel(record, channel, present, nearest.as_deref()))]
    MissingChannel {
        /// Source of the record.
        record: String,
        /// Canonical name of the channel that is not there.
        channel: String,
        /// Channels that are there.
        present: Vec<String>,
        /// The one among them with the most similar name.
        nearest: Option<String>,
    },
    /// A channel is there but has no value.
    #[error("channel `{0}` has no finite value in the whole record: check the column in the file")]
    EmptyChannel(String),
    /// Too few samples for anything.
    #[error("the record has {samples} usable samples: at least 20 are needed")]
    TooShort {
        /// Samples in which every input has a value.
        samples: usize,
    },
    /// A channel has an impossible unit or sign.
    #[error("{}", units.join("\n"))]
    Units {
        /// One sentence per channel.
        units: Vec<String>,
    },
    /// The noise of an output cannot be measured.
    #[error(
        "the noise of `{0}` cannot be measured from the record: the channel does not move, or has fewer than eleven \
         values at the start. Give it under [noise] in the model file, or leave `{0}` out of `outputs`"
    )]
    Noise(String),
    /// The model cannot be built.
    #[error("{0}")]
    Model(String),
    /// More parameters than the estimator has room for.
    #[error(
        "the model has {wanted} parameters, sensor biases included; this build has room for {capacity}. Fix some \
         (fixed = true) or drop terms"
    )]
    TooManyParameters {
        /// Parameters of the model file that are not fixed.
        wanted: usize,
        /// Capacity.
        capacity: usize,
    },
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
    Err(EstimateError::Model("the pipeline is not connected yet".to_owned()))
}

fn missing_channel(record: &str, channel: &str, present: &[String], nearest: Option<&str>) -> String {
    let mut text = format!("{record}: channel `{channel}` is missing");
    if let Some(near) = nearest {
        text.push_str(&format!("; the nearest one there is `{near}`"));
    }
    text.push_str(&format!(
        ". Name a column `{channel}` (with its unit), or map one in the model file: [channels] {channel} = \"your \
         header\". Channels in the record: {}",
        present.join(", ")
    ));
    text
}
