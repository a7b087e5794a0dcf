//! Steady flight: the angles, rates and controls that keep an aircraft straight and level, climbing, or turning.
//!
//! Eight equations, in this order,
//!
//! ```text
//! V' = 0, alpha' = 0, beta' = 0, p' = 0, q' = 0, r' = 0, h' = V sin(gamma), ay = 0
//! ```
//!
//! in the eight unknowns alpha, beta, phi, theta, throttle, elevator, aileron, rudder. The last equation says that no side
//! force is felt: in steady flight it is the turn coordination constraint of Stevens, Lewis & Johnson (3.6-7), and
//! without a turn it makes the wings level. The climb equation is their rate-of-climb constraint (3.6-1). The body rates
//! follow from the turn rate (their 3.6-6):
//!
//! ```text
//! p = -psi' sin(theta), q = psi' sin(phi) cos(theta), r = psi' cos(phi) cos(theta)
//! ```
//!
//! The equations are solved as a root-finding problem by Levenberg-Marquardt with exact derivatives, not by minimising a
//! cost, from several angles of attack in turn. Beyond the ends of the throttle the solver goes on with an extra force
//! along the thrust, and beyond the surfaces' limits with the aircraft's own data, so that it can say how much would have
//! been needed.

mod approach;
mod error;
mod problem;

use std::ops::RangeInclusive;

use serde::Serialize;

use crate::aircraft::{Aircraft, Controls, DataRange, State};
use crate::increments::Increments;

use self::problem::{Problem, Solution, TOLERANCE, UNKNOWNS};
pub use approach::{TrimStart, TrimStep, approach};
pub use error::TrimError;

/// The steady flight asked for. Still air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimCondition {
    /// True airspeed, m/s.
    pub speed: f64,
    /// Altitude above sea level, m; from -1000 to 25,000 m.
    pub altitude: f64,
    /// Flight path angle, rad, positive climbing. A climb is steady but for the change of the air with altitude.
    pub flight_path_angle: f64,
    /// Rate of the heading, rad/s, positive to the right.
    pub turn_rate: f64,
    /// Heading, rad; it does not influence the trim.
    pub heading: f64,
    /// Aerodynamic increments in force.
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

/// A steady flight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trim {
    /// True airspeed, m/s.
    pub speed_m_s: f64,
    /// Altitude, m.
    pub altitude_m: f64,
    /// Flight path angle, rad.
    pub flight_path_angle_rad: f64,
    /// Rate of the heading, rad/s.
    pub turn_rate_rad_s: f64,
    /// Angle of attack, rad.
    pub alpha_rad: f64,
    /// Sideslip angle, rad.
    pub beta_rad: f64,
    /// Bank angle, rad.
    pub phi_rad: f64,
    /// Pitch angle, rad.
    pub theta_rad: f64,
    /// Heading, rad.
    pub psi_rad: f64,
    /// Roll rate, rad/s.
    pub p_rad_s: f64,
    /// Pitch rate, rad/s.
    pub q_rad_s: f64,
    /// Yaw rate, rad/s.
    pub r_rad_s: f64,
    /// Throttle lever, 0 to 1.
    pub throttle: f64,
    /// Elevator, rad, positive trailing edge down.
    pub elevator_rad: f64,
    /// Aileron, rad.
    pub aileron_rad: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
    /// Engine state, percent.
    pub power_percent: f64,
    /// Thrust, N: magnitude of the propulsive force, negative when it points backwards.
    pub thrust_n: f64,
    /// Dynamic pressure, Pa.
    pub dynamic_pressure_pa: f64,
    /// Mach number.
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

const EQUATIONS: [&str; UNKNOWNS] = [
    "speed rate",
    "angle-of-attack rate",
    "sideslip rate",
    "roll acceleration",
    "pitch acceleration",
    "yaw acceleration",
    "climb",
    "side force",
];
/// Starts in angle of attack, deg: the attached-flow equilibrium is found before those beyond the stall.
const STARTS_DEG: [f64; 8] = [3.0, 8.0, 14.0, 20.0, 27.0, 34.0, 40.0, 45.0];

/// The steady flight at a condition: the first one, from starts of rising angle of attack, that lies within the aircraft's
/// limits (throttle 0 to 1, actuator limits, the condition's range of angle of attack).
///
/// # Errors
/// [`TrimError`] says which limit stands against it and by how much, or how far the solver came.
///
/// ```
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
///
/// let aircraft = F16::new(F16Options::default())?;
/// let level = trim(&aircraft, &TrimCondition::steady(&aircraft, 150.0, 1000.0, 0.0, 0.0))?;
/// assert!((level.load_factor - 1.0).abs() < 0.01 && level.phi_rad.abs() < 1e-6);
/// // A turn of 6 deg/s to the right banks and pulls more than 1 g; the climb that was asked for is too steep.
/// let turn = TrimCondition::steady(&aircraft, 150.0, 1000.0, 0.0, 6.0_f64.to_radians());
/// let turn = trim(&aircraft, &turn)?;
/// assert!(turn.phi_rad > 0.9 && turn.load_factor > 1.7);
/// let refused = trim(&aircraft, &TrimCondition::steady(&aircraft, 150.0, 1000.0, 1.4, 0.0));
/// assert!(refused.unwrap_err().to_string().contains("throttle"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn trim<A: Aircraft>(aircraft: &A, condition: &TrimCondition) -> Result<Trim, TrimError> {
    check(condition)?;
    let problem = Problem::new(aircraft, condition);
    let mut mildest: Option<(f64, TrimError)> = None;
    let mut closest: Option<Solution> = None;
    for start in STARTS_DEG {
        let solution = problem.solve(problem.start(start.to_radians()), &mut |_, _| ());
        if solution.largest() > TOLERANCE {
            if closest.as_ref().is_none_or(|c| solution.largest() < c.largest()) {
                closest = Some(solution);
            }
            continue;
        }
        match problem.refusal(&solution) {
            None => return Ok(problem.report(&solution)),
            Some(refusal) => {
                if mildest.as_ref().is_none_or(|m| refusal.0 < m.0) {
                    mildest = Some(refusal);
                }
            }
        }
    }
    if let Some(refusal) = problem.not_enough_lift() {
        return Err(refusal);
    }
    match (mildest, closest) {
        (Some((_, refusal)), _) => Err(refusal),
        (None, closest) => {
            let residuals = closest.as_ref().map_or([f64::NAN; UNKNOWNS], |s| s.residuals);
            let worst = (0..UNKNOWNS).max_by(|&a, &b| residuals[a].abs().total_cmp(&residuals[b].abs())).unwrap_or(0);
            Err(TrimError::NoConvergence {
                starts: STARTS_DEG.len(),
                equation: EQUATIONS[worst],
                residual: residuals[worst],
                alpha_rad: closest.map_or(f64::NAN, |s| s.unknowns[0]),
            })
        }
    }
}

/// Altitudes, m, in which the atmosphere models mean something; not far above, the air of Stevens & Lewis ends.
const ATMOSPHERE: RangeInclusive<f64> = -1_000.0..=25_000.0;

fn check(c: &TrimCondition) -> Result<(), TrimError> {
    let [low, high] = c.alpha_range;
    for (field, value, valid, expected) in [
        ("speed", c.speed, c.speed > 0.0, "a positive number, m/s"),
        (
            "altitude",
            c.altitude,
            ATMOSPHERE.contains(&c.altitude),
            "between -1000 and 25000 m, where the models of the air hold",
        ),
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
