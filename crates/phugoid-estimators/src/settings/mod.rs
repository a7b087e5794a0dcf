//! Settings of all estimators: priors of the parameters, noise levels, timing, change detection.
//!
//! ```
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior, SettingsError};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::absolute(2.0, 0.5)];
//! // One state, two outputs, room for four columns; outputs with noise of 0.01 and 0.2, 50 Hz.
//! let mut settings = EstimatorSettings::<1, 2, 4>::automatic(&priors, [0.01, 0.2], 0.02)?;
//! // Parameters that cannot change in flight: nothing to look for.
//! settings.change_detection = None;
//! // More priors than there is room for are refused, and the message says so.
//! let refused = EstimatorSettings::<1, 2, 1>::automatic(&priors, [0.01, 0.2], 0.02);
//! assert_eq!(refused.unwrap_err(), SettingsError::Capacity { needed: 2, capacity: 1 });
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod methods;
mod noise_learning;

pub use methods::{EkfSettings, FourierSettings, MAXIMUM_BINS, RegressionSettings};
pub use noise_learning::{LearntLevels, NoiseLearning, SCALES};

use core::fmt;

use crate::discretization::InputHold;
use crate::model::Model;

/// How large a *sudden* change of a parameter in flight would be: the alternative the change detector tests against. It
/// is smaller than the prior of the start: with a change prior that wide the detector would hardly ever decide for a
/// change, because the evidence is averaged over all sizes of change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChangePrior {
    /// Never changes: biases, offsets and other nuisance columns. Not tested, not re-opened.
    None,
    /// One sigma of the change, parameter units.
    Fixed(f64),
    /// `min(maximum, fraction * max(|initial|, |current estimate|))`, for parameters in absolute form.
    Relative {
        /// One sigma of the change as a part of the parameter itself.
        fraction: f64,
        /// Upper limit, parameter units; may be infinite.
        maximum: f64,
    },
}

impl ChangePrior {
    /// One sigma of a sudden change when the parameter started at `initial` and is now estimated as `current`.
    pub fn std(&self, initial: f64, current: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Fixed(d) => d,
            Self::Relative { fraction, maximum } => (fraction * initial.abs().max(current.abs())).min(maximum),
        }
    }
}

/// What is known of one parameter before the flight: start value, standard deviation and bounds, all in parameter
/// units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPrior {
    /// Value at the start, parameter units. It has to lie within the bounds.
    pub initial: f64,
    /// One sigma of the start value. Zero keeps the parameter fixed.
    pub std: f64,
    /// Declared lower bound; may be minus infinity.
    pub lower: f64,
    /// Declared upper bound; may be infinity.
    pub upper: f64,
    /// Plausible sudden change in flight.
    pub change_std: ChangePrior,
}

impl ParameterPrior {
    /// A parameter known by its bounds: `C0 = (R/2)^2`, half width `R` (theory: the bounds decide the gain), and half
    /// of `R` as one sigma of a sudden change. The form for increments on a database.
    ///
    /// ```
    /// use phugoid_estimators::settings::ParameterPrior;
    ///
    /// let prior = ParameterPrior::bounded(-1.0, -3.0, 1.0);
    /// // Half of the half width.
    /// assert_eq!((prior.half_width(), prior.std), (2.0, 1.0));
    /// ```
    pub fn bounded(initial: f64, lower: f64, upper: f64) -> Self {
        let std = 0.25 * (upper - lower);
        Self { initial, std, lower, upper, change_std: ChangePrior::Fixed(std) }
    }

    /// A parameter in absolute form, known by a start value and its one sigma; a sudden change is of the order of half
    /// the parameter.
    pub fn absolute(initial: f64, std: f64) -> Self {
        Self {
            initial,
            std,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            change_std: ChangePrior::Relative { fraction: 0.5, maximum: f64::INFINITY },
        }
    }

    /// A parameter that only supports the others (offset, bias): start value zero, never a sudden change.
    pub fn nuisance(std: f64) -> Self {
        Self { initial: 0.0, std, lower: f64::NEG_INFINITY, upper: f64::INFINITY, change_std: ChangePrior::None }
    }

