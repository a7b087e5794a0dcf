//! Everything that follows from a state at one instant: where the vehicle is, how it moves, and the air data.

use super::attitude::{EulerAngles, Quaternion};
use super::planet::{Geodetic, Planet};
use super::vector::{
    Matrix, Vector, add, apply, apply_transposed, atan2, cross, dot, norm, product, scale, sqrt, subtract, transpose,
};
use crate::aircraft::AirData;
use crate::atmosphere::{Air, Atmosphere};
use crate::gust::AirMotion;
use crate::standard_atmosphere::standard_atmosphere;

/// The air at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AirModel {
    /// U.S. Standard Atmosphere 1976 of the geometric altitude, up to 86 km.
    #[default]
    Standard1976,
    /// No air: density and pressure are zero, the speed of sound is that of 288.15 K.
    Vacuum,
    /// One of the models of a flat earth, whose altitude is geopotential.
    Simple(Atmosphere),
}

impl AirModel {
    /// The air at a geometric altitude above sea level, m.
    #[inline]
    pub fn at(&self, altitude: f64) -> Air {
        match self {
            Self::Standard1976 => standard_atmosphere(altitude),
            Self::Vacuum => Air { density: 0.0, pressure: 0.0, ..standard_atmosphere(0.0) },
            Self::Simple(model) => model.at(altitude),
        }
    }
}

/// A steady wind that is linear in altitude: `at_zero + gradient * altitude`. The default is still air, which turns with
/// the planet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wind {
    /// Velocity of the air relative to the ground at altitude zero, m/s towards north, east and down.
    pub at_zero: Vector,
    /// Change of that velocity with altitude, 1/s.
    pub gradient: Vector,
}

impl Wind {
    /// Velocity of the air relative to the ground at an altitude (m), m/s towards north, east and down.
    #[inline]
    pub fn at(&self, altitude: f64) -> Vector {
        add(self.at_zero, scale(self.gradient, altitude))
    }
}

/// A planet with its air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Shape, gravitation and rotation.
    pub planet: Planet,
    /// The air at rest.
    pub air: AirModel,
    /// Motion of the air relative to the ground.
    pub wind: Wind,
}

impl World {
    /// A planet with the standard atmosphere of 1976 in still air.
    pub const fn new(planet: Planet) -> Self {
        Self { planet, air: AirModel::Standard1976, wind: Wind { at_zero: [0.0; 3], gradient: [0.0; 3] } }
    }
}

/// State of a vehicle with `X` states of its own, relative to the inertial frame of [`planet`](super::planet).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobeState<const X: usize = 0> {
    /// Position of the centre of gravity from the centre of the planet, m, inertial components.
    pub position: Vector,
    /// Inertial velocity of the centre of gravity, m/s, inertial components.
    pub velocity: Vector,
    /// Attitude of the body axes (x forward, y right, z down) relative to the inertial frame.
    pub attitude: Quaternion,
    /// Body rates `[p, q, r]` relative to the inertial frame, rad/s, body axes.
    pub rates: Vector,
    /// The vehicle's own states.
    pub internal: [f64; X],
}

/// Body rates at the start, rad/s in body axes, and what they are relative to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialRates {
    /// Relative to the inertial frame.
    Inertial(Vector),
    /// Relative to the rotating planet.
    Earth(Vector),
    /// Relative to the local north-east-down axes, which turn with the planet and with the motion over it.
    Local(Vector),
}

/// Where and how a flight begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Launch {
    /// The place.
    pub place: Geodetic,
    /// Velocity relative to the ground, m/s towards north, east and down.
    pub velocity: Vector,
    /// Attitude relative to local north, east and down.
    pub euler: EulerAngles,
    /// Body rates.
    pub rates: InitialRates,
}

