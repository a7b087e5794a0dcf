//! The flight that `tests/python/table_fixtures.py` writes in every format.

use phugoid_flight_data::record::{Quantity, Record};

pub(crate) const ROWS: usize = 40;

/// Every number of it, exactly.
#[track_caller]
pub(crate) fn check(record: &Record, name: &str) {
    let column = |value: &dyn Fn(f64) -> f64| (0..ROWS).map(|row| value(row as f64)).collect::<Vec<f64>>();
    assert_eq!(record.time, column(&|k| k * 0.0625), "{name}");
    let degrees = |value: f64| value * (std::f64::consts::PI / 180.0);
    let q = |k: f64| if k == 3.0 { f64::NAN } else { degrees(k * k / 1024.0 - 0.5) };
    let expected: [(&str, Quantity, Vec<f64>); 5] = [
        ("alpha", Quantity::Angle, column(&|k| degrees((k % 7.0) * 0.125 - 0.25))),
        ("q", Quantity::AngularRate, column(&q)),
        ("count", Quantity::Number, column(&|k| k - 20.0)),
        ("big", Quantity::Number, column(&|k| 9_007_199_254_740_991.0 - k)),
        ("on", Quantity::Number, column(&|k| k % 2.0)),
    ];
    for (channel, quantity, values) in expected {
        let found = record.channel(channel).unwrap_or_else(|| panic!("{name}: no {channel}\n{}", record.quality));
        assert_eq!(found.quantity, quantity, "{name}: {channel}");
        let same =
            found.values.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()));
        assert!(same && found.values.len() == ROWS, "{name}: {channel}: {:?}\n{values:?}", found.values);
    }
}

/// Whatever was read, it is a record.
#[track_caller]
pub(crate) fn keeps_its_promises(record: &Record) {
    assert!(record.len() >= 2);
    assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]) && record.time.iter().all(|time| time.is_finite()));
    let good = |values: &[f64]| values.len() == record.len() && values.iter().all(|value| !value.is_infinite());
    assert!(record.channels.iter().all(|channel| good(&channel.values)));
    assert!(record.quality.to_string().len() < 100_000);
}