    /// A parameter held at a value.
    pub fn fixed(value: f64) -> Self {
        Self { initial: value, ..Self::nuisance(0.0) }
    }

    /// Half width of the declared bounds; infinite if one of them is.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.upper - self.lower)
    }

    fn check(&self, parameter: usize) -> Result<(), SettingsError> {
        let change_is_wrong = match self.change_std {
            ChangePrior::None => false,
            ChangePrior::Fixed(d) => !(d.is_finite() && d >= 0.0),
            ChangePrior::Relative { fraction, maximum } => !(fraction.is_finite() && fraction >= 0.0 && maximum >= 0.0),
        };
        let sd_is_right = self.std.is_finite() && self.std >= 0.0;
        if !self.initial.is_finite() || !sd_is_right || change_is_wrong {
            return Err(SettingsError::Prior { parameter });
        }
        let ordered = self.lower < self.upper;
        if !ordered || !(self.lower..=self.upper).contains(&self.initial) {
            return Err(SettingsError::Bounds {
                parameter,
                lower: self.lower,
                initial: self.initial,
                upper: self.upper,
            });
        }
        Ok(())
    }
}

/// Noise that drives the states beside the known input: gusts and what the model leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise<const N: usize, const R: usize> {
    /// `Qx`, variance per second of each state, (state unit)^2/s. Scaled by the adaptive factor `q_s`.
    pub variance_per_s: [f64; N],
    /// Scale `q_s` of the process noise at the start; it has to lie within the limits.
    pub initial_scale: f64,
    /// How `q_s` follows the data.
    pub adaptation: NoiseAdaptation<R>,
    /// Lowest and highest scale `q_s`; the lowest has to be positive.
    pub scale_limits: [f64; 2],
}

/// How the scale of the process noise follows the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseAdaptation<const R: usize> {
    /// The scale stays at its start value.
    Off,
    /// By the slope of the likelihood of all rows over the information that they have given, a Newton step per frame;
    /// each row by how far its predicted variance depends on the process noise.
    Score {
        /// Part of that information that is forgotten per frame.
        forgetting: f64,
    },
    /// `q_s <- q_s exp(gain (min(xi^2, 9) - 1))` for each of some rows, however little they have to do with the process
    /// noise: the first prototype's law, with which its published traces are reproduced. In light gusts `q_s` follows
    /// the noise of these rows.
    Rows {
        /// Gain per row and frame, 0 to 1.
        gain: f64,
        /// The rows whose innovations drive the scale, by output.
        outputs: [bool; R],
    },
}

/// Part of the information about the scale of the process noise that is forgotten per frame: a memory of 3 s at 100 Hz.
const FORGETTING: f64 = 0.003;

impl<const N: usize, const R: usize> ProcessNoise<N, R> {
    /// No process noise: the model and its input are exact.
    pub const NONE: Self = Self {
        variance_per_s: [0.0; N],
        initial_scale: 1.0,
        adaptation: NoiseAdaptation::Off,
        scale_limits: [1e-4, 1e3],
    };

    /// `Qx`, its scale adapted to the data by [`NoiseAdaptation::Score`].
    pub fn adaptive(variance_per_s: [f64; N]) -> Self {
        Self { variance_per_s, adaptation: NoiseAdaptation::Score { forgetting: FORGETTING }, ..Self::NONE }
    }

    /// `Qx` as given, never scaled.
    pub fn fixed(variance_per_s: [f64; N]) -> Self {
        Self { variance_per_s, ..Self::NONE }
    }
}

/// Which input the output equation sees at a sample where the held input steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutputInput {
    /// The input of the sample itself (right limit).
    #[default]
    Current,
    /// The input held up to the sample (left limit).
    Previous,
}

