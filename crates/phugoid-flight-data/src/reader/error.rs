//! Errors of reading a flight.

use crate::csv;
use crate::format::{Format, build_with};
use crate::log::LogError;
use crate::profile::{FieldNameError, ProfileError};
use crate::table::TableError;

/// Why a flight could not be read. Every message says where, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system could not open or read the file or stream.
    #[error("{source_name}: cannot be read: {error}")]
    Io {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The format is known, but this build does not read it: it is never read, or its feature is switched off
    /// ([`Format::feature`]).
    #[error("{source_name}: this is {}; {}", format.in_words(), advice(*format))]
    NotRead {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The format of the file.
        format: Format,
    },
    /// It is compressed by gzip, and what is in it is read only where it is not compressed.
    #[error("{source_name}: {}: {command}", packed(*format))]
    Packed {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The format of what is in it.
        format: Format,
        /// The command that unpacks it.
        command: String,
    },
    /// Names were given for the columns of a file that names them itself.
    #[error(
        "{source_name}: names of columns were given (--columns), but this is {}, which names its columns itself. Leave them out; a \
         channel that has another name there is mapped in the model file: [channels] q = {{ header = \"name\", unit = \"rad/s\" }}",
        format.in_words()
    )]
    NamedInTheFile {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The format of the file.
        format: Format,
    },
    /// A workbook could not be read, or no record can be made of its sheet.
    #[cfg(feature = "excel")]
    #[error(transparent)]
    Excel(#[from] crate::excel::ReadError),
    /// A CSV file could not be read, or no record can be made of it.
    #[error(transparent)]
    Csv(#[from] csv::ReadError),
    /// No record can be made of the columns of a table or the signals of a log.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A log could not be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The profile that was given, or a built-in one, is not valid.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// A Parquet or Arrow file could not be read.
    #[cfg(feature = "parquet")]
    #[error(transparent)]
    Columnar(#[from] crate::parquet::ReadError),
    /// A MATLAB file could not be read.
    #[cfg(feature = "matlab")]
    #[error(transparent)]
    Matlab(#[from] crate::matlab::ReadError),
    /// A mapping names a topic or a field that is not in the log.
    #[error("{source_name}: channel '{channel}' is mapped to '{header}', but {problem}")]
    NoSuchField {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The channel that the mapping names.
        channel: String,
        /// The column or field that the mapping names.
        header: String,
        /// What is missing, and what the log has instead.
        problem: Box<FieldProblem>,
    },
    /// None of the topics whose times a record could take has two samples.
    #[error("{source_name}: no topic that could give the times of a record: none of {} has two samples. The log has: {present}", wanted.join(", "))]
    NoTimeBase {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// The topics that were looked for, in order of preference.
        wanted: Vec<String>,
        /// The topics that the log has, separated by commas; long lists are cut.
        present: String,
    },
    /// No field of the log is a channel by the profile or the mappings.
    #[error(
        "{source_name}: nothing in the log is a channel that is known to the profile '{profile}'. The log has: {present}. Map \
         fields in the model file: [channels] q = {{ header = \"topic.field\", unit = \"rad/s\" }}"
    )]
    NothingUsable {
        /// Name of the file or stream, as the caller gave it.
        source_name: String,
        /// Name of the profile that was used.
        profile: String,
        /// The topics that the log has, separated by commas; long lists are cut.
        present: String,
    },
}

/// Why a mapping finds no signal in a log.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldProblem {
    /// The header is neither the name of a field nor of the command of a surface.
    #[error(
        "{error}{}",
        if commands.is_empty() { String::new() } else { format!(", or one of the commands {}", commands.join(", ")) }
    )]
    Name {
        /// What is wrong with it as the name of a field.
        error: FieldNameError,
        /// The commands of surfaces that the log has.
        commands: Vec<String>,
    },
    /// The log has no topic of this name.
    #[error("the log has no topic '{topic}'{}. It has: {present}", did_you_mean(nearest))]
    UnknownTopic {
        /// The topic that was asked for.
        topic: String,
        /// The topic of the log with a similar name.
        nearest: Option<String>,
        /// The topics that the log has, separated by commas; long lists are cut.
        present: String,
    },
    /// The log has the topic, but not this instance of it.
    #[error(
        "the topic has the instances {} only",
        instances.iter().map(u16::to_string).collect::<Vec<_>>().join(", ")
    )]
    UnknownInstance {
        /// The instances that the log has.
        instances: Vec<u16>,
    },
    /// The topic has no field of this name.
    #[error("the topic '{topic}' has no such field{}. It has: {}", did_you_mean(nearest), fields.join(", "))]
    UnknownField {
        /// The topic that was asked for.
        topic: String,
        /// The field of the topic with a similar name.
        nearest: Option<String>,
        /// The fields that the topic has.
        fields: Vec<String>,
    },
    /// The field has no samples.
    #[error("it has no samples")]
    NoSamples,
    /// The mapping names no field at all.
    #[error("it names no field")]
    NoField,
    /// Fields that are to be added have different units, and the mapping does not state one.
    #[error(
        "it is in {}, and what it is added to, {first}, in {}: say with `unit` what the sum is in",
        unit.as_deref().unwrap_or("no unit"),
        first_unit.as_deref().unwrap_or("no unit")
    )]
    DifferentUnit {
        /// Unit of this field; `None` if the log states none.
        unit: Option<String>,
        /// The first field of the sum.
        first: String,
        /// Unit of the first field; `None` if the log states none.
        first_unit: Option<String>,
    },
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|near| format!(" (did you mean '{near}'?)")).unwrap_or_default()
}

fn packed(format: Format) -> String {
    match format {
        Format::Gzip => "it is compressed by gzip twice. Unpack it once".to_owned(),
        format => format!(
            "this is {}, compressed by gzip. Only tables as text are read compressed; unpack it first",
            format.in_words()
        ),
    }
}

fn advice(format: Format) -> String {
    if let Some(feature) = format.feature() {
        return format!("this build does not read it; {}. Or save it as CSV", build_with(feature));
    }
    let advice = match format {
        Format::Hdf5 => "it is not read. In MATLAB, save it with -v7, or write a table as CSV with writetable",
        Format::DataFlashText => "give the binary log (.BIN) that it was made of",
        _ => "it is not read. Save it as CSV",
    };
    advice.to_owned()
}

impl ReadError {
    /// Whether the file was read and lacks the variable or the sheet that was asked for ([`TableOptions::variable`]).
    ///
    /// [`TableOptions::variable`]: crate::table::TableOptions::variable
    pub fn is_without_variable(&self) -> bool {
        match self {
            #[cfg(feature = "excel")]
            Self::Excel(error) => matches!(error, crate::excel::ReadError::NoSheet { .. }),
            #[cfg(feature = "matlab")]
            Self::Matlab(error) => matches!(error, crate::matlab::ReadError::NoVariable { .. }),
            _ => false,
        }
    }
}
