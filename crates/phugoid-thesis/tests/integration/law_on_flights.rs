//! The thesis's one-parameter law on the F-16, one coefficient unknown at a time: noise-free, with an input as small as
//! the thesis used (1 Hz sine of 0.05 deg from 3 s on) and increments of the published sizes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::TRIM;
use phugoid_estimators::discretization::{self, InputHold, IntervalInput, Part};
use phugoid_estimators::{Estimator, LinearizedOutputs, Model, Sample};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_identification::longitudinal::{Database, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES, row};
use phugoid_identification::term::{Coefficient, Term};
use phugoid_identification::trim::{LevelTrim, TrimCondition, level_trim};
use phugoid_thesis::laws::{SurfaceChannel, SurfaceDerivative, ThesisLaw, ThesisSettings};

const STEP: f64 = 0.01;

fn aircraft() -> Database {
    Database::F16(Box::new(F16::new(F16Options { cg: 0.3, ..F16Options::default() }).unwrap()))
}

fn trim() -> LevelTrim {
    let condition = TrimCondition {
        speed: 675.0 * 0.3048,
        density: phugoid_flight_dynamics::atmosphere::Atmosphere::Book.at(6096.0).density,
        mass: 9_299.813_806,
        gravity: 32.17 * 0.3048,
        wing_area: 27.870_912,
        mean_chord: 3.450_336,
        thrust_inclination: 0.0,
        thrust_arm: 0.0,
    };
    level_trim(&aircraft(), &condition).unwrap()
}

/// The trim of the published condition: alpha 2.38934 deg, elevator -1.96254 deg, thrust 2227.74 lbf.
#[test]
fn trim_is_the_published_one() {
    let trim = trim();
    assert!((trim.alpha.to_degrees() - 2.38934).abs() < 1e-4, "{}", trim.alpha.to_degrees());
    assert!((trim.elevator.to_degrees() + 1.96254).abs() < 1e-4, "{}", trim.elevator.to_degrees());
    assert!((trim.thrust / 4.448_221_615 - 2227.74).abs() < 0.05, "{}", trim.thrust);
    assert!((trim.alpha - TRIM[0]).abs() < 1e-7 && (trim.elevator - TRIM[1]).abs() < 1e-7);
}

fn model(coefficient: Coefficient, term: &str, trim: &LevelTrim) -> LongitudinalModel {
    let text = include_str!("../../../../data/models/f16.toml");
    let file = phugoid_identification::model_file::ModelFile::parse("f16", text).unwrap();
    let whole = phugoid_identification::prepare::build(&file, aircraft(), trim.alpha, trim.elevator);
    let constants = *whole.constants();
    LongitudinalModel::new(constants, aircraft(), vec![(coefficient, Term::parse(term, &[]).unwrap())], vec![])
}

struct Found {
    estimate: f64,
    /// Time after the start of the input until the estimate stays within 5 %, s.
    converged_s: Option<f64>,
}

fn run(coefficient: Coefficient, term: &str, truth: f64, channel: SurfaceChannel, lambda: f64, eta: f64) -> Found {
    let trim = trim();
    let model = model(coefficient, term, &trim);
    let bounds = if truth < 0.0 { [2.0 * truth, 0.5 * truth] } else { [0.5 * truth, 2.0 * truth] };
    let mut settings = ThesisSettings::new(0, [0.5 * truth], bounds, [channel]);
    settings.lambda = lambda;
    settings.eta = eta;
    settings.input_hold = InputHold::Linear;
    settings.follow = std::array::from_fn(|state| state != channel.state);
    let mut law: ThesisLaw<LongitudinalModel, STATES, OUTPUTS, 1, 1> = ThesisLaw::new(model.clone(), settings).unwrap();
    let input = |t: f64| LongitudinalInput {
        elevator: trim.elevator
            + if t >= 3.0 { 0.05_f64.to_radians() * (std::f64::consts::TAU * (t - 3.0)).sin() } else { 0.0 },
        air_density: phugoid_flight_dynamics::atmosphere::Atmosphere::Book.at(6096.0).density,
        thrust: trim.thrust,
        mass: 9_299.813_806,
        iyy: 75_673.623,
        ..LongitudinalInput::default()
    };
    let mut x = [675.0 * 0.3048, trim.alpha, trim.alpha, 0.0];
    let (mut last_outside, mut estimate) = (0.0, f64::NAN);
    for k in 0..2000 {
        let t = STEP * f64::from(k);
        let mut out = LinearizedOutputs::<STATES, OUTPUTS, 1>::ZERO;
        model.linearized_outputs(&x, &[truth], &input(t), &mut out);
        estimate = law.update(&Sample { time_s: t, input: input(t), outputs: out.outputs }).parameters[0];
        if (estimate / truth - 1.0).abs() > 0.05 {
            last_outside = t;
        }
        let interval = IntervalInput { from: input(t), to: input(t + STEP), hold: InputHold::Linear };
        let (mut sensitivity, mut transition) = ([[0.0; 1]; STATES], [[0.0; STATES]; STATES]);
        let part = Part { from: 0.0, to: 1.0 };
        x = discretization::step::<_, STATES, OUTPUTS, 1>(
            &model,
            &x,
            &[truth],
            &interval,
            STEP,
            part,
            0,
            &mut sensitivity,
            &mut transition,
        );
    }
    Found { estimate, converged_s: (last_outside < 19.9).then_some((last_outside - 3.0).max(0.0)) }
}

fn channel(state: usize, scale: f64, derivative: SurfaceDerivative) -> SurfaceChannel {
    SurfaceChannel { state, output: state, scale, derivative }
}

#[test]
fn each_of_the_four_coefficients_is_found_alone() {
    let qdot = SurfaceDerivative::Output(row::PITCH_ACCELERATION);
    let integrated = SurfaceDerivative::Integrated;
    // Coefficient, term, published size (its sign is lost), surface, lambda, eta. The law is as good as its eta is
    // chosen: with eta a hundred times smaller neither dCL_alpha nor dCD_alpha settles.
    let cases = [
        (Coefficient::PitchingMoment, "alpha", -0.0015, channel(3, 1e-3, qdot), 10.0, 1e-3),
        (Coefficient::PitchingMoment, "q_hat", -0.01, channel(3, 1e-3, qdot), 10.0, 1e-5),
        (Coefficient::Lift, "alpha", 0.01, channel(1, 0.05, integrated), 1.0, 1e-3),
        (Coefficient::Drag, "alpha", 0.001, channel(0, 200.0, integrated), 1.0, 1e-4),
    ];
    for (coefficient, term, truth, surface, lambda, eta) in cases {
        let found = run(coefficient, term, truth, surface, lambda, eta);
        println!(
            "d{}_{term}: {:.6} (true {truth}), within 5 % {:?} s after the input starts",
            coefficient.symbol(),
            found.estimate,
            found.converged_s
        );
        assert!((found.estimate / truth - 1.0).abs() < 0.01, "{term}: {}", found.estimate);
        // The thesis needed 0.4 to 1 s for dCm_alpha, 10 s and more for dCm_q, 15 s and more for dCL_alpha, 0.25 s for
        // dCD_alpha.
        assert!(found.converged_s.is_some_and(|t| t < 0.4), "{term}: {:?}", found.converged_s);
    }
}
