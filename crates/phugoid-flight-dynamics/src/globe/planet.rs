//! Shape, gravitation and rotation of a planet, and positions on it.
//!
//! Two frames share the planet's centre and its axis of rotation z (towards the north pole): the inertial frame, and the
//! earth-fixed frame whose x axis passes through longitude zero on the equator. They coincide at time zero.

use super::vector::{Matrix, Vector, add, atan2, norm, scale, sin_cos, sqrt};

/// Geodetic latitude, longitude and altitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Geodetic {
    /// Angle between the equatorial plane and the normal of the ellipsoid, rad, positive north.
    pub latitude: f64,
    /// Longitude, rad, positive east.
    pub longitude: f64,
    /// Height above the ellipsoid along its normal, m, positive up.
    pub altitude: f64,
}

/// An ellipsoid of revolution with its gravitation and rotation; a sphere where the flattening is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Radius of the equator, m; positive.
    pub equatorial_radius: f64,
    /// `1 - polar radius / equatorial radius`, a pure number from 0 to below 1.
    pub flattening: f64,
    /// Gravitational constant times mass, m^3/s^2.
    pub gravitational_parameter: f64,
    /// Second zonal harmonic of the gravitational field, a pure number; zero for an inverse-square field.
    pub j2: f64,
    /// Rotation about the z axis, rad/s, positive eastwards.
    pub rotation_rate: f64,
}

impl Ellipsoid {
    /// The Earth of WGS 84: ellipsoid, rotation, and gravitation with the second zonal harmonic.
    ///
    /// National Imagery and Mapping Agency TR8350.2, 3rd ed. 2000: radius 6378137 m, flattening 1/298.257223563,
    /// 7.292115e-5 rad/s, 3.986004418e14 m^3/s^2. The second zonal harmonic is 1.08262982e-3, the value of the check
    /// cases of NASA/TM-2015-218675.
    pub const WGS84: Self = Self {
        equatorial_radius: 6_378_137.0,
        flattening: 1.0 / 298.257_223_563,
        gravitational_parameter: 3.986_004_418e14,
        j2: 1.082_629_82e-3,
        rotation_rate: 7.292_115e-5,
    };
}

/// What a vehicle flies over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Planet {
    /// A plane at rest. Both frames are then north, east and down from a point of the ground: positions are metres in
    /// that frame, the altitude is minus the third, and latitude and longitude are zero everywhere.
    Flat {
        /// Acceleration of gravity, m/s^2, positive down.
        gravity: f64,
    },
    /// A sphere or an ellipsoid.
    Ellipsoid(Ellipsoid),
}

impl Planet {
    /// [`Ellipsoid::WGS84`].
    pub const WGS84: Self = Self::Ellipsoid(Ellipsoid::WGS84);

    /// A sphere with an inverse-square field: radius in m, gravitational constant times mass in m^3/s^2, rotation in
    /// rad/s (positive eastwards).
    pub const fn sphere(radius: f64, gravitational_parameter: f64, rotation_rate: f64) -> Self {
        Self::Ellipsoid(Ellipsoid {
            equatorial_radius: radius,
            flattening: 0.0,
            gravitational_parameter,
            j2: 0.0,
            rotation_rate,
        })
    }

    /// Rotation about the z axis, rad/s, positive eastwards; zero for a plane.
    #[inline]
    pub fn rotation_rate(&self) -> f64 {
        match self {
            Self::Flat { .. } => 0.0,
            Self::Ellipsoid(e) => e.rotation_rate,
        }
    }

    /// Acceleration by gravitation, m/s^2, at a position (m); both in the inertial or both in the earth-fixed frame.
    ///
    /// The field of the mass and of its second zonal harmonic (Stevens, Lewis and Johnson 1.6-16). Centrifugal
    /// acceleration is no part of it. The centre of the planet gives NaN.
    #[inline]
    pub fn gravitation(&self, position: Vector) -> Vector {
        match *self {
            Self::Flat { gravity } => [0.0, 0.0, gravity],
            Self::Ellipsoid(e) => {
                let distance = norm(position);
                let sine = position[2] / distance;
                let ratio = e.equatorial_radius / distance;
                let harmonic = 1.5 * e.j2 * ratio * ratio;
                let strength = -e.gravitational_parameter / (distance * distance * distance);
                let across = strength * (1.0 + harmonic * (1.0 - 5.0 * sine * sine));
                let along = strength * (1.0 + harmonic * (3.0 - 5.0 * sine * sine));
                [position[0] * across, position[1] * across, position[2] * along]
            }
        }
    }

    /// Potential of [`gravitation`](Self::gravitation), m^2/s^2: kinetic energy per mass plus this is constant in free
    /// flight. Zero at infinite distance, or at the ground of a plane.
    #[inline]
    pub fn potential(&self, position: Vector) -> f64 {
        match *self {
            Self::Flat { gravity } => -gravity * position[2],
            Self::Ellipsoid(e) => {
                let distance = norm(position);
                let sine = position[2] / distance;
                let ratio = e.equatorial_radius / distance;
                -e.gravitational_parameter / distance * (1.0 - 0.5 * e.j2 * ratio * ratio * (3.0 * sine * sine - 1.0))
            }
        }
    }

