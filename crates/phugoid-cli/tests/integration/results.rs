//! What the commands give: numbers, JSON documents, files.

use crate::common;

use common::{Folder, phugoid, shared_file};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    assert!(value.is_number(), "{value} is not a number");
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
fn the_main_job_estimates_and_writes_a_report() {
    let folder = Folder::new("main");
    let run = phugoid(&folder.0, &[]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.is_empty(), "quiet in a pipe: {}", run.err);
    for word in ["dCm_alpha", "dCm_q", "dCL_alpha", "dCD_alpha", "+- 2 sigma", "truth", "converged at", "report.html"] {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
    let page = folder.read("phugoid-report/report.html");
    assert!(page.contains("<svg") && page.contains("dCm_alpha"));
    for outside in ["src=\"http", "href=\"http", "@import", "<script src"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn the_main_job_as_json_has_bounds_that_hold() {
    let folder = Folder::new("main-json");
    let document = phugoid(&folder.0, &["--json", "--seed", "3", "--out", "r", "--figures", "f"]).json();
    let parameters = document["parameters"].as_array().unwrap();
    let names: Vec<&str> = parameters.iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["dCm_alpha", "dCm_q", "dCL_alpha", "dCD_alpha"]);
    for (p, truth) in parameters.iter().zip([-0.2, -2.0, 0.4, 0.1]) {
        assert_eq!(number(&p["truth"]), truth);
        let (value, sigma) = (number(&p["value"]), number(&p["corrected_std_error"]));
        assert!(sigma >= number(&p["std_error"]) && sigma > 0.0);
        // One fixed seed; a right estimator is outside four sigmas in 1 of 16,000 cases.
        assert!((value - truth).abs() < 4.0 * sigma, "{p}");
        assert!((number(&p["lower"]) - (value - 2.0 * sigma)).abs() < 1e-12);
        assert!((number(&p["upper"]) - (value + 2.0 * sigma)).abs() < 1e-12);
        assert_eq!(p["status"], "converged");
        assert!((0.5..10.0).contains(&number(&p["converged_at_s"])), "{p}");
    }
    assert_eq!(document["samples"], 2001);
    assert_eq!(document["report"], "r/report.html");
    let figures = document["figures"].as_array().unwrap();
    assert!(figures.len() >= 6 && figures.iter().all(|f| folder.0.join(f.as_str().unwrap()).is_file()));
    // The same seed gives the same document, another one another.
    let again = phugoid(&folder.0, &["--json", "--seed", "3", "--out", "r", "--figures", "f"]).json();
    assert_eq!(document, again);
    assert_ne!(document, phugoid(&folder.0, &["--json", "--seed", "4", "--out", "r", "--figures", "f"]).json());
}

/// Thesis trim at 20,000 ft, 675 ft/s, cg 0.30: alpha 2.38934 deg, elevator -1.96254 deg, thrust 2227.74 lbf.
#[test]
fn trim_gives_the_published_numbers_in_si() {
    let folder = Folder::new("trim");
    let command =
        ["trim", "--aircraft", "f16", "--altitude", "20000ft", "--speed", "675ft/s", "--cg", "0.30", "--json"];
    let trim = phugoid(&folder.0, &command).json();
    assert!((number(&trim["alpha_rad"]).to_degrees() - 2.38934).abs() < 5e-6);
    assert!((number(&trim["elevator_rad"]).to_degrees() + 1.96254).abs() < 5e-6);
    assert!((number(&trim["thrust_n"]) / 4.448_221_615_26 - 2227.74).abs() < 5e-3);
    assert!(number(&trim["trim_index"]) < 1e-20);
    assert_eq!(trim["aircraft"], "f16");
    // The same in other units, and the document in a file.
    let other =
        ["trim", "--altitude", "6.096km", "--speed", "740.664km/h", "--cg", "0.30", "--json", "--out", "t.json"];
    let same = phugoid(&folder.0, &other);
    assert!((number(&same.json()["alpha_rad"]) - number(&trim["alpha_rad"])).abs() < 1e-9);
    assert_eq!(folder.read("t.json"), same.out);
    // Text for people has degrees.
    let text = phugoid(&folder.0, &command[..command.len() - 1]).out;
    assert!(text.contains("2.38934") && text.contains("-1.96254") && !text.contains('{'), "{text}");
}

#[test]
fn a_turn_and_a_climb_can_be_trimmed() {
    let folder = Folder::new("turn");
    let turn = ["trim", "--altitude", "0ft", "--speed", "502ft/s", "--cg", "0.30", "--turn-rate", "0.3rad/s", "--json"];
    let turn = phugoid(&folder.0, &turn).json();
    // Stevens & Lewis table 3.6-3: bank angle 1.367 rad, angle of attack 0.2485 rad.
    assert!((number(&turn["phi_rad"]) - 1.367).abs() < 2e-3, "{turn}");
    assert!((number(&turn["alpha_rad"]) - 0.2485).abs() < 5e-4, "{turn}");
    let climb = ["trim", "--altitude", "3000m", "--speed", "180m/s", "--flight-path", "-3deg", "--json"];
    let climb = phugoid(&folder.0, &climb).json();
    let path = number(&climb["theta_rad"]) - number(&climb["alpha_rad"]);
    assert!((path.to_degrees() + 3.0).abs() < 1e-6, "{climb}");
}

#[test]
fn linearize_names_matrices_and_modes() {
    let folder = Folder::new("linearize");
    let command = ["linearize", "--altitude", "20000ft", "--speed", "675ft/s", "--cg", "0.30", "--json"];
    let model = phugoid(&folder.0, &command).json();
    let (states, inputs) = (model["states"].as_array().unwrap().len(), model["inputs"].as_array().unwrap().len());
    assert_eq!(model["A"].as_array().unwrap().len(), states);
    assert!(model["A"].as_array().unwrap().iter().all(|row| row.as_array().unwrap().len() == states));
    assert!(model["B"].as_array().unwrap().iter().all(|row| row.as_array().unwrap().len() == inputs));
    let modes = model["modes"].as_array().unwrap();
    let mode = |name: &str| modes.iter().find(|m| m["name"] == name).unwrap_or_else(|| panic!("no {name}"));
    // Short period of 2 pi / 1.507 = 4.17 s.
    assert!((number(&mode("short_period")["period_s"]) - 4.17).abs() < 0.005);
    assert!(number(&mode("phugoid")["damping_ratio"]) > 0.0);
    assert!(number(&mode("short_period")["time_to_half_s"]) > 0.0);
    for name in ["dutch_roll", "roll", "spiral"] {
        mode(name);
    }
}

#[test]
fn a_simulated_flight_can_be_estimated() {
    let folder = Folder::new("simulate");
    let flown =
        phugoid(&folder.0, &["simulate", "f16-damage", "--out", "flight", "--figures", "figures", "--json"]).json();
    assert_eq!(flown["samples"], 2001);
    assert_eq!(number(&flown["true_parameters"]["dCm_elevator"]), 0.15);
    // Inputs, longitudinal and lateral motion, each as SVG and PNG.
    assert_eq!(flown["figures"].as_array().unwrap().len(), 6);
    let header = folder.read("flight/measured.csv").lines().next().unwrap().to_owned();
    assert!(
        header.starts_with("time_s,") && header.contains("alpha_rad") && header.contains("elevator_rad"),
        "{header}"
    );
    assert!(folder.read("flight/truth.csv").lines().count() == 2002);
    // The damage at 10 s is found, and the coefficients after it; without change detection it is not.
    let estimate = ["estimate", "flight/measured.csv", "--model", "f16-damage-model", "--json", "--no-report"];
    let found = phugoid(&folder.0, &estimate).json();
    let event = found["events"].as_array().unwrap().iter().find(|e| e["kind"] == "adopted").unwrap().clone();
    assert!((10.0..11.0).contains(&number(&event["time_s"])), "{event}");
    assert_eq!(found["report"], Value::Null);
    for p in found["parameters"].as_array().unwrap() {
        let truth = number(&flown["true_parameters"][p["name"].as_str().unwrap()]);
        let error = (number(&p["value"]) - truth).abs();
        assert!(error < 4.0 * number(&p["corrected_std_error"]), "{p}");
    }
    // Without change detection the numbers are those of no time, and refused.
    let without = phugoid(&folder.0, &[&estimate[..], &["--no-change-detection"]].concat()).json_of_any_result();
    assert!(without["events"].as_array().unwrap().iter().all(|e| e["kind"] != "adopted"));
}

#[test]
fn a_flight_beyond_the_aerodynamic_tables_says_so() {
    let folder = Folder::new("beyond");
    let calm = phugoid(&folder.0, &["simulate", "f16-calm", "--json"]).json();
    assert_eq!(calm["warnings"].as_array().unwrap().len(), 0);
    let scenario = phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out.replace("cg = 0.30", "cg = 0.60");
    folder.file("aft.toml", &scenario);
    let aft = phugoid(&folder.0, &["simulate", "aft.toml"]);
    assert!(aft.out.contains("Warning: alpha leaves the aerodynamic tables (-10 to 45 deg)"), "{}", aft.out);
    // Nor is a manoeuvre that is not flown.
    folder.file("late.toml", &phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out.replace("10.5 s", "500 s"));
    let late = phugoid(&folder.0, &["simulate", "late.toml", "--out", "late"]);
    assert!(
        late.out.contains("Warning: `[[manoeuvre]]` number 2 (3-2-1-1 of the elevator) moves nothing"),
        "{}",
        late.out
    );
}

#[test]
fn a_simulated_flight_is_shown_beside_its_truth() {
    let folder = Folder::new("truth");
    phugoid(&folder.0, &["simulate", "f16-gust-actuators", "--out", "."]);
    let command = ["estimate", "measured.csv", "--model", "f16-gust-model", "--no-report"];
    let plain = phugoid(&folder.0, &command).out;
    assert!(!plain.contains("truth"), "{plain}");
    let with_scenario = [&command[..], &["--truth", "f16-gust-actuators"]].concat();
    let text = phugoid(&folder.0, &with_scenario).out;
    assert!(text.contains("truth") && text.contains("error/sigma"), "{text}");
    let document = phugoid(&folder.0, &[&with_scenario[..], &["--json", "--truth", "dCm_q=-2.5"]].concat()).json();
    let truth = |name: &str| {
        let all = document["parameters"].as_array().unwrap();
        number(&all.iter().find(|p| p["name"] == name).unwrap()["truth"])
    };
    // The scenario's increments and sensor errors; a value by itself wins over it.
    assert_eq!((truth("dCm_alpha"), truth("dCL_alpha"), truth("dCm_q")), (-0.2, 0.4, -2.5));
    assert!((truth("bias_alpha").to_degrees() - 0.2).abs() < 1e-12 && (truth("bias_az") - 0.0980665).abs() < 1e-12);
    // The truth changes nothing but the comparison.
    let blind = phugoid(&folder.0, &[&command[..], &["--json"]].concat()).json();
    for (a, b) in document["parameters"].as_array().unwrap().iter().zip(blind["parameters"].as_array().unwrap()) {
        assert_eq!((&a["value"], &a["std_error"], &b["truth"]), (&b["value"], &b["std_error"], &Value::Null));
    }
    let with = |truth: &str| phugoid(&folder.0, &[&command[..], &["--truth", truth]].concat());
    assert!(with("dCm_alfa=1").fails(3).contains("did you mean `dCm_alpha`"));
    assert!(with("dCm_q=two").fails(2).contains("no number"));
    assert!(with("f16-gust-actuator").fails(3).contains("`f16-gust-actuators`"));
}

/// A column of another name, unit and sign, mapped in the model file.
#[test]
fn a_mapped_column_is_scaled() {
    let folder = Folder::new("scale");
    phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]);
    let text = folder.read("measured.csv");
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let column = header.split(',').position(|h| h == "elevator_rad").unwrap();
    let mut turned = header.replace("elevator_rad", "DE");
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[column] = (-cells[column].parse::<f64>().unwrap().to_degrees()).to_string();
        turned.push_str(&format!("\n{}", cells.join(",")));
    }
    folder.file("turned.csv", &turned);
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    let mapping = "[channels]\nelevator = { header = \"DE\", unit = \"deg\", scale = -1 }\n";
    folder.file("mapped.toml", &format!("{model}\n{mapping}"));
    let estimate = |flight: &str, model: &str| {
        phugoid(&folder.0, &["estimate", flight, "--model", model, "--json", "--no-report"]).json()
    };
    let (plain, mapped) = (estimate("measured.csv", "f16-model"), estimate("turned.csv", "mapped.toml"));
    for (a, b) in plain["parameters"].as_array().unwrap().iter().zip(mapped["parameters"].as_array().unwrap()) {
        // Degrees and back cost a rounding of the elevator.
        assert!((number(&a["value"]) - number(&b["value"])).abs() < 1e-6 * number(&a["std_error"]), "{a} {b}");
    }
    let findings = mapped["quality"]["findings"].as_array().unwrap();
    assert!(findings.iter().any(|f| f["message"].as_str().unwrap().contains("multiplied by -1")), "{findings:?}");
}

