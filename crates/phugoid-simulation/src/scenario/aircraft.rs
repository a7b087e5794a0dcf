//! The aircraft of a scenario and where its flight starts.

use phugoid_flight_dynamics::built_in::AircraftName;
use phugoid_flight_dynamics::f16::F16Tables;
use serde::Deserialize;

use crate::quantity::{Angle, AngularRate, Length, Speed};

/// The aircraft of a scenario.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AircraftSettings {
    /// The built-in aircraft that flies, for instance the F-16.
    #[serde(rename = "type")]
    pub kind: AircraftName,
    /// The set of aerodynamic tables that is used for the F-16: `book` or `morelli`.
    #[serde(default)]
    pub tables: F16Tables,
    /// Centre of gravity, fraction of the mean aerodynamic chord.
    #[serde(default = "reference_cg")]
    pub cg: f64,
    /// Whether surfaces follow their commands through actuators (lag, rate and position limits) or at once.
    #[serde(default)]
    pub actuators: bool,
    /// Whether thrust stays as trimmed, or comes from the engine at fixed throttle.
    #[serde(default)]
    pub thrust: Thrust,
}

fn reference_cg() -> f64 {
    0.35
}

/// What thrust does after the trim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Thrust {
    /// Thrust keeps the value that it has in the trim, whatever the aircraft does afterwards.
    #[default]
    Constant,
    /// The engine at the trim throttle: thrust follows Mach number and altitude.
    Engine,
}

/// The steady condition in which the flight starts; the aircraft is trimmed there.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Altitude above mean sea level, in the standard atmosphere.
    pub altitude: Length,
    /// True airspeed at the start of the flight.
    pub speed: Speed,
    /// Angle of climb, positive up.
    #[serde(default)]
    pub flight_path: Angle,
    /// Rate of turn about the vertical, positive to the right.
    #[serde(default)]
    pub turn_rate: AngularRate,
}

/// How the aircraft that flies differs from what is known of it, beside the increments to be found. The default is no error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(non_snake_case)] // the field's own spelling, which scenario files use as well
pub struct ModelError {
    /// Factors on the aircraft's coefficients (body axes, about the centre of gravity).
    pub tables: TableFactors,
    /// Pitching moment with the square of the angle of attack from trim, per rad^2: a term that no model has.
    pub Cm_alpha_squared: f64,
    /// Recorded thrust less the true one, as a part of it: 0.1 for a record that is 10 % too high. Models that take their
    /// thrust from the trim do not see it.
    pub thrust: f64,
    /// What the record gives as the position of the surfaces.
    pub surfaces: RecordedSurfaces,
}

/// Factors of the true coefficients on those of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(non_snake_case)] // the field's own spelling, which scenario files use as well
pub struct TableFactors {
    /// Factor of the axial force coefficient, body x axis, positive forward; 1 leaves the tables as they are.
    pub CX: f64,
    /// Factor of the side force coefficient, body y axis, positive to the right; 1 leaves the tables as they are.
    pub CY: f64,
    /// Factor of the normal force coefficient, body z axis, positive down; 1 leaves the tables as they are.
    pub CZ: f64,
    /// Factor of the rolling moment coefficient, positive right wing down; 1 leaves the tables as they are.
    pub Cl: f64,
    /// Factor of the pitching moment coefficient, positive nose up; 1 leaves the tables as they are.
    pub Cm: f64,
    /// Factor of the yawing moment coefficient, positive nose right; 1 leaves the tables as they are.
    pub Cn: f64,
}

impl Default for TableFactors {
    fn default() -> Self {
        Self { CX: 1.0, CY: 1.0, CZ: 1.0, Cl: 1.0, Cm: 1.0, Cn: 1.0 }
    }
}

/// What is recorded as the position of a surface that moves through an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RecordedSurfaces {
    /// The true position of the surface, after the actuator, as its sensor measures it.
    #[default]
    Measured,
    /// The commanded position of the surface; an estimator then does not know the lag of the actuator.
    Commanded,
}

impl ModelError {
    pub(super) fn check(&self) -> Result<(), String> {
        let t = &self.tables;
        let factors = [("CX", t.CX), ("CY", t.CY), ("CZ", t.CZ), ("Cl", t.Cl), ("Cm", t.Cm), ("Cn", t.Cn)];
        if let Some((name, value)) = factors.into_iter().find(|(_, f)| !(*f > 0.0 && f.is_finite())) {
            return Err(format!(
                "`model_error.tables.{name}` is {value}: it is a positive factor (1.1 for ten per cent more)"
            ));
        }
        if !self.Cm_alpha_squared.is_finite() {
            return Err(format!("`model_error.Cm_alpha_squared` is {}: per rad^2", self.Cm_alpha_squared));
        }
        if !(self.thrust > -1.0 && self.thrust.is_finite()) {
            return Err(format!(
                "`model_error.thrust` is {}: it is a part of the true thrust (0.1 for ten per cent too high)",
                self.thrust
            ));
        }
        Ok(())
    }
}
