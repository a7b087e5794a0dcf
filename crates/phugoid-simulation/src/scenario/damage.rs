//! Increments that change in flight.

use phugoid_flight_dynamics::increments::Increments;
use serde::Deserialize;

use super::ranges::Ranges;
use crate::quantity::Time;

/// A change of the aerodynamic increments in flight, sudden or gradual.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Damage {
    /// Time at which the change begins, from the start of the flight.
    pub at: Time,
    /// How long it takes to get there, evenly; zero for at once.
    #[serde(default)]
    pub over: Time,
    /// Increments that hold once the change is complete; they replace those that held before.
    #[serde(default)]
    pub increments: Increments,
    /// Increments that are drawn, in place of those above.
    #[serde(default)]
    pub ranges: Ranges,
}

impl Damage {
    /// A change that is complete at once and whose increments are given, not drawn.
    pub fn sudden(at: Time, increments: Increments) -> Self {
        Self { at, increments, ..Self::default() }
    }

    /// The increments at a time (s) from [`at`](Self::at) on, when `before` held until then.
    pub(crate) fn after(&self, before: &Increments, time: f64) -> Increments {
        let over = self.over.si();
        let part = if over > 0.0 { ((time - self.at.si()) / over).min(1.0) } else { 1.0 };
        // Not interpolated where it is over: the numbers of the file, to the last bit.
        if part < 1.0 { before.towards(&self.increments, part) } else { self.increments }
    }
}
