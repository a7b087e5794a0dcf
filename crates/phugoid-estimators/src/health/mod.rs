//! Health monitoring: whether the plant still has the parameters that are expected of it, and if not, since when and
//! which.
//!
//! Two things are computed. The *estimate* is compared with the expectation: by how much it differs, and whether its
//! bounds are small enough to call the plant healthy. The *flag* does not use the estimate, because successive errors
//! of an estimate are strongly correlated and give no false-alarm rate. It uses the innovations of a reference model
//! that runs with the expected parameters. They are white as long as the expectation holds, so that for every possible
//! onset `s` the mean likelihood of a failure over the likelihood of the best healthy parameters is an e-process, `E <=
//! 1` at every stopping time. Their sum over the onsets, each weighted by the time it stands for, is bounded in the
//! mean by the time flown (an e-detector of Shiryaev and Roberts' kind; J. Shin, A. Ramdas, A. Rinaldo, *E-detectors*,
//! 2023), and so
//!
//! ```text
//! evidence(t) = ln sum_s dt_s E_s(t),      flag when evidence >= ln(1/rate)
//! P(false alarm within T hours) <= rate T,  mean time between false alarms >= 1/rate
//! ```
//!
//! for any number and any correlation of looks. docs/theory.md derives it, says what it assumes, and measures it.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::health::{Condition, Expected, HealthMonitor, MonitorSettings, Watched};
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//! use phugoid_estimators::smpe::Smpe;
//! use phugoid_estimators::{Estimator, Inspect};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let mut estimator = Smpe::new(Lag, settings)?;
//! // a = 3 within 0.3 and b = 2 within 0.3 count as healthy; a failure would change them by about 1.
//! let healthy = |value| Some(Expected { value, tolerance: 0.3, failure_std: 1.0, constant: false });
//! let mut monitor = HealthMonitor::new(Lag, &settings, &[healthy(3.0), healthy(2.0)], MonitorSettings::default()).unwrap();
//! let mut covariance = [[0.0; 2]; 2];
//! let mut flagged_s = None;
//! // a changes to 5 after 15 s.
//! for sample in &flight(20.0, |t| if t < 15.0 { 3.0 } else { 5.0 }) {
//!     let estimate = estimator.update(sample);
//!     estimator.covariance(&mut covariance);
//!     let health = monitor.update(sample, &Watched {
//!         estimate: &estimate,
//!         covariance: &covariance,
//!         residuals: &estimator.innovations().normalised,
//!         noise_std: &estimator.noise().std,
//!         noise_scales: &estimator.process_noise_scales(),
//!     });
//!     if health.condition == Condition::Diverged && flagged_s.is_none() {
//!         flagged_s = Some(sample.time_s);
//!     }
//! }
//! let flagged_s = flagged_s.unwrap();
//! assert!(15.0 < flagged_s && flagged_s < 16.0, "{flagged_s}");
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod assumptions;
mod deviation;
mod evidence;
mod level;
mod onset;
mod reference;
mod scatter;
mod settings;
mod starts;

pub use assumptions::Assumptions;
pub use onset::Onset;
pub use settings::{Expected, MonitorError, MonitorSettings};

use deviation::{Deviation, deviation};
use evidence::{Information, Limits, log_add};
use level::Levels;
use reference::{Parts, Reference};
use starts::{FailureStart, Starts};

use crate::bounded::{Places, at};
use crate::columns::Columns;
use crate::estimate::{ChangeState, Estimate, Phase};
use crate::model::{Model, Sample};
use crate::settings::EstimatorSettings;

/// The hypotheses are weighed this often, s.
const LOOK_S: f64 = 0.05;

/// A hypothesis with less than the others together by this many nats is left out of the sum (a thousandth, to the side
/// of fewer alarms).
const NEGLIGIBLE: f64 = 7.0;

/// Parameters are named up to this long after the flag, s.
const NAMING_S: f64 = 10.0;
/// ... and by what cannot be told from a constant in the last so many seconds of that.
const LATE_S: f64 = 1.0;
/// The estimate confirms a failed parameter when it lies this many corrected standard errors outside of its tolerance,
/// ...
const CONFIRMED: f64 = 3.0;
/// ... for this long, s: its bounds are wrong while it follows a failure.
const CONFIRMED_S: f64 = 0.2;

