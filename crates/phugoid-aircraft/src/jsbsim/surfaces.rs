//! What the aerodynamics of an aircraft read, and how far its surfaces go.

use super::aircraft::Aircraft;
use super::builtin::is_builtin;
use super::error::{JsbsimError, Omission};
use super::function::{Op, check_circles};
use super::propulsion::Source;
use super::scaling::Scaling;
use super::source::shortened;

/// What gives a property its value elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Awaited {
    /// A component of a channel.
    Channel,
    /// A part of the files that is left out.
    LeftOut,
    /// JSBSim itself.
    Jsbsim,
}

/// Properties and tables that functions and properties go through.
pub(super) struct Reached {
    pub(super) properties: Vec<bool>,
    tables: Vec<bool>,
}

impl Aircraft {
    /// What functions go through, themselves and by other functions, and where `channels` is set by the components of channels.
    pub(super) fn reached_from(&self, functions: Vec<usize>, properties: Vec<usize>, channels: bool) -> Reached {
        let model = &self.model;
        let mut reached =
            Reached { properties: vec![false; model.properties.len()], tables: vec![false; model.tables.len()] };
        let mut called = vec![false; model.functions.len()];
        let (mut open, mut read) = (functions, properties);
        loop {
            if let Some(index) = read.pop() {
                if std::mem::replace(&mut reached.properties[index], true) {
                    continue;
                }
                open.extend(model.properties[index].function);
                if channels {
                    let feeding = self.channels.feeding(index);
                    read.extend(feeding.properties);
                    open.extend(feeding.functions);
                    for table in feeding.tables {
                        reached.tables[table] = true;
                        read.extend(model.tables[table].variables.iter().flatten().map(|(index, _)| *index));
                    }
                }
            } else if let Some(function) = open.pop() {
                if std::mem::replace(&mut called[function], true) {
                    continue;
                }
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
            } else {
                return reached;
            }
        }
    }

    fn reached(&self) -> Reached {
        self.reached_from(self.aerodynamics.functions().collect(), Vec::new(), false)
    }

    /// The functions and the properties that the engines read.
    fn read_by_engines(&self) -> (Vec<usize>, Vec<usize>) {
        let (mut functions, mut properties) = (Vec::new(), Vec::new());
        for source in self.engines.iter().flat_map(|engine| engine.sources()) {
            match source {
                Source::Property(index) => properties.push(index),
                Source::Function(index) => functions.push(index),
            }
        }
        (functions, properties)
    }

    /// Whether a part of the files makes a property, or this crate does.
    fn is_made(&self, index: usize) -> bool {
        let property = &self.model.properties[index];
        property.declared
            || property.function.is_some()
            || property.left_out
            || self.flight.contain(index)
            || self.fed.contain(index)
            || self.constants.contains(&index)
    }

    /// Refuses a property that aerodynamics or engines read, themselves or through the channels that feed them, and that nothing
    /// makes: neither the files nor JSBSim. Where a file that the aircraft refers to is missing, it may be made there: then it is
    /// among what is left out.
    ///
    /// # Errors
    /// [`JsbsimError::Refused`] with the name and the line where it is first named.
    pub(super) fn check_sources(&mut self, complete: bool) -> Result<(), JsbsimError> {
        let (mut functions, properties) = self.read_by_engines();
        functions.extend(self.aerodynamics.functions());
        let reached = self.reached_from(functions, properties, true);
        for (index, property) in self.model.properties.iter().enumerate() {
            let Some((file, line)) = property.mentioned.clone() else { continue };
            if !reached.properties[index] || self.is_made(index) || is_builtin(&property.name) {
                continue;
            }
            // What a left out section makes has names of its own.
            let folder = property.name.split('/').next().unwrap_or_default();
            if self.omitted.iter().any(|omission| omission.what.starts_with(&format!("<{folder}>"))) {
                continue;
            }
            let name = shortened(&property.name);
            if complete {
                let what = format!(
                    "nothing makes the property {name}: no component, function or <property> of the files has this name, and \
                     JSBSim has none of it"
                );
                return Err(JsbsimError::Refused { file, line, what });
            }
            let what = format!("{name}, which nothing makes without the files that are missing, stays at 0");
            self.omitted.push(Omission { file, line, what });
        }
        Ok(())
    }

