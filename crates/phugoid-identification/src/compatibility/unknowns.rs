//! The unknowns of the kinematics: names, units, priors, and when they can be asked for.

use serde::{Deserialize, Serialize};

/// Groups of unknowns that are asked for together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// Constant errors of all sensors.
    Biases,
    /// Scale factors of airspeed and vanes.
    AirDataScales,
    /// Scale factors of accelerometers and rate gyroscopes.
    InertialScales,
    /// Delays of airspeed, vanes and attitude against the inertial sensors.
    Delays,
    /// Distance of the vanes ahead of the centre of gravity.
    VanePositions,
    /// Position of the accelerometers ahead of and below the centre of gravity.
    AccelerometerPosition,
    /// Constant wind; needs the positions north and east.
    Wind,
}

impl Group {
    /// All groups, in the order in which they are listed.
    pub const ALL: [Self; 7] = [
        Self::Biases,
        Self::AirDataScales,
        Self::InertialScales,
        Self::Delays,
        Self::VanePositions,
        Self::AccelerometerPosition,
        Self::Wind,
    ];
}

/// One unknown of the kinematic model, and what is known of it beforehand.
pub(super) struct Spec {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) group: Group,
    /// One sigma of what is expected of an ordinary installation: this project's choice, wide on purpose. Where the
    /// data do not determine the error, the result keeps this standard deviation.
    pub(super) prior_std: f64,
    /// Channel that the record must have for this unknown to be estimated.
    pub(super) channel: &'static str,
}

const fn spec(name: &'static str, unit: &'static str, group: Group, prior_std: f64, channel: &'static str) -> Spec {
    Spec { name, unit, group, prior_std, channel }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// In the order of the model's parameters.
pub(super) const UNKNOWNS: [Spec; super::kinematics::PARAMETERS] = [
    spec("bias_ax", "m/s^2", Group::Biases, 0.5, "ax"),
    spec("bias_ay", "m/s^2", Group::Biases, 0.5, "ay"),
    spec("bias_az", "m/s^2", Group::Biases, 0.5, "az"),
    spec("bias_p", "rad/s", Group::Biases, 0.5 * DEGREE, "p"),
    spec("bias_q", "rad/s", Group::Biases, 0.5 * DEGREE, "q"),
    spec("bias_r", "rad/s", Group::Biases, 0.5 * DEGREE, "r"),
    spec("scale_ax", "-", Group::InertialScales, 0.03, "ax"),
    spec("scale_ay", "-", Group::InertialScales, 0.03, "ay"),
    spec("scale_az", "-", Group::InertialScales, 0.03, "az"),
    spec("scale_p", "-", Group::InertialScales, 0.03, "p"),
    spec("scale_q", "-", Group::InertialScales, 0.03, "q"),
    spec("scale_r", "-", Group::InertialScales, 0.03, "r"),
    spec("bias_true_airspeed", "m/s", Group::Biases, 3.0, "true_airspeed"),
    spec("scale_true_airspeed", "-", Group::AirDataScales, 0.05, "true_airspeed"),
    spec("bias_alpha", "rad", Group::Biases, 2.0 * DEGREE, "alpha"),
    spec("scale_alpha", "-", Group::AirDataScales, 0.2, "alpha"),
    spec("bias_beta", "rad", Group::Biases, 2.0 * DEGREE, "beta"),
    spec("scale_beta", "-", Group::AirDataScales, 0.2, "beta"),
    spec("bias_phi", "rad", Group::Biases, DEGREE, "phi"),
    spec("bias_theta", "rad", Group::Biases, DEGREE, "theta"),
    spec("bias_psi", "rad", Group::Biases, DEGREE, "psi"),
    spec("delay_true_airspeed", "s", Group::Delays, 0.1, "true_airspeed"),
    spec("delay_alpha", "s", Group::Delays, 0.1, "alpha"),
    spec("delay_beta", "s", Group::Delays, 0.1, "beta"),
    spec("delay_attitude", "s", Group::Delays, 0.1, "theta"),
    spec("vane_alpha_x", "m", Group::VanePositions, 5.0, "alpha"),
    spec("vane_beta_x", "m", Group::VanePositions, 5.0, "beta"),
    spec("accelerometer_x", "m", Group::AccelerometerPosition, 2.0, "az"),
    spec("accelerometer_z", "m", Group::AccelerometerPosition, 1.0, "ax"),
    spec("wind_north", "m/s", Group::Wind, 15.0, "north"),
    spec("wind_east", "m/s", Group::Wind, 15.0, "east"),
    spec("wind_down", "m/s", Group::Wind, 3.0, "altitude"),
];