    /// Matrix that turns inertial components into earth-fixed ones at a time (s).
    #[inline]
    pub fn earth_from_inertial(&self, time: f64) -> Matrix {
        let (s, c) = sin_cos(self.rotation_rate() * time);
        [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
    }

    /// Earth-fixed position, m, of a place.
    #[inline]
    pub fn position(&self, place: &Geodetic) -> Vector {
        match self {
            Self::Flat { .. } => [0.0, 0.0, -place.altitude],
            Self::Ellipsoid(e) => {
                let (sin_latitude, cos_latitude) = sin_cos(place.latitude);
                let (sin_longitude, cos_longitude) = sin_cos(place.longitude);
                let eccentricity2 = e.flattening * (2.0 - e.flattening);
                let normal = e.equatorial_radius / sqrt(1.0 - eccentricity2 * sin_latitude * sin_latitude);
                let radius = (normal + place.altitude) * cos_latitude;
                let z = (normal * (1.0 - eccentricity2) + place.altitude) * sin_latitude;
                [radius * cos_longitude, radius * sin_longitude, z]
            }
        }
    }

    /// Latitude, longitude (-pi to pi) and altitude of an earth-fixed position (m). On the axis the longitude is zero.
    ///
    /// Bowring's iteration for the reduced latitude (B. R. Bowring, Survey Review 23 (1976) 323), carried to the last
    /// digit; meant for altitudes from -1000 km upwards.
    pub fn geodetic(&self, position: Vector) -> Geodetic {
        let e = match self {
            Self::Flat { .. } => return Geodetic { altitude: -position[2], ..Geodetic::default() },
            Self::Ellipsoid(e) => e,
        };
        let [x, y, z] = position;
        let longitude = if x == 0.0 && y == 0.0 { 0.0 } else { atan2(y, x) };
        let radius = sqrt(x * x + y * y);
        if e.flattening == 0.0 {
            let distance = norm(position);
            return Geodetic { latitude: atan2(z, radius), longitude, altitude: distance - e.equatorial_radius };
        }
        let eccentricity2 = e.flattening * (2.0 - e.flattening);
        let ratio = 1.0 - e.flattening;
        let polar_radius = e.equatorial_radius * ratio;
        let second_eccentricity2 = eccentricity2 / (ratio * ratio);
        // Direction of the reduced latitude, not the angle: exact at the equator and the poles alike.
        let (mut s, mut c) = (z, radius * ratio);
        let (mut sin_latitude, mut cos_latitude) = (0.0, 1.0);
        for _ in 0..4 {
            let length = sqrt(s * s + c * c);
            (s, c) = (s / length, c / length);
            let up = z + second_eccentricity2 * polar_radius * s * s * s;
            let out = radius - eccentricity2 * e.equatorial_radius * c * c * c;
            let length = sqrt(up * up + out * out);
            (sin_latitude, cos_latitude) = (up / length, out / length);
            (s, c) = (sin_latitude * ratio, cos_latitude);
        }
        let altitude = radius * cos_latitude + z * sin_latitude
            - e.equatorial_radius * sqrt(1.0 - eccentricity2 * sin_latitude * sin_latitude);
        Geodetic { latitude: atan2(sin_latitude, cos_latitude), longitude, altitude }
    }

    /// Matrix that turns earth-fixed components into those along local north, east and down at a place.
    #[inline]
    pub fn ned_from_earth(&self, place: &Geodetic) -> Matrix {
        match self {
            Self::Flat { .. } => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Self::Ellipsoid(_) => {
                let (sl, cl) = sin_cos(place.latitude);
                let (so, co) = sin_cos(place.longitude);
                [[-sl * co, -sl * so, cl], [-so, co, 0.0], [-cl * co, -cl * so, -sl]]
            }
        }
    }

    /// Radii of curvature, m, of the surface at a latitude (rad): along the meridian, and across it. Infinite for a plane.
    ///
    /// A step of `dlat` rad in latitude is `(first + altitude) dlat` long, one of `dlon` in longitude
    /// `(second + altitude) cos(latitude) dlon` (Stevens, Lewis and Johnson 1.6-5 and 1.6-13).
    #[inline]
    pub fn curvature_radii(&self, latitude: f64) -> [f64; 2] {
        let e = match self {
            Self::Flat { .. } => return [f64::INFINITY; 2],
            Self::Ellipsoid(e) => e,
        };
        let (sin_latitude, _) = sin_cos(latitude);
        let eccentricity2 = e.flattening * (2.0 - e.flattening);
        let w2 = 1.0 - eccentricity2 * sin_latitude * sin_latitude;
        let normal = e.equatorial_radius / sqrt(w2);
        [normal * (1.0 - eccentricity2) / w2, normal]
    }

    /// Rotation of the local north-east-down axes relative to the inertial frame, rad/s, components along north, east
    /// and down, for something at `place` that moves with `velocity` (north, east and down, m/s) relative to the ground.
    ///
    /// Rotation of the planet plus transport rate (Stevens, Lewis and Johnson 1.6-24 and 1.6-25). Not finite at the
    /// poles, where north turns infinitely fast, unless the velocity there has no eastward part.
    #[inline]
    pub fn ned_rotation(&self, place: &Geodetic, velocity: Vector) -> Vector {
        let e = match self {
            Self::Flat { .. } => return [0.0; 3],
            Self::Ellipsoid(e) => e,
        };
        let (sin_latitude, cos_latitude) = sin_cos(place.latitude);
        let [meridian, normal] = self.curvature_radii(place.latitude);
        let east = velocity[1] / (normal + place.altitude);
        let turning = if east == 0.0 { 0.0 } else { -east * sin_latitude / cos_latitude };
        add(
            scale([cos_latitude, 0.0, -sin_latitude], e.rotation_rate),
            [east, -velocity[0] / (meridian + place.altitude), turning],
        )
    }
}
