//! What this crate takes from the crate of simulations and studies, in one place.

pub use phugoid_studies::accuracy::StudyError;
pub use phugoid_studies::arena::{Arena, Entry};
pub use phugoid_studies::design;
pub use phugoid_studies::design::DesignError;
pub use phugoid_studies::flight::{Flight, FlightError};
pub use phugoid_studies::manoeuvre::Surface;
pub use phugoid_studies::named::NamedError;
pub use phugoid_studies::scenario::{Scenario, ScenarioError};

pub(crate) use phugoid_studies::arena::{BUILT_IN as ARENA, Contestant, built_in as arena_entry, compare};
pub(crate) use phugoid_studies::flight::{F16_ALPHA_RANGE_DEG, fly_with_progress};
pub(crate) use phugoid_studies::scenario::nearest;
