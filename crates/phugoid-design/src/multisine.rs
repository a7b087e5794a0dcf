//! Orthogonal phase-optimised multisines: many surfaces at once, each with frequencies of its own, and little peak for much
//! energy.
//!
//! ```text
//! u_j(t) = sum over k in K_j of A_k sin(2 pi k t/T + phi_k)          K_j disjoint: orthogonal over T, whatever the phases
//! ```
//!
//! Power is equal over a surface's harmonics; harmonics are dealt to the surfaces in turn, so that each has the whole band
//! (Morelli 2003, 2012). Phases start from M. R. Schroeder's (*IEEE Transactions on Information Theory* 16, 1970) and from
//! fixed random ones, and are then moved to the least peak through p-norms of rising order with Gauss-Newton steps (P.
//! Guillaume, J. Schoukens, R. Pintelon, I. Kollár, "Crest-factor minimization using nonlinear Chebyshev approximation methods",
//! *IEEE Transactions on Instrumentation and Measurement* 40(6), 1991); the start with the least relative peak factor wins. A
//! shift in time, which changes neither, lets every surface begin and end at zero.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::error::DesignError;
use phugoid_simulation::manoeuvre::Surface;

/// One component of a multisine, `amplitude sin(2 pi index t/T + phase)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Harmonic {
    /// Number of periods in the period of the multisine.
    pub index: u32,
    /// Frequency of the component, Hz: `index` divided by the period of the multisine.
    pub frequency_hz: f64,
    /// Amplitude as a part of the surface's peak.
    pub amplitude: f64,
    /// Phase of the component at the start of the multisine, rad.
    pub phase_rad: f64,
}

/// The multisine of one surface, peak one.
#[derive(Clone, Debug, PartialEq)]
pub struct Multisine {
    /// The surface that this multisine moves.
    pub surface: Surface,
    /// The components, in the order of their frequencies.
    pub harmonics: Vec<Harmonic>,
    /// `(max - min)/(2 sqrt(2) rms)`.
    pub relative_peak_factor: f64,
    /// The same with the phases of Schroeder alone, for comparison.
    pub schroeder_peak_factor: f64,
}

impl Multisine {
    /// Deflection at time `t` from the start, peak one; zero outside of one period.
    pub fn at(&self, t: f64, period: f64) -> f64 {
        if t < -1e-9 || t > period + 1e-9 {
            return 0.0;
        }
        self.harmonics.iter().map(|h| h.amplitude * (TAU * f64::from(h.index) * t / period + h.phase_rad).sin()).sum()
    }
}

/// Multisines of several surfaces with one period.
#[derive(Clone, Debug, PartialEq)]
pub struct MultisineSet {
    /// Period, s: a whole number of samples.
    pub period_s: f64,
    /// The multisines, one per surface, in the order of the surfaces that were asked for.
    pub inputs: Vec<Multisine>,
}

/// Designs the multisines for surfaces in a band (Hz) within `available` seconds.
///
/// # Errors
/// [`DesignError::Unsuitable`] if the band holds fewer harmonics than surfaces.
pub fn design(
    surfaces: &[Surface],
    [low, high]: [f64; 2],
    available: f64,
    sample_rate_hz: f64,
) -> Result<MultisineSet, DesignError> {
    let period_s = (available * sample_rate_hz + 1e-9).floor() / sample_rate_hz;
    // Two periods of the slowest one at least (Morelli 2012): with less its derivatives are guesses.
    let first = ((low * period_s - 1e-9).ceil()).max(2.0) as u32;
    let last = (high * period_s + 1e-9).floor() as u32;
    let count = (last + 1).saturating_sub(first) as usize;
    if count < surfaces.len() {
        return Err(DesignError::Unsuitable(format!(
            "the band {low:.3} to {high:.3} Hz holds {count} harmonics of {period_s:.2} s for {} surfaces: lengthen the \
             duration or widen the band",
            surfaces.len()
        )));
    }
    let inputs = surfaces
        .iter()
        .enumerate()
        .map(|(k, surface)| {
            let indices: Vec<u32> = (first..=last).skip(k).step_by(surfaces.len()).collect();
            optimised(*surface, &indices, period_s)
        })
        .collect();
    Ok(MultisineSet { period_s, inputs })
}