#[test]
fn a_part_of_a_record_can_be_chosen() {
    let folder = Folder::new("part");
    phugoid(&folder.0, &["simulate", "f16-calm", "--out", "flight"]);
    let part = |more: &[&str]| {
        let all = ["estimate", "flight/measured.csv", "--model", "f16-model", "--json", "--no-report"];
        phugoid(&folder.0, &[&all, more].concat())
    };
    assert_eq!(part(&["--from", "2s", "--to", "8 s"]).json()["samples"], 601);
    let history = part(&["--history"]).json()["history"].clone();
    assert_eq!(history["time_s"].as_array().unwrap().len(), 2001);
    part(&["--from", "100s"]).fails(3);
    // The time of convergence is one of the whole record: it cannot lie before the part.
    let late = part(&["--from", "2s"]).json();
    let times: Vec<f64> =
        late["parameters"].as_array().unwrap().iter().filter_map(|p| p["converged_at_s"].as_f64()).collect();
    assert!(!times.is_empty() && times.iter().all(|t| *t >= 2.0), "{times:?}");
}

#[test]
fn histories_are_written_as_csv() {
    let folder = Folder::new("history");
    phugoid(&folder.0, &["simulate", "f16-calm", "--out", "flight"]);
    let estimate = |more: &[&str]| {
        let all = ["estimate", "flight/measured.csv", "--model", "f16-model", "--no-report"];
        phugoid(&folder.0, &[&all, more].concat())
    };
    let document = estimate(&["--json", "--history", "history.csv"]).json();
    assert!(document["history"].is_null());
    let text = folder.read("history.csv");
    let mut lines = text.lines();
    let headers: Vec<&str> = lines.next().unwrap().split(',').collect();
    for header in ["time_s", "elevator_rad", "alpha_rad", "alpha_predicted_rad", "alpha_residual", "dCm_q", "dCm_q_std"]
    {
        assert!(headers.contains(&header), "{header} is not in {headers:?}");
    }
    assert_eq!(lines.clone().count(), 2001);
    // The last row is the result.
    let column = headers.iter().position(|h| *h == "dCm_q").unwrap();
    let last: f64 = lines.last().unwrap().split(',').nth(column).unwrap().parse().unwrap();
    let parameters = document["parameters"].as_array().unwrap();
    assert_eq!(last, number(&parameters.iter().find(|p| p["name"] == "dCm_q").unwrap()["value"]));
    estimate(&["--history"]).fails(3);
    estimate(&["--history", "flight/measured.csv"]).fails(3);
}

