//! Units and signs that cannot be: every spoilt channel is named, once, and sound flights raise no doubt.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, not production code

use crate::shared_data;

use phugoid_flight_data::csv::{CsvOptions, read, read_path};
use phugoid_flight_data::plausibility::{Certainty, Doubt, check};
use phugoid_flight_data::record::{Channel, Record};
use shared_data::shared_file;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const G: f64 = 9.80665;
const SPEED: f64 = 100.0;

fn shared(file: &str) -> Option<Record> {
    Some(read_path(&shared_file(file)?, &CsvOptions::default()).unwrap_or_else(|error| panic!("{error}")))
}

/// A hundred seconds of path and attitude at 20 Hz that fit one another: pitching and rolling about a level turn.
fn flight(bank: f64) -> Record {
    flown(G * bank.tan() / SPEED, |t| {
        [0.06 / bank.cos() + 0.02 * (1.1 * t).sin(), 0.08 + 0.04 * (0.7 * t).sin(), bank + 0.1 * (0.5 * t).sin(), 0.0]
    })
}

/// Bank to bank, with a sideslip in step with the rate of roll, which turns the nose by 0.39 of what the pitch rate does.
fn bank_to_bank() -> Record {
    let (roll, frequency, sideslip) = (0.6, 1.5, 0.05);
    flown(0.0, |t| {
        let pitch = roll * sideslip / (4.0 * 0.39);
        let theta = 0.08 - pitch * (2.0 * frequency * t).sin();
        [0.06 + 0.002 * (1.1 * t).sin(), theta, roll * (frequency * t).sin(), -sideslip * (frequency * t).cos()]
    })
}

/// Records alpha, theta, phi and beta (rad) of a flight at [`SPEED`], and what rates and accelerations go with them;
/// `turn_rate` is that of the heading, rad/s.
fn flown(turn_rate: f64, state: impl Fn(f64) -> [f64; 4]) -> Record {
    let time: Vec<f64> = (0..2000).map(|k| 0.05 * f64::from(k)).collect();
    let speed = SPEED;
    let slope = |t: f64, i: usize| (state(t + 1e-4)[i] - state(t - 1e-4)[i]) / 2e-4;
    let names =
        ["true_airspeed", "alpha", "theta", "phi", "p", "q", "r", "ax", "az", "nz", "altitude", "elevator", "beta"];
    let mut columns = vec![Vec::new(); names.len()];
    let mut altitude = 3000.0;
    for &t in &time {
        let [alpha, theta, phi, beta] = state(t);
        let q = slope(t, 1) * phi.cos() + turn_rate * phi.sin() * theta.cos();
        let p = slope(t, 2) - turn_rate * theta.sin();
        let r = turn_rate * phi.cos() * theta.cos() - slope(t, 1) * phi.sin();
        let ax: f64 = 0.3;
        let across = G * (alpha.cos() * phi.cos() * theta.cos() + alpha.sin() * theta.sin());
        let nose = q - beta.tan() * (p * alpha.cos() + r * alpha.sin());
        let az = (speed * beta.cos() * (slope(t, 0) - nose) + ax * alpha.sin() - across) / alpha.cos();
        altitude += 0.05 * speed * (alpha.cos() * theta.sin() - alpha.sin() * phi.cos() * theta.cos());
        let values =
            [speed, alpha, theta, phi, p, q, r, ax, az, -az / G, altitude, -0.03 - 0.01 * (1.1 * t).sin(), beta];
        columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
    }
    let channel = |(name, values): (&str, Vec<f64>)| Channel {
        name: name.to_owned(),
        quantity: phugoid_flight_data::channels::by_name(name).unwrap().quantity,
        values,
    };
    Record { time, channels: names.into_iter().zip(columns).map(channel).collect(), ..Record::default() }
}

fn spoilt(record: &Record, name: &str, factor: f64) -> Vec<Doubt> {
    let mut record = record.clone();
    let channel = record.channels.iter_mut().find(|channel| channel.name == name).unwrap();
    channel.values.iter_mut().for_each(|value| *value *= factor);
    let doubts = check(&record);
    println!("{name} x {factor:.3}:");
    doubts.iter().for_each(|doubt| println!("    {:?} {doubt}", doubt.certainty));
    doubts
}

