//! The model-reference estimator: what its printed law can hold, the limits of its step, its Lyapunov function.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::{Estimator, Phase, Sample};
use phugoid_thesis::laws::{SurfaceChannel, SurfaceDerivative};
use phugoid_thesis::model_reference::{
    ModelReference, ModelReferenceError, ModelReferenceForm, ModelReferenceSettings,
};
use phugoid_thesis::plants::{FirstOrder, SecondOrder};
use plants::{fly, regular, seeded};

type Samples = Vec<Sample<[f64; 1], 2>>;
type Law = ModelReference<FirstOrder, 1, 2, 1, 1>;

const INTEGRATED: SurfaceDerivative = SurfaceDerivative::Integrated;
const MEASURED: SurfaceDerivative = SurfaceDerivative::Output(1);

fn first_order(a: f64, step_s: f64, seconds: f64, x0: f64, input: impl Fn(f64) -> f64) -> Samples {
    let times = regular((seconds / step_s) as usize, step_s);
    fly(&FirstOrder, &times, [x0], |_| [a], |t| [input(t)], [0.0; 2], &mut seeded(1))
}

fn settings(
    form: ModelReferenceForm,
    gain: f64,
    start: f64,
    derivative: SurfaceDerivative,
) -> ModelReferenceSettings<1, 1, 1> {
    let channel = SurfaceChannel { state: 0, output: 0, scale: 1.0, derivative };
    ModelReferenceSettings::new(form, gain, [start], [1.0], [channel])
}

/// Estimate after each sample.
fn run(settings: ModelReferenceSettings<1, 1, 1>, samples: &Samples) -> Vec<f64> {
    let mut law = Law::new(FirstOrder, settings).unwrap();
    samples.iter().map(|sample| law.update(sample).parameters[0]).collect()
}

/// `theta = theta(0) - g R E` at every sample, whatever happened before: the printed law keeps no memory. So at a zero of
/// the measurement the estimate is on one side of its start, at a zero of the model on the other, whatever the gain.
#[test]
fn the_printed_law_is_a_feedback_of_the_energy_alone() {
    let (start, truth) = (4.0, 3.0);
    for gain in [-1.0, -10.0, -100.0] {
        let samples = first_order(truth, 0.001, 20.0, 0.0, |t| 3.0 * (2.0 * t).sin());
        let mut law = Law::new(FirstOrder, settings(ModelReferenceForm::Printed, gain, start, INTEGRATED)).unwrap();
        let mut wrong_side = [0; 2];
        let mut last = [0.0; 2];
        for (k, sample) in samples.iter().enumerate() {
            let theta = law.update(sample).parameters[0];
            assert!((theta - (start - gain * law.energy())).abs() < 1e-9 * gain.abs(), "{theta} {}", law.energy());
            let now = [sample.outputs[0], law.state()[0]];
            // Crossing within a thousandth: y^2/2 there is at most 1e-5.
            if k > 0 && now[0] * last[0] < 0.0 {
                assert!(theta >= start - 1e-4 * gain.abs(), "measurement zero: {theta}");
                wrong_side[0] += 1;
            }
            if k > 0 && now[1] * last[1] < 0.0 {
                assert!(theta <= start + 1e-4 * gain.abs(), "model zero: {theta}");
                wrong_side[1] += 1;
            }
            last = now;
        }
        assert!(wrong_side.iter().all(|n| *n > 10), "{wrong_side:?}");
    }
}

/// At rest under a step, `theta - theta(0) = |g| R (1/theta^2 - 1/a^2)/2`: it settles short of the truth, nearer with more gain.
/// Measured derivatives give the same but for the rectangle rule.
#[test]
fn under_a_step_the_printed_law_stops_short_of_the_truth() {
    let (start, truth) = (4.0, 3.0);
    let samples = first_order(truth, 0.001, 40.0, 0.0, |_| 1.0);
    let mut last = f64::INFINITY;
    for gain in [-10.0, -100.0, -1000.0] {
        for (derivative, tolerance) in [(INTEGRATED, 1e-9), (MEASURED, 0.02)] {
            let end = *run(settings(ModelReferenceForm::Printed, gain, start, derivative), &samples).last().unwrap();
            let balance = end - start - gain.abs() * (1.0 / (end * end) - 1.0 / (truth * truth)) / 2.0;
            // The rest must turn the balance into an error of the estimate: divide by its slope.
            let error = balance / (1.0 + gain.abs() / end.powi(3));
            println!("gain {gain} {derivative:?}: rests at {end}, balance off by {error:.1e}");
            assert!(error.abs() < tolerance, "gain {gain}, {derivative:?}: rests at {end}");
            if derivative == INTEGRATED {
                assert!(end > truth && end < last, "nearer with more gain: {end}");
                last = end;
            }
        }
    }
    assert!(last / truth - 1.0 < 0.05);
}

