"""DataFlash: what pymavlink reads gives the same numbers here; multipliers, which it leaves to its caller, are applied."""

import math
import os
import pathlib
import struct
import tempfile

import numpy

# The reader in Python, not the indexer in C: it is the one that is documented.
os.environ.setdefault("PYMAVLINK_FAST_INDEX", "0")
from pymavlink import DFReader  # noqa: E402

from common import compare, dump_log, shared

SIZES = {letter: struct.calcsize("<" + code) for letter, (code, _, _) in DFReader.FORMAT_TO_STRUCT.items()}
OWN_MULTIPLIER = "cCeEL"
INTERNAL = {"FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG"}


class Writer:
    """A minimal DataFlash log as ArduPilot writes it."""

    def __init__(self):
        self.log = bytearray()
        self.letters = {}
        self.define(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")

    def define(self, kind, name, letters, columns):
        self.letters[name] = (kind, letters)
        length = 3 + sum(SIZES[letter] for letter in letters)
        self.write("FMT", kind, length, name.encode(), letters.encode(), columns.encode())

    def write(self, name, *values):
        kind, letters = self.letters[name]
        codes = "<" + "".join(DFReader.FORMAT_TO_STRUCT[letter][0] for letter in letters)
        self.log += bytes([0xA3, 0x95, kind]) + struct.pack(codes, *values)


def synthetic():
    """Every type, units, multipliers, two instances of a sensor, parameters, texts, a type defined anew."""
    w = Writer()
    w.define(177, "UNIT", "QbZ", "TimeUS,Id,Label")
    w.define(178, "MULT", "Qbd", "TimeUS,Id,Mult")
    w.define(179, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
    w.define(180, "PARM", "QNff", "TimeUS,Name,Value,Default")
    w.define(181, "MSG", "QZ", "TimeUS,Message")
    w.define(182, "IMU", "QBffhI", "TimeUS,I,GyrX,AccX,Temp,EG")
    w.define(183, "ALL", "QbBhHiIfdcCeELMg", "TimeUS,b,B,h,H,i,I,f,d,c,C,e,E,L,M,g")
    w.define(186, "ALL2", "QqQnN", "TimeUS,q,Q,n,N")
    w.define(184, "ARR", "Qa", "TimeUS,x")
    w.define(185, "GPS", "QBBIHBcLLe", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt")
    for letter, unit in [("s", "s"), ("#", "instance"), ("E", "rad/s"), ("o", "m/s/s"), ("O", "degC"), ("m", "m"), ("D", "deglatitude"), ("-", "")]:
        w.write("UNIT", 100, ord(letter), unit.encode())
    for letter, factor in [("-", 0.0), ("F", 1e-6), ("0", 1.0), ("B", 1e-2), ("G", 1e-7), ("2", 1e2)]:
        w.write("MULT", 100, ord(letter), factor)
    w.write("FMTU", 100, 182, b"s#EoO-", b"F-00B-")
    w.write("FMTU", 100, 183, b"s------m--m-D---", b"F--B2-----B-G---")
    w.write("FMTU", 100, 185, b"s#----------", b"F-----------")
    for name, value in [("ARSPD_RATIO", 1.9936), ("SERVO2_FUNCTION", 19.0)]:
        w.write("PARM", 200, name.encode(), value, 0.0)
    w.write("MSG", 300, b"ArduPlane V4.5.0")
    random = numpy.random.default_rng(7)
    whole = lambda low, high: int(random.integers(low, high))  # noqa: E731
    for sample in range(400):
        stamp = 1000 + 2500 * sample
        imu = [float(numpy.float32(random.normal())) for _ in range(2)]
        w.write("IMU", stamp, sample % 3, *imu, whole(-4000, 8000), sample)
        w.write(
            "ALL", stamp + 1, whole(-128, 128), whole(0, 256), whole(-(2**15), 2**15), whole(0, 2**16), whole(-(2**31), 2**31), whole(0, 2**32),
            math.nan if sample == 9 else float(numpy.float32(random.normal())), random.normal(), whole(-(2**15), 2**15), whole(0, 2**16),
            whole(-(2**31), 2**31), whole(0, 2**32), whole(-(2**31), 2**31), whole(0, 30), float(numpy.float16(random.normal())),
        )
        w.write("ALL2", stamp + 2, whole(-(2**52), 2**52), whole(0, 2**52), b"four", b"sixteen letters")
        if sample % 10 == 0:
            w.write("ARR", stamp + 2, numpy.asarray(random.integers(-(2**15), 2**15, 32), "<i2").tobytes())
            w.write("GPS", stamp + 3, 0, 3, 1000 * sample, 2300, 12, 80, -353632621, 1491652374, 58400)
    return bytes(w.log)


def multipliers(reader):
    """By type and column: what the log says its numbers are to be multiplied by, where the letter does not say so."""
    table = {0: 1.0}
    for letter, factor in reader.mult_lookup.items():
        table[ord(letter) if isinstance(letter, str) else letter] = factor
    return table


def read(path):
    """Their reading: times and columns by (name, instance)."""
    reader = DFReader.DFReader_binary(str(path), zero_time_base=True)
    ids, topics, parameters, texts = {}, {}, {}, []
    factors = {}
    while (message := reader.recv_msg()) is not None:
        name, form = message.get_type(), message.fmt
        if name == "MULT":
            factors[chr(message.Id)] = message.Mult
        if name == "FMTU":
            ids[message.FmtType] = (message.UnitIds, message.MultIds)
        if name == "PARM":
            parameters.setdefault(message.Name, message.Value)
        if name == "MSG":
            texts.append(message.Message)
        if name in INTERNAL:
            continue
        instance = getattr(message, form.instance_field) if form.instance_field else 0
        topic = topics.setdefault((name, instance), {"rows": [], "form": form})
        topic["rows"].append([getattr(message, column) for column in form.columns])
    return reader, topics, parameters, texts, ids, factors


def check(path):
    """Every number of the log."""
    reader, theirs, parameters, texts, ids, factors = read(path)
    head, ours = dump_log(path)
    count = 0
    for (name, instance), topic in theirs.items():
        form = topic["form"]
        letters = [chr(letter) if isinstance(letter, int) else letter for letter in form.format]
        letters = [letter for letter in letters if letter != "\0"]
        place = f"{path.name} {name}#{instance}"
        clock = next((c for c in ("TimeUS", "TimeMS") if form.columns[:1] == [c]), None)
        clock = clock or ("T" if name in ("GPS", "GPS2") and "T" in form.columns else None)
        numeric = [i for i, letter in enumerate(letters) if letter not in "nNZ" and form.columns[i] != clock]
        if not numeric:
            continue
        mine = ours.pop((name, instance))
        fields = {field["name"]: field["values"] for field in mine["fields"]}
        if clock:
            stamps = [row[form.columns.index(clock)] for row in topic["rows"]]
            scale = 1e-6 if clock == "TimeUS" else 1e-3
            first = mine["time_s"][0] - stamps[0] * scale
            count += compare(f"{place} time", mine["time_s"], [stamp * scale + first for stamp in stamps], 1e-12)
        mults = ids.get(form.type, ("", ""))[1]
        for i in numeric:
            column = form.columns[i]
            factor = factors.get(mults[i], 1.0) if i < len(mults) and letters[i] not in OWN_MULTIPLIER else 1.0
            values = [row[i] for row in topic["rows"]]
            if letters[i] == "a":
                for element in range(32):
                    count += compare(f"{place}.{column}[{element}]", fields.pop(f"{column}[{element}]"), [v[element] for v in values])
                continue
            # A hundredth by division or by multiplication: the last bit may differ.
            expected = [float(v) * (factor or 1.0) for v in values]
            count += compare(f"{place}.{column}", fields.pop(column), expected, 1e-15 if factor in (0.0, 1.0) else 3e-16)
        assert not fields, f"{place}: {list(fields)}"
    assert not ours, f"{path.name}: topics that pymavlink has not: {list(ours)}"
    mine = dict(head["parameters"])
    assert mine == {name: float(value) for name, value in parameters.items()}, path.name
    assert [text["text"] for text in head["messages"]] == [text.strip() for text in texts], path.name
    print(f"  {path.name}: {len(theirs)} topics, {count} numbers the same")


def main():
    with tempfile.TemporaryDirectory() as folder:
        written = pathlib.Path(folder) / "synthetic.bin"
        written.write_bytes(synthetic())
        check(written)
        path = shared("logs/log171.bin")
        if path is not None:
            check(path)


if __name__ == "__main__":
    main()
