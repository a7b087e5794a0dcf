//! `phugoid init`: from a flight to a model file, and from there to an estimate.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Folder, phugoid};

#[test]
fn a_model_file_is_begun_from_a_flight_and_a_few_options() {
    let folder = Folder::new("init");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let run = phugoid(&folder.0, &["init", "measured.csv"]);
    assert_eq!(run.code, Some(3));
    assert!(run.err.contains("--class: what kind of aircraft"), "{}", run.err);
    let run = phugoid(&folder.0, &["init", "measured.csv", "--class", "fighter"]);
    assert_eq!(run.code, Some(3));
    for option in ["--mass: mass in flight", "--wing-area", "--wing-span"] {
        assert!(run.err.contains(option), "{option}: {}", run.err);
    }
    let answers = [
        "init",
        "measured.csv",
        "--class",
        "fighter",
        "--mass",
        "20500lb",
        "--wing-area",
        "300ft^2",
        "--wing-span",
        "30ft",
        "--mean-chord",
        "11.32ft",
        "--iyy",
        "55814slug*ft^2",
    ];
    // Printed, so that it can be looked at or sent on.
    let run = phugoid(&folder.0, &answers);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("wing_area = \"27.87091 m^2\"") && !run.err.contains("Assumed"), "{}", run.out);
    // What nobody said goes to standard error too.
    let run = phugoid(&folder.0, &answers[..answers.len() - 2]);
    assert!(run.err.contains("Assumed, because nobody said it") && run.out.contains("inertia = 0.3"), "{}", run.err);
    // Never over the flight.
    let run = phugoid(&folder.0, &[&answers[..], &["--out", "measured.csv"]].concat());
    assert_eq!(run.code, Some(3), "{}", run.err);
    let run = phugoid(&folder.0, &[&answers[..], &["--out", "mine.toml"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.contains("Next: phugoid estimate measured.csv --model mine.toml"), "{}", run.err);
    // Never over a file that has been changed by hand since.
    let begun = folder.read("mine.toml");
    folder.file("mine.toml", &format!("# mine\n{begun}"));
    let run = phugoid(&folder.0, &[&answers[..], &["--out", "mine.toml"]].concat());
    let message = run.fails(4);
    assert!(message.contains("mine.toml: this file exists") && message.contains("Name a new file"), "{message}");
    assert_eq!(folder.read("mine.toml"), format!("# mine\n{begun}"));
    let run = phugoid(&folder.0, &["estimate", "measured.csv", "--model", "mine.toml", "--no-report", "--json"]);
    let estimated = run.json();
    let parameter = |name: &str| {
        let all = estimated["parameters"].as_array().unwrap();
        all.iter().find(|p| p["name"] == name).unwrap_or_else(|| panic!("no {name}: {all:?}"))["value"]
            .as_f64()
            .unwrap()
    };
    // The totals of the README's table: the database's slope and the increment.
    assert!((parameter("Cm_q") + 8.75).abs() < 1.5, "{}", parameter("Cm_q"));
    assert!((parameter("CL_alpha") - 4.02).abs() < 0.5, "{}", parameter("CL_alpha"));
    // A pound is no kilogram: the record says so.
    let run = phugoid(
        &folder.0,
        &["init", "measured.csv", "--class", "drone", "--mass", "20500lb", "--wing-area", "3m^2", "--wing-span", "3m"],
    );
    assert!(run.err.contains("Does not belong together") && run.err.contains("is no usual mass"), "{}", run.err);
}

/// A lateral-directional model needs no thrust, and is not blamed for the drag that it does not know.
#[test]
fn a_lateral_model_is_begun_where_the_ailerons_were_moved() {
    let folder = Folder::new("init-lateral");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-lateral", "--out", "."]).code, Some(0));
    let run = phugoid(
        &folder.0,
        &[
            "init",
            "measured.csv",
            "--class",
            "fighter",
            "--mass",
            "20500lb",
            "--wing-area",
            "300ft^2",
            "--wing-span",
            "30ft",
            "--mean-chord",
            "11.32ft",
            "--out",
            "mine.toml",
        ],
    );
    assert_eq!(run.code, Some(0), "{}", run.err);
    let text = std::fs::read_to_string(folder.0.join("mine.toml")).unwrap();
    assert!(
        text.contains("axes = [\"lateral\"]") && !run.err.contains("Does not belong together"),
        "{text}{}",
        run.err
    );
    let without_thrust: String =
        text.lines().filter(|line| !line.starts_with("thrust")).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.0.join("mine.toml"), without_thrust).unwrap();
    let run = phugoid(&folder.0, &["estimate", "measured.csv", "--model", "mine.toml", "--no-report"]);
    assert!(!run.out.contains("Check thrust") && !run.out.starts_with("REFUSED"), "{}", run.out);
}

