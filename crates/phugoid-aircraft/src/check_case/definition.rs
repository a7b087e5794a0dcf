//! Definitions of the check cases, read from `cases.json`.

use std::path::{Path, PathBuf};

use phugoid_flight_dynamics::globe::attitude::EulerAngles;
use phugoid_flight_dynamics::globe::condition::{InitialRates, Launch, Wind, World};
use phugoid_flight_dynamics::globe::loads::BluntBody;
use phugoid_flight_dynamics::globe::planet::{Ellipsoid, Geodetic, Planet};
use phugoid_flight_dynamics::mass::MassProperties;
use serde_json::Value;

use super::CheckCaseError;
use super::sentence::{fraction, numbers_before};
use super::trajectory::{FOOT, KNOT, SLUG};

/// The check cases of a file.
#[derive(Clone, Debug)]
pub struct CheckCases {
    definitions: Value,
    /// Folder of the F-16 in DAVE-ML.
    aircraft: PathBuf,
}

/// One check case, ready to be flown.
#[derive(Clone, Debug)]
pub struct CheckCase {
    /// Its number, such as `13p1`.
    pub id: String,
    /// What happens in it.
    pub title: String,
    /// Earth, air and wind.
    pub world: World,
    /// The vehicle.
    pub vehicle: CheckVehicle,
    /// How the flight begins; pitch, roll and rates of a vehicle that is trimmed first are a guess.
    pub launch: Launch,
    /// Length of the flight, s.
    pub duration: f64,
    /// Interval between the rows of the trajectory, s.
    pub output_interval: f64,
}

/// Vehicle of a check case.
#[derive(Clone, Debug, PartialEq)]
pub enum CheckVehicle {
    /// The sphere or the brick.
    Blunt(Box<BluntBody>),
    /// The F-16 in DAVE-ML.
    F16 {
        /// Folder with `F16_aero.dml`, `F16_prop.dml`, `F16_inertia.dml`, `F16_control.dml` and `F16_gnc.dml`.
        folder: PathBuf,
        /// What it does.
        manoeuvre: Manoeuvre,
    },
}

/// What the pilot or the autopilot of the F-16 does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Manoeuvre {
    /// The controls stay as trimmed, without stability augmentation.
    Free,
    /// The autopilot holds altitude, equivalent airspeed and course of the start, and at a time one of them changes.
    Command {
        /// When, s.
        time: f64,
        /// Change of the altitude, m.
        altitude: f64,
        /// Change of the equivalent airspeed, m/s.
        equivalent_airspeed: f64,
        /// Change of the course, rad, positive clockwise.
        course: f64,
        /// Sidestep of the line that is to be followed, m, positive to the right of the course; none if no line is
        /// followed.
        sidestep: Option<f64>,
    },
    /// The autopilot flies a circle of three nautical miles.
    Circle {
        /// About the north pole; if false, about the crossing of the equator and the date line.
        pole: bool,
    },
}

/// Looks things up in the definition of one case and says what is missing.
struct Reader<'a> {
    id: &'a str,
    root: &'a Value,
}

