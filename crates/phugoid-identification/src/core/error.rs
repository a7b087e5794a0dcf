//! Why an estimation could not be made.

use phugoid_flight_data::channels::by_name;

use phugoid_estimators::settings::SettingsError;

use super::method::Method;
use crate::batch::BatchError;

/// Why an estimation could not be made. The text says what to do about it.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::error::EstimateError;
/// use phugoid_identification::estimate::{EstimateOptions, estimate};
/// use phugoid_identification::model_file::ModelFile;
/// let columns = [("time_s", vec![0.0, 0.1]), ("elevatr_deg", vec![1.0, 2.0])];
/// let flight = Record::from_columns("test flight", columns)?;
/// let error = estimate(&flight, &ModelFile::named("f16")?, &EstimateOptions::default(), &mut |_| {}).unwrap_err();
/// assert!(matches!(&error, EstimateError::MissingChannel { channel, .. } if channel == "elevator"));
/// assert!(error.to_string().contains("channel `elevator` is missing"), "{error}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// A channel that the model needs is not in the record.
    #[error("{}", missing_channel(record, channel, present, nearest.as_deref(), lacking))]
    MissingChannel {
        /// Source of the record, e.g. its file name.
        record: String,
        /// Canonical name of the channel that is not there.
        channel: String,
        /// Canonical names of the channels that the record has.
        present: Vec<String>,
        /// The one among them with the most similar name.
        nearest: Option<String>,
        /// Further missing channels, and what the reader of the record says about them.
        lacking: Box<Lacking>,
    },
    /// A channel is in the record but has no finite value.
    #[error(
        "channel `{0}` has no finite value in the whole record: check the column in the file, or, if the model can do without it, leave \
         it out of `outputs` in the model file"
    )]
    EmptyChannel(String),
    /// An input is in the record but has no finite value.
    #[error(
        "input `{0}` has no finite value in the whole record, and the model cannot do without it: check the column in the file, or name \
         the column that holds it in the model file: [channels] {0} = \"your header\""
    )]
    EmptyInput(String),
    /// Every parameter of the model is fixed.
    #[error(
        "{model}: every parameter is fixed, so that there is nothing to estimate: take `fixed = true` from those under [parameters] that \
         the flight is to tell"
    )]
    AllFixed {
        /// Name of the model file.
        model: String,
    },
    /// There are too few samples for any estimation.
    #[error("the record has {samples} usable samples: at least 20 are needed")]
    TooShort {
        /// Samples in which every input has a value.
        samples: usize,
    },
    /// A channel has an impossible unit or sign.
    #[error("{}", units.join("\n"))]
    Units {
        /// What is wrong, one sentence for each channel concerned.
        units: Vec<String>,
    },
    /// The noise of an output cannot be measured.
    #[error(
        "the noise of `{0}` cannot be measured from the record: the channel does not move at the start of the record, or has fewer than \
         eleven values of its own there (twelve, if it is slower than the record), which a longer part of a flight has. Give it \
         under [noise] in the model file; if the model can do without `{0}`, leave it out of `outputs`"
    )]
    Noise(String),
    /// The model, the signals or the reference point cannot be made of the file and the record; the sentence says why.
    #[error("{0}")]
    Model(String),
    /// The estimator refuses the settings that follow from the model file.
    #[error("{0}")]
    Settings(SettingsError),
    /// A batch method was asked to estimate sample by sample.
    #[error(
        "{method} looks at a record as a whole; sample by sample works a causal method: {}",
        Method::ALL.iter().filter(|m| !m.is_batch()).map(|m| m.name()).collect::<Vec<_>>().join(", ")
    )]
    NotCausal {
        /// The method that was asked for.
        method: Method,
    },
    /// A causal method was given further records, or one to predict.
    #[error(
        "{method} takes one record, sample by sample: further records and a prediction need a batch method ({})",
        Method::ALL.iter().filter(|m| m.is_batch()).map(|m| m.name()).collect::<Vec<_>>().join(", ")
    )]
    OneRecordOnly {
        /// The method that was asked for.
        method: Method,
    },
    /// A band of frequencies was given to a method that uses none.
    #[error(
        "{method} works in the time domain: a band of frequencies is for {}",
        Method::ALL.iter().filter(|m| m.is_in_band()).map(|m| m.name()).collect::<Vec<_>>().join(" and ")
    )]
    NoBand {
        /// The method that was asked for.
        method: Method,
    },
    /// A health monitor was asked for together with a batch method.
    #[error("{method} sees the whole record at once: the health monitor needs a causal method")]
    MonitorNeedsCausal {
        /// The method that was asked for.
        method: Method,
    },
    /// An expectation was given for a parameter that the model does not estimate.
    #[error("`{name}` is expected, but the model does not estimate it")]
    NotMonitored {
        /// Name of the parameter as it was given.
        name: String,
    },
    /// Nothing moved beyond its noise, so that a batch method would fit the noise.
    #[error("no excitation: {movers} never move beyond their noise, and {method} would fit the noise. Fly {manoeuvre}")]
    NoExcitation {
        /// The method that was asked for.
        method: Method,
        /// What should have moved, in words.
        movers: &'static str,
        /// A manoeuvre that would move it, in words.
        manoeuvre: &'static str,
    },
    /// A batch method found no estimate; the inner error says why.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// A batch method found no estimate with the model's terms, and one with terms that the equations of motion ask for.
    #[error(
        "{error}\nThe equations of motion ask for {terms}, which the model lacks, and with that there is an estimate: add the \
         term to the model file, or let it be taken in (--structure auto)"
    )]
    LacksTerms {
        /// Why there is no estimate without them.
        error: BatchError,
        /// The terms and their coefficients, in words.
        terms: String,
    },
    /// More parameters than the estimator has room for.
    #[error(
        "the model has {wanted} parameters, sensor biases included; this build has room for {capacity}. Fix some \
         (fixed = true) or drop terms"
    )]
    TooManyParameters {
        /// Parameters of the model file that are not fixed.
        wanted: usize,
        /// Number of parameters that one estimation of these axes has room for: [`capacity`](super::options::capacity).
        capacity: usize,
    },
}

