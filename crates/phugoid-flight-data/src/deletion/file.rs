//! A file of deletions, for one flight or for several.

use std::path::Path;

use serde::Deserialize;

use super::{Deletion, DeletionError};
use crate::printable;
use crate::quantity::{Dimension, QuantityError};

/// Deletions in a TOML file, for one flight or for several.
///
/// ```
/// use phugoid_flight_data::deletion::DeletionFile;
/// let text = r#"
/// [[delete]]
/// channel = "alpha"        # or a list of names; without it every channel
/// at = "12.34 s"
/// reason = "bird strike"
///
/// [[delete]]
/// flight = "second.csv"    # without it the flight that the command names first
/// from = "12.5 s"
/// to = "12.8 s"
/// reason = "telemetry dropout"
/// "#;
/// let file = DeletionFile::parse("bad-values.toml", text)?;
/// assert_eq!(file.of("flights/second.csv".as_ref(), false)[0].reason, "telemetry dropout");
/// assert_eq!(file.of("flights/first.csv".as_ref(), true)[0].to_string(), "alpha@12.34s: bird strike");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeletionFile {
    entries: Vec<(Option<String>, Deletion)>,
}

/// Why a file of deletions cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum DeletionFileError {
    /// The file cannot be opened.
    #[error("cannot read the deletions `{file}`: {error}")]
    Io {
        /// Its name.
        file: String,
        /// The system's error.
        #[source]
        error: std::io::Error,
    },
    /// It is no TOML, or has keys that are none of a deletion.
    #[error("{file}: {error}\nWrite [[delete]] tables with channel, at (or from and to), reason, and flight.")]
    Toml {
        /// Its name.
        file: String,
        /// What is wrong, with line and column.
        #[source]
        error: Box<toml::de::Error>,
    },
    /// A time of an entry is wrong or missing.
    #[error("{file}: entry {entry} of [[delete]]: {why}")]
    Entry {
        /// Its name.
        file: String,
        /// Number of the entry, from 1.
        entry: usize,
        /// What is wrong and what to write.
        why: String,
    },
    /// An entry is no deletion.
    #[error("{file}: entry {entry} of [[delete]]: {error}")]
    Deletion {
        /// Its name.
        file: String,
        /// Number of the entry, from 1.
        entry: usize,
        /// What is wrong.
        #[source]
        error: Box<DeletionError>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    #[serde(default)]
    delete: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    flight: Option<String>,
    channel: Option<Names>,
    at: Option<String>,
    from: Option<String>,
    to: Option<String>,
    #[serde(default)]
    reason: String,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Names {
    One(String),
    Several(Vec<String>),
}

impl DeletionFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`DeletionFileError`].
    pub fn open(path: &Path) -> Result<Self, DeletionFileError> {
        let file = printable::path(path);
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&file, &text),
            Err(error) => Err(DeletionFileError::Io { file, error }),
        }
    }

    /// Reads the text of a file with this name.
    ///
    /// # Errors
    /// [`DeletionFileError`].
    pub fn parse(file: &str, text: &str) -> Result<Self, DeletionFileError> {
        let document: Document = toml::from_str(text)
            .map_err(|error| DeletionFileError::Toml { file: file.to_owned(), error: Box::new(error) })?;
        let mut entries = Vec::with_capacity(document.delete.len());
        for (index, entry) in document.delete.into_iter().enumerate() {
            let wrong = |why: String| DeletionFileError::Entry { file: file.to_owned(), entry: index + 1, why };
            let time =
                |text: &str| Dimension::TIME.parse(text).map_err(|error: QuantityError| wrong(error.to_string()));
            let (from_s, to_s) = match (&entry.at, &entry.from, &entry.to) {
                (Some(at), None, None) => time(at).map(|at| (at, at))?,
                (None, Some(from), Some(to)) => (time(from)?, time(to)?),
                _ => {
                    return Err(wrong(
                        "write either at = \"12.34 s\", or from = \"12.3 s\" and to = \"12.8 s\"".to_owned(),
                    ));
                }
            };
            let channels = match entry.channel {
                None => Vec::new(),
                Some(Names::One(name)) => vec![name],
                Some(Names::Several(names)) if names.is_empty() => {
                    return Err(wrong("channel = [] names none; leave the key out for all channels".to_owned()));
                }
                Some(Names::Several(names)) => names,
            };
            let deletion = Deletion::new(channels, from_s, to_s, &entry.reason)
                .map_err(Box::new)
                .map_err(|error| DeletionFileError::Deletion { file: file.to_owned(), entry: index + 1, error })?;
            entries.push((entry.flight, deletion));
        }
        Ok(Self { entries })
    }

    /// The deletions of one flight: those that name its file (the whole path, or the end of it), and for the flight that
    /// a command names first also those that name none.
    pub fn of(&self, flight: &Path, is_first: bool) -> Vec<Deletion> {
        let fits = |named: &Option<String>| match named {
            Some(named) => flight.ends_with(named),
            None => is_first,
        };
        self.entries.iter().filter(|(named, _)| fits(named)).map(|(_, deletion)| deletion.clone()).collect()
    }

    /// The flights that the file names and that are none of these, each once.
    pub fn others(&self, flights: &[&Path]) -> Vec<&str> {
        let mut others: Vec<&str> = Vec::new();
        for named in self.entries.iter().filter_map(|(named, _)| named.as_deref()) {
            if !flights.iter().any(|flight| flight.ends_with(named)) && !others.contains(&named) {
                others.push(named);
            }
        }
        others
    }

    /// Number of deletions.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True without any deletion.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_in_a_file_is_named_with_its_entry() {
        for (text, words) in [
            ("[[delete]]\nchannel = \"alpha\"\nreason = \"ice\"", "entry 1 of [[delete]]: write either at"),
            ("[[delete]]\nat = \"1 s\"\nfrom = \"1 s\"\nreason = \"ice\"", "write either at"),
            ("[[delete]]\nat = \"1\"\nreason = \"ice\"", "has no unit"),
            ("[[delete]]\nat = \"1 s\"", "say why"),
            ("[[delete]]\nat = \"1 s\"\nresaon = \"ice\"", "unknown field `resaon`"),
            ("[[delete]]\nat = \"1 s\"\nchannel = []\nreason = \"ice\"", "names none"),
            ("[delet]\n", "unknown field `delet`"),
        ] {
            let error = DeletionFile::parse("bad.toml", text).expect_err(text).to_string();
            assert!(error.starts_with("bad.toml: ") && error.contains(words), "{text}: {error}");
        }
        assert!(
            DeletionFile::open("no-such-file.toml".as_ref()).unwrap_err().to_string().contains("no-such-file.toml")
        );
    }

    #[test]
    fn flights_are_told_apart_by_the_end_of_their_path() {
        let text = "[[delete]]\nflight = \"day1/a.csv\"\nat = \"1 s\"\nreason = \"ice\"\n\
                    [[delete]]\nchannel = [\"p\", \"q\"]\nat = \"2 s\"\nreason = \"ice\"";
        let file = DeletionFile::parse("bad.toml", text).unwrap();
        assert_eq!(file.of("x/day1/a.csv".as_ref(), false).len(), 1);
        assert_eq!(file.of("x/day2/a.csv".as_ref(), false).len(), 0);
        assert_eq!(file.of("x/day1/a.csv".as_ref(), true).len(), 2);
        assert_eq!(file.others(&["x/day2/a.csv".as_ref()]), ["day1/a.csv"]);
        assert!(file.others(&["x/day1/a.csv".as_ref()]).is_empty() && file.len() == 2 && !file.is_empty());
    }
}
