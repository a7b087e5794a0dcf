//! Profiles say which topics and fields of a log or a stream are which channels. They are data: TOML files such as
//! `profiles/px4.toml` of this crate.
//!
//! ```toml
//! name = "PX4"
//! time_base = ["vehicle_angular_velocity", "vehicle_attitude"]   # the first one that the log has gives the times
//! surfaces = "px4"                                               # how commands of surfaces are found
//!
//! [mixed]                                                        # commands made of several surfaces
//! elevator_command = [{ left_elevon_command = 0.5, right_elevon_command = 0.5 }]
//!
//! [channel.theta]
//! sources = [{ field = "vehicle_attitude.q", transform = "quaternion_theta", unit = "rad" }]
//!
//! [channel.air_density]
//! held_s = 5.0                                                   # a level: used until it is this old
//! sources = [{ field = "vehicle_air_data.rho", unit = "kg/m^3", note = "as PX4 computes it" }]
//! ```
//!
//! The comments of `profiles/px4.toml` explain every key. Units stated by the log itself come before those of the
//! profile, and mappings of the caller come before both.
//!
//! ```
//! use phugoid_flight_data::profile::Profile;
//! let text = r#"
//! name = "my logger"
//! time_base = ["imu"]
//! [channel.q]
//! sources = [{ field = "imu.gyro[1]", unit = "deg/s", scale = -1.0 }]
//! "#;
//! let profile = Profile::parse("logger.toml", text)?;
//! let q = profile.channel("q").expect("it is in the profile");
//! assert_eq!(q.sources[0].field.to_string(), "imu.gyro[1]");
//! assert!(Profile::parse("logger.toml", &text.replace("deg/s", "kg")).is_err()); // no unit of an angular rate
//! # Ok::<(), phugoid_flight_data::profile::ProfileError>(())
//! ```

use std::collections::BTreeMap;
use std::str::FromStr;

use serde::Deserialize;

use crate::airspeed;
use crate::align::Hold;
use crate::channels;
use crate::units::{self, Quantity};

/// Which fields of a kind of log are which channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Name of the profile in messages, such as `PX4`.
    pub name: String,
    /// Topics whose times become those of the record, in order of preference; the first with two samples is taken.
    pub time_base: Vec<String>,
    /// The rule by which commands of control surfaces are found; `None` if there is no such rule.
    pub surfaces: Option<SurfaceRule>,
    /// Commands that are made of the commands of several surfaces, as those of elevons.
    pub mixed: Vec<Mixture>,
    /// The channels in the order of [`channels::CHANNELS`].
    pub channels: Vec<ChannelProfile>,
}

/// Where a log states which servo moves which control surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceRule {
    /// PX4: the commands are `actuator_servos.control[i]`, and the parameters `CA_SV_CSi_TYPE` assign surfaces.
    Px4,
    /// ArduPilot: the commands are pulse widths `RCOU.Ci`, microseconds, and the parameters `SERVOi_FUNCTION`, `_MIN`,
    /// `_TRIM`, `_MAX` and `_REVERSED` assign surfaces and ranges.
    Ardupilot,
    /// The same in a telemetry log: pulse widths `SERVO_OUTPUT_RAW.servoi_raw`, microseconds.
    Telemetry,
}

/// A command that is made of the commands of several surfaces: the elevator of an aircraft with elevons.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// Name of the resulting command, such as `elevator_command`.
    pub command: String,
    /// Names of the commands that are added, each with its factor.
    pub of: Vec<(String, f64)>,
}

/// One channel and the fields that can give it.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelProfile {
    /// Canonical name of the channel.
    pub channel: String,
    /// Whether a value is used once or until it is stale.
    pub hold: Hold,
    /// The fields that can give it, in order of preference.
    pub sources: Vec<Source>,
}

