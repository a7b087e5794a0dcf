//! Makes a record with one time base of a log whose topics have times of their own.

use super::mapped::{mapped, present};
use super::signals::{self, Signal};
use super::{ReadError, ReadOptions, surfaces, vehicle};
use crate::align::{Aligner, Hold, Statistics};
use crate::channels;
use crate::log::{Log, Selection, Topic, Wanted};
use crate::memory::{Account, Excess, many};
use crate::printable::toml_string;
use crate::profile::{Factor, FieldName, Profile, Source};
use crate::quality::QualityReport;
use crate::record::Record;
use crate::statistics;
use crate::table::{self, Column, ColumnMapping, TableError, TableOptions};
use crate::units;
use crate::wording::{Short, plural};

/// A source is not used if a later one of the profile has more than this many times its samples.
const MANY_TIMES: usize = 10;
/// Channels that an estimation usually needs: their absence gets a note in the quality report.
const EXPECTED: &[&str] =
    &["phi", "theta", "p", "q", "r", "ax", "ay", "az", "true_airspeed", "alpha", "beta", "air_density"];

/// The part of a log that has to be read to make a record of it by this profile and these options.
pub fn selection(profile: &Profile, options: &ReadOptions) -> Selection {
    let mut topics: Vec<Wanted> = Vec::new();
    for FieldName { topic, instance, field } in profile.fields() {
        topics.push(Wanted { topic, instance, fields: Some(vec![field]) });
    }
    let base = profile.time_base.iter().chain(&options.time_base);
    topics.extend(base.map(|topic| Wanted { topic: topic.clone(), instance: None, fields: Some(Vec::new()) }));
    topics.extend(profile.surfaces.map(surfaces::wanted).unwrap_or_default());
    let headers = options.table.columns.iter().flat_map(ColumnMapping::terms);
    let mapped = headers.filter_map(|(header, _)| header.parse::<FieldName>().ok());
    topics.extend(mapped.map(|FieldName { topic, instance, .. }| Wanted { topic, instance, fields: None }));
    Selection { topics: Some(topics), max_memory: options.table.max_memory }
}

