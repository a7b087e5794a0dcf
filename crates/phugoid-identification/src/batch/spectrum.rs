//! From samples to a band of frequencies: the finite Fourier transform, by least squares.
//!
//! A manoeuvre is cut into parts: at gaps, and so that none is longer than a minute. In each part of length `T` a signal
//! is written as a sum of
//!
//! ```text
//! slow      1, t, t^2, t^3 and the harmonics of 1/T below the band: biases, drifts, what leaks of them into the band
//! band      cos(2 pi k t/T), sin(2 pi k t/T) for the k with low <= k/T <= high
//! ```
//!
//! and the functions are made orthonormal over the samples that were measured, in this order. The coefficients of the
//! band are then those of the finite Fourier transform (Klein & Morelli, Aircraft System Identification, chapter 7) of
//! the signal without its slow part: for equally spaced samples exactly, up to the factor `sqrt(2/n)`. Samples may be
//! spaced unequally and missing: white noise of one sigma `s` still has coefficients that are independent and of one
//! sigma `s` each. Polynomials besides harmonics take the difference between the ends with them, which would otherwise
//! fall off as 1/k only and spread over the whole band.

use nalgebra::{Cholesky, DMatrix, Dyn};

use super::error::BatchError;
use super::loss::Loss;
use super::response::Rows;
use crate::core::options::Band;

/// Frequencies with fewer periods than this in a part are not used: drift and they cannot be told apart.
const PERIODS: usize = 2;
/// Longest part, s. Longer ones would not tell more, and the work grows with the square of the length.
const LONGEST_S: f64 = 60.0;
/// Fewest frequencies of a part.
const FEWEST: usize = 3;
/// Order of the polynomial that is taken out.
const ORDER: usize = 3;
/// Most functions over the number of samples of a channel.
const FULL: f64 = 0.8;

/// The transforms of all parts of all manoeuvres, for the samples that were measured.
pub(crate) struct Spectrum<const R: usize> {
    /// By manoeuvre, in order of time.
    parts: Vec<Vec<Part<R>>>,
    /// Times of the stretches that are too short for the band, by manoeuvre, s.
    pub(crate) left_out: Vec<Vec<[f64; 2]>>,
}

struct Part<const R: usize> {
    /// The frequencies, Hz; each has two rows.
    frequencies_hz: Vec<f64>,
    /// The transform of each output; none where it was measured too seldom.
    of_output: [Option<usize>; R],
    transforms: Vec<Transform>,
}

/// The transform over one set of samples.
struct Transform {
    /// Positions in the manoeuvre.
    samples: Vec<usize>,
    /// Number of slow functions; those of the band follow.
    slow: usize,
    /// A row per sample, a column per function.
    basis: DMatrix<f64>,
    /// Of the products of the functions: `Q = basis L^-T` is orthonormal.
    factor: Cholesky<f64, Dyn>,
}

impl Transform {
    /// `None` where the samples do not tell the functions apart.
    fn new(time_s: &[f64], samples: Vec<usize>, length_s: f64, cycles: &[usize]) -> Option<Self> {
        let (first, last) = (time_s[*samples.first()?], time_s[*samples.last()?]);
        let middle = 0.5 * (first + last);
        let half = (0.5 * (last - first)).max(f64::MIN_POSITIVE);
        let lowest = *cycles.first()?;
        let slow = ORDER + 1 + 2 * (lowest - 1);
        let all: Vec<usize> = (1..lowest).chain(cycles.iter().copied()).collect();
        let mut basis = DMatrix::zeros(samples.len(), ORDER + 1 + 2 * all.len());
        for (row, &k) in samples.iter().enumerate() {
            let t = time_s[k] - middle;
            let mut power = 1.0;
            for order in 0..=ORDER {
                basis[(row, order)] = power;
                power *= t / half;
            }
            for (i, &cycle) in all.iter().enumerate() {
                let (sin, cos) = (std::f64::consts::TAU * cycle as f64 * t / length_s).sin_cos();
                basis[(row, ORDER + 1 + 2 * i)] = cos;
                basis[(row, ORDER + 2 + 2 * i)] = sin;
            }
        }
        for mut column in basis.column_iter_mut() {
            let norm = column.norm();
            column /= norm;
        }
        let factor = Cholesky::new(basis.tr_mul(&basis))?;
        // A function that the others make up to rounding would carry nothing but rounding.
        let smallest = factor.l_dirty().diagonal().min();
        (smallest > 1e-5).then_some(Self { samples, slow, basis, factor })
    }

