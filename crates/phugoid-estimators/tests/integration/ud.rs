//! The factored covariance against dense algebra, over random covariances, rows and sizes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use phugoid_estimators::ud::Ud;
use proptest::prelude::*;

const CAPACITY: usize = 7;
type Dense = [[f64; CAPACITY]; CAPACITY];

fn dense(ud: &Ud<CAPACITY>) -> Dense {
    let mut out = [[0.0; CAPACITY]; CAPACITY];
    ud.write_dense(&mut out);
    out
}

/// A random covariance: a diagonal plus random ranks, with its dense value built beside it.
fn covariance() -> impl Strategy<Value = (usize, Ud<CAPACITY>, Dense)> {
    let variances = prop::collection::vec(0.01..10.0_f64, 1..=CAPACITY);
    let ranks = prop::collection::vec(prop::array::uniform7(-3.0..3.0_f64), 0..5);
    (variances, ranks).prop_map(|(variances, ranks)| {
        let n = variances.len();
        let mut ud = Ud::from_variances(&variances);
        let mut reference = [[0.0; CAPACITY]; CAPACITY];
        for i in 0..n {
            reference[i][i] = variances[i];
        }
        for a in ranks {
            ud.add_rank_one(0.7, &a);
            for i in 0..n {
                for j in 0..n {
                    reference[i][j] += 0.7 * a[i] * a[j];
                }
            }
        }
        (n, ud, reference)
    })
}

fn assert_close(n: usize, found: &Dense, expected: &Dense, tolerance: f64) -> Result<(), TestCaseError> {
    let size = (0..n).fold(0.0_f64, |m, i| m.max(expected[i][i].abs()));
    for i in 0..n {
        for j in 0..n {
            let error = (found[i][j] - expected[i][j]).abs();
            prop_assert!(error <= tolerance * size, "({i},{j}): {} for {}", found[i][j], expected[i][j]);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(2), ..ProptestConfig::default() })]

    #[test]
    fn rank_one_increase_is_the_sum((n, ud, reference) in covariance()) {
        assert_close(n, &dense(&ud), &reference, 1e-12)?;
        let variances = ud.variances();
        for j in 0..n {
            prop_assert!((variances[j] - reference[j][j]).abs() <= 1e-12 * reference[j][j]);
        }
    }

    #[test]
    fn measurement_update_is_kalmans(
        (n, mut ud, c) in covariance(),
        a in prop::array::uniform7(-5.0..5.0_f64),
        r in 1e-3..10.0_f64,
    ) {
        let mut ca = [0.0; CAPACITY];
        for i in 0..n {
            for j in 0..n {
                ca[i] += c[i][j] * a[j];
            }
        }
        let s = r + (0..n).map(|i| a[i] * ca[i]).sum::<f64>();
        let projection = ud.project(&a, r);
        prop_assert!((projection.variance - s).abs() <= 1e-12 * s);
        let without = ud.cross_covariance(&projection);
        let with = ud.update(&projection, r);
        let size = (0..n).fold(0.0_f64, |m, i| m.max(ca[i].abs()));
        for i in 0..n {
            prop_assert!((without[i] - ca[i]).abs() <= 1e-11 * size);
            prop_assert!((with[i] - ca[i]).abs() <= 1e-11 * size);
        }
        let mut expected = c;
        for i in 0..n {
            for j in 0..n {
                expected[i][j] -= ca[i] * ca[j] / s;
            }
        }
        assert_close(n, &dense(&ud), &expected, 1e-11)?;
        prop_assert!(ud.is_sound());
    }

    #[test]
    fn time_update_is_the_sandwich_plus_noise(
        (n, mut ud, c) in covariance(),
        a in prop::array::uniform7(prop::array::uniform7(-2.0..2.0_f64)),
        q in prop::array::uniform7(0.0..3.0_f64),
    ) {
        let mut expected = [[0.0; CAPACITY]; CAPACITY];
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    for l in 0..n {
                        expected[i][j] += a[i][k] * c[k][l] * a[j][l];
                    }
                }
            }
            expected[i][i] += q[i];
        }
        ud.predict(&a, &q);
        assert_close(n, &dense(&ud), &expected, 1e-12)?;
        prop_assert!(ud.is_sound());
    }

    #[test]
    fn solving_undoes_multiplying((n, ud, c) in covariance(), x in prop::array::uniform7(-5.0..5.0_f64)) {
        let mut y = [0.0; CAPACITY];
        for i in 0..n {
            y[i] = (0..n).map(|j| c[i][j] * x[j]).sum();
        }
        ud.solve(&mut y);
        for i in 0..n {
            prop_assert!((y[i] - x[i]).abs() < 1e-8, "{} for {}", y[i], x[i]);
        }
    }
}

