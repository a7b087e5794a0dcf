//! From a flight record, a model file and what is expected to the health of the aircraft.

use phugoid_estimators::health::{
    self, Expected, Failure, Health, HealthMonitor, MonitorError, MonitorSettings, Watched,
};
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{Estimate, Inspect, Sample};
use phugoid_flight_data::record::Record;

use crate::error::EstimateError;
use crate::estimate::pipeline;
use crate::estimation::Estimation;
use crate::health::{Condition, FailureReport, HealthHistory, HealthOptions, HealthReport, ParameterHealth};
use crate::model_file::{Expectation, ModelFile, Role};
use crate::motion::MotionModel;
use crate::options::EstimateOptions;

/// Estimates the parameters of `model` from `record` as [`crate::estimate::estimate`] does, and watches beside it whether they
/// are what is expected: sample by sample, no verdict uses a later sample. `progress` is called with the fraction done, 0 to 1.
///
/// # Errors
/// Those of [`crate::estimate::estimate`]; [`EstimateError::Model`] for expectations that cannot be monitored.
pub fn monitor(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    health: &HealthOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<(Estimation, HealthReport), EstimateError> {
    let (estimation, run) = pipeline(record, model, options, Some(health), progress)?;
    let run = run.ok_or_else(|| EstimateError::Model("the estimator was run without its monitor".to_owned()))?;
    let report = report(&estimation, health, run);
    Ok((estimation, report))
}

/// The monitor while a record is run, in the room of the estimator beside it.
pub(crate) struct Monitoring<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> {
    monitor: Box<HealthMonitor<M, N, R, P>>,
    expected: Vec<Expectation>,
    /// Column of each expectation.
    columns: Vec<usize>,
    run: HealthRun,
}

/// What the monitor said over a record.
#[derive(Clone, Debug, Default)]
pub(crate) struct HealthRun {
    history: HealthHistory,
    threshold: f64,
    /// By expectation, at the end.
    parameters: Vec<(Expectation, FailedParameter, bool)>,
    failure: Option<(f64, Option<health::Onset>)>,
}

/// When a parameter was named, its change and the change's standard error; NaN where there is none.
#[derive(Clone, Copy, Debug, Default)]
struct FailedParameter {
    named_s: f64,
    change: f64,
    change_std: f64,
}

impl<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> Monitoring<M, N, R, P> {
    #[inline(never)] // the copies on the stack live only here
    pub(crate) fn new(
        model: &M,
        file: &ModelFile,
        settings: &EstimatorSettings<N, R, P>,
        options: &HealthOptions,
    ) -> Result<Self, EstimateError> {
        let names: Vec<&str> =
            file.estimated().filter(|p| !matches!(p.role, Role::Bias(_))).map(|p| p.name.as_str()).collect();
        let mut entries = vec![None; names.len()];
        let mut columns = Vec::with_capacity(options.expected.len());
        for expectation in &options.expected {
            let Some(column) = names.iter().position(|name| *name == expectation.name) else {
                let message = format!("`{}` is expected, but the model does not estimate it", expectation.name);
                return Err(EstimateError::Model(message));
            };
            let prior = &settings.priors[column];
            let automatic = prior.change_std.std(prior.initial, expectation.value);
            // A parameter that never changes suddenly, or starts at zero: several tolerances are a failure.
            let failure_std = expectation.failure_std.unwrap_or(if automatic > 0.0 {
                automatic
            } else {
                4.0 * expectation.tolerance
            });
            entries[column] =
                Some(Expected { value: expectation.value, tolerance: expectation.tolerance, failure_std });
            columns.push(column);
        }
        let monitoring =
            MonitorSettings { false_alarms_per_hour: options.false_alarms_per_hour, ..MonitorSettings::default() };
        let monitor =
            HealthMonitor::new(model.clone(), settings, &entries, monitoring).map_err(|e| refused(e, &names))?;
        let mut run = HealthRun { threshold: monitor.threshold(), ..HealthRun::default() };
        run.history.deviation = vec![Vec::new(); columns.len()];
        Ok(Self { monitor: Box::new(monitor), expected: options.expected.clone(), columns, run })
    }

    /// Takes the next sample with the estimate as it is shown.
    pub(crate) fn update(
        &mut self,
        sample: &Sample<M::KnownInput, R>,
        estimate: &Estimate<P>,
        estimator: &impl Inspect<R, P>,
    ) {
        let mut covariance = [[0.0; P]; P];
        estimator.covariance(&mut covariance);
        let watched = Watched {
            estimate,
            covariance: &covariance,
            residuals: &estimator.innovations().normalised,
            noise_scale: estimator.process_noise_scale(),
        };
        let health = self.monitor.update(sample, &watched);
        let history = &mut self.run.history;
        history.time_s.push(sample.time_s);
        history.condition.push(match health.condition {
            health::Condition::Settling => Condition::Settling,
            health::Condition::Unknown => Condition::Unknown,
            health::Condition::Healthy => Condition::Healthy,
            health::Condition::Diverged => Condition::Diverged,
        });
        history.evidence.push(health.evidence);
        history.joint_deviation.push(health.joint_deviation);
        for (deviation, column) in history.deviation.iter_mut().zip(&self.columns) {
            deviation.push(health.deviation[*column]);
        }
        self.note(&health);
    }

    fn note(&mut self, health: &Health<P>) {
        let failed = |column: usize| {
            let nothing = FailedParameter { named_s: f64::NAN, change: f64::NAN, change_std: f64::NAN };
            health.failure.as_ref().map_or(nothing, |failure: &Failure<P>| FailedParameter {
                named_s: failure.named_s[column],
                change: failure.change[column],
                change_std: failure.change_std[column],
            })
        };
        self.run.failure = health.failure.as_ref().map(|f| (f.flagged_s, f.onset));
        let entries = self.expected.iter().zip(&self.columns);
        self.run.parameters = entries.map(|(e, c)| (e.clone(), failed(*c), !health.unknown[*c])).collect();
    }

    pub(crate) fn finish(self) -> HealthRun {
        self.run
    }
}

fn refused(error: MonitorError, names: &[&str]) -> EstimateError {
    EstimateError::Model(match error {
        MonitorError::Expected { parameter, name, value } => {
            let parameter = names.get(parameter).copied().unwrap_or_default();
            format!("the expected {name} of `{parameter}` is {value}: values are finite, tolerances more than zero")
        }
        MonitorError::NothingExpected => {
            "nothing to monitor: no estimated parameter of the model has an expected value".to_owned()
        }
        other => other.to_string(),
    })
}

fn report(estimation: &Estimation, options: &HealthOptions, run: HealthRun) -> HealthReport {
    let HealthRun { history, threshold, parameters, failure } = run;
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
                diverged_at_s: finite(found.named_s),
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
    let sentences = sentences(condition, &parameters, failure.as_ref(), evidence, options);
    HealthReport {
        source: estimation.source.clone(),
        model: estimation.model.clone(),
        false_alarms_per_hour: options.false_alarms_per_hour,
        threshold,
        evidence,
        condition,
        parameters,
        failure,
        sentences,
        history,
    }
}

fn sentences(
    condition: Condition,
    parameters: &[ParameterHealth],
    failure: Option<&FailureReport>,
    evidence: f64,
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
        sentences.push(format!(
            "A healthy aircraft raises such a flag at most once in {} flight hours",
            number(1.0 / options.false_alarms_per_hour)
        ));
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
    if evidence.is_finite() {
        sentences.push(format!(
            "Strongest evidence of a failure: as much as a healthy aircraft shows at most once in {} h; the flag needs {} h",
            number(evidence.exp()),
            number(1.0 / options.false_alarms_per_hour)
        ));
    }
    sentences
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
