//! Every kind of bad file: what is mended is said, what is hopeless is refused with a place and a remedy.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use std::fmt::Write as _;
use std::io::Read;

use phugoid_flight_data::csv::{ColumnMapping, CsvOptions, ReadError, read};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::record::{Quantity, Record};

fn read_text(text: &str) -> Result<Record, ReadError> {
    read(text.as_bytes(), "flight.csv", &CsvOptions::default())
}

fn good(text: &str) -> Record {
    let record = read_text(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(record.channels.iter().all(|channel| channel.values.len() == record.time.len()));
    assert_eq!(record.quality.rows_kept, record.time.len());
    record
}

/// The error's text, checked to fit on a screen and to name the source.
fn refused(text: &str) -> String {
    let message = read_text(text).map(|record| record.quality.to_string()).unwrap_err().to_string();
    assert!(message.starts_with("flight.csv"), "{message}");
    assert!(message.len() < 1200, "{message}");
    message
}

fn values(record: &Record, name: &str) -> Vec<f64> {
    record.require(name).unwrap_or_else(|error| panic!("{error}")).values.clone()
}

/// The warnings and notes with `place: message`.
fn findings(record: &Record) -> Vec<String> {
    record.quality.findings.iter().map(|finding| format!("{}: {}", finding.place, finding.message)).collect()
}

#[track_caller]
fn says(record: &Record, parts: &[&str]) {
    let all = findings(record);
    assert!(all.iter().any(|finding| parts.iter().all(|part| finding.contains(part))), "{parts:?} not in {all:#?}");
}

#[track_caller]
fn silent(record: &Record) {
    assert_eq!(findings(record), [] as [String; 0]);
}

#[test]
fn a_good_file_needs_no_word() {
    let record = good("time_s,alpha_deg,tas_kt\n0,2,100\n0.1,3,101\n0.2,4,100.5\n");
    silent(&record);
    assert_eq!(record.time, [0.0, 0.1, 0.2]);
    assert!((values(&record, "alpha")[1] - 3_f64.to_radians()).abs() < 1e-15);
    assert!((values(&record, "true_airspeed")[0] - 51.444_444_444).abs() < 1e-8);
    assert_eq!(record.quality.rows_read, 3);
    assert!((record.quality.sample_time_s - 0.1).abs() < 1e-12);
}

#[test]
fn empty_files_and_bare_headers() {
    for text in ["", "\n\n", "\u{feff}", "# only a comment\n", "   \n\t\n"] {
        assert!(refused(text).contains("the file is empty"), "{text:?}");
    }
    for text in ["time_s,alpha_rad\n", "time_s,alpha_rad", "time_s,alpha_rad\ns,rad\n"] {
        let message = refused(text);
        assert!(message.contains("no usable row of data below the header in line 1: there is none"), "{message}");
    }
    assert!(refused("time_s,alpha_rad\n0,1\n").contains("only one time is left"));
}

#[test]
fn a_time_with_too_few_digits_for_any_step_is_named() {
    let mut text = String::from("time_s,alpha_rad\n");
    (0..40).for_each(|row| writeln!(text, "1796076000,{}", 0.01 * f64::from(row)).unwrap());
    let message = refused(&text);
    assert!(message.contains("all 40 rows have the same time, 1796076000 s in the column 'time_s'"), "{message}");
    assert!(message.contains("too few digits") && message.contains("--sample-time 0.02s"), "{message}");
}

#[test]
fn an_empty_name_at_the_end_of_a_header_is_named() {
    let message = refused("time_s,alpha_rad,\n0,1,5\n1,2,5\n2,3,5\n");
    let empty = "the last name of the header (line 1, column 3) is empty";
    assert!(message.contains(&format!("{empty}, and 3 rows have values there (lines 2, 3, 4)")), "{message}");
    let message = refused("# log\ntime_s,alpha_rad,,\n0,1,5,\n1,2,5,6\n");
    assert!(message.contains("the last 2 names of the header (line 2, columns 3 to 4) are empty"), "{message}");
    // Where some rows can be read it is said beside them.
    let record = good("time_s,alpha_rad,\n0,1,\n1,2,\n2,3,\n3,4,5\n");
    assert_eq!(record.time.len(), 3);
    says(&record, &["line 5: 1 row left out: more than the header's 2 cells", empty]);
}

#[test]
fn a_file_without_a_header_is_refused() {
    let message = refused("# log\n0.0,1.0,2.0\n0.1,1.0,2.0\n");
    assert!(message.contains("line 2: a header line"), "{message}");
    assert!(refused("12:30:00,1.0\n12:30:01,2.0\n").contains("line 1: a header line"));
    // A commented header counts if it fits.
    let record = good("# time_s, alpha_rad\n0.0,0.1\n0.1,0.2\n");
    assert_eq!(values(&record, "alpha"), [0.1, 0.2]);
    says(&record, &["line 1", "comment above the numbers is taken as the header"]);
}

#[test]
fn no_time_is_refused_and_the_nearest_named() {
    let message = refused("tme_s,alpha_rad\n0,1\n1,2\n");
    assert!(
        message.contains("line 1: no column is the time") && message.contains("'tme_s' looks like it"),
        "{message}"
    );
    // Two columns could be it.
    let message = refused("time (furlong),run time,alpha_rad\n0,0,1\n1,1,2\n");
    assert!(message.contains("'furlong' is no unit of time"), "{message}");
    let options = CsvOptions { sample_time_s: Some(0.02), ..CsvOptions::default() };
    let record = read("alpha_rad\n0.1\n0.2\n0.3\n".as_bytes(), "x", &options).unwrap();
    assert_eq!(record.time, [0.0, 0.02, 0.04]);
    // A given sample time stands in for a time with too few digits.
    let record = read("time_s,alpha_rad\n0.0,0.1\n0.0,0.2\n0.0,0.3\n".as_bytes(), "x", &options).unwrap();
    assert_eq!(record.time, [0.0, 0.02, 0.04]);
    says(&record, &["'time_s'", "left out: the sample time is given as 0.02 s"]);
}

#[test]
fn a_missing_unit_is_taken_as_si_and_said() {
    let record = good("time,alpha,tas\n0,0.1,100\n1,0.2,100\n");
    says(&record, &["column 'alpha'", "an angle but no unit is written; taken as rad (SI)", "alpha_rad", "deg"]);
    says(&record, &["column 'tas'", "taken as m/s (SI)"]);
    says(&record, &["column 'time'", "taken as s (SI)", "e.g. time_s or time_ms"]);
    says(&record, &["time: the rows are 1 s apart: if the time is in milliseconds"]);
    assert!(record.quality.channels.iter().all(|channel| channel.unit_assumed));
}

#[test]
fn times_of_a_recorder_without_a_unit_are_read_in_its_own() {
    for (start, step, unit, seconds) in [
        (0.0, 20.0, "ms", 1e-3),
        (5e6, 10_000.0, "us", 1e-6),
        (1.7e18, 2e7, "ns", 1e-9),
        // Milliseconds since 1970.
        (1.7e12, 40.0, "ms", 1e-3),
    ] {
        let mut text = String::from("timestamp,alpha_rad\n");
        (0..50).for_each(|row| writeln!(text, "{},0.1", start + step * f64::from(row)).unwrap());
        let record = good(&text);
        says(&record, &["column 'timestamp'", &format!("taken as {unit}"), &format!("time_{unit}")]);
        let found = (record.time[49] - record.time[0]) / 49.0;
        // A double since 1970 has steps of 0.24 us.
        assert!((found / (step * seconds) - 1.0).abs() < 1e-6, "{unit}: {found}");
    }
    // A unit that is written is not changed, and steps of seconds are steps of seconds.
    for header in ["time_s", "time [s]"] {
        let mut text = format!("{header},alpha_rad\n");
        (0..50).for_each(|row| writeln!(text, "{},0.1", 20 * row).unwrap());
        assert_eq!(good(&text).time[1], 20.0);
    }
    let mut text = String::from("time,alpha_rad\n");
    (0..50).for_each(|row| writeln!(text, "{row},0.1").unwrap());
    assert_eq!(good(&text).time[1], 1.0);
}

#[test]
fn the_east_component_of_a_velocity_is_no_equivalent_airspeed() {
    let record = good("time_s,vn_m_s,ve_m_s,vd_m_s\n0,1,40,0\n1,1,40,0\n");
    assert!(record.channel("equivalent_airspeed").is_none(), "{:?}", record.channels);
    let record = good("time_s,vn,ve,vd\n0,1,40,0\n1,1,40,0\n");
    assert!(record.channel("equivalent_airspeed").is_none(), "{:?}", record.channels);
    // Alone it is the airspeed of flight mechanics.
    let record = good("time_s,ve_kt,alpha_rad\n0,80,0.1\n1,80,0.1\n");
    assert!(record.channel("equivalent_airspeed").is_some());
}

#[test]
fn degrees_given_as_radians_are_noticed() {
    let mut text = String::from("time_s,alpha_rad,elevator_rad,theta_rad,q_rad_s\n");
    for row in 0..100 {
        let t = 0.1 * f64::from(row);
        let (theta, q) = (5.0 + 2.0 * t.sin(), (2.0 * t.cos()).to_radians());
        writeln!(text, "{t},{},{},{theta},{q}", 4.0 + t.sin(), -2.0 + t.cos()).unwrap();
    }
    let record = good(&text);
    says(&record, &["alpha: reaches", "degrees read as radians", "`alpha_deg`"]);
    says(&record, &["elevator: reaches", "degrees read as radians"]);
    // Its size and its rate say the same: one cause, one finding.
    says(&record, &["theta: theta changes 57.", "theta is probably in degrees"]);
    assert_eq!(findings(&record).iter().filter(|finding| finding.contains("theta")).count(), 1);
    // The other way round: only the comparison of attitude and rate can tell.
    let record = good(&text.replace("q_rad_s", "q_deg_s").replace("theta_rad", "theta_deg"));
    says(&record, &["theta and q", "q is in rad/s and taken for deg/s"]);
    let record = good("time_s,alpha_deg\n0,0.04\n1,0.05\n2,0.06\n");
    says(&record, &["alpha: stays below 0.06 deg", "radians taken for degrees"]);
    // And with the right units there is nothing to say about these two.
    let record = good(&text.replace("theta_rad", "theta_deg"));
    assert!(!findings(&record).iter().any(|finding| finding.contains("theta")));
}

#[test]
fn turned_signs_are_noticed() {
    let mut text = String::from("time_s,theta_rad,q_rad_s,az_m_s2,nz\n");
    for row in 0..100 {
        let t = 0.1 * f64::from(row);
        writeln!(text, "{t},{},{},9.7,-1.01", 0.05 * t.sin(), -0.05 * t.cos()).unwrap();
    }
    let record = good(&text);
    says(&record, &["theta and q", "wrong sign"]);
    says(&record, &["az: is 9.7 m/s^2", "scale -1"]);
    says(&record, &["nz: is -1.01", "positive up"]);
}

#[test]
fn speed_and_pressure_that_contradict_one_another_are_noticed() {
    let record = good("time_s,tas_m_s,qbar_pa\n0,347.9,4467\n1,347.9,4467\n2,347.8,4467\n");
    says(&record, &["imply an air density of 0.0738"]);
}

#[test]
fn misspelt_headers_get_a_suggestion() {
    let record = good("time_s,aplha_deg,elevtor_deg\n0,1,2\n1,2,3\n");
    says(&record, &["column 'aplha_deg'", "its name is like 'alpha'", "If it is alpha, write alpha_deg"]);
    says(&record, &["column 'elevtor_deg'", "[channels] elevator = { header = \"elevtor_deg\", unit = \"deg\" }"]);
    let error = record.require("alpha").unwrap_err().to_string();
    assert!(error.contains("there is no channel 'alpha' (did you mean 'aplha'?)"), "{error}");
    assert!(error.contains("'alpha_rad'") && error.contains("elevtor"), "{error}");
    // Names in other languages, units in a row of their own, and a misspelt unit.
    let record = good("Zeit [s];Höhenuder [°];Anstelwinkel [°]\n0;1,5;2\n1;1,6;3\n");
    says(&record, &["'Höhenuder [°]'", "like 'höhenruder' (elevator)", "header = \"Höhenuder [°]\", unit = \"deg\""]);
    says(&record, &["'Anstelwinkel [°]'", "like 'anstellwinkel' (alpha)", "write alpha_deg as its header"]);
    let of: Vec<&str> = record.misspelt().iter().map(|misspelt| misspelt.channel).collect();
    assert_eq!(of, ["elevator", "alpha"]);
    let record = good("Zeit;Höhenuder\n[s];[°]\n0;1,5\n1;1,6\n");
    says(&record, &["'Höhenuder'", "write elevator_deg as its header"]);
    assert_eq!(record.misspelt().len(), 1);
    says(&good("time_s,alpha_dg\n0,1\n1,2\n"), &["'alpha_dg'", "its name is like 'alpha'"]);
    // A column in another unit is no such channel, and what the record has from elsewhere is not missed.
    let record = good("time_s,Elevation [m],alpha_deg,alpha_dg\n0,1,1,1\n1,2,2,2\n");
    assert!(
        record.misspelt().is_empty() && !findings(&record).iter().any(|f| f.contains("known channel")),
        "{record:?}"
    );
    let options =
        CsvOptions { columns: vec![ColumnMapping::new("alpha", "vane").with_unit("deg")], ..CsvOptions::default() };
    let record = read("time_s,vane,aplha_deg\n0,1,1\n1,2,1\n".as_bytes(), "x", &options).unwrap();
    assert!(!findings(&record).iter().any(|f| f.contains("known channel")), "{:?}", findings(&record));
}

#[test]
fn a_recording_of_a_live_session_is_known() {
    let message =
        read(&b"PHGL\x20\0\0\0\x01\x02\x03\x04\x01\0"[..], "x", &CsvOptions::default()).unwrap_err().to_string();
    assert!(message.contains("not a text file but a recording of `phugoid live`"), "{message}");
    assert!(message.contains("phugoid live --replay FILE") && message.contains("phugoid view FILE"), "{message}");
    assert_eq!(good("PHGL,time_s\n1,0\n2,1\n").time, [0.0, 1.0]);
}

#[test]
fn a_known_channel_is_no_misspelling_of_another() {
    let record = good("time_s,beta_rad,q_deg_s,qdot_rad_s2,elevator_left_deg\n0,1,2,3,4\n1,2,3,4,5\n");
    for (name, similar) in [("theta", None), ("thrust", None), ("p", None), ("elevator", Some("elevator_left"))] {
        assert_eq!(record.similar_channel(name), similar, "{name}");
        assert_eq!(record.require(name).unwrap_err().alike.as_deref(), similar, "{name}");
    }
    assert_eq!(record.similar_channel("betta"), Some("beta"));
}

#[test]
fn a_misspelt_unit_is_offered_as_it_is_meant() {
    let record = good("time_s,q_deg_sce,tas_xy\n0,1,2\n1,2,3\n");
    let q = record.columns_for("q");
    assert!(q.iter().all(|column| !column.message.contains("rad_s")), "{q:?}");
    let record = good("time_s,alpha_dg\n0,1\n1,2\n");
    says(&record, &["write alpha_deg as its header", "[channels] alpha = { header = \"alpha_dg\", unit = \"deg\" }"]);
    // Degrees per second without a mark between them are read.
    let record = good("time_s,q_degps\n0,1\n1,2\n");
    assert_eq!(values(&record, "q")[0], 1_f64.to_radians());
}

#[test]
fn columns_that_could_be_a_lacking_channel_are_named_with_the_reason() {
    let record = good("time_s,airspeed_m_s,alpha_kt,eta\n0,80,1,2\n1,81,2,3\n");
    for (channel, parts) in [
        (
            "true_airspeed",
            &["could be true_airspeed or calibrated_airspeed or indicated_airspeed", "unit = \"m_s\" }"][..],
        ),
        ("calibrated_airspeed", &["[channels] calibrated_airspeed = { header = \"airspeed_m_s\""]),
        ("alpha", &["'kt' is a speed and no unit of an angle", "with the unit that it is in where that is not rad"]),
        ("elevator", &["can also mean something else"]),
    ] {
        let found = record.columns_for(channel);
        let [column] = found.as_slice() else { panic!("{channel}: {found:?}") };
        assert!(parts.iter().all(|part| column.message.contains(part)), "{column}");
    }
    // What is there is not looked for, and the misspelt ones are those of before.
    let record = good("time_s,tas_m_s,airspeed_m_s,aplha_deg\n0,80,80,1\n1,81,81,1\n");
    assert!(record.columns_for("true_airspeed").is_empty());
    assert_eq!(record.columns_for("alpha"), record.misspelt());
}

#[test]
fn ambiguous_headers_are_not_guessed() {
    let record = good("time_s,airspeed_kt,V_m_s\n0,200,1\n1,201,2\n");
    says(&record, &["'airspeed_kt'", "true_airspeed or calibrated_airspeed or indicated_airspeed", "not guessed"]);
    says(&record, &["'V_m_s'", "not guessed"]);
    assert!(record.channel("true_airspeed").is_none() && record.channel("v").is_none());
    // A bare namesake of a column that says its unit.
    let record = good("T,M,time_s,q_deg_s,Q\n300,0.6,0,1,5000\n301,0.6,1,2,5001\n");
    assert_eq!(record.time, [0.0, 1.0]);
    says(&record, &["'T'", "time or temperature or thrust; not guessed"]);
    says(&record, &["'M'", "mach or mass; not guessed"]);
    says(&record, &["'Q'", "q or dynamic_pressure; not guessed"]);
    // Beside u and w it is the lateral velocity.
    let record = good("time_s,u_m_s,v_m_s,w_m_s\n0,200,1,3\n1,201,2,3.5\n");
    assert_eq!(values(&record, "v"), [1.0, 2.0]);
}

/// The letters of LN 9300 for the surfaces, with a unit in brackets and in a row of units, and names of German flight tests.
#[test]
fn names_of_german_flight_tests() {
    let record = good("Zeit [s];η [°];ξ [°];ζ [°];Staudruck [hPa]\n0;1,5;0,5;-2,5;44,5\n1;2,5;0,5;-2,5;44,7\n");
    for (name, first) in [("elevator", 1.5_f64), ("aileron", 0.5), ("rudder", -2.5)] {
        assert_eq!(values(&record, name)[0], first.to_radians(), "{name}");
    }
    assert_eq!(values(&record, "dynamic_pressure"), [4450.0, 4470.0]);
    let record =
        good("Zeit;η;Querneigung;Wahre Eigengeschwindigkeit\n[s];[°];[°];[kt]\n0;1,5;3;100,5\n1;2,5;4;100,6\n");
    assert_eq!(values(&record, "elevator")[0], 1.5_f64.to_radians());
    assert_eq!(values(&record, "phi")[0], 3_f64.to_radians());
    assert!(record.channel("true_airspeed").is_some());
    // An efficiency has this letter too.
    let record = good("Zeit [s];η\n0;0,5\n1;0,6\n");
    says(&record, &["'η'", "could be elevator or something else", "without a unit"]);
    assert!(record.channel("elevator").is_none());
}

/// What an airspeed indicator shows is not silently a true airspeed.
#[test]
fn a_german_fahrt_is_not_guessed() {
    let record = good("Zeit [s];Fahrt [kt];Alpha [°]\n0;100,5;1\n1;101,5;2\n");
    says(&record, &["'Fahrt [kt]'", "indicated_airspeed or calibrated_airspeed or true_airspeed", "not guessed"]);
    assert!(record.channel("true_airspeed").is_none() && record.channel("indicated_airspeed").is_none());
    let record = good("Zeit [s];Fahrtmesser TAS [kt];Fahrtmesser [kt]\n0;100,5;90\n1;101,5;91\n");
    assert!(record.channel("true_airspeed").is_some() && record.channel("indicated_airspeed").is_some());
}

#[test]
fn a_unit_of_another_quantity_is_not_used() {
    let record = good("time_s,alpha_kt,q (vane)\n0,1,1\n1,2,2\n");
    says(&record, &["'alpha_kt'", "'kt' is a speed", "rad, deg"]);
    says(&record, &["'q (vane)'", "'vane' is no unit"]);
    assert!(record.channel("alpha").is_none() && record.channel("q").is_none());
}

#[test]
fn two_columns_for_one_channel_are_refused() {
    let message = refused("time_s,alpha_deg,aoa_rad\n0,1,2\n1,2,3\n");
    assert!(message.contains("columns 2 ('alpha_deg') and 3 ('aoa_rad') are both alpha"), "{message}");
    let message = refused("time_s,t_s,alpha_rad\n0,1,2\n1,2,3\n");
    assert!(message.contains("('time_s') and 2 ('t_s') are both time"), "{message}");
    // A mapping decides.
    let options = CsvOptions { columns: vec![ColumnMapping::new("alpha", "aoa_rad")], ..CsvOptions::default() };
    let record = read("time_s,alpha_deg,aoa_rad\n0,1,2\n1,2,3\n".as_bytes(), "x", &options).unwrap();
    assert_eq!(values(&record, "alpha"), [2.0, 3.0]);
    says(&record, &["'alpha_deg'", "left out: the mapping takes alpha"]);
}

#[test]
fn foreign_columns_of_one_name_are_kept_apart() {
    let record = good("time_s,x1,x1,x1_2,x1\n0,1,2,3,4\n1,2,3,4,5\n");
    let read: Vec<_> = record.channels.iter().map(|channel| (channel.name.as_str(), channel.values[0])).collect();
    assert_eq!(read, [("x1", 1.0), ("x1_2", 2.0), ("x1_2_2", 3.0), ("x1_3", 4.0)]);
    says(&record, &["kept as 'x1_2'"]);
}

#[test]
fn mappings_give_name_unit_and_sign() {
    let options = CsvOptions {
        columns: vec![
            ColumnMapping::new("time", "CLK").with_unit("ms"),
            ColumnMapping::new("elevator", "elev_pos_2").with_unit("deg").with_scale(-1.0),
            ColumnMapping::new("my_probe", "PRB [ft]"),
            ColumnMapping::new("alpha", "AOA_RAW"),
        ],
        ..CsvOptions::default()
    };
    let text = "CLK,ELEV_POS_2,PRB [ft],AOA_RAW\n0,2,10,0.1\n20,3,20,0.2\n";
    let record = read(text.as_bytes(), "x", &options).unwrap();
    assert_eq!(record.time, [0.0, 0.02]);
    assert!((values(&record, "elevator")[1] + 3_f64.to_radians()).abs() < 1e-15);
    let probe = record.channel("my_probe").unwrap();
    assert_eq!((probe.quantity, probe.values[0]), (Quantity::Length, 3.048));
    says(&record, &["multiplied by -1"]);
    says(&record, &["'AOA_RAW'", "no unit is written"]);
}

#[test]
fn wrong_mappings_are_refused() {
    let error = |mapping: ColumnMapping| {
        let options = CsvOptions { columns: vec![mapping], ..CsvOptions::default() };
        read("time_s,elev_deg\n0,1\n1,2\n".as_bytes(), "flight.csv", &options).unwrap_err().to_string()
    };
    let message = error(ColumnMapping::new("elevator", "elev_dg"));
    assert!(message.contains("no such column; did you mean 'elev_deg'?"), "{message}");
    assert!(message.contains("The columns are: time_s, elev_deg"), "{message}");
    assert!(error(ColumnMapping::new("elevater", "elev_deg")).contains("did you mean 'elevator'?"));
    assert!(error(ColumnMapping::new("pitch", "elev_deg")).contains("did you mean 'theta'?"));
    let message = error(ColumnMapping::new("elevator", "elev_deg").with_unit("kt"));
    assert!(message.contains("unit 'kt' is not understood for an angle; accepted are rad, deg"), "{message}");
    assert!(error(ColumnMapping::new("elevator", "elev_deg").with_scale(0.0)).contains("scale = 0"));
    assert!(error(ColumnMapping::new("elevator", "elev_deg").with_scale(f64::NAN)).contains("scale = NaN"));
}

#[test]
fn wrong_options_are_refused() {
    for (options, option) in [
        (CsvOptions { gap_factor: 0.5, ..CsvOptions::default() }, "gap_factor"),
        (CsvOptions { gap_factor: f64::NAN, ..CsvOptions::default() }, "gap_factor"),
        (CsvOptions { sample_time_s: Some(0.0), ..CsvOptions::default() }, "sample_time_s"),
        (CsvOptions { delimiter: Some('x'), ..CsvOptions::default() }, "delimiter"),
    ] {
        let error = read("time_s,a\n0,1\n1,2\n".as_bytes(), "x", &options).unwrap_err();
        assert!(error.to_string().contains(option), "{error}");
    }
}

#[test]
fn two_units_for_one_column_are_refused() {
    let message = refused("time_s,alpha_deg\ns,rad\n0,1\n1,2\n");
    assert!(message.contains("line 1, column 2 ('alpha_deg')"), "{message}");
    assert!(message.contains("as 'deg' and as 'rad'"), "{message}");
}

#[test]
fn a_row_of_units_below_the_header() {
    for units in ["s,deg,kt,-", "[s],[deg],[kts],[-]", "(s),(deg),(knots),()"] {
        let record = good(&format!("Time,Alpha,True Airspeed,flag\n{units}\n0,2,100,1\n0.1,3,101,0\n"));
        silent(&record);
        assert!((values(&record, "alpha")[0] - 2_f64.to_radians()).abs() < 1e-15);
        assert!((values(&record, "true_airspeed")[0] - 51.444_444_444).abs() < 1e-8);
    }
}

#[test]
fn missing_values_are_kept_missing_and_counted() {
    let mut text = String::from("time_s,alpha_rad,beta_rad,gamma_rad\n");
    for row in 0..100 {
        let alpha = match row {
            3 => "".into(),
            4 => "nan".into(),
            5 => "-inf".into(),
            6 => "ERR".into(),
            _ => format!("{}", 0.1 + 0.001 * f64::from(row)),
        };
        let beta = if row % 2 == 0 { "NaN".into() } else { format!("0.{row:03}") };
        writeln!(text, "{},{alpha},{beta},", f64::from(row) * 0.5).unwrap();
    }
    let record = good(&text);
    let alpha = values(&record, "alpha");
    assert!(alpha[3..7].iter().all(|value| value.is_nan()));
    assert_eq!(alpha.iter().filter(|value| value.is_nan()).count(), 4);
    says(&record, &["line 8: 1 cell of alpha no number, such as 'ERR'"]);
    says(&record, &["4 in alpha"]);
    says(&record, &["'beta_rad'", "50 of 100 values of beta missing (50 %)"]);
    says(&record, &["'gamma_rad'", "flight_path_angle has no value at all"]);
    let quality: Vec<_> = record.quality.channels.iter().map(|c| (c.name.as_str(), c.missing)).collect();
    assert_eq!(quality, [("time", 0), ("alpha", 4), ("beta", 50), ("flight_path_angle", 100)]);
}

/// Taken for angles, they are 174 rad.
#[test]
fn numbers_that_stand_for_no_value_are_missing() {
    let row = |k: usize| {
        let alpha = if k % 15 == 3 { -9999.0 } else { 2.0 + (0.3 * k as f64).sin() };
        format!("{:.2},{alpha},{}\n", 0.02 * k as f64, 100.0 + 0.1 * k as f64)
    };
    let text = format!("time_s,alpha_deg,tas_m_s\n{}", (0..60).map(row).collect::<String>());
    let record = good(&text);
    says(&record, &["column 'alpha_deg'", "4 cells of alpha hold -9999, far from all other values: taken as missing"]);
    assert_eq!(values(&record, "alpha").iter().filter(|v| v.is_nan()).count(), 4);
    assert!(values(&record, "true_airspeed").iter().all(|v| v.is_finite()));
}

#[test]
fn columns_of_text_are_left_out() {
    let record = good("time_s,mode,note,alpha_rad\n0,AUTO,,0.1\n1,MAN,,0.2\n");
    assert!(record.channel("mode").is_none() && record.channel("note").is_none());
    says(&record, &["'mode'", "holds text such as 'AUTO'"]);
    says(&record, &["'note'", "it has no values"]);
}

#[test]
fn rows_of_the_wrong_length_are_left_out() {
    let record = good("time_s,a1,b1\n0,1,2\n1,1\n2,1,2\n\n# pause\n3,1,2,3\n4,1,2,,\n5,1,2\n");
    assert_eq!(record.time, [0.0, 2.0, 4.0, 5.0]);
    assert_eq!(record.quality.rows_read, 6);
    says(&record, &["line 3: 1 row left out: fewer than the header's 3 cells"]);
    says(&record, &["line 7: 1 row left out: more than"]);
    says(&record, &["line 8: blank cells beyond"]);
}

#[test]
fn when_no_row_fits_the_reason_is_given() {
    let message = refused("time_s,a1\n0,1,0,5\n0,2,0,7\n");
    assert!(
        message.contains("2 rows with more than 2 cells (lines 2, 3; are there commas in the numbers?"),
        "{message}"
    );
    let message = refused("time_s,a1\nx,1\ny,2\n");
    assert!(message.contains("2 rows without a time (lines 2, 3)"), "{message}");
}

#[test]
fn a_file_cut_in_the_middle_of_a_row() {
    let record = good("time_s,a1,b1\n0,1,2\n1,1,2\n2,1");
    assert_eq!(record.time, [0.0, 1.0]);
    says(&record, &["line 4: the file ends in the middle of this row"]);
    // With all cells there it may still be cut in the last number.
    let record = good("time_s,a1,b1\n0,1,2\n1,1,2\n2,1,2");
    assert_eq!(record.time.len(), 3);
    says(&record, &["line 4: the last row has no line end"]);
    // A last number shorter than all others in its column was cut, and is no number: `2.` of 2.25 would be a quietly wrong one.
    let record = good("time_s,a1,b1\n0,1,2.25\n1,1,2.50\n2,1,2.");
    assert_eq!(values(&record, "a1"), [1.0, 1.0, 1.0]);
    assert!(values(&record, "b1")[2].is_nan());
    says(&record, &["line 4: the file ends without a line end after '2.'"]);
    assert_eq!(good("a1,time_s\n1,0.00\n1,0.10\n1,0.").time, [0.0, 0.1]);
    // With a line end it is a number like any other.
    assert_eq!(values(&good("time_s,a1\n0,2.25\n1,2.50\n2,2.\n"), "a1"), [2.25, 2.5, 2.0]);
    let message = refused("time_s,a1,b1\n0,1");
    assert!(message.contains("the only row, line 2, is cut off"), "{message}");
}

#[test]
fn time_that_is_missing_or_goes_back() {
    let record = good("time_s,a1\n0,1\n1,2\n,3\nnan,4\nx,5\n2,6\n1.5,7\n3,8\n");
    assert_eq!(record.time, [0.0, 1.0, 2.0, 3.0]);
    says(&record, &["lines 4, 5, 6: 3 rows left out: no time"]);
    says(&record, &["line 8: 1 row left out: the time jumps back"]);
}

#[test]
fn rows_of_equal_time_are_merged() {
    let record = good("time_s,a1,b1\n0,1,\n0,,5\n1,2,6\n1,3,6\n2,4,7\n");
    assert_eq!(record.time, [0.0, 1.0, 2.0]);
    assert_eq!(values(&record, "a1"), [1.0, 2.0, 4.0]);
    assert_eq!(values(&record, "b1"), [5.0, 6.0, 7.0]);
    says(&record, &["lines 3, 5: 2 rows with the time of the row before merged", "1 value missing there taken"]);
    says(&record, &["1 of the values differ and the first is kept"]);
}

#[test]
fn a_time_with_too_few_digits_is_said() {
    let mut text = String::from("time_s,a1\n");
    for row in 0..100 {
        writeln!(text, "{:.1},{row}", 0.01 * f64::from(row)).unwrap();
    }
    let record = good(&text);
    assert_eq!(record.time.len(), 100);
    assert!(record.time.windows(2).all(|pair| (pair[1] - pair[0] - 0.01).abs() < 3e-4), "{:?}", record.time);
    says(&record, &["time: written to 0.1 s alone", "evenly spaced, 0.01 s apart", "--sample-time 0.01s"]);
}

#[test]
fn a_clock_that_starts_again_does_not_join_two_records() {
    let mut text = String::from("time_s,a1\n");
    for (part, rows) in [(0, 30), (1, 20)] {
        for row in 0..rows {
            writeln!(text, "{},{part}", row).unwrap();
        }
    }
    let record = good(&text);
    assert_eq!(record.time.len(), 30);
    assert!(values(&record, "a1").iter().all(|&part| part == 0.0));
    says(&record, &["line 32: the time falls by 29 s", "started again"]);
    says(&record, &["lines 2 to 31: this longest of 2 parts is used, 20 rows outside it are left out"]);
}

#[test]
fn a_column_that_falls_is_no_time() {
    let mut text = String::from("t_s,a1\n");
    (0..9).for_each(|row| writeln!(text, "{},1", 100 - row).unwrap());
    let message = refused(&text);
    assert!(message.contains("column 't_s' does not work as the time: it rises in only 1 of 9 rows"), "{message}");
    assert!(message.contains("turn the order of the rows round"), "{message}");
    // Of the whole table, though every row seems to start the clock again.
    let falling: String = (0..60).map(|row| format!("{},1\n", 100 - row)).collect();
    assert!(refused(&format!("t_s,a1\n{falling}")).contains("rises in only 1 of 60 rows"));
}

#[test]
fn gaps_and_jitter_are_said() {
    let mut text = String::from("time_s,a1\n");
    let mut time = 0.0;
    for row in 0..200 {
        time += match row {
            50 => 1.5,
            100 => 0.04,
            r if r % 10 == 0 => 0.023,
            _ => 0.02,
        };
        writeln!(text, "{time:.3},{row}").unwrap();
    }
    let record = good(&text);
    assert!((record.quality.sample_time_s - 0.02).abs() < 1e-9);
    says(&record, &["gap of 1.5 s (75 sample times); nothing is filled in"]);
    says(&record, &["1 step longer than 1.5 sample times"]);
    says(&record, &["irregular: steps from 0.02 s to 0.023 s"]);
}

#[test]
fn many_gaps_are_summed_up() {
    let mut text = String::from("time_s,a1\n");
    for row in 0..200 {
        writeln!(text, "{},{row}", 0.1 * f64::from(row) + f64::from(row / 10)).unwrap();
    }
    let record = good(&text);
    assert_eq!(record.quality.findings.iter().filter(|f| f.message.starts_with("gap of")).count(), 10);
    says(&record, &["19 gaps in all"]);
}

#[test]
fn stuck_channels_and_spikes_are_said_and_kept() {
    let mut text = String::from("time_s,alpha_rad,beta_rad,q_rad_s\n");
    for row in 0..300 {
        let t = 0.02 * f64::from(row);
        let alpha = if row == 150 { 1.2 } else { 0.05 + 0.02 * (3.0 * t).sin() };
        let q = 0.1 * (3.0 * t.min(2.0).max(t - 2.0)).cos();
        writeln!(text, "{t},{alpha},0.01,{q}").unwrap();
    }
    let record = good(&text);
    assert_eq!(values(&record, "alpha")[150], 1.2);
    says(&record, &["alpha: 1 single value far outside the neighbouring values, the first at 3 s"]);
    says(&record, &["beta: is 0.01 rad throughout"]);
    says(&record, &["2 s to 4 s: q did not move in these 101 rows"]);
    assert_eq!(record.quality.channels.iter().find(|c| c.name == "alpha").unwrap().spikes, 1);
}

#[test]
fn times_in_other_units_and_clocks() {
    for (header, cells) in [
        ("flight time (s)", ["1", "1.02", "1.04"]),
        ("Zeit [ms]", ["1000", "1020", "1040"]),
        ("time_ms", ["1000", "1020", "1040"]),
        ("TimeUS", ["1000000", "1020000", "1040000"]),
        ("Time [min]", ["0.0166666666666666667", "0.017", "0.0173333333333333333"]),
    ] {
        let record = good(&format!("{header},a1\n{},1\n{},2\n{},3\n", cells[0], cells[1], cells[2]));
        for (time, expected) in record.time.iter().zip([1.0, 1.02, 1.04]) {
            assert!((time - expected).abs() < 1e-9, "{header}: {time}");
        }
        assert!(!findings(&record).iter().any(|finding| finding.contains("no unit is written")), "{header}");
    }
    // Clocks count from the first row, whatever the column is called.
    for (header, cells) in [
        ("time", ["12:00:01", "12:00:01.02", "12:00:01.04"]),
        ("Time (hh:mm:ss.00)", ["11:59:59.99 am", "12:00:00.01 pm", "12:00:00.03 PM"]),
        ("timestamp", ["1970-01-01T00:00:01Z", "1970-01-01T00:00:01.02Z", "1970-01-01 00:00:01.04"]),
        ("Date/Time", ["31.12.2023 23:59:59.99", "01.01.2024 00:00:00.01", "01.01.2024 00:00:00.03"]),
        ("Date/Time", ["12/31/2023 11:59:59.99 PM", "1/1/2024 12:00:00.01 AM", "1/1/2024 12:00:00.03 AM"]),
        ("Uhrzeit", ["23:59:59.99", "0:00:00.01", "0:00:00.03"]),
        ("mm:ss", ["59:59.99", "00:00.01", "00:00.03"]),
        ("IRIG", ["365:23:59:59.990", "001:00:00:00.010", "001:00:00:00.030"]),
    ] {
        let record = good(&format!("{header},a1\n{},1\n{},2\n{},3\n", cells[0], cells[1], cells[2]));
        for (time, expected) in record.time.iter().zip([0.0, 0.02, 0.04]) {
            assert!((time - expected).abs() < 1e-6, "{header}: {:?}", record.time);
        }
        says(&record, &["time: counts from the first row, which is at"]);
        assert!(!findings(&record).iter().any(|finding| finding.contains("no unit is")), "{header}");
    }
    let record = good("time,a1\n23:59:59,1\n00:00:00,2\n00:00:01,3\n");
    assert_eq!(record.time, [0.0, 1.0, 2.0]);
    says(&record, &["begins again 1 time;"]);
    says(&record, &["which is at 23:59:59.000000"]);
    // Seconds from 1970 in a number.
    let record = good("unix time,a1\n1714566896.5,1\n1714566897,2\n1714566897.5,3\n");
    assert_eq!(record.time, [0.0, 0.5, 1.0]);
}

#[test]
fn the_time_is_one_column_of_several() {
    // Date and time of day in columns of their own, and a clock beside a time in seconds.
    let record = good("Datum;Uhrzeit;a1\n01.05.2024;23:59:59,5;1\n02.05.2024;00:00:00,0;2\n02.05.2024;00:00:00,5;3\n");
    assert_eq!(record.time, [0.0, 0.5, 1.0]);
    says(&record, &["'Uhrzeit'", "taken as the time: it holds clock times"]);
    let record = good("UTC,time_s,a1\n10:00:00,5,1\n10:00:01,6,2\n10:00:02,7,3\n");
    assert_eq!(record.time, [5.0, 6.0, 7.0]);
}

#[test]
fn a_table_without_a_header_is_named_by_its_reader() {
    let column_names = ["time_s", "alpha_deg", "q_deg_s"].map(str::to_owned).to_vec();
    let options = CsvOptions { column_names, ..CsvOptions::default() };
    let named = |text: &str| read(text.as_bytes(), "x", &options);
    let record = named("0 1 2\n0.1 1 3\n0.2 1 4\n").unwrap();
    assert_eq!((record.time.len(), values(&record, "q")[2]), (3, 4_f64.to_radians()));
    let record = named("T,A,Q\n0,1,2\n0.1,1,3\n0.2,1,4\n").unwrap();
    assert_eq!(record.time.len(), 3);
    says(&record, &["line 1", "the names in the file are replaced"]);
    let message = named("0 1\n0.1 1\n").unwrap_err().to_string();
    assert!(message.contains("3 names of columns were given, and this row has 2 cells"), "{message}");
    let message = refused("0 1\n0.1 1\n");
    assert!(message.contains("--columns"), "{message}");
}

#[test]
fn what_follows_from_other_channels_is_made_of_them() {
    let record =
        good("time_s,nz,nx,pressure_altitude_ft,α [°],δe [°],q̄ [Pa]\n0,1,0.1,1000,2,-1,500\n1,,0.1,1000,2,-1,500\n");
    assert!((values(&record, "az")[0] + 9.80665).abs() < 1e-12 && values(&record, "az")[1].is_nan());
    assert!((values(&record, "ax")[0] - 0.980665).abs() < 1e-12);
    assert!((values(&record, "altitude")[0] - 304.8).abs() < 1e-9);
    says(&record, &["channel az", "not recorded; taken as -9.80665 m/s2 times nz"]);
    for (name, value) in [("alpha", 2.0), ("elevator", -1.0)] {
        assert_eq!(values(&record, name)[0], f64::to_radians(value));
    }
    assert_eq!(values(&record, "dynamic_pressure")[0], 500.0);
    let record = good("time_s,nz,az_m_s2\n0,1,-9\n1,1,-9\n");
    assert_eq!(values(&record, "az")[0], -9.0);
}

#[test]
fn layouts_of_other_tools() {
    let expected = good("time_s,alpha_deg\n0.5,1.5\n1.0,2.5\n2.0,3.5\n");
    for text in [
        "\u{feff}time_s,alpha_deg\r\n0.5,1.5\r\n1.0,2.5\r\n2.0,3.5\r\n",
        "time_s;alpha_deg\n0,5;1,5\n1,0;2,5\n2,0;3,5\n",
        "sep=;\ntime_s;alpha_deg\n0,5;1,5\n1,0;2,5\n2,0;3,5\n",
        "time_s\talpha_deg\n0.5\t1.5\n1.0\t2.5\n2.0\t3.5\n",
        "time_s|alpha_deg\n0.5|1.5\n1.0|2.5\n2.0|3.5\n",
        "  time_s   alpha_deg\n  0.5  1.5\n  1.0  2.5\n 2.0  3.5\n",
        "\"time_s\",\"Alpha, deg\"\n\"0.5\",\"1.5\"\n1.0,2.5\n2.0,3.5\n",
        "\"time_s\",\"alpha_deg\"\n\"0,5\",\"1,5\"\n\"1,0\",\"2,5\"\n\"2,0\",\"3,5\"\n",
        "# made by hand\n\ntime_s,alpha_deg\n# units: s, deg\n0.5,1.5\n\n1.0,2.5\n2.0,3.5\n",
        "time_s,alpha_deg\r0.5,1.5\r1.0,2.5\r2.0,3.5\r",
        "time_s,alpha_deg,\n0.5,1.5,\n1.0,2.5,\n2.0,3.5,\n",
        "alpha_deg , time_s\n1.5 , 0.5\n2.5 , 1.0\n3.5 , 2.0\n",
        "time_s,alpha_deg\n5.0E-01,1.5D0\n+1.0,2.5\n2.,3.5\n",
    ] {
        let record = good(text);
        assert_eq!((&record.time, &record.channels), (&expected.time, &expected.channels), "{text}");
    }
    let latin1 = [&b"time_s,alpha [\xB0]\n0.5,1.5\n1.0,2.5\n2.0,3.5\n"[..]].concat();
    let record = read(latin1.as_slice(), "x", &CsvOptions::default()).unwrap();
    assert_eq!(record.channels, expected.channels);
}

/// What a point or a comma is follows from what the file shows, and never makes another number of one.
#[test]
fn marks_of_thousands_are_no_decimal_marks() {
    let table = |cells: &dyn Fn(i32) -> [String; 3]| {
        let rows: String = (0..40).map(|k| cells(k).join(";") + "\n").collect();
        read_text(&format!("Zeit [s];TAS [kt];Alt [ft]\n{rows}"))
    };
    let comma = |value: f64, decimals: usize| format!("{value:.decimals$}").replace('.', ",");
    let time = |k: i32| comma(0.02 * f64::from(k), 2);
    let altitudes = |record: &Record| -> Vec<f64> {
        values(record, "altitude").iter().map(|metres| (metres / 0.3048 * 1e6).round() / 1e6).collect()
    };
    let feet = |k: i32| 5003 + k;
    let expected: Vec<f64> = (0..40).map(|k| f64::from(feet(k))).collect();
    for mark in [".", " ", "'", "\u{a0}", "\u{202f}"] {
        let record = table(&|k| [time(k), "119,84".into(), format!("5{mark}{:03}", feet(k) - 5000)]).unwrap();
        assert_eq!(altitudes(&record), expected, "{mark:?}");
    }
    let record = table(&|k| [time(k), "119,84".into(), format!("5.{:03},25", feet(k) - 5000)]).unwrap();
    assert_eq!(altitudes(&record)[0], 5003.25);
    // The other way round, in a file with decimal points.
    let record =
        table(&|k| [format!("{:.2}", 0.02 * f64::from(k)), "119.84".into(), format!("5,{:03}", feet(k) - 5000)]);
    assert_eq!(altitudes(&record.unwrap()), expected);
    // Each column by its own marks, where it has some of its own.
    let record = table(&|k| [time(k), format!("119.{k}4"), "5003,25".into()]).unwrap();
    assert!((values(&record, "true_airspeed")[0] - 119.04 * 1852.0 / 3600.0).abs() < 1e-9);
    assert_eq!(altitudes(&record)[0], 5003.25);
    // A third column of such a file is in doubt: named, and no number.
    let record = table(&|k| [time(k), format!("119.{k}4"), "5.003".into()]).unwrap();
    assert!(altitudes(&record).iter().all(|value| value.is_nan()));
    says(&record, &["column 'Alt [ft]': '5.003' is a number with decimals or with marks of thousands"]);
    // Nothing says that it is no decimal point.
    let record = table(&|k| [k.to_string(), "119".into(), "5.003".into()]).unwrap();
    assert_eq!(altitudes(&record)[0], 5.003);
    // What was read as thousands is contradicted further on, behind what the layout is found from.
    let rows: String = (0..6000)
        .map(|k| format!("{};{}\n", comma(0.02 * f64::from(k), 2), if k < 5990 { "5.003" } else { "5.1" }))
        .collect();
    let error = refused(&format!("time_s;altitude_ft\n{rows}"));
    assert!(
        error.contains("column 'altitude_ft': '5.003' is a thousand and more") && error.contains("'5.1'"),
        "{error}"
    );
    // The time is named with what stands there.
    let error = refused("time_s;altitude_ft\nfirst;1\nsecond;2\n");
    assert!(error.contains("'first' is none that is understood"), "{error}");
}

/// What Excel saves as "Unicode text".
#[test]
fn text_in_utf_16_is_read() {
    let text = "Zeit [s]\tHöhenruder [°]\tα [°]\r\n0,00\t1,5\t2\r\n0,05\t\t3\r\n0,10\t2,5\t4\r\n";
    let units: Vec<u16> = std::iter::once(0xFEFF).chain(text.encode_utf16()).collect();
    let low: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let high: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    let expected = good(text);
    for bytes in [low, high] {
        let record = read(bytes.as_slice(), "flight.txt", &CsvOptions::default()).unwrap();
        assert_eq!(record.time, expected.time);
        assert_eq!(values(&record, "alpha"), values(&expected, "alpha"));
        assert_eq!(values(&record, "elevator")[2], 2.5_f64.to_radians());
        assert_eq!(findings(&record), findings(&expected));
    }
}

#[test]
fn line_numbers_are_those_of_an_editor() {
    let record = good("# one\r\n\r\ntime_s,a1\r\n# four\r\n0,1\r\n1\r\n\r\n2,2\r\n");
    says(&record, &["line 6: 1 row left out"]);
}

#[test]
fn an_unclosed_quote_costs_one_row() {
    let record = good("time_s,a1,b1\n0,1,2\n1,\"1,2\n2,1,2\n3,1,2\n");
    assert_eq!(record.time, [0.0, 2.0, 3.0]);
    says(&record, &["line 3: 1 row left out: fewer"]);
}

#[test]
fn other_file_types_are_named() {
    for (bytes, name) in [
        (&b"ULog\x01\x12\x35\x01"[..], "PX4 ULog"),
        (&b"\xA3\x95\x80\x80"[..], "ArduPilot DataFlash"),
        (&b"PK\x03\x04"[..], "zip"),
        (&b"abc,d\0ef\n"[..], "binary"),
    ] {
        let error = read(bytes, "flight.csv", &CsvOptions::default()).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}

#[test]
fn memory_is_bounded() {
    let options = CsvOptions { max_memory: Memory::from_bytes(950), ..CsvOptions::default() };
    let mut text = String::from("time_s,a1,b1\n");
    (0..11).for_each(|row| writeln!(text, "{row},1,2").unwrap());
    let error = read(text.as_bytes(), "flight.csv", &options).unwrap_err().to_string();
    assert!(
        error.contains("line 12: to read it more than 968 bytes of memory are needed, and the budget is 950 bytes"),
        "{error}"
    );
    // A file without line ends is not swallowed whole: this source would never end.
    let endless = std::io::repeat(b'x');
    let error = read(endless, "flight.csv", &CsvOptions::default()).unwrap_err().to_string();
    assert!(error.contains("longer than 1048576 bytes"), "{error}");
    let wide = format!("time_s{}\n", ",x".repeat(9999));
    assert!(refused(&wide).contains("the header has 10000 columns, more than the 5000"));
    // Nor do endless comments or bad rows pile up; they end with the source.
    let comments = std::io::repeat(b'\n').take(1 << 22);
    assert!(matches!(read(comments, "x", &CsvOptions::default()), Err(ReadError::Empty { .. })));
}

#[test]
fn a_file_that_cannot_be_opened() {
    let missing = std::path::Path::new("no/such/flight.csv");
    let error = phugoid_flight_data::csv::read_path(missing, &CsvOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("no/such/flight.csv: cannot be read: "), "{error}");
}

/// A reader that fails half way.
struct Broken(usize);

impl Read for Broken {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.0 == 0 {
            return Err(std::io::Error::other("the disk is gone"));
        }
        self.0 -= 1;
        let line = b"time_s,a1\n";
        let n = line.len().min(buffer.len());
        buffer[..n].copy_from_slice(&line[..n]);
        Ok(n)
    }
}

#[test]
fn a_reader_that_fails_is_an_error() {
    let error = read(Broken(1), "flight.csv", &CsvOptions::default()).unwrap_err().to_string();
    assert!(error.contains("the disk is gone"), "{error}");
}

#[test]
fn titles_above_a_table_are_left_out() {
    let text = "Flight 12;;;\nD-EXYZ, pilot A. B.;;;\n\nTime [s];Alpha [deg];q [deg/s];nz\n0,0;1,5;0,1;1\n0,1;1,6;0,2;1\n0,2;1,7;0,3;1\n";
    for text in [text.to_owned(), text.replace(";;;", "")] {
        let record = good(&text);
        assert_eq!(record.time, [0.0, 0.1, 0.2]);
        says(&record, &["lines 1 to 2", "not part of the table"]);
    }
    // Titles with fewer separators than the header, which have the same number of words.
    let table = "Datum;Uhrzeit;TAS [kt];Nickwinkel [°];q [°/s]\n";
    let rows: String = (0..4).map(|row| format!("12.06.2024;10:15:3{row},000;120,4{row};0,25{row};0,1\n")).collect();
    for titles in
        ["Flugversuch 17;;;\nDatum: 12.06.2024;;\n", "Flugversuch 17;;;\n", "Flug 17\nPilot: A;;\nMuster: C;\n"]
    {
        let record = good(&format!("{titles}{table}{rows}"));
        assert_eq!(values(&record, "theta")[1], 0.251_f64.to_radians(), "{titles}");
        says(&record, &["not part of the table"]);
    }
    // A short row that ends a table is none.
    assert_eq!(good("time_s,alpha_rad,q_rad_s\n0,1,2\n1,1,2\n2,1\n").time.len(), 2);
}
