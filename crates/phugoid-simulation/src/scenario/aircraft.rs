//! The aircraft of a scenario and where its flight starts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use phugoid_aircraft::flown::{FlownOptions, Thrust as FlownThrust};
use phugoid_aircraft::transport::Damage;
use phugoid_flight_dynamics::built_in::AircraftName;
use phugoid_flight_dynamics::f16::F16Tables;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::aircraft::{AircraftError, AnyAircraft};
use crate::quantity::{Angle, AngularRate, Force, Length, Speed, Time};

/// The aircraft of a scenario.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AircraftSettings {
    /// The built-in aircraft that flies, for instance the F-16; none where it comes from a `file`.
    #[serde(rename = "type", default)]
    pub kind: Option<AircraftName>,
    /// The file, or the folder, of the aircraft that flies, relative to the scenario file: an aircraft of JSBSim or in
    /// DAVE-ML, or a model file. The name of a built-in model (`hfb320`) where there is no such file.
    #[serde(default)]
    pub file: Option<PathBuf>,
    /// Further files of an aircraft in DAVE-ML, relative to the scenario file: models of mass and inertia or of the engine.
    #[serde(default)]
    pub with: Vec<PathBuf>,
    /// Properties of an aircraft of JSBSim by name, in its units, set once: contents of tanks, flaps, gear. In DAVE-ML
    /// variables in the unit of their file, and mass, inertia and sizes that no file has, in SI.
    #[serde(default)]
    pub properties: BTreeMap<String, f64>,
    /// Thrust at full throttle of an aircraft of JSBSim or in DAVE-ML, along body x, in place of its engines.
    #[serde(default)]
    pub largest_thrust: Option<Force>,
    /// Damage of the Generic Transport Model, for example `left-stabiliser-off`.
    #[serde(default)]
    pub damaged: Option<DamageWord>,
    /// When the damage happens; from the start of the flight where it is not given.
    #[serde(default)]
    pub damaged_at: Option<Time>,
    /// The set of aerodynamic tables that is used for the F-16: `book` or `morelli`.
    #[serde(default)]
    pub tables: Option<F16Tables>,
    /// Centre of gravity of the F-16, fraction of the mean aerodynamic chord; 0.35 where it is not given.
    #[serde(default)]
    pub cg: Option<f64>,
    /// Length of a dynamically scaled model over that of the aircraft that it stands for, 0.055 for one of 5.5 %; 1 where it is not
    /// given. `phugoid fly` asks of the model what is wanted of the full size.
    #[serde(default)]
    pub scale: Option<f64>,
    /// Whether the flight control system in the files of an aircraft of JSBSim moves the surfaces, and the manoeuvres the stick; without
    /// it, the manoeuvres move the surfaces. `properties` may then set what its channels read, such as the switches of an autopilot.
    #[serde(default)]
    pub flight_control: bool,
    /// Whether surfaces follow their commands through actuators (lag, rate and position limits) or at once.
    #[serde(default)]
    pub actuators: bool,
    /// Whether thrust stays as trimmed, or comes from the engine at fixed throttle.
    #[serde(default)]
    pub thrust: Thrust,
    /// The aircraft once it was opened.
    #[serde(skip)]
    opened: Opened,
}

/// The word for a damage of the Generic Transport Model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DamageWord(pub Damage);

impl<'de> Deserialize<'de> for DamageWord {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        Damage::from_word(&word).map(Self).ok_or_else(|| {
            let words = Damage::ALL.map(|damage| format!("`{}`", damage.word()));
            D::Error::custom(format!("unknown damage `{word}`, expected one of {}", words.join(", ")))
        })
    }
}

/// The aircraft of a scenario once it was opened, with the settings and the folder that it was opened for: others open another.
/// It follows from these, so that any two are equal.
#[derive(Clone, Debug, Default)]
struct Opened(Option<Arc<(AircraftSettings, PathBuf, Arc<AnyAircraft>)>>);

