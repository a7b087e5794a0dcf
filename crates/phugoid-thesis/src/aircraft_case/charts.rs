//! Figures of an aircraft case.

use std::sync::Arc;

use crate::laws::{Diagnostics, Evaluation, ThesisForm};
use phugoid_flight_data::record::Record;

use super::case::AircraftCase;
use super::judged::Judged;
use super::law::LawForm;
use super::method::{Method, ParameterRun};
use super::reference::Reference;
use crate::result::Behaviour;
use crate::units::FOOT;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_simulation::flight::Flight;

/// Most points of a curve.
const POINTS: usize = 600;

/// States with their names, units as drawn, and factors from SI.
const STATES: [(&str, &str, f64); 4] = [
    ("V", "ft/s", 1.0 / FOOT),
    ("alpha", "deg", 180.0 / std::f64::consts::PI),
    ("theta", "deg", 180.0 / std::f64::consts::PI),
    ("q", "deg/s", 180.0 / std::f64::consts::PI),
];

/// Command, estimates, the aircraft, and the laws from inside.
pub(super) fn charts(case: &AircraftCase, flight: &Flight, reference: &Reference, judged: &[Judged]) -> Vec<Chart> {
    let mut charts = vec![command(case, flight), estimates(case, reference, judged)];
    charts.push(aircraft(case, reference, judged));
    charts.push(tracking(case, reference, judged));
    charts.extend(judged.iter().enumerate().filter_map(|(index, one)| inside(case, reference, judged, index, one)));
    charts
}

/// A line with at most [`POINTS`] points: per part of the record its lowest and highest value, so that no spike is lost.
fn line(label: &str, meaning: Meaning, time: &[f64], values: &[f64]) -> Curve {
    let parts = POINTS / 2;
    let kept: Vec<usize> = if values.len() <= POINTS {
        (0..values.len()).collect()
    } else {
        (0..parts)
            .flat_map(|part| {
                let range = part * values.len() / parts..(part + 1) * values.len() / parts;
                let lowest = range.clone().min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(range.start);
                let highest = range.clone().max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(range.start);
                [lowest.min(highest), lowest.max(highest)]
            })
            .collect()
    };
    Curve {
        label: label.to_owned(),
        meaning,
        x: kept.iter().map(|k| time[*k]).collect::<Arc<[f64]>>(),
        shape: Shape::Line(kept.iter().map(|k| values[*k]).collect()),
    }
}

fn time_axis() -> Axis {
    Axis::new("Time", "s")
}

/// Equal numbers are equal methods throughout the entry.
fn meaning(judged: &[Judged], index: usize) -> Meaning {
    crate::result::meaning_of_method(judged.iter().map(|one| one.outcome.role), index)
}

fn degrees(record: &Record, name: &str) -> Vec<f64> {
    record.channel(name).map(|c| c.values.iter().map(|v| v.to_degrees()).collect()).unwrap_or_default()
}

fn command(case: &AircraftCase, flight: &Flight) -> Chart {
    let trim = flight.trim.elevator_rad.to_degrees();
    let elevator: Vec<f64> = degrees(&flight.truth, "elevator").iter().map(|position| position - trim).collect();
    let mut curve = line("elevator", Meaning::Command, &flight.truth.time, &elevator);
    if let Shape::Line(values) = curve.shape {
        curve.shape = Shape::Step(values);
    }
    Chart {
        name: "command".into(),
        title: format!("{}: command", case.title),
        caption: format!("Elevator from its trim position of {trim:.3} deg, positive trailing edge down."),
        x: time_axis(),
        panels: vec![Panel {
            y: Axis::new("elevator from trim", "deg"),
            content: Content::Curves { curves: vec![curve], levels: Vec::new(), instants: Vec::new() },
        }],
        columns: 1,
    }
}

