//! Small logs as the autopilots write them, byte by byte after the formats' descriptions.
#![allow(dead_code)]

/// A ULog with two instances of `imu` (float[3] and a counter) at 100 Hz and `slow` at 10 Hz, `samples` of the first.
pub(crate) fn ulog(samples: u32) -> Vec<u8> {
    let mut log = ulog_head();
    for sample in 0..samples {
        let stamp = 5_000_000 + 10_000 * u64::from(sample);
        for id in 0..2_u16 {
            log.extend(ulog_imu(id, stamp, sample));
        }
        if sample % 10 == 0 {
            let mut slow = 2_u16.to_le_bytes().to_vec();
            slow.extend((stamp + 1).to_le_bytes());
            slow.extend((0.5 * f64::from(sample)).to_le_bytes());
            log.extend(ulog_message(b'D', &slow));
        }
    }
    log
}

pub(crate) fn ulog_head() -> Vec<u8> {
    let mut log = b"ULog\x01\x12\x35\x01".to_vec();
    log.extend(5_000_000_u64.to_le_bytes());
    log.extend(ulog_message(b'B', &[0; 40]));
    log.extend(ulog_message(b'F', b"imu:uint64_t timestamp;float[3] gyro;uint32_t count;uint8_t[4] _padding0;"));
    log.extend(ulog_message(b'F', b"slow:uint64_t timestamp;double level;"));
    log.extend(ulog_key(b'I', "char[3] sys_name", b"PX4"));
    log.extend(ulog_key(b'P', "float MASS", &1.25_f32.to_le_bytes()));
    for (instance, id, name) in [(0_u8, 0_u16, "imu"), (1, 1, "imu"), (0, 2, "slow")] {
        let mut add = vec![instance];
        add.extend(id.to_le_bytes());
        add.extend(name.bytes());
        log.extend(ulog_message(b'A', &add));
    }
    log
}

pub(crate) fn ulog_imu(id: u16, stamp: u64, sample: u32) -> Vec<u8> {
    let mut imu = id.to_le_bytes().to_vec();
    imu.extend(stamp.to_le_bytes());
    (0..3_u8).for_each(|axis| imu.extend((sample as f32 + f32::from(axis)).to_le_bytes()));
    imu.extend(sample.to_le_bytes());
    // A writer may leave the padding at the end out, or not.
    if id == 1 {
        imu.extend([0; 4]);
    }
    ulog_message(b'D', &imu)
}

pub(crate) fn ulog_message(kind: u8, payload: &[u8]) -> Vec<u8> {
    let mut message = (payload.len() as u16).to_le_bytes().to_vec();
    message.push(kind);
    message.extend(payload);
    message
}

pub(crate) fn ulog_key(kind: u8, key: &str, value: &[u8]) -> Vec<u8> {
    let mut payload = vec![key.len() as u8];
    payload.extend(key.bytes());
    payload.extend(value);
    ulog_message(kind, &payload)
}

/// A DataFlash log with three instances of `IMU`, with units, a multiplier, a parameter and a text.
pub(crate) fn dataflash(samples: u32) -> Vec<u8> {
    let mut log = dataflash_head();
    for sample in 0..samples {
        log.extend(dataflash_imu(2_000_000 + 2500 * u64::from(sample), (sample % 3) as u8, sample as f32));
    }
    log
}

