//! The sliding surfaces against time, with the phase of each sample.

use phugoid_identification::estimation::Phase;
use std::sync::Arc;

use super::context::Context;
use crate::figure::{At, Axis, Body, Colour, Figure, Panel, Reference, Series, SeriesKind, Stroke};

/// Number of surfaces in a figure, so that it fits on a page.
const PER_FIGURE: usize = 8;

/// The phases in the order in which they are drawn, so that a single rejected sample stays visible among thousands of sliding ones.
const PHASES: [(Phase, Colour); 5] = [
    (Phase::Sliding, Colour::Green),
    (Phase::Starting, Colour::Sky),
    (Phase::Predicting, Colour::Purple),
    (Phase::Reaching, Colour::Orange),
    (Phase::Rejected, Colour::Vermillion),
];

/// The figures of the surfaces, each with the phases at the top; none if the estimator has neither.
pub(super) fn figures(context: &Context) -> Vec<(String, Figure)> {
    let mut panels: Vec<Panel> = Vec::new();
    for (parameter, history, _) in context.parameters(false).into_iter().chain(context.parameters(true)) {
        if !has_values(&history.surface) {
            continue;
        }
        // In units of the parameter a surface shrinks with the covariance until it is not visible any more.
        let surface: Vec<f64> = history.surface.iter().zip(&history.std_error).map(|(s, sigma)| s / sigma).collect();
        let axis = Axis::new(format!("Surface of {}", parameter.name), "σ");
        let axis = match robust_range(&surface) {
            Some([low, high]) => axis.with_range(low, high),
            None => axis,
        };
        let line = Series::new("surface", Colour::Blue, &context.time, SeriesKind::Line(surface));
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
                "The bar shows the phase of each sample: sliding (the model explains it), reaching (influence bounded), \
                 rejected (nothing within the bounds explains it). Surface: by how much one sample alone would move the \
                 estimate (least squares before the correction), in standard errors of that moment. In the sliding phase \
                 it is removed at once and looks like noise about zero; a run to one side is a wrong parameter.",
            );
            figure.panels.extend(strip.clone());
            figure.panels.extend(panels.iter().skip(index * PER_FIGURE).take(PER_FIGURE).cloned());
            (format!("surfaces-{}", index + 1), figure)
        })
        .collect()
}

/// A bar with the phase of each sample.
fn phase_strip(context: &Context) -> Option<Panel> {
    let phase = &context.estimation.history.phase;
    let mut shown: Vec<(Phase, Colour)> = PHASES.to_vec();
    let mut state = Vec::with_capacity(phase.len());
    for at in phase {
        let index = shown.iter().position(|(known, _)| known == at).unwrap_or_else(|| {
            shown.push((*at, Colour::Muted));
            shown.len() - 1
        });
        state.push(index);
    }
    let states = shown.into_iter().map(|(phase, colour)| (phase.word().to_owned(), colour)).collect();
    let body = Body::Strip { x: Arc::clone(&context.time), state, states };
    (!phase.is_empty()).then(|| Panel { y: Axis::new("Phase", ""), x: None, height: 18.0, body })
}

/// A thin line at zero.
fn zero() -> Reference {
    Reference {
        label: String::new(),
        colour: Colour::Muted,
        stroke: Stroke::Solid,
        at: At::HorizontalIfVisible(0.0),
        on_top: false,
    }
}

/// Whether any value is finite and not zero.
fn has_values(surface: &[f64]) -> bool {
    surface.iter().any(|s| s.is_finite() && *s != 0.0)
}

/// Limits with zero and all values, or with 98 % of the values if the others would need more than two thirds of the
/// height.
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