/// Whatever a person's table looks like, it is read from the file and from a pipe.
#[test]
fn a_table_without_names_or_times_is_told_by_options() {
    let folder = Folder::new("nameless");
    let rows: String = (0..60).map(|k| format!("{},{}\n", f64::from(k).sin(), k)).collect();
    std::fs::write(folder.0.join("bare.txt"), &rows).unwrap();
    let run = phugoid(&folder.0, &["inspect", "bare.txt"]);
    assert!(run.code == Some(3) && run.err.contains("--columns"), "{}", run.err);
    let run = phugoid(&folder.0, &["inspect", "bare.txt", "--columns", "alpha_deg,count"]);
    assert!(run.code == Some(3) && run.err.contains("--sample-time"), "{}", run.err);
    let run = phugoid(&folder.0, &["inspect", "bare.txt", "--columns", "alpha_deg,count", "--sample-time", "20ms"]);
    assert!(run.code == Some(0) && run.out.contains("60 samples from 0.00 s to 1.18 s"), "{}{}", run.out, run.err);
}

/// What the flight cannot give is told apart from what cannot be read: scripts go on with the next flight.
#[test]
fn a_flight_that_says_nothing_is_no_bad_input() {
    let folder = Folder::new("says-nothing");
    let rows: String =
        (0..400).map(|k| format!("{},205,0.04,0.04,0,0.4,-9.8,6000,10000,-0.03\n", 0.02 * f64::from(k))).collect();
    let header = "time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,ax_m_s2,az_m_s2,altitude_m,thrust_n,elevator_rad\n";
    std::fs::write(folder.0.join("still.csv"), format!("{header}{rows}")).unwrap();
    let estimate = |file: &str| phugoid(&folder.0, &["estimate", file, "--model", "f16", "--no-report"]);
    let run = estimate("still.csv");
    assert_eq!(run.code, Some(5), "{}{}", run.out, run.err);
    let first: String = rows.lines().take(8).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.0.join("short.csv"), format!("{header}{first}")).unwrap();
    let run = estimate("short.csv");
    assert_eq!(run.code, Some(5), "{}{}", run.out, run.err);
    assert!(run.err.contains("at least 20 are needed"), "{}", run.err);
    assert_eq!(estimate("nowhere.csv").code, Some(3));
}

const DRONE: [&str; 9] =
    ["init", "flight.csv", "--class", "drone", "--mass", "2.1kg", "--wing-area", "0.45m^2", "--wing-span=1.8m"];

/// A log of an autopilot has the command of the elevator; the degrees at full command only a person knows.
#[test]
fn the_travel_of_a_surface_is_asked_for_where_only_its_command_is_recorded() {
    let folder = Folder::new("init-command");
    let row = |k: i32| {
        let t = 0.02 * f64::from(k);
        let command = if (1.0..1.5).contains(&t) { 0.5 } else { 0.0 };
        format!("{t},18,0.05,0.05,{},-9.8,100,{command}\n", 0.1 * (3.0 * t).sin())
    };
    let rows: String = (0..200).map(row).collect();
    let header = "time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,az_m_s2,altitude_m,elevator_command\n";
    folder.file("flight.csv", &format!("{header}{rows}"));
    let run = phugoid(&folder.0, &DRONE);
    assert!(run.fails(3).contains("--elevator-travel: degrees of the elevator at full command"), "{}", run.err);
    let run = phugoid(&folder.0, &[&DRONE[..], &["--elevator-travel", "-20deg", "--out", "mine.toml"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    let text = folder.read("mine.toml");
    assert!(text.contains("elevator = { header = \"elevator_command\", scale = -20, unit = \"deg\" }"), "{text}");
    // The estimation finds the elevator by it.
    let run = phugoid(&folder.0, &["estimate", "flight.csv", "--model", "mine.toml", "--no-report"]);
    assert!(!run.err.contains("is missing") && !run.err.contains("mapping"), "{}", run.err);
}

/// The command that comes next is recommended only where it would not be refused for its units.
#[test]
fn units_are_checked_before_a_model_is_begun() {
    let folder = Folder::new("init-units");
    let rows: String = (0..300)
        .map(|k| {
            let t = 0.05 * f64::from(k);
            format!("{t},18,{},{},0.1,100\n", 4.0 + t.sin(), t.cos())
        })
        .collect();
    let table = |theta: &str| format!("time_s,tas_m_s,{theta},q_deg_s,elevator_deg,altitude\n{rows}");
    folder.file("flight.csv", &table("theta_rad"));
    let run = phugoid(&folder.0, &DRONE);
    assert!(run.fails(3).contains("degrees read as radians") && !run.err.contains("Next:"), "{}", run.err);
    folder.file("flight.csv", &table("theta_deg"));
    let run = phugoid(&folder.0, &[&DRONE[..], &["--altitude", "5000m"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    for part in
        ["Doubtful in the record", "column 'altitude' has no unit", "Said and recorded", "of 5000 m that was said"]
    {
        assert!(run.err.contains(part), "{part}: {}", run.err);
    }
}
