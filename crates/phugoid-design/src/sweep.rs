//! Frequency sweeps.

use std::f64::consts::TAU;

use super::modes::ModeFrequencies;
use super::{DesignError, Request, SurfaceInput, relative_peak_factor};

/// One sweep per surface, one after another.
///
/// The frequency runs from the lower to the upper end of the band, with equal time per octave
/// (`f = f0 (f1/f0)^(t/T)`) or linearly. The ends are faded by half a cosine over half a period of the lowest frequency, at most
/// a tenth of the sweep, so that it starts and ends at rest.
pub(super) fn sweeps(
    time: &[f64],
    request: &Request,
    modes: &ModeFrequencies,
    [low, high]: [f64; 2],
) -> Result<Vec<SurfaceInput>, DesignError> {
    let each = (request.duration_s - request.lead_s) / request.surfaces.len() as f64;
    if each * low < 1.0 {
        return Err(DesignError::Unsuitable(format!(
            "a sweep of {each:.1} s holds no whole period of its lowest frequency, {low:.3} Hz: lengthen the duration, move fewer \
             surfaces or raise the lower frequency"
        )));
    }
    let fade = (0.5 / low).min(0.1 * each);
    let phase = |t: f64| {
        if request.linear_sweep {
            TAU * (low * t + 0.5 * (high - low) * t * t / each)
        } else {
            let ratio = (high / low).ln();
            TAU * low * each / ratio * ((t / each * ratio).exp() - 1.0)
        }
    };
    let window = |t: f64| {
        let from_end = t.min(each - t);
        if from_end >= fade { 1.0 } else { 0.5 - 0.5 * (std::f64::consts::PI * from_end / fade).cos() }
    };
    let input = |(k, surface): (usize, &phugoid_simulation::manoeuvre::Surface)| {
        let start = request.lead_s + k as f64 * each;
        let at = |t: f64| if (0.0..=each).contains(&t) { window(t) * phase(t).sin() } else { 0.0 };
        let mut deflection: Vec<f64> = time.iter().map(|t| at(t - start)).collect();
        let peak = deflection.iter().fold(0.0_f64, |peak, d| peak.max(d.abs()));
        deflection.iter_mut().for_each(|d| *d /= peak);
        SurfaceInput {
            surface: *surface,
            relative_peak_factor: relative_peak_factor(&deflection),
            deflection,
            mode_rad_s: modes.of(*surface),
            pulse_width_s: None,
            harmonics: Vec::new(),
        }
    };
    Ok(request.surfaces.iter().enumerate().map(input).collect())
}
