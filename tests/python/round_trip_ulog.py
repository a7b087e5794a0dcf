"""ULog: what pyulog reads, and what it writes, gives the same numbers here."""

import math
import pathlib
import struct
import tempfile

import numpy
from pyulog import ULog

from common import compare, dump_log, shared

TYPES = ["int8_t", "uint8_t", "int16_t", "uint16_t", "int32_t", "uint32_t", "int64_t", "uint64_t", "float", "double", "bool"]
LETTERS = "bBhHiIqQfd?"


def message(kind, payload):
    return struct.pack("<HB", len(payload), ord(kind)) + payload


def information(kind, key, value, first=b""):
    return message(kind, first + bytes([len(key)]) + key.encode() + value)


def synthetic():
    """A log with every type, arrays, nested types, padding, two instances, text, a dropout and parameters."""
    start = 1_000_000
    log = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", start))
    log += message("B", bytes(40))
    log += message("F", b"inner:float[2] a;uint8_t b;uint8_t[3] _padding0;")
    fields = "".join(f"{name} x_{index};" for index, name in enumerate(TYPES))
    log += message("F", f"everything:uint64_t timestamp;{fields}char[6] text;uint8_t[2] _padding0;".encode())
    log += message("F", b"nested:uint64_t timestamp;inner one;inner[2] two;uint8_t[4] _padding0;")
    log += information("I", "char[3] sys_name", b"PX4")
    log += information("I", "uint32_t ver_sw_release", struct.pack("<I", 17498624))
    log += information("P", "float MASS", struct.pack("<f", 1.25))
    log += information("P", "int32_t COUNT", struct.pack("<i", -7))
    for instance in (0, 1):
        log += message("A", struct.pack("<BH", instance, instance) + b"everything")
    log += message("A", struct.pack("<BH", 0, 7) + b"nested")
    random = numpy.random.default_rng(11)
    for sample in range(500):
        stamp = start + 10_000 * sample
        values = [
            int(random.integers(0, 2)) if letter == "?"
            else float(numpy.float32(random.normal())) if letter in "fd"
            else int(random.integers(-(2 ** (8 * struct.calcsize(letter) - 1)) if letter.islower() else 0,
                                     2 ** min(8 * struct.calcsize(letter) - 1, 52)))
            for letter in LETTERS
        ]
        if sample == 17:
            values[LETTERS.index("f")] = math.nan
        values = [max(value, -(2**52)) if isinstance(value, int) else value for value in values]
        data = struct.pack("<HQ" + LETTERS, sample % 2, stamp, *values) + b"text\0\0"
        # Writers leave the padding at the end out; pyulog refuses it, so that only our own tests have it there.
        log += message("D", data)
        inner = b"".join(struct.pack("<ffB", sample + part, -sample, sample % 256) + bytes(3) for part in range(3))
        log += message("D", struct.pack("<HQ", 7, stamp + 3) + inner)
        if sample == 250:
            log += message("L", b"6" + struct.pack("<Q", stamp) + b"half way")
            log += message("O", struct.pack("<H", 42))
            log += information("P", "float MASS", struct.pack("<f", 1.5))
            log += message("S", bytes([0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12]))
    return bytes(log)


def check(path):
    """Every number of the log."""
    theirs = ULog(str(path))
    head, ours = dump_log(path)
    count = 0
    for data in theirs.data_list:
        topic = ours.pop((data.name, data.multi_id))
        place = f"{path.name} {data.name}#{data.multi_id}"
        # The same operations on the same integers: the same number.
        times = (data.data["timestamp"].astype(float) - float(theirs.start_timestamp)) * 1e-6
        count += compare(f"{place} time", topic["time_s"], times)
        fields = {field["name"]: field["values"] for field in topic["fields"]}
        numeric = [field for field in data.field_data if field.type_str != "char" and field.field_name != "timestamp"]
        numeric = [field for field in numeric if "_padding" not in field.field_name]
        assert sorted(fields) == sorted(field.field_name for field in numeric), place
        for field in numeric:
            values = data.data[field.field_name]
            count += compare(f"{place}.{field.field_name}", fields[field.field_name], values.astype(float))
    assert not ours, f"{path.name}: topics that pyulog has not: {list(ours)}"
    parameters = dict(head["parameters"])
    assert parameters == {name: float(value) for name, value in theirs.initial_parameters.items()}, path.name
    told = dict(head["information"])
    for name, value in theirs.msg_info_dict.items():
        if isinstance(value, (str, int, float)):
            assert told[name] == str(value).rstrip("\0"), f"{path.name} {name}"
    logged = [(text["time_s"], text["text"]) for text in head["messages"]]
    expected = [((text.timestamp - theirs.start_timestamp) * 1e-6, text.message) for text in theirs.logged_messages]
    for one in expected:
        assert any(abs(time - one[0]) < 1e-9 and text == one[1].rstrip("\0") for time, text in logged), one
    print(f"  {path.name}: {len(theirs.data_list)} topics, {count} numbers the same")


def main():
    with tempfile.TemporaryDirectory() as folder:
        written = pathlib.Path(folder) / "synthetic.ulg"
        written.write_bytes(synthetic())
        check(written)
        for name in ["logs/sample_log_small.ulg", "logs/sample_appended_multiple.ulg"]:
            path = shared(name)
            if path is not None:
                check(path)
                written = pathlib.Path(folder) / f"written-{path.name}"
                try:
                    ULog(str(path)).write_ulog(str(written))
                except TypeError as error:
                    # It cannot write information that is neither a number nor a text.
                    print(f"  {path.name}: pyulog cannot write it back: {error}")
                    continue
                check(written)


if __name__ == "__main__":
    main()
