//! A flight over the Earth in the states that an aircraft's sensors see: a round or flattened planet that may turn, where
//! [`motion`](crate::motion) has a plane at rest.
//!
//! Speed, angle of attack and sideslip stay those relative to the air, the attitude that against the local north, east and
//! down; `p`, `q` and `r` are the rates that gyros measure, relative to the stars. What the planet adds to the equations of the
//! plane is exact (B. L. Stevens, F. L. Lewis and E. N. Johnson, Aircraft Control and Simulation, 3rd ed., sections 1.6 and 1.7):
//! with the rotation `w` of the planet, that of the local axes `w + rho`, the velocity `v` relative to the air and the wind `W`,
//! all in body axes,
//!
//! ```text
//! v' = f + g - (omega + w) x v - (2 w + rho) x W - W'(h) h'        g: gravitation and centrifugal acceleration
//! phi', theta', psi'   from omega - w - rho                        aerodynamics from omega - w
//! ```
//!
//! Position is kept as latitude and longitude, written as metres: `north` is the angle of latitude from the origin times the
//! radius of curvature there, `east` the angle of longitude times that of the parallel there. Near the origin they are metres over
//! the ground. [`globe`](crate::globe) integrates the same motion relative to the stars, which holds at the poles as well.

use crate::aircraft::State;
use crate::globe::planet::{Ellipsoid, Geodetic, Planet};
use crate::globe::vector::{Vector, add, apply, cross, norm, subtract};
use crate::scalar::Scalar;

/// The planet where an aircraft is at one instant: what the equations of motion need of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalEarth {
    /// Gravity along local north, east and down, m/s^2: gravitation and the centrifugal acceleration of the turning planet.
    pub gravity: [f64; 3],
    /// Rotation of the planet along north, east and down, rad/s.
    pub rotation: [f64; 3],
    /// What a metre per second towards north and towards east turns the local axes by, rad/s: one over the radii of curvature of
    /// the surface, to which the altitude is added.
    pub curvature: [f64; 2],
    /// Tangent of the latitude.
    pub tan_latitude: f64,
    /// Metres of the states `north` and `east` per metre over the ground.
    pub map: [f64; 2],
}

impl LocalEarth {
    /// Rotation of the local axes relative to the planet (transport rate) at a velocity over the ground towards north and
    /// east, m/s: along north, east and down, rad/s.
    #[inline]
    pub fn transport_rate<T: Scalar>(&self, [north, east]: [T; 2]) -> [T; 3] {
        let [meridian, parallel] = self.curvature;
        let turning = east * parallel;
        [turning, north * -meridian, turning * -self.tan_latitude]
    }
}

/// A planet and the place over which a flight begins.
///
/// ```
/// use phugoid_flight_dynamics::earth::Earth;
/// use phugoid_flight_dynamics::globe::planet::Planet;
///
/// let earth = Earth::new(Planet::WGS84, 52.3_f64.to_radians(), 10.6_f64.to_radians()).ok_or("no place on the earth")?;
/// // 1 km further north.
/// let place = earth.place(1000.0, 0.0, 300.0);
/// assert!((place.latitude.to_degrees() - 52.3 - 0.008986).abs() < 1e-6);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Earth {
    planet: Ellipsoid,
    origin: Geodetic,
    /// Radius of curvature along the meridian, and radius of the parallel, at the origin, m.
    radii: [f64; 2],
}

/// Latitude up to which the local axes serve, rad: 89 degrees. Beyond, north turns by more than a degree over 2 km.
const LARGEST_LATITUDE: f64 = 89.0 * core::f64::consts::PI / 180.0;

impl Earth {
    /// A planet with the origin of a flight at a latitude (geodetic, positive north) and a longitude (positive east), rad. None for
    /// a plane, within a degree of a pole, and for numbers that are not finite.
    pub fn new(planet: Planet, latitude: f64, longitude: f64) -> Option<Self> {
        let Planet::Ellipsoid(ellipsoid) = planet else { return None };
        if !(latitude.abs() <= LARGEST_LATITUDE && longitude.is_finite()) {
            return None;
        }
        let (_, cos) = Scalar::sin_cos(latitude);
        let [meridian, normal] = planet.curvature_radii(latitude);
        let origin = Geodetic { latitude, longitude, altitude: 0.0 };
        Some(Self { planet: ellipsoid, origin, radii: [meridian, normal * cos] })
    }

    /// The planet.
    pub fn planet(&self) -> Planet {
        Planet::Ellipsoid(self.planet)
    }

