//! The short period as a segment shows it, and whether the input had power there.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::input::SurfaceInput;
use super::support::Judged;

/// The short-period mode that follows from the regressions of a segment, by the approximation with two states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShortPeriod {
    /// Undamped natural frequency of the mode, rad/s.
    pub frequency_rad_s: f64,
    /// Damping ratio of the mode: 1 is critical damping.
    pub damping: f64,
}

/// An input should have its power within this factor of the mode, to either side: as designed inputs have.
const WITHIN: f64 = 2.5;

/// Of the approximation with two states (Etkin & Reid, Dynamics of Flight, section 6.3; `M` and `L` the dimensional
/// derivatives):
///
/// ```text
/// w^2 = -(M_alpha + M_q L_alpha / V)      2 zeta w = L_alpha / V - M_q
/// ```
///
/// None where a derivative is not known or the motion is not oscillatory.
pub(crate) fn of(judged: &[Judged]) -> Option<ShortPeriod> {
    let term = |name: &str| {
        let found = judged.iter().find(|j| j.coefficient.name == name)?;
        let term = found.term.as_ref().filter(|t| t.value.is_finite() && t.std_error < t.value.abs())?;
        Some((term.value, found.speed))
    };
    let ((m_alpha, speed), (m_q, _), (l_alpha, _)) = (term("Cm_alpha")?, term("Cm_q")?, term("CL_alpha")?);
    let (m_alpha, m_q, l_alpha) = (m_alpha * speed * speed, m_q * speed, l_alpha * speed);
    let square = -(m_alpha + m_q * l_alpha);
    let frequency_rad_s = (square > 0.0).then(|| square.sqrt())?;
    Some(ShortPeriod { frequency_rad_s, damping: (l_alpha - m_q) / (2.0 * frequency_rad_s) })
}

impl ShortPeriod {
    /// A sentence about an input that is much slower or faster than the mode; `None` where its frequency suits.
    pub(crate) fn remark(&self, input: &SurfaceInput) -> Option<String> {
        let (own, mode) = (TAU * input.frequency_hz?, self.frequency_rad_s);
        let what = if own < mode / WITHIN {
            "slow"
        } else if own > mode * WITHIN {
            "fast"
        } else {
            return None;
        };
        Some(format!(
            "the {} input is {what} against the short period: most of its power is at {own:.2} rad/s, the mode at \
             {mode:.2} rad/s",
            input.surface
        ))
    }
}
