//! Aircraft of JSBSim: their files are read, and evaluated as that program does.
//!
//! [`Aircraft::open`] reads an aircraft, with the systems and engines that it refers to. What changes its aerodynamics and is
//! not known refuses it, with file and line; what else is left out is listed by [`Aircraft::omitted`]. An [`Evaluator`] holds the
//! values of all its properties at one moment and gives forces and moments about the centre of gravity.
//!
//! Functions of the aerodynamics have the values of the moment that they are asked for, whatever was asked before: those that
//! JSBSim takes from the step before (the square of the lift coefficient, and functions that stand after the one that reads
//! them) differ from it by one step, unless [`Evaluator::set_stepwise`] asks for them.

mod aerodynamics;
mod aircraft;
mod channels;
mod error;
mod evaluator;
mod fed;
mod files;
mod flight;
mod function;
mod mass;
mod model;
mod propulsion;
mod source;
mod table;
mod units;

pub use aircraft::Aircraft;
pub use error::{JsbsimError, Omission};
pub use evaluator::{Coefficients, Evaluator, ForceMoment};
pub use files::{MAX_FILES, MAX_TOTAL_BYTES};
pub use flight::FlightCondition;
pub use mass::{Geometry, MassProperties};
pub use propulsion::{Engine, EngineKind};

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
