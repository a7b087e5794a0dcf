//! Derivatives between stability and body axes: round trips, the turned forces and moments themselves, the covariance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid_identification::form::{Argument, Derivative, Derivatives, Form, Symbol};
use phugoid_identification::term::Variable;
use proptest::prelude::*;

/// All derivatives of a build-up that is linear in all its variables.
fn names() -> Vec<Derivative> {
    let of = |symbols: &[Symbol], variables: &[Variable]| -> Vec<Derivative> {
        let arguments = || std::iter::once(Argument::Constant).chain(variables.iter().map(|v| Argument::Variable(*v)));
        symbols.iter().flat_map(|symbol| arguments().map(|argument| Derivative { symbol: *symbol, argument })).collect()
    };
    use Variable::{Aileron, Alpha, Beta, Elevator, PitchRate, RollRate, Rudder, YawRate};
    let mut all = of(&[Symbol::CL, Symbol::CD, Symbol::Cm], &[Alpha, PitchRate, Elevator]);
    all.extend(of(&[Symbol::CY, Symbol::Cl, Symbol::Cn], &[Beta, RollRate, YawRate, Aileron, Rudder]));
    all
}

/// With a covariance `L L^T` of full rank.
fn derivatives(numbers: &[f64]) -> Derivatives {
    let names = names();
    let n = names.len();
    let at = |i: usize, j: usize| if i == j { 1.0 } else { numbers[n + (i * 7 + j * 3) % (numbers.len() - n)] };
    let entry = |i: usize, j: usize| (0..=i.min(j)).map(|k| at(i, k) * at(j, k)).sum();
    let covariance = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    Derivatives { form: Form::Model, names, values: numbers[..n].to_vec(), covariance, increments: false }
}

fn value(d: &Derivatives, name: &str) -> f64 {
    let index = d.names.iter().position(|n| n.to_string() == name).unwrap_or_else(|| panic!("no {name}"));
    d.values[index]
}

fn same(a: &Derivatives, b: &Derivatives) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.names.len(), b.names.len());
    for (i, name) in a.names.iter().enumerate() {
        let k = b.names.iter().position(|n| n == name).unwrap();
        prop_assert!((a.values[i] - b.values[k]).abs() <= 1e-12, "{}", name);
        for (j, other) in a.names.iter().enumerate() {
            let l = b.names.iter().position(|n| n == other).unwrap();
            let (x, y) = (a.covariance[i][j], b.covariance[k][l]);
            prop_assert!((x - y).abs() <= 1e-12 * (1.0 + x.abs()), "cov {} {}: {} {}", name, other, x, y);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn there_and_back_is_where_it_was(numbers in proptest::collection::vec(-1.0..1.0_f64, 60), alpha in -0.5..1.0_f64) {
        let d = derivatives(&numbers);
        for form in [Form::Stability, Form::Body] {
            same(&d, &d.to(form, alpha).to(Form::Model, alpha))?;
        }
        let body = d.to(Form::Body, alpha);
        same(&body, &body.to(Form::Stability, alpha).to(Form::Body, alpha))?;
    }

    /// The forces and moments themselves, turned at the angle of attack that they are at, against those of the turned
    /// derivatives: equal in value, and in slope by differences.
    #[test]
    fn turned_derivatives_give_the_turned_forces_and_moments(
        numbers in proptest::collection::vec(-1.0..1.0_f64, 60), alpha in -0.5..1.0_f64,
        v in proptest::array::uniform7(-1.0..1.0_f64),
    ) {
        let d = derivatives(&numbers);
        let [a, q, elevator, beta, p, r, aileron] = v;
        let rudder = 0.3;
        let sum = |d: &Derivatives, symbol: &str, terms: &[(&str, f64)]| -> f64 {
            value(d, &format!("{symbol}_0")) + terms.iter().map(|(n, x)| value(d, &format!("{symbol}_{n}")) * x).sum::<f64>()
        };
        let body = d.to(Form::Body, alpha);
        // Small steps about the reference point: the remainder is of second order.
        let h = 1e-6;
        let step = [("alpha", a * h), ("q", q * h), ("elevator", elevator * h)];
        let (lift, drag) = (sum(&d, "CL", &step), sum(&d, "CD", &step));
        let (sin, cos) = (alpha + a * h).sin_cos();
        let found = [sum(&body, "CX", &step), sum(&body, "CZ", &step)];
        for (found, expected) in found.into_iter().zip([lift * sin - drag * cos, -lift * cos - drag * sin]) {
            prop_assert!((found - expected).abs() <= 1e-11, "{} {}", found, expected);
        }
        // At the reference angle of attack moments turn exactly, whatever the rates.
        let (sin, cos) = alpha.sin_cos();
        let stability = d.to(Form::Stability, alpha);
        let lateral = [("beta", beta), ("p", p), ("r", r), ("aileron", aileron), ("rudder", rudder)];
        let (ps, rs) = (p * cos + r * sin, r * cos - p * sin);
        let turned = [("beta", beta), ("ps", ps), ("rs", rs), ("aileron", aileron), ("rudder", rudder)];
        let (roll, yaw) = (sum(&d, "Cl", &lateral), sum(&d, "Cn", &lateral));
        let found = [sum(&stability, "Cls", &turned), sum(&stability, "Cns", &turned), sum(&stability, "CY", &turned)];
        let expected = [roll * cos + yaw * sin, yaw * cos - roll * sin, sum(&d, "CY", &lateral)];
        for (found, expected) in found.into_iter().zip(expected) {
            prop_assert!((found - expected).abs() <= 1e-12, "{} {}", found, expected);
        }
    }
}

/// `CL_alpha = 5`, `CL_0 = 0.4`, `CD_0 = 0.03`, `CD_alpha = 0.3` at 0.1 rad: `CZ_alpha` and `CX_alpha` by hand.
#[test]
fn the_slopes_know_the_forces_themselves() {
    let constant = |symbol| Derivative { symbol, argument: Argument::Constant };
    let slope = |symbol| Derivative { symbol, argument: Argument::Variable(Variable::Alpha) };
    let d = Derivatives {
        form: Form::Model,
        names: vec![constant(Symbol::CL), slope(Symbol::CL), constant(Symbol::CD), slope(Symbol::CD)],
        values: vec![0.4, 5.0, 0.03, 0.3],
        covariance: vec![vec![0.0; 4]; 4],
        increments: false,
    };
    let (sin, cos) = 0.1_f64.sin_cos();
    let body = d.to(Form::Body, 0.1);
    assert!((value(&body, "CZ_alpha") - (-5.03 * cos + 0.1 * sin)).abs() < 1e-14);
    assert!((value(&body, "CX_alpha") - (5.03 * sin + 0.1 * cos)).abs() < 1e-14);
}
