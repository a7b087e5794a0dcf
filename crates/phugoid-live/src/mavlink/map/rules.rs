//! Which field is which channel: by the model file, by the name of a value, and by the profile `crates/phugoid-flight-data/profiles/mavlink.toml`.

use std::collections::BTreeMap;

use phugoid_flight_data::channels;
use phugoid_flight_data::csv::ColumnMapping;
pub(super) use phugoid_flight_data::mavlink::time_field;
use phugoid_flight_data::profile::{FieldName, Profile, Source};
use phugoid_flight_data::record::Quantity;
use phugoid_flight_data::units;

use super::conversion::{Conversion, of_mapping};
use crate::airspeed;
use crate::mavlink::definitions::{self, Field, Message, NAMED_VALUE_FLOAT};

/// If the best source of a channel has been silent for this long, s, the next one takes over.
const TAKE_OVER_S: f64 = 1.0;
/// Names of `NAMED_VALUE_FLOAT` that are kept; a sender has some dozens.
const MOST_NAMES: usize = 1024;
/// Ranks of the sources of a channel, the best first: a mapping of the model file, ...
const BY_MAPPING: usize = 0;
/// ... a value under the name of the channel, ...
const BY_NAME: usize = 1;
/// ... and the sources of the profile in their order, from here on.
const BY_PROFILE: usize = 2;

/// A value of a channel, SI.
pub(super) struct Reading {
    pub(super) channel: usize,
    pub(super) value: f64,
}

/// What is read from which message.
pub(super) struct Rules {
    by_message: BTreeMap<u32, Vec<Rule>>,
    /// Channel of each name of `NAMED_VALUE_FLOAT`: those of the model file, and those that have come, because the
    /// search takes time.
    named: BTreeMap<String, Option<(usize, Conversion)>>,
    channels: Vec<String>,
    /// How many of the channels are in the samples.
    asked: usize,
    /// Warnings for people about the mappings.
    pub(super) warnings: Vec<String>,
    /// For each channel the rank of its present source, and the stamp of its last value, s.
    given_by: Vec<(usize, f64)>,
}

/// A source of a channel.
#[derive(Clone, Debug)]
struct Rule {
    what: What,
    channel: usize,
    /// The source with the lowest rank gives the channel.
    rank: usize,
    conversion: Conversion,
}

/// How the raw value is obtained from a message.
#[derive(Clone, Debug)]
enum What {
    /// An element of a field.
    Element(Field, usize),
    /// Computed from four fields, as a source of the profile says, such as an angle from a quaternion.
    Computed([Field; 4], Box<Source>),
}

impl Rules {
    /// The rules for these channels, of which the first `asked` are in the samples.
    ///
    /// # Errors
    /// A sentence for people: a mapping to a field that its message does not have, a unit that does not suit the
    /// channel, or a profile with a field that MAVLink does not have.
    pub(super) fn new(
        channels: &[String],
        asked: usize,
        columns: &[ColumnMapping],
        profile: &Profile,
    ) -> Result<Self, String> {
        let mut rules = Self {
            by_message: BTreeMap::new(),
            named: BTreeMap::new(),
            channels: channels.to_vec(),
            asked,
            warnings: columns.iter().filter_map(|mapping| warning(mapping, profile)).collect(),
            given_by: vec![(usize::MAX, f64::NEG_INFINITY); channels.len()],
        };
        for mapping in columns {
            rules.map(mapping)?;
        }
        for (channel, name) in channels.iter().enumerate() {
            let sources = profile.channel(name).into_iter().flat_map(|entry| &entry.sources);
            for (rank, source) in sources.enumerate() {
                let wrong = |problem: String| format!("profile {}, {name}, {}: {problem}", profile.name, source.field);
                let (message, what, conversion) = of_source(source).map_err(wrong)?;
                let rule = Rule { what, channel, rank: BY_PROFILE + rank, conversion };
                rules.by_message.entry(message.id).or_default().push(rule);
            }
        }
        Ok(rules)
    }

