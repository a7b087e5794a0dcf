//! For tests: what a motion says that errors of constants do, against errors that are put into it.

use phugoid_estimators::ConstantEffects;

use crate::core::systematic::UncertainQuantity;

/// Compares each column of `effects` with `shown(column, c)`, which are the rates and then the outputs of the motion in which that constant
/// is `c`, by central differences, in parts of the largest entry of the column.
///
/// # Panics
/// Where an entry differs by more than 1e-7 of the largest, or a constant does nothing.
pub(crate) fn assert_effects<const N: usize, const R: usize, const K: usize>(
    constants: &[UncertainQuantity],
    effects: &ConstantEffects<N, R, K>,
    shown: impl Fn(usize, f64) -> Vec<f64>,
) {
    let c = 1e-5;
    for (column, quantity) in constants.iter().enumerate() {
        let (up, down) = (shown(column, c), shown(column, -c));
        assert_eq!(up.len(), N + R);
        let expected: Vec<f64> = up.iter().zip(&down).map(|(up, down)| (up - down) / (2.0 * c)).collect();
        let largest = expected.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        assert!(largest > 0.0, "{quantity}");
        let found = effects.rates.iter().chain(&effects.outputs).map(|row| row[column]);
        for (i, (found, expected)) in found.zip(&expected).enumerate() {
            assert!((found - expected).abs() < 1e-7 * largest, "{quantity} {column}, {i}: {found} {expected}");
        }
    }
}