/// Makes a record of a log by a profile: all channels at the times of one topic, causally and without interpolation
/// (see [`crate::align`]). The quality report names that topic, and the rate and the delay of every other one.
///
/// ```
/// use phugoid_flight_data::profile::Profile;
/// use phugoid_flight_data::reader::{self, ReadOptions};
/// let (profile, options) = (Profile::px4()?, ReadOptions::default());
/// let selection = reader::selection(&profile, &options);
/// let log = phugoid_flight_data::log::read_path("examples/flight.ulg".as_ref(), &selection)?;
/// let record = reader::record(&log, &profile, &options)?;
/// assert_eq!(record.len(), 81); // the samples of vehicle_angular_velocity
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReadError`]: a mapping names a topic or field that the log does not have, no topic can give the times, or no field
/// is a channel, or the log and the record together need more than `options.table.max_memory`.
pub fn record(log: &Log, profile: &Profile, options: &ReadOptions) -> Result<Record, ReadError> {
    let account = Account::new(options.table.max_memory);
    let values = log.topics.iter().map(|topic| topic.time_s.len().saturating_mul(1 + topic.fields.len())).sum();
    account.take(many(values, 8)).map_err(|excess| over(&account, excess, log, ""))?;
    record_counted(log, profile, options, &account)
}

fn over(account: &Account, excess: Excess, log: &Log, place: &str) -> TableError {
    account.over(excess, &log.source, place).into()
}

/// As [`record`], for a log that the account holds already.
pub(super) fn record_counted(
    log: &Log,
    profile: &Profile,
    options: &ReadOptions,
    account: &Account,
) -> Result<Record, ReadError> {
    // What is needed for a moment to make one signal: its samples in order, and the signal itself.
    let longest = log.topics.iter().map(|topic| topic.time_s.len()).max().unwrap_or(0);
    let work = account.hold(many(longest, 6 * 8)).map_err(|excess| over(account, excess, log, ""))?;
    let keep = |signal: &Signal| {
        let taken = account.take(many(signal.time_s.len(), 2 * 8));
        taken.map_err(|excess| over(account, excess, log, &signal.topic))
    };
    let mut quality = log.quality.clone();
    vehicle::report(log, &mut quality);
    let commands = profile.surfaces.map(|rule| surfaces::commands(log, rule, &profile.mixed)).unwrap_or_default();
    commands.iter().try_for_each(keep)?;
    let mut signals = Vec::new();
    for mapping in &options.table.columns {
        let signal = mapped(log, profile, mapping, &commands)?;
        keep(&signal)?;
        signals.push(signal);
    }
    let by_hand: Vec<String> = signals.iter().map(|signal| signal.channel.clone()).collect();
    for entry in profile.channels.iter().filter(|entry| !by_hand.contains(&entry.channel)) {
        match choose(log, &entry.sources, &entry.channel, &mut quality) {
            Some(source) => {
                if let Some(mut signal) = signals::signal(log, source, &entry.channel, entry.hold) {
                    check_unit(&mut signal, source, &mut quality);
                    keep(&signal)?;
                    signals.push(signal);
                }
            }
            None if EXPECTED.contains(&entry.channel.as_str()) => {
                quality.note(entry.channel.as_str(), absent(log, &entry.channel, &entry.sources));
            }
            None => {}
        }
    }
    if signals.is_empty() {
        return Err(ReadError::NothingUsable {
            source_name: log.source.clone(),
            profile: profile.name.clone(),
            present: present(log),
        });
    }
    if let Some(rule) = profile.surfaces {
        surfaces::report(log, &commands, &by_hand, rule, &profile.mixed, &mut quality);
    }
    signals.extend(commands);
    drop(work);
    let base = base(log, profile, options)?;
    align(log, base, signals, options, quality, account)
}

/// Why a channel is not in the record.
fn absent(log: &Log, channel: &str, sources: &[Source]) -> String {
    let asked = |source: &Source| match &source.factor {
        Some(Factor::Times(factor) | Factor::Density(factor)) => format!("{} with {factor}", source.field),
        None => source.field.to_string(),
    };
    let fields: Vec<String> = sources.iter().map(asked).collect();
    let mut text = format!("not in the log (looked for {}), and nothing stands in for it", fields.join(", "));
    let indicated = |source: &Source| {
        source.factor.is_some() && signals::samples(log, &Source { factor: None, ..source.clone() }).is_some()
    };
    if let Some(source) = sources.iter().find(|source| indicated(source)) {
        text += &format!(
            ". {} is there, but it is indicated: it becomes {channel} only with the density of the air, which the log does not \
             give. Log it, or, where the error does not matter, map it: [channels] {channel} = {{ header = {} }}",
            source.field,
            toml_string(&source.field.to_string())
        );
    }
    text
}

/// The first source that the log has, unless a later one has many times its samples.
fn choose<'a>(log: &Log, sources: &'a [Source], channel: &str, quality: &mut QualityReport) -> Option<&'a Source> {
    let there: Vec<(&Source, usize)> =
        sources.iter().filter_map(|source| Some((source, signals::samples(log, source)?))).collect();
    let (first, samples) = *there.first()?;
    match there.iter().find(|(_, others)| *others > MANY_TIMES * samples) {
        Some((better, others)) => {
            quality.note(
                channel,
                format!("taken from {} ({others} samples) rather than {} ({samples})", better.field, first.field),
            );
            Some(better)
        }
        None => Some(first),
    }
}

/// Keeps the unit that the log states if it is one of the quantity of the channel; else takes that of the profile, with
/// a warning.
fn check_unit(signal: &mut Signal, source: &Source, quality: &mut QualityReport) {
    let Some(quantity) = channels::by_name(&signal.channel).map(|spec| spec.quantity) else { return };
    let Some(unit) = signal.unit.clone().filter(|unit| units::find_for(unit, quantity).is_none()) else { return };
    signal.unit = source.unit.clone();
    let taken = source.unit.as_deref().unwrap_or("a pure number");
    quality.warn(
        signal.channel.as_str(),
        format!(
            "the log gives {} in '{unit}', which is no unit of {}; taken as {taken}",
            signal.header,
            quantity.in_words()
        ),
    );
}

/// The topic whose times become the times of the record.
fn base<'a>(log: &'a Log, profile: &Profile, options: &ReadOptions) -> Result<&'a Topic, ReadError> {
    let wanted = match &options.time_base {
        Some(topic) => std::slice::from_ref(topic),
        None => &profile.time_base,
    };
    let there = wanted.iter().filter_map(|name| signals::topic(log, name, None)).find(|topic| topic.time_s.len() >= 2);
    there.ok_or_else(|| ReadError::NoTimeBase {
        source_name: log.source.clone(),
        wanted: wanted.to_vec(),
        present: present(log),
    })
}

/// Puts all signals on the times of the base topic and makes the record.
fn align(
    log: &Log,
    base: &Topic,
    signals: Vec<Signal>,
    options: &ReadOptions,
    mut quality: QualityReport,
    account: &Account,
) -> Result<Record, ReadError> {
    let needed = many(base.time_s.len(), 8 * (signals.len() + 3));
    account.take(needed).map_err(|excess| over(account, excess, log, &base.name))?;
    let kept = signals::rising(&base.time_s);
    let times: Vec<f64> = kept.iter().filter_map(|&sample| base.time_s.get(sample).copied()).collect();
    let step_s = statistics::median_step(&times).unwrap_or(0.0);
    let label = signals::label(log, base);
    quality.note(
        "time",
        format!(
            "times are those of {label}: {}, median step {} s ({} Hz). Other topics are shown at the first of these times not \
             before their own stamp; nothing is interpolated",
            plural(times.len(), "sample"),
            Short(step_s),
            Short(hertz(step_s))
        ),
    );
    if kept.len() < base.time_s.len() {
        let count = base.time_s.len() - kept.len();
        quality.warn(
            label.as_str(),
            format!("{} left out: their stamps stand against the order of time", plural(count, "sample")),
        );
    }
    let holds: Vec<Hold> = signals.iter().map(|signal| signal.hold).collect();
    // Steps of the base longer than two median ones are gaps; no value is carried across a gap.
    let mut aligner = Aligner::new(&holds).with_longest_delay(2.0 * step_s);
    let mut columns: Vec<Vec<f64>> = signals.iter().map(|_| Vec::with_capacity(times.len())).collect();
    let mut next = vec![0_usize; signals.len()];
    let mut frame = vec![f64::NAN; signals.len()];
    for &time in &times {
        for (channel, (signal, next)) in signals.iter().zip(&mut next).enumerate() {
            while let (Some(&stamp), Some(&value)) = (signal.time_s.get(*next), signal.values.get(*next))
                && stamp <= time
            {
                aligner.put(channel, stamp, value);
                *next += 1;
            }
        }
        aligner.frame(time, &mut frame);
        columns.iter_mut().zip(&frame).for_each(|(column, value)| column.push(*value));
    }
    report_delays(&signals, &aligner, &label, &mut quality);

    let mut table = vec![Column { header: "time".into(), unit: Some("s".into()), values: times, is_time: true }];
    let mut mappings = vec![ColumnMapping::new("time", "time").with_unit("s")];
    for (signal, values) in signals.into_iter().zip(columns) {
        // Two channels of the same field share a column, unless they are held differently and so differ in values.
        let mut header = signal.header;
        if let Some(other) = table.iter().find(|column| column.header == header)
            && !same(&other.values, &values)
        {
            header = format!("{header} (for {})", signal.channel);
        }
        if !table.iter().any(|column| column.header == header) {
            table.push(Column { header: header.clone(), values, ..Column::default() });
        }
        mappings.push(ColumnMapping {
            unit: signal.unit,
            scale: signal.scale,
            ..ColumnMapping::new(signal.channel, header)
        });
    }
    let options = TableOptions { columns: mappings, sample_time_s: None, ..options.table.clone() };
    Ok(table::from_sparse_columns(&log.source, table, &options, quality, account)?)
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
}

fn hertz(step_s: f64) -> f64 {
    if step_s > 0.0 { (10.0 / step_s).round() / 10.0 } else { 0.0 }
}

/// Reports one line per topic: its channels, its rate and its delays.
fn report_delays(signals: &[Signal], aligner: &Aligner, base: &str, quality: &mut QualityReport) {
    let mut topics: Vec<&str> = Vec::new();
    for signal in signals {
        if !topics.contains(&signal.topic.as_str()) {
            topics.push(&signal.topic);
        }
    }
    for topic in topics {
        let of_topic: Vec<(&Signal, Statistics)> = signals
            .iter()
            .enumerate()
            .filter(|(_, signal)| signal.topic == topic)
            .map(|(channel, signal)| (signal, aligner.statistics(channel).copied().unwrap_or_default()))
            .collect();
        let names: Vec<&str> = of_topic.iter().map(|(signal, _)| signal.channel.as_str()).collect();
        let Some((signal, first)) = of_topic.first() else { continue };
        let span = signal.time_s.last().zip(signal.time_s.first()).map_or(0.0, |(last, first)| last - first);
        let rate = if span > 0.0 { (signal.time_s.len() - 1) as f64 / span } else { 0.0 };
        let mut message = format!(
            "{}: {} at {} Hz",
            names.join(", "),
            plural(signal.time_s.len(), "sample"),
            Short((10.0 * rate).round() / 10.0)
        );
        if topic != base {
            let largest = of_topic.iter().map(|(_, s)| s.largest_delay_s).fold(0.0, f64::max);
            let mean = first.total_delay_s / first.shown.max(1) as f64;
            message += &format!(
                "; shown at most {} ms after their stamp, {} ms in the mean",
                Short((1e5 * largest).round() / 100.0),
                Short((1e5 * mean).round() / 100.0)
            );
            if first.passed_over > 0 {
                message += &format!("; {} passed over for newer ones of the same step", first.passed_over);
            }
            if first.too_old > 0 {
                message += &format!("; {} too old when the next time came, and left out", first.too_old);
            }
        }
        if signal.out_of_order > 0 {
            message += &format!("; {} with stamps against the order of time left out", signal.out_of_order);
        }
        let mut notes: Vec<&str> = of_topic.iter().filter_map(|(signal, _)| signal.note.as_deref()).collect();
        notes.dedup();
        if !notes.is_empty() {
            message += &format!("; {}", notes.join("; "));
        }
        quality.note(topic, message);
    }
}