/// Growth of a small disturbance from the middle to the end of a run, as a factor.
fn growth(history: &[f64], truth: f64) -> f64 {
    let largest = |part: &[f64]| part.iter().map(|v| (v - truth).abs()).fold(0.0, f64::max);
    let (first, second) = history.split_at(history.len() / 2);
    largest(&second[second.len() - 20..]) / largest(&first[..20])
}

/// Linearised about rest, `dx+ = (alpha - |g| R x |B|) dx` with `alpha = exp(-a h)`, `|B| = x (1 - alpha)/a`: the limit is
/// `|g| R = a/(x^2 tanh(a h/2))`, which is `2/(h x^2)` for small steps.
#[test]
fn the_step_limit_of_the_printed_law() {
    let (a, h) = (3.0_f64, 0.01);
    let limit = a * a * a / (0.5 * a * h).tanh();
    assert!((limit / (2.0 * a * a / h) - 1.0).abs() < 1e-3);
    let samples = first_order(a, h, 4.0, 1.0 / a, |_| 1.0);
    for (fraction, stable) in [(0.97, true), (1.03, false)] {
        let start = a * (1.0 + 1e-9);
        let history = run(settings(ModelReferenceForm::Printed, -fraction * limit, start, INTEGRATED), &samples);
        let growth = growth(
            &history,
            *run(settings(ModelReferenceForm::Printed, -limit, a, INTEGRATED), &samples).last().unwrap(),
        );
        println!("{fraction} of the limit {limit:.0}: grows by {growth:.1e}");
        assert_eq!(growth < 1.0, stable, "{growth}");
    }
}

/// With a constant regressor the pair `(e, theta)` has determinant `rho` and trace `1 + rho - g b^2`: stable to
/// `g b^2 = 2 (1 + rho)`. The Lyapunov function falls up to `1 - rho^2` only, but for every input (next test).
#[test]
fn the_step_limit_of_the_state_error_form() {
    let (a, h) = (3.0_f64, 0.01);
    let b = (1.0 - (-a * h).exp()) / (a * a);
    let limit = 2.0 * (1.0 + (-2.0 * h).exp()) / (b * b);
    let samples = first_order(a, h, 6.0, 1.0 / a, |_| 1.0);
    for (fraction, stable) in [(0.97, true), (1.03, false)] {
        let start = a * (1.0 + 1e-9);
        let growth =
            growth(&run(settings(ModelReferenceForm::StateError, fraction * limit, start, INTEGRATED), &samples), a);
        println!("{fraction} of the limit {limit:.0}: grows by {growth:.1e}");
        assert_eq!(growth < 1.0, stable, "{growth}");
    }
}

/// Largest rise of `V = e^2/2 + (a - theta)^2/(2 g)` from one sample to the next, as a fraction of its first value, and its end.
fn lyapunov(settings: ModelReferenceSettings<1, 1, 1>, samples: &Samples, truth: f64) -> (f64, f64) {
    let mut law = Law::new(FirstOrder, settings).unwrap();
    let mut values = Vec::new();
    for sample in samples {
        let miss = truth - law.update(sample).parameters[0];
        values.push(0.5 * law.error()[0].powi(2) + 0.5 * miss * miss / settings.gain);
    }
    let rise = values.windows(2).map(|w| w[1] - w[0]).fold(f64::NEG_INFINITY, f64::max);
    (rise / values[0], values.last().unwrap() / values[0])
}

