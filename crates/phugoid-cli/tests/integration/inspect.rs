//! `phugoid inspect`, the segments it numbers, and the forms that a result is exported in.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};
use serde_json::Value;

fn flown(name: &str, test: &str) -> Folder {
    let folder = Folder::new(&format!("inspect-{test}"));
    assert_eq!(phugoid(&folder.0, &["simulate", name, "--out", "."]).code, Some(0));
    folder
}

#[test]
fn a_flight_is_told_with_its_manoeuvres_and_a_segment_is_estimated() {
    let folder = flown("f16-calm", "segments");
    let run = phugoid(&folder.0, &["inspect", "measured.csv"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for word in ["20.00 s, 100 Hz", "elevator 3-2-1-1", "9.50 s", "--segment N", "Cm_alpha_dot  no", "Built-in models"]
    {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
    let json = phugoid(&folder.0, &["inspect", "measured.csv", "--model", "f16-model", "--json"]).json();
    let told = phugoid(&folder.0, &["inspect", "measured.csv", "--model", "f16-model"]).out;
    assert!(told.contains("Parameters of f16-model that the record could support, by its Cramer-Rao bound"), "{told}");
    let support = &json["support"]["segments"];
    assert_eq!(support[2]["manoeuvres"], serde_json::json!([1, 2]), "{support}");
    assert_eq!(support[2]["parameters"][0]["support"], "told", "{support}");
    let manoeuvres = json["found"]["manoeuvres"].as_array().unwrap();
    assert_eq!(manoeuvres.len(), 2);
    assert_eq!(manoeuvres[1]["inputs"][0]["kind"], "3-2-1-1");
    assert_eq!(json["models"][0]["missing"].as_array().unwrap().len(), 0, "{}", json["models"]);
    let channel =
        |name: &str| json["channels"].as_array().unwrap().iter().find(|c| c["name"] == name).cloned().unwrap();
    assert!((channel("alpha")["noise"].as_f64().unwrap() - 0.1_f64.to_radians()).abs() < 2e-4);

    let estimate = |segment: &str, more: &[&str]| {
        let base = ["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--json", "--segment", segment];
        phugoid(&folder.0, &[&base, more].concat())
    };
    let second = estimate("2", &[]).json();
    // From 9.5 s to 16.7 s at 100 Hz.
    assert_eq!(second["samples"], 721, "{}", second["source"]);
    assert!(second["source"].as_str().unwrap().ends_with("measured.csv, manoeuvre 2"));
    let both = estimate("1,2", &["--method", "output-error"]).json();
    assert_eq!(both["batch"]["manoeuvres"].as_array().unwrap().len(), 2);
    assert!(estimate("1,2", &[]).fails(3).contains("batch method"));
    assert!(estimate("3", &[]).fails(3).contains("there are 1 (0.00 s to 6.70 s, elevator 3-2-1-1), 2"));
    assert!(estimate("2,2", &["--method", "output-error"]).fails(3).contains("twice"));
}

#[test]
fn the_coherence_of_the_elevator_is_told_and_drawn() {
    let folder = flown("f16-calm", "coherence");
    let run = phugoid(&folder.0, &["inspect", "measured.csv", "--figures", "figures"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("Coherence of inputs and outputs") && run.out.contains("2 figure files"), "{}", run.out);
    assert!(folder.read("figures/coherence-elevator.svg").contains("Pitch rate q"));
    assert!(folder.0.join("figures/coherence-elevator.png").exists());
    let json = phugoid(&folder.0, &["inspect", "measured.csv", "--json"]).json();
    let pairs = json["coherence"].as_array().unwrap();
    let of = |output: &str| pairs.iter().find(|c| c["output"] == output).unwrap();
    assert!(of("q")["ordinary"]["peak"].as_f64().unwrap() > 0.95, "{}", of("q"));
    assert!(of("q")["ordinary"]["chance"].as_f64().unwrap() < 0.01);
    assert_eq!(of("q")["given"], serde_json::json!([]));
}

#[test]
fn a_doubt_is_told_once() {
    let folder = Folder::new("inspect-doubts");
    let row = |k: i32| {
        let t = 0.05 * f64::from(k);
        format!("{t},{},{}\n", 4.0 + t.sin(), t.cos())
    };
    let rows: String = (0..300).map(row).collect();
    folder.file("flight.csv", &format!("time_s,theta_rad,q_deg_s\n{rows}"));
    let run = phugoid(&folder.0, &["inspect", "flight.csv"]);
    assert_eq!(run.out.matches("degrees read as radians").count(), 1, "{}", run.out);
    let json = phugoid(&folder.0, &["inspect", "flight.csv", "--json"]);
    assert_eq!(json.out.matches("degrees read as radians").count(), 1, "{}", json.out);
    assert!(json.json()["doubts"].to_string().contains("degrees read as radians"), "{}", json.out);
}

#[test]
fn a_flight_that_tells_nothing_says_why_and_is_no_failure() {
    let folder = Folder::new("inspect-nothing");
    let rows: String =
        (0..400).map(|k| format!("{},{},0.1\n", f64::from(k) * 0.02, (f64::from(k) * 0.1).sin())).collect();
    folder.file("copter.csv", &format!("time_s,q_rad_s,theta_rad\n{rows}"));
    let run = phugoid(&folder.0, &["inspect", "copter.csv"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("no control surface") && run.out.contains("no airspeed was recorded"), "{}", run.out);
    assert!(run.out.contains("lacks"), "{}", run.out);
}

const MODEL: &str = r#"
name = "F-16, whole coefficients"
axes = ["longitudinal"]
[aircraft]
mass = "637.2396642834939 slug"
iyy = "55814 slug*ft^2"
wing_area = "300 ft^2"
mean_chord = "11.32 ft"
thrust = { channel = "thrust" }
air_density = "book_atmosphere"
gravity = "32.17 ft/s^2"
[coefficients]
CL = ["1", "alpha", "q_hat", "elevator"]
CD = ["1", "alpha", "alpha^2"]
Cm = ["1", "alpha", "q_hat", "elevator"]
[parameters]
CL_0 = { start = 0.0, prior_std = 10.0 }
CL_alpha = { start = 0.0, prior_std = 10.0 }
CL_q = { start = 0.0, prior_std = 100.0 }
CL_elevator = { start = 0.0, prior_std = 10.0 }
CD_0 = { start = 0.0, prior_std = 10.0 }
CD_alpha = { start = 0.0, prior_std = 10.0 }
CD_alpha2 = { start = 0.0, prior_std = 10.0 }
Cm_0 = { start = 0.0, prior_std = 10.0 }
Cm_alpha = { start = 0.0, prior_std = 10.0 }
Cm_q = { start = 0.0, prior_std = 100.0 }
Cm_elevator = { start = 0.0, prior_std = 10.0 }
"#;

#[test]
fn a_result_is_exported_in_every_form() {
    let folder = flown("f16-calm", "exports");
    folder.file("jet.toml", MODEL);
    let truth = "truth.csv";
    let run = phugoid(
        &folder.0,
        &[
            "estimate",
            truth,
            "--model",
            "jet.toml",
            "--method",
            "equation-error",
            "--no-report",
            "--export",
            "jsbsim=aero.xml",
            "--export",
            "gazebo=plugin.sdf",
            "--export",
            "csv=estimates.csv",
            "--export",
            "json=result.json",
        ],
    );
    assert_eq!(run.code, Some(0), "{}{}", run.out, run.err);
    assert!(run.out.contains("Written: aero.xml") && run.out.contains("AERORP"), "{}", run.out);
    let result: Value = serde_json::from_str(&folder.read("result.json")).unwrap();
    let parameters = result["parameters"].as_array().unwrap();
    let value = |name: &str| parameters.iter().find(|p| p["name"] == name).unwrap()["value"].as_f64().unwrap();
    // The same numbers, to the last digit, in every file.
    let (slope, damping) = (value("CL_alpha"), value("Cm_q"));
    assert!(slope > 2.0 && damping < -1.0, "{slope} {damping}");
    assert!(folder.read("aero.xml").contains(&format!("<value>{slope}</value>")));
    assert!(folder.read("plugin.sdf").contains(&format!("<Cemq>{damping}</Cemq>")));
    let table = folder.read("estimates.csv");
    assert!(table.lines().any(|l| l.starts_with(&format!("CL_alpha,{slope},"))), "{table}");
    assert_eq!(table.lines().count(), parameters.len() + 1);
    // Increments are refused before anything is estimated.
    let refused = phugoid(
        &folder.0,
        &["estimate", "measured.csv", "--model", "f16-model", "--export", "jsbsim=no.xml", "--no-report"],
    );
    assert!(refused.fails(3).contains("increments to a database"));
    assert!(!folder.0.join("no.xml").exists());
    let unknown = phugoid(&folder.0, &["estimate", "measured.csv", "--model", "f16-model", "--export", "xml=a"]);
    assert!(unknown.fails(2).contains("is no form"));
}

#[cfg(feature = "parquet")]
#[test]
fn estimates_and_their_history_are_read_back_from_parquet() {
    use phugoid_flight_data::parquet;
    use phugoid_flight_data::reader::{ReadOptions, read_path};
    use phugoid_flight_data::table::TableOptions;
    let folder = flown("f16-calm", "parquet");
    let base = ["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--json"];
    let more = ["--export", "parquet=estimates.parquet", "--history", "history.parquet"];
    let result = phugoid(&folder.0, &[&base[..], &more].concat()).json();
    assert_eq!(phugoid(&folder.0, &[&base[..], &["--history", "history.csv"]].concat()).code, Some(0));
    // One row per parameter; names and statuses are text, which is no signal and is named as left out.
    let options = TableOptions { sample_time_s: Some(1.0), ..TableOptions::default() };
    let table = parquet::read_path(&folder.0.join("estimates.parquet"), &options).unwrap();
    let parameters = result["parameters"].as_array().unwrap();
    for (column, key) in [("value", "value"), ("corrected_std_error", "corrected_std_error"), ("lower", "lower")] {
        let values = &table.channel(column).unwrap().values;
        assert_eq!(values.len(), parameters.len());
        for (value, parameter) in values.iter().zip(parameters) {
            assert_eq!(Some(*value), parameter[key].as_f64(), "{column}");
        }
    }
    assert!(table.quality.to_string().contains("column 'name': left out: it is text"), "{}", table.quality);
    // The same history, to the last bit, as from CSV.
    let history = |name: &str| read_path(&folder.0.join(name), &ReadOptions::default()).unwrap();
    let (ours, text) = (history("history.parquet"), history("history.csv"));
    assert_eq!(ours.time, text.time);
    assert_eq!(ours.channels.len(), text.channels.len());
    for (a, b) in ours.channels.iter().zip(&text.channels) {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<u64>>();
        assert_eq!((&a.name, bits(&a.values)), (&b.name, bits(&b.values)));
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn a_build_without_parquet_says_how_to_get_it_before_it_estimates() {
    let folder = flown("f16-calm", "no-parquet");
    let base = ["estimate", "measured.csv", "--model", "f16-model", "--no-report"];
    for more in [["--export", "parquet=estimates.parquet"], ["--history", "history.parquet"]] {
        let run = phugoid(&folder.0, &[&base[..], &more].concat());
        let told = run.fails(3);
        assert!(told.contains("this build does not write Parquet") && told.contains("--features parquet"), "{told}");
        assert!(told.contains(more[0]), "{told}");
    }
}

#[cfg(not(feature = "excel"))]
#[test]
fn a_build_without_excel_says_how_to_get_it_before_it_estimates() {
    let folder = flown("f16-calm", "no-excel");
    let run = phugoid(
        &folder.0,
        &["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--export", "xlsx=result.xlsx"],
    );
    let told = run.fails(3);
    assert!(told.contains("does not write workbooks of Excel") && told.contains("--features excel"), "{told}");
    assert!(!folder.0.join("result.xlsx").exists());
}

#[cfg(feature = "excel")]
#[test]
fn a_result_is_a_workbook_that_is_read_back() {
    use phugoid_flight_data::excel;
    use phugoid_flight_data::table::TableOptions;
    let folder = flown("f16-calm", "excel");
    let run =
        ["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--json", "--export", "xlsx=result.xlsx"];
    let result = phugoid(&folder.0, &run).json();
    let options =
        TableOptions { sample_time_s: Some(1.0), variable: Some("Parameters".to_owned()), ..TableOptions::default() };
    let table = excel::read_path(&folder.0.join("result.xlsx"), &options).unwrap();
    let parameters = result["parameters"].as_array().unwrap();
    for column in ["value", "corrected_std_error", "lower"] {
        let values = &table.channel(column).unwrap().values;
        assert_eq!(values.len(), parameters.len());
        for (value, parameter) in values.iter().zip(parameters) {
            assert_eq!(Some(*value), parameter[column].as_f64(), "{column}");
        }
    }
}
