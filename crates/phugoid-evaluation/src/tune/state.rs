//! The state file of a search: everything that is needed to continue it after it was stopped, and a description of the
//! problem that it belongs to.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::search::Search;

/// Layout of the file.
const FORMAT: u32 = 1;

/// What decides the scores of a search, by name: method, scenarios, settings, seeds.
pub type Problem = BTreeMap<String, String>;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    format: u32,
    problem: Problem,
    search: Search,
}

/// Why a search cannot be continued from a state file, or cannot write one.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The file is there and cannot be read.
    #[error("cannot read the state file `{}`: {source}", .file.display())]
    Unreadable {
        /// Path of the state file.
        file: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// It is no state file, or a damaged one.
    #[error("`{}` is no state file of `phugoid tune`: {message}\nGive another file, or delete it to start anew.", .file.display())]
    Invalid {
        /// Path of the state file.
        file: PathBuf,
        /// What is wrong with the contents of the file.
        message: String,
    },
    /// It belongs to another problem.
    #[error(
        "the state file `{}` is of another problem: {}\nGive another file, or delete it to start anew.", .file.display(), .differences.join("; ")
    )]
    OtherProblem {
        /// Path of the state file.
        file: PathBuf,
        /// What differs, a phrase each.
        differences: Vec<String>,
    },
    /// The state file could not be written, for the reason given.
    #[error("cannot write the state file `{}`: {source}", .file.display())]
    Unwritable {
        /// Path of the state file.
        file: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
}

/// The search that a file holds; none if there is no such file.
///
/// # Errors
/// [`StateError`]: the file cannot be read, is damaged, or is of another problem.
pub fn read(file: &Path, problem: &Problem) -> Result<Option<Search>, StateError> {
    let text = match std::fs::read_to_string(file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(StateError::Unreadable { file: file.to_owned(), source }),
        Ok(text) => text,
    };
    let invalid = |message: String| StateError::Invalid { file: file.to_owned(), message };
    let state: State = toml::from_str(&text).map_err(|error| invalid(error.message().to_owned()))?;
    if state.format != FORMAT {
        return Err(invalid(format!("its format is {}, expected {FORMAT}", state.format)));
    }
    let differences = differences(&state.problem, problem);
    if !differences.is_empty() {
        return Err(StateError::OtherProblem { file: file.to_owned(), differences });
    }
    let size = Search::population_size(state.search.start.len());
    let whole = |m: &super::search::Member| m.point.len() == state.search.start.len() && m.score.is_finite();
    if state.search.population.len() != size || !state.search.population.iter().all(whole) {
        return Err(invalid("its population is not complete".to_owned()));
    }
    state.search.consistent().map_err(invalid)?;
    Ok(Some(state.search))
}

/// Writes the state whole or not at all: whoever is stopped in between leaves the old one.
///
/// # Errors
/// [`StateError::Unwritable`].
pub fn write(file: &Path, problem: &Problem, search: &Search) -> Result<(), StateError> {
    let unwritable = |source| StateError::Unwritable { file: file.to_owned(), source };
    let state = State { format: FORMAT, problem: problem.clone(), search: search.clone() };
    let text = toml::to_string(&state).map_err(|error| unwritable(std::io::Error::other(error)))?;
    phugoid_flight_data::output_file::write(file, text).map_err(unwritable)
}

fn differences(found: &Problem, wanted: &Problem) -> Vec<String> {
    let names: std::collections::BTreeSet<&String> = found.keys().chain(wanted.keys()).collect();
    let word = |value: Option<&String>| value.map_or_else(|| "nothing".to_owned(), |v| format!("`{v}`"));
    names
        .into_iter()
        .filter(|name| found.get(*name) != wanted.get(*name))
        .map(|name| format!("its {name} is {}, here it is {}", word(found.get(name)), word(wanted.get(name))))
        .collect()
}

/// A short name of a text that differs where the text differs (FNV-1a, 64 bit), for problems that hold whole files.
pub fn fingerprint(text: &str) -> String {
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    format!("{hash:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingerprints_are_the_published_ones() {
        // Test vectors of the FNV reference (Fowler, Noll, Vo).
        assert_eq!(fingerprint(""), "cbf29ce484222325");
        assert_eq!(fingerprint("a"), "af63dc4c8601ec8c");
        assert_eq!(fingerprint("foobar"), "85944171f73967e8");
    }
}