/// Starts beside Schroeder's phases.
const RANDOM_STARTS: u64 = 11;

fn optimised(surface: Surface, indices: &[u32], period_s: f64) -> Multisine {
    let schroeder = schroeder(indices.len());
    let schroeder_peak_factor = peak_factor(indices, &schroeder);
    let random = (0..RANDOM_STARTS).map(|seed| {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        indices.iter().map(|_| TAU * random.random::<f64>()).collect::<Vec<f64>>()
    });
    let mut best = (schroeder_peak_factor, schroeder.clone());
    for start in std::iter::once(schroeder).chain(random) {
        let phases = least_peak(indices, start);
        let factor = peak_factor(indices, &phases);
        if factor < best.0 {
            best = (factor, phases);
        }
    }
    let (relative_peak_factor, mut phases) = best;
    start_at_zero(indices, &mut phases);
    // Equal powers, peak one.
    let peak = dense(indices, &phases).iter().fold(0.0_f64, |peak, v| peak.max(v.abs()));
    let harmonics = indices
        .iter()
        .zip(&phases)
        .map(|(index, phase)| Harmonic {
            index: *index,
            frequency_hz: f64::from(*index) / period_s,
            amplitude: 1.0 / peak,
            phase_rad: phase.rem_euclid(TAU),
        })
        .collect();
    Multisine { surface, harmonics, relative_peak_factor, schroeder_peak_factor }
}

/// `phi_n = -pi n^2/N` for equal powers.
fn schroeder(count: usize) -> Vec<f64> {
    (0..count).map(|n| -std::f64::consts::PI * (n * n) as f64 / count as f64).collect()
}

/// One period of the sum of unit sines, `per_period` samples for each period of the fastest.
fn sampled(indices: &[u32], phases: &[f64], per_period: usize) -> Vec<f64> {
    let samples = per_period * indices.last().copied().unwrap_or(1).max(1) as usize;
    let at = |t: f64| indices.iter().zip(phases).map(|(k, phase)| (TAU * f64::from(*k) * t + phase).sin()).sum();
    (0..samples).map(|i| at(i as f64 / samples as f64)).collect()
}

fn dense(indices: &[u32], phases: &[f64]) -> Vec<f64> {
    sampled(indices, phases, 64)
}

fn peak_factor(indices: &[u32], phases: &[f64]) -> f64 {
    let signal = dense(indices, phases);
    let (low, high) = signal.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
    // The rms of n unit sines is sqrt(n/2).
    (high - low) / (2.0 * SQRT_2 * (indices.len() as f64 / 2.0).sqrt())
}

/// Phases of a local least peak: Gauss-Newton with Levenberg-Marquardt damping on `sum (u/peak)^(2p)`, p = 2, 4, ... 64.
fn least_peak(indices: &[u32], mut phases: Vec<f64>) -> Vec<f64> {
    const PER_PERIOD: usize = 12;
    let n = indices.len();
    if n < 2 {
        return phases;
    }
    for p in [2, 4, 8, 16, 32, 64] {
        let mut damping = 1e-3;
        let peak = |signal: &[f64]| signal.iter().fold(0.0_f64, |peak, v| peak.max(v.abs()));
        let scale = peak(&sampled(indices, &phases, PER_PERIOD));
        let cost = |phases: &[f64]| -> f64 {
            sampled(indices, phases, PER_PERIOD).iter().map(|u| (u / scale).powi(2 * p)).sum()
        };
        let mut now = cost(&phases);
        for _ in 0..25 {
            let signal = sampled(indices, &phases, PER_PERIOD);
            let samples = signal.len() as f64;
            let (mut normal, mut gradient) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
            for (i, u) in signal.iter().enumerate() {
                let value = u / scale;
                // Far below the peak nothing weighs.
                if value.abs() < 0.3 && p > 4 {
                    continue;
                }
                let slope = f64::from(p) * value.powi(p - 1) / scale;
                let t = i as f64 / samples;
                let row = DVector::from_fn(n, |k, _| slope * (TAU * f64::from(indices[k]) * t + phases[k]).cos());
                gradient.axpy(value.powi(p), &row, 1.0);
                normal.ger(1.0, &row, &row, 1.0);
            }
            let mean = normal.trace() / n as f64;
            let mut improved = false;
            while damping < 1e6 {
                let damped = &normal + DMatrix::identity(n, n) * (damping * mean);
                let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else { break };
                let trial: Vec<f64> = phases.iter().zip(step.iter()).map(|(phase, s)| phase - s).collect();
                let next = cost(&trial);
                if next < now {
                    improved = next < now * (1.0 - 1e-6);
                    (phases, now) = (trial, next);
                    damping = (damping * 0.2).max(1e-9);
                    break;
                }
                damping *= 5.0;
            }
            if !improved {
                break;
            }
        }
    }
    phases
}