/// A field that gives a channel, and what is computed of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The field. For a transform of four fields it is their common name (`q` for `q[0]` to `q[3]`), or the first and
    /// the last of them (`q1..q4`).
    pub field: FieldName,
    /// The unit, used where the log does not state one; `None` for a pure number.
    pub unit: Option<String>,
    /// Factor by which values are multiplied before the unit is converted; -1 reverses the sign.
    pub scale: f64,
    /// What is computed of the field or fields.
    pub transform: Transform,
    /// A slower field by which the result is multiplied.
    pub factor: Option<Factor>,
    /// What the user has to know about this source; it goes into the quality report.
    pub note: Option<String>,
}

/// The name of a field in a log, written `topic.field` or `topic#instance.field`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FieldName {
    /// Name of the topic in the log.
    pub topic: String,
    /// Number of the instance; the lowest one that the log has if not given.
    pub instance: Option<u16>,
    /// Name of the field within the topic; it may contain dots.
    pub field: String,
}

/// What is computed of the numbers of a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Transform {
    /// The value of the field is taken as it is.
    #[default]
    None,
    /// Bank angle of `field[0]` to `field[3]`, a quaternion from north-east-down to body axes, scalar first; rad.
    QuaternionPhi,
    /// Pitch attitude of the same quaternion, rad.
    QuaternionTheta,
    /// Heading of the same quaternion, rad, zero at north.
    QuaternionPsi,
}

/// A slower field by which a channel is multiplied; its last value before each sample is used.
#[derive(Clone, Debug, PartialEq)]
pub enum Factor {
    /// The value of the field is the factor.
    Times(FieldName),
    /// The field is the density of the air, kg/m^3, and the factor is the root of 1.225 kg/m^3 over it, which makes
    /// true airspeed of equivalent airspeed (see [`crate::airspeed`]).
    Density(FieldName),
}

/// Longest name of a `NAMED_VALUE_FLOAT`, bytes.
const NAME_IN_MAVLINK: usize = 10;

impl Profile {
    /// The built-in profile of PX4 logs (ULog), fixed wing.
    ///
    /// # Errors
    /// Never in a released build: the profile is part of the library, and a test reads it.
    pub fn px4() -> Result<Self, ProfileError> {
        Self::parse("px4.toml", include_str!("../profiles/px4.toml"))
    }

    /// The built-in profile of ArduPilot DataFlash logs, fixed wing.
    ///
    /// # Errors
    /// As [`Profile::px4`].
    pub fn ardupilot() -> Result<Self, ProfileError> {
        Self::parse("ardupilot.toml", include_str!("../profiles/ardupilot.toml"))
    }

    /// The built-in profile of MAVLink streams, fixed wing: a topic is a message, and units are those of the protocol.
    ///
    /// # Errors
    /// As [`Profile::px4`].
    pub fn mavlink() -> Result<Self, ProfileError> {
        Self::parse("mavlink.toml", include_str!("../profiles/mavlink.toml"))
    }

    /// The built-in profile of telemetry logs (`.tlog`): that of MAVLink streams, values under the names of channels
    /// (`NAMED_VALUE_FLOAT`, in SI) before it as there, and commands of surfaces from the pulse widths of the servos.
    ///
    /// # Errors
    /// As [`Profile::px4`].
    pub fn telemetry_log() -> Result<Self, ProfileError> {
        let mut profile = Self::mavlink()?;
        profile.surfaces = Some(SurfaceRule::Telemetry);
        profile.mixed = Self::ardupilot()?.mixed;
        for spec in channels::CHANNELS.iter().filter(|spec| spec.name != "time") {
            // A name that means several channels gives the likeliest one.
            let names = std::iter::once(&spec.name).chain(spec.synonyms);
            let own =
                names.filter(|name| channels::by_any_name(name).first().is_some_and(|first| first.name == spec.name));
            let named = own.filter(|name| name.len() <= NAME_IN_MAVLINK).map(|name| Source {
                field: FieldName { topic: "NAMED_VALUE_FLOAT".into(), instance: None, field: (*name).to_owned() },
                unit: Some(spec.quantity.si_unit().to_owned()).filter(|unit| !unit.is_empty()),
                scale: 1.0,
                transform: Transform::None,
                factor: None,
                note: None,
            });
            let named: Vec<Source> = named.collect();
            match profile.channels.iter_mut().find(|entry| entry.channel == spec.name) {
                Some(entry) => entry.sources.splice(..0, named).for_each(drop),
                None if named.is_empty() => {}
                None => profile.channels.push(ChannelProfile {
                    channel: spec.name.to_owned(),
                    hold: Hold::Sampled,
                    sources: named,
                }),
            }
        }
        profile.channels.sort_by_key(|entry| channels::CHANNELS.iter().position(|spec| spec.name == entry.channel));
        Ok(profile)
    }

