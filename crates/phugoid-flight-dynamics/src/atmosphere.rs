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
    /// U.S. Standard Atmosphere 1976 up to its end at 86 km ([`ceiling`](Self::ceiling)). Altitude is taken as geopotential,
    /// which is what a flat earth with constant gravity has. [`standard_atmosphere`](crate::standard_atmosphere) is the same
    /// over geometric altitude.
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
    /// Altitude, m, at which the model ends: 84,852 m of geopotential altitude, which are 86 km, of the standard; 43,357 m of the
    /// book, where its density is zero, while its temperature is meant for some 25 km at most. Above it [`at`](Self::at) gives
    /// numbers that are no part of the model, and NaN for the book; flights and trims refuse.
    pub fn ceiling(self) -> f64 {
        match self {
            Self::Book => FOOT / 0.703e-5,
            Self::Standard => crate::standard_atmosphere::TOP,
        }
    }

    /// The air at an altitude above sea level in m (positive up). NaN gives NaN.
    ///
    /// The standard's pressure at 11 km is rounded to eight digits up to 20 km, so that it falls by 1e-9 of itself there.
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
    if altitude.real() >= crate::standard_atmosphere::STRATOSPHERE {
        return crate::standard_atmosphere::at_geopotential_altitude(altitude);
    }
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
    const TABLE: [(f64, f64, f64, f64, f64); 11] = [
        (0.0, 288.150, 101_325.0, 1.2250, 340.294),
        (5_000.0, 255.650, 54_019.9, 0.736_116, 320.529),
        (10_000.0, 223.150, 26_436.3, 0.412_707, 299.463),
        (11_000.0, 216.650, 22_632.1, 0.363_918, 295.070),
        (20_000.0, 216.650, 5_474.89, 0.088_035, 295.070),
        (32_000.0, 228.650, 868.019, 0.013_225, 303.131),
        (40_000.0, 251.050, 277.521, 3.850_99e-3, 317.633),
        (47_000.0, 270.650, 110.906, 1.427_53e-3, 329.799),
        (51_000.0, 270.650, 66.9389, 8.616_06e-4, 329.799),
        (60_000.0, 245.450, 20.3143, 2.883_21e-4, 314.070),
        (71_000.0, 214.650, 3.956_42, 6.421_10e-5, 293.704),
    ];

    /// Up to 20 km nothing has changed since flights were first recorded: the digits are those of the formula written out.
    #[test]
    fn the_layers_join_at_20_km() {
        let (below, above) = (Atmosphere::Standard.at(20_000.0 - 1e-9), Atmosphere::Standard.at(20_000.0));
        for (low, high) in [
            (below.pressure, above.pressure),
            (below.density, above.density),
            (below.temperature, above.temperature),
            (below.speed_of_sound, above.speed_of_sound),
        ] {
            assert!((low / high - 1.0).abs() < 2e-9, "{low} {high}");
        }
        let scale: f64 = 8314.32 / 28.9644 * 216.65 / 9.80665;
        let decay = (-(19_999.0 - 11_000.0) / scale).exp();
        assert!((Atmosphere::Standard.at(19_999.0).pressure / (22_632.064 * decay) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn ceilings_are_where_the_models_end() {
        let top = Atmosphere::Standard.ceiling();
        let air = Atmosphere::Standard.at(top);
        // Table I at 86 km of geometric altitude.
        assert!((air.temperature - 186.87).abs() < 0.01 && (air.pressure / 0.373_38 - 1.0).abs() < 1e-4, "{air:?}");
        let book = Atmosphere::Book.ceiling();
        assert!(Atmosphere::Book.at(book - 1.0).density > 0.0 && Atmosphere::Book.at(book + 1.0).density.is_nan());
        assert!(Atmosphere::Standard.at(f64::NAN).density.is_nan());
    }

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
            for h in [1_000.0, 6_096.0, 13_000.0, 25_000.0] {
                let exact = atmosphere.at(Dual::<1>::variable(h, 0)).density.derivatives[0];
                let (up, down) = (atmosphere.at(h + 1.0).density, atmosphere.at(h - 1.0).density);
                assert!((exact - 0.5 * (up - down)).abs() < 1e-11, "{atmosphere:?} {h}");
            }
        }
    }
}
