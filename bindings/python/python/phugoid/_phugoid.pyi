from os import PathLike
from typing import Any, Callable, Optional, Union

import numpy as np
from numpy.typing import NDArray

__version__: str

_Array = NDArray[np.float64]
_Mapping = tuple[str, str, Optional[str], float]
_Path = Union[str, PathLike[str]]
_Report = Optional[Callable[[float], Any]]

class PhugoidError(ValueError): ...

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
    def delete(self, channels: list[str], start: float, end: float, reason: str) -> Record: ...
    def write_csv(self, path: _Path) -> None: ...
    def __getitem__(self, name: str) -> _Array: ...
    def __contains__(self, name: str) -> bool: ...
    def __len__(self) -> int: ...

class Model:
    """An aircraft, its coefficient build-up and what is known beforehand: ``Model.named``, ``Model.open``, ``Model.parse``."""

    source: str
    name: str
    parameters: list[str]
    channels: list[str]
    axes: list[str]
    def __init__(self, name: str) -> None:
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

class Estimation:
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
    def __getitem__(self, name: str) -> tuple[float, float]: ...

class Session:
    channels: list[str]
    parameters: list[str]
    message: Optional[str]
    values: Optional[_Array]
    std_errors: Optional[_Array]
    systematic_std_errors: Optional[_Array]
    def __init__(self, model: Model, method: Optional[str] = ..., change_detection: Optional[bool] = ...) -> None: ...
    def update(self, time_s: float, values: _Array) -> bool: ...
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
    structure: str = ...,
    truth: dict[str, float] = ...,
    further: list[Record] = ...,
    predict: Optional[Record] = ...,
    progress: _Report = ...,
    likelihood: str = ...,
    flow_angles: str = ...,
    band: Optional[tuple[float, float]] = ...,
) -> Estimation: ...
def trim(altitude_m: float, speed_m_s: float, cg: Optional[float] = ..., flight_path_rad: float = ..., turn_rate_rad_s: float = ..., aircraft: str = ..., with_files: list[str] = ..., properties: list[tuple[str, float]] = ...) -> str: ...
def linearize(altitude_m: float, speed_m_s: float, cg: Optional[float] = ..., flight_path_rad: float = ..., turn_rate_rad_s: float = ..., aircraft: str = ..., with_files: list[str] = ..., properties: list[tuple[str, float]] = ...) -> str: ...
def simulate(scenario: str, seed: Optional[int] = ...) -> tuple[Record, Record, str, list[str]]: ...
def compare(scenarios: list[str], methods: list[str] = ..., seeds: int = ..., progress: _Report = ...) -> str: ...
def names() -> tuple[list[str], list[str], list[str]]: ...

class FleetTask:
    def __init__(self, model_name: str, model_text: str, store: str, method: Optional[str] = ..., segments: str = ..., flights: Optional[str] = ..., begin: bool = ...) -> None: ...
    def plan(self, logs: list[tuple[str, str, int, str]], shard: str) -> tuple[list[tuple[str, str, int, str]], str]: ...
    def one(self, log: tuple[str, str, int, str], file: str) -> Optional[tuple[int, bool]]: ...
    def run(self, files: list[str], shard: str, workers: int, progress: _Report = ...) -> str: ...

def fleet_files(words: list[str]) -> list[str]: ...
def fleet_hash(name: str, file: str) -> tuple[str, str, int, str]: ...
def fleet_model(wanted: str) -> tuple[str, str]: ...
def fleet_tell(store: str, false_discoveries: float = ..., only: list[str] = ..., over: str = ...) -> tuple[str, str]: ...
