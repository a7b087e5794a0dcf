"""Telemetry logs (.tlog): what pymavlink reads of one is read to the same numbers here, also where bytes are lost and put in."""

import json
import math
import os
import pathlib
import random
import struct
import subprocess
import tempfile

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from common import EXAMPLES, same

START = 1_700_000_000_000_000
# Factors to the units of this project, where MAVLink has units of its own: as decimal fractions, so that the quotient is exact.
DIVISORS = {"degE7": 1e7, "degE5": 1e5, "cdeg": 100, "ddeg": 10, "ddeg/s": 10, "cm/s": 100, "dm/s": 10, "mm/s": 1000, "dm": 10,
            "cdegC": 100, "d%": 10, "c%": 100, "mG": 1000}


def flight(seconds, generator):
    """A telemetry log as ground stations write it: a time of arrival, then the frame."""
    vehicle, ground = mavlink.MAVLink(None, 1, 1), mavlink.MAVLink(None, 255, 190)
    pieces = []

    def add(at, sender, message):
        pieces.append(struct.pack(">Q", at & ~3) + message.pack(sender))
        sender.seq = (sender.seq + 1) % 256

    for k in range(50 * seconds):
        boot = 20 * k + 4000
        at = START + 20_000 * k + generator.randrange(8000)
        t = 0.02 * k
        wave = [math.sin(1.3 * t + i) for i in range(6)]
        add(at, vehicle, mavlink.MAVLink_attitude_message(boot, *wave))
        add(at + 4, vehicle, mavlink.MAVLink_raw_imu_message(1000 * boot, *[int(900 * x) for x in wave], 1, 2, 3, 0, 4321))
        add(at + 8, vehicle, mavlink.MAVLink_named_value_float_message(boot, b"my_vane", 0.1 * wave[0]))
        if k % 5 == 0:
            add(at + 12, vehicle, mavlink.MAVLink_vfr_hud_message(20 + wave[1], 21.0, 90, 55, 300.0, 0.1))
            add(at + 16, vehicle, mavlink.MAVLink_global_position_int_message(boot, 473977421 + k, 85455941, 300000, 1000, 1, 2, 3, 9000))
            add(at + 20, vehicle, mavlink.MAVLink_servo_output_raw_message(1000 * boot % 2**32, 0, 1500, 1600 + k % 7, *[0] * 6))
        if k % 50 == 0:
            add(at + 24, ground, mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
            add(at + 28, vehicle, mavlink.MAVLink_attitude_quaternion_message(boot, 1.0, 0.0, 0.0, 0.0, *wave[:3]))
    return pieces


def theirs(file):
    """Their messages of the vehicle, by name."""
    log = mavutil.mavlink_connection(str(file), robust_parsing=True)
    topics = {}
    while (message := log.recv_msg()) is not None:
        if message.get_type() not in ("BAD_DATA",) and message.get_srcSystem() == 1:
            topics.setdefault(message.get_type(), []).append(message)
    return topics


def ours(file):
    run = subprocess.run([EXAMPLES / "dump_log", file], capture_output=True, check=True, text=True)
    _, *topics = [json.loads(line) for line in run.stdout.splitlines()]
    return {topic["name"]: topic for topic in topics}, run.stderr


def check(title, pieces, folder):
    file = folder / "flight.tlog"
    file.write_bytes(b"".join(pieces))
    expected, (found, said) = theirs(file), ours(file)
    assert set(found) == set(expected), f"{title}: {sorted(found)}, expected {sorted(expected)}"
    count = 0
    for name, messages in expected.items():
        topic = found[name]
        assert len(topic["time_s"]) == len(messages), f"{title}, {name}: {len(topic['time_s'])} of {len(messages)}"
        for field in topic["fields"]:
            label = field["name"]
            element = int(label.split("[")[1][:-1]) if "[" in label else None
            raw = "value" if name == "NAMED_VALUE_FLOAT" else label.split("[")[0]
            divisor = DIVISORS.get(messages[0].fieldunits_by_name.get(raw), 1)
            for mine, message in zip(field["values"], messages, strict=True):
                value = getattr(message, raw)
                value = value if element is None else value[element]
                assert same(mine, value / divisor), f"{title}, {name}.{label}: {mine!r}, expected {value / divisor!r}"
                count += 1
        # The times are those of the vehicle, from its first.
        if hasattr(messages[0], "time_boot_ms"):
            first = found["ATTITUDE"]
            assert len(first["time_s"]) and all(
                abs(time - (message.time_boot_ms - 4000) * 1e-3) < 1e-6 for time, message in zip(topic["time_s"], messages, strict=True)
            ), f"{title}, {name}: times"
    print(f"  {title}: {sum(map(len, expected.values()))} messages, {count} numbers the same")
    return said


def main():
    generator = random.Random(5)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        pieces = flight(60, generator)
        check("a flight", pieces, folder)
        damaged = [bytearray(piece) for piece in pieces]
        # One bit of the payload: both leave the message out, for its checksum is wrong.
        for at in generator.sample(range(10, len(damaged)), 40):
            damaged[at][18 + generator.randrange(3)] ^= 1 << generator.randrange(8)
        said = check("with wrong bits", damaged, folder)
        assert "checksum is wrong" in said, said


if __name__ == "__main__":
    main()
