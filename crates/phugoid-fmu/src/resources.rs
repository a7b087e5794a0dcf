//! What an FMU carries of its aircraft: the file `aircraft.toml` in its folder `resources`, and the aircraft's own files beside it.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use phugoid_flight_dynamics::aircraft::{Controls, State};
use phugoid_identification::stack::STACK_BYTES;
use phugoid_simulation::aircraft::{AircraftError, AnyAircraft};
use phugoid_simulation::scenario::AircraftSettings;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::point::Point;

/// Name of the description in the folder `resources`.
pub const FILE: &str = "aircraft.toml";
/// What the description is written as; another number is refused.
pub const FORMAT: u32 = 1;
/// Largest description that is read, bytes: a hundred times the largest one that is written.
const MOST_BYTES: u64 = 1 << 20;
/// Largest file of an aircraft, bytes: the most that readers of aircraft take.
const MOST_BYTES_OF_FILE: u64 = 64 << 20;

/// Why the resources of an FMU make no aircraft.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResourceError {
    /// The description cannot be read.
    #[error("{} cannot be read: {source}. The FMU is not unpacked as a whole, or damaged: export it again", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// It is much too large.
    #[error("{} is larger than {MOST_BYTES} bytes: it is no description that `phugoid export-fmu` writes", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
    },
    /// It is no description.
    #[error("{} is no description of an aircraft: {source}", file.display())]
    Wrong {
        /// The file.
        file: PathBuf,
        /// Line, column and what is wrong there.
        source: Box<toml::de::Error>,
    },
    /// It was written by another version.
    #[error("{} has format {found}, and this library reads format {FORMAT}: export the FMU again", file.display())]
    Format {
        /// The file.
        file: PathBuf,
        /// Its format.
        found: u32,
    },
    /// A number of it is not finite.
    #[error("{}: a number of [state] or [controls] is not finite", file.display())]
    NotFinite {
        /// The file.
        file: PathBuf,
    },
    /// No aircraft is named, or two.
    #[error("{}: [aircraft] needs either `type` or `file`", file.display())]
    Unnamed {
        /// The file.
        file: PathBuf,
    },
    /// A file of the aircraft is not what was exported. Readers of aircraft leave out what they do not find, and fly on with
    /// something else.
    #[error("{} was changed after the FMU was exported: export it again", file.display())]
    Changed {
        /// The file.
        file: PathBuf,
    },
    /// The files of the aircraft cannot be read or make none.
    #[error("the aircraft of the FMU: {0}")]
    Aircraft(#[from] AircraftError),
    /// The system gives no further thread.
    #[error("no thread to read the aircraft in: {0}")]
    Thread(std::io::Error),
    /// Reading ended in a panic, which is a defect of this library.
    #[error("the aircraft of the FMU cannot be read, by a defect of Phugoid: {0}")]
    Panic(String),
}

/// The state of a description, SI and radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StateNumbers {
    speed: f64,
    alpha: f64,
    beta: f64,
    phi: f64,
    theta: f64,
    psi: f64,
    p: f64,
    q: f64,
    r: f64,
    north: f64,
    east: f64,
    altitude: f64,
    power: f64,
}

impl From<State> for StateNumbers {
    fn from(s: State) -> Self {
        let State { speed, alpha, beta, phi, theta, psi, p, q, r, north, east, altitude, power } = s;
        Self { speed, alpha, beta, phi, theta, psi, p, q, r, north, east, altitude, power }
    }
}

impl From<StateNumbers> for State {
    fn from(s: StateNumbers) -> Self {
        let StateNumbers { speed, alpha, beta, phi, theta, psi, p, q, r, north, east, altitude, power } = s;
        Self { speed, alpha, beta, phi, theta, psi, p, q, r, north, east, altitude, power }
    }
}

/// The controls of a description, rad and throttle 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControlNumbers {
    throttle: f64,
    elevator: f64,
    aileron: f64,
    rudder: f64,
}

impl From<Controls> for ControlNumbers {
    fn from(Controls { throttle, elevator, aileron, rudder }: Controls) -> Self {
        Self { throttle, elevator, aileron, rudder }
    }
}

