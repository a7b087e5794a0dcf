//! The known part of the aerodynamic coefficients.

use std::sync::Arc;

use phugoid_aircraft::flown::AircraftFile;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls};
use phugoid_flight_dynamics::f16::F16;
use phugoid_flight_dynamics::scalar::Scalar;

/// The known part of the aerodynamic coefficients, to which the terms of the model file are added.
#[derive(Clone, Debug)]
pub enum Database {
    /// None: the terms are the whole build-up.
    None,
    /// The F-16 of Stevens & Lewis, with its centre of gravity.
    F16(Box<F16>),
    /// An aircraft of a file, about its centre of gravity.
    Aircraft(Arc<AircraftFile>),
}

/// Density at sea level (kg/m3) and gas constant (J/(kg K)) and ratio of specific heats of air, in the standard atmosphere.
const SEA_DENSITY: f64 = 1.225;
const GAS: f64 = 8314.32 / 28.9644;
const RATIO_OF_HEATS: f64 = 1.4;

/// Speed of sound, m/s, where the standard atmosphere has a density, kg/m3, up to 20 km; NaN without density.
fn speed_of_sound(density: f64) -> f64 {
    // Density goes with this power of the temperature up to 11 km, where its ratio to that at the sea is the second number.
    const POWER: f64 = 9.80665 / (GAS * 0.0065) - 1.0;
    const AT_TROPOPAUSE: f64 = 0.297_076;
    let ratio = density / SEA_DENSITY;
    let temperature = if ratio < AT_TROPOPAUSE { 216.65 } else { 288.15 * ratio.powf(1.0 / POWER) };
    if ratio > 0.0 { (RATIO_OF_HEATS * GAS * temperature).sqrt() } else { f64::NAN }
}

/// A flight condition in which an aircraft of a file is asked for its coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InAir<T> {
    /// True airspeed, m/s.
    pub(crate) speed: T,
    /// Angle of attack and sideslip, rad.
    pub(crate) flow: [T; 2],
    /// Density of the air, kg/m3.
    pub(crate) density: T,
    /// Mach number; none: that of the standard atmosphere where it has this density.
    pub(crate) mach: Option<T>,
    /// Body rates `[p, q, r]`, rad/s.
    pub(crate) rates: [T; 3],
    /// Elevator, aileron and rudder, rad.
    pub(crate) deflections: [T; 3],
}

impl<T: Scalar> InAir<T> {
    fn air(&self) -> AirData<T> {
        let &Self { speed, flow: [alpha, beta], density, mach, .. } = self;
        let mach = mach.unwrap_or_else(|| speed * speed_of_sound(density.real()).recip());
        AirData { speed, alpha, beta, density, dynamic_pressure: density * speed * speed * 0.5, mach }
    }

    fn controls(&self) -> Controls<T> {
        let [elevator, aileron, rudder] = self.deflections;
        Controls { throttle: T::from(0.0), elevator, aileron, rudder }
    }

    /// Coefficients in body axes without the rate of the angle of attack. The throttle, which the aerodynamics of hardly any
    /// file read, is closed.
    pub(crate) fn coefficients<A: Aircraft>(&self, aircraft: &A) -> Coefficients<T> {
        aircraft.coefficients(&self.air(), self.rates, &self.controls())
    }

    /// Change of the coefficients with the rate of the angle of attack, per rad/s.
    pub(crate) fn by_alpha_rate(&self, aircraft: &AircraftFile) -> Option<Coefficients<T>> {
        aircraft.alpha_rate_coefficients(&self.air(), self.rates, &self.controls())
    }
}

/// Lift, drag and pitching moment of body-axis coefficients, without sideslip.
pub(crate) fn lift_drag_moment<T: Scalar>([cx, cz, cm]: [T; 3], alpha: T) -> [T; 3] {
    let (sin, cos) = alpha.sin_cos();
    [cx * sin - cz * cos, -(cx * cos + cz * sin), cm]
}

