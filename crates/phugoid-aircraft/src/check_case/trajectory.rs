//! A flight as the check cases write it: a table in US units whose headings carry the units.

use std::fmt::Write;

use phugoid_flight_dynamics::globe::flight::GlobeMotion;
use phugoid_flight_dynamics::globe::vector::norm;

/// m per ft, exact.
pub(super) const FOOT: f64 = 0.3048;
/// N per lbf, exact.
pub(super) const POUND: f64 = 4.448_221_615_260_5;
/// kg per slug.
pub(super) const SLUG: f64 = POUND / FOOT;
/// m/s per knot.
pub(super) const KNOT: f64 = 1852.0 / 3600.0;

/// Headings of the columns, as in the files of the simulators.
pub const COLUMNS: [&str; 37] = [
    "time",
    "eiPosition_ft_X",
    "eiPosition_ft_Y",
    "eiPosition_ft_Z",
    "gePosition_ft_X",
    "gePosition_ft_Y",
    "gePosition_ft_Z",
    "eiVelocity_ft_s_X",
    "eiVelocity_ft_s_Y",
    "eiVelocity_ft_s_Z",
    "feVelocity_ft_s_X",
    "feVelocity_ft_s_Y",
    "feVelocity_ft_s_Z",
    "altitudeMsl_ft",
    "longitude_deg",
    "latitude_deg",
    "localGravity_ft_s2",
    "eulerAngle_deg_Yaw",
    "eulerAngle_deg_Pitch",
    "eulerAngle_deg_Roll",
    "bodyAngularRateWrtEi_deg_s_Roll",
    "bodyAngularRateWrtEi_deg_s_Pitch",
    "bodyAngularRateWrtEi_deg_s_Yaw",
    "altitudeRateWrtMsl_ft_min",
    "speedOfSound_ft_s",
    "airDensity_slug_ft3",
    "ambientPressure_lbf_ft2",
    "ambientTemperature_dgR",
    "aero_bodyForce_lbf_X",
    "aero_bodyForce_lbf_Y",
    "aero_bodyForce_lbf_Z",
    "aero_bodyMoment_ftlbf_L",
    "aero_bodyMoment_ftlbf_M",
    "aero_bodyMoment_ftlbf_N",
    "mach",
    "dynamicPressure_lbf_ft2",
    "trueAirspeed_nmi_h",
];

/// A flight at equal intervals of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// One row per instant, with the columns of [`COLUMNS`]. Positions and velocities `ei` are inertial, `ge` earth-fixed,
    /// `fe` relative to the ground towards north, east and down; rates are inertial, in body axes; aerodynamic moments are
    /// about the centre of gravity; gravity is gravitation without centrifugal acceleration.
    pub rows: Vec<[f64; COLUMNS.len()]>,
}

impl Trajectory {
    /// Adds the row of one instant.
    pub fn push(&mut self, motion: &GlobeMotion) {
        self.rows.push(row(motion));
    }

    /// Puts another instant in place of the first row.
    pub(super) fn replace_first(&mut self, motion: &GlobeMotion) {
        if let Some(first) = self.rows.first_mut() {
            *first = row(motion);
        }
    }

    /// The table as comma-separated text with one line of headings. Numbers read back to the same bits.
    pub fn to_csv(&self) -> String {
        let mut text = COLUMNS.join(",");
        text.push('\n');
        for row in &self.rows {
            for (i, value) in row.iter().enumerate() {
                let separator = if i == 0 { "" } else { "," };
                // Writing to a string does not fail.
                let _ = write!(text, "{separator}{value:?}");
            }
            text.push('\n');
        }
        text
    }

    /// Smallest and largest value of a column; none for an unknown heading or an empty flight.
    pub fn range(&self, heading: &str) -> Option<(f64, f64)> {
        let column = COLUMNS.iter().position(|name| *name == heading)?;
        self.rows.iter().map(|row| row[column]).fold(None, |range, x| match range {
            None => Some((x, x)),
            Some((low, high)) => Some((x.min(low), x.max(high))),
        })
    }
}

/// The numbers of one instant in the units of [`COLUMNS`].
fn row(motion: &GlobeMotion) -> [f64; COLUMNS.len()] {
    let c = &motion.condition;
    let state = &c.state;
    let mut row = [0.0; COLUMNS.len()];
    let mut column = 0;
    let mut put = |values: &[f64], unit: f64| {
        for value in values {
            row[column] = value / unit;
            column += 1;
        }
    };
    let degree = 1.0_f64.to_radians();
    put(&[c.time], 1.0);
    put(&state.position, FOOT);
    put(&c.earth_position, FOOT);
    put(&state.velocity, FOOT);
    put(&c.ground_velocity, FOOT);
    put(&[c.place.altitude], FOOT);
    put(&[c.place.longitude, c.place.latitude], degree);
    put(&[norm(c.gravitation)], FOOT);
    put(&[c.euler.yaw, c.euler.pitch, c.euler.roll], degree);
    put(&state.rates, degree);
    put(&[-c.ground_velocity[2] * 60.0], FOOT);
    put(&[c.atmosphere.speed_of_sound], FOOT);
    put(&[c.atmosphere.density], SLUG / (FOOT * FOOT * FOOT));
    put(&[c.atmosphere.pressure], POUND / (FOOT * FOOT));
    put(&[c.atmosphere.temperature], 5.0 / 9.0);
    put(&motion.loads.aerodynamic_force, POUND);
    put(&motion.loads.aerodynamic_moment, POUND * FOOT);
    put(&[c.air.mach], 1.0);
    put(&[c.air.dynamic_pressure], POUND / (FOOT * FOOT));
    put(&[c.air.speed], KNOT);
    row
}
