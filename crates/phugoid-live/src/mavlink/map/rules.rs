//! Which field is which channel.

use std::collections::BTreeMap;

use phugoid_flight_data::channels;
use phugoid_flight_data::csv::ColumnMapping;
use phugoid_flight_data::record::Quantity;
use phugoid_flight_data::units;

use crate::mavlink::definitions::{self, Field, Message};
use crate::mavlink::units::to_si;

/// Which field is which channel where the model file does not say: message, field, channel. Of several messages that give a
/// channel the first in this table is used. The unit is the definition's.
const PROFILE: &[(&str, &str, &str)] = &[
    ("HIGHRES_IMU", "xacc", "ax"),
    ("HIGHRES_IMU", "yacc", "ay"),
    ("HIGHRES_IMU", "zacc", "az"),
    ("HIGHRES_IMU", "xgyro", "p"),
    ("HIGHRES_IMU", "ygyro", "q"),
    ("HIGHRES_IMU", "zgyro", "r"),
    ("SCALED_IMU", "xacc", "ax"),
    ("SCALED_IMU", "yacc", "ay"),
    ("SCALED_IMU", "zacc", "az"),
    ("SCALED_IMU", "xgyro", "p"),
    ("SCALED_IMU", "ygyro", "q"),
    ("SCALED_IMU", "zgyro", "r"),
    ("RAW_IMU", "xacc", "ax"),
    ("RAW_IMU", "yacc", "ay"),
    ("RAW_IMU", "zacc", "az"),
    ("RAW_IMU", "xgyro", "p"),
    ("RAW_IMU", "ygyro", "q"),
    ("RAW_IMU", "zgyro", "r"),
    ("ATTITUDE", "roll", "phi"),
    ("ATTITUDE", "pitch", "theta"),
    ("ATTITUDE", "yaw", "psi"),
    ("ATTITUDE", "rollspeed", "p"),
    ("ATTITUDE", "pitchspeed", "q"),
    ("ATTITUDE", "yawspeed", "r"),
    ("ATTITUDE_QUATERNION", "roll", "phi"),
    ("ATTITUDE_QUATERNION", "pitch", "theta"),
    ("ATTITUDE_QUATERNION", "yaw", "psi"),
    ("ATTITUDE_QUATERNION", "rollspeed", "p"),
    ("ATTITUDE_QUATERNION", "pitchspeed", "q"),
    ("ATTITUDE_QUATERNION", "yawspeed", "r"),
    ("AOA_SSA", "AOA", "alpha"),
    ("AOA_SSA", "SSA", "beta"),
    ("AIRSPEED", "airspeed", "calibrated_airspeed"),
    ("VFR_HUD", "airspeed", "calibrated_airspeed"),
    ("VFR_HUD", "groundspeed", "ground_speed"),
    ("VFR_HUD", "climb", "vertical_speed"),
    ("VFR_HUD", "throttle", "throttle"),
    ("GLOBAL_POSITION_INT", "alt", "altitude"),
    ("VFR_HUD", "alt", "altitude"),
    ("GLOBAL_POSITION_INT", "lat", "latitude"),
    ("GLOBAL_POSITION_INT", "lon", "longitude"),
    ("HIGHRES_IMU", "abs_pressure", "static_pressure"),
    ("SCALED_PRESSURE", "press_abs", "static_pressure"),
    ("HIGHRES_IMU", "diff_pressure", "impact_pressure"),
    ("SCALED_PRESSURE", "press_diff", "impact_pressure"),
];

/// Widths of servo pulses count from here, us: the neutral position of every servo.
const NEUTRAL_US: f64 = 1500.0;
/// A message that gave a channel and has been silent for this long, s, leaves it to the next.
const GIVEN_UP_S: f64 = 1.0;

/// A value of a channel.
pub(super) struct Reading {
    pub(super) channel: usize,
    pub(super) value: f64,
}

/// The fields that are read, by message.
pub(super) struct Rules {
    by_message: BTreeMap<u32, Vec<Rule>>,
    /// Channels by the names that `NAMED_VALUE_FLOAT` may give them.
    named: BTreeMap<String, (usize, Conversion)>,
    channels: Vec<String>,
    /// Per channel: rank of the message that gives it, and when it did last, s.
    given_by: Vec<(usize, f64)>,
}

#[derive(Clone, Debug)]
struct Rule {
    what: What,
    channel: usize,
    /// Of several, the lowest gives the channel.
    rank: usize,
    conversion: Conversion,
}

#[derive(Clone, Debug)]
enum What {
    Element(Field, usize),
    /// Roll, pitch or yaw (0, 1, 2) of the quaternion.
    Euler(usize),
}

/// `SI value = scale * (raw - zero) + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Conversion {
    zero: f64,
    scale: f64,
    offset: f64,
}

impl Conversion {
    const NONE: Self = Self { zero: 0.0, scale: 1.0, offset: 0.0 };
}

