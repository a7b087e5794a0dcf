//! Signals against time: inputs, measured and predicted outputs, a predicted record, and histories of any kind.

use std::sync::Arc;

use phugoid_identification::estimate::Method;
use phugoid_identification::estimation::{Estimation, Signal};

use super::context::{Context, display_axis, scaled};
use crate::figure::{Axis, Colour, Figure, LINE_COLOURS, Panel, Series, SeriesKind};
use crate::names::{display_unit, legend_label, signal_label};

/// The inputs that the estimator used; `None` without inputs.
pub(super) fn inputs(context: &Context) -> Option<(String, Figure)> {
    let inputs = &context.estimation.history.inputs;
    let mut figure = context.figure("Inputs", "Known inputs as the estimator used them.");
    for input in inputs {
        let (axis, unit) = display_axis(signal_label(&input.name), &input.unit);
        let line = SeriesKind::Line(scaled(&input.values, &unit));
        figure.panels.push(Panel::plot(axis, vec![Series::new("", Colour::Blue, &context.time, line)]));
    }
    (!inputs.is_empty()).then(|| ("inputs".to_owned(), figure))
}

/// What the outputs of the estimated model are, of a result by its method: in the legend, and in a sentence.
fn of_the_model(estimation: &Estimation) -> (&'static str, &'static str) {
    let is_measured = estimation.batch.as_ref().is_some_and(|report| report.measured_angles);
    match estimation.method {
        method if method.is_equation_error() => (
            "estimated model at the smoothed states",
            "the smoothed states, and the accelerations that the estimated model has at them",
        ),
        Method::OutputError | Method::OutputErrorFrequency if is_measured => (
            "estimated model, simulated",
            "the estimated model, simulated from a fitted initial state with airspeed, flow angles and attitude as measured",
        ),
        Method::OutputError | Method::OutputErrorFrequency => (
            "estimated model, simulated",
            "the estimated model, simulated from a fitted initial state without a correction by any measurement",
        ),
        _ => (
            "estimated model, one step ahead",
            "the estimated model one sample ahead, before it is corrected by the measurement it is compared with",
        ),
    }
}

/// The measured outputs and their predictions; `None` without outputs.
pub(super) fn outputs(context: &Context) -> Option<(String, Figure)> {
    let history = &context.estimation.history;
    let (line, what) = of_the_model(context.estimation);
    let caption = format!("Dots: measurements. Line: {what}.");
    let mut figure = context.figure("Measured and estimated-model outputs", &caption);
    for measured in &history.measured {
        let (axis, unit) = display_axis(signal_label(&measured.name), &measured.unit);
        let dots = SeriesKind::Points(scaled(&measured.values, &unit));
        let mut series = vec![Series::new("measured", Colour::Ink, &context.time, dots)];
        if let Some(predicted) = history.predicted.iter().find(|p| p.name == measured.name) {
            let values = SeriesKind::Line(scaled(&predicted.values, &unit));
            series.push(Series::new(line, Colour::Vermillion, &context.time, values));
        }
        figure.panels.push(Panel::plot(axis, series));
    }
    (!history.measured.is_empty()).then(|| ("outputs".to_owned(), figure))
}

/// The outputs of a record that was predicted, with their prediction intervals; `None` without a prediction.
pub(super) fn prediction(context: &Context) -> Option<(String, Figure)> {
    let prediction = context.estimation.batch.as_ref()?.prediction.as_ref()?;
    let time: Arc<[f64]> = Arc::from(prediction.time_s.as_slice());
    let mut figure = Figure {
        title: format!("Prediction of {}", prediction.source),
        caption:
            "Dots: measurements, which the estimate has not seen. Line: simulated with the estimated parameters; only \
                  the initial state and the sensor biases are fitted. Band: where 95 % of the measurements lie if the \
                  model and the bounds of its parameters are right."
                .to_owned(),
        x: Axis::new("Time", "s"),
        columns: 1,
        events: Vec::new(),
        panels: Vec::new(),
    };
    for (measured, predicted) in prediction.measured.iter().zip(&prediction.predicted) {
        let (axis, unit) = display_axis(signal_label(&measured.name), &measured.unit);
        let mut series = Vec::new();
        if let Some(interval) = prediction.intervals.iter().find(|i| i.name == measured.name) {
            let edge = |sign: f64| -> Vec<f64> {
                predicted.values.iter().zip(&interval.std_error).map(|(v, s)| v + sign * 2.0 * s).collect()
            };
            let (lower, upper) = (scaled(&edge(-1.0), &unit), scaled(&edge(1.0), &unit));
            series.push(Series::new("±2σ of a measurement", Colour::Sky, &time, SeriesKind::Band { lower, upper }));
        }
        let dots = SeriesKind::Points(scaled(&measured.values, &unit));
        series.push(Series::new("measured", Colour::Ink, &time, dots));
        let line = SeriesKind::Line(scaled(&predicted.values, &unit));
        series.push(Series::new("predicted", Colour::Vermillion, &time, line));
        figure.panels.push(Panel::plot(axis, series));
    }
    (!figure.panels.is_empty()).then(|| ("prediction".to_owned(), figure))
}

/// One panel of the figure that [`time_histories`] makes.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeHistoryPanel {
    /// Name of the quantity: words or a canonical channel name. If it is empty and there is one signal, the name of
    /// that signal is used.
    pub label: String,
    /// SI unit of all signals of the panel (`rad`, `m/s`, `-`, ...). Angles are drawn in degrees.
    pub unit: String,
    /// The signals, in SI. If there are several, each appears in the legend under its name.
    pub signals: Vec<Signal>,
}

/// A figure of histories over a common time, s, such as those of a simulated flight. More than eight panels stand in
/// two columns.
///
/// ```
/// use phugoid_identification::estimation::Signal;
/// use phugoid_report::{TimeHistoryPanel, time_histories};
///
/// let q = Signal { name: "q".to_owned(), unit: "rad/s".to_owned(), values: vec![0.0, std::f64::consts::FRAC_PI_2] };
/// let panel = TimeHistoryPanel { label: String::new(), unit: "rad/s".to_owned(), signals: vec![q] };
/// let figure = time_histories("Flight", "", &[0.0, 1.0], &[panel]);
/// assert_eq!((figure.panels[0].y.label.as_str(), figure.panels[0].y.unit.as_str()), ("Pitch rate q", "deg/s"));
/// ```
pub fn time_histories(title: &str, caption: &str, time_s: &[f64], panels: &[TimeHistoryPanel]) -> Figure {
    let time: Arc<[f64]> = Arc::from(time_s);
    let mut figure = Figure {
        title: title.to_owned(),
        caption: caption.to_owned(),
        x: Axis::new("Time", "s"),
        // A long column of panels fits neither on a screen nor on a page.
        columns: if panels.len() > 8 { 2 } else { 1 },
        ..Figure::default()
    };
    for panel in panels {
        let unit = display_unit(&panel.unit);
        let label = match panel.signals.as_slice() {
            [only] if panel.label.is_empty() => signal_label(&only.name),
            _ => signal_label(&panel.label),
        };
        let several = panel.signals.len() > 1;
        let series = panel
            .signals
            .iter()
            .zip(LINE_COLOURS.iter().cycle())
            .map(|(signal, colour)| {
                let name = if several { legend_label(&signal.name) } else { String::new() };
                Series::new(name, *colour, &time, SeriesKind::Line(scaled(&signal.values, &unit)))
            })
            .collect();
        figure.panels.push(Panel::plot(Axis::new(label, unit.text), series));
    }
    figure
}