/// The first real flight: see the flight's reference answers for how close the estimates have to be; here only that the
/// command works on it end to end.
#[test]
fn the_hfb320_flight_is_estimated() {
    let Some(flight) = shared_file("flight/hfb320.csv") else { return };
    let folder = Folder::new("hfb320");
    let result = phugoid(&folder.0, &["estimate", flight.to_str().unwrap(), "--model", "hfb320", "--json"]).json();
    let lift = result["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "CL_alpha").unwrap();
    // Filter error 4.328.
    assert!((number(&lift["value"]) / 4.32785 - 1.0).abs() < 0.05, "{lift}");
    assert_eq!(result["samples"], 601);
    assert!(folder.read("phugoid-report/report.html").contains("CL_alpha"));
}

#[test]
fn studies_say_what_they_measured() {
    let folder = Folder::new("study");
    let study = phugoid(&folder.0, &["study", "calm-air", "--runs", "4", "--json"]).json();
    assert_eq!(study["runs"], 4);
    let last = study["checkpoints"].as_array().unwrap().last().unwrap();
    assert_eq!(last["parameters"].as_array().unwrap().len(), 4);
    assert!(number(&last["parameters"][0]["rmse_over_cramer_rao"]) > 0.0);
    let study = phugoid(&folder.0, &["study", "thesis-size", "--json"]).json();
    assert_eq!(study.as_array().unwrap().len(), 2);
}

#[test]
fn built_in_files_can_be_listed_and_copied() {
    let folder = Folder::new("built-in");
    let listed = phugoid(&folder.0, &["simulate", "--list", "--json"]).json();
    assert!(listed.as_array().unwrap().iter().any(|s| s["name"] == "f16-calm"));
    let text = phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out;
    folder.file("mine.toml", &text);
    assert_eq!(phugoid(&folder.0, &["simulate", "mine.toml"]).code, Some(0));
    let models = phugoid(&folder.0, &["estimate", "--list-models", "--json"]).json();
    assert!(models.as_array().unwrap().iter().any(|m| m["name"] == "hfb320"));
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    folder.file("mine-model.toml", &model);
    let run = phugoid(&folder.0, &["estimate", "phugoid-flight/measured.csv", "--model", "mine-model.toml"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
}