    /// Reads a profile from the text of a TOML file. `name` is the name of the file in messages.
    ///
    /// # Errors
    /// [`ProfileError`] if the text is no valid profile, or names an unknown channel or a unit that does not suit its
    /// channel.
    pub fn parse(name: &str, text: &str) -> Result<Self, ProfileError> {
        let wrong = |problem| ProfileError { file: name.to_owned(), problem };
        let file: File = toml::from_str(text).map_err(|error| wrong(ProfileProblem::Toml(error.to_string())))?;
        let mut channels = Vec::with_capacity(file.channel.len());
        for (channel, entry) in file.channel {
            let Some(spec) = channels::by_name(&channel) else {
                let nearest = channels::nearest(&channel);
                return Err(wrong(ProfileProblem::UnknownChannel { channel, nearest }));
            };
            let hold = match entry.held_s {
                None => Hold::Sampled,
                Some(stale_after_s) if stale_after_s > 0.0 => Hold::Held { stale_after_s },
                Some(held_s) => return Err(wrong(ProfileProblem::HeldTime { channel, held_s })),
            };
            let mut sources = Vec::with_capacity(entry.sources.len());
            for source in entry.sources {
                let unit = source.unit.as_deref();
                if let Some(unit) = unit.filter(|unit| units::find_for(unit, spec.quantity).is_none()) {
                    let (unit, quantity) = (unit.to_owned(), spec.quantity);
                    return Err(wrong(ProfileProblem::Unit { channel, unit, quantity }));
                }
                sources.push(source.resolve(&channel).map_err(wrong)?);
            }
            channels.push(ChannelProfile { channel, hold, sources });
        }
        let mut mixed = Vec::new();
        for (command, mixtures) in file.mixed {
            for of in mixtures {
                let mixture = Mixture { command: command.clone(), of: of.into_iter().collect() };
                mixture.check().map_err(wrong)?;
                mixed.push(mixture);
            }
        }
        channels.sort_by_key(|entry| channels::CHANNELS.iter().position(|spec| spec.name == entry.channel));
        Ok(Self { name: file.name, time_base: file.time_base, surfaces: file.surfaces, mixed, channels })
    }

    /// The entry of the channel with this canonical name, or `None`.
    pub fn channel(&self, name: &str) -> Option<&ChannelProfile> {
        self.channels.iter().find(|entry| entry.channel == name)
    }

    /// All fields that the profile can use, those of transforms one by one; a field may come several times.
    pub fn fields(&self) -> impl Iterator<Item = FieldName> {
        self.channels.iter().flat_map(|entry| &entry.sources).flat_map(Source::inputs)
    }
}

impl Mixture {
    fn check(&self) -> Result<(), ProfileProblem> {
        let command = || self.command.clone();
        let names = || std::iter::once(&self.command).chain(self.of.iter().map(|(name, _)| name));
        if let Some(name) = names().find(|name| !name.ends_with("_command")) {
            return Err(ProfileProblem::NotACommand { command: command(), name: name.clone() });
        }
        match self.of.iter().all(|(_, factor)| factor.is_finite() && *factor != 0.0) && !self.of.is_empty() {
            true => Ok(()),
            false => Err(ProfileProblem::MixedFactor { command: command() }),
        }
    }
}

