//! Settings, models and arguments that used to end in a panic: `scripts/check-no-panic.py` proves that nothing does any
//! more, and this runs what did.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../doc/lag.rs"]
#[allow(unreachable_pub)]
mod lag;

use lag::{Lag, NOISE, flight};
use phugoid_estimators::adaptive_model::AdaptiveModel;
use phugoid_estimators::health::{Expected, HealthMonitor, MonitorError, MonitorSettings};
use phugoid_estimators::implicit_sign::ImplicitSign;
use phugoid_estimators::regression::{MeasuredStates, Regression, SourceStep, StateSource};
use phugoid_estimators::settings::{EstimatorSettings, NoiseLearning, ParameterPrior, SettingsError};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::verdict::Collinearity;
use phugoid_estimators::{Estimator, LinearizedOutputs, LinearizedRates, Model, Sample};

fn settings() -> EstimatorSettings<1, 1, 2> {
    let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
    EstimatorSettings::automatic(&priors, [NOISE], 0.01).unwrap()
}

/// A model that says anything of its parameters and of the output that measures its state.
struct Liar {
    parameters: usize,
    output: usize,
}

impl<const R: usize> Model<1, R, 2> for Liar {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        self.parameters
    }

    fn rates(&self, _: &[f64; 1], _: &[f64; 2], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }

    fn linearized_rates(&self, _: &[f64; 1], _: &[f64; 2], _: &[f64; 1], out: &mut LinearizedRates<1, 2>) {
        *out = LinearizedRates::ZERO;
    }

    fn linearized_outputs(&self, _: &[f64; 1], _: &[f64; 2], _: &[f64; 1], out: &mut LinearizedOutputs<1, R, 2>) {
        *out = LinearizedOutputs::ZERO;
    }

    fn measuring_output(&self, _state: usize) -> Option<usize> {
        Some(self.output)
    }
}

/// The floor of a learnt level lay above its ceiling: `clamp` refuses that.
#[test]
fn a_white_noise_beyond_all_measure_is_borne() {
    let mut settings = settings();
    settings.noise_learning = Some(NoiseLearning::from_white([1e13]));
    let mut estimator = Smpe::new(Lag, settings).unwrap();
    for sample in &flight(3.0, |_| 3.0) {
        assert!(estimator.update(sample).parameters.iter().all(|value| value.is_finite()));
    }
}

/// Infinitely far in one step, times a prior of zero, is no number: `clamp` refuses that as a limit.
#[test]
fn a_reaching_rate_that_overflows_is_borne() {
    let mut settings = settings();
    settings.priors[1] = ParameterPrior::fixed(2.0);
    settings.maximum_gap_s = f64::INFINITY;
    let rows = Regression::new(Lag, MeasuredStates::<1>::new::<_, 1, 2>(&Lag), settings).unwrap();
    let mut law = ImplicitSign::new(rows, f64::MAX).unwrap();
    let mut last = law.estimate();
    for sample in &flight(3.0, |_| 3.0) {
        last = law.update(&Sample { time_s: 1000.0 * sample.time_s, ..*sample });
    }
    assert_eq!(last.parameters[1], 2.0);
}

/// As many parameters as there are numbers, and a bias: their sum was zero.
#[test]
fn a_model_with_too_many_parameters_is_refused_however_many_they_are() {
    let mut settings = settings();
    settings.bias_std = [0.1];
    for parameters in [3, usize::MAX] {
        let liar = || Liar { parameters, output: 0 };
        let capacity = |error: SettingsError| matches!(error, SettingsError::Capacity { capacity: 2, .. });
        assert!(AdaptiveModel::<_, 1, 1, 2>::new(liar(), &settings).err().is_some_and(capacity));
        assert!(Smpe::<_, 1, 1, 2>::new(liar(), settings).err().is_some_and(capacity));
        let expected = [Some(Expected { value: 3.0, tolerance: 0.3, failure_std: 1.0, constant: false })];
        let refused = HealthMonitor::<_, 1, 1, 2>::new(liar(), &settings, &expected, MonitorSettings::default()).err();
        assert!(matches!(refused, Some(MonitorError::Estimator(error)) if capacity(error)));
    }
}

/// The source was set up for a model with three outputs, and used with one.
#[test]
fn a_state_source_of_another_model_takes_the_prediction() {
    let mut source = MeasuredStates::<1>::new::<_, 3, 2>(&Liar { parameters: 2, output: 2 });
    let step = SourceStep {
        interval_s: 0.01,
        input_before: &[0.0],
        input_after: &[0.0],
        outputs: &[5.0],
        predicted_state: &[4.0],
        predicted_outputs: &[4.0],
    };
    assert_eq!(source.update(&step), [4.0]);
}

#[test]
fn a_column_beyond_the_room_has_no_partners() {
    let collinearity = Collinearity::of(&[[1.0, 0.98], [0.98, 1.0]], 2);
    assert_eq!(collinearity.partners(1, 0.7)[0].unwrap().column, 0);
    assert_eq!(collinearity.partners(2, 0.7), [None; 2]);
}
