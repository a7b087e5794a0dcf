//! Channels that the caller maps by hand to fields of a log or to commands of surfaces.

use super::signals::{self, Signal};
use super::{ReadError, surfaces};
use crate::align::Hold;
use crate::log::Log;
use crate::profile::{FieldName, Profile, Source, Transform};
use crate::table::ColumnMapping;

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
        let fail = |problem: String| ReadError::NoSuchField {
            source_name: log.source.clone(),
            channel: mapping.channel.clone(),
            header: header.to_owned(),
            problem,
        };
        let signal = named(log, header, &mapping.channel, hold, commands).map_err(&fail)?;
        // The unit that the caller gives comes before that of the log.
        let signal = Signal { unit: mapping.unit.clone().or(signal.unit), ..signal };
        if let Some((first, _)) = found.first().filter(|(first, _): &&(Signal, f64)| first.unit != signal.unit) {
            let unit = |signal: &Signal| signal.unit.clone().unwrap_or_else(|| "no unit".to_owned());
            return Err(fail(format!(
                "it is in {}, and what it is added to, {}, in {}: say with `unit` what the sum is in",
                unit(&signal),
                first.header,
                unit(first)
            )));
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
        problem: "it names no field".into(),
    })
}

/// The signal with this name: a command of a surface, or a field of the log as `topic.field`.
///
/// # Errors
/// What is wrong with the name, as a clause.
fn named(log: &Log, header: &str, channel: &str, hold: Hold, commands: &[Signal]) -> Result<Signal, String> {
    if let Some(command) = commands.iter().find(|command| command.channel == header.trim()) {
        return Ok(Signal { channel: channel.to_owned(), unit: None, ..command.clone() });
    }
    let field: FieldName = header.parse().map_err(|problem: String| match commands.is_empty() {
        true => problem,
        false => {
            let names: Vec<&str> = commands.iter().map(|command| command.channel.as_str()).collect();
            format!("{problem}, or one of the commands {}", names.join(", "))
        }
    })?;
    let Some(topic) = signals::topic(log, &field.topic, field.instance) else {
        let names = log.topics.iter().map(|topic| topic.name.as_str()).chain(log.others.iter().map(String::as_str));
        let near = nearest(&field.topic, names).map(|near| format!(" (did you mean '{near}'?)")).unwrap_or_default();
        let instances: Vec<String> =
            log.topics.iter().filter(|t| t.name == field.topic).map(|topic| topic.instance.to_string()).collect();
        return Err(match instances.is_empty() {
            true => format!("the log has no topic '{}'{near}. It has: {}", field.topic, present(log)),
            false => format!("the topic has the instances {} only", instances.join(", ")),
        });
    };
    if topic.field(&field.field).is_none() {
        let names: Vec<&str> = topic.fields.iter().map(|field| field.name.as_str()).collect();
        let near = nearest(&field.field, names.iter().copied());
        let near = near.map(|near| format!(" (did you mean '{near}'?)")).unwrap_or_default();
        return Err(format!("the topic '{}' has no such field{near}. It has: {}", topic.name, names.join(", ")));
    }
    let source = Source { field, unit: None, scale: 1.0, transform: Transform::None, factor: None, note: None };
    signals::signal(log, &source, channel, hold).ok_or_else(|| "it has no samples".into())
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
