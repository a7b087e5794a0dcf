//! An aircraft as an FMU: the file.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use phugoid_aircraft::flown::{AircraftFile, FlownOptions, Thrust};
use phugoid_aircraft::transport::Damage;
use phugoid_flight_dynamics::aircraft::STATES;
use phugoid_flight_dynamics::f16::F16Tables;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::trim::Trim;
use phugoid_simulation::aircraft::AnyAircraft;
use phugoid_simulation::quantity::Force;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::description;
use crate::documentation;
use crate::files::Carried;
use crate::library::Library;
use crate::point::Point;
use crate::resources::{self, FILE, ResourceError, Resources};

/// How an aircraft is named and opened, as the command line does it.
#[derive(Clone, Debug)]
pub struct Source {
    /// `f16`, a file, a folder, or the name of a built-in model.
    pub aircraft: String,
    /// The options of an aircraft of a file; acceleration of gravity and scale of thrust as they are by default.
    pub options: FlownOptions,
    /// The tables of the F-16; the book's where they are not given.
    pub tables: Option<F16Tables>,
    /// The centre of gravity of the F-16, fraction of the mean chord.
    pub cg: Option<f64>,
}

/// Why an aircraft cannot become an FMU.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A file of the aircraft cannot be read a second time.
    #[error("`{}` cannot be read for the FMU: {source}", file.display())]
    Reading {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The model file cannot be read.
    #[error("{0}")]
    Model(String),
    /// Nothing was read.
    #[error("`{}` names no file that an FMU could carry", .0.display())]
    Nothing(PathBuf),
    /// A name that a ZIP archive has no place for.
    #[error("the name of `{}` is not plain text, and an FMU cannot carry it: rename it", .0.display())]
    Name(PathBuf),
    /// Files on different disks.
    #[error("the files of the aircraft are in no common folder, and an FMU keeps their places to each other: {}", .0.join(", "))]
    Apart(Vec<String>),
    /// An option that resources have no word for.
    #[error("an FMU has no place for another `{0}` than the usual one")]
    Option(&'static str),
    /// No library.
    #[error("an FMU needs a library to run: none is given")]
    NoLibrary,
    /// Two libraries for one kind of machine.
    #[error("two libraries are for {0}: name one for each kind of machine")]
    Twice(String),
    /// The description cannot be written.
    #[error("the description of the aircraft cannot be written: {0}")]
    Description(#[from] toml::ser::Error),
    /// The archive cannot be written.
    #[error("the FMU cannot be packed: {0}")]
    Packing(#[from] zip::result::ZipError),
    /// The same, in the writer of the archive.
    #[error("the FMU cannot be packed: {0}")]
    Writing(#[from] std::io::Error),
    /// The FMU's own copy of the aircraft cannot be opened.
    #[error("the aircraft cannot be opened out of the FMU as it can outside: {0}")]
    NotCarried(#[from] ResourceError),
    /// The FMU's own copy of the aircraft moves in another way.
    #[error(
        "the aircraft in the FMU does not move as the one outside (rates at the trim differ): something that its files refer \
         to was not carried along. Put everything that the aircraft needs below one folder"
    )]
    Differs,
}

impl ExportError {
    pub(crate) fn reading(file: &Path, source: std::io::Error) -> Self {
        Self::Reading { file: file.into(), source }
    }
}

/// On what terms the content of an FMU may be handed on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Licence {
    /// A few words, for the attribute `license` of the model description.
    pub short: String,
    /// Sentences, for people.
    pub text: String,
}

/// An FMU and what it holds.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The file.
    pub bytes: Vec<u8>,
    /// Name of the model in file names and functions.
    pub identifier: String,
    /// The token by which the parts of the FMU know each other.
    pub token: String,
    /// Kinds of machine on which it runs, as FMI 3.0 names them.
    pub platforms: Vec<String>,
    /// Files of the aircraft in it, below `resources`.
    pub files: Vec<String>,
    /// On what terms it may be handed on.
    pub licence: Licence,
}

/// Makes an FMU for FMI 3.0 (model exchange and co-simulation) of an aircraft that was opened from a source, whose flight begins at
/// a trim of it.
///
/// The FMU carries the files of the aircraft. Before it is given, its copy is opened in a folder of its own and has to move exactly as
/// the original, at the trim and beside it. The same aircraft, trim and libraries give the same bytes.
///
/// # Errors
/// [`ExportError`]: files that cannot be carried along, no library.
pub fn export(
    aircraft: &AnyAircraft,
    source: &Source,
    trim: &Trim,
    libraries: &[Library],
) -> Result<Exported, ExportError> {
    if libraries.is_empty() {
        return Err(ExportError::NoLibrary);
    }
    let mut platforms: Vec<String> = Vec::new();
    for library in libraries {
        if platforms.contains(&library.platform) {
            return Err(ExportError::Twice(library.platform.clone()));
        }
        platforms.push(library.platform.clone());
    }
    let carried = Carried::of(aircraft, source)?;
    let start = Point::of_trim(trim);
    let table = table(source, &carried)?;
    let token = token(&resources::text(table.clone(), &carried.files, &start, "")?);
    let resources = resources::text(table, &carried.files, &start, &token)?;
    check(aircraft, &start, &resources, &carried)?;

    let licence = licence(aircraft);
    let name = name(aircraft, source);
    let identifier = identifier(&name);
    let summary = documentation::summary(&name, trim);
    let description = description::text(&description::Model {
        name: &name,
        identifier: &identifier,
        token: &token,
        description: &summary,
        licence: &licence.short,
        start: &start,
    });
    let files: Vec<String> = carried.files.iter().map(|(name, _)| name.clone()).collect();
    let notes: Vec<String> = aircraft.notes().iter().map(|note| carried.without_places(note)).collect();
    let page = documentation::page(&documentation::Page {
        name: &name,
        summary: &summary,
        notes: &notes,
        files: &files,
        licence: &licence.text,
        trim,
    });

    let mut archive = Archive(ZipWriter::new(Cursor::new(Vec::new())));
    archive.add("modelDescription.xml", description.as_bytes(), false)?;
    archive.add("documentation/index.html", page.as_bytes(), false)?;
    archive.add("documentation/licenses/license.txt", documentation::licence_text(&licence.text).as_bytes(), false)?;
    for (name, bytes) in &carried.licences {
        archive.add(&format!("documentation/licenses/{name}"), bytes, false)?;
    }
    archive.add(&format!("resources/{FILE}"), resources.as_bytes(), false)?;
    for (name, bytes) in &carried.files {
        archive.add(&format!("resources/{name}"), bytes, false)?;
    }
    for library in libraries {
        let name = format!("binaries/{}/{identifier}{}", library.platform, library.ending);
        archive.add(&name, &library.bytes, true)?;
    }
    let bytes = archive.0.finish()?.into_inner();
    Ok(Exported { bytes, identifier, token, platforms, files, licence })
}

struct Archive(ZipWriter<Cursor<Vec<u8>>>);

impl Archive {
    /// A file of the archive, without the time of day, so that the same content makes the same archive.
    fn add(&mut self, name: &str, bytes: &[u8], runs: bool) -> Result<(), ExportError> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(if runs { 0o755 } else { 0o644 });
        self.0.start_file(name, options)?;
        Ok(self.0.write_all(bytes)?)
    }
}

