//! What the thesis says of a case: the table `[published]` of a case file.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::result::Reproduction;
use phugoid_simulation::quantity::Time;

/// What was published, and what of it is ours.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Published {
    /// Where, e.g. `table 4.3, case 3`.
    pub place: String,
    /// What the text says, in a sentence or two.
    pub statement: String,
    /// What the text at hand has lost, and what we put in its place and why.
    pub reconstruction: String,
    /// What differs in our result, and why.
    pub difference: String,
    /// Published time to converge (5 %) by parameter.
    pub converged_after: BTreeMap<String, Time>,
}

impl Published {
    /// The result of a case with its words, and nothing found yet.
    pub fn reproduction(&self, id: &str, title: &str) -> Reproduction {
        Reproduction {
            id: id.to_owned(),
            title: title.to_owned(),
            place: self.place.clone(),
            published: self.statement.clone(),
            reconstruction: self.reconstruction.clone(),
            difference: self.difference.clone(),
            ..Reproduction::default()
        }
    }

    /// Published time to converge of a parameter, s from the start of the record.
    pub fn converged_s(&self, parameter: &str) -> Option<f64> {
        self.converged_after.get(parameter).map(|time| time.si())
    }
}
