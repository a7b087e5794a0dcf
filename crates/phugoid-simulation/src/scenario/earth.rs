//! The planet that a scenario is flown over.

use phugoid_flight_dynamics::earth::Earth;
use phugoid_flight_dynamics::globe::planet::{Ellipsoid, Planet};
use serde::Deserialize;

use crate::quantity::Angle;

/// Mean radius of the Earth, m (WGS 84, TR8350.2 3rd ed.: `R_1`).
const MEAN_RADIUS: f64 = 6_371_008.771_4;

/// The planet that a flight goes over, and where it begins. Without it the earth is a plane at rest, with the gravity that the
/// aircraft's data assume.
///
/// ```
/// use phugoid_simulation::scenario::Scenario;
///
/// let text = "
/// name = \"over Braunschweig\"
/// duration = \"5 s\"
/// sample_rate = \"50 Hz\"
/// aircraft = { type = \"f16\", cg = 0.30 }
/// condition = { altitude = \"6000 m\", speed = \"205 m/s\", heading = \"90 deg\" }
/// earth = { shape = \"wgs84\", latitude = \"52.3 deg\", longitude = \"10.6 deg\" }
/// ";
/// let flight = phugoid_simulation::flight::fly(&Scenario::parse(text, "text")?)?;
/// let longitude = &flight.truth.channel("longitude").ok_or("no longitude")?.values;
/// assert!(longitude[longitude.len() - 1] > longitude[0]); // it flies to the east
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EarthSettings {
    /// The figure of the planet and its gravitation.
    pub shape: EarthShape,
    /// Geodetic latitude of the start, positive north, up to 89 deg on both sides.
    pub latitude: Angle,
    /// Longitude of the start, positive east.
    #[serde(default)]
    pub longitude: Angle,
    /// Whether the planet turns; where nothing is said it does.
    #[serde(default = "turns")]
    pub rotating: bool,
}

fn turns() -> bool {
    true
}

/// The figure of the planet and its gravitation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EarthShape {
    /// A sphere of 6371.0088 km with the gravitation of a point.
    Round,
    /// The ellipsoid of WGS 84, with the gravitation of its mass and of the second zonal harmonic.
    Wgs84,
}

impl EarthSettings {
    /// The planet and the origin of the flight.
    ///
    /// # Errors
    /// A sentence that names the entry that is wrong and what is expected of it.
    pub fn earth(&self) -> Result<Earth, String> {
        let Ellipsoid { gravitational_parameter, rotation_rate, .. } = Ellipsoid::WGS84;
        let rotation_rate = if self.rotating { rotation_rate } else { 0.0 };
        let planet = match self.shape {
            EarthShape::Wgs84 => Planet::Ellipsoid(Ellipsoid { rotation_rate, ..Ellipsoid::WGS84 }),
            EarthShape::Round => Planet::sphere(MEAN_RADIUS, gravitational_parameter, rotation_rate),
        };
        let (latitude, longitude) = (self.latitude.si(), self.longitude.si());
        if !(-std::f64::consts::TAU..=std::f64::consts::TAU).contains(&longitude) {
            return Err("`earth.longitude` is from -180 to 180 deg, positive to the east".to_owned());
        }
        Earth::new(planet, latitude, longitude).ok_or_else(|| {
            "`earth.latitude` is from -89 to 89 deg, positive to the north: at the poles north is no direction"
                .to_owned()
        })
    }
}

/// In what the attitude of a flight is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Attitude {
    /// Roll, pitch and heading angle, which fail where the nose points straight up or down; the heading goes on beyond 180 deg.
    #[default]
    Euler,
    /// A quaternion, for loops and vertical flight; recorded roll angle and heading are from -180 to 180 deg.
    Quaternion,
}