impl Source {
    /// The fields whose numbers [`Source::value`] takes, in this order: those of the transform, which are all of one
    /// topic, and then that of the factor.
    pub fn inputs(&self) -> Vec<FieldName> {
        let mut inputs = match self.transform {
            Transform::None => vec![self.field.clone()],
            _ => {
                let named = numbered(&self.field.field)
                    .unwrap_or_else(|| (0..4).map(|i| format!("{}[{i}]", self.field.field)).collect());
                named.into_iter().map(|field| FieldName { field, ..self.field.clone() }).collect()
            }
        };
        if let Some(Factor::Times(field) | Factor::Density(field)) = &self.factor {
            inputs.push(field.clone());
        }
        inputs
    }

    /// The value of the channel from the numbers of the fields [`Source::inputs`], in the unit of the source, before
    /// `scale`. NaN if a number is missing or NaN, and for a quaternion whose norm is not 1.
    pub fn value(&self, inputs: &[f64]) -> f64 {
        let (value, rest) = match self.transform {
            Transform::None => (inputs.first().copied(), inputs.get(1..)),
            transform => (inputs.first_chunk().map(|q| euler(transform, q)), inputs.get(4..)),
        };
        let factor = rest.and_then(|rest| rest.first()).copied();
        let factor = match &self.factor {
            None => Some(1.0),
            Some(Factor::Times(_)) => factor,
            Some(Factor::Density(_)) => factor.map(airspeed::true_over_equivalent),
        };
        value.zip(factor).map_or(f64::NAN, |(value, factor)| value * factor)
    }
}

/// The four names that `q1..q4` stands for: `q1`, `q2`, `q3`, `q4`. `None` if it is no such range.
fn numbered(field: &str) -> Option<Vec<String>> {
    let (first, last) = field.split_once("..")?;
    let name = first.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = |text: &str| text.strip_prefix(name)?.parse::<u32>().ok();
    let (first, last) = (number(first)?, number(last)?);
    (last.checked_sub(first)? == 3).then(|| (first..=last).map(|i| format!("{name}{i}")).collect())
}

/// Euler angles (3-2-1: heading, pitch, bank) of a quaternion, scalar first (Stevens and Lewis, Aircraft Control and
/// Simulation, section 1.8). NaN if the norm is not 1: PX4 writes zeros before its estimator runs.
fn euler(transform: Transform, [w, x, y, z]: &[f64; 4]) -> f64 {
    let norm = w * w + x * x + y * y + z * z;
    // The norm of a unit quaternion in single precision differs from 1 by about 1e-7.
    if !(0.98..1.02).contains(&norm) {
        return f64::NAN;
    }
    match transform {
        Transform::QuaternionPhi => (2.0 * (w * x + y * z)).atan2(w * w - x * x - y * y + z * z),
        Transform::QuaternionTheta => (2.0 * (w * y - z * x) / norm).clamp(-1.0, 1.0).asin(),
        Transform::QuaternionPsi => (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z),
        Transform::None => f64::NAN,
    }
}

impl FromStr for FieldName {
    type Err = FieldNameError;

    fn from_str(text: &str) -> Result<Self, FieldNameError> {
        let wrong = || FieldNameError { text: text.to_owned() };
        let (topic, field) = text.trim().split_once('.').ok_or_else(wrong)?;
        let (topic, instance) = match topic.split_once('#') {
            Some((topic, instance)) => (topic, Some(instance.parse().map_err(|_| wrong())?)),
            None => (topic, None),
        };
        if topic.is_empty() || field.is_empty() {
            return Err(wrong());
        }
        Ok(Self { topic: topic.to_owned(), instance, field: field.to_owned() })
    }
}

impl std::fmt::Display for FieldName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.instance {
            Some(instance) => write!(f, "{}#{instance}.{}", self.topic, self.field),
            None => write!(f, "{}.{}", self.topic, self.field),
        }
    }
}