fn estimates(case: &AircraftCase, reference: &Reference, judged: &[Judged]) -> Chart {
    let found = |one: &Judged, name: &str| -> Option<ParameterRun> {
        one.run.parameters.iter().find(|p| p.name == name).cloned()
    };
    let panels = case.unknowns().into_iter().map(|(name, settings)| {
        let mut curves = Vec::new();
        for (index, one) in judged.iter().enumerate().rev() {
            let Some(parameter) = found(one, name) else { continue };
            let time = &one.run.time_s;
            if let Some(errors) = &parameter.std_errors {
                let edge = |sign: f64| -> Vec<f64> {
                    parameter.values.iter().zip(errors).map(|(v, e)| v + sign * 2.0 * e).collect()
                };
                let kept: Vec<usize> = (0..POINTS).map(|k| k * (time.len() - 1) / (POINTS - 1)).collect();
                let of = |values: Vec<f64>| kept.iter().map(|k| values[*k]).collect();
                curves.push(Curve {
                    label: format!("{}, two sigma", one.settings.name),
                    meaning: meaning(judged, index),
                    x: kept.iter().map(|k| time[*k]).collect(),
                    shape: Shape::Band { lower: of(edge(-1.0)), upper: of(edge(1.0)) },
                });
            }
            curves.push(line(&one.settings.name, meaning(judged, index), time, &parameter.values));
        }
        let margin = 0.15 * (settings.upper - settings.lower);
        let truth = case.truth(name);
        let low = settings.lower.min(truth) - margin;
        let high = settings.upper.max(truth) + margin;
        let mut instants: Vec<Level> =
            reference.input_starts_s.map(|t| Level::new("input starts", t, Meaning::Command)).into_iter().collect();
        instants.extend(case.published.converged_s(name).map(|t| Level::new("published", t, Meaning::Truth)));
        Panel {
            y: Axis::new(name, "1/rad").with_range(low, high),
            content: Content::Curves {
                curves,
                levels: vec![
                    Level::new("truth", truth, Meaning::Truth),
                    Level::new("bounds", settings.lower, Meaning::Bound),
                    Level::new("", settings.upper, Meaning::Bound),
                ],
                instants,
            },
        }
    });
    Chart {
        name: "estimates".into(),
        title: format!("{}: convergence", case.title),
        caption:
            "All methods from the same start value beside the same flight. What leaves the figure has left the bounds. \
                  The laws are told the rates of the states too (true ones where the sensors are perfect, \
                  else what follows from the sensors), the flagship is not."
                .into(),
        x: time_axis(),
        panels: panels.collect(),
        columns: 1,
    }
}

/// Methods whose aircraft is worth drawing.
fn flown(judged: &[Judged]) -> impl Iterator<Item = (usize, &Judged)> {
    judged.iter().enumerate().filter(|(_, one)| one.outcome.behaviour != Behaviour::Diverges)
}

fn aircraft(case: &AircraftCase, reference: &Reference, judged: &[Judged]) -> Chart {
    let panels = STATES.into_iter().enumerate().map(|(i, (name, unit, factor))| {
        let of = |states: &[[f64; 4]]| -> Vec<f64> { states.iter().map(|x| factor * x[i]).collect() };
        let truth = of(&reference.states);
        let (low, high) = truth.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        let margin = 0.1 * (high - low).max(1e-9);
        let mut curves = Vec::new();
        for (index, one) in flown(judged) {
            let label = format!("estimated aircraft, {}", one.settings.name);
            curves.push(line(&label, meaning(judged, index), &one.run.time_s, &of(&one.run.states)));
        }
        // Last, and dashed, so that what lies on it is seen too.
        curves.push(line("reference aircraft", Meaning::Truth, &reference.time, &truth));
        Panel {
            y: Axis::new(name, unit).with_range(low - margin, high + margin),
            content: Content::Curves { curves, levels: Vec::new(), instants: Vec::new() },
        }
    });
    let mut caption =
        "The estimated aircraft flies from the same input with the estimates of each instant and is never \
                       corrected. What runs away is not drawn."
            .to_owned();
    if !case.scenario.gust.is_empty() {
        caption.push_str(
            " It knows of no gust: what the gust does to the reference aircraft, above all to V, stays between the two, \
             however good the estimates.",
        );
    }
    Chart {
        name: "aircraft".into(),
        title: format!("{}: reference and estimated aircraft", case.title),
        caption,
        x: time_axis(),
        panels: panels.collect(),
        columns: 2,
    }
}

