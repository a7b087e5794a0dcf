//! Case files that the binary carries.

use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::scenario::ScenarioError;

/// Entries of cases, and the text of each file by id: `group / name: title` for `scenarios/thesis/<group>-<name>.toml`. The
/// title is also in the file, for those who copy it. The entries are run by the `run` of the module that names them.
macro_rules! cases {
    ($($group:literal / $name:literal: $title:literal),* $(,)?) => {
        /// Entries of this module.
        pub(crate) const ENTRIES: &[$crate::entry::Entry] =
            &[$($crate::entry::Entry { id: concat!($group, "/", $name), title: $title, run }),*];

        /// Text of each case file, by id.
        pub(crate) const FILES: &[(&str, &str)] = &[$((
            concat!($group, "/", $name),
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/thesis/", $group, "-", $name, ".toml")),
        )),*];
    };
}

/// [`cases!`] that are all of one type and run by its own `run`: `Type; group / name: title, ...`.
macro_rules! published_cases {
    ($case:ty; $($cases:tt)*) => {
        $crate::embedded::cases! { $($cases)* }

        /// A published case of this kind by id, `group/number`.
        ///
        /// # Errors
        /// [`StudyError::Unsuitable`](phugoid_evaluation::accuracy::StudyError::Unsuitable): there is none of that id.
        pub fn published_case(id: &str) -> Result<$case, phugoid_evaluation::accuracy::StudyError> {
            $crate::embedded::case(FILES, id, <$case>::parse)
        }

        /// Ids of the published cases of this kind.
        pub fn published_ids() -> impl Iterator<Item = &'static str> + Clone {
            FILES.iter().map(|(id, _)| *id)
        }

        fn run(
            id: &str,
            progress: &(dyn Fn(f64) + Sync),
        ) -> Result<$crate::result::Reproduction, phugoid_evaluation::accuracy::StudyError> {
            let result = published_case(id)?.run(id);
            progress(1.0);
            result
        }
    };
}

pub(crate) use {cases, published_cases};

/// The case of an id among embedded files.
///
/// # Errors
/// [`StudyError::Unsuitable`]: there is none of that id, or its file cannot be read.
pub(crate) fn case<C>(
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
