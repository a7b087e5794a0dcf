//! Whitened residuals against time, and their autocorrelation.

use std::sync::Arc;

use super::context::Context;
use crate::figure::{At, Axis, Colour, Figure, Panel, Reference, Series, SeriesKind, Stroke};
use crate::names::signal_label;
use crate::statistics::{autocorrelation, median_step};

/// Residuals beyond this, in standard deviations, are drawn at the border in another colour.
const LIMIT: f64 = 10.0;

/// The residuals against time; `None` without residuals.
pub(super) fn series(context: &Context) -> Option<(String, Figure)> {
    let residuals = &context.estimation.history.residuals;
    let mut figure = context.figure(
        "Whitened residuals",
        "Measured minus predicted, divided by the standard deviation that the estimator expects. If model and noise \
         are right, 95 % lie within ±2.",
    );
    for residual in residuals {
        let largest = residual.values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
        let limit = (1.1 * largest).clamp(4.0, LIMIT);
        let axis = Axis::new(format!("Residual of {}", uncapitalised(&signal_label(&residual.name))), "σ");
        let mut dots =
            vec![Series::new("residual", Colour::Blue, &context.time, SeriesKind::Points(residual.values.clone()))];
        if largest > limit {
            let beyond = residual
                .values
                .iter()
                .map(|v| if v.abs() > limit { 0.95 * limit.copysign(*v) } else { f64::NAN })
                .collect();
            let label = format!("beyond ±{LIMIT} σ, drawn at the border");
            dots.push(Series::new(label, Colour::Vermillion, &context.time, SeriesKind::Marks(beyond)));
        }
        let panel = Panel::plot(axis.with_range(-limit, limit), dots).with_height(96.0);
        let line = |at| Reference {
            label: "±2σ".to_owned(),
            colour: Colour::Orange,
            stroke: Stroke::Dashed,
            at,
            on_top: false,
        };
        figure.panels.push(panel.with_reference(line(At::Horizontal(2.0))).with_reference(line(At::Horizontal(-2.0))));
    }
    (!residuals.is_empty()).then(|| ("residuals".to_owned(), figure))
}

/// The autocorrelation of the residuals; `None` without regular times or without residuals.
pub(super) fn autocorrelations(context: &Context) -> Option<(String, Figure)> {
    let step = median_step(&context.time);
    if step.is_nan() || step <= 0.0 {
        return None;
    }
    let mut figure = context.figure(
        "Autocorrelation of the whitened residuals",
        "Without model error and with white sensor noise 95 % of the bars stay between the dashed lines. Slowly \
         decaying bars mean coloured residuals; the corrected standard errors allow for them.",
    );
    figure.columns = 2;
    figure.events.clear();
    figure.x = Axis::new("Lag", "s");
    for residual in &context.estimation.history.residuals {
        let lags = ((1.5 / step) as usize).clamp(20, 150).min(residual.values.len() / 3);
        let r = autocorrelation(&residual.values, lags);
        if r.len() < 2 {
            continue;
        }
        let count = residual.values.iter().filter(|v| v.is_finite()).count() as f64;
        let limit = 1.96 / count.sqrt();
        let lag: Arc<[f64]> = (1..r.len()).map(|k| k as f64 * step).collect();
        let smallest = r.iter().copied().filter(|v| v.is_finite()).fold(-2.0 * limit, f64::min);
        let largest = r.iter().skip(1).copied().filter(|v| v.is_finite()).fold(2.0 * limit, f64::max);
        let axis = Axis::new(format!("Autocorrelation, {}", uncapitalised(&signal_label(&residual.name))), "–")
            .with_range((1.15 * smallest).min(-0.22), (1.15 * largest).clamp(0.22, 1.05));
        let bars = Series::new("autocorrelation", Colour::Blue, &lag, SeriesKind::Bars(r[1..].to_vec()));
        let line = |at| Reference {
            label: "95 % limits of white noise".to_owned(),
            colour: Colour::Orange,
            stroke: Stroke::Dashed,
            at,
            on_top: false,
        };
        let zero = Reference {
            label: String::new(),
            colour: Colour::Muted,
            stroke: Stroke::Solid,
            at: At::HorizontalIfVisible(0.0),
            on_top: false,
        };
        figure.panels.push(
            Panel::plot(axis, vec![bars])
                .with_reference(zero)
                .with_reference(line(At::Horizontal(limit)))
                .with_reference(line(At::Horizontal(-limit))),
        );
    }
    let longest = figure.panels.iter().filter_map(last_lag).fold(0.0, f64::max);
    figure.x = figure.x.with_range(0.0, longest + step);
    (!figure.panels.is_empty()).then(|| ("autocorrelation".to_owned(), figure))
}

/// The largest lag of a panel, s.
fn last_lag(panel: &Panel) -> Option<f64> {
    match &panel.body {
        crate::figure::Body::Plot { series, .. } => series.first().and_then(|s| s.x.last().copied()),
        _ => None,
    }
}

/// `Angle of attack` as `angle of attack`, for use within a sentence.
fn uncapitalised(words: &str) -> String {
    let mut characters = words.chars();
    match (characters.next(), characters.next()) {
        // A single capital letter is a symbol and not a word.
        (Some(first), Some(second)) if second.is_lowercase() => {
            first.to_lowercase().chain(words.chars().skip(1)).collect()
        }
        _ => words.to_owned(),
    }
}
