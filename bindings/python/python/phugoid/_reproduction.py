"""Cases of the thesis, and plants of one's own: run, and shown as tables and figures."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _phugoid, _show
from ._phugoid import PhugoidError
from ._plant import Plant
from ._progress import Progress, reporter

Case = Union[str, "os.PathLike[str]", Mapping[str, Any], Plant]


class Reproduction:
    """The result of one case or study: what every method did with it."""

    def __init__(self, document: dict[str, Any]) -> None:
        self._document = document

    @property
    def id(self) -> str:
        """Name of the case: ``second-order/3``, or that of a file or class of one's own."""
        return str(self._document["id"])

    @property
    def title(self) -> str:
        """What it is, in a few words."""
        return str(self._document["title"])

    @property
    def outcomes(self) -> list[dict[str, Any]]:
        """What each method did: ``method``, ``role`` (``flagship``, ``published``, ``mended``, ``comparison``), ``behaviour``
        (``converges``, ``biased``, ``chatters``, ``diverges``, ``unfinished``), the ``condition`` that decides it, and its
        ``parameters``. Empty for a study, which has ``tables``."""
        found: list[dict[str, Any]] = self._document["outcomes"]
        return found

    @property
    def charts(self) -> list[str]:
        """Names of the figures that :meth:`plot` draws."""
        return [chart["name"] for chart in self._document["charts"]]

    def curves(self, chart: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """The curves of a figure as arrays, by ``"quantity: label"``: what is along the horizontal and the vertical axis."""
        found = self._chart(chart)
        curves = {}
        for panel in found["panels"]:
            for curve in panel["content"].get("curves", {}).get("curves", []):
                for kind, values in curve["shape"].items():
                    if kind != "band":
                        curves[f"{panel['y']['label']}: {curve['label']}"] = (_show.numbers(curve["x"]), _show.numbers(values))
        return curves

    def _chart(self, name: str) -> dict[str, Any]:
        for chart in self._document["charts"]:
            if chart["name"] == name:
                found: dict[str, Any] = chart
                return found
        raise PhugoidError(f"{self.id} has no figure `{name}`; there are {', '.join(self.charts) or 'none'}")

    def plot(self, chart: Optional[str] = None) -> Any:
        """Draws a figure with matplotlib and returns it; the first one if none is named.

        :raises PhugoidError: if there is no such figure.
        """
        if chart is None:
            if not self.charts:
                raise PhugoidError(f"{self.id} has no figure")
            chart = self.charts[0]
        return _show.plot_chart(self._chart(chart))

    def to_dict(self) -> dict[str, Any]:
        """Everything: also ``published``, ``reconstruction``, ``difference``, ``requirements`` and ``tables``."""
        return self._document

    def _rows(self) -> list[dict[str, Any]]:
        return [
            {
                "method": outcome["method"],
                "role": outcome["role"],
                "behaviour": outcome["behaviour"],
                "parameter": parameter.pop("name"),
                **parameter,
            }
            for outcome in self.outcomes
            for parameter in [dict(parameter) for parameter in outcome["parameters"]]
        ]

    def to_pandas(self) -> Any:
        """A pandas ``DataFrame`` with a row for every method and parameter: behaviour, truth, start, end, the standard error
        that the method claims, and when it stayed within 5 % of the truth (s), as published and as found."""
        import pandas

        frame = pandas.DataFrame(self._rows())
        numbers = ("truth", "start", "end", "std_error", "published_s", "converged_s")
        return frame.astype({column: float for column in numbers if column in frame})

    def __repr__(self) -> str:
        lines = "".join(
            f"\n  {row['method']:<28} {row['parameter']:<12} {_show.number(row['end'], 5):>10} (truth "
            f"{_show.number(row['truth'], 5)})  {row['behaviour']}"
            for row in self._rows()
        )
        return f"<Reproduction {self.id}: {self.title}{lines}>"

    def _repr_html_(self) -> str:
        return _show.reproduction_html(self.id, self.title, self._rows())


def reproduce(case: Case, *, progress: Progress = None) -> Reproduction:
    """Runs a case: the plant or flight is simulated, and every method estimates the unknown parameters from it.

    ``case`` is the id of a case or study of the thesis (:func:`cases` lists them), the path of a case file (it ends in
    ``.toml``), its text, a dictionary with its tables and keys, or a :class:`Plant` of one's own. Other Python threads can run
    meanwhile. ``progress`` is True for a bar, or a function that is called with the fraction done; only studies know it.

    :raises PhugoidError: if there is no such case, a key or value of it is wrong, or its simulation leaves the range of
        numbers.
    """
    name: str
    text: Optional[str]
    if isinstance(case, Plant):
        name, text = type(case).__name__, _phugoid.case_toml(_json(case.case()))
    elif isinstance(case, Mapping):
        name, text = "case", _phugoid.case_toml(_json(case))
    else:
        written = os.fspath(case)
        is_text = "\n" in written
        name, text = ("case", written) if is_text else (written, None)
    with reporter(progress, "reproducing") as report:
        return Reproduction(json.loads(_phugoid.reproduce(name, text, report)))


def _json(case: Mapping[str, Any]) -> str:
    try:
        return json.dumps(case, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise PhugoidError(f"the case: {error}; its values are words, finite numbers, lists and dictionaries") from error


def cases() -> dict[str, str]:
    """The cases and studies of the thesis: title by id, as :func:`reproduce` takes them."""
    return dict(_phugoid.cases())