pub(crate) fn dataflash_head() -> Vec<u8> {
    let mut log = dataflash_define(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
    log.extend(dataflash_define(177, 3 + 8 + 1 + 64, "UNIT", "QbZ", "TimeUS,Id,Label"));
    log.extend(dataflash_define(178, 3 + 8 + 1 + 8, "MULT", "Qbd", "TimeUS,Id,Mult"));
    log.extend(dataflash_define(179, 3 + 8 + 1 + 32, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"));
    log.extend(dataflash_define(180, 3 + 8 + 16 + 4, "PARM", "QNf", "TimeUS,Name,Value"));
    log.extend(dataflash_define(181, 3 + 8 + 64, "MSG", "QZ", "TimeUS,Message"));
    log.extend(dataflash_define(182, 3 + 8 + 1 + 4 + 2, "IMU", "QBfh", "TimeUS,I,GyrX,Temp"));
    for (id, label) in [(b'E', "rad/s"), (b'#', "instance"), (b'O', "degC"), (b's', "s")] {
        let mut unit = 2_000_000_u64.to_le_bytes().to_vec();
        unit.push(id);
        unit.extend(padded(label, 64));
        log.extend(dataflash_message(177, &unit));
    }
    for (id, factor) in [(b'B', 0.01), (b'0', 1.0), (b'-', 0.0), (b'F', 1e-6)] {
        let mut multiplier = 2_000_000_u64.to_le_bytes().to_vec();
        multiplier.push(id);
        multiplier.extend(f64::to_le_bytes(factor));
        log.extend(dataflash_message(178, &multiplier));
    }
    log.extend(dataflash_units(182, "s#EO", "F-0B"));
    let mut parameter = 2_000_000_u64.to_le_bytes().to_vec();
    parameter.extend(padded("SERVO2_FUNCTION", 16));
    parameter.extend(19_f32.to_le_bytes());
    log.extend(dataflash_message(180, &parameter));
    let mut text = 2_000_000_u64.to_le_bytes().to_vec();
    text.extend(padded("ArduPlane V4.5.0", 64));
    log.extend(dataflash_message(181, &text));
    log
}

pub(crate) fn dataflash_imu(stamp: u64, instance: u8, rate: f32) -> Vec<u8> {
    let mut imu = stamp.to_le_bytes().to_vec();
    imu.push(instance);
    imu.extend(rate.to_le_bytes());
    imu.extend(2512_i16.to_le_bytes());
    dataflash_message(182, &imu)
}

pub(crate) fn dataflash_units(kind: u8, units: &str, multipliers: &str) -> Vec<u8> {
    let mut payload = 2_000_000_u64.to_le_bytes().to_vec();
    payload.push(kind);
    payload.extend(padded(units, 16));
    payload.extend(padded(multipliers, 16));
    dataflash_message(179, &payload)
}

pub(crate) fn dataflash_define(kind: u8, length: u8, name: &str, letters: &str, columns: &str) -> Vec<u8> {
    let mut payload = vec![kind, length];
    payload.extend(padded(name, 4));
    payload.extend(padded(letters, 16));
    payload.extend(padded(columns, 64));
    dataflash_message(128, &payload)
}

pub(crate) fn dataflash_message(kind: u8, payload: &[u8]) -> Vec<u8> {
    let mut message = vec![0xA3, 0x95, kind];
    message.extend(payload);
    message
}

fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(length, 0);
    bytes
}

/// When the first message of [`tlog`] came, us: 2023-11-14.
pub(crate) const TLOG_START_US: u64 = 1_700_000_000_000_000;

/// A telemetry log of an ArduPlane (system 1) and its ground station (system 255), `samples` of ATTITUDE 20 ms apart, which
/// come with an uneven delay.
pub(crate) fn tlog(samples: u32) -> Vec<u8> {
    let vehicle = (1, 1);
    let mut log = tlog_entry(TLOG_START_US, vehicle, "HEARTBEAT", &[("type", 1.0), ("autopilot", 3.0)], "");
    let mut at = TLOG_START_US;
    for sample in 0..samples {
        let t = 0.02 * f64::from(sample);
        let stamp = f64::from(5000 + 20 * sample);
        at = at.max(TLOG_START_US + 20_000 * u64::from(sample) + u64::from(sample * 7 % 31) * 1000);
        let mut add = |name: &str, numbers: &[(&str, f64)], text: &str| {
            log.extend(tlog_entry(at, vehicle, name, numbers, text));
        };
        add("ATTITUDE", &[("time_boot_ms", stamp), ("pitch", 0.05 * t.sin()), ("pitchspeed", 0.05 * t.cos())], "");
        for (name, value) in [("alpha", 0.07), ("my_vane", 2.0)] {
            add("NAMED_VALUE_FLOAT", &[("time_boot_ms", stamp), ("value", value)], name);
        }
        add("SERVO_OUTPUT_RAW", &[("time_usec", 1000.0 * stamp), ("servo2_raw", 1600.0)], "");
        add("VFR_HUD", &[("airspeed", 21.5), ("alt", 300.0)], "");
        if sample == 0 {
            add("PARAM_VALUE", &[("param_value", 19.0)], "SERVO2_FUNCTION");
            add("STATUSTEXT", &[("severity", 6.0)], "ArduPlane V4.5.0");
        }
        if sample % 10 == 0 {
            add("GLOBAL_POSITION_INT", &[("time_boot_ms", stamp), ("lat", 473_977_421.0)], "");
        }
        if sample % 5 == 0 {
            log.extend(tlog_entry(at, (255, 190), "HEARTBEAT", &[("type", 6.0), ("autopilot", 8.0)], ""));
        }
    }
    log
}

/// A message of a telemetry log: the time at which it came, us, and a frame of this system and component with these fields,
/// the others zero, and this text in its field of characters.
pub(crate) fn tlog_entry(
    came_us: u64,
    (system, component): (u8, u8),
    name: &str,
    numbers: &[(&str, f64)],
    text: &str,
) -> Vec<u8> {
    use phugoid_flight_data::mavlink::definitions::{self, Kind};

    let message = definitions::by_name(name).unwrap();
    let mut payload = vec![0; message.length()];
    for (field, value) in numbers {
        let field = message.field(field).unwrap();
        let bytes = match field.kind {
            Kind::Float => (*value as f32).to_le_bytes().to_vec(),
            _ => (*value as i64).to_le_bytes()[..field.kind.size()].to_vec(),
        };
        payload[field.offset..field.offset + bytes.len()].copy_from_slice(&bytes);
    }
    if let Some(field) = message.fields.iter().find(|field| field.kind == Kind::Character) {
        payload[field.offset..field.offset + text.len()].copy_from_slice(text.as_bytes());
    }
    let frame = phugoid_flight_data::mavlink::frame::encode(message.id, 0, system, component, &payload).unwrap();
    [&came_us.to_be_bytes()[..], &frame].concat()
}
