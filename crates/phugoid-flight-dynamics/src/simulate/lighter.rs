//! An aircraft that has burnt some of its fuel.

use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, Geometry, Propulsion};
use crate::fuel::Burnt;
use crate::mass::MassProperties;
use crate::modified::Modified;
use crate::scalar::Scalar;

/// An aircraft that has burnt some of its fuel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lighter<'a, A> {
    aircraft: &'a A,
    now: Burnt,
    geometry: Geometry,
}

impl<'a, A: Aircraft> Lighter<'a, A> {
    /// `aircraft` with the body that it has now.
    pub(super) fn new(aircraft: &'a A, now: Burnt) -> Self {
        let whole = *aircraft.geometry();
        Self { aircraft, now, geometry: Geometry { cg: whole.cg + now.shift, ..whole } }
    }
}

impl<A: Aircraft> Modified for Lighter<'_, A> {
    type Unmodified = A;

    fn unmodified(&self) -> &A {
        self.aircraft
    }

    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.now.mass
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        self.aircraft.coefficients(air, rates, controls).about(self.now.shift, &self.geometry)
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let slope = self.aircraft.alpha_rate_coefficients(air, rates, controls)?;
        Some(slope.about(self.now.shift, &self.geometry))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        if self.now.left <= 0.0 {
            return Propulsion { force: [T::from(0.0); 3], moment: [T::from(0.0); 3] };
        }
        self.aircraft.propulsion(power, altitude, mach).about(self.now.shift * self.geometry.mean_chord)
    }

    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let blown = self.aircraft.slipstream_coefficients(propulsion, air, rates, controls)?;
        Some(blown.about(self.now.shift, &self.geometry))
    }
}
