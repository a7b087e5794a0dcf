//! The gust of figure 2.2, and what the aircraft does in it.

use std::f64::consts::PI;
use std::sync::Arc;

use phugoid_flight_data::record::Record;
use phugoid_flight_dynamics::gust::Gust;

use crate::entry::Entry;
use crate::flight_charts::{instant, motion};
use crate::result::Reproduction;
use crate::result::Requirement;
use crate::units::FOOT;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::{GustSettings, built_in};

/// Entries of this file.
pub(crate) const ENTRIES: &[Entry] =
    &[Entry { id: "gust/figure-2.2", title: "A smooth gust and the aircraft's answer to it", run }];

/// Built-in scenario of the figure.
const SCENARIO: &str = "f16-thesis-gust";

fn run(id: &str, _progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let unsuitable = |what: &str| StudyError::Unsuitable(format!("`{SCENARIO}`: {what}"));
    let scenario = built_in(SCENARIO)
        .ok_or_else(|| unsuitable("no such scenario"))?
        .map_err(|error| StudyError::Flight(error.into()))?;
    let settings = scenario.gust.first().ok_or_else(|| unsuitable("no gust"))?;
    let gust = gust(settings);
    let flight = fly(&scenario)?;
    let [start, end] = [gust.delay, gust.delay + gust.duration];
    let instants = [instant("gust begins", start), instant("gust is full", end)];
    Ok(Reproduction {
        id: id.to_owned(),
        title: ENTRIES[0].title.to_owned(),
        place: "equation 2.32 and figure 2.2".to_owned(),
        published: "A gust on any body axis: after a delay Td, U(t) = Um/2 [1 - cos(pi t/Ud)] up to Ud, then Um. The figure has \
                    Um = 20 ft/s, Ud = 6 s, Td = 2 s along x."
            .to_owned(),
        reconstruction: "Nothing of the gust. The thesis draws no answer of the aircraft: ours starts in the trim of table 2.2 \
                         with the stick and the thrust as they were. The axis of the gust stays with the aircraft's body, \
                         as in the equation; the tables see the motion relative to the moving air."
            .to_owned(),
        difference: "None in the gust. The aircraft loses airspeed to the tail wind, sinks and picks up speed again in a \
                     phugoid, far slower than the gust."
            .to_owned(),
        requirements: requirements(&gust),
        tables: vec![answer(&flight)],
        charts: vec![
            profile(&gust, &flight.truth.time),
            motion(
                "The aircraft in the gust",
                "Stick and thrust as trimmed. Airspeed and angle of attack are relative to the moving air, as a probe has them.",
                &flight.truth,
                None,
                &instants,
            ),
        ],
        golden: golden(&gust, &flight.truth),
        ..Reproduction::default()
    })
}

/// The gust in SI.
fn gust(settings: &GustSettings) -> Gust {
    Gust {
        axis: settings.axis,
        amplitude: settings.amplitude.si(),
        duration: settings.duration.si(),
        delay: settings.start.si(),
    }
}

/// Velocity of the air along the gust's axis, m/s.
fn along(gust: &Gust, time: f64) -> f64 {
    gust.velocity(time).iter().sum()
}

fn requirements(gust: &Gust) -> Vec<Requirement> {
    let Gust { amplitude, duration, delay, .. } = *gust;
    let middle = along(gust, delay + 0.5 * duration) / amplitude;
    // The acceleration of the air just after the start: pi^2 Um t / (2 Ud^2) by the equation, where a ramp has Um / Ud.
    let moment = 1e-3;
    let slope = (along(gust, delay + moment) - along(gust, delay)) / moment / (amplitude / duration);
    let expected = PI * PI * moment / (4.0 * duration);
    let late = (0..1000).map(|k| along(gust, delay + duration + 0.1 * f64::from(k)));
    let wander = late.fold(0.0, |m: f64, u| m.max((u / amplitude - 1.0).abs()));
    let early = (0..100).map(|k| along(gust, delay * f64::from(k) / 100.0)).fold(0.0, |m: f64, u| m.max(u.abs()));
    vec![
        Requirement {
            what: "half the velocity half way up, at Td + Ud/2".into(),
            limit: "0.5 Um, to rounding".into(),
            found: format!("{middle:.12} Um"),
            met: (middle - 0.5).abs() < 1e-12,
        },
        Requirement {
            what: "still air before Td".into(),
            limit: "0".into(),
            found: format!("{early} m/s"),
            met: early == 0.0,
        },
        Requirement {
            what: "smooth start: mean slope of the first millisecond".into(),
            limit: format!("{expected:.2e} of a ramp's, to 1 %"),
            found: format!("{slope:.2e} of a ramp's"),
            met: (slope / expected - 1.0).abs() < 0.01,
        },
        Requirement {
            what: "stays at Um after Td + Ud, for 100 s".into(),
            limit: "Um".into(),
            found: format!("at most {wander:.0} Um away"),
            met: wander < 1e-12,
        },
    ]
}

