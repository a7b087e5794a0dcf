"""Writes the small files that the tests of phugoid-flight-data read, with the formats' own tools.

Usage: table_fixtures.py FOLDER   (crates/phugoid-flight-data/tests/data)
Every number is a small fraction of two, so that the tests can state it exactly.
"""

import pathlib
import sys

import numpy as np
import scipy.io

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
    values = {name: {"values": value, "unit": {"q": "deg/s"}.get(name, "")} for name, value in table.items()}
    save("values.mat", values, oned_as="column")
    matrix = np.column_stack([np.asarray(value, dtype=float) for value in table.values()])
    names = np.array(list(table), dtype=object)
    unit_list = np.array([{"q": "deg/s"}.get(name, "") for name in table], dtype=object)
    save("matrix.mat", {"data": matrix, "data_names": names, "data_units": unit_list})
    save("transposed.mat", {"data": matrix.T, "names": names, "units": unit_list}, do_compression=True)
    save("version4.mat", {"time_s": table["time_s"]}, format="4")


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    matlab(folder)


if __name__ == "__main__":
    main()
