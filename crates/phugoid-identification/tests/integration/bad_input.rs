//! What people really hand in: missing channels, wrong units, holes, outliers, flights without excitation.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::{TRUTH, channel, fly, model, unbiased};
use phugoid_flight_data::record::{Quantity, Record};
use phugoid_identification::axes::Axes;
use phugoid_identification::compatibility::{CompatibilityOptions, compatibility};
use phugoid_identification::estimate::{EstimateError, EstimateOptions, Method, capacity, estimate};
use phugoid_identification::estimation::{Estimation, FinalStatus};
use phugoid_identification::health::{Condition, FALSE_ALARMS_PER_HOUR, HealthOptions};
use phugoid_identification::model_file::{Expectation, ModelFile, Source, Thrust};
use phugoid_identification::monitor::monitor;
use phugoid_identification::options::FlowAngles;
use phugoid_identification::regress::{RegressOptions, regress};
use phugoid_identification::session::Session;
use phugoid_identification::term::Coefficient;
use proptest::prelude::*;

const AMPLITUDE: f64 = 0.026; // 1.5 deg

fn run(record: &Record, model: &ModelFile) -> Result<Estimation, EstimateError> {
    let truth = TRUTH.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
    estimate(record, model, &EstimateOptions { truth, ..EstimateOptions::default() }, &mut |_| {})
}

fn values<'a>(record: &'a mut Record, name: &str) -> &'a mut Vec<f64> {
    &mut record.channels.iter_mut().find(|c| c.name == name).unwrap().values
}

/// Every estimate within four corrected standard errors of the truth, and the bounds worth something.
fn assert_good(estimation: &Estimation) {
    for p in &estimation.parameters {
        let error = (p.value - p.truth.unwrap()).abs();
        assert!(error < 4.0 * p.corrected_std_error, "{}: {} +- {}", p.name, p.value, p.corrected_std_error);
        assert!(p.corrected_std_error < 0.3 * p.prior_std, "{}: {}", p.name, p.corrected_std_error);
    }
}

fn said(estimation: &Estimation, words: &[&str]) -> bool {
    estimation.verdict.iter().any(|s| words.iter().all(|w| s.contains(w)))
}

#[test]
fn a_sound_flight_gives_the_truth_within_its_bounds() {
    let estimation = run(&fly(15.0, AMPLITUDE, 1), &model()).unwrap();
    assert_good(&estimation);
    assert!(estimation.events.is_empty(), "{:?}", estimation.events);
    assert!(said(&estimation, &["Noise levels measured from the record"]));
    assert!(!said(&estimation, &["Check the units"]), "{:?}", estimation.verdict);
    for (signal, std) in estimation.noise.iter().zip(common::f16::NOISE) {
        let ratio = signal.values[0] / std;
        assert!((0.6..1.6).contains(&ratio), "{}: measured noise is {ratio:.2} of the true one", signal.name);
    }
    let n = estimation.history.time_s.len();
    let h = &estimation.history;
    assert_eq!(h.phase.len(), n);
    for signal in h.inputs.iter().chain(&h.measured).chain(&h.predicted).chain(&h.residuals) {
        assert_eq!(signal.values.len(), n, "{}", signal.name);
    }
    for p in &h.parameters {
        assert_eq!((p.value.len(), p.std_error.len(), p.surface.len()), (n, n, n));
    }
    for (i, row) in estimation.correlation.iter().enumerate() {
        assert_eq!(row[i], 1.0);
        for (j, r) in row.iter().enumerate() {
            assert!((r - estimation.correlation[j][i]).abs() < 1e-9 && r.abs() <= 1.0);
        }
    }
}

#[test]
fn a_missing_channel_is_named_with_the_nearest_one() {
    let mut record = fly(2.0, AMPLITUDE, 1);
    record.channels.iter_mut().find(|c| c.name == "elevator").unwrap().name = "elevator_left".to_owned();
    let error = run(&record, &model()).unwrap_err();
    let EstimateError::MissingChannel { channel, nearest, .. } = &error else { panic!("{error}") };
    assert_eq!((channel.as_str(), nearest.as_deref()), ("elevator", Some("elevator_left")));
    let text = error.to_string();
    assert!(text.contains("simulated") && text.contains("[channels]") && text.contains("true_airspeed"), "{text}");
}

