//! Options of one estimation, and the largest number of parameters.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
pub use crate::core::method::Method;

/// Largest number of estimated parameters, sensor biases included, that an estimation of any axes has place for.
pub const CAPACITY: usize = 48;

/// Largest number of estimated parameters, sensor biases included, that an estimation of these axes has place for. It
/// is smaller for the longitudinal motion alone, because unused places cost time and memory.
pub const fn capacity(axes: Axes) -> usize {
    match axes {
        Axes::Longitudinal => 24,
        Axes::LateralDirectional | Axes::All => CAPACITY,
    }
}

/// What is done about terms that the model may lack (`estimation::Offer`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StructureSearch {
    /// They are not looked for. This is the default.
    #[default]
    Never,
    /// They are looked for, and offered beside the estimate, which stays that of the model file.
    Offer,
    /// They are looked for, and the estimate is that of the model with the missing terms.
    Auto,
}

/// What a batch method takes the noise of the measurements for. Causal methods have a gate of their own and ignore it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Likelihood {
    /// Gaussian with outliers. Output error counts a value further than three sigmas from the model the less the further
    /// away it is; equation error and filter error leave out single values that stand out of their neighbours by eight
    /// sigmas. This is the default.
    #[default]
    Robust,
    /// Gaussian: every value counts with the square of its residual, outliers too.
    Gaussian,
}

/// Where output error has the flow angles from, and with them airspeed and attitude, as far as they are states of the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FlowAngles {
    /// As measured where the air is not calm (gusts change an angle in a second by more than 0.56 sigmas of the noise of its vane
    /// and 0.08 degrees, by accelerations, rates and attitude), which is said; simulated otherwise. This is the default.
    #[default]
    Auto,
    /// Simulated: the maximum-likelihood estimate in calm air. Gusts bend it.
    Simulated,
    /// As measured: the forces and moments then know of the gusts, and the angles themselves are not fitted. The noise of the
    /// sensors is taken out where accelerations, rates and attitude tell it from gusts, and only then airspeed and attitude
    /// are as measured too.
    Measured,
}

/// A band of frequencies, Hz, written `LOW:HIGH`.
///
/// ```
/// use phugoid_identification::options::Band;
/// assert_eq!("0.1:1.5".parse(), Ok(Band { low_hz: 0.1, high_hz: 1.5 }));
/// assert!("1.5:0.1".parse::<Band>().is_err() && "0.1-1.5".parse::<Band>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Band {
    /// Lowest frequency, Hz; zero for as low as the record allows, which is two periods in it.
    pub low_hz: f64,
    /// Highest frequency, Hz.
    pub high_hz: f64,
}

/// What is wrong with a band of frequencies.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BandError {
    /// Not two numbers with a colon between them.
    #[error("`{word}` is no band of frequencies: expected LOW:HIGH in Hz, such as 0.1:1.5")]
    NotABand {
        /// What was given.
        word: String,
    },
    /// The numbers are not finite, negative, or in the wrong order.
    #[error("the band is {low_hz} to {high_hz} Hz: it has to begin at zero or above and end at a higher frequency")]
    Order {
        /// Lowest frequency as given, Hz.
        low_hz: f64,
        /// Highest frequency as given, Hz.
        high_hz: f64,
    },
}

impl Band {
    /// # Errors
    /// [`BandError::Order`] where a frequency is not finite or negative, or the highest not above the lowest.
    pub fn check(self) -> Result<Self, BandError> {
        let Self { low_hz, high_hz } = self;
        let is_one = low_hz.is_finite() && high_hz.is_finite() && low_hz >= 0.0 && low_hz < high_hz;
        if is_one { Ok(self) } else { Err(BandError::Order { low_hz, high_hz }) }
    }
}

impl std::str::FromStr for Band {
    type Err = BandError;

    fn from_str(word: &str) -> Result<Self, BandError> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let pair = word.split_once(':').and_then(|(low, high)| Some((number(low)?, number(high)?)));
        let (low_hz, high_hz) = pair.ok_or_else(|| BandError::NotABand { word: word.to_owned() })?;
        Self { low_hz, high_hz }.check()
    }
}

/// A change of the aircraft that is known from another source than the record (damage, a flap, a store released).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownChange {
    /// When, s on the clock of the record: the parameters are opened again before the first sample that is not earlier.
    pub time_s: f64,
    /// What may have changed.
    pub opens: Opens,
}

/// Which parameters a change opens again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Opens {
    /// All: any derivative may be another one.
    #[default]
    Everything,
    /// The constant terms alone: a constant force or moment (a trim shift) sets in, the derivatives stay.
    Constants,
}

/// Settings of one estimation beside those of the model file. The default changes nothing of the model file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EstimateOptions {
    /// The method; `None` takes that of the model file.
    pub method: Option<Method>,
    /// Whether sudden changes of the parameters are looked for; `None` takes what the model file says.
    pub change_detection: Option<bool>,
    /// Time from which times of convergence count, s, where the record is a part of one that began earlier; none: its
    /// own first sample.
    pub start_s: Option<f64>,
    /// Changes of the aircraft that are known from another source than the record, in order of time. Methods without change
    /// detection ignore them.
    pub known_changes: Vec<KnownChange>,
    /// Whether the result is what a live session would have had. Otherwise SMPE and the EKF, with a model in absolute form, begin again from
    /// the values of equation error where that predicts the record much better, look at the whole record again for changes that were not found in flight ([`ChangeOutcome::FoundAfterwards`](super::estimation::ChangeOutcome::FoundAfterwards)),
    /// and equation error stands beside both ([`Estimation::second_answer`](super::estimation::Estimation::second_answer)); that takes
    /// one to four times as long as the filter. Beside RLS, the Fourier regression and the implicit sign stands SMPE.
    pub causal_only: bool,
    /// True values by parameter name, where the flight was simulated.
    pub truth: BTreeMap<String, f64>,
    /// Further records of the same aircraft; a batch method fits all together. A causal method refuses them
    /// ([`EstimateError::OneRecordOnly`](super::error::EstimateError::OneRecordOnly)).
    pub further: Vec<Record>,
    /// A record that is predicted with the estimated parameters; for batch methods only.
    pub predict: Option<Record>,
    /// Whether terms that the model lacks are looked for, by any method.
    pub structure: StructureSearch,
    /// What a batch method takes the noise of the measurements for.
    pub likelihood: Likelihood,
    /// Where output error has the flow angles from. Other methods ignore it.
    pub flow_angles: FlowAngles,
    /// The band of frequencies of a method that uses one ([`Method::is_in_band`]), Hz; with `None` it is found
    /// from the record. The other methods refuse it ([`EstimateError::NoBand`](super::error::EstimateError::NoBand)).
    pub band: Option<Band>,
}

impl EstimateOptions {
    /// The default, and nothing that a live session would not have ([`causal_only`](Self::causal_only)).
    ///
    /// ```
    /// use phugoid_identification::options::EstimateOptions;
    /// assert!(EstimateOptions::causal().causal_only && !EstimateOptions::default().causal_only);
    /// ```
    pub fn causal() -> Self {
        Self { causal_only: true, ..Self::default() }
    }
}
