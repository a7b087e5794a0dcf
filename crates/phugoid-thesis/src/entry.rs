//! One case or study of the thesis, and how it is run.

use phugoid_evaluation::accuracy::StudyError;

use crate::result::Reproduction;

/// One case or study of the thesis, ready to be run.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name as `group/name`, for instance `second-order/3`.
    pub id: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// The function that runs it.
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
