//! The same flight, eight seconds at 50 Hz, with its times written in every form that recorders and spreadsheets have.

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;

const STEP_S: f64 = 0.02;
const ROWS: u32 = 400;
/// A time, s, as text.
type Written = Box<dyn Fn(f64) -> String>;
/// Noon on 2024-05-01, UTC.
const NOON: f64 = 1_714_564_800.0;

fn read(header: &str, time: impl Fn(f64) -> String) -> Record {
    let row = |k: u32| {
        let t = STEP_S * f64::from(k);
        format!("{},{:.4}\n", time(t), (3.0 * t).sin())
    };
    let rows: String = (0..ROWS).map(row).collect();
    csv::read(format!("{header},alpha_deg\n{rows}").as_bytes(), "flight.csv", &CsvOptions::default()).unwrap()
}

/// A time of day, s from midnight, with so many decimals of the second, cut off as clocks do.
fn clock(of_day: f64, decimals: usize) -> String {
    let unit = 10_f64.powi(i32::try_from(decimals).unwrap());
    let of_day = ((of_day * unit + 1e-6).floor() / unit).rem_euclid(86_400.0);
    let (hours, minutes) = ((of_day / 3600.0).floor(), (of_day / 60.0).floor() % 60.0);
    let width = if decimals == 0 { 2 } else { 3 + decimals };
    format!("{hours:02}:{minutes:02}:{:0width$.decimals$}", of_day - 3600.0 * hours - 60.0 * minutes)
}

fn says(record: &Record, words: &str) -> bool {
    record.quality.findings.iter().any(|finding| finding.message.contains(words))
}

/// Largest difference of the steps between rows from the true one, s.
fn off(record: &Record) -> f64 {
    let (first, last) = (record.time[0], record.time[record.time.len() - 1]);
    let even = record.time.iter().enumerate().map(|(k, t)| (t - first - STEP_S * k as f64).abs());
    assert!((last - first - STEP_S * f64::from(ROWS - 1)).abs() < 2.0 * STEP_S, "{first} to {last}");
    even.fold(0.0, f64::max)
}

#[test]
fn every_form_of_times_gives_the_same_record() {
    let date = |t: f64, decimals| format!("2024-05-01T{}", clock(43_200.0 + t, decimals));
    let forms: Vec<(&str, Written)> = vec![
        ("time_s", Box::new(|t| format!("{t:.3}"))),
        ("time_ms", Box::new(|t| format!("{:.0}", 1e3 * t))),
        ("time", Box::new(|t| format!("{:.0}", 1e3 * t))),
        ("time", Box::new(|t| format!("{:.0}", 1e6 * t))),
        ("time", Box::new(|t| format!("{:.0}", 1e9 * t))),
        ("timestamp", Box::new(|t| format!("{:.3}", NOON + t))),
        ("timestamp", Box::new(|t| format!("{:.0}", 1e3 * (NOON + t)))),
        ("timestamp", Box::new(|t| format!("{:.0}", 1e6 * (NOON + t)))),
        // Sixteen digits of nineteen are what a number has: to the microsecond.
        ("timestamp", Box::new(|t| format!("{:.0}000", 1e6 * (NOON + t)))),
        ("time [min]", Box::new(|t| format!("{:.7}", t / 60.0))),
        ("time", Box::new(move |t| clock(43_200.25 + t, 3))),
        ("time", Box::new(move |t| format!("{} PM", clock(3600.0 + t, 2)))),
        // Over midnight, without a date.
        ("time", Box::new(move |t| clock(86_396.0 + t, 2))),
        ("irig", Box::new(move |t| format!("123:{}", clock(43_200.0 + t, 3)))),
        ("time", Box::new(move |t| format!("{}Z", date(t, 3)))),
        ("time", Box::new(move |t| format!("{}+02:00", date(t, 3)))),
        ("time", Box::new(move |t| format!("01.05.2024 {}", clock(43_200.0 + t, 2)))),
        // A day number, as a spreadsheet writes a date in a cell that is no date.
        ("time", Box::new(|t| format!("{:.9}", 45_413.5 + t / 86_400.0))),
    ];
    for (header, time) in forms {
        let record = read(header, &time);
        let case = format!("{header} {}", time(1.0));
        assert_eq!(record.time.len(), ROWS as usize, "{case}: {}", record.quality);
        assert!(off(&record) < 1e-3, "{case}: {} s off", off(&record));
    }
}

#[test]
fn an_offset_makes_a_local_time_universal_and_a_local_time_is_called_one() {
    let start =
        |end: &str| read("time", |t| format!("2024-05-01T{}{end}", clock(43_200.0 + t, 3))).quality.start.unwrap();
    assert_eq!((start("").unix_s, start("").is_utc), (NOON, false));
    assert_eq!((start("Z").unix_s, start("Z").is_utc), (NOON, true));
    assert_eq!((start("+02:00").unix_s, start("+02:00").is_utc), (NOON - 7200.0, true));
}

