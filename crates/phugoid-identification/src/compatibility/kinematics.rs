//! The kinematics of a rigid body, driven by what the inertial sensors measured, and what the other sensors show of
//! them: they hold for every aircraft.

use phugoid_flight_dynamics::scalar::{Dual, Scalar};

/// States of the motion: u, v, w (body axes, against air that moves with the mean wind), phi, theta, psi, north, east,
/// altitude.
pub(super) const BODY: usize = 9;
/// All states: those of the motion, the gusts along body x, y and z (m/s), two that the spectrum of the lateral and
/// vertical gusts needs, and the bank that nobody recorded (`1 - cos phi`).
pub(super) const STATES: usize = 15;
/// The second state of the lateral gust; that of the vertical one follows.
pub(super) const GUST_LAG: usize = 12;
/// `1 - cos phi` of a record without bank.
pub(super) const BANK: usize = 14;
/// Outputs: true airspeed, alpha, beta, phi, theta, psi, north, east, altitude.
pub(super) const OUTPUTS: usize = 9;
/// Number of unknowns that the kinematics have places for: the entries of [`super::unknowns::UNKNOWNS`].
pub(super) const PARAMETERS: usize = 39;
/// Accelerometers, then gyroscopes.
pub(super) const SENSORS: usize = 6;

/// Places of the unknowns.
pub(super) mod place {
    /// Biases of the accelerometers; those of the gyroscopes follow.
    pub(in super::super) const BIAS: usize = 0;
    /// Scale factors of the accelerometers; those of the gyroscopes follow.
    pub(in super::super) const SCALE: usize = 6;
    pub(in super::super) const BIAS_SPEED: usize = 12;
    pub(in super::super) const SCALE_SPEED: usize = 13;
    pub(in super::super) const BIAS_ALPHA: usize = 14;
    pub(in super::super) const SCALE_ALPHA: usize = 15;
    pub(in super::super) const BIAS_BETA: usize = 16;
    pub(in super::super) const SCALE_BETA: usize = 17;
    /// Biases of phi, theta and psi.
    pub(in super::super) const BIAS_ATTITUDE: usize = 18;
    pub(in super::super) const DELAY_SPEED: usize = 21;
    pub(in super::super) const DELAY_ALPHA: usize = 22;
    pub(in super::super) const DELAY_BETA: usize = 23;
    pub(in super::super) const DELAY_ATTITUDE: usize = 24;
    pub(in super::super) const VANE_ALPHA: usize = 25;
    pub(in super::super) const VANE_BETA: usize = 26;
    pub(in super::super) const ACCELEROMETER_X: usize = 27;
    pub(in super::super) const ACCELEROMETER_Z: usize = 28;
    /// Wind to the north, to the east and down.
    pub(in super::super) const WIND: usize = 29;
    /// Scale factors of phi and theta.
    pub(in super::super) const SCALE_ATTITUDE: usize = 32;
    pub(in super::super) const UPWASH_ALPHA: usize = 34;
    /// Gravity beyond what [`super::Kinematics`] takes for the place, with what the turning Earth adds to it.
    pub(in super::super) const GRAVITY: usize = 35;
    /// By how much the gusts along body x, y and z grow with the specific force there, s.
    pub(in super::super) const GUST_BY_FORCE: usize = 36;
}

/// The unknowns that move the states; the others only change what is shown of them.
const MOVING: [usize; 18] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 27, 28, 29, 30, 31, 35];

/// Curvature of the Earth, 1/m.
pub(super) const CURVATURE: f64 = 1.0 / 6.371e6;

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

impl Inertial {
    /// On the straight line from this sample (`s` = 0) to another (`s` = 1).
    pub(super) fn between(&self, other: &Self, s: f64) -> Self {
        let mix = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| a[i] + s * (b[i] - a[i]));
        Self {
            force: mix(self.force, other.force),
            rate: mix(self.rate, other.rate),
            acceleration: mix(self.acceleration, other.acceleration),
        }
    }
}

