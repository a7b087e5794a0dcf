//! The step map and its derivatives against finite differences and closed solutions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, simulate, step, sub_steps};
use phugoid_estimators::{LinearizedOutputs, Model};
use plants::*;
use proptest::prelude::*;

const WHOLE: Part = Part { from: 0.0, to: 1.0 };

/// States of the plants here.
const N: usize = 2;

/// Derivatives of one step and its central differences, relative to the larger of them and one.
fn worst_derivative_error<M, const P: usize>(
    model: &M,
    x: [f64; N],
    theta: [f64; P],
    input: &IntervalInput<M::Input>,
    h: f64,
) -> f64
where
    M: Model<N, 3, P>,
{
    let p = model.parameter_count();
    let mut b = [[0.0; P]; N];
    let mut a = [[0.0; N]; N];
    let after = step(model, &x, &theta, input, h, WHOLE, p, &mut b, &mut a);
    let plain = simulate(model, &x, &theta, input, h, h);
    let mut worst = (0..N).fold(0.0_f64, |m, i| m.max((after[i] - plain[i]).abs()));
    for j in 0..N {
        let d = 1e-6 * x[j].abs().max(1e-2);
        let (mut up, mut down) = (x, x);
        up[j] += d;
        down[j] -= d;
        let (up, down) = (simulate(model, &up, &theta, input, h, h), simulate(model, &down, &theta, input, h, h));
        for i in 0..N {
            let difference = (up[i] - down[i]) / (2.0 * d);
            worst = worst.max((difference - a[i][j]).abs() / a[i][j].abs().max(1.0));
        }
    }
    for j in 0..p {
        let d = 1e-6 * theta[j].abs().max(1e-2);
        let (mut up, mut down) = (theta, theta);
        up[j] += d;
        down[j] -= d;
        let (up, down) = (simulate(model, &x, &up, input, h, h), simulate(model, &x, &down, input, h, h));
        for i in 0..N {
            let difference = (up[i] - down[i]) / (2.0 * d);
            worst = worst.max((difference - b[i][j]).abs() / b[i][j].abs().max(1.0));
        }
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(3), ..ProptestConfig::default() })]

    #[test]
    fn derivatives_are_those_of_the_step_map(
        x in prop::array::uniform2(-2.0..2.0_f64),
        a1 in -5.0..20.0_f64,
        a2 in -5.0..20.0_f64,
        u in prop::array::uniform2(-5.0..5.0_f64),
        h in 0.001..0.1_f64,
        linear in any::<bool>(),
    ) {
        let hold = if linear { InputHold::Linear } else { InputHold::Zero };
        let input = IntervalInput { from: [u[0]], to: [u[1]], hold };
        // Second order nonlinear in the state: the derivatives change along the step.
        let error = worst_derivative_error::<_, 4>(&QuadraticSpring, x, [a1, a2, 7.0, 7.0], &input, h);
        prop_assert!(error < 1e-7, "{error}");
    }

    #[test]
    fn a_seeded_sensitivity_becomes_a_u_plus_b(
        x in prop::array::uniform2(-1.0..1.0_f64),
        seed in prop::array::uniform2(prop::array::uniform3(-2.0..2.0_f64)),
        h in 0.001..0.2_f64,
    ) {
        let theta = [3.0, 1.0, 0.0];
        let input = IntervalInput { from: [0.5], to: [0.5], hold: InputHold::Zero };
        let (mut a, mut b) = ([[0.0; 2]; 2], [[0.0; 3]; 2]);
        step::<_, 2, 3, 3>(&QuadraticSpring, &x, &theta, &input, h, WHOLE, 3, &mut b, &mut a);
        let mut u = seed;
        let mut unused = [[0.0; 2]; 2];
        step::<_, 2, 3, 3>(&QuadraticSpring, &x, &theta, &input, h, WHOLE, 3, &mut u, &mut unused);
        for i in 0..2 {
            // Column 2 is a bias column: B is zero there, and it rides along with A.
            prop_assert_eq!(b[i][2], 0.0);
            for j in 0..3 {
                let expected = b[i][j] + (0..2).map(|k| a[i][k] * seed[k][j]).sum::<f64>();
                prop_assert!((u[i][j] - expected).abs() < 1e-12 * (1.0 + expected.abs()));
            }
        }
    }

    #[test]
    fn outputs_and_rates_have_right_derivatives(
        x in prop::array::uniform2(-0.2..0.2_f64),
        scale in prop::array::uniform6(0.2..2.0_f64),
        elevator in -0.3..0.3_f64,
    ) {
        // The test plants must themselves be right, or nothing proved with them holds.
        let model = ShortPeriod { parameters: 6, ..JET };
        let theta: [f64; 6] = core::array::from_fn(|j| if j < 4 { JET_TRUTH[j] * scale[j] } else { 0.01 * scale[j] });
        let input = IntervalInput { from: [elevator], to: [elevator], hold: InputHold::Zero };
        let error = worst_derivative_error::<_, 6>(&model, x, theta, &input, 0.02);
        prop_assert!(error < 1e-7, "{error}");
        let mut lin = LinearizedOutputs::<2, 3, 6>::ZERO;
        model.linearized_outputs(&x, &theta, &[elevator], &mut lin);
        for j in 0..6 {
            let mut up = theta;
            up[j] += 1e-3;
            let mut moved = LinearizedOutputs::<2, 3, 6>::ZERO;
            model.linearized_outputs(&x, &up, &[elevator], &mut moved);
            for i in 0..3 {
                let difference = (moved.outputs[i] - lin.outputs[i]) / 1e-3;
                prop_assert!((difference - lin.parameter_jacobian[i][j]).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn first_order_step_is_exact_to_fourth_order() {
    // x' = -a x + u over h: x(h) = u/a + (x0 - u/a) exp(-a h). RK4 in halves gains 2^4 in error.
    let exact = |h: f64| 0.5 + (2.0 - 0.5) * (-4.0 * h).exp();
    let input = IntervalInput { from: [2.0], to: [-9.0], hold: InputHold::Zero };
    let error =
        |step: f64| (simulate::<_, 1, 2, 1>(&FirstOrder, &[2.0], &[4.0], &input, 0.4, step)[0] - exact(0.4)).abs();
    let order = (error(0.1) / error(0.05)).log2();
    assert!((3.7..4.6).contains(&order), "{order}");
    // Held means held: the value at the end of the interval has no part in it.
    assert!(error(0.01) < 1e-7);
}

#[test]
fn linear_hold_integrates_a_ramp_exactly() {
    // x' = u with u from 1 to 3 in 0.5 s: x grows by 1.
    let input = IntervalInput { from: [1.0], to: [3.0], hold: InputHold::Linear };
    let x = simulate::<_, 1, 2, 1>(&FirstOrder, &[0.0], &[0.0], &input, 0.5, 0.1);
    assert!((x[0] - 1.0).abs() < 1e-14);
}

#[test]
fn sub_steps_are_bounded_and_do_not_cut_on_rounding() {
    assert_eq!(sub_steps(0.1 + 0.2, 0.3), 1);
    assert_eq!(sub_steps(0.31, 0.3), 2);
    assert_eq!(sub_steps(1e9, 1e-3), 64);
    assert_eq!(sub_steps(1.0, f64::INFINITY), 1);
    assert_eq!(sub_steps(f64::NAN, 0.1), 1);
}
