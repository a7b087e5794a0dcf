//! The crate's own dual numbers against the num-dual crate.

use num_dual::{Dual64, DualNum};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Derivatives of every operation with respect to both arguments.
    #[test]
    fn every_operation_agrees_with_num_dual(x in 0.05..0.95, y in -3.0..3.0_f64) {
        prop_assume!(y.abs() > 1e-2);
        let (ox, oy) = (Dual::<2>::variable(x, 0), Dual::<2>::variable(y, 1));
        let ours = [
            -ox, ox + oy, ox - oy, ox * oy, ox / oy, ox + 1.7, ox - 1.7, ox * 1.7, ox / 1.7, ox.sqrt(), oy.sin_cos().0,
            oy.sin_cos().1, oy.atan2(ox), ox.asin(), ox.powf(4.14), oy.exp(), oy.recip(),
        ];
        for direction in 0..2 {
            let seed = |i: usize| f64::from(i == direction);
            let (dx, dy) = (Dual64::new(x, seed(0)), Dual64::new(y, seed(1)));
            let theirs = [
                -dx, dx + dy, dx - dy, dx * dy, dx / dy, dx + 1.7, dx - 1.7, dx * 1.7, dx / 1.7, dx.sqrt(), dy.sin(),
                dy.cos(), dy.atan2(dx), dx.asin(), dx.powf(4.14), dy.exp(), dy.recip(),
            ];
            for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
                prop_assert!((a.value - b.re).abs() <= 1e-14 * (1.0 + b.re.abs()), "{k}: {} {}", a.value, b.re);
                let (a, b) = (a.derivatives[direction], b.eps);
                prop_assert!((a - b).abs() <= 1e-12 * (1.0 + b.abs()), "derivative {direction} of {k}: {a} {b}");
            }
        }
    }
}
