//! A flight that is replayed gives the numbers of `phugoid estimate`, however its columns are called and scaled.

use crate::common;

use common::{Folder, Run, phugoid};
use serde_json::Value;

/// A new header, and what a cell of the old column is under it.
type Column = (&'static str, fn(f64) -> f64);

/// The headers of the simulated flight that are changed, and how: what a cell becomes under each new header, and the
/// line of `[channels]` that undoes it.
struct Form {
    name: &'static str,
    column: &'static str,
    becomes: &'static [Column],
    mapping: &'static str,
}

const FORMS: [Form; 11] = [
    Form {
        name: "renamed, the unit in the header",
        column: "alpha_rad",
        becomes: &[("AOA vane [deg]", f64::to_degrees)],
        mapping: "alpha = \"AOA vane [deg]\"",
    },
    Form {
        name: "renamed, without a unit",
        column: "theta_rad",
        becomes: &[("attitude 2", |rad| rad)],
        mapping: "theta = { header = \"attitude 2\" }",
    },
    Form {
        name: "renamed, with unit and sign",
        column: "elevator_rad",
        becomes: &[("DE", |rad| -rad.to_degrees())],
        mapping: "elevator = { header = \"DE\", unit = \"deg\", scale = -1 }",
    },
    Form {
        // Nothing is missing if this is mapped twice: only the sign is wrong.
        name: "the sign under the header of the channel itself",
        column: "elevator_rad",
        becomes: &[("elevator_rad", |rad| -rad)],
        mapping: "elevator = { header = \"elevator_rad\", scale = -1 }",
    },
    Form {
        name: "a factor under the header of the channel itself",
        column: "q_rad_s",
        becomes: &[("q_rad_s", |rad_s| rad_s / 4.0)],
        mapping: "q = { header = \"q_rad_s\", scale = 4 }",
    },
    Form {
        name: "another unit than the header says",
        column: "true_airspeed_m_s",
        becomes: &[("tas_m_s", |m_s| m_s * 3600.0 / 1852.0)],
        mapping: "true_airspeed = { header = \"tas_m_s\", unit = \"kt\" }",
    },
    Form {
        name: "a sum of two columns",
        column: "elevator_rad",
        becomes: &[("left", |rad| rad.to_degrees() + 1.0), ("right", |rad| 1.0 - rad.to_degrees())],
        mapping: "elevator = { sum = { \"left\" = 0.5, \"right\" = -0.5 }, unit = \"deg\" }",
    },
    Form {
        name: "a header in quotes, with quotes, a comma and semicolons in it",
        column: "alpha_rad",
        becomes: &[("\"the \"\"true\"\" one; a; b, or not\"", f64::to_degrees)],
        mapping: "alpha = { header = \"the \\\"true\\\" one; a; b, or not\", unit = \"deg\" }",
    },
    Form {
        // It is mapped to nothing, and goes through the replay as it is.
        name: "a further column with quotes in its name",
        column: "theta_rad",
        becomes: &[("theta_rad", |rad| rad), ("\"the \"\"other\"\" one\"", |rad| 2.0 * rad)],
        mapping: "",
    },
    Form {
        // The model file states the density then, in place of the channel that it is computed from.
        name: CONSTANT,
        column: "altitude_m",
        becomes: &[],
        mapping: "",
    },
    Form {
        name: "the time in milliseconds",
        column: "time_s",
        becomes: &[("clock", |s| s * 1000.0)],
        mapping: "time = { header = \"clock\", unit = \"ms\" }",
    },
];

/// The form in which a channel is missing, and the model file states a constant.
const CONSTANT: &str = "a constant in place of a channel";

/// The model file for a form: its mapping, or the constant.
fn model_for(model: &str, form: &Form) -> String {
    if form.name != CONSTANT {
        return format!("{model}\n[channels]\n{}\n", form.mapping);
    }
    let of_altitude = "air_density = \"book_atmosphere\"";
    assert_eq!(model.matches(of_altitude).count(), 1);
    model.replace(of_altitude, "air_density = \"0.653 kg/m^3\"")
}

/// The flight under other headers.
fn changed(flight: &str, form: &Form) -> String {
    let mut lines = flight.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place = header.iter().position(|h| *h == form.column).unwrap_or_else(|| panic!("{header:?}"));
    let row = |cells: Vec<String>, new: Vec<String>| {
        let mut cells = cells;
        cells.splice(place..=place, new);
        cells.join(",")
    };
    let own = |cells: &[&str]| cells.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>();
    let mut rows = vec![row(own(&header), form.becomes.iter().map(|(header, _)| (*header).to_owned()).collect())];
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let value: f64 = cells[place].parse().unwrap();
        rows.push(row(own(&cells), form.becomes.iter().map(|(_, what)| what(value).to_string()).collect()));
    }
    rows.join("\n") + "\n"
}

/// Values and standard errors of the parameters at the end of what `phugoid live` has published.
fn live_result(run: &Run) -> Vec<(f64, f64)> {
    assert_eq!(run.code, Some(0), "{}", run.err);
    let last = run.out.lines().rfind(|line| line.starts_with("{\"type\":\"estimate\"")).unwrap();
    let last: Value = serde_json::from_str(last).unwrap();
    last["parameters"].as_array().unwrap().iter().map(|p| numbers(p, "std_error")).collect()
}

fn numbers(parameter: &Value, error: &str) -> (f64, f64) {
    (parameter["value"].as_f64().unwrap(), parameter[error].as_f64().unwrap())
}

fn replay(folder: &Folder, file: &str, more: &[&str]) -> Run {
    let command = ["live", "--replay", file, "--speed", "max", "--all", "--no-page"];
    phugoid(&folder.0, &[&command[..], more].concat())
}