/// The verdict on the plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Condition {
    /// The noise levels are still being looked at.
    #[default]
    Settling,
    /// No divergence, but too little is known of some parameter to call it healthy: its bounds are wider than the
    /// tolerance, or the estimate lies outside and the evidence is not yet enough.
    Unknown,
    /// Every parameter is known better than its tolerance, and within it as far as is known.
    Healthy,
    /// The plant has diverged from what is expected. The condition stays so until [`HealthMonitor::acknowledge`].
    Diverged,
}

/// What is known of a failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure<const P: usize> {
    /// When it was flagged, s.
    pub flagged_s: f64,
    /// When it began; refined until [`MonitorSettings::refinement_s`] after the flag. None if it cannot be computed.
    pub onset: Option<Onset>,
    /// Difference from the expected value since the onset, parameter units, from the innovations of the reference
    /// alone: linear about the expectation, and good for failures that are small enough for that. For the present value
    /// take the estimate. Zero for parameters that are not monitored.
    pub change: [f64; P],
    /// Standard deviation of [`Self::change`], parameter units.
    pub change_std: [f64; P],
    /// When the parameter was named as one that has diverged, s: NaN until then. It takes as much evidence as the flag,
    /// against the parameter anywhere within its tolerance and all others anywhere, or against no change of it where it
    /// alone (the constants together) explains what is seen, the values before the onset taken for granted; and the estimate, which is not linear about the expectation, has to lie outside of the tolerance by
    /// more than three corrected standard errors for 0.2 s.
    pub named_s: [f64; P],
}

/// What the monitor says after one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Health<const P: usize> {
    /// Time of the sample, s.
    pub time_s: f64,
    /// Whether the plant is healthy, has diverged, or cannot be judged yet.
    pub condition: Condition,
    /// How far the estimate lies outside of the tolerance, in corrected standard errors, with its sign; zero inside.
    pub deviation: [f64; P],
    /// Parameters too little known to call them healthy.
    pub unknown: [bool; P],
    /// Squared distance of the estimate from the nearest healthy parameters, in its corrected covariance: all
    /// parameters together. NaN if it cannot be computed.
    pub joint_deviation: f64,
    /// Evidence of a failure, the natural logarithm of hours: a healthy plant shows this much at most once in
    /// `exp(evidence)` hours, as far as the assumptions hold ([`Assumptions::hold`]).
    pub evidence: f64,
    /// What was seen of the assumptions behind the rate of false alarms, up to the flag.
    pub assumptions: Assumptions,
    /// The failure, from the sample at which it was flagged until it is acknowledged.
    pub failure: Option<Failure<P>>,
}

/// What the estimator said of the same sample.
#[derive(Clone, Copy, Debug)]
pub struct Watched<'a, const R: usize, const P: usize> {
    /// The estimate that the estimator gave for this sample.
    pub estimate: &'a Estimate<P>,
    /// Its covariance, of which the correlations are used ([`crate::Estimator::covariance`]).
    pub covariance: &'a [[f64; P]; P],
    /// Its normalised residuals, NaN where missing: they tell the noise levels, before and after a failure.
    pub residuals: &'a [f64; R],
    /// One sigma of the noise per output in the estimator's use, output units, which its residuals are normalised by.
    /// The reference uses the same from the next sample on; where it is not finite and positive, what it used before.
    pub noise_std: &'a [f64; R],
    /// Its scale of each state's process noise; one that is missing or not finite counts as 1.
    pub noise_scales: &'a [f64],
}

/// The monitor: `N` states, `R` outputs, room for `P` columns. No allocation; bounded work per sample.
pub struct HealthMonitor<M, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    settings: MonitorSettings,
    expected: [Option<Expected>; P],
    parts: Parts<P>,
    reference: Reference<M, N, R, P>,
    starts: Starts<N, P>,
    levels: Levels<R>,
    first_s: f64,
    last_s: f64,
    last_look_s: f64,
    evidence: f64,
    /// Noise in the estimator's use at the last sample.
    noise_std: [f64; R],
    assumptions: Assumptions,
    failure: Option<Failure<P>>,
    /// Since when each column would be named, s; NaN: it would not.
    convincing_since_s: [f64; P],
}

