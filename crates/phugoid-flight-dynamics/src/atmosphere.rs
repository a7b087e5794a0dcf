//! Air density, temperature, pressure and speed of sound.

use crate::scalar::Scalar;

/// The model of the air, at rest: which constants, and up to which altitude they hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Atmosphere {
    /// The air-data model of Stevens & Lewis (subroutine ADC, appendix A.6), with its rounded constants in slug-ft-degR:
    /// `tfac = 1 - 0.703e-5 h`, `T = 519 tfac` (390 from 35,000 ft upwards), `rho = 0.002377 tfac^4.14`,
    /// `a = sqrt(1.4 * 1716.3 T)`, `p = 1715 rho T`.
    #[default]
    Book,
    /// U.S. Standard Atmosphere 1976: troposphere to 11 km and the isothermal layer above it, meant to 20 km. Altitude
    /// is taken as geopotential, which is what a flat earth with constant gravity has.
    Standard,
}

/// State of the air at one altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air<T = f64> {
    /// Density of the air, kg/m^3.
    pub density: T,
    /// Static temperature of the air, K.
    pub temperature: T,
    /// Static pressure of the air, Pa.
    pub pressure: T,
    /// Speed of sound in this air, m/s.
    pub speed_of_sound: T,
}

impl Atmosphere {
    /// The air at an altitude above sea level in m (positive up).
    ///
    /// ```
    /// use phugoid_flight_dynamics::atmosphere::Atmosphere;
    ///
    /// let air = Atmosphere::Standard.at(11_000.0);
    /// assert!((air.temperature - 216.65).abs() < 0.01 && (air.density - 0.3639).abs() < 1e-4);
    /// ```
    #[inline]
    pub fn at<T: Scalar>(self, altitude: T) -> Air<T> {
        match self {
            Self::Book => book(altitude),
            Self::Standard => standard(altitude),
        }
    }
}

/// m per ft, exact.
const FOOT: f64 = 0.3048;
/// kg per slug: lbf s^2/ft with the pound-force of 4.4482216152605 N.
const SLUG: f64 = 4.448_221_615_260_5 / FOOT;
/// K per degree Rankine.
const RANKINE: f64 = 5.0 / 9.0;

#[inline]
fn book<T: Scalar>(altitude: T) -> Air<T> {
    const DENSITY_0: f64 = 0.002377 * SLUG / (FOOT * FOOT * FOOT);
    // ft^2/(s^2 degR) to m^2/(s^2 K).
    const GAS: f64 = FOOT * FOOT / RANKINE;
    let factor = altitude * (-0.703e-5 / FOOT) + 1.0;
    let temperature =
        if altitude.real() >= 35_000.0 * FOOT { T::from(390.0 * RANKINE) } else { factor * (519.0 * RANKINE) };
    let density = factor.powf(4.14) * DENSITY_0;
    Air {
        density,
        temperature,
        pressure: density * temperature * (1715.0 * GAS),
        speed_of_sound: (temperature * (1.4 * 1716.3 * GAS)).sqrt(),
    }
}

#[inline]
fn standard<T: Scalar>(altitude: T) -> Air<T> {
    // U.S. Standard Atmosphere 1976, tables 2 and 4.
    const GAS: f64 = 8314.32 / 28.9644;
    const LAPSE: f64 = 0.0065;
    const TEMPERATURE_0: f64 = 288.15;
    const PRESSURE_0: f64 = 101_325.0;
    const TROPOPAUSE: f64 = 11_000.0;
    const TEMPERATURE_11: f64 = TEMPERATURE_0 - LAPSE * TROPOPAUSE;
    const PRESSURE_11: f64 = 22_632.064;
    const G0: f64 = 9.80665;
    let (temperature, pressure) = if altitude.real() < TROPOPAUSE {
        let temperature = altitude * -LAPSE + TEMPERATURE_0;
        (temperature, (temperature / TEMPERATURE_0).powf(G0 / (GAS * LAPSE)) * PRESSURE_0)
    } else {
        let decay = ((altitude - TROPOPAUSE) * (-G0 / (GAS * TEMPERATURE_11))).exp();
        (T::from(TEMPERATURE_11), decay * PRESSURE_11)
    };
    Air {
        density: pressure / (temperature * GAS),
        temperature,
        pressure,
        speed_of_sound: (temperature * (1.4 * GAS)).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    /// U.S. Standard Atmosphere 1976, table I (geopotential metres): T, p, rho, a.
    const TABLE: [(f64, f64, f64, f64, f64); 5] = [
        (0.0, 288.150, 101_325.0, 1.2250, 340.294),
        (5_000.0, 255.650, 54_019.9, 0.736_116, 320.529),
        (10_000.0, 223.150, 26_436.3, 0.412_707, 299.463),
        (11_000.0, 216.650, 22_632.1, 0.363_918, 295.070),
        (20_000.0, 216.650, 5_474.89, 0.088_035, 295.070),
    ];

    #[test]
    fn standard_atmosphere_matches_its_table() {
        for (h, temperature, pressure, density, sound) in TABLE {
            let air = Atmosphere::Standard.at(h);
            assert!((air.temperature - temperature).abs() < 1e-3, "{h} T {}", air.temperature);
            assert!((air.pressure / pressure - 1.0).abs() < 5e-6, "{h} p {}", air.pressure);
            assert!((air.density / density - 1.0).abs() < 1e-5, "{h} rho {}", air.density);
            assert!((air.speed_of_sound - sound).abs() < 1e-3, "{h} a {}", air.speed_of_sound);
        }
    }

    #[test]
    fn book_air_data_in_the_books_units() {
        // 10,000 ft, 500 ft/s worked by hand: tfac = 0.9297, rho = 0.002377 tfac^4.14, T = 482.5143.
        let air = Atmosphere::Book.at(10_000.0 * 0.3048);
        let density = air.density / 515.378_818_393_2;
        assert!((density - 0.002_377 * 0.9297_f64.powf(4.14)).abs() < 1e-12, "{density}");
        let mach = 500.0 / (air.speed_of_sound / 0.3048);
        assert!((mach - 500.0 / (1.4 * 1716.3 * 519.0 * 0.9297_f64).sqrt()).abs() < 1e-12, "{mach}");
        assert!((Atmosphere::Book.at(36_000.0 * 0.3048).temperature - 390.0 / 1.8).abs() < 1e-12);
    }

    #[test]
    fn the_two_atmospheres_agree_to_the_books_rounding() {
        for h in [0.0, 2_000.0, 6_096.0, 10_000.0] {
            let ratio = Atmosphere::Book.at(h).density / Atmosphere::Standard.at(h).density;
            assert!((ratio - 1.0).abs() < 0.01, "{h}: {ratio}");
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        for atmosphere in [Atmosphere::Book, Atmosphere::Standard] {
            for h in [1_000.0, 6_096.0, 13_000.0] {
                let exact = atmosphere.at(Dual::<1>::variable(h, 0)).density.derivatives[0];
                let (up, down) = (atmosphere.at(h + 1.0).density, atmosphere.at(h - 1.0).density);
                assert!((exact - 0.5 * (up - down)).abs() < 1e-11, "{atmosphere:?} {h}");
            }
        }
    }
}
