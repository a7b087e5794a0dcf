//! The items that this crate takes from the crates of simulation, input design and evaluation.

pub use phugoid_design as design;
pub use phugoid_design::DesignError;
pub use phugoid_evaluation::accuracy::StudyError;
pub use phugoid_evaluation::arena::{Arena, Entry};
pub use phugoid_simulation::aircraft::{AircraftError, AnyAircraft};
pub use phugoid_simulation::flight::{Flight, FlightError};
pub use phugoid_simulation::manoeuvre::Surface;
pub use phugoid_simulation::named::NamedError;
pub use phugoid_simulation::scenario::{Scenario, ScenarioError};

pub(crate) use phugoid_evaluation::arena::{BUILT_IN as ARENA, Contestant, built_in as arena_entry, compare};
pub(crate) use phugoid_simulation::flight::fly_with_progress;
pub(crate) use phugoid_simulation::scenario::nearest;
