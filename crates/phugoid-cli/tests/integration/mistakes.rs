//! What users get wrong, and what they are told.

use crate::common;

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use common::{Folder, phugoid};

#[test]
fn every_help_text_has_examples_and_exit_codes() {
    let folder = Folder::new("help");
    for command in
        [&[][..], &["trim"], &["linearize"], &["simulate"], &["estimate"], &["study"], &["tune"], &["monitor"]]
    {
        let run = phugoid(&folder.0, &[command, &["--help"]].concat());
        assert_eq!(run.code, Some(0));
        assert!(run.out.contains("Examples:") && run.out.contains("Exit codes:"), "{}", run.out);
        assert!(run.out.lines().all(|l| l.chars().count() <= 120), "{}", run.out);
    }
    // Nothing was run and nothing written.
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 0);
}

#[test]
fn quantities_need_their_units() {
    let folder = Folder::new("units");
    let run = phugoid(&folder.0, &["trim", "--altitude", "20000", "--speed", "675ft/s"]);
    let message = run.fails(2);
    assert!(message.contains("no unit") && message.contains("ft"), "{message}");
    let run = phugoid(&folder.0, &["trim", "--altitude", "20000ft", "--speed", "675ft"]);
    assert!(run.fails(2).contains("not a unit of a speed"));
    let run = phugoid(&folder.0, &["trim", "--altitude", "20000ft", "--speed", "675ft/s", "--cg", "30"]);
    assert!(run.fails(2).contains("between 0 and 1"));
    let run = phugoid(&folder.0, &["trim", "--aircraft", "f-16", "--altitude", "20000ft", "--speed", "675ft/s"]);
    // A file may have any name, so that a name is looked for where the file would be.
    assert!(run.fails(3).contains("did you mean `f16`"));
    phugoid(&folder.0, &["tirm"]).fails(2);
    phugoid(&folder.0, &["study", "calm-air", "--runs", "0"]).fails(2);
}

/// A value is refused for what is wrong with it, and not as an option that nobody knows.
#[test]
fn negative_values_are_refused_with_the_reason() {
    let folder = Folder::new("negative");
    folder.file("flight.csv", "time_s,alpha_deg,q_deg_s\n0,1,1\n0.1,2,1\n0.2,1,1\n");
    let estimate = ["estimate", "flight.csv", "--model", "f16"];
    let init = ["init", "flight.csv", "--class", "drone"];
    let told = |command: &[&str], option: &[&str], reason: &str| {
        let run = phugoid(&folder.0, &[command, option].concat());
        let message = run.fails(2);
        assert!(message.contains(reason) && !message.contains("use '-- -"), "{option:?}: {message}");
    };
    told(&["simulate", "f16-doublet"], &["--seed", "-1"], "write a whole number, 0 or more");
    told(&[], &["--seed", "-1"], "write a whole number, 0 or more");
    told(&["study", "calm-air"], &["--runs", "-1"], "-1 is not in 1..");
    told(&["compare", "calm"], &["--cycle", "-4s"], "it must be above zero");
    told(&estimate, &["--sample-time", "-1s"], "it must be above zero");
    told(&estimate, &["--sample-time", "0s"], "it must be above zero");
    told(&estimate, &["--max-memory", "-1MB"], "'-1MB' is no amount of memory");
    told(&estimate, &["--segment", "-1"], "write the number of a manoeuvre");
    told(&init, &["--mass", "-7472kg"], "it must be above zero");
    told(&init, &["--wing-span", "-2m"], "it must be above zero");
    told(&init, &["--iyy", "-2kg*m^2"], "it must be above zero");
    // An option behind one without its value is not taken for the value in silence.
    told(&["init", "flight.csv"], &["--mass", "--class"], "`--class` does not start with a number");
    phugoid(&folder.0, &[&init[..], &["--mass", "--out", "model.toml"]].concat()).fails(2);
    told(&["simulate", "f16-doublet"], &["--seed", "--json"], "a value is required for '--seed <NUMBER>'");
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 1);
}

