//! An aircraft whose thrust does not change.

use phugoid_flight_dynamics::aircraft::{Aircraft, Propulsion};
use phugoid_flight_dynamics::modified::Modified;
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

impl<A: Aircraft> Modified for ConstantThrust<'_, A> {
    type Unmodified = A;

    fn unmodified(&self) -> &A {
        self.aircraft
    }

    fn propulsion<T: Scalar>(&self, _power: T, _altitude: T, _mach: T) -> Propulsion<T> {
        Propulsion { force: self.propulsion.force.map(T::from), moment: self.propulsion.moment.map(T::from) }
    }

    fn fuel_flow(&self, _power: f64, _altitude: f64, _mach: f64) -> f64 {
        // The engine is as it was, whatever state, altitude and Mach number say.
        self.fuel_flow
    }

    fn power_rate<T: Scalar>(&self, _throttle: T, _power: T) -> T {
        T::from(0.0)
    }
}
