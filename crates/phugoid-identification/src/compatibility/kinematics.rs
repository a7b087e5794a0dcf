//! The kinematics of a rigid body over a flat earth, driven by what the inertial sensors measured: they hold for every
//! aircraft.

use phugoid_estimators::{Input, LinearizedOutputs, LinearizedRates, Model};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

/// States: u, v, w (body axes, through the air), phi, theta, psi, north, east, altitude.
pub(super) const STATES: usize = 9;
/// Outputs: true airspeed, alpha, beta, phi, theta, psi, north, east, altitude.
pub(super) const OUTPUTS: usize = 9;
/// Number of unknowns that the kinematics have places for: the entries of [`super::unknowns::UNKNOWNS`].
pub(super) const PARAMETERS: usize = 32;

/// What the inertial sensors measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Inertial {
    /// Specific force, body axes, m/s^2.
    pub(super) force: [f64; 3],
    /// Angular rate about body x, y and z, rad/s.
    pub(super) rate: [f64; 3],
    /// Angular acceleration, from the rates, rad/s^2.
    pub(super) acceleration: [f64; 3],
}

impl Input for Inertial {
    fn interpolate(&self, other: &Self, s: f64) -> Self {
        let between = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| a[i] + s * (b[i] - a[i]));
        Self {
            force: between(self.force, other.force),
            rate: between(self.rate, other.rate),
            acceleration: between(self.acceleration, other.acceleration),
        }
    }
}

/// The kinematic equations (Klein & Morelli, section 10.2; Jategaonkar, section 10.3):
///
/// ```text
/// u' = r v - q w - g sin theta + ax          phi'   = p + (q sin phi + r cos phi) tan theta
/// v' = p w - r u + g cos theta sin phi + ay  theta' = q cos phi - r sin phi
/// w' = q u - p v + g cos theta cos phi + az  psi'   = (q sin phi + r cos phi)/cos theta
/// (north, east, -altitude)' = R(phi, theta, psi) (u, v, w) + wind
/// ```
///
/// with true rates and forces `(1 - scale) measured - bias`, less what the accelerometers feel beside the centre of
/// gravity. Given the state the rates are linear in the unknowns. The wind is constant, so that the air is an inertial
/// frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kinematics {
    /// Acceleration of gravity, m/s^2, positive.
    pub(super) gravity: f64,
}

impl Kinematics {
    /// True rates p, q, r.
    fn turning<T: Scalar>(theta: &[T; PARAMETERS], u: &Inertial) -> [T; 3] {
        std::array::from_fn(|i| T::from(u.rate[i]) - theta[3 + i] - theta[9 + i] * u.rate[i])
    }

    fn motion<T: Scalar>(&self, x: &[T; STATES], theta: &[T; PARAMETERS], input: &Inertial) -> [T; STATES] {
        let [u, v, w, phi, pitch, psi, ..] = *x;
        let [p, q, r] = Self::turning(theta, input);
        // At (x, 0, z) from the centre of gravity: a + w' x r + w x (w x r), with the measured rates.
        let [pm, qm, rm] = input.rate;
        let [pd, qd, rd] = input.acceleration;
        let lever =
            [[-(qm * qm + rm * rm), pm * rm + qd], [pm * qm + rd, qm * rm - pd], [pm * rm - qd, -(pm * pm + qm * qm)]];
        let force: [T; 3] = std::array::from_fn(|i| {
            let sensed = T::from(input.force[i]) - theta[i] - theta[6 + i] * input.force[i];
            sensed - theta[27] * lever[i][0] - theta[28] * lever[i][1]
        });
        let (sin_phi, cos_phi) = phi.sin_cos();
        let (sin_theta, cos_theta) = pitch.sin_cos();
        let (sin_psi, cos_psi) = psi.sin_cos();
        let g_cos = cos_theta * self.gravity;
        let turn = (q * sin_phi + r * cos_phi) / cos_theta;
        let climbing = v * sin_phi + w * cos_phi;
        let along = u * cos_theta + climbing * sin_theta;
        let across = v * cos_phi - w * sin_phi;
        [
            r * v - q * w - sin_theta * self.gravity + force[0],
            p * w - r * u + g_cos * sin_phi + force[1],
            q * u - p * v + g_cos * cos_phi + force[2],
            p + turn * sin_theta,
            q * cos_phi - r * sin_phi,
            turn,
            along * cos_psi - across * sin_psi + theta[29],
            along * sin_psi + across * cos_psi + theta[30],
            u * sin_theta - climbing * cos_theta - theta[31],
        ]
    }

