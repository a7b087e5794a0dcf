//! What arrives, through the whole engine: the same arrivals give the same documents, whatever the timers do in between.

// What goes wrong in a helper fails the test.
#![allow(clippy::unwrap_used)]

use crate::telemetry;

use std::path::PathBuf;

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_live::arrival::{Arrival, Content};
use phugoid_live::document::DocumentKind;
use phugoid_live::engine::Engine;
use phugoid_live::receiver::ReceiverOptions;
use phugoid_live::recording::{Header, Reader, Recorder, VERSION};
use serde_json::Value;
use telemetry::{message, signals};

/// A flight of 4 s.
const SAMPLES: u32 = 400;

/// The arrivals of a flight with losses, duplicates, another order, garbage and damage, its time counted from `from_s`.
fn arrivals(from_s: f64, first_ns: u64) -> Vec<Arrival> {
    let mut sequence = 0_u8;
    let mut number = 1_u32;
    let mut random = || {
        number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(number >> 8) / f64::from(1 << 24)
    };
    let mut sent: Vec<(u64, Vec<u8>)> = Vec::new();
    for k in 0..SAMPLES {
        let t = from_s + 0.01 * f64::from(k);
        let at_ns = first_ns + u64::from(k) * 10_000_000;
        for (place, (name, value)) in signals(t - from_s).into_iter().enumerate() {
            let bytes =
                message("NAMED_VALUE_FLOAT", sequence, &[("time_boot_ms", t * 1e3 + 1e-6), ("value", value)], name);
            sequence = sequence.wrapping_add(1);
            sent.push((at_ns + place as u64 * 1000, bytes));
        }
        let base = message("HIGHRES_IMU", sequence, &[("time_usec", (t * 1e6).round()), ("zacc", -9.7)], "");
        sequence = sequence.wrapping_add(1);
        sent.push((at_ns + 20_000, base));
    }
    let mut received = Vec::new();
    for (at_ns, mut bytes) in sent {
        let chance = random();
        match chance {
            chance if chance < 0.02 => continue,
            // Later than others, some of them after the window.
            chance if chance < 0.05 => received.push((at_ns + 1_000_000 + (random() * 8e6) as u64, bytes)),
            chance if chance < 0.06 => {
                received.push((at_ns, bytes.clone()));
                received.push((at_ns + 500_000, bytes));
            }
            chance if chance < 0.07 => {
                bytes.splice(0..0, *b"noise\xFD\x01");
                received.push((at_ns, bytes));
            }
            chance if chance < 0.08 => {
                bytes[12] ^= 0x40;
                received.push((at_ns, bytes));
            }
            _ => received.push((at_ns, bytes)),
        }
    }
    received.sort_by_key(|(at_ns, _)| *at_ns);
    let arrival =
        |(arrival_ns, bytes)| Arrival { arrival_ns, wall_ns: 0, origin: 0, content: Content::Datagram(bytes) };
    received.into_iter().map(arrival).collect()
}

fn model() -> ModelFile {
    ModelFile::named("f16").unwrap()
}

fn engine() -> Engine {
    engine_with(&ReceiverOptions::default())
}

fn engine_with(options: &ReceiverOptions) -> Engine {
    Engine::new(&model(), &EstimateOptions::default(), options, "test").unwrap().with_every_estimate()
}

/// Everything that is published of arrivals; timers run every `timer_ns` as in flight, or not at all as in a replay.
pub(crate) fn published(arrivals: &[Arrival], timer_ns: Option<u64>) -> Vec<String> {
    published_with(&ReceiverOptions::default(), arrivals, timer_ns)
}

/// The same with these options of the reception.
pub(crate) fn published_with(options: &ReceiverOptions, arrivals: &[Arrival], timer_ns: Option<u64>) -> Vec<String> {
    let mut engine = engine_with(options);
    let mut documents = Vec::new();
    let mut publish = |kind: DocumentKind, text: &str| {
        if kind != DocumentKind::Link {
            documents.push(text.to_owned());
        }
    };
    engine.begin(&mut publish);
    let mut now_ns = 0;
    for arrival in arrivals {
        while let Some(step) = timer_ns.filter(|step| now_ns + step < arrival.arrival_ns) {
            now_ns += step;
            engine.advance(now_ns, &|| 0, &mut publish);
        }
        let mut arrival = arrival.clone();
        engine.stamp(&mut arrival);
        engine.take(&arrival, &|| 0, &mut publish);
    }
    engine.end("test", &|| 0, &mut publish);
    documents
}

pub(crate) fn last(documents: &[String]) -> Value {
    serde_json::from_str(documents.last().unwrap()).unwrap()
}

pub(crate) fn count(documents: &[String], kind: &str) -> usize {
    documents.iter().filter(|text| text.contains(&format!("\"type\":\"{kind}\""))).count()
}

fn temporary(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("phugoid-live-{name}-{}", std::process::id()));
    let _ = std::fs::remove_file(&path);
    path
}

#[test]
fn timers_do_not_matter() {
    let arrivals = arrivals(0.0, 1);
    let replayed = published(&arrivals, None);
    assert!(count(&replayed, "estimate") > 100, "{}", replayed.last().unwrap());
    for timer_ns in [137_000, 1_000_000, 7_300_000] {
        let live = published(&arrivals, Some(timer_ns));
        assert_eq!(live.len(), replayed.len());
        for (live, replayed) in live.iter().zip(&replayed) {
            assert_eq!(live, replayed, "timer every {timer_ns} ns");
        }
    }
    let end = last(&replayed);
    for kind in ["lost", "reordered", "duplicated", "checksum_failures", "garbage_bytes"] {
        assert!(end[kind].as_u64().unwrap() > 0, "{kind}: {end}");
    }
}