#[test]
fn an_input_without_values_is_no_output_that_could_be_left_out() {
    let mut record = fly(2.0, AMPLITUDE, 1);
    values(&mut record, "elevator").fill(f64::NAN);
    let error = run(&record, &model()).unwrap_err();
    assert_eq!(error, EstimateError::EmptyInput("elevator".to_owned()));
    let text = error.to_string();
    assert!(text.contains("[channels] elevator = ") && !text.contains("outputs"), "{text}");
}

#[test]
fn a_channel_that_the_model_file_names_itself_is_told_with_its_line() {
    let record = fly(2.0, AMPLITUDE, 1);
    let mut file = model();
    file.aircraft.thrust = Thrust::Known(Source::Channel("trust".to_owned()));
    let text = run(&record, &file).unwrap_err().to_string();
    assert!(
        text.contains("`thrust = { channel = \"trust\" }` under [aircraft]") && text.contains(&file.source),
        "{text}"
    );
    assert!(text.contains("Channels in the record: "), "{text}");
}

#[test]
fn a_model_with_nothing_to_estimate_says_so() {
    let mut file = model();
    file.parameters.iter_mut().for_each(|parameter| parameter.fixed = true);
    let expected = EstimateError::AllFixed { model: file.source.clone() };
    assert_eq!(run(&fly(2.0, AMPLITUDE, 1), &file).unwrap_err(), expected);
    assert_eq!(Session::new(&file, &EstimateOptions::default()).err(), Some(expected));
}

#[test]
fn an_airspeed_of_zero_throughout_is_refused() {
    let mut record = fly(5.0, AMPLITUDE, 1);
    values(&mut record, "true_airspeed").fill(0.0);
    let text = run(&record, &model()).unwrap_err().to_string();
    assert!(text.contains("`true_airspeed`: is 0 m/s throughout"), "{text}");
}

#[test]
fn an_elevator_with_one_value_is_named_with_what_it_cannot_tell() {
    let mut record = fly(5.0, AMPLITUDE, 1);
    let words = ["The elevator has one value throughout", "dCm_elevator"];
    let file = ModelFile::named("f16").unwrap();
    assert!(!said(&run(&record, &file).unwrap(), &words));
    values(&mut record, "elevator").fill(-0.03);
    let estimation = run(&record, &file).unwrap();
    assert!(said(&estimation, &words), "{:?}", estimation.verdict);
}

#[test]
fn a_regression_is_refused_for_a_wrong_sign_and_names_a_long_gap() {
    let regression = |record: &Record| regress(record, &model(), &RegressOptions::new(Coefficient::PitchingMoment));
    let record = fly(15.0, AMPLITUDE, 3);
    assert!(regression(&record).unwrap().reasons.is_empty());
    let mut gap = record.clone();
    let half = gap.time.len() / 2;
    gap.time.iter_mut().skip(half).for_each(|time| *time += 86_400.0);
    let text = regression(&gap).unwrap_err().to_string();
    assert!(text.contains("there is no sample between 7.") && text.contains("--from 86407."), "{text}");
    let mut wrong = record;
    values(&mut wrong, "q").iter_mut().for_each(|q| *q = -*q);
    let error = regression(&wrong).unwrap_err();
    assert!(matches!(error, EstimateError::Units { .. }), "{error}");
}