#[test]
fn what_names_a_part_of_a_record_is_said() {
    let folder = Folder::new("part");
    folder.file("flight.csv", "time_s,alpha_deg,q_deg_s\n0,1,1\n0.1,2,1\n0.2,1,1\n");
    let estimate = ["estimate", "flight.csv", "--model", "f16"];
    for segment in ["1-2", "x", "1;2"] {
        let run = phugoid(&folder.0, &[&estimate[..], &["--segment", segment]].concat());
        let message = run.fails(2);
        assert!(message.contains("as `phugoid inspect` lists them") && message.contains("as in 1,3"), "{message}");
    }
    let run = phugoid(&folder.0, &[&estimate[..], &["--from", "40s", "--to", "12s"]].concat());
    let message = run.fails(3);
    assert!(message.contains("--from 40 s is after --to 12 s: the part ends before it begins"), "{message}");
}

#[test]
fn a_flight_that_needs_more_memory_than_it_may_take_is_told_so() {
    let folder = Folder::new("memory");
    let rows: String = (0..2000).map(|row| format!("{},{row}\n", 0.01 * f64::from(row))).collect();
    folder.file("flight.csv", &format!("time_s,alpha_deg\n{rows}"));
    for command in [
        &["inspect", "flight.csv"][..],
        &["estimate", "flight.csv", "--model", "f16"],
        &["monitor", "flight.csv", "--model", "f16"],
        &["compatibility", "flight.csv"],
        &["compatibility", "flight.csv", "--model", "f16"],
        &["live", "--replay", "flight.csv", "--model", "f16", "--speed", "max"],
    ] {
        let run = phugoid(&folder.0, &[command, &["--max-memory", "100kB"]].concat());
        let message = run.fails(3);
        assert!(message.contains("flight.csv, line 12") && message.contains("the budget is 100 kB"), "{message}");
        assert!(message.contains("--max-memory 1MB"), "{message}");
    }
    let run = phugoid(&folder.0, &["inspect", "flight.csv", "--max-memory", "100"]);
    assert!(run.fails(2).contains("such as 500MB"));
    assert_eq!(phugoid(&folder.0, &["inspect", "flight.csv", "--max-memory", "1 MiB"]).code, Some(0));
}

#[test]
fn an_impossible_trim_says_why() {
    let folder = Folder::new("no-trim");
    let run = phugoid(&folder.0, &["trim", "--altitude", "60000ft", "--speed", "400ft/s", "--json"]);
    let message = run.fails(1);
    assert!(message.contains("deg") || message.contains(" N "), "a number: {message}");
    let run = phugoid(&folder.0, &["linearize", "--altitude", "0ft", "--speed", "5000ft/s"]);
    run.fails(1);
}

/// A flight to spoil.
fn flight(folder: &Folder) -> String {
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    folder.read("measured.csv")
}

/// Estimates a spoilt flight.
fn estimate(folder: &Folder, text: &str) -> common::Run {
    folder.file("spoilt.csv", text);
    phugoid(&folder.0, &["estimate", "spoilt.csv", "--model", "f16-model", "--no-report"])
}

#[test]
fn files_that_are_not_there_are_named() {
    let folder = Folder::new("missing");
    let run = phugoid(&folder.0, &["estimate", "nothing.csv", "--model", "f16"]);
    assert!(run.fails(3).contains("nothing.csv"));
    folder.file("flight.csv", "time_s,alpha_deg\n0,1\n1,2\n");
    let run = phugoid(&folder.0, &["estimate", "flight.csv", "--model", "hfb230"]);
    assert!(run.fails(3).contains("did you mean") || run.fails(3).contains("Did you mean the built-in model `hfb320`"));
    let run = phugoid(&folder.0, &["simulate", "f16-clam"]);
    assert!(run.fails(3).contains("`f16-calm`"));
}

#[test]
fn empty_cut_and_wrong_files_are_told() {
    let folder = Folder::new("files");
    let good = flight(&folder);
    assert!(estimate(&folder, "").fails(3).contains("empty"));
    assert!(estimate(&folder, "no table at all").fails(3).contains("spoilt.csv"));
    let header = good.lines().next().unwrap();
    estimate(&folder, header).fails(3);
    // Cut in the middle of a row: what is there is used, and it is said.
    let cut = estimate(&folder, &good[..good.len() / 2]);
    assert_eq!(cut.code, Some(0), "{}", cut.err);
    assert!(cut.out.contains("cut off") || cut.out.contains("ends in the middle"), "{}", cut.out);
}

