//! What recorders and the programs after them do to a channel: straight lines between slow samples, smoothing forwards and
//! backwards, steps, a gyro that is late. Flights of JSBSim with one channel changed.

use std::path::Path;

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{Estimation, EstimationStatus, ReasonCode};
use phugoid_identification::model_file::ModelFile;

/// A flight of the field (`aircraft/flight`) with one channel changed, by SMPE.
fn with(flight: &str, channel: &str, change: impl Fn(&[f64]) -> Vec<f64>) -> Estimation {
    let field = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field/develop");
    let (aircraft, _) = flight.split_once('/').unwrap();
    let model = ModelFile::open(field.join(aircraft).join("longitudinal.toml")).unwrap();
    let mut record = Record::open(field.join(format!("{flight}.csv"))).unwrap();
    let changed = record.channels.iter_mut().find(|c| c.name == channel).unwrap();
    changed.values = change(&changed.values);
    let options = EstimateOptions { structure: StructureSearch::Never, ..EstimateOptions::default() };
    estimate(&record, &model, &options, &mut |_| ()).unwrap()
}

/// Every `n`th value, and straight lines between them.
fn straight(values: &[f64], n: usize) -> Vec<f64> {
    let at = |row: usize| {
        let (from, to) = (row / n * n, (row / n + 1) * n);
        let next = values.get(to).copied().unwrap_or(values[from]);
        values[from] + (next - values[from]) * (row - from) as f64 / n as f64
    };
    (0..values.len()).map(at).collect()
}

/// CL_elevator of the flight of the `pc7`, by least squares on its exact aerodynamics, per rad.
const CL_ELEVATOR: f64 = 0.258;

/// Taken as measured in every row, such an az has next to no noise and answers late to the elevator: CL_elevator was -0.79, 4.4 of its
/// errors from the truth, in a result without a warning.
#[test]
fn an_accelerometer_on_straight_lines_counts_where_it_was_sampled() {
    for n in [5, 10] {
        let found = with("pc7/light-stick", "az", |values| straight(values, n));
        assert!(found.verdict.iter().any(|s| s.starts_with("Az runs straight between samples")), "{:?}", found.verdict);
        let lift = found.parameter("CL_elevator").unwrap();
        let off = (lift.value - CL_ELEVATOR).abs() / lift.corrected_std_error;
        assert!(off < 2.0, "{n}: {} +- {}", lift.value, lift.corrected_std_error);
    }
}

/// A moving mean of a quarter of a second, four times: nothing comes late, and nothing that is quick is left.
#[test]
fn an_accelerometer_that_was_smoothed_is_in_doubt() {
    let smooth = |values: &[f64]| {
        let mut values = values.to_vec();
        for _ in 0..4 {
            let mean = |row: usize| {
                let around = &values[row.saturating_sub(6)..values.len().min(row + 7)];
                around.iter().sum::<f64>() / around.len() as f64
            };
            values = (0..values.len()).map(mean).collect();
        }
        values
    };
    let found = with("OV10/calm-short", "az", smooth);
    assert_eq!(found.status, EstimationStatus::Doubtful, "{:?}", found.verdict);
    let reason = found.reasons.iter().find(|reason| reason.code == ReasonCode::Channel).unwrap();
    assert_eq!(reason.concerns, ["az"]);
    assert!(with("OV10/calm-short", "az", <[f64]>::to_vec).reasons.is_empty());
}

/// Against it alpha and the elevator seem early by as much, and were blamed for it.
#[test]
fn a_rate_gyro_that_is_late_is_named() {
    let found = with("OV10/calm-short", "q", |q| [&[q[0]; 4], &q[..q.len() - 4]].concat());
    let reason = found.reasons.iter().find(|reason| reason.code == ReasonCode::SensorError).unwrap();
    assert_eq!(reason.concerns, ["q"], "{}", reason.sentence);
    let said = reason.sentence.split_whitespace().find_map(|word| word.parse::<f64>().ok()).unwrap();
    assert!((said - 80.0).abs() < 10.0, "{}", reason.sentence);
}

/// A gyro with steps of half a degree per second stands still until the aircraft moves: its noise was not to be measured, and the flight
/// was refused.
#[test]
fn a_gyro_with_coarse_steps_is_as_good_as_its_steps() {
    let step = 0.5_f64.to_radians();
    let found = with("OV10/calm-short", "q", |q| q.iter().map(|v| (v / step).round() * step).collect());
    assert_eq!(found.status, EstimationStatus::Sound, "{:?}", found.verdict);
    // By least squares on the exact aerodynamics of the flight, per rad.
    let damping = found.parameter("Cm_q").unwrap();
    let level = found.noise.iter().find(|signal| signal.name == "q").unwrap().values[0];
    assert!(
        (damping.value - CM_Q).abs() < 2.0 * damping.corrected_std_error,
        "{} +- {}",
        damping.value,
        damping.corrected_std_error
    );
    assert!(level > 0.3 * step / 12.0_f64.sqrt(), "{level}");
}

/// Cm_q of the flight of the `OV10`, by least squares on its exact aerodynamics, per rad.
const CM_Q: f64 = -30.238;
