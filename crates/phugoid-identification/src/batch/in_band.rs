//! Likelihood in a band of frequencies, and its result: what the frequency-domain methods share.
//!
//! The coefficients of the residuals in the band ([`Spectrum`]) are independent, and those of an output have one level
//! over the band: its spectral density. With it at its own optimum the cost is that of Whittle (P. Whittle, Arkiv foer
//! Matematik 2, 1953; Klein & Morelli, Aircraft System Identification, chapter 7),
//!
//! ```text
//! J = sum_i [ N_i ln s_i + 1/2 sum_f |E_i(f)|^2 / s_i^2 ]        N_i: number of coefficients (two per frequency)
//! ```

use nalgebra::DMatrix;

use super::error::BatchError;
use super::fit::OutputFit;
use super::layout::{Layout, Place};
use super::likelihood::Evaluation;
use super::loss::Loss;
use super::optimise::{Minimum, OptimiserSettings, minimise};
use super::problem::{Manoeuvre, Noise, Structure};
use super::relaxation::levels;
use super::response::Rows;
use super::result::{BandUsed, BatchFit, ManoeuvreFit};
use super::spectrum::{Spectrum, Transformed};
use super::summary::{Estimates, assemble};

/// Residuals and sensitivities at one point.
pub(crate) struct InBand<const R: usize> {
    /// In the band, divided by one sigma, by manoeuvre.
    pub(crate) rows: Vec<Rows<R>>,
    /// As they were by sample.
    pub(crate) time: Vec<Rows<R>>,
    pub(crate) noise_std: [f64; R],
    /// Information of the slow rows and the priors.
    pub(crate) held: DMatrix<f64>,
}

/// Minimises the cost in the band. `slow_std`: one sigma of what lies below the band, by output, which then holds a
/// simulation near the flight; none: it is not looked at.
pub(crate) fn fit<const R: usize>(
    places: &[Place],
    start: Vec<f64>,
    spectrum: &Spectrum<R>,
    slow_std: Option<&[f64; R]>,
    floor: &[f64; R],
    settings: &OptimiserSettings,
    residuals: impl Fn(&[f64]) -> Result<Vec<Rows<R>>, BatchError>,
) -> Result<Minimum<InBand<R>>, BatchError> {
    let evaluate = |unknowns: &[f64]| Ok(evaluate(places, unknowns, spectrum, slow_std, floor, residuals(unknowns)?));
    let first = evaluate(&start)?;
    minimise(places, start, first, settings, 0, |unknowns, _| evaluate(unknowns).ok())
}

/// Cost, gradient and information of residuals in the band; the arguments are those of [`fit`], the residuals by sample.
pub(crate) fn evaluate<const R: usize>(
    places: &[Place],
    unknowns: &[f64],
    spectrum: &Spectrum<R>,
    slow_std: Option<&[f64; R]>,
    floor: &[f64; R],
    time: Vec<Rows<R>>,
) -> Evaluation<InBand<R>> {
    let transformed: Vec<Transformed<R>> =
        time.iter().enumerate().map(|(index, rows)| spectrum.transform(index, rows)).collect();
    let mut evaluation = Evaluation::of_priors(places, unknowns);
    let (mut band, mut below) = (Vec::with_capacity(time.len()), 0.0);
    for Transformed { band: rows, slow } in transformed {
        band.push(rows);
        if let Some(std) = slow_std {
            let slow = slow.whitened(std, Loss::GAUSSIAN);
            below += 0.5 * slow.residuals.as_flattened().iter().filter(|e| e.is_finite()).map(|e| e * e).sum::<f64>();
            evaluation.add(&slow);
        }
    }
    let held = evaluation.information.clone();
    let (noise_std, cost) = levels(&[Noise::Estimated; R], &band, floor, Loss::GAUSSIAN);
    let rows: Vec<Rows<R>> = band.into_iter().map(|r| r.whitened(&noise_std, Loss::GAUSSIAN)).collect();
    rows.iter().for_each(|r| evaluation.add(r));
    evaluation.with(cost + below, InBand { rows, time, noise_std, held })
}

/// Frequencies to each side over which the spectrum of the residuals is averaged for the standard errors: it is then
/// known to a third, and still follows what resonates.
const AROUND: usize = 5;

