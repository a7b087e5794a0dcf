//! The steady flight that is asked for, and the one that is found.

use std::ops::RangeInclusive;

use serde::Serialize;

use super::error::TrimError;
use crate::aircraft::{Aircraft, Controls, DataRange, State};
use crate::atmosphere::Atmosphere;
use crate::increments::Increments;

/// The steady flight asked for. Still air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimCondition {
    /// True airspeed, m/s; above zero and at most 12,000 m/s.
    pub speed: f64,
    /// Altitude above sea level, m; from -1000 m to 25,000 m in the air of the book, to 84,852 m in the standard atmosphere.
    pub altitude: f64,
    /// Flight path angle, rad, positive climbing. A climb is steady but for the change of the air with altitude.
    pub flight_path_angle: f64,
    /// Rate of the heading, rad/s, positive to the right.
    pub turn_rate: f64,
    /// Heading, rad; it does not influence the trim.
    pub heading: f64,
    /// Aerodynamic increments to the database that are in force.
    pub increments: Increments,
    /// Lowest and highest angle of attack, rad, that the aircraft's data are good for. A trim outside is refused.
    pub alpha_range: [f64; 2],
}

impl TrimCondition {
    /// Straight and level at a true airspeed (m/s) and altitude (m), heading north, at angles of attack from -20 to 50 deg
    /// ([`DataRange::UNSTATED`]). [`steady`](Self::steady) takes the range of an aircraft instead.
    pub fn level(speed: f64, altitude: f64) -> Self {
        Self {
            speed,
            altitude,
            flight_path_angle: 0.0,
            turn_rate: 0.0,
            heading: 0.0,
            increments: Increments::NONE,
            alpha_range: DataRange::UNSTATED.alpha,
        }
    }

    /// Steady flight of an aircraft inside the range of its data: true airspeed in m/s, altitude in m, flight path angle in
    /// rad (positive climbing) and rate of the heading in rad/s (positive to the right). Heading north, no increments.
    pub fn steady<A: Aircraft>(
        aircraft: &A,
        speed: f64,
        altitude: f64,
        flight_path_angle: f64,
        turn_rate: f64,
    ) -> Self {
        let alpha_range = aircraft.data_range().alpha;
        Self { flight_path_angle, turn_rate, alpha_range, ..Self::level(speed, altitude) }
    }
}

/// A steady flight that was found: angles, rates, controls, and what they amount to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trim {
    /// True airspeed in still air, m/s.
    pub speed_m_s: f64,
    /// Altitude above sea level, m.
    pub altitude_m: f64,
    /// Flight path angle, rad, positive climbing.
    pub flight_path_angle_rad: f64,
    /// Rate of the heading, rad/s.
    pub turn_rate_rad_s: f64,
    /// Angle of attack, rad, positive nose up.
    pub alpha_rad: f64,
    /// Sideslip angle, rad, positive with the wind from the right.
    pub beta_rad: f64,
    /// Bank angle, rad, positive with the right wing down.
    pub phi_rad: f64,
    /// Pitch angle, rad, of body x above the horizon.
    pub theta_rad: f64,
    /// Heading from north to east, rad.
    pub psi_rad: f64,
    /// Roll rate about body x, rad/s; not zero in a turn.
    pub p_rad_s: f64,
    /// Pitch rate about body y, rad/s; not zero in a turn.
    pub q_rad_s: f64,
    /// Yaw rate about body z, rad/s; not zero in a turn.
    pub r_rad_s: f64,
    /// Throttle lever, 0 to 1.
    pub throttle: f64,
    /// Elevator, rad, positive trailing edge down.
    pub elevator_rad: f64,
    /// Aileron, rad, positive rolls to the left.
    pub aileron_rad: f64,
    /// Rudder, rad, positive yaws to the left.
    pub rudder_rad: f64,
    /// Engine state that the throttle settles at, percent.
    pub power_percent: f64,
    /// Thrust, N: magnitude of the propulsive force, negative when it points backwards.
    pub thrust_n: f64,
    /// Dynamic pressure of this condition, Pa.
    pub dynamic_pressure_pa: f64,
    /// Mach number of this condition.
    pub mach: f64,
    /// Normal load factor at the centre of gravity, `-az/g`, 1 in level flight at small angle of attack.
    pub load_factor: f64,
    /// Trim index of the thesis (2.31), `J = V'^2 + alpha'^2 + beta'^2 + p'^2 + q'^2 + r'^2`, here with V' in m/s^2, the
    /// others in rad/s and rad/s^2. The thesis has V' in ft/s^2, which makes that term 10.76 times as large.
    pub trim_index: f64,
    /// Largest of the eight residuals: accelerations over gravity, the others in rad/s, rad/s^2, and sine of an angle.
    pub largest_residual: f64,
    /// Iterations of the solver from the start that succeeded.
    pub iterations: usize,
}

impl Trim {
    /// The state of the aircraft, above the origin.
    pub fn state(&self) -> State {
        State {
            speed: self.speed_m_s,
            alpha: self.alpha_rad,
            beta: self.beta_rad,
            phi: self.phi_rad,
            theta: self.theta_rad,
            psi: self.psi_rad,
            p: self.p_rad_s,
            q: self.q_rad_s,
            r: self.r_rad_s,
            north: 0.0,
            east: 0.0,
            altitude: self.altitude_m,
            power: self.power_percent,
        }
    }

    /// Throttle lever and surface positions.
    pub fn controls(&self) -> Controls {
        Controls {
            throttle: self.throttle,
            elevator: self.elevator_rad,
            aileron: self.aileron_rad,
            rudder: self.rudder_rad,
        }
    }
}

/// Altitudes, m, in which a model of the air means something, and the words for it.
fn altitudes(atmosphere: Atmosphere) -> (RangeInclusive<f64>, &'static str) {
    match atmosphere {
        // Not far above, the air of Stevens & Lewis ends.
        Atmosphere::Book => (-1_000.0..=25_000.0, "between -1000 and 25000 m, where the air of Stevens & Lewis holds"),
        Atmosphere::Standard => (
            -1_000.0..=Atmosphere::Standard.ceiling(),
            "between -1000 and 84852 m (geopotential), where the standard atmosphere of 1976 ends at 86 km",
        ),
    }
}

/// Highest speed, m/s: a little more than the 11,200 m/s with which a body leaves the earth. Far beyond it the squares of the
/// speed are no numbers any more.
const FASTEST: f64 = 12_000.0;

pub(super) fn check(c: &TrimCondition, atmosphere: Atmosphere) -> Result<(), TrimError> {
    let (altitudes, which) = altitudes(atmosphere);
    let [low, high] = c.alpha_range;
    for (field, value, valid, expected) in [
        ("speed", c.speed, c.speed > 0.0, "a positive number, m/s"),
        ("speed", c.speed, c.speed <= FASTEST, "above 0 and at most 12000 m/s: check its number and its unit"),
        ("altitude", c.altitude, altitudes.contains(&c.altitude), which),
        ("flight_path_angle", c.flight_path_angle, c.flight_path_angle.abs() < 1.5, "between -1.5 and 1.5 rad"),
        ("turn_rate", c.turn_rate, true, "a number, rad/s"),
        ("heading", c.heading, true, "a number, rad"),
        ("alpha_range", low, low < high, "the lower angle of attack first, rad"),
        ("alpha_range", high, true, "a number, rad"),
    ] {
        if !valid || !value.is_finite() {
            return Err(TrimError::Condition { field, value, expected });
        }
    }
    Ok(())
}
