//! What all figures of an estimation share: time, events, parameters with their units.

use std::sync::Arc;

use phugoid_identification::estimation::{Estimation, ParameterHistory, ParameterResult};

use crate::figure::{Axis, Colour, EventMark, Figure};
use crate::names::{HumanUnit, human_unit, parameter_unit};

/// The estimation with what all figures share.
pub(super) struct Context<'a> {
    pub(super) estimation: &'a Estimation,
    pub(super) time: Arc<[f64]>,
    pub(super) events: Vec<EventMark>,
}

impl<'a> Context<'a> {
    pub(super) fn new(estimation: &'a Estimation) -> Self {
        let events = estimation
            .events
            .iter()
            .map(|event| {
                let (label, colour) = event_kind(&event.kind);
                EventMark { x: event.time_s, label, colour }
            })
            .collect();
        Self { estimation, time: Arc::from(estimation.history.time_s.as_slice()), events }
    }

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

    /// Parameters that were estimated, with their histories and units: the wanted ones or the nuisance ones.
    pub(super) fn parameters(&self, nuisance: bool) -> Vec<(&'a ParameterResult, &'a ParameterHistory, HumanUnit)> {
        self.estimation
            .parameters
            .iter()
            .filter(|p| p.nuisance == nuisance && p.status != "fixed")
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
pub(crate) fn event_kind(kind: &str) -> (String, Colour) {
    let (words, colour) = match kind {
        "in_doubt" => ("bounds in doubt", Colour::Purple),
        "re_reached" => ("change adopted (re-reached)", Colour::Vermillion),
        "doubt_dropped" => ("doubt dropped", Colour::Sky),
        "insensitive" => ("change detector insensitive", Colour::Orange),
        "gap" => ("gap in the data", Colour::Muted),
        "restarted" => ("restarted", Colour::Ink),
        other => return (other.replace('_', " "), Colour::Muted),
    };
    (words.to_owned(), colour)
}

pub(super) fn scaled(values: &[f64], unit: &HumanUnit) -> Vec<f64> {
    values.iter().map(|v| v * unit.factor).collect()
}

pub(super) fn human_axis(label: String, si: &str) -> (Axis, HumanUnit) {
    let unit = human_unit(si);
    (Axis::new(label, unit.text.clone()), unit)
}
