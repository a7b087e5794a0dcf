//! The files of an aircraft, and their places in an FMU: as they lie to each other outside.

use std::path::{Component, Path, PathBuf};

use phugoid_aircraft::flown::AircraftFile;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::aircraft::AnyAircraft;

use crate::export::{ExportError, Source};

/// The folder of the aircraft's files below `resources`.
const FOLDER: &str = "aircraft";

/// What an FMU carries of an aircraft that is not built in.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    /// What names the aircraft, relative to `resources`.
    pub(crate) entry: String,
    /// Further files of DAVE-ML, relative to `resources`.
    pub(crate) with: Vec<String>,
    /// All files: their paths below `resources`, and their bytes.
    pub(crate) files: Vec<(String, Vec<u8>)>,
    /// Files with terms of use that lie beside the data: name and bytes.
    pub(crate) licences: Vec<(String, Vec<u8>)>,
    /// How files and folders are called outside, and what they are called below `resources`; longer ones first.
    names: Vec<(String, String)>,
}

impl Carried {
    /// The files that an aircraft was read from.
    pub(crate) fn of(aircraft: &AnyAircraft, source: &Source) -> Result<Self, ExportError> {
        let path = Path::new(&source.aircraft);
        match aircraft {
            AnyAircraft::Model(..) => Self::of_model(path),
            AnyAircraft::File(file) => Self::of_file(file, source),
            _ => Ok(Self::default()),
        }
    }

    fn of_model(path: &Path) -> Result<Self, ExportError> {
        // The rule of `AnyAircraft::open`: a file before a built-in model of the same name.
        if !path.exists() {
            let name = path.display().to_string();
            let text = ModelFile::text(&name).map_err(|error| ExportError::Model(error.to_string()))?;
            let entry = format!("{FOLDER}/{name}.toml");
            return Ok(Self { entry: entry.clone(), files: vec![(entry, text.into())], ..Self::default() });
        }
        let model = ModelFile::open(path).map_err(|error| ExportError::Model(error.to_string()))?;
        let mut files = vec![place(path)?];
        if let Some(known) = &model.known {
            let listed = known.files().map_err(|source| ExportError::reading(known.file(), source))?;
            files.extend(placed(known.aircraft(), listed)?);
        }
        let mut carried = Self::below(&files[0], &[], &files)?;
        if let Some(known) = &model.known {
            // A folder has the name of the file in it.
            let base = carried.files.get(1).map(|(inside, _)| inside.clone());
            let (outside, is_folder) = (known.file().display().to_string(), known.file().is_dir());
            if let Some(inside) = base {
                let folder = inside.rsplit_once('/').map_or(FOLDER, |(folder, _)| folder).to_owned();
                carried.names.push((outside, if is_folder { folder } else { inside }));
            }
        }
        carried.names.push((path.display().to_string(), carried.entry.clone()));
        Ok(carried.sorted())
    }

    fn of_file(aircraft: &AircraftFile, source: &Source) -> Result<Self, ExportError> {
        let path = Path::new(&source.aircraft);
        let listed = aircraft.files(path, &source.options).map_err(|error| ExportError::reading(path, error))?;
        let files = placed(aircraft, listed)?;
        let folder = path.is_dir().then(|| path.canonicalize()).transpose();
        let folder = folder.map_err(|error| ExportError::reading(path, error))?;
        let is_folder = matches!(aircraft, AircraftFile::Transport(_));
        let first = files.first().ok_or_else(|| ExportError::Nothing(path.into()))?;
        let entry = folder.as_ref().filter(|_| is_folder).unwrap_or(first);
        let with = if source.options.with.is_empty() { &[] } else { files.get(1..).unwrap_or_default() };
        let mut carried = Self::below(entry, with, &files)?;
        if let Some(folder) = folder {
            carried.licences = licences(&folder)?;
            let inside = if is_folder {
                Some(carried.entry.as_str())
            } else {
                carried.entry.rsplit_once('/').map(|(inside, _)| inside)
            };
            let inside = inside.unwrap_or(FOLDER).to_owned();
            carried.names.push((path.display().to_string(), inside));
        } else {
            carried.names.push((path.display().to_string(), carried.entry.clone()));
        }
        Ok(carried.sorted())
    }

    /// With the longer names first, so that a folder does not take the beginning of a file in it.
    fn sorted(mut self) -> Self {
        self.names.sort_by_key(|(outside, _)| std::cmp::Reverse(outside.len()));
        self
    }

    /// A note without the places of files on the machine of the export.
    pub(crate) fn without_places(&self, note: &str) -> String {
        self.names.iter().fold(note.to_owned(), |note, (outside, inside)| note.replace(outside, inside))
    }

    /// The files with the paths that they have below the deepest folder that holds all of them.
    fn below(entry: &Path, with: &[PathBuf], files: &[PathBuf]) -> Result<Self, ExportError> {
        let mut folder = entry.parent().filter(|_| files.iter().any(|file| file == entry)).unwrap_or(entry).to_owned();
        while !files.iter().all(|file| file.starts_with(&folder)) {
            if !folder.pop() {
                return Err(ExportError::Apart(files.iter().map(|file| file.display().to_string()).collect()));
            }
        }
        let inside = |path: &Path| {
            let words = path.strip_prefix(&folder).unwrap_or(path).components().map(|part| match part {
                Component::Normal(word) => word.to_str().ok_or_else(|| ExportError::Name(path.into())),
                _ => Err(ExportError::Name(path.into())),
            });
            let words = std::iter::once(Ok(FOLDER)).chain(words).collect::<Result<Vec<_>, _>>()?;
            Ok::<String, ExportError>(words.join("/"))
        };
        let mut carried = Self { entry: inside(entry)?, ..Self::default() };
        carried.with = with.iter().map(|file| inside(file)).collect::<Result<_, _>>()?;
        for file in files {
            let bytes = std::fs::read(file).map_err(|source| ExportError::reading(file, source))?;
            carried.names.push((file.display().to_string(), inside(file)?));
            carried.files.push((inside(file)?, bytes));
        }
        Ok(carried)
    }
}

/// The places of the files of an aircraft. JSBSim's reader gives them whole, as it found them from its own folder.
fn placed(aircraft: &AircraftFile, files: Vec<PathBuf>) -> Result<Vec<PathBuf>, ExportError> {
    if matches!(aircraft, AircraftFile::Jsbsim(_)) {
        return Ok(files);
    }
    files.iter().map(|file| place(file)).collect()
}

/// A file with the whole path of its folder, without links in it.
fn place(file: &Path) -> Result<PathBuf, ExportError> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().map_err(|source| ExportError::reading(file, source))?;
    Ok(file.file_name().map_or_else(|| folder.clone(), |name| folder.join(name)))
}

/// The files of a folder whose names speak of a licence.
fn licences(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, ExportError> {
    let entries = std::fs::read_dir(folder).map_err(|source| ExportError::reading(folder, source))?;
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let lower = name.to_lowercase();
        if (lower.starts_with("licen") || lower.starts_with("copying")) && entry.path().is_file() {
            let bytes = std::fs::read(entry.path()).map_err(|source| ExportError::reading(&entry.path(), source))?;
            found.push((name, bytes));
        }
    }
    found.sort();
    Ok(found)
}
