//! The F-16 of Stevens, Lewis and Johnson: data from `data/f16/stevens_lewis`, equations of their appendix A.

mod aerodynamics;
mod engine;
#[cfg(feature = "std")]
mod load;

pub use aerodynamics::{ALPHA_POINTS, AerodynamicTables, AlphaAxis, Lateral, Longitudinal, SideslipAxis};
pub use engine::{Engine, ThrustTables};
#[cfg(feature = "std")]
pub use load::F16DataError;

use crate::actuator::Actuators;
use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use crate::atmosphere::Atmosphere;
use crate::mass::MassProperties;
use crate::scalar::Scalar;

/// Angles of attack that the tables cover, `[lowest, highest]`, deg (Stevens & Lewis, appendix A).
pub const ALPHA_RANGE_DEG: [f64; 2] = [-10.0, 45.0];

/// Which digitisation of the aerodynamic tables the aircraft uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "std", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum F16Tables {
    /// As printed in the book's third edition (2015), appendix A: they reproduce its published check case.
    #[default]
    Book,
    /// As used by Morelli and in NASA's DAVE-ML model (AIAA S-119). They differ in the rolling moment due to sideslip
    /// and a few single entries; `contested_entries.csv` lists and judges every one.
    Morelli,
}

/// Which mass and inertia constants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "std", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum F16Constants {
    /// Mass from weight over gravity and the full inertia tensor.
    #[default]
    Exact,
    /// The rounded constants that the book's printed examples were computed with: `1/mass = 1.57e-3` 1/slug and
    /// `c1..c9` of the 1992 edition.
    BookRounded,
}

/// Which F-16: tables, constants and centre of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "std", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct F16Options {
    /// Which digitisation of the aerodynamic tables; [`F16Tables::Book`] by default.
    pub tables: F16Tables,
    /// Exact or rounded mass and inertia; [`F16Constants::Exact`] by default.
    pub constants: F16Constants,
    /// Centre of gravity, fraction of the mean aerodynamic chord behind its leading edge; the data refer to 0.35.
    pub cg: f64,
}

impl Default for F16Options {
    fn default() -> Self {
        Self { tables: F16Tables::Book, constants: F16Constants::Exact, cg: 0.35 }
    }
}

/// The F-16. The fields are plain data in SI and radians: [`F16::new`] reads them from the embedded files; a program
/// without files may fill them otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct F16 {
    /// Reference geometry and centre of gravity.
    pub geometry: Geometry,
    /// Mass, inertia tensor and the momentum of the engine's rotor.
    pub mass_properties: MassProperties,
    /// Acceleration of gravity, m/s^2 (the book's 32.17 ft/s^2).
    pub gravity: f64,
    /// The atmosphere that it flies in.
    pub atmosphere: Atmosphere,
    /// Tables of the aerodynamic coefficients, moments about the reference point.
    pub aerodynamics: AerodynamicTables,
    /// Thrust tables and engine dynamics.
    pub engine: Engine,
    /// Lag, rate and deflection limits of elevator, aileron and rudder.
    pub actuators: Actuators,
}

impl F16 {
    /// Body-axis force coefficients and pitching-moment coefficient `(CX, CZ, Cm)` about the centre of gravity in
    /// symmetric flight, from angle of attack (rad), dimensionless pitch rate `q cbar / 2V` and elevator (rad).
    ///
    /// The same numbers as [`Aircraft::coefficients`] without sideslip (appendix A.3), at a fraction of the cost.
    #[inline]
    pub fn longitudinal_coefficients<T: Scalar>(&self, alpha: T, q_hat: T, elevator: T) -> (T, T, T) {
        let Longitudinal { cx, cz, cm } = self.aerodynamics.longitudinal(alpha, q_hat, elevator);
        (cx, cz, cm + cz * (self.geometry.cg_reference - self.geometry.cg))
    }

    /// All coefficients, body axes, moments about the centre of gravity, from angle of attack and sideslip (rad), the
    /// dimensionless rates `[p b/2V, q cbar/2V, r b/2V]` and the surface positions (appendix A.3, A.4).
    #[inline]
    pub fn coefficients_at<T: Scalar>(
        &self,
        alpha: T,
        beta: T,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Coefficients<T> {
        let Geometry { span, mean_chord, cg, cg_reference, .. } = self.geometry;
        let (longitudinal, lateral) = self.aerodynamics.all(alpha, beta, rates, controls);
        let Longitudinal { cx, cz, cm } = longitudinal;
        let Lateral { cy, cl, cn } = lateral;
        // From the reference point to the centre of gravity.
        let arm = cg_reference - cg;
        Coefficients { cx, cy, cz, cl, cm: cm + cz * arm, cn: cn - cy * (arm * mean_chord / span) }
    }

    /// Thrust along body x, N, from the engine power level (percent), altitude (m) and Mach number (appendix A.5).
    #[inline]
    pub fn thrust<T: Scalar>(&self, power: T, altitude: T, mach: T) -> T {
        self.engine.thrust.at(power, altitude, mach)
    }
}

impl Aircraft for F16 {
    #[inline]
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    #[inline]
    fn mass_properties(&self) -> &MassProperties {
        &self.mass_properties
    }

    #[inline]
    fn gravity(&self) -> f64 {
        self.gravity
    }

    #[inline]
    fn atmosphere(&self) -> Atmosphere {
        self.atmosphere
    }

    #[inline]
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let Geometry { span, mean_chord, .. } = self.geometry;
        let time_scale = (air.speed * 2.0).recip();
        let span_time = time_scale * span;
        let [p_hat, q_hat, r_hat] = [rates[0] * span_time, rates[1] * (time_scale * mean_chord), rates[2] * span_time];
        self.coefficients_at(air.alpha, air.beta, [p_hat, q_hat, r_hat], controls)
    }

    #[inline]
    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let zero = T::from(0.0);
        Propulsion { force: [self.thrust(power, altitude, mach), zero, zero], moment: [zero; 3] }
    }

    #[inline]
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        engine::power_rate(engine::commanded_power(throttle), power)
    }

    #[inline]
    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        engine::commanded_power(throttle)
    }

    #[inline]
    fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    fn data_range(&self) -> DataRange {
        let within = |limit: f64| [(-limit).to_radians(), limit.to_radians()];
        DataRange {
            alpha: ALPHA_RANGE_DEG.map(f64::to_radians),
            beta: within(30.0),
            elevator: within(25.0),
            aileron: within(21.5),
            rudder: within(30.0),
            ..DataRange::UNSTATED
        }
    }
}