    /// Coefficients of the functions: a row per function, a column per signal.
    fn forward(&self, signals: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        self.factor.l_dirty().solve_lower_triangular(&self.basis.tr_mul(signals))
    }

    /// The signal that has these coefficients in the band, at the samples.
    fn back(&self, band: &[f64]) -> Option<DMatrix<f64>> {
        let mut all = DMatrix::zeros(self.basis.ncols(), 1);
        for (i, value) in band.iter().enumerate().filter(|(_, v)| v.is_finite()) {
            all[(self.slow + i, 0)] = *value;
        }
        Some(&self.basis * self.factor.l_dirty().tr_solve_lower_triangular(&all)?)
    }

    /// Number of rows in the band.
    fn rows(&self) -> usize {
        self.basis.ncols() - self.slow
    }
}

/// Rows of one manoeuvre in the band and below it.
pub(crate) struct Transformed<const R: usize> {
    /// Two rows per frequency (cosine and sine), part by part; NaN where an output has none.
    pub(crate) band: Rows<R>,
    /// The rows of the slow functions, divided by the root of the number of samples: in units of the output.
    pub(crate) slow: Rows<R>,
}

impl<const R: usize> Spectrum<R> {
    /// The transforms of stretches (`[from, to)`, by manoeuvre) over the samples at which `values` are finite.
    pub(crate) fn new<'a>(
        band: Band,
        times_s: impl Iterator<Item = &'a [f64]>,
        stretches: &[Vec<[usize; 2]>],
        values: &[&[[f64; R]]],
    ) -> Self {
        let mut spectrum = Self { parts: Vec::new(), left_out: Vec::new() };
        for ((time_s, stretches), values) in times_s.zip(stretches).zip(values) {
            let (mut parts, mut left_out) = (Vec::new(), Vec::new());
            for [from, to] in stretches.iter().flat_map(|stretch| cut(time_s, *stretch)) {
                match Part::new(band, time_s, from, to, values) {
                    Some(part) => parts.push(part),
                    None if to > from => left_out.push([time_s[from], time_s[to - 1]]),
                    None => {}
                }
            }
            spectrum.parts.push(parts);
            spectrum.left_out.push(left_out);
        }
        spectrum
    }

    /// # Errors
    /// [`BatchError::BadInput`] where no part of the records has enough frequencies in the band.
    pub(crate) fn check(&self, band: Band) -> Result<(), BatchError> {
        if self.parts.iter().any(|parts| !parts.is_empty()) {
            return Ok(());
        }
        let Band { low_hz, high_hz } = band;
        Err(BatchError::BadInput(format!(
            "the record is too short, or sampled too seldom, for the band from {low_hz:.3} to {high_hz:.3} Hz: a stretch \
             between two gaps needs two periods of its lowest frequency and {FEWEST} frequencies, which are one over its \
             length apart. Give a wider band or a longer record, or take a method in the time domain"
        )))
    }

    /// All frequencies that are used, Hz, part by part.
    pub(crate) fn frequencies_hz(&self) -> impl Iterator<Item = f64> {
        self.parts.iter().flatten().flat_map(|part| part.frequencies_hz.iter().copied())
    }

    /// The frequencies of one manoeuvre, Hz, in the order of its pairs of rows.
    pub(crate) fn own_frequencies_hz(&self, manoeuvre: usize) -> Vec<f64> {
        self.parts[manoeuvre].iter().flat_map(|part| part.frequencies_hz.iter().copied()).collect()
    }

    /// The number of frequencies of each part of a manoeuvre: rows come in pairs, part by part.
    pub(crate) fn part_lengths(&self, manoeuvre: usize) -> impl Iterator<Item = usize> {
        self.parts[manoeuvre].iter().map(|part| part.frequencies_hz.len())
    }

    /// Residuals and sensitivities of one manoeuvre in the band and below it.
    pub(crate) fn transform(&self, manoeuvre: usize, time: &Rows<R>) -> Transformed<R> {
        let parts = &self.parts[manoeuvre];
        let width = time.columns.len();
        let count = |of: &dyn Fn(&Part<R>) -> usize| parts.iter().map(of).sum::<usize>();
        let mut band = empty(time, count(&|part| 2 * part.frequencies_hz.len()));
        let mut slow = empty(time, count(&|part| part.transforms.first().map_or(0, |t| t.slow)));
        let (mut band_row, mut slow_row) = (0, 0);
        for part in parts {
            for (index, transform) in part.transforms.iter().enumerate() {
                // Only columns that move an output are transformed: of an equation it is a few.
                let mut signals: Vec<(usize, Option<usize>)> = Vec::new();
                for i in (0..R).filter(|&i| part.of_output[i] == Some(index)) {
                    signals.push((i, None));
                    let moves = |c: &usize| transform.samples.iter().any(|&k| time.sensitivity(k, i)[*c] != 0.0);
                    signals.extend((0..width).filter(moves).map(|c| (i, Some(c))));
                }
                let value = |row: usize, column: usize| {
                    let ((i, c), k) = (signals[column], transform.samples[row]);
                    c.map_or_else(|| time.residuals[k][i], |c| time.sensitivity(k, i)[c])
                };
                let all = DMatrix::from_fn(transform.samples.len(), signals.len(), value);
                let Some(found) = transform.forward(&all) else { continue };
                let unit = 1.0 / (transform.samples.len() as f64).sqrt();
                for (column, (i, c)) in signals.iter().enumerate() {
                    for row in 0..found.nrows() {
                        let value = found[(row, column)];
                        match row.checked_sub(transform.slow) {
                            Some(row) => place(&mut band, band_row + row, *i, *c, value),
                            None => place(&mut slow, slow_row + row, *i, *c, unit * value),
                        }
                    }
                }
            }
            band_row += 2 * part.frequencies_hz.len();
            slow_row += part.transforms.first().map_or(0, |t| t.slow);
        }
        Transformed { band, slow }
    }

    /// The coefficients in the band of signals by sample, in the order of the rows.
    pub(crate) fn of_signals(&self, manoeuvre: usize, values: &[[f64; R]]) -> Vec<[f64; R]> {
        let rows = Rows {
            columns: Vec::new(),
            outputs: Vec::new(),
            residuals: values.to_vec(),
            sensitivities: Vec::new(),
            loss: Loss::GAUSSIAN,
            growth: 1.0,
        };
        self.transform(manoeuvre, &rows).band.residuals
    }

    /// The part in the band as a signal by sample, in units of what white coefficients of one sigma of one would give: a
    /// signal of root mean square one for those. NaN where nothing was measured.
    pub(crate) fn as_signal(&self, manoeuvre: usize, band: &[[f64; R]], samples: usize) -> Vec<[f64; R]> {
        let mut signal = vec![[f64::NAN; R]; samples];
        let mut first = 0;
        for part in &self.parts[manoeuvre] {
            let rows = 2 * part.frequencies_hz.len();
            for i in 0..R {
                let Some(transform) = part.of_output[i].map(|index| &part.transforms[index]) else { continue };
                let own: Vec<f64> = band[first..first + transform.rows()].iter().map(|row| row[i]).collect();
                let Some(values) = transform.back(&own) else { continue };
                let scale = (transform.samples.len() as f64 / transform.rows() as f64).sqrt();
                for (&k, value) in transform.samples.iter().zip(values.iter()) {
                    signal[k][i] = scale * value;
                }
            }
            first += rows;
        }
        signal
    }
}

