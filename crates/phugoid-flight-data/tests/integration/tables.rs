//! Columns of numbers become a record by the same rules as the cells of a CSV file.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::{
    Column, ColumnMapping, LeftOut, MappingProblem, OptionProblem, TableError, TableOptions, from_columns,
};
use phugoid_flight_data::units::Quantity;

fn column(header: &str, unit: Option<&str>, values: &[f64]) -> Column {
    Column { header: header.into(), unit: unit.map(Into::into), values: values.to_vec(), is_time: false }
}

fn read(columns: Vec<Column>, options: &TableOptions) -> Result<Record, TableError> {
    from_columns("flight", columns, &[], options, QualityReport::default())
}

fn findings(record: &Record) -> Vec<String> {
    record.quality.findings.iter().map(|finding| format!("{}: {}", finding.place, finding.message)).collect()
}

#[track_caller]
fn says(record: &Record, part: &str) {
    assert!(findings(record).iter().any(|finding| finding.contains(part)), "{part:?} not in {:#?}", findings(record));
}

/// The same numbers as text and as columns: the same record and the same findings, but for the word for a row.
#[test]
fn a_table_reads_as_the_same_text_does() {
    let time = [0.0, 0.1, 0.2, 0.15, 0.3, f64::NAN, 0.4, 2.0];
    let alpha = [1.0, f64::NAN, 3.0, 9.0, 4.0, 5.0, f64::INFINITY, 6.0];
    let speed = [100.0, 101.0, 99.0, 98.0, 97.0, 96.0, 95.0, 94.0];
    let mut text = "time_s,alpha_deg,tas_kt,q\n".to_owned();
    for row in 0..time.len() {
        text += &format!("{},{},{},0.5\n", time[row], alpha[row], speed[row]);
    }
    let from_text = csv::read(text.as_bytes(), "flight", &CsvOptions::default()).unwrap();
    let columns = vec![
        column("time_s", None, &time),
        column("alpha", Some("deg"), &alpha),
        column("tas", Some("kt"), &speed),
        column("q", None, &[0.5; 8]),
    ];
    let record = read(columns, &TableOptions::default()).unwrap();
    assert_eq!(record.time, from_text.time);
    for (ours, theirs) in record.channels.iter().zip(&from_text.channels) {
        assert_eq!((&ours.name, ours.quantity), (&theirs.name, theirs.quantity));
        let same = ours.values.iter().zip(&theirs.values).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()));
        assert!(same, "{}", ours.name);
    }
    let of = |record: &Record| findings(record).len();
    assert_eq!(of(&record), of(&from_text), "{:#?}\n{:#?}", findings(&record), findings(&from_text));
    // Line 1 of the text is the header: row 4 stands in line 5.
    says(&from_text, "line 5: 1 row left out: the time jumps back");
    says(&record, "row 4: 1 row left out: the time jumps back");
    says(&record, "row 6: 1 row left out: no time");
}

