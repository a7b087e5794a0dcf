"""Writes fuzz/seeds: small files that the readers understand, so that a run of scripts/fuzz.sh begins within the formats.

    target/python/bin/python fuzz/make_seeds.py      (the environment of scripts/python-tools.sh: pymavlink)

Topics and messages are those that the built-in profiles map, so that records are made of them. What is in the folders of the
tests (crates/phugoid-flight-data/tests/data) is not written again.
"""

import io
import json
import math
import pathlib
import struct
import zlib

from pymavlink.dialects.v20 import ardupilotmega as mavlink

SEEDS = pathlib.Path(__file__).parent / "seeds"
SAMPLES = 8
START_US = 2_000_000
STEP_US = 10_000


def motion(sample):
    """Pitch, m/s and rad/s of a slow phugoid: any numbers that move will do."""
    return 0.05 * math.sin(0.3 * sample), 90.0 + 3.0 * math.cos(0.3 * sample), 0.015 * math.cos(0.3 * sample)


def ulog():
    """PX4: attitude, rates, accelerations, airspeed, servos."""

    def message(kind, payload):
        return struct.pack("<Hc", len(payload), kind) + payload

    def key(kind, name, value):
        return message(kind, bytes([len(name)]) + name.encode() + value)

    topics = [
        ("vehicle_attitude", "float[4] q;", lambda pitch, speed, rate: struct.pack("<4f", 1.0, 0.0, pitch / 2, 0.0)),
        ("vehicle_angular_velocity", "float[3] xyz;", lambda pitch, speed, rate: struct.pack("<3f", 0.0, rate, 0.0)),
        ("vehicle_acceleration", "float[3] xyz;", lambda pitch, speed, rate: struct.pack("<3f", 0.3, 0.0, -9.8)),
        ("airspeed_validated", "float true_airspeed_m_s;", lambda pitch, speed, rate: struct.pack("<f", speed)),
        ("actuator_servos", "float[8] control;", lambda pitch, speed, rate: struct.pack("<8f", *([pitch] * 8))),
    ]
    log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", START_US) + message(b"B", bytes(40))
    for name, fields, _ in topics:
        log += message(b"F", f"{name}:uint64_t timestamp;{fields}".encode())
    log += key(b"I", "char[3] sys_name", b"PX4") + key(b"P", "int32_t CA_AIRFRAME", struct.pack("<i", 1))
    log += key(b"P", "int32_t CA_SV_CS_COUNT", struct.pack("<i", 1)) + key(b"P", "int32_t CA_SV_CS0_TYPE", struct.pack("<i", 3))
    for number, (name, _, _) in enumerate(topics):
        log += message(b"A", struct.pack("<BH", 0, number) + name.encode())
    log += message(b"L", struct.pack("<cQ", b"6", START_US) + b"armed")
    for sample in range(SAMPLES):
        stamp = struct.pack("<Q", START_US + STEP_US * sample)
        for number, (_, _, pack) in enumerate(topics):
            log += message(b"D", struct.pack("<H", number) + stamp + pack(*motion(sample)))
    log += message(b"O", struct.pack("<H", 20)) + message(b"S", b"\x2f\x73\x13\x20\x25\x0c\xbb\x12")
    return log


