//! Standard errors when the residuals are coloured.
//!
//! The inverse of the information is the covariance of the estimates only if the residuals are white. In flight they
//! are not: turbulence and model error last for many samples. With the sensitivities `S(k)` and residuals `nu(k)`, both
//! divided by one sigma of each output,
//!
//! ```text
//! Cov = M^-1 [ sum_i sum_j S(i)^T R(i - j) S(j) ] M^-1        R(k): autocorrelation matrix of nu at lag k
//! ```
//!
//! (Morelli & Klein, Determining the accuracy of maximum likelihood parameter estimates with colored residuals, NASA
//! CR-194893, 1994; Klein & Morelli, Aircraft System Identification, section 6.3). All lags together would give exactly
//! zero, because residuals and sensitivities are orthogonal at the optimum; lags are therefore summed as far as the
//! residuals are correlated at all, with a flat-top window whose width is found by the rule of D. N. Politis (Adaptive
//! bandwidth choice, Journal of Nonparametric Statistics 15, 2003).

use nalgebra::DMatrix;

use super::loss::Loss;
use super::response::Rows;

/// Up to this lag every one is evaluated; beyond, steps are this part of the lag: a correlation that lasts for minutes
/// does not change within a hundredth of that.
const EVERY_LAG: usize = 256;
const STEP: usize = 128;

/// Autocorrelation matrices of the residuals, by lag.
pub(crate) struct Colour<const R: usize> {
    /// The lags that were evaluated, from 0, with `E nu_a(i) nu_b(i + lag)`.
    evaluated: Vec<(usize, [[f64; R]; R])>,
    /// Up to this lag the window is one; from there it falls to zero at twice this lag, or is cut at `width`.
    last_loud: usize,
    /// Last lag that is summed.
    width: usize,
}

impl<const R: usize> Colour<R> {
    /// Measures the colour of residuals in units of one sigma, pooled over the manoeuvres.
    pub(crate) fn of(rows: &[Rows<R>]) -> Self {
        let samples = rows.iter().map(|r| r.residuals.len()).sum::<usize>();
        let shortest = rows.iter().map(|r| r.residuals.len()).min().unwrap_or(0);
        let most = shortest / 4;
        // Politis: the first lag after which `quiet` lags in a row are below the threshold.
        let decades = (samples.max(2) as f64).log10();
        let threshold = 2.0 * (decades / samples.max(1) as f64).sqrt();
        let quiet = 5.max(decades.sqrt().ceil() as usize);
        let mut evaluated = vec![(0, pooled(rows, 0))];
        let variance = evaluated[0].1;
        let mut last_loud = 0;
        let mut in_a_row = 0;
        let next = |lag: usize| lag + 1.max(if lag > EVERY_LAG { lag / STEP } else { 0 });
        let mut lag = 1;
        while lag <= most {
            let at = pooled(rows, lag);
            evaluated.push((lag, at));
            let loud = (0..R).any(|i| variance[i][i] > 0.0 && (at[i][i] / variance[i][i]).abs() > threshold);
            if loud {
                (last_loud, in_a_row) = (lag, 0);
            } else {
                in_a_row += 1;
                if in_a_row >= quiet {
                    break;
                }
            }
            lag = next(lag);
        }
        let width = (2 * last_loud).min(most);
        while let Some((last, _)) = evaluated.last().copied().filter(|(last, _)| *last < width) {
            let lag = next(last).min(width);
            evaluated.push((lag, pooled(rows, lag)));
        }
        Self { evaluated, last_loud, width }
    }

    /// `E nu_a(i) nu_b(i + lag)` times the window; between the lags that were evaluated by a straight line.
    fn windowed(&self, lag: usize) -> [[f64; R]; R] {
        if lag > self.width {
            return [[0.0; R]; R];
        }
        let window = if lag <= self.last_loud { 1.0 } else { 2.0 - lag as f64 / self.last_loud as f64 };
        let after = self.evaluated.partition_point(|(at, _)| *at < lag).min(self.evaluated.len() - 1);
        let (to, above) = self.evaluated[after];
        let (from, below) = self.evaluated[after.saturating_sub(1)];
        if to == lag || from == to {
            return above.map(|row| row.map(|value| window * value));
        }
        let share = (lag - from) as f64 / (to - from) as f64;
        std::array::from_fn(|i| std::array::from_fn(|j| window * (below[i][j] + share * (above[i][j] - below[i][j]))))
    }

