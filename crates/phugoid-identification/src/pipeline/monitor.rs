//! From a flight record, a model file and what is expected to the health of the aircraft.

use phugoid_estimators::health::Assumptions;
use phugoid_flight_data::plausibility::{Cause, Doubt};
use phugoid_flight_data::record::Record;

use super::estimate::pipeline;
use crate::core::error::EstimateError;
use crate::core::estimation::Estimation;
use crate::core::health::{Condition, FailureReport, HealthOptions, HealthReport, ParameterHealth, Promise};
use crate::core::options::EstimateOptions;
use crate::methods::HealthRun;
use crate::model_file::ModelFile;
use crate::preparation::checks::doubts;

/// Estimates the parameters of `model` from `record` as [`crate::pipeline::estimate::estimate`] does, and watches
/// beside it whether they are what is expected: sample by sample, no verdict uses a later sample. `progress` is called
/// with the fraction done, 0 to 1.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::estimate::EstimateOptions;
/// use phugoid_identification::health::{Condition, FALSE_ALARMS_PER_HOUR, HealthOptions};
/// use phugoid_identification::model_file::{Expectation, ModelFile};
/// use phugoid_identification::monitor::monitor;
/// let flight = Record::open("examples/flight.csv")?;
/// // The elevator should have its full effect, within 0.04 per rad; it was flown with 0.15 per rad less.
/// let elevator = Expectation { name: "dCm_elevator".to_owned(), value: 0.0, tolerance: 0.04, failure_std: None };
/// let health = HealthOptions { expected: vec![elevator], false_alarms_per_hour: FALSE_ALARMS_PER_HOUR };
/// let model = ModelFile::named("f16")?;
/// let (_, report) = monitor(&flight, &model, &EstimateOptions::default(), &health, &mut |_| {})?;
/// assert_eq!(report.condition, Condition::Diverged);
/// assert!(report.sentences[0].starts_with("dCm_elevator diverged"), "{:?}", report.sentences);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`crate::pipeline::estimate::estimate`]; [`EstimateError::Model`] for expectations that cannot be
/// monitored.
pub fn monitor(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    health: &HealthOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<(Estimation, HealthReport), EstimateError> {
    let (estimation, run) = pipeline(record, model, options, Some(health), progress)?;
    let run = run.ok_or_else(|| EstimateError::Model("the estimator was run without its monitor".to_owned()))?;
    let doubts = doubts(record, model)?;
    let failed = run.failure.as_ref().map(|(flagged_at_s, _)| *flagged_at_s);
    let by_then =
        |doubt: &&Doubt| doubt.since_s.is_none_or(|since_s| failed.is_none_or(|flagged_s| since_s <= flagged_s));
    let sensor = doubts.iter().filter(|doubt| doubt.cause == Cause::Sensor).find(by_then);
    let report = report(&estimation, health, run, sensor);
    Ok((estimation, report))
}

/// `sensor` is what is doubtful of the recording by the time of a flag: a sensor that fails looks to the monitor like a failure of the aircraft, so
/// that no failure is told then.
fn report(estimation: &Estimation, options: &HealthOptions, run: HealthRun, sensor: Option<&Doubt>) -> HealthReport {
    let HealthRun { mut history, threshold, parameters, failure, assumptions, learns } = run;
    let mut promise = promise(assumptions.as_ref(), learns);
    let flagged_at_s = failure.as_ref().map(|(flagged_at_s, _)| *flagged_at_s);
    let failure = failure.filter(|_| sensor.is_none());
    if sensor.is_some() {
        promise.holds = false;
        promise.reason = Some("a sensor or its recording is in doubt".to_owned());
        history.condition.iter_mut().filter(|c| **c == Condition::Diverged).for_each(|c| *c = Condition::Unknown);
    }
    let finite = |value: f64| value.is_finite().then_some(value);
    let failed = failure.is_some();
    let parameters: Vec<ParameterHealth> = parameters
        .into_iter()
        .enumerate()
        .map(|(index, (expectation, found, known))| {
            let estimate = estimation.parameters.iter().find(|p| p.name == expectation.name);
            ParameterHealth {
                name: expectation.name,
                expected: expectation.value,
                tolerance: expectation.tolerance,
                value: estimate.map_or(f64::NAN, |p| p.value),
                corrected_std_error: estimate.map_or(f64::NAN, |p| p.corrected_std_error),
                deviation: history.deviation[index].last().copied().unwrap_or(f64::NAN),
                known,
                diverged_at_s: finite(found.named_s).filter(|_| sensor.is_none()),
                change: finite(found.change).filter(|_| failed),
                change_std: finite(found.change_std).filter(|_| failed),
            }
        })
        .collect();
    let failure = failure.map(|(flagged_at_s, onset)| {
        let mut named: Vec<&ParameterHealth> = parameters.iter().filter(|p| p.diverged_at_s.is_some()).collect();
        named.sort_by(|a, b| a.diverged_at_s.partial_cmp(&b.diverged_at_s).unwrap_or(std::cmp::Ordering::Equal));
        FailureReport {
            flagged_at_s,
            onset_s: onset.map(|o| o.time_s),
            onset_interval_s: onset.map(|o| o.interval_s),
            or_earlier: onset.is_some_and(|o| o.or_earlier),
            parameters: named.iter().map(|p| p.name.clone()).collect(),
        }
    });
    let condition = history.condition.last().copied().unwrap_or_default();
    let evidence = history.evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut sentences = sentences(condition, &parameters, failure.as_ref(), evidence, &promise, options);
    if let Some(doubt) = sensor {
        let flag = flagged_at_s
            .map_or_else(String::new, |at| format!(" The monitor raised a flag at {at:.2} s, which may come of it."));
        let no_verdict = format!("No verdict on the aircraft, because the recording is in doubt: {doubt}.{flag}");
        sentences.insert(0, no_verdict);
    }
    HealthReport {
        source: estimation.source.clone(),
        model: estimation.model.clone(),
        false_alarms_per_hour: options.false_alarms_per_hour,
        promise,
        threshold,
        evidence,
        condition,
        parameters,
        failure,
        sentences,
        history,
    }
}

/// Scatter before a flag from which an error of the model is named as a possible cause of it: on the develop flights of the
/// field 11 of 18 false alarms lay above, and 7 of 64 true ones.
const UNEXPLAINED: f64 = 10.0;

fn sentences(
    condition: Condition,
    parameters: &[ParameterHealth],
    failure: Option<&FailureReport>,
    evidence: f64,
    promise: &Promise,
    options: &HealthOptions,
) -> Vec<String> {
    let number = |value: f64| short(value);
    let mut sentences = Vec::new();
    if let Some(failure) = failure {
        let onset = match (failure.onset_s, failure.onset_interval_s) {
            (Some(onset), Some([low, high])) => {
                let earlier = if failure.or_earlier { " or earlier" } else { "" };
                format!(", onset {onset:.2} s ({low:.2} to {high:.2} s{earlier})")
            }
            _ => String::new(),
        };
        for parameter in parameters.iter().filter(|p| p.diverged_at_s.is_some()) {
            let at = parameter.diverged_at_s.unwrap_or(failure.flagged_at_s);
            sentences.push(format!(
                "{} diverged from expected {} +- {} at {at:.2} s (flag){onset}; now {} +- {}",
                parameter.name,
                number(parameter.expected),
                number(parameter.tolerance),
                number(parameter.value),
                number(2.0 * parameter.corrected_std_error)
            ));
        }
        if failure.parameters.is_empty() {
            sentences.push(format!(
                "The aircraft diverged from what is expected at {:.2} s (flag){onset}; no single parameter can be named \
                 with the same certainty",
                failure.flagged_at_s
            ));
        }
        let unsure: Vec<&str> = parameters
            .iter()
            .filter(|p| p.diverged_at_s.is_none() && p.deviation.abs() > 2.0)
            .map(|p| p.name.as_str())
            .collect();
        if !unsure.is_empty() {
            sentences.push(format!(
                "Perhaps {}: the estimate ends outside of the tolerance, but did not confirm it soon after the flag",
                unsure.join(", ")
            ));
        }
        if let Some(scatter) = promise.scatter.filter(|scatter| *scatter > UNEXPLAINED) {
            sentences.push(format!(
                "Perhaps none of these: before the flag too the model explained the flight only with {} times the variance \
                 of its noise along these parameters, so that an error of the model may have raised it",
                number(scatter)
            ));
        }
        if promise.holds {
            sentences.push(format!(
                "A healthy aircraft raises such a flag at most once in {} flight hours",
                number(1.0 / options.false_alarms_per_hour)
            ));
        }
        sentences.push(said(promise));
        return sentences;
    }
    sentences.push(match condition {
        Condition::Healthy => format!("All {} monitored parameters are as expected", parameters.len()),
        Condition::Settling => "The record ends before monitoring begins (two seconds after its start)".to_owned(),
        _ => {
            let unknown: Vec<&str> = parameters.iter().filter(|p| !p.known).map(|p| p.name.as_str()).collect();
            let outside: Vec<&str> =
                parameters.iter().filter(|p| p.known && p.deviation.abs() > 2.0).map(|p| p.name.as_str()).collect();
            let mut text = "No divergence, and not enough information to call the aircraft healthy".to_owned();
            if !unknown.is_empty() {
                text.push_str(&format!(": the bounds are wider than the tolerance of {}", unknown.join(", ")));
            }
            if !outside.is_empty() {
                text.push_str(&format!("; the estimate lies outside of the tolerance of {}", outside.join(", ")));
            }
            text
        }
    });
    if evidence.is_finite() && promise.holds {
        sentences.push(format!(
            "Strongest evidence of a failure: as much as a healthy aircraft shows at most once in {} h; the flag needs {} h",
            number(evidence.exp()),
            number(1.0 / options.false_alarms_per_hour)
        ));
    }
    sentences.push(said(promise));
    sentences
}

/// Whether the rate of false alarms is promised. It holds for innovations of the reference that are white and of the
/// level in use; where they are not, where too little of them was seen, or where the levels were learnt from the flight
/// that they judge, nothing is.
fn promise(assumptions: Option<&Assumptions>, learns: bool) -> Promise {
    let finite = |value: f64| value.is_finite().then_some(value);
    let Some(seen) = assumptions else {
        let reason = Some("the record has no samples".to_owned());
        let [level, correlation, scatter, largest_scatter] = [None; 4];
        return Promise { holds: false, reason, level, correlation, scatter, largest_scatter };
    };
    let reason = if learns {
        Some("the noise levels are not given but learnt in flight".to_owned())
    } else if !seen.are_checked() {
        Some("too little has moved before to check what it assumes".to_owned())
    } else if seen.hold() {
        None
    } else {
        // NaN holds nothing.
        let mut broken = Vec::new();
        let level_holds = seen.level <= Assumptions::LARGEST_LEVEL;
        if !level_holds {
            broken.push(format!("their mean square is {} (limit {})", short(seen.level), Assumptions::LARGEST_LEVEL));
        }
        let white = seen.correlation.abs() <= Assumptions::LARGEST_CORRELATION;
        if !white {
            let limit = Assumptions::LARGEST_CORRELATION;
            broken.push(format!("successive ones are correlated by {} (limit {limit})", short(seen.correlation)));
        }
        let scatter_holds = seen.scatter <= seen.largest_scatter();
        if !scatter_holds {
            let limit = short(seen.largest_scatter());
            broken.push(format!(
                "what they say of the parameters scatters {} times (limit {limit})",
                short(seen.scatter)
            ));
        }
        Some(format!("the innovations are not white noise of the level in use: {}", broken.join(", ")))
    };
    Promise {
        holds: reason.is_none(),
        reason,
        level: finite(seen.level),
        correlation: finite(seen.correlation),
        scatter: finite(seen.scatter),
        largest_scatter: finite(seen.largest_scatter()),
    }
}

/// The promise in a sentence.
fn said(promise: &Promise) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), short);
    match &promise.reason {
        None => format!(
            "Checked for this rate on this flight: the innovations' mean square {} (limit {}), correlation {} (limit {}), \
             scatter {} (limit {})",
            number(promise.level),
            Assumptions::LARGEST_LEVEL,
            number(promise.correlation),
            Assumptions::LARGEST_CORRELATION,
            number(promise.scatter),
            number(promise.largest_scatter)
        ),
        Some(reason) => format!(
            "No rate of false alarms is promised for this flight: {reason}; docs/field.md has the rate that was counted \
             on healthy flights of foreign aircraft"
        ),
    }
}

/// Three significant digits, without an exponent where that stays readable.
fn short(value: f64) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..=6).contains(&exponent) {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.*}", (2 - exponent).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
