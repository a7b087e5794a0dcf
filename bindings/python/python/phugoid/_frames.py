"""Times of frames: dates and durations to seconds and back. Pandas and polars are imported by who has them."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from typing import Any, Iterable, Optional

import numpy as np

from ._phugoid import PhugoidError

#: When time zero was: seconds from 1970-01-01T00:00:00, and whether that is UTC.
Start = Optional[tuple[float, bool]]

_EPOCH = datetime(1970, 1, 1)


def to_datetime(start: Start) -> Optional[datetime]:
    """A start as a date, to the microsecond: aware of UTC where that is known, else naive."""
    if start is None:
        return None
    unix_s, is_utc = start
    try:
        naive = _EPOCH + timedelta(microseconds=round(unix_s * 1e6))
    except OverflowError:
        return None
    return naive.replace(tzinfo=timezone.utc) if is_utc else naive


def from_datetime(when: Optional[datetime]) -> Start:
    """A date as a start; a naive one is taken for the local time that nobody wrote a zone to."""
    if when is None:
        return None
    if not isinstance(when, datetime):
        raise PhugoidError(f"expected a datetime (or a pandas Timestamp), found {when!r}")
    is_utc = when.utcoffset() is not None
    naive = when.astimezone(timezone.utc).replace(tzinfo=None) if is_utc else when
    return (naive - _EPOCH) / timedelta(seconds=1), is_utc


def _of_index(frame: Any) -> Optional[tuple[np.ndarray, Start, str]]:
    """Seconds and start from the index of a pandas frame; None where the index is no time, or there is none."""
    index: Any = getattr(frame, "index", None)
    kind = getattr(getattr(index, "dtype", None), "kind", None)
    if kind not in ("M", "m"):
        return None
    name = f"the index '{index.name}'" if index.name is not None else "the index"
    if kind == "m":
        return _seconds(index.to_numpy()), None, name
    is_utc = index.tz is not None
    return (*_instants((index.tz_convert("UTC").tz_localize(None) if is_utc else index).to_numpy(), is_utc, name), name)


def _seconds(durations: np.ndarray) -> np.ndarray:
    """Durations (timedelta64) in seconds; NaN where one is missing."""
    seconds: np.ndarray = durations / np.timedelta64(1, "s")
    return seconds


def _instants(instants: np.ndarray, is_utc: bool, name: str) -> tuple[np.ndarray, Start]:
    """Dates (datetime64) in seconds from the first of them, and when that was."""
    there = instants[~np.isnat(instants)]
    if not there.size:
        raise PhugoidError(f"{name} holds no date: give every row its time")
    first = there.min()
    return _seconds(instants - first), (float(_seconds(first - np.datetime64(0, "s"))), is_utc)


def _is_date(series: Any) -> bool:
    kind = getattr(series.dtype, "kind", None)  # pandas
    return kind == "M" or str(series.dtype).startswith("Datetime")  # polars


def _of_column(series: Any, header: str) -> tuple[np.ndarray, Start]:
    is_utc = getattr(series.dtype, "time_zone", None) is not None  # polars: the numbers are those of UTC
    if getattr(series.dtype, "tz", None) is not None:  # pandas
        is_utc, series = True, series.dt.tz_convert("UTC").dt.tz_localize(None)
    return _instants(np.asarray(series.to_numpy(), dtype="datetime64[ns]"), is_utc, f"column '{header}'")


def _is_time(header: str) -> bool:
    return header.lower() in ("time", "t") or header.lower().startswith(("time_", "t_", "time ["))


def _numbers_of_index(frame: Any) -> dict[str, Any]:
    """An index of numbers that is called a time, with its name as the header: any other index of numbers counts rows."""
    index: Any = getattr(frame, "index", None)
    name = getattr(index, "name", None)
    is_number = getattr(getattr(index, "dtype", None), "kind", None) in ("f", "i", "u")
    return {name: index.to_numpy()} if is_number and isinstance(name, str) and _is_time(name) else {}


def columns_of(frame: Any) -> tuple[dict[str, Any], Start]:
    """The columns of a frame that are numbers, and the time in seconds from its index or its one column of dates."""
    data: dict[str, Any] = _numbers_of_index(frame)
    of_index = next(iter(data), None)
    found = _of_index(frame)
    dates = []
    for header in frame.columns:
        series = frame[header]
        if _is_date(series):
            dates.append(header)
            continue
        values = series.to_numpy()
        if np.issubdtype(values.dtype, np.number) or values.dtype == bool:
            data[str(header)] = values
    times = [header for header in data if _is_time(header)]
    if of_index is not None and (len(times) > 1 or of_index in map(str, frame.columns)):
        raise PhugoidError(
            f"the index '{of_index}' and the column '{times[-1]}' both give times: drop the column, or take the index away "
            "with reset_index(drop=True)"
        )
    if found is None and not times and len(dates) == 1:
        found = (*_of_column(frame[dates[0]], str(dates[0])), f"column '{dates[0]}'")
    if found is None:
        if not times and len(dates) > 1:
            listed = "', '".join(map(str, dates))
            raise PhugoidError(f"the columns '{listed}' hold dates: drop all of them but the time of the samples")
        return data, None
    seconds, start, name = found
    if times:
        raise PhugoidError(
            f"{name} and the column '{times[0]}' both give times: drop the column, or take the index away with "
            "reset_index(drop=True)"
        )
    return {"time_s": seconds, **data}, start


def index_of(time: np.ndarray, start: Start, wanted: str) -> Any:
    """The times (s) as a pandas index: ``datetime``, ``timedelta``, or ``time``, which is the first of them that can be."""
    import pandas

    if wanted not in ("time", "datetime", "timedelta"):
        raise PhugoidError(f"index = '{wanted}': expected 'time', 'datetime' or 'timedelta', or None for a column time_s")
    steps = pandas.TimedeltaIndex(np.round(time * 1e9).astype("timedelta64[ns]"), name="time")
    if wanted == "timedelta" or (wanted == "time" and start is None):
        return steps
    if start is None:
        raise PhugoidError("nobody wrote when this record begins: take index='timedelta', or record.with_start(datetime)")
    unix_s, is_utc = start
    zero = pandas.Timestamp(np.datetime64(round(unix_s * 1e6), "us"))
    instants = pandas.DatetimeIndex(zero + steps, name="time")
    return instants.tz_localize("UTC") if is_utc else instants


def covariance(correlation: Iterable[Iterable[float]], std_errors: np.ndarray) -> np.ndarray:
    """Correlations and standard errors as a covariance matrix."""
    matrix = np.array([list(row) for row in correlation], dtype=float).reshape(std_errors.size, std_errors.size)
    result: np.ndarray = matrix * np.outer(std_errors, std_errors)
    return result
