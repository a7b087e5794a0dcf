//! Channels that the caller maps by hand to fields of a log or to commands of surfaces.

use super::signals::{self, Signal};
use super::{FieldProblem, ReadError, surfaces};
use crate::align::Hold;
use crate::channels;
use crate::log::{Log, Topic};
use crate::profile::{FieldName, Profile, Source, SurfaceRule, Transform};
use crate::table::ColumnMapping;
use crate::units::Quantity;

/// Channels that change slowly or in steps: without an entry in the profile their last value is held.
const LEVELS: &[&str] = &[
    "elevator",
    "aileron",
    "rudder",
    "flaps",
    "leading_edge_flap",
    "speed_brake",
    "throttle",
    "thrust",
    "mass",
    "ixx",
    "iyy",
    "izz",
    "ixz",
    "cg",
    "fuel",
    "air_density",
    "temperature",
    "static_pressure",
];

/// Servo pulses of telemetry are counted from this width, us, which is the neutral position.
const NEUTRAL_US: f64 = 1500.0;

/// Makes pulse widths that are mapped to another quantity count from the neutral one, as `phugoid live` does with the same
/// mapping; what one microsecond is in SI is the factor of the mapping.
fn count_from_neutral(signal: &mut Signal) {
    let quantity = channels::by_name(&signal.channel).map(|spec| spec.quantity);
    if let Some(quantity) =
        quantity.filter(|quantity| *quantity != Quantity::Time && signal.unit.as_deref() == Some("us"))
    {
        signal.values.iter_mut().for_each(|value| *value -= NEUTRAL_US);
        signal.unit = Some(quantity.si_unit().to_owned()).filter(|unit| !unit.is_empty());
    }
}

/// The signal of a mapping of the caller.
pub(super) fn mapped(
    log: &Log,
    profile: &Profile,
    mapping: &ColumnMapping,
    commands: &[Signal],
) -> Result<Signal, ReadError> {
    let hold = match profile.channel(&mapping.channel) {
        Some(entry) => entry.hold,
        None if LEVELS.contains(&mapping.channel.as_str()) => Hold::Held { stale_after_s: surfaces::STALE_AFTER_S },
        None => Hold::Sampled,
    };
    let mut found = Vec::with_capacity(1 + mapping.plus.len());
    for (header, scale) in mapping.terms() {
        let fail = |problem| ReadError::NoSuchField {
            source_name: log.source.clone(),
            channel: mapping.channel.clone(),
            header: header.to_owned(),
            problem: Box::new(problem),
        };
        let mut signal = named(log, header, &mapping.channel, hold, commands).map_err(&fail)?;
        if mapping.unit.is_none() && profile.surfaces == Some(SurfaceRule::Telemetry) {
            count_from_neutral(&mut signal);
        }
        // The unit that the caller gives comes before that of the log.
        let signal = Signal { unit: mapping.unit.clone().or(signal.unit), ..signal };
        if let Some((first, _)) = found.first().filter(|(first, _): &&(Signal, f64)| first.unit != signal.unit) {
            return Err(fail(FieldProblem::DifferentUnit {
                unit: signal.unit,
                first: first.header.clone(),
                first_unit: first.unit.clone(),
            }));
        }
        found.push((signal, scale));
    }
    let terms: Vec<(&Signal, f64)> = found.iter().map(|(signal, scale)| (signal, *scale)).collect();
    let sum = match terms.as_slice() {
        [(only, scale)] => Some(Signal { scale: *scale, ..(*only).clone() }),
        several => signals::sum(several, surfaces::STALE_AFTER_S),
    };
    sum.ok_or_else(|| ReadError::NoSuchField {
        source_name: log.source.clone(),
        channel: mapping.channel.clone(),
        header: mapping.header.clone(),
        problem: Box::new(FieldProblem::NoField),
    })
}

/// The signal with this name: a command of a surface, or a field of the log as `topic.field`.
///
/// # Errors
/// What is wrong with the name.
fn named(log: &Log, header: &str, channel: &str, hold: Hold, commands: &[Signal]) -> Result<Signal, FieldProblem> {
    if let Some(command) = commands.iter().find(|command| command.channel == header.trim()) {
        return Ok(Signal { channel: channel.to_owned(), unit: None, ..command.clone() });
    }
    let field: FieldName = header.parse().map_err(|error| {
        let commands = commands.iter().map(|command| command.channel.clone()).collect();
        FieldProblem::Name { error, commands }
    })?;
    let Some(topic) = signals::topic(log, &field.topic, field.instance) else {
        let names = log.topics.iter().map(|topic| topic.name.as_str()).chain(log.others.iter().map(String::as_str));
        let nearest = nearest(&field.topic, names).map(str::to_owned);
        let instances: Vec<u16> =
            log.topics.iter().filter(|t| t.name == field.topic).map(|topic| topic.instance).collect();
        return Err(match instances.is_empty() {
            true => FieldProblem::UnknownTopic { topic: field.topic, nearest, present: present(log) },
            false => FieldProblem::UnknownInstance { instances },
        });
    };
    // Instances of a topic need not have the same fields.
    let same =
        |other: &&Topic| other.name == field.topic && field.instance.is_none_or(|instance| instance == other.instance);
    let mut fields: Vec<String> = Vec::new();
    for name in log.topics.iter().filter(same).flat_map(|topic| &topic.fields).map(|field| &field.name) {
        if !fields.contains(name) {
            fields.push(name.clone());
        }
    }
    if !fields.contains(&field.field) {
        let nearest = nearest(&field.field, fields.iter().map(String::as_str)).map(str::to_owned);
        return Err(FieldProblem::UnknownField { topic: topic.name.clone(), nearest, fields });
    }
    let source = Source { field, unit: None, scale: 1.0, transform: Transform::None, factor: None, note: None };
    signals::signal(log, &source, channel, hold).ok_or(FieldProblem::NoSamples)
}

fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    names
        .map(|name| (name, strsim::normalized_damerau_levenshtein(wanted, name)))
        .filter(|&(_, likeness)| likeness >= 0.6)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(name, _)| name)
}

/// The names of the topics of a log in one line, cut to 30, for messages.
pub(super) fn present(log: &Log) -> String {
    const MAX_SHOWN: usize = 30;
    let mut names: Vec<&str> =
        log.topics.iter().map(|topic| topic.name.as_str()).chain(log.others.iter().map(String::as_str)).collect();
    names.sort_unstable();
    names.dedup();
    let more = names.len().saturating_sub(MAX_SHOWN);
    names.truncate(MAX_SHOWN);
    if more > 0 { format!("{}, ... and {more} more", names.join(", ")) } else { names.join(", ") }
}
