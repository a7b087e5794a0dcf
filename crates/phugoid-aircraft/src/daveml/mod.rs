//! Models in DAVE-ML, the format of the standard ANSI/AIAA S-119: read, evaluated, checked and written.
//!
//! A model is a list of variables, each of which is set from outside, constant, the result of a calculation in MathML or
//! the value of a table. [`Model::open`] reads a file into operations in an order in which each can be computed;
//! an [`Evaluator`] runs them without taking memory, with exact derivatives if asked for.
//!
//! ```
//! use phugoid_aircraft::daveml::Model;
//!
//! let model = Model::parse(
//!     r#"<DAVEfunc xmlns="http://daveml.org/2010/DAVEML">
//!   <fileHeader><author name="A" org="B"/><creationDate date="2026-01-01"/></fileHeader>
//!   <variableDef name="angleOfAttack" varID="alpha" units="deg"><isInput/></variableDef>
//!   <variableDef name="totalCoefficientOfLift" varID="CL" units="nd"><isOutput/></variableDef>
//!   <function name="lift">
//!     <independentVarPts varID="alpha">-4, 0, 12</independentVarPts>
//!     <dependentVarPts varID="CL">0.0, 0.4, 1.4</dependentVarPts>
//!   </function>
//! </DAVEfunc>"#,
//! )?;
//! let alpha = model.input_position("angleOfAttack")?; // once
//! let lift = model.position("CL")?;
//! let mut evaluator = model.evaluator();
//! evaluator.set(alpha, 6.0); // at every step: in the unit of the file, here degrees
//! evaluator.run();
//! assert!((evaluator.get(lift) - 0.9).abs() < 1e-12);
//! # Ok::<(), phugoid_aircraft::daveml::DavemlError>(())
//! ```
//!
//! # What is read
//!
//! Elements are known by their local name, so that files with the namespace of the standard, with none and of its drafts
//! are read alike. Everything of version 2.0.2 of the document type is known, except for what is refused with its line:
//! quadratic splines, which the standard does not define, ungridded tables of more than two dimensions, and functions of
//! MathML that give no real number. Where the standard leaves a choice:
//!
//! - Where a function may extrapolate (`extrapolate`), the `min` or `max` of that side does not limit its variable.
//! - Ungridded tables of two dimensions are planes over a Delaunay triangulation; where four points on a circle leave
//!   two, that with the point of the smallest first (then second) variable on the shared edge. Outside it, the value is that at the
//!   nearest point of the convex hull, or continues the plane there where the function may extrapolate.
//! - Cubic splines are free at their ends, and have the slope of the last two points where the table is extrapolated.
//! - `quotient` is the whole part of a quotient, as MathML defines it, rounded to zero.
//! - A `piecewise` without a piece that holds is NaN.
//! - Inputs without initial value that are not set are NaN, and so is what depends on them.
//!
//! Some published files are no XML, because markup stands in their descriptions (`Added namespace to <math> elements`).
//! They are read with that markup as text, and [`Model::repaired_lines`] says where.
//!
//! Uncertainties are read and can be asked for; they never change what is evaluated. [`Model::moved`] is another model, with one of
//! its uncertain elements moved.

mod axis;
mod checks;
mod delaunay;
mod deviation;
mod document;
mod error;
mod functions;
mod gridded;
mod identified;
mod mathml;
mod model;
mod moved;
mod program;
mod reader;
mod repair;
mod scattered;
mod shots;
mod tables;
mod tree;
mod uncertainty;
mod units;
mod write;

pub(crate) use axis::{Axis, Independent, Interpolation, Place};
pub use checks::{CheckReport, DEFAULT_TOLERANCE, Kind, ShotReport, SignalReport};
pub use document::{Bound, Distribution, Effect, Function, Header, Role, Signal, StaticShot, Uncertainty, Variable};
pub use error::DavemlError;
pub(crate) use gridded::Gridded;
pub use identified::{
    CheckPoint, Coefficient, Constant, Correlation, Derived, Expression, IdentifiedModel, Input, Term,
};
pub use model::Model;
pub use moved::{UncertainElement, UncertainPart};
pub use program::Evaluator;
pub use units::Unit;
pub use write::{WriteError, identifier, write};
