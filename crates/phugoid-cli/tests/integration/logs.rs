//! Logs of autopilots, as a user gives them to the commands.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::common;

use common::{Folder, phugoid, shared_file};

#[test]
fn a_log_that_cannot_give_derivatives_is_refused_with_what_is_missing_and_what_to_do() {
    let Some(path) = shared_file("logs/sample_log_small.ulg") else { return };
    let folder = Folder::new("log-refused");
    let run = phugoid(&folder.0, &["estimate", path.to_str().unwrap(), "--model", "f16"]);
    let told = run.fails(3);
    for part in [
        "channel `elevator` is missing; the model also needs `alpha`",
        "VTOL aircraft",
        "alpha: not in the log (looked for airflow_aoa.aoa_rad)",
        "elevator = { header = \"actuator_controls_0.control[1]\", scale = DEFLECTION, unit = \"deg\" }",
        "Channels in the record: true_airspeed",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn a_multirotor_is_said_to_be_one() {
    let Some(path) = shared_file("logs/log171.bin") else { return };
    let folder = Folder::new("log-multirotor");
    let run = phugoid(&folder.0, &["monitor", path.to_str().unwrap(), "--model", "f16-health-model"]);
    let told = run.fails(3);
    assert!(told.contains("a multirotor ('APM:Copter V3.3-dev (ae3192b8)')"), "{told}");
    assert!(told.contains("true_airspeed: not in the log (looked for ARSP.Airspeed with CTUN.E2T)"), "{told}");
}

#[test]
fn a_cut_log_is_named_and_a_text_with_its_name_is_read_as_text() {
    let folder = Folder::new("log-cut");
    std::fs::write(folder.0.join("cut.csv"), b"ULog\x01\x12\x35\x01").unwrap();
    let run = phugoid(&folder.0, &["estimate", "cut.csv", "--model", "f16"]);
    assert!(
        run.fails(3).contains("cut.csv: this is no ULog: the file ends within its head of 16 bytes"),
        "{}",
        run.err
    );
}
