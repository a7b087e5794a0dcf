//! The local linear model of an aircraft.
//!
//! ```text
//! alpha' = Za alpha + q + Zd u                      [p', q', r'] = R x + S u + c
//! beta'  = Yb beta + p sin a0 - r cos a0 + (g/V) phi + Yd u
//! phi'   = p + r tan th0                             x = [alpha, beta, p, q, r],  u = [elevator, aileron, rudder]
//! ```
//!
//! All variables are differences from a reference: steady, nearly straight flight at the angle of attack `a0`. Rates of the speed
//! are left out; over the seconds in which a controller acts it is constant.

/// Number of feedback variables: angle of attack, sideslip, roll, pitch and yaw rate.
pub const VARIABLES: usize = 5;
/// Number of surfaces: elevator, aileron, rudder.
pub const SURFACES: usize = 3;
/// Number of body axes.
pub const AXES: usize = 3;
/// States of the whole local motion: angle of attack, sideslip, bank angle, roll, pitch and yaw rate.
pub const STATES: usize = 6;

/// The axis that elevator, aileron and rudder are there for, among roll, pitch and yaw: pitch, roll, yaw.
pub const MAIN_AXIS: [usize; SURFACES] = [1, 0, 2];

/// Index of the roll axis.
pub const ROLL: usize = 0;
/// Yaw axis.
pub const YAW: usize = 2;

/// Index of the aileron among the surfaces.
pub const AILERON: usize = 1;
/// Rudder.
pub const RUDDER: usize = 2;

/// Indices of the feedback variables.
pub const ALPHA: usize = 0;
/// Sideslip.
pub const BETA: usize = 1;
/// Roll rate.
pub const P: usize = 2;
/// Pitch rate.
pub const Q: usize = 3;
/// Yaw rate.
pub const R: usize = 4;

/// The linear model about a reference condition. Angles in rad, rates in rad/s, times in s. A model with numbers that are not
/// finite makes gains that are refused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LocalModel {
    /// Angular accelerations `[p', q', r']` (rows) by the feedback variables (columns), 1/s^2 and 1/s.
    pub rates: [[f64; VARIABLES]; AXES],
    /// Angular accelerations by elevator, aileron and rudder, 1/s^2.
    pub surfaces: [[f64; SURFACES]; AXES],
    /// Angular accelerations at the reference, with the surfaces at theirs, rad/s^2: what is out of trim.
    pub constant: [f64; AXES],
    /// `Z_alpha`, rate of the angle of attack by itself, 1/s; negative.
    pub alpha_by_alpha: f64,
    /// Rate of the angle of attack by the elevator, 1/s.
    pub alpha_by_elevator: f64,
    /// `Y_beta`, rate of the sideslip by itself, 1/s; negative.
    pub beta_by_beta: f64,
    /// Rate of the sideslip by the rudder, 1/s.
    pub beta_by_rudder: f64,
    /// Rate of the sideslip by the aileron, 1/s.
    pub beta_by_aileron: f64,
    /// Angle of attack of the reference, rad.
    pub alpha: f64,
    /// Airspeed of the reference, m/s.
    pub speed: f64,
    /// Acceleration of gravity, m/s^2.
    pub gravity: f64,
}

impl LocalModel {
    /// The matrix of the whole motion, states `[alpha, beta, phi, p, q, r]`, when the surfaces answer the feedback variables with
    /// these gains (rows elevator, aileron, rudder; columns the feedback variables).
    pub fn closed_loop(&self, feedback: &[[f64; VARIABLES]; SURFACES]) -> [[f64; STATES]; STATES] {
        /// Where each feedback variable stands among the states.
        const PLACE: [usize; VARIABLES] = [0, 1, 3, 4, 5];
        let mut a = [[0.0; STATES]; STATES];
        a[0][0] = self.alpha_by_alpha;
        a[0][4] = 1.0;
        a[1][1] = self.beta_by_beta;
        a[1][2] = self.gravity / self.speed;
        a[1][3] = libm::sin(self.alpha);
        a[1][5] = -libm::cos(self.alpha);
        a[2][3] = 1.0;
        a[2][5] = libm::tan(self.alpha);
        for i in 0..AXES {
            for j in 0..VARIABLES {
                a[3 + i][PLACE[j]] = self.rates[i][j];
            }
        }
        for j in 0..VARIABLES {
            let [elevator, aileron, rudder] = [feedback[0][j], feedback[1][j], feedback[2][j]];
            a[0][PLACE[j]] += self.alpha_by_elevator * elevator;
            a[1][PLACE[j]] += self.beta_by_aileron * aileron + self.beta_by_rudder * rudder;
            for i in 0..AXES {
                a[3 + i][PLACE[j]] +=
                    self.surfaces[i][0] * elevator + self.surfaces[i][1] * aileron + self.surfaces[i][2] * rudder;
            }
        }
        a
    }

    /// Change of the load factor with the angle of attack, g per rad: `n/alpha = -V Z_alpha / g`.
    pub fn load_factor_per_alpha(&self) -> f64 {
        -self.speed * self.alpha_by_alpha / self.gravity
    }

    /// Whether every number is finite and the speed positive.
    pub fn is_finite(&self) -> bool {
        let matrices = self.rates.iter().flatten().chain(self.surfaces.iter().flatten()).chain(&self.constant);
        let scalars = [
            self.alpha_by_alpha,
            self.alpha_by_elevator,
            self.beta_by_beta,
            self.beta_by_rudder,
            self.beta_by_aileron,
            self.alpha,
            self.gravity,
        ];
        matrices.chain(&scalars).all(|value| value.is_finite()) && self.speed > 0.0 && self.speed.is_finite()
    }
}
