//! From an autopilot's log of a fixed-wing flight to derivatives, as a user goes: inspect, map the elevator, estimate. The log is
//! a simulated flight in PX4's topics, because the logs at hand are of multirotors.
#![allow(clippy::unwrap_used)] // tests may

use crate::common;

use common::{Folder, phugoid};
use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;

const TRUTH: [(&str, f64); 4] = [("dCm_alpha", -0.2), ("dCm_q", -2.0), ("dCL_alpha", 0.4), ("dCD_alpha", 0.1)];
/// Deflection at full command, deg: up, so that pulling is positive.
const FULL_COMMAND_DEG: f64 = -25.0;

/// A channel's value at one sample, by name.
type Values<'a> = dyn Fn(&str) -> f64 + 'a;

/// What moves the aircraft: the surface, and PX4's type of each servo (`CA_SV_CSi_TYPE`).
#[derive(Clone, Copy, PartialEq)]
enum Surfaces {
    /// An elevator, type 3, on the second servo.
    Plain,
    /// A left and a right elevon, types 5 and 6, which roll besides.
    Elevons,
}

impl Surfaces {
    fn types(self) -> &'static [(usize, i32)] {
        match self {
            Self::Plain => &[(1, 3)],
            Self::Elevons => &[(0, 5), (1, 6)],
        }
    }

    /// The commands that hold this elevator, deg.
    fn control(self, elevator_deg: f64, time_s: f64) -> [f64; 8] {
        let mut control = [f64::NAN; 8];
        let pitch = elevator_deg / FULL_COMMAND_DEG;
        // Much more than the elevator does, and nothing that the motion shows: it has to drop out.
        let roll = 0.2 * (1.3 * time_s).sin();
        match self {
            Self::Plain => control[1] = pitch,
            Self::Elevons => (control[0], control[1]) = (pitch - roll, pitch + roll),
        }
        control
    }
}

/// What PX4 writes (docs.px4.io, ULog file format): each topic with the fields that are made of a record's channels.
struct Topic {
    name: &'static str,
    format: &'static str,
    /// Written at every so many samples.
    every: usize,
    payload: fn(&Values) -> Vec<u8>,
}

fn floats(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect()
}

/// Rotation from north-east-down to body axes, scalar first.
fn quaternion(at: &Values) -> Vec<u8> {
    let [(sp, cp), (st, ct), (sy, cy)] = ["phi", "theta", "psi"].map(|name| (0.5 * at(name)).sin_cos());
    let (w, x) = (cp * ct * cy + sp * st * sy, sp * ct * cy - cp * st * sy);
    floats(&[w, x, cp * st * cy + sp * ct * sy, cp * ct * sy - sp * st * cy])
}

const TOPICS: [Topic; 7] = [
    Topic {
        name: "vehicle_angular_velocity",
        format: "float[3] xyz;",
        every: 1,
        payload: |at| floats(&[at("p"), at("q"), at("r")]),
    },
    Topic {
        name: "vehicle_acceleration",
        format: "float[3] xyz;",
        every: 1,
        payload: |at| floats(&[at("ax"), at("ay"), at("az")]),
    },
    Topic { name: "vehicle_attitude", format: "float[4] q;", every: 1, payload: quaternion },
    Topic {
        name: "airspeed_validated",
        format: "float true_airspeed_m_s;",
        every: 1,
        payload: |at| floats(&[at("true_airspeed")]),
    },
    Topic { name: "airflow_aoa", format: "float aoa_rad;", every: 1, payload: |at| floats(&[at("alpha")]) },
    Topic {
        name: "vehicle_global_position",
        format: "double lat;double lon;float alt;",
        every: 20,
        payload: |at| [&[0; 16][..], &floats(&[at("altitude")])].concat(),
    },
    Topic {
        name: "actuator_servos",
        format: "float[8] control;",
        every: 1,
        // Another payload for elevons.
        payload: |at| floats(&Surfaces::Plain.control(at("elevator").to_degrees(), 0.0)),
    },
];

fn message(kind: u8, payload: &[u8]) -> Vec<u8> {
    [&u16::try_from(payload.len()).unwrap().to_le_bytes()[..], &[kind], payload].concat()
}

fn ulog(record: &Record, surfaces: Surfaces) -> Vec<u8> {
    const START_US: u64 = 12_345_678;
    let mut log = b"ULog\x01\x12\x35\x01".to_vec();
    log.extend(START_US.to_le_bytes());
    log.extend(message(b'B', &[0; 40]));
    for topic in &TOPICS {
        log.extend(message(b'F', format!("{}:uint64_t timestamp;{}", topic.name, topic.format).as_bytes()));
    }
    for (servo, kind) in surfaces.types() {
        let parameter = format!("int32_t CA_SV_CS{servo}_TYPE");
        let payload = [&[parameter.len() as u8], parameter.as_bytes(), &kind.to_le_bytes()].concat();
        log.extend(message(b'P', &payload));
    }
    for (id, topic) in TOPICS.iter().enumerate() {
        log.extend(message(b'A', &[&[0, id as u8, 0], topic.name.as_bytes()].concat()));
    }
    for k in 0..record.time.len() {
        let at = |name: &str| record.channel(name).map_or(f64::NAN, |channel| channel.values[k]);
        let stamp = START_US + (record.time[k] * 1e6).round() as u64;
        for (id, topic) in TOPICS.iter().enumerate().filter(|(_, topic)| k % topic.every == 0) {
            let payload = match (surfaces, topic.name) {
                (Surfaces::Elevons, "actuator_servos") => {
                    floats(&surfaces.control(at("elevator").to_degrees(), record.time[k]))
                }
                _ => (topic.payload)(&at),
            };
            log.extend(message(b'D', &[&[id as u8, 0], &stamp.to_le_bytes()[..], &payload].concat()));
        }
    }
    log
}

