//! What is to be known of the channels of an aircraft before they fly it.

use super::aircraft::Aircraft;
use super::builtin::is_builtin;
use super::function::Op;
use super::model::Function;

impl Aircraft {
    /// Whether channels write a property, themselves or along with another.
    pub(crate) fn is_written(&self, index: usize) -> bool {
        self.channels.outputs().any(|output| output == index || self.model.linked(output).any(|other| other == index))
    }

    /// Whether a property follows its command through a drive of the files.
    pub(crate) fn has_drive(&self, index: usize) -> bool {
        // An angle may be written in degrees and read in radians.
        let mut outputs = self.channels.outputs();
        outputs.any(|output| {
            (output == index || self.model.linked(output).any(|other| other == index))
                && self.channels.has_drive(output)
        })
    }

    /// Which properties the channels read, themselves and through functions and tables.
    pub(crate) fn channels_read(&self) -> Vec<bool> {
        let all = self.channels.everything();
        let mut properties = all.properties;
        for table in all.tables {
            properties.extend(self.model.tables[table].variables.iter().flatten().map(|(index, _)| *index));
        }
        self.reached_from(all.functions, properties, false).properties
    }

    /// Which properties decide on some properties that channels write.
    pub(crate) fn decide_on(&self, properties: &[usize]) -> Vec<bool> {
        let mut written = properties.to_vec();
        // What is written along with another has no component of its own.
        for output in self.channels.outputs() {
            if self.model.linked(output).any(|other| properties.contains(&other)) {
                written.push(output);
            }
        }
        self.reached_from(Vec::new(), written, true).properties
    }

    /// Whether JSBSim itself has a property of this index, without a file that makes it.
    pub(crate) fn is_of_jsbsim(&self, index: usize) -> bool {
        is_builtin(&self.model.properties[index].name)
    }

    /// Whether a property is a force, a moment, or what an engine does: it has its value when forces were computed.
    pub(crate) fn follows_forces(&self, index: usize) -> bool {
        let name = &self.model.properties[index].name;
        self.fed.contain(index) && !self.fed.is_steady(index) && !name.starts_with("simulation/")
    }

    /// Keeps a property, and what is tied to it, at a value, whatever a channel makes of it.
    pub(crate) fn hold(&mut self, index: usize, value: f64) {
        self.model.begin(index, value);
        let along: Vec<usize> = self.model.linked(index).collect();
        for held in std::iter::once(index).chain(along) {
            if self.model.properties[held].function.is_some() {
                continue;
            }
            let (file, line) = self.model.properties[held].mentioned.clone().unwrap_or_default();
            let ops = vec![Op::Constant(self.model.properties[held].initial)];
            self.model.properties[held].function = Some(self.model.functions.len());
            self.model.functions.push(Function { ops, copy: None, file, line });
        }
    }
}