impl Database {
    /// `(CL, CD, Cm)` from true airspeed (m/s) and density (kg/m3), the angle of attack (rad), `q cbar/2V` with the actual
    /// speed, and the elevator (rad).
    #[inline(always)]
    pub(crate) fn coefficients<T: Scalar>(&self, speed: T, density: f64, alpha: T, q_hat: T, elevator: T) -> [T; 3] {
        match self {
            Self::None => [T::from(0.0); 3],
            Self::F16(aircraft) => {
                let (cx, cz, cm) = aircraft.longitudinal_coefficients(alpha, q_hat, elevator);
                // Body axes to wind axes, without sideslip.
                lift_drag_moment([cx, cz, cm], alpha)
            }
            Self::Aircraft(aircraft) => {
                let q = q_hat * speed * (2.0 / aircraft.geometry().mean_chord);
                Self::in_plane(aircraft, speed, density, alpha, q, elevator)
            }
        }
    }

    /// `(CL, CD, Cm)` of an aircraft of a file in symmetric flight, with the pitch rate in rad/s.
    pub(crate) fn in_plane<T: Scalar>(
        aircraft: &AircraftFile,
        speed: T,
        density: f64,
        alpha: T,
        q: T,
        elevator: T,
    ) -> [T; 3] {
        let zero = T::from(0.0);
        let flight = InAir {
            speed,
            flow: [alpha, zero],
            density: T::from(density),
            mach: None,
            rates: [zero, q, zero],
            deflections: [elevator, zero, zero],
        };
        let Coefficients { cx, cz, cm, .. } = flight.coefficients(aircraft);
        lift_drag_moment([cx, cz, cm], alpha)
    }

    /// `CL, CD, Cm, CY, Cl, Cn` in a flight condition, in the order of `Coefficient`; lift and drag along the stability axes,
    /// as the terms have them. Zero without a database.
    pub(crate) fn all(&self, flight: &InAir<f64>) -> [f64; 6] {
        let Coefficients { cx, cy, cz, cl, cm, cn } = match self {
            Self::None => return [0.0; 6],
            Self::F16(aircraft) => flight.coefficients(aircraft.as_ref()),
            Self::Aircraft(aircraft) => flight.coefficients(aircraft.as_ref()),
        };
        let [lift, drag, pitch] = lift_drag_moment([cx, cz, cm], flight.flow[0]);
        [lift, drag, pitch, cy, cl, cn]
    }

    /// Change of `(CL, CD, Cm)` with `alpha' cbar/2V` at a point of symmetric flight; none where nothing follows that rate.
    pub(crate) fn by_alpha_rate(&self, speed: f64, density: f64, alpha: f64, elevator: f64) -> Option<[f64; 3]> {
        let Self::Aircraft(aircraft) = self else { return None };
        let flight = InAir {
            speed,
            flow: [alpha, 0.0],
            density,
            mach: None,
            rates: [0.0; 3],
            deflections: [elevator, 0.0, 0.0],
        };
        let Coefficients { cx, cz, cm, .. } = flight.by_alpha_rate(aircraft)?;
        let per_second = 2.0 * speed / aircraft.geometry().mean_chord;
        let slopes = lift_drag_moment([cx, cz, cm], alpha).map(|slope| slope * per_second);
        slopes.iter().any(|slope| *slope != 0.0).then_some(slopes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_dynamics::atmosphere::Atmosphere;

    #[test]
    fn the_speed_of_sound_of_a_density_is_that_of_the_standard_atmosphere() {
        for altitude in [0.0, 3000.0, 10_900.0, 11_100.0, 15_000.0] {
            let air = Atmosphere::Standard.at(altitude);
            let found = speed_of_sound(air.density);
            assert!((found / air.speed_of_sound - 1.0).abs() < 1e-5, "{altitude}: {found} {}", air.speed_of_sound);
        }
        assert!(speed_of_sound(0.0).is_nan() && speed_of_sound(f64::NAN).is_nan());
    }
}
