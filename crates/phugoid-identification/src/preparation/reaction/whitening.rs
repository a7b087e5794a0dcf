//! Residuals without memory: noise of a sensor, gusts and whatever a model lacks have a spectrum, and a least squares
//! that takes no account of it is neither the most likely value nor has it the error that it claims.

/// Coefficients of the prediction error `e_k = sum_i a_i x_(k-i)`, `a_0 = 1`, of stretches of a stationary signal, by the
/// method of J. P. Burg (*Maximum Entropy Spectral Analysis*, 1967): stable, and without windows. Of the order given, or
/// of a lower one where nothing is left to be predicted.
pub(super) fn autoregression(stretches: &[Vec<f64>], order: usize) -> Vec<f64> {
    let (mut forward, mut backward) = (stretches.to_vec(), stretches.to_vec());
    let mut filter = vec![1.0];
    for _ in 0..order {
        let (mut product, mut power) = (0.0, 0.0);
        for (f, b) in forward.iter().zip(&backward) {
            for (f, b) in f.iter().skip(1).zip(b) {
                product += f * b;
                power += f * f + b * b;
            }
        }
        if !(power > 0.0 && power.is_finite()) {
            break;
        }
        let reflection = -2.0 * product / power;
        filter.push(0.0);
        filter = (0..filter.len()).map(|i| filter[i] + reflection * filter[filter.len() - 1 - i]).collect();
        for (f, b) in forward.iter_mut().zip(&mut backward) {
            let next: Vec<(f64, f64)> =
                f.iter().skip(1).zip(b.iter()).map(|(f, b)| (f + reflection * b, b + reflection * f)).collect();
            (*f, *b) = next.into_iter().unzip();
        }
    }
    filter
}

/// The prediction errors of a signal, from the first sample on that has enough before it.
pub(super) fn whitened(values: &[f64], filter: &[f64]) -> Vec<f64> {
    let order = filter.len().saturating_sub(1);
    let count = values.len().saturating_sub(order);
    let mut out = vec![0.0; count];
    for (i, a) in filter.iter().enumerate() {
        let before = values.iter().skip(order - i);
        out.iter_mut().zip(before).for_each(|(out, value)| *out += a * value);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_a_signal_is_found_and_taken_out() {
        // x_k = 1.5 x_(k-1) - 0.7 x_(k-2) + e_k, in two stretches.
        let mut seed = 5_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut stretch = |count: usize| {
            let (mut x, mut before) = (0.0, 0.0);
            (0..count)
                .map(|_| {
                    (x, before) = (1.5 * x - 0.7 * before + random(), x);
                    x
                })
                .collect::<Vec<f64>>()
        };
        let signal = [stretch(3000), stretch(2000)];
        let filter = autoregression(&signal, 2);
        for (found, expected) in filter.iter().zip([1.0, -1.5, 0.7]) {
            assert!((found - expected).abs() < 0.03, "{filter:?}");
        }
        let white = whitened(&signal[0], &filter);
        assert_eq!(white.len(), 2998);
        let power: f64 = white.iter().map(|e| e * e).sum();
        let lagged: f64 = white.windows(2).map(|w| w[0] * w[1]).sum();
        assert!((lagged / power).abs() < 0.05, "{}", lagged / power);
    }

    #[test]
    fn a_signal_without_power_stays_as_it_is() {
        assert_eq!(autoregression(&[vec![0.0; 50]], 4), [1.0]);
        assert_eq!(whitened(&[1.0, 2.0], &[1.0]), [1.0, 2.0]);
        assert!(whitened(&[1.0], &[1.0, -1.0]).is_empty());
    }
}