/// rereaching.md section 6: two columns collinear to 1e-3 and a prior variance of 1e6. Plain formulas lose
/// definiteness here in single precision; the factors cannot, and in double precision they must agree with the
/// information sum.
#[test]
fn stays_positive_on_nearly_collinear_rows() {
    let mut ud = Ud::<2>::from_variances(&[1e6, 1e6]);
    let mut information = [[1e-6, 0.0], [0.0, 1e-6]];
    for k in 0..360_000 {
        let t = f64::from(k) * 0.01;
        let a = [t.sin(), t.sin() + 1e-3 * (1.7 * t).cos()];
        let projection = ud.project(&a, 1.0);
        ud.update(&projection, 1.0);
        for i in 0..2 {
            for j in 0..2 {
                information[i][j] += a[i] * a[j];
            }
        }
    }
    let determinant = information[0][0] * information[1][1] - information[0][1] * information[1][0];
    let expected = [information[1][1] / determinant, information[0][0] / determinant];
    assert!(ud.is_sound());
    for j in 0..2 {
        let ratio = ud.variances()[j] / expected[j];
        assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(6), ..ProptestConfig::default() })]

    /// Of a covariance whose column `fixed` is known exactly, too: it takes no part in a solution.
    #[test]
    fn the_factors_of_a_matrix_give_it_back_and_solve_it((n, _, mut matrix) in covariance(), fixed in 0..2 * CAPACITY) {
        for i in 0..n {
            if fixed < n {
                matrix[i][fixed] = 0.0;
                matrix[fixed][i] = 0.0;
            }
        }
        let mut lower = [[f64::NAN; CAPACITY]; CAPACITY];
        for i in 0..n {
            lower[i][..=i].copy_from_slice(&matrix[i][..=i]);
        }
        let ud = Ud::from_lower_triangle(&lower, n);
        prop_assert!(ud.is_sound() && ud.len() == n);
        assert_close(n, &dense(&ud), &matrix, 1e-12)?;
        let known: [f64; CAPACITY] = core::array::from_fn(|i| if i < n && i != fixed { 1.0 - 0.3 * i as f64 } else { 0.0 });
        let mut y: [f64; CAPACITY] = core::array::from_fn(|i| (0..n).map(|j| matrix[i][j] * known[j]).sum());
        ud.solve(&mut y);
        for i in 0..n {
            prop_assert!((y[i] - known[i]).abs() < 1e-8, "{} for {}", y[i], known[i]);
        }
    }
}

/// One step of a filter.
#[allow(clippy::large_enum_variant)] // a few of them in a test
#[derive(Clone, Debug)]
enum Step {
    Measure { row: [f64; CAPACITY], noise: f64 },
    Predict { transition: Dense, noise: [f64; CAPACITY] },
    Increase { factor: f64, direction: [f64; CAPACITY] },
    Scale(f64),
}

/// Steps whose numbers have up to so many decades to either side of one.
fn steps(decades: f64) -> impl Strategy<Value = Vec<Step>> {
    let size = move || (-decades..=decades).prop_map(|decades| 10f64.powf(decades));
    let value = move || (size(), -1.0..1.0_f64).prop_map(|(size, sign)| sign * size);
    let vector = move || prop::array::uniform7(value());
    let step = prop_oneof![
        4 => (vector(), size()).prop_map(|(row, noise)| Step::Measure { row, noise }),
        2 => (prop::array::uniform7(vector()), prop::array::uniform7(prop_oneof![Just(0.0), size()]))
            .prop_map(|(transition, noise)| Step::Predict { transition, noise }),
        2 => (size(), vector()).prop_map(|(factor, direction)| Step::Increase { factor, direction }),
        1 => size().prop_map(Step::Scale),
    ];
    prop::collection::vec(step, 1..24)
}

