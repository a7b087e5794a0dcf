//! Cross spectra of several signals by sine tapers, and the coherences that follow from them.
//!
//! The sine tapers (K. S. Riedel, A. Sidorenko, *Minimum bias multiple taper spectral estimation*, IEEE Trans. Signal
//! Process. 43, 1995) `h_k(n) = sqrt(2/(N+1)) sin(pi k n/(N+1))`, `n = 1..N`, are orthonormal: of white noise the
//! transforms with `K` of them are `K` independent complex normal numbers. `K` tapers see a band of the width
//! `(K+1)/((N+1) dt)`. Because a sine is the difference of two exponentials, the transform with each taper is the
//! difference of two values of one plain transform.

use nalgebra::{Complex, DMatrix};

/// Part of its power that must be left in a signal after others are taken out of it. Below, what is left is rounding.
const LEFT: f64 = 1e-9;

/// Sums of cross spectra over tapers and stretches, at a few frequencies.
pub(super) struct CrossSpectra {
    frequencies_hz: Vec<f64>,
    bandwidth_hz: f64,
    sums: Vec<DMatrix<Complex<f64>>>,
    averages: usize,
}

/// The number of tapers that see at most a band of this width (Hz) in a stretch of `samples` with one step (s).
pub(super) fn tapers(samples: usize, step_s: f64, bandwidth_hz: f64) -> usize {
    // A band is as wide as asked for within rounding.
    let product = bandwidth_hz * (samples + 1) as f64 * step_s + 1e-9;
    // As many tapers as there are samples would be the whole space.
    (product.floor() as usize).saturating_sub(1).min(samples / 4)
}

impl CrossSpectra {
    /// Of so many signals, at these frequencies (Hz), averaged over bands of this width (Hz).
    pub(super) fn new(signals: usize, frequencies_hz: Vec<f64>, bandwidth_hz: f64) -> Self {
        let sums = vec![DMatrix::zeros(signals, signals); frequencies_hz.len()];
        Self { frequencies_hz, bandwidth_hz, sums, averages: 0 }
    }

    /// Adds one stretch: the signals, equally long, finite, with one step (s). Their straight trends are taken out.
    pub(super) fn add(&mut self, signals: &[Vec<f64>], step_s: f64) {
        let samples = signals.first().map_or(0, Vec::len);
        let count = tapers(samples, step_s, self.bandwidth_hz);
        if count == 0 || signals.iter().any(|signal| signal.len() != samples) {
            return;
        }
        self.averages += count;
        // The grid on which all tapers have their lines.
        let line_hz = 0.5 / ((samples + 1) as f64 * step_s);
        let grid: Vec<usize> = self.frequencies_hz.iter().map(|f| (f / line_hz).round() as usize).collect();
        let first = grid.iter().min().copied().unwrap_or(0).saturating_sub(count);
        let last = grid.iter().max().copied().unwrap_or(0) + count;
        let turns = line_hz * step_s;
        let transforms: Vec<Vec<Complex<f64>>> = signals
            .iter()
            .map(|signal| {
                let signal = without_trend(signal);
                (first..=last).map(|line| transform(&signal, turns * line as f64)).collect()
            })
            .collect();
        // A line below zero is the conjugate of the one above.
        let at = |signal: usize, line: isize| {
            let value = transforms[signal][line.unsigned_abs().saturating_sub(first)];
            if line < 0 { value.conj() } else { value }
        };
        for (sum, &line) in self.sums.iter_mut().zip(&grid) {
            for taper in 1..=count {
                let (line, taper) = (line as isize, taper as isize);
                let seen: Vec<Complex<f64>> =
                    (0..signals.len()).map(|i| at(i, line - taper) - at(i, line + taper)).collect();
                // 1/(2i) sqrt(2/(N+1)): the phase is that of all signals and cancels.
                let weight = 0.5 / (samples + 1) as f64;
                for (i, a) in seen.iter().enumerate() {
                    for (j, b) in seen.iter().enumerate() {
                        sum[(i, j)] += a.conj() * b * weight;
                    }
                }
            }
        }
    }

    /// Number of independent complex averages, tapers times stretches: half the degrees of freedom.
    pub(super) fn averages(&self) -> usize {
        self.averages
    }

    /// Magnitude-squared coherence of two signals after the linear effect of others is taken out of both, at each
    /// frequency; with no others the ordinary coherence. `None` where too little of a signal is left at a frequency.
    pub(super) fn partial(&self, one: usize, other: usize, given: &[usize]) -> Option<Vec<f64>> {
        self.sums
            .iter()
            .map(|sum| {
                let left = residual(sum, &[one, other], given)?;
                let (a, b) = (left[(0, 0)].re, left[(1, 1)].re);
                let enough = a > LEFT * sum[(one, one)].re && b > LEFT * sum[(other, other)].re;
                enough.then(|| (left[(0, 1)].norm_sqr() / (a * b)).clamp(0.0, 1.0))
            })
            .collect()
    }

