//! Values that are deleted with a reason, in every command that reads a flight; and the choice of the unknowns of the
//! compatibility check.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};

const DELETE: [&str; 4] = ["--delete", "alpha@1.2s: bird strike", "--delete", "2s..2.09s: \u{1b}[31mdropout"];
const TOLD: &str = "alpha: 1 value deleted at 1.2 s: bird strike";
const TOLD_OF_ALL: &str = "10 values of each deleted from 2 s to 2.09 s: \u{fffd}[31mdropout";

fn flown(test: &str) -> Folder {
    let folder = Folder::new(&format!("deletion-{test}"));
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    folder
}

fn lines(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn every_result_says_what_was_deleted_and_why() {
    let folder = flown("results");
    let estimate = ["estimate", "measured.csv", "--model", "f16-model", "--out", "report"];
    let run = phugoid(&folder.0, &[&estimate[..], &DELETE].concat());
    assert_eq!(run.code, Some(0), "{}{}", run.out, run.err);
    for text in [lines(&run.out), lines(&folder.read("report/report.html"))] {
        assert!(text.contains("1 value deleted at 1.2 s: bird strike") && text.contains(TOLD_OF_ALL), "{text}");
    }
    assert!(!run.out.contains('\u{1b}'));
    let json = phugoid(&folder.0, &[&estimate[..], &["--no-report", "--json"], &DELETE].concat()).json();
    let deletions = json["quality"]["deletions"].as_array().unwrap();
    assert_eq!(deletions[0]["channels"], serde_json::json!([{ "channel": "alpha", "values": 1 }]));
    assert_eq!((deletions.len(), deletions[1]["from_s"].as_f64()), (2, Some(2.0)));
    // The estimate is another one, and still near.
    let before = phugoid(&folder.0, &[&estimate[..], &["--no-report", "--json"]].concat()).json();
    let value = |json: &serde_json::Value| json["parameters"][0]["value"].as_f64().unwrap();
    let sigma = before["parameters"][0]["corrected_std_error"].as_f64().unwrap();
    assert!(value(&json) != value(&before) && (value(&json) - value(&before)).abs() < sigma, "{json}");

    let inspect = phugoid(&folder.0, &[&["inspect", "measured.csv"], &DELETE[..]].concat());
    assert!(lines(&inspect.out).contains(TOLD) && lines(&inspect.out).contains(TOLD_OF_ALL), "{}", inspect.out);
    let monitor = ["monitor", "measured.csv", "--model", "f16-health-model"];
    let run = phugoid(&folder.0, &[&monitor[..], &DELETE].concat());
    assert!(lines(&run.out).contains(TOLD), "{}{}", run.out, run.err);
    let json = phugoid(&folder.0, &[&monitor[..], &["--json"], &DELETE].concat());
    assert!(json.out.contains("\"bird strike\""), "{}", json.out);
    let compatibility = ["compatibility", "measured.csv", "--flat-earth", "--unknowns", "bias_q", "--out", "c"];
    let run = phugoid(&folder.0, &[&compatibility[..], &DELETE].concat());
    assert!(lines(&run.out).contains(TOLD), "{}{}", run.out, run.err);
    assert!(folder.read("c/compatibility.html").contains("bird strike"));
}

#[test]
fn a_file_of_deletions_names_the_flight_and_mistakes_are_answered() {
    let folder = flown("file");
    std::fs::copy(folder.0.join("measured.csv"), folder.0.join("second.csv")).unwrap();
    folder.file(
        "bad.toml",
        "[[delete]]\nflight = \"second.csv\"\nchannel = [\"alpha\", \"q\"]\nfrom = \"1 s\"\nto = \"1.5 s\"\nreason = \"ice\"\n",
    );
    let base = ["estimate", "measured.csv", "--model", "f16-model", "--method", "output-error", "--no-report"];
    let with = ["--with", "second.csv", "--deletions", "bad.toml"];
    let run = phugoid(&folder.0, &[&base[..], &with].concat());
    assert!(lines(&run.out).contains("second.csv: alpha: 51 values deleted from 1 s to 1.5 s: ice"), "{}", run.out);
    // Without that flight, nothing would be deleted.
    let error = phugoid(&folder.0, &[&base[..], &["--deletions", "bad.toml"]].concat());
    assert!(error.fails(3).contains("it deletes values of second.csv, and none of measured.csv"), "{}", error.err);
    for (deletion, code, words) in [
        ("alhpa@1s: ice", 3, "(did you mean 'alpha'?)"),
        ("alpha@99s: ice", 3, "runs from 0 s to 20 s"),
        ("alpha@1.002s..1.008s: ice", 3, "the nearest are at 1 s and 1.01 s"),
        ("alpha@1s", 2, "say why the values are bad"),
        ("alpha@1: ice", 2, "has no unit"),
    ] {
        let run = phugoid(&folder.0, &["inspect", "measured.csv", "--delete", deletion]);
        assert_eq!(run.code, Some(code), "{deletion}: {}", run.err);
        assert!(run.err.contains(words), "{deletion}: {}", run.err);
    }
}

#[test]
fn unknowns_of_the_sensors_are_chosen_by_name() {
    let folder = flown("unknowns");
    let base = ["compatibility", "measured.csv", "--flat-earth", "--json"];
    let names = |more: &[&str]| -> Vec<String> {
        let json = phugoid(&folder.0, &[&base[..], more].concat()).json();
        json["errors"].as_array().unwrap().iter().map(|e| e["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names(&["--unknowns", "scale_alpha,bias_az"]), ["bias_az", "scale_alpha"]);
    let held = phugoid(
        &folder.0,
        &["compatibility", "measured.csv", "--flat-earth", "--without", "scale_theta", "--hold", "bias_q=0.06deg/s"],
    );
    assert_eq!(held.code, Some(0), "{}", held.err);
    assert!(held.out.contains("bias_q at 0.06000 deg/s, not estimated"), "{}", held.out);
    assert!(!held.out.contains("scale_theta") && held.out.contains("scale_alpha"), "{}", held.out);
    let wrong = |more: &[&str]| phugoid(&folder.0, &[&base[..], more].concat());
    assert!(wrong(&["--unknowns", "bias_alhpa"]).fails(3).contains("did you mean `bias_alpha`?"));
    assert!(wrong(&["--unknowns", "wind_north"]).fails(3).contains("the record does not have north, east"));
    let run = wrong(&["--hold", "bias_q=0.06"]);
    assert!(run.code == Some(2) && run.err.contains("has no unit"), "{}", run.err);
}