#[test]
fn what_is_wrong_is_said_without_a_line() {
    let error = read(vec![column("alpha", None, &[1.0, 2.0])], &TableOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("flight: no column is the time. Found: alpha."), "{error}");
    let error = read(vec![column("time_s", None, &[0.0, f64::NAN])], &TableOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no usable row of data: only one time is left"), "{error}");
    let columns = vec![column("time_s", None, &[0.0, 1.0]), column("alpha", None, &[0.0])];
    let error = read(columns, &TableOptions::default()).unwrap_err().to_string();
    assert!(error.contains("column 'alpha' has 1 values, the first column has 2"), "{error}");
    let columns = vec![column("time_s", None, &[0.0, 1.0]), column("alpha_deg", Some("rad"), &[0.0, 1.0])];
    let error = read(columns, &TableOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("flight, column 2 ('alpha_deg'): the unit is given twice"), "{error}");
    let bound = TableOptions { max_memory: Memory::from_bytes(200), ..TableOptions::default() };
    let error = read(vec![column("time_s", None, &[0.0, 1.0, 2.0])], &bound).unwrap_err().to_string();
    assert!(
        error.starts_with("flight: to read it about 240 bytes of memory are needed, and the budget is 200 bytes"),
        "{error}"
    );
}

#[test]
fn columns_that_are_no_numbers_are_named() {
    let text = [LeftOut { header: "Mode".into(), why: "text".into() }];
    let columns = || vec![column("time_s", None, &[0.0, 1.0]), column("alpha_rad", None, &[0.0, 0.1])];
    let options = TableOptions::default();
    let record = from_columns("flight", columns(), &text, &options, QualityReport::default()).unwrap();
    says(&record, "column 'Mode': left out: it is text");
    let options = TableOptions { columns: vec![ColumnMapping::new("elevator", "mode")], ..options };
    let error = from_columns("flight", columns(), &text, &options, QualityReport::default()).unwrap_err().to_string();
    assert!(error.contains("'mode': this column is text; map"), "{error}");
}

#[test]
fn points_in_time_are_the_time_where_nothing_is_called_so() {
    let points = || Column { is_time: true, ..column("index", Some("s"), &[10.0, 11.0]) };
    let record = read(vec![column("alpha_rad", None, &[0.0, 0.1]), points()], &TableOptions::default()).unwrap();
    assert_eq!(record.time, [10.0, 11.0]);
    says(&record, "column 'index': taken as the time");
    // Of two nobody knows which.
    let error = read(vec![points(), Column { header: "end".into(), ..points() }], &TableOptions::default());
    assert!(matches!(error, Err(TableError::NoTime { .. })));
    let record = read(vec![column("time_s", None, &[0.0, 1.0]), points()], &TableOptions::default()).unwrap();
    assert_eq!(record.time, [0.0, 1.0]);
}

/// One column may be mapped to two channels.
#[test]
fn one_column_for_two_channels() {
    let columns = vec![ColumnMapping::new("elevator", "x").with_unit("deg"), ColumnMapping::new("other", "x")];
    let options = TableOptions { columns, ..TableOptions::default() };
    let record = read(vec![column("time_s", None, &[0.0, 1.0]), column("x", None, &[180.0, 90.0])], &options).unwrap();
    assert_eq!(record.channel("other").unwrap().values, [180.0, 90.0]);
    assert_eq!(record.channel("elevator").unwrap().values[0], std::f64::consts::PI);
}

#[test]
fn columns_are_added_with_their_factors() {
    let read = |mappings: Vec<ColumnMapping>| {
        let columns = vec![
            column("time_s", None, &[0.0, 1.0, 2.0]),
            column("left", None, &[10.0, 4.0, f64::NAN]),
            column("right", None, &[-2.0, 8.0, 1.0]),
        ];
        read(columns, &TableOptions { columns: mappings, ..TableOptions::default() })
    };
    let record = read(vec![
        ColumnMapping::new("elevator", "left").with_scale(0.5).plus("right", 0.5).with_unit("deg"),
        ColumnMapping::new("aileron", "right").with_scale(0.5).plus("left", -0.5).with_unit("deg"),
    ])
    .unwrap();
    let degrees = |name: &str, row: usize| record.channel(name).unwrap().values[row].to_degrees();
    assert!((degrees("elevator", 0) - 4.0).abs() < 1e-12 && (degrees("aileron", 0) + 6.0).abs() < 1e-12);
    assert!((degrees("elevator", 1) - 6.0).abs() < 1e-12 && (degrees("aileron", 1) - 2.0).abs() < 1e-12);
    assert!(degrees("elevator", 2).is_nan() && degrees("aileron", 2).is_nan(), "half a sum is no angle");
    let told = record.quality.to_string();
    assert!(told.contains("elevator is 0.5 times 'left' plus 0.5 times 'right'"), "{told}");
    let wrong = |mapping: ColumnMapping| read(vec![mapping]).unwrap_err().to_string();
    assert!(wrong(ColumnMapping::new("elevator", "left").plus("rigth", 1.0)).contains("did you mean 'right'?"));
    assert!(wrong(ColumnMapping::new("elevator", "left").plus("right", 0.0)).contains("scale = 0 of 'right'"));
}

/// A program can act on what is wrong with a mapping or an option without reading the message.
#[test]
fn problems_of_mappings_and_options_are_variants() {
    let error = |mapping: ColumnMapping| {
        let columns = vec![column("time_s", None, &[0.0, 0.1]), column("x", None, &[0.0, 0.1])];
        match read(columns, &TableOptions { columns: vec![mapping], ..TableOptions::default() }) {
            Err(TableError::BadMapping { problem, .. }) => *problem,
            other => panic!("{other:?}"),
        }
    };
    let alpha = || ColumnMapping::new("alpha", "x");
    assert_eq!(error(alpha().with_scale(0.0)), MappingProblem::Scale { header: None, scale: 0.0 });
    let unit = MappingProblem::UnitOfChannel { unit: "kg".into(), quantity: Quantity::Angle };
    assert_eq!(error(alpha().with_unit("kg")), unit);
    let nearest = MappingProblem::NotCanonical { channel: "aoa".into(), nearest: "alpha" };
    assert_eq!(error(ColumnMapping::new("aoa", "x")), nearest);
    let options = TableOptions { gap_factor: 1.0, ..TableOptions::default() };
    assert!(matches!(read(Vec::new(), &options), Err(TableError::BadOption(OptionProblem::GapFactor(1.0)))));
}