#[test]
fn degrees_given_as_radians_are_noticed_and_said() {
    let degrees = 180.0 / std::f64::consts::PI;
    let record = fly(15.0, AMPLITUDE, 2);
    for wrong in
        [&["alpha"][..], &["theta"], &["q"], &["elevator"], &["alpha", "theta"], &["alpha", "theta", "q", "elevator"]]
    {
        let mut record = record.clone();
        for name in wrong {
            values(&mut record, name).iter_mut().for_each(|v| *v *= degrees);
        }
        let error = run(&record, &model()).err().unwrap_or_else(|| panic!("{wrong:?} not noticed"));
        let EstimateError::Units { units } = &error else { panic!("{wrong:?}: {error}") };
        let text = units.join("\n");
        println!("{wrong:?}: {text}");
        assert!(text.contains("degrees read as radians") && text.contains("deg"), "{text}");
        for name in wrong {
            // q alone may be blamed on its partner: the ratio of theta and q is all that physics says.
            assert!(text.contains(name) || wrong.len() > 1, "{name} is not named in {text}");
        }
    }
}

#[test]
fn wrong_accelerometer_units_and_signs_are_refused() {
    let record = fly(15.0, AMPLITUDE, 3);
    for (factor, word) in [(-1.0, "sign"), (1.0 / 9.80665, "az_g"), (1.0 / 0.3048, "ft/s^2")] {
        let mut record = record.clone();
        values(&mut record, "az").iter_mut().for_each(|v| *v *= factor);
        let error = run(&record, &model()).unwrap_err().to_string();
        assert!(error.contains("`az`") && error.contains(word), "{error}");
    }
}

#[test]
fn missing_values_cost_information_and_nothing_else() {
    let mut record = fly(15.0, AMPLITUDE, 4);
    for name in ["alpha", "az", "elevator", "true_airspeed"] {
        for (k, v) in values(&mut record, name).iter_mut().enumerate() {
            if (k * 7 + name.len()) % 13 == 0 {
                *v = f64::NAN;
            }
        }
    }
    values(&mut record, "altitude")[0] = f64::NAN;
    let estimation = run(&record, &model()).unwrap();
    for p in &estimation.parameters {
        assert!(p.value.is_finite() && p.corrected_std_error.is_finite());
    }
    assert!(said(&estimation, &["elevator", "missing"]), "{:?}", estimation.verdict);
    assert!(said(&estimation, &["samples were left out"]), "{:?}", estimation.verdict);

    values(&mut record, "q").fill(f64::NAN);
    let error = run(&record, &model()).unwrap_err();
    assert_eq!(error, EstimateError::EmptyChannel("q".to_owned()));
}

#[test]
fn twenty_sigma_outliers_do_not_matter_and_are_counted() {
    let mut record = fly(15.0, AMPLITUDE, 5);
    for (i, name) in ["true_airspeed", "alpha", "theta", "q", "ax", "az"].into_iter().enumerate() {
        for (k, v) in values(&mut record, name).iter_mut().enumerate() {
            if (k + 3 * i) % 20 == 7 {
                *v += if k % 40 < 20 { 20.0 } else { -20.0 } * common::f16::NOISE[i];
            }
        }
    }
    let estimation = run(&record, &model()).unwrap();
    assert_good(&estimation);
    assert!(said(&estimation, &["samples of alpha", "outliers"]), "{:?}", estimation.verdict);
}

/// A second of wrong accelerations: output error, which knows no disturbance, names the method that does, where it simulates. With
/// measured air data the sensor itself is named: its error is none of the air.
#[test]
fn output_error_names_the_method_that_allows_for_disturbances() {
    let mut record = fly(15.0, AMPLITUDE, 3);
    values(&mut record, "az")[300..380].iter_mut().for_each(|v| *v += 10.0);
    let run = |flow_angles| {
        let options = EstimateOptions { method: Some(Method::OutputError), flow_angles, ..EstimateOptions::default() };
        estimate(&record, &model(), &options, &mut |_| {}).unwrap()
    };
    let found = run(FlowAngles::Simulated);
    let said = found.reasons.iter().find(|r| r.sentence.contains("more than six sigmas away")).unwrap();
    assert!(said.sentence.contains("az") && said.sentence.contains("filter-error"), "{}", said.sentence);
    let found = run(FlowAngles::Auto);
    assert!(found.parameters.iter().all(|p| p.converged_at_s.is_none() && p.status != FinalStatus::Converged));
    assert!(
        found.reasons.iter().any(|r| r.sentence.contains("check scale, bias and mounting of az")),
        "{:?}",
        found.reasons
    );
}