impl<M, const N: usize, const R: usize, const P: usize> HealthMonitor<M, N, R, P>
where
    M: Model<N, R, P>,
{
    /// A monitor beside the estimator with these settings. `expected` has one entry per parameter of the model; columns
    /// without an expectation are learnt along with the state.
    ///
    /// # Errors
    /// [`MonitorError`]: an impossible expectation or setting.
    pub fn new(
        model: M,
        estimator: &EstimatorSettings<N, R, P>,
        expected: &[Option<Expected>],
        settings: MonitorSettings,
    ) -> Result<Self, MonitorError> {
        settings.check()?;
        estimator.check(model.parameter_count()).map_err(MonitorError::Estimator)?;
        let columns = Columns::new(estimator, model.parameter_count());
        let mut parts =
            Parts { monitored: Places::NONE, failure_std: [0.0; P], constant: [false; P], nuisance: Places::NONE };
        let mut width = [0.0; P];
        let mut theta = columns.initial;
        let mut all = [None; P];
        for column in 0..columns.count() {
            let expectation = if column < columns.own() { expected.get(column).copied().flatten() } else { None };
            if let Some(expectation) = expectation {
                check(column, &expectation)?;
                let place = parts.monitored.len();
                if place < P {
                    parts.failure_std[place] = expectation.failure_std;
                    parts.constant[place] = expectation.constant;
                    width[place] = expectation.tolerance / expectation.failure_std;
                }
                parts.monitored.push(column);
                theta[column] = expectation.value;
                all[column] = Some(expectation);
            } else if columns.std[column] > 0.0 {
                parts.nuisance.push(column);
            }
        }
        if parts.monitored.len() == 0 {
            return Err(MonitorError::NothingExpected);
        }
        Ok(Self {
            settings,
            expected: all,
            reference: Reference::new(model, *estimator, columns, parts, theta),
            starts: Starts::new(parts.monitored.len(), parts.nuisance.len(), width, &settings),
            levels: Levels::new(),
            parts,
            first_s: f64::NAN,
            last_s: f64::NEG_INFINITY,
            last_look_s: f64::NEG_INFINITY,
            evidence: f64::NEG_INFINITY,
            noise_std: [f64::NAN; R],
            assumptions: Assumptions::NONE,
            failure: None,
            convincing_since_s: [f64::NAN; P],
        })
    }

    /// What is expected, per column.
    pub fn expected(&self) -> &[Option<Expected>; P] {
        &self.expected
    }

    /// Evidence at which the flag is raised, the natural logarithm of hours.
    pub fn threshold(&self) -> f64 {
        -libm::log(self.settings.false_alarms_per_hour)
    }

    /// Takes the next sample and what the estimator made of it. A sample whose time does not increase is ignored.
    pub fn update(&mut self, sample: &Sample<M::Input, R>, watched: &Watched<'_, R, P>) -> Health<P> {
        if sample.time_s.is_finite() && sample.time_s > self.last_s {
            self.last_s = sample.time_s;
            if self.first_s.is_nan() {
                self.first_s = sample.time_s;
            }
            self.observe(sample, watched);
        }
        self.health(watched)
    }

    /// Takes note of the failure and begins to watch anew, for the same expectation.
    pub fn acknowledge(&mut self) {
        self.failure = None;
        self.convincing_since_s = [f64::NAN; P];
        self.starts.clear();
        self.evidence = f64::NEG_INFINITY;
    }

    fn observe(&mut self, sample: &Sample<M::Input, R>, watched: &Watched<'_, R, P>) {
        let time_s = sample.time_s;
        let open = self.failure.is_none() && time_s - self.first_s >= self.settings.settle_s;
        let horizon_s = self.settings.horizon_s;
        let scales = core::array::from_fn(|state| {
            let given = watched.noise_scales.get(state).copied().filter(|scale| scale.is_finite());
            given.map_or(1.0, |scale| scale.max(0.0))
        });
        self.reference.set_noise(&self.noise_std);
        self.reference.update(sample, &scales, &self.levels, &mut self.starts, |starts| {
            if open {
                starts.open(time_s, horizon_s);
            }
        });
        self.noise_std = *watched.noise_std;
        // Only after the frame was judged, so that the noise level it was judged by does not depend on it.
        let steady = watched.estimate.status.change == ChangeState::Steady;
        if steady && watched.estimate.status.phase != Phase::Starting {
            self.levels.add(time_s, watched.residuals);
        }
        if self.reference.is_running() && time_s - self.last_look_s >= LOOK_S - 1e-9 {
            self.last_look_s = time_s;
            self.look(time_s, watched);
        }
    }

    /// Sums the evidence of all hypotheses, and describes the failure once it is enough for the flag.
    fn look(&mut self, time_s: f64, watched: &Watched<'_, R, P>) {
        let Some(failure) = self.failure else {
            self.reference.recentre(&mut self.starts);
            self.starts.look_at_scatter(time_s);
            self.assumptions = Assumptions::of(self.reference.seen(), self.starts.scatter());
            self.evidence = f64::NEG_INFINITY;
            // The youngest first: most old ones have little evidence by now and are then left out of the sum.
            for start in self.starts.iter().rev() {
                let value =
                    start.log_weight + self.starts.evidence(start, self.evidence - NEGLIGIBLE - start.log_weight);
                // Evidence that cannot be computed does not count.
                if value.is_finite() {
                    self.evidence = log_add(self.evidence, value);
                }
            }
            if self.evidence >= self.threshold() {
                let mut failure = Failure {
                    flagged_s: time_s,
                    onset: None,
                    change: [0.0; P],
                    change_std: [0.0; P],
                    named_s: [f64::NAN; P],
                };
                self.describe(time_s, watched, &mut failure);
                self.failure = Some(failure);
            }
            return;
        };
        let since_s = time_s - failure.flagged_s - 1e-9;
        if since_s <= self.settings.refinement_s.max(NAMING_S) {
            let mut refined = failure;
            self.describe(time_s, watched, &mut refined);
            if since_s > self.settings.refinement_s {
                refined = Failure { named_s: refined.named_s, ..failure };
            }
            self.failure = Some(refined);
        } else {
            // The description of this failure is complete; its hypotheses are not needed any more.
            self.starts.clear();
        }
    }

    /// Onset, size and names of a failure, from the hypotheses.
    fn describe(&mut self, time_s: f64, watched: &Watched<'_, R, P>, failure: &mut Failure<P>) {
        let outside = deviation(&self.expected, watched.estimate, watched.covariance).outside;
        let (n, threshold) = (self.parts.monitored.len(), self.threshold());
        failure.onset = onset::onset(&self.starts);
        let mut best = (f64::NEG_INFINITY, 0);
        let mut named = [f64::NEG_INFINITY; P];
        for (place, start) in self.starts.iter().enumerate() {
            let whole = self.starts.whole(start);
            if whole > best.0 {
                best = (whole, place);
            }
            let change = self.starts.change(start);
            let log = change.failure(n);
            let within = change.best_with_one_within(&start.healthy, self.starts.limits(), n);
            for (sum, bound) in named[..n].iter_mut().zip(&within) {
                if log.is_finite() && bound.is_finite() {
                    *sum = log_add(*sum, start.log_weight + log - bound);
                }
            }
        }
        let Some(start) = self.starts.get(best.1) else { return };
        let change = self.starts.change(start);
        let misfit = self.starts.misfit(start).max(1.0);
        let late = time_s - failure.flagged_s >= NAMING_S - LATE_S;
        let causes = causes(&change, start, self.starts.limits(), &self.parts.constant, misfit, late, n);
        let (mean, variance) = change.deviation(n);
        for place in 0..n {
            let column = self.parts.monitored.column(place);
            failure.change[column] =
                (self.starts.centre()[place] + start.healthy[place] + mean[place]) * self.parts.failure_std[place];
            failure.change_std[column] = libm::sqrt(variance[place]) * self.parts.failure_std[place];
            let since_s = &mut self.convincing_since_s[column];
            let by_all = named[place] >= threshold && (self.parts.constant[place] || !causes.constants_suffice);
            let by_cause = start.log_weight + causes.against[place] >= threshold;
            if outside[column].abs() <= CONFIRMED || !(by_all || by_cause) {
                *since_s = f64::NAN;
                continue;
            }
            if since_s.is_nan() {
                *since_s = time_s;
            }
            if failure.named_s[column].is_nan() && time_s - *since_s >= CONFIRMED_S - 1e-9 {
                failure.named_s[column] = time_s;
            }
        }
    }

    fn health(&self, watched: &Watched<'_, R, P>) -> Health<P> {
        let estimate = watched.estimate;
        let Deviation { outside, unknown, joint } = deviation(&self.expected, estimate, watched.covariance);
        let doubtful = outside.iter().any(|z| z.abs() > 2.0) || unknown.contains(&true) || !joint.is_finite();
        let settled = self.last_s - self.first_s >= self.settings.settle_s;
        let condition = if self.failure.is_some() {
            Condition::Diverged
        } else if !self.reference.is_running() || !settled {
            Condition::Settling
        } else if doubtful || estimate.status.change == ChangeState::InDoubt {
            Condition::Unknown
        } else {
            Condition::Healthy
        };
        Health {
            time_s: self.last_s,
            condition,
            deviation: outside,
            unknown,
            joint_deviation: joint,
            evidence: self.evidence,
            assumptions: self.assumptions,
            failure: self.failure,
        }
    }
}

