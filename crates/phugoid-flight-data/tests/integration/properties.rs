//! Invariants: round trip, order of columns, units, layout; and no input whatever makes the reader panic.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use std::fmt::Write as _;

use phugoid_flight_data::channels::CHANNELS;
use phugoid_flight_data::csv::{self, CsvOptions, WriteError};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_flight_data::units::{UNITS, Unit};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

/// The same cases in every run: what CI tries today it tries tomorrow.
fn runner(cases: u32) -> TestRunner {
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[17; 32]))
}

fn read(text: &[u8]) -> Result<Record, csv::ReadError> {
    csv::read(text, "generated", &CsvOptions::default())
}

fn text_of(record: &Record) -> String {
    let mut bytes = Vec::new();
    csv::write(record, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// Any finite number, or NaN for a missing one.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -1e3..1e3,
        2 => proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
        1 => Just(f64::NAN),
    ]
}

/// Names that no table knows, with everything a file may hold in a header.
fn foreign_name() -> impl Strategy<Value = (String, Quantity)> {
    let name = prop_oneof![
        "x[0-9]{1,3}_[a-z]{0,3}",
        "[A-Za-z\"][A-Za-z0-9_ ,;()\\[\\]%°\"-]{0,12}[a-z\"]",
        Just("expected_dCm_alpha".to_owned()),
        Just("delta_Cm".to_owned()),
        Just("pilot_command".to_owned()),
    ];
    let quantities: Vec<Quantity> = UNITS.iter().map(|unit| unit.quantity).collect();
    (name, proptest::sample::select(quantities))
}

fn record() -> impl Strategy<Value = Record> {
    let known: Vec<(String, Quantity)> = CHANNELS.iter().skip(1).map(|c| (c.name.to_owned(), c.quantity)).collect();
    let known = proptest::sample::subsequence(known, 1..8);
    (known, proptest::collection::vec(foreign_name(), 0..3), 2..20_usize).prop_flat_map(|(mut names, foreign, rows)| {
        names.extend(foreign);
        let channels = names
            .into_iter()
            .map(|(name, quantity)| {
                (Just(name), Just(quantity), proptest::collection::vec(value(), rows))
                    .prop_map(|(name, quantity, values)| Channel { name, quantity, values })
            })
            .collect::<Vec<_>>();
        let steps = proptest::collection::vec(1e-4..2.0, rows);
        (-1e4..1e4_f64, steps, channels).prop_map(|(start, steps, channels)| {
            let mut now = start;
            let time = steps.iter().map(|step| {
                now += step;
                now
            });
            Record { source: "generated".into(), time: time.collect(), channels, ..Record::default() }
        })
    })
}

fn same(one: f64, other: f64) -> bool {
    one == other || (one.is_nan() && other.is_nan())
}

/// What is written is read back bit for bit; a name that would not be is refused beforehand.
#[test]
fn round_trip() {
    let mut refused = 0;
    let mut tried = 0;
    let counts = (&mut refused, &mut tried);
    let counts = std::cell::RefCell::new(counts);
    runner(600)
        .run(&record(), |record| {
            *counts.borrow_mut().1 += 1;
            let mut bytes = Vec::new();
            match csv::write(&record, &mut bytes) {
                Err(WriteError::Name { .. }) => {
                    *counts.borrow_mut().0 += 1;
                    prop_assert!(bytes.is_empty(), "nothing may be written");
                    return Ok(());
                }
                other => other.unwrap(),
            }
            let back = read(&bytes).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert_eq!(&back.time, &record.time);
            // A foreign channel without any value is left out; a known one stays.
            let expected: Vec<&Channel> = record
                .channels
                .iter()
                .filter(|c| CHANNELS.iter().any(|known| known.name == c.name) || c.values.iter().any(|v| !v.is_nan()))
                .collect();
            // Specific forces follow from load factors, and an altitude from the pressure altitude.
            let derived =
                back.quality.findings.iter().filter(|f| f.message.starts_with("not recorded; taken as")).count();
            prop_assert_eq!(back.channels.len(), expected.len() + derived);
            for (read, written) in back.channels.iter().zip(expected) {
                prop_assert_eq!((&read.name, read.quantity), (&written.name, written.quantity));
                let alike = read.values.iter().zip(&written.values).all(|(a, b)| same(*a, *b));
                prop_assert!(alike, "{}: {:?} {:?}", read.name, read.values, written.values);
            }
            Ok(())
        })
        .unwrap();
    assert!(tried > 500 && refused * 2 < tried, "{refused} of {tried} records were refused: the test tests too little");
}