/// The kinematic equations (Klein & Morelli, section 10.2; Jategaonkar, section 10.3):
///
/// ```text
/// u' = r v - q w - g sin theta + ax          phi'   = p + (q sin phi + r cos phi) tan theta
/// v' = p w - r u + g cos theta sin phi + ay  theta' = q cos phi - r sin phi + V/R
/// w' = q u - p v + g cos theta cos phi + az  psi'   = (q sin phi + r cos phi)/cos theta
/// (north, east, -altitude)' = R(phi, theta, psi) (u, v, w) + wind
/// ```
///
/// with true rates and forces `(1 - scale) measured - bias`, less what the accelerometers feel beside the centre of
/// gravity. The horizon turns under an aircraft that flies on: `V/R`, 0.001 degrees per second at 100 m/s, is as large
/// as the error with which thirty seconds tell the bias of a gyroscope. The mean wind is constant, so that the air is an
/// inertial frame but for its gusts.
///
/// Where bank and yaw rate were not recorded, the aircraft turns all the same, as turbulence or the pilot rolls it. A
/// bank of nine degrees in turbulence is a bias of 0.2 degrees per second of the pitch gyroscope: `b = 1 - cos phi` takes
/// `2 g b/V` from theta' (a coordinated turn) and `g b` from w'.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kinematics {
    /// Acceleration of gravity at the place, m/s^2, positive.
    pub(super) gravity: f64,
    /// Curvature of the Earth, 1/m: zero over a flat one.
    pub(super) curvature: f64,
}

/// One step of the motion with its derivatives.
pub(super) struct Moved {
    pub(super) state: [f64; BODY],
    /// By the state before.
    pub(super) transition: [[f64; STATES]; BODY],
    /// By the unknowns; zero for those that do not move the states.
    pub(super) by_parameter: [[f64; PARAMETERS]; BODY],
}

/// Outputs with their derivatives.
pub(super) struct Shown {
    pub(super) outputs: [f64; OUTPUTS],
    pub(super) by_state: [[f64; STATES]; OUTPUTS],
    pub(super) by_parameter: [[f64; PARAMETERS]; OUTPUTS],
}

impl Kinematics {
    fn motion<T: Scalar>(&self, x: &[T; BODY], bank: T, theta: &[T; PARAMETERS], input: &Inertial) -> [T; BODY] {
        let [u, v, w, phi, pitch, psi, ..] = *x;
        let rate: [T; 3] = std::array::from_fn(|i| {
            T::from(input.rate[i]) - theta[place::BIAS + 3 + i] - theta[place::SCALE + 3 + i] * input.rate[i]
        });
        let [p, q, r] = rate;
        // At (x, 0, z) from the centre of gravity: a + w' x r + w x (w x r), with the measured rates.
        let [pm, qm, rm] = input.rate;
        let [pd, qd, rd] = input.acceleration;
        let lever =
            [[-(qm * qm + rm * rm), pm * rm + qd], [pm * qm + rd, qm * rm - pd], [pm * rm - qd, -(pm * pm + qm * qm)]];
        let force: [T; 3] = std::array::from_fn(|i| {
            let sensed = T::from(input.force[i]) - theta[place::BIAS + i] - theta[place::SCALE + i] * input.force[i];
            sensed - theta[place::ACCELEROMETER_X] * lever[i][0] - theta[place::ACCELEROMETER_Z] * lever[i][1]
        });
        let gravity = theta[place::GRAVITY] + self.gravity;
        let (sin_phi, cos_phi) = phi.sin_cos();
        let (sin_theta, cos_theta) = pitch.sin_cos();
        let (sin_psi, cos_psi) = psi.sin_cos();
        let g_cos = cos_theta * gravity;
        let turn = (q * sin_phi + r * cos_phi) / cos_theta;
        let climbing = v * sin_phi + w * cos_phi;
        let along = u * cos_theta + climbing * sin_theta;
        let across = v * cos_phi - w * sin_phi;
        let wind = place::WIND;
        [
            r * v - q * w - sin_theta * gravity + force[0],
            p * w - r * u + g_cos * sin_phi + force[1],
            q * u - p * v + g_cos * (cos_phi - bank) + force[2],
            p + turn * sin_theta,
            q * cos_phi - r * sin_phi + along * self.curvature - bank * 2.0 * gravity / along,
            turn,
            along * cos_psi - across * sin_psi + theta[wind],
            along * sin_psi + across * cos_psi + theta[wind + 1],
            u * sin_theta - climbing * cos_theta - theta[wind + 2],
        ]
    }

