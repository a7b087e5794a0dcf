//! Whether the recorded positions of the surfaces are too noisy for the derivatives by them, after what could be smoothed
//! away has been: see [`crate::preparation::surface`].

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::preparation::surface::SurfaceNoise;

/// Share of the noise in the scatter of a surface from which its derivatives are called doubtful: a bias of one part in
/// a hundred is as large as what the bounds allow for the scale of a surface.
const DOUBTFUL: f64 = 0.01;

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
    use super::reason;
    use crate::preparation::surface::SurfaceNoise;

    #[test]
    fn a_surface_is_named_with_the_share_that_is_left() {
        let of = |share: f64, left: f64| vec![("elevator".to_owned(), SurfaceNoise { std: 1e-3, share, left })];
        let found = reason(&of(0.15, 0.02)).unwrap();
        assert!(found.sentence.contains("2 % of the scatter of elevator is noise even after smoothing"));
        assert!(reason(&of(0.15, 0.15)).unwrap().sentence.contains("15 % of the scatter of elevator is noise:"));
        assert!(reason(&of(0.05, 0.005)).is_none() && reason(&[]).is_none());
    }
}
