//! Model files that are begun from a flight, against ones that were written by hand.

use phugoid_flight_data::reader::{ReadOptions, read_path};
use phugoid_flight_data::record::Record;
use phugoid_identification::draft::{AircraftClass, Answers, DraftError, DraftedAxes, check, draft, questions};
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::manoeuvres::{Settings, find};
use phugoid_identification::model_file::ModelFile;

use crate::common as shared_data;

fn record(text: &str) -> Record {
    phugoid_flight_data::csv::read(text.as_bytes(), "flight.csv", &phugoid_flight_data::csv::CsvOptions::default())
        .unwrap()
}

fn run(record: &Record, model: &str) -> Estimation {
    run_with(record, model, EstimateOptions::default())
}

fn run_with(record: &Record, model: &str, options: EstimateOptions) -> Estimation {
    estimate(record, &ModelFile::parse("model.toml", model).unwrap(), &options, &mut |_| ()).unwrap()
}

/// Both estimates of a parameter agree within the bounds of the one whose model was written by hand.
#[track_caller]
fn agree(drafted: &Estimation, by_hand: &Estimation, names: &[&str]) {
    for name in names {
        let of = |estimation: &Estimation| {
            let parameter = estimation.parameters.iter().find(|parameter| parameter.name == *name);
            parameter.map(|p| (p.value, p.corrected_std_error)).unwrap_or_else(|| panic!("no {name}"))
        };
        let ((ours, _), (theirs, sigma)) = (of(drafted), of(by_hand));
        println!("{name}: {ours:.4}, by hand {theirs:.4} +- {:.4}", 2.0 * sigma);
        assert!((ours - theirs).abs() <= 2.0 * sigma, "{name}: {ours} against {theirs} +- {}", 2.0 * sigma);
    }
}

#[test]
fn the_hfb_320_from_a_few_answers_is_the_one_written_by_hand() {
    let Some(path) = shared_data::shared_file("flight/hfb320.csv") else { return };
    let flight = read_path(&path, &ReadOptions::default()).unwrap();
    let answers = Answers {
        mass_kg: Some(7472.0),
        iyy_kg_m2: Some(91_388.0),
        wing_area_m2: Some(30.0968),
        wing_span_m: Some(14.49),
        mean_chord_m: Some(2.43),
        ..Answers::of(AircraftClass::Transport)
    };
    assert!(questions(&flight, &answers).is_empty());
    let drafted = draft(&flight, &answers).unwrap();
    println!("{}", drafted.text);
    assert!(drafted.doubts.is_empty(), "{:?}", drafted.doubts);
    assert!(drafted.text.contains("air_density = \"0.79"), "{}", drafted.text);
    let by_hand = run(&flight, ModelFile::text("hfb320").unwrap());
    agree(&run(&flight, &drafted.text), &by_hand, &["CL_alpha", "Cm_alpha", "Cm_q", "Cm_elevator", "CD_alpha"]);
}

