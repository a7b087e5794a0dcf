"""Fleets: many logs estimated once each, on this machine or on a cluster of Ray, into one store."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

from . import _phugoid
from ._phugoid import PhugoidError
from ._progress import reporter

#: Name, hash, bytes, and why it cannot be read.
_Log = tuple[str, str, int, str]
#: What makes a task on any machine.
_Recipe = tuple[str, str, str, Optional[str], str, Optional[str]]


def fleet(
    logs: Union[str, Iterable[str]],
    model: str,
    store: Union[str, os.PathLike[str]],
    *,
    method: Optional[str] = None,
    segments: str = "manoeuvres",
    flights: Union[None, str, os.PathLike[str]] = None,
    engine: str = "local",
    workers: int = 0,
    shard: str = "1/1",
    address: Optional[str] = None,
    progress: Union[None, bool, Callable[[float], Any]] = None,
) -> dict[str, Any]:
    """Estimates every manoeuvre of every log that the store does not have yet: ``phugoid fleet`` of the command line.

    ``logs`` are files, folders and patterns; with Ray also addresses that fsspec reads (``s3://bucket/flights/*.ulg``).
    ``model`` is a model file or the name of a built-in one, ``store`` a folder, ``flights`` a table of flights (CSV).

    ``engine="ray"`` makes each log a task of the cluster at ``address`` (``ray://HOST:10001``; without one, of this machine),
    and needs ``pip install "phugoid[fleet]"``. All machines have to see ``store`` under the same path, and logs that are files
    too. The store is the same, bit for bit, whatever the engine, ``workers`` (0: one per core) and order.

    :return: the document of ``phugoid fleet --json``: how many logs were estimated, found, refused.
    :raises PhugoidError: if the model, a log's path or the store is wrong. A log that cannot be read or estimated is a row.
    """
    words = [logs] if isinstance(logs, str) else [os.fspath(word) for word in logs]
    name, text = _phugoid.fleet_model(model)
    table = None if flights is None else os.path.abspath(flights)
    recipe: _Recipe = (name, text, os.path.abspath(store), method, segments, table)
    if engine == "local":
        files = _phugoid.fleet_files(words)
        task = _phugoid.FleetTask(*recipe)
        with reporter(progress, "logs") as report:
            summary: dict[str, Any] = json.loads(task.run(files, shard, workers, report))
        return summary
    if engine != "ray":
        raise PhugoidError(f'the engine is "local" or "ray", not "{engine}"')
    return _on_ray(_names(words), recipe, shard, workers, address, progress)


def fleet_tell(
    store: Union[str, os.PathLike[str]],
    *,
    false_discoveries: float = 0.05,
    only: Sequence[str] = (),
    over: str = "flights",
    html: Union[None, str, os.PathLike[str]] = None,
) -> dict[str, Any]:
    """What the fleet in a store tells: the document of ``phugoid fleet tell --json``. ``html`` also writes the page."""
    text, page = _phugoid.fleet_tell(os.fspath(store), false_discoveries, list(only), over)
    if html is not None:
        with open(html, "w", encoding="utf-8") as file:
            file.write(page)
    document: dict[str, Any] = json.loads(text)
    return document


def _names(words: Sequence[str]) -> list[str]:
    """Files and addresses, each once, in one order."""
    remote = [word for word in words if "://" in word]
    names = set(_phugoid.fleet_files([word for word in words if "://" not in word]) if len(remote) < len(words) else [])
    for word in remote:
        import fsspec

        files, path = fsspec.core.url_to_fs(word)
        found = files.glob(path) if any(letter in path for letter in "*?[") else files.find(path)
        if not found:
            raise PhugoidError(f"`{word}`: nothing is there")
        names.update(files.unstrip_protocol(one) for one in found if files.isfile(one))
    return sorted(names)


@contextlib.contextmanager
def _content(name: str) -> Iterator[str]:
    """A file with the content of a log: the log itself, or a copy for as long as it is needed."""
    if "://" not in name:
        yield name
        return
    import fsspec

    # The end of the name is kept, because tables are known by it.
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, os.path.basename(name))
        # What cannot be fetched is found missing by the reader, and becomes a row.
        with contextlib.suppress(OSError):
            files, path = fsspec.core.url_to_fs(name)
            files.get(path, copy)
        yield copy


def _hash(name: str) -> _Log:
    with _content(name) as file:
        return _phugoid.fleet_hash(name, file)


def _one(recipe: _Recipe, log: _Log) -> Optional[tuple[int, bool]]:
    with _content(log[0]) as file:
        return _phugoid.FleetTask(*recipe, begin=False).one(log, file)


def _on_ray(
    names: list[str],
    recipe: _Recipe,
    shard: str,
    workers: int,
    address: Optional[str],
    progress: Union[None, bool, Callable[[float], Any]],
) -> dict[str, Any]:
    try:
        import ray
    except ImportError as error:
        raise PhugoidError('engine="ray" needs Ray: pip install "phugoid[fleet]"') from error
    if not ray.is_initialized():
        # Without an address it is this machine: Ray otherwise joins what it finds running.
        how = {"address": address} if address else {"address": "local", "num_cpus": workers or None}
        ray.init(log_to_driver=False, include_dashboard=None if address else False, **how)
    hashing, doing = ray.remote(_hash), ray.remote(_one)
    task = _phugoid.FleetTask(*recipe)
    hashed = ray.get([hashing.remote(name) for name in names])
    work, text = task.plan(hashed, shard)
    summary: dict[str, Any] = json.loads(text)
    shared = ray.put(recipe)
    with reporter(progress, "logs") as report:
        waiting = [doing.remote(shared, log) for log in work]
        while waiting:
            ready, waiting = ray.wait(waiting)
            for outcome in ray.get(ready):
                if outcome is None:
                    summary["found"] += 1
                else:
                    summary["estimated"] += 1
                    summary["rows"] += outcome[0]
                    summary["refused"] += int(outcome[1])
            if report is not None:
                report(1.0 - len(waiting) / len(work))
    return summary