impl Reader<'_> {
    fn fault(&self, what: impl Into<String>) -> CheckCaseError {
        CheckCaseError::Definition { id: self.id.to_owned(), what: what.into() }
    }

    fn number(&self, at: &Value, key: &str) -> Result<f64, CheckCaseError> {
        let value = at[key].as_f64().or_else(|| at[key].as_str().and_then(fraction));
        value.filter(|x| x.is_finite()).ok_or_else(|| self.fault(format!("{key} is no number")))
    }

    fn text<'v>(&self, at: &'v Value, key: &str) -> Result<&'v str, CheckCaseError> {
        at[key].as_str().ok_or_else(|| self.fault(format!("{key} is missing")))
    }

    fn vector(&self, at: &Value, key: &str) -> Result<Option<[f64; 3]>, CheckCaseError> {
        let Some(values) = at[key].as_array() else { return Ok(None) };
        let numbers: Vec<f64> = values.iter().filter_map(Value::as_f64).collect();
        let vector = numbers.try_into().map_err(|_| self.fault(format!("{key} is not three numbers")))?;
        Ok(Some(vector))
    }

    fn planet(&self, case: &Value) -> Result<Planet, CheckCaseError> {
        let wgs = &self.root["earth"]["WGS84"];
        let (earth, gravity) = (self.text(case, "earth")?, self.text(case, "gravity")?);
        let rotation_rate = if earth.contains("rotating") {
            self.number(wgs, "rotation_rate_rad_s")?
        } else if earth.contains("fixed") {
            0.0
        } else {
            return Err(self.fault(format!("earth `{earth}`: rotating or fixed?")));
        };
        let (equatorial_radius, flattening) = if earth.starts_with("WGS84") {
            (self.number(wgs, "semi_major_axis_m")?, self.number(wgs, "flattening")?)
        } else if earth.starts_with("round") {
            (self.number(&self.root["earth"]["round"], "radius_ft")? * FOOT, 0.0)
        } else {
            return Err(self.fault(format!("earth `{earth}` is not known")));
        };
        let j2 = match gravity {
            "J2" => self.number(wgs, "J2")?,
            "1/r^2" => 0.0,
            other => return Err(self.fault(format!("gravity `{other}` is not known"))),
        };
        let gravitational_parameter = self.number(wgs, "GM_m3_s2")?;
        Ok(Planet::Ellipsoid(Ellipsoid { equatorial_radius, flattening, gravitational_parameter, j2, rotation_rate }))
    }

    fn wind(&self, case: &Value) -> Result<Wind, CheckCaseError> {
        let text = self.text(case, "wind")?;
        if text == "still air" {
            return Ok(Wind::default());
        }
        let directions = [("north", [1.0, 0.0]), ("east", [0.0, 1.0]), ("south", [-1.0, 0.0]), ("west", [0.0, -1.0])];
        let towards = directions.iter().find(|(name, _)| text.contains(&format!("towards {name}")));
        let speeds = numbers_before(text, "ft/s");
        let heights = numbers_before(text, "ft");
        let (Some((_, [north, east])), Some(first)) = (towards, speeds.first()) else {
            return Err(self.fault(format!("wind `{text}` is not understood")));
        };
        let along = |speed: f64| [north * speed, east * speed, 0.0];
        match (&speeds[..], &heights[..]) {
            ([_], []) => Ok(Wind { at_zero: along(first * FOOT), gradient: [0.0; 3] }),
            ([high, low], [top, bottom]) if top != bottom => {
                let gradient = (high - low) / (top - bottom);
                Ok(Wind { at_zero: along((low - gradient * bottom) * FOOT), gradient: along(gradient) })
            }
            _ => Err(self.fault(format!("wind `{text}` is not understood"))),
        }
    }

    fn body(&self, description: &str) -> Result<BluntBody, CheckCaseError> {
        let name = description.split([' ', ',']).next().unwrap_or_default();
        let v = &self.root["vehicles"][name];
        if !v.is_object() {
            return Err(self.fault(format!("there is no vehicle `{name}`")));
        }
        let unit = SLUG * FOOT * FOOT;
        let inertia = if v["Ixx_Iyy_Izz_slug_ft2"].is_number() {
            [self.number(v, "Ixx_Iyy_Izz_slug_ft2")?; 3]
        } else {
            [self.number(v, "Ixx_slug_ft2")?, self.number(v, "Iyy_slug_ft2")?, self.number(v, "Izz_slug_ft2")?]
        };
        let tensor = std::array::from_fn(|r| std::array::from_fn(|c| if r == c { inertia[r] * unit } else { 0.0 }));
        let mass = MassProperties::from_tensor(self.number(v, "mass_slug")? * SLUG, tensor, 0.0)
            .ok_or_else(|| self.fault("mass or inertia are impossible"))?;
        let length = |key: &str| if v[key].is_null() { Ok(1.0) } else { self.number(v, key) };
        let mut body = BluntBody {
            mass,
            area: self.number(v, "reference_area_ft2")? * FOOT * FOOT,
            span: length("span_ft")? * FOOT,
            chord: length("chord_ft")? * FOOT,
            drag: if v["CD"].is_null() { 0.0 } else { self.number(v, "CD")? },
            damping: [0.0; 3],
        };
        let rest = description[name.len()..].trim_start_matches([',', ' ']);
        match rest {
            "" => (),
            "no aerodynamics" | "with CD = 0" => body.drag = 0.0,
            _ => {
                let value = rest.strip_prefix("Cl_p = Cm_q = Cn_r = ").and_then(fraction);
                body.damping =
                    [value.ok_or_else(|| self.fault(format!("vehicle `{description}` is not understood")))?; 3];
            }
        }
        Ok(body)
    }

    fn launch(&self, initial: &Value) -> Result<Launch, CheckCaseError> {
        let velocity = match self.vector(initial, "vn_ve_vd_ft_s")? {
            Some(velocity) => velocity,
            None => {
                [self.number(initial, "vn_ft_s")?, self.number(initial, "ve_ft_s")?, self.number(initial, "vd_ft_s")?]
            }
        };
        let [yaw, pitch, roll] = match self.vector(initial, "psi_theta_phi_deg")? {
            Some(angles) => angles,
            None => [self.number(initial, "psi_deg")?, 0.0, 0.0],
        };
        let rates = match self.vector(initial, "inertial_body_rates_deg_s")? {
            Some(rates) => InitialRates::Inertial(rates.map(f64::to_radians)),
            None if initial["body_rates"].as_str().is_some_and(|t| t.starts_with("0 relative to the earth")) => {
                InitialRates::Earth([0.0; 3])
            }
            None => InitialRates::Local([0.0; 3]),
        };
        Ok(Launch {
            place: Geodetic {
                latitude: self.number(initial, "latitude_deg")?.to_radians(),
                longitude: self.number(initial, "longitude_deg")?.to_radians(),
                altitude: self.number(initial, "altitude_msl_ft")? * FOOT,
            },
            velocity: velocity.map(|v| v * FOOT),
            euler: EulerAngles { yaw: yaw.to_radians(), pitch: pitch.to_radians(), roll: roll.to_radians() },
            rates,
        })
    }

    /// The manoeuvre of an F-16 as the title of the case states it.
    fn manoeuvre(&self, title: &str) -> Result<Manoeuvre, CheckCaseError> {
        if title.contains("circlePoleSW = 1") {
            return Ok(Manoeuvre::Circle { pole: true });
        }
        if title.contains("circlePoleSW = 0") {
            return Ok(Manoeuvre::Circle { pole: false });
        }
        if title.contains("stability augmentation off") {
            return Ok(Manoeuvre::Free);
        }
        let first = |unit: &str| numbers_before(title, unit).first().copied();
        let not_understood = || self.fault(format!("manoeuvre `{title}` is not understood"));
        let time = first("s").ok_or_else(not_understood)?;
        let (mut altitude, mut equivalent_airspeed, mut course, mut sidestep) = (0.0, 0.0, 0.0, None);
        if title.contains("altitude command") {
            altitude = first("ft").ok_or_else(not_understood)? * FOOT;
        } else if title.contains("airspeed command") {
            equivalent_airspeed = first("kt").ok_or_else(not_understood)? * KNOT;
        } else if title.contains("course command") {
            course = first("deg").ok_or_else(not_understood)?.to_radians();
        } else if title.contains("lateral offset to the right") {
            sidestep = Some(first("ft").ok_or_else(not_understood)? * FOOT);
        } else {
            return Err(not_understood());
        }
        Ok(Manoeuvre::Command { time, altitude, equivalent_airspeed, course, sidestep })
    }
}