impl Rules {
    /// # Errors
    /// A mapping to a message that exists with a field that it does not have, or a unit that does not suit the channel.
    pub(super) fn new(channels: &[String], columns: &[ColumnMapping]) -> Result<Self, String> {
        let mut rules = Self {
            by_message: BTreeMap::new(),
            named: BTreeMap::new(),
            channels: channels.to_vec(),
            given_by: vec![(usize::MAX, f64::NEG_INFINITY); channels.len()],
        };
        let position = |name: &str| channels.iter().position(|channel| channel == name);
        for mapping in columns {
            let Some((message, field)) = mapping.header.trim().split_once('.') else { continue };
            let (Some(message), Some(channel)) = (definitions::by_name(message), position(&mapping.channel)) else {
                continue;
            };
            if message.name == "NAMED_VALUE_FLOAT" {
                let conversion = by_hand(mapping, "")?;
                rules.named.insert(field.to_owned(), (channel, conversion));
                continue;
            }
            let (name, element) = element(field);
            let Some(found) = message.field(name).filter(|found| element < found.count.max(1)) else {
                let fields: Vec<String> = message.fields.iter().map(written).collect();
                return Err(format!(
                    "[channels] {}: the MAVLink message {} has no field `{field}`. It has {}",
                    mapping.channel,
                    message.name,
                    fields.join(", ")
                ));
            };
            let conversion = by_hand(mapping, found.unit)?;
            let rule = Rule { what: What::Element(found.clone(), element), channel, rank: 0, conversion };
            rules.by_message.entry(message.id).or_default().push(rule);
        }
        for (rank, (message, field, channel)) in PROFILE.iter().enumerate() {
            let (Some(message), Some(channel)) = (definitions::by_name(message), position(channel)) else { continue };
            let euler = ["roll", "pitch", "yaw"].iter().position(|angle| angle == field);
            let (what, unit) = match (message.field(field), euler) {
                (Some(found), _) => (What::Element(found.clone(), 0), found.unit),
                (None, Some(angle)) => (What::Euler(angle), "rad"),
                (None, None) => continue,
            };
            let Some((scale, offset)) = to_si(unit) else { continue };
            let conversion = Conversion { zero: 0.0, scale, offset };
            rules.by_message.entry(message.id).or_default().push(Rule { what, channel, rank: rank + 2, conversion });
        }
        Ok(rules)
    }

    /// Gives the values of a message, SI.
    pub(super) fn read(&mut self, message: &Message, payload: &[u8], stamp_s: f64, out: &mut dyn FnMut(Reading)) {
        if message.name == "NAMED_VALUE_FLOAT" {
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
                What::Euler(angle) => euler(message, payload).and_then(|angles| angles.get(*angle).copied()),
            };
            let Some(raw) = raw else { continue };
            let Conversion { zero, scale, offset } = rule.conversion;
            out(Reading { channel: rule.channel, value: scale * (raw - zero) + offset });
        }
    }

    /// A value under the name of a channel, SI (`elevator` in rad), or under a name of the model file.
    fn read_named(&mut self, message: &Message, payload: &[u8], stamp_s: f64, out: &mut dyn FnMut(Reading)) {
        let name = message.field("name").and_then(|field| field.text(payload));
        let value = message.field("value").and_then(|field| field.value(payload, 0));
        let (Some(name), Some(value)) = (name, value) else { return };
        let (channel, conversion) = match self.named.get(&name) {
            Some(known) => *known,
            None => {
                let known = channels::by_any_name(&name);
                let position = |name: &str| self.channels.iter().position(|channel| channel == name);
                let Some(channel) = position(&name).or_else(|| known.iter().find_map(|spec| position(spec.name)))
                else {
                    return;
                };
                (channel, Conversion::NONE)
            }
        };
        let Some(given_by) = self.given_by.get_mut(channel) else { return };
        if gives(given_by, 1, stamp_s) {
            out(Reading { channel, value: conversion.scale * value + conversion.offset });
        }
    }
}

/// May a source of this rank give the channel now?
fn gives(given_by: &mut (usize, f64), rank: usize, stamp_s: f64) -> bool {
    let (best, last_s) = *given_by;
    let given_up = (stamp_s - last_s).abs() > GIVEN_UP_S;
    if rank <= best || given_up {
        *given_by = (rank, stamp_s);
        return true;
    }
    false
}