/// The table `[aircraft]` of the resources: that of a scenario, with paths below `resources`.
fn table(source: &Source, carried: &Carried) -> Result<toml::Table, ExportError> {
    use toml::Value::{Array, Float, String as Text, Table};

    let FlownOptions { gravity, thrust, thrust_scale, properties, damage, .. } = &source.options;
    let usual = FlownOptions::default();
    for (option, same) in
        [("gravity", *gravity == usual.gravity), ("scale of thrust", *thrust_scale == usual.thrust_scale)]
    {
        if !same {
            return Err(ExportError::Option(option));
        }
    }
    let mut table = toml::Table::new();
    let mut put = |key: &str, value: toml::Value| {
        table.insert(key.to_owned(), value);
    };
    if carried.entry.is_empty() {
        put("type", Text("f16".into()));
        if let Some(tables) = source.tables {
            put("tables", toml::Value::try_from(tables)?);
        }
        if let Some(cg) = source.cg {
            put("cg", Float(cg));
        }
        return Ok(table);
    }
    put("file", Text(carried.entry.clone()));
    if !carried.with.is_empty() {
        put("with", Array(carried.with.iter().cloned().map(Text).collect()));
    }
    if !properties.is_empty() {
        put("properties", Table(properties.iter().map(|(name, value)| (name.clone(), Float(*value))).collect()));
    }
    if let Thrust::AlongBodyX { largest_n } = *thrust {
        put("largest_thrust", Text(Force::from_si(largest_n).to_string()));
    }
    if *damage != Damage::None {
        put("damaged", Text(damage.word().into()));
    }
    Ok(table)
}

/// A token that only the same content has: the description holds the hash of each file.
fn token(description: &str) -> String {
    let hash = resources::sha256(&[description.as_bytes(), env!("CARGO_PKG_VERSION").as_bytes()]);
    format!("{{{}}}", hash.get(..32).unwrap_or(&hash))
}

