//! A flight as PX4 logs it, after the description of the format in the documentation of PX4 ("ULog File Format").

use phugoid_flight_data::record::Record;

use crate::autopilot::{self, Ballast, Sample};
use crate::bytes::singles;

/// Topics that are estimated from: name, fields after the time, samples per second (the rate of the record where it is lower),
/// and microseconds by which they are stamped before the angular velocity of the same moment.
const TOPICS: &[(&str, &str, f64, u64)] = &[
    ("vehicle_acceleration", "float[3] xyz;", 1000.0, 300),
    ("vehicle_attitude", "float[4] q;", 25.0, 250),
    (
        "airspeed_validated",
        "float indicated_airspeed_m_s;float calibrated_airspeed_m_s;float true_airspeed_m_s;",
        25.0,
        700,
    ),
    ("airflow_aoa", "float aoa_rad;", 1000.0, 450),
    ("actuator_servos", "float[8] control;", 1000.0, 150),
    ("vehicle_air_data", "float baro_alt_meter;float rho;", 5.0, 900),
    ("actuator_motors", "float[12] control;", 10.0, 120),
    ("vehicle_angular_velocity", "float[3] xyz;", 1000.0, 0),
];

/// Topics that no estimation reads: name, numbers in it, samples per second.
const BALLAST: &[(&str, u16, f64)] = &[
    ("sensor_combined", 10, 200.0),
    ("vehicle_local_position", 38, 10.0),
    ("estimator_status", 70, 5.0),
    ("actuator_outputs", 17, 10.0),
    ("estimator_innovation_test_ratios", 34, 5.0),
    ("estimator_innovation_variances", 34, 5.0),
    ("estimator_innovations", 34, 5.0),
    ("manual_control_setpoint", 16, 5.0),
    ("battery_status", 27, 3.4),
    ("actuator_controls_0", 11, 10.0),
    ("vehicle_status_flags", 9, 2.0),
    ("input_rc", 16, 2.0),
    ("vehicle_imu", 12, 4.0),
    ("vehicle_gps_position", 24, 1.0),
    ("ekf_gps_drift", 4, 5.0),
    ("sensor_accel", 10, 2.0),
    ("sensor_mag", 9, 2.0),
    ("wind", 10, 2.0),
    ("cpuload", 2, 2.0),
];
/// Parameters of the autopilot in a log, beside those of the surfaces.
const PARAMETERS: u32 = 900;
/// The servo of the elevator, counted from 0.
const ELEVATOR: usize = 2;

/// The bytes of the log of a flight.
pub(crate) fn log(record: &Record) -> Vec<u8> {
    let mut ballast = Ballast::new();
    let mut log = b"ULog\x01\x12\x35\x01".to_vec();
    log.extend(31_400_000_u64.to_le_bytes());
    message(&mut log, b'B', &[0; 40]);
    for (name, fields, ..) in TOPICS {
        message(&mut log, b'F', format!("{name}:uint64_t timestamp;{fields}").as_bytes());
    }
    for (name, numbers, _) in BALLAST {
        message(&mut log, b'F', format!("{name}:uint64_t timestamp;float[{numbers}] value;").as_bytes());
    }
    keyed(&mut log, b'I', "char[3] sys_name", b"PX4");
    keyed(&mut log, b'P', &format!("int32_t CA_SV_CS{ELEVATOR}_TYPE"), &3_i32.to_le_bytes());
    for number in 0..PARAMETERS {
        keyed(&mut log, b'P', &format!("float OTHER_PARAM_{number}"), &ballast.number());
    }
    let names = TOPICS.iter().map(|(name, ..)| name).chain(BALLAST.iter().map(|(name, ..)| name));
    for (id, name) in (0_u16..).zip(names) {
        let mut subscription = vec![0];
        subscription.extend(id.to_le_bytes());
        subscription.extend(name.bytes());
        message(&mut log, b'A', &subscription);
    }
    for sample in Sample::all(record) {
        for (id, &(_, numbers, rate)) in (TOPICS.len() as u16..).zip(BALLAST) {
            for count in 0..sample.due(rate) {
                let mut data = head(id, sample.stamp() + 20 * count);
                (0..numbers).for_each(|_| data.extend(ballast.number()));
                message(&mut log, b'D', &data);
            }
        }
        for (id, &(name, _, rate, early_us)) in (0_u16..).zip(TOPICS) {
            if sample.due(rate) > 0 {
                let mut data = head(id, sample.stamp() - early_us);
                singles(&mut data, &values(&sample, name));
                message(&mut log, b'D', &data);
            }
        }
    }
    log
}

/// The numbers of a topic at a sample, in the order of its fields.
fn values(sample: &Sample<'_>, topic: &str) -> Vec<f64> {
    match topic {
        "vehicle_acceleration" => vec![sample.value("ax"), 0.0, sample.value("az")],
        "vehicle_angular_velocity" => vec![0.0, sample.value("q"), 0.0],
        "vehicle_attitude" => {
            let half = sample.value("theta") / 2.0;
            vec![half.cos(), 0.0, half.sin(), 0.0]
        }
        "airspeed_validated" => {
            let airspeed = sample.value("true_airspeed");
            let equivalent = airspeed / autopilot::true_over_equivalent();
            vec![equivalent, equivalent, airspeed]
        }
        "airflow_aoa" => vec![sample.value("alpha")],
        "actuator_servos" => {
            let mut servos = vec![f64::NAN; 8];
            servos[ELEVATOR] = sample.elevator_command();
            servos
        }
        "vehicle_air_data" => vec![sample.value("altitude"), autopilot::AIR_DENSITY],
        _ => {
            let mut motors = vec![f64::NAN; 12];
            motors[0] = sample.value("throttle");
            motors
        }
    }
}

/// The beginning of a message with data.
fn head(id: u16, stamp: u64) -> Vec<u8> {
    let mut data = id.to_le_bytes().to_vec();
    data.extend(stamp.to_le_bytes());
    data
}

fn message(log: &mut Vec<u8>, kind: u8, content: &[u8]) {
    log.extend((content.len() as u16).to_le_bytes());
    log.push(kind);
    log.extend(content);
}

fn keyed(log: &mut Vec<u8>, kind: u8, key: &str, value: &[u8]) {
    let mut content = vec![key.len() as u8];
    content.extend(key.bytes());
    content.extend(value);
    message(log, kind, &content);
}
