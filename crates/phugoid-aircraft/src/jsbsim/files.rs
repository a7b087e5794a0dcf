//! The files that an aircraft may read: those of its own folder, and of the folders of systems and engines beside it.

use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

use roxmltree::Node;

use super::error::JsbsimError;
use super::source::{Source, shortened, tag};
use crate::xml;

/// Most files that one aircraft may refer to. The largest of JSBSim's refer to 30.
pub const MAX_FILES: usize = 300;
/// Most bytes that the files of one aircraft may have together.
pub const MAX_TOTAL_BYTES: usize = 64_000_000;

/// The folders that an aircraft may read from, and how much it has read.
pub(super) struct Files {
    /// Folder of the aircraft; empty where it comes from a text.
    aircraft: Option<PathBuf>,
    /// Folder that holds `aircraft`, `systems` and `engine`.
    package: Option<PathBuf>,
    read: usize,
    bytes: usize,
    /// The files that were read, in order, under the names by which they were found: links are not followed.
    found: Vec<PathBuf>,
    /// Whether a file that was referred to is not there.
    missing: bool,
}

/// What kind of file is referred to: it says in which folders it is looked for.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// A section of the aircraft.
    Section,
    /// A system.
    System,
    /// An engine, or what makes its thrust.
    Engine,
}

impl Files {
    /// The folders of an aircraft in a file.
    pub(super) fn of(file: &Path) -> Self {
        let canonical = file.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        let aircraft = canonical.and_then(|folder| folder.canonicalize().ok());
        let package = aircraft.as_deref().and_then(Path::parent).and_then(Path::parent).map(Path::to_path_buf);
        let own = aircraft.as_deref().zip(file.file_name()).map(|(folder, name)| folder.join(name));
        Self { aircraft, package, read: 0, bytes: 0, found: own.into_iter().collect(), missing: false }
    }

    /// No folder: whatever a text refers to is not found.
    pub(super) fn none() -> Self {
        Self { aircraft: None, package: None, read: 0, bytes: 0, found: Vec::new(), missing: false }
    }

    /// Whether a file that was referred to is not there.
    pub(super) fn is_missing(&self) -> bool {
        self.missing
    }

    /// The files of the aircraft, its own first; each once.
    pub(super) fn into_found(self) -> Vec<PathBuf> {
        let mut files = Vec::with_capacity(self.found.len());
        for file in self.found {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files
    }

    /// The folders in which a kind of file is looked for, each with the folder that it must not leave.
    fn folders(&self, kind: Kind) -> Vec<PathBuf> {
        let inside = |names: &[&str]| {
            let aircraft = self.aircraft.iter();
            aircraft.flat_map(|folder| names.iter().map(|name| folder.join(name))).collect::<Vec<_>>()
        };
        let beside = |name: &str| self.package.iter().map(|folder| folder.join(name)).collect::<Vec<_>>();
        match kind {
            Kind::Section => inside(&[""]),
            Kind::System => [inside(&["", "Systems", "systems"]), beside("systems")].concat(),
            Kind::Engine => [inside(&["Engines", "engines", "Engine", "engine", ""]), beside("engine")].concat(),
        }
    }

    /// The text of a file that an element refers to by the attribute `file`.
    pub(super) fn text(
        &mut self,
        source: &Source,
        node: Node<'_, '_>,
        name: &str,
        kind: Kind,
    ) -> Result<(PathBuf, String), JsbsimError> {
        let refuse =
            |why: &str| Err(source.refuse(node, format!("<{} file=\"{}\">: {why}", tag(node), shortened(name))));
        let name = name.trim();
        let path = Path::new(name);
        if name.is_empty() || !path.components().all(|part| matches!(part, Component::Normal(_))) {
            return refuse("only a file below the folder of the aircraft may be named");
        }
        self.read += 1;
        if self.read > MAX_FILES {
            return refuse("the aircraft refers to too many files");
        }
        for folder in self.folders(kind) {
            let Ok(root) = folder.canonicalize() else { continue };
            for below in [path.to_path_buf(), PathBuf::from(format!("{name}.xml"))] {
                let Ok(found) = root.join(&below).canonicalize() else { continue };
                // A link in the folder may lead out of it.
                if !found.is_file() || !found.starts_with(&root) {
                    continue;
                }
                let text = text_of(&found)?;
                self.bytes = self.bytes.saturating_add(text.len());
                if self.bytes > MAX_TOTAL_BYTES {
                    return refuse("the files of the aircraft are too large together");
                }
                self.found.push(folder.join(below));
                return Ok((found, text));
            }
        }
        self.missing = true;
        refuse("there is no such file in the folders of the aircraft and of its package")
    }
}

/// The text of a file. Where it is not UTF-8, each byte is a letter of its own (Latin-1), as in older files.
pub(crate) fn text_of(file: &Path) -> Result<String, JsbsimError> {
    match xml::text_of(file) {
        Err(xml::XmlError::Unreadable { source, .. }) if source.kind() == std::io::ErrorKind::InvalidData => {
            let mut bytes = Vec::new();
            let unreadable = |source| JsbsimError::Unreadable(xml::XmlError::Unreadable { file: file.into(), source });
            let opened = std::fs::File::open(file).map_err(unreadable)?;
            opened.take(xml::MAX_BYTES).read_to_end(&mut bytes).map_err(unreadable)?;
            Ok(bytes.into_iter().map(char::from).collect())
        }
        other => other.map_err(JsbsimError::Unreadable),
    }
}
