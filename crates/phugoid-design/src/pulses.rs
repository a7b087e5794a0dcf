//! Doublets and 3-2-1-1 whose width follows from the mode.

use super::modes::ModeFrequencies;
use super::{DesignError, Request, SurfaceInput, relative_peak_factor};

/// A multistep of pulses of alternating sign.
pub(super) struct Multistep {
    name: &'static str,
    /// Lengths of the pulses in units.
    units: &'static [f64],
    /// Natural frequency of the mode times the unit.
    frequency_times_unit: f64,
}

/// The spectrum of a doublet, `sin^2(w dt/2)/(w dt/2)`, has its maximum where `tan y = 2 y`, y = `w dt`/2 = 1.166.
pub(super) const DOUBLET: Multistep = Multistep { name: "doublet", units: &[1.0, 1.0], frequency_times_unit: 2.33 };

/// The energy spectrum of a 3-2-1-1 is wide, above half of its maximum from `w dt` = 0.3 to 2.6 (with a shallow dip about 1.2
/// that stays above it); 1.6 is its centre (Jategaonkar, section 2.3.2: the unit is about a quarter of the period).
pub(super) const THREE_TWO_ONE_ONE: Multistep =
    Multistep { name: "3-2-1-1", units: &[3.0, 2.0, 1.0, 1.0], frequency_times_unit: 1.6 };

/// One multistep after another, each followed by a period of its mode to let it ring, the surfaces in turn and the sign
/// changed from round to round, as long as the time lasts.
pub(super) fn trains(
    time: &[f64],
    request: &Request,
    modes: &ModeFrequencies,
    multistep: &Multistep,
) -> Result<Vec<SurfaceInput>, DesignError> {
    let h = 1.0 / request.sample_rate_hz;
    let plan: Vec<(f64, f64)> = request
        .surfaces
        .iter()
        .map(|surface| {
            let mode = modes.of(*surface);
            // Commands change at the samples; a pulse shorter than one cannot be flown.
            let unit = ((multistep.frequency_times_unit / mode / h).round() * h).max(h);
            (unit, multistep.units.iter().sum::<f64>() * unit + std::f64::consts::TAU / mode)
        })
        .collect();
    let round: f64 = plan.iter().map(|(_, length)| length).sum();
    let available = request.duration_s - request.lead_s;
    let rounds = (available / round + 1e-9) as usize;
    if rounds == 0 {
        return Err(DesignError::Unsuitable(format!(
            "a {} of each surface with the time to ring takes {round:.1} s, and there are {available:.1} s: lengthen the \
             duration, or move fewer surfaces",
            multistep.name
        )));
    }
    let mut inputs: Vec<SurfaceInput> = Vec::new();
    for (k, surface) in request.surfaces.iter().enumerate() {
        let (unit, _) = plan[k];
        let before: f64 = plan[..k].iter().map(|(_, length)| length).sum();
        let mut deflection = vec![0.0; time.len()];
        for turn in 0..rounds {
            let mut from = request.lead_s + turn as f64 * round + before;
            // The first pulse of each round has the other sign: what one leaves behind, the next one takes away.
            let mut sign = if turn % 2 == 0 { 1.0 } else { -1.0 };
            for units in multistep.units {
                let to = from + units * unit;
                let inside = |t: f64| t >= from - 0.25 * h && t < to - 0.25 * h;
                time.iter().zip(&mut deflection).filter(|(t, _)| inside(**t)).for_each(|(_, d)| *d = sign);
                (from, sign) = (to, -sign);
            }
        }
        inputs.push(SurfaceInput {
            surface: *surface,
            relative_peak_factor: relative_peak_factor(&deflection),
            deflection,
            mode_rad_s: modes.of(*surface),
            pulse_width_s: Some(unit),
            harmonics: Vec::new(),
        });
    }
    Ok(inputs)
}