    /// Mean of the windowed correlation between the samples of two blocks of `block` samples, `apart` blocks apart.
    fn between_blocks(&self, apart: usize, block: usize) -> [[f64; R]; R] {
        let mut mean = [[0.0; R]; R];
        for nearer in 0..2 * block - 1 {
            // Lags from -(block - 1) to block - 1 about that of the middles, each as often as pairs of samples have it.
            let lag = (apart * block + nearer) as isize - (block - 1) as isize;
            let pairs = block - nearer.abs_diff(block - 1);
            let weight = pairs as f64 / (block * block) as f64;
            let at = self.windowed(lag.unsigned_abs());
            for a in 0..R {
                for b in 0..R {
                    mean[a][b] += weight * if lag < 0 { at[b][a] } else { at[a][b] };
                }
            }
        }
        mean
    }

    /// `sum_i sum_j S(i)^T R(i - j) S(j)` over all manoeuvres.
    ///
    /// Where the residuals are correlated over many samples, sensitivities are summed over blocks of them first, which
    /// takes the square of the block's length less time: within a block, a hundredth of that length of time, they hardly
    /// change.
    pub(crate) fn spread(&self, rows: &[Rows<R>], unknowns: usize) -> DMatrix<f64> {
        let block = self.width.div_ceil(EVERY_LAG).max(1);
        // The furthest samples of two blocks are one block further apart than the nearest.
        let reach = self.width / block + usize::from(block > 1);
        let correlations: Vec<[[f64; R]; R]> = (0..=reach).map(|apart| self.between_blocks(apart, block)).collect();
        let mut total = DMatrix::<f64>::zeros(unknowns, unknowns);
        for manoeuvre in rows {
            let width = manoeuvre.columns.len();
            let blocks = manoeuvre.residuals.len().div_ceil(block);
            let summed = in_blocks(manoeuvre, block);
            let sensitivity = |k: usize, a: usize| summed[(k * R + a) * width..][..width].iter();
            let mut half = DMatrix::<f64>::zeros(width, width);
            let mut ahead = vec![0.0; width];
            for k in 0..blocks {
                for a in 0..R {
                    if sensitivity(k, a).all(|s| *s == 0.0) {
                        continue;
                    }
                    ahead.fill(0.0);
                    for (apart, correlation) in correlations.iter().enumerate().take(blocks - k) {
                        for b in 0..R {
                            // Both signs of the lag come by adding the transpose: lag zero counts half.
                            let weight = correlation[a][b] * if apart == 0 { 0.5 } else { 1.0 };
                            for (sum, s) in ahead.iter_mut().zip(sensitivity(k + apart, b)) {
                                *sum += weight * s;
                            }
                        }
                    }
                    for (i, s) in sensitivity(k, a).enumerate().filter(|(_, s)| **s != 0.0) {
                        for (j, sum) in ahead.iter().enumerate() {
                            half[(i, j)] += s * sum;
                        }
                    }
                }
            }
            for (i, &row) in manoeuvre.columns.iter().enumerate() {
                for (j, &column) in manoeuvre.columns.iter().enumerate() {
                    total[(row, column)] += half[(i, j)] + half[(j, i)];
                }
            }
        }
        total
    }
}

/// The sensitivities of the outputs that were measured, summed over blocks of samples: block by block, output by output,
/// one value per column.
fn in_blocks<const R: usize>(rows: &Rows<R>, block: usize) -> Vec<f64> {
    let width = rows.columns.len();
    let mut summed = vec![0.0; rows.residuals.len().div_ceil(block) * R * width];
    for (k, residuals) in rows.residuals.iter().enumerate() {
        for (i, _) in residuals.iter().enumerate().filter(|(_, e)| e.is_finite()) {
            let from = (k / block * R + i) * width;
            for (sum, s) in summed[from..from + width].iter_mut().zip(rows.sensitivity(k, i)) {
                *sum += s;
            }
        }
    }
    summed
}

/// What a residual acts with: `rho'(nu)`, the residual itself unless it is an outlier's.
fn acting(loss: Loss, residual: f64) -> f64 {
    loss.weight(residual) * residual
}

