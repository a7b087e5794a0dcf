//! The content of what a model or a scenario names beside its own text: the files of an aircraft.
//!
//! A key has to change with everything that decides on a row. The text of a model file with a `base` says only where the aircraft
//! is; an aircraft of JSBSim is a file that names further ones (engines, systems).

use std::path::{Path, PathBuf};

use phugoid_aircraft::flown::{AircraftFile, FlownOptions};
use phugoid_identification::model_file::ModelFile;

use crate::key::{hash, hash_file, key};

/// SHA-256 of what a model file says: of its text, and if it has a `base` with files, of these as well.
pub(crate) fn model_sha256(text: &str, model: &ModelFile) -> String {
    let of_text = hash(text.as_bytes());
    let Some(known) = &model.known else { return of_text };
    let hashes = match known.files() {
        Ok(files) => hashes(&files),
        // It has been read a moment ago. What can be said of it now is that it is another one.
        Err(error) => vec![error.to_string()],
    };
    let mut parts = vec![("model", of_text.as_str())];
    parts.extend(hashes.iter().map(|hash| ("base", hash.as_str())));
    key(&parts)
}

/// Hashes of all files that an aircraft is made of, which stands at a path: a folder with everything in it; a file with those that
/// it names; a model file with its `base`. A file that is no aircraft counts by itself; one that is not there has no hash.
pub(crate) fn aircraft_hashes(path: &Path) -> Vec<String> {
    if path.is_dir() {
        let mut found = Vec::new();
        hash_folder(path, &mut found);
        return found;
    }
    let is_model = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"));
    let named = match is_model {
        true => ModelFile::open(path).ok().and_then(|model| model.known?.files().ok()),
        false => {
            let options = FlownOptions::default();
            AircraftFile::open_with(path, &options).ok().and_then(|aircraft| aircraft.files(path, &options).ok())
        }
    };
    let own = std::iter::once(path.to_owned());
    hashes(&own.chain(named.into_iter().flatten().filter(|file| file != path)).collect::<Vec<_>>())
}

fn hashes(files: &[PathBuf]) -> Vec<String> {
    files.iter().filter_map(|file| hash_file(file).ok()).map(|(hash, _)| hash).collect()
}

/// Hashes of all files in a folder and below it, in the order of their paths.
fn hash_folder(folder: &Path, found: &mut Vec<String>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        // A link may lead back.
        match path.is_dir() && !path.is_symlink() {
            true => hash_folder(&path, found),
            false => found.extend(hash_file(&path).ok().map(|(hash, _)| hash)),
        }
    }
}