impl CheckCases {
    /// Reads `cases.json`. The F-16 is looked for where the file says, relative to it.
    ///
    /// # Errors
    ///
    /// [`CheckCaseError::Read`] or [`CheckCaseError::Json`].
    pub fn read(path: &Path) -> Result<Self, CheckCaseError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| CheckCaseError::Read { path: path.to_owned(), source })?;
        let definitions: Value =
            serde_json::from_str(&text).map_err(|source| CheckCaseError::Json { path: path.to_owned(), source })?;
        let model = definitions["vehicles"]["f16"]["model"].as_str().unwrap_or_default();
        let first = Path::new(model.split(',').next().unwrap_or_default());
        let aircraft = path.parent().unwrap_or(Path::new("")).join(first.parent().unwrap_or(Path::new("")));
        Ok(Self { definitions, aircraft })
    }

    /// Numbers of all cases, in alphabetical order.
    pub fn ids(&self) -> Vec<String> {
        let mut ids: Vec<String> =
            self.definitions["cases"].as_object().map(|cases| cases.keys().cloned().collect()).unwrap_or_default();
        ids.sort();
        ids
    }

    /// The case of a number, such as `09` or `13p1`.
    ///
    /// # Errors
    ///
    /// [`CheckCaseError::Unknown`], or [`CheckCaseError::Definition`] if a part of it is missing or not understood.
    pub fn case(&self, id: &str) -> Result<CheckCase, CheckCaseError> {
        let cases = &self.definitions["cases"];
        let case = &cases[id];
        if !case.is_object() {
            return Err(CheckCaseError::Unknown { id: id.to_owned(), known: self.ids().join(", ") });
        }
        let reader = Reader { id, root: &self.definitions };
        let title = reader.text(case, "title")?.to_owned();
        let initial = match case["initial"].as_str().and_then(|text| text.strip_prefix("as ")) {
            Some(other) => &cases[other]["initial"],
            None => &case["initial"],
        };
        let vehicle = match case["vehicle"].as_str() {
            Some(description) => CheckVehicle::Blunt(Box::new(reader.body(description)?)),
            None => CheckVehicle::F16 { folder: self.aircraft.clone(), manoeuvre: reader.manoeuvre(&title)? },
        };
        let atmosphere = reader.text(case, "atmosphere")?;
        if atmosphere != "US Standard 1976" {
            return Err(reader.fault(format!("atmosphere `{atmosphere}` is not known")));
        }
        let world = World { wind: reader.wind(case)?, ..World::new(reader.planet(case)?) };
        let output_interval = reader.number(case, "nominal_step_of_the_output_s")?;
        if output_interval <= 0.0 {
            return Err(reader.fault("nominal_step_of_the_output_s is not positive"));
        }
        Ok(CheckCase {
            id: id.to_owned(),
            world,
            vehicle,
            launch: reader.launch(initial)?,
            duration: reader.number(case, "duration_s")?,
            output_interval,
            title,
        })
    }
}