/// `sum_f sum_ab Re[S_a(f)^H C_ab(f) S_b(f)]/2`, `C_ab(f)` the spectra and cross spectra of the residuals about `f`: the
/// spread of the gradient when the residuals are not of one level over the band, and those of two outputs not
/// independent (the sum of Morelli & Klein, NASA CR-194893, 1994, over all lags, in the frequency domain).
pub(crate) fn spread<const R: usize>(rows: &[Rows<R>], spectrum: &Spectrum<R>, unknowns: usize) -> DMatrix<f64> {
    let mut total = DMatrix::<f64>::zeros(unknowns, unknowns);
    for (index, rows) in rows.iter().enumerate() {
        let width = rows.columns.len();
        let mut own = DMatrix::<f64>::zeros(width, width);
        let mut first = 0;
        for frequencies in spectrum.part_lengths(index) {
            let complex = |f: usize, i: usize| {
                let row = 2 * (first + f);
                [rows.residuals[row][i], rows.residuals[row + 1][i]]
            };
            for f in 0..frequencies {
                let around = f.saturating_sub(AROUND)..(f + AROUND + 1).min(frequencies);
                for a in 0..R {
                    for b in 0..R {
                        // E nu_a conj(nu_b), real and imaginary.
                        let (mut real, mut imaginary, mut count) = (0.0, 0.0, 0.0);
                        for near in around.clone() {
                            let ([ar, ai], [br, bi]) = (complex(near, a), complex(near, b));
                            let product = [ar * br + ai * bi, ai * br - ar * bi];
                            if product.iter().all(|v| v.is_finite()) {
                                (real, imaginary, count) = (real + product[0], imaginary + product[1], count + 1.0);
                            }
                        }
                        if count == 0.0 || !complex(f, a).iter().chain(&complex(f, b)).all(|v| v.is_finite()) {
                            continue;
                        }
                        let (real, imaginary) = (0.5 * real / count, 0.5 * imaginary / count);
                        let row = 2 * (first + f);
                        let [sa, sa_i] = [rows.sensitivity(row, a), rows.sensitivity(row + 1, a)];
                        let [sb, sb_i] = [rows.sensitivity(row, b), rows.sensitivity(row + 1, b)];
                        for j in 0..width {
                            if sb[j] == 0.0 && sb_i[j] == 0.0 {
                                continue;
                            }
                            for i in 0..width {
                                // E Re(conj(s_a) nu_a) Re(conj(s_b) nu_b).
                                own[(i, j)] += real * (sa[i] * sb[j] + sa_i[i] * sb_i[j])
                                    + imaginary * (sa_i[i] * sb[j] - sa[i] * sb_i[j]);
                            }
                        }
                    }
                }
            }
            first += frequencies;
        }
        for (i, &row) in rows.columns.iter().enumerate() {
            for (j, &column) in rows.columns.iter().enumerate() {
                total[(row, column)] += own[(i, j)];
            }
        }
    }
    total
}

/// What the result of a method in a band is computed from.
pub(crate) struct BandSummary<'a, const N: usize, const R: usize> {
    pub(crate) method: &'static str,
    pub(crate) structure: &'a Structure<N, R>,
    pub(crate) manoeuvres: &'a [Manoeuvre<'a, N, R>],
    pub(crate) layout: &'a Layout<N>,
    pub(crate) spectrum: &'a Spectrum<R>,
    pub(crate) minimum: &'a Minimum<InBand<R>>,
    /// The left sides of the rows by sample, by manoeuvre; NaN for a row that is compared with nothing measured.
    pub(crate) measured: Vec<Vec<[f64; R]>>,
}