#[test]
fn the_lyapunov_function_of_the_state_error_form_falls_for_small_steps() {
    let (truth, h) = (3.0, 0.001);
    for (seed, input) in
        [(0.0, 1.0), (1.0, 3.0), (2.0, 10.0)].map(|(s, amplitude)| (s, move |t: f64| amplitude * (2.0 * t + s).sin()))
    {
        let samples = first_order(truth, h, 20.0, 0.0, input);
        let largest = samples.iter().map(|s| s.outputs[0].abs()).fold(0.0, f64::max);
        // g (h x)^2 = 1 - rho^2.
        let limit = (1.0 - (-4.0 * h).exp()) / (h * largest).powi(2);
        for fraction in [1e-3, 0.1, 0.95] {
            let (rise, end) =
                lyapunov(settings(ModelReferenceForm::StateError, fraction * limit, 5.0, INTEGRATED), &samples, truth);
            println!("phase {seed}, {fraction} of {limit:.0}: largest rise {rise:.1e}, end {end:.1e}");
            assert!(rise < 1e-12, "{rise}");
            assert!(end < 1e-3, "enough excitation: {end}");
        }
        let (rise, _) =
            lyapunov(settings(ModelReferenceForm::StateError, 100.0 * limit, 5.0, INTEGRATED), &samples, truth);
        assert!(rise > 1e-3, "the condition is needed: {rise}");
    }
}

/// With an input that never lets the energy rest, gradient descent and state error find it from above and from below.
#[test]
fn with_excitation_they_find_the_parameter() {
    // (truth, start, seconds): the unstable plant's run ends while it is finite.
    for (truth, start, seconds) in [(3.0, 4.0, 30.0), (3.0, 2.0, 30.0), (0.5, 1.0, 60.0)] {
        let samples = first_order(truth, 0.005, seconds, 0.0, |t| 2.0 + 1.5 * (1.1 * t).sin() + (2.7 * t).sin());
        for (form, gain, normalisation) in [
            (ModelReferenceForm::EnergyGradient, 20.0, None),
            (ModelReferenceForm::EnergyGradient, 20.0, Some(1.0)),
            (ModelReferenceForm::StateError, 20.0, None),
            (ModelReferenceForm::StateError, 20.0, Some(1.0)),
        ] {
            let mut settings = settings(form, gain, start, INTEGRATED);
            settings.normalisation = normalisation;
            let end = *run(settings, &samples).last().unwrap();
            println!("{form:?} {normalisation:?}: {end} (true {truth})");
            assert!((end / truth - 1.0).abs() < 0.01, "{form:?} {normalisation:?}: {end}, true {truth}");
        }
    }
    let samples = first_order(-1.0, 0.005, 6.0, 0.1, |_| 0.1);
    let mut settings = settings(ModelReferenceForm::StateError, 50.0, -0.5, INTEGRATED);
    settings.normalisation = Some(1.0);
    let end = *run(settings, &samples).last().unwrap();
    assert!((end + 1.0).abs() < 0.01, "unstable plant: {end}");
}

/// A gain that suits an input of 1 makes the plain law escape under an input of 1000; the normalised one does not mind.
#[test]
fn normalised_it_stays_bounded_for_large_inputs() {
    for amplitude in [1.0, 1e3, 1e6] {
        let samples = first_order(3.0, 0.01, 40.0, 0.0, |t| amplitude * (2.0 + (1.1 * t).sin()));
        let mut plain = settings(ModelReferenceForm::StateError, 20.0, 4.0, INTEGRATED);
        plain.error_decay = 2.0;
        let largest = |history: &[f64]| history.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let escaped = largest(&run(plain, &samples)) > 1e3;
        assert_eq!(escaped, amplitude > 1.0, "plain, input {amplitude}");
        for form in [ModelReferenceForm::StateError, ModelReferenceForm::EnergyGradient] {
            let mut normalised = settings(form, 20.0, 4.0, INTEGRATED);
            normalised.normalisation = Some(0.1);
            let history = run(normalised, &samples);
            let (worst, end) = (largest(&history), history.last().unwrap());
            println!("input {amplitude}, {form:?}: at most {worst:.2}, end {end:.4}");
            assert!(worst < 8.0, "{form:?}, input {amplitude}: {worst}");
            assert!((end / 3.0 - 1.0).abs() < 0.05, "{form:?}, input {amplitude}: {end}");
        }
    }
}