#[test]
fn a_missing_channel_is_named() {
    let folder = Folder::new("channel");
    let good = flight(&folder);
    let message = estimate(&folder, &good.replacen("alpha_rad", "vane_signal", 1)).fails(3).to_owned();
    assert!(message.contains("`alpha`"), "{message}");
}

#[test]
fn degrees_taken_for_radians_are_noticed() {
    let folder = Folder::new("degrees");
    let good = flight(&folder);
    let column = good.lines().next().unwrap().split(',').position(|h| h == "alpha_rad").unwrap();
    let mut spoilt = String::new();
    for (k, line) in good.lines().enumerate() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if k > 0 {
            cells[column] = cells[column].parse::<f64>().unwrap().to_degrees().to_string();
        }
        spoilt.push_str(&cells.join(","));
        spoilt.push('\n');
    }
    let run = estimate(&folder, &spoilt);
    let message = run.fails(3);
    assert!(message.contains("`alpha`") && message.contains("degrees"), "{message}");
}

#[test]
fn mistakes_in_a_model_file_have_their_line() {
    let folder = Folder::new("model");
    flight(&folder);
    let good = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    let spoil = |from: &str, to: &str| {
        assert!(good.contains(from));
        folder.file("model.toml", &good.replacen(from, to, 1));
        phugoid(&folder.0, &["estimate", "measured.csv", "--model", "model.toml"])
    };
    let line = 1 + good.lines().position(|l| l.starts_with("dCm_q")).unwrap();
    let run = spoil("dCm_q = ", "dCm_qq = ");
    let message = run.fails(3);
    assert!(message.contains(&format!("model.toml:{line}")) && message.contains("did you mean `dCm_q`"), "{message}");
    assert!(spoil("mass = ", "mas = ").fails(3).contains("did you mean `mass`"));
    assert!(spoil("[aircraft]", "[aircraft").fails(3).contains("TOML"));
    assert!(spoil("20000 ft", "20000 kg").fails(3).contains("kg"));
}

