//! Aircraft of other programs' files as an [`Aircraft`](phugoid_flight_dynamics::aircraft::Aircraft): what trim, linear models, scenarios and studies work on, over a flat
//! earth.
//!
//! [`FlownJsbsim`] is an aircraft of JSBSim, [`FlownDaveml`] one in DAVE-ML, [`Transport`] the transport of NASA with damage, [`Tp1538`] the
//! F-16 of NASA's report of that number; [`AircraftFile`] opens whatever kind of file a path leads to. What the files say
//! and the equations of motion cannot take in, and what had to be assumed, each of them tells in sentences (`notes`).

mod daveml;
mod error;
mod jsbsim;
mod options;
mod pool;
mod scaled;
mod surface;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use phugoid_flight_dynamics::aircraft::Aircraft as _;
use phugoid_flight_dynamics::aircraft_by_variant;
use phugoid_flight_dynamics::f16::F16Options;

pub use self::daveml::FlownDaveml;
pub use self::error::FlownError;
pub use self::jsbsim::{FlightControl, FlownJsbsim, Sensed};
pub use self::options::{FlownOptions, Thrust};
pub use self::scaled::Scaled;
use crate::tp1538::{self, Tp1538};
use crate::transport::{Damage, Transport, TransportOptions};
use crate::xml;

/// An aircraft of a file, whatever program it was made for.
///
/// ```no_run
/// use phugoid_aircraft::flown::AircraftFile;
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
///
/// let aircraft = AircraftFile::open("jsbsim/aircraft/c182")?;
/// for note in aircraft.notes() {
///     eprintln!("{note}");
/// }
/// let level = trim(&aircraft, &TrimCondition::steady(&aircraft, 61.7, 1524.0, 0.0, 0.0))?;
/// println!("{:.2} deg, throttle {:.2}", level.alpha_rad.to_degrees(), level.throttle);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum AircraftFile {
    /// An aircraft of JSBSim.
    Jsbsim(Box<FlownJsbsim>),
    /// An aircraft in DAVE-ML.
    Daveml(Box<FlownDaveml>),
    /// The Generic Transport Model of NASA.
    Transport(Box<Transport>),
    /// The F-16 of NASA TP-1538.
    Tp1538(Box<Tp1538>),
    /// One of these whose coefficients change more than its file says ([`AircraftFile::scaled`]).
    Scaled(Box<Scaled>),
}