    fn measured<T: Scalar>(&self, x: &[T; STATES], theta: &[T; PARAMETERS], input: &Inertial) -> [T; OUTPUTS] {
        // What a late channel shows is what was true one delay ago; to first order x - delay x'.
        let rates = self.motion(x, theta, input);
        let ago = |delay: T| -> [T; 6] { std::array::from_fn(|i| x[i] - delay * rates[i]) };
        let speed = |s: &[T; 6]| (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).sqrt();
        let [p, q, r] = Self::turning(theta, input);
        let air = ago(theta[21]);
        let vane = ago(theta[22]);
        let side = ago(theta[23]);
        let attitude = ago(theta[24]);
        // A vane ahead of the centre of gravity meets the air that pitching and yawing bring.
        let alpha = vane[2].atan2(vane[0]) - q * theta[25] / speed(&vane);
        let in_plane = (side[0] * side[0] + side[2] * side[2]).sqrt();
        let beta = side[1].atan2(in_plane) + r * theta[26] / speed(&side);
        let _ = p;
        let read = |value: T, bias: usize, scale: usize| value + value * theta[scale] + theta[bias];
        [
            read(speed(&air), 12, 13),
            read(alpha, 14, 15),
            read(beta, 16, 17),
            attitude[3] + theta[18],
            attitude[4] + theta[19],
            attitude[5] + theta[20],
            x[6],
            x[7],
            x[8],
        ]
    }
}

/// States and unknowns as variables of the derivatives.
const VARIABLES: usize = STATES + PARAMETERS;

fn variables<const P: usize>(
    x: &[f64; STATES],
    theta: &[f64; P],
) -> ([Dual<VARIABLES>; STATES], [Dual<VARIABLES>; PARAMETERS]) {
    (std::array::from_fn(|i| Dual::variable(x[i], i)), std::array::from_fn(|j| Dual::variable(theta[j], STATES + j)))
}

/// The model can be compiled with place for any number of columns from [`PARAMETERS`] on.
impl<const P: usize> Model<STATES, OUTPUTS, P> for Kinematics {
    type Input = Inertial;

    fn parameter_count(&self) -> usize {
        PARAMETERS
    }

    fn rates(&self, x: &[f64; STATES], theta: &[f64; P], u: &Inertial) -> [f64; STATES] {
        self.motion(x, &std::array::from_fn(|j| theta[j]), u)
    }

    fn linearized_rates(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Inertial,
        out: &mut LinearizedRates<STATES, P>,
    ) {
        let (x, theta) = variables(x, theta);
        for (i, rate) in self.motion(&x, &theta, u).iter().enumerate() {
            out.rates[i] = rate.value;
            out.state_jacobian[i] = std::array::from_fn(|j| rate.derivatives[j]);
            out.regressors[i][..PARAMETERS].copy_from_slice(&rate.derivatives[STATES..]);
        }
    }

    fn linearized_outputs(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Inertial,
        out: &mut LinearizedOutputs<STATES, OUTPUTS, P>,
    ) {
        let (x, theta) = variables(x, theta);
        for (i, output) in self.measured(&x, &theta, u).iter().enumerate() {
            out.outputs[i] = output.value;
            out.state_jacobian[i] = std::array::from_fn(|j| output.derivatives[j]);
            out.parameter_jacobian[i][..PARAMETERS].copy_from_slice(&output.derivatives[STATES..]);
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        // u, v and w are measured together; the start value comes from all three (`super::start`).
        (state >= 3).then_some(state)
    }
}
