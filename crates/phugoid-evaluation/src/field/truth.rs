//! What is known of a flight of the field: the file beside its record.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::FieldError;

/// The part of the field that a flight belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// Flights to develop with: they may be looked at as often as one likes.
    Develop,
    /// Flights that are looked at once, at the end: other aircraft, and other flights of the same ones.
    LookOnce,
}

impl Split {
    /// The word in the files and on the command line.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Develop => "develop",
            Self::LookOnce => "look-once",
        }
    }
}

/// Whether a flight has errors of sensors that a model file cannot know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Noise, turbulence, filters that are the same in all channels, missing values, outliers; no systematic error.
    Sound,
    /// Systematic errors of sensors, of the clock, or of what the model file says of the aircraft.
    Faulty,
}

/// The true value of one parameter of the model file.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct TrueParameter {
    /// Least-squares fit of the simulator's own coefficients by the terms of the model file over the samples of this
    /// flight, per radian where an angle is involved.
    pub value: f64,
    /// Part of the motion of the coefficient that this term makes, 0 to 1.
    pub share: f64,
    /// Standard error of `value` that what the terms do not explain would make, in the unit of `value`.
    pub structure_std: f64,
    /// Whether the share is large enough (5 %) for the flight to show the derivative. False for constants.
    pub well_excited: bool,
}

/// Largest `structure_std`, as a part of the value, with which a true value counts as defined by the flight. Where the
/// terms do not describe the coefficient, two least squares with other weights already differ by more.
const DEFINED: f64 = 0.1;

impl TrueParameter {
    /// Whether an estimate can be compared with it: well excited, and the terms describe the coefficient well enough for
    /// the flight to have one value.
    pub fn counts(&self) -> bool {
        self.well_excited && self.structure_std <= DEFINED * self.value.abs()
    }
}

/// The true parameters up to a time, or of the whole flight.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TrueParameters {
    /// True values by the name of the parameter in the model file.
    pub parameters: BTreeMap<String, TrueParameter>,
}

/// A change of the aircraft in flight.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TrueChange {
    /// Time of the change, s, on the time base of the record.
    pub time_s: f64,
    /// By how much each changed parameter differs from then on.
    pub changes: BTreeMap<String, f64>,
    /// True values after it.
    pub after: BTreeMap<String, TrueParameter>,
}

/// What is known of a flight.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Truth {
    /// Name of the flight.
    pub flight: String,
    /// Name of the aircraft in the simulator.
    pub aircraft: String,
    /// The part of the field that it belongs to.
    pub split: Split,
    /// Whether it has systematic errors.
    pub kind: Kind,
    /// Group that it is counted in, e.g. `light turbulence`.
    pub group: String,
    /// The axes of its model file, `longitudinal` or `lateral`.
    pub axes: String,
    /// File name of the model file, in the folder of this file.
    pub model: String,
    /// File name of the record, in the folder of this file.
    pub record: String,
    /// True values before the change, or of the whole flight where nothing changes.
    pub truth: TrueParameters,
    /// Terms that the aircraft has and the model file has not: coefficient and term, as a model file writes them.
    #[serde(default)]
    pub missing: Vec<(String, String)>,
    /// The change, where the aircraft changes in flight.
    #[serde(default)]
    pub change: Option<TrueChange>,
    /// Folder of the files; not in the file.
    #[serde(skip)]
    pub folder: PathBuf,
}

impl Truth {
    /// The true values at the end of the flight.
    pub fn at_end(&self) -> &BTreeMap<String, TrueParameter> {
        self.change.as_ref().map_or(&self.truth.parameters, |change| &change.after)
    }

    /// Whether an error of the estimate has no excuse: a sound record of an aircraft that does not change.
    pub fn is_healthy(&self) -> bool {
        self.kind == Kind::Sound && self.change.is_none()
    }
}

/// The flights of one part of the field, from all folders below `folder`, in the order of their paths.
///
/// # Errors
/// [`FieldError`]: a folder or file cannot be read, a file is not what the field's generator writes, or no flight of this
/// part is there.
pub fn find(folder: &Path, split: Split) -> Result<Vec<Truth>, FieldError> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    files.sort();
    let mut flights = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).map_err(|error| FieldError::reading(&file, error))?;
        let mut truth: Truth = serde_json::from_str(&text)
            .map_err(|error| FieldError::Truth { file: file.display().to_string(), error: error.to_string() })?;
        if truth.split == split {
            truth.folder = file.parent().unwrap_or(folder).to_owned();
            flights.push(truth);
        }
    }
    if flights.is_empty() {
        return Err(FieldError::Empty { folder: folder.display().to_string(), split: split.word() });
    }
    Ok(flights)
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), FieldError> {
    let entries = std::fs::read_dir(folder).map_err(|error| FieldError::reading(folder, error))?;
    for entry in entries {
        let path = entry.map_err(|error| FieldError::reading(folder, error))?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.to_string_lossy().ends_with(".truth.json") {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(value: f64, structure_std: f64, well_excited: bool) -> TrueParameter {
        TrueParameter { value, share: 0.3, structure_std, well_excited }
    }

    #[test]
    fn only_what_the_flight_shows_and_the_terms_describe_counts() {
        assert!(parameter(-0.8, 0.02, true).counts());
        assert!(!parameter(-0.8, 0.02, false).counts());
        assert!(!parameter(-0.8, 0.2, true).counts());
    }

    #[test]
    fn a_folder_without_flights_of_the_part_is_refused_with_what_to_do() {
        let folder = std::env::temp_dir().join(format!("phugoid-field-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let error = find(&folder, Split::LookOnce).unwrap_err().to_string();
        assert!(error.contains("no flight of the part `look-once`") && error.contains("make.py"), "{error}");
        std::fs::write(folder.join("a.truth.json"), "{}").unwrap();
        let error = find(&folder, Split::LookOnce).unwrap_err().to_string();
        assert!(error.contains("a.truth.json") && error.contains("missing field"), "{error}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
