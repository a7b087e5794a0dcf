//! What the axes of a model file need, and what is said when it is not there.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_identification::axes::Axes;
use phugoid_identification::estimate::{EstimateError, EstimateOptions, capacity, estimate};
use phugoid_identification::model_file::{ModelFile, ReferenceValue, Source};
use phugoid_identification::output::Output;

/// A light aircraft's lateral-directional build-up.
const LATERAL: &str = r#"
name = "lateral"
axes = ["lateral"]

[aircraft]
mass = "1000 kg"
ixx = "1300 kg*m^2"
iyy = "1800 kg*m^2"
izz = "2700 kg*m^2"
ixz = 0
wing_area = "16 m^2"
mean_chord = "1.5 m"
wing_span = "11 m"
air_density = 1.1

[coefficients]
CY = ["beta", "rudder"]
Cl = ["beta", "p_hat", "r_hat", "aileron", "alpha*r_hat"]
Cn = ["beta", "r_hat", "rudder"]
offsets = true

[parameters]
CY_beta = { start = -0.3, prior_std = 0.3 }
CY_rudder = { start = 0.2, prior_std = 0.2 }
Cl_beta = { start = -0.1, prior_std = 0.1 }
Cl_p = { start = -0.5, prior_std = 0.3 }
Cl_r = { start = 0.1, prior_std = 0.1 }
Cl_aileron = { start = -0.15, prior_std = 0.1 }
Cl_alpha_r = { start = 0, prior_std = 0.3 }
Cn_beta = { start = 0.07, prior_std = 0.05 }
Cn_r = { start = -0.1, prior_std = 0.1 }
Cn_rudder = { start = -0.06, prior_std = 0.05 }

[reference]
aileron = "first_sample"

[noise]
beta = "0.1 deg"

[process_noise]
beta = 3e-5
p = "0.01 deg^2/s^3"

[biases]
ay = "0.02 g"
"#;

#[test]
fn a_lateral_file_is_understood() {
    let file = ModelFile::parse("lateral", LATERAL).unwrap();
    assert_eq!(file.axes, Axes::LateralDirectional);
    let measured: Vec<&str> = file.measured().map(Output::name).collect();
    assert_eq!(measured, ["beta", "phi", "p", "r", "ay"]);
    assert_eq!(file.aircraft.wing_span, Some(11.0));
    assert_eq!(file.aircraft.ixz, Some(Source::Constant(0.0)));
    let names: Vec<&str> = file.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names[..2], ["CY_beta", "CY_rudder"]);
    assert_eq!(names[6], "Cl_alpha_r");
    assert_eq!(names[10..], ["offset_CY", "offset_Cl", "offset_Cn", "bias_ay"]);
    assert!((file.noise[Output::Beta.index()].unwrap() - 0.1_f64.to_radians()).abs() < 1e-15);
    assert_eq!(file.process_noise.density[Output::Beta.index()], 3e-5);
    assert!((file.process_noise.density[Output::RollRate.index()] - 0.01 * 1.0_f64.to_radians().powi(2)).abs() < 1e-15);
    assert_eq!(file.reference.aileron, ReferenceValue::FirstSample);
    let used = file.channels_used();
    for channel in ["aileron", "rudder", "true_airspeed", "alpha", "theta", "q", "ax", "az", "beta", "ay"] {
        assert!(used.contains(&channel), "{channel} is not in {used:?}");
    }
    assert!(!used.contains(&"elevator") && !used.contains(&"thrust"), "{used:?}");
}

