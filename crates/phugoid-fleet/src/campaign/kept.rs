//! What consecutive units of a campaign share is read, opened and flown once.

use std::path::PathBuf;
use std::sync::Arc;

use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::{AircraftSettings, Scenario};

use super::unit::Unit;

/// What was made last, and of what.
#[derive(Debug)]
struct Last<K, T>(Option<(K, Result<T, String>)>);

impl<K: PartialEq, T> Last<K, T> {
    /// What is made of `key`: what was made last, if that was made of the same.
    fn of(&mut self, key: K, make: impl FnOnce() -> Result<T, String>) -> Result<&T, String> {
        if self.0.as_ref().is_some_and(|(last, _)| *last != key) {
            self.0 = None;
        }
        let (_, made) = self.0.get_or_insert_with(|| (key, make()));
        made.as_ref().map_err(Clone::clone)
    }
}

impl<K, T> Default for Last<K, T> {
    fn default() -> Self {
        Self(None)
    }
}

/// The model, the aircraft and the flight of the last unit. Nothing of it decides on a row: a unit gives the same with what was
/// kept and without.
#[derive(Debug, Default)]
pub struct Kept {
    models: KeptModel,
    flights: KeptFlight,
}

#[derive(Debug, Default)]
struct KeptModel(Last<(String, PathBuf, Arc<str>), ModelFile>);

/// Name, text and folder of a scenario, and its seed.
type Flown = (String, Arc<str>, PathBuf, u64);

#[derive(Debug, Default)]
struct KeptFlight {
    /// Folder and settings of the aircraft that was opened last.
    aircraft: Option<(PathBuf, AircraftSettings)>,
    last: Last<Flown, Flight>,
}

/// What keeps a unit from being estimated, in a sentence.
pub(super) enum Problem {
    Model(String),
    Flight(String),
}

impl Kept {
    /// The model of a unit and its flight.
    pub(super) fn of(&mut self, unit: &Unit) -> Result<(&ModelFile, &Flight), Problem> {
        let model = self.models.of(unit).map_err(Problem::Model)?;
        Ok((model, self.flights.of(unit).map_err(Problem::Flight)?))
    }
}

impl KeptModel {
    fn of(&mut self, unit: &Unit) -> Result<&ModelFile, String> {
        self.0.of((unit.model_name.clone(), unit.model_folder.clone(), Arc::clone(&unit.model)), || {
            // A `base` is looked for from the folder of the model file; a row does not depend on where that folder is.
            let file = unit.model_folder.join(&unit.model_name).display().to_string();
            ModelFile::parse(&file, &unit.model).map_err(|error| error.to_string().replace(&file, &unit.model_name))
        })
    }
}

impl KeptFlight {
    fn of(&mut self, unit: &Unit) -> Result<&Flight, String> {
        let Self { aircraft, last } = self;
        last.of((unit.scenario_name.clone(), Arc::clone(&unit.scenario), unit.folder.clone(), unit.seed), || {
            let mut scenario =
                Scenario::parse(&unit.scenario, &unit.scenario_name).map_err(|error| error.to_string())?;
            scenario.folder.clone_from(&unit.folder);
            scenario.seed = unit.seed;
            match aircraft {
                // Equal settings are the same aircraft, which the kept ones have opened.
                Some(kept) if *kept == (unit.folder.clone(), scenario.aircraft.clone()) => {
                    scenario.aircraft.clone_from(&kept.1);
                }
                // One that cannot be opened is refused by the flight.
                _ if scenario.aircraft.open(&unit.folder).is_ok() => {
                    *aircraft = Some((unit.folder.clone(), scenario.aircraft.clone()));
                }
                _ => {}
            }
            fly(&scenario).map_err(|error| error.to_string())
        })
    }
}
