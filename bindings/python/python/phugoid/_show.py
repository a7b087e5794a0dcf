"""What notebooks show of a record, a model and a result, and the figures of a result.

Matplotlib is imported when a figure is drawn, and not before: the package works without it.
"""

from __future__ import annotations

import math
import re
from html import escape
from typing import TYPE_CHECKING, Any, Iterable, Optional, Sequence

import numpy as np

if TYPE_CHECKING:
    from . import Estimation, Record, _phugoid

#: Colours of the words of a result as a whole and of a parameter: what must not be used is red.
_COLOURS = {
    "sound": "#1a7f37",
    "provisional": "#9a6700",
    "doubtful": "#bc4c00",
    "refused": "#cf222e",
    "converged": "#1a7f37",
    "improving": "#9a6700",
    "not_excited": "#57606a",
    "unknown": "#57606a",
    "fixed": "#57606a",
    "at_limit": "#cf222e",
    "in_doubt": "#cf222e",
    "converges": "#1a7f37",
    "unfinished": "#9a6700",
    "biased": "#bc4c00",
    "chatters": "#bc4c00",
    "diverges": "#cf222e",
}


def _word(word: str, size: str = "1em") -> str:
    colour = _COLOURS.get(word, "#57606a")
    return f'<b style="color:{colour};font-size:{size}">{escape(word.replace("_", " "))}</b>'


