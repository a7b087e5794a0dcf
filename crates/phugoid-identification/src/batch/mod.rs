//! Batch methods: all samples of one or more manoeuvres at once, after the flight.
//!
//! They are written against [`Flown`], a [`phugoid_estimators::Model`] with the inputs of its flight, and know nothing of
//! aircraft.
//!
//! | method | minimises | allows for |
//! |---|---|---|
//! | [`equation_error()`] | residuals of the equations of motion | noise of the rates |
//! | [`equation_error_frequency()`] | the same in a band of frequencies | the same, and drifts and gusts below the band |
//! | [`output_error()`] | output errors of a free simulation | measurement noise |
//! | [`output_error_frequency()`] | output errors in a band of frequencies | measurement noise, drifts below the band |
//! | [`filter_error()`] | prediction errors of a Kalman filter | measurement and process noise: turbulence, model error, unstable aircraft |
//!
//! A [`Manoeuvre`] is a flight's samples with the model of that flight, a [`Structure`] says what is unknown, and a
//! [`BatchFit`] holds the estimates with their covariance and the fit. Equations and sources are in docs/methods.md.

mod believed;
mod bound;
mod by_surfaces;
pub(crate) mod colour;
mod constants;
pub(crate) mod differentiate;
mod equation_error;
mod equation_error_frequency;
mod error;
mod filter;
mod filter_error;
mod filters;
mod fit;
mod flown;
mod followed;
mod in_band;
mod information;
mod layout;
mod likelihood;
pub(crate) mod loss;
mod measured;
mod optimise;
mod output_error;
mod output_error_frequency;
mod prediction;
mod problem;
mod regression;
mod regressor_noise;
mod relaxation;
pub(crate) mod response;
mod result;
mod row_correlation;
mod signal_band;
mod spectrum;
mod start;
mod summary;
mod table;

pub(crate) use constants::{
    ByConstant, cleared, equation_error_constants, equation_error_frequency_constants, filter_error_constants,
    output_error_constants, output_error_frequency_constants,
};
pub(crate) use equation_error::equations_at;
pub(crate) use problem::with_outputs;
pub(crate) use regressor_noise::{noise_of, noisy};
pub(crate) use row_correlation::RowCorrelation;
pub(crate) use signal_band::signal_band;
#[cfg(test)]
pub(crate) use table::APART;
pub(crate) use table::{Equation as TableEquation, Grid, Table, tables};

pub use bound::{Bounded, bound};
pub use by_surfaces::by_surfaces;
pub use equation_error::{EquationErrorFit, EquationErrorSettings, equation_error};
pub use equation_error_frequency::equation_error_frequency;
pub use error::BatchError;
pub use filter_error::filter_error;
pub use fit::OutputFit;
pub use flown::{Flown, Instant, WithInputs};
pub use optimise::OptimiserSettings;
pub use output_error::output_error;
pub use output_error_frequency::output_error_frequency;
pub use prediction::{predict, prediction_intervals};
pub use problem::{BatchParameter, Bias, InitialState, Manoeuvre, Noise, OutputChannel, ProcessNoise, Structure};
pub use regression::{Equation, Term};
pub use result::{BandUsed, BatchFit, Iteration, ManoeuvreFit, Unknown, UnknownKind};