/// How a mapping of the model file converts.
fn by_hand(mapping: &ColumnMapping, unit_of_field: &str) -> Result<Conversion, String> {
    let quantity = channels::by_name(&mapping.channel).map_or(Quantity::Number, |spec| spec.quantity);
    if let Some(text) = &mapping.unit {
        let Some(unit) = units::find_for(text, quantity) else {
            let accepted = units::accepted(quantity);
            return Err(format!(
                "[channels] {}: the unit `{text}` is not understood for {}; accepted are {accepted}",
                mapping.channel,
                quantity.in_words()
            ));
        };
        return Ok(Conversion { zero: 0.0, scale: mapping.scale * unit.scale, offset: unit.offset });
    }
    let suits = quantity == Quantity::Number
        || units::find_for(unit_of_field, quantity).is_some()
        || (unit_of_field == "mG" && quantity == Quantity::Acceleration)
        || (to_si(unit_of_field).is_some() && units::find(unit_of_field).is_empty() && !unit_of_field.is_empty());
    if suits && let Some((scale, offset)) = to_si(unit_of_field) {
        return Ok(Conversion { zero: 0.0, scale: mapping.scale * scale, offset });
    }
    if unit_of_field.is_empty() && mapping.header.starts_with("NAMED_VALUE_FLOAT") {
        return Ok(Conversion { zero: 0.0, scale: mapping.scale, offset: 0.0 });
    }
    if mapping.scale == 1.0 {
        return Err(format!(
            "[channels] {}: `{}` is a command {}, not {} in a unit. Give what one of its units is in {}: \
             {} = {{ header = \"{}\", scale = ... }}. Servo pulses count from 1500 us",
            mapping.channel,
            mapping.header,
            if unit_of_field.is_empty() { "without a unit".to_owned() } else { format!("in {unit_of_field}") },
            quantity.in_words(),
            quantity.si_unit(),
            mapping.channel,
            mapping.header
        ));
    }
    let zero = if unit_of_field == "us" { NEUTRAL_US } else { 0.0 };
    Ok(Conversion { zero, scale: mapping.scale, offset: 0.0 })
}

/// `actuator[3]`: name and element.
fn element(field: &str) -> (&str, usize) {
    let parts = field.strip_suffix(']').and_then(|inner| inner.rsplit_once('['));
    parts.and_then(|(name, index)| Some((name, index.parse().ok()?))).unwrap_or((field, 0))
}

fn written(field: &Field) -> String {
    if field.count == 0 { field.name.to_owned() } else { format!("{}[0..{}]", field.name, field.count) }
}

/// The field that says when a message was sampled.
pub(super) fn time_field(message: &Message) -> Option<&Field> {
    ["time_usec", "time_boot_ms"].iter().find_map(|name| message.field(name))
}

/// When a message was sampled, s, by its own clock.
pub(super) fn stamp_s(message: &Message, payload: &[u8]) -> Option<f64> {
    let field = time_field(message)?;
    let unit = units::find_for(field.unit, Quantity::Time)?;
    // Divided, not multiplied: so that 100010 ms and 100010000 us are the same number of seconds.
    Some(field.value(payload, 0)? / (1.0 / unit.scale).round())
}

/// Roll, pitch and yaw, rad, of the quaternion (w, x, y, z) from the ground's axes to the body's.
fn euler(message: &Message, payload: &[u8]) -> Option<[f64; 3]> {
    let q = |name: &str| message.field(name).and_then(|field| field.value(payload, 0));
    let (w, x, y, z) = (q("q1")?, q("q2")?, q("q3")?, q("q4")?);
    // Stevens & Lewis, Aircraft Control and Simulation, 3rd edition, (1.3-32).
    Some([
        (2.0 * (w * x + y * z)).atan2(w * w - x * x - y * y + z * z),
        (2.0 * (w * y - x * z)).clamp(-1.0, 1.0).asin(),
        (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_profile_exists() {
        for (message, field, channel) in PROFILE {
            let found = definitions::by_name(message).unwrap();
            let quaternion = *message == "ATTITUDE_QUATERNION";
            let field = found.field(field).map(|field| field.unit).or(quaternion.then_some("rad"));
            let spec = channels::by_name(channel).unwrap();
            assert!(to_si(field.unwrap()).is_some(), "{message}");
            assert!(spec.name == *channel);
        }
    }

    #[test]
    fn commands_need_a_scale() {
        let channels = ["elevator".to_owned()];
        let mapping = ColumnMapping::new("elevator", "SERVO_OUTPUT_RAW.servo2_raw");
        let refused = Rules::new(&channels, std::slice::from_ref(&mapping)).err().unwrap();
        assert!(refused.contains("scale") && refused.contains("1500"), "{refused}");
        let mut rules = Rules::new(&channels, &[mapping.with_scale(0.001)]).unwrap();
        let message = definitions::by_name("SERVO_OUTPUT_RAW").unwrap();
        let mut payload = vec![0; message.length()];
        let at = message.field("servo2_raw").unwrap().offset;
        payload[at..at + 2].copy_from_slice(&1600_u16.to_le_bytes());
        let mut values = Vec::new();
        rules.read(message, &payload, 0.0, &mut |reading| values.push(reading.value));
        assert_eq!(values, [0.1]);
        let refused =
            Rules::new(&channels, &[ColumnMapping::new("elevator", "SERVO_OUTPUT_RAW.servo2")]).err().unwrap();
        assert!(refused.contains("servo2_raw"), "{refused}");
    }

    #[test]
    fn a_better_message_takes_a_channel_over() {
        let channels = ["q".to_owned()];
        let mut rules = Rules::new(&channels, &[]).unwrap();
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