impl PartialEq for Opened {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl AircraftSettings {
    /// The aircraft, opened if it was not yet; relative paths start in `folder`.
    ///
    /// # Errors
    /// [`AircraftError`]: no such file, a file that cannot be read, or one that makes no aircraft.
    pub fn aircraft(&self, folder: &Path) -> Result<Arc<AnyAircraft>, AircraftError> {
        match self.opened.0.as_deref() {
            Some((settings, from, aircraft)) if settings == self && from == folder => Ok(Arc::clone(aircraft)),
            _ => Ok(Arc::new(self.read(folder)?)),
        }
    }

    /// Opens the aircraft once for all flights of this scenario and its copies.
    ///
    /// # Errors
    /// As [`aircraft`](Self::aircraft).
    pub fn open(&mut self, folder: &Path) -> Result<(), AircraftError> {
        let aircraft = Arc::new(self.read(folder)?);
        let settings = Self { opened: Opened(None), ..self.clone() };
        self.opened = Opened(Some(Arc::new((settings, folder.to_owned(), aircraft))));
        Ok(())
    }

    /// The parameters of a model file with their values; none for other aircraft, and for one that cannot be opened.
    pub(super) fn parameters(&self, folder: &Path) -> Option<BTreeMap<String, f64>> {
        self.file.as_ref()?;
        Some(self.aircraft(folder).ok()?.parameters().clone())
    }

    fn read(&self, folder: &Path) -> Result<AnyAircraft, AircraftError> {
        let Some(file) = &self.file else {
            return match self.kind {
                None | Some(AircraftName::F16) => AnyAircraft::f16(self.tables, self.cg),
            };
        };
        let thrust =
            self.largest_thrust.map_or(FlownThrust::Engines, |force| FlownThrust::AlongBodyX { largest_n: force.si() });
        let properties = self.properties.iter().map(|(name, value)| (name.clone(), *value)).collect();
        let with = self.with.iter().map(|file| folder.join(file)).collect();
        let damage = self.damaged.filter(|_| self.damaged_at.is_none()).map_or(Damage::None, |word| word.0);
        let options = FlownOptions {
            thrust,
            properties,
            with,
            damage,
            flight_control: self.flight_control,
            ..FlownOptions::default()
        };
        let beside = folder.join(file);
        // A name of a built-in model stands in no folder.
        let found = if beside.exists() || file.components().count() > 1 { &beside } else { file };
        AnyAircraft::open(found, &options)
    }

    /// The damage that happens in flight, and when, s; none for one that is there from the start.
    pub(crate) fn damage_in_flight(&self) -> Option<(Damage, f64)> {
        Some((self.damaged?.0, self.damaged_at?.si()))
    }

    pub(super) fn check(&self) -> Result<(), String> {
        if let Some(at) = self.damaged_at {
            if self.damaged.is_none() {
                return Err("`aircraft.damaged_at` needs `damaged`, the damage that happens then".to_owned());
            }
            if at.si() < 0.0 {
                return Err(format!("`aircraft.damaged_at` is {at}: a time from the start of the flight on"));
            }
        }
        match (&self.kind, &self.file) {
            (Some(_), None) | (None, Some(_)) => {}
            (None, None) => {
                return Err("`aircraft` needs `type = \"f16\"`, or `file` with the path of an aircraft".to_owned());
            }
            (Some(_), Some(_)) => return Err("`aircraft` has both `type` and `file`: give one of the two".to_owned()),
        }
        let f16_only = [("tables", self.tables.is_some()), ("cg", self.cg.is_some())];
        let file_only = [
            ("properties", !self.properties.is_empty()),
            ("largest_thrust", self.largest_thrust.is_some()),
            ("damaged", self.damaged.is_some()),
            ("with", !self.with.is_empty()),
            ("flight_control", self.flight_control),
        ];
        let (foreign, of) = match self.file {
            Some(_) => (f16_only.as_slice(), "type = \"f16\""),
            None => (file_only.as_slice(), "file"),
        };
        if let Some((key, _)) = foreign.iter().find(|(_, given)| *given) {
            return Err(format!("`aircraft.{key}` has a meaning with `{of}` alone: leave it out"));
        }
        if let Some(scale) = self.scale
            && !(0.005..=1.0).contains(&scale)
        {
            return Err(
                "`aircraft.scale` is the length of the model over that of the full size, 0.005 to 1 (0.055, not 5.5)"
                    .to_owned(),
            );
        }
        if let Some(cg) = self.cg
            && !(0.0..=1.0).contains(&cg)
        {
            return Err("`aircraft.cg` is a fraction of the mean chord, 0 to 1 (0.30, not 30)".to_owned());
        }
        Ok(())
    }
}

/// What thrust does after the trim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Thrust {
    /// Thrust keeps the value that it has in the trim, whatever the aircraft does afterwards.
    #[default]
    Constant,
    /// The engine at the trim throttle: thrust follows Mach number and altitude.
    Engine,
}

