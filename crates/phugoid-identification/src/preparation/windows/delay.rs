//! At what time a flow angle was recorded, by when it makes a force. (Surfaces: [`crate::preparation::reaction`].)
//!
//! The flow angle makes a force at once. So the force equation, integrated once over the time,
//!
//! ```text
//! integral of az = integral of qbar (a alpha(t + tau) + b q c/(2V) + d delta),   alpha(t + tau) = alpha + tau alpha'
//!                = a integral(qbar alpha) + b integral(qbar q/V) + d integral(qbar delta) + a tau qbar alpha
//! ```
//!
//! has the delay tau of what was recorded as the ratio of two factors (the dynamic pressure changes slowly). No
//! aerodynamic coefficient has to be known.

use phugoid_flight_data::statistics::median;

use super::GUSTS;
use super::regression::{factors, integral};

/// How late a channel was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Delay {
    /// s; negative: early.
    pub(crate) late_s: f64,
    /// One sigma of it, s.
    pub(crate) std_s: f64,
}

/// The causes of one equation; the column of the factor that is the delay times that of `late` comes last.
pub(crate) struct Causes<'a, const C: usize> {
    pub(crate) time_s: &'a [f64],
    pub(crate) step_s: f64,
    /// What the equation gives, without the constants and drifts of windows.
    pub(crate) signal: &'a [f64],
    /// The other causes; `late` and the last one are replaced.
    pub(crate) others: [Vec<f64>; C],
    /// Place of the cause that is late.
    pub(crate) late: usize,
    /// That cause before it is integrated, and the dynamic pressure.
    pub(crate) cause: &'a [f64],
    pub(crate) pressure: &'a [f64],
}

impl<const C: usize> Causes<'_, C> {
    /// The delay, if the equation explains the motion.
    pub(crate) fn delay(mut self) -> Option<Delay> {
        let by_pressure = product(self.cause, self.pressure);
        self.others[self.late] = integral(self.time_s, &by_pressure);
        self.others[C - 1] = by_pressure;
        let found = factors(self.time_s, self.signal, &self.others, self.step_s)?;
        let (late_s, std_s) = found.ratio(C - 1, self.late)?;
        (found.unexplained <= GUSTS).then_some(Delay { late_s, std_s })
    }
}

/// Dynamic pressure over its median, and the true airspeed over its median.
pub(crate) fn scales(speed: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let usual = median(&mut speed.to_vec()).filter(|usual| *usual > 0.0)?;
    let relative: Vec<f64> = speed.iter().map(|v| v / usual).collect();
    Some((relative.iter().map(|v| v * v).collect(), relative))
}

pub(crate) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}
