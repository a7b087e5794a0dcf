//! Model files: what they give, and how wrong ones are refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use phugoid_identification::method::Method;
use phugoid_identification::model_file::{Base, EstimatorTuning, ModelFile, ReferenceValue, Role, Source, Thrust};
use phugoid_identification::output::Output;
use proptest::prelude::*;

const HFB320: &str = include_str!("../../../../data/models/hfb320.toml");
const F16: &str = include_str!("../../../../data/models/f16.toml");

#[test]
fn built_in_models_are_what_their_sources_say() {
    let hfb = ModelFile::named("hfb320").unwrap();
    let names: Vec<&str> = hfb.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(
        names,
        ["CD_0", "CD_V", "CD_alpha", "CL_0", "CL_V", "CL_alpha", "Cm_0", "Cm_V", "Cm_alpha", "Cm_q", "Cm_elevator"]
    );
    assert_eq!(hfb.aircraft.mass, Source::Constant(7472.0));
    assert_eq!(hfb.aircraft.thrust, Thrust::Known(Source::Channel("thrust".to_owned())));
    assert_eq!(hfb.measured().count(), 7);
    // The published variances.
    let variance = hfb.noise[Output::Alpha.index()].unwrap().powi(2);
    assert!((variance / 9.9020743e-07 - 1.0).abs() < 1e-6);

    let f16 = ModelFile::named("f16").unwrap();
    assert_eq!(f16.base, Base::F16);
    let names: Vec<&str> = f16.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names[..5], ["dCL_alpha", "dCD_alpha", "dCm_alpha", "dCm_q", "dCm_elevator"]);
    assert_eq!(names[5..], ["bias_true_airspeed", "bias_alpha", "bias_theta", "bias_q", "bias_ax", "bias_az"]);
    assert_eq!(f16.parameters[3].bounds, Some([-6.0, 6.0]));
    assert_eq!(f16.parameters[3].prior_std, 3.0);
    assert!(!f16.outputs[Output::PitchAcceleration.index()]);
    assert_eq!(f16.reference.alpha, ReferenceValue::Trim);
    assert!(ModelFile::named("f18").is_err());
}

