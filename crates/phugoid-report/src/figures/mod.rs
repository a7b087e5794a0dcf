//! The figures that a flight-test engineer draws of an estimation.

use std::sync::Arc;

use phugoid_identification::estimation::{Estimation, EventKind, FinalStatus, ParameterHistory, ParameterResult};

use crate::figure::{Axis, Colour, EventMark, Figure};
use crate::names::{HumanUnit, human_unit, parameter_unit};

mod correlation;
mod parameters;
mod planes;
mod residuals;
mod signals;
mod surfaces;

pub use signals::{TimeHistoryPanel, time_histories};

/// All figures of an estimation with short names that serve as file names and anchors (`inputs`, `outputs`,
/// `parameters-1`, `correlation`, `parameter-planes`, `surfaces-1`, `residuals`, `autocorrelation`). Figures for which
/// the estimation has no data are left out: an estimator without surfaces has no surface figure.
pub fn figures(estimation: &Estimation) -> Vec<(String, Figure)> {
    let context = Context::new(estimation);
    let mut figures = Vec::new();
    figures.extend(signals::inputs(&context));
    figures.extend(signals::outputs(&context));
    figures.extend(parameters::figures(&context));
    figures.extend(correlation::figure(&context));
    figures.extend(planes::figure(&context));
    figures.extend(surfaces::figures(&context));
    figures.extend(residuals::series(&context));
    figures.extend(residuals::autocorrelations(&context));
    figures
}

/// The estimation with what all figures share.
struct Context<'a> {
    estimation: &'a Estimation,
    time: Arc<[f64]>,
    events: Vec<EventMark>,
}

impl<'a> Context<'a> {
    fn new(estimation: &'a Estimation) -> Self {
        let events = estimation
            .events
            .iter()
            .map(|event| {
                let (label, colour) = event_kind(event.kind);
                EventMark { x: event.time_s, label: label.to_owned(), colour }
            })
            .collect();
        Self { estimation, time: Arc::from(estimation.history.time_s.as_slice()), events }
    }

    fn figure(&self, title: &str, caption: &str) -> Figure {
        Figure {
            title: title.to_owned(),
            caption: caption.to_owned(),
            x: Axis::new("Time", "s"),
            columns: 1,
            events: self.events.clone(),
            panels: Vec::new(),
        }
    }

    /// Parameters that were estimated, with their histories and units: the wanted ones or the nuisance ones.
    fn parameters(&self, nuisance: bool) -> Vec<(&'a ParameterResult, &'a ParameterHistory, HumanUnit)> {
        self.estimation
            .parameters
            .iter()
            .filter(|p| p.nuisance == nuisance && p.status != FinalStatus::Fixed)
            .filter_map(|p| {
                let history = self.estimation.history.parameters.iter().find(|h| h.name == p.name)?;
                (!history.value.is_empty()).then(|| (p, history, unit_of(self.estimation, &p.name)))
            })
            .collect()
    }
}

/// The unit in which a parameter of this estimation is shown.
pub(crate) fn unit_of(estimation: &Estimation, parameter: &str) -> HumanUnit {
    parameter_unit(parameter, |channel| {
        let history = &estimation.history;
        let mut known = history.measured.iter().chain(&estimation.noise);
        known.find(|s| s.name == channel).map(|s| s.unit.clone())
    })
}

/// Words and colour for a kind of event.
pub(crate) fn event_kind(kind: EventKind) -> (&'static str, Colour) {
    match kind {
        EventKind::InDoubt => ("bounds in doubt", Colour::Purple),
        EventKind::Adopted => ("change adopted", Colour::Vermillion),
        EventKind::DoubtDropped => ("doubt dropped", Colour::Sky),
        EventKind::Insensitive => ("change detector insensitive", Colour::Orange),
        EventKind::Gap => ("gap in the data", Colour::Muted),
        EventKind::Restarted => ("restarted", Colour::Ink),
    }
}

fn scaled(values: &[f64], unit: &HumanUnit) -> Vec<f64> {
    values.iter().map(|v| v * unit.factor).collect()
}

fn human_axis(label: String, si: &str) -> (Axis, HumanUnit) {
    let unit = human_unit(si);
    (Axis::new(label, unit.text.clone()), unit)
}
