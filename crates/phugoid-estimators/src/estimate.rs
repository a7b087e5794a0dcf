//! The estimate that an estimator gives after each sample, and the traits of an estimator.

use crate::innovation::Innovations;
use crate::levels::NoiseReport;
use crate::model::{Input, Sample};
use crate::supervisor::learnt::Evidence;

/// Observability below which a parameter counts as not excited: its bound has shrunk by less than 30 %. Lower would not
/// do: the noise of the estimated state alone, minute after minute, looks like a little excitation.
pub(crate) const EXCITED: f64 = 0.5;
/// Part of the prior standard deviation (or of twice the change prior, if that is smaller) below which a parameter
/// counts as converged.
pub(crate) const CONVERGED: f64 = 0.1;

/// Internal quantities of the change detector.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectorReport {
    /// Largest log Bayes factor of the last test, nats: change against wander.
    pub bayes_factor: f64,
    /// `w`: how far the parameters wander without any change, as a part of the change prior. Model error.
    pub wander: f64,
    /// `lev >= 1`: variance of the residuals over what the noise levels promise, at the time scale of the window.
    pub leverage: f64,
    /// Windows worth of information the wander was learnt from; armed from ten on.
    pub informative_windows: f64,
    /// Score of the running challenger on fresh data, nats; zero when none runs.
    pub challenger_score: f64,
    /// Number of challengers that have replaced the running estimate so far: detected changes.
    pub adoptions: u32,
    /// Number of challengers that were dropped so far: suspicions that did not hold.
    pub dropped: u32,
    /// Latched: the wander stayed large after an adoption, so the model itself is in error and changes are no longer
    /// adopted.
    pub model_error: bool,
}

/// How the last frame met the sliding surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Phase {
    /// Collecting the samples from which the state is started.
    #[default]
    Starting,
    /// Every row was inside the boundary layer: equivalent control.
    Sliding,
    /// A row was outside the boundary layer and moved the parameters with bounded influence.
    Reaching,
    /// A row was so far away that no parameter inside the bounds explains it; it was not used. Or the whole sample was
    /// refused because its time did not increase.
    Rejected,
    /// No measurement in this frame: prediction only.
    Predicting,
    /// The estimate stopped being a number and the estimator with it: only a law that is evaluated as printed does
    /// this.
    Diverged,
}

impl Phase {
    /// Its word in results: that of its serialised form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Sliding => "sliding",
            Self::Reaching => "reaching",
            Self::Rejected => "rejected",
            Self::Predicting => "predicting",
            Self::Diverged => "diverged",
        }
    }
}

impl core::fmt::Display for Phase {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.word())
    }
}

/// Whether the change detector suspects or has found a change of the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum ChangeState {
    /// No change of the parameters is suspected.
    #[default]
    Steady,
    /// A change is suspected and a challenger runs beside the estimate: the reported bounds are widened.
    InDoubt,
    /// The challenger was adopted at this sample: the parameters changed. Results of older versions say `re_reached`.
    #[cfg_attr(feature = "serde", serde(alias = "re_reached"))]
    Adopted,
    /// A change was adopted and the former estimate still runs as its rival: it is given up once everything that was
    /// re-opened has been excited and the new estimate has predicted better.
    OnProbation,
    /// The former estimate has predicted better and took its place again at this sample: there was no change.
    RolledBack,
}

impl ChangeState {
    /// Its word in results: that of its serialised form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::InDoubt => "in_doubt",
            Self::Adopted => "adopted",
            Self::OnProbation => "on_probation",
            Self::RolledBack => "rolled_back",
        }
    }
}

impl core::fmt::Display for ChangeState {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.word())
    }
}

/// Whether the change detector is able to detect changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DetectorState {
    /// Switched off by the settings.
    #[default]
    Off,
    /// Still learning how much this model wanders without any change.
    Calibrating,
    /// The wander has been learnt: changes are detected.
    Armed,
    /// Model error hides changes below about three times the wander: see the change sensitivity.
    Insensitive,
}

/// What can be said of one parameter, from its standard error and its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum ParameterStatus {
    /// The data contain almost no information about it: the bound is that of the prior. Move the aircraft more.
    #[default]
    NotExcited,
    /// The bound is shrinking and not yet small.
    Improving,
    /// The bound is a small part of the prior's.
    Converged,
    /// A change has re-opened it and nothing has excited it since: what it was before need not hold any more.
    Unknown,
    /// It is held at one of its limits, or lies outside: the declared bounds exclude what the data say. Check the
    /// bounds.
    AtLimit,
}

