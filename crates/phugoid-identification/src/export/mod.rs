//! An identified model in the forms of other programs.
//!
//! | form | function | what fits |
//! |---|---|---|
//! | table of the estimates, CSV | [`csv()`] | everything |
//! | the same as Parquet (feature `parquet`) | `parquet` | everything |
//! | all tables of the result as a workbook of Excel (feature `excel`) | `xlsx` | everything |
//! | the model file with its values, to fly and to start from | [`model_file()`] | everything |
//! | `<aerodynamics>` section of JSBSim | [`jsbsim()`] | every term of a model in absolute form |
//! | model in DAVE-ML (ANSI/AIAA S-119) with uncertainties and check data | [`daveml()`] | every term of a model in absolute form |
//! | parameters of Gazebo's advanced lift-drag plugin, as PX4 simulates with | [`gazebo()`] | terms of first order; the rest is said |
//!
//! Increments to a database are refused: the database is not part of the result, and these formats have no place for
//! it.

mod daveml;
mod estimates;
mod gazebo;
mod identified;
mod jsbsim;
mod model_file;
#[cfg(feature = "excel")]
mod workbook;

pub use daveml::daveml;
pub use estimates::csv;
#[cfg(feature = "parquet")]
pub use estimates::parquet;
pub use gazebo::gazebo;
pub use identified::{ExportError, Exported, Identified};
pub use jsbsim::jsbsim;
pub use model_file::model_file;
#[cfg(feature = "excel")]
pub use rust_xlsxwriter::XlsxError;
#[cfg(feature = "excel")]
pub use workbook::xlsx;
