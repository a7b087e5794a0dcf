//! Gravity at the place of a record, and how well it is known.

use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;

/// What is known beforehand of the acceleration that kinematics over a resting, flat Earth have to assume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gravity {
    /// m/s^2, positive.
    pub(super) value: f64,
    /// One sigma, m/s^2.
    pub(super) std: f64,
}

/// Rate at which the Earth turns, rad/s.
const EARTH_RATE: f64 = 7.292e-5;
/// The fall of gravity with altitude near the ground, 1/s^2.
const FREE_AIR: f64 = 3.086e-6;

impl Gravity {
    /// For a record that flies at `speed`, m/s. With `given` this is the value, and exact.
    ///
    /// Gravity grows by 0.5 % from the equator to the poles (the formula of WGS 84), and falls by 0.03 % for each
    /// kilometre. An aircraft that flies east over the turning Earth is lighter by `2 Omega V cos(latitude)`: whither it
    /// flies is not asked, so that this stays a part of the sigma, over all latitudes and headings `0.55 * 2 Omega V`.
    pub(super) fn of(record: &Record, speed: f64, given: Option<f64>) -> Self {
        if let Some(value) = given {
            return Self { value, std: 0.0 };
        }
        let middle = |name: &str| {
            let mut values: Vec<f64> = record.channel(name)?.values.iter().copied().filter(|v| v.is_finite()).collect();
            median(&mut values)
        };
        let altitude = middle("altitude").filter(|h| (-500.0..30_000.0).contains(h)).unwrap_or(0.0);
        let (at_sea, latitude_std): (f64, f64) = match middle("latitude") {
            Some(latitude) if latitude.abs() <= std::f64::consts::FRAC_PI_2 => {
                let sin2 = latitude.sin().powi(2);
                (9.780_325_336 * (1.0 + 0.001_931_852_65 * sin2) / (1.0 - 0.006_694_38 * sin2).sqrt(), 5e-4)
            }
            // All latitudes alike: from 9.780 to 9.832 m/s^2.
            _ => (9.80665, 0.015),
        };
        let turning = 0.55 * 2.0 * EARTH_RATE * speed;
        Self { value: at_sea - FREE_AIR * altitude, std: latitude_std.hypot(turning) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_data::record::{Channel, Quantity};

    #[test]
    fn gravity_follows_latitude_and_altitude() {
        let mut record = Record { time: vec![0.0; 3], ..Record::default() };
        let mut add = |name: &str, quantity, value: f64| {
            record.channels.push(Channel { name: name.to_owned(), quantity, values: vec![value; 3] });
        };
        add("altitude", Quantity::Length, 3000.0);
        let blind = Gravity::of(&record, 100.0, None);
        assert!((blind.value - (9.80665 - 0.00926)).abs() < 1e-4 && blind.std > 0.015, "{blind:?}");
        let mut add = |name: &str, quantity, value: f64| {
            record.channels.push(Channel { name: name.to_owned(), quantity, values: vec![value; 3] });
        };
        add("latitude", Quantity::Angle, 52.0_f64.to_radians());
        // 9.8126 at the ground in 52 degrees north (normal gravity of WGS 84).
        let known = Gravity::of(&record, 100.0, None);
        assert!((known.value - (9.8126 - 0.00926)).abs() < 2e-4 && known.std < 0.01, "{known:?}");
        assert_eq!(Gravity::of(&record, 100.0, Some(9.7)), Gravity { value: 9.7, std: 0.0 });
    }
}
