//! The estimators to choose from, by name.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::words::did_you_mean;

/// The estimation methods of the project. Batch methods fit a whole record; the others take one sample after the other.
///
/// ```
/// use phugoid_identification::method::Method;
/// assert_eq!("output-error".parse(), Ok(Method::OutputError));
/// assert!(Method::OutputError.is_batch() && !Method::default().is_batch());
/// let error = "kalman".parse::<Method>().unwrap_err();
/// assert!(error.to_string().contains("unknown method `kalman`"));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The sliding-mode parameter estimator on a parallel model (docs/theory.md).
    #[default]
    Smpe,
    /// The joint extended Kalman filter of states and parameters (docs/methods.md).
    Ekf,
    /// Recursive least squares on states smoothed by kinematics (docs/methods.md).
    Rls,
    /// Recursive Fourier-transform regression with the end-point term (docs/methods.md).
    Fourier,
    /// Model-reference law tuned by rule, without bounds (docs/methods.md).
    ModelReference,
    /// Teaching mode: implicit sign on the least-squares surface (docs/methods.md).
    ImplicitSign,
    /// Teaching mode: super-twisting law on mixed regressors, without bounds (docs/methods.md).
    SuperTwisting,
    /// Least squares on the equations of motion (docs/methods.md, as all below).
    EquationError,
    /// The same in a band of frequencies, over the whole record.
    EquationErrorFrequency,
    /// Output error: maximum likelihood with measurement noise only, by a free simulation.
    OutputError,
    /// Output error in a band of frequencies: biases, drifts and slow gusts do not count.
    OutputErrorFrequency,
    /// Filter error: maximum likelihood with process noise, for turbulence and unstable aircraft.
    FilterError,
}

impl Method {
    /// All, in the order in which they are shown.
    pub const ALL: &[Self] = &[
        Self::Smpe,
        Self::Ekf,
        Self::Rls,
        Self::Fourier,
        Self::ModelReference,
        Self::ImplicitSign,
        Self::SuperTwisting,
        Self::EquationError,
        Self::EquationErrorFrequency,
        Self::OutputError,
        Self::OutputErrorFrequency,
        Self::FilterError,
    ];

    /// Its name on the command line, in model files and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smpe => "smpe",
            Self::Ekf => "ekf",
            Self::Rls => "rls",
            Self::Fourier => "fourier",
            Self::ModelReference => "model-reference",
            Self::ImplicitSign => "implicit-sign",
            Self::SuperTwisting => "super-twisting",
            Self::EquationError => "equation-error",
            Self::EquationErrorFrequency => "equation-error-frequency",
            Self::OutputError => "output-error",
            Self::OutputErrorFrequency => "output-error-frequency",
            Self::FilterError => "filter-error",
        }
    }

    /// Whether it sees all samples at once, and several records; the others see one sample after the other.
    pub fn is_batch(self) -> bool {
        matches!(
            self,
            Self::EquationError
                | Self::EquationErrorFrequency
                | Self::OutputError
                | Self::OutputErrorFrequency
                | Self::FilterError
        )
    }

    /// Whether it uses a band of frequencies of the record alone; the others use the samples as they are.
    pub fn is_in_band(self) -> bool {
        matches!(self, Self::EquationErrorFrequency | Self::OutputErrorFrequency)
    }

    /// Whether it solves the equations of motion with the measured states, and integrates nothing.
    pub fn is_equation_error(self) -> bool {
        matches!(self, Self::EquationError | Self::EquationErrorFrequency)
    }

    /// Whether it solves the equations of motion with smoothed states, one sample after the other, and has bounds.
    pub fn is_recursive_regression(self) -> bool {
        matches!(self, Self::Rls | Self::Fourier | Self::ImplicitSign)
    }

    /// Whether it learns the noise levels of the outputs in flight; the others use those that are given or measured.
    pub fn learns_noise(self) -> bool {
        matches!(self, Self::Smpe | Self::Ekf)
    }

    /// Whether it follows what errors of constants (scales of sensors, mass, ...) do to its estimate while it runs; for the others they
    /// are carried into the bounds by powers of the scales, and for a [recursive regression](Self::is_recursive_regression) over a whole
    /// record the runs are made again.
    pub fn follows_constants(self) -> bool {
        matches!(self, Self::Smpe | Self::Ekf) || self.is_batch()
    }

    /// One line that says what the method is, for lists of methods.
    pub fn description(self) -> &'static str {
        match self {
            Self::Smpe => "sliding-mode parameter estimator on a parallel model",
            Self::Ekf => "joint extended Kalman filter with a gate, and all else that smpe has",
            Self::Rls => "recursive least squares on smoothed states",
            Self::Fourier => "recursive Fourier-transform regression on smoothed states",
            Self::ModelReference => "model-reference law tuned by rule; no bounds",
            Self::ImplicitSign => "teaching mode: sliding law on the least-squares surface",
            Self::SuperTwisting => "teaching mode: super-twisting law on mixed regressors; no bounds",
            Self::EquationError => "batch: least squares on the equations of motion",
            Self::EquationErrorFrequency => "batch: least squares on the equations of motion in a band of frequencies",
            Self::OutputError => "batch: maximum likelihood, measurement noise only",
            Self::OutputErrorFrequency => "batch: maximum likelihood in a band of frequencies, for biases and drifts",
            Self::FilterError => "batch: maximum likelihood with process noise, for turbulence",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The error for a word that is not the name of a method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown method `{word}`{}", did_you_mean(word, Method::ALL.iter().map(|m| m.name())))]
pub struct UnknownMethod {
    /// The word that was given.
    pub word: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(word: &str) -> Result<Self, UnknownMethod> {
        let found = Self::ALL.iter().copied().find(|m| m.name() == word);
        found.ok_or_else(|| UnknownMethod { word: word.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_wrong_ones_get_the_list() {
        for method in Method::ALL {
            assert_eq!(method.name().parse::<Method>(), Ok(*method));
        }
        let message = "kalmann".parse::<Method>().unwrap_err().to_string();
        assert!(message.contains("`kalmann`") && message.contains("`smpe`"), "{message}");
    }
}
