//! From the text of a file to what it describes, or to what is wrong with it and where.

use std::path::PathBuf;

use serde::de::DeserializeOwned;

use crate::aircraft::AircraftError;
use crate::toml_tree;

/// Why a scenario could not be read or flown.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("cannot read the scenario `{}`: {source}", .file.display())]
    Unreadable {
        /// Path of the file that cannot be read.
        file: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The text is not a scenario.
    #[error("{place}:{line}: {message}\n{excerpt}")]
    Invalid {
        /// File or name of the scenario.
        place: String,
        /// Number of the line in the text, counted from 1.
        line: usize,
        /// What is wrong and what to write.
        message: String,
        /// Text of the line in which the error is.
        excerpt: String,
    },
    /// The aircraft that the scenario names cannot be opened.
    #[error("{place}: the aircraft: {source}")]
    Aircraft {
        /// File or name of the scenario.
        place: String,
        /// Why it cannot be opened.
        source: Box<AircraftError>,
    },
    /// A value is out of range.
    #[error("{place}: {message}")]
    OutOfRange {
        /// File or name of the scenario.
        place: String,
        /// What is wrong and what to write.
        message: String,
    },
}

/// Parses TOML; `place` is the name of the text in messages, which give the line and the nearest valid word.
pub fn parse_toml<T: DeserializeOwned>(text: &str, place: &str) -> Result<T, ScenarioError> {
    toml_tree::read(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start).min(text.len());
        let before = text.get(..offset).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let excerpt = text.lines().nth(line - 1).unwrap_or_default();
        ScenarioError::Invalid {
            place: place.to_owned(),
            line,
            message: with_suggestion(error.message()),
            excerpt: format!("  {line} | {excerpt}"),
        }
    })
}

/// Adds the nearest valid word to serde's "unknown field `x`, expected one of `a`, `b`".
fn with_suggestion(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let (Some(found), true) = (quoted.next(), message.starts_with("unknown")) else { return message.to_owned() };
    let head = message.split(", expected").next().unwrap_or(message);
    let valid: Vec<&str> = quoted.collect();
    match nearest(found, valid.iter().copied()) {
        Some(word) => format!("{head}: did you mean `{word}`?"),
        None => format!("{head}: expected one of {}", valid.join(", ")),
    }
}

/// The valid word nearest to a misspelt one, if any is near.
pub fn nearest<'a>(word: &str, valid: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    valid
        .map(|v| (strsim::jaro_winkler(&word, &v.to_lowercase()), v))
        .filter(|(similarity, _)| *similarity > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, v)| v)
}
