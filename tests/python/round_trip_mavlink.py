"""MAVLink: what pymavlink writes is decoded to the same numbers here, frame by frame, and what is skipped is counted the same."""

import json
import math
import pathlib
import random
import struct
import subprocess
import tempfile
import tomllib

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from common import EXAMPLES, same

PROFILE = pathlib.Path(__file__).parents[2] / "crates/phugoid-flight-data/profiles/mavlink.toml"
MARKERS = {0xFD, 0xFE}
WHOLE = {"uint8_t": (0, 2**8), "int8_t": (-(2**7), 2**7), "uint16_t": (0, 2**16), "int16_t": (-(2**15), 2**15), "uint32_t": (0, 2**32),
         "int32_t": (-(2**31), 2**31), "uint64_t": (0, 2**64), "int64_t": (-(2**63), 2**63)}


def single(kind, generator):
    """A value of a type: now and then zero, an end of its range, or what is no number."""
    chance = generator.random()
    if kind in ("float", "double"):
        if chance < 0.1:
            return generator.choice([0.0, -0.0, math.nan, math.inf, -math.inf])
        value = generator.uniform(-1.0, 1.0) * 10.0 ** generator.randint(-20, 20)
        return struct.unpack("<f", struct.pack("<f", value))[0] if kind == "float" else value
    low, high = WHOLE[kind.removesuffix("_mavlink_version")]
    return generator.choice([0, low, high - 1]) if chance < 0.2 else generator.randrange(low, high)


def message(kind, generator):
    """A message with values in all fields, extensions too; in a third of the cases zeros from some field of the wire on."""
    values = {}
    for name, type_name in zip(kind.fieldnames, kind.fieldtypes):
        count = kind.array_lengths[kind.ordered_fieldnames.index(name)]
        if type_name == "char":
            letters = bytes(generator.choice(b"abcdefghijklmnopqrstuvwxyz_0123456789") for _ in range(generator.randint(0, count)))
            values[name] = letters
        else:
            values[name] = [single(type_name, generator) for _ in range(count)] if count else single(type_name, generator)
    if generator.random() < 0.33:
        for name in kind.ordered_fieldnames[generator.randrange(len(kind.ordered_fieldnames)):]:
            values[name] = b"" if isinstance(values[name], bytes) else [0] * len(values[name]) if isinstance(values[name], list) else 0
    return kind(*(values[name] for name in kind.fieldnames))


class Stream:
    """Frames of several systems and components, with what belongs to none of them in between."""

    def __init__(self, seed, noise):
        self.generator = random.Random(seed)
        self.noise = noise
        self.senders = {}
        for number, ids in enumerate([(1, 1), (1, 191), (7, 1), (255, 190)]):
            sender = self.senders[ids] = mavlink.MAVLink(None, *ids)
            sender.signing.secret_key = bytes(range(32))
            sender.signing.link_id = number
        self.data = bytearray()
        self.skipped = 0
        self.damaged = 0

    def add(self, kind):
        generator = self.generator
        sender = generator.choice(list(self.senders.values()))
        version_1 = kind.id < 256 and generator.random() < 0.4
        sender.signing.sign_outgoing = not version_1 and generator.random() < 0.25
        frame = bytearray(message(kind, generator).pack(sender, force_mavlink1=version_1))
        sender.seq = (sender.seq + generator.choice([1, 1, 1, 2])) % 256
        chance = generator.random()
        if chance < 0.05:
            # One bit, of the payload or the checksum: the header says how long the frame is and what.
            end = len(frame) - (13 if sender.signing.sign_outgoing else 0)
            frame[generator.randrange(6 if version_1 else 10, end)] ^= 1 << generator.randrange(8)
            if not self.noise and MARKERS & set(frame[1:]):
                return
            self.skipped += len(frame)
            self.damaged += 1
        elif chance < 0.15:
            dirt = bytes(generator.randrange(256) for _ in range(generator.randint(1, 60)))
            dirt = dirt if self.noise else bytes(byte for byte in dirt if byte not in MARKERS)
            self.data += dirt
            self.skipped += len(dirt)
        self.data += frame

    def finish(self):
        # What might be the beginning of a frame is waited for: behind the last frame there is enough to know.
        self.data += bytes(300)
        self.skipped += 300
        return bytes(self.data)


