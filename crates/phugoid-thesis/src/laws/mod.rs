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
//! The damped form finds the parameter of the first-order plant from its step response:
//!
//! ```
//! use phugoid_estimators::{Estimator, Sample};
//! use phugoid_thesis::laws::{SurfaceChannel, SurfaceDerivative, ThesisLaw, ThesisSettings};
//! use phugoid_thesis::plants::FirstOrder;
//!
//! // x' = -a x + u with a between 1 and 9; x is measured, and so is x'.
//! let channel = SurfaceChannel { state: 0, output: 0, scale: 1.0, derivative: SurfaceDerivative::Output(1) };
//! let settings = ThesisSettings::new(0, [5.0], [1.0, 9.0], [channel]);
//! let mut law: ThesisLaw<_, 1, 2, 1, 1> = ThesisLaw::new(FirstOrder, settings)?;
//! let mut found = f64::NAN;
//! for k in 0..200 {
//!     let time_s = 0.01 * f64::from(k);
//!     let x = (1.0 - (-3.0 * time_s).exp()) / 3.0;
//!     found = law.update(&Sample { time_s, input: [1.0], outputs: [x, 1.0 - 3.0 * x] }).parameters[0];
//! }
//! assert!((found - 3.0).abs() < 0.01);
//! # Ok::<(), phugoid_thesis::laws::ThesisError>(())
//! ```
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
pub(crate) mod parallel;
mod settings;
mod two_parameter;

pub use diagnostics::Diagnostics;
pub use error::ThesisError;
pub use extended::{ExtendedLaw, ExtendedSettings};
pub use one_parameter::ThesisLaw;
pub use settings::{Evaluation, LawSign, SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisSettings};
pub use two_parameter::{TwoParameterDiagnostics, TwoParameterLaw, TwoParameterSettings};
