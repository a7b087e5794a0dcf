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
//! without a turn it makes the wings level. An aircraft whose rudder moves nothing, because it is gone or in no table, cannot
//! meet it: its rudder is held at zero in its place, and it may fly banked, with a side force. The climb equation is their rate-of-climb constraint (3.6-1). The body rates
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
mod condition;
mod error;
mod problem;

use crate::aircraft::Aircraft;

use self::condition::check;
use self::problem::{Problem, STARTS_DEG, Solution, TOLERANCE, UNKNOWNS};
pub use approach::{TrimStart, TrimStep, approach};
pub use condition::{Trim, TrimCondition};
pub use error::TrimError;

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
    check(condition, aircraft.atmosphere())?;
    within_tables(aircraft, condition)?;
    let problem = Problem::new(aircraft, condition);
    if let Some(refusal) = problem.no_turn() {
        return Err(refusal);
    }
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

/// Refuses speeds and altitudes for which the aircraft has no data.
fn within_tables<A: Aircraft>(aircraft: &A, condition: &TrimCondition) -> Result<(), TrimError> {
    let range = aircraft.data_range();
    let mach = condition.speed / aircraft.atmosphere().at(condition.altitude).speed_of_sound;
    let checked = [
        ("true airspeed in m/s", condition.speed, range.speed),
        ("Mach number", mach, range.mach),
        ("altitude in m", condition.altitude, range.altitude),
    ];
    match checked.into_iter().find(|(_, value, [lowest, highest])| !(*lowest..=*highest).contains(value)) {
        Some((quantity, value, [lowest, highest])) => {
            Err(TrimError::OutsideTables { quantity, value, lowest, highest })
        }
        None => Ok(()),
    }
}
