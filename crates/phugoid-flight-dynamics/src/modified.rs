//! Aircraft that are another aircraft but for some of what that says.

use crate::actuator::Actuators;
use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use crate::atmosphere::Atmosphere;
use crate::fuel::Burnt;
use crate::mass::MassProperties;
use crate::scalar::Scalar;

/// An aircraft that is another one but for what it says otherwise: damaged, with other coefficients, with less fuel.
///
/// What is implemented makes it an [`Aircraft`]; every function that is left out is that of [`unmodified`](Self::unmodified). So
/// nothing that an aircraft has is lost in one that is made of it. Quantities, units, frames and signs are those of [`Aircraft`].
///
/// ```
/// use phugoid_flight_dynamics::aircraft::{Aircraft, Propulsion};
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::modified::Modified;
/// use phugoid_flight_dynamics::scalar::Scalar;
///
/// struct Glider<'a>(&'a F16);
///
/// impl Modified for Glider<'_> {
///     type Unmodified = F16;
///
///     fn unmodified(&self) -> &F16 {
///         self.0
///     }
///
///     fn propulsion<T: Scalar>(&self, _power: T, _altitude: T, _mach: T) -> Propulsion<T> {
///         Propulsion { force: [T::from(0.0); 3], moment: [T::from(0.0); 3] }
///     }
/// }
///
/// fn weight(aircraft: &impl Aircraft) -> f64 {
///     aircraft.mass_properties().mass() * aircraft.gravity()
/// }
/// let jet = F16::new(F16Options::default())?;
/// assert_eq!(weight(&Glider(&jet)), weight(&jet));
/// # Ok::<(), phugoid_flight_dynamics::f16::F16DataError>(())
/// ```
pub trait Modified {
    /// The aircraft that it otherwise is.
    type Unmodified: Aircraft;

    /// The aircraft that it otherwise is.
    fn unmodified(&self) -> &Self::Unmodified;

    /// See [`Aircraft::geometry`].
    #[inline]
    fn geometry(&self) -> &Geometry {
        self.unmodified().geometry()
    }

    /// See [`Aircraft::mass_properties`].
    #[inline]
    fn mass_properties(&self) -> &MassProperties {
        self.unmodified().mass_properties()
    }

    /// See [`Aircraft::gravity`].
    #[inline]
    fn gravity(&self) -> f64 {
        self.unmodified().gravity()
    }

    /// See [`Aircraft::atmosphere`].
    #[inline]
    fn atmosphere(&self) -> Atmosphere {
        self.unmodified().atmosphere()
    }

    /// See [`Aircraft::coefficients`].
    #[inline]
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        self.unmodified().coefficients(air, rates, controls)
    }

    /// See [`Aircraft::alpha_rate_coefficients`].
    #[inline]
    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        self.unmodified().alpha_rate_coefficients(air, rates, controls)
    }

    /// See [`Aircraft::propulsion`].
    #[inline]
    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        self.unmodified().propulsion(power, altitude, mach)
    }

    /// See [`Aircraft::slipstream_coefficients`].
    #[inline]
    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        self.unmodified().slipstream_coefficients(propulsion, air, rates, controls)
    }

    /// See [`Aircraft::fuel_flow`].
    #[inline]
    fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
        self.unmodified().fuel_flow(power, altitude, mach)
    }

    /// See [`Aircraft::after_burning`].
    #[inline]
    fn after_burning(&self, fuel: f64) -> Option<Burnt> {
        self.unmodified().after_burning(fuel)
    }

    /// See [`Aircraft::power_rate`].
    #[inline]
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        self.unmodified().power_rate(throttle, power)
    }

    /// See [`Aircraft::steady_power`].
    #[inline]
    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        self.unmodified().steady_power(throttle)
    }

    /// See [`Aircraft::actuators`].
    #[inline]
    fn actuators(&self) -> &Actuators {
        self.unmodified().actuators()
    }

    /// See [`Aircraft::surface_stops`].
    #[inline]
    fn surface_stops(&self) -> [[f64; 2]; 3] {
        self.unmodified().surface_stops()
    }

    /// See [`Aircraft::data_range`].
    #[inline]
    fn data_range(&self) -> DataRange {
        self.unmodified().data_range()
    }
}

impl<M: Modified> Aircraft for M {
    #[inline]
    fn geometry(&self) -> &Geometry {
        Modified::geometry(self)
    }

    #[inline]
    fn mass_properties(&self) -> &MassProperties {
        Modified::mass_properties(self)
    }

    #[inline]
    fn gravity(&self) -> f64 {
        Modified::gravity(self)
    }

    #[inline]
    fn atmosphere(&self) -> Atmosphere {
        Modified::atmosphere(self)
    }

    #[inline]
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        Modified::coefficients(self, air, rates, controls)
    }

    #[inline]
    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        Modified::alpha_rate_coefficients(self, air, rates, controls)
    }

    #[inline]
    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        Modified::propulsion(self, power, altitude, mach)
    }

    #[inline]
    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        Modified::slipstream_coefficients(self, propulsion, air, rates, controls)
    }

    #[inline]
    fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
        Modified::fuel_flow(self, power, altitude, mach)
    }

    #[inline]
    fn after_burning(&self, fuel: f64) -> Option<Burnt> {
        Modified::after_burning(self, fuel)
    }

    #[inline]
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        Modified::power_rate(self, throttle, power)
    }

    #[inline]
    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        Modified::steady_power(self, throttle)
    }

    #[inline]
    fn actuators(&self) -> &Actuators {
        Modified::actuators(self)
    }

    #[inline]
    fn surface_stops(&self) -> [[f64; 2]; 3] {
        Modified::surface_stops(self)
    }

    #[inline]
    fn data_range(&self) -> DataRange {
        Modified::data_range(self)
    }
}