#[test]
fn times_that_are_written_to_the_second_alone_are_spread_evenly_and_it_is_said() {
    let of = [read("time", |t| clock(43_200.3 + t, 0)), read("time_s", |t| format!("{}", (NOON + 0.3 + t).floor()))];
    for record in of {
        assert_eq!(record.time.len(), ROWS as usize, "{}", record.quality);
        assert!((record.sample_time_s() - STEP_S).abs() < 0.005 * STEP_S, "{}", record.sample_time_s());
        assert!(off(&record) < STEP_S, "{}", off(&record));
        assert!(says(&record, "evenly spaced") && says(&record, "--sample-time"), "{}", record.quality);
    }
}

#[test]
fn uneven_groups_of_equal_times_are_not_spread() {
    // Twenty rows in every second but each third one, which has fifty: this recorder is not even.
    let seconds: Vec<usize> = (0..12).flat_map(|s| std::iter::repeat_n(s, if s % 3 == 0 { 50 } else { 20 })).collect();
    let rows: String =
        seconds.iter().enumerate().map(|(k, s)| format!("{s},{:.4}\n", (0.1 * k as f64).sin())).collect();
    let text = format!("time_s,alpha_deg\n{rows}");
    let record = csv::read(text.as_bytes(), "flight.csv", &CsvOptions::default()).unwrap();
    assert_eq!(record.time.len(), 12);
    assert!(says(&record, "not evenly spaced") && says(&record, "--sample-time"), "{}", record.quality);
}

/// Four seconds of a flight are four seconds into its table, whatever the time began at; the reader of text alone keeps the times.
#[test]
fn the_times_of_a_flight_count_from_its_first_row() {
    use phugoid_flight_data::reader::{ReadOptions, read_path};
    let file = std::env::temp_dir().join(format!("phugoid-late-{}.csv", std::process::id()));
    for (header, first, seconds, expected) in [
        ("Tiempo [s]", 100.0, 1.0, 0.0),
        ("t [h]", 10.0, 3600.0, 0.0),
        ("time_ms", 5000.0, 1e-3, 0.0),
        ("time_s", -5.0, 1.0, 0.0),
        // A first sample near zero keeps its time.
        ("time_s", 0.02, 1.0, 0.02),
        ("time_s", 0.0, 1.0, 0.0),
    ] {
        let rows: String = (0..50).map(|k| format!("{:.9},{k}\n", first + 0.02 * f64::from(k) / seconds)).collect();
        let text = format!("{header},alpha_deg\n{rows}");
        std::fs::write(&file, &text).unwrap();
        let record = read_path(&file, &ReadOptions::default()).unwrap();
        assert!((record.time[0] - expected).abs() < 1e-9, "{header}: {}", record.time[0]);
        assert!((record.time[49] - expected - 0.98).abs() < 1e-4, "{header}: {}", record.time[49]);
        assert_eq!(says(&record, "counts from the first row"), first.abs() * seconds > 1.0, "{header}");
        let kept = csv::read(text.as_bytes(), "flight.csv", &CsvOptions::default()).unwrap();
        assert!((kept.time[0] - first * seconds).abs() < 1e-6, "{header}: {}", kept.time[0]);
    }
    std::fs::remove_file(&file).unwrap();
}

/// A time of day is a time of the record by the clock that its file shows.
#[test]
fn a_time_of_day_is_found_by_the_clock_of_the_file() {
    use phugoid_flight_data::record::{NoTimeOfDay, time_of_day};
    let read = |times: &[&str]| {
        let rows: String = times.iter().enumerate().map(|(row, time)| format!("{time};{row}\n")).collect();
        csv::read(format!("Uhrzeit;alpha_deg\n{rows}").as_bytes(), "flight.csv", &CsvOptions::default()).unwrap()
    };
    let record = read(&["10:15:30,000", "10:15:30,500", "10:15:31,000", "10:15:31,500"]);
    let at = |text: &str| record.at_time_of_day(time_of_day(text).unwrap());
    assert_eq!((at("10:15:30"), at("10:15:30,5"), at("10:15:31.500")), (Ok(0.0), Ok(0.5), Ok(1.5)));
    let outside = at("10:15:29").unwrap_err().to_string();
    assert!(outside.contains("from 10:15:30.000000 to 10:15:31.500000"), "{outside}");
    assert!(matches!(at("10:15"), Err(NoTimeOfDay::Outside { .. })));
    // Over midnight, and by the zone of the file.
    let record = read(&["2024-06-12T23:59:59+02:00", "2024-06-13T00:00:00+02:00", "2024-06-13T00:00:01+02:00"]);
    assert_eq!(record.at_time_of_day(1.0), Ok(2.0));
    let record = csv::read("time_s,a_deg\n0,1\n1,2\n".as_bytes(), "x", &CsvOptions::default()).unwrap();
    assert_eq!(record.at_time_of_day(1.0), Err(NoTimeOfDay::NoClock));
    for text in ["4.5s", "34:56.7", "10", "", "2024-05-01T10:15:31", "25:00:00", "10:15:31Z"] {
        assert_eq!(time_of_day(text), None, "{text}");
    }
}