/// Two aircraft of JSBSim, flown by it: the same estimates as from a model file of an engineer who knows more. By regression:
/// the flights are exact, and a filter that learns its noise has none to learn.
#[test]
fn aircraft_of_another_simulator_are_those_written_by_hand() {
    for (name, class) in [("c182", AircraftClass::LightSingle), ("fokker100", AircraftClass::Transport)] {
        let file = |end: &str| shared_data::shared_file(&format!("jsbsim/{name}{end}"));
        let (Some(flight), Some(data)) = (file("_small.csv.gz"), file(".json")) else { return };
        // The record of the elevator manoeuvre; the others come later in the same flight.
        let flight = read_path(&flight, &ReadOptions::default()).unwrap().between(0.0, 11.0).unwrap();
        let data: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(data).unwrap()).unwrap();
        let number = |pointer: &str| data.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap();
        let answers = Answers {
            mass_kg: Some(number("/mass_kg")),
            iyy_kg_m2: Some(number("/inertia_kg_m2/Iyy")),
            wing_area_m2: Some(number("/geometry/S_m2")),
            wing_span_m: Some(number("/geometry/b_m")),
            mean_chord_m: Some(number("/geometry/cbar_m")),
            thrust_n: Some(number("/trim/thrust_x_n")),
            ..Answers::of(class)
        };
        let drafted = draft(&flight, &answers).unwrap();
        assert!(drafted.doubts.is_empty(), "{:?}", drafted.doubts);
        let by_hand = format!(
            r#"
axes = ["longitudinal"]
input = "interpolated"
outputs = ["true_airspeed", "alpha", "theta", "q", "ax", "az"]
[aircraft]
mass = {mass}
iyy = {iyy}
wing_area = {area}
mean_chord = {chord}
thrust = {thrust}
air_density = {{ channel = "air_density" }}
[coefficients]
CL = ["1", "alpha", "q_hat", "elevator"]
CD = ["1", "alpha", "alpha^2"]
Cm = ["1", "alpha", "q_hat", "elevator"]
[parameters]
CL_0 = {{ start = 0.3, prior_std = 1 }}
CL_alpha = {{ start = 5, prior_std = 10 }}
CL_q = {{ start = 4, prior_std = 40 }}
CL_elevator = {{ start = 0.4, prior_std = 4 }}
CD_0 = {{ start = 0.03, prior_std = 0.3 }}
CD_alpha = {{ start = 0.1, prior_std = 2 }}
CD_alpha2 = {{ start = 1, prior_std = 10 }}
Cm_0 = {{ start = 0, prior_std = 0.3 }}
Cm_alpha = {{ start = -1, prior_std = 5 }}
Cm_q = {{ start = -15, prior_std = 60 }}
Cm_elevator = {{ start = -1, prior_std = 5 }}
[uncertainty]
class = "unstated"
"#,
            mass = number("/mass_kg"),
            iyy = number("/inertia_kg_m2/Iyy"),
            area = number("/geometry/S_m2"),
            chord = number("/geometry/cbar_m"),
            thrust = number("/trim/thrust_x_n"),
        );
        println!("{name}");
        let regression = |model: &str| {
            run_with(
                &flight,
                model,
                EstimateOptions { method: Some(Method::EquationError), ..EstimateOptions::default() },
            )
        };
        let (drafted, by_hand) = (regression(&drafted.text), regression(&by_hand));
        agree(&drafted, &by_hand, &["CL_alpha", "CL_elevator", "Cm_alpha", "Cm_q", "Cm_elevator"]);
    }
}

#[test]
fn what_nobody_said_is_asked_for() {
    let flight = record("time_s,tas_m_s,theta_deg,q_deg_s,elevator_deg\n0,30,1,0,0\n0.1,30,1,0,0\n0.2,30,1,0,0\n");
    let mut answers = Answers::of(AircraftClass::Drone);
    let asked: Vec<&str> = questions(&flight, &answers).iter().map(|question| question.key).collect();
    assert_eq!(asked, ["mass", "wing_area", "wing_span", "altitude"]);
    assert!(matches!(draft(&flight, &answers), Err(DraftError::Unanswered(open)) if open.len() == 4));
    answers.mass_kg = Some(2.0);
    (answers.wing_area_m2, answers.wing_span_m, answers.altitude_m) = (Some(0.45), Some(1.8), Some(100.0));
    let drafted = draft(&flight, &answers).unwrap();
    ModelFile::parse("drone.toml", &drafted.text).unwrap();
    for word in ["iyy", "mean_chord", "thrust", "alpha was not recorded", "az was not recorded"] {
        assert!(drafted.assumed.iter().any(|line| line.contains(word)), "{word}: {:?}", drafted.assumed);
    }
    assert!(drafted.text.contains("class = \"unmanned-without-vane\""), "{}", drafted.text);
    // An answer in another unit than it was meant.
    answers.mass_kg = Some(2000.0);
    let doubts = draft(&flight, &answers).unwrap().doubts;
    assert!(doubts.iter().any(|doubt| doubt.contains("is it in pounds?")), "{doubts:?}");
    assert!(doubts.iter().any(|doubt| doubt.contains("a coefficient of lift of")), "{doubts:?}");
    answers.mass_kg = Some(f64::NAN);
    assert!(matches!(draft(&flight, &answers), Err(DraftError::NotPositive { key: "mass", .. })));
    answers.mass_kg = Some(2.0);
    answers.axes = Some(DraftedAxes::Lateral);
    let error = draft(&flight, &answers).unwrap_err().to_string();
    assert!(error.contains("no phi, no p, no r") && error.contains("phi_rad"), "{error}");
}

