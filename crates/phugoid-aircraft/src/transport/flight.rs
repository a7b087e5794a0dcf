//! Flights in which damage happens.

use phugoid_flight_dynamics::aircraft::{Controls, State};
use phugoid_flight_dynamics::globe::vector::{cross, subtract};
use phugoid_flight_dynamics::gust::AirMotion;
use phugoid_flight_dynamics::rigid_body::Angles;
use phugoid_flight_dynamics::simulate::{Simulation, SimulationError, Trajectory};

use super::Transport;

/// Flies a simulation whose aircraft is another from a time (s) on: damage in flight.
///
/// Times, commands and air are as in [`Simulation::run_changed`].
///
/// The body keeps its motion: attitude, rates, the velocity of every point, engine state and surface positions are those of
/// the instant before. The centre of gravity moves within the body, so that speed, angle of attack, sideslip and position,
/// which are its own, change ([`moved_to`]). Surfaces that are gone keep their positions in the record, where they do nothing.
///
/// # Errors
/// [`SimulationError`] when the times make no grid or the motion diverges; its time counts from the start of the flight.
pub fn fly_damaged<W: Into<AirMotion>>(
    simulation: &Simulation<'_, Transport>,
    damaged: &Transport,
    at: f64,
    commands: impl FnMut(f64) -> Controls,
    gust: impl FnMut(f64) -> W,
) -> Result<Trajectory, SimulationError> {
    let before = simulation.aircraft;
    simulation.run_changed(damaged, at, |state| moved_to(before, damaged, state), commands, gust)
}

/// The state of an aircraft whose centre of gravity is that of `after`, from the state that it had with that of `before`: the
/// same motion of the same body.
///
/// The velocity of the new centre of gravity is `v + w x d` and its position moves with the attitude by `d`, the way between
/// both in body axes.
pub fn moved_to(before: &Transport, after: &Transport, state: &State) -> State {
    let way = subtract(after.centre_of_gravity(), before.centre_of_gravity());
    let angles = Angles::of(state.alpha, state.beta, state.phi, state.theta);
    let turning = cross([state.p, state.q, state.r], way);
    let velocity = angles.body_velocity(state.speed);
    let [u, v, w] = std::array::from_fn(|i| velocity[i] + turning[i]);
    let (sin_psi, cos_psi) = state.psi.sin_cos();
    let Angles { sin_phi, cos_phi, sin_theta, cos_theta, .. } = angles;
    let [x, y, z] = way;
    let sideways = y * sin_phi + z * cos_phi;
    let (along, across) = (x * cos_theta + sideways * sin_theta, y * cos_phi - z * sin_phi);
    State {
        speed: (u * u + v * v + w * w).sqrt(),
        alpha: w.atan2(u),
        beta: v.atan2(u.hypot(w)),
        north: state.north + along * cos_psi - across * sin_psi,
        east: state.east + along * sin_psi + across * cos_psi,
        altitude: state.altitude + x * sin_theta - sideways * cos_theta,
        ..*state
    }
}