#[test]
fn mistakes_in_a_scenario_have_their_line() {
    let folder = Folder::new("scenario");
    let good = phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out;
    let spoil = |from: &str, to: &str| {
        folder.file("scenario.toml", &good.replacen(from, to, 1));
        phugoid(&folder.0, &["simulate", "scenario.toml"])
    };
    assert!(spoil("dCL_alpha", "dCL_alfa").fails(3).contains("did you mean `dCL_alpha`"));
    assert!(spoil("\"20000 ft\"", "20000").fails(3).contains("no unit"));
    assert!(spoil("\"675 ft/s\"", "\"675 kt/h\"").fails(3).contains("not a unit of a speed"));
    // The scenario is right, and cannot be flown: no trim at this speed.
    spoil("\"675 ft/s\"", "\"100 ft/s\"").fails(1);
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let folder = Folder::new("output");
    folder.file("occupied", "");
    assert!(phugoid(&folder.0, &["--out", "occupied"]).fails(4).contains("occupied"));
    assert!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "occupied"]).fails(4).contains("occupied"));
    let trim = ["trim", "--altitude", "0m", "--speed", "150m/s", "--out", "occupied/trim.json"];
    assert!(phugoid(&folder.0, &trim).fails(4).contains("trim.json"));
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let folder = Folder::new("pipe");
    flight(&folder);
    let mut child = Command::new(env!("CARGO_BIN_EXE_phugoid"))
        .args(["estimate", "measured.csv", "--model", "f16-model", "--json", "--history", "--no-report"])
        .current_dir(&folder.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Take the first byte and leave: the document is far larger than any pipe's buffer.
    let mut first = [0];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A last number that was cut off would be a quietly wrong one: 90 for a thrust of 9909 N.
#[test]
fn a_file_cut_inside_its_last_number_is_told() {
    let folder = Folder::new("cut-number");
    let good = flight(&folder);
    let line = good.lines().nth(900).unwrap();
    let end = good.find(line).unwrap() + line.len();
    let run = estimate(&folder, &good[..end - 12]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let words = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("line 901: the file ends without a line end after '9909"), "{}", run.out);
}

#[test]
fn nonsense_in_a_design_is_refused() {
    let folder = Folder::new("design-mistakes");
    let design = |arguments: &[&str]| phugoid(&folder.0, &[&["design", "doublet"], arguments].concat());
    assert!(design(&["--duration", "1e9s"]).fails(1).contains("shorten the duration"));
    assert!(design(&["--duration", "-5s"]).fails(1).contains("lengthen the duration"));
    assert!(design(&["--lead", "-1s"]).fails(1).contains("-1 s of rest"));
    assert!(design(&["--amplitude", "0deg"]).fails(1).contains("moves nothing"));
    assert!(design(&["--amplitude", "1000deg"]).fails(1).contains("Give smaller ones"));
    assert!(design(&["--surface-rate-limit", "0deg/s"]).fails(1).contains("limit on the surface rate is 0"));
    assert!(design(&["--deflection-limit", "-1deg"]).fails(1).contains("limit on the deflection is -0.017"));
    assert!(design(&["--load-factor-limit", "-1"]).fails(2).contains("positive"));
    assert!(!folder.0.join("phugoid-design").exists(), "nothing is written");
}

#[test]
fn a_mistake_in_a_scenario_is_told_before_its_missing_model() {
    let folder = Folder::new("compare-mistakes");
    folder.file("bad.toml", "x = [\n");
    let run = phugoid(&folder.0, &["compare", "bad.toml"]);
    let message = run.fails(3);
    assert!(message.contains("bad.toml:1: unclosed") && !message.contains("--model"), "{message}");
}

#[test]
fn a_flight_that_was_fitted_is_neither_fitted_again_nor_predicted() {
    let folder = Folder::new("twice");
    flight(&folder);
    let fit = ["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--method", "output-error"];
    let with = |option: &str| phugoid(&folder.0, &[&fit[..], &[option, "./measured.csv"]].concat());
    assert!(with("--with").fails(3).contains("fitted already"));
    assert!(with("--predict").fails(3).contains("tests nothing"));
}

/// An option that would change nothing is refused: the result would look as if it had counted.
#[test]
fn options_that_nothing_looks_at_are_refused() {
    let folder = Folder::new("ignored");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let estimate = |more: &[&str]| {
        let command = ["estimate", "measured.csv", "--model", "f16-model", "--no-report"];
        phugoid(&folder.0, &[&command[..], more].concat())
    };
    for (options, words) in [
        (&["--gaussian"][..], ["--gaussian would change nothing", "output-error"]),
        (&["--flow-angles", "measured"], ["--flow-angles would change nothing", "the method is smpe"]),
        (&["--flow-angles", "simulated", "--method", "filter-error"], ["it is for output-error", "filter-error"]),
        (&["--variable", "x"], ["--variable x: `measured.csv` is a table as text", "Leave it out"]),
        (&["--with", "measured.csv:x", "--method", "output-error"], ["--with x: `measured.csv`", "Leave it out"]),
    ] {
        let run = estimate(options);
        let message = run.fails(3);
        assert!(words.iter().all(|word| message.contains(word)), "{options:?}: {message}");
    }
    for options in [
        &["--gaussian", "--method", "equation-error"][..],
        &["--flow-angles", "measured", "--method", "output-error"],
        &["--flow-angles", "auto"],
        &["--truth", "f16-calm"],
    ] {
        assert_eq!(estimate(options).code, Some(0), "{options:?}");
    }
    let other = ["estimate", "measured.csv", "--model", "hfb320", "--no-report", "--truth", "f16-calm"];
    let run = phugoid(&folder.0, &other);
    let message = run.fails(3);
    assert!(message.contains("--truth f16-calm: this scenario") && message.contains("the model has CD_0"), "{message}");
    let run = phugoid(&folder.0, &["inspect", "measured.csv", "--variable", "x"]);
    assert!(run.fails(3).contains("--variable x"), "{}", run.err);
    let run = phugoid(&folder.0, &["field", ".", "--gaussian"]);
    assert!(run.fails(3).contains("--gaussian would change nothing"), "{}", run.err);
}

/// Whatever is quoted of a file, a message fits on a screen.
#[test]
fn what_a_message_quotes_of_a_file_is_short() {
    let folder = Folder::new("long-quotes");
    let key = "A".repeat(1_000_000);
    let model = phugoid(&folder.0, &["estimate", "--show-model", "hfb320"]).out;
    folder.file("key.toml", &model.replace("[parameters]", &format!("[parameters]\n{key} = 1")));
    folder.file("flight.csv", "time_s,alpha_deg\n0,1\n1,2\n");
    let scenario = phugoid(&folder.0, &["simulate", "f16-calm", "--show"]).out;
    folder.file("key-of-scenario.toml", &format!("{key} = 1\n{scenario}"));
    for command in
        [&["estimate", "flight.csv", "--model", "key.toml", "--no-report"][..], &["simulate", "key-of-scenario.toml"]]
    {
        let run = phugoid(&folder.0, command);
        let message = run.fails(3);
        assert!(message.len() < 2000 && message.contains("AAA...`"), "{} {}", message.len(), &message[..200]);
    }
}

/// Another variable of one file is another flight.
#[cfg(feature = "matlab")]
#[test]
fn a_further_flight_is_a_variable_of_its_own() {
    let folder = Folder::new("variables");
    for name in ["several.mat", "struct.mat"] {
        let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../phugoid-flight-data/tests/data/matlab");
        std::fs::copy(std::path::Path::new(data).join(name), folder.0.join(name)).unwrap();
    }
    let fit = ["estimate", "several.mat", "--variable", "first", "--model", "f16-model", "--method", "output-error"];
    let with = |word: &str| phugoid(&folder.0, &[&fit[..], &["--no-report", "--with", word]].concat());
    assert!(with("several.mat").fails(3).contains("--with several.mat:VARIABLE"));
    assert!(with("several.mat:third").fails(3).contains("Found: first, second. Name the one"));
    // Read, and found to be no flight of this model: the variable, and in a file without `first` its only table.
    for word in ["several.mat:second", "struct.mat"] {
        let message = with(word);
        assert!(message.fails(3).contains("is missing"), "{word}: {}", message.err);
    }
}

/// A command that needs a feature says so.
#[cfg(not(feature = "fleet"))]
#[test]
fn a_command_of_another_build_names_its_feature() {
    let folder = Folder::new("no-fleet");
    for arguments in [&["fleet", "study.toml"][..], &["campaign"], &["fleet", "--help"]] {
        let run = phugoid(&folder.0, arguments);
        assert!(run.fails(2).contains("--features fleet"), "{arguments:?}: {}", run.err);
    }
    let run = phugoid(&folder.0, &["fleat"]);
    assert!(run.fails(2).contains("fleat"), "{}", run.err);
}

#[test]
fn a_surface_that_never_moves_is_named() {
    let folder = Folder::new("still-rudder");
    let text = include_str!("../../../../scenarios/f16-lateral.toml");
    let still: Vec<String> = text
        .split("[[manoeuvre]]")
        .map(|part| match part.contains("surface = \"rudder\"") {
            true => part.replacen("amplitude = \"", "amplitude = \"0 deg\" # ", 1),
            false => part.to_owned(),
        })
        .collect();
    folder.file("still.toml", &still.join("[[manoeuvre]]"));
    assert_eq!(phugoid(&folder.0, &["simulate", "still.toml", "--out", "flight"]).code, Some(0));
    let estimate = |method: &str| {
        let arguments =
            ["estimate", "flight/measured.csv", "--model", "f16-lateral", "--no-report", "--method", method];
        phugoid(&folder.0, &arguments)
    };
    for method in ["equation-error", "output-error", "filter-error"] {
        let run = estimate(method);
        let message = run.fails(5);
        assert!(message.contains("_rudder does not move any measured output"), "{method}: {message}");
    }
    for method in ["smpe", "ekf", "rls", "fourier", "implicit-sign"] {
        let run = estimate(method);
        assert_eq!(run.code, Some(0), "{method}: {}", run.err);
        for name in ["dCY_rudder", "dCl_rudder", "dCn_rudder"] {
            let row = run.out.lines().find(|l| l.trim_start().starts_with(name)).unwrap();
            let cells: Vec<&str> = row.split_whitespace().collect();
            assert_eq!(cells[3..], ["-", "-", "not", "excited"], "{method}: {row}");
        }
    }
}

#[test]
fn a_history_without_a_folder_names_its_option() {
    let folder = Folder::new("history");
    flight(&folder);
    let estimate = ["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--history", "absent/h.csv"];
    let run = phugoid(&folder.0, &estimate);
    let message = run.fails(4);
    assert!(message.contains("no folder `absent`: make it") && message.contains("with --history"), "{message}");
}

/// A part of a record asks the whole by how much its surfaces are late, and corrections may say it too: an elevator 80 ms late that was
/// moved by both gave half of the pitch damping.
#[test]
fn a_surface_is_not_moved_by_the_corrections_and_once_more_by_the_whole_record() {
    let folder = Folder::new("moved-once");
    let field = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phugoid-evaluation/tests/field/develop/OV10");
    let model = std::fs::read_to_string(field.join("longitudinal.toml")).unwrap();
    folder.file("model.toml", &model.replace("input = \"interpolated\"\n", ""));
    let flight = std::fs::read_to_string(field.join("calm-short.csv")).unwrap();
    let rows: Vec<Vec<&str>> = flight.lines().map(|line| line.split(',').collect()).collect();
    let elevator = rows[0].iter().position(|name| *name == "elevator_deg").unwrap();
    let late = rows.iter().enumerate().map(|(k, row)| {
        let mut row = row.clone();
        // Four samples of 20 ms.
        row[elevator] = if k == 0 { row[elevator] } else { rows[k.saturating_sub(4).max(1)][elevator] };
        row.join(",") + "\n"
    });
    folder.file("late.csv", &late.collect::<String>());
    folder.file("c.json", r#"{ "channels": { "elevator": { "delay_s": 0.08 } } }"#);
    let estimate = ["estimate", "late.csv", "--model", "model.toml", "--no-report", "--json", "--correct", "c.json"];
    let damping = |further: &[&str]| {
        let result = phugoid(&folder.0, &[&estimate, further].concat()).json();
        let parameters = result["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == "Cm_q").unwrap()["value"].as_f64().unwrap()
    };
    assert_eq!(damping(&["--from", "0s"]), damping(&[]));
}

#[test]
fn a_file_that_holds_no_corrections_is_refused() {
    let folder = Folder::new("corrections");
    flight(&folder);
    folder.file("none.json", "{}");
    let estimate = ["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--correct", "none.json"];
    let run = phugoid(&folder.0, &estimate);
    let message = run.fails(3);
    assert!(message.contains("none.json") && message.contains("`channels`"), "{message}");
    for (text, expected) in [
        (
            r#"{ "channels": { "aplha": { "bias": 0.01 } } }"#,
            "channel `aplha` is neither in the record nor a known channel. Is `alpha`",
        ),
        (r#"{ "channels": { "alpha": { "scale": -1.0 } } }"#, "scale of channel `alpha` is -1"),
        (r#"{ "channels": { "alpha": { "bias": 20 } } }"#, "bias of channel `alpha` is 20, and no instrument"),
        (r#"{ "channels": { "theta": { "delay_s": 500 } } }"#, "delay_s of channel `theta` is 500"),
        (r#"{ "channels": {}, "vane_alpha_x": 4000 }"#, "vane_alpha_x is 4000 m, which is longer than any aeroplane"),
        (r#"{ "channels": {}, "vane_alpha": 4 }"#, "unknown field `vane_alpha`"),
    ] {
        folder.file("none.json", text);
        let run = phugoid(&folder.0, &estimate);
        let message = run.fails(3).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(message.contains(expected), "{message}");
    }
    // Nothing to correct, and a sensor that this record has not, are said.
    for (text, expected) in [
        (r#"{ "channels": {} }"#, "hold no error of a sensor"),
        (r#"{ "channels": { "mach": { "bias": 0.01 } } }"#, "The corrections of mach were not used"),
    ] {
        folder.file("none.json", text);
        let run = phugoid(&folder.0, &estimate);
        let all = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(all.contains(expected), "{all}");
    }
}

#[test]
fn a_time_outside_the_flight_is_refused() {
    let folder = Folder::new("study-time");
    let study = ["study", "accuracy", "--scenario", "f16-calm", "--model", "f16-model", "--runs", "2", "--at"];
    for at in ["1000s", "-1s"] {
        let run = phugoid(&folder.0, &[&study[..], &[at]].concat());
        assert!(run.fails(3).contains("which lasts 20 s"));
    }
}

/// What stands in a file with decimal commas and clock times is understood in options too.
#[test]
fn decimal_commas_and_times_of_day_are_understood() {
    let folder = Folder::new("commas");
    let rows: String = (0..400)
        .map(|row| {
            let (time, text) = (30.0 + 0.05 * f64::from(row), flight_row(row));
            format!("10:15:{time:06.3};{text}\n").replace('.', ",")
        })
        .collect();
    std::fs::write(folder.0.join("f.csv"), format!("Uhrzeit;TAS [m/s];Theta [°];q [°/s];η [°]\n{rows}")).unwrap();
    let with = |more: &[&str]| {
        let run = ["regress", "f.csv", "--model", "f16-model", "--coefficient", "Cm"];
        phugoid(&folder.0, &[&run[..], more].concat())
    };
    // The record runs from 10:15:30 to 10:15:49.95.
    let message = with(&["--from", "10:16:00"]).fails(3).to_owned();
    assert!(
        message.contains("--from: by its clock the record runs from 10:15:30.000000 to 10:15:49.950000"),
        "{message}"
    );
    let message = with(&["--from", "1,500s"]).fails(2).to_owned();
    assert!(message.contains("`1.500s` or as `1500s`"), "{message}");
    // Both lie before the record.
    let message = with(&["--from", "-2,5s", "--to", "-1,5s"]).fails(3).to_owned();
    assert!(message.contains("no sample lies between"), "{message}");
    std::fs::write(
        folder.0.join("f.csv"),
        format!("n;TAS [m/s];Theta [°];q [°/s];η [°]\n{rows}").replace("10:15:", ""),
    )
    .unwrap();
    let message = with(&["--from", "10:16:00", "--sample-time", "0,05s"]).fails(3).to_owned();
    assert!(message.contains("no clock that shows times of day"), "{message}");
}

/// Cells of a steady flight.
fn flight_row(row: u32) -> String {
    let wave = (0.1 * f64::from(row)).sin();
    format!("{:.2};{:.3};{:.3};{:.3}", 60.0 + wave, 2.0 + wave, wave, -1.0 + 0.5 * wave)
}

#[test]
fn what_is_no_flight_is_answered_with_what_it_is() {
    let folder = Folder::new("no-flight");
    std::fs::create_dir(folder.0.join("folder")).unwrap();
    std::fs::write(folder.0.join("photo.bin"), [b'J', 0, 1, 2, 0xFF, 0xFE, 0]).unwrap();
    std::fs::write(folder.0.join("noise.bin"), [&[0xA3, 0x95, 0x80][..], &[7; 400]].concat()).unwrap();
    let falling: String = (0..50).map(|row| format!("{},1\n", 60 - row)).collect();
    folder.file("falling.csv", &format!("time_s,alpha_deg\n{falling}"));
    folder.file("one.csv", "time_s,alpha_deg\n0,1\n");
    folder.file("empty.bin", "");
    for (file, parts) in [
        ("folder", &["it is a folder; name a file in it"][..]),
        ("photo.bin", &["binary data", "neither as a ULog (`ULog`) nor as a DataFlash log (bytes A3 95)"]),
        ("noise.bin", &["the log holds no data", "if it was cut off or damaged, copy it again"]),
        ("falling.csv", &["rises in only 1 of 50 rows", "turn the order of the rows round"]),
        ("one.csv", &["only one time is left; a record needs at least two"]),
        ("empty.bin", &["the file is empty", "time_s,alpha_deg,q_deg_s"]),
    ] {
        for command in [&["inspect", file][..], &["estimate", file, "--model", "f16", "--no-report"]] {
            let run = phugoid(&folder.0, command);
            let told = run.fails(3);
            assert!(told.starts_with(&format!("error: {file}")), "{told}");
            assert!(parts.iter().all(|part| told.contains(part)), "{parts:?}: {told}");
        }
    }
}