/// The printed law moves all parameters along the one direction of their ranges; the state error finds both.
#[test]
fn two_parameters_need_more_than_the_printed_law() {
    let (truth, start) = ([8.0, 6.0], [6.0, 5.0]);
    let input = |t: f64| [10.0 * ((1.3 * t).sin() + (3.1 * t).sin())];
    let samples = fly(&SecondOrder, &regular(30_000, 0.002), [0.0; 2], |_| truth, input, [0.0; 3], &mut seeded(1));
    let channel = SurfaceChannel { state: 1, output: 1, scale: 1.0, derivative: INTEGRATED };
    let mut settings =
        ModelReferenceSettings::<2, 2, 1>::new(ModelReferenceForm::Printed, -2.0, start, [1.0, 2.0], [channel]);
    let mut law = ModelReference::<_, 2, 3, 2, 1>::new(SecondOrder, settings).unwrap();
    for sample in &samples {
        let theta = law.update(sample).parameters;
        assert!((2.0 * (theta[0] - start[0]) - (theta[1] - start[1])).abs() < 1e-9);
    }
    settings.form = ModelReferenceForm::StateError;
    settings.gain = 50.0;
    let mut law = ModelReference::<_, 2, 3, 2, 1>::new(SecondOrder, settings).unwrap();
    let end = samples.iter().map(|sample| law.update(sample).parameters).last().unwrap();
    println!("state error: {end:?}");
    assert!((0..2).all(|j| (end[j] / truth[j] - 1.0).abs() < 0.01), "{end:?}");
}

#[test]
fn bad_samples_do_no_harm() {
    for (form, gain) in [
        (ModelReferenceForm::Printed, -100.0),
        (ModelReferenceForm::EnergyGradient, 20.0),
        (ModelReferenceForm::StateError, 20.0),
    ] {
        let mut samples = first_order(3.0, 0.005, 30.0, 0.0, |t| 2.0 + 1.5 * (1.1 * t).sin());
        for (k, sample) in samples.iter_mut().enumerate() {
            match k % 7 {
                0 => sample.outputs[0] = f64::NAN,
                3 => sample.outputs[1] = f64::INFINITY,
                _ => {}
            }
        }
        samples[500].time_s = 0.1;
        samples[600].input = [f64::NAN];
        samples[700].time_s = f64::NAN;
        let mut settings =
            settings(form, gain, 4.0, if form == ModelReferenceForm::Printed { MEASURED } else { INTEGRATED });
        (settings.lower, settings.upper) = ([1.0], [9.0]);
        let mut law = Law::new(FirstOrder, settings).unwrap();
        let mut refused = 0;
        for sample in &samples {
            let estimate = law.update(sample);
            assert!((1.0..=9.0).contains(&estimate.parameters[0]), "{form:?}: {}", estimate.parameters[0]);
            assert!(estimate.std_error[0].is_infinite() && estimate.corrected_std_error[0].is_infinite());
            refused += usize::from(estimate.status.phase == Phase::Rejected);
        }
        assert_eq!(refused, 2, "{form:?}");
        let mut covariance = [[0.0; 1]; 1];
        law.covariance(&mut covariance);
        assert!(covariance[0][0].is_infinite());
        // After a long pause the model starts again on the measurement, and the estimate stays.
        let before = law.update(&Sample { time_s: 30.0, input: [2.0], outputs: [0.7, 0.0] }).parameters[0];
        let after = law.update(&Sample { time_s: 100.0, input: [1.0], outputs: [0.2, 0.0] }).parameters[0];
        assert_eq!((after, law.state()[0]), (before, 0.2), "{form:?}");
        if form == ModelReferenceForm::StateError {
            assert!((after / 3.0 - 1.0).abs() < 0.02, "{after}");
        }
    }
}

