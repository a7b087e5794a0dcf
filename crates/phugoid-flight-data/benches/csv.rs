//! Speed of reading a large CSV: `cargo bench -p phugoid-flight-data --bench csv`. The plain pass does with the standard
//! library the least that any reader has to do: it takes lines, divides them at commas and reads every cell as a number.

#![allow(clippy::expect_used, missing_docs)] // a bench may stop, and criterion makes its own public items

#[path = "../tests/logger_table/mod.rs"]
mod logger_table;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use phugoid_flight_data::csv::{self, CsvOptions};
use std::hint::black_box;

/// Rows of the table, 20 columns each.
const ROWS: usize = 100_000;

fn benches(criterion: &mut Criterion) {
    let text = logger_table::csv(ROWS);
    let mut group = criterion.benchmark_group("csv of 20 columns and 100,000 rows");
    group.sample_size(10);
    for (name, text) in [
        ("read", &text),
        ("read, decimal commas", &logger_table::with_decimal_commas(&text)),
        ("read, all quoted", &logger_table::quoted(&text)),
        ("read, dates and times", &logger_table::with_clock(&text)),
    ] {
        group.throughput(Throughput::Bytes(text.len() as u64));
        let read = || csv::read(text.as_bytes(), "flight", &CsvOptions::default()).expect("it is a table");
        assert_eq!((read().len(), read().channels.len()), (ROWS, 19));
        group.bench_function(name, |bencher| bencher.iter(|| black_box(read())));
    }
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("plain pass: split at commas, str::parse", |bencher| {
        bencher.iter(|| black_box(logger_table::plain_pass(&text)));
    });
    group.finish();
}

criterion_group!(csv_benches, benches);
criterion_main!(csv_benches);