#[test]
fn a_flight_that_the_model_contradicts_has_no_converged_parameter() {
    let sound = run(&fly(15.0, AMPLITUDE, 3), &model()).unwrap();
    assert!(!said(&sound, &["contradicts"]), "{:?}", sound.verdict);
    let knots = |record: &mut Record| values(record, "true_airspeed").iter_mut().for_each(|v| *v /= 0.514_444);
    let sign = |record: &mut Record| values(record, "elevator").iter_mut().for_each(|v| *v *= -1.0);
    let still = |record: &mut Record| values(record, "elevator").fill(-0.03);
    let late = |record: &mut Record| values(record, "elevator").rotate_right(10);
    for (name, spoil) in [
        ("knots as m/s", &knots as &dyn Fn(&mut Record)),
        ("elevator sign", &sign),
        ("elevator stuck in the record", &still),
        ("elevator 0.2 s late", &late),
    ] {
        let mut record = fly(15.0, AMPLITUDE, 3);
        spoil(&mut record);
        let estimation = run(&record, &model()).unwrap();
        assert!(estimation.verdict[0].contains("contradicts"), "{name}: {:#?}", estimation.verdict);
        assert!(
            estimation.parameters.iter().all(|p| p.status.word() != "converged"),
            "{name}: {:#?}",
            estimation.parameters
        );
    }
}

#[test]
fn an_elevator_that_moves_while_samples_are_lost_is_said() {
    let mut record = fly(15.0, AMPLITUDE, 6);
    let elevator = values(&mut record, "elevator").clone();
    // Every sample before a step is lost, and some at rest.
    let lost = |k: usize| k % 100 == 50 || elevator.get(k + 1).is_some_and(|next| (next - elevator[k]).abs() > 0.01);
    assert!(!said(&run(&record, &model()).unwrap(), &["samples were lost"]));
    let keep = |values: &mut Vec<f64>| {
        *values = values.iter().enumerate().filter(|(k, _)| !lost(*k)).map(|(_, value)| *value).collect();
    };
    keep(&mut record.time);
    record.channels.iter_mut().for_each(|channel| keep(&mut channel.values));
    let estimation = run(&record, &model()).unwrap();
    assert!(said(&estimation, &["elevator moved", "samples were lost", "bounds"]), "{:#?}", estimation.verdict);
}

#[test]
fn a_gap_is_an_event_and_not_a_catastrophe() {
    let mut record = fly(15.0, AMPLITUDE, 6);
    let cut = |values: &mut Vec<f64>| {
        values.drain(300..450);
    };
    cut(&mut record.time);
    for channel in &mut record.channels {
        cut(&mut channel.values);
    }
    let estimation = run(&record, &model()).unwrap();
    assert_good(&estimation);
    let gap = estimation.events.iter().find(|e| e.kind.word() == "gap").unwrap();
    assert!((gap.time_s - 9.0).abs() < 1e-9 && gap.message.contains("3.0"), "{gap:?}");
    assert!(!estimation.events.iter().any(|e| e.kind.word() == "adopted"));
}

#[test]
fn without_excitation_the_bounds_stay_at_the_prior_and_the_verdict_says_so() {
    let estimation = run(&fly(15.0, 0.0, 7), &model()).unwrap();
    for p in &estimation.parameters {
        println!("{}: {} +- {} ({}) of {}", p.name, p.value, p.std_error, p.corrected_std_error, p.prior_std);
    }
    assert!(said(&estimation, &["No excitation"]), "{:?}", estimation.verdict);
    for p in &estimation.parameters {
        assert_eq!(p.status.word(), "not_excited", "{}", p.name);
        assert!(p.std_error > 0.9 * p.prior_std, "{}: {} of {}", p.name, p.std_error, p.prior_std);
        assert_eq!(p.converged_at_s, None);
    }
}