/// `sum nu_a(i) nu_b(i + lag)` over the number of samples: the biased estimate, smaller in variance.
fn pooled<const R: usize>(rows: &[Rows<R>], lag: usize) -> [[f64; R]; R] {
    let mut sum = [[0.0; R]; R];
    let mut present = [[0.0_f64; R]; R];
    for manoeuvre in rows {
        let residuals = &manoeuvre.residuals;
        for (now, later) in residuals.iter().zip(residuals.iter().skip(lag)) {
            for a in 0..R {
                for b in 0..R {
                    let product = acting(manoeuvre.loss, now[a]) * acting(manoeuvre.loss, later[b]);
                    if product.is_finite() {
                        sum[a][b] += product;
                        present[a][b] += 1.0;
                    }
                }
            }
        }
    }
    let share = |n: usize| (n.saturating_sub(lag)) as f64 / n.max(1) as f64;
    let taper = rows.iter().map(|r| share(r.residuals.len())).sum::<f64>() / rows.len().max(1) as f64;
    for a in 0..R {
        for b in 0..R {
            sum[a][b] *= if present[a][b] > 0.0 { taper / present[a][b] } else { 0.0 };
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two outputs with one column each and residuals that are correlated over about `seconds` of 50 samples; every
    /// eleventh value of the second is missing.
    fn rows(samples: usize, seconds: f64) -> [Rows<2>; 1] {
        let mut state = 3_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let keep = (-0.02 / seconds).exp();
        let mut slow = 0.0;
        let mut residuals = Vec::new();
        let mut sensitivities = Vec::new();
        for k in 0..samples {
            slow = keep * slow + (1.0 - keep * keep).sqrt() * 12_f64.sqrt() * uniform();
            let second = if k % 11 == 3 { f64::NAN } else { 0.5 * slow + uniform() };
            residuals.push([slow, second]);
            let t = 0.02 * k as f64;
            sensitivities.extend([(0.7 * t).sin(), 0.0, 0.3 * (1.1 * t).cos(), 1.0]);
        }
        let columns = vec![0, 1];
        [Rows { columns, outputs: Vec::new(), residuals, sensitivities, loss: Loss::GAUSSIAN, growth: 1.0 }]
    }

    /// Every pair of samples by itself.
    fn pair_by_pair(colour: &Colour<2>, rows: &Rows<2>) -> DMatrix<f64> {
        let mut total = DMatrix::zeros(2, 2);
        let finite = |k: usize, a: usize| rows.residuals[k][a].is_finite();
        for i in 0..rows.residuals.len() {
            for j in i.saturating_sub(colour.width)..(i + colour.width + 1).min(rows.residuals.len()) {
                let at = colour.windowed(i.abs_diff(j));
                for a in (0..2).filter(|&a| finite(i, a)) {
                    for b in (0..2).filter(|&b| finite(j, b)) {
                        let correlation = if j < i { at[b][a] } else { at[a][b] };
                        for (p, s) in rows.sensitivity(i, a).iter().enumerate() {
                            for (q, t) in rows.sensitivity(j, b).iter().enumerate() {
                                total[(p, q)] += s * correlation * t;
                            }
                        }
                    }
                }
            }
        }
        total
    }

    #[test]
    fn blocks_of_samples_give_what_every_pair_gives() {
        // Short correlations take no blocks, and the sums are the same to rounding.
        let quick = rows(1500, 0.1);
        let colour = Colour::of(&quick);
        assert!(colour.width > 5 && colour.width < EVERY_LAG, "{}", colour.width);
        let (fast, slow) = (colour.spread(&quick, 2), pair_by_pair(&colour, &quick[0]));
        assert!((&fast - &slow).amax() < 1e-9 * slow.amax(), "{fast} {slow}");
        // Long ones do; the motion of the sensitivities within a block is what differs.
        let lasting = rows(6000, 8.0);
        let colour = Colour::of(&lasting);
        assert!(colour.width > 3 * EVERY_LAG, "{}", colour.width);
        let (fast, slow) = (colour.spread(&lasting, 2), pair_by_pair(&colour, &lasting[0]));
        for i in 0..2 {
            assert!((fast[(i, i)] / slow[(i, i)] - 1.0).abs() < 0.01, "{fast} {slow}");
        }
    }
}
