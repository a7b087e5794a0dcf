//! The motion that is wanted of an aircraft.

use crate::local::{ALPHA, AXES, BETA, LocalModel, P, Q, R, VARIABLES};

/// What the closed loop should do; all numbers positive.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Targets {
    /// Control anticipation parameter `omega_sp^2 / (n/alpha)`, rad^2/s^2 per g: what frequency of the short period is wanted.
    pub control_anticipation: f64,
    /// Lowest and highest frequency of the short period that is asked of the surfaces, rad/s, whatever `n/alpha` is.
    pub short_period_range: [f64; 2],
    /// Damping ratio of the short period.
    pub short_period_damping: f64,
    /// Frequency of the Dutch roll, rad/s.
    pub dutch_roll_frequency: f64,
    /// Damping ratio of the Dutch roll.
    pub dutch_roll_damping: f64,
    /// Time constant of the roll, s.
    pub roll_time_constant: f64,
}

impl Default for Targets {
    /// Well inside level 1 of MIL-F-8785C for a fighter in cruise (class IV, category B) and at frequencies that actuators of 20
    /// rad/s follow.
    fn default() -> Self {
        Self {
            control_anticipation: 0.5,
            short_period_range: [1.5, 3.5],
            short_period_damping: 0.8,
            dutch_roll_frequency: 2.5,
            dutch_roll_damping: 0.5,
            roll_time_constant: 0.5,
        }
    }
}

impl Targets {
    /// Frequency of the short period that is wanted of this aircraft, rad/s.
    pub fn short_period_frequency(&self, model: &LocalModel) -> f64 {
        let wanted = libm::sqrt((self.control_anticipation * model.load_factor_per_alpha()).max(0.0));
        let [lowest, highest] = self.short_period_range;
        wanted.max(lowest).min(highest)
    }

    /// The wanted angular accelerations `[p', q', r']` (rows) by the feedback variables (columns): with them the aircraft's own
    /// lift and side force give short period and Dutch roll their frequency and damping. Rolling neither with sideslip nor with
    /// yaw rate.
    ///
    /// Short period: `s^2 - (Za + Mq) s + Za Mq - Ma`; Dutch roll with the roll held: `s^2 - (Yb + Nr) s + Yb Nr + Nb`.
    pub fn rates(&self, model: &LocalModel) -> [[f64; VARIABLES]; AXES] {
        let mut wanted = [[0.0; VARIABLES]; AXES];
        wanted[0][P] = -1.0 / self.roll_time_constant;
        let (frequency, lift) = (self.short_period_frequency(model), model.alpha_by_alpha);
        let pitch_damping = -2.0 * self.short_period_damping * frequency - lift;
        wanted[1][Q] = pitch_damping;
        wanted[1][ALPHA] = lift * pitch_damping - frequency * frequency;
        let (frequency, side) = (self.dutch_roll_frequency, model.beta_by_beta);
        let yaw_damping = -2.0 * self.dutch_roll_damping * frequency - side;
        let cosine = libm::cos(model.alpha);
        wanted[2][R] = yaw_damping;
        wanted[2][BETA] = (frequency * frequency - side * yaw_damping) / cosine;
        wanted
    }
}
