//! Steady flight and linear models of an aircraft.

use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::linearize::{self as library, LinearModel, SubModel};
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::trim::{self as trimming, Trim, TrimCondition};

use crate::Error;
use crate::studies::F16_ALPHA_RANGE_DEG;

/// Finds the controls and the attitude that hold an aircraft in steady flight: straight, climbing or turning.
///
/// Angles are in rad, the elevator positive with its trailing edge down, the throttle from 0 to 1.
///
/// ```
/// use phugoid::{F16, F16Options, f16_level, trim};
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let level = trim(&aircraft, &f16_level(152.4, 0.0))?; // 152.4 m/s at sea level
/// assert!(level.alpha_rad.to_degrees() > 2.0 && level.alpha_rad.to_degrees() < 3.0);
/// assert!((level.load_factor - 1.0).abs() < 0.01);
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Trim`]: the condition is impossible, with what would have been needed (more thrust, a surface beyond its stop).
pub fn trim<A: Aircraft>(aircraft: &A, condition: &TrimCondition) -> Result<Trim, Error> {
    Ok(trimming::trim(aircraft, condition)?)
}

/// Straight and level flight of the F-16 at a true airspeed (m/s) and an altitude above sea level (m), with the angles of attack
/// that its tables cover. For a climb or a turn, set the other fields of the [`TrimCondition`].
///
/// ```
/// use phugoid::{F16, F16Options, TrimCondition, f16_level, trim};
/// let aircraft = F16::new(F16Options::default())?;
/// let turn = TrimCondition { turn_rate: 0.1, ..f16_level(200.0, 1000.0) }; // rad/s, to the right
/// assert!(trim(&aircraft, &turn)?.phi_rad > 1.0); // rad, right wing down
/// # Ok::<(), phugoid::Error>(())
/// ```
pub fn f16_level(speed_m_s: f64, altitude_m: f64) -> TrimCondition {
    TrimCondition {
        alpha_range: F16_ALPHA_RANGE_DEG.map(f64::to_radians),
        ..TrimCondition::level(speed_m_s, altitude_m)
    }
}

/// The linear model of an aircraft about a steady flight, `x' = A x + B u`, and its two planes of motion with their modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// All states, inputs and outputs, with their names. Units: SI and radians, power in percent, throttle from 0 to 1.
    pub model: LinearModel,
    /// Speed, angle of attack, pitch angle and pitch rate: short period and phugoid.
    pub longitudinal: SubModel,
    /// Sideslip, bank angle, roll rate and yaw rate: Dutch roll, roll and spiral modes.
    pub lateral: SubModel,
}

/// The linear model of an aircraft about a steady flight in still air, with exact derivatives.
///
/// ```
/// use phugoid::{F16, F16Options, f16_level, linearize, trim};
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let linear = linearize(&aircraft, &trim(&aircraft, &f16_level(152.4, 0.0))?)?;
/// let names: Vec<String> = linear.longitudinal.modes.iter().map(|mode| mode.name.to_string()).collect();
/// assert!(names.contains(&"short period".to_owned()) && names.contains(&"phugoid".to_owned()), "{names:?}");
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Modes`] if a matrix has no eigenvalues to give.
pub fn linearize<A: Aircraft>(aircraft: &A, trim: &Trim) -> Result<Linearization, Error> {
    let model = library::linearize(aircraft, &trim.state(), &trim.controls(), &Disturbance::default());
    let (longitudinal, lateral) = (model.longitudinal()?, model.lateral()?);
    Ok(Linearization { model, longitudinal, lateral })
}
