//! The arguments of a run of a method, and its result.

use phugoid_estimators::{DetectorReport, Innovations, ParameterStatus, Phase, Status};

use super::consistency::OutputUse;
use super::gate::DisplacedConstant;
use super::health_watch::HealthRun;
use super::readiness::ColumnVerdict;
use super::snapshot::Snapshot;
use crate::core::estimation::{BatchReport, ChangeOutcome, Event, OtherValue, SecondAnswer};
use crate::core::health::HealthOptions;
use crate::core::method::Method;
use crate::core::options::{EstimateOptions, Opens};
use crate::core::systematic::{LearntQuantity, SystematicPart};
use crate::core::term::Coefficient;
use crate::model_file::ModelFile;
use crate::motion::Motion;
use crate::preparation::noise::NoiseLevel;
use crate::preparation::prepared::Prepared;

/// The result of one run, by sample and by column.
#[derive(Clone, Debug)]
pub(crate) struct Run<const R: usize> {
    /// One per estimated parameter, in the order of the columns.
    pub(crate) columns: Vec<ColumnRun>,
    pub(crate) predicted: Vec<[f64; R]>,
    pub(crate) residuals: Vec<[f64; R]>,
    /// Bounded logarithm of the density that each innovation had before it was seen ([`log_density`]), by sample: NaN
    /// where there was none and before anything had moved. Empty for a batch method.
    pub(crate) log_density: Vec<[f64; R]>,
    pub(crate) phases: Vec<Phase>,
    /// How each output agreed with its predictions, in the order of the rows. Empty for a batch method.
    pub(crate) consistency: Vec<OutputUse>,
    pub(crate) events: Vec<Event>,
    /// Of the parameters at the end, row and column as in `columns`.
    pub(crate) covariance: Vec<Vec<f64>>,
    /// Status of the estimator after the last sample.
    pub(crate) status: Status,
    pub(crate) detector: Option<DetectorReport>,
    /// The adopted changes, in order of time.
    pub(crate) changes: Vec<RunChange>,
    /// The noise levels that were learnt in flight; `None` of a method that uses those of its settings.
    pub(crate) noise: Option<LearntNoise<R>>,
    /// True if any motion was visible above the noise.
    pub(crate) excited: bool,
    /// The result of the health monitor; `None` without one.
    pub(crate) health: Option<HealthRun>,
    /// The additional results of a batch method; `None` for a causal one.
    pub(crate) batch: Option<BatchReport>,
    /// The parameters by another method; `None` where it gives none.
    pub(crate) second_answer: Option<SecondAnswer>,
    /// The parameters by a filter, of a method whose second answer is that of equation error.
    pub(crate) third_answer: Option<SecondAnswer>,
    /// What the surfaces explain of the motion.
    pub(crate) by_surfaces: BySurfaces,
    /// Why another method that should stand beside this one gives none.
    pub(crate) no_second_answer: Option<String>,
    /// A change that was not believed when the record was looked at again; `None` where there is none with much evidence.
    pub(crate) disputed: Option<Disputed>,
    /// What another start made of the run; `None` where it is from the starts of the model file.
    pub(crate) begun_again: Option<BegunAgain>,
    /// What is said of errors of the tables of the base; none where the declared ones were not worked out.
    pub(crate) said_of_base: Option<String>,
    /// True if errors of the declared constants were followed, false if they are carried by the powers of the scales.
    pub(crate) follows_constants: bool,
    /// The declared constants of which the flight itself says what they are, whether that is used or not.
    pub(crate) learnt: Vec<LearntQuantity>,
}

/// A run that began at other values than those of the model file, because they predict the record better.
#[derive(Clone, Debug)]
pub(crate) struct BegunAgain {
    /// How much better, nats.
    pub(crate) gain: f64,
    /// The column that is the most another one at the end than from the starts of the model file, and its value from there.
    pub(crate) most: Option<(usize, f64)>,
}

/// A moment at which a record asks for other parameters, though none of them shows that the aircraft changed.
#[derive(Clone, Debug)]
pub(crate) struct Disputed {
    /// The moment, s.
    pub(crate) time_s: f64,
    /// How much better the record is predicted with the parameters opened there, nats.
    pub(crate) gain: f64,
    /// The values with them opened there, and their corrected standard errors, by column; none for one that is not settled then.
    pub(crate) opened: Vec<Option<[f64; 2]>>,
}

impl<const R: usize> Run<R> {
    /// Logarithm of the density that the run gave to the record, sample by sample before it saw it, nats; zero of a batch method.
    pub(crate) fn evidence(&self) -> f64 {
        self.evidence_from(0)
    }

    /// The first sample with a prediction after something has moved; the first one of all where there is none. Before it the parameters
    /// have the errors of their priors.
    pub(crate) fn first_moved(&self) -> usize {
        self.log_density.iter().position(|row| row.iter().any(|nats| nats.is_finite())).unwrap_or(0)
    }

    /// The same of the samples from this one on.
    pub(crate) fn evidence_from(&self, sample: usize) -> f64 {
        self.log_density.iter().skip(sample).flatten().filter(|nats| nats.is_finite()).sum()
    }
}

/// An adopted change, and what was estimated before and after it.
#[derive(Clone, Debug)]
pub(crate) struct RunChange {
    pub(crate) time_s: f64,
    /// The times between which it happened, s; `None` where it was found in flight or given.
    pub(crate) interval_s: Option<[f64; 2]>,
    /// The parameters that may have changed.
    pub(crate) opens: Opens,
    pub(crate) outcome: ChangeOutcome,
    pub(crate) before: Snapshot,
    pub(crate) after: Snapshot,
}

