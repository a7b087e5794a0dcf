//! Folders of Flight Review 2: a log of PX4 of which each topic is a Parquet file.
//!
//! ```text
//! folder/
//!   metadata.json             what the log says of itself: topics, parameters, messages, the time of its head
//!   vehicle_attitude.parquet  the first instance of a topic; a column for each field, `timestamp` in microseconds
//!   sensor_accel_1.parquet    a further instance, by its number
//! ```
//!
//! Source: `crates/converter/src/converter.rs` and `metadata.rs` of <https://github.com/PX4/flight-review-rs> (2026), which its
//! server and its command `flight-review convert` share.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::sink::{Full, Head, Sink, Stop};
use super::{LogError, Message};
use crate::columnar::{ReadError, row_groups};
use crate::memory::{Account, many};
use crate::table::TableError;

/// Longest metadata that are read, bytes: text messages and parameters of a long flight are some megabytes.
const LONGEST_METADATA: u64 = 64 << 20;
/// What the metadata take in memory for each byte of their file, at most: a parameter is a name and a number.
const BYTES_PER_BYTE: u64 = 6;
/// Longest text of a message, characters.
const LONGEST_TEXT: usize = 400;
/// The field that holds the time of a sample, microseconds.
const TIMESTAMP: &str = "timestamp";