#[test]
fn what_the_axes_do_not_have_is_refused_with_what_to_do() {
    let both = r#"axes = ["longitudinal", "lateral"]"#;
    for (from, to, message, nearest) in [
        ("wing_span = \"11 m\"\n", "", &["`wing_span` is missing in [aircraft]", "lateral axes"][..], None),
        ("wing_span", "wingspan", &["unknown key `wingspan`"], Some("wing_span")),
        ("ixx = \"1300 kg*m^2\"\n", "", &["`ixx` is missing", "channel = \"ixx\""], None),
        ("ixz = 0", "ixz = \"2000 kg*m^2\"", &["`ixz` is 2000", "below ixx izz"], None),
        ("\"beta\", \"rudder\"]", "\"betta\", \"rudder\"]", &["unknown variable `betta`", "did you mean `beta`"], None),
        ("\"beta\", \"rudder\"]", "\"beta\", \"elevator\"]", &["`elevator` is no variable of the lateral", both], None),
        ("\"beta\", \"r_hat\"", "\"alpha_dot_hat\", \"r_hat\"", &["`alpha_dot_hat`", "effective derivative"], None),
        ("CY = [", "CL = [\"alpha\"]\nCY = [", &["`CL` is no coefficient of the lateral", both], None),
        ("[noise]\n", "[noise]\nalpha = 0.01\n", &["unknown output `alpha`"], Some("p")),
        ("[process_noise]\n", "[process_noise]\nq = 1e-6\n", &["unknown key `q`"], None),
        ("axes = [\"lateral\"]", "axes = []", &["no axes"], None),
        ("axes = [\"lateral\"]", "axes = [\"lateral\"]\noutputs = [\"q\"]", &["`q` is no output of the lateral"], None),
        ("axes = [\"lateral\"]", "axes = [\"lateral\"]\noutputs = [\"beta\"]", &["`phi` must be measured"], None),
        ("axes = [\"lateral\"]", "axes = [\"longitudinal\"]", &["`thrust` is missing"], None),
    ] {
        assert!(LATERAL.contains(from), "the test itself is out of date: {from}");
        let error = ModelFile::parse("mine.toml", &LATERAL.replacen(from, to, 1)).unwrap_err();
        for word in message {
            assert!(error.to_string().contains(word), "{from} -> {to}: {word} is not in: {error}");
        }
        if nearest.is_some() && from != "[noise]\n" {
            assert_eq!(error.nearest.as_deref(), nearest, "{error}");
        }
    }
    // In a file of the longitudinal axes: a coefficient of the other ones, and a channel of them as an input of one's own.
    let f16 = include_str!("../../../../data/models/f16.toml");
    let side_force = f16.replacen("CL = [", "CY = [\"1\"]\nCL = [", 1);
    let error = ModelFile::parse("f16", &side_force).unwrap_err().to_string();
    assert!(error.contains("`CY` is no coefficient of the longitudinal motion") && error.contains(both), "{error}");
    let sideslip = f16.replacen("CL = [\"alpha\"]", "CL = [\"alpha\", \"beta\"]", 1);
    let error = ModelFile::parse("f16", &sideslip).unwrap_err().to_string();
    assert!(error.contains("may stand under inputs"), "{error}");
    let own = sideslip.replacen("[parameters]", "[parameters]\ndCL_beta.prior_std = 1\n", 1);
    let own = own.replacen("base =", "inputs = [\"beta\"]\nbase =", 1);
    assert!(ModelFile::parse("f16", &own).unwrap().channels_used().contains(&"beta"));
}

/// Half a minute of steady flight at 50 Hz with every channel that the lateral axes take.
fn record() -> Record {
    let time: Vec<f64> = (0..1500).map(|k| 0.02 * f64::from(k)).collect();
    let constant = |name: &str, quantity, value: f64| Channel {
        name: name.to_owned(),
        quantity,
        values: (0..1500).map(|k| value + 1e-4 * f64::from((k * 7919) % 13 - 6)).collect(),
    };
    let still = |name: &str| Channel { values: vec![0.01; 1500], ..constant(name, Quantity::Angle, 0.0) };
    let channels = vec![
        still("aileron"),
        still("rudder"),
        constant("true_airspeed", Quantity::Speed, 50.0),
        constant("alpha", Quantity::Angle, 0.05),
        constant("theta", Quantity::Angle, 0.05),
        constant("q", Quantity::AngularRate, 0.0),
        constant("ax", Quantity::Acceleration, 0.49),
        constant("az", Quantity::Acceleration, -9.79),
        constant("beta", Quantity::Angle, 0.0),
        constant("phi", Quantity::Angle, 0.0),
        constant("p", Quantity::AngularRate, 0.0),
        constant("r", Quantity::AngularRate, 0.0),
        constant("ay", Quantity::Acceleration, 0.0),
    ];
    Record { source: "steady".to_owned(), time, channels, ..Record::default() }
}

#[test]
fn a_missing_or_misspelt_channel_is_named() {
    let file = ModelFile::parse("lateral", LATERAL).unwrap();
    for (channel, instead) in [("aileron", None), ("beta", Some("betta")), ("ax", None)] {
        let mut record = record();
        match instead {
            Some(name) => record.channels.iter_mut().find(|c| c.name == channel).unwrap().name = name.to_owned(),
            None => record.channels.retain(|c| c.name != channel),
        }
        let error = estimate(&record, &file, &EstimateOptions::default(), &mut |_| {}).unwrap_err();
        let EstimateError::MissingChannel { channel: found, nearest, .. } = &error else { panic!("{error}") };
        assert_eq!(found, channel);
        if let Some(name) = instead {
            assert_eq!(nearest.as_deref(), Some(name));
        }
    }
}

#[test]
fn nothing_is_learnt_from_steady_flight_on_the_lateral_axes() {
    let file = ModelFile::parse("lateral", LATERAL).unwrap();
    let steady = estimate(&record(), &file, &EstimateOptions::default(), &mut |_| {}).unwrap();
    assert!(
        steady.verdict.iter().any(|s| s.contains("No excitation: aileron, rudder, sideslip, roll and yaw rate")),
        "{:?}",
        steady.verdict
    );
    for parameter in &steady.parameters {
        assert_eq!(
            (parameter.value, parameter.status.word()),
            (parameter.initial, "not_excited"),
            "{}",
            parameter.name
        );
    }
    assert_eq!(capacity(Axes::LateralDirectional), 48);
}
