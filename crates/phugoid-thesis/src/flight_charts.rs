//! Figures of a flight: what was commanded, and what the aircraft did.

use std::sync::Arc;

use phugoid_flight_data::record::Record;

use crate::units::{FOOT, STANDARD_GRAVITY};
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};

/// A channel as it is drawn: name in the record, label, unit, and the factor from SI to that unit.
pub(super) struct Drawn {
    channel: &'static str,
    label: &'static str,
    unit: &'static str,
    factor: f64,
}

const DEGREE: f64 = 180.0 / std::f64::consts::PI;

/// Elevator.
pub(super) const ELEVATOR: Drawn = Drawn { channel: "elevator", label: "Elevator", unit: "deg", factor: DEGREE };
/// Longitudinal motion, as the thesis draws it, and the specific force that a passenger feels.
pub(super) const MOTION: [Drawn; 6] = [
    Drawn { channel: "true_airspeed", label: "True airspeed", unit: "ft/s", factor: 1.0 / FOOT },
    Drawn { channel: "alpha", label: "Angle of attack", unit: "deg", factor: DEGREE },
    Drawn { channel: "theta", label: "Pitch angle", unit: "deg", factor: DEGREE },
    Drawn { channel: "q", label: "Pitch rate", unit: "deg/s", factor: DEGREE },
    Drawn { channel: "altitude", label: "Altitude", unit: "ft", factor: 1.0 / FOOT },
    Drawn { channel: "az", label: "Load factor (−az)", unit: "g", factor: -1.0 / STANDARD_GRAVITY },
];

/// Commands and motion over time: the truth, and what the sensors made of it where `measured` is given.
pub(super) fn motion(title: &str, caption: &str, truth: &Record, measured: Option<&Record>, at: &[Level]) -> Chart {
    let time: Arc<[f64]> = truth.time.as_slice().into();
    let panels = std::iter::once(&ELEVATOR).chain(&MOTION).filter_map(|drawn| {
        let values = |record: &Record| Some(scaled(&record.channel(drawn.channel)?.values, drawn.factor));
        let is_command = drawn.channel == ELEVATOR.channel;
        let mut curves = Vec::new();
        if let Some(noisy) = measured.and_then(values).filter(|_| !is_command) {
            let shape = Shape::Points(noisy);
            curves.push(Curve { label: "measured".into(), meaning: Meaning::Measured, x: time.clone(), shape });
        }
        let values = values(truth)?;
        let (label, meaning, shape) = match is_command {
            true => ("elevator", Meaning::Command, Shape::Step(values)),
            false => ("aircraft", Meaning::Truth, Shape::Line(values)),
        };
        curves.push(Curve { label: label.into(), meaning, x: time.clone(), shape });
        let content = Content::Curves { curves, levels: Vec::new(), instants: at.to_vec() };
        Some(Panel { y: Axis::new(drawn.label, drawn.unit), content })
    });
    Chart {
        name: "motion".into(),
        title: title.into(),
        caption: caption.into(),
        x: Axis::new("Time", "s"),
        panels: panels.collect(),
        columns: 2,
    }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|v| factor * v).collect()
}

/// A vertical line.
pub(super) fn instant(label: &str, at: f64) -> Level {
    Level::new(label, at, Meaning::Bound)
}