impl AircraftFile {
    /// Opens a file, or of a folder `name` the file `name/name.xml`: an aircraft of JSBSim if it begins with `fdm_config`, one in
    /// DAVE-ML if it ends in `.dml` or begins with `DAVEfunc`. A folder with a file `vehicle.json` is the Generic Transport Model of NASA. A
    /// folder with `tp1538_tables.json`, or that file, is the F-16 of NASA TP-1538, whose property `cg` is its centre of gravity.
    ///
    /// # Errors
    /// [`FlownError`]: the file cannot be read, is of no known kind, or does not make an aircraft that can be flown.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FlownError> {
        Self::open_with(path, &FlownOptions::default())
    }

    /// As [`open`](Self::open), with options.
    ///
    /// # Errors
    /// As [`open`](Self::open), and for an option that makes no sense.
    pub fn open_with(path: impl AsRef<Path>, options: &FlownOptions) -> Result<Self, FlownError> {
        let path = path.as_ref();
        let no_option = |option: &'static str, aircraft: &'static str| {
            Err(FlownError::Option { file: path.into(), option, aircraft })
        };
        if path.join("vehicle.json").is_file() {
            if !options.with.is_empty() {
                return no_option("with", "the Generic Transport Model");
            }
            let transport = "the Generic Transport Model";
            if !options.properties.is_empty() {
                return no_option("properties", transport);
            }
            if options.thrust != Thrust::Engines {
                return no_option("largest_thrust", transport);
            }
            if options.thrust_scale != 1.0 {
                return no_option("thrust_scale", transport);
            }
            no_flight_control(path, options, "this is the Generic Transport Model")?;
            let options =
                TransportOptions { damage: options.damage, gravity: options.gravity, ..TransportOptions::default() };
            return Ok(Self::Transport(Box::new(Transport::open_with(path, &options)?)));
        }
        if path.join(tp1538::FILE).is_file() || path.file_name().is_some_and(|name| name == tp1538::FILE) {
            return open_tp1538(path, options);
        }
        if options.damage != Damage::None {
            return no_option("damaged", "an aircraft of JSBSim or in DAVE-ML");
        }
        if path.is_dir() {
            let of_the_folder = path.file_name().map(|name| path.join(name).with_extension("xml"));
            if !of_the_folder.is_some_and(|file| file.is_file()) && has_models(path) {
                return Err(FlownError::Models { folder: path.into() });
            }
        } else if is_model(path) {
            // Some of these files are no XML before they are repaired, so that they are known by their name first.
            no_flight_control(path, options, DAVEML)?;
            return Ok(Self::Daveml(Box::new(FlownDaveml::open_with(path, options)?)));
        } else {
            match root_of(path)?.as_str() {
                "fdm_config" => {}
                "DAVEfunc" => {
                    no_flight_control(path, options, DAVEML)?;
                    return Ok(Self::Daveml(Box::new(FlownDaveml::open_with(path, options)?)));
                }
                root => return Err(FlownError::UnknownKind { file: path.into(), root: root.to_owned() }),
            }
        }
        if !options.with.is_empty() {
            return no_option("with", "an aircraft of JSBSim");
        }
        Ok(Self::Jsbsim(Box::new(FlownJsbsim::open_with(path, options)?)))
    }

    /// The name that the file gives the aircraft.
    pub fn name(&self) -> &str {
        match self {
            Self::Jsbsim(aircraft) => aircraft.name(),
            Self::Daveml(aircraft) => aircraft.name(),
            Self::Transport(aircraft) => aircraft.name(),
            Self::Tp1538(_) => "F-16 of NASA TP-1538",
            Self::Scaled(scaled) => scaled.aircraft().name(),
        }
    }

    /// Centre of gravity behind the leading edge of the mean chord, fraction of it; none in DAVE-ML, which counts from a
    /// moment reference point that is anywhere.
    pub fn centre_of_gravity(&self) -> Option<f64> {
        match self {
            Self::Jsbsim(_) | Self::Transport(_) | Self::Tp1538(_) => Some(self.geometry().cg),
            Self::Daveml(_) => None,
            Self::Scaled(scaled) => scaled.aircraft().centre_of_gravity(),
        }
    }

    /// The files that it was read from when it was [opened](Self::open_with) by this path with these options, its own first: what
    /// has to be carried along so that it can be opened elsewhere. Their places to each other are to be kept.
    ///
    /// # Errors
    /// A folder of tables that cannot be listed.
    pub fn files(&self, path: &Path, options: &FlownOptions) -> std::io::Result<Vec<PathBuf>> {
        match self {
            Self::Jsbsim(aircraft) => Ok(aircraft.aircraft().files().to_vec()),
            Self::Daveml(_) => {
                Ok(std::iter::once(path).chain(options.with.iter().map(PathBuf::as_path)).map(Into::into).collect())
            }
            Self::Transport(_) => {
                let listed = std::fs::read_dir(path.join("tables"))?.collect::<Result<Vec<_>, _>>()?;
                let is_table = |file: &PathBuf| file.extension().is_some_and(|end| end == "json");
                let mut tables: Vec<PathBuf> = listed.into_iter().map(|file| file.path()).filter(is_table).collect();
                tables.sort();
                Ok(std::iter::once(path.join("vehicle.json")).chain(tables).collect())
            }
            Self::Tp1538(_) if path.is_dir() => Ok(vec![path.join(tp1538::FILE)]),
            Self::Tp1538(_) => Ok(vec![path.into()]),
            Self::Scaled(scaled) => scaled.aircraft().files(path, options),
        }
    }

    /// Names of the variables and tables of which the file says how well they are known: the `uncertainty` elements of DAVE-ML. Empty
    /// for all other files, which cannot say it.
    pub fn uncertain(&self) -> Vec<String> {
        match self {
            Self::Daveml(aircraft) => aircraft.uncertain(),
            _ => Vec::new(),
        }
    }

    /// Correlation of each of [`uncertain`](Self::uncertain) with each, -1 to 1, as the file says it.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        match self {
            Self::Daveml(aircraft) => aircraft.correlations(),
            _ => Vec::new(),
        }
    }

    /// The aircraft with one of [`uncertain`](Self::uncertain) moved by so many of its standard uncertainties
    /// ([`FlownDaveml::moved`]). `None` for a place beyond the last, and where a bound does not belong to its table.
    pub fn moved(&self, uncertain: usize, by: f64) -> Option<Self> {
        match self {
            Self::Daveml(aircraft) => Some(Self::Daveml(Box::new(aircraft.moved(uncertain, by)?))),
            _ => None,
        }
    }

    /// The aircraft with each of `CL, CD, Cm, CY, Cl, Cn` (lift and drag along the stability axes) larger by a part of its difference
    /// from the value in `reference`, which stands for a database that is off by that part of what changes in flight. Numbers that are
    /// not finite make coefficients that are not.
    pub fn scaled(aircraft: Arc<Self>, parts: [f64; 6], reference: [f64; 6]) -> Self {
        Self::Scaled(Box::new(Scaled::new(aircraft, parts, reference)))
    }

    /// What is left out and what is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        match self {
            Self::Jsbsim(aircraft) => aircraft.notes(),
            Self::Daveml(aircraft) => aircraft.notes(),
            Self::Transport(aircraft) => aircraft.notes(),
            Self::Tp1538(aircraft) => aircraft.notes(),
            Self::Scaled(scaled) => scaled.aircraft().notes(),
        }
    }
}