#[test]
fn every_form_of_a_mapping_gives_the_numbers_of_estimate() {
    let folder = Folder::new("mapped-replay");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let flight = folder.read("measured.csv");
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    for (number, form) in FORMS.iter().enumerate() {
        let [file, mapped, recording] = ["csv", "toml", "phugoid-live"].map(|end| format!("{number}.{end}"));
        folder.file(&file, &changed(&flight, form));
        folder.file(&mapped, &model_for(&model, form));
        let estimate = ["estimate", &file, "--model", &mapped, "--no-change-detection", "--no-report", "--json"];
        let estimated = phugoid(&folder.0, &estimate).json();
        let estimated: Vec<(f64, f64)> =
            estimated["parameters"].as_array().unwrap().iter().map(|p| numbers(p, "corrected_std_error")).collect();

        let no_change = ["--model", &mapped, "--no-change-detection"];
        let first = replay(&folder, &file, &[&no_change[..], &["--record", &recording]].concat());
        let lived = live_result(&first);
        assert_eq!(lived.len(), estimated.len(), "{}", form.name);
        for (lived, estimated) in lived.iter().zip(&estimated) {
            assert_eq!(lived, estimated, "{}", form.name);
        }
        // The recording of the replay holds rows that are mapped already, and says so.
        assert_eq!(live_result(&replay(&folder, &recording, &[])), lived, "{}", form.name);
        let page = phugoid(&folder.0, &["view", &recording, "--html", "page.html"]);
        assert_eq!(page.code, Some(0), "{}: {}", form.name, page.err);
        let page = folder.read("page.html");
        let data = page.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0;
        let data: Value = serde_json::from_str(data).unwrap();
        let shown: Vec<(f64, f64)> =
            data["parameters"].as_array().unwrap().iter().map(|p| numbers(p, "std_error")).collect();
        assert_eq!(shown, lived, "{}", form.name);
    }
}

/// A stream whose header lacks what the model file maps gives no sample; that is an error and its reason, not silence.
#[test]
fn data_without_a_sample_are_an_error_that_says_why() {
    let folder = Folder::new("no-sample");
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    folder.file("mapped.toml", &format!("{model}\n[channels]\nelevator = {{ header = \"DE\", unit = \"deg\" }}\n"));
    let stream = |text: &str| {
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_phugoid"))
            .args(["live", "-", "--model", "mapped.toml", "--no-page", "--no-record"])
            .current_dir(&folder.0)
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::io::Write::write_all(&mut program.stdin.take().unwrap(), text.as_bytes()).unwrap();
        let output = program.wait_with_output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Run { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    };
    for (text, reason) in [
        ("time_s,alpha_deg,elevator_deg\n0.00,2.1,-1\n0.01,2.2,-1\n", "DE"),
        ("alpha_deg,DE\n2.1,-1\n2.2,-1\n", "time"),
        ("time_s,alpha_deg,DE\n", "0 rows"),
        ("hello\n", "header line"),
    ] {
        let run = stream(text);
        assert_eq!(run.code, Some(3), "{text}: {}", run.err);
        assert!(run.err.contains("no sample could be made") && run.err.contains(reason), "{text}: {}", run.err);
        // Who reads the lines sees it too.
        assert!(run.out.contains("\"kind\":\"waiting\""), "{}", run.out);
    }
    // Nothing at all has arrived: nothing is wrong with it.
    assert_eq!(stream("").code, Some(0));
    // Samples, but nothing that could be estimated of them.
    folder.file("short.csv", "time_s,alpha_deg,DE\n0.00,2.1,-1\n0.01,2.2,-1\n0.02,2.2,-1\n");
    let run = replay(&folder, "short.csv", &["--model", "mapped.toml"]);
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert!(run.err.contains("no estimate could be made: "), "{}", run.err);
    // Through a pipe no estimate is no success either, and a channel that never comes is named.
    let rows: String = (0..400).map(|k| format!("{},2.{},{}\n", 0.01 * f64::from(k), k % 7, -1 - k % 3)).collect();
    let piped = stream(&format!("time_s,alpha_deg,DE\n{rows}"));
    folder.file("without.csv", &format!("time_s,alpha_deg,DE\n{rows}"));
    for run in [piped, replay(&folder, "without.csv", &["--model", "mapped.toml"])] {
        assert_eq!(run.code, Some(1), "{}", run.err);
        assert!(
            run.err.contains("no estimate could be made: the channels ") && run.err.contains("are missing"),
            "{}",
            run.err
        );
        assert!(!run.err.contains("elevator"), "{}", run.err);
    }
}

/// The mapping of another model file cannot be applied to rows that were mapped before they were recorded.
#[test]
fn a_recording_of_a_replay_keeps_the_mapping_of_its_model() {
    let folder = Folder::new("whose-mapping");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    folder
        .file("turned.toml", &format!("{model}\n[channels]\nelevator = {{ header = \"elevator_rad\", scale = -1 }}\n"));
    let first = replay(&folder, "measured.csv", &["--model", "turned.toml", "--record", "r.phugoid-live"]);
    let recorded = live_result(&first);
    let other = replay(&folder, "r.phugoid-live", &["--model", "f16-model"]);
    assert!(other.err.contains("`turned.toml`") && other.err.contains("not applied"), "{}", other.err);
    assert_eq!(live_result(&other), recorded);
    let same = replay(&folder, "r.phugoid-live", &["--model", "turned.toml"]);
    assert!(!same.err.contains("not applied"), "{}", same.err);
    assert_eq!(live_result(&same), recorded);
}
