//! Where the flight of a scenario starts: its trim, and the state over a plane or a planet that belongs to it.

use phugoid_flight_dynamics::aircraft::{Aircraft, State};
use phugoid_flight_dynamics::earth::Earth;
use phugoid_flight_dynamics::globe::attitude::EulerAngles;
use phugoid_flight_dynamics::globe::vector::{Matrix, add, apply, apply_transposed, product, transpose};
use phugoid_flight_dynamics::modified::Modified;
use phugoid_flight_dynamics::rigid_body::Angles;
use phugoid_flight_dynamics::standard_atmosphere::geopotential_altitude;
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, trim};

use crate::scenario::{Scenario, Wind};

/// The steady flight that a scenario starts in, of any aircraft.
///
/// Over a planet it is that of a plane with the gravity of the place, less what the curved path and the rotation of the planet
/// carry of the weight; its altitude is the geopotential one, by which the air counts.
///
/// # Errors
/// [`TrimError`]: the aircraft has no steady flight in this condition.
pub fn trim_of<A: Aircraft>(aircraft: &A, scenario: &Scenario) -> Result<Trim, TrimError> {
    let at = &scenario.condition;
    let steady = |altitude: f64, gravity: Option<f64>| {
        let condition =
            TrimCondition::steady(aircraft, at.speed.si(), altitude, at.flight_path.si(), at.turn_rate.si());
        match gravity {
            None => trim(aircraft, &condition),
            Some(gravity) => trim(&InGravity { aircraft, gravity }, &condition),
        }
    };
    match scenario.earth_below() {
        None => steady(at.altitude.si(), None),
        Some(earth) => {
            let Pull { size, .. } = pull(scenario, &earth);
            steady(geopotential_altitude(at.altitude.si()), Some(size))
        }
    }
}

/// The state in which a flight starts from its trim: heading, and over a planet the altitude above it, the rates of the local axes
/// and the small bank that holds against the sideways acceleration of Coriolis.
pub(crate) fn state_of(scenario: &Scenario, trim: &Trim) -> State {
    let heading = scenario.condition.heading.si();
    let mut state = trim.state();
    if heading != 0.0 {
        state.psi = heading;
    }
    let Some(earth) = scenario.earth_below() else { return state };
    state.altitude = scenario.condition.altitude.si();
    let body = product(&attitude(&state), &transpose(&about_path(heading, -pull(scenario, &earth).bank)));
    let EulerAngles { yaw, pitch, roll } = EulerAngles::of_matrix(&body);
    (state.phi, state.theta, state.psi) = (roll, pitch, yaw);
    // Rates of the trim are relative to north, east and down.
    let here = earth.under(&state);
    let velocity = Angles::of(state.alpha, state.beta, state.phi, state.theta).body_velocity(state.speed);
    let through_air = apply_transposed(&body, velocity);
    let [north, east] = wind(scenario, &state);
    let carried = here.transport_rate([through_air[0] + north, through_air[1] + east]);
    let turning = apply(&body, add(here.rotation, carried));
    (state.p, state.q, state.r) = (state.p + turning[0], state.q + turning[1], state.r + turning[2]);
    state
}

/// An aircraft under another gravity.
struct InGravity<'a, A> {
    aircraft: &'a A,
    /// m/s^2.
    gravity: f64,
}

impl<A: Aircraft> Modified for InGravity<'_, A> {
    type Unmodified = A;

    fn unmodified(&self) -> &A {
        self.aircraft
    }

    fn gravity(&self) -> f64 {
        self.gravity
    }
}

/// What the lift has to hold at the start: its size, m/s^2, and how far it lies to the right of straight down, rad.
struct Pull {
    size: f64,
    bank: f64,
}

fn pull(scenario: &Scenario, earth: &Earth) -> Pull {
    let at = &scenario.condition;
    let mut state = State::from_array([0.0; phugoid_flight_dynamics::aircraft::STATES]);
    state.altitude = at.altitude.si();
    let (sin, cos) = at.heading.si().sin_cos();
    let level = at.speed.si() * at.flight_path.si().cos();
    let [north, east] = wind(scenario, &state);
    let [x, y, down] = earth.gravity_in_motion(&state, [level * cos + north, level * sin + east]);
    let right = y * cos - x * sin;
    Pull { size: right.hypot(down), bank: right.atan2(down) }
}

/// The wind of a scenario at the altitude of a state, towards north and east, m/s.
fn wind(scenario: &Scenario, state: &State) -> [f64; 2] {
    let profile = scenario.wind.as_ref().map(Wind::profile).and_then(Result::ok);
    profile.map_or([0.0; 2], |profile| profile.at(state.altitude).velocity)
}

fn attitude(state: &State) -> Matrix {
    EulerAngles { yaw: state.psi, pitch: state.theta, roll: state.phi }.matrix()
}

/// Rotation by an angle (rad, right-handed) about the level direction of a heading (rad): it turns components along north, east and
/// down.
fn about_path(heading: f64, angle: f64) -> Matrix {
    let along = EulerAngles { yaw: heading, ..EulerAngles::default() }.matrix();
    // From the axes before to those that have turned is the matrix of the roll; the vector turns the other way.
    let roll = transpose(&EulerAngles { roll: angle, ..EulerAngles::default() }.matrix());
    product(&transpose(&along), &product(&roll, &along))
}