    /// Adds a mapping of the model file, if its channel is wanted and it names a message.
    fn map(&mut self, mapping: &ColumnMapping) -> Result<(), String> {
        let of_mavlink = |(header, _): (&str, f64)| {
            header.trim().split_once('.').is_some_and(|(message, _)| definitions::by_name(message).is_some())
        };
        if !mapping.plus.is_empty() && mapping.terms().any(of_mavlink) {
            return Err(format!(
                "[channels] {}: a sum of several fields is not taken from MAVLink, whose messages come one by one. Send the surface \
                 itself (NAMED_VALUE_FLOAT), or as CSV or JSON lines",
                mapping.channel
            ));
        }
        let Some((message, field)) = mapping.header.trim().split_once('.') else { return Ok(()) };
        let channel = self.channels.iter().position(|channel| *channel == mapping.channel);
        let (Some(message), Some(channel)) = (definitions::by_name(message), channel) else { return Ok(()) };
        if message.id == NAMED_VALUE_FLOAT {
            let conversion = of_mapping(mapping, "")?;
            self.named.insert(field.to_owned(), Some((channel, conversion)));
            return Ok(());
        }
        let Some((found, element)) = element_of(message, field) else {
            let fields: Vec<String> = message.fields.iter().map(written).collect();
            return Err(format!(
                "[channels] {}: the MAVLink message {} has no field `{field}`. It has {}",
                mapping.channel,
                message.name,
                fields.join(", ")
            ));
        };
        let conversion = of_mapping(mapping, found.unit)?;
        let rule = Rule { what: What::Element(found.clone(), element), channel, rank: BY_MAPPING, conversion };
        self.by_message.entry(message.id).or_default().push(rule);
        Ok(())
    }

    /// Hands the values of a message to `out`, SI.
    pub(super) fn read(&mut self, message: &Message, payload: &[u8], stamp_s: f64, out: &mut dyn FnMut(Reading)) {
        if message.id == NAMED_VALUE_FLOAT {
            return self.read_named(message, payload, stamp_s, out);
        }
        let Some(rules) = self.by_message.get(&message.id) else { return };
        for rule in rules {
            let Some(given_by) = self.given_by.get_mut(rule.channel) else { continue };
            if !gives(given_by, rule.rank, stamp_s) {
                continue;
            }
            let raw = match &rule.what {
                What::Element(field, element) => field.value(payload, *element),
                What::Computed(fields, source) => {
                    let inputs = fields.each_ref().map(|field| field.value(payload, 0).unwrap_or(f64::NAN));
                    Some(source.value(&inputs))
                }
            };
            let Some(raw) = raw else { continue };
            out(Reading { channel: rule.channel, value: rule.conversion.si(raw) });
        }
    }

    /// The channel that a name or a synonym means. A channel of the samples wins; for the others only the likeliest
    /// meaning counts, so that `p`, the roll rate, is not taken for a pressure where no roll rate is asked for.
    fn by_name(&self, name: &str) -> Option<usize> {
        let position = |name: &str| self.channels.iter().position(|channel| channel == name);
        let known = channels::by_any_name(name);
        let in_samples = known.iter().filter_map(|spec| position(spec.name)).find(|place| *place < self.asked);
        position(name).or(in_samples).or_else(|| known.first().and_then(|spec| position(spec.name)))
    }

    /// Reads a `NAMED_VALUE_FLOAT`: under the name of a channel in SI (`elevator` in rad), or under a name of the model
    /// file in its unit.
    fn read_named(&mut self, message: &Message, payload: &[u8], stamp_s: f64, out: &mut dyn FnMut(Reading)) {
        let name = message.field("name").and_then(|field| field.text(payload));
        let value = message.field("value").and_then(|field| field.value(payload, 0));
        let (Some(name), Some(value)) = (name, value) else { return };
        let known = match self.named.get(&name) {
            Some(known) => *known,
            None => {
                let known = self.by_name(&name).map(|channel| (channel, Conversion::NONE));
                if self.named.len() < MOST_NAMES {
                    self.named.insert(name, known);
                }
                known
            }
        };
        let Some((channel, conversion)) = known else { return };
        let Some(given_by) = self.given_by.get_mut(channel) else { return };
        if gives(given_by, BY_NAME, stamp_s) {
            out(Reading { channel, value: conversion.si(value) });
        }
    }
}

/// A warning if a mapping takes another airspeed for the true one. That is allowed, but the estimates have an error
/// then.
fn warning(mapping: &ColumnMapping, profile: &Profile) -> Option<String> {
    let header = mapping.header.trim();
    let speeds = ["equivalent_airspeed", "calibrated_airspeed", "indicated_airspeed"];
    let mut others = speeds.iter().filter_map(|name| profile.channel(name)).flat_map(|entry| &entry.sources);
    let is_other = mapping.channel == "true_airspeed" && others.any(|source| source.field.to_string() == header);
    is_other.then(|| {
        format!(
            "[channels] takes {header} for the true airspeed V, which it is not: {}",
            airspeed::ERROR_WITHOUT_DENSITY
        )
    })
}

