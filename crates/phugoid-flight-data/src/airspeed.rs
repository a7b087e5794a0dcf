//! True airspeed from equivalent airspeed and the density of the air.
//!
//! An autopilot's airspeed is `sqrt(2 qc / rho0)` of the impact pressure `qc` and the density of the standard
//! atmosphere at sea level (PX4 `calc_IAS`, ArduPilot `AP_Airspeed`), whether it is corrected for the position of the
//! probe or not. Apart from the compressibility of the air this is an equivalent airspeed. True airspeed follows with
//! the density of the air (Gracey, Measurement of Aircraft Speed and Altitude, NASA RP-1046, 1980, chapter III; PX4
//! `calc_TAS_from_CAS`):
//!
//! ```text
//! V = V_e sqrt(rho0 / rho)        rho = p / (R T)
//! ```
//!
//! This neglects compressibility: `qc/p = (1 + 0.2 M^2)^3.5 - 1 = 0.7 M^2 (1 + M^2/4 + ...)`, so that `V` comes out too
//! large by `M^2/8` of its value: 0.1 % at 30 m/s, 0.5 % at 70 m/s, 1.1 % at Mach 0.3. Moist air is lighter by at most
//! 1.8 % at 30 degC and 100 % humidity, which makes `V` 0.9 % too small.

/// Density of the standard atmosphere at sea level (ISO 2533), kg/m^3.
pub const SEA_LEVEL_DENSITY: f64 = 1.225;
/// Gas constant of dry air (ISO 2533), J/(kg K).
const GAS_CONSTANT: f64 = 287.052_87;

/// Density of dry air, kg/m^3, from static pressure, Pa, and static temperature, K. NaN if one of them is NaN or not
/// positive.
///
/// ```
/// use phugoid_flight_data::airspeed::{SEA_LEVEL_DENSITY, density};
/// // The standard atmosphere at sea level (ISO 2533).
/// assert!((density(101_325.0, 288.15) - SEA_LEVEL_DENSITY).abs() < 1e-4);
/// assert!(density(0.0, 288.15).is_nan());
/// ```
pub fn density(static_pressure: f64, temperature: f64) -> f64 {
    match static_pressure > 0.0 && temperature > 0.0 {
        true => static_pressure / (GAS_CONSTANT * temperature),
        false => f64::NAN,
    }
}

/// Ratio of true to equivalent airspeed, `sqrt(rho0 / rho)`, in air of this density, kg/m^3. NaN if the density is NaN
/// or not positive.
///
/// ```
/// use phugoid_flight_data::airspeed::{density, true_over_equivalent};
/// // The standard atmosphere at 2000 m (ISO 2533): 79 495 Pa, 275.15 K, 1.0065 kg/m^3.
/// let rho = density(79_495.0, 275.15);
/// assert!((rho - 1.0065).abs() < 1e-4);
/// assert!((50.0 * true_over_equivalent(rho) - 55.16).abs() < 0.01);
/// assert!(true_over_equivalent(f64::NAN).is_nan());
/// ```
pub fn true_over_equivalent(density: f64) -> f64 {
    match density > 0.0 {
        true => (SEA_LEVEL_DENSITY / density).sqrt(),
        false => f64::NAN,
    }
}