/// What is used of `metadata.json`.
#[derive(Debug, Deserialize)]
struct Metadata {
    topics: BTreeMap<String, IgnoredAny>,
    start_timestamp_us: u64,
    #[serde(default)]
    parameters: BTreeMap<String, Option<f64>>,
    #[serde(default)]
    logged_messages: Vec<Logged>,
    sys_name: Option<String>,
    ver_hw: Option<String>,
    ver_sw: Option<String>,
    ver_sw_release_str: Option<String>,
    sys_uuid: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Logged {
    timestamp_us: u64,
    message: String,
}

/// Reads a folder into a sink.
pub(super) fn run<S: Sink>(folder: &Path, source: &str, sink: &mut S, account: &Account) -> Result<Head, Stop> {
    let metadata = metadata(folder, source, account)?;
    let files = files(folder, source, &metadata)?;
    let named = [
        ("sys_name", metadata.sys_name),
        ("ver_hw", metadata.ver_hw),
        ("ver_sw", metadata.ver_sw),
        ("ver_sw_release", metadata.ver_sw_release_str),
        ("sys_uuid", metadata.sys_uuid),
    ];
    let cut = |text: String| text.chars().take(LONGEST_TEXT).collect();
    let message = |logged: Logged| Message { time_s: logged.timestamp_us as f64, text: cut(logged.message) };
    let mut head = Head {
        source: source.to_owned(),
        information: named.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect(),
        parameters: metadata.parameters.into_iter().filter_map(|(name, value)| Some((name, value?))).collect(),
        messages: metadata.logged_messages.into_iter().map(message).collect(),
        start_us: Some(metadata.start_timestamp_us as f64),
        ..Head::default()
    };
    let mut is_there = false;
    for ((topic, instance), file) in files {
        is_there |= one(&topic, instance, &file, sink, &mut head, account)?;
    }
    match is_there {
        true => Ok(head),
        false => {
            let reason = ": none of its Parquet files has a sample".to_owned();
            Err(LogError::NoData { source_name: source.to_owned(), reason }.into())
        }
    }
}

fn metadata(folder: &Path, source: &str, account: &Account) -> Result<Metadata, Stop> {
    let path = folder.join("metadata.json");
    let io = |error| LogError::Io { source_name: crate::printable::path(&path), error };
    let wrong = |problem: String| {
        let source_name = source.to_owned();
        LogError::NotThisFormat { source_name, format: "folder of Flight Review", problem }
    };
    let length = path.metadata().map_err(io)?.len();
    if length > LONGEST_METADATA {
        return Err(wrong(format!("metadata.json has {length} bytes, more than {LONGEST_METADATA}")).into());
    }
    account.take(length.saturating_mul(BYTES_PER_BYTE)).map_err(Full)?;
    let text = std::fs::read(&path).map_err(io)?;
    Ok(serde_json::from_slice(&text).map_err(|error| wrong(format!("metadata.json: {error}")))?)
}

/// The files of the topics, in the order of topics and instances.
fn files(folder: &Path, source: &str, metadata: &Metadata) -> Result<BTreeMap<(String, u16), PathBuf>, LogError> {
    let io = |error| LogError::Io { source_name: source.to_owned(), error };
    let mut files = BTreeMap::new();
    for entry in folder.read_dir().map_err(io)? {
        let path = entry.map_err(io)?.path();
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        let (Some(stem), true) = (stem, path.extension().is_some_and(|end| end == "parquet")) else { continue };
        let further = stem.rsplit_once('_').and_then(|(topic, number)| Some((topic, number.parse::<u16>().ok()?)));
        // The name of a topic may end with a number itself.
        let (topic, instance) = match further {
            Some((topic, number)) if !metadata.topics.contains_key(stem) => (topic, number),
            _ => (stem, 0),
        };
        files.insert((topic.to_owned(), instance), path);
    }
    Ok(files)
}

/// Reads one topic; whether it has a sample. A file that cannot be read is left out, and the report names it.
fn one<S: Sink>(
    topic: &str,
    instance: u16,
    file: &Path,
    sink: &mut S,
    head: &mut Head,
    account: &Account,
) -> Result<bool, Stop> {
    let mut stream = None;
    let mut has_time = true;
    let read = row_groups::columns(
        || File::open(file),
        &crate::printable::path(file),
        account,
        |columns| {
            // Padding makes the samples of a log as long as the structures of PX4, and means nothing.
            let is_field = |name: &str| name != TIMESTAMP && !name.starts_with("_padding");
            let names: Vec<String> = columns.names().map(str::to_owned).collect();
            let places: Vec<usize> = (0..names.len()).filter(|place| is_field(&names[*place])).collect();
            let fields: Vec<String> = places.iter().map(|place| names[*place].clone()).collect();
            has_time = names.iter().any(|name| name == TIMESTAMP);
            stream = if has_time { sink.open(topic, instance, &fields) } else { None };
            let Some(stream) = &stream else { return false };
            let kept: Vec<usize> = stream.kept.iter().filter_map(|field| places.get(*field).copied()).collect();
            columns.retain(|place| names[place] == TIMESTAMP || kept.contains(&place));
            true
        },
    );
    let (columns, report) = match read {
        Ok(both) => both,
        Err(ReadError::Table(TableError::OverBudget(over))) => return Err(LogError::OverBudget(over).into()),
        Err(error) => {
            head.quality.warn(topic, format!("left out: {error}"));
            return Ok(false);
        }
    };
    head.quality.findings.extend(report.findings);
    if !has_time {
        head.quality.warn(topic, format!("left out: it has no field `{TIMESTAMP}`"));
        return Ok(false);
    }
    // A topic that is not selected has samples as far as anybody knows.
    let Some(stream) = stream else { return Ok(true) };
    let taken = many(columns.rows(), 8 * columns.chosen.len());
    let mut columns = columns.into_columns();
    let Some(time) = columns.iter().position(|column| column.header == TIMESTAMP) else { return Ok(false) };
    let time = columns.remove(time).values;
    let mut row = vec![f64::NAN; columns.len()];
    for (k, time_us) in time.iter().enumerate() {
        row.iter_mut().zip(&columns).for_each(|(value, column)| *value = column.values[k]);
        sink.row(&stream, *time_us, &row)?;
    }
    account.give_back(taken);
    Ok(!time.is_empty())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use ::parquet::arrow::ArrowWriter;
    use ::parquet::basic::Compression;
    use ::parquet::file::properties::WriterProperties;
    use arrow_array::{ArrayRef, Float32Array, RecordBatch, StringArray, UInt64Array};

    use crate::log::{self, Selection};
    use crate::memory::Memory;
    use crate::reader::{ReadError, ReadOptions, read_path, survey_path};
    use crate::record::Record;

    use super::*;

    const ULOG: &str = "examples/flight.ulg";
    /// Time of the head of the example, microseconds: what is written here as well.
    const START_US: u64 = 5_000_000;

    /// A folder that is removed at the end.
    struct Folder(PathBuf);

    impl Drop for Folder {
        fn drop(&mut self) {
            std::fs::remove_dir_all(&self.0).unwrap();
        }
    }

    fn write(file: &Path, columns: Vec<(&str, ArrayRef)>) {
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let properties = WriterProperties::builder().set_compression(Compression::ZSTD(Default::default())).build();
        let mut writer = ArrowWriter::try_new(File::create(file).unwrap(), batch.schema(), Some(properties)).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
    }

    /// The example as the converter of Flight Review writes it: the time first, the fields by their names, numbers in their types,
    /// characters as text.
    fn folder(name: &str) -> Folder {
        let folder = Folder(std::env::temp_dir().join(format!("phugoid-flight-review-{name}-{}", std::process::id())));
        std::fs::create_dir_all(&folder.0).unwrap();
        let log = log::read_path(ULOG.as_ref(), &Selection::default()).unwrap();
        for topic in &log.topics {
            let file = match topic.instance {
                0 => format!("{}.parquet", topic.name),
                instance => format!("{}_{instance}.parquet", topic.name),
            };
            let time = topic.time_s.iter().map(|time| START_US + (time * 1e6).round() as u64);
            let time: ArrayRef = Arc::new(UInt64Array::from_iter_values(time));
            let samples = topic.time_s.len();
            let mut columns: Vec<(&str, ArrayRef)> = vec![("timestamp", time)];
            let mut fields: Vec<_> = topic.fields.iter().collect();
            fields.sort_by(|a, b| a.name.cmp(&b.name));
            for field in fields {
                let values = field.values.iter().map(|value| *value as f32);
                columns.push((field.name.as_str(), Arc::new(Float32Array::from_iter_values(values))));
            }
            columns.push(("_padding0[0]", Arc::new(Float32Array::from(vec![0.0; samples]))));
            columns.push(("letter", Arc::new(StringArray::from(vec!["x"; samples]))));
            write(&folder.0.join(file), columns);
        }
        let parameters: BTreeMap<&str, f64> =
            log.parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let topics: BTreeMap<&str, serde_json::Value> = log
            .topics
            .iter()
            .map(|topic| (topic.name.as_str(), serde_json::json!({"message_count": 1, "multi_id": 0})))
            .collect();
        let metadata = serde_json::json!({
            "sys_name": "PX4", "ver_hw": null, "topics": topics, "parameters": parameters, "start_timestamp_us": START_US,
            "logged_messages": [{"level": "INFO", "timestamp_us": START_US + 1_500_000, "message": "armed"}],
            "analysis": {"diagnostics": []},
        });
        std::fs::write(folder.0.join("metadata.json"), metadata.to_string()).unwrap();
        folder
    }

    #[test]
    fn a_folder_gives_the_flight_of_its_log() {
        let folder = folder("same");
        let (ours, of_ulog) = (Record::open(&folder.0).unwrap(), Record::open(ULOG).unwrap());
        let names = |record: &Record| record.channels.iter().map(|channel| channel.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&ours), names(&of_ulog));
        assert_eq!(ours.time.len(), of_ulog.time.len());
        for (one, other) in ours.channels.iter().zip(&of_ulog.channels) {
            assert_eq!(one.quantity, other.quantity);
            for (a, b) in one.values.iter().zip(&other.values) {
                assert!((a - b).abs() <= 1e-6 * b.abs().max(1.0) || a.is_nan() && b.is_nan(), "{}: {a} {b}", one.name);
            }
        }
        let log = log::read_path(&folder.0, &Selection::topics(["vehicle_attitude"])).unwrap();
        assert_eq!((log.topics.len(), log.messages[0].time_s, log.messages[0].text.as_str()), (1, 1.5, "armed"));
        assert!(log.topics[0].fields.iter().all(|field| field.name != "letter" && !field.name.starts_with('_')));
        let surveyed = survey_path(&folder.0, &ReadOptions::default()).unwrap();
        assert!(surveyed.survey.unwrap().topic("vehicle_attitude", 0).unwrap().samples > 10 && surveyed.record.is_ok());
    }