fn empty<const R: usize>(like: &Rows<R>, rows: usize) -> Rows<R> {
    Rows {
        columns: like.columns.clone(),
        outputs: Vec::new(),
        residuals: vec![[f64::NAN; R]; rows],
        sensitivities: vec![0.0; rows * R * like.columns.len()],
        loss: Loss::GAUSSIAN,
        growth: like.growth,
    }
}

fn place<const R: usize>(rows: &mut Rows<R>, row: usize, output: usize, column: Option<usize>, value: f64) {
    let width = rows.columns.len();
    match column {
        None => rows.residuals[row][output] = value,
        Some(column) => rows.sensitivities[(row * R + output) * width + column] = value,
    }
}

/// The parts of a stretch, equally long and none longer than a minute.
fn cut(time_s: &[f64], [from, to]: [usize; 2]) -> Vec<[usize; 2]> {
    if to <= from {
        return Vec::new();
    }
    let length = time_s[to - 1] - time_s[from];
    let pieces = (length / LONGEST_S).ceil().max(1.0) as usize;
    let at = |piece: usize| {
        let until = time_s[from] + length * piece as f64 / pieces as f64;
        if piece == pieces { to } else { from + time_s[from..to].partition_point(|t| *t < until) }
    };
    (0..pieces).map(|piece| [at(piece), at(piece + 1)]).collect()
}