/// Why flight control of an aircraft in DAVE-ML cannot run.
const DAVEML: &str = "this one is in DAVE-ML";

/// Refuses flight control for an aircraft that has none.
fn no_flight_control(path: &Path, options: &FlownOptions, why: &str) -> Result<(), FlownError> {
    if options.flight_control {
        return Err(FlownError::NoFlightControl { file: path.into(), why: why.to_owned() });
    }
    Ok(())
}

/// The F-16 of NASA TP-1538, whose one property is its centre of gravity.
fn open_tp1538(path: &Path, options: &FlownOptions) -> Result<AircraftFile, FlownError> {
    for (option, given) in [
        ("damaged", options.damage != Damage::None),
        ("largest_thrust", options.thrust != Thrust::Engines),
        ("thrust_scale", options.thrust_scale != 1.0),
        ("with", !options.with.is_empty()),
    ] {
        if given {
            return Err(FlownError::Option { file: path.into(), option, aircraft: "the F-16 of NASA TP-1538" });
        }
    }
    no_flight_control(path, options, "this is the F-16 of NASA TP-1538")?;
    let mut cg = F16Options::default().cg;
    for (name, value) in &options.properties {
        if name != "cg" {
            return Err(FlownError::Property { name: name.clone(), settable: "cg".to_owned() });
        }
        if !(0.0..=1.0).contains(value) {
            let what = "the centre of gravity (`cg`), a fraction of the mean chord,";
            return Err(FlownError::Number { what, value: *value, expected: "0 to 1" });
        }
        cg = *value;
    }
    Ok(AircraftFile::Tp1538(Box::new(Tp1538::open(path, cg)?)))
}

/// Whether a file is a model in DAVE-ML by its name.
fn is_model(file: &Path) -> bool {
    file.extension().is_some_and(|end| end.eq_ignore_ascii_case("dml"))
}

/// Whether there is such a file in a folder.
fn has_models(folder: &Path) -> bool {
    std::fs::read_dir(folder).is_ok_and(|files| files.flatten().any(|file| is_model(&file.path())))
}

/// Name of the outermost element of a file.
fn root_of(file: &Path) -> Result<String, FlownError> {
    let text = crate::jsbsim::text_of(file)?;
    let document = xml::parse(&text).map_err(|source| FlownError::NoXml { file: file.into(), source })?;
    Ok(document.root_element().tag_name().name().chars().take(60).collect())
}

aircraft_by_variant!(
    AircraftFile,
    aircraft: Self::Jsbsim(aircraft),
    Self::Daveml(aircraft),
    Self::Transport(aircraft),
    Self::Tp1538(aircraft),
    Self::Scaled(aircraft),
);
