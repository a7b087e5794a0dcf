//! U.S. Standard Atmosphere 1976 up to 86 km.
//!
//! NOAA, NASA and USAF, U.S. Standard Atmosphere 1976, NASA-TM-X-74335. Temperature is linear in the geopotential altitude
//! within layers, and the pressure follows from hydrostatic equilibrium.

use crate::atmosphere::Air;
use crate::scalar::Scalar;

/// Radius of the Earth that the standard uses to make geopotential altitude of geometric, m.
const EARTH_RADIUS: f64 = 6_356_766.0;
/// Gas constant of air at sea level, J/(kg K).
const GAS: f64 = 8314.32 / 28.9644;
/// Standard gravity, m/s^2.
const GRAVITY: f64 = 9.806_65;
/// Ratio of specific heats.
const HEAT_RATIO: f64 = 1.4;

/// Layers: geopotential altitude of the lower edge (m), molecular-scale temperature there (K), its gradient (K/m) and the
/// pressure (Pa), which hydrostatic equilibrium carries from sea level upwards (checked by a test).
const LAYERS: [[f64; 4]; 7] = [
    [0.0, 288.15, -0.0065, 101_325.0],
    [11_000.0, 216.65, 0.0, 22_632.063_973_462_926],
    [20_000.0, 216.65, 0.001, 5_474.888_669_677_777],
    [32_000.0, 228.65, 0.0028, 868.018_684_755_228],
    [47_000.0, 270.65, 0.0, 110.906_305_554_965_92],
    [51_000.0, 270.65, -0.0028, 66.938_873_118_687_4],
    [71_000.0, 214.65, -0.002, 3.956_420_428_040_73],
];

/// Geopotential altitude, m, of the lower edge of the layer in which the temperature rises.
pub(crate) const STRATOSPHERE: f64 = LAYERS[2][0];

/// Geopotential altitude of 86 km, m.
pub(crate) const TOP: f64 = 84_852.045_844_905_75;

/// Molecular mass over that at sea level from 80 to 86 km in steps of 0.5 km (table 8 of the standard).
const MOLECULAR_MASS: [f64; 13] = [
    1.000_000, 0.999_996, 0.999_989, 0.999_971, 0.999_941, 0.999_909, 0.999_870, 0.999_829, 0.999_786, 0.999_741,
    0.999_694, 0.999_641, 0.999_579,
];

/// Geopotential altitude, m, of a geometric altitude, m: the height at which a field of standard gravity has the same
/// potential (equation 18 of the standard).
///
/// ```
/// use phugoid_flight_dynamics::standard_atmosphere::geopotential_altitude;
/// assert!((geopotential_altitude(86_000.0) - 84_852.0).abs() < 0.1);
/// ```
#[inline]
pub fn geopotential_altitude<T: Scalar>(altitude: T) -> T {
    altitude * EARTH_RADIUS / (altitude + EARTH_RADIUS)
}

/// The air at a geometric altitude above sea level, m (positive up).
///
/// The lowest layer is continued below sea level. Above 86 km, where the standard describes a mixture out of
/// equilibrium, the temperature is held and the pressure falls exponentially: an extension for vehicles that leave the
/// air, no part of the standard. NaN gives NaN.
///
/// ```
/// use phugoid_flight_dynamics::standard_atmosphere::standard_atmosphere;
/// let air = standard_atmosphere(30_000.0 * 0.3048);
/// assert!((air.pressure - 30_148.7).abs() < 10.0 && (air.temperature - 228.8).abs() < 0.05);
/// ```
#[inline]
pub fn standard_atmosphere<T: Scalar>(altitude: T) -> Air<T> {
    layers(geopotential_altitude(altitude), altitude.real())
}

/// As [`standard_atmosphere`], at a geopotential altitude in m.
#[inline]
pub(crate) fn at_geopotential_altitude<T: Scalar>(height: T) -> Air<T> {
    let real = height.real();
    layers(height, real * EARTH_RADIUS / (EARTH_RADIUS - real))
}

/// The air at a geopotential altitude, m. The geometric one, m, decides on the molecular mass.
#[inline]
fn layers<T: Scalar>(height: T, geometric: f64) -> Air<T> {
    let real = height.real();
    if real > TOP {
        let [base, temperature, gradient, pressure] = LAYERS[6];
        let top = temperature + gradient * (TOP - base);
        let pressure = pressure * Scalar::powf(top / temperature, -GRAVITY / (GAS * gradient));
        let decay = ((height - TOP) * (-GRAVITY / (GAS * top))).exp();
        return air(T::from(top), decay * pressure, 0.999_579);
    }
    let mut layer = &LAYERS[0];
    for candidate in &LAYERS[1..] {
        if real >= candidate[0] {
            layer = candidate;
        }
    }
    let &[base, base_temperature, gradient, base_pressure] = layer;
    let above = height - base;
    let temperature = above * gradient + base_temperature;
    let pressure = if gradient == 0.0 {
        (above * (-GRAVITY / (GAS * base_temperature))).exp() * base_pressure
    } else {
        (temperature / base_temperature).powf(-GRAVITY / (GAS * gradient)) * base_pressure
    };
    air(temperature, pressure, molecular_mass(geometric))
}