/// Length of a part, s: that of its samples, the last interval included.
fn length_s(time_s: &[f64], from: usize, to: usize) -> f64 {
    let intervals = (to - from - 1).max(1) as f64;
    (time_s[to - 1] - time_s[from]) * (intervals + 1.0) / intervals
}

/// The lowest frequency that the longest part of these stretches allows, Hz.
pub(crate) fn lowest_hz(time_s: &[f64], stretches: &[[usize; 2]]) -> f64 {
    let parts = stretches.iter().flat_map(|stretch| cut(time_s, *stretch)).filter(|[from, to]| to - from > 1);
    let longest = parts.map(|[from, to]| length_s(time_s, from, to)).fold(0.0, f64::max);
    PERIODS as f64 / longest
}

impl<const R: usize> Part<R> {
    fn new(band: Band, time_s: &[f64], from: usize, to: usize, values: &[[f64; R]]) -> Option<Self> {
        if to < from + 2 {
            return None;
        }
        let length_s = length_s(time_s, from, to);
        // A frequency that is asked for belongs to the band whatever rounding does.
        let lowest = PERIODS.max((band.low_hz * length_s * (1.0 - 1e-9)).ceil() as usize);
        let highest = (band.high_hz * length_s * (1.0 + 1e-9)).floor() as usize;
        if highest + 1 < lowest + FEWEST {
            return None;
        }
        let (mut transforms, mut of_output): (Vec<Transform>, [Option<usize>; R]) = (Vec::new(), [None; R]);
        let mut known: Vec<(Vec<usize>, Option<usize>)> = Vec::new();
        for (i, of_output) in of_output.iter_mut().enumerate() {
            let samples: Vec<usize> = (from..to).filter(|&k| values[k][i].is_finite()).collect();
            if let Some((_, index)) = known.iter().find(|(others, _)| *others == samples) {
                *of_output = *index;
                continue;
            }
            // A channel that is sampled more slowly has fewer frequencies.
            let most = ((FULL * samples.len() as f64 - (ORDER + 1) as f64) / 2.0).max(0.0) as usize;
            let cycles: Vec<usize> = (lowest..=highest.min(most)).collect();
            if cycles.len() >= FEWEST
                && let Some(transform) = Transform::new(time_s, samples.clone(), length_s, &cycles)
            {
                *of_output = Some(transforms.len());
                transforms.push(transform);
            }
            known.push((samples, *of_output));
        }
        let frequencies_hz = (lowest..=highest).map(|cycle| cycle as f64 / length_s).collect();
        (!transforms.is_empty()).then_some(Self { frequencies_hz, of_output, transforms })
    }
}
