//! Whether the recorded positions of the surfaces are too noisy for the derivatives by them.
//!
//! The estimators take the known inputs as exact. White noise on a recorded position is taken for motion, to which the
//! aircraft does not answer: the derivative by the surface comes out too small by about the share of the noise in the
//! scatter of the signal (errors in variables; W. A. Fuller, *Measurement Error Models*, 1987, ch. 1), and those whose
//! regressors move with the surface are wrong by as much of its part. Residuals hardly show it.

use crate::core::axes::Axes;
use crate::core::estimation::{EstimationStatus, ReasonCode, Signal, VerdictReason};
use crate::preparation::noise::measure_noise;

/// Share of the noise in the scatter of a surface from which its derivatives are called doubtful: a bias of one part in
/// a hundred is as large as what the bounds allow for the scale of a surface.
const DOUBTFUL: f64 = 0.01;

/// The share of white noise in the scatter of a signal; zero for noise below the step of the recorder, and for a signal
/// that stands still.
fn share(values: &[f64]) -> f64 {
    let Some(noise) = measure_noise(values).filter(|noise| !noise.quantised) else { return 0.0 };
    let present: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let n = present.len() as f64;
    let mean = present.iter().sum::<f64>() / n;
    let variance = present.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    if variance > 0.0 { (noise.std * noise.std / variance).min(1.0) } else { 0.0 }
}

/// Names the surfaces that are too noisy. `known` are the known inputs by name.
pub(super) fn reason(known: &[Signal]) -> Option<VerdictReason> {
    let surfaces = known.iter().filter(|signal| Axes::SURFACES.contains(&signal.name.as_str()));
    let noisy: Vec<(&Signal, f64)> =
        surfaces.map(|signal| (signal, share(&signal.values))).filter(|(_, share)| *share > DOUBTFUL).collect();
    if noisy.is_empty() {
        return None;
    }
    let list: Vec<String> = noisy
        .iter()
        .map(|(signal, share)| format!("{:.0} % of the scatter of {} is noise", 100.0 * share, signal.name))
        .collect();
    Some(VerdictReason {
        code: ReasonCode::InputNoise,
        status: EstimationStatus::Doubtful,
        concerns: noisy.iter().map(|(signal, _)| signal.name.clone()).collect(),
        sentence: format!(
            "{}: derivatives by a noisy surface come out too small by about that share, and others make up for it. \
             Record the position with less noise, use the command that drives the surface, or fly larger inputs.",
            list.join(", ")
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::{reason, share};
    use crate::core::estimation::Signal;

    fn surface(noise: f64) -> Vec<f64> {
        // A square wave of one degree, and noise of a congruential generator.
        let mut seed = 7_u64;
        let mut uniform = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..2000)
            .map(|k| if (k / 100) % 2 == 0 { 0.0175 } else { -0.0175 } + noise * 12_f64.sqrt() * uniform())
            .collect()
    }

    #[test]
    fn a_noisy_surface_is_named_with_its_share_and_a_clean_one_is_not() {
        let noisy = surface(0.00525);
        // 0.3 of the amplitude: 9 % over 109 %; the third differences of uniform noise tell it to some per cent.
        assert!((share(&noisy) / (0.09 / 1.09) - 1.0).abs() < 0.25, "{}", share(&noisy));
        let signal = |values: Vec<f64>| Signal { name: "elevator".to_owned(), unit: "rad".to_owned(), values };
        let found = reason(&[signal(noisy)]).unwrap();
        assert!(found.sentence.contains("of the scatter of elevator is noise"), "{}", found.sentence);
        assert!(reason(&[signal(surface(0.0002)), signal(vec![0.01; 500])]).is_none());
    }
}
