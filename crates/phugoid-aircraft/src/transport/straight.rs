//! Straight flight with a given rudder, banked if need be.

use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::globe::steady::{NoTrim, solve};
use phugoid_flight_dynamics::motion::{Disturbance, motion};

/// A steady straight flight that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightFlight {
    /// State above the origin, heading north.
    pub state: State,
    /// Throttle lever and surface positions.
    pub controls: Controls,
}

/// Why there is no such flight.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StraightFlightError {
    /// The solver stopped before all accelerations were gone.
    #[error("straight flight: {0}")]
    NoTrim(NoTrim),
    /// A control would have to go beyond its stop, or an angle leaves the data.
    #[error(
        "straight flight: the {what} would have to be {needed:.4}, it goes from {low:.4} to {high:.4} (rad, throttle 0 to 1)"
    )]
    Limit {
        /// Name of the control or angle.
        what: &'static str,
        /// Its value in the flight without limits, rad or throttle.
        needed: f64,
        /// Lowest value.
        low: f64,
        /// Highest value.
        high: f64,
    },
}

/// Straight flight at a true airspeed (m/s), altitude (m) and flight path angle (rad, positive climbing) with the rudder held
/// at an angle (rad). In place of the side force, which [`trim`](phugoid_flight_dynamics::trim::trim) makes zero, the bank
/// angle is free: the way to fly straight without a rudder.
///
/// ```
/// use phugoid_aircraft::transport::straight_flight;
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
///
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let crabbed = straight_flight(&aircraft, 150.0, 1000.0, 0.0, 0.05)?;
/// // The rudder yaws to the left: wind from the right, and a bank to the right that holds the heading.
/// assert!(crabbed.state.beta > 0.01 && crabbed.state.phi > 0.005);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StraightFlightError`]: no equilibrium, or only one beyond the limits of actuators, throttle or angle of attack.
pub fn straight_flight<A: Aircraft>(
    aircraft: &A,
    speed: f64,
    altitude: f64,
    path: f64,
    rudder: f64,
) -> Result<StraightFlight, StraightFlightError> {
    let flight = |&[alpha, beta, phi, theta, throttle, elevator, aileron]: &[f64; 7]| {
        let mut state = State::from_array([0.0; 13]);
        (state.speed, state.alpha, state.beta, state.phi, state.theta) = (speed, alpha, beta, phi, theta);
        state.altitude = altitude;
        state.power = aircraft.steady_power(throttle);
        StraightFlight { state, controls: Controls { throttle, elevator, aileron, rudder } }
    };
    let (gravity, climb) = (aircraft.gravity(), speed * path.sin());
    let residuals = |x: &[f64; 7]| {
        let StraightFlight { state, controls } = flight(x);
        let rates = motion(aircraft, &state, &controls, &Disturbance::default()).rates;
        let along = rates.speed / gravity;
        [along, rates.alpha, rates.beta, rates.p, rates.q, rates.r, (rates.altitude - climb) / speed]
    };
    let solution = [3.0_f64, 6.0, 10.0]
        .into_iter()
        .map(|start| {
            let alpha = start.to_radians();
            solve(residuals, [alpha, 0.0, 0.0, alpha + path, 0.4, 0.0, 0.0], [1e-6; 7], 1e-10)
        })
        .reduce(|first, next| first.or(next))
        .unwrap_or(Err(NoTrim { residual: f64::NAN }))
        .map_err(StraightFlightError::NoTrim)?;
    let found = flight(&solution);
    let actuators = aircraft.actuators();
    let [low, high] = aircraft.data_range().alpha;
    for (what, needed, low, high) in [
        ("angle of attack", found.state.alpha, low, high),
        ("throttle", found.controls.throttle, 0.0, 1.0),
        ("elevator", found.controls.elevator, -actuators.elevator.limit, actuators.elevator.limit),
        ("aileron", found.controls.aileron, -actuators.aileron.limit, actuators.aileron.limit),
        ("rudder", found.controls.rudder, -actuators.rudder.limit, actuators.rudder.limit),
    ] {
        if !(low..=high).contains(&needed) {
            return Err(StraightFlightError::Limit { what, needed, low, high });
        }
    }
    Ok(found)
}
