"""Progress in notebooks and terminals."""

from __future__ import annotations

import contextlib
import sys
import threading
from typing import Any, Callable, Iterator, Optional, Union

#: True for a bar, or a function that is called with the fraction done, from 0 to 1.
Progress = Union[None, bool, Callable[[float], Any]]


@contextlib.contextmanager
def reporter(progress: Progress, title: str) -> Iterator[Optional[Callable[[float], Any]]]:
    """A function that takes the fraction done: the caller's, one that draws a bar, or none."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    else:
        bar = _tqdm(title) or _cell(title) or _Line(title)
        try:
            yield bar.to
        finally:
            bar.close()


class _Cell:
    """A line in the output of a notebook's cell, for where tqdm is not installed. It is one output that changes: each line
    that is written to a stream stays in the file of the notebook."""

    #: Percent between two changes.
    _STEP = 5

    def __init__(self, title: str, display: Callable[..., Any]) -> None:
        self._title, self._shown, self._lock = title, 0, threading.Lock()
        self._handle = display(self._content(0), raw=True, display_id=True)

    def _content(self, percent: int) -> dict[str, str]:
        return {"text/plain": f"{self._title}: {percent:3d} %"}

    def to(self, fraction: float) -> None:
        percent = int(100 * fraction)
        with self._lock:
            if percent >= self._shown + self._STEP:
                self._shown = percent
                self._handle.update(self._content(percent), raw=True)

    def close(self) -> None:
        self._handle.update(self._content(100), raw=True)


def _cell(title: str) -> Optional[_Cell]:
    """None where this is no notebook."""
    if "ipykernel" not in sys.modules:
        return None
    from IPython.display import display

    return _Cell(title, display)


class _Line:
    """A line on standard error, for where tqdm is not installed."""

    def __init__(self, title: str) -> None:
        self._title, self._shown, self._lock = title, -1, threading.Lock()

    def to(self, fraction: float) -> None:
        percent = int(100 * fraction)
        with self._lock:
            if percent > self._shown:
                self._shown = percent
                print(f"\r{self._title}: {percent:3d} %", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        print(file=sys.stderr)


def _tqdm(title: str) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None

    class Bar:
        def __init__(self) -> None:
            self._bar, self._lock = tqdm(total=100, desc=title, unit="%"), threading.Lock()

        def to(self, fraction: float) -> None:
            with self._lock:
                step = int(100 * fraction) - self._bar.n
                if step > 0:
                    self._bar.update(step)

        def close(self) -> None:
            self._bar.close()

    return Bar()
