//! The health monitor on a flight of the field.

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::health::{Condition, FALSE_ALARMS_PER_HOUR, HealthOptions};
use phugoid_identification::model_file::{Expectation, ModelFile};
use phugoid_identification::monitor::monitor;
use serde::Serialize;

use super::truth::{TrueParameter, Truth};

/// Part of a derivative that counts as healthy: what a flight test before would have left open.
const TOLERANCE: f64 = 0.2;
/// What constants may be off: trim of the surfaces, of load and of sensors.
const CONSTANTS: [(&str, f64); 6] =
    [("CL_0", 0.05), ("CD_0", 0.005), ("Cm_0", 0.005), ("CY_0", 0.01), ("Cl_0", 0.001), ("Cn_0", 0.001)];

/// What the health monitor said of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Watched {
    /// Parameters that were monitored.
    pub expected: usize,
    /// Time of the alarm, s; none without one.
    pub flagged_at_s: Option<f64>,
    /// Parameters that were named.
    pub named: Vec<String>,
    /// Whether the rate of false alarms was promised for this flight.
    pub promised: bool,
    /// What was seen of the scatter of the innovations along the monitored parameters, as a variance; none if nothing
    /// has moved.
    pub scatter: Option<f64>,
    /// Whether every parameter was called as expected at the end.
    pub called_healthy: bool,
    /// Parameters that really changed, of those that were monitored.
    pub changed: Vec<String>,
    /// When they changed, s.
    pub change_s: Option<f64>,
}

/// How an alarm fits what really happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Alarm {
    /// None, and nothing changed.
    RightlyQuiet,
    /// Nothing had changed yet, or at all.
    False,
    /// The aircraft changed and there was no alarm.
    Missed,
    /// Found, and every named parameter is one that changed.
    NamedRightly,
    /// Found, and a parameter that did not change is named.
    NamedWrongly,
    /// Found, and none is named.
    NotNamed,
}

impl Watched {
    /// How the alarm fits what really happened.
    pub fn alarm(&self) -> Alarm {
        match (self.flagged_at_s, self.change_s) {
            (None, None) => Alarm::RightlyQuiet,
            (None, Some(_)) => Alarm::Missed,
            (Some(_), None) => Alarm::False,
            (Some(flagged), Some(change)) if flagged < change => Alarm::False,
            _ if self.named.is_empty() => Alarm::NotNamed,
            _ if self.named.iter().all(|name| self.changed.contains(name)) => Alarm::NamedRightly,
            _ => Alarm::NamedWrongly,
        }
    }
}

/// Runs the monitor with the expectations that a flight test before would have given: the truth of the healthy aircraft.
/// None if the record does not allow an estimate, or nothing can be expected.
pub(super) fn watch(record: &Record, model: &ModelFile, truth: &Truth) -> Option<Watched> {
    let expected: Vec<Expectation> =
        truth.truth.parameters.iter().filter_map(|(name, p)| expectation(name, p, model)).collect();
    if expected.is_empty() {
        return None;
    }
    let is_expected = |name: &String| expected.iter().any(|e| e.name == *name);
    let changed: Vec<String> =
        truth.change.iter().flat_map(|c| c.changes.keys()).filter(|name| is_expected(name)).cloned().collect();
    let count = expected.len();
    let options = EstimateOptions::causal();
    let health = HealthOptions { expected, false_alarms_per_hour: FALSE_ALARMS_PER_HOUR };
    let (_, report) = monitor(record, model, &options, &health, &mut |_| {}).ok()?;
    Some(Watched {
        expected: count,
        flagged_at_s: report.failure.as_ref().map(|f| f.flagged_at_s),
        named: report.failure.map(|f| f.parameters).unwrap_or_default(),
        promised: report.promise.holds,
        scatter: report.promise.scatter,
        called_healthy: report.condition == Condition::Healthy,
        changed,
        change_s: truth.change.as_ref().map(|c| c.time_s),
    })
}

fn expectation(name: &str, p: &TrueParameter, model: &ModelFile) -> Option<Expectation> {
    let estimated = model.estimated().any(|own| own.name == *name);
    let constant = CONSTANTS.iter().find(|(known, _)| *known == name).map(|(_, tolerance)| *tolerance);
    let tolerance = match constant {
        Some(tolerance) => tolerance,
        None if p.counts() => TOLERANCE * p.value.abs() + 2.0 * p.structure_std,
        None => return None,
    };
    estimated.then(|| Expectation { name: name.to_owned(), value: p.value, tolerance, failure_std: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watched(flagged_at_s: Option<f64>, named: &[&str], change_s: Option<f64>) -> Watched {
        let named = named.iter().map(|name| (*name).to_owned()).collect();
        let changed = vec!["Cm_0".to_owned()];
        Watched {
            expected: 5,
            flagged_at_s,
            named,
            promised: false,
            scatter: None,
            called_healthy: false,
            changed,
            change_s,
        }
    }

    #[test]
    fn alarms_are_judged_by_time_and_name() {
        for (found, expected) in [
            (watched(None, &[], None), Alarm::RightlyQuiet),
            (watched(Some(3.0), &["Cm_0"], None), Alarm::False),
            (watched(Some(3.0), &["Cm_0"], Some(20.0)), Alarm::False),
            (watched(None, &[], Some(20.0)), Alarm::Missed),
            (watched(Some(23.0), &["Cm_0"], Some(20.0)), Alarm::NamedRightly),
            (watched(Some(23.0), &["Cm_0", "Cm_q"], Some(20.0)), Alarm::NamedWrongly),
            (watched(Some(23.0), &[], Some(20.0)), Alarm::NotNamed),
        ] {
            assert_eq!(found.alarm(), expected, "{found:?}");
        }
    }
}
