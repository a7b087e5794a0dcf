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
    /// Scale factors of bank and pitch attitude.
    AttitudeScales,
    /// Scale factors of accelerometers and rate gyroscopes.
    InertialScales,
    /// Delays of airspeed, vanes and attitude against the inertial sensors.
    Delays,
    /// Distance of the vanes ahead of the centre of gravity.
    VanePositions,
    /// Position of the accelerometers ahead of and below the centre of gravity.
    AccelerometerPosition,
    /// Upwash at the vane of the angle of attack, in proportion to lift.
    Upwash,
    /// Constant wind; needs the positions north and east.
    Wind,
}

impl Group {
    /// All groups, in the order in which they are listed.
    pub const ALL: [Self; 9] = [
        Self::Biases,
        Self::AirDataScales,
        Self::AttitudeScales,
        Self::InertialScales,
        Self::Delays,
        Self::VanePositions,
        Self::AccelerometerPosition,
        Self::Upwash,
        Self::Wind,
    ];
}

/// One unknown of the kinematic model, and what is known of it beforehand.
pub(super) struct Spec {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    /// None for what is no error of a sensor.
    pub(super) group: Option<Group>,
    /// One sigma of what is expected of an ordinary installation: this project's choice, wide on purpose. Where the
    /// data do not determine the error, the result keeps this standard deviation.
    pub(super) prior_std: f64,
    /// Channel that the record must have for this unknown to be estimated.
    pub(super) channel: &'static str,
    /// What such an error can be: an estimate outside means that something else is wrong.
    pub(super) possible: [f64; 2],
}

const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

const fn spec(
    name: &'static str,
    unit: &'static str,
    group: Group,
    prior_std: f64,
    channel: &'static str,
    possible: [f64; 2],
) -> Spec {
    Spec { name, unit, group: Some(group), prior_std, channel, possible }
}

const fn bias(name: &'static str, unit: &'static str, prior_std: f64, channel: &'static str) -> Spec {
    // Ten times what is expected: half of gravity, 5 deg/s or 20 deg of a vane is a wrong sign, unit or alignment.
    let most = 10.0 * prior_std;
    spec(name, unit, Group::Biases, prior_std, channel, [-most, most])
}

const fn scale(name: &'static str, group: Group, prior_std: f64, channel: &'static str) -> Spec {
    let possible = match group {
        // A vane beside a fuselage or under a wing shows up to half as much again.
        Group::AirDataScales => [-0.5, 0.5],
        _ => [-0.15, 0.15],
    };
    spec(name, "-", group, prior_std, channel, possible)
}

const fn delay(name: &'static str, channel: &'static str) -> Spec {
    // A channel cannot be ahead of the inertial sensors by more than these are late themselves; half a second is what
    // the slowest pneumatic line takes.
    spec(name, "s", Group::Delays, 0.1, channel, [-0.05, 0.5])
}

const fn position(name: &'static str, group: Group, prior_std: f64, channel: &'static str) -> Spec {
    spec(name, "m", group, prior_std, channel, FREE)
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// In the order of the model's parameters.
pub(super) const UNKNOWNS: [Spec; super::kinematics::PARAMETERS] = [
    bias("bias_ax", "m/s^2", 0.5, "ax"),
    bias("bias_ay", "m/s^2", 0.5, "ay"),
    bias("bias_az", "m/s^2", 0.5, "az"),
    bias("bias_p", "rad/s", 0.5 * DEGREE, "p"),
    bias("bias_q", "rad/s", 0.5 * DEGREE, "q"),
    bias("bias_r", "rad/s", 0.5 * DEGREE, "r"),
    scale("scale_ax", Group::InertialScales, 0.03, "ax"),
    scale("scale_ay", Group::InertialScales, 0.03, "ay"),
    scale("scale_az", Group::InertialScales, 0.03, "az"),
    scale("scale_p", Group::InertialScales, 0.03, "p"),
    scale("scale_q", Group::InertialScales, 0.03, "q"),
    scale("scale_r", Group::InertialScales, 0.03, "r"),
    bias("bias_true_airspeed", "m/s", 3.0, "true_airspeed"),
    // The best and the worst of static ports and probes are 15 % apart from the truth at the most.
    spec("scale_true_airspeed", "-", Group::AirDataScales, 0.05, "true_airspeed", [-0.15, 0.15]),
    bias("bias_alpha", "rad", 2.0 * DEGREE, "alpha"),
    scale("scale_alpha", Group::AirDataScales, 0.2, "alpha"),
    bias("bias_beta", "rad", 2.0 * DEGREE, "beta"),
    scale("scale_beta", Group::AirDataScales, 0.2, "beta"),
    bias("bias_phi", "rad", DEGREE, "phi"),
    bias("bias_theta", "rad", DEGREE, "theta"),
    // A heading by the magnetic north is off by the declination.
    spec("bias_psi", "rad", Group::Biases, DEGREE, "psi", FREE),
    delay("delay_true_airspeed", "true_airspeed"),
    delay("delay_alpha", "alpha"),
    delay("delay_beta", "beta"),
    delay("delay_attitude", "theta"),
    position("vane_alpha_x", Group::VanePositions, 5.0, "alpha"),
    position("vane_beta_x", Group::VanePositions, 5.0, "beta"),
    position("accelerometer_x", Group::AccelerometerPosition, 2.0, "az"),
    position("accelerometer_z", Group::AccelerometerPosition, 1.0, "ax"),
    spec("wind_north", "m/s", Group::Wind, 15.0, "north", FREE),
    spec("wind_east", "m/s", Group::Wind, 15.0, "east", FREE),
    spec("wind_down", "m/s", Group::Wind, 3.0, "altitude", FREE),
    scale("scale_phi", Group::AttitudeScales, 0.05, "phi"),
    scale("scale_theta", Group::AttitudeScales, 0.05, "theta"),
    // Half a degree at the lift of level flight at 50 m/s is 2 m.
    position("upwash_alpha", Group::Upwash, 5.0, "alpha"),
    // The prior belongs to each record, see `gravity`.
    Spec { name: "gravity", unit: "m/s^2", group: None, prior_std: 0.02, channel: "az", possible: FREE },
    // A gust of 1 m/s changes the specific force at once, by 0.5 to 3 m/s^2 along z.
    Spec { name: "gust_by_ax", unit: "s", group: None, prior_std: 0.5, channel: "ax", possible: FREE },
    Spec { name: "gust_by_ay", unit: "s", group: None, prior_std: 0.5, channel: "ay", possible: FREE },
    Spec { name: "gust_by_az", unit: "s", group: None, prior_std: 0.5, channel: "az", possible: FREE },
];