pub(crate) fn summarise<const N: usize, const R: usize>(s: &BandSummary<'_, N, R>) -> Result<BatchFit, BatchError> {
    let InBand { rows, time, noise_std, held } = &s.minimum.evaluation.detail;
    let unknowns = s.layout.places.len();
    let spread = spread(rows, s.spectrum, unknowns) + held;
    let frequencies: Vec<f64> = s.spectrum.frequencies_hz().collect();
    let fits = |(index, m): (usize, &Manoeuvre<'_, N, R>)| {
        let measured = s.spectrum.of_signals(index, &s.measured[index]);
        let own = s.spectrum.own_frequencies_hz(index);
        let outputs = s.structure.outputs.iter().enumerate().filter_map(|(i, channel)| {
            let left: Vec<f64> = measured.iter().map(|y| y[i]).collect();
            let residual: Vec<f64> = rows[index].residuals.iter().map(|e| noise_std[i] * e[i]).collect();
            in_band(&channel.name, &own, &left, &residual)
        });
        let unknowns = &s.minimum.unknowns;
        ManoeuvreFit {
            name: m.name.to_owned(),
            initial_state: s.layout.stretches(index, unknowns).first().map(|s| s.state.to_vec()).unwrap_or_default(),
            biases: s.layout.biases::<R>(index, unknowns).to_vec(),
            outputs: outputs.collect(),
            fitted: time[index].outputs.iter().map(|y| y.to_vec()).collect(),
            residuals: s
                .spectrum
                .as_signal(index, &rows[index].residuals, m.time_s.len())
                .iter()
                .map(|e| e.to_vec())
                .collect(),
        }
    };
    let manoeuvres = s.manoeuvres.iter().enumerate().map(fits).collect();
    let estimates = Estimates { method: s.method, structure: s.structure, layout: s.layout, minimum: s.minimum };
    let mut fit = assemble(&estimates, &spread, noise_std, manoeuvres)?;
    fit.band = Some(BandUsed {
        low_hz: frequencies.iter().copied().fold(f64::INFINITY, f64::min),
        high_hz: frequencies.iter().copied().fold(0.0, f64::max),
        frequencies: frequencies.len(),
    });
    for (m, left_out) in s.manoeuvres.iter().zip(&s.spectrum.left_out).filter(|(_, left_out)| !left_out.is_empty()) {
        let stretches: Vec<String> = left_out.iter().map(|[from, to]| format!("{from:.2} to {to:.2} s")).collect();
        fit.notes.push(format!(
            "{}: too short between two gaps for the band, and left out: {}",
            m.name,
            stretches.join(", ")
        ));
    }
    Ok(fit)
}

/// How well a model follows an output in the band: the numbers of [`OutputFit`] for the coefficients in place of the
/// samples, whose rms is that of as much white noise. `lag_one` is the lag-one correlation that the errors would have if
/// the band alone were sampled twice per period of its width: positive where they are largest at its lower end, zero where
/// their spectrum is flat. `white`: whether it is flat, by Bartlett's test of the cumulative periodogram at 99 %. `None`
/// with fewer than three frequencies.
fn in_band(name: &str, frequencies_hz: &[f64], measured: &[f64], residual: &[f64]) -> Option<OutputFit> {
    let fitted: Vec<f64> = measured.iter().zip(residual).map(|(y, e)| y - e).collect();
    let fit = OutputFit::of(name, measured, &fitted)?;
    let mut power: Vec<(f64, f64)> = frequencies_hz
        .iter()
        .zip(residual.chunks_exact(2))
        .map(|(f, pair)| (*f, pair[0] * pair[0] + pair[1] * pair[1]))
        .filter(|(_, power)| power.is_finite())
        .collect();
    if power.len() < 3 {
        return None;
    }
    power.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = power.iter().map(|(_, power)| power).sum();
    if total.is_nan() || total <= 0.0 {
        return Some(OutputFit { lag_one: 0.0, white: true, ..fit });
    }
    let count = power.len() as f64;
    let (mut sum, mut furthest, mut lag_one) = (0.0, 0.0_f64, 0.0);
    for (i, (_, power)) in power.iter().enumerate() {
        sum += power / total;
        lag_one += power / total * (std::f64::consts::PI * (i as f64 + 0.5) / count).cos();
        furthest = furthest.max((sum - (i + 1) as f64 / count).abs());
    }
    // 99 % point of Kolmogorov's statistic in the form of M. A. Stephens, Journal of the Royal Statistical Society B 32,
    // 1970.
    let root = (count - 1.0).sqrt();
    Some(OutputFit { lag_one, white: furthest <= 1.628 / (root + 0.12 + 0.11 / root), ..fit })
}
