//! The aircraft that come with the crate, by name: the one place that decides which aircraft a word means.
//!
//! Trim, linearisation and simulation take anything that implements [`Aircraft`]. A program that lets its user name an
//! aircraft asks here.

use serde::{Deserialize, Serialize};

use crate::actuator::Actuators;
use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use crate::atmosphere::Atmosphere;
use crate::f16::{F16, F16DataError, F16Options, F16Tables};
use crate::mass::MassProperties;
use crate::scalar::Scalar;

/// The names of the built-in aircraft, as scenario files and command lines write them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AircraftName {
    /// `f16`: the F-16 of Stevens, Lewis and Johnson.
    F16,
}

impl AircraftName {
    /// The name as scenario files and command lines write it.
    pub fn word(self) -> &'static str {
        match self {
            Self::F16 => "f16",
        }
    }
}

/// A built-in aircraft.
///
/// ```
/// use phugoid_flight_dynamics::aircraft::Aircraft;
/// use phugoid_flight_dynamics::built_in::{AircraftName, BuiltInAircraft};
/// use phugoid_flight_dynamics::f16::F16Tables;
///
/// let aircraft = BuiltInAircraft::new(AircraftName::F16, F16Tables::Book, 0.30)?;
/// assert!((aircraft.mass_properties().mass() - 9_295.0).abs() < 10.0);
/// # Ok::<(), phugoid_flight_dynamics::f16::F16DataError>(())
/// ```
///
/// It is an [`Aircraft`] itself. Where speed matters, match once and hand the aircraft inside to a generic function. An
/// aircraft that is read from a model file becomes another variant here.
#[derive(Clone, Debug)]
pub enum BuiltInAircraft {
    /// The F-16 of Stevens, Lewis and Johnson.
    F16(Box<F16>),
}

impl BuiltInAircraft {
    /// The aircraft of a name, with the aerodynamic tables asked for and its centre of gravity at `cg` (fraction of the mean
    /// aerodynamic chord behind its leading edge).
    ///
    /// # Errors
    /// [`F16DataError`]: the embedded data files cannot be read, or `cg` is not a finite number.
    pub fn new(name: AircraftName, tables: F16Tables, cg: f64) -> Result<Self, F16DataError> {
        match name {
            AircraftName::F16 => Ok(Self::F16(Box::new(F16::new(F16Options { tables, cg, ..F16Options::default() })?))),
        }
    }
}

impl Aircraft for BuiltInAircraft {
    #[inline]
    fn geometry(&self) -> &Geometry {
        match self {
            Self::F16(aircraft) => aircraft.geometry(),
        }
    }

    #[inline]
    fn mass_properties(&self) -> &MassProperties {
        match self {
            Self::F16(aircraft) => aircraft.mass_properties(),
        }
    }

    #[inline]
    fn gravity(&self) -> f64 {
        match self {
            Self::F16(aircraft) => aircraft.gravity(),
        }
    }

    #[inline]
    fn atmosphere(&self) -> Atmosphere {
        match self {
            Self::F16(aircraft) => aircraft.atmosphere(),
        }
    }

    #[inline]
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        match self {
            Self::F16(aircraft) => aircraft.coefficients(air, rates, controls),
        }
    }

    #[inline]
    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        match self {
            Self::F16(aircraft) => aircraft.alpha_rate_coefficients(air, rates, controls),
        }
    }

    #[inline]
    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        match self {
            Self::F16(aircraft) => aircraft.propulsion(power, altitude, mach),
        }
    }

    #[inline]
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        match self {
            Self::F16(aircraft) => aircraft.power_rate(throttle, power),
        }
    }

    #[inline]
    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        match self {
            Self::F16(aircraft) => aircraft.steady_power(throttle),
        }
    }

    #[inline]
    fn actuators(&self) -> &Actuators {
        match self {
            Self::F16(aircraft) => aircraft.actuators(),
        }
    }

    fn data_range(&self) -> DataRange {
        match self {
            Self::F16(aircraft) => aircraft.data_range(),
        }
    }
}
