//! Each parameter against time, twice: the whole course, and enlarged to the precision at the end.

use phugoid_identification::estimation::{ParameterHistory, ParameterResult};

use super::context::{Context, scaled};
use crate::figure::{At, Axis, Colour, Figure, Panel, Reference, Series, SeriesKind, Stroke};
use crate::names::DisplayUnit;
use crate::ticks::with_error;

/// Number of parameters in a figure, so that it fits on a page.
const PER_FIGURE: usize = 6;

/// The figures of the parameters, then those of the nuisance parameters.
pub(super) fn figures(context: &Context) -> Vec<(String, Figure)> {
    let mut out = Vec::new();
    for (nuisance, slug, title) in
        [(false, "parameters", "Parameters against time"), (true, "nuisance", "Offsets and sensor biases against time")]
    {
        let parameters = context.parameters(nuisance);
        let groups = parameters.len().div_ceil(PER_FIGURE);
        for (index, group) in parameters.chunks(PER_FIGURE).enumerate() {
            let title = if groups > 1 { format!("{title}, {} of {groups}", index + 1) } else { title.to_owned() };
            let mut figure = context.figure(
                &title,
                "Left: the whole course; the band of the first moments, before the input begins, is cut off, and \
                 bounds are drawn where they are near. Right: the same curves enlarged to the precision at the end. \
                 Band: ±2 corrected standard errors.",
            );
            figure.columns = 2;
            for (parameter, history, unit) in group {
                figure.panels.extend(panels(context, parameter, history, unit));
            }
            out.push((format!("{slug}-{}", index + 1), figure));
        }
    }
    out
}

/// The two panels of a parameter.
fn panels(
    context: &Context,
    parameter: &ParameterResult,
    history: &ParameterHistory,
    unit: &DisplayUnit,
) -> [Panel; 2] {
    let values = scaled(&history.value, unit);
    let errors = scaled(&history.std_error, unit);
    let band = |sign: f64| values.iter().zip(&errors).map(|(v, s)| v + 2.0 * sign * s).collect::<Vec<f64>>();
    let series = || {
        let spread = SeriesKind::Band { lower: band(-1.0), upper: band(1.0) };
        vec![
            Series::new("±2σ (corrected)", Colour::Blue, &context.time, spread),
            Series::new("estimate", Colour::Blue, &context.time, SeriesKind::Line(values.clone())),
        ]
    };
    let last = Final {
        value: parameter.value * unit.factor,
        sigma: parameter.corrected_std_error * unit.factor,
        truth: parameter.truth.map(|t| t * unit.factor),
    };
    let bounds = parameter.bounds.map(|b| b.map(|v| v * unit.factor));

    let label = format!("{} at the end: {}, 2σ", parameter.name, with_error(last.value, 2.0 * last.sigma));
    let whole = ranged(&parameter.name, unit, whole_range(&values, &last, bounds));
    let end = ranged(&label, unit, end_range(&values, &last));
    [whole, end].map(|axis| {
        let lines = references(context, parameter, &last, bounds, axis.range);
        lines.into_iter().fold(Panel::plot(axis, series()), Panel::with_reference)
    })
}

/// Truth, bounds and instant of convergence. Those outside the limits of the ordinate are left out, because the legend
/// must not name what is not visible.
fn references(
    context: &Context,
    parameter: &ParameterResult,
    last: &Final,
    bounds: Option<[f64; 2]>,
    range: Option<[f64; 2]>,
) -> Vec<Reference> {
    let seen = |v: &f64| range.is_some_and(|[low, high]| low <= *v && *v <= high);
    let level = |label: &str, colour, stroke, value| Reference {
        label: label.to_owned(),
        colour,
        stroke,
        at: At::HorizontalIfVisible(value),
        on_top: false,
    };
    let mut lines = Vec::new();
    lines.extend(last.truth.filter(seen).map(|v| level("truth", Colour::Vermillion, Stroke::Solid, v)));
    lines.extend(bounds.into_iter().flatten().filter(seen).map(|v| level("bounds", Colour::Muted, Stroke::Dashed, v)));
    let start = context.time.first().copied().unwrap_or(0.0);
    lines.extend(parameter.converged_at_s.map(|after| Reference {
        label: "converged (stays within 5 %)".to_owned(),
        colour: Colour::Green,
        stroke: Stroke::Dashed,
        at: At::Vertical(start + after),
        on_top: false,
    }));
    lines
}

/// The values at the end, in the unit in which they are shown.
struct Final {
    value: f64,
    sigma: f64,
    truth: Option<f64>,
}

/// An axis with limits, if there are any.
fn ranged(label: &str, unit: &DisplayUnit, range: Option<[f64; 2]>) -> Axis {
    let axis = Axis::new(label, unit.text.clone());
    match range {
        Some([low, high]) => axis.with_range(low, high),
        None => axis,
    }
}

/// Limits for the whole course: 99 % of the values, the end with +-2 sigma, the truth, and bounds that are not far
/// away. The wide band at the beginning, where little is known, is not included.
fn whole_range(values: &[f64], last: &Final, bounds: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let rank = |share: f64| sorted.get(((sorted.len().checked_sub(1)?) as f64 * share).round() as usize).copied();
    let start = values.iter().copied().find(|v| v.is_finite());
    let ends = [Some(last.value - 2.0 * last.sigma), Some(last.value + 2.0 * last.sigma), last.truth, start];
    let seen: Vec<f64> =
        ends.into_iter().chain([rank(0.005), rank(0.995)]).flatten().filter(|v| v.is_finite()).collect();
    let low = seen.iter().copied().reduce(f64::min)?;
    let high = seen.iter().copied().reduce(f64::max)?;
    let span = high - low;
    let (mut from, mut to) = (low, high);
    for bound in bounds.into_iter().flatten() {
        if bound >= low - 1.6 * span && bound <= high + 1.6 * span {
            from = from.min(bound);
            to = to.max(bound);
        }
    }
    let pad = 0.08 * (to - from);
    (pad > 0.0).then_some([from - pad, to + pad])
}

/// Limits about the final value: the movement of the estimate in the last quarter with its band, and the truth if it is
/// not far away.
fn end_range(values: &[f64], last: &Final) -> Option<[f64; 2]> {
    let centre = last.value;
    let moved = values[values.len() - values.len() / 4..]
        .iter()
        .map(|v| (v - centre).abs())
        .filter(|v| v.is_finite())
        .fold(0.0, f64::max);
    let sigma = if last.sigma.is_finite() { last.sigma } else { 0.0 };
    let mut half = (1.1 * moved + 2.2 * sigma).max(3.5 * sigma);
    if let Some(error) = last.truth.map(|t| (t - centre).abs()).filter(|e| *e <= 4.0 * half) {
        half = half.max(1.25 * error);
    }
    (half > 1e-12 * centre.abs() && half > 0.0).then_some([centre - half, centre + half])
}
