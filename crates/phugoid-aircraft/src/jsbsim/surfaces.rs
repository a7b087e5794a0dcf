//! What the aerodynamics of an aircraft read, and how far its surfaces go.

use super::aircraft::Aircraft;
use super::function::Op;

/// How a property follows from another through a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scaling {
    /// The other property, by its index, and its sign.
    pub(crate) input: (usize, f64),
    /// Ends of the other property.
    pub(crate) domain: [f64; 2],
    /// The values at these ends.
    pub(crate) range: [f64; 2],
    /// Whether 0 goes to 0, with a slope of its own on either side.
    pub(crate) centred: bool,
}

impl Scaling {
    /// The value for one of the other property times its sign. It goes on beyond the ends, and is NaN for an empty domain.
    pub(crate) fn value(&self, x: f64) -> f64 {
        let ([low, high], [least, most]) = (self.domain, self.range);
        if self.centred {
            return if x < 0.0 { least * x / low } else { most * x / high };
        }
        least + (most - least) * (x - low) / (high - low)
    }
}

/// A property of the aerodynamics that follows the angle of a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Follower {
    pub(crate) property: usize,
    /// What the angle is multiplied by, one after the other.
    pub(crate) factors: [f64; 2],
    /// The scale of the result, if it is not the result itself.
    pub(crate) scaling: Option<Scaling>,
}

/// Properties and tables that the aerodynamics go through.
struct Reached {
    properties: Vec<bool>,
    tables: Vec<bool>,
}

impl Aircraft {
    fn reached(&self) -> Reached {
        let model = &self.model;
        let mut reached =
            Reached { properties: vec![false; model.properties.len()], tables: vec![false; model.tables.len()] };
        let mut called = vec![false; model.functions.len()];
        let mut open: Vec<usize> = self.aerodynamics.functions().collect();
        while let Some(function) = open.pop() {
            if std::mem::replace(&mut called[function], true) {
                continue;
            }
            let mut read = Vec::new();
            for op in &model.functions[function].ops {
                match *op {
                    Op::Property(index, _) => read.push(index),
                    Op::Table(table) => {
                        reached.tables[table] = true;
                        read.extend(model.tables[table].variables.iter().flatten().map(|(index, _)| *index));
                    }
                    Op::Constant(_) | Op::Apply(..) => {}
                }
            }
            for index in read {
                reached.properties[index] = true;
                open.extend(model.properties[index].function);
            }
        }
        reached
    }

    /// Names of the properties that the aerodynamics read, themselves and through functions.
    pub(crate) fn aerodynamics_read(&self) -> Vec<&str> {
        let reached = self.reached();
        let properties = self.model.properties.iter().zip(reached.properties);
        properties.filter(|(_, read)| *read).map(|(property, _)| property.name.as_str()).collect()
    }

    /// Lowest and highest angle of attack of the tables of the aerodynamics, rad; none without a table over it.
    pub(crate) fn alpha_of_tables(&self) -> Option<[f64; 2]> {
        let units = [("aero/alpha-rad", 1.0), ("aero/alpha-deg", std::f64::consts::PI / 180.0)];
        let units = units.map(|(name, factor)| (self.property(name), factor));
        let mut widest: Option<[f64; 2]> = None;
        for (lookup, _) in self.model.tables.iter().zip(self.reached().tables).filter(|(_, reached)| *reached) {
            for (place, variable) in lookup.variables.iter().enumerate() {
                let Some((index, sign)) = *variable else { continue };
                let Some((_, factor)) = units.iter().find(|(unit, _)| *unit == Some(index)) else { continue };
                let Some(ends) = lookup.table.ends(place) else { continue };
                let [a, b] = ends.map(|end| sign * factor * end);
                let (low, high) = (a.min(b), a.max(b));
                widest = Some(widest.map_or([low, high], |[least, most]| [least.min(low), most.max(high)]));
            }
        }
        widest.filter(|[low, high]| low < high)
    }

    /// How a property follows from another through a scale of flight control, looked for through lags and actuators.
    pub(crate) fn scaling(&self, property: &str) -> Option<Scaling> {
        self.channels.scaling(self.property(property)?)
    }
}