#[test]
fn impossible_settings_are_refused() {
    let good = settings(ModelReferenceForm::StateError, 20.0, 4.0, INTEGRATED);
    let refuse = |settings| Law::new(FirstOrder, settings).err().unwrap();
    assert!(Law::new(FirstOrder, good).is_ok());
    let mut wrong = good;
    wrong.gain = -1.0;
    assert_eq!(refuse(wrong), ModelReferenceError::Setting { name: "gain", value: -1.0 });
    assert!(refuse(wrong).to_string().contains("gain"));
    wrong.form = ModelReferenceForm::Printed;
    assert!(Law::new(FirstOrder, wrong).is_ok(), "its sign has to be that of z");
    let mut wrong = good;
    wrong.upper = [3.0];
    assert_eq!(refuse(wrong), ModelReferenceError::Parameter { index: 0 });
    let mut wrong = good;
    wrong.lower = [f64::NAN];
    assert_eq!(refuse(wrong), ModelReferenceError::Parameter { index: 0 });
    let mut wrong = good;
    wrong.ranges = [0.0];
    assert_eq!(refuse(wrong), ModelReferenceError::NothingUnknown);
    let mut wrong = good;
    wrong.channels[0].derivative = SurfaceDerivative::Output(2);
    assert_eq!(refuse(wrong), ModelReferenceError::Channel { index: 0 });
    let mut wrong = good;
    wrong.normalisation = Some(0.0);
    assert_eq!(refuse(wrong), ModelReferenceError::Setting { name: "normalisation", value: 0.0 });
}

/// The method `model-reference` of the program has the state-error law of its own, over all states and normalised: bit for
/// bit the one here, through missing measurements, a gap and a frame from the past.
#[test]
fn the_method_of_the_program_is_the_state_error_law() {
    use phugoid_estimators::adaptive_model::AdaptiveModel;
    use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
    use plants::{JET, JET_NOISE, JET_TRUTH, elevator_3211};

    const P: usize = 6;
    let truth: [f64; P] = JET_TRUTH;
    let start: [f64; P] = [-0.4, -10.0, 4.0, -1.0, 0.0, 0.0];
    let std: [f64; P] = [0.2, 10.0, 1.0, 0.4, 0.1, 0.1];
    let priors: Vec<ParameterPrior> = (0..P).map(|j| ParameterPrior::absolute(start[j], std[j])).collect();
    let shared: EstimatorSettings<2, 3, P> = EstimatorSettings::automatic(&priors, JET_NOISE, 0.01).unwrap();
    let channels = [0, 1].map(|i| SurfaceChannel { state: i, output: i, scale: JET_NOISE[i], derivative: INTEGRATED });
    let settings = ModelReferenceSettings {
        lower: core::array::from_fn(|j| shared.priors[j].lower),
        upper: core::array::from_fn(|j| shared.priors[j].upper),
        normalisation: Some(4.0),
        initial_state: shared.initial_state,
        input_hold: shared.input_hold,
        maximum_step_s: shared.maximum_step_s,
        maximum_gap_s: shared.maximum_gap_s,
        ..ModelReferenceSettings::new(ModelReferenceForm::StateError, 2.0, start, std.map(|s| 2.0 * s), channels)
    };
    let mut law: ModelReference<_, 2, 3, P, 2> = ModelReference::new(JET, settings).unwrap();
    let mut method: AdaptiveModel<_, 2, 3, P> = AdaptiveModel::new(JET, &shared).unwrap();
    let times: Vec<f64> = regular(3000, 0.01).into_iter().map(|t| if t > 20.0 { t + 5.0 } else { t }).collect();
    let mut record = fly(&JET, &times, [0.0; 2], |_| truth, |t| [elevator_3211(t)], JET_NOISE, &mut seeded(3));
    record[0].outputs[1] = f64::NAN;
    record[700].outputs[0] = f64::NAN;
    record[900].time_s = 1.0;
    for sample in &record {
        let (one, other) = (law.update(sample), method.update(sample));
        assert_eq!(one.parameters.map(f64::to_bits), other.parameters.map(f64::to_bits), "at {} s", sample.time_s);
        assert_eq!((one.status.phase, one.parameter_status), (other.status.phase, other.parameter_status));
    }
    assert!((0..4).all(|j| law.update(&record[2999]).parameters[j] != start[j]));
}