/// Settings of the change detector. The defaults hold for any number of parameters and any rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChangeDetection {
    /// Length of the window, s; twenty blocks of at least one sample each.
    pub window_s: f64,
    /// Log Bayes factor at which a challenger is started, nats.
    pub trigger: f64,
    /// Score on fresh data at which the challenger is adopted, nats.
    pub adoption: f64,
    /// Score over the rows that are measured in the longest doubt from which on it is adopted whatever the maturity of
    /// the change, nats per row: the running estimate predicts next to nothing. Infinite for never.
    pub overwhelming: f64,
    /// Score at which it is dropped, nats (negative).
    pub dropping: f64,
    /// Longest doubt, s: a challenger that has not been adopted by then is dropped.
    pub doubt_limit_s: f64,
    /// Maturity `dtheta^T (C_B + w^2 diag d^2)^-1 dtheta` needed for adoption; none: twice the chi-square quantile at
    /// `1 - 1.4e-4` for the number of tested parameters.
    pub maturity: Option<f64>,
    /// No trigger before this time from the first sample, s.
    pub arming_s: f64,
    /// `w` at the start: how far the parameters of this model are expected to wander without any change, as a part of
    /// `d`.
    pub initial_wander: f64,
    /// Lowest and highest wander `w` that may be learnt.
    pub wander_limits: [f64; 2],
    /// `w` above which the detector is called insensitive (and latches "model error" after an adoption).
    pub insensitive_wander: f64,
}

impl Default for ChangeDetection {
    fn default() -> Self {
        Self {
            window_s: 1.0,
            trigger: 6.0,
            adoption: 10.0,
            overwhelming: 0.6,
            dropping: -30.0,
            doubt_limit_s: 6.0,
            maturity: None,
            arming_s: 2.0,
            initial_wander: 0.15,
            wander_limits: [0.03, 0.7],
            insensitive_wander: 0.25,
        }
    }
}

impl ChangeDetection {
    fn check(&self) -> Result<(), SettingsError> {
        let [low, high] = self.wander_limits;
        let settings = [
            ("change_detection.window_s", self.window_s, self.window_s > 0.0),
            ("change_detection.trigger", self.trigger, !self.trigger.is_nan()),
            ("change_detection.adoption", self.adoption, !self.adoption.is_nan()),
            ("change_detection.overwhelming", self.overwhelming, !self.overwhelming.is_nan()),
            ("change_detection.dropping", self.dropping, !self.dropping.is_nan()),
            ("change_detection.doubt_limit_s", self.doubt_limit_s, self.doubt_limit_s >= 0.0),
            ("change_detection.arming_s", self.arming_s, !self.arming_s.is_nan()),
            ("change_detection.initial_wander", self.initial_wander, (low..=high).contains(&self.initial_wander)),
            ("change_detection.wander_limits", low, low > 0.0 && low <= high),
            ("change_detection.wander_limits", high, high.is_finite()),
            ("change_detection.insensitive_wander", self.insensitive_wander, !self.insensitive_wander.is_nan()),
        ];
        match settings.into_iter().find(|(_, _, right)| !right) {
            Some((name, value, _)) => Err(SettingsError::Setting { name, value }),
            None => Ok(()),
        }
    }
}

/// How far a reaching row moves the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReachingState {
    /// As far as the joint filter with the innovation clipped at `kappa` would: continuous with the sliding phase.
    #[default]
    Joint,
    /// `1 + v` times as far, as in the prototype whose recorded traces a test compares with. Too far while much is
    /// still to be learnt.
    Prototype,
}