#[test]
fn an_airspeed_that_is_not_true_becomes_one() {
    let rows: String = (0..50).map(|k| format!("{},60,1,0,0,3000\n", 0.1 * f64::from(k))).collect();
    let flight = record(&format!("time_s,IAS [kt],theta_deg,q_deg_s,elevator_deg,altitude_m\n{rows}"));
    let answers = Answers {
        mass_kg: Some(300.0),
        wing_area_m2: Some(10.0),
        wing_span_m: Some(15.0),
        ..Answers::of(AircraftClass::Glider)
    };
    let drafted = draft(&flight, &answers).unwrap();
    let model = ModelFile::parse("glider.toml", &drafted.text).unwrap();
    let file = std::env::temp_dir().join(format!("phugoid-draft-{}.csv", std::process::id()));
    std::fs::write(&file, format!("time_s,IAS [kt],theta_deg,q_deg_s,elevator_deg,altitude_m\n{rows}")).unwrap();
    let read = model.open_record(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    // 60 kt at the density of 3000 m, 0.9093 kg/m^3 (ISO 2533).
    let expected = 60.0 * 1852.0 / 3600.0 * (1.225_f64 / 0.9093).sqrt();
    assert!((read.channel("true_airspeed").unwrap().values[0] - expected).abs() < 0.05);
}

/// A flight of a drone whose elevator is known by its command alone.
fn commanded(header: &str, scale: f64) -> Record {
    let row = |k: i32| {
        let t = 0.02 * f64::from(k);
        let command = scale * if (1.0..1.5).contains(&t) { 0.5 } else { 0.01 };
        format!("{t},18,0.05,0.05,{},-9.8,100,{command}\n", 0.1 * (3.0 * t).sin())
    };
    let rows: String = (0..200).map(row).collect();
    record(&format!("time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,az_m_s2,altitude_m,{header}\n{rows}"))
}

fn drone() -> Answers {
    Answers {
        mass_kg: Some(2.1),
        wing_area_m2: Some(0.45),
        wing_span_m: Some(1.8),
        ..Answers::of(AircraftClass::Drone)
    }
}

#[test]
fn a_command_becomes_the_surface_by_its_travel() {
    let flight = commanded("elevator_command", 1.0);
    let asked: Vec<&str> = questions(&flight, &drone()).iter().map(|question| question.key).collect();
    assert_eq!(asked, ["elevator_travel"]);
    assert!(check(&flight, &drone()).is_ok());
    let answers = Answers { elevator_travel_rad: Some((-20.0_f64).to_radians()), ..drone() };
    let drafted = draft(&flight, &answers).unwrap();
    let line = "elevator = { header = \"elevator_command\", scale = -20, unit = \"deg\" }";
    assert!(drafted.text.contains(line) && drafted.text.contains("not positions"), "{}", drafted.text);
    assert!(drafted.assumed.iter().any(|line| line.contains("its command times -20 deg")), "{:?}", drafted.assumed);
    let model = ModelFile::parse("drone.toml", &drafted.text).unwrap();
    let mapping = model.columns().into_iter().find(|mapping| mapping.channel == "elevator").unwrap();
    assert_eq!((mapping.header.as_str(), mapping.scale), ("elevator_command", -20.0));
    // Degrees that are no travel, and a command that is none.
    for degrees in [0.0, 200.0, f64::NAN] {
        let answers = Answers { elevator_travel_rad: Some(f64::to_radians(degrees)), ..drone() };
        assert!(matches!(draft(&flight, &answers), Err(DraftError::Travel { surface: "elevator", .. })), "{degrees}");
    }
    let pulses = commanded("elevator_command", 1500.0);
    assert!(matches!(check(&pulses, &drone()), Err(DraftError::NoCommand { surface: "elevator", .. })));
    // Nothing is said of it by a search for manoeuvres but how the command becomes a position.
    let reasons = find(&flight, &Settings::default()).reasons;
    let told =
        reasons.iter().find(|reason| reason.contains("`elevator_command`")).unwrap_or_else(|| panic!("{reasons:?}"));
    assert!(told.contains("`phugoid init FLIGHT --elevator-travel -20deg`") && told.contains(line), "{told}");
    assert!(!told.contains("multirotor"), "{told}");
    let reasons = find(&pulses, &Settings::default()).reasons;
    assert!(reasons.iter().any(|reason| reason.contains("no control surface")), "{reasons:?}");
    // A position that was recorded comes before what was said.
    let drafted = draft(&commanded("elevator_rad", 0.1), &answers).unwrap();
    assert!(!drafted.text.contains("[channels]"), "{}", drafted.text);
    assert!(drafted.said_twice.iter().any(|line| line.contains("travel of the elevator that was said is not used")));
    // What the record lacks is no question to anybody.
    let bare = record("time_s,alpha_deg\n0,1\n0.1,1\n0.2,1\n");
    assert!(matches!(check(&bare, &drone()), Err(DraftError::Channels { .. })));
}

#[test]
fn what_is_said_and_recorded_is_told_and_wrong_units_are_refused() {
    let flight = commanded("elevator_rad", 0.1);
    let answers = Answers { altitude_m: Some(5000.0), iyy_kg_m2: Some(190.0), ..drone() };
    let drafted = draft(&flight, &answers).unwrap();
    assert!(drafted.said_twice.iter().any(|line| line.contains("altitude of 5000 m") && line.contains("not used")));
    let blamed = drafted.doubts.iter().find(|doubt| doubt.contains("izz")).unwrap();
    assert!(blamed.starts_with("iyy 190 kg m^2 does not suit what is estimated"), "{blamed}");
    // No unit: said, with what it is taken for.
    let unitless = record(
        "time_s,tas_m_s,theta_deg,q_deg_s,elevator_deg,altitude\n0,30,1,0,0,5000\n0.1,30,1,0,0,5000\n0.2,30,1,0,0,5000\n",
    );
    let drafted = draft(&unitless, &drone()).unwrap();
    assert!(
        drafted.record_doubts.iter().any(|line| line.contains("'altitude' has no unit")),
        "{:?}",
        drafted.record_doubts
    );
    // Degrees called radians: no estimate would be made of them, and so no model is begun.
    let rows: String = (0..200)
        .map(|k| {
            let t = 0.05 * f64::from(k);
            format!("{t},30,{},{},0.1,100\n", 4.0 + t.sin(), t.cos())
        })
        .collect();
    let wrong = record(&format!("time_s,tas_m_s,theta_rad,q_deg_s,elevator_rad,altitude_m\n{rows}"));
    let error = draft(&wrong, &drone()).unwrap_err();
    assert!(matches!(error, DraftError::Units { .. }) && error.to_string().contains("theta"), "{error}");
}

/// A misspelt column is named where the channel that it may be is missing, and a model of other axes is not begun in silence.
#[test]
fn a_misspelt_column_is_named() {
    let flight = |elevator: &str, aileron: bool| {
        let rows: String = (0..600)
            .map(|row| {
                let t = 0.05 * f64::from(row);
                let doublet = if (5.0..6.0).contains(&t) { 3.0 } else { f64::from((6.0..7.0).contains(&t)) * -3.0 };
                let moved = if aileron { doublet } else { 0.0 };
                let p = 4.0 * moved + 0.01 * (7.0 * t).sin();
                format!(
                    "{t},30,{},1,{},0,{p},{},0,0.1,-9.8,0,1000,{doublet},{moved}\n",
                    2.0 + (0.1 * t).sin(),
                    1.5 + 0.01 * (3.0 * t).sin(),
                    0.02 * (5.0 * t).sin()
                )
            })
            .collect();
        record(&format!(
            "time_s,tas_m_s,theta_deg,phi_deg,alpha_deg,beta_deg,p_deg_s,q_deg_s,r_deg_s,ax_m_s2,az_m_s2,ay_m_s2,altitude_m,{elevator},Querruder [°]\n{rows}"
        ))
    };
    let misspelt = flight("Höhenuder [°]", false);
    let answers = Answers { axes: Some(DraftedAxes::Longitudinal), ..drone() };
    for error in [check(&misspelt, &answers).unwrap_err(), draft(&misspelt, &answers).unwrap_err()] {
        let told = error.to_string();
        assert!(
            told.contains("no elevator") && told.contains("'Höhenuder [°]'") && told.contains("elevator_deg"),
            "{told}"
        );
    }
    // With ailerons that were moved a model of the lateral motion is begun: it says why.
    let drafted = draft(&flight("Höhenuder [°]", true), &drone()).unwrap();
    assert!(drafted.text.contains("axes = [\"lateral\"]"), "{}", drafted.text);
    assert!(drafted.assumed.iter().any(|line| line.contains("no elevator") && line.contains("lateral-directional")));
    let doubts = &drafted.record_doubts;
    assert!(doubts.iter().any(|line| line.contains("'Höhenuder [°]'") && line.contains("elevator")), "{doubts:?}");
    // An estimation that needs the channel names the column too.
    let model = draft(&flight("elevator_deg", false), &answers).unwrap().text;
    let model = ModelFile::parse("model.toml", &model).unwrap();
    let error = estimate(&misspelt, &model, &EstimateOptions::default(), &mut |_| ()).unwrap_err().to_string();
    assert!(error.contains("`elevator` is missing") && error.contains("column 'Höhenuder [°]'"), "{error}");
}