/// A file, what to replace in it and by what, what the message must say, and the nearest word where there is one.
type Case = (&'static str, &'static str, &'static str, &'static [&'static str], Option<&'static str>);

#[test]
fn a_wrong_file_is_refused_at_its_line_with_the_nearest_word() {
    let cases: &[Case] = &[
        // file, from, to, message, nearest
        (
            HFB320,
            "CL_alpha = {",
            "CL_aplha = {",
            &["unknown parameter `CL_aplha`", "did you mean `CL_alpha`"],
            Some("CL_alpha"),
        ),
        (
            HFB320,
            "wing_area =",
            "wing_aera =",
            &["unknown key `wing_aera`", "[aircraft]", "`wing_area`"],
            Some("wing_area"),
        ),
        (HFB320, "[coefficients]", "[coeficients]", &["`coefficients`"], Some("coefficients")),
        (HFB320, "\"q_hat\", ", "\"q_hta\", ", &["unknown variable `q_hta`", "`q_hat`"], None),
        (HFB320, "CD = [", "Cd = [", &["unknown coefficient `Cd`"], Some("CD")),
        (HFB320, "\"2.43 m\"", "\"2.43 kg\"", &["`kg`", "expected m"], None),
        (HFB320, "\"2.43 m\"", "\"2.43 mtr\"", &["unknown unit `mtr`"], None),
        (HFB320, "\"2.43 m\"", "-2.43", &["more than zero"], None),
        (HFB320, "\"2.43 m\"", "true", &["boolean", "expected a number in m"], None),
        (HFB320, "\"longitudinal\"", "\"latteral\"", &["did you mean `lateral`"], Some("lateral")),
        (HFB320, "\"longitudinal\"", "\"longitudnal\"", &["did you mean `longitudinal`"], Some("longitudinal")),
        (HFB320, "\"qdot\"]", "\"qdott\"]", &["unknown word `qdott`", "`qdot`"], Some("qdot")),
        (HFB320, "\"true_airspeed\", ", "", &["`true_airspeed` must be measured"], None),
        (
            HFB320,
            "channel = \"thrust\"",
            "chanel = \"thrust\"",
            &["unknown key `chanel`", "`channel`"],
            Some("channel"),
        ),
        (HFB320, "start = 5.37576, ", "", &["`start` is missing"], None),
        (HFB320, "prior_std = 53.7576", "prior_std = -1", &["more than zero"], None),
        (HFB320, "reference_speed = \"104.67 m/s\"", "", &["`reference_speed` is missing", "v_hat"], None),
        (HFB320, "iyy = \"91388 kg*m^2\"", "", &["`iyy` is missing"], None),
        (F16, "[-6, 6]", "[6, -6]", &["the lower one must come first"], None),
        (F16, "base = \"f16\"", "base = \"f-16\"", &["unknown word `f-16`", "`f16`"], Some("f16")),
        (F16, "cg = 0.30", "", &["`cg` is missing"], None),
        (F16, "altitude = \"20000 ft\"", "", &["`altitude` is missing"], None),
        (F16, "\"book_atmosphere\"", "\"book_atmosfere\"", &["`book_atmosphere`"], Some("book_atmosphere")),
        (F16, "Cm = [\"alpha\",", "Cm = [\"alpha\", \"alpha\",", &["there twice"], None),
        (F16, "name = \"F-16\"", "name = \"F-16", &["not valid TOML"], None),
    ];
    for (file, from, to, message, nearest) in cases {
        assert!(file.contains(from), "the test itself is out of date: {from}");
        let text = file.replacen(from, to, 1);
        let error = ModelFile::parse("mine.toml", &text).unwrap_err();
        let said = error.to_string();
        for word in *message {
            assert!(said.contains(word), "{from} -> {to}: {word} is not in: {said}");
        }
        assert!(said.starts_with(&format!("mine.toml:{}:{}: ", error.line, error.column)), "{said}");
        assert_eq!(error.nearest.as_deref(), *nearest, "{said}");
        // Where something was replaced, the line is the one with the replacement.
        if !to.is_empty() && *from != "name = \"F-16\"" {
            let line = 1 + file[..file.find(from).unwrap()].matches('\n').count();
            let same = error.line == line;
            let same_block = matches!(*from, "[coefficients]" | "\"true_airspeed\", ");
            assert!(same || same_block, "expected line {line}: {said}");
        }
    }
}

#[test]
fn everything_that_can_be_said_is_understood() {
    let text = r#"
name = "Mine"
axes = ["longitudinal"]
rate_speed = "actual"
inputs = ["flap"]
outputs = ["true_airspeed", "alpha", "theta", "q", "az"]
change_detection = false

[aircraft]
mass = { channel = "mass" }
iyy = 1e4
wing_area = 20
mean_chord = "5 ft"
thrust = 0
air_density = "standard_atmosphere"
reference_speed = "120 kt"
gravity = "1 g"

[channels]
alpha = "AOA vane"
elevator = { header = "DE", unit = "deg", scale = -1 }
flap = "FLAP"

[coefficients]
CL = ["1", "alpha", "alpha*flap"]
Cm = ["alpha", "q_hat", "elevator", "alpha^2"]
offsets = true

[reference]
alpha = "first_sample"
elevator = "-2 deg"

[parameters]
CL_0 = { start = 0.3, prior_std = 0.1 }
CL_alpha = { start = 5, bounds = [2, 8], change_std = 0.7 }
CL_alpha_flap = { start = 0, prior_std = 1 }
Cm_alpha = { start = -1, fixed = true }
Cm_q = { start = -10, prior_std = 5 }
Cm_elevator = { start = -1, prior_std = 0.5 }
Cm_alpha2 = { start = 0, prior_std = 1 }
offset_Cm = { prior_std = 0.02 }

[noise]
alpha = "0.1 deg"
az = "measured"

[process_noise]
true_airspeed = "10 ft^2/s^3"
alpha = 1e-5
adaptive = true

[estimator]
reaching_limit = 4
rejection_scale = 1.5
prior_scale = 2
process_noise_scale = 0.1
adaptation_gain = 0.02
start_window = "100 ms"

[biases]
alpha = "0.3 deg"
az = "0.02 g"
"#;
    let model = ModelFile::parse("mine", text).unwrap();
    let names: Vec<&str> = model.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "CL_0",
            "CL_alpha",
            "CL_alpha_flap",
            "Cm_alpha",
            "Cm_q",
            "Cm_elevator",
            "Cm_alpha2",
            "offset_CD",
            "offset_Cm",
            "bias_alpha",
            "bias_az"
        ]
    );
    assert_eq!(model.estimated().count(), 10);
    assert_eq!(model.parameters[1].prior_std, 1.5); // a quarter of the width of the bounds
    assert_eq!(model.parameters[7].prior_std, 0.01);
    assert_eq!(model.parameters[8].prior_std, 0.02);
    assert!(matches!(model.parameters[9].role, Role::Bias(Output::Alpha)));
    assert!((model.parameters[10].prior_std - 0.02 * 9.80665).abs() < 1e-12);
    assert_eq!(model.noise[Output::Az.index()], None);
    assert!((model.noise[Output::Alpha.index()].unwrap() - 0.1_f64.to_radians()).abs() < 1e-15);
    assert_eq!(model.channels["elevator"].scale, -1.0);
    assert_eq!(model.channels["elevator"].unit.as_deref(), Some("deg"));
    assert_eq!(model.channels["alpha"].header, "AOA vane");
    assert_eq!(model.reference.alpha, ReferenceValue::FirstSample);
    assert!((model.process_noise.density[0] - 10.0 * 0.3048 * 0.3048).abs() < 1e-12);
    assert!(model.process_noise.adaptive && !model.change_detection);
    assert!((model.aircraft.gravity - 9.80665).abs() < 1e-12);
    let own = EstimatorTuning {
        method: Method::Smpe,
        reaching_limit: Some(4.0),
        rejection_scale: 1.5,
        prior_scale: 2.0,
        process_noise_scale: 0.1,
        adaptation_gain: Some(0.02),
        start_window_s: Some(0.1),
    };
    assert_eq!(model.estimator, own);
    assert_eq!(ModelFile::parse("f16", F16).unwrap().estimator, EstimatorTuning::default());
}