    /// Part of the power of a signal that is linear in all these inputs together, at each frequency.
    pub(super) fn multiple(&self, inputs: &[usize], output: usize) -> Option<Vec<f64>> {
        self.sums
            .iter()
            .map(|sum| {
                let whole = sum[(output, output)].re;
                let left = residual(sum, &[output], inputs)?[(0, 0)].re;
                (whole > 0.0).then(|| (1.0 - left / whole).clamp(0.0, 1.0))
            })
            .collect()
    }
}

/// The cross spectra of some signals after the linear effect of others is taken out: `S_aa - S_ao S_oo^-1 S_oa`. `None`
/// if the others cannot be told from each other.
fn residual(sum: &DMatrix<Complex<f64>>, of: &[usize], given: &[usize]) -> Option<DMatrix<Complex<f64>>> {
    let block = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, j| sum[(rows[i], columns[j])])
    };
    let own = block(of, of);
    if own.diagonal().iter().any(|power| power.re.is_nan() || power.re <= 0.0) {
        return None;
    }
    if given.is_empty() {
        return Some(own);
    }
    // In units of their own power, so that the pivots say how much of each is left.
    let scale: Vec<f64> = given.iter().map(|&i| sum[(i, i)].re.sqrt()).collect();
    if scale.iter().any(|power| power.is_nan() || *power <= 0.0) {
        return None;
    }
    let mut known = block(given, given);
    let mut with = block(given, of);
    for (i, a) in scale.iter().enumerate() {
        for (j, b) in scale.iter().enumerate() {
            known[(i, j)] /= a * b;
        }
        for j in 0..of.len() {
            with[(i, j)] /= *a;
        }
    }
    let factor = known.cholesky()?;
    if factor.l().diagonal().iter().any(|pivot| pivot.re * pivot.re < LEFT) {
        return None;
    }
    Some(own - with.adjoint() * factor.solve(&with))
}

/// `sum x_n exp(-2 pi i turns n)`, `n = 1..N` as the tapers count, by a rotating factor that is set anew before its
/// rounding grows.
fn transform(signal: &[f64], turns: f64) -> Complex<f64> {
    const ANEW: usize = 256;
    let angle = -std::f64::consts::TAU * turns;
    let step = Complex::from_polar(1.0, angle);
    let mut sum = Complex::new(0.0, 0.0);
    for (block, values) in signal.chunks(ANEW).enumerate() {
        let mut factor = Complex::from_polar(1.0, angle * (block * ANEW + 1) as f64);
        for value in values {
            sum += factor * *value;
            factor *= step;
        }
    }
    sum
}

/// The signal less its straight line of least squares.
fn without_trend(signal: &[f64]) -> Vec<f64> {
    let n = signal.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = signal.iter().sum::<f64>() / n;
    let at = |k: usize| k as f64 - middle;
    let spread: f64 = (0..signal.len()).map(|k| at(k) * at(k)).sum();
    let slope = if spread > 0.0 {
        signal.iter().enumerate().map(|(k, v)| at(k) * (v - mean)).sum::<f64>() / spread
    } else {
        0.0
    };
    signal.iter().enumerate().map(|(k, v)| v - mean - slope * at(k)).collect()
}

/// The probability that an estimated multiple coherence of this many inputs, of `averages` averages, exceeds `value`
/// where the true one is zero: `sum_(j<m) C(K-1, j) x^j (1-x)^(K-1-j)`, the beta distribution with `m` and `K - m` (N. R.
/// Goodman, *Statistical analysis based on a certain multivariate complex Gaussian distribution*, Ann. Math. Stat. 34,
/// 1963). With one input it is `(1-x)^(K-1)`; a partial coherence given `o` others has `K - o` in place of `K`.
pub(super) fn chance(value: f64, inputs: usize, averages: usize) -> f64 {
    let n = averages.saturating_sub(1);
    if inputs == 0 || inputs > n {
        return 1.0;
    }
    let (x, rest) = (value.clamp(0.0, 1.0), 1.0 - value.clamp(0.0, 1.0));
    let mut binomial = 1.0;
    let mut sum = 0.0;
    for j in 0..inputs {
        sum += binomial * x.powi(j as i32) * rest.powi((n - j) as i32);
        binomial *= (n - j) as f64 / (j + 1) as f64;
    }
    sum.min(1.0)
}

