//! The content of a model or a scenario with all that it names beside its own text: the files of an aircraft.
//!
//! A key has to change with everything that decides on a row. The text of a model file with a `base` says only where the aircraft
//! is; an aircraft of JSBSim is a file that names further ones (engines, systems).

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use phugoid_aircraft::flown::{AircraftFile, FlownOptions};
use phugoid_identification::model_file::ModelFile;
use toml::{Table, Value};

use crate::key::{hash, hash_file, key};

/// SHA-256 of a file in TOML with the content of every file that it names: of a scenario, a case, an entry of the arena, or a model.
///
/// # Errors
/// What the operating system says.
pub fn source_of(file: &Path) -> std::io::Result<String> {
    let text = std::fs::read_to_string(file)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let of_file = source_sha256(&text, 0, folder, &mut NamedFiles::default());
    // One that is no model has no `base`.
    let base = ModelFile::open(file).map_or_else(|_| Vec::new(), |model| base_hashes(&model));
    Ok(model_sha256(&of_file, &base))
}

/// SHA-256 of a scenario as it is flown: its text, the seed, and the content of every file that the text names, in the order of
/// the text. `folder` is where relative paths begin.
pub(crate) fn source_sha256(scenario: &str, seed: u64, folder: &Path, files: &mut NamedFiles) -> String {
    let mut named = Vec::new();
    if let Ok(table) = toml::from_str::<Table>(scenario) {
        table.iter().for_each(|(key, value)| files.named_in(key, value, folder, &mut named));
    }
    let seed = seed.to_string();
    let mut parts = vec![("scenario", scenario), ("seed", seed.as_str())];
    parts.extend(named.iter().map(|hash| ("file", hash.as_str())));
    key(&parts)
}

/// Hashes of the files that scenarios name, each read once. Words that name no file are not kept: a number with its unit may be
/// another one in every flight.
#[derive(Debug, Default)]
pub struct NamedFiles(HashMap<PathBuf, Vec<String>>);

impl NamedFiles {
    /// Hashes of the files that texts in a value name. `key` is the key under which the value stands.
    pub(crate) fn named_in(&mut self, key: &str, value: &Value, folder: &Path, named: &mut Vec<String>) {
        match value {
            Value::Table(table) => table.iter().for_each(|(key, value)| self.named_in(key, value, folder, named)),
            Value::Array(list) => list.iter().for_each(|value| self.named_in(key, value, folder, named)),
            Value::String(text) => {
                let path = folder.join(text);
                if let Some(hashes) = self.0.get(&path) {
                    named.extend_from_slice(hashes);
                    return;
                }
                let hashes = match key == "file" || key == "base" {
                    // An aircraft, which may be in several files: of a scenario, or below the increments of a model.
                    true => aircraft_hashes(&path),
                    false => hash_file(&path).ok().map(|(hash, _)| hash).into_iter().collect(),
                };
                if !hashes.is_empty() {
                    named.extend_from_slice(&hashes);
                    self.0.insert(path, hashes);
                }
            }
            _ => {}
        }
    }
}

/// SHA-256 of what a model file says: of its text, and if it has a `base` with files, of these as well, as [`base_hashes`] gives them.
pub(crate) fn model_sha256(text: &str, base: &[String]) -> String {
    let of_text = hash(text.as_bytes());
    if base.is_empty() {
        return of_text;
    }
    let mut parts = vec![("model", of_text.as_str())];
    parts.extend(base.iter().map(|hash| ("base", hash.as_str())));
    key(&parts)
}

/// Hashes of the files of the `base` of a model; none without a `base` in files.
pub(crate) fn base_hashes(model: &ModelFile) -> Vec<String> {
    match model.known.as_ref().map(|known| known.files()) {
        None => Vec::new(),
        Some(Ok(files)) => hashes(&files),
        // It has been read a moment ago. What can be said of it now is that it is another one.
        Some(Err(error)) => vec![error.to_string()],
    }
}