/// In absolute form steady flight fits a whole plane of parameters: a frozen recorder is no estimate of any of them.
#[test]
fn a_frozen_record_leaves_a_whole_build_up_at_its_prior() {
    let model = ModelFile::named("hfb320").unwrap();
    let time: Vec<f64> = (0..300).map(|k| 0.1 * f64::from(k)).collect();
    let frozen = [
        ("true_airspeed", Quantity::Speed, 106.0),
        ("alpha", Quantity::Angle, 0.117),
        ("theta", Quantity::Angle, 0.096),
        ("q", Quantity::AngularRate, 0.002),
        ("ax", Quantity::Acceleration, 1.03),
        ("az", Quantity::Acceleration, -9.6),
        ("qdot", Quantity::AngularAcceleration, 0.003),
        ("elevator", Quantity::Angle, -0.032),
        ("thrust", Quantity::Force, 8500.0),
    ];
    let channels = frozen.iter().map(|(name, quantity, v)| channel(name, *quantity, vec![*v; time.len()])).collect();
    let record = Record { source: "frozen".to_owned(), time, channels, ..Record::default() };
    let estimation = run(&record, &model).unwrap();
    assert!(said(&estimation, &["No excitation"]), "{:?}", estimation.verdict);
    assert!(said(&estimation, &["recorder was frozen"]), "{:?}", estimation.verdict);
    assert!(estimation.events.is_empty(), "{:?}", estimation.events);
    assert_eq!(estimation.parameters.len(), 11);
    for p in &estimation.parameters {
        assert_eq!((p.status.word(), p.converged_at_s, p.observability), ("not_excited", None, 0.0), "{}", p.name);
        assert_eq!((p.value, p.std_error, p.corrected_std_error), (p.initial, p.prior_std, p.prior_std), "{}", p.name);
    }
}

#[test]
fn a_record_cut_within_a_manoeuvre_is_not_taken_for_another_unit() {
    let mut record = fly(15.0, 2.0 * AMPLITUDE, 14);
    let az = values(&mut record, "az").clone();
    let middle = |from: usize| {
        let mut window = az[from..from + 40].to_vec();
        window.sort_by(f64::total_cmp);
        window[20]
    };
    let from = (0..az.len() - 40).max_by(|a, b| middle(*a).total_cmp(&middle(*b))).unwrap();
    println!("from {:.2} s on az has the median {:.2} m/s^2", record.time[from], middle(from));
    assert!(middle(from) > -4.0, "no push-over in this flight");
    let cut = |values: &mut Vec<f64>| *values = values[from..from + 40].to_vec();
    cut(&mut record.time);
    record.channels.iter_mut().for_each(|c| cut(&mut c.values));
    let estimation = run(&record, &model()).unwrap();
    assert!(!said(&estimation, &["Check the units", "az"]), "{:?}", estimation.verdict);
}

#[test]
fn parameters_that_cannot_be_told_apart_are_named_as_a_pair() {
    let text = unbiased()
        .replace("base = \"f16\"", "base = \"f16\"\ninputs = [\"flap\"]")
        .replace("\"q_hat\", \"elevator\"]", "\"q_hat\", \"elevator\", \"flap\"]")
        .replace("dCm_elevator =", "dCm_flap = { bounds = [-0.4, 0.4] }\ndCm_elevator =");
    let model = ModelFile::parse("flapped", &text).unwrap();
    let mut record = fly(15.0, AMPLITUDE, 8);
    // A flap that is geared to the elevator.
    let flap = values(&mut record, "elevator").iter().map(|e| 0.5 * (e - common::f16::TRIM[1])).collect();
    record.channels.push(channel("flap", Quantity::Angle, flap));
    let estimation = run(&record, &model).unwrap();
    assert!(said(&estimation, &["dCm_elevator", "dCm_flap", "cannot be told apart"]), "{:?}", estimation.verdict);
}

