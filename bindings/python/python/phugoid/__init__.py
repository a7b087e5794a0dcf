"""Aerodynamic coefficients from flight data, each with a bound of two standard errors.

Read a flight, estimate the parameters of a model, and print one of them::

    import phugoid
    record = phugoid.Record.open("flight.csv")        # any format that the command line reads
    model = phugoid.Model.named("f16")                # or phugoid.Model.open("mine.toml")
    result = phugoid.estimate(record, model, progress=True)
    cm_alpha = result.parameter("dCm_alpha")
    print(cm_alpha.value, "+-", cm_alpha.bound)       # the bound is two standard errors

The names are those of the Rust library ``phugoid``.

SI units and radians throughout; body axes x forward, y right, z down.
"""

from __future__ import annotations

import copyreg
import json
import os
import warnings
from datetime import datetime
from typing import Any, Iterable, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _frames, _phugoid, _show
from ._fleet import campaign, command_shards, fleet, fleet_analyses, fleet_tell
from ._phugoid import Model, PhugoidError, Step, __version__
from ._plant import Formula, Plant, Symbols
from ._progress import Progress, reporter
from ._reproduction import Reproduction, cases, reproduce

__all__ = [
    "Compatibility",
    "Design",
    "Estimation",
    "Formula",
    "Model",
    "Parameter",
    "PhugoidError",
    "Plant",
    "Reason",
    "Record",
    "Reproduction",
    "Session",
    "Step",
    "Symbols",
    "__version__",
    "cases",
    "command_shards",
    "compare",
    "compatibility",
    "design",
    "estimate",
    "campaign",
    "fleet",
    "fleet_analyses",
    "fleet_tell",
    "from_columns",
    "from_frame",
    "inspect",
    "linearize",
    "methods",
    "read",
    "reproduce",
    "scenarios",
    "simulate",
    "trim",
]

Columns = Mapping[str, Union[str, Mapping[str, Any]]]


def _mappings(columns: Optional[Columns]) -> list[tuple[str, str, Optional[str], float]]:
    """Channel, header, unit, scale of ``{"elevator": "ELEV_POS"}`` or ``{"elevator": {"header": .., "unit": ..,
    "scale": ..}}``."""
    mappings = []
    for channel, source in (columns or {}).items():
        if isinstance(source, str):
            source = {"header": source}
        unknown = set(source) - {"header", "unit", "scale"}
        if unknown or "header" not in source:
            raise PhugoidError(f"columns['{channel}']: expected header, and perhaps unit and scale, found {sorted(source)}")
        mappings.append((channel, source["header"], source.get("unit"), float(source.get("scale", 1.0))))
    return mappings


