//! Aircraft of other programs' files as an [`Aircraft`](phugoid_flight_dynamics::aircraft::Aircraft): what trim, linear models, scenarios and studies work on, over a flat
//! earth.
//!
//! [`FlownJsbsim`] is an aircraft of JSBSim, [`Transport`] the transport of NASA with damage; [`AircraftFile`] opens whatever kind of file a path leads to. What the files say
//! and the equations of motion cannot take in, and what had to be assumed, each of them tells in sentences (`notes`).

mod error;
mod jsbsim;
mod options;
mod surface;

use std::path::Path;

use phugoid_flight_dynamics::aircraft_by_variant;

pub use self::error::FlownError;
pub use self::jsbsim::FlownJsbsim;
pub use self::options::{FlownOptions, Thrust};
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
    /// The Generic Transport Model of NASA.
    Transport(Box<Transport>),
}

impl AircraftFile {
    /// Opens a file, or of a folder `name` the file `name/name.xml`: an aircraft of JSBSim if it begins with `fdm_config`. A
    /// folder with a file `vehicle.json` is the Generic Transport Model of NASA.
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
            let options =
                TransportOptions { damage: options.damage, gravity: options.gravity, ..TransportOptions::default() };
            return Ok(Self::Transport(Box::new(Transport::open_with(path, &options)?)));
        }
        if options.damage != Damage::None {
            return no_option("damaged", "an aircraft of JSBSim");
        }
        if !path.is_dir() {
            let root = root_of(path)?;
            if root != "fdm_config" {
                return Err(FlownError::UnknownKind { file: path.into(), root });
            }
        }
        Ok(Self::Jsbsim(Box::new(FlownJsbsim::open_with(path, options)?)))
    }

    /// The name that the file gives the aircraft.
    pub fn name(&self) -> &str {
        match self {
            Self::Jsbsim(aircraft) => aircraft.name(),
            Self::Transport(aircraft) => aircraft.name(),
        }
    }

    /// What is left out and what is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        match self {
            Self::Jsbsim(aircraft) => aircraft.notes(),
            Self::Transport(aircraft) => aircraft.notes(),
        }
    }
}

/// Name of the outermost element of a file.
fn root_of(file: &Path) -> Result<String, FlownError> {
    let text = crate::jsbsim::text_of(file)?;
    let document = xml::parse(&text).map_err(|source| FlownError::NoXml { file: file.into(), source })?;
    Ok(document.root_element().tag_name().name().chars().take(60).collect())
}

aircraft_by_variant!(AircraftFile, aircraft: Self::Jsbsim(aircraft), Self::Transport(aircraft));
