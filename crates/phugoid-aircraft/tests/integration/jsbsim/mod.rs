//! Aircraft of JSBSim, where its Python package is there.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

mod broken;
mod engines;
mod flights;
mod package;
mod recorded;
mod sources;

use std::path::{Path, PathBuf};

/// Whether an aircraft is kept for a last check: nothing was made with it in mind. `PHUGOID_JSBSIM_RESERVED` makes that check.
pub(super) fn is_reserved(name: &str) -> bool {
    const RESERVED: [&str; 6] = ["c172p", "737", "f16", "SGS", "minisgs", "Concorde"];
    RESERVED.contains(&name) && std::env::var_os("PHUGOID_JSBSIM_RESERVED").is_none()
}

/// The folder of JSBSim's Python package: that of the environment variable `PHUGOID_JSBSIM`, which has to be there, or the one
/// that scripts/python-tools.sh made. Where there is none, says so in a line.
pub(super) fn package() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os("PHUGOID_JSBSIM") {
        let folder = PathBuf::from(folder);
        assert!(folder.join("aircraft").is_dir(), "PHUGOID_JSBSIM: there is no folder {}/aircraft", folder.display());
        return Some(folder);
    }
    let python = repository().join("target/python/lib");
    let versions = std::fs::read_dir(&python).into_iter().flatten().flatten();
    let found = versions.map(|version| version.path().join("site-packages/jsbsim")).find(|path| path.is_dir());
    if found.is_none() {
        eprintln!("skipped: no package jsbsim (set PHUGOID_JSBSIM, or run scripts/python-tools.sh)");
    }
    found
}

/// The folder of the repository.
pub(super) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A text, of which the end says that it is compressed by gzip.
pub(super) fn text_of(path: &Path) -> String {
    use std::io::Read as _;
    let bytes = std::fs::read(path).unwrap();
    let mut text = String::new();
    if path.extension().is_some_and(|end| end == "gz") {
        flate2::read::GzDecoder::new(bytes.as_slice()).read_to_string(&mut text).unwrap();
    } else {
        text = String::from_utf8(bytes).unwrap();
    }
    text
}
