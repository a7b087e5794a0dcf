//! Damage: what changes on the aircraft in flight.

use std::collections::BTreeMap;

use phugoid_flight_dynamics::increments::Increments;
use serde::Deserialize;

use super::ranges::Ranges;
use crate::damaged::{COEFFICIENTS, Effects, VARIABLES};
use crate::quantity::{Length, Time};
use crate::text::nearest;

/// A change of the aircraft in flight, sudden or gradual. It says everything that differs from the undamaged aircraft once it is
/// complete: what an earlier one changed and this one does not name is whole again.
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
    /// Constant coefficients that are added, by coefficient: `{ Cm = -0.01, Cl = 0.004 }`. `CL` and `CD` in stability axes, the
    /// others in body axes.
    #[serde(default)]
    pub constants: BTreeMap<String, f64>,
    /// Terms that couple the axes, per rad, about the trim: `{ Cl_alpha = 0.05, Cm_beta = 0.1 }`. Rates are dimensionless as in
    /// model files.
    #[serde(default)]
    pub coupling: BTreeMap<String, f64>,
    /// What is left of a surface, 0 to 1: the factor on the deflection that the aerodynamics feel, `{ elevator = 0.6 }`.
    #[serde(default)]
    pub effectiveness: BTreeMap<String, f64>,
    /// Factor on the mass, 1 for the whole aircraft.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Factors on the moments of inertia about body x, y and z.
    #[serde(default)]
    pub inertia: Option<[f64; 3]>,
    /// How far the centre of gravity moves aft, fraction of the mean chord. The motion is then that of the new one; the small
    /// difference in velocity between the two at that moment is left out.
    #[serde(default)]
    pub cg_shift: f64,
    /// Factor on the thrust, 1 for all of it.
    #[serde(default)]
    pub thrust: Option<f64>,
    /// How far to the right of the plane of symmetry the thrust acts.
    #[serde(default)]
    pub thrust_arm: Length,
}

/// The surfaces in the order of [`Effects::effectiveness`].
const SURFACES: [&str; 3] = ["elevator", "aileron", "rudder"];

impl Damage {
    /// A change that is complete at once and whose increments are given, not drawn.
    pub fn sudden(at: Time, increments: Increments) -> Self {
        Self { at, increments, ..Self::default() }
    }

    /// Whether it changes more than increments.
    pub fn has_effects(&self) -> bool {
        self.effects() != Effects::NONE
    }

    /// What it changes beside the increments, once it is complete.
    pub fn effects(&self) -> Effects {
        let mut effects = Effects::NONE;
        for (i, coefficient) in COEFFICIENTS.into_iter().enumerate() {
            effects.constants[i] = self.constants.get(coefficient).copied().unwrap_or(0.0);
            for (j, variable) in VARIABLES.into_iter().enumerate() {
                effects.coupling[i][j] =
                    self.coupling.get(&format!("{coefficient}_{variable}")).copied().unwrap_or(0.0);
            }
        }
        for (left, surface) in effects.effectiveness.iter_mut().zip(SURFACES) {
            *left = self.effectiveness.get(surface).copied().unwrap_or(1.0);
        }
        Effects {
            mass: self.mass.unwrap_or(1.0),
            inertia: self.inertia.unwrap_or([1.0; 3]),
            cg_shift: self.cg_shift,
            thrust: self.thrust.unwrap_or(1.0),
            thrust_arm: self.thrust_arm.si(),
            ..effects
        }
    }

    /// The increments at a time (s) from [`at`](Self::at) on, when `before` held until then.
    pub(crate) fn after(&self, before: &Increments, time: f64) -> Increments {
        let part = self.part(time);
        // Not interpolated where it is over: the numbers of the file, to the last bit.
        if part < 1.0 { before.towards(&self.increments, part) } else { self.increments }
    }

    /// The effects at a time (s) from [`at`](Self::at) on, when `before` held until then and `complete` are its own
    /// [`effects`](Self::effects).
    pub(crate) fn effects_after(&self, before: &Effects, complete: &Effects, time: f64) -> Effects {
        let part = self.part(time);
        if part < 1.0 { before.towards(complete, part) } else { *complete }
    }

    /// How much of the change has happened, 0 to 1.
    pub(crate) fn part(&self, time: f64) -> f64 {
        let over = self.over.si();
        if over > 0.0 { ((time - self.at.si()) / over).min(1.0) } else { 1.0 }
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let known = |name: &str, names: &[&str], what: &str| {
            if names.contains(&name) {
                return Ok(());
            }
            let near = nearest(name, names.iter().copied()).map(|n| format!(": did you mean `{n}`?"));
            Err(format!("`{what}` of a `[[damage]]` knows no `{name}`{}", near.unwrap_or_default()))
        };
        let crossing: Vec<String> = COEFFICIENTS.into_iter().flat_map(cross_terms).collect();
        let crossing: Vec<&str> = crossing.iter().map(String::as_str).collect();
        for (table, names, what) in [
            (&self.constants, COEFFICIENTS.as_slice(), "constants"),
            (&self.coupling, crossing.as_slice(), "coupling"),
            (&self.effectiveness, SURFACES.as_slice(), "effectiveness"),
        ] {
            for (name, value) in table {
                known(name, names, what)?;
                if !value.is_finite() {
                    return Err(format!("`{what}.{name}` of a `[[damage]]` is {value}: expected a finite number"));
                }
            }
        }
        if let Some((name, left)) = self.effectiveness.iter().find(|(_, left)| !(0.0..=1.0).contains(*left)) {
            return Err(format!("`effectiveness.{name}` of a `[[damage]]` is {left}: what is left of it, 0 to 1"));
        }
        let factors = self.mass.into_iter().chain(self.inertia.into_iter().flatten());
        if let Some(factor) = factors.into_iter().find(|factor| !(*factor > 0.0 && factor.is_finite())) {
            return Err(format!("a factor on mass or inertia of a `[[damage]]` is {factor}: 0.9 for a tenth less"));
        }
        if !self.cg_shift.is_finite() || self.cg_shift.abs() > 1.0 {
            return Err(format!("`cg_shift` of a `[[damage]]` is {}: a fraction of the mean chord", self.cg_shift));
        }
        match self.thrust {
            Some(left) if !(0.0..=1.0).contains(&left) => {
                Err(format!("`thrust` of a `[[damage]]` is {left}: what is left of it, 0 to 1"))
            }
            _ => Ok(()),
        }
    }
}

/// The terms of a coefficient in variables of the other axes: those of its own axes are increments.
fn cross_terms(coefficient: &'static str) -> impl Iterator<Item = String> {
    let own: &[&str] = match coefficient {
        "CL" | "CD" | "Cm" => &["alpha", "q", "elevator"],
        _ => &["beta", "p", "r", "aileron", "rudder"],
    };
    VARIABLES.into_iter().filter(move |variable| !own.contains(variable)).map(move |v| format!("{coefficient}_{v}"))
}