impl Launch {
    /// The state at a time (s) with these own states of the vehicle.
    pub fn state<const X: usize>(&self, planet: &Planet, time: f64, internal: [f64; X]) -> GlobeState<X> {
        let earth_from_inertial = planet.earth_from_inertial(time);
        let ned_from_inertial = product(&planet.ned_from_earth(&self.place), &earth_from_inertial);
        let position = apply_transposed(&earth_from_inertial, planet.position(&self.place));
        let spin = [0.0, 0.0, planet.rotation_rate()];
        let velocity = add(apply_transposed(&ned_from_inertial, self.velocity), cross(spin, position));
        let body_from_ned = self.euler.matrix();
        let body_from_inertial = product(&body_from_ned, &ned_from_inertial);
        let rates = match self.rates {
            InitialRates::Inertial(rates) => rates,
            InitialRates::Earth(rates) => add(rates, apply(&body_from_inertial, spin)),
            InitialRates::Local(rates) => {
                add(rates, apply(&body_from_ned, planet.ned_rotation(&self.place, self.velocity)))
            }
        };
        GlobeState { position, velocity, attitude: Quaternion::of_matrix(&body_from_inertial), rates, internal }
    }
}

/// Everything that follows from a state at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition<const X: usize = 0> {
    /// Time since both frames coincided, s.
    pub time: f64,
    /// The state itself: inertial position, velocity, attitude and rates, and the vehicle's own states.
    pub state: GlobeState<X>,
    /// Latitude, longitude and altitude.
    pub place: Geodetic,
    /// Position in the earth-fixed frame, m.
    pub earth_position: Vector,
    /// Velocity relative to the ground, m/s towards north, east and down.
    pub ground_velocity: Vector,
    /// Attitude relative to local north, east and down.
    pub euler: EulerAngles,
    /// Matrix from inertial to body components.
    pub body_from_inertial: Matrix,
    /// Matrix from inertial components to those along local north, east and down.
    pub ned_from_inertial: Matrix,
    /// Body rates relative to the rotating planet and its air, rad/s, body axes.
    pub rates_to_earth: Vector,
    /// Acceleration by gravitation, m/s^2, inertial components. Centrifugal acceleration is no part of it.
    pub gravitation: Vector,
    /// The air around the vehicle.
    pub atmosphere: Air,
    /// Velocity of the air relative to the ground, m/s towards north, east and down.
    pub wind: Vector,
    /// Velocity relative to the air in body axes, m/s.
    pub air_velocity: Vector,
    /// True airspeed, angle of attack, sideslip, density, dynamic pressure and Mach number. The angles are zero at rest.
    pub air: AirData,
    /// Rates of angle of attack and of sideslip, rad/s. Zero before the accelerations are known; see
    /// [`Loads::uses_angle_rates`](super::loads::Loads::uses_angle_rates).
    pub angle_rates: [f64; 2],
}

/// Air data of a velocity relative to the air (body axes, m/s).
fn air_data(velocity: Vector, atmosphere: &Air) -> AirData {
    let [u, v, w] = velocity;
    let speed = norm(velocity);
    AirData {
        speed,
        alpha: if u == 0.0 && w == 0.0 { 0.0 } else { atan2(w, u) },
        beta: if speed == 0.0 { 0.0 } else { atan2(v, sqrt(u * u + w * w)) },
        density: atmosphere.density,
        dynamic_pressure: 0.5 * atmosphere.density * speed * speed,
        mach: speed / atmosphere.speed_of_sound,
    }
}

/// Density of the air at sea level in the standard atmosphere, kg/m^3.
const DENSITY_0: f64 = 1.225;

