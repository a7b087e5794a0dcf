//! The sliding surfaces: against time with the phase, and against the parameter's error.

use std::sync::Arc;

use super::{Context, scaled};
use crate::figure::{At, Axis, Body, Colour, Figure, Kind, Panel, Reference, Series};

const PER_FIGURE: usize = 8;

/// Phases in drawing order, so that a single rejected sample stays visible between thousands of sliding ones.
const PHASES: [(&str, Colour); 5] = [
    ("sliding", Colour::Green),
    ("starting", Colour::Sky),
    ("predicting", Colour::Purple),
    ("reaching", Colour::Orange),
    ("rejected", Colour::Vermillion),
];

pub(super) fn figures(context: &Context) -> Vec<(String, Figure)> {
    let mut panels: Vec<Panel> = Vec::new();
    for (parameter, history, unit) in context.parameters(false).into_iter().chain(context.parameters(true)) {
        if !says_something(&history.surface) {
            continue;
        }
        let axis = Axis::new(format!("Surface of {}", parameter.name), unit.text.clone());
        let surface = scaled(&history.surface, &unit);
        let axis = match robust_range(&surface) {
            Some([low, high]) => axis.with_range(low, high),
            None => axis,
        };
        let line = Series::new(
            "surface: least-squares estimate minus estimate",
            Colour::Blue,
            &context.time,
            Kind::Line(surface),
        );
        panels.push(Panel::plot(axis, vec![line]).with_height(84.0).with_reference(zero()));
    }
    let strip = phase_strip(context);
    if panels.is_empty() && strip.is_none() {
        return Vec::new();
    }
    let groups = panels.len().div_ceil(PER_FIGURE).max(1);
    (0..groups)
        .map(|index| {
            let title = match groups {
                1 => "Phase and surfaces".to_owned(),
                _ => format!("Phase and surfaces, {} of {groups}", index + 1),
            };
            let mut figure = context.figure(
                &title,
                "The bar shows the phase of each sample: sliding (the model explains it), reaching (influence \
                 bounded), rejected (nothing within the bounds explains it). A surface near zero means that the \
                 estimate is where least squares would put it.",
            );
            figure.panels.extend(strip.clone());
            figure.panels.extend(panels.iter().skip(index * PER_FIGURE).take(PER_FIGURE).cloned());
            (format!("surfaces-{}", index + 1), figure)
        })
        .collect()
}

/// Surface against the error of the estimate, one panel per parameter.
pub(super) fn portraits(context: &Context) -> Option<(String, Figure)> {
    let mut figure = context.figure(
        "Phase portraits",
        "Each parameter's surface against its error (estimate minus truth where known, else minus the final estimate). \
         On the dashed line the surface equals the remaining error: there the information at hand knows the answer. \
         The dot is the end.",
    );
    figure.columns = 3;
    figure.events.clear();
    for (parameter, history, unit) in context.parameters(false) {
        if !says_something(&history.surface) {
            continue;
        }
        let (target, words) = match parameter.truth {
            Some(truth) => (truth, "truth"),
            None => (parameter.value, "final estimate"),
        };
        let error: Arc<[f64]> = history.value.iter().map(|v| (v - target) * unit.factor).collect();
        let surface = scaled(&history.surface, &unit);
        let y = Axis::new(format!("Surface of {}", parameter.name), unit.text.clone());
        let y = match robust_range(&surface) {
            Some([low, high]) => y.with_range(low, high),
            None => y,
        };
        let x = Axis::new(format!("{} − {words}", parameter.name), unit.text.clone());
        let x = match robust_range(&error) {
            Some([low, high]) => x.with_range(low, high),
            None => x,
        };
        let mut series = Vec::new();
        if let Some([low, high]) = x.range {
            let line: Arc<[f64]> = Arc::from([low, high]);
            series.push(Series::new("surface = −error", Colour::Muted, &line, Kind::Dashed(vec![-low, -high])));
        }
        series.push(Series::new("course of the estimation", Colour::Blue, &error, Kind::Trajectory(surface)));
        let panel = Panel::plot(y, series).with_x(x).with_height(190.0);
        let vertical = Reference { at: At::Vertical(0.0), ..zero() };
        figure.panels.push(panel.with_reference(zero()).with_reference(vertical));
    }
    (!figure.panels.is_empty()).then(|| ("phase-portraits".to_owned(), figure))
}

fn phase_strip(context: &Context) -> Option<Panel> {
    let phase = &context.estimation.history.phase;
    let mut states: Vec<(String, Colour)> = PHASES.iter().map(|(name, c)| ((*name).to_owned(), *c)).collect();
    let mut state = Vec::with_capacity(phase.len());
    for name in phase {
        let index = states.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            states.push((name.clone(), Colour::Muted));
            states.len() - 1
        });
        state.push(index);
    }
    let body = Body::Strip { x: Arc::clone(&context.time), state, states };
    (!phase.is_empty()).then(|| Panel { y: Axis::new("Phase", ""), x: None, height: 18.0, body })
}

fn zero() -> Reference {
    Reference { label: String::new(), colour: Colour::Muted, dashed: false, at: At::HorizontalIfVisible(0.0) }
}

fn says_something(surface: &[f64]) -> bool {
    surface.iter().any(|s| s.is_finite() && *s != 0.0)
}

/// Limits with all values and zero; without the wildest 2 % if those would take more than two thirds of the height.
fn robust_range(values: &[f64]) -> Option<[f64; 2]> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let within = |share: f64| {
        let low = sorted[(share * last as f64).floor() as usize].min(0.0);
        let high = sorted[((1.0 - share) * last as f64).ceil() as usize].max(0.0);
        [low, high]
    };
    let (all, most) = (within(0.0), within(0.01));
    let span = |[low, high]: [f64; 2]| high - low;
    let [low, high] = if span(all) <= 3.0 * span(most) { all } else { most };
    let pad = 0.08 * (high - low);
    (pad > 0.0).then_some([low - pad, high + pad])
}