/// Further missing channels of a record, and the explanations of its reader.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lacking {
    /// Other channels that the model needs and that are not in the record.
    pub other_channels: Vec<String>,
    /// Findings of the reader of the record about the missing channels and the vehicle, with what to do.
    pub findings: Vec<String>,
    /// Where the model can do without some of the missing channels: a sentence with the line to write in the model file.
    pub dispensable: Option<String>,
    /// The line of the model file that asks for the channel, where it names it itself.
    pub asked_by: Option<String>,
}

fn missing_channel(
    record: &str,
    channel: &str,
    present: &[String],
    nearest: Option<&str>,
    Lacking { other_channels, findings, dispensable, asked_by }: &Lacking,
) -> String {
    let mut text = format!("{record}: channel `{channel}` is missing");
    if let Some(near) = nearest {
        text.push_str(&format!("; the nearest one there is `{near}`"));
    }
    if let Some(asked_by) = asked_by {
        text.push_str(&format!("; {asked_by} asks for it: correct the name there if it is misspelt"));
    }
    if !other_channels.is_empty() {
        text.push_str(&format!("; the model also needs `{}`, not there either", other_channels.join("`, `")));
    }
    let present = present.join(", ");
    if !findings.is_empty() {
        text.push_str(&format!(".\n  {}", findings.join("\n  ")));
        if let Some(dispensable) = dispensable {
            text.push_str(&format!("\n  {dispensable}"));
        }
        text.push_str(&format!("\nChannels in the record: {present}"));
        return text;
    }
    let synonyms = by_name(channel).map_or(&[][..], |spec| spec.synonyms);
    let or = if synonyms.is_empty() { String::new() } else { format!(" (or {})", synonyms.join(", ")) };
    text.push_str(&format!(
        ". Name a column `{channel}`{or} with its unit, or map one in the model file: [channels] {channel} = \"your \
         header\"."
    ));
    if let Some(dispensable) = dispensable {
        text.push_str(&format!(" {dispensable}"));
    }
    text.push_str(&format!(" Channels in the record: {present}"));
    text
}
