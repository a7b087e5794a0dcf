//! A finished result, made ready for the page. It comes from the JSON of `phugoid estimate --json --history`, from the
//! documents that `phugoid live` has published, or from a recording that is estimated again.

mod documents;
mod estimation;
mod finished;
mod thinned;

pub use documents::Collector;
pub use finished::{Finished, ViewError};

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

use serde_json::Value;

impl Finished {
    /// Reads a result from a file, which holds either one document or one per line. Lines that cannot be read are left
    /// out, and the page says so.
    ///
    /// # Errors
    /// [`ViewError`] if the file cannot be read, is no result, or has no histories.
    pub fn read_path(path: &Path) -> Result<Self, ViewError> {
        let mut file = BufReader::new(File::open(path)?);
        let lines = is_lines(&mut file)?;
        file.rewind()?;
        if lines { documents::read(file) } else { estimation::read(file) }
    }
}

/// Longest first line that is examined. The `hello` of the largest model has some ten thousand characters.
const FIRST_LINE_BYTES: u64 = 1 << 20;

/// Whether the first line is a whole document with a type, so that the file has one document per line.
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
