//! From a flight record and a model file to parameters with bounds: the whole pipeline.

use std::collections::BTreeMap;

use phugoid_flight_data::channels::by_name;
use phugoid_flight_data::record::Record;

use crate::estimation::Estimation;
use crate::model_file::ModelFile;
use crate::noise::measure_noise;
use crate::output::{OUTPUTS, Output};
use crate::plausibility::{Certainty, Signals, check_units};
use crate::prepare::{Prepared, prepare};
use crate::run::run_smpe;
use crate::summary::summarise;

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

/// Estimates the parameters of `model` from `record`, sample by sample as an on-board computer would: no estimate uses
/// a later sample. (Measured noise levels, where the model file gives none, are those of the first two seconds, or of
/// the first 40 samples if that is longer.) `progress` is called with the fraction done, 0 to 1.
///
/// # Errors
/// [`EstimateError`]: a missing channel, too few samples, units that are certainly wrong, too many parameters.
pub fn estimate(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Estimation, EstimateError> {
    let wanted = model.estimated().count();
    if wanted > CAPACITY {
        return Err(EstimateError::TooManyParameters { wanted, capacity: CAPACITY });
    }
    let prepared = prepare(record, model)?;
    let doubts = check_units(&signals(record, model));
    let certain: Vec<String> =
        doubts.iter().filter(|d| d.certainty == Certainty::Certain).map(|d| d.message.clone()).collect();
    if !certain.is_empty() {
        return Err(EstimateError::Units { units: certain });
    }
    let noise = noise_levels(&prepared, model)?;
    let run = match options.method {
        Method::Smpe => run_smpe(&prepared, model, options, &noise, progress)?,
    };
    Ok(summarise(record, model, options, &prepared, &noise, run, &doubts))
}

/// Channels that the unit checks look at.
fn signals<'a>(record: &'a Record, model: &ModelFile) -> Signals<'a> {
    let sound = |name: &str| record.channel(name).filter(|c| c.values.len() == record.time.len());
    let values = |name: &str| sound(name).map_or(&[][..], |c| c.values.as_slice());
    let output = |o: Output| if model.outputs[o.index()] { values(o.name()) } else { &[] };
    Signals {
        time: &record.time,
        true_airspeed: output(Output::TrueAirspeed),
        alpha: output(Output::Alpha),
        theta: output(Output::Theta),
        q: output(Output::PitchRate),
        az: output(Output::Az),
        ax: output(Output::Ax),
        elevator: values("elevator"),
        altitude: values("altitude"),
    }
}

/// One sigma per output, and whether it was measured from the record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoiseLevel {
    pub(crate) std: f64,
    pub(crate) measured: bool,
}

fn noise_levels(prepared: &Prepared, model: &ModelFile) -> Result<[NoiseLevel; OUTPUTS], EstimateError> {
    let length = prepared.noise_samples();
    let mut levels = [NoiseLevel { std: 0.0, measured: false }; OUTPUTS];
    for output in Output::ALL.into_iter().filter(|o| model.outputs[o.index()]) {
        levels[output.index()] = match model.noise[output.index()] {
            Some(std) => NoiseLevel { std, measured: false },
            None => {
                let values: Vec<f64> = prepared.outputs[..length].iter().map(|y| y[output.index()]).collect();
                let found = measure_noise(&values).ok_or_else(|| EstimateError::Noise(output.name().to_owned()))?;
                NoiseLevel { std: found.std, measured: true }
            }
        };
    }
    Ok(levels)
}

fn missing_channel(record: &str, channel: &str, present: &[String], nearest: Option<&str>) -> String {
    let mut text = format!("{record}: channel `{channel}` is missing");
    if let Some(near) = nearest {
        text.push_str(&format!("; the nearest one there is `{near}`"));
    }
    let synonyms = by_name(channel).map_or(&[][..], |spec| spec.synonyms);
    let also = if synonyms.is_empty() { String::new() } else { format!(" (or {})", synonyms.join(", ")) };
    text.push_str(&format!(
        ". Name a column `{channel}`{also} with its unit, or map one in the model file: [channels] {channel} = \"your \
         header\". Channels in the record: {}",
        present.join(", ")
    ));
    text
}