    /// Names of the properties that the aerodynamics read, themselves and through functions.
    pub(crate) fn aerodynamics_read(&self) -> Vec<&str> {
        let reached = self.reached();
        let properties = self.model.properties.iter().zip(reached.properties);
        properties.filter(|(_, read)| *read).map(|(property, _)| property.name.as_str()).collect()
    }

    /// Makes functions of the components of channels that have no memory, whose outputs aerodynamics or engines read, and that
    /// follow from the flight condition and from constants of the files alone: their values are those of every moment, though
    /// channels do not run. Positions of surfaces and gear stay to be set. Gives the names of those outputs.
    ///
    /// # Errors
    /// [`JsbsimError::Refused`] where the functions then need their own values.
    pub(crate) fn compute_steady_channels(&mut self) -> Result<Vec<String>, JsbsimError> {
        let (mut functions, properties) = self.read_by_engines();
        functions.extend(self.aerodynamics.functions());
        let outputs = self.outputs();
        let mut computed = Vec::new();
        loop {
            let reached = self.reached_from(functions.clone(), properties.clone(), true);
            let next = outputs.iter().copied().find_map(|output| {
                let property = &self.model.properties[output];
                let is_position = property.name.starts_with("gear/")
                    || property.name.starts_with("fcs/") && property.name.contains("-pos-");
                if !reached.properties[output] || property.function.is_some() || is_position {
                    return None;
                }
                let steady = self.channels.steady(&self.model, output)?;
                let read = self.reached_from(steady.functions.clone(), steady.properties.clone(), false);
                let mut leaves = (0..read.properties.len()).filter(|&index| read.properties[index]);
                leaves.all(|index| index != output && self.is_known(index, &outputs)).then_some((output, steady))
            });
            let Some((output, steady)) = next else {
                check_circles(&self.model)?;
                return Ok(computed);
            };
            computed.push(self.model.properties[output].name.clone());
            steady.become_function(&mut self.model, output);
        }
    }

    /// Whether the value of a property is known at every moment without channels that run.
    fn is_known(&self, index: usize, outputs: &[usize]) -> bool {
        self.is_computed(index)
            || self.constants.contains(&index)
            || self.model.properties[index].declared && outputs.binary_search(&index).is_err()
    }

    /// Names of the properties that the engines read, themselves and through functions.
    pub(crate) fn engines_read(&self) -> Vec<&str> {
        let (functions, properties) = self.read_by_engines();
        let reached = self.reached_from(functions, properties, false);
        let properties = self.model.properties.iter().zip(reached.properties);
        properties.filter(|(_, read)| *read).map(|(property, _)| property.name.as_str()).collect()
    }

    /// Names of the properties that mass, centre and inertia follow.
    pub(crate) fn masses_read(&self) -> Vec<&str> {
        self.masses.properties_read().map(|index| self.model.properties[index].name.as_str()).collect()
    }

    /// Whether this crate computes a property, or a function of the files does, so that a value that is set does not last.
    pub(crate) fn is_computed(&self, index: usize) -> bool {
        self.model.properties[index].function.is_some() || self.flight.contain(index) || self.fed.is_steady(index)
    }

    /// Who would give a property its value that nobody gives here while channels do not run; none for one that has its value.
    pub(crate) fn awaited(&self, index: usize) -> Option<Awaited> {
        let property = &self.model.properties[index];
        if self.is_computed(index) || self.constants.contains(&index) {
            None
        } else if self.channels.outputs().any(|output| output == index) {
            Some(Awaited::Channel)
        } else if property.declared {
            None
        } else {
            Some(if property.left_out { Awaited::LeftOut } else { Awaited::Jsbsim })
        }
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
