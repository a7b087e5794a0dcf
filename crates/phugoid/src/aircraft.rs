//! Steady flight and linear models of an aircraft.

use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::linearize::{self as library, LinearModel, SubModel};
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::trim::{self as trimming, Trim, TrimCondition};

use crate::Error;

/// Finds the controls and the attitude that hold an aircraft in steady flight: straight, climbing or turning.
///
/// Angles are in rad, the elevator positive with its trailing edge down, the throttle from 0 to 1.
///
/// ```
/// use phugoid::{F16, F16Options, TrimCondition, trim};
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// // 152.4 m/s at sea level, neither climbing nor turning.
/// let level = trim(&aircraft, &TrimCondition::steady(&aircraft, 152.4, 0.0, 0.0, 0.0))?;
/// assert!(level.alpha_rad.to_degrees() > 2.0 && level.alpha_rad.to_degrees() < 3.0);
/// assert!((level.load_factor - 1.0).abs() < 0.01);
/// // 200 m/s at 1000 m, turning to the right by 0.1 rad/s: banked with the right wing down.
/// let turn = trim(&aircraft, &TrimCondition::steady(&aircraft, 200.0, 1000.0, 0.0, 0.1))?;
/// assert!(turn.phi_rad > 1.0);
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Trim`]: the condition is impossible, with what would have been needed (more thrust, a surface beyond its stop).
pub fn trim<A: Aircraft>(aircraft: &A, condition: &TrimCondition) -> Result<Trim, Error> {
    Ok(trimming::trim(aircraft, condition)?)
}

/// The linear model of an aircraft about a steady flight, `x' = A x + B u`, and its two planes of motion with their
/// modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// All states, inputs and outputs, with their names. Units: SI and radians, power in percent, throttle from 0 to 1.
    pub model: LinearModel,
    /// Speed, angle of attack, pitch angle and pitch rate: short period and phugoid.
    pub longitudinal: SubModel,
    /// Sideslip, bank angle, roll rate and yaw rate: Dutch roll, roll and spiral modes. An aircraft that
    /// nothing rolls or yaws has zeros there and no modes.
    pub lateral: SubModel,
}

/// The linear model of an aircraft about a steady flight in still air, with exact derivatives.
///
/// ```
/// use phugoid::{F16, F16Options, TrimCondition, linearize, trim};
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let level = trim(&aircraft, &TrimCondition::steady(&aircraft, 152.4, 0.0, 0.0, 0.0))?;
/// let linear = linearize(&aircraft, &level)?;
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