#[test]
fn a_recording_gives_the_same_estimates() {
    let arrivals = arrivals(0.0, 1);
    let path = temporary("recording");
    let header = Header { version: VERSION, model_text: "text".to_owned(), ..Header::default() };
    let recorder = Recorder::create(&path, &header).unwrap();
    let mut engine = engine();
    let mut live = Vec::new();
    let mut publish = |_: DocumentKind, text: &str| live.push(text.to_owned());
    engine.begin(&mut publish);
    for arrival in &arrivals {
        engine.advance(arrival.arrival_ns.saturating_sub(10_000), &|| 0, &mut publish);
        let mut arrival = arrival.clone();
        engine.stamp(&mut arrival);
        engine.take(&arrival, &|| 0, &mut publish);
        recorder.record(arrival);
    }
    engine.end("test", &|| 0, &mut publish);
    recorder.finish().unwrap();

    let read = |path: &PathBuf| {
        let mut reader = Reader::open(path).unwrap();
        assert_eq!(reader.header(), &header);
        let mut arrivals = Vec::new();
        while let Some(arrival) = reader.next_arrival().unwrap() {
            arrivals.push(arrival);
        }
        (arrivals, reader.damage())
    };
    let (whole, damage) = read(&path);
    assert!(damage.ended && damage.skipped_bytes == 0 && damage.cut_off_bytes == 0, "{damage:?}");
    assert_eq!(published(&whole, None), live);

    // Cut off anywhere, as by a kill: everything before is there.
    let bytes = std::fs::read(&path).unwrap();
    for cut in [bytes.len() - 1, bytes.len() / 2, bytes.len() / 3] {
        std::fs::write(&path, &bytes[..cut]).unwrap();
        let (part, damage) = read(&path);
        assert!(!damage.ended && damage.skipped_bytes == 0 && damage.cut_off_bytes < 400, "{damage:?}");
        assert_eq!(part, whole[..part.len()]);
        assert!(part.len() + 2 > whole.len() * cut / bytes.len() * 9 / 10);
    }
    // Damaged inside: what is whole is there, and what is not is said.
    let mut damaged = bytes.clone();
    let middle = bytes.len() / 2;
    damaged[middle..middle + 300].fill(0xAA);
    std::fs::write(&path, &damaged).unwrap();
    let (part, damage) = read(&path);
    assert!(damage.ended && damage.skipped_bytes >= 300 && damage.skipped_bytes < 1000, "{damage:?}");
    assert!(part.len() + 10 > whole.len() && part.len() < whole.len());
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn a_restarted_sender_begins_another_flight() {
    let mut both = arrivals(100.0, 1);
    let pause_ns = both.last().unwrap().arrival_ns + 1_000_000_000;
    both.extend(arrivals(0.0, pause_ns));
    let documents = published(&both, Some(1_000_000));
    let end = last(&documents);
    assert_eq!(end["restarts"], 1, "{end}");
    assert_eq!(count(&documents, "hello"), 2);
    let flights: Vec<u64> = documents
        .iter()
        .map(|text| serde_json::from_str::<Value>(text).unwrap())
        .filter(|document| document["type"] == "estimate")
        .filter_map(|document| document["flight"].as_u64())
        .collect();
    let events: Vec<&String> = documents.iter().filter(|text| text.contains("\"type\":\"event\"")).collect();
    let of = |wanted: u64| flights.iter().filter(|flight| **flight == wanted).count();
    assert!(of(0) > 100 && of(1) > 100, "{} {} {events:#?}", of(0), of(1));
}

#[test]
fn a_clock_that_stands_still_is_said() {
    let mut all = arrivals(0.0, 1);
    let end_ns = all.last().unwrap().arrival_ns;
    all.extend((1..200_u32).map(|k| Arrival {
        arrival_ns: end_ns + u64::from(k) * 10_000_000,
        wall_ns: 0,
        origin: 0,
        content: Content::Datagram(message("HIGHRES_IMU", k as u8, &[("time_usec", 3_990_000.0)], "")),
    }));
    let documents = published(&all, Some(1_000_000));
    assert_eq!(last(&documents)["stalled"], 1);
    assert!(documents.iter().any(|text| text.contains("stands still")));
}

/// The same flight as text, in pieces that end anywhere, gives an estimate per row.
#[test]
fn csv_and_json_give_the_same_estimates() {
    let csv = telemetry::csv_header() + &telemetry::csv_rows(0..SAMPLES);
    let json = telemetry::json_lines(0..SAMPLES);
    let estimates = |text: &str| {
        let pieces = text.as_bytes().chunks(777).enumerate().map(|(k, bytes)| Arrival {
            arrival_ns: 1 + k as u64 * 1_000_000,
            wall_ns: 0,
            origin: 0,
            content: Content::Piece(bytes.to_vec()),
        });
        let documents = published(&pieces.collect::<Vec<_>>(), None);
        assert_eq!(last(&documents)["samples"], u64::from(SAMPLES), "{documents:?}");
        documents.into_iter().filter(|text| text.contains("\"type\":\"estimate\"")).collect::<Vec<_>>()
    };
    let from_csv = estimates(&csv);
    assert!(from_csv.len() > 150);
    // Not by `assert_eq`, which would print both.
    assert!(from_csv == estimates(&json));
}