#[test]
fn settings_of_the_estimator_that_cannot_be_are_refused() {
    for (wrong, message) in [
        ("method = \"kalmann\"", "unknown method `kalmann`"),
        ("rejection_scale = 0", "more than zero"),
        ("prior_scale = 0", "more than zero"),
        ("process_noise_scale = -1", "zero or more"),
        ("start_window = \"0.2 m\"", "expected s"),
        ("kappa = 3", "unknown key `kappa`"),
    ] {
        let text = format!("{F16}\n[estimator]\n{wrong}\n");
        let error = ModelFile::parse("mine.toml", &text).unwrap_err();
        assert!(error.to_string().contains(message), "{wrong}: {error}");
        assert_eq!(error.line, text.lines().count(), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any text gives a model or an error with a line inside the file, and never a panic.
    #[test]
    fn damaged_files_never_panic(file in prop::sample::select(vec![HFB320, F16]), at in 0..4000_usize, length in 0..40_usize, filling in "[ -~\n]{0,12}|[\\PC]{0,4}") {
        let mut bytes = file.as_bytes().to_vec();
        let at = at.min(bytes.len());
        let end = (at + length).min(bytes.len());
        bytes.splice(at..end, filling.bytes());
        let text = String::from_utf8_lossy(&bytes);
        if let Err(error) = ModelFile::parse("damaged", &text) {
            prop_assert!(error.line >= 1 && error.column >= 1);
            prop_assert!(error.line <= text.lines().count() + 1, "{error}");
        }
    }
}

/// What the documentation prints is read as it stands.
#[test]
fn the_documented_examples_are_true() {
    let page = include_str!("../../../../docs/model-file.md");
    let whole = page.split("```toml\n").last().unwrap().split("```").next().unwrap();
    let model = ModelFile::parse("glider.toml", whole).unwrap();
    assert_eq!(model.estimated().count(), 9);
    let misspelt = HFB320.replacen("CL_alpha = {", "CL_aplha = {", 1);
    let error = ModelFile::parse("mine.toml", &misspelt).unwrap_err().to_string();
    assert!(page.contains(&error), "docs/model-file.md should print:\n{error}");
    for unit in ["m", "km", "cm", "mm", "ft", "in", "nmi"] {
        let text = whole.replace("\"0.75 m\"", &format!("\"0.75 {unit}\""));
        assert!(ModelFile::parse("glider.toml", &text).is_ok(), "{unit}");
    }
}

#[test]
fn the_former_name_of_change_detection_is_read_with_a_note() {
    let text = ModelFile::BUILT_IN[3].1;
    let now = ModelFile::parse("hfb320.toml", &format!("change_detection = false\n{text}")).unwrap();
    assert!(!now.change_detection && now.notes.is_empty());
    let former = ModelFile::parse("hfb320.toml", &format!("re_reaching = false\n{text}")).unwrap();
    assert!(!former.change_detection);
    assert!(former.notes[0].contains("`change_detection`"), "{:?}", former.notes);
    let both = format!("re_reaching = false\nchange_detection = true\n{text}");
    assert!(ModelFile::parse("hfb320.toml", &both).unwrap_err().to_string().contains("former name"));
}