/// The coherence that noise alone exceeds with this probability ([`chance`]), by bisection.
pub(super) fn level(probability: f64, inputs: usize, averages: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if chance(middle, inputs, averages) > probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::coherence::testing::Random;

    const STEP_S: f64 = 0.05;

    fn spectra(signals: &[Vec<f64>], frequencies: Vec<f64>, bandwidth: f64) -> CrossSpectra {
        let mut spectra = CrossSpectra::new(signals.len(), frequencies, bandwidth);
        spectra.add(signals, STEP_S);
        spectra
    }

    /// The definition, in place of the difference of two lines.
    #[test]
    fn the_spectra_are_those_of_the_sine_tapers() {
        let mut random = Random::new(3);
        let signals = [random.normals(150), random.normals(150)];
        let bandwidth = 6.0 / (151.0 * STEP_S);
        let line = 0.5 / (151.0 * STEP_S);
        for steps in [2.0, 9.0, 77.0] {
            let frequency = steps * line;
            let found = spectra(&signals, vec![frequency], bandwidth);
            assert_eq!(found.averages(), 5);
            let clean: Vec<Vec<f64>> = signals.iter().map(|s| without_trend(s)).collect();
            let mut wanted = DMatrix::zeros(2, 2);
            for k in 1..=5 {
                let seen: Vec<Complex<f64>> = clean
                    .iter()
                    .map(|signal| {
                        signal
                            .iter()
                            .enumerate()
                            .map(|(n, value)| {
                                let place = (n + 1) as f64;
                                let taper = (2.0 / 151.0_f64).sqrt()
                                    * (std::f64::consts::PI * f64::from(k) * place / 151.0).sin();
                                Complex::from_polar(taper * value, -std::f64::consts::TAU * frequency * STEP_S * place)
                            })
                            .sum()
                    })
                    .collect();
                for (i, a) in seen.iter().enumerate() {
                    for (j, b) in seen.iter().enumerate() {
                        wanted[(i, j)] += a.conj() * b;
                    }
                }
            }
            assert!((&found.sums[0] - &wanted).norm() < 1e-10 * wanted.norm(), "{} {wanted}", found.sums[0]);
        }
    }

    #[test]
    fn the_chance_is_the_beta_distribution() {
        // By the integral of its density, m = 2, K = 7: x^1 (1-x)^4 / B(2, 5), B = 1/30.
        let steps = 200_000;
        let tail = |from: f64| {
            let width = (1.0 - from) / f64::from(steps);
            (0..steps).map(|k| from + width * (f64::from(k) + 0.5)).map(|x| 30.0 * x * (1.0 - x).powi(4) * width).sum()
        };
        for value in [0.1, 0.4, 0.8] {
            let wanted: f64 = tail(value);
            assert!((chance(value, 2, 7) - wanted).abs() < 1e-9, "{value}");
            assert!((chance(value, 1, 7) - (1.0 - value).powi(6)).abs() < 1e-15);
        }
        assert!((level(0.05, 1, 7) - (1.0 - 0.05_f64.powf(1.0 / 6.0))).abs() < 1e-12);
        assert!((chance(level(0.05, 3, 20), 3, 20) - 0.05).abs() < 1e-12);
        assert_eq!(chance(0.9, 2, 2), 1.0);
    }

    /// Independent noise exceeds the level at one frequency in twenty: ordinary, partial, and multiple coherence.
    #[test]
    fn noise_alone_exceeds_the_level_at_one_frequency_in_twenty() {
        let (runs, samples) = (600, 400);
        // Nine tapers, frequencies one band apart and away from zero and half the rate.
        let bandwidth = 10.0 / (401.0 * STEP_S);
        let frequencies: Vec<f64> = (1..=17).map(|k| bandwidth * f64::from(k)).collect();
        let mut random = Random::new(11);
        let mut above = [0_u32; 3];
        let mut cases = 0_u32;
        for _ in 0..runs {
            let first = random.normals(samples);
            // The second input is mostly the first.
            let second = first.iter().map(|v| 0.9 * v + 0.3 * random.normal()).collect();
            let output = random.normals(samples);
            let found = spectra(&[first, second, output], frequencies.clone(), bandwidth);
            assert_eq!(found.averages(), 9);
            let counted = [
                (found.partial(0, 2, &[]).unwrap(), level(0.05, 1, 9)),
                (found.partial(0, 2, &[1]).unwrap(), level(0.05, 1, 8)),
                (found.multiple(&[0, 1], 2).unwrap(), level(0.05, 2, 9)),
            ];
            for (above, (values, level)) in above.iter_mut().zip(counted) {
                *above += values.iter().map(|v| u32::from(*v > level)).sum::<u32>();
            }
            cases += frequencies.len() as u32;
        }
        // Three standard deviations of the binomial distribution; neighbours a band apart are nearly independent.
        let allowed = 3.0 * (0.05 * 0.95 / f64::from(cases)).sqrt();
        for above in above {
            let share = f64::from(above) / f64::from(cases);
            assert!((share - 0.05).abs() < allowed, "{share} +- {allowed}");
        }
    }

    /// Mean of the estimate where the true coherence is `truth`: `1/K + (K-1)/(K+1) truth F(1,1;K+2;truth)` (G. C. Carter,
    /// C. H. Knapp, A. H. Nuttall, IEEE Trans. Audio Electroacoust. AU-21, 1973).
    fn mean_of_estimate(truth: f64, averages: usize) -> f64 {
        let k = averages as f64;
        let (mut term, mut sum) = (1.0, 1.0);
        for n in 0..2000 {
            let n = f64::from(n);
            term *= (1.0 + n) * (1.0 + n) / (k + 2.0 + n) / (1.0 + n) * truth;
            sum += term;
        }
        1.0 / k + (k - 1.0) / (k + 1.0) * truth * sum
    }

    /// A first-order lag with noise, whose coherence is known at every frequency.
    #[test]
    fn the_coherence_of_a_known_system_is_found() {
        let samples = 1200;
        let bandwidth = 13.0 / (1201.0 * STEP_S);
        let frequencies = vec![0.5, 1.5, 3.0, 6.0];
        let pole = 0.7_f64;
        let noise = 0.5_f64;
        let mut random = Random::new(5);
        let runs = 400;
        let mut sums = vec![(0.0, 0.0); frequencies.len()];
        for _ in 0..runs {
            let input = random.normals(samples);
            let mut state = 0.0;
            let output = input
                .iter()
                .map(|u| {
                    state = pole * state + (1.0 - pole) * u;
                    state + noise * random.normal()
                })
                .collect();
            let found = spectra(&[input, output], frequencies.clone(), bandwidth);
            assert_eq!(found.averages(), 12);
            for (sum, value) in sums.iter_mut().zip(found.partial(0, 1, &[]).unwrap()) {
                *sum = (sum.0 + value, sum.1 + value * value);
            }
        }
        for (frequency, (sum, squares)) in frequencies.iter().zip(sums) {
            let turn = Complex::from_polar(1.0, -std::f64::consts::TAU * frequency * STEP_S);
            let gain = ((1.0 - pole) / (Complex::new(1.0, 0.0) - turn * pole)).norm_sqr();
            let truth = gain / (gain + noise * noise);
            let (mean, n) = (sum / f64::from(runs), f64::from(runs));
            let error = ((squares / n - mean * mean) / n).sqrt();
            // Four standard errors of the mean, and the gain's change within the band.
            let wanted = mean_of_estimate(truth, 12);
            assert!((mean - wanted).abs() < 4.0 * error + 0.01, "{frequency} Hz: {mean} +- {error}, wanted {wanted}");
        }
    }

    /// Two inputs that move together, of which one does nothing: the ordinary coherence of that one is high, the partial
    /// one is noise.
    #[test]
    fn the_partial_coherence_clears_an_input_that_does_nothing() {
        let samples = 1000;
        let bandwidth = 16.0 / (1001.0 * STEP_S);
        let frequencies: Vec<f64> = (1..=10).map(|k| bandwidth * f64::from(k)).collect();
        let mut random = Random::new(8);
        let (mut above, mut cases) = (0_u32, 0_u32);
        for _ in 0..100 {
            let acting = random.normals(samples);
            let idle: Vec<f64> = acting.iter().map(|v| v + 0.5 * random.normal()).collect();
            let output = acting.iter().map(|v| 2.0 * v + 0.5 * random.normal()).collect();
            let found = spectra(&[acting, idle, output], frequencies.clone(), bandwidth);
            let ordinary = found.partial(1, 2, &[]).unwrap();
            // True: 0.8 for the correlation of the inputs times 16/17 for the noise.
            assert!(ordinary.iter().sum::<f64>() / 10.0 > 0.6, "{ordinary:?}");
            let level = level(0.05, 1, found.averages() - 1);
            above += found.partial(1, 2, &[0]).unwrap().iter().map(|v| u32::from(*v > level)).sum::<u32>();
            cases += 10;
        }
        let share = f64::from(above) / f64::from(cases);
        assert!((share - 0.05).abs() < 3.0 * (0.05 * 0.95 / f64::from(cases)).sqrt(), "{share}");
    }

    #[test]
    fn what_cannot_be_told_apart_has_no_coherence() {
        let mut random = Random::new(2);
        let one = random.normals(200);
        let twice: Vec<f64> = one.iter().map(|v| 2.0 * v).collect();
        let output = random.normals(200);
        let found = spectra(&[one, twice, output, vec![3.0; 200]], vec![2.0], 1.0);
        assert_eq!(found.partial(0, 2, &[1]), None);
        assert_eq!(found.multiple(&[0, 1], 2), None);
        assert_eq!(found.partial(0, 3, &[]), None, "a channel that stands still");
        assert!(found.partial(0, 2, &[]).is_some());
    }
}