    /// The place at the states `north`, `east` and `altitude`, m. The longitude is not wrapped.
    pub fn place(&self, north: f64, east: f64, altitude: f64) -> Geodetic {
        Geodetic {
            latitude: self.origin.latitude + north / self.radii[0],
            longitude: self.origin.longitude + east / self.radii[1],
            altitude,
        }
    }

    /// The planet under an aircraft in this state.
    pub fn under(&self, state: &State) -> LocalEarth {
        let planet = self.planet();
        // The field is the same at every longitude.
        let place = Geodetic { longitude: 0.0, ..self.place(state.north, state.east, state.altitude) };
        let (sin, cos) = Scalar::sin_cos(place.latitude);
        let position = planet.position(&place);
        let spin = self.planet.rotation_rate;
        let centrifugal = [spin * spin * position[0], spin * spin * position[1], 0.0];
        let gravity = apply(&planet.ned_from_earth(&place), add(planet.gravitation(position), centrifugal));
        let [meridian, normal] = planet.curvature_radii(place.latitude).map(|radius| radius + place.altitude);
        LocalEarth {
            gravity,
            rotation: [spin * cos, 0.0, -spin * sin],
            curvature: [1.0 / meridian, 1.0 / normal],
            tan_latitude: sin / cos,
            map: [self.radii[0] / meridian, self.radii[1] / (normal * cos)],
        }
    }

    /// What accelerates an aircraft along local north, east and down that keeps a level velocity over the ground (m/s towards
    /// north and east), forces left out: gravity less the accelerations of Coriolis and of the curved path, m/s^2. Its third
    /// component is the gravity that the lift has to hold.
    pub fn gravity_in_motion(&self, state: &State, [north, east]: [f64; 2]) -> Vector {
        let here = self.under(state);
        let carried = here.transport_rate([north, east]);
        let turning = core::array::from_fn(|i| 2.0 * here.rotation[i] + carried[i]);
        subtract(here.gravity, cross(turning, [north, east, 0.0]))
    }

    /// Size of gravity at a place, m/s^2.
    pub fn gravity_at(&self, state: &State) -> f64 {
        norm(self.under(state).gravity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_rest() -> State {
        State::from_array([0.0; 13])
    }

    /// Somigliana's formula of WGS 84 (TR8350.2, 4-1) is that of the normal field, in which the J2 field of the
    /// check cases lacks the terms from J4 on: 2e-6 of gravity.
    #[test]
    fn gravity_is_that_of_the_normal_field() {
        for degrees in [-80.0_f64, -45.0, 0.0, 30.0, 60.0, 88.0] {
            let earth = Earth::new(Planet::WGS84, degrees.to_radians(), 0.3).unwrap();
            let sine2 = degrees.to_radians().sin().powi(2);
            let normal =
                9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * sine2) / (1.0 - 0.006_694_379_990_14 * sine2).sqrt();
            let [north, east, down] = earth.under(&at_rest()).gravity;
            assert!((down / normal - 1.0).abs() < 2e-5, "{degrees}: {down} {normal}");
            assert!(north.abs() < 1e-4 && east == 0.0, "{degrees}: {north} {east}");
        }
    }

    #[test]
    fn eastwards_an_aircraft_is_lighter_than_westwards() {
        let earth = Earth::new(Planet::WGS84, 0.0, 0.0).unwrap();
        let [east, west] = [200.0, -200.0].map(|v| earth.gravity_in_motion(&at_rest(), [0.0, v])[2]);
        // Eotvos: 2 omega V, twice.
        assert!((west - east - 4.0 * 7.292_115e-5 * 200.0).abs() < 1e-12, "{east} {west}");
        let north = earth.gravity_in_motion(&at_rest(), [200.0, 0.0]);
        assert!((earth.gravity_at(&at_rest()) - north[2] - 200.0 * 200.0 / 6_335_439.327).abs() < 1e-7);
    }

    #[test]
    fn planes_poles_and_what_is_no_number_are_refused() {
        let flat = Planet::Flat { gravity: 9.8 };
        for (planet, latitude, longitude) in [
            (flat, 0.0, 0.0),
            (Planet::WGS84, 1.56, 0.0),
            (Planet::WGS84, f64::NAN, 0.0),
            (Planet::WGS84, 0.0, f64::INFINITY),
        ] {
            assert_eq!(Earth::new(planet, latitude, longitude), None);
        }
    }
}