impl From<ControlNumbers> for Controls {
    fn from(ControlNumbers { throttle, elevator, aileron, rudder }: ControlNumbers) -> Self {
        Self { throttle, elevator, aileron, rudder }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    /// Was looked at before.
    #[serde(rename = "format")]
    _format: u32,
    instantiation_token: String,
    /// The files of the aircraft below `resources`, with their SHA-256.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// As in a scenario; paths are relative to the folder `resources`.
    aircraft: AircraftSettings,
    state: StateNumbers,
    controls: ControlNumbers,
}

/// What an FMU carries: its aircraft, where its flight begins, and the token by which a model description and its resources
/// know that they belong together.
#[derive(Clone, Debug)]
pub struct Resources {
    /// The aircraft.
    pub aircraft: Arc<AnyAircraft>,
    /// The flight at its start: the trim.
    pub start: Point,
    /// The token.
    pub token: String,
}

impl Resources {
    /// Reads the resources in a folder. It is done in a thread of its own with 16 MB of stack: whoever runs an FMU may call from
    /// a thread with little, and readers of aircraft go deep.
    ///
    /// # Errors
    /// [`ResourceError`] names the file and what is wrong with it.
    pub fn open(folder: &Path) -> Result<Self, ResourceError> {
        let thread = std::thread::Builder::new().name("phugoid resources".into()).stack_size(STACK_BYTES);
        std::thread::scope(|scope| {
            let reading = thread.spawn_scoped(scope, || Self::read(folder)).map_err(ResourceError::Thread)?;
            reading.join().unwrap_or_else(|panic| Err(ResourceError::Panic(panic_text(panic.as_ref()))))
        })
    }

    fn read(folder: &Path) -> Result<Self, ResourceError> {
        let file = folder.join(FILE);
        let unreadable = |source| ResourceError::Unreadable { file: file.clone(), source };
        let mut text = String::new();
        let opened = std::fs::File::open(&file).map_err(unreadable)?;
        opened.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(unreadable)?;
        if text.len() as u64 > MOST_BYTES {
            return Err(ResourceError::TooLarge { file });
        }
        let wrong = |source| ResourceError::Wrong { file: file.clone(), source: Box::new(source) };
        // The format first: of another one nothing else is understood.
        let found = toml::from_str::<Format>(&text).map_err(wrong)?.format;
        if found != FORMAT {
            return Err(ResourceError::Format { file, found });
        }
        let description: Description = toml::from_str(&text).map_err(wrong)?;
        let start = Point::new(description.state.into(), description.controls.into());
        if Point::from_bytes(&start.to_bytes()).is_err() {
            return Err(ResourceError::NotFinite { file });
        }
        if description.aircraft.kind.is_some() == description.aircraft.file.is_some() {
            return Err(ResourceError::Unnamed { file });
        }
        for (name, hash) in &description.files {
            check_file(folder, name, hash)?;
        }
        let aircraft = description.aircraft.aircraft(folder)?;
        Ok(Self { aircraft, start, token: description.instantiation_token })
    }
}

/// Refuses a file that is not there, or is another one than was exported.
fn check_file(folder: &Path, name: &str, hash: &str) -> Result<(), ResourceError> {
    let file = folder.join(name);
    let mut bytes = Vec::new();
    let is_below = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    if is_below {
        let unreadable = |source| ResourceError::Unreadable { file: file.clone(), source };
        let opened = std::fs::File::open(&file).map_err(unreadable)?;
        opened.take(MOST_BYTES_OF_FILE).read_to_end(&mut bytes).map_err(unreadable)?;
    }
    if is_below && sha256(&[&bytes]) == hash { Ok(()) } else { Err(ResourceError::Changed { file }) }
}

/// SHA-256 of parts one after the other, as hexadecimal digits.
pub(crate) fn sha256(parts: &[&[u8]]) -> String {
    let mut hash = Sha256::new();
    parts.iter().for_each(|part| hash.update(part));
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[derive(Deserialize)]
struct Format {
    format: u32,
}

/// What a panic says of itself.
pub(crate) fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without a message")
        .to_owned()
}

/// The text of a description, which [`Resources::open`] reads.
#[cfg(feature = "write")]
pub(crate) fn text(
    aircraft: toml::Table,
    files: &[(String, Vec<u8>)],
    start: &Point,
    token: &str,
) -> Result<String, toml::ser::Error> {
    #[derive(Serialize)]
    struct Written<'a> {
        format: u32,
        instantiation_token: &'a str,
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        files: BTreeMap<&'a str, String>,
        aircraft: toml::Table,
        state: StateNumbers,
        controls: ControlNumbers,
    }
    let written = Written {
        format: FORMAT,
        instantiation_token: token,
        files: files.iter().map(|(name, bytes)| (name.as_str(), sha256(&[bytes]))).collect(),
        aircraft,
        state: start.state.into(),
        controls: start.controls.into(),
    };
    let head =
        "# The aircraft of this FMU, as in a scenario of Phugoid, and where its flight begins. SI units and radians.\n";
    Ok(format!("{head}{}", toml::to_string(&written)?))
}
