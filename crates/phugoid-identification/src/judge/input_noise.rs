//! Whether the recorded positions of the surfaces are too noisy for the derivatives by them, after what could be smoothed
//! away has been: see [`crate::preparation::surface`].

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::preparation::surface::{SurfaceNoise, WildValues};

/// Share of the noise in the scatter of a surface from which its derivatives are called doubtful: a bias of one part in
/// a hundred is as large as what the bounds allow for the scale of a surface.
const DOUBTFUL: f64 = 0.01;

/// From so many values on that may be wild they are no single pulse that a pilot flew, ...
const MANY: usize = 3;
/// ... and from this share in the scatter of the surface on they decide its derivatives: the bias of less is about what the bounds
/// allow for the scale of a surface (3 %).
const DECISIVE: f64 = 0.03;

/// Names the surfaces that go away and come back within one or two samples, too often and too far for what was flown.
pub(super) fn wild(surfaces: &[WildValues]) -> Option<VerdictReason> {
    let wild: Vec<&WildValues> = surfaces.iter().filter(|s| s.count >= MANY && s.share > DECISIVE).collect();
    if wild.is_empty() {
        return None;
    }
    let list: Vec<String> = wild
        .iter()
        .map(|s| {
            let share = 100.0 * s.share;
            format!(
                "{} times the {} goes away and is back after one or two samples, which is {share:.0} % of its motion",
                s.count, s.surface
            )
        })
        .collect();
    Some(VerdictReason {
        code: ReasonCode::InputNoise,
        status: EstimationStatus::Doubtful,
        concerns: wild.iter().map(|s| s.surface.clone()).collect(),
        sentence: format!(
            "In the record {}. If these are wild values of the recorder, the aircraft does not answer to them, and the derivatives by \
             the surface come out too small: look at the channel, take them out, or fly pulses of three samples and more.",
            list.join(", ")
        ),
    })
}

/// Names the surfaces that are too noisy. `surfaces` are their names and noise.
pub(super) fn reason(surfaces: &[(String, SurfaceNoise)]) -> Option<VerdictReason> {
    let noisy: Vec<&(String, SurfaceNoise)> = surfaces.iter().filter(|(_, noise)| noise.left > DOUBTFUL).collect();
    if noisy.is_empty() {
        return None;
    }
    let list: Vec<String> = noisy
        .iter()
        .map(|(name, noise)| {
            let smoothed = if noise.left < noise.share { " even after smoothing" } else { "" };
            format!("{:.0} % of the scatter of {name} is noise{smoothed}", 100.0 * noise.left)
        })
        .collect();
    Some(VerdictReason {
        code: ReasonCode::InputNoise,
        status: EstimationStatus::Doubtful,
        concerns: noisy.iter().map(|(name, _)| name.clone()).collect(),
        sentence: format!(
            "{}: derivatives by a noisy surface come out too small by about that share, and others make up for it. \
             Record the position with less noise, use the command that drives the surface, or fly larger inputs.",
            list.join(", ")
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::{reason, wild};
    use crate::preparation::surface::{SurfaceNoise, WildValues};

    #[test]
    fn a_surface_is_named_with_the_share_that_is_left() {
        let of = |share: f64, left: f64| vec![("elevator".to_owned(), SurfaceNoise { std: 1e-3, share, left })];
        let found = reason(&of(0.15, 0.02)).unwrap();
        assert!(found.sentence.contains("2 % of the scatter of elevator is noise even after smoothing"));
        assert!(reason(&of(0.15, 0.15)).unwrap().sentence.contains("15 % of the scatter of elevator is noise:"));
        assert!(reason(&of(0.05, 0.005)).is_none() && reason(&[]).is_none());
    }

    #[test]
    fn many_wild_values_are_named_and_a_pulse_is_not() {
        let of = |count: usize, share: f64| wild(&[WildValues { surface: "elevator".to_owned(), count, share }]);
        assert!(of(6, 0.4).unwrap().sentence.contains("6 times the elevator goes away"));
        assert_eq!((of(2, 0.4), of(6, 0.01), wild(&[])), (None, None, None));
    }
}
