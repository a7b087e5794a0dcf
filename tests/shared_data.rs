//! Where the tests of every crate find the data of others: check cases, recorded flights, prototype traces. A test
//! includes this file with `#[path]`; the data themselves stay outside the repository.

use std::path::PathBuf;

/// A file of the shared data, in `PHUGOID_SHARED_DATA` or in `../shared/data` beside the workspace.
///
/// Without it, one line says that the test is skipped and what to do, and there is none; where `CI` is set its absence
/// is a failure.
pub(crate) fn shared_file(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("PHUGOID_SHARED_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")), PathBuf::from);
    let file = folder.join(name);
    if file.is_file() {
        return Some(file);
    }
    assert!(std::env::var_os("CI").is_none(), "{} is not there", file.display());
    println!("skipped: {} is not there; set PHUGOID_SHARED_DATA to the folder of the shared data", file.display());
    None
}