/// The step in factors.
fn take(ud: &mut Ud<CAPACITY>, step: &Step) {
    match step {
        Step::Measure { row, noise } => {
            let projection = ud.project(row, *noise);
            ud.update(&projection, *noise);
        }
        Step::Predict { transition, noise } => ud.predict(transition, noise),
        Step::Increase { factor, direction } => ud.add_rank_one(*factor, direction),
        Step::Scale(factor) => ud.scale(*factor),
    }
}

/// `L C L^T + sum of squares`, the form of each of the steps in dense algebra.
fn sandwich(n: usize, l: &Dense, c: &Dense, add: impl Fn(usize, usize) -> f64) -> Dense {
    let mut out = [[0.0; CAPACITY]; CAPACITY];
    for i in 0..n {
        for j in 0..n {
            out[i][j] = add(i, j);
            for k in 0..n {
                for m in 0..n {
                    out[i][j] += l[i][k] * c[k][m] * l[j][m];
                }
            }
        }
    }
    out
}

/// The step in dense algebra; the measurement in Joseph's form, which loses no definiteness either.
fn take_dense(n: usize, c: &mut Dense, step: &Step) {
    let mut l = [[0.0; CAPACITY]; CAPACITY];
    for (i, row) in l.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    *c = match step {
        Step::Measure { row, noise } => {
            let ca: [f64; CAPACITY] = core::array::from_fn(|i| (0..n).map(|j| c[i][j] * row[j]).sum());
            let s = noise + (0..n).map(|i| row[i] * ca[i]).sum::<f64>();
            let gain = ca.map(|value| value / s);
            for i in 0..n {
                for j in 0..n {
                    l[i][j] -= gain[i] * row[j];
                }
            }
            sandwich(n, &l, c, |i, j| noise * gain[i] * gain[j])
        }
        Step::Predict { transition, noise } => sandwich(n, transition, c, |i, j| if i == j { noise[i] } else { 0.0 }),
        Step::Increase { factor, direction } => sandwich(n, &l, c, |i, j| factor * direction[i] * direction[j]),
        Step::Scale(factor) => sandwich(n, &l.map(|row| row.map(|value| value * factor.sqrt())), c, |_, _| 0.0),
    };
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    /// Whatever the order of the steps of a filter: the factors give what dense algebra gives. Each step of it rounds to
    /// about 1e-15 of the largest variance there has been; four decades of sizes are within the tolerance.
    #[test]
    fn any_order_of_steps_is_what_dense_algebra_gives((n, mut ud, mut c) in covariance(), steps in steps(0.5)) {
        let mut largest = 0.0_f64;
        for step in &steps {
            take(&mut ud, step);
            take_dense(n, &mut c, step);
            largest = (0..n).fold(largest, |largest, i| largest.max(c[i][i]));
            prop_assert!(ud.is_sound());
            let found = dense(&ud);
            for i in 0..n {
                for j in 0..n {
                    let error = (found[i][j] - c[i][j]).abs();
                    prop_assert!(error <= 1e-11 * largest, "({i},{j}): {} for {} after {step:?}", found[i][j], c[i][j]);
                }
            }
        }
    }

    /// Numbers over sixteen decades, at which the plain formulas lose their definiteness: no variance of any direction
    /// becomes negative.
    #[test]
    fn no_order_of_steps_and_no_sizes_lose_definiteness((n, mut ud, _) in covariance(), steps in steps(8.0)) {
        for step in &steps {
            take(&mut ud, step);
            // Products of large numbers may leave the range of a double, which the filter notices and starts again.
            prop_assume!(ud.variances()[..n].iter().all(|variance| variance.is_finite()));
            prop_assert!(ud.is_sound(), "{step:?}");
            prop_assert!(ud.variances()[..n].iter().all(|variance| *variance >= 0.0));
            if let Step::Measure { row, noise } = step {
                let projection = ud.project(row, *noise);
                prop_assert!(projection.variance >= *noise);
            }
        }
    }
}