/// Hashes of all files that an aircraft is made of, which stands at a path: a folder with everything in it; a file with those that
/// it names; a model file with its `base`. A file that is no aircraft counts by itself; one that is not there has no hash.
pub(crate) fn aircraft_hashes(path: &Path) -> Vec<String> {
    if path.is_dir() {
        let mut found = Vec::new();
        hash_folder(path, &mut found);
        return found;
    }
    if !path.exists() {
        return Vec::new();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::{Segments, Task};

    const MODEL: &str = r#"
axes = ["longitudinal"]
base = "glider.xml"
[aircraft]
thrust = 0
air_density = "standard_atmosphere"
reference_speed = 30
[coefficients]
Cm = ["alpha", "q_hat"]
[reference]
altitude = 1000
[parameters]
dCm_alpha = { bounds = [-1, 1] }
dCm_q = { bounds = [-15, 15] }
"#;

    /// A folder with a glider of JSBSim that names the file of a system, and a model file with the glider as its `base`.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("phugoid-content-{name}-{}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phugoid-aircraft/tests/integration/jsbsim");
            let glider = std::fs::read_to_string(tests.join("glider.xml")).unwrap();
            let glider = glider.replace("</fdm_config>", "<system file=\"vario\"/></fdm_config>");
            std::fs::write(folder.join("glider.xml"), glider).unwrap();
            std::fs::write(folder.join("vario.xml"), "<system name=\"vario\"/>").unwrap();
            std::fs::write(folder.join("glider.toml"), MODEL).unwrap();
            Self(folder)
        }

        /// Replaces something in a file.
        fn change(&self, file: &str, from: &str, to: &str) {
            let text = std::fs::read_to_string(self.0.join(file)).unwrap();
            assert!(text.contains(from), "{file}");
            std::fs::write(self.0.join(file), text.replace(from, to)).unwrap();
        }

        fn task(&self) -> Task {
            Task::open(&self.0.join("glider.toml").display().to_string(), None, Segments::Whole).unwrap()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            std::fs::remove_dir_all(&self.0).unwrap();
        }
    }

    #[test]
    fn a_key_changes_with_every_file_of_the_base() {
        let folder = Folder::new("base");
        let before = folder.task();
        assert_eq!(before.key("log"), folder.task().key("log"));
        folder.change("vario.xml", "/>", "></system>");
        let system = folder.task();
        assert_ne!(system.model_sha256(), before.model_sha256());
        folder.change("glider.xml", "</fdm_config>", " </fdm_config>");
        let aircraft = folder.task();
        assert!(aircraft.key("log") != system.key("log") && aircraft.model_text() == before.model_text());
    }

    /// A case of a comparison has its model as a table.
    #[test]
    fn a_base_in_a_table_counts_with_every_file_that_it_names() {
        let folder = Folder::new("case");
        let case = folder.0.join("case.toml");
        std::fs::write(&case, "[model]\nbase = \"glider.xml\"\n").unwrap();
        let before = source_of(&case).unwrap();
        assert_eq!(source_of(&case).unwrap(), before);
        folder.change("vario.xml", "/>", "></system>");
        assert_ne!(source_of(&case).unwrap(), before);
    }

    #[test]
    fn an_aircraft_is_all_its_files_and_what_is_not_there_is_none() {
        let folder = Folder::new("aircraft");
        assert_eq!(aircraft_hashes(&folder.0.join("glider.xml")).len(), 2);
        assert_eq!(aircraft_hashes(&folder.0.join("glider.toml")).len(), 3);
        assert_eq!(aircraft_hashes(&folder.0).len(), 3);
        assert!(aircraft_hashes(Path::new("hfb320")).is_empty());
    }

    #[test]
    fn a_method_that_is_named_and_the_same_one_of_the_model_are_one_task() {
        let task = |method| Task::open("hfb320", method, Segments::Whole).unwrap().key("log");
        let own = ModelFile::named("hfb320").unwrap().estimator.method;
        assert_eq!(task(None), task(Some(own)));
    }
}