/// One finding, certain, that names the channel and says what to do.
#[track_caller]
fn certain(doubts: &[Doubt], name: &str, words: &[&str]) {
    let [doubt] = doubts else { panic!("not one finding: {doubts:#?}") };
    assert_eq!(doubt.certainty, Certainty::Certain);
    assert!(doubt.channels.iter().any(|channel| channel == name), "{doubt:?}");
    words.iter().for_each(|word| assert!(doubt.message.contains(word), "{word} not in {doubt}"));
}

#[test]
fn sound_flights_raise_no_doubt() {
    for bank in [0.0, 0.5, 1.0, 1.25] {
        let record = flight(bank);
        assert_eq!(check(&record), [], "bank {bank}");
        // Without the bank too: the path turns as the accelerometer says, up to bank where the wings are not level.
        let mut blind = record;
        blind.channels.retain(|channel| channel.name != "phi");
        assert!(!check(&blind).iter().any(|doubt| doubt.certainty == Certainty::Certain), "{:#?}", check(&blind));
    }
    for path in ["flight/hfb320.csv", "golden/calm_3211_p4.csv", "golden/gust_bias_outliers_damage_p5_6.csv"] {
        let Some(record) = shared(path) else { return };
        assert_eq!(check(&record), [], "{path}");
    }
}

fn spoil_each(record: &Record) {
    for name in ["alpha", "theta", "q", "phi", "p"] {
        certain(&spoilt(record, name, DEGREES), name, &["degrees read as radians", "deg"]);
    }
    for name in ["theta", "q", "phi", "p"] {
        certain(&spoilt(record, name, -1.0), name, &["wrong sign", "scale -1"]);
        certain(&spoilt(record, name, 1.0 / DEGREES), name, &["taken for deg"]);
    }
    certain(&spoilt(record, "az", -1.0), "az", &["sign", "scale -1"]);
    certain(&spoilt(record, "az", 1.0 / G), "az", &["az_g"]);
    certain(&spoilt(record, "az", -1.0 / G), "az", &["nz"]);
    certain(&spoilt(record, "az", 1.0 / 0.3048), "az", &["az_ft_s2"]);
}

#[test]
fn every_spoilt_channel_of_a_computed_flight_is_named_once() {
    let record = flight(0.0);
    spoil_each(&record);
    certain(&spoilt(&record, "elevator", DEGREES), "elevator", &["degrees read as radians"]);
    certain(&spoilt(&record, "nz", -1.0), "nz", &["positive up"]);
    certain(&spoilt(&record, "nz", G), "nz", &["not g"]);
    for (name, factor) in [
        ("altitude", 1.0 / 0.3048),
        ("altitude", 0.3048),
        ("true_airspeed", 1.0 / 0.3048),
        ("true_airspeed", 1.0 / 0.5144),
    ] {
        let doubts = spoilt(&record, name, factor);
        assert!(doubts.iter().any(|doubt| doubt.channels.contains(&name.to_owned())), "{name}");
        assert!(doubts.iter().all(|doubt| doubt.certainty == Certainty::Doubtful));
    }
}

#[test]
fn every_spoilt_channel_of_a_real_flight_is_named_once() {
    let Some(record) = shared("flight/hfb320.csv") else { return };
    spoil_each(&record);
    // This elevator never moves by a degree: nothing that every aircraft shares tells its unit.
    assert_eq!(spoilt(&record, "elevator", DEGREES), []);
    // In ft/s the density seems a tenth: that of 20 km, where aircraft do fly.
    let doubts = spoilt(&record, "true_airspeed", 1.0 / 0.3048);
    assert!(doubts.len() == 1 && doubts[0].certainty == Certainty::Doubtful && doubts[0].message.contains("density"));
    certain(&spoilt(&record, "dynamic_pressure", 47.88), "dynamic_pressure", &["density"]);
}

/// The nose of an aircraft that rolls with sideslip goes up and down without any pitch rate: taken for a turn of the path, this
/// made the airspeed of a sound bank-to-bank flight doubtful.
#[test]
fn rolling_with_sideslip_is_no_wrong_airspeed() {
    let airspeed =
        |doubts: &[Doubt]| doubts.iter().any(|doubt| doubt.channels.iter().any(|name| name == "true_airspeed"));
    let mut record = bank_to_bank();
    assert!(!airspeed(&check(&record)), "{:?}", check(&record));
    // The check is asleep for nobody: a speed in knots read as m/s is found in the same flight.
    assert!(airspeed(&spoilt(&record, "true_airspeed", 1.0 / 0.514_444)));
    // Where the sideslip is not known, nothing is said of what depends on it: without values ...
    let without_values = |mut record: Record| {
        let beta = record.channels.iter_mut().find(|channel| channel.name == "beta").unwrap();
        beta.values.fill(f64::NAN);
        record
    };
    let empty = without_values(record.clone());
    assert!(!airspeed(&check(&empty)), "{:?}", check(&empty));
    // ... which does not put the check to sleep where the wings stay level;
    assert!(airspeed(&spoilt(&without_values(flight(0.0)), "true_airspeed", 1.0 / 0.514_444)));
    // ... and without the column.
    record.channels.retain(|channel| channel.name != "beta");
    assert!(!airspeed(&check(&record)), "{:?}", check(&record));
}