/// Molecular mass over that at sea level, linear between the entries of table 8.
fn molecular_mass(altitude: f64) -> f64 {
    let place = (altitude - 80_000.0) / 500.0;
    if place <= 0.0 || place.is_nan() {
        return 1.0;
    }
    let low = (place as usize).min(MOLECULAR_MASS.len() - 2);
    let share = (place - low as f64).min(1.0);
    MOLECULAR_MASS[low] + share * (MOLECULAR_MASS[low + 1] - MOLECULAR_MASS[low])
}

/// Density and speed of sound belong to the molecular-scale temperature; the kinetic temperature is lower by the ratio of
/// the molecular masses.
#[inline]
fn air<T: Scalar>(molecular_temperature: T, pressure: T, mass: f64) -> Air<T> {
    Air {
        density: pressure / (molecular_temperature * GAS),
        temperature: molecular_temperature * mass,
        pressure,
        speed_of_sound: (molecular_temperature * (HEAT_RATIO * GAS)).sqrt(),
    }
}

/// Dynamic viscosity of air, Pa s, at a temperature in K: Sutherland's law with the constants of the standard (equation
/// 51), meant up to 86 km. A negative temperature gives NaN.
#[inline]
pub fn viscosity<T: Scalar>(temperature: T) -> T {
    temperature * temperature.sqrt() * 1.458e-6 / (temperature + 110.4)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// U.S. Standard Atmosphere 1976, table I: geometric altitude (m), temperature (K), pressure (Pa), density (kg/m^3),
    /// speed of sound (m/s; 0 where not used), viscosity (Pa s; 0 where not used). A few rows by hand; a test of
    /// `phugoid-aircraft` compares temperature, pressure and density with the whole table as NASA typed it.
    const TABLE: [[f64; 6]; 10] = [
        [-1_000.0, 294.651, 1.1393e5, 1.3470, 344.11, 1.8206e-5],
        [0.0, 288.150, 1.01325e5, 1.2250, 340.29, 1.7894e-5],
        [5_000.0, 255.676, 5.4048e4, 0.736_43, 320.55, 1.6282e-5],
        [10_000.0, 223.252, 2.6499e4, 0.413_51, 299.53, 1.4577e-5],
        [20_000.0, 216.650, 5.5293e3, 8.8910e-2, 295.07, 1.4216e-5],
        [30_000.0, 226.509, 1.1970e3, 1.8410e-2, 301.71, 1.4753e-5],
        [50_000.0, 270.650, 7.9779e1, 1.0269e-3, 329.80, 1.7037e-5],
        [60_000.0, 247.021, 2.1958e1, 3.0968e-4, 315.07, 1.5837e-5],
        [80_000.0, 198.639, 1.0525, 1.8458e-5, 282.54, 1.3208e-5],
        [86_000.0, 186.87, 3.7338e-1, 6.958e-6, 0.0, 0.0],
    ];

    #[test]
    fn matches_the_published_table() {
        for [altitude, temperature, pressure, density, sound, thickness] in TABLE {
            let air = standard_atmosphere(altitude);
            assert!(
                (air.temperature - temperature).abs() < 1.5e-3 * (1.0 + 4.0 * f64::from(sound == 0.0)),
                "{altitude} T {}",
                air.temperature
            );
            // Half a unit of the last printed digit.
            assert!((air.pressure / pressure - 1.0).abs() < 6e-5, "{altitude} p {}", air.pressure);
            assert!((air.density / density - 1.0).abs() < 6e-5, "{altitude} rho {}", air.density);
            if sound > 0.0 {
                assert!((air.speed_of_sound - sound).abs() < 6e-3, "{altitude} a {}", air.speed_of_sound);
                let viscosity = viscosity(air.temperature);
                assert!((viscosity / thickness - 1.0).abs() < 5e-5, "{altitude} mu {viscosity}");
            }
        }
    }

    #[test]
    fn layers_join() {
        for pair in LAYERS.windows(2) {
            let [base, temperature, gradient, pressure] = pair[0];
            let rise = pair[1][0] - base;
            let top = temperature + gradient * rise;
            assert!((top - pair[1][1]).abs() < 1e-9);
            let above = if gradient == 0.0 {
                pressure * (-GRAVITY * rise / (GAS * temperature)).exp()
            } else {
                pressure * (top / temperature).powf(-GRAVITY / (GAS * gradient))
            };
            assert!((above / pair[1][3] - 1.0).abs() < 1e-12, "{above:e} {:e}", pair[1][3]);
        }
        assert!((geopotential_altitude(86_000.0) - TOP).abs() < 1e-6, "{}", geopotential_altitude(86_000.0));
        let (below, above) = (standard_atmosphere(85_999.999), standard_atmosphere(86_000.001));
        assert!(
            (below.density / above.density - 1.0).abs() < 1e-6 && (below.temperature - above.temperature).abs() < 1e-4
        );
    }
}
