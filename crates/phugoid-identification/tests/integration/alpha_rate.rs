//! Terms with the rate of the angle of attack: the implicit equations and their derivatives.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_identification::longitudinal::{
    Database, LongitudinalConstants, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES,
};
use phugoid_identification::term::{Coefficient, Term};
use proptest::prelude::*;

const P: usize = 10;
const CHORD: f64 = 3.45;
const TERMS: [(Coefficient, &str); P] = [
    (Coefficient::Lift, "alpha"),
    (Coefficient::Lift, "RATE"),
    (Coefficient::Lift, "alpha*RATE"),
    (Coefficient::Drag, "alpha"),
    (Coefficient::Drag, "RATE"),
    (Coefficient::PitchingMoment, "alpha"),
    (Coefficient::PitchingMoment, "q_hat"),
    (Coefficient::PitchingMoment, "RATE"),
    (Coefficient::PitchingMoment, "elevator"),
    (Coefficient::Lift, "q_hat"),
];

/// With `rate` for the variable of the terms marked RATE, and a known term of it.
fn model(rate: &str) -> LongitudinalModel {
    let aircraft = F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap();
    let constants = LongitudinalConstants {
        wing_area: 27.87,
        mean_chord: CHORD,
        gravity: 9.80665,
        thrust_inclination: 0.03,
        thrust_arm: 0.1,
        reference_speed: 200.0,
        rate_speed: None,
        alpha_reference: 0.0417,
        elevator_reference: -0.0343,
    };
    let term = |text: &str| Term::parse(&text.replace("RATE", rate), &["given".to_owned()]).unwrap();
    let columns = TERMS.iter().map(|(coefficient, text)| (*coefficient, term(text))).collect();
    let known = vec![(Coefficient::PitchingMoment, term("RATE"), -1.5)];
    LongitudinalModel::new(constants, Database::F16(Box::new(aircraft)), columns, known)
}

type At<'a> = (&'a LongitudinalModel, [f64; STATES], [f64; P], LongitudinalInput);

fn rates_of((m, x, theta, u): At<'_>) -> LinearizedRates<STATES, P> {
    let mut out = LinearizedRates::ZERO;
    m.linearized_rates(&x, &theta, &u, &mut out);
    out
}

fn outputs_of((m, x, theta, u): At<'_>) -> LinearizedOutputs<STATES, OUTPUTS, P> {
    let mut out = LinearizedOutputs::ZERO;
    m.linearized_outputs(&x, &theta, &u, &mut out);
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, rng_seed: proptest::test_runner::RngSeed::Fixed(2), failure_persistence: None, ..ProptestConfig::default() })]

    /// The rate that it finds, given to an ordinary model as an input, gives the same motion: the equation is solved.
    /// And the derivatives are those of small differences.
    #[test]
    fn the_implicit_equations_are_solved_and_differentiated(
        // Away from the breakpoints of the tables, where a one-sided slope and a difference disagree.
        speed in 80.0..250.0_f64, alpha in 0.005..0.08_f64, pitch in -0.5..0.5_f64, q in -0.3..0.3_f64,
        elevator in -0.15..-0.01_f64, thrust in 0.0..2e4_f64, theta in proptest::array::uniform10(-3.0..3.0_f64),
    ) {
        let (implicit, given) = (model("alpha_dot_hat"), model("given"));
        let x = [speed, alpha, pitch, q];
        let u = LongitudinalInput {
            elevator, air_density: 0.65, thrust, mass: 9300.0, iyy: 75000.0, ..LongitudinalInput::default()
        };
        let (rates, outputs) = (rates_of((&implicit, x, theta, u)), outputs_of((&implicit, x, theta, u)));
        let plain = <LongitudinalModel as Model<STATES, OUTPUTS, P>>::rates(&implicit, &x, &theta, &u);
        let told = LongitudinalInput { extra: [rates.rates[1] * CHORD / (2.0 * speed), 0.0, 0.0], ..u };
        let (expected, expected_outputs) = (rates_of((&given, x, theta, told)), outputs_of((&given, x, theta, told)));
        let near = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * (1.0 + b.abs());
        for i in 0..STATES {
            prop_assert!(near(rates.rates[i], expected.rates[i], 1e-12), "rate {}", i);
            prop_assert!(near(plain[i], expected.rates[i], 1e-12), "plain rate {}", i);
        }
        for i in 0..OUTPUTS {
            prop_assert!(near(outputs.outputs[i], expected_outputs.outputs[i], 1e-12), "output {}", i);
        }
        let check = |i: usize, high: f64, low: f64, step: f64, exact: f64| {
            let difference = (high - low) / (2.0 * step);
            prop_assert!(near(difference, exact, 2e-6), "{}: {} against {}", i, difference, exact);
            Ok(())
        };
        for j in 0..STATES {
            let step = 1e-6 * (1.0 + x[j].abs());
            let (mut high, mut low) = (x, x);
            high[j] += step;
            low[j] -= step;
            let (h, l) = (rates_of((&implicit, high, theta, u)), rates_of((&implicit, low, theta, u)));
            for i in 0..STATES {
                check(i, h.rates[i], l.rates[i], step, rates.state_jacobian[i][j])?;
            }
            let (h, l) = (outputs_of((&implicit, high, theta, u)), outputs_of((&implicit, low, theta, u)));
            for i in 0..OUTPUTS {
                check(i, h.outputs[i], l.outputs[i], step, outputs.state_jacobian[i][j])?;
            }
        }
        for j in 0..P {
            let (mut high, mut low) = (theta, theta);
            high[j] += 1e-4;
            low[j] -= 1e-4;
            let (h, l) = (rates_of((&implicit, x, high, u)), rates_of((&implicit, x, low, u)));
            for i in 0..STATES {
                check(i, h.rates[i], l.rates[i], 1e-4, rates.regressors[i][j])?;
            }
            let (h, l) = (outputs_of((&implicit, x, high, u)), outputs_of((&implicit, x, low, u)));
            for i in 0..OUTPUTS {
                check(i, h.outputs[i], l.outputs[i], 1e-4, outputs.parameter_jacobian[i][j])?;
            }
        }
    }
}
