//! How large a study in the tests is. A test includes this file with `#[path]`.
//!
//! A claim about many flights is checked with few of them each time that the tests run, and with all of them where
//! `PHUGOID_WHOLE_STUDIES` is set: `scripts/check-studies.sh` does that. What is allowed follows from the number of flights.

/// The number of flights of a study, or of what else it tries.
pub(crate) fn size(few: usize, all: usize) -> usize {
    if std::env::var_os("PHUGOID_WHOLE_STUDIES").is_some() { all } else { few }
}
