//! The aerodynamic coefficients of an aircraft of JSBSim at plain numbers.

use phugoid_flight_dynamics::aircraft::Geometry;

use super::{GAS, RATIO_OF_HEATS};
use crate::flown::pool::Pool;
use crate::flown::surface::Surface;
use crate::jsbsim::{
    AerodynamicWorkspace, Aircraft, CompiledAerodynamics, Evaluator, FlightCondition, ForceMoment,
    altitude_of_density_m,
};

/// Speed (m/s), angle of attack and sideslip (rad), density (kg/m3), Mach number, p, q, r (rad/s), elevator, aileron, rudder
/// (rad, in the signs of the equations of motion).
pub(super) const VARIABLES: usize = 11;
/// Rate of the angle of attack, rad/s, whose coefficients less those without it give the slope: they are linear in it.
const ALPHA_RATE: f64 = 0.1;

/// Coefficients of force along body x, y, z and of moment about them.
#[derive(Clone, Debug)]
pub(super) struct Aerodynamics {
    compiled: CompiledAerodynamics,
    pool: Pool<Room>,
}

/// What a thread computes in, and what it computed last.
#[derive(Debug)]
struct Room {
    workspace: AerodynamicWorkspace,
    at: [f64; VARIABLES],
    coefficients: [f64; 6],
}

impl Aerodynamics {
    /// Those at what an evaluator of the aircraft holds, with the surfaces where they are put.
    pub(super) fn new(aircraft: &Aircraft, evaluator: &Evaluator<'_>, surfaces: &[Surface; 3]) -> Self {
        let followers = [0, 1, 2].map(|k: usize| surfaces[k].followers());
        Self { compiled: aircraft.compile_aerodynamics(evaluator, followers), pool: Pool::default() }
    }

    fn lend<R>(&self, with: impl FnOnce(&mut Room) -> R) -> R {
        let make =
            || Room { workspace: self.compiled.workspace(), at: [f64::NAN; VARIABLES], coefficients: [f64::NAN; 6] };
        self.pool.lend(make, with)
    }

    /// The coefficients without a rate of the angle of attack.
    pub(super) fn at(&self, aircraft: &Aircraft, geometry: &Geometry, x: &[f64; VARIABLES]) -> [f64; 6] {
        self.lend(|room| self.run(aircraft, geometry, room, x))
    }

    fn run(&self, aircraft: &Aircraft, geometry: &Geometry, room: &mut Room, x: &[f64; VARIABLES]) -> [f64; 6] {
        let &[speed, alpha, beta, density, mach, p, q, r, elevator, aileron, rudder] = x;
        let sound = speed / mach;
        let temperature = sound * sound / (RATIO_OF_HEATS * GAS);
        let height = if self.compiled.reads_height() { altitude_of_density_m(density) } else { 0.0 };
        let flight = FlightCondition {
            airspeed_m_s: speed,
            alpha_rad: alpha,
            beta_rad: beta,
            alphadot_rad_s: 0.0,
            betadot_rad_s: 0.0,
            rates_rad_s: [p, q, r],
            attitude_rad: [0.0, alpha, 0.0],
            height_m: height,
            height_above_ground_m: height,
            density_kg_m3: density,
            pressure_pa: density * GAS * temperature,
            temperature_k: temperature,
            sound_speed_m_s: sound,
        };
        let sum = self.compiled.run(aircraft, &mut room.workspace, &flight, [elevator, aileron, rudder]);
        (room.at, room.coefficients) = (*x, coefficients(geometry, &sum, x));
        room.coefficients
    }

    /// The change of the coefficients with the rate of the angle of attack, per rad/s.
    pub(super) fn by_alpha_rate(&self, aircraft: &Aircraft, geometry: &Geometry, x: &[f64; VARIABLES]) -> [f64; 6] {
        self.lend(|room| {
            // As a rule it was in this flight last, for the coefficients without the rate.
            let without = if room.at == *x { room.coefficients } else { self.run(aircraft, geometry, room, x) };
            // Now it is in another.
            room.at = [f64::NAN; VARIABLES];
            let sum = self.compiled.with_alpha_rate(aircraft, &mut room.workspace, ALPHA_RATE);
            let with = coefficients(geometry, &sum, x);
            std::array::from_fn(|i| (with[i] - without[i]) / ALPHA_RATE)
        })
    }
}

fn coefficients(geometry: &Geometry, sum: &ForceMoment, x: &[f64; VARIABLES]) -> [f64; 6] {
    let force = 0.5 * x[3] * x[0] * x[0] * geometry.wing_area;
    let [l, m, n] = sum.moment_n_m;
    let [cx, cy, cz] = sum.force_n.map(|newton| newton / force);
    let (span, chord) = (force * geometry.span, force * geometry.mean_chord);
    [cx, cy, cz, l / span, m / chord, n / span]
}
