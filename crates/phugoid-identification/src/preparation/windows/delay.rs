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
//! aerodynamic coefficient has to be known. In gusts the straight line holds for delays that are short against them; longer ones are
//! looked for by moving the flow angle.

use phugoid_flight_data::statistics::median;

use super::GUSTS;
use super::regression::{Factors, factors, integral};

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

/// A delay that is too long for the straight line above is looked for up to here, s, ...
const LONGEST_S: f64 = 0.4;
/// ... in steps of so many seconds, or of one sample where these are slower.
const STEP_S: f64 = 0.04;
/// It counts if the cause, moved by it, leaves less than this part of what is left without it, ...
const LEFT: f64 = 0.9;
/// ... and if the windows agree: so many standard errors of the mean difference. Of 381 flights of another simulator with vanes that
/// are in time, healthy and damaged, calm and in gusts, none has 0.9 and more than 2.0; of 22 with one 0.3 s late all have less than
/// 0.5 and 2.9 or more (measured with a prototype of this regression on the records as they were written).
const AGREED: f64 = 2.5;

impl<const C: usize> Causes<'_, C> {
    /// The delay, if the equation explains the motion.
    pub(crate) fn delay(&self) -> Option<Delay> {
        let found = self.fitted(self.cause, self.time_s.len())?;
        let (late_s, std_s) = found.ratio(C - 1, self.late)?;
        (found.unexplained <= GUSTS).then_some(Delay { late_s, std_s })
    }

    /// A long delay in gusts, s: the time by which the cause has to be moved so that the equation explains the motion best. None
    /// where that is not clearly better than the cause as it was recorded, as in still air, where the flow angle follows from
    /// the other causes whatever its time.
    pub(crate) fn long_delay(&self) -> Option<f64> {
        let fitted = |late_s: f64, count: usize| self.fitted(&moved(self.time_s, self.cause, late_s), count);
        best_moved(self.time_s, self.step_s, fitted)
            .filter(|best| best.left < LEFT && best.agreed > AGREED)
            .map(|best| best.late_s)
    }

    /// The equation over the first so many samples, with this in the place of the cause.
    fn fitted(&self, cause: &[f64], count: usize) -> Option<Factors<C>> {
        let time_s = &self.time_s[..count];
        let by_pressure = product(&cause[..count], &self.pressure[..count]);
        let integrated = integral(time_s, &by_pressure);
        let columns: [Vec<f64>; C] = std::array::from_fn(|c| match c {
            c if c == self.late => integrated.clone(),
            c if c == C - 1 => by_pressure.clone(),
            c => self.others[c][..count].to_vec(),
        });
        factors(time_s, &self.signal[..count], &columns, self.step_s)
    }
}

/// What moving a channel by some time explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moved {
    /// The time by which it was late, s: a multiple of the step of the search.
    pub(crate) late_s: f64,
    /// What the equation leaves with it, over what it leaves with the channel as it was recorded.
    pub(crate) left: f64,
    /// Mean over the windows of what it leaves less, in standard errors.
    pub(crate) agreed: f64,
}

/// The time by which a channel was late with which an equation explains the motion best. `fitted` is the equation with the channel
/// moved by a time, over the first so many samples: all over the same ones.
pub(crate) fn best_moved<const C: usize>(
    time_s: &[f64],
    step_s: f64,
    fitted: impl Fn(f64, usize) -> Option<Factors<C>>,
) -> Option<Moved> {
    let end = time_s.last()?;
    let count = time_s.partition_point(|t| t + LONGEST_S <= *end);
    let recorded = fitted(0.0, count)?;
    let step_s = step_s * (STEP_S / step_s).round().max(1.0);
    let sum = |factors: &Factors<C>| factors.left.iter().sum::<f64>();
    let times = (1..).map(|k| f64::from(k) * step_s).take_while(|late_s| *late_s <= LONGEST_S);
    let all = times.filter_map(|late_s| Some((late_s, fitted(late_s, count)?)));
    let (late_s, best) = all.min_by(|a, b| sum(&a.1).total_cmp(&sum(&b.1)))?;
    let gain: Vec<f64> = recorded.left.iter().zip(&best.left).map(|(recorded, moved)| recorded - moved).collect();
    let n = gain.len() as f64;
    let mean = gain.iter().sum::<f64>() / n;
    let variance = gain.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n - 1.0);
    Some(Moved { late_s, left: sum(&best) / sum(&recorded), agreed: mean / (variance / n).sqrt() })
}

/// A channel as it was recorded this time later, by straight lines.
pub(crate) fn moved(time_s: &[f64], values: &[f64], late_s: f64) -> Vec<f64> {
    let last = time_s.len() - 1;
    let mut after = 0;
    let at = |k: usize| {
        let t = time_s[k] + late_s;
        while after < last && time_s[after] < t {
            after += 1;
        }
        let before = after.saturating_sub(1);
        let part = (t - time_s[before]) / (time_s[after] - time_s[before]).max(f64::MIN_POSITIVE);
        values[before] + part.clamp(0.0, 1.0) * (values[after] - values[before])
    };
    (0..=last).map(at).collect()
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
