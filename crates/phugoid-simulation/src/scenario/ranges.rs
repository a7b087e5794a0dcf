//! Increments that differ from flight to flight.

use std::collections::BTreeMap;

use phugoid_flight_dynamics::increments::Increments;
use rand::RngExt;
use rand_pcg::Pcg64;
use serde::Deserialize;

use crate::text::nearest;

/// Increments that are drawn evenly between two values, by name.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Ranges(pub BTreeMap<String, [f64; 2]>);

impl Ranges {
    pub(super) fn check(&self) -> Result<(), String> {
        let names = Increments::NONE.named().map(|(name, _)| name);
        for (name, [low, high]) in &self.0 {
            if !names.contains(&name.as_str()) {
                let near = nearest(name, names.into_iter()).map(|n| format!(": did you mean `{n}`?"));
                return Err(format!("no increment has the name `{name}`{}", near.unwrap_or_default()));
            }
            if !(low <= high && low.is_finite() && high.is_finite()) {
                return Err(format!("the range of `{name}` is [{low}, {high}]: expected [lower, upper]"));
            }
        }
        Ok(())
    }

    /// Draws in the order of the names.
    pub(super) fn draw(&mut self, increments: &mut Increments, random: &mut Pcg64) {
        for (name, [low, high]) in std::mem::take(&mut self.0) {
            let value = low + (high - low) * random.random::<f64>();
            if let Some(increment) = increments.by_name_mut(&name) {
                *increment = value;
            }
        }
    }
}
