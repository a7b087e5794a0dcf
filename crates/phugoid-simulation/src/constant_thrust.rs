//! An aircraft whose thrust does not change.

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::fuel::Burnt;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

/// Any aircraft with its propulsion frozen: what the thesis assumes, and what separates the aerodynamics from the engine.
#[derive(Clone, Copy, Debug)]
pub struct ConstantThrust<'a, A> {
    aircraft: &'a A,
    propulsion: Propulsion,
    fuel_flow: f64,
}

impl<'a, A: Aircraft> ConstantThrust<'a, A> {
    /// `aircraft` with the propulsion that it has at this engine state (percent), altitude (m) and Mach number.
    pub fn at(aircraft: &'a A, power: f64, altitude: f64, mach: f64) -> Self {
        let fuel_flow = aircraft.fuel_flow(power, altitude, mach);
        Self { aircraft, propulsion: aircraft.propulsion(power, altitude, mach), fuel_flow }
    }
}

impl<A: Aircraft> Aircraft for ConstantThrust<'_, A> {
    fn geometry(&self) -> &Geometry {
        self.aircraft.geometry()
    }

    fn mass_properties(&self) -> &MassProperties {
        self.aircraft.mass_properties()
    }

    fn gravity(&self) -> f64 {
        self.aircraft.gravity()
    }

    fn atmosphere(&self) -> Atmosphere {
        self.aircraft.atmosphere()
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        self.aircraft.coefficients(air, rates, controls)
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        self.aircraft.alpha_rate_coefficients(air, rates, controls)
    }

    fn propulsion<T: Scalar>(&self, _power: T, _altitude: T, _mach: T) -> Propulsion<T> {
        Propulsion { force: self.propulsion.force.map(T::from), moment: self.propulsion.moment.map(T::from) }
    }

    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        self.aircraft.slipstream_coefficients(propulsion, air, rates, controls)
    }

    fn fuel_flow(&self, _power: f64, _altitude: f64, _mach: f64) -> f64 {
        // The engine is as it was, whatever state, altitude and Mach number say.
        self.fuel_flow
    }

    fn after_burning(&self, fuel: f64) -> Option<Burnt> {
        self.aircraft.after_burning(fuel)
    }

    fn power_rate<T: Scalar>(&self, _throttle: T, _power: T) -> T {
        T::from(0.0)
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        self.aircraft.steady_power(throttle)
    }

    fn actuators(&self) -> &Actuators {
        self.aircraft.actuators()
    }

    fn data_range(&self) -> DataRange {
        self.aircraft.data_range()
    }
}