#[test]
fn gravity_that_was_taken_out_is_certain_only_in_a_whole_record() {
    let mut record = flight(0.0);
    record.channels.iter_mut().find(|c| c.name == "az").unwrap().values.iter_mut().for_each(|az| *az += G);
    certain(&check(&record), "az", &["gravity"]);
    // A record of deviations has nothing else to compare with.
    record.channels.retain(|channel| channel.name == "az" || channel.name == "elevator");
    let doubts = check(&record);
    assert_eq!((doubts.len(), doubts[0].certainty), (1, Certainty::Doubtful));
}

#[test]
fn an_ax_that_is_positive_aft_is_noticed() {
    let mut record = flight(0.0);
    assert_eq!(check(&record), []);
    let value = |name: &str, k: usize| record.channel(name).unwrap().values[k];
    // At a speed that stays, along the path: ax cos a + az sin a = g sin(theta - a).
    let along = |k: usize| {
        let [alpha, theta, az] = ["alpha", "theta", "az"].map(|name| value(name, k));
        (G * (theta - alpha).sin() - az * alpha.sin()) / alpha.cos()
    };
    let ax: Vec<f64> = (0..record.len()).map(along).collect();
    let place = record.channels.iter().position(|channel| channel.name == "ax").unwrap();
    record.channels[place].values.clone_from(&ax);
    assert_eq!(check(&record), []);
    record.channels[place].values = ax.iter().map(|ax| -ax).collect();
    let [doubt] = &check(&record)[..] else { panic!("{:#?}", check(&record)) };
    assert_eq!((doubt.channels.as_slice(), doubt.certainty), (["ax".to_owned()].as_slice(), Certainty::Doubtful));
    assert!(doubt.message.contains("wrong sign") && doubt.message.contains("scale -1"), "{doubt}");
    // An accelerometer with an ordinary bias.
    record.channels[place].values = ax.iter().map(|ax| ax + 0.2).collect();
    assert_eq!(check(&record), []);
}

#[test]
fn gusts_along_the_path_are_no_sign_of_ax() {
    // From a flight of another simulator in turbulence, in parts of two seconds: by how much the airspeed changes more than the
    // accelerations say, and ax. The medians of what is missing are 0.49 m/s^2, and 0.20 m/s^2 with the other sign of ax.
    let gusts = [-0.83, -0.49, 0.98, -0.62, 0.57, -0.13, -0.56, 0.01, -0.17, 0.2, 1.15, -0.24, -0.04, 0.01, -0.49];
    let ahead = [0.22, 0.22, 0.02, -0.04, 0.1, 0.02, 0.06, 0.145, 0.165, -0.1, -0.075, 0.05, 0.075, 0.035, 0.145];
    let mut record = flown(0.0, |t| [0.025 + 0.005 * (1.1 * t).sin(), 0.01 + 0.005 * (0.7 * t).sin(), 0.0, 0.0]);
    record.time.truncate(20 * 30);
    record.channels.iter_mut().for_each(|channel| channel.values.truncate(20 * 30));
    let value = |name: &str, k: usize| record.channel(name).unwrap().values[k];
    let [mut speed, mut ax] = [vec![SPEED], vec![ahead[0]]];
    for k in 1..record.time.len() {
        let part = (record.time[k] / 2.0) as usize;
        let [alpha, theta, az] = ["alpha", "theta", "az"].map(|name| value(name, k));
        let rate = (ahead[part] - G * theta.sin()) * alpha.cos() + (az + G * theta.cos()) * alpha.sin();
        speed.push(speed[k - 1] + 0.05 * (rate + gusts[part]));
        ax.push(ahead[part]);
    }
    for (name, values) in [("true_airspeed", speed), ("ax", ax)] {
        record.channels.iter_mut().find(|channel| channel.name == name).unwrap().values = values;
    }
    assert_eq!(check(&record), []);
}