    /// The rates of the motion.
    fn rates(&self, x: &[f64; BODY], bank: f64, theta: &[f64; PARAMETERS], input: &Inertial) -> [f64; BODY] {
        self.motion(x, bank, theta, input)
    }

    /// One step of the fourth order between two samples, with the derivatives of this step.
    pub(super) fn step(
        &self,
        x: &[f64; STATES],
        theta: &[f64; PARAMETERS],
        from: &Inertial,
        to: &Inertial,
        h: f64,
    ) -> Moved {
        type D = Dual<{ BODY + MOVING.len() + 1 }>;
        let start: [D; BODY] = std::array::from_fn(|i| D::variable(x[i], i));
        let mut unknown: [D; PARAMETERS] = std::array::from_fn(|j| D::from(theta[j]));
        for (k, j) in MOVING.into_iter().enumerate() {
            unknown[j] = D::variable(theta[j], BODY + k);
        }
        let bank = D::variable(x[BANK], BODY + MOVING.len());
        let plus = |k: &[D; BODY], h: f64| -> [D; BODY] { std::array::from_fn(|i| start[i] + k[i] * h) };
        let middle = from.between(to, 0.5);
        let k1 = self.motion(&start, bank, &unknown, from);
        let k2 = self.motion(&plus(&k1, 0.5 * h), bank, &unknown, &middle);
        let k3 = self.motion(&plus(&k2, 0.5 * h), bank, &unknown, &middle);
        let k4 = self.motion(&plus(&k3, h), bank, &unknown, to);
        let mut moved =
            Moved { state: [0.0; BODY], transition: [[0.0; STATES]; BODY], by_parameter: [[0.0; PARAMETERS]; BODY] };
        for i in 0..BODY {
            let end = start[i] + (k1[i] + k2[i] * 2.0 + k3[i] * 2.0 + k4[i]) * (h / 6.0);
            moved.state[i] = end.value;
            moved.transition[i][..BODY].copy_from_slice(&end.derivatives[..BODY]);
            moved.transition[i][BANK] = end.derivatives[BODY + MOVING.len()];
            for (k, j) in MOVING.into_iter().enumerate() {
                moved.by_parameter[i][j] = end.derivatives[BODY + k];
            }
        }
        moved
    }

