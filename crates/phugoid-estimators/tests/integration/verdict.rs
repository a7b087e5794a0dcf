//! The verdict on parameters of an integrator whose inputs are chosen to show each reason.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::verdict::{ParameterVerdict, Readiness, Reason, Verdict, VerdictMonitor};
use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};
use plants::{normal, seeded};

/// `x' = sum theta_j u_j`, `y = x + n`.
struct Integrator;

impl Model<1, 1, 3> for Integrator {
    type Input = [f64; 3];
    fn parameter_count(&self) -> usize {
        3
    }
    fn rates(&self, _: &[f64; 1], theta: &[f64; 3], u: &[f64; 3]) -> [f64; 1] {
        [theta.iter().zip(u).map(|(t, u)| t * u).sum()]
    }
    fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; 3], u: &[f64; 3], out: &mut LinearizedRates<1, 3>) {
        *out = LinearizedRates::ZERO;
        out.rates = self.rates(x, theta, u);
        out.regressors[0] = *u;
    }
    fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; 3], _: &[f64; 3], out: &mut LinearizedOutputs<1, 1, 3>) {
        *out = LinearizedOutputs::ZERO;
        out.outputs = *x;
        out.state_jacobian[0][0] = 1.0;
    }
    fn measuring_output(&self, _: usize) -> Option<usize> {
        Some(0)
    }
}

const TRUTH: [f64; 3] = [0.4, -0.3, 0.2];
const NOISE: f64 = 0.005;

/// Ten seconds at 100 Hz with the given inputs, and a last hook on the measured value.
fn fly(input: impl Fn(f64) -> [f64; 3], sensor: impl Fn(f64, f64) -> f64) -> Verdict<1, 3> {
    let priors = [ParameterPrior::bounded(0.0, -1.0, 1.0); 3];
    let mut settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01).unwrap();
    settings.change_detection = None;
    let mut smpe = Smpe::new(Integrator, settings).unwrap();
    let mut monitor = VerdictMonitor::new();
    let (mut rng, mut x) = (seeded(7), 0.0);
    let mut estimate = smpe.estimate();
    for k in 0..1000 {
        let time_s = 0.01 * f64::from(k);
        let u = input(time_s);
        let y = sensor(time_s, x + NOISE * normal(&mut rng));
        estimate = smpe.update(&Sample { time_s, input: u, outputs: [y] });
        monitor.update(&estimate, &smpe);
        x += 0.01 * Integrator.rates(&[x], &TRUTH, &u)[0];
    }
    monitor.verdict(&estimate, &smpe)
}

fn square(t: f64, period: f64) -> f64 {
    if (t / period).fract() < 0.5 { 1.0 } else { -1.0 }
}

fn words(verdict: &ParameterVerdict) -> (Readiness, Reason) {
    (verdict.readiness, verdict.reason)
}

#[test]
fn three_good_inputs_make_three_ready_parameters() {
    let verdict = fly(|t| [square(t, 2.0), square(t, 3.0), square(t, 5.0)], |_, y| y);
    for parameter in &verdict.parameters {
        assert_eq!(words(parameter), (Readiness::Ready, Reason::Settled), "{parameter:?}");
        // The bound with all others known is never larger than that without.
        assert!(parameter.excitation <= parameter.bound_over_prior * (1.0 + 1e-12));
        assert!(parameter.variance_inflation < 3.0);
    }
    assert!(verdict.condition < 10.0);
    assert!(!verdict.whiteness[0].is_coloured() && !verdict.whiteness[0].contradicts());
}

#[test]
fn an_input_that_never_moves_is_named_and_so_are_two_that_move_together() {
    let verdict = fly(|t| [square(t, 2.0), square(t, 2.0), 0.0], |_, y| y);
    let [a, b, still] = &verdict.parameters;
    assert_eq!(words(still), (Readiness::NotIdentifiable, Reason::NotExcited));
    assert!((still.excitation - 1.0).abs() < 1e-9);
    for (one, other) in [(a, 1), (b, 0)] {
        assert_eq!(words(one), (Readiness::NotIdentifiable, Reason::Collinear), "{one:?}");
        let partner = one.partners[0].unwrap();
        // Their sum alone is known: the errors are opposite.
        assert!(partner.column == other && partner.correlation < -0.99);
        // Two equal priors and a known sum: each keeps half of its prior's variance, and the others known it has next to none.
        assert!((one.bound_over_prior - 0.5_f64.sqrt()).abs() < 0.02 && one.excitation < 0.1, "{one:?}");
    }
    assert!(verdict.condition > 100.0);
}

#[test]
fn a_short_weak_input_leaves_the_bound_wide() {
    let weak = |t: f64| if t < 2.0 { 0.006 * square(t, 1.0) } else { 0.0 };
    let verdict = fly(|t| [weak(t), 0.0, 0.0], |_, y| y);
    let found = &verdict.parameters[0];
    assert_eq!(words(found), (Readiness::Improving, Reason::WideBound), "{found:?}");
}

/// A sensor that jumps to and fro by a hundred sigmas has most of its rows rejected. What was learnt before is not ready.
#[test]
fn a_model_that_contradicts_the_flight_is_not_believed() {
    let jumping = |t: f64, y: f64| if t > 6.0 && square(t, 0.3) > 0.0 { y + 100.0 * NOISE } else { y };
    let verdict = fly(|t| [square(t, 2.0), square(t, 3.0), square(t, 5.0)], jumping);
    assert!(verdict.whiteness[0].rejected > 0.25, "{:?}", verdict.whiteness);
    for parameter in &verdict.parameters {
        assert_eq!(words(parameter), (Readiness::Doubtful, Reason::ModelContradicted));
    }
}
