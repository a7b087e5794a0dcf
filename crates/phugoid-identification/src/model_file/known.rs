//! The aircraft of a file that the terms of a model file are increments to.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use phugoid_aircraft::flown::{AircraftFile, FlownOptions};
use phugoid_flight_dynamics::aircraft::Aircraft;
use toml::Spanned;
use toml::de::DeValue;

use super::aircraft::Base;
use super::error::ModelFileError;
use super::section::Section;

/// An aircraft of another program's file, as the `base` of a model file names it. Two are equal if they are read from the same
/// file in the same way.
#[derive(Clone, Debug)]
pub struct KnownAircraft {
    file: PathBuf,
    options: FlownOptions,
    aircraft: Arc<AircraftFile>,
}

impl PartialEq for KnownAircraft {
    fn eq(&self, other: &Self) -> bool {
        (&self.file, &self.options) == (&other.file, &other.options)
    }
}

impl KnownAircraft {
    /// The file, or the folder, that it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The last part of its path, for a sentence.
    pub(crate) fn name(&self) -> String {
        self.file
            .file_name()
            .map_or_else(|| self.file.display().to_string(), |name| name.to_string_lossy().into_owned())
    }

    /// The aircraft.
    pub fn aircraft(&self) -> &Arc<AircraftFile> {
        &self.aircraft
    }

    /// The same with another aircraft in its place, which has the same sizes.
    pub(crate) fn with(&self, aircraft: Arc<AircraftFile>) -> Self {
        Self { aircraft, ..self.clone() }
    }

    /// The files that it was read from, its own first.
    ///
    /// # Errors
    /// A folder of tables that cannot be listed.
    pub fn files(&self) -> std::io::Result<Vec<PathBuf>> {
        self.aircraft.files(&self.file, &self.options)
    }

    /// Moments of inertia Ixx, Iyy, Izz and the product Ixz, kg m^2.
    pub(crate) fn inertia(&self) -> [f64; 4] {
        let tensor = self.aircraft.mass_properties().inertia_tensor();
        [tensor[0][0], tensor[1][1], tensor[2][2], -tensor[0][2]]
    }

    /// Angle of the thrust line above body x, rad, and pitching moment per newton, m, at half power near the ground; zero
    /// without thrust.
    pub(super) fn thrust_line(&self) -> [f64; 2] {
        let push = self.aircraft.propulsion(50.0, 0.0, 0.3);
        let [x, _, z] = push.force;
        let size = x.hypot(z);
        if size > 0.0 && size.is_finite() { [(-z).atan2(x), push.moment[1] / size] } else { [0.0; 2] }
    }
}

/// What the terms are added to: a word, the path of an aircraft relative to the model file, or a table with `file`, `with` and
/// `properties`.
pub(super) fn base(top: &Section) -> Result<(Base, Option<KnownAircraft>), ModelFileError> {
    let folder = Path::new(top.source.file).parent().unwrap_or(Path::new(""));
    let (file, mut options) = match top.get("base").map(Spanned::get_ref) {
        None => return Ok((Base::None, None)),
        Some(DeValue::Table(_)) => {
            let Some(section) = top.section("base")? else { return Ok((Base::None, None)) };
            section.allow("key", ["file", "with", "properties"].into_iter())?;
            let file = section.string("file")?.ok_or_else(|| section.missing("file", "the path of an aircraft"))?;
            let with = section.strings("with")?.unwrap_or_default();
            let with = with.into_iter().map(|(file, _)| folder.join(file)).collect();
            let mut properties = Vec::new();
            if let Some(numbers) = section.section("properties")? {
                for (name, _) in numbers.keys() {
                    let value = numbers.number(name, phugoid_flight_data::quantity::Dimension::NUMBER)?;
                    properties.extend(value.map(|value| (name.to_owned(), value)));
                }
            }
            (file, FlownOptions { with, properties, ..FlownOptions::default() })
        }
        Some(_) => {
            let word = top.string("base")?.unwrap_or_default();
            match word {
                "none" => return Ok((Base::None, None)),
                "f16" => return Ok((Base::F16, None)),
                _ => {}
            }
            let is_path = word.contains(['/', '\\', '.']) || folder.join(word).exists();
            if !is_path {
                if let Err(error) = top.word("base", &["none", "f16"])
                    && error.nearest.is_some()
                {
                    return Err(error);
                }
                return Err(top.error(
                    "base",
                    format!(
                        "unknown word `{word}` for `base`: expected \"none\", \"f16\", or the path of an aircraft of JSBSim or in \
                         DAVE-ML, and there is no such file beside the model file"
                    ),
                ));
            }
            (word, FlownOptions::default())
        }
    };
    let path = folder.join(file);
    if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("toml")) {
        let message = "a base is \"f16\" or an aircraft of JSBSim or in DAVE-ML, not another model file: give its values as \
                       `start` instead";
        return Err(top.error("base", message));
    }
    // The same gravity as of a model file that does not say it.
    options.gravity = super::aircraft::STANDARD_GRAVITY;
    let aircraft = AircraftFile::open_with(&path, &options);
    let aircraft = aircraft.map_err(|error| top.error("base", format!("the base cannot be read: {error}")))?;
    Ok((Base::Aircraft, Some(KnownAircraft { file: path, options, aircraft: Arc::new(aircraft) })))
}
