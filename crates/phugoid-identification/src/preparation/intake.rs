//! Which channels become the known inputs and the measured outputs of a model.

use phugoid_flight_dynamics::atmosphere::Atmosphere;

use crate::core::error::EstimateError;
use crate::core::output::Output;
use crate::model_file::{AirDensity, InputHold, ModelFile, Source, Thrust};
use crate::motion::{Known, Motion};

/// Where a known input comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Origin {
    /// The same value at every sample, SI.
    Constant(f64),
    /// The channel of this name.
    Channel(String),
    /// The density of this atmosphere at the channel `altitude`.
    DensityAt(Atmosphere),
}

impl Origin {
    fn of(source: &Source) -> Self {
        match source {
            Source::Constant(value) => Self::Constant(*value),
            Source::Channel(name) => Self::Channel(name.clone()),
        }
    }

    pub(crate) fn of_density(file: &ModelFile) -> Self {
        match &file.aircraft.air_density {
            AirDensity::Known(source) => Self::of(source),
            AirDensity::StandardAtmosphere => Self::DensityAt(Atmosphere::Standard),
            AirDensity::BookAtmosphere => Self::DensityAt(Atmosphere::Book),
        }
    }

    pub(crate) fn of_mass(file: &ModelFile) -> Self {
        Self::of(&file.aircraft.mass)
    }

    /// The channel that it needs; none if it is constant.
    pub(crate) fn channel(&self) -> Option<&str> {
        match self {
            Self::Constant(_) => None,
            Self::Channel(name) => Some(name),
            Self::DensityAt(_) => Some("altitude"),
        }
    }

    /// Its value where its channel has this one.
    pub(crate) fn value(&self, channel: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Channel(_) => channel,
            Self::DensityAt(atmosphere) => atmosphere.at(channel).density,
        }
    }
}

/// A known input of the model: its name, its SI unit and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KnownInput {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) origin: Origin,
}

/// The known inputs of a model: those of its axes, then air, mass and inertia, then the extra inputs. `trim_thrust` (N)
/// is used where the file takes the thrust from the trim.
///
/// # Errors
/// [`EstimateError::Model`] if the file lacks what its axes need.
pub(crate) fn known_inputs(file: &ModelFile, trim_thrust: Option<f64>) -> Result<Vec<KnownInput>, EstimateError> {
    let aircraft = &file.aircraft;
    let thrust = match (&aircraft.thrust, trim_thrust) {
        (Thrust::Known(source), _) => Origin::of(source),
        (Thrust::Trim, Some(thrust)) => Origin::Constant(thrust),
        (Thrust::Trim, None) => return Err(EstimateError::Model("thrust = \"trim\" needs a database".to_owned())),
    };
    let mut known = Vec::new();
    let mut add = |name: &str, unit: &str, origin: Origin| {
        known.push(KnownInput { name: name.to_owned(), unit: unit.to_owned(), origin });
    };
    for name in file.axes.known_channels() {
        add(name, Output::from_name(name).map_or("rad", Output::unit), Origin::Channel((*name).to_owned()));
    }
    add("air_density", "kg/m^3", Origin::of_density(file));
    add("thrust", "N", thrust);
    add("mass", "kg", Origin::of_mass(file));
    add("iyy", "kg*m^2", Origin::of(&aircraft.iyy));
    if file.axes.has_lateral() {
        for (name, source) in [("ixx", &aircraft.ixx), ("izz", &aircraft.izz), ("ixz", &aircraft.ixz)] {
            let Some(source) = source else {
                let message =
                    format!("{}: the {} motion needs `{name}` under [aircraft]", file.source, file.axes.name());
                return Err(EstimateError::Model(message));
            };
            add(name, "kg*m^2", Origin::of(source));
        }
    }
    for name in &file.extra_inputs {
        add(name, "-", Origin::Channel(name.clone()));
    }
    Ok(known)
}

/// The model's input from the values of its known inputs, in the order of [`known_inputs`]: those before `named` go to
/// their places by name, the rest are the extra inputs.
pub(crate) fn model_input<'a, M: Motion<N, R>, const N: usize, const R: usize>(
    hold: InputHold,
    named: usize,
    inputs: impl Iterator<Item = (&'a str, f64)>,
) -> M::KnownInput {
    let mut at = Known::new(hold);
    for (index, (name, value)) in inputs.enumerate() {
        let slot = if index < named { at.slot(name) } else { at.extra.get_mut(index - named) };
        if let Some(slot) = slot {
            *slot = value;
        }
    }
    M::known_input(&at)
}
