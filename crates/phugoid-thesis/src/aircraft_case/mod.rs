//! The published cases with the F-16: one increment at a time, and all four at once, from one elevator input.
//!
//! The reference is a flight in six degrees of freedom ([`fly`]). Beside it run the flagship and the thesis's sliding laws
//! ([`run_method`]), all on the longitudinal motion, and an estimated aircraft that flies from the same input with the
//! current estimates.

mod case;
mod charts;
mod condition;
mod entries;
mod flight;
mod golden;
mod judged;
mod law;
mod method;
mod model;
mod rank;
mod rates;
mod reference;
mod run;

pub use case::{AircraftCase, EstimatorSettings, PARAMETERS, ParameterSettings};
pub(super) use entries::{ENTRIES, FILES};
pub use entries::{published_case, published_ids};
pub use flight::fly;
pub use law::{LawForm, LawSettings, Surface};
pub use method::{Method, MethodRun, NamedMethod, ParameterRun, run_method};
pub use model::model_file;
pub(crate) use model::sensor_noise;
pub use reference::Reference;
pub use run::short_period_s;
