//! A flight as ArduPilot logs it: messages that name their own format first (`FMT`), after the documentation of ArduPilot.

use phugoid_flight_data::record::Record;

use crate::autopilot::{self, Ballast, Sample};
use crate::bytes::{padded, singles};

/// A kind of message: name, letters of its fields without the time, their names, samples per second.
type Kind = (&'static str, &'static str, &'static str, f64);

/// Messages that are estimated from; a rate above that of the record is that of the record.
const MESSAGES: &[Kind] = &[
    ("IMU", "Bffffff", "I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", 1000.0),
    ("ATT", "fff", "Roll,Pitch,Yaw", 25.0),
    ("ARSP", "Bf", "I,Airspeed", 25.0),
    ("AOA", "ff", "AOA,SSA", 1000.0),
    ("CTUN", "ff", "ThO,E2T", 10.0),
    ("POS", "LLf", "Lat,Lng,Alt", 10.0),
    ("RCOU", "HHHHHHHH", "C1,C2,C3,C4,C5,C6,C7,C8", 1000.0),
];
/// Messages that no estimation reads.
const BALLAST: &[Kind] = &[
    ("VIBE", "ffff", "X,Y,Z,C", 50.0),
    ("XKF1", "ffffffffffff", "A,B,C,D,E,F,G,H,I,J,K,L", 10.0),
    ("XKF2", "fffffffffff", "A,B,C,D,E,F,G,H,I,J,K", 10.0),
    ("XKF3", "ffffffffff", "A,B,C,D,E,F,G,H,I,J", 10.0),
    ("XKF4", "ffffffffffff", "A,B,C,D,E,F,G,H,I,J,K,L", 10.0),
    ("RATE", "ffffffffffff", "A,B,C,D,E,F,G,H,I,J,K,L", 10.0),
    ("RCIN", "ffffff", "A,B,C,D,E,F", 10.0),
    ("NTUN", "fffffffff", "A,B,C,D,E,F,G,H,I", 10.0),
    ("MAG", "ffffffffff", "A,B,C,D,E,F,G,H,I,J", 10.0),
    ("BARO", "fff", "Alt,Press,Temp", 10.0),
    ("BAT", "ffffff", "A,B,C,D,E,F", 10.0),
    ("PIDP", "ffffffff", "A,B,C,D,E,F,G,H", 25.0),
    ("AHR2", "ffffff", "A,B,C,D,E,F", 10.0),
];
/// The number of the first kind of message after `FMT` and `PARM`.
const FIRST: u8 = 130;
/// Bytes of a message before its fields: two of its beginning and one of its kind.
const HEADER: usize = 3;
/// Parameters of the autopilot in a log, beside those of the servo.
const PARAMETERS: u32 = 1100;

/// The bytes of the log of a flight.
pub(crate) fn log(record: &Record) -> Vec<u8> {
    let mut ballast = Ballast::new();
    let mut log = Vec::new();
    define(&mut log, 128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
    define(&mut log, 129, "PARM", "QNf", "TimeUS,Name,Value");
    for (kind, (name, letters, fields, _)) in (FIRST..).zip(MESSAGES.iter().chain(BALLAST)) {
        define(&mut log, kind, name, &format!("Q{letters}"), &format!("TimeUS,{fields}"));
    }
    let servo = [("FUNCTION", 19.0), ("MIN", 1000.0), ("TRIM", 1500.0), ("MAX", 2000.0), ("REVERSED", 0.0)];
    let servo = servo.map(|(name, value)| (format!("SERVO2_{name}"), f32::to_le_bytes(value)));
    let others: Vec<_> = (0..PARAMETERS).map(|number| (format!("OTHER_{number}"), ballast.number())).collect();
    for (name, value) in servo.iter().chain(&others) {
        log.extend([0xA3, 0x95, 129]);
        log.extend(31_400_000_u64.to_le_bytes());
        padded(&mut log, name, 16);
        log.extend(value);
    }
    for sample in Sample::all(record) {
        for (kind, (_, letters, _, rate)) in (FIRST + MESSAGES.len() as u8..).zip(BALLAST) {
            for count in 0..sample.due(*rate) {
                begin(&mut log, kind, sample.stamp() + 20 * count);
                letters.chars().for_each(|_| log.extend(ballast.number()));
            }
        }
        for (kind, (name, .., rate)) in (FIRST..).zip(MESSAGES) {
            if sample.due(*rate) > 0 {
                begin(&mut log, kind, sample.stamp());
                fields(&mut log, &sample, name);
            }
        }
    }
    log
}

/// The fields of a message at a sample, after the time.
fn fields(log: &mut Vec<u8>, sample: &Sample<'_>, name: &str) {
    match name {
        "IMU" => {
            log.push(0);
            singles(log, &[0.0, sample.value("q"), 0.0, sample.value("ax"), 0.0, sample.value("az")]);
        }
        "ATT" => singles(log, &[0.0, sample.value("theta").to_degrees(), 0.0]),
        "ARSP" => {
            log.push(0);
            singles(log, &[sample.value("true_airspeed") / autopilot::true_over_equivalent()]);
        }
        "AOA" => singles(log, &[sample.value("alpha").to_degrees(), 0.0]),
        "CTUN" => singles(log, &[100.0 * sample.value("throttle"), autopilot::true_over_equivalent()]),
        "POS" => {
            log.extend([0; 8]);
            singles(log, &[sample.value("altitude")]);
        }
        _ => {
            // Pulses of whole microseconds, as they are put out.
            let elevator = (1500.0 + 500.0 * sample.elevator_command()).round() as u16;
            let pulses = [1500_u16, elevator, 1100, 1500, 1500, 1500, 1500, 1500];
            pulses.iter().for_each(|pulse| log.extend(pulse.to_le_bytes()));
        }
    }
}

fn begin(log: &mut Vec<u8>, kind: u8, stamp: u64) {
    log.extend([0xA3, 0x95, kind]);
    log.extend(stamp.to_le_bytes());
}

/// The message that says what messages of a kind consist of.
fn define(log: &mut Vec<u8>, kind: u8, name: &str, letters: &str, fields: &str) {
    let size = |letter: char| match letter {
        'B' => 1,
        'H' => 2,
        'f' | 'n' | 'L' => 4,
        'Q' => 8,
        'N' => 16,
        _ => 64,
    };
    let length = HEADER + letters.chars().map(size).sum::<usize>();
    log.extend([0xA3, 0x95, 128, kind, length as u8]);
    padded(log, name, 4);
    padded(log, letters, 16);
    padded(log, fields, 64);
}
