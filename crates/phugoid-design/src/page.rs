//! A design as tables and charts.

use std::sync::Arc;

use super::fit::Fitted;
use super::predict::Prediction;
use super::{Kind, spectrum};
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};

/// The surfaces: amplitudes, rates, what limits them, relative peak factors.
pub fn surfaces(fitted: &Fitted) -> Table {
    let design = &fitted.design;
    let rows = design.inputs.iter().zip(&fitted.limited_by).map(|(input, why)| {
        vec![
            Cell::from(input.surface.name()),
            Cell::from(input.peak().to_degrees()),
            Cell::from(input.peak_rate(1.0 / design.sample_rate_hz).to_degrees()),
            Cell::from(*why),
            Cell::from(input.relative_peak_factor),
            Cell::from(std::f64::consts::TAU / input.mode_rad_s),
            Cell::from(input.pulse_width_s),
            Cell::from(if input.harmonics.is_empty() { f64::NAN } else { input.harmonics.len() as f64 }),
        ]
    });
    Table {
        title: "Surfaces".to_owned(),
        columns: vec![
            Column::new("Surface", ""),
            Column::new("Peak", "deg"),
            Column::new("Rate", "deg/s"),
            Column::new("Limited by", ""),
            Column::new("Relative peak factor", ""),
            Column::new("Period of the mode", "s"),
            Column::new("Pulse", "s"),
            Column::new("Harmonics", ""),
        ],
        rows: rows.collect(),
    }
}

/// The bound of every parameter.
pub fn bounds(prediction: &Prediction) -> Table {
    let rows = prediction.parameters.iter().map(|p| {
        vec![
            Cell::from(p.name.as_str()),
            Cell::from(p.value),
            Cell::from(if p.std_error.is_finite() { p.std_error } else { f64::NAN }),
            Cell::from(p.prior_std),
            Cell::from(if p.std_error.is_finite() { p.percent_of_prior } else { f64::NAN }),
        ]
    });
    Table {
        title: "Predicted Cramer-Rao bound".to_owned(),
        columns: vec![
            Column::new("Parameter", ""),
            Column::new("Value assumed", ""),
            Column::new("Bound, 1σ", ""),
            Column::new("Prior, 1σ", ""),
            Column::new("Bound/prior", "%"),
        ],
        rows: rows.collect(),
    }
}

/// Candidates beside each other, best first.
pub fn ranking(candidates: &[(Kind, Fitted, Prediction)]) -> Table {
    let mut columns = vec![Column::new("Input", ""), Column::new("Score", "% of prior")];
    if let Some((_, _, prediction)) = candidates.first() {
        let mains = prediction.parameters.iter().filter(|p| !p.nuisance);
        columns.extend(mains.map(|p| Column::new(format!("σ({})/prior", p.name), "%")));
    }
    columns.push(Column::new("Worst correlation", ""));
    let rows = candidates.iter().map(|(kind, _, prediction)| {
        let finite = |v: f64| Cell::from(if v.is_finite() { v } else { f64::NAN });
        let mut row = vec![Cell::from(kind.name()), finite(100.0 * prediction.score)];
        row.extend(prediction.parameters.iter().filter(|p| !p.nuisance).map(|p| finite(p.percent_of_prior)));
        row.push(Cell::from(prediction.worst_correlation.as_ref().map_or(f64::NAN, |(_, _, value)| *value)));
        row
    });
    Table { title: "Inputs at equal limits and equal time".to_owned(), rows: rows.collect(), columns }
}

/// Inputs, the flight that they make, and their spectra; then the bound over time.
pub fn charts(fitted: &Fitted, prediction: Option<&Prediction>) -> Vec<Chart> {
    let mut charts = vec![histories(fitted), spectra(fitted)];
    charts.extend(prediction.map(bound_over_time));
    charts
}

fn line(label: &str, meaning: Meaning, x: &Arc<[f64]>, y: Vec<f64>) -> Curve {
    Curve { label: label.to_owned(), meaning, x: Arc::clone(x), shape: Shape::Line(y) }
}

fn panel(label: &str, unit: &str, curves: Vec<Curve>) -> Panel {
    Panel { y: Axis::new(label, unit), content: Content::Curves { curves, levels: Vec::new(), instants: Vec::new() } }
}

