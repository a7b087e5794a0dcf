//! Aircraft of JSBSim: their files are read, and evaluated as that program does.
//!
//! [`Aircraft::open`] reads an aircraft, with the systems and engines that it refers to. What changes its aerodynamics and is
//! not known refuses it, with file and line; what else is left out is listed by [`Aircraft::omitted`]. An [`Evaluator`] holds the
//! values of all its properties at one moment and gives forces and moments about the centre of gravity.
//!
//! Functions of the aerodynamics have the values of the moment that they are asked for, whatever was asked before: those that
//! JSBSim takes from the step before (the square of the lift coefficient, and functions that stand after the one that reads
//! them) differ from it by one step, unless [`Evaluator::set_stepwise`] asks for them.
//!
//! What goes in and comes out of the methods is in SI units and body axes (x forward, y right, z down); properties by name are in
//! the units of JSBSim that their names tell. Surfaces stay where they are set, or follow their commands where
//! [`Evaluator::step_channels`] runs flight control:
//!
//! ```no_run
//! use phugoid_aircraft::jsbsim::{Aircraft, Evaluator, FlightCondition};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let aircraft = Aircraft::open("jsbsim/aircraft/c182")?;
//! for note in aircraft.omitted() {
//!     eprintln!("{note}");
//! }
//! let mut evaluator = Evaluator::new(&aircraft);
//! evaluator.set_flight(&FlightCondition {
//!     airspeed_m_s: 62.0,
//!     alpha_rad: 0.01,
//!     beta_rad: 0.0,
//!     alphadot_rad_s: 0.0,
//!     betadot_rad_s: 0.0,
//!     rates_rad_s: [0.0; 3],
//!     attitude_rad: [0.0, 0.01, 0.0],
//!     height_m: 1524.0,
//!     height_above_ground_m: 1524.0,
//!     density_kg_m3: 1.0556,
//!     pressure_pa: 84_307.0,
//!     temperature_k: 278.2,
//!     sound_speed_m_s: 334.4,
//! });
//! evaluator.set("fcs/elevator-pos-rad", 0.08);
//! evaluator.set("fcs/throttle-pos-norm", 0.7);
//! let air = evaluator.aerodynamic_force_moment();
//! let engines = evaluator.propulsive_force_moment();
//! println!("{:?} N, {} kg", air.force_n[0] + engines.force_n[0], evaluator.mass_properties().mass_kg);
//! # Ok(())
//! # }
//! ```

mod aerodynamics;
mod aircraft;
mod builtin;
mod channels;
mod closed_loop;
mod compiled;
mod error;
mod evaluator;
mod fed;
mod files;
mod flight;
mod function;
mod mass;
mod model;
mod program;
mod propulsion;
mod scaling;
mod source;
mod surfaces;
mod symbolic;
mod table;
mod units;

pub use aircraft::Aircraft;
pub use error::{JsbsimError, Omission};
pub use evaluator::{Coefficients, Evaluator, ForceMoment};
pub use files::{MAX_FILES, MAX_TOTAL_BYTES};
pub use flight::FlightCondition;
pub use mass::{Geometry, MassProperties};
pub use propulsion::{Engine, EngineKind};

pub(crate) use aerodynamics::{AerodynamicWorkspace, CompiledAerodynamics};
pub(crate) use compiled::{CompiledPropulsion, PropulsiveWorkspace};
pub(crate) use files::text_of;
pub(crate) use flight::altitude_of_density_m;
pub(crate) use propulsion::{GivenPropeller, GivenTables};
pub(crate) use scaling::{Follower, Scaling};
pub(crate) use surfaces::Awaited;

use model::Model;
use roxmltree::Node;
use source::Source;

/// Makes the property that a `<property>` declares, with its value if it gives one.
fn declare(model: &mut Model, source: &Source, node: Node<'_, '_>) -> Result<(), JsbsimError> {
    let (index, _) = function::named_property(model, source, node, &source::text(node))?;
    let value =
        match node.attribute("value") {
            None => None,
            Some(value) => Some(source::parse(value).ok_or_else(|| {
                source.refuse(node, format!("the value \"{}\" is no number", source::shortened(value)))
            })?),
        };
    let new = !std::mem::replace(&mut model.properties[index].declared, true);
    if let Some(value) = value.or(new.then_some(0.0)) {
        model.begin(index, value);
    }
    Ok(())
}