/// An aircraft without a vane: the message has the line to write, and with that line the flight is estimated.
#[test]
fn without_a_vane_the_message_says_the_line_that_leaves_the_angle_of_attack_out() {
    let mut record = fly(15.0, AMPLITUDE, 8);
    record.channels.retain(|channel| channel.name != "alpha");
    let text = ModelFile::text("f16").unwrap();
    let message = run(&record, &ModelFile::parse("f16.toml", text).unwrap()).unwrap_err().to_string();
    assert!(message.contains("can do without `alpha`: without a vane"), "{message}");
    assert!(message.contains("take `alpha` out of [noise] and [biases]"), "{message}");
    let from = message.find("outputs = [").unwrap();
    let line = &message[from..=from + message[from..].find(']').unwrap()];
    assert_eq!(line, "outputs = [\"true_airspeed\", \"theta\", \"q\", \"ax\", \"az\"]");
    let (before, biases) = text.split_once("[biases]").unwrap();
    let biases: Vec<&str> = biases.lines().filter(|line| !line.starts_with("alpha")).collect();
    let (head, rest) = before.split_once("[aircraft]").unwrap();
    let mended = format!("{head}{line}\n[aircraft]{rest}[biases]{}", biases.join("\n"));
    let estimation = run(&record, &ModelFile::parse("f16.toml", &mended).unwrap()).unwrap();
    for p in estimation.parameters.iter().filter(|p| !p.nuisance) {
        let error = (p.value - p.truth.unwrap()).abs();
        assert!(error < 4.0 * p.corrected_std_error, "{}: {} +- {}", p.name, p.value, p.corrected_std_error);
    }
    // A state that nothing else gives is not offered to be left out.
    record.channels.retain(|channel| channel.name != "q");
    let message = run(&record, &ModelFile::parse("f16.toml", text).unwrap()).unwrap_err().to_string();
    assert!(message.contains("`q` is missing") || message.contains("needs `q`"), "{message}");
    assert!(message.contains("outputs = [\"true_airspeed\", \"theta\", \"q\", \"ax\", \"az\"]"), "{message}");
}

#[test]
fn more_parameters_than_there_is_room_for_are_refused() {
    let terms: Vec<String> = (1..=9).flat_map(|a| (1..=3).map(move |q| format!("\"alpha^{a}*q_hat^{q}\""))).collect();
    let names: Vec<String> =
        (1..=9).flat_map(|a| (1..=3).map(move |q| (a, q))).map(|(a, q)| power_name(a, q)).collect();
    let priors: String = names.iter().map(|n| format!("{n}.prior_std = 1\n")).collect();
    let text = unbiased()
        .replace("Cm = [", &format!("Cm = [{}, ", terms.join(", ")))
        .replace("[parameters] ", &format!("[parameters]\n{priors}#"));
    let model = ModelFile::parse("crowded", &text).unwrap();
    let error = run(&fly(2.0, AMPLITUDE, 9), &model).unwrap_err();
    assert_eq!(error, EstimateError::TooManyParameters { wanted: 32, capacity: capacity(Axes::Longitudinal) });
}

fn power_name(alpha: u32, q: u32) -> String {
    let power = |n: u32| if n > 1 { n.to_string() } else { String::new() };
    format!("dCm_alpha{}_q{}", power(alpha), power(q))
}

#[test]
fn a_record_that_is_cut_short_is_refused() {
    let mut record = fly(2.0, AMPLITUDE, 10);
    record.time.truncate(12);
    for channel in &mut record.channels {
        channel.values.truncate(12);
    }
    assert_eq!(run(&record, &model()).unwrap_err(), EstimateError::TooShort { samples: 12 });
    record.time.clear();
    for channel in &mut record.channels {
        channel.values.clear();
    }
    assert!(run(&record, &model()).is_err());
}

