//! Case files that the binary carries.

use crate::accuracy::StudyError;
use crate::scenario::ScenarioError;

/// Entries of cases, and the text of each file by id: `group / name: title` for `scenarios/thesis/<group>-<name>.toml`. The
/// title is also in the file, for those who copy it. The entries are run by the `run` of the module that names them.
macro_rules! cases {
    ($($group:literal / $name:literal: $title:literal),* $(,)?) => {
        /// Entries of this module.
        pub(in crate::reproduction) const ENTRIES: &[$crate::reproduction::Entry] =
            &[$($crate::reproduction::Entry { id: concat!($group, "/", $name), title: $title, run }),*];

        /// Text of each case file, by id.
        const FILES: &[(&str, &str)] = &[$((
            concat!($group, "/", $name),
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/thesis/", $group, "-", $name, ".toml")),
        )),*];
    };
}

pub(super) use cases;

/// The case of an id among embedded files.
///
/// # Errors
/// [`StudyError::Unsuitable`]: there is none of that id, or its file cannot be read.
pub(super) fn case<C>(
    files: &[(&str, &str)],
    id: &str,
    parse: impl Fn(&str, &str) -> Result<C, ScenarioError>,
) -> Result<C, StudyError> {
    let Some((_, text)) = files.iter().find(|(known, _)| *known == id) else {
        let known = files.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
        return Err(StudyError::Unsuitable(format!("there is no case `{id}` among {known}")));
    };
    parse(text, id).map_err(StudyError::unsuitable)
}