def theirs(data):
    """Their reading: messages, and how many bytes belong to none."""
    reader = mavlink.MAVLink(None)
    reader.robust_parsing = True
    found = reader.parse_buffer(data) or []
    good = [m for m in found if not isinstance(m, (mavlink.MAVLink_bad_data, mavlink.MAVLink_unknown))]
    bad = [m for m in found if isinstance(m, mavlink.MAVLink_bad_data)]
    # The rest is a frame that has not come to its end, as far as they know.
    return good, sum(len(m.data) for m in bad) + reader.buf_len(), sum(m.reason.startswith("invalid MAVLink CRC") for m in bad)


def ours(data, folder):
    file = folder / "stream.mavlink"
    file.write_bytes(data)
    run = subprocess.run([EXAMPLES / "dump_mavlink", file], capture_output=True, check=True, text=True)
    *frames, last = [json.loads(line) for line in run.stdout.splitlines()]
    return frames, last


def key(m):
    header = m.get_header()
    return header.msgId, header.seq, header.srcSystem, header.srcComponent


def compare(frame, m):
    """Every field of a frame; gives how many numbers there were."""
    place = f"{m.get_type()} of {m.get_srcSystem()}.{m.get_srcComponent()}, number {m.get_seq()}"
    assert frame["name"] == m.msgname, f"{place}: {frame['name']}"
    assert set(frame["fields"]) == set(m.fieldnames), f"{place}: fields {sorted(frame['fields'])}"
    count = 0
    for name, value in frame["fields"].items():
        their = getattr(m, f"_{name}_raw", None)
        their = their if isinstance(their, bytes) else getattr(m, name)
        if isinstance(value, str):
            their = their if isinstance(their, bytes) else their.encode()
            assert value.encode() == their.split(b"\0")[0], f"{place}.{name}: {value!r}, expected {their!r}"
            count += 1
            continue
        pairs = list(zip(value, their, strict=True)) if isinstance(value, list) else [(value, their)]
        for mine, other in pairs:
            assert same(mine, float(other)), f"{place}.{name}: {mine!r}, expected {other!r}"
        count += len(pairs)
    return count


def check(title, stream, folder, exactly):
    data = stream.finish()
    good, skipped, damaged = theirs(data)
    frames, last = ours(data, folder)
    known = [frame for frame in frames if frame["name"]]
    if exactly:
        # Without bytes that look like the beginning of a frame both see the same, and what was written.
        assert len(known) == len(good), f"{title}: {len(known)} frames, {len(good)} expected"
        assert last["skipped_bytes"] + last["left_bytes"] == skipped == stream.skipped, f"{title}: {last}, {skipped}, {stream.skipped}"
        assert last["bad_checksums"] == damaged == stream.damaged, f"{title}: {last}, {damaged}, {stream.damaged}"
        pairs = list(zip(known, good))
    else:
        # They give up the bytes of a false frame, ours look for a true one within: what they have is there, in their order.
        at, pairs = 0, []
        for m in good:
            while (known[at]["id"], known[at]["sequence"], known[at]["system"], known[at]["component"]) != key(m):
                at += 1
            pairs.append((known[at], m))
            at += 1
        assert len(known) >= len(good), f"{title}: {len(known)} frames, at least {len(good)} expected"
    count = sum(compare(frame, m) for frame, m in pairs)
    print(f"  {title}: {len(pairs)} frames, {count} numbers the same, {last['bad_checksums']} wrong checksums, {last['skipped_bytes']} bytes skipped")
    return known


def mapped():
    """Messages that the profile maps to channels, and those that a model file may."""
    profile = tomllib.loads(PROFILE.read_text())
    names = {source["field"].split(".")[0] for channel in profile["channel"].values() for source in channel["sources"]}
    return sorted(names | set(profile["time_base"]) | {"NAMED_VALUE_FLOAT", "SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS"})


def main():
    kinds = list(mavlink.mavlink_map.values())
    by_name = {kind.msgname: kind for kind in kinds}
    names = mapped()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        every = Stream(1, noise=False)
        for _ in range(4):
            for kind in kinds:
                every.add(kind)
        check("every message", every, folder, exactly=True)
        channels = Stream(2, noise=False)
        for _ in range(200):
            for name in names:
                channels.add(by_name[name])
        check("messages of channels", channels, folder, exactly=True)
        dirty = Stream(3, noise=True)
        for _ in range(200):
            for name in names:
                dirty.add(by_name[name])
        known = check("noise that looks like frames", dirty, folder, exactly=False)
        # No frame that was sent whole is lost to it.
        sent = 200 * len(names) - dirty.damaged
        assert len(known) == sent, f"noise: {len(known)} frames, {sent} were sent whole"


if __name__ == "__main__":
    main()