/// Columns in any order give the same channels.
#[test]
fn order_of_columns_does_not_matter() {
    let strategy = (proptest::sample::subsequence((1..CHANNELS.len()).collect::<Vec<_>>(), 2..10), any::<u64>());
    runner(200)
        .run(&strategy, |(chosen, seed)| {
            let headers: Vec<String> = std::iter::once("time_s".to_owned())
                .chain(chosen.iter().map(|&index| {
                    let spec = CHANNELS[index];
                    format!("{} [{}]", spec.name, spec.quantity.si_unit())
                }))
                .collect();
            let mut order: Vec<usize> = (0..headers.len()).collect();
            order.sort_by_key(|&column| (column as u64 + 1).wrapping_mul(seed | 1).rotate_left(17));
            let file = |order: &[usize]| {
                let line = |cell: &dyn Fn(usize) -> String| {
                    order.iter().map(|&column| cell(column)).collect::<Vec<_>>().join(",") + "\n"
                };
                let mut text = line(&|column| headers[column].clone());
                for row in 0..5 {
                    text += &line(&|column| format!("{}", row as f64 * (1.0 + 0.1 * column as f64)));
                }
                text
            };
            let straight: Vec<usize> = (0..headers.len()).collect();
            let (one, other) = (read(file(&straight).as_bytes()).unwrap(), read(file(&order).as_bytes()).unwrap());
            prop_assert_eq!(&one.time, &other.time);
            prop_assert_eq!(one.channels.len(), other.channels.len());
            for channel in &one.channels {
                prop_assert_eq!(Some(channel), other.channel(&channel.name));
            }
            Ok(())
        })
        .unwrap();
}

/// A record written in any unit of each quantity gives the same SI values, to rounding.
#[test]
fn units_do_not_matter() {
    let indices: Vec<usize> = (0..CHANNELS.len()).collect();
    let strategy = (proptest::sample::select(indices), any::<proptest::sample::Index>(), -1e3..1e3_f64, any::<bool>());
    runner(2000)
        .run(&strategy, |(channel, unit, si, bracket)| {
            let spec = CHANNELS[channel];
            let units: Vec<&Unit> = UNITS.iter().filter(|unit| unit.quantity == spec.quantity).collect();
            let unit = units[unit.index(units.len())];
            // `v` alone may be the airspeed; `1` and `-` are no suffixes.
            let name = if spec.name == "v" { "v_body" } else { spec.name };
            let header = match bracket || spec.quantity == Quantity::Number {
                true => format!("{name} [{}]", unit.symbol),
                false => format!("{name}_{}", unit.symbol),
            };
            let (first, second) = (unit.from_si(si), unit.from_si(si + 1.0));
            let text = match spec.name {
                "time" => format!("{header},x1\n{first},0\n{second},1\n"),
                _ => format!("time_s,{header}\n0,{first}\n1,{second}\n"),
            };
            let record = read(text.as_bytes()).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
            let values = match spec.name {
                "time" => &record.time,
                name => &record.require(name).map_err(|error| TestCaseError::fail(error.to_string()))?.values,
            };
            // Temperatures lose digits in the offset of a few hundred.
            let tolerance = 1e-12 * (si.abs() + unit.offset.abs() + 1.0);
            prop_assert!((values[0] - si).abs() <= tolerance, "{text}: {} for {si}", values[0]);
            prop_assert!((values[1] - si - 1.0).abs() <= tolerance);
            let assumed = record.quality.channels.iter().any(|entry| entry.unit_assumed);
            prop_assert!(!assumed, "{}", record.quality);
            Ok(())
        })
        .unwrap();
}

/// Every synonym in every usual spelling is the channel it stands under.
#[test]
fn synonyms_are_understood_in_every_spelling() {
    for spec in CHANNELS.iter().skip(1) {
        for name in std::iter::once(spec.name).chain(spec.synonyms.iter().copied()) {
            let spaced = name.replace('_', " ");
            for name in [name.to_owned(), name.to_uppercase(), spaced] {
                let text = format!("time_s,{name} [{}]\n0,1\n1,2\n", spec.quantity.si_unit());
                let ambiguous = name.eq_ignore_ascii_case("v");
                let record = read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
                assert_eq!(record.channel(spec.name).is_some(), !ambiguous, "{text}");
            }
        }
    }
}

