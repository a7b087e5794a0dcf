//! Values of a flight that the command line, or a file, calls bad: the options `--delete` and `--deletions`.

use std::path::Path;

use phugoid_flight_data::deletion::{Deletion, DeletionFile};
use phugoid_flight_data::printable;
use phugoid_flight_data::record::Record;

use crate::arguments::Deleting;
use crate::failure::Failure;

/// The deletions of a command, before they are carried out.
pub(super) struct Deletions<'a> {
    given: &'a [Deletion],
    file: Option<(String, DeletionFile)>,
    /// Flights that the file names and that are not read.
    others: String,
}

impl<'a> Deletions<'a> {
    /// Reads the file of `--deletions`. `flights` are those that the command reads, the first one first.
    ///
    /// # Errors
    /// [`Failure::Input`]: the file cannot be read, is empty, or is about other flights alone.
    pub(super) fn new(arguments: &'a Deleting, flights: &[&Path]) -> Result<Self, Failure> {
        let given = arguments.delete.as_slice();
        let Some(path) = &arguments.deletions else {
            return Ok(Self { given, file: None, others: String::new() });
        };
        let name = printable::path(path);
        let file = DeletionFile::open(path).map_err(Failure::input)?;
        if file.is_empty() {
            return Err(Failure::input(format!(
                "--deletions {name}: it has no [[delete]] table. Write one with channel, at (or from and to) and reason"
            )));
        }
        let others = file.others(flights).join(", ");
        if flights.iter().enumerate().all(|(index, flight)| file.of(flight, index == 0).is_empty()) {
            let read: Vec<String> = flights.iter().map(|flight| printable::path(flight)).collect();
            return Err(Failure::input(format!(
                "--deletions {name}: it deletes values of {others}, and none of {}. The key `flight` has to be the name of \
                 the file, or the end of its path",
                read.join(", ")
            )));
        }
        Ok(Self { given, file: Some((name, file)), others })
    }

    /// Deletes what is called bad in one flight; `is_first` for the one that the command names first.
    ///
    /// # Errors
    /// [`Failure::Input`] for a deletion that is wrong or matches nothing.
    pub(super) fn apply(&self, record: &mut Record, flight: &Path, is_first: bool) -> Result<(), Failure> {
        if is_first {
            for deletion in self.given {
                record.delete(deletion).map_err(|error| Failure::input(format!("--delete: {error}")))?;
            }
        }
        let Some((name, file)) = &self.file else { return Ok(()) };
        for deletion in file.of(flight, is_first) {
            record.delete(&deletion).map_err(|error| Failure::input(format!("--deletions {name}: {error}")))?;
        }
        if is_first && !self.others.is_empty() {
            record.quality.warn("", format!("{name} also has deletions of {}, which is not read here", self.others));
        }
        Ok(())
    }
}