fn tracking(case: &AircraftCase, reference: &Reference, judged: &[Judged]) -> Chart {
    let panels = STATES.into_iter().enumerate().map(|(i, (name, unit, factor))| {
        let curves = flown(judged).map(|(index, one)| {
            let error: Vec<f64> =
                one.run.states.iter().zip(&reference.states).map(|(x, y)| factor * (x[i] - y[i])).collect();
            line(&one.settings.name, meaning(judged, index), &one.run.time_s, &error)
        });
        Panel {
            y: Axis::new(format!("error of {name}"), unit),
            content: Content::Curves {
                curves: curves.collect(),
                levels: vec![Level::new("", 0.0, Meaning::Truth)],
                instants: Vec::new(),
            },
        }
    });
    let left = if case.scenario.gust.is_empty() {
        "what the wrong estimates before convergence have left behind."
    } else {
        "what the gust, of which the estimated aircraft knows nothing, and the wrong estimates before convergence have left."
    };
    Chart {
        name: "tracking".into(),
        title: format!("{}: tracking", case.title),
        caption: format!("Estimated minus reference aircraft: {left}"),
        x: time_axis(),
        panels: panels.collect(),
        columns: 2,
    }
}

/// Surface, reaching condition and gain of a law that is solved implicitly: as printed and damped.
///
/// None of a law that runs away: the powers of ten that it passes through hide everything else.
fn inside(case: &AircraftCase, reference: &Reference, judged: &[Judged], index: usize, one: &Judged) -> Option<Chart> {
    if one.outcome.behaviour == Behaviour::Diverges {
        return None;
    }
    let Method::Laws(laws) = &one.settings.method else { return None };
    let name = match laws.first()?.form {
        LawForm::AsPrinted(Evaluation::Implicit) => "law-printed",
        LawForm::Solved(ThesisForm::Damped) => "law-damped",
        _ => return None,
    };
    type Quantity = fn(&Diagnostics) -> f64;
    const QUANTITIES: [(&str, Quantity); 3] =
        [("s", |d| d.surface), ("s s' + eta |s|", |d| d.reaching), ("K", |d| d.gain)];
    let panels = QUANTITIES.into_iter().flat_map(|(label, quantity)| {
        one.run.parameters.iter().filter_map(move |p| {
            let values: Vec<f64> = p.inside.as_ref()?.iter().map(quantity).collect();
            let curve = line(&p.name, meaning(judged, index), &one.run.time_s, &values);
            let starts = reference.input_starts_s.map(|t| Level::new("input starts", t, Meaning::Command));
            Some(Panel {
                y: Axis::new(format!("{label}, {}", p.name), "–"),
                content: Content::Curves {
                    curves: vec![curve],
                    levels: vec![Level::new("", 0.0, Meaning::Bound)],
                    instants: starts.into_iter().collect(),
                },
            })
        })
    });
    Some(Chart {
        name: name.into(),
        title: format!("{}: {} from inside", case.title, one.settings.name),
        caption: "The surface s; the reaching condition s s' <= -eta |s|, which holds where its curve is not above zero; \
                  the gain K = |theta (1/mu - 1) z| - eta that follows from the bounds, mu = sqrt(upper/lower). A law that is \
                  solved at every sample sets s' itself and does not switch: it may converge where the condition does not \
                  hold. Units are those of the law's channels squared."
            .into(),
        x: time_axis(),
        panels: panels.collect(),
        columns: one.run.parameters.len(),
    })
}
