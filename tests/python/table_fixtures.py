"""Writes the small files that the tests of phugoid-flight-data read, with the formats' own tools.

Usage: table_fixtures.py FOLDER   (crates/phugoid-flight-data/tests/data)
Every number is a small fraction of two, so that the tests can state it exactly.
"""

import datetime
import json
import pathlib
import sys

import numpy as np
import openpyxl
import pyarrow as pa
import pyarrow.feather
import pyarrow.ipc
import pyarrow.parquet
import scipy.io
from mcap.writer import CompressionType, Writer

ROWS = 40


def flight():
    k = np.arange(ROWS)
    q = k * k / 1024.0 - 0.5
    q[3] = np.nan
    return {
        "time_s": k * 0.0625,
        "alpha_deg": ((k % 7) * 0.125 - 0.25).astype(np.float32),
        "q": q,
        "count": (k - 20).astype(np.int16),
        "big": (2**53 - 1 - k).astype(np.int64),
        "on": k % 2 == 1,
    }


def matlab(folder):
    table = flight()
    save = lambda name, content, **options: scipy.io.savemat(folder / name, content, **options)
    extra = {"wing_area": 16.2, "note": "made by scipy", "inertia": np.eye(3), "z": table["q"] * 1j}
    save("vectors.mat", {**table, "q_unit": "deg/s", **extra}, oned_as="column")
    save("compressed.mat", {**table, "q_unit": "deg/s", **extra}, oned_as="row", do_compression=True)
    units = {"q": "deg/s"}
    save("struct.mat", {"flight": {**table, "units": units}, "version": 3.0}, oned_as="column", do_compression=True)
    save("several.mat", {"first": table, "second": table}, oned_as="column", do_compression=True)
    values = {name: {"values": value, "unit": {"q": "deg/s"}.get(name, "")} for name, value in table.items()}
    save("values.mat", values, oned_as="column")
    matrix = np.column_stack([np.asarray(value, dtype=float) for value in table.values()])
    names = np.array(list(table), dtype=object)
    unit_list = np.array([{"q": "deg/s"}.get(name, "") for name in table], dtype=object)
    save("matrix.mat", {"data": matrix, "data_names": names, "data_units": unit_list})
    save("transposed.mat", {"data": matrix.T, "names": names, "units": unit_list}, do_compression=True)
    save("version4.mat", {"time_s": table["time_s"]}, format="4")


def excel(folder):
    """A workbook of one sheet with titles, units in a row and a clock; and one whose second sheet is the flight."""
    table = flight()
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "Flight 1"
    sheet.append(["Flight test 12, D-EXYZ"])
    sheet.append([])
    sheet.append(["Uhrzeit", *list(table)[1:], "remark"])
    sheet.append([None, None, "deg/s", None, None, None, None])
    start = datetime.datetime(2024, 5, 1, 23, 59, 59)
    for row in range(ROWS):
        values = [table[name][row] for name in list(table)[1:]]
        values = [None if isinstance(v, float) and np.isnan(v) else v.item() for v in values]
        # Excel keeps times to the millisecond.
        sheet.append([start + datetime.timedelta(seconds=row * 0.125), *values, "a 'b'\tc" if row == 1 else None])
    book.save(folder / "clock.xlsx")
    book = openpyxl.Workbook()
    book.active.title = "Notes"
    book.active.append(["nothing to see"])
    sheet = book.create_sheet("Flight 2")
    sheet.append([{"q": "q_deg_s"}.get(name, name) for name in table])
    for row in range(ROWS):
        values = [column[row].item() for column in table.values()]
        sheet.append([None if isinstance(v, float) and np.isnan(v) else v for v in values])
    book.save(folder / "sheets.xlsx")