/// The message of a source of the profile, what is read from it, and how it is converted to SI. The unit of the
/// definition wins over that of the profile.
fn of_source(source: &Source) -> Result<(&'static Message, What, Conversion), String> {
    let missing = |name: &FieldName| format!("MAVLink has no {name}");
    let found = |name: &FieldName| {
        let message = definitions::by_name(&name.topic).filter(|_| name.instance.is_none())?;
        element_of(message, &name.field).map(|(field, element)| (message, field, element))
    };
    let fields: Result<Vec<_>, String> =
        source.inputs().iter().map(|name| found(name).ok_or_else(|| missing(name))).collect();
    let fields = fields?;
    let (message, what, unit) = match fields.as_slice() {
        [(message, field, element)] => (*message, What::Element((*field).clone(), *element), Some(field.unit)),
        [(message, a, _), (_, b, _), (_, c, _), (_, d, _)] if source.factor.is_none() => {
            (*message, What::Computed([*a, *b, *c, *d].map(Field::clone), Box::new(source.clone())), None)
        }
        _ => return Err("a stream of messages has no factors: leave out `times` and `density`".to_owned()),
    };
    let unit = unit.filter(|unit| !unit.is_empty()).or(source.unit.as_deref()).unwrap_or_default();
    let conversion =
        Conversion::of_unit(unit, source.scale).ok_or_else(|| format!("the unit `{unit}` is not understood"))?;
    Ok((message, what, conversion))
}

/// Whether a source of this rank gives the channel now. It does if no better one has given a value within the last
/// second.
fn gives(given_by: &mut (usize, f64), rank: usize, stamp_s: f64) -> bool {
    let (best, last_s) = *given_by;
    let silent = (stamp_s - last_s).abs() > TAKE_OVER_S;
    if rank <= best || silent {
        *given_by = (rank, stamp_s);
        return true;
    }
    false
}

/// The field and element that a name means: `pitch`, `actuator[3]`.
fn element_of<'a>(message: &'a Message, name: &str) -> Option<(&'a Field, usize)> {
    let parts = name.strip_suffix(']').and_then(|inner| inner.rsplit_once('['));
    let (name, element) = parts.and_then(|(name, index)| Some((name, index.parse().ok()?))).unwrap_or((name, 0));
    message.field(name).filter(|found| element < found.count.max(1)).map(|found| (found, element))
}

/// A field as it is to be written in a mapping.
fn written(field: &Field) -> String {
    if field.count == 0 { field.name.to_owned() } else { format!("{}[0..{}]", field.name, field.count) }
}