/// Shifts the signal in time so that it starts, and after one period ends, at a rising zero.
fn start_at_zero(indices: &[u32], phases: &mut [f64]) {
    let value = |t: f64, phases: &[f64]| -> f64 {
        indices.iter().zip(phases).map(|(k, phase)| (TAU * f64::from(*k) * t + phase).sin()).sum()
    };
    let signal = dense(indices, phases);
    let samples = signal.len();
    let rising = (0..samples).find(|i| signal[*i] <= 0.0 && signal[(i + 1) % samples] > 0.0);
    let Some(i) = rising else { return };
    let (mut low, mut high) = (i as f64 / samples as f64, (i + 1) as f64 / samples as f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if value(middle, phases) > 0.0 { high = middle } else { low = middle }
    }
    for (phase, k) in phases.iter_mut().zip(indices) {
        *phase += TAU * f64::from(*k) * low;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> MultisineSet {
        design(&[Surface::Elevator, Surface::Aileron, Surface::Rudder], [0.1, 1.5], 20.0, 50.0).unwrap()
    }

    /// Disjoint harmonics of one period: the inner products vanish to rounding, and with them the confusion of surfaces.
    #[test]
    fn surfaces_are_orthogonal() {
        let set = three();
        let signals: Vec<Vec<f64>> =
            set.inputs.iter().map(|m| (0..1000).map(|k| m.at(f64::from(k) / 50.0, set.period_s)).collect()).collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for i in 0..3 {
            for j in 0..i {
                let size = (product(&signals[i], &signals[i]) * product(&signals[j], &signals[j])).sqrt();
                assert!((product(&signals[i], &signals[j]) / size).abs() < 1e-9, "{i} {j}");
            }
        }
        let used: Vec<u32> = set.inputs.iter().flat_map(|m| m.harmonics.iter().map(|h| h.index)).collect();
        let mut sorted = used.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), used.len());
    }

    /// Morelli (2012) gives relative peak factors of 1.0 to 1.2 after optimisation; a random sum of ten sines has about 1.7.
    #[test]
    fn phases_are_better_than_schroeders_and_as_good_as_published() {
        for m in three().inputs {
            let (found, start) = (m.relative_peak_factor, m.schroeder_peak_factor);
            assert!(found < start && found < 1.2, "{:?}: {found} from {start}", m.surface);
        }
    }

    #[test]
    fn every_surface_starts_and_ends_at_zero_with_a_peak_of_one() {
        let set = three();
        for m in &set.inputs {
            assert!(m.at(0.0, set.period_s).abs() < 1e-9 && m.at(set.period_s, set.period_s).abs() < 1e-9);
            let peak = (0..20_000).map(|k| m.at(f64::from(k) / 1000.0, 20.0).abs()).fold(0.0, f64::max);
            assert!((peak - 1.0).abs() < 2e-3, "{peak}");
            assert_eq!(m.at(20.5, 20.0), 0.0);
        }
    }

    #[test]
    fn a_band_too_narrow_is_told() {
        let surfaces = [Surface::Elevator, Surface::Aileron, Surface::Rudder];
        let message = design(&surfaces, [0.1, 0.15], 20.0, 50.0).unwrap_err().to_string();
        assert!(message.contains("2 harmonics") && message.contains("3 surfaces"), "{message}");
    }
}