/// The name of the aircraft. A model file without one is known by its path, of which the FMU says the last part alone.
fn name(aircraft: &AnyAircraft, source: &Source) -> String {
    let name = aircraft.name();
    let stem = Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    stem.filter(|_| name == source.aircraft).unwrap_or_else(|| name.to_owned())
}

/// A name that C and file names have a place for.
fn identifier(name: &str) -> String {
    let mut word: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).take(60).collect();
    if !word.starts_with(|c: char| c.is_ascii_alphabetic()) {
        word.insert_str(0, "aircraft_");
    }
    word
}

/// A folder that is gone when it is no longer needed.
struct Folder(PathBuf);

impl Folder {
    fn new() -> std::io::Result<Self> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let folder = std::env::temp_dir().join(format!("phugoid-fmu-{}-{number}", std::process::id()));
            match std::fs::create_dir(&folder) {
                Ok(()) => return Ok(Self(folder)),
                // Left by a program that was killed and had the same number.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // There is nobody to tell.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Opens what the FMU carries, as an FMU does, and compares it with the aircraft outside.
fn check(aircraft: &AnyAircraft, start: &Point, text: &str, carried: &Carried) -> Result<(), ExportError> {
    let folder = Folder::new()?;
    let written = std::iter::once((FILE, text.as_bytes()))
        .chain(carried.files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
    for (name, bytes) in written {
        let file = folder.0.join(name);
        if let Some(parent) = file.parent() {
            std::fs::create_dir_all(parent)?;
        }
        std::fs::write(file, bytes)?;
    }
    let inside = Resources::open(&folder.0)?;
    let mut beside = *start;
    (beside.state.alpha, beside.state.beta, beside.state.q) = (start.state.alpha + 0.01, 0.01, 0.02);
    (beside.state.p, beside.state.r, beside.controls.elevator) = (0.03, -0.01, start.controls.elevator - 0.01);
    (beside.controls.aileron, beside.controls.rudder) = (0.02, -0.02);
    let same = [*start, beside].iter().all(|point| rates(aircraft, point) == rates(&inside.aircraft, point));
    if same && inside.start == *start { Ok(()) } else { Err(ExportError::Differs) }
}

/// The rates of the states, bit by bit.
fn rates(aircraft: &AnyAircraft, point: &Point) -> [u64; STATES] {
    motion(aircraft, &point.state, &point.controls, &Disturbance::default()).rates.to_array().map(f64::to_bits)
}

fn licence(aircraft: &AnyAircraft) -> Licence {
    let ours = "The library in this FMU is Phugoid's (MIT or Apache-2.0).";
    let own = "MIT OR Apache-2.0 (library)";
    let (short, text) = match aircraft {
        AnyAircraft::BuiltIn(_) => ("MIT OR Apache-2.0".to_owned(), String::new()),
        AnyAircraft::Model(..) => {
            (
                format!("{own}; the model file is its author's"),
                "It contains the model file of the aircraft, and the files of its base, if it has one: the terms of their authors \
                 hold for this FMU."
                    .to_owned(),
            )
        }
        AnyAircraft::File(AircraftFile::Jsbsim(_)) => (
            format!("{own}; the aircraft's files have terms of their own"),
            "It contains the files of an aircraft of JSBSim, whose terms hold for this FMU: look in the files and in the package \
             that they come from (that of JSBSim itself: LGPL; some of its aircraft: GPL)."
                .to_owned(),
        ),
        AnyAircraft::File(AircraftFile::Transport(_)) => (
            format!("{own}; the aircraft's data: NASA Open Source Agreement 1.3"),
            "It contains data of NASA's Generic Transport Model, under the NASA Open Source Agreement 1.3, whose terms hold for this \
             FMU."
                .to_owned(),
        ),
        _ => (
            format!("{own}; the aircraft's files have terms of their own"),
            "It contains the files of the aircraft. Their authors say on what terms they may be handed on; these terms hold for this \
             FMU."
                .to_owned(),
        ),
    };
    Licence { short, text: format!("{ours} {text}").trim_end().to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_words_of_c() {
        assert_eq!(identifier("f16"), "f16");
        assert_eq!(identifier("F-16 of NASA TP-1538"), "F_16_of_NASA_TP_1538");
        assert_eq!(identifier("747/\u{e9}"), "aircraft_747__");
        assert_eq!(identifier(""), "aircraft_");
        assert_eq!(identifier(&"a".repeat(500)).len(), 60);
    }
}
