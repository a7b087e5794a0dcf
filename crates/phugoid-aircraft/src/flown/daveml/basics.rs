//! Sizes, mass and inertia of an aircraft in DAVE-ML, taken once.

use std::path::Path;

use phugoid_flight_dynamics::aircraft::Geometry;

use super::super::error::FlownError;
use super::feed::FEEDS;
use super::wiring::{Wiring, value};
use crate::daveml::{Evaluator, Model};
use crate::vehicle::named::{LENGTH, Names};

/// Where the moment reference point is taken to be, in chords; only differences from it have a meaning.
const QUARTER: f64 = 0.25;
const AREA: [i8; 5] = [2, 0, 0, 0, 0];
const MASS: [i8; 5] = [0, 1, 0, 0, 0];
const INERTIA: [i8; 5] = [2, 1, 0, 0, 0];

/// What there is no flight without: name, dimension, and its unit in SI.
const NEEDED: [(&str, [i8; 5], &str); 7] = [
    ("referenceWingArea", AREA, "m2"),
    ("referenceWingSpan", LENGTH, "m"),
    ("referenceWingChord", LENGTH, "m"),
    ("totalMass", MASS, "kg"),
    ("bodyMomentOfInertia_Roll", INERTIA, "kg m2"),
    ("bodyMomentOfInertia_Pitch", INERTIA, "kg m2"),
    ("bodyMomentOfInertia_Yaw", INERTIA, "kg m2"),
];
/// What is zero where nobody says it.
const OTHERWISE_ZERO: [(&str, [i8; 5]); 6] = [
    ("bodyProductOfInertia_XY", INERTIA),
    ("bodyProductOfInertia_YZ", INERTIA),
    ("bodyProductOfInertia_ZX", INERTIA),
    ("bodyPositionOfCmWrtMrc_X", LENGTH),
    ("bodyPositionOfCmWrtMrc_Y", LENGTH),
    ("bodyPositionOfCmWrtMrc_Z", LENGTH),
];

/// Of the numbers that were given those that no model can be told: mass, inertia and sizes, in SI.
pub(super) fn given_in_si(models: &[Model], properties: &[(String, f64)]) -> Result<Vec<(String, f64)>, FlownError> {
    let mut own = Vec::new();
    for (name, value) in properties {
        if !value.is_finite() {
            return Err(FlownError::Number { what: "a property", value: *value, expected: "finite" });
        }
        if models.iter().any(|model| model.input_position(name).is_ok()) {
            continue;
        }
        if !is_basic(name) {
            let basic = NEEDED.iter().map(|(name, ..)| *name).chain(OTHERWISE_ZERO.iter().map(|(name, _)| *name));
            let basic = basic.collect::<Vec<_>>().join(", ");
            let settable =
                format!("an input of the models by its name or identifier, and in SI, where no model has it, {basic}");
            return Err(FlownError::Property { name: name.clone(), settable });
        }
        own.push((name.clone(), *value));
    }
    Ok(own)
}

/// Whether a name is one of those that can be given in SI where no model has it.
fn is_basic(name: &str) -> bool {
    let names = NEEDED.iter().map(|(name, ..)| name).chain(OTHERWISE_ZERO.iter().map(|(name, _)| name));
    names.into_iter().any(|known| known.eq_ignore_ascii_case(name))
}

/// The numbers, in SI.
pub(super) struct Basics {
    pub(super) mass_kg: f64,
    area_m2: f64,
    span_m: f64,
    chord_m: f64,
    moments: [f64; 3],
    products: [f64; 3],
    /// From the centre of gravity to the moment reference point, body axes, m.
    pub(super) arm_m: [f64; 3],
}

impl Basics {
    /// From the models, and from what was given in SI.
    pub(super) fn find(wiring: &Wiring, own: &[(String, f64)], file: &Path) -> Result<Self, FlownError> {
        let names = Names { models: wiring.models() };
        let mut evaluators: Vec<Evaluator> = wiring.evaluators();
        // None of it may follow the flight: what does is NaN.
        wiring.run(&mut evaluators, &[f64::NAN; FEEDS], u64::MAX);
        let number = |name: &str, dimension| -> Result<Option<f64>, FlownError> {
            if let Some((_, value)) = own.iter().find(|(given, _)| given.eq_ignore_ascii_case(name)) {
                return Ok(Some(*value));
            }
            let found = names.find(name, dimension);
            let found = found.map_err(|source| FlownError::Vehicle { file: file.into(), source })?;
            let Some(output) = found else { return Ok(None) };
            let value = value(&evaluators, output);
            if value.is_finite() {
                Ok(Some(value))
            } else {
                Err(FlownError::Follows { file: file.into(), name: name.to_owned() })
            }
        };
        let mut lacking = Vec::new();
        let mut needed = [0.0; NEEDED.len()];
        for (slot, (name, dimension, unit)) in needed.iter_mut().zip(NEEDED) {
            match number(name, dimension)? {
                Some(value) if value > 0.0 => *slot = value,
                Some(value) => return Err(FlownError::NotPositive { file: file.into(), name, value, unit }),
                None => lacking.push(format!("{name} ({unit})")),
            }
        }
        if !lacking.is_empty() {
            return Err(FlownError::Lacking { file: file.into(), names: lacking.join(", ") });
        }
        let mut others = [0.0; OTHERWISE_ZERO.len()];
        for (slot, (name, dimension)) in others.iter_mut().zip(OTHERWISE_ZERO) {
            *slot = number(name, dimension)?.unwrap_or(0.0);
        }
        let [area_m2, span_m, chord_m, mass_kg, xx, yy, zz] = needed;
        let [xy, yz, zx, x, y, z] = others;
        Ok(Self {
            mass_kg,
            area_m2,
            span_m,
            chord_m,
            moments: [xx, yy, zz],
            products: [xy, yz, zx],
            arm_m: [-x, -y, -z],
        })
    }

    pub(super) fn geometry(&self) -> Geometry {
        Geometry {
            wing_area: self.area_m2,
            span: self.span_m,
            mean_chord: self.chord_m,
            cg: QUARTER + self.arm_m[0] / self.chord_m,
            cg_reference: QUARTER,
        }
    }

    /// The inertia tensor, kg m2.
    pub(super) fn tensor(&self) -> [[f64; 3]; 3] {
        let ([xx, yy, zz], [xy, yz, zx]) = (self.moments, self.products);
        [[xx, -xy, -zx], [-xy, yy, -yz], [-zx, -yz, zz]]
    }
}
