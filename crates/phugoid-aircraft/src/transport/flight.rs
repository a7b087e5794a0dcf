//! Flights in which damage happens.

use phugoid_flight_dynamics::aircraft::{Controls, State};
use phugoid_flight_dynamics::gust::AirMotion;
use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule};
use phugoid_flight_dynamics::rigid_body::Angles;
use phugoid_flight_dynamics::simulate::{Simulation, SimulationError, Trajectory};

use super::{Transport, cross, difference};

/// Flies a simulation whose aircraft is another from a time (s) on: damage in flight.
///
/// The commands and the motion of the air are functions of the time since the start, as in [`Simulation::run`]. The time is
/// rounded to the grid of the samples. The sample at that time is the first of the damaged aircraft; a time beyond the end
/// (or none, NaN) leaves the aircraft whole, one before the start gives the damaged aircraft from the beginning.
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
    mut commands: impl FnMut(f64) -> Controls,
    mut gust: impl FnMut(f64) -> W,
) -> Result<Trajectory, SimulationError> {
    let Simulation { duration, sample_time, .. } = *simulation;
    let sample = (at / sample_time).round().max(0.0);
    let begin = sample * sample_time;
    if at.is_nan() || begin > duration || !(sample.is_finite() && sample_time > 0.0) {
        return simulation.run(commands, gust);
    }
    let before = Simulation { duration: begin, ..simulation.clone() };
    let mut flight = before.run(&mut commands, &mut gust)?;
    let Some(last) = flight.samples.pop() else { return Ok(flight) };
    // The grid of the whole flight has the same times as that of a flight without damage.
    let rate = (1.0 / sample_time).round();
    let even = rate > 0.0 && (rate * sample_time - 1.0).abs() < 1e-12;
    let grid = |k: f64| if even { k / rate } else { k * sample_time };
    let on_sample = |time: f64| {
        let k = (time / sample_time).round();
        ((k * sample_time - time).abs() < 1e-6 * sample_time).then_some(k)
    };
    let since_start = |time: f64| on_sample(time).map_or(grid(sample) + time, |k| grid(sample + k));
    let after = Simulation {
        aircraft: damaged,
        initial: moved_to(simulation.aircraft, damaged, &last.state),
        initial_surfaces: last.surfaces,
        increments: from_then_on(&simulation.increments, grid(sample), |time| on_sample(time).map_or(time, grid)),
        duration: duration - begin,
        ..simulation.clone()
    };
    let rest =
        after.run(|time| commands(since_start(time)), |time| gust(since_start(time))).map_err(|error| match error {
            SimulationError::NotFinite { state, time, last_speed } => {
                SimulationError::NotFinite { state, time: since_start(time), last_speed }
            }
            other => other,
        })?;
    flight.samples.extend(rest.samples.into_iter().map(|mut sample| {
        sample.time = since_start(sample.time);
        sample
    }));
    Ok(flight)
}

/// Increments with times that count from another instant. A change on a sample stays on it whatever the rounding.
fn from_then_on(increments: &IncrementSchedule, begin: f64, grid: impl Fn(f64) -> f64) -> IncrementSchedule {
    let mut changes: Vec<IncrementChange> = Vec::new();
    for change in increments.changes() {
        let moved = IncrementChange { time: grid(change.time - begin), ..*change };
        // Two that rounding puts on one instant are the later one.
        changes.pop_if(|last| last.time >= moved.time);
        changes.push(moved);
    }
    IncrementSchedule::new(changes).unwrap_or_else(|_| IncrementSchedule::constant(increments.at(begin)))
}

/// The state of an aircraft whose centre of gravity is that of `after`, from the state that it had with that of `before`: the
/// same motion of the same body.
///
/// The velocity of the new centre of gravity is `v + w x d` and its position moves with the attitude by `d`, the way between
/// both in body axes.
pub fn moved_to(before: &Transport, after: &Transport, state: &State) -> State {
    let way = difference(after.centre_of_gravity(), before.centre_of_gravity());
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