/// Settings of an estimator. [`EstimatorSettings::automatic`] fills them by rule; every field may then be changed. All
/// methods take these settings; fields that only some methods use say so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorSettings<const N: usize, const R: usize, const P: usize> {
    /// Priors of the model's parameters, the model's order; entries from its parameter count on are ignored.
    pub priors: [ParameterPrior; P],
    /// One sigma of the measurement noise per output, output units. Zero or not finite: the output is not used.
    pub noise_std: [f64; R],
    /// One sigma of an unknown constant bias per output, output units. Zero or not finite: no bias column. Bias
    /// columns follow the model's parameters in the order of the outputs and count against the capacity `P`.
    pub bias_std: [f64; R],
    /// Start value of states that no output measures.
    pub initial_state: [f64; N],
    /// One sigma of [`Self::initial_state`], state units; zero if it is known exactly.
    pub initial_state_std: [f64; N],
    /// Noise that drives the states: gusts, and what the model leaves out.
    pub process_noise: ProcessNoise<N, R>,
    /// `kappa`: up to this normalised surface value a row slides (equivalent control).
    pub reaching_limit: f64,
    /// `kappa2`: beyond this a row is rejected.
    pub rejection_limit: f64,
    /// How the noise levels and the scales of the process noise are learnt in flight, starting from
    /// [`Self::noise_std`]; `None` takes [`Self::noise_std`] as it is. [`Smpe`](crate::smpe::Smpe) and
    /// [`JointEkf`](crate::ekf::JointEkf) learn them.
    pub noise_learning: Option<NoiseLearning<N, R>>,
    /// How far a reaching row moves the state.
    pub reaching_state: ReachingState,
    /// Nominal time between samples, s. The samples themselves may come irregularly.
    pub sample_time_s: f64,
    /// What the input does between samples.
    pub input_hold: InputHold,
    /// Which input the outputs see at a sample.
    pub output_input: OutputInput,
    /// Longest integration step, s; longer intervals are divided.
    pub maximum_step_s: f64,
    /// Longest interval between samples that is predicted through, s (the input inside it is not known). After a longer
    /// one the state is started again from the measurements; the parameters and their covariance are kept.
    pub maximum_gap_s: f64,
    /// Length of the median start, s.
    pub start_window_s: f64,
    /// How long the first start is on trial, s: when an output has been rejected for more than half of it, everything
    /// starts again from the prior, twice at most. More than twice the longest burst of outliers that is to be borne
    /// (0.25 s). Zero: no trial.
    pub start_trial_s: f64,
    /// Whether the very first sample also corrects (it has already helped to start the state).
    pub correct_first_sample: bool,
    /// Estimates are held inside this many half widths of their bounds, about the middle. Where only one bound is
    /// finite, at that bound itself.
    pub clip_factor: f64,
    /// Length of the blocks of the colour correction, s.
    pub colour_block_s: f64,
    /// Settings of change detection; `None` switches it off.
    pub change_detection: Option<ChangeDetection>,
    /// What the joint extended Kalman filter alone uses.
    pub ekf: EkfSettings<P>,
    /// What the regression methods alone use.
    pub regression: RegressionSettings,
    /// What the Fourier regression alone uses.
    pub fourier: FourierSettings,
}

impl<const N: usize, const R: usize, const P: usize> EstimatorSettings<N, R, P> {
    /// The automatic rule: everything from the priors (bounds), the measured noise (one sigma per output) and the
    /// sample time. Parameters of the model beyond the last prior given are held at zero. No process noise, no biases,
    /// states not measured start at zero with variance zero: set [`Self::process_noise`], [`Self::with_biases`] and
    /// [`Self::initial_state`] where the plant has them.
    pub fn automatic(
        priors: &[ParameterPrior],
        noise_std: [f64; R],
        sample_time_s: f64,
    ) -> Result<Self, SettingsError> {
        if priors.len() > P {
            return Err(SettingsError::Capacity { needed: priors.len(), capacity: P });
        }
        let mut all = [ParameterPrior::fixed(0.0); P];
        all[..priors.len()].copy_from_slice(priors);
        let settings = Self {
            priors: all,
            noise_std,
            bias_std: [0.0; R],
            initial_state: [0.0; N],
            initial_state_std: [0.0; N],
            process_noise: ProcessNoise::NONE,
            noise_learning: None,
            reaching_limit: 3.0,
            rejection_limit: automatic_rejection_limit(learnt(priors)),
            reaching_state: ReachingState::Joint,
            sample_time_s,
            input_hold: InputHold::Zero,
            output_input: OutputInput::Current,
            maximum_step_s: (1.5 * sample_time_s).clamp(0.02, 0.15),
            maximum_gap_s: 0.5_f64.max(5.0 * sample_time_s),
            start_window_s: 0.2,
            start_trial_s: 0.6,
            correct_first_sample: true,
            clip_factor: 1.5,
            colour_block_s: 0.5,
            change_detection: Some(ChangeDetection::default()),
            ekf: EkfSettings::default(),
            regression: RegressionSettings::default(),
            fourier: FourierSettings::default(),
        };
        settings.check(priors.len())?;
        Ok(settings)
    }

