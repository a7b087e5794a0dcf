//! The sliding-mode laws of the thesis that this project grew from (Gurbacki, RIT, 2010), as estimators.
//!
//! An estimated model runs beside the plant with the estimate in place of the unknown parameter. A surface is an *energy*
//! over a few channels (`y` of the estimated model, `ym` measured), and the law is the estimate that keeps it at rest.
//!
//! | law | what |
//! |---|---|
//! | [`ThesisLaw`] | one parameter, one surface: plants 1 and 2, each aircraft coefficient by itself |
//! | [`TwoParameterLaw`] | two parameters, two surfaces: plants 3 and 4; rank one at every instant |
//! | [`ExtendedLaw`] | any number of parameters: the repair, an extended regression of full rank |
//!
//! Every printed law contains its unknown on both sides, because the estimated model's rate depends on it: an algebraic loop.
//! [`Evaluation`] says whether the loop is cut by a delay of one sample, as in a block diagram, or solved.
//!
//! What is as published and what is reconstructed: the text at hand has lost its minus signs, and most of its equations
//! their numbers. A law is referred to here by the table of the cases it belongs to.

mod claim;
mod diagnostics;
mod eigen;
mod error;
mod extended;
mod gain;
mod one_parameter;
mod parallel;
mod settings;
mod two_parameter;

pub use diagnostics::Diagnostics;
pub use error::ThesisError;
pub use extended::{ExtendedLaw, ExtendedSettings};
pub use one_parameter::ThesisLaw;
pub use settings::{Evaluation, LawSign, SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisSettings};
pub use two_parameter::{TwoParameterDiagnostics, TwoParameterLaw, TwoParameterSettings};
