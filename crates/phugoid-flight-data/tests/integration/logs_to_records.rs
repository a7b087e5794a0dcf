//! From logs to records: channels, units, times, surfaces, and what is said of them.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::logs;
use crate::shared_data;

use std::path::PathBuf;

use logs::{dataflash_define, dataflash_head, dataflash_message, dataflash_units, ulog_key, ulog_message};
use phugoid_flight_data::format::Format;
use phugoid_flight_data::log;
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::reader::{ReadError, ReadOptions, Surveyed, read_path, survey_path};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::{ColumnMapping, TableOptions};

/// A file that is removed when it goes out of scope.
struct Temporary(PathBuf);

impl Temporary {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("phugoid-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        Self(path)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Topics as (name, fields, seconds between samples), with values by time and field, as a PX4 log of 4 s with an elevator.
fn px4(topics: &[(&str, &str, f64)], value: impl Fn(&str, usize, f64) -> f64) -> Vec<u8> {
    px4_with(&[("CA_SV_CS2_TYPE", 3)], topics, value)
}

/// The same with these parameters.
fn px4_with(
    parameters: &[(&str, i32)],
    topics: &[(&str, &str, f64)],
    value: impl Fn(&str, usize, f64) -> f64,
) -> Vec<u8> {
    let mut log = b"ULog\x01\x12\x35\x01".to_vec();
    log.extend(1_000_000_u64.to_le_bytes());
    log.extend(ulog_message(b'B', &[0; 40]));
    for (name, fields, _) in topics {
        let fields: String = fields.split(' ').map(|field| format!("float {field};")).collect();
        let fields = fields
            .replace("float q;", "float[4] q;")
            .replace("float xyz;", "float[3] xyz;")
            .replace("float control;", "float[8] control;");
        log.extend(ulog_message(b'F', format!("{name}:uint64_t timestamp;{fields}").as_bytes()));
    }
    for (name, parameter) in parameters {
        log.extend(ulog_key(b'P', &format!("int32_t {name}"), &parameter.to_le_bytes()));
    }
    for (id, (name, ..)) in topics.iter().enumerate() {
        let mut add = vec![0];
        add.extend((id as u16).to_le_bytes());
        add.extend(name.bytes());
        log.extend(ulog_message(b'A', &add));
    }
    let mut samples: Vec<(u64, usize)> = Vec::new();
    for (id, (_, _, step)) in topics.iter().enumerate() {
        samples.extend(
            (0..(4.0 / step) as u64).map(|i| (1_000_000 + (i as f64 * step * 1e6) as u64 + 300 * id as u64, id)),
        );
    }
    samples.sort_unstable();
    for (stamp, id) in samples {
        let (name, fields, _) = topics[id];
        let count = match fields {
            "q" => 4,
            "xyz" => 3,
            "control" => 8,
            other => other.split(' ').count(),
        };
        let mut payload = (id as u16).to_le_bytes().to_vec();
        payload.extend(stamp.to_le_bytes());
        let time = (stamp - 1_000_000) as f64 * 1e-6;
        (0..count).for_each(|field| payload.extend((value(name, field, time) as f32).to_le_bytes()));
        log.extend(ulog_message(b'D', &payload));
    }
    log
}

const TOPICS: &[(&str, &str, f64)] = &[
    ("vehicle_angular_velocity", "xyz", 0.01),
    ("vehicle_attitude", "q", 0.02),
    ("airspeed_validated", "true_airspeed_m_s indicated_airspeed_m_s", 0.1),
    ("actuator_servos", "control", 0.05),
];

fn flight(name: &str, field: usize, time: f64) -> f64 {
    match (name, field) {
        // Pitch attitude of 0.2 rad.
        ("vehicle_attitude", 0) => 0.1_f64.cos(),
        ("vehicle_attitude", 2) => 0.1_f64.sin(),
        ("vehicle_attitude", _) => 0.0,
        ("vehicle_angular_velocity", axis) => time + axis as f64,
        ("airspeed_validated", 0) => 20.0 + time,
        ("actuator_servos", 2) => 0.5 * time.sin(),
        _ => 0.0,
    }
}

fn read(file: &Temporary, columns: Vec<ColumnMapping>) -> Record {
    read_path(&file.0, &ReadOptions::with_columns(columns)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_px4_log_becomes_a_record_on_the_times_of_its_rates() {
    let file = Temporary::new("px4.ulg", &px4(TOPICS, flight));
    let record = read(&file, Vec::new());
    assert_eq!(record.time.len(), 400);
    let q = record.channel("q").unwrap();
    assert!((q.values[100] - 2.0).abs() < 1e-6);
    let theta = record.channel("theta").unwrap();
    let shown: Vec<usize> = (0..400).filter(|&row| !theta.values[row].is_nan()).collect();
    assert_eq!(shown.len(), 200, "every sample once");
    assert!(shown.iter().all(|&row| (theta.values[row] - 0.2).abs() < 1e-6));
    // Stamped 0.3 ms after a time of the base, it is shown at the next one.
    assert_eq!(shown[0], 1);
    let told = record.quality.to_string();
    assert!(
        told.contains("times are those of vehicle_angular_velocity: 400 samples, median step 0.01 s (100 Hz)"),
        "{told}"
    );
    assert!(told.contains("theta, phi, psi: 200 samples at 50 Hz; shown at most 9.7 ms"), "{told}");
    assert!(told.contains("alpha: not in the log (looked for airflow_aoa.aoa_rad)"), "{told}");
}

#[test]
fn a_surface_needs_the_users_angle_and_says_how_to_give_it() {
    let file = Temporary::new("surface.ulg", &px4(TOPICS, flight));
    let record = read(&file, Vec::new());
    assert!(record.channel("elevator").is_none(), "no angle is invented");
    assert!(record.channel("elevator_command").is_some());
    let told = record.quality.to_string();
    assert!(told.contains("actuator_servos.control[2], by CA_SV_CS2_TYPE = 3"), "{told}");
    assert!(
        told.contains("elevator = { header = \"elevator_command\", scale = DEFLECTION, unit = \"deg\" }"),
        "{told}"
    );
    for header in ["elevator_command", "actuator_servos.control[2]", "actuator_servos#0.control[2]"] {
        let mapping = ColumnMapping::new("elevator", header).with_scale(-25.0).with_unit("deg");
        let record = read(&file, vec![mapping]);
        let elevator = record.channel("elevator").unwrap();
        let expected = -(25.0_f64).to_radians() * 0.5 * 2.0_f64.sin();
        // The command of 2.0009 s, held.
        assert!((elevator.values[203] - expected).abs() < 1e-3, "{header}: {} {expected}", elevator.values[203]);
        assert!(elevator.values[2..].iter().all(|value| value.is_finite()), "a command stands until the next");
    }
}

/// The commands of two surfaces that make two others together.
fn commands(time: f64) -> (f64, f64) {
    (0.3 * time.sin(), 0.2 * (3.0 * time).cos())
}

/// A flight with elevons (types 5 and 6: left and right) or a V-tail (7 and 8).
fn mixed(types: [i32; 2], values: fn(f64) -> [f64; 2]) -> Vec<u8> {
    px4_with(&[("CA_SV_CS0_TYPE", types[0]), ("CA_SV_CS1_TYPE", types[1])], TOPICS, |name, field, time| {
        match (name, field) {
            ("actuator_servos", side @ 0..=1) => values(time)[side],
            ("actuator_servos", _) => f64::NAN,
            _ => flight(name, field, time),
        }
    })
}

#[test]
fn elevons_and_v_tails_are_the_surfaces_that_they_make() {
    // PX4: positive commands move both trailing edges up. Up on both sides pitches up, up on the right rolls right, up on the left
    // side of a V-tail moves the trailing edge right.
    let elevons = mixed([5, 6], |time| {
        let (pitch, roll) = commands(time);
        [pitch - roll, pitch + roll]
    });
    let tail = mixed([7, 8], |time| {
        let (pitch, yaw) = commands(time);
        [pitch + yaw, pitch - yaw]
    });
    for (name, log, second) in [("elevons.ulg", elevons, "aileron"), ("tail.ulg", tail, "rudder")] {
        let file = Temporary::new(name, &log);
        let map = |surface: &str| {
            ColumnMapping::new(surface, format!("{surface}_command")).with_scale(-20.0).with_unit("deg")
        };
        let record = read(&file, vec![map("elevator"), map(second)]);
        let value = |channel: &str| record.channel(channel).unwrap().values[203];
        // The commands of 2.0009 s, held; single precision.
        let (pitch, other) = commands(2.0);
        assert!((value("elevator") + (20.0 * pitch).to_radians()).abs() < 1e-3, "{}", value("elevator"));
        assert!((value(second) + (20.0 * other).to_radians()).abs() < 1e-3, "{}", value(second));
        assert!(record.channel("left_elevon_command").or(record.channel("left_v_tail_command")).is_some());
        let told = read(&file, Vec::new()).quality.to_string();
        assert!(told.contains(&format!("{second} = {{ header = \"{second}_command\", scale = DEFLECTION")), "{told}");
        assert!(
            told.contains("0.5 times actuator_servos.control[0] plus 0.5 times actuator_servos.control[1]"),
            "{told}"
        );
        assert!(!told.contains("not worked out"), "{told}");
    }
}

#[test]
fn a_surface_is_a_sum_of_what_the_log_has_with_the_callers_factors() {
    let log = mixed([5, 6], |time| {
        let (pitch, roll) = commands(time);
        [pitch - roll, pitch + roll]
    });
    let file = Temporary::new("sum.ulg", &log);
    // Elevons of 24 degrees: half of it each; an aileron is positive with its right trailing edge down.
    let sums = vec![
        ColumnMapping::new("elevator", "left_elevon_command")
            .with_scale(-12.0)
            .plus("right_elevon_command", -12.0)
            .with_unit("deg"),
        ColumnMapping::new("aileron", "actuator_servos.control[0]")
            .with_scale(12.0)
            .plus("actuator_servos#0.control[1]", -12.0)
            .with_unit("deg"),
    ];
    let record = read(&file, sums.clone());
    let value = |channel: &str| record.channel(channel).unwrap().values[203];
    let (pitch, roll) = commands(2.0);
    assert!((value("elevator") + (24.0 * pitch).to_radians()).abs() < 1e-3, "{}", value("elevator"));
    assert!((value("aileron") + (24.0 * roll).to_radians()).abs() < 1e-3, "{}", value("aileron"));
    // A wrong name in a sum is answered as any other.
    let wrong = vec![sums[0].clone().plus("actuator_servos.controls[3]", 1.0)];
    let told = read_path(&file.0, &ReadOptions::with_columns(wrong)).unwrap_err().to_string();
    assert!(
        told.contains("'actuator_servos.controls[3]', but the topic 'actuator_servos' has no such field"),
        "{told}"
    );
}

#[test]
fn a_log_is_surveyed_and_read_in_one_pass() {
    let file = Temporary::new("surveyed.ulg", &px4(TOPICS, flight));
    let options = ReadOptions::default();
    let Surveyed { survey, record } = survey_path(&file.0, &options).unwrap();
    assert_eq!(survey.unwrap(), log::survey_path(&file.0).unwrap());
    let (record, alone) = (record.unwrap(), read_path(&file.0, &options).unwrap());
    assert_eq!((&record.source, &record.quality), (&alone.source, &alone.quality));
    assert_eq!(record.channels.len(), alone.channels.len());
    for (channel, other) in record.channels.iter().zip(&alone.channels) {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<u64>>();
        assert_eq!((&channel.name, bits(&channel.values)), (&other.name, bits(&other.values)));
    }
    // Too much for a record is not too much for a survey.
    let table = TableOptions { max_memory: Memory::from_bytes(20_000), ..TableOptions::default() };
    let Surveyed { survey, record } = survey_path(&file.0, &ReadOptions { table, ..options }).unwrap();
    assert_eq!(survey.unwrap(), log::survey_path(&file.0).unwrap());
    assert!(record.unwrap_err().to_string().contains("the budget is 20 kB"));
    // A table has no topics.
    let table = Temporary::new("surveyed.csv", b"time_s,alpha_deg\n0,1\n1,2\n");
    let Surveyed { survey, record } = survey_path(&table.0, &ReadOptions::default()).unwrap();
    assert!(survey.is_none() && record.unwrap().channel("alpha").is_some());
}

#[test]
fn mappings_that_name_nothing_are_answered_with_what_there_is() {
    let file = Temporary::new("wrong.ulg", &px4(TOPICS, flight));
    let error = |header: &str| {
        let options = ReadOptions::with_columns(vec![ColumnMapping::new("alpha", header)]);
        read_path(&file.0, &options).unwrap_err().to_string()
    };
    let told = error("actuator_servo.control[2]");
    assert!(told.contains("no topic 'actuator_servo' (did you mean 'actuator_servos'?)"), "{told}");
    let told = error("vehicle_attitude.r[2]");
    assert!(told.contains("no such field (did you mean 'q[2]'?). It has: q[0], q[1], q[2], q[3]"), "{told}");
    assert!(error("alpha").contains("write topic.field or topic#instance.field"), "{}", error("alpha"));
}

/// A user who names columns expects these names: a file with names of its own does not pass over them.
#[test]
fn names_of_columns_are_not_ignored_where_the_file_has_its_own() {
    let table = TableOptions { column_names: vec!["time_s".into(), "alpha_deg".into()], ..TableOptions::default() };
    let options = ReadOptions { table, ..ReadOptions::default() };
    let log = Temporary::new("named.ulg", &px4(TOPICS, flight));
    let parquet = Temporary::new("named.parquet", b"PAR1 and no more");
    for (file, format) in [(&log, Format::Ulog), (&parquet, Format::Parquet)] {
        for error in [read_path(&file.0, &options).unwrap_err(), survey_path(&file.0, &options).unwrap_err()] {
            assert!(matches!(&error, ReadError::NamedInTheFile { format: found, .. } if *found == format), "{error}");
            assert!(error.to_string().contains("names its columns itself"), "{error}");
        }
    }
    let csv = Temporary::new("named.csv", b"0,1\n1,2\n");
    assert_eq!(read_path(&csv.0, &options).unwrap().time, [0.0, 1.0]);
}

#[test]
fn a_source_with_ten_times_the_samples_is_preferred() {
    let topics: Vec<(&str, &str, f64)> =
        TOPICS.iter().copied().chain([("airspeed", "indicated_airspeed_m_s true_airspeed_m_s", 0.005)]).collect();
    let file = Temporary::new(
        "airspeed.ulg",
        &px4(&topics, |name, field, time| match (name, field) {
            ("airspeed", 1) => 30.0,
            _ => flight(name, field, time),
        }),
    );
    let record = read(&file, Vec::new());
    assert_eq!(record.channel("true_airspeed").unwrap().values[50], 30.0);
    let told = record.quality.to_string();
    assert!(
        told.contains("taken from airspeed.true_airspeed_m_s (800 samples) rather than airspeed_validated"),
        "{told}"
    );
    assert!(told.contains("passed over for newer ones"), "{told}");
}

/// An ArduPilot log with attitude in hundredths of a degree, an airspeed and a servo.
fn ardupilot(ratio: bool) -> Vec<u8> {
    let mut log = dataflash_head();
    log.extend(dataflash_define(190, 3 + 8 + 6, "ATT", "Qccc", "TimeUS,Roll,Pitch,Yaw"));
    log.extend(dataflash_define(191, 3 + 8 + 4, "ARSP", "Qf", "TimeUS,Airspeed"));
    log.extend(dataflash_define(192, 3 + 8 + 4, "CTUN", "Qf", "TimeUS,E2T"));
    log.extend(dataflash_define(193, 3 + 8 + 4, "RCOU", "QHH", "TimeUS,C1,C2"));
    log.extend(dataflash_units(190, "sddh", "FBBB"));
    for (name, value) in
        [("SERVO2_MIN", 1000.0), ("SERVO2_MAX", 2000.0), ("SERVO2_TRIM", 1400.0), ("SERVO2_REVERSED", 1.0)]
    {
        let mut parameter = 2_000_000_u64.to_le_bytes().to_vec();
        let mut padded = str::as_bytes(name).to_vec();
        padded.resize(16, 0);
        parameter.extend(padded);
        parameter.extend(f32::to_le_bytes(value));
        log.extend(dataflash_message(180, &parameter));
    }
    for i in 0..200_u64 {
        let stamp = (2_000_000 + 20_000 * i).to_le_bytes();
        let mut attitude = stamp.to_vec();
        [1000_i16, -500, 9000].iter().for_each(|angle| attitude.extend(angle.to_le_bytes()));
        log.extend(dataflash_message(190, &attitude));
        if i % 5 == 0 {
            log.extend(dataflash_message(191, &[&stamp[..], &20_f32.to_le_bytes()].concat()));
            if ratio {
                log.extend(dataflash_message(192, &[&stamp[..], &1.25_f32.to_le_bytes()].concat()));
            }
            log.extend(dataflash_message(
                193,
                &[&stamp[..], &1500_u16.to_le_bytes(), &1700_u16.to_le_bytes()].concat(),
            ));
        }
    }
    log
}

#[test]
fn an_ardupilot_log_in_its_own_units() {
    let file = Temporary::new("plane.bin", &ardupilot(true));
    let record = read(&file, Vec::new());
    assert!((record.channel("phi").unwrap().values[3] - 10_f64.to_radians()).abs() < 1e-12);
    assert!((record.channel("theta").unwrap().values[3] + 5_f64.to_radians()).abs() < 1e-12);
    let airspeed: Vec<f64> =
        record.channel("true_airspeed").unwrap().values.iter().copied().filter(|v| !v.is_nan()).collect();
    // The ratio comes after the first airspeed, and is held from then on.
    assert!(airspeed.len() >= 39 && airspeed.iter().all(|&speed| speed == 25.0), "{airspeed:?}");
    // (1700 - 1400) / (2000 - 1400), reversed.
    assert_eq!(record.channel("elevator_command").unwrap().values[7], -0.5);
    let told = record.quality.to_string();
    assert!(told.contains("RCOU.C2 from -1 to 1, by SERVO2_FUNCTION = 19"), "{told}");
}

#[test]
fn an_indicated_airspeed_without_density_is_not_called_true() {
    let file = Temporary::new("indicated.bin", &ardupilot(false));
    let record = read(&file, Vec::new());
    assert!(record.channel("true_airspeed").is_none());
    assert!(record.channel("indicated_airspeed").is_some());
    let told = record.quality.to_string();
    assert!(told.contains("ARSP.Airspeed is there, but it is indicated"), "{told}");
}

#[test]
fn a_table_is_read_by_the_same_entry_and_binary_files_are_named() {
    let csv = Temporary::new("flight.ulg", b"time_s,alpha_deg\n0,1\n0.1,2\n0.2,3\n");
    assert_eq!(read(&csv, Vec::new()).time.len(), 3, "by content, not by name");
    for (start, told) in [
        (&b"\x89HDF\r\n\x1a\n"[..], "HDF5"),
        (b"FMT, 128, 89, FMT, BBnNZ", "give the binary log (.BIN)"),
        (
            b"PK\x03\x04....",
            if cfg!(feature = "excel") { "no workbook that can be read" } else { "another zip archive" },
        ),
        (b"\x89MCAP0\r\n", if cfg!(feature = "mcap") { "the log holds no data" } else { "MCAP" }),
    ] {
        let file = Temporary::new("unknown", start);
        let error = read_path(&file.0, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[cfg(feature = "gzip")]
fn packed(text: &[u8]) -> Vec<u8> {
    use std::io::Write as _;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(text).unwrap();
    packer.finish().unwrap()
}

#[test]
#[cfg(feature = "gzip")]
fn a_table_compressed_by_gzip_is_read() {
    let file = Temporary::new("flight.csv.gz", &packed(b"time_s,alpha_deg\n0,1\n0.1,2\n0.2,3\n"));
    assert_eq!(read(&file, Vec::new()).time, [0.0, 0.1, 0.2]);
    // What it is unpacked to counts.
    let bomb = [&b"time_s,alpha_deg\n"[..], &b"0.123456,1.123456\n".repeat(2_000_000)].concat();
    let file = Temporary::new("bomb.csv.gz", &packed(&bomb));
    let options = ReadOptions::default().with_max_memory(Memory::from_bytes(10_000_000));
    let error = read_path(&file.0, &options).unwrap_err().to_string();
    assert!(error.contains("the budget is 10 MB"), "{error}");
    let file = Temporary::new("log.gz", &packed(b"ULog\x01\x12\x35"));
    let error = read_path(&file.0, &ReadOptions::default()).unwrap_err().to_string();
    let unpack = format!("unpack it first: gunzip {}", file.0.display());
    assert!(error.contains("this is a PX4 log (ULog), compressed by gzip") && error.ends_with(&unpack), "{error}");
    let file = Temporary::new("twice.gz", &packed(&packed(b"time_s,alpha_deg\n0,1\n")));
    let error = read_path(&file.0, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("compressed by gzip twice. Unpack it once: gunzip"), "{error}");
}

/// What is no row takes no memory, and still it is bounded.
#[test]
#[cfg(feature = "gzip")]
fn blank_lines_are_not_unpacked_without_end() {
    let options = ReadOptions::default().with_max_memory(Memory::from_bytes(1_000_000));
    let rows = b"0.123456,1.123456\n0.223456,1.123456\n0.323456,1.123456\n";
    for filling in ["\n", "# a comment\n"] {
        let bomb = [b"time_s,alpha_deg\n", &rows[..], filling.repeat(3_000_000 / filling.len()).as_bytes()].concat();
        let file = Temporary::new("blank.csv.gz", &packed(&bomb));
        let error = read_path(&file.0, &options).unwrap_err().to_string();
        assert!(error.contains("it was unpacked to 1 MB") && error.contains("the budget is 1 MB"), "{error}");
        assert!(error.contains("--max-memory") && error.contains("up to line "), "{error}");
    }
    // Rows may be longer than what is kept of them.
    let row = |number: usize| format!("{number},{:60},{:60}\n", 0.5, "no number");
    let text: String = (0..8000).map(row).collect();
    assert!(text.len() > 1_000_000);
    let file = Temporary::new("long.csv.gz", &packed(format!("time_s,alpha_deg,note\n{text}").as_bytes()));
    assert_eq!(read_path(&file.0, &options).unwrap().time.len(), 8000);
}

#[test]
#[cfg(feature = "gzip")]
fn a_damaged_compressed_table_gives_the_rows_before_a_cut_or_advice() {
    let text: String =
        (0..20_000).map(|row| format!("{:.2},{:.9}\n", 0.01 * f64::from(row), f64::from(row).sin())).collect();
    let whole = packed(format!("time_s,alpha_deg\n{text}").as_bytes());
    let file = Temporary::new("cut.csv.gz", &whole[..whole.len() / 2]);
    let record = read_path(&file.0, &ReadOptions::default()).unwrap();
    assert!((8000..12_000).contains(&record.time.len()), "{}", record.time.len());
    // The row in which it ends may be whole.
    let rows = record.quality.rows_read;
    let told = record.quality.to_string();
    let places =
        [format!("line {}: the compressed file is cut off here", rows + 1), format!("line {}: the compr", rows + 2)];
    assert!(places.iter().any(|place| told.contains(place)), "{rows} rows: {told}");
    for length in [2, 12] {
        let file = Temporary::new("cut.csv.gz", &whole[..length]);
        let error = read_path(&file.0, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("cut off before anything could be unpacked: copy it again"), "{error}");
    }
    // The checksum stands in the last eight bytes.
    let mut wrong = whole.clone();
    let end = wrong.len();
    wrong[end - 8] ^= 1;
    let file = Temporary::new("crc.csv.gz", &wrong);
    let error = read_path(&file.0, &ReadOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("are damaged, found at line 20002 of the text") && error.contains("copy it again"),
        "{error}"
    );
}

/// Rates and the attitude at the end, as pyulog and pymavlink give them for the same files.
#[test]
fn real_logs() {
    let Some(path) = shared_data::shared_file("logs/sample_log_small.ulg") else { return };
    let record = read_path(&path, &ReadOptions::default()).unwrap();
    assert_eq!(record.time.len(), 1812);
    assert!(record.quality.to_string().contains("theta, phi, psi: 1298 samples"), "{}", record.quality);
    let Some(path) = shared_data::shared_file("logs/log171.bin") else { return };
    let record = read_path(&path, &ReadOptions::default()).unwrap();
    assert_eq!(record.time.len(), 11916);
    let theta = record.channel("theta").unwrap();
    assert_eq!(theta.values.iter().filter(|value| !value.is_nan()).count(), 2383);
}
