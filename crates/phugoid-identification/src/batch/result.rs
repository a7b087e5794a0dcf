//! The result of a batch method: plain data to print, plot, save and compare.

use serde::{Deserialize, Serialize};

use super::fit::OutputFit;
use crate::core::correlation::correlation;

/// The kind of an unknown, with its positions in the model and in the list of manoeuvres, all counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnknownKind {
    /// A parameter of the model.
    Parameter {
        /// Its position in the model.
        index: usize,
    },
    /// A constant error of an output.
    Bias {
        /// Position of the output in the output vector.
        output: usize,
        /// The manoeuvre's position; none if it is the same in all.
        manoeuvre: Option<usize>,
    },
    /// A state at the start of a manoeuvre, or after a gap in it.
    InitialState {
        /// Position of the state in the state vector.
        state: usize,
        /// Position of the manoeuvre in the list.
        manoeuvre: usize,
        /// Position of the stretch between gaps in the manoeuvre, in order of time.
        #[serde(default)]
        stretch: usize,
    },
    /// One sigma of the noise of an output.
    Noise {
        /// Position of the output in the output vector.
        output: usize,
    },
    /// Density of the process noise of a state: variance gained per second.
    ProcessNoise {
        /// Position of the state in the state vector.
        state: usize,
    },
}

impl UnknownKind {
    /// True of a variance of measurement or process noise.
    pub(crate) fn is_variance(self) -> bool {
        matches!(self, Self::Noise { .. } | Self::ProcessNoise { .. })
    }
}

/// The estimate of one unknown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unknown {
    /// Which kind of unknown it is.
    pub kind: UnknownKind,
    /// Name of the unknown, e.g. `Cm_alpha` or `bias of alpha`.
    pub name: String,
    /// Estimate, in the unknown's own unit.
    pub value: f64,
    /// One-sigma error, from the inverse of the information: the Cramer-Rao bound if the residuals are white.
    pub std_error: f64,
    /// One-sigma error corrected for the colour of the residuals, never below `std_error`. Show this one.
    pub corrected_std_error: f64,
    /// True if the estimate lies on one of its bounds; the standard error is then that of an unbounded estimate.
    pub at_limit: bool,
}

/// One accepted step of the iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Negative logarithm of the likelihood (and of the priors), without constants.
    pub cost: f64,
    /// Levenberg-Marquardt damping of the step that led here; 0 for a pure Gauss-Newton step and for the start.
    pub damping: f64,
    /// Length in standard errors of the Gauss-Newton step that would follow.
    pub next_step: f64,
}

/// The fit of one manoeuvre: its initial state, biases, fitted outputs and residuals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ManoeuvreFit {
    /// Name of the manoeuvre, e.g. its file.
    pub name: String,
    /// State at the first sample with which the fit was computed, in the order of the model's states, SI. After a gap the
    /// state begins anew: those starts are among [`BatchFit::unknowns`].
    pub initial_state: Vec<f64>,
    /// Constant errors of the sensors that the fitted outputs include, in the order of the outputs; 0 where none was
    /// estimated.
    pub biases: Vec<f64>,
    /// Model outputs with their biases, by sample and output.
    pub fitted: Vec<Vec<f64>>,
    /// Measured minus fitted divided by one sigma, by sample and output; NaN where nothing was measured.
    pub residuals: Vec<Vec<f64>>,
    /// Quality of the fit by output; an output without values is left out.
    pub outputs: Vec<OutputFit>,
}

/// The band of a frequency-domain method, as it was used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandUsed {
    /// Lowest frequency that was used, Hz.
    pub low_hz: f64,
    /// Highest frequency that was used, Hz.
    pub high_hz: f64,
    /// Number of frequencies, over all parts of all records.
    pub frequencies: usize,
}

impl std::fmt::Display for BandUsed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.3} to {:.3} Hz", self.low_hz, self.high_hz)
    }
}

/// The result of one batch method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatchFit {
    /// Name of the method on the command line, e.g. `output-error`.
    pub method: String,
    /// All parameters of the model in its order, fixed ones included.
    pub parameters: Vec<f64>,
    /// The estimated unknowns: free parameters, biases, initial states, and variances where they were estimated.
    pub unknowns: Vec<Unknown>,
    /// Covariance of the unknowns from the information.
    pub covariance: Vec<Vec<f64>>,
    /// One sigma of the noise by output, given or estimated; NaN for an output without values.
    pub noise_std: Vec<f64>,
    /// Variance gained by each state per second, given or estimated; empty where the method knows none.
    pub process_noise: Vec<f64>,
    /// The band of a frequency-domain method; none of the others. The fit by output and the residuals are then those in
    /// the band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<BandUsed>,
    /// The accepted steps from the start to the minimum.
    pub iterations: Vec<Iteration>,
    /// How each manoeuvre was fitted, in the order in which they were given.
    pub manoeuvres: Vec<ManoeuvreFit>,
    /// Warnings about the result in sentences; read them before you use the numbers.
    pub notes: Vec<String>,
}

impl BatchFit {
    /// The estimate of the unknown with this name; `None` if nothing of this name was estimated.
    pub fn unknown(&self, name: &str) -> Option<&Unknown> {
        self.unknowns.iter().find(|u| u.name == name)
    }

    /// Correlation matrix of the errors of the unknowns, row and column in the order of [`unknowns`](Self::unknowns).
    pub fn correlation(&self) -> Vec<Vec<f64>> {
        correlation(&self.covariance)
    }
}
