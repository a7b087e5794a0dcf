//! The health monitor beside an estimator: it sees the same samples and the estimates as they are shown.

use phugoid_estimators::health::{
    self, Assumptions, Expected, Failure, Health, HealthMonitor, MonitorError, MonitorSettings, Watched,
};
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{Estimate, Inspect, Sample};

use crate::core::error::EstimateError;
use crate::core::health::{Condition, HealthHistory, HealthOptions};
use crate::model_file::{Expectation, ModelFile, Parameter, Role};
use crate::motion::MotionModel;

/// Scatter that is assumed at first where the noise levels are learnt in flight, and not known: levels follow the size of
/// residuals, and not what the model lacks. On healthy flights of foreign aircraft it was between one and ten.
const SCATTER: f64 = 8.0;

/// The monitor during a run, with the same room for parameters as the estimator.
pub(crate) struct Monitoring<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> {
    monitor: Box<HealthMonitor<M, N, R, P>>,
    expected: Vec<Expectation>,
    /// Column of the estimator that each expectation belongs to.
    columns: Vec<usize>,
    /// Whether the estimator learns its noise levels in flight.
    learns: bool,
    run: HealthRun,
}

/// The result of the monitor over a record.
#[derive(Clone, Debug, Default)]
pub(crate) struct HealthRun {
    pub(crate) history: HealthHistory,
    pub(crate) threshold: f64,
    /// What was seen of the assumptions behind the rate of false alarms; none before the first sample.
    pub(crate) assumptions: Option<Assumptions>,
    /// Whether the noise levels were learnt in flight.
    pub(crate) learns: bool,
    /// By expectation, at the end: what was found, and whether enough is known of it.
    pub(crate) parameters: Vec<(Expectation, FailedParameter, bool)>,
    /// When the flag was raised, s, and when the failure began.
    pub(crate) failure: Option<(f64, Option<health::Onset>)>,
}

/// When a parameter was named, its change and the change's standard error; NaN where there is none.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FailedParameter {
    pub(crate) named_s: f64,
    pub(crate) change: f64,
    pub(crate) change_std: f64,
}

impl<M: MotionModel<N, R, P>, const N: usize, const R: usize, const P: usize> Monitoring<M, N, R, P> {
    #[inline(never)] // the copies on the stack live only here
    pub(crate) fn new(
        model: &M,
        file: &ModelFile,
        settings: &EstimatorSettings<N, R, P>,
        options: &HealthOptions,
        learns: bool,
    ) -> Result<Self, EstimateError> {
        let own: Vec<&Parameter> = file.estimated().filter(|p| !matches!(p.role, Role::Bias(_))).collect();
        let names: Vec<&str> = own.iter().map(|p| p.name.as_str()).collect();
        let mut entries = vec![None; names.len()];
        let mut columns = Vec::with_capacity(options.expected.len());
        for expectation in &options.expected {
            let Some(column) = names.iter().position(|name| *name == expectation.name) else {
                return Err(EstimateError::NotMonitored { name: expectation.name.clone() });
            };
            let prior = &settings.priors[column];
            let automatic = prior.change_std.std(prior.initial, expectation.value);
            // A parameter that never changes suddenly, or starts at zero: several tolerances are a failure.
            let failure_std = expectation.failure_std.unwrap_or(if automatic > 0.0 {
                automatic
            } else {
                4.0 * expectation.tolerance
            });
            let constant = matches!(&own[column].role, Role::Term(_, term) if term.is_constant());
            entries[column] =
                Some(Expected { value: expectation.value, tolerance: expectation.tolerance, failure_std, constant });
            columns.push(column);
        }
        let mut monitoring =
            MonitorSettings { false_alarms_per_hour: options.false_alarms_per_hour, ..MonitorSettings::default() };
        if learns {
            monitoring.scatter = SCATTER;
        }
        let monitor =
            HealthMonitor::new(model.clone(), settings, &entries, monitoring).map_err(|e| refused(e, &names))?;
        let mut run = HealthRun { threshold: monitor.threshold(), ..HealthRun::default() };
        run.history.deviation = vec![Vec::new(); columns.len()];
        Ok(Self { monitor: Box::new(monitor), expected: options.expected.clone(), columns, learns, run })
    }

    /// Takes the next sample with the estimate as it is shown.
    pub(crate) fn update(
        &mut self,
        sample: &Sample<M::KnownInput, R>,
        estimate: &Estimate<P>,
        estimator: &(impl Inspect<R, P> + ?Sized),
    ) {
        let mut covariance = [[0.0; P]; P];
        estimator.covariance(&mut covariance);
        let noise_std = estimator.noise().map_or([f64::NAN; R], |noise| noise.std);
        let noise_scales: [f64; N] = std::array::from_fn(|state| estimator.process_noise_scale(state));
        let watched = Watched {
            estimate,
            covariance: &covariance,
            residuals: &estimator.innovations().normalised,
            noise_std: &noise_std,
            noise_scales: &noise_scales,
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
        self.run.assumptions = Some(health.assumptions);
        self.run.learns = self.learns;
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
