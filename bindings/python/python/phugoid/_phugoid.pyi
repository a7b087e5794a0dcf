from os import PathLike
from typing import Any, Callable, Optional, Union, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "__version__",
    "PhugoidError",
    "Record",
    "Model",
    "Estimation",
    "Session",
    "Step",
    "inspect",
    "compatibility",
    "estimate",
    "design",
    "trim",
    "linearize",
    "simulate",
    "compare",
    "names",
    "case_toml",
    "cases",
    "reproduce",
    "CampaignTask",
    "FleetTask",
    "fleet_analyses",
    "fleet_files",
    "fleet_hash",
    "fleet_model",
    "fleet_store",
    "fleet_tell",
]

__version__: str

_Array = NDArray[np.float64]
_Mapping = tuple[str, str, Optional[str], float]
_Path = Union[str, PathLike[str]]
_Report = Optional[Callable[[float], Any]]

class PhugoidError(ValueError): ...

@final
class Record:
    source: str
    time: _Array
    channels: list[str]
    quality: str
    @staticmethod
    def open(
        path: _Path,
        model: Optional[Model] = ...,
        mappings: list[_Mapping] = ...,
        max_memory: Optional[str] = ...,
        names: list[str] = ...,
        sample_time_s: Optional[float] = ...,
        variable: Optional[str] = ...,
    ) -> Record: ...
    @staticmethod
    def from_columns(
        source: str, headers: list[str], units: list[Optional[str]], values: list[_Array], mappings: list[_Mapping]
    ) -> Record: ...
    def unit(self, name: str) -> str: ...
    def header(self, name: str) -> str: ...
    def between(self, start: Optional[float] = ..., end: Optional[float] = ...) -> Record: ...
    deletions: list[tuple[float, float, str, list[tuple[str, int]]]]
    start: Optional[tuple[float, bool]]
    def starting(self, start: Optional[tuple[float, bool]]) -> Record: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> Record: ...
    def delete(self, channels: list[str], start: float, end: float, reason: str) -> Record: ...
    def write_csv(self, path: _Path) -> None: ...
    def __getitem__(self, name: str, /) -> _Array: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __len__(self) -> int: ...

@final
class Model:
    """An aircraft, its coefficient build-up and what is known beforehand: ``Model.named``, ``Model.open``, ``Model.parse``."""

    source: str
    name: str
    parameters: list[str]
    channels: list[str]
    axes: list[str]
    toml: str
    """The text (TOML) that it was read from."""
    table: list[tuple[str, str, float, float, Optional[list[float]], bool, bool]]
    """Of each parameter: name, unit, start value, one sigma of what is known beforehand, lower and upper limit (None without),
    whether it is fixed, and whether it only supports the others."""
    def __new__(cls, name: str) -> Model:
        """The former way in: the file at this path, or the built-in model of this name."""

    @staticmethod
    def named(name: str) -> Model:
        """The built-in model with this name."""

    @staticmethod
    def open(path: _Path) -> Model:
        """Reads and checks the model file at this path."""

    @staticmethod
    def parse(text: str, name: str = ...) -> Model: ...
    @staticmethod
    def built_in() -> list[str]: ...
    @staticmethod
    def text(name: str) -> str: ...
    def _repr_html_(self) -> str: ...

@final
class Estimation:
    source: str
    correlation: list[list[float]]
    method: str
    names: list[str]
    values: _Array
    std_errors: _Array
    systematic_std_errors: _Array
    totals: dict[str, tuple[float, float]]
    status: str
    reasons: list[tuple[str, str, list[str], str]]
    verdict: list[str]
    history: Record
    def to_json(self) -> str: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> Estimation: ...
    def __getitem__(self, name: str, /) -> tuple[float, float]: ...

@final
class Step:
    """What has become of a sample: true where there is an estimate after it."""

    kind: str
    """``estimated``, ``waiting`` (used to measure the noise) or ``refused`` (not used)."""
    reason: Optional[str]
    """Why there is no estimate after the sample; None where there is one."""
    def __bool__(self) -> bool: ...

