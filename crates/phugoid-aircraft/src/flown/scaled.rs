//! An aircraft whose coefficients change more, or less, with the flight than its file says.

use std::sync::Arc;

use phugoid_flight_dynamics::aircraft::{AirData, Aircraft as _, Coefficients, Controls};
use phugoid_flight_dynamics::modified::Modified;
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

impl Modified for Scaled {
    type Unmodified = AircraftFile;

    fn unmodified(&self) -> &AircraftFile {
        &self.aircraft
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
}