#[test]
fn a_log_of_a_fixed_wing_flight_gives_its_derivatives() {
    let folder = Folder::new("px4");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let record = csv::read_path(&folder.0.join("measured.csv"), &CsvOptions::default()).unwrap();
    // The name says nothing: the content does.
    std::fs::write(folder.0.join("flight.log"), ulog(&record, Surfaces::Plain)).unwrap();

    // Without the elevator's angle there is no estimate, but the lines that are missing in the model file.
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    folder.file("mine.toml", &model);
    let run = phugoid(&folder.0, &["estimate", "flight.log", "--model", "mine.toml", "--no-report"]);
    let told = run.fails(3);
    assert!(told.contains("elevator_command") && told.contains("[channels]"), "{told}");

    let seen = phugoid(&folder.0, &["inspect", "flight.log"]);
    assert_eq!(seen.code, Some(0), "{}", seen.err);
    assert!(seen.out.contains("vehicle_angular_velocity") && seen.out.contains("CA_SV_CS1_TYPE"), "{}", seen.out);

    let mapping = format!(
        "\n[channels]\nelevator = {{ header = \"elevator_command\", scale = {FULL_COMMAND_DEG}, unit = \"deg\" }}\n"
    );
    folder.file("mine.toml", &(model + &mapping));
    let command = ["estimate", "flight.log", "--model", "mine.toml", "--no-report", "--json"];
    let from_log = phugoid(&folder.0, &command).json();
    let from_csv =
        phugoid(&folder.0, &["estimate", "measured.csv", "--model", "f16-model", "--no-report", "--json"]).json();
    for (name, truth) in TRUTH {
        let number = |document: &serde_json::Value, key: &str| {
            let found = document["parameters"].as_array().into_iter().flatten().find(|p| p["name"] == name);
            found.and_then(|p| p[key].as_f64()).unwrap_or(f64::NAN)
        };
        let (value, sigma) = (number(&from_log, "value"), number(&from_log, "corrected_std_error"));
        // One fixed seed; a right estimator is outside four sigmas in 1 of 16,000 cases.
        assert!((value - truth).abs() < 4.0 * sigma, "{name}: {value} +- {sigma}");
        // The same samples but for single precision and an altitude five times a second: far below the noise.
        assert!((value - number(&from_csv, "value")).abs() < 0.1 * sigma, "{name}: {value}, from CSV {from_csv}");
    }
}

#[test]
fn elevons_give_the_estimates_of_the_elevator_that_they_make() {
    let folder = Folder::new("px4-elevons");
    assert_eq!(phugoid(&folder.0, &["simulate", "f16-calm", "--out", "."]).code, Some(0));
    let record = csv::read_path(&folder.0.join("measured.csv"), &CsvOptions::default()).unwrap();
    std::fs::write(folder.0.join("plain.ulg"), ulog(&record, Surfaces::Plain)).unwrap();
    std::fs::write(folder.0.join("elevons.ulg"), ulog(&record, Surfaces::Elevons)).unwrap();
    let model = phugoid(&folder.0, &["estimate", "--show-model", "f16-model"]).out;
    let mapped = |name: &str, elevator: &str| {
        folder.file(name, &format!("{model}\n[channels]\nelevator = {{ {elevator}, unit = \"deg\" }}\n"));
    };
    mapped("command.toml", &format!("header = \"elevator_command\", scale = {FULL_COMMAND_DEG}"));
    let half = 0.5 * FULL_COMMAND_DEG;
    mapped("sum.toml", &format!("sum = {{ left_elevon_command = {half}, right_elevon_command = {half} }}"));
    mapped(
        "fields.toml",
        &format!("sum = {{ \"actuator_servos.control[0]\" = {half}, \"actuator_servos.control[1]\" = {half} }}"),
    );
    let values = |log: &str, model: &str| -> Vec<(f64, f64)> {
        let result = phugoid(&folder.0, &["estimate", log, "--model", model, "--no-report", "--json"]).json();
        let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
        let parameters = result["parameters"].as_array().unwrap();
        parameters.iter().map(|p| (number(&p["value"]), number(&p["corrected_std_error"]))).collect()
    };
    let plain = values("plain.ulg", "command.toml");
    for model in ["command.toml", "sum.toml", "fields.toml"] {
        let elevons = values("elevons.ulg", model);
        assert_eq!(elevons.len(), plain.len());
        for ((value, _), (expected, sigma)) in elevons.iter().zip(&plain) {
            // Half the sum of two numbers in single precision, of the size of 0.2: a millionth of a degree.
            assert!((value - expected).abs() < 1e-3 * sigma, "{model}: {value} {expected} +- {sigma}");
        }
    }
    let wrong = format!("{model}\n[channels]\nelevator = {{ sum = {{ left_elevon_command = 0 }} }}\n");
    folder.file("wrong.toml", &wrong);
    let run = phugoid(&folder.0, &["estimate", "elevons.ulg", "--model", "wrong.toml", "--no-report"]);
    assert!(run.fails(3).contains("the factor is zero"), "{}", run.err);
}