    /// What the sensors show at a sample. `before(delay)` gives the inertial signals that long ago, s (negative: later).
    ///
    /// A late channel shows what was true one delay ago: the motion is followed backwards for that time. Derivatives by
    /// the state leave out how the way back depends on the state, which changes them by a few per cent at most.
    pub(super) fn shown(
        &self,
        x: &[f64; STATES],
        theta: &[f64; PARAMETERS],
        before: &dyn Fn(f64) -> Inertial,
    ) -> Shown {
        let mut out = Shown {
            outputs: [0.0; OUTPUTS],
            by_state: [[0.0; STATES]; OUTPUTS],
            by_parameter: [[0.0; PARAMETERS]; OUTPUTS],
        };
        let body: [f64; BODY] = std::array::from_fn(|i| x[i]);
        let ago = |delay: f64| -> ([f64; BODY], [f64; BODY], Inertial) {
            if delay == 0.0 {
                let now = before(0.0);
                return (body, self.rates(&body, x[BANK], theta, &now), now);
            }
            let first = self.rates(&body, x[BANK], theta, &before(0.0));
            let half: [f64; BODY] = std::array::from_fn(|i| body[i] - 0.5 * delay * first[i]);
            let middle = self.rates(&half, x[BANK], theta, &before(0.5 * delay));
            let then: [f64; BODY] = std::array::from_fn(|i| body[i] - delay * middle[i]);
            let input = before(delay);
            (then, self.rates(&then, x[BANK], theta, &input), input)
        };
        // Airspeed.
        let (then, slope, _) = ago(theta[place::DELAY_SPEED]);
        let air: [f64; 3] = std::array::from_fn(|i| then[i] + x[BODY + i]);
        let speed = air.iter().map(|a| a * a).sum::<f64>().sqrt().max(1e-3);
        let scale = 1.0 + theta[place::SCALE_SPEED];
        out.outputs[0] = scale * speed + theta[place::BIAS_SPEED];
        for i in 0..3 {
            let by = scale * air[i] / speed;
            out.by_state[0][i] = by;
            out.by_state[0][BODY + i] = by;
            out.by_parameter[0][place::DELAY_SPEED] -= by * slope[i];
        }
        out.by_parameter[0][place::BIAS_SPEED] = 1.0;
        out.by_parameter[0][place::SCALE_SPEED] = speed;
        // Angle of attack: a vane ahead of the centre of gravity meets the air that pitching brings.
        let (then, slope, input) = ago(theta[place::DELAY_ALPHA]);
        let air: [f64; 3] = std::array::from_fn(|i| then[i] + x[BODY + i]);
        let speed2 = air.iter().map(|a| a * a).sum::<f64>().max(1e-6);
        let speed = speed2.sqrt();
        let plane2 = (air[0] * air[0] + air[2] * air[2]).max(1e-6);
        let rate = |i: usize, input: &Inertial| {
            (1.0 - theta[place::SCALE + 3 + i]) * input.rate[i] - theta[place::BIAS + 3 + i]
        };
        let lift = -input.force[2] / speed2;
        let alpha = air[2].atan2(air[0]) - rate(1, &input) * theta[place::VANE_ALPHA] / speed
            + theta[place::UPWASH_ALPHA] * lift;
        let scale = 1.0 + theta[place::SCALE_ALPHA];
        out.outputs[1] = scale * alpha + theta[place::BIAS_ALPHA];
        let by_speed =
            rate(1, &input) * theta[place::VANE_ALPHA] / speed2 - 2.0 * theta[place::UPWASH_ALPHA] * lift / speed;
        for (i, by) in [-air[2] / plane2, 0.0, air[0] / plane2].into_iter().enumerate() {
            let by = scale * (by + by_speed * air[i] / speed);
            out.by_state[1][i] = by;
            out.by_state[1][BODY + i] = by;
            out.by_parameter[1][place::DELAY_ALPHA] -= by * slope[i];
        }
        out.by_parameter[1][place::BIAS_ALPHA] = 1.0;
        out.by_parameter[1][place::SCALE_ALPHA] = alpha;
        out.by_parameter[1][place::VANE_ALPHA] = -scale * rate(1, &input) / speed;
        out.by_parameter[1][place::UPWASH_ALPHA] = scale * lift;
        // Sideslip.
        let (then, slope, input) = ago(theta[place::DELAY_BETA]);
        let air: [f64; 3] = std::array::from_fn(|i| then[i] + x[BODY + i]);
        let speed2 = air.iter().map(|a| a * a).sum::<f64>().max(1e-6);
        let speed = speed2.sqrt();
        let plane = (air[0] * air[0] + air[2] * air[2]).max(1e-6).sqrt();
        let beta = air[1].atan2(plane) + rate(2, &input) * theta[place::VANE_BETA] / speed;
        let scale = 1.0 + theta[place::SCALE_BETA];
        out.outputs[2] = scale * beta + theta[place::BIAS_BETA];
        for i in 0..3 {
            let angle = if i == 1 { plane / speed2 } else { -air[1] * air[i] / (plane * speed2) };
            let by = scale * (angle - rate(2, &input) * theta[place::VANE_BETA] * air[i] / (speed2 * speed));
            out.by_state[2][i] = by;
            out.by_state[2][BODY + i] = by;
            out.by_parameter[2][place::DELAY_BETA] -= by * slope[i];
        }
        out.by_parameter[2][place::BIAS_BETA] = 1.0;
        out.by_parameter[2][place::SCALE_BETA] = beta;
        out.by_parameter[2][place::VANE_BETA] = scale * rate(2, &input) / speed;
        // Attitude.
        let (then, slope, _) = ago(theta[place::DELAY_ATTITUDE]);
        for i in 0..3 {
            // A heading has no scale: its zero is a convention.
            let factor = if i < 2 { 1.0 + theta[place::SCALE_ATTITUDE + i] } else { 1.0 };
            out.outputs[3 + i] = factor * then[3 + i] + theta[place::BIAS_ATTITUDE + i];
            out.by_state[3 + i][3 + i] = factor;
            out.by_parameter[3 + i][place::BIAS_ATTITUDE + i] = 1.0;
            out.by_parameter[3 + i][place::DELAY_ATTITUDE] = -factor * slope[3 + i];
            if i < 2 {
                out.by_parameter[3 + i][place::SCALE_ATTITUDE + i] = then[3 + i];
            }
        }
        for i in 6..BODY {
            out.outputs[i] = x[i];
            out.by_state[i][i] = 1.0;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inertial(t: f64) -> Inertial {
        Inertial {
            force: [0.3 + 0.2 * t, 0.4 - t, -9.5 + 3.0 * t],
            rate: [0.2 + t, 0.1 - 0.5 * t, -0.05 + 0.3 * t],
            acceleration: [1.0, -0.5, 0.3],
        }
    }

    const STATE: [f64; STATES] = [70.0, 3.0, 5.0, 0.2, 0.1, 0.5, 100.0, -50.0, 900.0, 1.0, -0.5, 0.7, 0.1, -0.2, 0.01];

    fn unknowns() -> [f64; PARAMETERS] {
        let mut theta = std::array::from_fn(|j| 0.003 * (j as f64 - 17.0));
        theta[place::DELAY_SPEED..=place::DELAY_ATTITUDE].copy_from_slice(&[0.02, 0.03, -0.01, 0.015]);
        theta
    }

    /// The derivatives of a step are those of the step: central differences of one part in a million.
    #[test]
    fn a_step_has_its_derivatives() {
        let kinematics = Kinematics { gravity: 9.8, curvature: CURVATURE };
        let (from, to, theta) = (inertial(0.0), inertial(0.04), unknowns());
        let moved = kinematics.step(&STATE, &theta, &from, &to, 0.04);
        for j in 0..STATES + PARAMETERS {
            let at = |d: f64| {
                let (mut x, mut theta) = (STATE, theta);
                if j < STATES {
                    x[j] += d
                } else {
                    theta[j - STATES] += d
                }
                kinematics.step(&x, &theta, &from, &to, 0.04).state
            };
            let (plus, minus) = (at(1e-4), at(-1e-4));
            for i in 0..BODY {
                let difference = (plus[i] - minus[i]) / 2e-4;
                let found = if j < STATES { moved.transition[i][j] } else { moved.by_parameter[i][j - STATES] };
                assert!((found - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{i} {j}: {found} {difference}");
            }
        }
    }

    /// Derivatives of the outputs; by the state they leave out the way back of a delay, and are compared without one.
    #[test]
    fn outputs_have_their_derivatives() {
        let kinematics = Kinematics { gravity: 9.8, curvature: CURVATURE };
        let before = |delay: f64| inertial(-delay);
        let theta = unknowns();
        let mut prompt = theta;
        prompt[place::DELAY_SPEED..=place::DELAY_ATTITUDE].fill(0.0);
        let (late, now) = (kinematics.shown(&STATE, &theta, &before), kinematics.shown(&STATE, &prompt, &before));
        for j in 0..STATES + PARAMETERS {
            let at = |d: f64, theta: &[f64; PARAMETERS]| {
                let (mut x, mut theta) = (STATE, *theta);
                if j < STATES {
                    x[j] += d
                } else {
                    theta[j - STATES] += d
                }
                kinematics.shown(&x, &theta, &before).outputs
            };
            // The inertial unknowns change the way back and, a little, the vane beside the centre of gravity: both are
            // left out. So is the wind on the way back of a position, which has no delay.
            if j >= STATES && MOVING.contains(&(j - STATES)) {
                continue;
            }
            let theta = if j < STATES { &prompt } else { &theta };
            let (plus, minus) = (at(1e-5, theta), at(-1e-5, theta));
            for i in 0..OUTPUTS {
                let difference = (plus[i] - minus[i]) / 2e-5;
                let found = if j < STATES { now.by_state[i][j] } else { late.by_parameter[i][j - STATES] };
                let tolerance = if (place::DELAY_SPEED..=place::DELAY_ATTITUDE).contains(&(j.wrapping_sub(STATES))) {
                    0.05 * difference.abs() + 1e-3
                } else {
                    1e-6 * (1.0 + difference.abs())
                };
                assert!((found - difference).abs() < tolerance, "{i} {j}: {found} {difference}");
            }
        }
    }
}
