//! One case or study of the thesis, and how it is run.

use phugoid_evaluation::accuracy::StudyError;

use crate::result::Reproduction;

/// One case or study.
#[derive(Clone, Copy)]
pub struct Entry {
    /// `group/name`, e.g. `second-order/3`.
    pub id: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// How it is run.
    pub run: Run,
}

/// Runs an entry: told its id, and calling back with the fraction done, 0 to 1, from any thread.
pub type Run = fn(&str, &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError>;

impl Entry {
    /// The part of the id before the slash.
    pub fn group(&self) -> &'static str {
        self.id.split('/').next().unwrap_or(self.id)
    }
}