impl ParameterStatus {
    /// Its word in results: that of its serialised form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NotExcited => "not_excited",
            Self::Improving => "improving",
            Self::Converged => "converged",
            Self::Unknown => "unknown",
            Self::AtLimit => "at_limit",
        }
    }
}

impl core::fmt::Display for ParameterStatus {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.word())
    }
}

/// Status of the whole estimator after one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// How the last frame met the surfaces.
    pub phase: Phase,
    /// Whether a change of the parameters is suspected or was just adopted.
    pub change: ChangeState,
    /// Whether changes can be detected.
    pub detector: DetectorState,
}

/// Parameters with their bounds after one sample. Entries from the parameter count on are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<const P: usize> {
    /// Time of the last sample used, s.
    pub time_s: f64,
    /// Estimated parameters, the model's units.
    pub parameters: [f64; P],
    /// One-sigma error claimed by the estimator's covariance, widened while a change is in doubt.
    pub std_error: [f64; P],
    /// One-sigma error corrected for the colour of the residuals: never below `std_error`. Show this one.
    pub corrected_std_error: [f64; P],
    /// Observability, `1 - variance / prior variance` in `[0, 1]`: 0 where the data have said nothing.
    pub observability: [f64; P],
    /// Status of each parameter. Entries from the parameter count on have no meaning.
    pub parameter_status: [ParameterStatus; P],
    /// Status of the estimator as a whole.
    pub status: Status,
}

/// A causal estimator: one sample in, one estimate out; no allocation, no blocking, bounded work.
pub trait Estimator<const R: usize, const P: usize> {
    /// Type of the known input of the model.
    type Input: Input;

    /// Takes the next sample and gives the estimate that holds after it.
    /// Only samples up to this one are ever used.
    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P>;

    /// Writes the covariance of the parameters (row and column = parameter) into `out`: that of the estimator alone,
    /// without the corrections of [`Estimate::corrected_std_error`] and without a doubt.
    fn covariance(&self, out: &mut [[f64; P]; P]);
}

/// A causal estimator whose internal quantities can be read: a record of a run, a plot and a verdict need them beside
/// the estimate.
///
/// Columns are the model's parameters in its order, then one per estimated output bias.
pub trait Inspect<const R: usize, const P: usize>: Estimator<R, P> {
    /// Columns in use, at most `P`.
    fn column_count(&self) -> usize;

    /// One sigma of what was known of each column beforehand, parameter units; infinite where the method takes no
    /// prior.
    fn prior_std(&self) -> &[f64; P];

    /// The last frame's rows before it corrected the estimate.
    fn innovations(&self) -> &Innovations<R>;

    /// The last correction wanted per column before it was limited, parameter units, for display: `theta_LS - theta`.
    fn surfaces(&self) -> [f64; P] {
        [0.0; P]
    }

    /// How often the state was started again.
    fn restarts(&self) -> u32 {
        0
    }

    /// Scale on the process noise of this state that was learnt from the innovations; one where the method learns none.
    fn process_noise_scale(&self, _state: usize) -> f64 {
        1.0
    }

    /// The noise levels in use, and what has been learnt of them; none for a method that does not use them.
    fn noise(&self) -> Option<NoiseReport<R>> {
        None
    }

    /// Time since which parameters that a change has re-opened are unknown, s; NaN without such a change.
    fn reopened_s(&self) -> f64 {
        f64::NAN
    }

    /// Opens the parameters for a change that is known to happen before the next sample. False where the method cannot.
    fn reopen_now(&mut self) -> bool {
        false
    }

    /// The same of these columns alone. False where the method cannot.
    fn reopen_columns_now(&mut self, _columns: &[usize]) -> bool {
        false
    }

    /// What the change detector knows; none for a method without one.
    fn detector(&self) -> Option<DetectorReport> {
        None
    }

    /// Changes smaller than this cannot be told from model error, parameter units; zero where no change is looked for.
    fn change_sensitivity(&self) -> [f64; P] {
        [0.0; P]
    }

    /// Error of a column (`true - estimated`) per unit of each constant that the model wants considered, parameter units;
    /// none where none is considered.
    fn error_by_constant(&self, _column: usize) -> Option<&[f64]> {
        None
    }

    /// What the residuals say of the constants that can be learnt; none where none is considered.
    fn evidence(&self) -> Option<Evidence<'_>> {
        None
    }
}