const VALID: &str = "# flight 7\ntime_s,Alpha [deg],tas_kt,q_rad_s,note,x1\ns,deg,kt,rad/s,,-\n0,2.5,250,0.01,a,1\n\
                     0.1,2.6,251,nan,b,2\n0.2,2.7,,0.02,c,3\n0.2,2.7,5,0.02,c,3\n0.15,9,9,9,9,9\n5.4,2.8,252,0.03,\"d,e\",4\n";

/// Nothing that reads without an error may break what a record promises.
fn check(bytes: &[u8]) {
    for options in [
        CsvOptions { max_memory: Memory::from_bytes(1 << 20), ..CsvOptions::default() },
        CsvOptions {
            max_memory: Memory::from_bytes(1 << 20),
            delimiter: Some(';'),
            sample_time_s: Some(0.1),
            ..CsvOptions::default()
        },
    ] {
        match csv::read(bytes, "generated", &options) {
            Ok(record) => {
                assert!(record.len() >= 2 && record.time.iter().all(|time| time.is_finite()));
                assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]));
                assert!(record.channels.iter().all(|channel| channel.values.len() == record.len()));
                assert!(record.channels.iter().all(|channel| channel.values.iter().all(|v| !v.is_infinite())));
                assert!(record.quality.rows_kept == record.len() && record.quality.rows_read >= record.len());
                assert!(!record.quality.to_string().is_empty());
            }
            Err(error) => assert!(error.to_string().len() < 4000, "{error}"),
        }
    }
}

/// Arbitrary bytes.
#[test]
fn arbitrary_bytes_never_panic() {
    runner(1500)
        .run(&proptest::collection::vec(any::<u8>(), 0..300), |bytes| {
            check(&bytes);
            Ok(())
        })
        .unwrap();
}

/// Pieces of the language of such files, strung together.
#[test]
fn arbitrary_tables_never_panic() {
    let pieces = [
        "time_s",
        "alpha",
        "alpha_deg",
        "tas_kt",
        "q",
        "V",
        "[deg]",
        "(",
        ")",
        "[",
        "]",
        ",",
        ",",
        ",",
        ";",
        "\t",
        "|",
        " ",
        "\n",
        "\n",
        "\n",
        "\r\n",
        "\r",
        "\"",
        "#",
        "sep=;",
        "0",
        "1",
        "0.1",
        "-2.5e3",
        "1e308",
        "-1e-320",
        "nan",
        "inf",
        "12:30:00",
        "2024-02-30T",
        "°",
        "%",
        "\u{feff}",
        "s,deg",
        "abc",
        "1,5",
        "_",
        "-",
        "1.#IND",
        "1d5",
        "time_h",
        "_deg",
    ];
    let strategy = proptest::collection::vec(proptest::sample::select(pieces.to_vec()), 0..80);
    runner(2000)
        .run(&strategy, |pieces| {
            check(pieces.concat().as_bytes());
            Ok(())
        })
        .unwrap();
}

/// A good file with bytes overwritten, put in and cut out.
#[test]
fn mutated_files_never_panic() {
    let edit = (any::<proptest::sample::Index>(), 0..4_u8, any::<u8>(), 0..20_usize);
    runner(2000)
        .run(&proptest::collection::vec(edit, 1..6), |edits| {
            let mut bytes = VALID.as_bytes().to_vec();
            for (place, kind, byte, length) in edits {
                let at = place.index(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
                let end = (at + length).min(bytes.len());
                match kind {
                    0 if !bytes.is_empty() => bytes[at] = byte,
                    1 => bytes.insert(at.min(bytes.len()), byte),
                    2 => drop(bytes.drain(at..end)),
                    _ => {
                        let copy = bytes[at..end].to_vec();
                        bytes.extend(copy);
                    }
                }
            }
            check(&bytes);
            Ok(())
        })
        .unwrap();
}

/// The file that is mutated above really is a good one, and what is odd in it is said.
#[test]
fn the_file_to_mutate_is_good() {
    let record = read(VALID.as_bytes()).unwrap();
    assert_eq!(record.time, [0.0, 0.1, 0.2, 5.4]);
    let mut all = String::new();
    write!(all, "{}", record.quality).unwrap();
    for part in ["merged", "jumps back", "gap of 5.2 s", "missing", "holds text"] {
        assert!(all.contains(part), "{part} not in {all}");
    }
    assert!(text_of(&record).starts_with("time_s,alpha_rad,true_airspeed_m_s,q_rad_s,x1\n0,"));
}
