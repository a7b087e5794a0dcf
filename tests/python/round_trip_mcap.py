"""MCAP: what the package `mcap` writes gives the same numbers here."""

import json
import pathlib
import tempfile

import numpy
from mcap.writer import CompressionType, Writer

from common import compare, dump_log

SAMPLES = 3000
START = 1_714_566_896_123_456_789


def main():
    random = numpy.random.default_rng(5)
    stamps = [START + int(step) for step in numpy.cumsum(random.integers(1, 20_000_000, SAMPLES)) - 1]
    values = random.normal(size=(SAMPLES, 4)) * 10.0 ** random.integers(-100, 100, (SAMPLES, 1))
    kinds = {
        "none": {"compression": CompressionType.NONE},
        "lz4": {"compression": CompressionType.LZ4},
        "zstd": {"compression": CompressionType.ZSTD},
        "without chunks": {"use_chunking": False},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "flight.mcap"
        for name, options in kinds.items():
            with open(path, "wb") as file:
                writer = Writer(file, chunk_size=20_000, **options)
                writer.start()
                schema = writer.register_schema("state", "jsonschema", b"{}")
                channel = writer.register_channel("state", "json", schema)
                for stamp, row in zip(stamps, values):
                    message = {"x": row[0], "attitude": {"q": list(row[1:])}, "name": "text"}
                    writer.add_message(channel, stamp, json.dumps(message).encode(), stamp)
                writer.finish()
            _, topics = dump_log(path)
            topic = topics["state", 0]
            fields = {field["name"]: field["values"] for field in topic["fields"]}
            # Microseconds from the first message, as the reader counts them.
            expected = [(stamp - stamps[0]) / 1e3 * 1e-6 for stamp in stamps]
            count = compare(f"MCAP, {name}, time", topic["time_s"], expected)
            for index, field in enumerate(["x", "attitude.q[0]", "attitude.q[1]", "attitude.q[2]"]):
                count += compare(f"MCAP, {name}, {field}", fields.pop(field), values[:, index])
            assert not fields, fields
            print(f"  MCAP, {name}: {count} numbers are the same")


main()