/// Why a profile cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("profile {file}: {problem}")]
pub struct ProfileError {
    /// Name of the file, as given to [`Profile::parse`].
    pub file: String,
    /// What is wrong in it.
    pub problem: ProfileProblem,
}

/// What is wrong in a profile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileProblem {
    /// The text is no TOML, or has unknown, missing or wrong keys; the message of the TOML reader names the line.
    #[error("{0}")]
    Toml(String),
    /// A name under `channel` is no known channel.
    #[error("'{channel}' is no channel{}", nearest.map(|near| format!("; did you mean '{near}'?")).unwrap_or_default())]
    UnknownChannel {
        /// The name as it is written in the profile.
        channel: String,
        /// The known channel with a similar name.
        nearest: Option<&'static str>,
    },
    /// The time for which a value is held is not positive.
    #[error("channel.{channel}: held_s = {held_s}; it must be positive")]
    HeldTime {
        /// Canonical name of the channel.
        channel: String,
        /// The time that was given, s.
        held_s: f64,
    },
    /// A unit is not known, or is one of another quantity than that of the channel.
    #[error("channel.{channel}: unit '{unit}' is not one of {}", units::accepted(*quantity))]
    Unit {
        /// Canonical name of the channel.
        channel: String,
        /// The unit as it is written in the profile.
        unit: String,
        /// The quantity of the channel.
        quantity: Quantity,
    },
    /// A factor is 0, infinite or NaN.
    #[error("channel.{channel}: scale = {scale} makes no sense; write 1, -1 or another factor")]
    Scale {
        /// Canonical name of the channel.
        channel: String,
        /// The factor that was given.
        scale: f64,
    },
    /// A source has both `times` and `density`.
    #[error("channel.{channel}: 'times' and 'density' together; keep one")]
    TwoFactors {
        /// Canonical name of the channel.
        channel: String,
    },
    /// The name of a field is not valid.
    #[error("channel.{channel}: {error}")]
    Field {
        /// Canonical name of the channel.
        channel: String,
        /// What is wrong with the name.
        error: FieldNameError,
    },
    /// A name under `mixed` does not end in `_command`.
    #[error("mixed.{command}: '{name}' is no command of a surface; write for instance left_elevon_command")]
    NotACommand {
        /// Name of the resulting command.
        command: String,
        /// The name as it is written in the profile.
        name: String,
    },
    /// A mixture has no parts, or a factor that is 0, infinite or NaN.
    #[error("mixed.{command}: a factor, not zero, for each of its surfaces is expected")]
    MixedFactor {
        /// Name of the resulting command.
        command: String,
    },
}

