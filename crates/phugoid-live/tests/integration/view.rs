//! Results as files, and the page that shows them.
// What goes wrong in a helper fails the test.
#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::path::PathBuf;

use phugoid_live::view::{Finished, ViewError};
use serde_json::{Value, json};

/// A file that lasts as long as the test.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("phugoid-view-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        Self(path)
    }

    fn read(&self) -> Result<Finished, ViewError> {
        Finished::read_path(&self.0)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn data_of(finished: &Finished) -> Value {
    let page = finished.html().unwrap();
    let (_, after) = page.split_once(r#"id="data">"#).unwrap();
    serde_json::from_str(after.split_once("</script>").unwrap().0).unwrap()
}

fn hello() -> Value {
    json!({"type": "hello", "source": "udp:127.0.0.1:14550", "version": "0.1.0", "flight": 0,
        "layout": {"model": "m", "method": "smpe", "axes": ["longitudinal"], "parameters": [{"name": "Cm_q", "unit": "per rad", "initial": 0.0, "prior_std": 1.0, "nuisance": false}],
        "outputs": [{"name": "alpha", "unit": "rad"}], "inputs": [{"name": "elevator", "unit": "rad"}]}})
}

fn estimate(k: u32) -> Value {
    let time_s = f64::from(k) * 0.01;
    json!({"type": "estimate", "time_s": time_s, "phase": "sliding", "change": "steady", "moved": true,
        "parameters": [{"value": -f64::from(k), "std_error": 0.5, "status": "converged", "readiness": null}],
        "outputs": [if k == 3 { Value::Null } else { json!(0.25) }], "predicted": [0.5], "residuals": [1.5], "inputs": [-0.125]})
}

fn stream(estimates: u32) -> String {
    let mut text = hello().to_string() + "\n";
    for k in 0..estimates {
        let _ = writeln!(text, "{}", estimate(k));
    }
    text
}

#[test]
fn documents_of_a_stream_become_columns() {
    let event = json!({"type": "event", "time_s": null, "arrival_s": 0.05, "kind": "gap", "message": "a gap"});
    let link = json!({"type": "link", "received": 30, "lost": 1});
    let file = Scratch::new("stream", &format!("{}{event}\n{link}\n", stream(10)));
    let data = data_of(&file.read().unwrap());
    assert_eq!(data["hello"]["layout"]["parameters"][0]["unit"], "per rad");
    assert_eq!(data["history"]["time_s"].as_array().unwrap().len(), 10);
    // Value, lower and upper edge; measured, predicted, residual; input.
    for (column, value) in [json!(-7.0), json!(-8.0), json!(-6.0), json!(0.25), json!(0.5), json!(1.5), json!(-0.125)]
        .into_iter()
        .enumerate()
    {
        assert_eq!(data["history"]["columns"][column][7], value, "{column}");
    }
    assert_eq!(data["history"]["columns"][3][3], Value::Null, "what was missing stays missing");
    assert_eq!(data["parameters"][0]["value"], -9.0);
    assert_eq!((&data["events"][0]["message"], &data["link"]["lost"]), (&json!("a gap"), &json!(1)));
    assert_eq!(data["verdict"], json!([]));
}

#[test]
fn damaged_lines_are_left_out_and_said_so() {
    let mut text = stream(10).replace(&estimate(4).to_string(), "{\"type\":\"estimate\",\"time_s\":oops}");
    text.truncate(text.len() - 40);
    let data = data_of(&Scratch::new("damaged", &text).read().unwrap());
    assert_eq!(data["history"]["time_s"].as_array().unwrap().len(), 8);
    let notes = data["verdict"].to_string();
    assert!(notes.contains("Line 6 is left out") && notes.contains("2 lines in all"), "{notes}");
}

#[test]
fn a_second_start_is_another_result() {
    let data = data_of(&Scratch::new("two", &(stream(10) + &stream(4))).read().unwrap());
    assert_eq!(data["history"]["time_s"].as_array().unwrap().len(), 4);
    assert!(data["verdict"].to_string().contains("10 estimates before"), "{}", data["verdict"]);
}

#[test]
fn a_long_stream_gives_a_bounded_page() {
    let data = data_of(&Scratch::new("long", &stream(40_000)).read().unwrap());
    assert!(data["history"]["samples_per_group"].as_u64().unwrap() > 1);
    assert!(data["history"]["time_s"].as_array().unwrap().len() <= 32_768);
    assert_eq!(data["parameters"][0]["value"], -39_999.0, "the final value is that of the last estimate");
}

#[test]
fn what_is_no_result_is_answered_with_what_to_do() {
    for (name, text, expected) in [
        ("empty", "", "empty"),
        ("csv", "time_s,alpha_rad\n0,0.1\n", "not JSON"),
        ("other", "{\"a\": 1}", "source"),
        ("silent", &hello().to_string(), "no estimate"),
        ("headless", &estimate(1).to_string(), "hello"),
    ] {
        let error = Scratch::new(name, text).read().unwrap_err();
        let told = error.to_string();
        assert!(matches!(error, ViewError::NoResult(_)), "{told}");
        assert!(told.contains(expected) && told.contains("--json --history"), "{name}: {told}");
    }
    let without =
        json!({"source": "f.csv", "model": "m", "method": "smpe", "parameters": [], "events": [], "verdict": []});
    assert!(matches!(Scratch::new("bare", &without.to_string()).read(), Err(ViewError::NoHistory)));
}
