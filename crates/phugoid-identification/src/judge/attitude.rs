//! Whether the filter follows the attitude at all. Attitude is measured to a fraction of a degree and changes by nothing
//! but the rates: levels that are learnt in flight grow where a filter has lost the motion, as after a change that it
//! could not settle, and residuals then look as they should again.

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::core::output::Output;

/// Ratio of the learnt level to the noise of the record from which the motion counts as lost. On foreign flights
/// (docs/field.md) every flight above it had wrong derivatives or was refused anyhow; right ones reached 41, in
/// turbulence and in a slow phugoid.
const LOST: f64 = 50.0;

/// Noise of an attitude below which the ratio says nothing, rad (0.02 deg): a channel that was smoothed or interpolated before it was
/// recorded shows none, and no model follows the attitude to thousandths of a degree.
const LEAST_NOISE: f64 = 3.5e-4;

/// Names the attitude angles that the filter does not follow. `levels` are the measured outputs, each with the noise that
/// the record or the model file gives and the level of its residual that was learnt, rad.
pub(super) fn reason(levels: impl Iterator<Item = (Output, f64, f64)>) -> Option<VerdictReason> {
    let lost: Vec<(Output, f64, f64)> = levels
        .filter(|(output, noise, learnt)| {
            matches!(output, Output::Phi | Output::Theta) && *noise > 0.0 && *learnt > LOST * noise.max(LEAST_NOISE)
        })
        .collect();
    let list: Vec<String> = lost
        .iter()
        .map(|(output, noise, learnt)| {
            format!(
                "{} is predicted to {:.1} deg (one sigma), and its noise is {:.2} deg",
                output.name(),
                learnt.to_degrees(),
                noise.to_degrees()
            )
        })
        .collect();
    (!list.is_empty()).then(|| VerdictReason {
        code: ReasonCode::Contradiction,
        status: EstimationStatus::Refused,
        concerns: lost.iter().map(|(output, ..)| output.name().to_owned()).collect(),
        sentence: format!(
            "The model does not follow the motion: {}. Did the aircraft change in flight? Then estimate the parts of the \
             record before and after it (--from, --to). Else look for motion of the other axes or forces that are not \
             recorded.",
            list.join("; ")
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::reason;
    use crate::core::output::Output;

    #[test]
    fn an_attitude_that_is_missed_by_degrees_is_named() {
        let of = |output: Output, noise: f64, learnt: f64| reason([(output, noise, learnt)].into_iter());
        let found = of(Output::Theta, 0.0017, 0.0863).unwrap();
        assert!(
            found.sentence.contains("theta is predicted to 4.9 deg (one sigma), and its noise is 0.10 deg"),
            "{found:?}"
        );
        // A smoothed channel shows no noise.
        assert!(of(Output::Theta, 1e-7, 0.002).is_none() && of(Output::Theta, 1e-7, 0.02).is_some());
        assert!(of(Output::Phi, 0.001, 0.051).is_some() && of(Output::Phi, 0.001, 0.049).is_none());
        // Gusts move the other outputs, and a channel without noise tells nothing.
        assert!(of(Output::PitchRate, 0.001, 0.1).is_none() && of(Output::Theta, 0.0, 0.1).is_none());
    }
}