    #[test]
    fn what_is_torn_is_left_out_with_its_name_or_refused_in_words() {
        let folder = folder("torn");
        let attitude = folder.0.join("vehicle_attitude.parquet");
        let whole = std::fs::read(&attitude).unwrap();
        std::fs::write(&attitude, &whole[..whole.len() / 2]).unwrap();
        let log = log::read_path(&folder.0, &Selection::default()).unwrap();
        assert!(log.topic("vehicle_attitude", 0).is_none());
        assert!(log.quality.findings.iter().any(|finding| finding.place == "vehicle_attitude"), "{:?}", log.quality);
        write(&attitude, vec![("x", Arc::new(Float32Array::from(vec![1.0])))]);
        let log = log::read_path(&folder.0, &Selection::default()).unwrap();
        assert!(log.quality.findings.iter().any(|finding| finding.message.contains("no field `timestamp`")));
        let selection = Selection { max_memory: Memory::from_bytes(10_000), ..Selection::default() };
        assert!(matches!(log::read_path(&folder.0, &selection), Err(LogError::OverBudget(_))));
        let metadata = folder.0.join("metadata.json");
        for (text, words) in
            [("{", "metadata.json"), ("{\"topics\": {}}", "start_timestamp_us"), (&"[".repeat(1000), "metadata.json")]
        {
            std::fs::write(&metadata, text).unwrap();
            let error = read_path(&folder.0, &ReadOptions::default()).unwrap_err();
            assert!(matches!(error, ReadError::Log(_)) && error.to_string().contains(words), "{error}");
        }
        std::fs::write(&metadata, "{\"topics\": {}, \"start_timestamp_us\": 0}").unwrap();
        for file in std::fs::read_dir(&folder.0).unwrap().map(|entry| entry.unwrap().path()) {
            if file != metadata {
                std::fs::remove_file(file).unwrap();
            }
        }
        assert!(matches!(log::read_path(&folder.0, &Selection::default()), Err(LogError::NoData { .. })));
    }

    #[test]
    fn topics_and_instances_are_told_apart() {
        let folder = Folder(std::env::temp_dir().join(format!("phugoid-flight-review-names-{}", std::process::id())));
        std::fs::create_dir_all(&folder.0).unwrap();
        for name in ["sensor_accel.parquet", "sensor_accel_2.parquet", "estimator_1.parquet", "notes.txt"] {
            std::fs::write(folder.0.join(name), "").unwrap();
        }
        let metadata: Metadata = serde_json::from_value(serde_json::json!({
            "topics": {"sensor_accel": {}, "estimator_1": {}}, "start_timestamp_us": 0
        }))
        .unwrap();
        let found: Vec<(String, u16)> = files(&folder.0, "folder", &metadata).unwrap().into_keys().collect();
        let named = |name: &str, instance| (name.to_owned(), instance);
        assert_eq!(found, [named("estimator_1", 0), named("sensor_accel", 0), named("sensor_accel", 2)]);
    }
}