impl<const X: usize> Condition<X> {
    /// Of a state at a time, s.
    pub fn of(world: &World, time: f64, state: &GlobeState<X>) -> Self {
        let planet = &world.planet;
        let earth_from_inertial = planet.earth_from_inertial(time);
        let earth_position = apply(&earth_from_inertial, state.position);
        let place = planet.geodetic(earth_position);
        let ned_from_inertial = product(&planet.ned_from_earth(&place), &earth_from_inertial);
        let spin = [0.0, 0.0, planet.rotation_rate()];
        let ground_velocity = apply(&ned_from_inertial, subtract(state.velocity, cross(spin, state.position)));
        let body_from_inertial = state.attitude.matrix();
        let body_from_ned = product(&body_from_inertial, &transpose(&ned_from_inertial));
        let wind = world.wind.at(place.altitude);
        let air_velocity = apply(&body_from_ned, subtract(ground_velocity, wind));
        let atmosphere = world.air.at(place.altitude);
        let air = air_data(air_velocity, &atmosphere);
        Self {
            time,
            state: *state,
            place,
            earth_position,
            ground_velocity,
            euler: EulerAngles::of_matrix(&body_from_ned),
            body_from_inertial,
            ned_from_inertial,
            rates_to_earth: subtract(state.rates, apply(&body_from_inertial, spin)),
            gravitation: planet.gravitation(state.position),
            atmosphere,
            wind,
            air_velocity,
            air,
            angle_rates: [0.0; 2],
        }
    }

    /// The same in air that moves besides the wind: its velocity is taken from the one relative to the air, and its
    /// rotation from the rates relative to the earth. Rates of the flow angles that were known stay as they are.
    pub fn in_moving_air(&self, motion: &AirMotion) -> Self {
        let air_velocity = subtract(self.air_velocity, motion.velocity);
        Self {
            air_velocity,
            air: air_data(air_velocity, &self.atmosphere),
            rates_to_earth: subtract(self.rates_to_earth, motion.rates),
            ..*self
        }
    }

    /// Equivalent airspeed, m/s: the speed that has the same dynamic pressure in the standard air of sea level
    /// (1.225 kg/m^3).
    pub fn equivalent_airspeed(&self) -> f64 {
        self.air.speed * sqrt(self.air.density / DENSITY_0)
    }

    /// Body rates relative to the local north-east-down axes, rad/s, body axes: the rates of the Euler angles follow from
    /// them. Not finite at the poles; see [`Planet::ned_rotation`].
    pub fn rates_to_local(&self, planet: &Planet) -> Vector {
        let turning = planet.ned_rotation(&self.place, self.ground_velocity);
        subtract(self.state.rates, apply(&self.body_from_inertial, apply_transposed(&self.ned_from_inertial, turning)))
    }

    /// Rates of angle of attack and sideslip, rad/s, that belong to a specific force (force without gravity over mass,
    /// m/s^2, body axes). Zero without motion through the air.
    ///
    /// Time derivative of `alpha = atan(w/u)` and `beta = asin(v/V)` with the velocity relative to the air, which moves
    /// with the planet and the wind (Stevens, Lewis and Johnson 2.3-10).
    pub fn angle_rates_of(&self, world: &World, specific_force: Vector) -> [f64; 2] {
        let [u, v, w] = self.air_velocity;
        let plane2 = u * u + w * w;
        if plane2 == 0.0 {
            return [0.0; 2];
        }
        let spin = [0.0, 0.0, world.planet.rotation_rate()];
        let mut acceleration = subtract(self.gravitation, cross(spin, self.state.velocity));
        if world.wind != Wind::default() {
            let turning = world.planet.ned_rotation(&self.place, self.ground_velocity);
            let climbing = scale(world.wind.gradient, -self.ground_velocity[2]);
            let change = add(climbing, cross(turning, self.wind));
            acceleration = subtract(acceleration, apply_transposed(&self.ned_from_inertial, change));
        }
        let in_body = add(apply(&self.body_from_inertial, acceleration), specific_force);
        let [u_rate, v_rate, w_rate] = subtract(in_body, cross(self.state.rates, self.air_velocity));
        let speed2 = dot(self.air_velocity, self.air_velocity);
        let alpha_rate = (u * w_rate - w * u_rate) / plane2;
        let beta_rate = (v_rate * plane2 - v * (u * u_rate + w * w_rate)) / (speed2 * sqrt(plane2));
        [alpha_rate, beta_rate]
    }
}
