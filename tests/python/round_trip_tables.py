"""Tables: what scipy and pyarrow write gives the same numbers here, and pyarrow reads ours."""

import csv
import math
import pathlib
import subprocess
import tempfile

import numpy
import openpyxl
import pyarrow
import pyarrow.feather
import pyarrow.ipc
import pyarrow.parquet
import scipy.io

from common import EXAMPLES, shared

ROWS = 20_000


def flight():
    """Doubles of every size, singles, integers and missing values; SI, so that no conversion rounds."""
    random = numpy.random.default_rng(3)
    wild = random.normal(size=ROWS) * 10.0 ** random.integers(-200, 200, ROWS)
    wild[::97] = numpy.nan
    return {
        "time_s": numpy.cumsum(random.uniform(0.001, 0.02, ROWS)),
        "alpha_rad": random.normal(size=ROWS),
        "q_rad_s": random.normal(size=ROWS).astype(numpy.float32),
        "wild": wild,
        "steps": random.integers(-(2**31), 2**31, ROWS).astype(numpy.int32),
        "big": random.integers(-(2**53), 2**53, ROWS),
        "flag": random.integers(0, 2, ROWS).astype(bool),
        "short": random.integers(0, 2**16, ROWS).astype(numpy.uint16),
    }


def ours(path, folder):
    target = folder / "ours.csv"
    subprocess.run([EXAMPLES / "read_table", path, target], check=True, capture_output=True)
    with open(target, newline="") as file:
        rows = csv.reader(file)
        names = next(rows)
        columns = list(zip(*rows))
    return {name: [float(cell) if cell else math.nan for cell in column] for name, column in zip(names, columns)}


def compare(place, found, expected):
    assert list(found) == list(expected), f"{place}: {list(found)}"
    for name, values in expected.items():
        theirs = numpy.asarray(values, dtype=float)
        same = numpy.array_equal(numpy.asarray(found[name]), theirs, equal_nan=True)
        assert same, f"{place}: {name} differs"
    print(f"  {place}: {len(expected)} columns of {ROWS} rows are the same")


def main():
    table = flight()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for compressed in (False, True):
            for orientation in ("row", "column"):
                path = folder / "flight.mat"
                scipy.io.savemat(path, table, do_compression=compressed, oned_as=orientation)
                compare(f"savemat, compressed {compressed}, {orientation}s", ours(path, folder), table)
            scipy.io.savemat(path, {"log": table, "note": "x"}, do_compression=compressed)
            compare(f"savemat, struct, compressed {compressed}", ours(path, folder), table)

        arrow = pyarrow.table({name: pyarrow.array(values, from_pandas=True) for name, values in table.items()})
        path = folder / "flight.parquet"
        for compression in ("none", "snappy", "zstd", "lz4"):
            for version in ("1.0", "2.0"):
                pyarrow.parquet.write_table(
                    arrow, path, compression=compression, data_page_version=version, row_group_size=7000
                )
                compare(f"Parquet, {compression}, pages {version}", ours(path, folder), table)
        pyarrow.parquet.write_table(
            arrow, path, use_dictionary=False, column_encoding={"time_s": "BYTE_STREAM_SPLIT", "big": "DELTA_BINARY_PACKED"}
        )
        compare("Parquet, byte streams split, deltas", ours(path, folder), table)
        for compression in ("uncompressed", "lz4", "zstd"):
            path = folder / "flight.feather"
            pyarrow.feather.write_feather(arrow, path, compression=compression, chunksize=3000)
            compare(f"Feather, {compression}", ours(path, folder), table)
        path = folder / "flight.arrows"
        with pyarrow.ipc.new_stream(path, arrow.schema) as stream:
            stream.write_table(arrow, max_chunksize=1234)
        compare("Arrow stream", ours(path, folder), table)

        # Our Parquet, as pyarrow reads it.
        target = folder / "ours.parquet"
        subprocess.run([EXAMPLES / "read_table", path, target], check=True, capture_output=True)
        back = pyarrow.parquet.read_table(target)
        found = {name: back[name].to_numpy(zero_copy_only=False) for name in back.column_names}
        compare("our Parquet in pyarrow", found, table)
        units = {field.name: field.metadata[b"unit"].decode() for field in back.schema}
        assert units["alpha_rad"] == "rad" and units["q_rad_s"] == "rad/s" and units["flag"] == "1", units
        assert back["wild"].null_count == numpy.isnan(table["wild"]).sum()
        workbook_of_a_refused_flight(folder)
        estimates(folder)