def arrow_table():
    table = flight()
    fields, columns = [], []
    for name, values in table.items():
        # NaN in pandas' way: missing.
        columns.append(pa.array(values, from_pandas=True))
        fields.append(pa.field(name, columns[-1].type, metadata={"unit": "deg/s"} if name == "q" else None))
    k = range(ROWS)
    extra = {
        "mode": pa.array(["cruise" if row % 3 else "climb" for row in k]),
        "category": pa.array(["a" if row % 2 else "b" for row in k]).dictionary_encode(),
        "list": pa.array([[1.0, 2.0]] * ROWS),
        "struct": pa.array([{"x": 1.0, "y": "z"}] * ROWS),
        "view": pa.array(["a text too long to be kept in place"] * ROWS, type=pa.string_view()),
        "decimal": pa.array([None] * ROWS, type=pa.decimal128(10, 2)),
    }
    for name, column in extra.items():
        # Between the numbers, so that their buffers have to be passed over.
        fields.insert(2, pa.field(name, column.type))
        columns.insert(2, column)
    return pa.table(columns, schema=pa.schema(fields))


def arrow(folder):
    table = arrow_table()
    for compression in ["uncompressed", "lz4", "zstd"]:
        pa.feather.write_feather(table, folder / f"{compression}.feather", compression=compression, chunksize=16)
    with pa.ipc.new_stream(folder / "stream.arrows", table.schema) as stream:
        stream.write_table(table, max_chunksize=16)
    pa.feather.write_feather(table.select(["time_s", "q"]), folder / "version1.feather", version=1)


def parquet(folder):
    # No string views in Parquet.
    table = arrow_table().drop_columns(["view"])
    for compression in ["none", "snappy", "zstd", "lz4", "gzip"]:
        pa.parquet.write_table(table, folder / f"{compression}.parquet", compression=compression, row_group_size=16)
    pa.parquet.write_table(table, folder / "pages2.parquet", data_page_version="2.0", use_dictionary=False)
    # Timestamps alone say what the time is.
    start = 1_714_566_896_000_000_000
    times = pa.array([start + row * 62_500_000 for row in range(ROWS)], type=pa.timestamp("ns", tz="UTC"))
    stamped = table.set_column(table.schema.get_field_index("time_s"), "index", times)
    pa.parquet.write_table(stamped.drop_columns(["mode", "category", "list", "struct"]), folder / "stamped.parquet")


def mcap(folder):
    start = 1_714_566_896_000_000_000
    kinds = {
        "none": {"compression": CompressionType.NONE},
        "lz4": {"compression": CompressionType.LZ4},
        "zstd": {"compression": CompressionType.ZSTD},
        "unchunked": {"use_chunking": False},
    }
    for name, options in kinds.items():
        with open(folder / f"{name}.mcap", "wb") as file:
            writer = Writer(file, chunk_size=1500, **options)
            writer.start(profile="", library="table_fixtures.py")
            schema = writer.register_schema("Attitude", "jsonschema", b'{"type": "object"}')
            imu = writer.register_schema("sensor_msgs/msg/Imu", "ros2msg", b"float64 x")
            attitude = writer.register_channel("attitude", "json", schema)
            air = [writer.register_channel("air", "json", schema) for _ in range(2)]
            other = writer.register_channel("/imu", "cdr", imu)
            for k in range(ROWS):
                stamp = start + k * 20_000_000
                message = {"q": [k / 8, -k / 16], "pose": {"x": k * k / 1024 - 0.5, "ok": k % 2 == 1}, "mode": "cruise"}
                if k == 3:
                    message["pose"]["x"] = None
                if k >= 20:
                    message["late"] = k
                writer.add_message(attitude, stamp, json.dumps(message).encode(), stamp)
                writer.add_message(air[k % 2], stamp + 1_000_000, json.dumps({"tas": k}).encode(), stamp)
                writer.add_message(other, stamp, bytes(12), stamp)
            writer.finish()


def main():
    for write in [excel, matlab, arrow, parquet, mcap]:
        folder = pathlib.Path(sys.argv[1]) / write.__name__
        folder.mkdir(parents=True, exist_ok=True)
        write(folder)


if __name__ == "__main__":
    main()