/// The noise levels at the end of a run that has learnt them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LearntNoise<const R: usize> {
    /// One sigma of the residual per output, SI.
    pub(crate) std: [f64; R],
    /// True if the run ended before the levels were known.
    pub(crate) is_provisional: bool,
}

/// The result of one run for one parameter.
#[derive(Clone, Debug)]
pub(crate) struct ColumnRun {
    /// Estimate after each sample, in the parameter's unit.
    pub(crate) values: Vec<f64>,
    /// By sample, corrected for the colour of the residuals.
    pub(crate) std_errors: Vec<f64>,
    /// By sample, what the flight says of the declared constants adds to the estimate, which the values are without: judgements hold them
    /// against methods and equations that do not know of it. Empty where nothing is learnt.
    pub(crate) learnt_shifts: Vec<f64>,
    /// Correction that the estimator would have liked to make at each sample, in the parameter's unit, for display.
    pub(crate) surfaces: Vec<f64>,
    /// The rest: at the end.
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    pub(crate) corrected_std_error: f64,
    /// The part of it that the model file declares.
    pub(crate) systematic_std: f64,
    /// What makes that part, the largest share first.
    pub(crate) systematic_parts: Vec<SystematicPart>,
    pub(crate) observability: f64,
    pub(crate) status: ParameterStatus,
    pub(crate) change_sensitivity: f64,
    /// Whether the value can be used, and since when.
    pub(crate) verdict: ColumnVerdict,
}

impl ColumnRun {
    /// The values by sample as they are shown: with what the flight says of the declared constants.
    pub(crate) fn shown_values(&self) -> Vec<f64> {
        let shifts = self.learnt_shifts.iter().copied().chain(std::iter::repeat(0.0));
        self.values.iter().zip(shifts).map(|(value, shift)| value + shift).collect()
    }
}

/// The parameters from what the surfaces explain of the motion; empty where that gives none.
#[derive(Clone, Debug, Default)]
pub(crate) struct BySurfaces {
    pub(crate) values: Vec<OtherValue>,
    /// The moments of which the whole motion gives a regression other derivatives than what the surfaces made of it: something that lasts, as air
    /// that turns, bends them.
    pub(crate) bent: Vec<Coefficient>,
}

/// The arguments of a run of a method.
pub(crate) struct Task<'a, M: Motion<N, R>, const N: usize, const R: usize> {
    pub(crate) prepared: &'a Prepared<M, N, R>,
    pub(crate) file: &'a ModelFile,
    pub(crate) options: &'a EstimateOptions,
    pub(crate) noise: &'a [NoiseLevel; R],
    /// The options of the health monitor; `None` without one.
    pub(crate) health: Option<&'a HealthOptions>,
    pub(crate) model_error: ModelError,
    /// The constant that is off in the model, of a run that is to show what it does; `None` in all others.
    pub(crate) displaced: Option<&'a DisplacedConstant>,
}

/// How the process noise of the rates is learnt, which stands for the moments that the model lacks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ModelError {
    /// Once the parameters are known it rises slowly, so that a sudden change of the aircraft is not taken for it.
    Slow,
    /// As fast as the data say: where changes have been looked for already.
    Free,
}

impl<'a, M: Motion<N, R>, const N: usize, const R: usize> Task<'a, M, N, R> {
    /// A run without a health monitor. Where nobody looks for sudden changes, nothing can be taken for model error that is one.
    pub(crate) fn new(
        prepared: &'a Prepared<M, N, R>,
        file: &'a ModelFile,
        options: &'a EstimateOptions,
        noise: &'a [NoiseLevel; R],
    ) -> Self {
        let looks = options.change_detection.unwrap_or(file.change_detection);
        let model_error = if looks { ModelError::Slow } else { ModelError::Free };
        Self { prepared, file, options, noise, health: None, model_error, displaced: None }
    }

    /// The same with another model file.
    pub(crate) fn with_file<'b>(&self, file: &'b ModelFile) -> Task<'b, M, N, R>
    where
        'a: 'b,
    {
        let Self { prepared, options, noise, health, model_error, displaced, .. } = *self;
        Task { prepared, file, options, noise, health, model_error, displaced }
    }

    /// The method: as asked for, else as the model file says.
    pub(crate) fn method(&self) -> Method {
        self.options.method.unwrap_or(self.file.estimator.method)
    }

    /// Whether errors of declared constants are to be followed: the method can, the motion has some, and some are declared.
    pub(crate) fn follows_constants(&self) -> bool {
        self.method().follows_constants() && self.declares_constants()
    }

    /// Whether there are constants to follow: the motion has some, and some are declared.
    pub(crate) fn declares_constants(&self) -> bool {
        self.file.uncertainty.follows() && !M::CONSTANTS.is_empty()
    }
}

/// `-(min(xi^2, 9) + ln S)/2` of each row, nats, without the constant `ln(2 pi)/2`: the score of the change detector's
/// contest (docs/theory.md), so that one outlier costs 4.5 nats and no more.
pub(crate) fn log_density<const R: usize>(innovations: &Innovations<R>) -> [f64; R] {
    std::array::from_fn(|i| {
        let xi = innovations.normalised[i];
        // `f64::min` ignores NaN and would turn a missing row into a number.
        if xi.is_finite() { -0.5 * ((xi * xi).min(9.0) + innovations.variance[i].ln()) } else { f64::NAN }
    })
}
