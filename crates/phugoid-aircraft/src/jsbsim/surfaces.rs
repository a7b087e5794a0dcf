//! What the aerodynamics of an aircraft read, and how far its surfaces go.

use super::aircraft::Aircraft;
use super::function::Op;
use super::scaling::Scaling;

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
