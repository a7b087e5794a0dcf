//! The band of frequencies in which a record tells something.

use nalgebra::{DMatrix, DVector};

use super::spectrum::lowest_hz;
use super::start::between_gaps;
use crate::core::options::Band;
use crate::preparation::noise::measure_noise;

/// Part of the energy of an input that lies in the band, at least; a step has the rest in edges that no aircraft follows.
const ENERGY: f64 = 0.99;
/// Power over that of the noise at which a signal still counts as seen.
const SEEN: f64 = 4.0;
/// Frequencies to each side over which the power is averaged for that.
const AROUND: usize = 2;
/// Fewest samples per period of the highest frequency: with fewer, differences and trapezia are no rates and means.
const PER_PERIOD: f64 = 6.0;
/// Fewest frequencies of the band.
const FEWEST: f64 = 8.0;

/// The band of a record, by its longest stretch between two gaps: from two periods in it up to where 99 % of the energy of
/// every input is passed, or no output stands out of its noise (power of five neighbouring frequencies below four times
/// that of the white noise of the channel), whichever is lower; a sixth of the sampling rate at most. `None` where no input
/// or no output moves, or the record has too few samples.
pub(crate) fn signal_band(time_s: &[f64], maximum_gap_s: f64, inputs: &[&[f64]], outputs: &[Vec<f64>]) -> Option<Band> {
    let stretches = between_gaps(time_s, maximum_gap_s);
    let low_hz = lowest_hz(time_s, &stretches);
    let length = |[from, to]: &[usize; 2]| time_s[to - 1] - time_s[*from];
    let [from, to] = stretches.into_iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let time_s = &time_s[from..to];
    let samples = time_s.len();
    let length_s = 2.0 / low_hz;
    if samples < 32 || !length_s.is_finite() {
        return None;
    }
    let rate_hz = (samples - 1) as f64 / (time_s[samples - 1] - time_s[0]);
    let highest = (rate_hz / PER_PERIOD * length_s).floor() as usize;
    // The frequencies of the whole stretch may lie closer than those of its parts: the spectrum is the same.
    let frequencies: Vec<f64> = (1..=highest).map(|cycle| cycle as f64 / length_s).collect();
    let signals: Vec<Vec<f64>> = inputs
        .iter()
        .map(|input| detrended(time_s, &input[from..to]))
        .chain(outputs.iter().map(|output| detrended(time_s, &output[from..to])))
        .collect();
    let power = powers(time_s, &signals, &frequencies);
    let noise = |signal: &[f64]| measure_noise(signal).map_or(0.0, |noise| noise.std).powi(2);
    let mut driven = 0.0_f64;
    for (input, power) in inputs.iter().zip(&power) {
        let floor = 2.0 * noise(&input[from..to]);
        let above: Vec<f64> = power.iter().map(|p| (p - floor).max(0.0)).collect();
        let all: f64 = above.iter().sum();
        let mut sum = 0.0;
        let passed = above.iter().position(|p| {
            sum += p;
            sum >= ENERGY * all
        });
        if all > 0.0 {
            driven = driven.max(passed.map_or(0.0, |k| frequencies[k]));
        }
    }
    let mut seen = 0.0_f64;
    for (output, power) in outputs.iter().zip(&power[inputs.len()..]) {
        let floor = 2.0 * noise(&output[from..to]);
        let mean = |k: usize| {
            let around = &power[k.saturating_sub(AROUND)..(k + AROUND + 1).min(power.len())];
            around.iter().sum::<f64>() / around.len() as f64
        };
        let last = (0..power.len()).rev().find(|&k| mean(k) > SEEN * floor && mean(k) > 0.0);
        seen = seen.max(last.map_or(0.0, |k| frequencies[k]));
    }
    let end = driven.min(seen);
    (end > 0.0).then_some(Band { low_hz, high_hz: end.max(low_hz + FEWEST / length_s) })
}

/// Without the cubic that fits best; missing values are zero then.
fn detrended(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
    let present: Vec<usize> = (0..values.len()).filter(|&k| values[k].is_finite()).collect();
    let at = |k: usize| 2.0 * (time_s[k] - first) / (last - first) - 1.0;
    let powers = DMatrix::from_fn(present.len(), 4, |row, order| at(present[row]).powi(order as i32));
    let right = DVector::from_iterator(present.len(), present.iter().map(|&k| values[k]));
    let Some(factor) = powers.tr_mul(&powers).cholesky() else { return vec![0.0; values.len()] };
    let solution = factor.solve(&powers.tr_mul(&right));
    let trend = |k: usize| (0..4).map(|order| solution[order as usize] * at(k).powi(order)).sum::<f64>();
    (0..values.len()).map(|k| if values[k].is_finite() { values[k] - trend(k) } else { 0.0 }).collect()
}

/// `2/n |sum v e^(-j w t)|^2` of each signal at each frequency: twice the variance for white noise.
fn powers(time_s: &[f64], signals: &[Vec<f64>], frequencies_hz: &[f64]) -> Vec<Vec<f64>> {
    let scale = 2.0 / time_s.len() as f64;
    let mut power = vec![Vec::with_capacity(frequencies_hz.len()); signals.len()];
    for frequency in frequencies_hz {
        let turns: Vec<(f64, f64)> =
            time_s.iter().map(|t| (std::f64::consts::TAU * frequency * (t - time_s[0])).sin_cos()).collect();
        for (signal, power) in signals.iter().zip(&mut power) {
            let sum = |part: fn(&(f64, f64)) -> f64| signal.iter().zip(&turns).map(|(v, t)| v * part(t)).sum::<f64>();
            power.push(scale * (sum(|t| t.0).powi(2) + sum(|t| t.1).powi(2)));
        }
    }
    power
}
