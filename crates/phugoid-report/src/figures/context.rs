//! What all figures of an estimation share: time, events, parameters with their units.

use std::sync::Arc;

use phugoid_identification::estimation::{Estimation, EventKind, FinalStatus, ParameterHistory, ParameterResult};

use crate::figure::{Axis, Colour, EventMark, Figure};
use crate::names::{DisplayUnit, display_unit, parameter_unit};

/// The estimation, and what all its figures share.
pub(super) struct Context<'a> {
    pub(super) estimation: &'a Estimation,
    pub(super) time: Arc<[f64]>,
    pub(super) events: Vec<EventMark>,
}

impl<'a> Context<'a> {
    /// Reads times and events once for all figures.
    pub(super) fn new(estimation: &'a Estimation) -> Self {
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

    /// A figure over time with the events of the estimation and without panels.
    pub(super) fn figure(&self, title: &str, caption: &str) -> Figure {
        Figure {
            title: title.to_owned(),
            caption: caption.to_owned(),
            x: Axis::new("Time", "s"),
            columns: 1,
            events: self.events.clone(),
            panels: Vec::new(),
        }
    }

    /// The estimated parameters with their histories and units; either the nuisance parameters or all others.
    pub(super) fn parameters(&self, nuisance: bool) -> Vec<(&'a ParameterResult, &'a ParameterHistory, DisplayUnit)> {
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
pub(crate) fn unit_of(estimation: &Estimation, parameter: &str) -> DisplayUnit {
    parameter_unit(parameter, |channel| {
        let history = &estimation.history;
        let mut known = history.measured.iter().chain(&estimation.noise);
        known.find(|s| s.name == channel).map(|s| s.unit.clone())
    })
}

/// The words and the colour for a kind of event.
pub(crate) fn event_kind(kind: EventKind) -> (&'static str, Colour) {
    match kind {
        EventKind::InDoubt => ("bounds in doubt", Colour::Purple),
        EventKind::Adopted => ("change adopted", Colour::Vermillion),
        EventKind::DoubtDropped => ("doubt dropped", Colour::Sky),
        EventKind::RolledBack => ("change taken back", Colour::Sky),
        EventKind::Units => ("unit or sign implausible", Colour::Orange),
        EventKind::Insensitive => ("change detector insensitive", Colour::Orange),
        EventKind::Gap => ("gap in the data", Colour::Muted),
        EventKind::Restarted => ("restarted", Colour::Ink),
    }
}

/// SI values in the unit in which they are shown.
pub(super) fn scaled(values: &[f64], unit: &DisplayUnit) -> Vec<f64> {
    values.iter().map(|v| v * unit.factor).collect()
}

/// The axis of an SI quantity in the unit in which it is shown.
pub(super) fn display_axis(label: String, si: &str) -> (Axis, DisplayUnit) {
    let unit = display_unit(si);
    (Axis::new(label, unit.text.clone()), unit)
}