/// A text is no [`FieldName`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{text}' is no field of a topic; write topic.field or topic#instance.field")]
pub struct FieldNameError {
    /// The text that was to be a name.
    pub text: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    time_base: Vec<String>,
    surfaces: Option<SurfaceRule>,
    #[serde(default)]
    mixed: BTreeMap<String, Vec<BTreeMap<String, f64>>>,
    channel: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    held_s: Option<f64>,
    sources: Vec<SourceEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceEntry {
    field: String,
    unit: Option<String>,
    #[serde(default = "one")]
    scale: f64,
    #[serde(default)]
    transform: Transform,
    times: Option<String>,
    density: Option<String>,
    note: Option<String>,
}

fn one() -> f64 {
    1.0
}

impl SourceEntry {
    fn resolve(self, channel: &str) -> Result<Source, ProfileProblem> {
        let channel = || channel.to_owned();
        let name = |text: &str| text.parse().map_err(|error| ProfileProblem::Field { channel: channel(), error });
        if !self.scale.is_finite() || self.scale == 0.0 {
            return Err(ProfileProblem::Scale { channel: channel(), scale: self.scale });
        }
        let factor = match (self.times, self.density) {
            (None, None) => None,
            (Some(field), None) => Some(Factor::Times(name(&field)?)),
            (None, Some(field)) => Some(Factor::Density(name(&field)?)),
            (Some(_), Some(_)) => return Err(ProfileProblem::TwoFactors { channel: channel() }),
        };
        Ok(Source {
            field: name(&self.field)?,
            unit: self.unit,
            scale: self.scale,
            transform: self.transform,
            factor,
            note: self.note,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_profiles_are_right() {
        for profile in [Profile::px4(), Profile::ardupilot(), Profile::mavlink()] {
            let profile = profile.unwrap();
            assert!(!profile.time_base.is_empty() && profile.channel("q").is_some(), "{}", profile.name);
        }
        let px4 = Profile::px4().unwrap();
        assert_eq!(px4.channel("theta").unwrap().sources[0].inputs()[3].to_string(), "vehicle_attitude.q[3]");
        let mavlink = Profile::mavlink().unwrap();
        assert_eq!(mavlink.channel("theta").unwrap().sources[1].inputs()[3].to_string(), "ATTITUDE_QUATERNION.q4");
    }

    #[test]
    fn euler_angles_of_quaternions() {
        let (phi, theta, psi) = (0.3_f64, -0.2_f64, 2.5_f64);
        let half = |angle: f64| (0.5 * angle).sin_cos();
        let ((sf, cf), (st, ct), (sp, cp)) = (half(phi), half(theta), half(psi));
        // Stevens and Lewis (1.8-18).
        let q = [
            cf * ct * cp + sf * st * sp,
            sf * ct * cp - cf * st * sp,
            cf * st * cp + sf * ct * sp,
            cf * ct * sp - sf * st * cp,
        ];
        for (transform, angle) in
            [(Transform::QuaternionPhi, phi), (Transform::QuaternionTheta, theta), (Transform::QuaternionPsi, psi)]
        {
            assert!((euler(transform, &q) - angle).abs() < 1e-14, "{transform:?}");
        }
        assert!(euler(Transform::QuaternionTheta, &[0.0; 4]).is_nan());
    }

    #[test]
    fn wrong_profiles_are_answered_with_the_place() {
        let head = "name = \"x\"\ntime_base = []\n";
        let wrong = |text: &str| Profile::parse("my.toml", &format!("{head}{text}")).unwrap_err().to_string();
        let message = wrong("[channel.aplha]\nsources = []\n");
        assert!(message.contains("my.toml: 'aplha' is no channel; did you mean 'alpha'?"), "{message}");
        assert!(
            wrong("[channel.alpha]\nsources = [{ field = \"a.b\", unit = \"kg\" }]\n").contains("not one of rad, deg")
        );
        assert!(wrong("[channel.alpha]\nsources = [{ field = \"ab\" }]\n").contains("write topic.field"));
        let mixed = |text: &str| wrong(&format!("[mixed]\n{text}\n[channel.alpha]\nsources = []\n"));
        assert!(mixed("e_command = [{ a_command = 0 }]").contains("mixed.e_command: a factor"));
        assert!(mixed("e_command = [{ elevon = 1 }]").contains("'elevon' is no command of a surface"));
        assert!(wrong("[channel.alpha]\nsources = [{ field = \"a.b\", skale = 2 }]\n").contains("line 4"), "line");
    }

    #[test]
    fn a_factor_multiplies() {
        let source = |factor| Source {
            field: "a.b".parse().unwrap(),
            unit: None,
            scale: 1.0,
            transform: Transform::None,
            factor: Some(factor),
            note: None,
        };
        let field: FieldName = "c#1.d.e".parse().unwrap();
        assert_eq!((field.instance, field.field.as_str()), (Some(1), "d.e"));
        assert_eq!(source(Factor::Times(field.clone())).value(&[20.0, 1.5]), 30.0);
        assert!((source(Factor::Density(field.clone())).value(&[20.0, 1.225 / 4.0]) - 40.0).abs() < 1e-12);
        assert!(source(Factor::Density(field)).value(&[20.0, f64::NAN]).is_nan());
    }
}