#[test]
fn milliseconds_read_as_seconds_are_noticed() {
    for (factor, unit) in [(1e3, "time_ms"), (1e6, "time_us")] {
        let mut record = flight(0.0);
        record.time.iter_mut().for_each(|time| *time *= factor);
        // Between two samples theta moves less than this.
        let theta = record.channels.iter_mut().find(|channel| channel.name == "theta").unwrap();
        theta.values.iter_mut().step_by(2).for_each(|value| *value += 0.002);
        let doubts = check(&record);
        let found = doubts.iter().filter(|doubt| doubt.message.contains(unit)).collect::<Vec<_>>();
        assert!(!found.is_empty() && found.iter().all(|d| d.certainty == Certainty::Certain), "{doubts:#?}");
    }
}

/// Angles of attack below a third of a degree are real where the nose is level too, as in a lateral manoeuvre of an
/// aeroplane that is trimmed at zero; where the nose is as high as the same numbers in radians, they are radians.
#[test]
fn a_trim_at_zero_angle_of_attack_is_no_wrong_unit() {
    let doubted = |alpha: f64, theta: Option<f64>| {
        let mut text =
            String::from(if theta.is_some() { "time_s,alpha_deg,theta_deg\n" } else { "time_s,alpha_deg\n" });
        for k in 0..500 {
            let t = 0.02 * f64::from(k);
            text += &format!("{t},{}", alpha + 0.02 * (1.1 * t).sin());
            text += &theta.map_or(String::new(), |theta| format!(",{}", theta + 0.3 * (0.7 * t).sin()));
            text.push('\n');
        }
        let record = read(text.as_bytes(), "x", &CsvOptions::default()).unwrap();
        check(&record).iter().any(|doubt| doubt.channels.iter().any(|name| name == "alpha"))
    };
    assert!(!doubted(0.12, Some(-0.4)) && !doubted(-0.13, Some(0.1)) && !doubted(0.0, Some(0.0)));
    // 0.1 rad, 5.7 deg, taken for degrees: level, and in a climb.
    assert!(doubted(0.1, Some(5.7)) && doubted(0.1, Some(9.0)));
    // Nothing tells.
    assert!(doubted(0.1, None) && doubted(0.0, Some(2.0)));
}

/// An aircraft that stands for most of a record and then flies: which part is the flight, and no word of units.
#[test]
fn the_flight_in_a_record_of_an_aircraft_that_stands_is_named() {
    use phugoid_flight_data::plausibility::{self, Cause};
    let read = |speed: &dyn Fn(f64) -> f64| {
        // Airspeed once a second among faster channels, as autopilots log it.
        let rows: String = (0..600)
            .map(|row| {
                let t = 0.1 * f64::from(row);
                let speed = if row % 10 == 0 { format!("{:.2}", speed(t)) } else { String::new() };
                format!("{t:.1},{speed},{:.3}\n", 0.1 * t.sin())
            })
            .collect();
        let text = format!("time_s,tas_m_s,q_rad_s\n{rows}");
        phugoid_flight_data::csv::read(text.as_bytes(), "x", &phugoid_flight_data::csv::CsvOptions::default()).unwrap()
    };
    let flies =
        |from: f64, to: f64| move |t: f64| if (from..=to).contains(&t) { 20.0 + t.sin() } else { 1.5 + t.sin() };
    let of =
        |record: &Record| plausibility::check(record).into_iter().find(|doubt| doubt.channels == ["true_airspeed"]);
    let doubt = of(&read(&flies(50.0, 60.0))).unwrap();
    assert_eq!(doubt.cause, Cause::Standing, "{doubt}");
    assert!(doubt.message.contains("stands for 50 s of the 59.9 s"), "{doubt}");
    assert!(doubt.message.contains("--from 50s") && !doubt.message.contains("--to"), "{doubt}");
    assert!(!doubt.message.contains("unit"), "{doubt}");
    let doubt = of(&read(&flies(10.0, 25.0))).unwrap();
    assert!(doubt.message.contains("--from 10s --to 25s"), "{doubt}");
    // One that never flies, and one value that is wrong.
    for record in [read(&|t: f64| 1.5 + t.sin()), read(&flies(30.0, 30.0))] {
        let doubt = of(&record).unwrap();
        assert!(doubt.cause == Cause::Unit && doubt.message.contains("check its unit"), "{doubt}");
    }
}