#[test]
fn units_and_the_order_of_channels_do_not_matter() {
    // The same flight with its channels in reverse order gives the same bits.
    let record = fly(8.0, AMPLITUDE, 11);
    let mut reversed = record.clone();
    reversed.channels.reverse();
    let (a, b) = (run(&record, &model()).unwrap(), run(&reversed, &model()).unwrap());
    assert_eq!(a.parameters, b.parameters);
    // And a model file in SI the same numbers as one in feet and slugs.
    let si = unbiased()
        .replace("\"637.2396642834939 slug\"", "9299.813806")
        .replace("\"300 ft^2\"", "27.870912")
        .replace("\"11.32 ft\"", "3.450336")
        .replace("\"55814 slug*ft^2\"", "75673.623");
    let c = run(&record, &ModelFile::parse("si", &si).unwrap()).unwrap();
    for (p, q) in a.parameters.iter().zip(&c.parameters) {
        assert!((p.value - q.value).abs() < 1e-4 * p.prior_std, "{}: {} {}", p.name, p.value, q.value);
    }
}

#[test]
fn a_channel_of_another_length_is_refused() {
    let mut record = fly(2.0, AMPLITUDE, 12);
    values(&mut record, "alpha").pop();
    let error = run(&record, &model()).unwrap_err().to_string();
    assert!(error.contains("`alpha` has 99 values for 100 times"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever numbers stand in a record: an answer that is finite where it matters, or an error, and never a panic.
    #[test]
    fn wild_values_never_panic(
        damage in prop::collection::vec(
            (0..8_usize, 0..150_usize, 1..60_usize, prop::sample::select(vec![
                f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 1e300, -1e300, 1e-300, 1e6, -500.0,
            ])),
            0..6,
        ),
        gap in 0.0..1e4_f64,
    ) {
        let mut record = fly(3.0, AMPLITUDE, 13);
        for (channel, from, length, value) in damage {
            for v in record.channels[channel].values.iter_mut().skip(from).take(length) {
                *v = value;
            }
        }
        record.time.iter_mut().skip(100).for_each(|t| *t += gap);
        if let Ok(estimation) = run(&record, &model()) {
            for p in &estimation.parameters {
                prop_assert!(p.value.is_finite() && p.corrected_std_error.is_finite(), "{} {}", p.name, p.value);
                prop_assert!(p.corrected_std_error >= 0.0 && p.corrected_std_error >= p.std_error);
            }
        }
    }
}

/// The equations of motion are kept by the seconds that have samples. By the seconds of the record's time, thirty years of them asked for 72 GB.
#[test]
fn a_gap_of_thirty_years_is_no_matter_of_memory() {
    let mut record = fly(15.0, AMPLITUDE, 1);
    let samples = record.time.len();
    record.time[samples / 2..].iter_mut().for_each(|time| *time += 1e9);
    assert_eq!(run(&record, &model()).unwrap().parameters.len(), TRUTH.len());
}

/// A gyro that freezes looks to the monitor like another aircraft.
#[test]
fn a_monitor_does_not_take_a_frozen_gyro_for_a_failure_of_the_aircraft() {
    let elevator = Expectation { name: TRUTH[0].0.to_owned(), value: TRUTH[0].1, tolerance: 0.04, failure_std: None };
    let health = HealthOptions { expected: vec![elevator], false_alarms_per_hour: FALSE_ALARMS_PER_HOUR };
    let mut record = fly(30.0, AMPLITUDE, 1);
    let from = record.time.iter().position(|time| *time >= 12.0).unwrap();
    let q = values(&mut record, "q");
    let frozen = q[from];
    q[from..].fill(frozen);
    let (_, report) = monitor(&record, &model(), &EstimateOptions::default(), &health, &mut |_| {}).unwrap();
    assert_ne!(report.condition, Condition::Diverged, "{:?}", report.sentences);
    assert!(report.failure.is_none() && !report.promise.holds);
    assert!(report.sentences[0].contains("`q`: repeats one value"), "{:?}", report.sentences);
}

/// A sign is no bias of 2 g.
#[test]
fn a_reversed_accelerometer_is_no_bias() {
    let mut record = fly(15.0, AMPLITUDE, 1);
    values(&mut record, "az").iter_mut().for_each(|az| *az = -*az);
    match compatibility(&record, &CompatibilityOptions::default()) {
        Err(EstimateError::Units { units }) => assert!(units[0].contains("`az`"), "{units:?}"),
        other => panic!("{other:?}"),
    }
}
