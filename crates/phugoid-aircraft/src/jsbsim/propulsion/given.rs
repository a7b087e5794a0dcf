//! A propeller of numbers in SI units that an engine of a given power turns.

use super::balance::{Engine, Guess};
use super::propeller::{Inflow, Propeller};
use crate::jsbsim::table::Table;
use crate::jsbsim::units::{FOOT, POUND_FORCE, SLUG};

/// A propeller of numbers: the one of JSBSim, in SI units.
#[derive(Debug, Clone)]
pub(crate) struct GivenPropeller {
    propeller: Propeller,
    most_rpm: f64,
}

/// Coefficients over the advance ratio and the pitch, row by row.
pub(crate) struct GivenTables<'a> {
    /// Advance ratios, increasing.
    pub(crate) advance: &'a [f64],
    /// Pitch, degrees, increasing; empty for blades that cannot be turned.
    pub(crate) pitch_deg: &'a [f64],
    /// Thrust over `rho n^2 D^4`.
    pub(crate) thrust: &'a [f64],
    /// Power over `rho n^3 D^5`.
    pub(crate) power: &'a [f64],
}

impl GivenPropeller {
    /// Keys have to increase, and there has to be a value for each pair of them.
    pub(crate) fn new(diameter_m: f64, most_turns_s: f64, tables: &GivenTables<'_>) -> Self {
        let table = |values: &[f64]| Table::of_numbers(tables.advance.into(), tables.pitch_deg.into(), values.into());
        let pitch = match tables.pitch_deg {
            [fine, .., coarse] => [*fine, *coarse],
            _ => [0.0; 2],
        };
        let most_rpm = 60.0 * most_turns_s;
        let coefficients = [table(tables.thrust), table(tables.power)];
        Self { propeller: Propeller::of_numbers(diameter_m / FOOT, pitch, most_rpm, coefficients), most_rpm }
    }

    /// Thrust (N), torque (N m) and turns per second where the engine gives `power_w`, in air of a density (kg/m^3) that comes
    /// along the axis at a speed (m/s). Not a number where one of them is not.
    pub(crate) fn work(&self, power_w: f64, speed_m_s: f64, density: f64) -> [f64; 3] {
        if !(power_w.is_finite() && speed_m_s.is_finite() && density.is_finite()) {
            return [f64::NAN; 3];
        }
        let inflow =
            Inflow { along_ft_s: speed_m_s / FOOT, density: density / SLUG * FOOT.powi(3), sound_ft_s: f64::INFINITY };
        let engine = Engine::of_power(power_w.max(0.0) / (POUND_FORCE * FOOT), self.most_rpm);
        let work = self.propeller.balance(&inflow, &engine, 1.0, &mut Guess::default());
        [work.thrust_lb * POUND_FORCE, work.torque_ft_lb * POUND_FORCE * FOOT, work.rpm / 60.0]
    }
}
