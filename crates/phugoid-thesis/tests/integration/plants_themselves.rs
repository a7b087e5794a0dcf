//! The four plants of the thesis against closed forms and central differences.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate};
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_thesis::plants::{FirstOrder, FirstOrderNonlinear, SecondOrder, SecondOrderNonlinear};
use proptest::prelude::*;

/// Central difference of `f` at `at` along coordinate `j`; exact to about 1e-9 for the numbers used here.
fn difference<const A: usize, const B: usize>(f: impl Fn([f64; A]) -> [f64; B], at: [f64; A], j: usize) -> [f64; B] {
    let step = 1e-5;
    let moved = |by: f64| {
        let mut at = at;
        at[j] += by;
        f(at)
    };
    let (ahead, behind) = (moved(step), moved(-step));
    std::array::from_fn(|i| (ahead[i] - behind[i]) / (2.0 * step))
}

/// Every Jacobian of a plant against central differences of its rates and outputs, and the outputs against the rates.
fn check<M, const N: usize, const R: usize>(model: &M, x: [f64; N], theta: [f64; 3], u: M::Input, rate_row: usize)
where
    M: Model<N, R, 3>,
{
    let mut lin = LinearizedRates::ZERO;
    model.linearized_rates(&x, &theta, &u, &mut lin);
    let mut outputs = LinearizedOutputs::ZERO;
    model.linearized_outputs(&x, &theta, &u, &mut outputs);
    assert_eq!(lin.rates, model.rates(&x, &theta, &u));
    assert_eq!(outputs.outputs[..N], x);
    assert_eq!(outputs.outputs[N], lin.rates[rate_row]);
    let measured = |x: [f64; N], theta: [f64; 3]| {
        let mut out = LinearizedOutputs::ZERO;
        model.linearized_outputs(&x, &theta, &u, &mut out);
        out.outputs
    };
    let close = |exact: f64, found: f64| assert!((exact - found).abs() < 1e-6 * (1.0 + exact.abs()), "{exact} {found}");
    for j in 0..N {
        let rates = difference(|x| model.rates(&x, &theta, &u), x, j);
        (0..N).for_each(|i| close(lin.state_jacobian[i][j], rates[i]));
        let out = difference(|x| measured(x, theta), x, j);
        (0..R).for_each(|i| close(outputs.state_jacobian[i][j], out[i]));
        assert_eq!(model.measuring_output(j), Some(j));
    }
    for j in 0..model.parameter_count() {
        let rates = difference(|theta| model.rates(&x, &theta, &u), theta, j);
        (0..N).for_each(|i| close(lin.regressors[i][j], rates[i]));
        let out = difference(|theta| measured(x, theta), theta, j);
        (0..R).for_each(|i| close(outputs.parameter_jacobian[i][j], out[i]));
    }
}

proptest! {
    #[test]
    fn jacobians_are_exact(
        x in prop::array::uniform2(-3.0..3.0_f64),
        theta in prop::array::uniform3(-20.0..20.0_f64),
        u in prop::array::uniform2(-10.0..10.0_f64),
    ) {
        check::<_, 1, 2>(&FirstOrder, [x[0]], theta, [u[0]], 0);
        check::<_, 2, 3>(&FirstOrderNonlinear::default(), x, theta, u, 0);
        check::<_, 2, 3>(&SecondOrder, x, theta, [u[0]], 1);
        check::<_, 2, 3>(&SecondOrderNonlinear, x, theta, [u[0]], 1);
    }
}

fn held<const M: usize>(u: [f64; M]) -> IntervalInput<[f64; M]> {
    IntervalInput { from: u, to: u, hold: InputHold::Zero }
}

/// Step responses in closed form: `(1 - e^-at)/a`, and for a1 = 8, a2 = 6 (roots -2 and -4)
/// `1/8 - e^-2t/4 + e^-4t/8`. The quadratic spring rests at `sqrt(u/a1)`.
#[test]
fn step_responses_are_the_known_ones() {
    let x = simulate::<_, 1, 2, 1>(&FirstOrder, &[0.0], &[3.0], &held([1.0]), 0.06, 0.001);
    assert!((x[0] - (1.0 - (-0.18_f64).exp()) / 3.0).abs() < 1e-12);
    let x = simulate::<_, 2, 3, 2>(&SecondOrder, &[0.0; 2], &[8.0, 6.0], &held([1.0]), 0.06, 0.001);
    let t: f64 = 0.06;
    assert!((x[0] - (0.125 - 0.25 * (-2.0 * t).exp() + 0.125 * (-4.0 * t).exp())).abs() < 1e-12);
    let mut x = [0.0; 2];
    for _ in 0..1000 {
        x = simulate::<_, 2, 3, 2>(&SecondOrderNonlinear, &x, &[12.0, 8.0], &held([5.0]), 0.02, 0.005);
    }
    assert!((x[0] - (5.0_f64 / 12.0).sqrt()).abs() < 1e-9 && x[1].abs() < 1e-9);
}

/// The sign of `C` is lost in the text. Case 1 of table 4.2 (`u = 3 sin 0.7 t`, a = 7) decides it.
#[test]
fn the_nonlinear_first_order_plant_is_finite_only_with_negative_coupling() {
    let last_finite = |coupling: f64| {
        let plant = FirstOrderNonlinear { coupling, ..FirstOrderNonlinear::default() };
        let input = |t: f64| [3.0 * (0.7 * t).sin(), (0.7 * t).sin()];
        let mut x = [0.0; 2];
        let step = 0.001;
        (0..8000)
            .map(|k| step * f64::from(k))
            .take_while(|&t| {
                let interval = IntervalInput { from: input(t), to: input(t + step), hold: InputHold::Linear };
                x = simulate::<_, 2, 3, 1>(&plant, &x, &[7.0], &interval, step, step);
                x.iter().all(|value| value.abs() < 1e3)
            })
            .last()
            .unwrap()
    };
    let (negative, positive) = (last_finite(-4.0), last_finite(4.0));
    println!("C = -4: finite until {negative} s; C = 4: until {positive} s");
    assert!(negative > 7.9 && positive < 3.0);
}