/// The steady condition in which the flight starts; the aircraft is trimmed there.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Altitude above mean sea level, in the standard atmosphere: geopotential over a plane, geometric over an `[earth]`.
    pub altitude: Length,
    /// True airspeed at the start of the flight.
    pub speed: Speed,
    /// Angle of climb, positive up.
    #[serde(default)]
    pub flight_path: Angle,
    /// Rate of turn about the vertical, positive to the right.
    #[serde(default)]
    pub turn_rate: AngularRate,
    /// Heading of the nose at the start, clockwise from north.
    #[serde(default)]
    pub heading: Angle,
}

/// How the aircraft that flies differs from what is known of it, beside the increments to be found. The default is no error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(non_snake_case)] // the field's own spelling, which scenario files use as well
pub struct ModelError {
    /// Factors on the aircraft's coefficients (body axes, about the centre of gravity).
    pub tables: TableFactors,
    /// Pitching moment with the square of the angle of attack from trim, per rad^2: a term that no model has.
    pub Cm_alpha_squared: f64,
    /// Recorded thrust less the true one, as a part of it: 0.1 for a record that is 10 % too high. Models that take their
    /// thrust from the trim do not see it.
    pub thrust: f64,
    /// What the record gives as the position of the surfaces.
    pub surfaces: RecordedSurfaces,
}

/// Factors of the true coefficients on those of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(non_snake_case)] // the field's own spelling, which scenario files use as well
pub struct TableFactors {
    /// Factor of the axial force coefficient, body x axis, positive forward; 1 leaves the tables as they are.
    pub CX: f64,
    /// Factor of the side force coefficient, body y axis, positive to the right; 1 leaves the tables as they are.
    pub CY: f64,
    /// Factor of the normal force coefficient, body z axis, positive down; 1 leaves the tables as they are.
    pub CZ: f64,
    /// Factor of the rolling moment coefficient, positive right wing down; 1 leaves the tables as they are.
    pub Cl: f64,
    /// Factor of the pitching moment coefficient, positive nose up; 1 leaves the tables as they are.
    pub Cm: f64,
    /// Factor of the yawing moment coefficient, positive nose right; 1 leaves the tables as they are.
    pub Cn: f64,
}

impl Default for TableFactors {
    fn default() -> Self {
        Self { CX: 1.0, CY: 1.0, CZ: 1.0, Cl: 1.0, Cm: 1.0, Cn: 1.0 }
    }
}

/// What is recorded as the position of a surface that moves through an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RecordedSurfaces {
    /// The true position of the surface, after the actuator, as its sensor measures it.
    #[default]
    Measured,
    /// The commanded position of the surface; an estimator then does not know the lag of the actuator.
    Commanded,
}

impl ModelError {
    pub(super) fn check(&self) -> Result<(), String> {
        let t = &self.tables;
        let factors = [("CX", t.CX), ("CY", t.CY), ("CZ", t.CZ), ("Cl", t.Cl), ("Cm", t.Cm), ("Cn", t.Cn)];
        if let Some((name, value)) = factors.into_iter().find(|(_, f)| !(*f > 0.0 && f.is_finite())) {
            return Err(format!(
                "`model_error.tables.{name}` is {value}: it is a positive factor (1.1 for ten per cent more)"
            ));
        }
        if !self.Cm_alpha_squared.is_finite() {
            return Err(format!("`model_error.Cm_alpha_squared` is {}: per rad^2", self.Cm_alpha_squared));
        }
        if !(self.thrust > -1.0 && self.thrust.is_finite()) {
            return Err(format!(
                "`model_error.thrust` is {}: it is a part of the true thrust (0.1 for ten per cent too high)",
                self.thrust
            ));
        }
        Ok(())
    }
}