class Record:
    """A flight: strictly increasing ``time`` (s) and channels in SI units and radians, NaN where a value is missing.

    ``record["alpha"]`` is a numpy array; ``record.channels`` are the names; ``record.quality`` lists what the reader
    found, converted, repaired and left out.
    """

    def __init__(self, native: _phugoid.Record) -> None:
        self._native = native

    @staticmethod
    def open(
        path: Any,
        model: Optional[Model] = None,
        columns: Optional[Columns] = None,
        max_memory: Optional[str] = None,
        *,
        names: Optional[Sequence[str]] = None,
        sample_time_s: Optional[float] = None,
        variable: Optional[str] = None,
    ) -> "Record":
        """Opens a flight of any format that the reader knows; the format is recognised from the content of the file.

        ``model`` (its table ``[channels]``) and ``columns`` assign headers of the file to channels by hand. Reading may
        take 200 MB of memory, or ``max_memory`` (``"500MB"``); a file that needs more is refused.

        ``names`` are those of the columns, with units, in the order of the file, for a table without a header or in place of
        it; ``sample_time_s`` counts the rows of a table without times; ``variable`` is the variable of a MATLAB file, or the
        sheet of a workbook, that is read.
        """
        return Record(
            _phugoid.Record.open(
                path, model, _mappings(columns), max_memory, list(names or []), sample_time_s, variable
            )
        )

    @staticmethod
    def from_columns(
        data: Mapping[str, Any],
        source: str = "columns",
        units: Optional[Mapping[str, str]] = None,
        columns: Optional[Columns] = None,
    ) -> "Record":
        """A flight from arrays by header. Headers say their units (``time_s``, ``alpha_deg``), or ``units`` does."""
        units = units or {}
        strange = set(units) - set(data)
        if strange:
            there = ", ".join(data)
            raise PhugoidError(f"units for columns that are not there: {', '.join(sorted(strange))}; there are {there}")
        arrays = []
        for header, values in data.items():
            try:
                array = np.ascontiguousarray(values, dtype=np.float64)
            except (TypeError, ValueError) as error:
                raise PhugoidError(
                    f"column '{header}': {error}; every column must be numbers, NaN where one is missing"
                ) from error
            if array.ndim != 1:
                raise PhugoidError(f"column '{header}' has the shape {array.shape}: expected one number per row")
            arrays.append(array)
        headers = [str(header) for header in data]
        native = _phugoid.Record.from_columns(
            source, headers, [units.get(header) for header in data], arrays, _mappings(columns)
        )
        return Record(native)

    @staticmethod
    def from_frame(frame: Any, source: str = "frame", columns: Optional[Columns] = None) -> "Record":
        """A flight from a pandas or polars ``DataFrame`` whose headers say their units. Columns that are no numbers are
        left out.

        The time is a column (``time_s``), or the index of a pandas frame where that is a ``DatetimeIndex`` or a
        ``TimedeltaIndex``, or the one column of dates. Dates are counted from the first one, which becomes the ``start`` of
        the record: in UTC where they have a time zone, whichever it is, else as they are written.

        :raises PhugoidError: if index and column both give times, or several columns hold dates and none is the time.
        """
        data, start = _frames.columns_of(frame)
        record = Record.from_columns(data, source=source, columns=columns)
        return record if start is None else Record(record._native.starting(start))

    @property
    def source(self) -> str:
        """The file that it was read from, or the name that it was given."""
        return self._native.source

    @property
    def time(self) -> np.ndarray:
        """Time of each sample, s, strictly increasing."""
        return self._native.time

    @property
    def start(self) -> Optional[datetime]:
        """When the time was zero, to the microsecond: aware (UTC) where the file says so or has the time of a satellite
        receiver, naive for a date whose time zone nobody wrote, None without a date."""
        return _frames.to_datetime(self._native.start)

    def with_start(self, start: Optional[datetime]) -> "Record":
        """A copy whose time was zero at ``start``, a datetime with or without a time zone; None: nobody knows."""
        return Record(self._native.starting(_frames.from_datetime(start)))

    @property
    def channels(self) -> list[str]:
        """Canonical names of the channels, for example ``alpha`` or ``true_airspeed``."""
        return self._native.channels

    @property
    def units(self) -> dict[str, str]:
        """SI unit of each channel, as printed."""
        return {name: self._native.unit(name) for name in self.channels}

    @property
    def quality(self) -> str:
        """What the reader found, converted, repaired and left out, as text."""
        return self._native.quality

    def __getitem__(self, name: str) -> np.ndarray:
        return self._native[name]

    def __contains__(self, name: str) -> bool:
        return name in self._native

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return repr(self._native)

    def _repr_html_(self) -> str:
        return _show.record_html(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return _record_of, (bytes(self._native.to_bytes()),)

    def between(self, start: Optional[float] = None, end: Optional[float] = None) -> "Record":
        """The part from one time (s) to another, both included."""
        return Record(self._native.between(start, end))

    def delete(
        self,
        start: float,
        end: Optional[float] = None,
        *,
        reason: str,
        channels: Union[str, Iterable[str], None] = None,
    ) -> "Record":
        """A copy without values that are known to be bad: they are missing (NaN), and every result lists how many, when and
        why.

        One sample, the nearest to ``start`` (s), or all from ``start`` to ``end``, both included; of one channel, of
        several, or of all. Where no value is, or without a reason, it is an error that names what would be right.
        """
        names = [channels] if isinstance(channels, str) else list(channels or [])
        return Record(self._native.delete(names, start, start if end is None else end, reason))

    @property
    def deletions(self) -> list[dict[str, Any]]:
        """What was deleted: ``from_s``, ``to_s``, ``reason``, and the number of values by channel in ``values``."""
        return [
            {"from_s": first, "to_s": last, "reason": reason, "values": dict(values)}
            for first, last, reason, values in self._native.deletions
        ]

    def write_csv(self, path: Any) -> None:
        """Writes the record as CSV, in SI units and with the units in the headers."""
        self._native.write_csv(path)

    def to_dict(self) -> dict[str, np.ndarray]:
        """Arrays under headers that say their units: ``time_s``, ``alpha_rad``, ..."""
        columns = {"time_s": self.time}
        columns.update((self._native.header(name), self._native[name]) for name in self.channels)
        return columns

    def to_pandas(self, index: Optional[str] = None) -> Any:
        """A pandas ``DataFrame`` with the headers of :meth:`to_dict`.

        Without ``index`` the time is the column ``time_s``. ``index="time"`` makes it the index: dates where the record has
        a ``start`` (with the time zone UTC where that is known), else durations; ``"datetime"`` and ``"timedelta"`` ask for
        one of them.
        """
        import pandas

        columns = self.to_dict()
        if index is None:
            return pandas.DataFrame(columns)
        return pandas.DataFrame(columns, index=_frames.index_of(columns.pop("time_s"), self._native.start, index))

    def to_polars(self) -> Any:
        """A polars ``DataFrame`` with the headers of :meth:`to_dict`."""
        import polars

        return polars.DataFrame(self.to_dict())


def _now(former: str, name: str) -> None:
    warnings.warn(f"phugoid.{former} is now phugoid.{name}", DeprecationWarning, stacklevel=3)


def read(path: Any, model: Optional[Model] = None, columns: Optional[Columns] = None) -> Record:
    """The former name of :meth:`Record.open`."""
    _now("read", "Record.open")
    return Record.open(path, model, columns)


def from_columns(
    data: Mapping[str, Any],
    source: str = "columns",
    units: Optional[Mapping[str, str]] = None,
    columns: Optional[Columns] = None,
) -> Record:
    """The former name of :meth:`Record.from_columns`."""
    _now("from_columns", "Record.from_columns")
    return Record.from_columns(data, source, units, columns)


def from_frame(frame: Any, source: str = "frame", columns: Optional[Columns] = None) -> Record:
    """The former name of :meth:`Record.from_frame`."""
    _now("from_frame", "Record.from_frame")
    return Record.from_frame(frame, source, columns)


class Parameter(NamedTuple):
    """The result for one parameter, per radian where an angle is involved."""

    #: Name in the model file.
    name: str
    #: Unit as printed: ``per rad``, ``-``; that of the sensor for a bias.
    unit: str
    #: Estimate at the end of the record.
    value: float
    #: One standard error, corrected for the correlation of the residuals from sample to sample.
    std_error: float
    #: State at the end of the record: ``converged``, ``improving``, ``not_excited``, ...
    status: str

    @property
    def bound(self) -> float:
        """Two standard errors, in the unit of the value."""
        return 2.0 * self.std_error


class Reason(NamedTuple):
    """One reason why a result is not sound."""

    code: str
    """What kind of reason it is, e.g. ``contradiction``, ``sign``, ``physics``; the words are those of the JSON document."""
    status: str
    """The status that it asks for: ``provisional``, ``doubtful`` or ``refused``."""
    concerns: list[str]
    """Names of the outputs, parameters, channels or keys of the model file that it is about."""
    sentence: str
    """What was found and what to do."""


class Estimation:
    """The result of an estimation. ``result["Cm_alpha"]`` is the value and its one-sigma error; bounds are two of
    them."""

    def __init__(self, native: _phugoid.Estimation) -> None:
        self._native = native

    @property
    def source(self) -> str:
        """The file or the scenario of the record."""
        return self._native.source

    @property
    def method(self) -> str:
        """Name of the estimator that was used, one of :func:`methods`."""
        return self._native.method

    @property
    def names(self) -> list[str]:
        """Names of the parameters; sensor biases and other supporting parameters come last."""
        return self._native.names

    @property
    def values(self) -> np.ndarray:
        """Estimates at the end of the record, in the order of ``names``."""
        return self._native.values

    @property
    def std_errors(self) -> np.ndarray:
        """Standard errors (one sigma) at the end, corrected for the correlation of the residuals from sample to
        sample."""
        return self._native.std_errors

    @property
    def systematic_std_errors(self) -> np.ndarray:
        """The parts of ``std_errors`` that the uncertainties declared in the model file make (one sigma): a longer flight does
        not make them smaller. Zero where nothing is declared."""
        return self._native.systematic_std_errors

    @property
    def totals(self) -> dict[str, tuple[float, float]]:
        """Of a longitudinal model of increments to a database, the total derivatives, which hold the slopes of the database:
        value and one-sigma error by name, such as ``Cm_alpha``. Empty for any other model."""
        return self._native.totals

    @property
    def status(self) -> str:
        """What the result as a whole is worth: ``sound``, ``provisional`` (nothing speaks against it, but the flight does
        not settle it), ``doubtful`` or ``refused`` (use neither the numbers nor their bounds)."""
        return self._native.status

    @property
    def reasons(self) -> list[Reason]:
        """Why the result is not ``sound``, the severest first; empty for a sound one."""
        return [Reason(*reason) for reason in self._native.reasons]

    @property
    def verdict(self) -> list[str]:
        """Assessment of the result in sentences: which estimates can be used, and which cannot and why."""
        return self._native.verdict

    @property
    def history(self) -> Record:
        """Inputs, outputs, predictions, residuals, each parameter and its standard error ``<parameter>_std``, at each
        sample."""
        return Record(self._native.history)

    def __getitem__(self, name: str) -> tuple[float, float]:
        return self._native[name]

    def parameter(self, name: str) -> Optional[Parameter]:
        """The result for the parameter of this name; None if the model has no such parameter."""
        for found in self.to_dict()["parameters"]:
            if found["name"] == name:
                return Parameter(name, found["unit"], found["value"], found["corrected_std_error"], found["status"])
        return None

    @property
    def correlation(self) -> np.ndarray:
        """Correlation matrix of the errors, rows and columns in the order of ``names``; 0 off the diagonal for a fixed
        parameter."""
        return _frames.covariance(self._native.correlation, np.ones(len(self.names)))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance matrix of the estimates, rows and columns in the order of ``names``: ``correlation`` with the
        ``std_errors``, in the products of the parameters' units."""
        return _frames.covariance(self._native.correlation, self.std_errors)

    def covariance_to_pandas(self) -> Any:
        """The covariance matrix as a pandas ``DataFrame`` with the names at its rows and columns."""
        import pandas

        return pandas.DataFrame(self.covariance, index=self.names, columns=self.names)

    def plot(self, what: Union[str, Sequence[str]] = "parameters") -> Any:
        """Draws the result with matplotlib (``pip install "phugoid[plot]"``) and returns the figure.

        ``what`` is ``"parameters"`` (each over the time, with its bound of two standard errors, its unit, and the truth where
        that is known), ``"outputs"`` (measured and predicted), or the names of some parameters. The histories begin with wide
        bounds: an axis holds the last three quarters of the record.

        :raises PhugoidError: if there is no such parameter.
        """
        if isinstance(what, str) and what == "outputs":
            return _show.plot_outputs(self)
        if isinstance(what, str) and what == "parameters":
            names = [p["name"] for p in self.to_dict()["parameters"] if not p["nuisance"]] or self.names
        else:
            names = [what] if isinstance(what, str) else list(what)
        strange = [name for name in names if name not in self.names]
        if strange or not names:
            raise PhugoidError(
                f"plot('{', '.join(strange)}'): expected 'parameters', 'outputs', or some of {', '.join(self.names)}"
            )
        return _show.plot_parameters(self, names)

    def __repr__(self) -> str:
        return repr(self._native)

    def _repr_html_(self) -> str:
        return _show.estimation_html(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return _estimation_of, (bytes(self._native.to_bytes()),)

    def to_dict(self) -> dict[str, Any]:
        """Everything but the histories, with the names of ``phugoid estimate --json``."""
        document: dict[str, Any] = json.loads(self._native.to_json())
        return document

    def _table(self) -> dict[str, list[Any]]:
        columns = ("name", "value", "corrected_std_error", "lower", "upper", "status", "truth", "unit", "systematic_std")
        parameters = self.to_dict()["parameters"]
        return {column: [parameter[column] for parameter in parameters] for column in columns}

    def to_pandas(self) -> Any:
        """The parameters as a pandas ``DataFrame``, by name: value, standard error, bounds of two of these, status, truth
        (NaN where it is not known), unit, and the part of the standard error that is declared in the model file."""
        import pandas

        table = pandas.DataFrame(self._table()).set_index("name")
        # A column of nothing but None would be one of objects.
        numbers = ("value", "corrected_std_error", "lower", "upper", "truth", "systematic_std")
        return table.astype({column: float for column in numbers})

    def to_polars(self) -> Any:
        """The parameters as a polars ``DataFrame``."""
        import polars

        return polars.DataFrame(self._table())


def _record_of(state: bytes) -> Record:
    """The record that was pickled."""
    return Record(_phugoid.Record.from_bytes(state))


def _estimation_of(state: bytes) -> Estimation:
    """The result that was pickled."""
    return Estimation(_phugoid.Estimation.from_bytes(state))


def _model_of(text: str, source: str) -> Model:
    """The model that was pickled."""
    return Model.parse(text, source)


def _reduced(model: Model) -> tuple[Any, ...]:
    return _model_of, (model.toml, model.source)


# The class is native: this is how pickle and copy learn what it is made of.
copyreg.pickle(Model, _reduced)


def _structure(structure: Optional[str], offer: Optional[str]) -> str:
    """The word for what is done about missing terms, from it or its former spelling."""
    if structure is not None:
        return structure
    former = {"reason": "offer", "always": "offer"}
    return "offer" if offer is None else former.get(offer, offer)


def estimate(
    record: Record,
    model: Model,
    *,
    method: Optional[str] = None,
    change_detection: Optional[bool] = None,
    causal_only: bool = False,
    structure: Optional[str] = None,
    truth: Optional[Mapping[str, float]] = None,
    further: Iterable[Record] = (),
    predict: Optional[Record] = None,
    progress: Progress = None,
    likelihood: str = "robust",
    flow_angles: str = "auto",
    band: Optional[tuple[float, float]] = None,
    offer: Optional[str] = None,
) -> Estimation:
    """Estimates the parameters of ``model`` from ``record``. Other Python threads can run during the estimation.

    ``method`` is one of :func:`methods`; without it, the one that the model file names is used. ``change_detection``
    switches the detection of sudden changes on or off; without it, the model file decides. SMPE and the EKF, with a
    model in absolute form, begin again from the values of equation error where that predicts the record much better,
    look at the whole record again for changes that were not found in flight, and equation error is held
    against them (``second_answer`` in :meth:`Estimation.to_dict`), and SMPE against the
    regressions (and against filter error and output error, ``third_answer``); with ``causal_only`` the result is what a
    :class:`Session` would have had. ``truth`` gives the true
    values of a simulated flight, for the comparison only: the estimator does not see them. A batch method fits
    ``further`` records together with the first one, and tests the result on the record ``predict``. ``progress`` is
    True for a bar, or a function that is called with the fraction done, from 0 to 1.

    ``structure`` says what is done about terms that the equations of motion ask for and the model lacks: ``"offer"`` (they
    are looked for and offered; the estimates stay those of the model), ``"never"``, or ``"auto"`` (the estimates are those
    of the model with the missing terms). The default is that of ``phugoid estimate`` on the command line; that of the Rust
    library is ``Never``. ``likelihood`` is what a batch method takes the noise for: ``"robust"`` counts a value the less the
    further from the model it is, or leaves it out where it stands alone; ``"gaussian"`` counts every value with its square.
    ``flow_angles`` is where output error has airspeed and the angles of attack and sideslip from: ``"simulated"``, ``"measured"``
    (and not fitted), or ``"auto"``, which takes them as measured where the air is not calm, without the noise that accelerations,
    rates and attitude tell from gusts. ``band`` is the band of frequencies of a method in the frequency domain, ``(low, high)``
    in Hz; without it, it is found from the record. ``offer`` is the former spelling: ``"reason"`` and ``"always"`` stand for ``"offer"``.

    :raises PhugoidError: if a channel that the model needs is missing, or the record and the options do not fit the
        model.
    """
    with reporter(progress, "estimating") as report:
        native = _phugoid.estimate(
            record._native,
            model,
            method,
            change_detection,
            causal_only,
            _structure(structure, offer),
            dict(truth or {}),
            [further_record._native for further_record in further],
            predict._native if predict is not None else None,
            report,
            likelihood,
            flow_angles,
            (band[0], band[1]) if band is not None else None,
        )
    return Estimation(native)


class Session:
    """A live estimation: one sample in, one estimate out, with the code that runs over records, bit for bit.

    The first two seconds are collected, because noise levels and the reference point come from them::

        session = phugoid.Session(model)
        sample = np.empty(len(session.channels))       # SI, in the order of session.channels, NaN where missing
        step = session.update(time_s, sample)
        if step:
            print(session.values, session.std_errors)  # in the order of session.parameters
        else:
            print(step.kind, step.reason)              # waiting or refused, and why
    """

    def __init__(self, model: Model, *, method: Optional[str] = None, change_detection: Optional[bool] = None) -> None:
        self._native = _phugoid.Session(model, method, change_detection)

    def update(self, time_s: float, sample: np.ndarray) -> Step:
        """Takes a sample: time (s), and one value per channel, SI, NaN where missing.

        The answer is true if there is an estimate after it. If not, ``kind`` is ``"waiting"`` (the sample was used to measure
        the noise, and there is no estimate yet) or ``"refused"`` (it was not used: its time does not come after the last one,
        or it has not one value per channel), and ``reason`` says why.

        :raises PhugoidError: if an estimation is impossible, as where units are certainly wrong; the session stays as it was.
        """
        return self._native.update(time_s, sample)

    @property
    def channels(self) -> list[str]:
        """Names of the channels whose values :meth:`update` takes, in this order and in SI units."""
        return self._native.channels

    @property
    def parameters(self) -> list[str]:
        """Names of the parameters, in the order of ``values`` and ``std_errors``."""
        return self._native.parameters

    @property
    def values(self) -> Optional[np.ndarray]:
        """Estimates after the last sample; None before the first estimate."""
        return self._native.values

    @property
    def std_errors(self) -> Optional[np.ndarray]:
        """Standard errors (one sigma) after the last sample, corrected for correlated residuals; None before the first
        estimate."""
        return self._native.std_errors

    @property
    def systematic_std_errors(self) -> Optional[np.ndarray]:
        """The parts of ``std_errors`` that the uncertainties declared in the model file make (one sigma); None before the
        first estimate."""
        return self._native.systematic_std_errors

    @property
    def message(self) -> Optional[str]:
        """Why the last sample gave no estimate; None if it gave one."""
        return self._native.message

    def snapshot(self) -> Optional[dict[str, Any]]:
        """All results after the last sample, as in the live protocol; None before the first estimate."""
        text = self._native.snapshot_json()
        document: Optional[dict[str, Any]] = None if text is None else json.loads(text)
        return document

    def layout(self) -> dict[str, Any]:
        """Names and units of the entries of a snapshot."""
        layout: dict[str, Any] = json.loads(self._native.layout_json())
        return layout

    def take_events(self) -> list[dict[str, Any]]:
        """Events since the last call: changes, gaps, restarts."""
        events: list[dict[str, Any]] = json.loads(self._native.take_events_json())
        return events

    def __repr__(self) -> str:
        return repr(self._native)


def inspect(record: Record, model: Optional[Model] = None) -> dict[str, Any]:
    """Lists what a flight contains: channels, gaps, noise, doubtful units, manoeuvres.

    The document is that of ``phugoid inspect --json``, in SI units and radians:

    - ``source``, ``samples``, ``span_s`` (first and last time), ``sample_time_s``, ``gaps_s`` (from and to, the longest ten);
    - ``channels``: of each its name, header and unit in the file, values, missing ones, rate, range and noise;
    - ``quality`` and ``doubts``: what the reader found, and which units and signs are implausible;
    - ``found``: manoeuvres, motion without an input, and why nothing can be estimated, where that is so;
    - ``derivatives``: for each the manoeuvre from which it can be estimated best;
    - ``coherence`` of each surface that was moved and each output.
    """
    document: dict[str, Any] = json.loads(_phugoid.inspect(record._native, model))
    return document


def _number(value: Optional[float]) -> float:
    """NaN where the document has none: an unknown that was refused."""
    return float("nan") if value is None else value


class Compatibility:
    """Estimated sensor errors. ``found["bias_q"]`` is the value and its standard error (one sigma), in the SI unit of
    the sensor; both are NaN where the estimate is refused."""

    def __init__(self, document: dict[str, Any], corrected: Record) -> None:
        self._document = document
        #: The record, corrected for the errors that are offered as corrections (``offered``).
        self.corrected = corrected

    @property
    def names(self) -> list[str]:
        """Names of the estimated errors: biases, scale factors, delays."""
        return [error["name"] for error in self._document["errors"]]

    @property
    def notes(self) -> list[str]:
        """Warnings to read before the numbers are used, in sentences."""
        return list(self._document["notes"])

    def __getitem__(self, name: str) -> tuple[float, float]:
        for error in self._document["errors"]:
            if error["name"] == name:
                return _number(error["value"]), _number(error["std_error"])
        raise KeyError(f"no error `{name}` was estimated; there are {', '.join(self.names)}")

    def to_dict(self) -> dict[str, Any]:
        """Everything, with the names of ``phugoid compatibility --json``."""
        return self._document

    def __repr__(self) -> str:
        lines = "".join(
            f"\n  {e['name']:<18} {_number(e['value']):>12.5g} +- {2 * _number(e['std_error']):.2g} {e['unit']}  {e['verdict']}"
            for e in self._document["errors"]
        )
        return f"<Compatibility of '{self._document['source']}'{lines}>"


def compatibility(
    record: Record,
    *,
    groups: Optional[Iterable[str]] = None,
    vanes_x_m: Sequence[float] = (0.0, 0.0),
    gravity_m_s2: Optional[float] = None,
    flat_earth: bool = False,
    unknowns: Optional[Iterable[str]] = None,
    without: Iterable[str] = (),
    hold: Optional[Mapping[str, float]] = None,
) -> Compatibility:
    """Checks the sensors against the kinematics of a rigid body, and estimates their errors without any aerodynamics.

    Biases are always estimated; ``groups`` names what else: ``air-data-scales``, ``attitude-scales`` and ``delays`` if
    not given, ``inertial-scales``, ``vane-positions``, ``accelerometer-position``, ``upwash``, ``wind``. ``vanes_x_m``
    is how far the vanes of alpha and beta are ahead of the centre of gravity. Without ``gravity_m_s2`` gravity follows
    from the latitude and altitude of the record, and is uncertain for what is not known. ``flat_earth`` is for flights of
    a simulator whose Earth is flat, as that of this package is.

    ``unknowns`` names the only errors to estimate, in place of biases and groups; ``without`` some that are not estimated;
    both take what is not estimated for zero. ``hold`` has errors that are known, by name, in SI units: they are not
    estimated, and become part of the corrections.
    """
    wanted = None if groups is None else list(groups)
    text, corrected = _phugoid.compatibility(
        record._native,
        wanted,
        list(vanes_x_m),
        gravity_m_s2,
        flat_earth,
        None if unknowns is None else list(unknowns),
        list(without),
        [(name, float(value)) for name, value in (hold or {}).items()],
    )
    return Compatibility(json.loads(text), Record(corrected))


class Design:
    """An input for a flight test. ``design.input`` has the deflections of the surfaces from trim (rad) by time,
    ``design.flight`` is the flight that they make, as the sensors of the scenario measure it."""

    def __init__(self, document: dict[str, Any], deflections: Record, flight: Record) -> None:
        self._document = document
        #: Deflections from trim, rad, by surface.
        self.input = deflections
        #: The flight with this input, with the noise of the sensors.
        self.flight = flight

    @property
    def bounds(self) -> dict[str, float]:
        """The smallest standard error (one sigma) that any unbiased estimator can have on this flight, by parameter of the
        model, in the parameter's unit; infinite where the input does not determine it, empty without a model."""
        prediction = self._document["prediction"] or {"parameters": []}
        # JSON has no infinity.
        return {p["name"]: float("inf") if p["std_error"] is None else p["std_error"] for p in prediction["parameters"]}

    def to_dict(self) -> dict[str, Any]:
        """Everything else, with the names of ``phugoid design --json``, in SI units: ``scenario``, ``modes`` (natural
        frequencies, rad/s), ``limits``, ``design`` (kind, band, inputs), ``peaks`` (largest deflection, rad, and rate, rad/s,
        of each surface), ``limited_by`` (the limit that keeps each surface from moving more), ``excursions`` (how far the
        aircraft moves from trim) and ``prediction`` (None without a model)."""
        return self._document

    def __repr__(self) -> str:
        kind = self._document["design"]["kind"]
        peaks = ", ".join(f"{name} {np.degrees(np.abs(self.input[name]).max()):.3g} deg" for name in self.input.channels)
        return f"<Design {kind} for '{self._document['scenario']}': {peaks}, {self.input.time[-1]:.4g} s>"


def design(
    kind: str,
    surfaces: Union[str, Iterable[str]] = "elevator",
    *,
    scenario: str = "f16-calm",
    model: Optional[Model] = None,
    duration_s: float = 20.0,
    lead_s: float = 0.5,
    band_hz: Optional[tuple[float, float]] = None,
    linear_sweep: bool = False,
    amplitudes_rad: Iterable[float] = (),
    limits: Optional[Mapping[str, float]] = None,
) -> Design:
    """Designs an input: ``kind`` is ``"doublet"``, ``"3-2-1-1"``, ``"sweep"`` or ``"multisine"``.

    ``surfaces`` are ``elevator``, ``aileron`` and ``rudder``; ``scenario``, a file or one of :func:`scenarios`, gives aircraft,
    condition, sample rate and sensors. The input is as large as the ``limits`` allow, in SI units: ``deflection`` (5 deg),
    ``surface_rate`` (60 deg/s), ``alpha`` (3 deg), ``load_factor`` (0.5 g), ``beta`` (3 deg), ``bank`` (30 deg); or it has the
    ``amplitudes_rad``, one for each surface. ``duration_s`` includes the quiet ``lead_s``; ``band_hz`` is that of sweeps and
    multisines, from the modes of the aircraft if not given. With a ``model``, ``bounds`` of the result say what the flight will
    tell. The amplitudes come from a simulation: begin with a tenth of them on a real aircraft.

    :raises PhugoidError: if the input does not fit into the time, a limit is not positive, or a word is not known.
    """
    usual = ("deflection", "surface_rate", "alpha", "load_factor", "beta", "bank")
    strange = set(limits or {}) - set(usual)
    if strange:
        raise PhugoidError(f"limits: there is no limit on {', '.join(sorted(strange))}; there are {', '.join(usual)}")
    given = {name: float(value) for name, value in (limits or {}).items()}
    unclear = [name for name, value in given.items() if np.isnan(value)]
    if unclear:
        raise PhugoidError(f"limits: {', '.join(unclear)} is NaN: give a number, or leave it out")
    text, deflections, flight = _phugoid.design(
        kind,
        [surfaces] if isinstance(surfaces, str) else list(surfaces),
        scenario,
        model,
        duration_s,
        lead_s,
        None if band_hz is None else [float(band_hz[0]), float(band_hz[1])],
        linear_sweep,
        [float(amplitude) for amplitude in amplitudes_rad],
        [given.get(name, float("nan")) for name in usual],
    )
    return Design(json.loads(text), Record(deflections), Record(flight))


def simulate(scenario: str, seed: Optional[int] = None) -> tuple[Record, Record, dict[str, float]]:
    """Simulates a scenario (a file, or one of :func:`scenarios`).

    Returns the measured record, the true record, and the true parameters by name. ``seed`` replaces the seed of the
    scenario. What is left out of the file of an aircraft and what is assumed is warned of.
    """
    measured, truth, parameters, notes = _phugoid.simulate(scenario, seed)
    if notes:
        warnings.warn("the aircraft of this scenario: " + " ".join(notes), stacklevel=2)
    return Record(measured), Record(truth), json.loads(parameters)


def _aircraft(
    aircraft: str | os.PathLike[str],
    with_files: Iterable[str | os.PathLike[str]],
    properties: Optional[Mapping[str, float]],
) -> tuple[str, list[str], list[tuple[str, float]]]:
    files = [os.fspath(file) for file in with_files]
    return os.fspath(aircraft), files, [(name, float(value)) for name, value in (properties or {}).items()]


def trim(
    altitude_m: float,
    speed_m_s: float,
    *,
    cg: Optional[float] = None,
    flight_path_rad: float = 0.0,
    turn_rate_rad_s: float = 0.0,
    aircraft: str | os.PathLike[str] = "f16",
    with_files: Iterable[str | os.PathLike[str]] = (),
    properties: Optional[Mapping[str, float]] = None,
) -> dict[str, Any]:
    """Controls and attitude that hold an aircraft in steady flight. Angles in rad.

    ``aircraft`` is ``"f16"``, the path of a model file, the name of a built-in model (``"hfb320"``), the file or folder of an
    aircraft of JSBSim, or a model in DAVE-ML, whose further files (mass and inertia, engine) are ``with_files``.
    ``properties`` sets properties of JSBSim in its units, variables in DAVE-ML in the unit of their file, and mass, inertia
    and sizes that no file has in SI. ``cg``, a fraction of the mean chord, is that of the F-16 (0.35). ``notes`` of the
    result say what the file leaves out and what is assumed.
    """
    document: dict[str, Any] = json.loads(
        _phugoid.trim(
            altitude_m,
            speed_m_s,
            cg,
            flight_path_rad,
            turn_rate_rad_s,
            *_aircraft(aircraft, with_files, properties),
        )
    )
    return document


def linearize(
    altitude_m: float,
    speed_m_s: float,
    *,
    cg: Optional[float] = None,
    flight_path_rad: float = 0.0,
    turn_rate_rad_s: float = 0.0,
    aircraft: str | os.PathLike[str] = "f16",
    with_files: Iterable[str | os.PathLike[str]] = (),
    properties: Optional[Mapping[str, float]] = None,
) -> dict[str, Any]:
    """Linear model of an aircraft about a trim: ``model``, and its ``longitudinal`` and ``lateral`` parts with their modes.

    The matrices are numpy arrays; the arguments are those of :func:`trim`.
    """
    document: dict[str, Any] = json.loads(
        _phugoid.linearize(
            altitude_m,
            speed_m_s,
            cg,
            flight_path_rad,
            turn_rate_rad_s,
            *_aircraft(aircraft, with_files, properties),
        )
    )
    for part in ("model", "longitudinal", "lateral"):
        for matrix in {"A", "B", "C", "D"} & set(document[part]):
            document[part][matrix] = np.array(document[part][matrix])
    return document


def compare(
    scenarios: Iterable[str], methods: Iterable[str] = (), seeds: int = 20, progress: Progress = None
) -> dict[str, Any]:
    """Compares methods on the same simulated flights: the document of ``phugoid compare --json``.

    ``scenarios`` are names of built-in entries of the comparison, each flown ``seeds`` times; without ``methods``, all
    run.
    """
    with reporter(progress, "comparing") as report:
        document: dict[str, Any] = json.loads(_phugoid.compare(list(scenarios), list(methods), seeds, report))
    return document


def scenarios() -> list[str]:
    """Built-in scenarios that :func:`simulate` flies."""
    return _phugoid.names()[0]


def methods() -> list[str]:
    """Names of the estimators, as :func:`estimate` and :func:`compare` take them."""
    return _phugoid.names()[2]