fn histories(fitted: &Fitted) -> Chart {
    let x: Arc<[f64]> = fitted.design.time_s.clone().into();
    let mut panels: Vec<Panel> = Vec::new();
    for input in &fitted.design.inputs {
        let degrees = input.deflection.iter().map(|d| d.to_degrees()).collect();
        let curve = Curve {
            label: "deflection from trim".to_owned(),
            meaning: Meaning::Command,
            x: Arc::clone(&x),
            shape: Shape::Step(degrees),
        };
        panels.push(panel(input.surface.name(), "deg", vec![curve]));
    }
    let truth = &fitted.flight.truth;
    let flown: Arc<[f64]> = truth.time.clone().into();
    let degrees = 1_f64.to_degrees();
    let responses = [
        ("alpha", "angle of attack", "deg", degrees),
        ("q", "pitch rate", "deg/s", degrees),
        ("az", "load factor from trim", "g", -1.0 / 9.80665),
        ("beta", "sideslip", "deg", degrees),
        ("phi", "bank", "deg", degrees),
        ("p", "roll rate", "deg/s", degrees),
        ("r", "yaw rate", "deg/s", degrees),
    ];
    for (name, label, unit, scale) in responses {
        let Some(channel) = truth.channel(name) else { continue };
        let first = channel.values.first().copied().unwrap_or(0.0);
        let zero = if name == "az" { first } else { 0.0 };
        if channel.values.iter().all(|v| (v - first).abs() < 1e-9) {
            continue;
        }
        let values = channel.values.iter().map(|v| scale * (v - zero)).collect();
        panels.push(panel(label, unit, vec![line("simulated response", Meaning::Flagship, &flown, values)]));
    }
    Chart {
        name: "input".to_owned(),
        title: "Input and the motion that it makes".to_owned(),
        caption: "Deflections from trim, and the simulated flight that the amplitudes were fitted to.".to_owned(),
        x: Axis::new("Time", "s"),
        columns: if panels.len() > 5 { 2 } else { 1 },
        panels,
    }
}

fn spectra(fitted: &Fitted) -> Chart {
    const POINTS: usize = 400;
    let design = &fitted.design;
    let slowest = design.inputs.iter().map(|i| i.mode_rad_s).fold(f64::INFINITY, f64::min);
    let fastest = design.inputs.iter().map(|i| i.mode_rad_s).fold(0.0, f64::max);
    let highest = design.band_hz.map_or(4.0 * fastest / std::f64::consts::TAU, |band| 1.3 * band[1]);
    let lowest = 0.02 * slowest / std::f64::consts::TAU;
    let frequencies: Vec<f64> =
        (0..POINTS).map(|k| lowest + (highest - lowest) * k as f64 / (POINTS - 1) as f64).collect();
    let x: Arc<[f64]> = frequencies.clone().into();
    let panels = design.inputs.iter().map(|input| {
        let degrees: Vec<f64> = input.deflection.iter().map(|d| d.to_degrees()).collect();
        let energy = spectrum(&degrees, 1.0 / design.sample_rate_hz, &frequencies);
        let mode = Level::new("its mode", input.mode_rad_s / std::f64::consts::TAU, Meaning::Bound);
        Panel {
            y: Axis::new(format!("{}: energy density", input.surface.name()), "deg² s/Hz"),
            content: Content::Curves {
                curves: vec![line("input", Meaning::Command, &x, energy)],
                levels: Vec::new(),
                instants: vec![mode],
            },
        }
    });
    Chart {
        name: "spectrum".to_owned(),
        title: "Where the energy of the input lies".to_owned(),
        caption: "Energy spectral density of each surface, and the frequency of the mode that it moves most."
            .to_owned(),
        x: Axis::new("Frequency", "Hz"),
        panels: panels.collect(),
        columns: 1,
    }
}

fn bound_over_time(prediction: &Prediction) -> Chart {
    let x: Arc<[f64]> = prediction.time_s.clone().into();
    let mains = prediction.parameters.iter().filter(|p| !p.nuisance);
    let panels = mains.map(|p| {
        let percent: Vec<f64> = p.history.iter().map(|sigma| 100.0 * sigma / p.prior_std).collect();
        let end = percent.last().copied().filter(|v| v.is_finite()).unwrap_or(100.0);
        let top = (8.0 * end).clamp(1e-6, 120.0);
        let content = Content::Curves {
            curves: vec![line("smallest possible standard error", Meaning::Bound, &x, percent)],
            levels: Vec::new(),
            instants: Vec::new(),
        };
        Panel { y: Axis::new(p.name.clone(), "% of prior").with_range(0.0, top), content }
    });
    let panels: Vec<Panel> = panels.collect();
    Chart {
        name: "bound".to_owned(),
        title: "What the flight will have told by then".to_owned(),
        caption: "Predicted Cramer-Rao bound of each parameter against time, in percent of what is known beforehand."
            .to_owned(),
        x: Axis::new("Time", "s"),
        columns: if panels.len() > 3 { 2 } else { 1 },
        panels,
    }
}
