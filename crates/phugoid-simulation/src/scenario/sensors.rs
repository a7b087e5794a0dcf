//! The sensors of a scenario.

use phugoid_flight_dynamics::sensors::SensorSpecification;
use serde::Deserialize;

use crate::quantity::{
    Acceleration, Angle, AngularAcceleration, AngularRate, Frequency, Length, Quantity, Speed, Time,
};

/// One sensor: `quantise(true value one delay ago + bias + noise [+ outlier])`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sensor<Q> {
    /// Standard deviation of white noise.
    pub noise: Q,
    /// Constant error that is added to every value, the same in every flight.
    pub bias: Q,
    /// Standard deviation of a further constant error that is drawn once per flight.
    pub bias_spread: Q,
    /// Error of the scale, a part of the value: 0.02 for a sensor that shows two per cent too much.
    pub scale_error: f64,
    /// Standard deviation of a further error of the scale that is drawn once per flight.
    pub scale_error_spread: f64,
    /// Size of the steps of the digital output.
    pub quantisation: Q,
    /// Age of what is measured: a value at time t is that of the aircraft at t minus this delay.
    pub delay: Time,
    /// Rate of the sensor's own samples; between them there is no value. Every sample has one if it is not given.
    pub rate: Option<Frequency>,
    /// Probability that a value is an outlier.
    pub outliers: f64,
    /// Mean length of a burst of outliers, samples: they come in runs of one sign, as many in all. Independent if not given.
    pub outlier_burst: f64,
    /// Size of an outlier in standard deviations of the noise, either sign.
    pub outlier_size: f64,
    /// Probability that a value is missing.
    pub drops: f64,
}

impl<Q: Quantity> Sensor<Q> {
    /// The sensor with all its numbers in SI, as the simulation takes it.
    pub fn specification(&self) -> SensorSpecification {
        SensorSpecification {
            noise: self.noise.si(),
            bias: self.bias.si(),
            scale_error: self.scale_error,
            sample_interval: self.rate.map_or(0.0, |rate| rate.si().recip()),
            delay: self.delay.si(),
            quantisation: self.quantisation.si(),
            outlier_probability: self.outliers,
            outlier_burst: self.outlier_burst,
            outlier_size: self.outlier_size * self.noise.si(),
            drop_probability: self.drops,
        }
    }
}

/// The sensors of all measured channels. A sensor that the scenario does not name is perfect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sensors {
    /// Probability that a whole frame of air data and inertial sensors is missing. Altitude and surface positions, which
    /// the flight computer has from elsewhere, stay.
    pub drops: f64,
    /// Where the accelerometers are, body axes from the centre of gravity (x forward, y right, z down). They feel the
    /// rotation there.
    pub accelerometers: [Length; 3],
    /// Where the vanes for angle of attack and sideslip are, likewise.
    pub vanes: [Length; 3],
    /// Sensor of the true airspeed: speed of the aircraft through the air.
    pub true_airspeed: Sensor<Speed>,
    /// Sensor of the angle of attack, positive with the air from below.
    pub alpha: Sensor<Angle>,
    /// Sensor of the sideslip angle, positive with the air from the right.
    pub beta: Sensor<Angle>,
    /// Sensor of the roll angle (Euler angle), positive right wing down.
    pub phi: Sensor<Angle>,
    /// Sensor of the pitch angle (Euler angle), positive nose up.
    pub theta: Sensor<Angle>,
    /// Sensor of the heading (Euler angle), clockwise from north seen from above.
    pub psi: Sensor<Angle>,
    /// Sensor of the roll rate about the body x axis, positive right wing down.
    pub p: Sensor<AngularRate>,
    /// Sensor of the pitch rate about the body y axis, positive nose up.
    pub q: Sensor<AngularRate>,
    /// Sensor of the yaw rate about the body z axis, positive nose right.
    pub r: Sensor<AngularRate>,
    /// Roll acceleration; not measured unless it is named.
    pub pdot: Option<Sensor<AngularAcceleration>>,
    /// Pitch acceleration; not measured unless it is named.
    pub qdot: Option<Sensor<AngularAcceleration>>,
    /// Yaw acceleration; not measured unless it is named.
    pub rdot: Option<Sensor<AngularAcceleration>>,
    /// Accelerometer along the body x axis (specific force, without gravity), positive forward.
    pub ax: Sensor<Acceleration>,
    /// Accelerometer along the body y axis (specific force, without gravity), positive to the right.
    pub ay: Sensor<Acceleration>,
    /// Accelerometer along the body z axis (specific force, without gravity), positive down.
    pub az: Sensor<Acceleration>,
    /// Sensor of the altitude above sea level.
    pub altitude: Sensor<Length>,
    /// Position towards the north from where the flight began (satellite receiver); not measured unless it is named.
    pub north: Option<Sensor<Length>>,
    /// Position towards the east from where the flight began (satellite receiver); not measured unless it is named.
    pub east: Option<Sensor<Length>>,
    /// Horizontal speed over the ground (satellite receiver); not measured unless it is named.
    pub ground_speed: Option<Sensor<Speed>>,
    /// Sensor of the elevator's position, with the sign of the aircraft's data.
    pub elevator: Sensor<Angle>,
    /// Sensor of the ailerons' position, with the sign of the aircraft's data.
    pub aileron: Sensor<Angle>,
    /// Sensor of the rudder's position, with the sign of the aircraft's data.
    pub rudder: Sensor<Angle>,
}

impl Sensors {
    /// Constant errors of the sensors by the names that model files have for them, SI.
    pub(super) fn biases(&self) -> Vec<(&'static str, f64)> {
        let optional = |sensor: &Option<Sensor<AngularAcceleration>>| sensor.map_or(0.0, |sensor| sensor.bias.si());
        vec![
            ("bias_true_airspeed", self.true_airspeed.bias.si()),
            ("bias_alpha", self.alpha.bias.si()),
            ("bias_beta", self.beta.bias.si()),
            ("bias_phi", self.phi.bias.si()),
            ("bias_theta", self.theta.bias.si()),
            ("bias_p", self.p.bias.si()),
            ("bias_q", self.q.bias.si()),
            ("bias_r", self.r.bias.si()),
            ("bias_ax", self.ax.bias.si()),
            ("bias_ay", self.ay.bias.si()),
            ("bias_az", self.az.bias.si()),
            ("bias_pdot", optional(&self.pdot)),
            ("bias_qdot", optional(&self.qdot)),
            ("bias_rdot", optional(&self.rdot)),
        ]
    }
}