fn profile(gust: &Gust, time: &[f64]) -> Chart {
    let feet = |u: f64| u / FOOT;
    let marked = [gust.delay, gust.delay + 0.5 * gust.duration, gust.delay + gust.duration];
    let x: Arc<[f64]> = time.iter().copied().filter(|t| *t <= 2.0 * (gust.delay + gust.duration)).collect();
    let values = x.iter().map(|t| feet(along(gust, *t))).collect();
    let points = marked.iter().map(|t| feet(along(gust, *t))).collect();
    let curves = vec![
        Curve { label: "equation 2.32".into(), meaning: Meaning::Truth, x, shape: Shape::Line(values) },
        Curve {
            label: "Td, Td + Ud/2, Td + Ud".into(),
            meaning: Meaning::Command,
            x: marked.into(),
            shape: Shape::Points(points),
        },
    ];
    let level = |label: &str, at: f64| Level::new(label, feet(at), Meaning::Bound);
    let levels = vec![level("Um/2", 0.5 * gust.amplitude), level("Um", gust.amplitude)];
    Chart {
        name: "gust".into(),
        title: "Figure 2.2: velocity of the air along the body x axis".into(),
        caption: "It starts without a step or a kink, is half way up half way through, and stays.".into(),
        x: Axis::new("Time", "s"),
        panels: vec![Panel {
            y: Axis::new("Gust velocity", "ft/s").with_range(feet(-0.05 * gust.amplitude), feet(1.1 * gust.amplitude)),
            content: Content::Curves { curves, levels, instants: Vec::new() },
        }],
        columns: 1,
    }
}

fn values<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    record.channel(name).map(|c| c.values.as_slice()).unwrap_or_default()
}

/// Where each quantity goes furthest from the trim.
fn answer(flight: &Flight) -> Table {
    let degrees = 1.0_f64.to_degrees();
    let quantities = [
        ("airspeed", "true_airspeed", "ft/s", 1.0 / FOOT),
        ("angle of attack", "alpha", "deg", degrees),
        ("pitch angle", "theta", "deg", degrees),
        ("pitch rate", "q", "deg/s", degrees),
        ("altitude", "altitude", "ft", 1.0 / FOOT),
    ];
    let rows = quantities.into_iter().filter_map(|(name, channel, unit, factor)| {
        let values = values(&flight.truth, channel);
        let trim = *values.first()?;
        let furthest = values.iter().enumerate().max_by(|a, b| (a.1 - trim).abs().total_cmp(&(b.1 - trim).abs()));
        let (k, value) = furthest?;
        let at = flight.truth.time.get(k).copied();
        Some(vec![name.into(), unit.into(), (factor * trim).into(), (factor * (value - trim)).into(), at.into()])
    });
    Table {
        title: "The aircraft's answer, stick and thrust fixed".into(),
        columns: vec![
            Column::new("quantity", ""),
            Column::new("unit", ""),
            Column::new("in trim", ""),
            Column::new("largest change", ""),
            Column::new("at", "s"),
        ],
        rows: rows.collect(),
    }
}

/// Every 75th sample: forty-one instants of the 30 s.
fn golden(gust: &Gust, truth: &Record) -> Table {
    let channels = ["true_airspeed", "alpha", "theta", "q"];
    let rows = truth.time.iter().enumerate().step_by(75).map(|(k, t)| {
        let gust = [*t, along(gust, *t)].into_iter();
        let motion = channels.iter().map(|name| values(truth, name).get(k).copied().unwrap_or(f64::NAN));
        gust.chain(motion).map(Cell::from).collect()
    });
    let columns =
        [("time", "s"), ("gust", "m/s"), ("true_airspeed", "m/s"), ("alpha", "rad"), ("theta", "rad"), ("q", "rad/s")];
    Table {
        title: "gust".into(),
        columns: columns.map(|(name, unit)| Column::new(name, unit)).to_vec(),
        rows: rows.collect(),
    }
}