def workbook_of_a_refused_flight(folder):
    """A workbook with what a workbook can get wrong, in openpyxl: what looks like a formula is text, and what is no number is no
    cell."""
    path = folder / "refused.xlsx"
    subprocess.run([EXAMPLES / "export_workbook", path], check=True, capture_output=True)
    book = openpyxl.load_workbook(path)
    assert book.sheetnames == ["Result", "Parameters", "Correlation", "Covariance", "Changes", "Events"], book.sheetnames
    rows = {sheet: list(book[sheet].iter_rows(values_only=True)) for sheet in book.sheetnames}
    told = rows["Result"]
    assert told[1][:2] == ("status", "refused") and "neither the numbers" in told[2][1], told
    assert any(row[1] == "The lift has the wrong sign." for row in told), told
    head, first, second = rows["Parameters"]
    at = head.index
    assert first[at("name")] == "Cm_alpha" and first[at("value")] == -1.0 and first[at("unit")] == "per rad", first
    assert first[at("bound (2 sigma)")] == 0.04 and first[at("truth")] is None, first
    cell = book["Parameters"].cell(row=3, column=at("name") + 1)
    assert cell.value == "=1+1" and cell.data_type == "s", (cell.value, cell.data_type)
    assert second[at("value")] is None and second[at("std_error")] is None, second
    assert rows["Covariance"][0][1:] == ("Cm_alpha", "=1+1") and rows["Covariance"][1][2] == 0.25 * (0.02 * 0.5)
    assert rows["Correlation"][2][1] == 0.25
    names, change = rows["Changes"]
    assert [change[names.index(name)] for name in ("not before (s)", "not after (s)", "after")] == [3.5, 4.75, -1.0], change
    assert rows["Events"][1][1] == "adopted"
    print("  our workbook of a refused flight in openpyxl: words, numbers and gaps are those that were written")


def estimates(folder):
    """Estimates as Parquet in pyarrow, and as a workbook in openpyxl, against the same as CSV: text, numbers with null where
    there is none, truth values."""
    path = shared("flight/hfb320.csv")
    if path is None:
        return
    text, columns, workbook = folder / "estimates.csv", folder / "estimates.parquet", folder / "estimates.xlsx"
    command = [EXAMPLES / "export_estimates", path, "hfb320", text, columns, workbook]
    subprocess.run(command, check=True, capture_output=True)
    with open(text, newline="") as file:
        rows = list(csv.DictReader(file))
    found = pyarrow.parquet.read_table(columns)
    assert found.column_names == list(rows[0]) and found.num_rows == len(rows) == 11, found.schema
    number = lambda cell: float(cell) if cell else None
    of = {pyarrow.string(): str, pyarrow.float64(): number, pyarrow.bool_(): lambda cell: cell == "true"}
    for name in found.column_names:
        assert found[name].to_pylist() == [of[found.schema.field(name).type](row[name]) for row in rows], name
    print(f"  our estimates in pyarrow: {found.num_columns} columns of {found.num_rows} parameters are those of the CSV")
    sheets = openpyxl.load_workbook(workbook)
    head, *body = sheets["Parameters"].iter_rows(values_only=True)
    for name in ("name", "value", "std_error", "corrected_std_error", "lower", "upper", "status", "truth"):
        kind = str if name in ("name", "status") else number
        assert [line[head.index(name)] for line in body] == [kind(row[name]) for row in rows], name
    names, *matrix = sheets["Covariance"].iter_rows(values_only=True)
    assert list(names[1:]) == [line[0] for line in matrix] == [row["name"] for row in rows]
    for place, row in enumerate(rows):
        assert abs(matrix[place][1 + place] - float(row["corrected_std_error"]) ** 2) <= 1e-12 * matrix[place][1 + place]
    print(f"  our workbook in openpyxl: {len(body)} parameters of {', '.join(sheets.sheetnames)} are those of the CSV")


main()