@final
class Session:
    channels: list[str]
    parameters: list[str]
    message: Optional[str]
    values: Optional[_Array]
    std_errors: Optional[_Array]
    systematic_std_errors: Optional[_Array]
    def __new__(cls, model: Model, method: Optional[str] = ..., change_detection: Optional[bool] = ...) -> Session: ...
    def update(self, time_s: float, values: _Array) -> Step: ...
    def snapshot_json(self) -> Optional[str]: ...
    def layout_json(self) -> str: ...
    def take_events_json(self) -> str: ...

def inspect(record: Record, model: Optional[Model] = ...) -> str: ...
def compatibility(
    record: Record,
    groups: Optional[list[str]] = ...,
    vanes_x_m: list[float] = ...,
    gravity_m_s2: Optional[float] = ...,
    flat_earth: bool = ...,
    unknowns: Optional[list[str]] = ...,
    without: list[str] = ...,
    held: list[tuple[str, float]] = ...,
) -> tuple[str, Record]: ...
def estimate(
    record: Record,
    model: Model,
    method: Optional[str] = ...,
    change_detection: Optional[bool] = ...,
    causal_only: bool = ...,
    structure: str = ...,
    truth: dict[str, float] = ...,
    further: list[Record] = ...,
    predict: Optional[Record] = ...,
    progress: _Report = ...,
    likelihood: str = ...,
    flow_angles: str = ...,
    band: Optional[tuple[float, float]] = ...,
) -> Estimation: ...
def design(
    kind: str,
    surfaces: list[str],
    scenario: str,
    model: Optional[Model],
    duration_s: float,
    lead_s: float,
    band_hz: Optional[list[float]],
    linear_sweep: bool,
    amplitudes_rad: list[float],
    limits: list[float],
) -> tuple[str, Record, Record]: ...
def trim(altitude_m: float, speed_m_s: float, cg: Optional[float] = ..., flight_path_rad: float = ..., turn_rate_rad_s: float = ..., aircraft: str = ..., with_files: list[str] = ..., properties: list[tuple[str, float]] = ...) -> str: ...
def linearize(altitude_m: float, speed_m_s: float, cg: Optional[float] = ..., flight_path_rad: float = ..., turn_rate_rad_s: float = ..., aircraft: str = ..., with_files: list[str] = ..., properties: list[tuple[str, float]] = ...) -> str: ...
def simulate(scenario: str, seed: Optional[int] = ...) -> tuple[Record, Record, str, list[str]]: ...
def compare(scenarios: list[str], methods: list[str] = ..., seeds: int = ..., progress: _Report = ...) -> str: ...
def names() -> tuple[list[str], list[str], list[str]]: ...
def reproduce(case: str, text: Optional[str] = ..., progress: _Report = ...) -> str: ...
def case_toml(document: str) -> str: ...
def cases() -> list[tuple[str, str]]: ...

@final
class FleetTask:
    def __new__(cls, model_name: str, model_text: str, store: str, method: Optional[str] = ..., segments: str = ..., flights: Optional[str] = ..., begin: bool = ...) -> FleetTask: ...
    def plan(self, logs: list[tuple[str, str, int, str]], shard: str) -> tuple[list[tuple[str, str, int, str]], str]: ...
    def one(self, log: tuple[str, str, int, str], file: str) -> Optional[tuple[int, bool]]: ...
    def run(self, files: list[str], shard: str, workers: int, progress: _Report = ...) -> str: ...
    def places(self, log: tuple[str, str, int, str]) -> list[str]: ...
    def note(self, log: tuple[str, str, int, str]) -> None: ...

@final
class CampaignTask:
    def __new__(cls, file: str) -> CampaignTask: ...
    def plan(self, shard: str) -> tuple[list[tuple[int, int]], str]: ...
    def place(self, number: int) -> str: ...
    def one(self, number: int, store: str) -> str: ...

def fleet_analyses(store: str, false_discoveries: float = ..., only: list[str] = ..., over: str = ...) -> str: ...
def fleet_files(words: list[str]) -> list[str]: ...
def fleet_hash(name: str, file: str) -> tuple[str, str, int, str]: ...
def fleet_model(wanted: str) -> tuple[str, str]: ...
def fleet_store(folder: str) -> None: ...
def fleet_tell(store: str, false_discoveries: float = ..., only: list[str] = ..., over: str = ...) -> tuple[str, str]: ...
