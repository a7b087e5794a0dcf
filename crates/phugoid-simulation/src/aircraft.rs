//! The aircraft that a name or a file stands for, whatever kind of file it is: what scenarios and command lines fly.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use phugoid_aircraft::flown::{AircraftFile, FlownError, FlownOptions};
use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::aircraft_by_variant;
use phugoid_flight_dynamics::built_in::{AircraftName, BuiltInAircraft};
use phugoid_flight_dynamics::f16::{F16DataError, F16Options, F16Tables};
use phugoid_identification::aircraft::{ModelAircraft, ModelAircraftError};
use phugoid_identification::model_file::{ModelError, ModelFile};

/// Why a name or a file stands for no aircraft that can be flown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AircraftError {
    /// The data of a built-in aircraft cannot be read.
    #[error(transparent)]
    BuiltIn(#[from] F16DataError),
    /// A file of another program cannot be read or flown.
    #[error(transparent)]
    File(#[from] FlownError),
    /// A model file cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model file makes no aircraft.
    #[error("{}: {source}", file.display())]
    Incomplete {
        /// The model file.
        file: PathBuf,
        /// What it lacks.
        source: ModelAircraftError,
    },
    /// Damage of this kind cannot happen to this aircraft in flight.
    #[error("`damaged` is for the Generic Transport Model, and the aircraft is `{0}`: take [[damage]] with increments")]
    NoDamage(String),
    /// A model file was opened with an option that only aircraft of other programs have.
    #[error("{}: `{option}` is for aircraft of other programs; {instead}", file.display())]
    Option {
        /// The model file.
        file: PathBuf,
        /// The option.
        option: &'static str,
        /// What to do in its place.
        instead: &'static str,
    },
}

/// An aircraft by name or from a file: built in, of another program, or of a model file.
///
/// It is an [`Aircraft`]; which one is asked at each call, which costs nothing beside the aerodynamics of a file.
///
/// ```
/// use phugoid_aircraft::flown::FlownOptions;
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
/// use phugoid_simulation::aircraft::AnyAircraft;
///
/// let jet = AnyAircraft::open("hfb320", &FlownOptions::default())?;
/// let level = trim(&jet, &TrimCondition::steady(&jet, 106.0, 5000.0, 0.0, 0.0))?;
/// assert!(level.alpha_rad > 0.0 && (level.load_factor - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum AnyAircraft {
    /// One that comes with Phugoid.
    BuiltIn(BuiltInAircraft),
    /// One of another program's file.
    File(AircraftFile),
    /// One of a model file.
    Model(Box<ModelAircraft>, BTreeMap<String, f64>),
}

impl AnyAircraft {
    /// The F-16 with these tables and this centre of gravity (fraction of the mean chord behind its leading edge); the book's
    /// tables and the reference point of the data where they are not given.
    ///
    /// # Errors
    /// [`AircraftError::BuiltIn`]: a centre of gravity that is not finite.
    pub fn f16(tables: Option<F16Tables>, cg: Option<f64>) -> Result<Self, AircraftError> {
        let cg = cg.unwrap_or(F16Options::default().cg);
        Ok(Self::BuiltIn(BuiltInAircraft::new(AircraftName::F16, tables.unwrap_or_default(), cg)?))
    }

    /// Centre of gravity behind the leading edge of the mean chord, fraction of it; none for a model file that does not say
    /// it (its coefficients are about the centre of gravity wherever that is), and none in DAVE-ML.
    pub fn centre_of_gravity(&self) -> Option<f64> {
        match self {
            Self::Model(aircraft, _) => aircraft.centre_of_gravity(),
            Self::BuiltIn(_) => Some(self.geometry().cg),
            Self::File(aircraft) => aircraft.centre_of_gravity(),
        }
    }

    /// Opens the aircraft of a file: a model file if its name ends in `.toml`, else a file or a folder of another program, in DAVE-ML among others
    /// ([`AircraftFile`]), which the options are for. Where there is no such file, the built-in model of this name
    /// (`hfb320`).
    ///
    /// # Errors
    /// [`AircraftError`]: no such file, a file that cannot be read, or one that makes no aircraft.
    pub fn open(path: impl AsRef<Path>, options: &FlownOptions) -> Result<Self, AircraftError> {
        let path = path.as_ref();
        let is_model = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"));
        let named = path.to_str().filter(|word| !path.exists() && ModelFile::text(word).is_ok());
        if !is_model && named.is_none() {
            return Ok(Self::File(AircraftFile::open_with(path, options)?));
        }
        let standard = FlownOptions::default();
        let in_file = "write it into the model file";
        for (option, given) in [
            ("properties", options.properties != standard.properties),
            ("thrust_scale", options.thrust_scale != standard.thrust_scale),
            ("largest_thrust", options.thrust != standard.thrust),
            ("damaged", options.damage != standard.damage),
            ("with", options.with != standard.with),
        ] {
            if given {
                return Err(AircraftError::Option { file: path.into(), option, instead: in_file });
            }
        }
        if options.flight_control {
            let why = "this is a model file".to_owned();
            return Err(FlownError::NoFlightControl { file: path.into(), why }.into());
        }
        let model = named.map_or_else(|| ModelFile::open(path), ModelFile::named)?;
        let aircraft =
            ModelAircraft::new(&model).map_err(|source| AircraftError::Incomplete { file: path.into(), source })?;
        let values = model.parameters.iter().filter(|p| !p.is_nuisance()).map(|p| (p.name.clone(), p.start)).collect();
        Ok(Self::Model(Box::new(aircraft), values))
    }

    /// The name of the aircraft: that of the word for one that is built in, else the one that the file gives.
    pub fn name(&self) -> &str {
        match self {
            Self::BuiltIn(BuiltInAircraft::F16(_)) => "f16",
            Self::File(aircraft) => aircraft.name(),
            Self::Model(aircraft, _) => aircraft.name(),
        }
    }

    /// What the file asks for and is left out, and what is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        match self {
            Self::BuiltIn(_) => &[],
            Self::File(aircraft) => aircraft.notes(),
            Self::Model(aircraft, _) => aircraft.notes(),
        }
    }

    /// True values of the parameters of a model file, by name, per radian where an angle is involved: what an estimation
    /// with the same terms has to find. Empty for an aircraft whose coefficients are not built of terms.
    pub fn parameters(&self) -> &BTreeMap<String, f64> {
        const NONE: &BTreeMap<String, f64> = &BTreeMap::new();
        match self {
            Self::Model(_, values) => values,
            Self::BuiltIn(_) | Self::File(_) => NONE,
        }
    }
}

aircraft_by_variant!(
    AnyAircraft,
    aircraft: Self::BuiltIn(aircraft),
    Self::File(aircraft),
    Self::Model(aircraft, _),
);
