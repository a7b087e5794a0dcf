//! The cases of the four proof-of-concept plants: simulated, estimated by every method, judged.
//!
//! [`simulate()`] gives the samples of a [`PlantCase`], [`run_method`] runs one method with any settings on them, and
//! [`verdict::behaviour`] says what became of it. [`PlantCase::run`] does all of it with the settings of the file.

mod bound;
mod charts;
mod condition;
mod entries;
mod format;
mod golden;
mod judged;
mod method;
mod plant;
mod report;
mod simulate;
pub mod verdict;

pub use bound::bound;
pub use condition::slopes;
pub(super) use entries::{ENTRIES, FILES};
pub use entries::{published_case, published_ids};
pub use format::{Noise, Parameter, PlantCase, Settings, Signal};
pub(super) use method::flagship_settings;
pub use method::{Method, MethodRun, Surface, run_method};
pub use plant::Plant;
pub(crate) use plant::{ROOM, Visit};
pub(super) use simulate::with_noise;
pub use simulate::{PlantRun, simulate};
