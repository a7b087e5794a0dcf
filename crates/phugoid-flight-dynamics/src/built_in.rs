//! The aircraft that come with the crate, by name: the one place that decides which aircraft a word means.
//!
//! Trim, linearisation and simulation take anything that implements [`Aircraft`](crate::aircraft::Aircraft). A program that
//! lets its user name an aircraft asks here.

use serde::{Deserialize, Serialize};

use crate::f16::{F16, F16DataError, F16Options, F16Tables};

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
/// It is an [`Aircraft`](crate::aircraft::Aircraft) itself. Where speed matters, match once and hand the aircraft inside to a generic function. An
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

/// Makes an enum whose variants each hold an aircraft an [`Aircraft`](crate::aircraft::Aircraft) itself: that of the variant, which
/// the patterns name.
///
/// ```
/// use phugoid_flight_dynamics::aircraft::Aircraft;
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
///
/// enum Hangar {
///     Own(F16),
///     Lent(Box<F16>),
/// }
/// phugoid_flight_dynamics::aircraft_by_variant!(Hangar, aircraft: Self::Own(aircraft), Self::Lent(aircraft));
///
/// let jet = Hangar::Lent(Box::new(F16::new(F16Options::default())?));
/// assert!(jet.mass_properties().mass() > 9_000.0); // kg
/// # Ok::<(), phugoid_flight_dynamics::f16::F16DataError>(())
/// ```
#[macro_export]
macro_rules! aircraft_by_variant {
    ($any:ty, $aircraft:ident: $($variant:pat),+ $(,)?) => {
        impl $crate::aircraft::Aircraft for $any {
            #[inline]
            fn geometry(&self) -> &$crate::aircraft::Geometry {
                match self { $($variant => $aircraft.geometry()),+ }
            }

            #[inline]
            fn mass_properties(&self) -> &$crate::mass::MassProperties {
                match self { $($variant => $aircraft.mass_properties()),+ }
            }

            #[inline]
            fn gravity(&self) -> f64 {
                match self { $($variant => $aircraft.gravity()),+ }
            }

            #[inline]
            fn atmosphere(&self) -> $crate::atmosphere::Atmosphere {
                match self { $($variant => $aircraft.atmosphere()),+ }
            }

            #[inline]
            fn coefficients<T: $crate::scalar::Scalar>(
                &self,
                air: &$crate::aircraft::AirData<T>,
                rates: [T; 3],
                controls: &$crate::aircraft::Controls<T>,
            ) -> $crate::aircraft::Coefficients<T> {
                match self { $($variant => $aircraft.coefficients(air, rates, controls)),+ }
            }

            #[inline]
            fn alpha_rate_coefficients<T: $crate::scalar::Scalar>(
                &self,
                air: &$crate::aircraft::AirData<T>,
                rates: [T; 3],
                controls: &$crate::aircraft::Controls<T>,
            ) -> Option<$crate::aircraft::Coefficients<T>> {
                match self { $($variant => $aircraft.alpha_rate_coefficients(air, rates, controls)),+ }
            }

            #[inline]
            fn propulsion<T: $crate::scalar::Scalar>(
                &self,
                power: T,
                altitude: T,
                mach: T,
            ) -> $crate::aircraft::Propulsion<T> {
                match self { $($variant => $aircraft.propulsion(power, altitude, mach)),+ }
            }

            #[inline]
            fn slipstream_coefficients<T: $crate::scalar::Scalar>(
                &self,
                propulsion: &$crate::aircraft::Propulsion<T>,
                air: &$crate::aircraft::AirData<T>,
                rates: [T; 3],
                controls: &$crate::aircraft::Controls<T>,
            ) -> Option<$crate::aircraft::Coefficients<T>> {
                match self { $($variant => $aircraft.slipstream_coefficients(propulsion, air, rates, controls)),+ }
            }

            #[inline]
            fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
                match self { $($variant => $aircraft.fuel_flow(power, altitude, mach)),+ }
            }

            #[inline]
            fn after_burning(&self, fuel: f64) -> Option<$crate::fuel::Burnt> {
                match self { $($variant => $aircraft.after_burning(fuel)),+ }
            }

            #[inline]
            fn power_rate<T: $crate::scalar::Scalar>(&self, throttle: T, power: T) -> T {
                match self { $($variant => $aircraft.power_rate(throttle, power)),+ }
            }

            #[inline]
            fn steady_power<T: $crate::scalar::Scalar>(&self, throttle: T) -> T {
                match self { $($variant => $aircraft.steady_power(throttle)),+ }
            }

            #[inline]
            fn actuators(&self) -> &$crate::actuator::Actuators {
                match self { $($variant => $aircraft.actuators()),+ }
            }

            #[inline]
            fn surface_stops(&self) -> [[f64; 2]; 3] {
                match self { $($variant => $aircraft.surface_stops()),+ }
            }

            #[inline]
            fn data_range(&self) -> $crate::aircraft::DataRange {
                match self { $($variant => $aircraft.data_range()),+ }
            }
        }
    };
}

aircraft_by_variant!(BuiltInAircraft, aircraft: Self::F16(aircraft));