/// A single cause that explains what is seen of a failure.
struct Causes<const P: usize> {
    /// Changed constants explain it about as well as changes of everything.
    constants_suffice: bool,
    /// By how many nats that cause explains it better than it does with this column within its tolerance. Minus infinity
    /// for columns of other causes, and where no single cause explains it, or two do.
    against: [f64; P],
}

/// Nats, beside half a nat for each column, by which changes of everything may explain more than a cause that suffices;
/// twice the difference is distributed as chi square if nothing else has changed.
const SUFFICIENT: f64 = 6.0;
/// Nats by which a cause has to explain more than each other one.
const CLEARLY: f64 = 5.0;

/// Compares the causes: the constants together, and each derivative alone. Nats are divided by the misfit, as for the
/// onset. Constants that suffice win late, at the end of the time for naming, over derivatives that explain it equally
/// well: what has not moved by then cannot be told from a constant, and a derivative is not named without evidence.
fn causes<const N: usize, const P: usize>(
    change: &Information<P>,
    start: &FailureStart<N, P>,
    limits: &Limits<P>,
    constant: &[bool; P],
    misfit: f64,
    late: bool,
    n: usize,
) -> Causes<P> {
    let n = n.min(P);
    let all = change.best(n);
    let suffices = |nats: f64| (all - nats) / misfit <= SUFFICIENT + 0.5 * n as f64;
    let is_constant: [bool; P] = core::array::from_fn(|j| j < n && constant[j]);
    let constants = change.restricted(&is_constant, n);
    let of_constants = if is_constant.contains(&true) { constants.best(n) } else { f64::NEG_INFINITY };
    let alone = |j: usize| change.restricted(&core::array::from_fn(|k| k == j), n);
    // The best derivative and the second best explanation.
    let (mut best, mut second, mut which) = (f64::NEG_INFINITY, f64::NEG_INFINITY, None);
    for j in 0..n {
        if constant[j] {
            continue;
        }
        let value = alone(j).best(n);
        if value > best {
            (second, best, which) = (best, value, Some(j));
        } else {
            second = second.max(value);
        }
    }
    let mut result = Causes { constants_suffice: suffices(of_constants), against: [f64::NEG_INFINITY; P] };
    let clearly = |one: f64, other: f64| (one - other) / misfit >= CLEARLY;
    if result.constants_suffice && (clearly(of_constants, best) || late) {
        let within = constants.best_with_one_within(&start.healthy, limits, n);
        for j in 0..n {
            if constant[j] {
                result.against[j] = (of_constants - within[j]) / misfit;
            }
        }
    } else if let Some(j) = which
        && suffices(best)
        && clearly(best, second.max(of_constants))
    {
        let within = alone(j).best_with_one_within(&start.healthy, limits, n);
        if let Some(against) = result.against.get_mut(j) {
            *against = (best - at(&within, j)) / misfit;
        }
    }
    for value in &mut result.against {
        if value.is_nan() {
            *value = f64::NEG_INFINITY;
        }
    }
    result
}

fn check(parameter: usize, expected: &Expected) -> Result<(), MonitorError> {
    let Expected { value, tolerance, failure_std, constant: _ } = *expected;
    if !value.is_finite() {
        return Err(MonitorError::Expected { parameter, name: "value", value });
    }
    for (name, value) in [("tolerance", tolerance), ("failure_std", failure_std)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(MonitorError::Expected { parameter, name, value });
        }
    }
    Ok(())
}