def number(value: Optional[float], digits: int = 4) -> str:
    """A number with so many significant digits; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return "–"
    return f"{value:.{digits}g}"


def estimate(value: Optional[float], bound: Optional[float]) -> str:
    """A value with as many decimals as its bound has with three digits, but not fewer than three digits of its own."""
    if value is None or not math.isfinite(value):
        return "–"
    if bound is None or not math.isfinite(bound) or bound <= 0.0:
        return number(value, 5)
    decimals = 2 - math.floor(math.log10(bound))
    own = 2 - math.floor(math.log10(abs(value))) if value != 0.0 else decimals
    decimals = max(decimals, own)
    return f"{value:.{decimals}f}" if 0 <= decimals <= 9 else number(value, 6)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], words: Sequence[str]) -> str:
    """A table whose columns ``words`` are text, and the others numbers; cells are HTML already."""

    def cells(tag: str, row: Sequence[str]) -> str:
        styles = [f"text-align:{'left' if name in words else 'right'};padding:2px 8px" for name in head]
        return "".join(f'<{tag} style="{style}">{cell}</{tag}>' for style, cell in zip(styles, row))

    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table><thead><tr>{cells('th', head)}</tr></thead><tbody>{body}</tbody></table>"


def _sentences(sentences: Iterable[str]) -> str:
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    return f"<ul>{items}</ul>" if items else ""


def estimation_html(result: Estimation) -> str:
    """A result: what it is worth first, then why, then the parameters."""
    document = result.to_dict()
    refused = result.status == "refused"
    known = any(p["truth"] is not None for p in document["parameters"])
    head = ["parameter", "estimate", "± 2 σ", "unit", "status"] + (["truth"] if known else [])

    def row(p: dict[str, Any]) -> list[str]:
        std_error = p["corrected_std_error"]
        bound = None if std_error is None else 2 * std_error
        value = escape(estimate(p["value"], bound))
        if refused or p["status"] in ("in_doubt", "at_limit"):
            # A number that must not be used does not look like one that may be.
            value = f'<s style="color:{_COLOURS["refused"]}">{value}</s>'
        cells = [escape(p["name"]), value, number(bound, 3), escape(p["unit"]), _word(p["status"])]
        return cells + ([number(p["truth"])] if known else [])

    frame = f' style="border-left:4px solid {_COLOURS["refused"]};padding-left:8px"' if refused else ""
    warning = (
        f'<div style="color:{_COLOURS["refused"]}">Use neither the numbers nor their bounds.</div>' if refused else ""
    )
    return (
        f"<div{frame}><div>{_word(result.status, '1.2em')}: {escape(document['source'])}, model "
        f"<code>{escape(document['model'])}</code>, method <code>{escape(result.method)}</code></div>{warning}"
        f"{_sentences(reason.sentence for reason in result.reasons)}"
        f"{_table(head, map(row, document['parameters']), ['parameter', 'unit', 'status'])}"
        "<small>Derivatives per radian; a bound is two standard errors.</small></div>"
    )


def record_html(record: Record) -> str:
    """A flight: length, start, channels with their range, and what the reader doubts."""

    def row(name: str) -> list[str]:
        values = record[name]
        there = values[np.isfinite(values)]
        low, high = (number(there.min()), number(there.max())) if there.size else ("–", "–")
        missing = values.size - there.size
        return [escape(name), escape(record.units[name]), low, high, str(missing) if missing else ""]

    time, start = record.time, record.start
    span = f", {number(time[0])} s to {number(time[-1])} s" if time.size else ""
    since = f", time zero {escape(start.isoformat(sep=' '))}" if start is not None else ""
    doubts = [line.strip() for line in record.quality.splitlines() if line.strip().startswith("warning:")]
    return (
        f"<div><div><b>{escape(record.source)}</b>: {len(record)} samples{span}{since}</div>{_sentences(doubts)}"
        f"{_table(['channel', 'unit', 'lowest', 'highest', 'missing'], map(row, record.channels), ['channel', 'unit'])}</div>"
    )


def model_html(model: _phugoid.Model) -> str:
    """A model: what it describes and needs, and its parameters with what is known of them beforehand."""

    def row(name: str, unit: str, start: float, prior: float, limits: Optional[list[float]], fixed: bool) -> list[str]:
        between = "" if limits is None else f"{number(limits[0])} to {number(limits[1])}"
        return [escape(name), escape(unit), number(start), _word("fixed") if fixed else number(prior), between]

    rows = [row(*entry[:6]) for entry in model.table]
    return (
        f"<div><div><b>{escape(model.name)}</b> (<code>{escape(model.source)}</code>), {escape(' and '.join(model.axes))}"
        f"; needs {escape(', '.join(model.channels))}</div>"
        f"{_table(['parameter', 'unit', 'start', 'known within, 1 σ', 'limits'], rows, ['parameter', 'unit', 'limits'])}</div>"
    )


def reproduction_html(name: str, title: str, rows: Iterable[dict[str, Any]]) -> str:
    """A case of the thesis: what every method made of every parameter."""
    head = ["method", "parameter", "estimate", "± 2 σ", "truth", "within 5 % from", "what it does"]

    def row(p: dict[str, Any]) -> list[str]:
        bound = None if p["std_error"] is None else 2 * p["std_error"]
        since = "–" if p["converged_s"] is None else f"{number(p['converged_s'])} s"
        return [
            escape(p["method"]),
            escape(p["parameter"]),
            escape(estimate(p["end"], bound)),
            number(bound, 3),
            number(p["truth"]),
            since,
            _word(p["behaviour"]),
        ]

    table = _table(head, map(row, rows), ["method", "parameter", "what it does"])
    called = "" if title == name else f": {escape(title)}"
    return f"<div><div><b>{escape(name)}</b>{called}</div>{table}</div>"


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as error:
        raise ImportError("plot() draws with matplotlib: pip install matplotlib") from error
    return pyplot


def _grid(count: int, height: float) -> tuple[Any, list[Any]]:
    """A figure with ``count`` axes under one time, in two columns where there are more than three."""
    columns = 1 if count <= 3 else 2
    rows = -(-count // columns)
    figure, axes = _pyplot().subplots(
        rows, columns, sharex=True, squeeze=False, figsize=(7.0 * columns, 0.8 + height * rows), layout="constrained"
    )
    cells = list(axes.flat)
    for spare in cells[count:]:
        spare.set_visible(False)
        # The time of the column stands under its last panel.
        axes[rows - 2][columns - 1].tick_params(labelbottom=True)
    cells = cells[:count]
    for lowest in cells[-columns:]:
        lowest.set_xlabel("time [s]")
    return figure, cells


def _headline(figure: Any, result: Estimation) -> None:
    colour = _COLOURS.get(result.status, "black")
    name = re.split(r"[/\\\\]", result.source)[-1]
    text = f"{name}, {result.method}: {result.status}"
    if result.status == "refused":
        text += " (use neither the numbers nor their bounds)"
    figure.suptitle(text, color=colour, fontsize="medium")


def plot_parameters(result: Estimation, names: Sequence[str]) -> Any:
    """Each parameter over the time with its bound of two standard errors."""
    history, document = result.history, {p["name"]: p for p in result.to_dict()["parameters"]}
    figure, cells = _grid(len(names), 2.0)
    for axes, name in zip(cells, names):
        found = document[name]
        colour = _COLOURS.get(found["status"], "#57606a")
        value, bound = history[name], 2 * history[f"{name}_std"]
        axes.fill_between(history.time, value - bound, value + bound, color="#0969da", alpha=0.2, linewidth=0)
        axes.plot(history.time, value, color="#0969da", linewidth=1.2)
        if found["truth"] is not None:
            axes.axhline(found["truth"], color="#bc4c00", linewidth=1.0, linestyle="--")
        axes.set_ylabel(f"{name} [{found['unit']}]")
        last = f"{estimate(found['value'], 2 * result[name][1])} ± {number(2 * result[name][1], 3)}"
        axes.set_title(f"{last}, {found['status'].replace('_', ' ')}", loc="right", color=colour, fontsize="small")
        _limit(axes, value, bound)
        axes.grid(alpha=0.3)
    truth = any(document[name]["truth"] is not None for name in names)
    cells[0].set_title(
        "band: ± 2 σ" + ("; dashed: truth" if truth else ""), loc="left", color="#57606a", fontsize="small"
    )
    _headline(figure, result)
    return figure


def _limit(axes: Any, value: np.ndarray, bound: np.ndarray) -> None:
    """Shows where the estimate goes, not the whole of a band that begins a hundred times as wide."""
    finite = np.isfinite(value) & np.isfinite(bound)
    if not finite.any():
        return
    value, bound = value[finite], bound[finite]
    late = slice(value.size // 4, None)
    low, high = (value[late] - bound[late]).min(), (value[late] + bound[late]).max()
    if high > low:
        room = 0.15 * (high - low)
        axes.set_ylim(low - room, high + room)


def plot_outputs(result: Estimation) -> Any:
    """Each measured output over the time, and what the model predicts."""
    history = result.history
    names = [name for name in history.channels if f"{name}_predicted" in history]
    if not names:
        raise ValueError(f"the method {result.method} has no predicted outputs to draw")
    figure, cells = _grid(len(names), 1.8)
    for axes, name in zip(cells, names):
        unit, scale = ("deg", math.degrees(1)) if history.units[name] == "rad" else (history.units[name], 1.0)
        unit, scale = ("deg/s", math.degrees(1)) if unit == "rad/s" else (unit, scale)
        axes.plot(history.time, scale * history[name], ".", markersize=2, color="#57606a", label="measured")
        axes.plot(history.time, scale * history[f"{name}_predicted"], linewidth=1.2, color="#d55e00", label="predicted")
        axes.set_ylabel(f"{name} [{unit}]")
        axes.grid(alpha=0.3)
    cells[0].set_title("dots: measured; line: predicted", loc="left", color="#57606a", fontsize="small")
    _headline(figure, result)
    return figure


#: Colours by what a curve stands for; methods take those of matplotlib in turn.
_MEANINGS = {"truth": "black", "measured": "#57606a", "command": "#57606a", "bound": "#bc4c00", "flagship": "#0969da"}


def _axis(axis: dict[str, Any]) -> str:
    return f"{axis['label']} [{axis['unit']}]" if axis["unit"] else str(axis["label"])


def numbers(values: Iterable[Optional[float]]) -> np.ndarray:
    """Values of a JSON document, which has no NaN."""
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _colour(meaning: Any) -> str:
    return f"C{1 + meaning['method'] % 9}" if isinstance(meaning, dict) else _MEANINGS.get(meaning, "#57606a")


def _curves(axes: Any, content: dict[str, Any]) -> None:
    for curve in content["curves"]:
        x, colour, label = numbers(curve["x"]), _colour(curve["meaning"]), curve["label"] or None
        for kind, values in curve["shape"].items():
            if kind == "band":
                axes.fill_between(x, numbers(values["lower"]), numbers(values["upper"]), color=colour, alpha=0.2, linewidth=0, label=label)
            elif kind == "points":
                axes.plot(x, numbers(values), ".", markersize=2, color=colour, label=label)
            else:
                style = "steps-post" if kind == "step" else "default"
                dashes = "--" if curve["meaning"] == "truth" else "-"
                axes.plot(x, numbers(values), dashes, drawstyle=style, linewidth=1.2, color=colour, label=label)
    for lines, draw in ((content["levels"], axes.axhline), (content["instants"], axes.axvline)):
        for line in lines:
            draw(line["at"], color=_colour(line["meaning"]), linewidth=0.8, linestyle=":", label=line["label"] or None)


def _map(figure: Any, axes: Any, content: dict[str, Any]) -> None:
    values = np.array([numbers(row) for row in content["values"]])
    if content["logarithmic"]:
        from matplotlib.colors import LogNorm

        limits = content["value"]["range"] or [np.nanmin(values), np.nanmax(values)]
        drawn = axes.pcolormesh(content["x"], content["y"], values, norm=LogNorm(*limits), shading="nearest")
    else:
        low, high = content["value"]["range"] or (None, None)
        drawn = axes.pcolormesh(content["x"], content["y"], values, vmin=low, vmax=high, shading="nearest")
    figure.colorbar(drawn, ax=axes, label=_axis(content["value"]))
    if content["marked"]:
        axes.plot(*content["marked"], "+", color="red", markersize=10)


def plot_chart(chart: dict[str, Any]) -> Any:
    """A figure of a case: its panels with their curves or maps."""
    count, columns = len(chart["panels"]), max(1, chart["columns"])
    rows = -(-count // columns)
    figure, axes = _pyplot().subplots(
        rows, columns, sharex=True, squeeze=False, figsize=(7.0 * columns, 0.8 + 2.4 * rows), layout="constrained"
    )
    cells = list(axes.flat)
    for spare in cells[count:]:
        spare.set_visible(False)
    for cell, panel in zip(cells, chart["panels"]):
        content = panel["content"]
        if "curves" in content:
            _curves(cell, content["curves"])
            cell.grid(alpha=0.3)
            if cell.get_legend_handles_labels()[1]:
                cell.legend(fontsize="x-small")
        else:
            _map(figure, cell, content["map"])
        cell.set_ylabel(_axis(panel["y"]))
        if panel["y"]["range"]:
            cell.set_ylim(*panel["y"]["range"])
    for lowest in cells[:count][-columns:]:
        lowest.set_xlabel(_axis(chart["x"]))
        if chart["x"]["range"]:
            lowest.set_xlim(*chart["x"]["range"])
    figure.suptitle(chart["title"], fontsize="medium")
    return figure
