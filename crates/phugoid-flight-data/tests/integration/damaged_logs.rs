//! Whatever the bytes, a reader of logs answers with a log or an error, never with a panic, and never takes what is not there.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::logs;
use crate::shared_data;

use phugoid_flight_data::log::{Selection, read, survey};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed};

fn config(cases: u32) -> Config {
    let rng_seed = RngSeed::Fixed(5);
    Config { cases, rng_algorithm: RngAlgorithm::ChaCha, rng_seed, failure_persistence: None, ..Config::default() }
}

/// Reads it in both ways; samples and values that came out.
fn read_both(bytes: &[u8]) -> (usize, usize) {
    let surveyed = survey(bytes, "damaged");
    let Ok(log) = read(bytes, "damaged", &Selection::default()) else {
        assert!(surveyed.is_err());
        return (0, 0);
    };
    let samples: usize = log.topics.iter().map(|topic| topic.time_s.len()).sum();
    let values = log.topics.iter().map(|topic| {
        assert!(topic.fields.iter().all(|field| field.values.len() == topic.time_s.len()));
        topic.fields.len() * topic.time_s.len()
    });
    let counted: usize = surveyed.unwrap().topics.iter().map(|topic| topic.samples).sum();
    assert_eq!(samples, counted, "the survey counts what the reader keeps");
    // Every sample and value comes from bytes of its own.
    let values = values.sum::<usize>();
    assert!(samples <= bytes.len() / 3, "{samples} samples of {} bytes", bytes.len());
    (samples, values)
}

#[test]
fn cut_at_every_byte() {
    for bytes in [logs::ulog(20), logs::dataflash(20)] {
        let mut before = 0;
        for length in 0..=bytes.len() {
            let (samples, _) = read_both(&bytes[..length]);
            assert!(samples >= before, "a longer piece has no less: {before} and {samples} at {length}");
            before = samples;
        }
    }
}

#[test]
fn real_logs_cut_and_bent() {
    for name in ["logs/sample_appended_multiple.ulg", "logs/log171.bin"] {
        let Some(path) = shared_data::shared_file(name) else { return };
        let bytes = std::fs::read(path).unwrap();
        let piece = &bytes[..bytes.len().min(300_000)];
        for part in 1..12 {
            read_both(&piece[..piece.len() * part / 12]);
            let mut bent = piece.to_vec();
            let at = bent.len() * part / 12;
            bent[at..at + 97].iter_mut().enumerate().for_each(|(index, byte)| *byte ^= (index as u8).wrapping_mul(37));
            read_both(&bent);
        }
    }
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn bytes_flipped(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..30), which in any::<bool>()) {
        let mut bytes = if which { logs::ulog(30) } else { logs::dataflash(60) };
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        read_both(&bytes);
    }

    #[test]
    fn pieces_shuffled(cuts in prop::collection::vec(any::<prop::sample::Index>(), 1..12), which in any::<bool>()) {
        let bytes = if which { logs::ulog(30) } else { logs::dataflash(60) };
        let mut shuffled = bytes[..40].to_vec();
        for pair in cuts.windows(2) {
            let (a, b) = (pair[0].index(bytes.len()), pair[1].index(bytes.len()));
            shuffled.extend(&bytes[a.min(b)..a.max(b)]);
        }
        read_both(&shuffled);
    }

    #[test]
    fn noise_behind_a_head(noise in prop::collection::vec(any::<u8>(), 0..4000), which in any::<bool>()) {
        let mut bytes = if which { logs::ulog_head() } else { logs::dataflash_head() };
        bytes.extend(noise);
        read_both(&bytes);
    }
}

/// Few bytes that ask for much: the time and the memory that they get are bounded.
#[test]
fn definitions_that_ask_for_much() {
    let mut log = logs::ulog_head();
    log.extend(logs::ulog_message(b'F', b"wide:uint64_t timestamp;uint8_t[60000] x;"));
    log.extend(logs::ulog_message(b'F', b"deep:uint64_t timestamp;empty[65535] x;"));
    log.extend(logs::ulog_message(b'F', b"empty:"));
    for id in 3..2000_u16 {
        let mut add = vec![(id % 256) as u8];
        add.extend(id.to_le_bytes());
        add.extend(if id % 2 == 0 { b"wide" } else { b"deep" });
        log.extend(logs::ulog_message(b'A', &add));
    }
    let mut wide = 4_u16.to_le_bytes().to_vec();
    wide.extend(vec![1; 60_008]);
    log.extend(logs::ulog_message(b'D', &wide));
    let log = read(&log[..], "wide", &Selection::default()).unwrap();
    assert_eq!(log.topics[0].fields.len(), 4096);
    assert!(log.quality.to_string().contains("55904 fields left out"), "{}", log.quality);
}