    /// Adds bias columns (one sigma per output, zero for none) and widens the rejection limit for their number.
    ///
    /// ```
    /// use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
    ///
    /// // The second output may be wrong by a constant of about 0.5; the first one is calibrated.
    /// let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0)];
    /// let settings = EstimatorSettings::<1, 2, 4>::automatic(&priors, [0.01, 0.2], 0.02)?.with_biases([0.0, 0.5]);
    /// assert_eq!(settings.bias_columns().collect::<Vec<_>>(), [1]);
    /// # Ok::<(), phugoid_estimators::settings::SettingsError>(())
    /// ```
    pub fn with_biases(mut self, bias_std: [f64; R]) -> Self {
        self.bias_std = bias_std;
        let columns = learnt(&self.priors) + self.bias_columns().count();
        self.rejection_limit = self.rejection_limit.max(automatic_rejection_limit(columns));
        self
    }

    /// The output that measures each state directly and is used (its noise level is positive and finite).
    pub(crate) fn output_of_state<M: Model<N, R, P>>(&self, model: &M) -> [Option<usize>; N] {
        core::array::from_fn(|state| {
            model
                .measuring_output(state)
                .filter(|&output| output < R)
                .filter(|&output| self.noise_std[output].is_finite() && self.noise_std[output] > 0.0)
        })
    }

    /// The input that the outputs see at the end of an interval.
    pub(crate) fn seen_input<I>(&self, previous: I, current: I) -> I {
        match self.output_input {
            OutputInput::Current => current,
            OutputInput::Previous => previous,
        }
    }

    /// Number of the block of the colour correction that a time since the first frame (s) belongs to.
    pub(crate) fn colour_block(&self, since_start_s: f64) -> u64 {
        (since_start_s / self.colour_block_s + 1e-9) as u64
    }

    /// Outputs that have a bias column, in order.
    pub fn bias_columns(&self) -> impl Iterator<Item = usize> + '_ {
        (0..R).filter(|&i| self.bias_std[i] > 0.0 && self.bias_std[i].is_finite())
    }

    /// Checks the settings for a model with `parameters` parameters.
    pub(crate) fn check(&self, parameters: usize) -> Result<(), SettingsError> {
        let needed = parameters.saturating_add(self.bias_columns().count());
        if parameters > P || needed > P {
            return Err(SettingsError::Capacity { needed, capacity: P });
        }
        for (i, prior) in self.priors[..parameters].iter().enumerate() {
            prior.check(i)?;
        }
        let positive = [
            ("sample_time_s", self.sample_time_s),
            ("maximum_step_s", self.maximum_step_s),
            ("maximum_gap_s", self.maximum_gap_s),
            ("reaching_limit", self.reaching_limit),
            ("rejection_limit", self.rejection_limit),
            ("clip_factor", self.clip_factor),
            ("colour_block_s", self.colour_block_s),
        ];
        for (name, value) in positive {
            // Infinity is allowed: no limit.
            if value.is_nan() || value <= 0.0 || (name == "sample_time_s" && value.is_infinite()) {
                return Err(SettingsError::Setting { name, value });
            }
        }
        if self.start_trial_s.is_nan() || self.start_trial_s < 0.0 {
            return Err(SettingsError::Setting { name: "start_trial_s", value: self.start_trial_s });
        }
        if self.start_window_s.is_nan() || self.start_window_s < 0.0 {
            return Err(SettingsError::Setting { name: "start_window_s", value: self.start_window_s });
        }
        for value in self.process_noise.variance_per_s {
            if !(value.is_finite() && value >= 0.0) {
                return Err(SettingsError::Setting { name: "process_noise.variance_per_s", value });
            }
        }
        let [low, high] = self.process_noise.scale_limits;
        if !(low > 0.0 && high >= low && (low..=high).contains(&self.process_noise.initial_scale)) {
            return Err(SettingsError::Setting {
                name: "process_noise.initial_scale",
                value: self.process_noise.initial_scale,
            });
        }
        let gain = match self.process_noise.adaptation {
            NoiseAdaptation::Off => 0.0,
            NoiseAdaptation::Score { forgetting: value } | NoiseAdaptation::Rows { gain: value, .. } => value,
        };
        if !(0.0..=1.0).contains(&gain) {
            return Err(SettingsError::Setting { name: "process_noise.adaptation", value: gain });
        }
        if let Some(learning) = &self.noise_learning {
            learning.check()?;
        }
        if let Some(detection) = &self.change_detection {
            detection.check()?;
        }
        for i in 0..N {
            if !self.initial_state[i].is_finite() {
                return Err(SettingsError::Setting { name: "initial_state", value: self.initial_state[i] });
            }
            if !(self.initial_state_std[i].is_finite() && self.initial_state_std[i] >= 0.0) {
                return Err(SettingsError::Setting { name: "initial_state_std", value: self.initial_state_std[i] });
            }
        }
        if !self.noise_std.iter().any(|std| std.is_finite() && *std > 0.0) {
            return Err(SettingsError::NoOutput);
        }
        Ok(())
    }
}

