//! An aircraft whose coefficients change more, or less, with the flight than its file says.

use std::sync::Arc;

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::fuel::Burnt;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use super::AircraftFile;

/// An aircraft of a file, with each of its coefficients `C` as
///
/// ```text
/// C + part (C - C_reference)      CL, CD, Cm, CY, Cl, Cn; lift and drag along the stability axes
/// ```
///
/// so that at the reference nothing changes, and every derivative is larger by the part. Thrust, mass and sizes are those of the file.
#[derive(Clone, Debug)]
pub struct Scaled {
    aircraft: Arc<AircraftFile>,
    parts: [f64; 6],
    reference: [f64; 6],
}

impl Scaled {
    pub(super) fn new(aircraft: Arc<AircraftFile>, parts: [f64; 6], reference: [f64; 6]) -> Self {
        Self { aircraft, parts, reference }
    }

    /// The aircraft as its file says.
    pub fn aircraft(&self) -> &AircraftFile {
        &self.aircraft
    }

    /// Coefficients in body axes with what is added to their differences from `reference`.
    fn scaled<T: Scalar>(&self, written: Coefficients<T>, alpha: T, reference: [f64; 6]) -> Coefficients<T> {
        let Coefficients { cx, cy, cz, cl, cm, cn } = written;
        let (sin, cos) = alpha.sin_cos();
        let all = [cx * sin - cz * cos, -(cx * cos + cz * sin), cm, cy, cl, cn];
        let added = |place: usize| (all[place] - reference[place]) * self.parts[place];
        let (lift, drag) = (added(0), added(1));
        Coefficients {
            cx: cx + lift * sin - drag * cos,
            cy: cy + added(3),
            cz: cz - lift * cos - drag * sin,
            cl: cl + added(4),
            cm: cm + added(2),
            cn: cn + added(5),
        }
    }
}

impl Aircraft for Scaled {
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
        self.scaled(self.aircraft.coefficients(air, rates, controls), air.alpha, self.reference)
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        // A derivative, which is zero at the reference.
        let written = self.aircraft.alpha_rate_coefficients(air, rates, controls)?;
        Some(self.scaled(written, air.alpha, [0.0; 6]))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        self.aircraft.propulsion(power, altitude, mach)
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

    fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
        self.aircraft.fuel_flow(power, altitude, mach)
    }

    fn after_burning(&self, fuel: f64) -> Option<Burnt> {
        self.aircraft.after_burning(fuel)
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        self.aircraft.power_rate(throttle, power)
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        self.aircraft.steady_power(throttle)
    }

    fn actuators(&self) -> &Actuators {
        self.aircraft.actuators()
    }

    fn surface_stops(&self) -> [[f64; 2]; 3] {
        self.aircraft.surface_stops()
    }

    fn data_range(&self) -> DataRange {
        self.aircraft.data_range()
    }
}
