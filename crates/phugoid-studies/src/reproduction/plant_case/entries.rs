//! The published plant cases, embedded.

use super::PlantCase;
use crate::accuracy::StudyError;
use crate::reproduction::{Entry, Reproduction};

/// Id, title and file of each case; the title is also in the file, for those who copy it.
macro_rules! cases {
    ($($group:literal / $number:literal: $title:literal),* $(,)?) => {
        /// Entries of the plant cases.
        pub(in crate::reproduction) const ENTRIES: &[Entry] =
            &[$(Entry { id: concat!($group, "/", $number), title: $title, run }),*];

        /// Text of each case file, by id.
        pub(super) const FILES: &[(&str, &str)] = &[$((
            concat!($group, "/", $number),
            include_str!(concat!("../../../../../scenarios/thesis/", $group, "-", $number, ".toml")),
        )),*];
    };
}

cases! {
    "first-order"/1: "First order, case 1: step, a = 3",
}

/// A published plant case by id, e.g. `second-order/3`.
///
/// # Errors
/// [`StudyError::Unsuitable`]: there is none of that id.
pub fn published_case(id: &str) -> Result<PlantCase, StudyError> {
    let Some((_, text)) = FILES.iter().find(|(known, _)| *known == id) else {
        return Err(StudyError::Unsuitable(format!("there is no plant case `{id}`")));
    };
    PlantCase::parse(text, id).map_err(|error| StudyError::Unsuitable(error.to_string()))
}

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let result = published_case(id)?.run(id);
    progress(1.0);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_reads_and_bears_the_title_of_its_entry() {
        for entry in ENTRIES {
            let case = published_case(entry.id).unwrap();
            assert_eq!(case.title, entry.title, "{}", entry.id);
        }
        assert!(published_case("first-order/9").unwrap_err().to_string().contains("first-order/9"));
    }
}
