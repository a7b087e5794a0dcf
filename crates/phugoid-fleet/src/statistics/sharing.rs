//! Which flights share an error: what belongs to an airframe does not average away over its flights.

use phugoid_identification::estimation::UncertainQuantity;

use crate::row::QUANTITIES;

/// What the error of a quantity belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The airframe and its sensors: the same in all its flights, another one in each airframe.
    Airframe,
    /// The airframe or the single flight, nobody knows: the mass is wrong by the weighing of the empty aircraft, and by the
    /// fuel of the day; the density of the air by a sensor, and by the temperature of the day. Where a mean is formed it counts as shared by all flights, and where flights are compared as their
    /// own: each is the choice that makes a bound larger.
    Loading,
    /// The type: the same in all airframes, as the thrust of a table of the engine, the size of the wing, or the tables that increments are estimated to.
    Fleet,
}

/// What the error of a quantity belongs to.
pub const fn owner(quantity: UncertainQuantity) -> Owner {
    match quantity {
        UncertainQuantity::AirspeedScale
        | UncertainQuantity::AirspeedPerAlpha
        | UncertainQuantity::FlowAngleScale
        | UncertainQuantity::FlowAngleZero
        | UncertainQuantity::FlowAngleLag
        | UncertainQuantity::FlowAnglePosition
        | UncertainQuantity::SurfaceScale
        | UncertainQuantity::SurfaceSkew
        | UncertainQuantity::SurfacePlay
        | UncertainQuantity::AccelerationScale
        | UncertainQuantity::AccelerationPosition
        | UncertainQuantity::Inertia => Owner::Airframe,
        UncertainQuantity::Mass | UncertainQuantity::CentreOfGravity | UncertainQuantity::AirDensity => Owner::Loading,
        UncertainQuantity::Geometry | UncertainQuantity::Thrust | UncertainQuantity::BaseTables => Owner::Fleet,
    }
}

/// Standard deviation of the parts of a budget with one of these owners, in the unit of the parameter.
pub fn part_of(budget: &[f64; QUANTITIES], owners: &[Owner]) -> f64 {
    let parts = UncertainQuantity::ALL.iter().zip(budget).filter(|(quantity, _)| owners.contains(&owner(**quantity)));
    parts.map(|(_, part)| part * part).sum::<f64>().sqrt()
}
