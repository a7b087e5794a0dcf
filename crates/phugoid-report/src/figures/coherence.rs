//! The coherence of the surfaces that were moved and the outputs, over frequency.

use std::sync::Arc;

use phugoid_identification::inspect::{Coherence, CoherenceCurve};

use crate::figure::{At, Axis, Colour, Figure, Panel, Reference, Series, SeriesKind, Stroke};
use crate::names::signal_label;

/// One figure for each surface, `coherence-elevator` and so on, with a panel for each output; none for a surface of
/// which no coherence could be computed.
///
/// ```
/// use phugoid_identification::inspect::{Coherence, CoherenceCurve};
/// use phugoid_report::coherence_figures;
/// let curve = CoherenceCurve {
///     values: vec![0.9, 0.2],
///     level: 0.4,
///     bands_hz: vec![[0.5, 0.5]],
///     peak: 0.9,
///     peak_hz: 0.5,
///     chance: 0.001,
/// };
/// let pair = Coherence {
///     input: "elevator".to_owned(),
///     output: "q".to_owned(),
///     given: Vec::new(),
///     stretches_s: vec![[0.0, 10.0]],
///     averages: 7,
///     bandwidth_hz: 0.8,
///     frequencies_hz: vec![0.5, 1.0],
///     ordinary: Some(curve),
///     partial: None,
///     multiple: None,
///     reason: String::new(),
/// };
/// let figures = coherence_figures(&[pair]);
/// assert_eq!(figures[0].0, "coherence-elevator");
/// assert!(figures[0].1.to_svg().contains("Pitch rate q"));
/// ```
pub fn coherence_figures(pairs: &[Coherence]) -> Vec<(String, Figure)> {
    let mut inputs: Vec<&str> = Vec::new();
    for pair in pairs {
        if !inputs.contains(&pair.input.as_str()) {
            inputs.push(&pair.input);
        }
    }
    inputs.into_iter().filter_map(|input| figure(pairs.iter().filter(|p| p.input == input), input)).collect()
}

fn figure<'a>(pairs: impl Iterator<Item = &'a Coherence>, input: &str) -> Option<(String, Figure)> {
    let mut panels = Vec::new();
    let mut given: &[String] = &[];
    for pair in pairs {
        if let Some(panel) = panel(pair) {
            given = &pair.given;
            panels.push(panel);
        }
    }
    let others = match given {
        [] => String::new(),
        given => format!(
            " The partial coherence is that of what is left after the effect of {} is taken out.",
            given.join(", ")
        ),
    };
    let columns = if panels.len() > 3 { 2 } else { 1 };
    let figure = Figure {
        title: format!("Coherence with the {input}"),
        caption: format!(
            "The part of the spectrum of each output that is linear in the {input}.{others} Noise alone exceeds the dotted \
             level at one frequency in twenty."
        ),
        x: Axis::new("Frequency", "Hz"),
        panels,
        columns,
        ..Figure::default()
    };
    (!figure.panels.is_empty()).then(|| (format!("coherence-{input}"), figure))
}

fn panel(pair: &Coherence) -> Option<Panel> {
    let x: Arc<[f64]> = pair.frequencies_hz.clone().into();
    let line = |label: &str, curve: &CoherenceCurve, colour| {
        Series::new(label, colour, &x, SeriesKind::Line(curve.values.clone())).joined()
    };
    let mut series = Vec::new();
    let ordinary_stroke = if pair.given.is_empty() { Stroke::Solid } else { Stroke::Dashed };
    if let Some(curve) = &pair.multiple {
        series.push(line("all these surfaces together", curve, Colour::Green));
    }
    if let Some(curve) = &pair.ordinary {
        let colour = if pair.given.is_empty() { Colour::Blue } else { Colour::Muted };
        series.push(line("ordinary coherence", curve, colour).with_stroke(ordinary_stroke));
    }
    if let Some(curve) = &pair.partial {
        series.push(line("partial coherence", curve, Colour::Blue));
    }
    let curve = pair.decisive().or(pair.ordinary.as_ref())?;
    Some(Panel::plot(Axis::new(signal_label(&pair.output), "").with_range(0.0, 1.0), series).with_reference(
        Reference {
            label: "level that noise exceeds at one frequency in twenty".to_owned(),
            colour: Colour::Ink,
            stroke: Stroke::Dotted,
            at: At::Horizontal(curve.level),
            on_top: false,
        },
    ))
}