def dataflash():
    """ArduPilot: formats, units, multipliers, parameters, attitude, IMU, airspeed, servos."""
    definitions = {
        128: ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
        177: ("UNIT", "QbZ", "TimeUS,Id,Label"),
        178: ("MULT", "Qbd", "TimeUS,Id,Mult"),
        179: ("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
        180: ("PARM", "QNf", "TimeUS,Name,Value"),
        181: ("MSG", "QZ", "TimeUS,Message"),
        182: ("IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"),
        183: ("ATT", "Qccc", "TimeUS,Roll,Pitch,Yaw"),
        184: ("ARSP", "QBf", "TimeUS,I,Airspeed"),
        185: ("RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4"),
        186: ("CTUN", "Qf", "TimeUS,E2T"),
    }
    codes = {"Q": "Q", "B": "B", "b": "b", "n": "4s", "N": "16s", "Z": "64s", "f": "f", "d": "d", "c": "h", "H": "H"}

    def message(kind, *values):
        letters = "<" + "".join(codes[letter] for letter in definitions[kind][1])
        return struct.pack("<BBB", 0xA3, 0x95, kind) + struct.pack(letters, *values)

    log = b""
    for kind, (name, letters, columns) in definitions.items():
        length = 3 + struct.calcsize("<" + "".join(codes[letter] for letter in letters))
        log += message(128, kind, length, name.encode(), letters.encode(), columns.encode())
    for unit, label in (("E", "rad/s"), ("o", "m/s/s"), ("#", "instance"), ("d", "deg"), ("n", "m/s"), ("Y", "us"), ("s", "s")):
        log += message(177, START_US, ord(unit), label.encode())
    for multiplier, factor in (("B", 0.01), ("0", 1.0), ("-", 0.0), ("F", 1e-6)):
        log += message(178, START_US, ord(multiplier), factor)
    for kind, units, multipliers in ((182, "s#EEEooo", "F-000000"), (183, "sddd", "FBBB"), (184, "s#n", "F-0"), (185, "sYYYY", "F----")):
        log += message(179, START_US, kind, units.encode(), multipliers.encode())
    for name, value in (("SERVO2_FUNCTION", 19), ("SERVO2_MIN", 1100), ("SERVO2_MAX", 1900), ("SERVO2_TRIM", 1500)):
        log += message(180, START_US, name.encode(), value)
    log += message(181, START_US, b"ArduPlane V4.5.0")
    for sample in range(SAMPLES):
        stamp, (pitch, speed, rate) = START_US + STEP_US * sample, motion(sample)
        log += message(182, stamp, sample % 2, 0.0, rate, 0.0, 0.3, 0.0, -9.8)
        log += message(183, stamp, 0, int(5730 * pitch), 0) + message(184, stamp, 0, speed)
        log += message(185, stamp, 1500, 1500 + int(400 * pitch), 1500, 1500)
    return log


def frames():
    """MAVLink 2, then MAVLink 1: attitude, IMU, air data, servos, at the times of the autopilot."""
    for version in (2, 1):
        out = io.BytesIO()
        link = mavlink.MAVLink(out, srcSystem=1, srcComponent=1)
        for sample in range(SAMPLES):
            stamp, (pitch, speed, rate) = START_US + STEP_US * sample, motion(sample)
            for message in (
                mavlink.MAVLink_attitude_message(stamp // 1000, 0.0, pitch, 0.0, 0.0, rate, 0.0),
                mavlink.MAVLink_highres_imu_message(stamp, 0.3, 0, -9.8, 0, rate, 0, 0, 0, 0, 900.0, 5.0, 500.0, 15.0, 0xFFFF),
                mavlink.MAVLink_vfr_hud_message(speed, speed, 0, 50, 500.0, 0.0),
                mavlink.MAVLink_servo_output_raw_message(stamp, 0, 1500, 1500 + int(400 * pitch), 1500, 1500, 0, 0, 0, 0),
            ):
                out.write(message.pack(link, force_mavlink1=version == 1))
                link.seq = (link.seq + 1) % 256
        yield out.getvalue()


def rows():
    """JSON lines, and CSV."""
    names = ("time_s", "theta_rad", "true_airspeed_m_s", "q_rad_s")
    table = [(STEP_US * 1e-6 * sample, *motion(sample)) for sample in range(SAMPLES)]
    yield "".join(json.dumps(dict(zip(names, row))) + "\n" for row in table).encode()
    yield "".join(",".join(map(str, row)) + "\n" for row in [names, *table]).encode()


def pieces(telemetry):
    """As the target `telemetry` takes it: before each piece of up to 248 bytes one that says its length, time and peer."""
    control = 5 << 5
    for start in range(0, len(telemetry), 248):
        piece = telemetry[start : start + 248].ljust(248, b"\0" if telemetry[0] in (0xFD, 0xFE) else b"\n")
        yield bytes([control | 0x1E, *piece[:240]]) + bytes([control | 0x01, *piece[240:]])


def recording(telemetry):
    """The blocks that docs/live.md describes."""

    def block(kind, stamp, content):
        body = struct.pack("<BQQH", kind, stamp, stamp, 0) + content
        return b"PHGL" + struct.pack("<II", len(body), zlib.crc32(body)) + body

    header = {
        "version": 1,
        "program": "0",
        "source": "udp",
        "started_wall_ns": 0,
        "model_name": "m.toml",
        "model_text": "",
        "method": None,
        "change_detection": None,
        "reorder_ns": 4000000,
        "system": None,
        "base": None,
    }
    blocks = [block(0, 0, json.dumps(header).encode()), block(1, 1, b"127.0.0.1:9")]
    blocks += [block(2, 2 + start, telemetry[start : start + 40]) for start in range(0, len(telemetry), 40)]
    return b"".join(blocks) + block(4, 10**9, b"closed") + block(5, 10**9, b"")


def main():
    def write(name, content):
        path = SEEDS / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        print(f"{path}: {len(content)} bytes")

    write("ulog/flight.ulg", ulog())
    write("dataflash/flight.bin", dataflash())
    for number, telemetry in enumerate([*frames(), *rows()]):
        write(f"telemetry/{number}", b"".join(pieces(telemetry)))
    write("recording/flight.phgl", recording(next(frames())))


if __name__ == "__main__":
    main()
