//! A finished result, made ready for the page: the JSON of `phugoid estimate --json --history`, or the documents that
//! `phugoid live` has published, or publishes of a recording.

mod documents;
mod estimation;
mod thinned;

pub use documents::Collector;

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::Path;

use phugoid_identification::estimation::ParameterReadiness;
use phugoid_identification::session::Layout;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::page;

/// Why a file cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// It cannot be read.
    #[error("cannot read the result: {0}")]
    Read(#[from] io::Error),
    /// It is no result.
    #[error(
        "this is no result that can be shown: {0}. Make one with `phugoid estimate FLIGHT --model MODEL --json --history > \
         result.json`, or keep what `phugoid live` publishes or records"
    )]
    NoResult(String),
    /// It is a result without the course over time.
    #[error("this result holds no histories: make it with `phugoid estimate ... --json --history`")]
    NoHistory,
    /// The page cannot be written as JSON.
    #[error("the result cannot be put into the page: {0}")]
    Page(#[from] serde_json::Error),
}

/// A result as the page takes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finished {
    hello: Hello,
    history: Columns,
    /// What is known of the parameters at the end.
    parameters: Vec<FinalParameter>,
    events: Vec<Event>,
    /// Sentences: the verdict, and what was left out of a damaged file.
    verdict: Vec<String>,
    /// The last report about the link.
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<Value>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct Hello {
    source: String,
    layout: Layout,
}

/// Columns over time: for each parameter its value and the edges of its band, for each output what was measured, what was
/// predicted and the residual, then the inputs. NaN (in JSON `null`) where missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct Columns {
    time_s: Vec<f64>,
    columns: Vec<Vec<f32>>,
    /// How many samples stand behind two rows, where there were too many to keep each: their least and greatest values.
    samples_per_group: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Event {
    /// Time of the sender, s; none if it is about the link.
    time_s: Option<f64>,
    kind: String,
    message: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct FinalParameter {
    value: Option<f64>,
    std_error: Option<f64>,
    status: String,
    readiness: Option<ParameterReadiness>,
    /// The true value, where the flight was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<f64>,
}

impl Finished {
    /// Reads a result; by its content it is one document or one per line.
    ///
    /// # Errors
    /// [`ViewError`]. Lines that cannot be read are left out and said so in the page, as are those cut off at the end.
    pub fn read_path(path: &Path) -> Result<Self, ViewError> {
        let mut file = BufReader::new(File::open(path)?);
        let lines = is_lines(&mut file)?;
        file.rewind()?;
        if lines { documents::read(file) } else { estimation::read(file) }
    }

    /// The page with the result inside: one file that needs nothing else.
    ///
    /// # Errors
    /// [`ViewError::Page`].
    pub fn html(&self) -> Result<String, ViewError> {
        Ok(page::with_result(self)?)
    }

    /// How many estimates it holds, or how many were thinned to the rows that it holds.
    pub fn rows(&self) -> usize {
        self.history.time_s.len()
    }
}

/// Longest first line that is looked at: a `hello` of the largest model has some ten thousand characters.
const FIRST_LINE_BYTES: u64 = 1 << 20;

/// Whether the first line is a document of its own that says its type.
fn is_lines(file: &mut BufReader<File>) -> Result<bool, ViewError> {
    let mut line = Vec::new();
    let mut beginning = file.take(FIRST_LINE_BYTES);
    while line.iter().all(u8::is_ascii_whitespace) {
        line.clear();
        if beginning.read_until(b'\n', &mut line)? == 0 {
            return Err(ViewError::NoResult("the file is empty".to_owned()));
        }
    }
    match line.trim_ascii_start().first() {
        Some(b'{') => {}
        _ => return Err(ViewError::NoResult("it is not JSON".to_owned())),
    }
    Ok(serde_json::from_slice::<Value>(&line).is_ok_and(|document| document.get("type").is_some()))
}