/// How many parameters are learnt: a fixed one is a known number.
fn learnt(priors: &[ParameterPrior]) -> usize {
    priors.iter().filter(|prior| prior.std > 0.0).count()
}

/// `kappa2 = max(6, 2 sqrt(p) + 2)`: beyond it nothing inside the bounds explains a row.
fn automatic_rejection_limit(columns: usize) -> f64 {
    (2.0 * libm::sqrt(columns as f64) + 2.0).max(6.0)
}

/// Why an estimator cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingsError {
    /// More columns (parameters and biases) than the compiled capacity.
    Capacity {
        /// Columns that the settings ask for.
        needed: usize,
        /// Columns there is room for.
        capacity: usize,
    },
    /// More considered constants than the compiled capacity.
    Constants {
        /// Constants that the model wants considered.
        needed: usize,
        /// Constants there is room for.
        capacity: usize,
    },
    /// A start value, standard deviation or change prior is not a finite number of the right sign.
    Prior {
        /// Index of the parameter in the model.
        parameter: usize,
    },
    /// Bounds in the wrong order, or a start value outside of them.
    Bounds {
        /// Index of the parameter in the model.
        parameter: usize,
        /// The lower bound that was given.
        lower: f64,
        /// The start value that was given.
        initial: f64,
        /// The upper bound that was given.
        upper: f64,
    },
    /// A setting has an impossible value.
    Setting {
        /// Name of the setting that is wrong.
        name: &'static str,
        /// The value that was refused.
        value: f64,
    },
    /// No output has a positive noise level: nothing could be learnt.
    NoOutput,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Capacity { needed, capacity } => write!(
                f,
                "{needed} columns (parameters and sensor biases) are asked for, this estimator has room for \
                 {capacity}: drop some, or compile a larger capacity"
            ),
            Self::Constants { needed, capacity } => write!(
                f,
                "the model wants {needed} constants considered, this estimator has room for {capacity}: drop some, or \
                 compile a larger capacity"
            ),
            Self::Prior { parameter } => write!(
                f,
                "parameter {parameter}: start value, standard deviation and change prior must be finite, the last \
                 two not negative"
            ),
            Self::Bounds { parameter, lower, initial, upper } => write!(
                f,
                "parameter {parameter}: needs lower < upper with the start value between, found lower {lower}, start \
                 {initial}, upper {upper}"
            ),
            Self::Setting { name, value } => write!(f, "setting {name} cannot be {value}"),
            Self::NoOutput => write!(f, "no output has a positive noise level: give at least one"),
        }
    }
}

impl core::error::Error for SettingsError {}