/// The time at which a message was sampled by the sender's clock, s; `None` if the message has no time.
pub(super) fn stamp_s(message: &Message, payload: &[u8]) -> Option<f64> {
    let field = time_field(message)?;
    let unit = units::find_for(field.unit, Quantity::Time)?;
    // A division gives the same number of seconds for 100010 ms and 100010000 us; a multiplication does not.
    Some(field.value(payload, 0)? / (1.0 / unit.scale).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile() -> Profile {
        Profile::mavlink().unwrap()
    }

    #[test]
    fn every_source_of_the_profile_exists_in_its_unit() {
        let profile = profile();
        let channels: Vec<String> = profile.channels.iter().map(|entry| entry.channel.clone()).collect();
        Rules::new(&channels, channels.len(), &[], &profile).unwrap();
        for entry in &profile.channels {
            let quantity = channels::by_name(&entry.channel).unwrap().quantity;
            for source in &entry.sources {
                let unit = match of_source(source).unwrap().1 {
                    What::Element(field, _) => field.unit,
                    What::Computed(..) => source.unit.as_deref().unwrap(),
                };
                // Units that MAVLink alone writes are not in the common table.
                let suits = units::find(unit).is_empty() || units::find_for(unit, quantity).is_some();
                assert!(suits, "{}: {} in {unit}", entry.channel, source.field);
            }
        }
        for base in &profile.time_base {
            assert!(definitions::by_name(base).and_then(time_field).is_some(), "{base}");
        }
    }

    #[test]
    fn a_profile_that_does_not_fit_is_refused() {
        let wrong = |source: &str| {
            let text = format!("name = \"x\"\ntime_base = []\n[channel.q]\nsources = [{source}]\n");
            let profile = Profile::parse("x.toml", &text).unwrap();
            Rules::new(&["q".to_owned()], 1, &[], &profile).err().unwrap()
        };
        assert!(wrong("{ field = \"ATTITUDE.pitch_rate\" }").contains("no ATTITUDE.pitch_rate"));
        assert!(wrong("{ field = \"ATTITUDE.pitchspeed\", times = \"VFR_HUD.alt\" }").contains("no factors"));
    }

    /// Half a turn about the vertical, then 30 degrees nose up.
    #[test]
    fn attitude_from_a_quaternion() {
        let channels = ["theta", "psi", "q"].map(str::to_owned);
        let mut rules = Rules::new(&channels, channels.len(), &[], &profile()).unwrap();
        let message = definitions::by_name("ATTITUDE_QUATERNION").unwrap();
        let (sin, cos) = 15_f64.to_radians().sin_cos();
        let mut payload = vec![0; message.length()];
        for (name, value) in [("q1", 0.0), ("q2", -sin), ("q3", 0.0), ("q4", cos), ("pitchspeed", 0.5)] {
            let at = message.field(name).unwrap().offset;
            payload[at..at + 4].copy_from_slice(&(value as f32).to_le_bytes());
        }
        let mut values = [f64::NAN; 3];
        rules.read(message, &payload, 0.0, &mut |reading| values[reading.channel] = reading.value);
        for (value, expected) in values.iter().zip([30_f64.to_radians(), std::f64::consts::PI, 0.5]) {
            // Of numbers in single precision.
            assert!((value.abs() - expected).abs() < 1e-6, "{values:?}");
        }
    }

    #[test]
    fn commands_need_a_scale() {
        let channels = ["elevator".to_owned()];
        let mapping = ColumnMapping::new("elevator", "SERVO_OUTPUT_RAW.servo2_raw");
        let refused = Rules::new(&channels, 1, std::slice::from_ref(&mapping), &profile()).err().unwrap();
        assert!(refused.contains("scale") && refused.contains("1500"), "{refused}");
        let mut rules = Rules::new(&channels, 1, &[mapping.with_scale(0.001)], &profile()).unwrap();
        let message = definitions::by_name("SERVO_OUTPUT_RAW").unwrap();
        let mut payload = vec![0; message.length()];
        let at = message.field("servo2_raw").unwrap().offset;
        payload[at..at + 2].copy_from_slice(&1600_u16.to_le_bytes());
        let mut values = Vec::new();
        rules.read(message, &payload, 0.0, &mut |reading| values.push(reading.value));
        assert_eq!(values, [0.1]);
        let wrong = ColumnMapping::new("elevator", "SERVO_OUTPUT_RAW.servo2");
        let refused = Rules::new(&channels, 1, &[wrong], &profile()).err().unwrap();
        assert!(refused.contains("servo2_raw"), "{refused}");
        let sum =
            ColumnMapping::new("elevator", "SERVO_OUTPUT_RAW.servo1_raw").plus("SERVO_OUTPUT_RAW.servo2_raw", 1.0);
        let refused = Rules::new(&channels, 1, &[sum], &profile()).err().unwrap();
        assert!(refused.contains("a sum of several fields is not taken from MAVLink"), "{refused}");
    }

    #[test]
    fn names_mean_what_is_likeliest() {
        let channels = ["thrust", "static_pressure", "temperature"].map(str::to_owned);
        let rules = Rules::new(&channels, 1, &[], &profile()).unwrap();
        let by_name = |name: &str| rules.by_name(name).map(|place| channels[place].as_str());
        assert_eq!(by_name("t"), Some("thrust"), "of the samples");
        assert_eq!((by_name("oat"), by_name("static_pressure")), (Some("temperature"), Some("static_pressure")));
        assert_eq!(by_name("p"), None, "a roll rate");
    }

    #[test]
    fn another_airspeed_by_hand_is_said() {
        let channels = ["true_airspeed".to_owned()];
        let warnings = |header: &str| {
            let mapping = ColumnMapping::new("true_airspeed", header);
            Rules::new(&channels, 1, &[mapping], &profile()).unwrap().warnings
        };
        assert!(warnings("VFR_HUD.airspeed")[0].contains("35 %"));
        assert!(warnings("NAMED_VALUE_FLOAT.v_true").is_empty());
    }

    #[test]
    fn a_better_message_takes_a_channel_over() {
        let channels = ["q".to_owned()];
        let mut rules = Rules::new(&channels, channels.len(), &[], &profile()).unwrap();
        let mut read = |name: &str, stamp_s: f64| {
            let message = definitions::by_name(name).unwrap();
            let mut count = 0;
            rules.read(message, &[0; 64], stamp_s, &mut |_| count += 1);
            count
        };
        assert_eq!(read("ATTITUDE", 0.0), 1);
        assert_eq!(read("HIGHRES_IMU", 0.01), 1);
        assert_eq!(read("ATTITUDE", 0.02), 0);
        assert_eq!(read("ATTITUDE", 2.0), 1, "the better one is silent");
    }
}
