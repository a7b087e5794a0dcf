"""Fleets and campaigns: many logs and many simulated flights estimated once each, on this machine or on a cluster of Ray, into one
store, which may stand behind an address."""

from __future__ import annotations

import contextlib
import functools
import json
import os
import subprocess
import tempfile
import uuid
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

from . import _phugoid
from ._addresses import RemoteStore, content, is_address, names, on_this_machine
from ._engine import RETRIES, chunks, engine as engine_of
from ._phugoid import PhugoidError
from ._progress import reporter

#: Name, hash, bytes, and why it cannot be read.
_Log = tuple[str, str, int, str]
#: What makes the task of a fleet on any machine: name and text of the model, store, method, segments, table of flights.
_Recipe = tuple[str, str, str, Optional[str], str, Optional[str]]
#: A log; whether the store has it; what the store has of it from a time when it could not be read.
_Piece = tuple[_Log, bool, list[str]]
_Progress = Union[None, bool, Callable[[float], Any]]


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
    progress: _Progress = None,
) -> dict[str, Any]:
    """Estimates every manoeuvre of every log that the store does not have yet: ``phugoid fleet`` of the command line.

    ``logs`` are files, folders and patterns, and addresses that fsspec reads (``s3://bucket/flights/*.ulg``). ``model`` is a
    model file or the name of a built-in one, ``store`` a folder or an address (``s3://bucket/fleet``), ``flights`` a table of
    flights (CSV). Addresses need ``pip install "phugoid[fleet]"``.

    ``engine="ray"`` makes tasks for the cluster at ``address`` (``ray://HOST:10001``; without one, of this machine), and needs
    ``pip install "phugoid[fleet]"``. All machines have to see under the same path what is no address. The store is the same,
    bit for bit, whatever the engine, ``workers`` (0: one per core), the order, and whether it stands on a disk or not.

    :return: the document of ``phugoid fleet --json``: how many logs were estimated, found, refused.
    :raises PhugoidError: if the model, a log's path or the store is wrong. A log that cannot be read or estimated is a row.
    """
    words = [logs] if isinstance(logs, str) else [os.fspath(word) for word in logs]
    name, text = _phugoid.fleet_model(model)
    table = None if flights is None else os.path.abspath(flights)
    place = _place(store)
    recipe: _Recipe = (name, text, place, method, segments, table)
    if engine == "local" and not any(is_address(word) for word in [*words, place]):
        files = _phugoid.fleet_files(words)
        task = _phugoid.FleetTask(*recipe)
        with reporter(progress, "logs") as report:
            summary: dict[str, Any] = json.loads(task.run(files, shard, workers, report))
        return summary
    with contextlib.closing(engine_of(engine, workers, address)) as run, _beside(place) as here:
        if here != place:
            RemoteStore(place).begin(here)
        # This writes the model too.
        task = _phugoid.FleetTask(name, text, here, method, segments, table)
        if here != place:
            RemoteStore(place).send(here)
        hashed: list[_Log] = []
        for _, some in run.each(_hash, None, chunks(names(words), run.workers)):
            hashed.extend(some)
        work, counted = task.plan(sorted(hashed), shard)
        summary = json.loads(counted)
        pieces = chunks(_pieces(task, work, place), run.workers)
        done = 0
        with reporter(progress, "logs") as report:
            for piece, outcomes in run.each(_estimate, (_this_call(), recipe), pieces):
                done += len(piece)
                for outcome in outcomes:
                    if outcome is None:
                        summary["found"] += 1
                    else:
                        summary["estimated"] += 1
                        summary["rows"] += outcome[0]
                        summary["refused"] += int(outcome[1])
                if report is not None:
                    report(done / len(work))
    return summary


def campaign(
    file: Union[str, os.PathLike[str]],
    store: Union[str, os.PathLike[str]],
    *,
    engine: str = "local",
    workers: int = 0,
    shard: str = "1/1",
    address: Optional[str] = None,
    progress: _Progress = None,
) -> dict[str, Any]:
    """Flies and estimates everything that a campaign asks for and the store does not have: ``phugoid campaign`` of the command
    line, without the scores. A piece of work is a block of the campaign.

    ``file`` is the file of the campaign; ``store``, ``engine``, ``workers``, ``shard`` and ``address`` are those of :func:`fleet`.

    :return: how many estimations were asked for, made, found and refused, and how many rows were written.
    :raises PhugoidError: if the campaign or the store is wrong. A flight that cannot be flown or estimated is a row.
    """
    place, path = _place(store), os.path.abspath(file)
    with contextlib.closing(engine_of(engine, workers, address)) as run:
        there: set[str] = set()
        if is_address(place):
            with _beside(place) as here:
                RemoteStore(place).begin(here)
            there = RemoteStore(place).done()
        else:
            _phugoid.fleet_store(place)
        call = _this_call()
        task = _campaign_task(call, path)
        work, counted = task.plan(shard)
        summary: dict[str, Any] = json.loads(counted)
        asked, done = sum(size for _, size in work), 0
        rest = []
        for number, size in work:
            name = task.place(number)
            if name in there:
                summary["found"] += size
                done += size
            else:
                rest.append((number, name))
        sizes = dict(work)
        with reporter(progress, "flights") as report:
            for (number, _), outcome in run.each(_fly, (call, path, place), rest):
                done += sizes[number]
                for key, count in outcome.items():
                    summary[key] += count
                if report is not None:
                    report(done / asked)
    return summary


def command_shards(
    program: str, arguments: Sequence[str], folder: str, *, workers: int = 0, address: Optional[str] = None
) -> dict[str, int]:
    """Lets tasks of Ray make the runs of a command with ``--store``: what ``phugoid study``, ``compare`` and ``tune`` do with
    ``--engine ray``. Each task is the program with ``--shard i/n`` on one core; there are four for each core, so that a machine that
    joins finds some to begin.

    ``program`` and ``folder``, the one in which ``arguments`` have a meaning, have to be there under the same path on all machines.

    :return: the number of shards.
    :raises PhugoidError: if a shard fails, with what it says.
    """
    with contextlib.closing(engine_of("ray", workers, address)) as run:
        count = 4 * run.workers
        shards = [f"{number}/{count}" for number in range(1, count + 1)]
        for _ in run.each(_help, (program, list(arguments), folder), shards):
            pass
    return {"shards": count}


def fleet_tell(
    store: Union[str, os.PathLike[str]],
    *,
    false_discoveries: float = 0.05,
    only: Sequence[str] = (),
    over: str = "flights",
    html: Union[None, str, os.PathLike[str]] = None,
) -> dict[str, Any]:
    """What the fleet in a store tells: the document of ``phugoid fleet tell --json``. ``store`` is a folder or an address.
    ``html`` also writes the page."""
    with on_this_machine(os.fspath(store)) as here:
        text, page = _phugoid.fleet_tell(here, false_discoveries, list(only), over)
    if html is not None:
        with open(html, "w", encoding="utf-8") as file:
            file.write(page)
    document: dict[str, Any] = json.loads(text)
    return document


def fleet_analyses(
    store: Union[str, os.PathLike[str]],
    *,
    false_discoveries: float = 0.05,
    only: Sequence[str] = (),
    over: str = "flights",
) -> list[dict[str, Any]]:
    """What is known of each log, in the form of the analyzers of Flight Review: the documents of ``phugoid fleet analyses``.
    ``store`` is a folder or an address."""
    with on_this_machine(os.fspath(store)) as here:
        text = _phugoid.fleet_analyses(here, false_discoveries, list(only), over)
    documents: list[dict[str, Any]] = json.loads(text)
    return documents


def _place(store: Union[str, os.PathLike[str]]) -> str:
    word = os.fspath(store)
    return word if is_address(word) else os.path.abspath(word)


@contextlib.contextmanager
def _beside(place: str) -> Iterator[str]:
    """A new store on this machine for what is sent to the one behind an address; the store itself where it is a folder."""
    if not is_address(place):
        yield place
        return
    with tempfile.TemporaryDirectory() as here:
        _phugoid.fleet_store(here)
        yield here


def _pieces(task: Any, work: list[_Log], place: str) -> list[_Piece]:
    """The logs, with what a store behind an address has of them. One in a folder is asked by whoever does the work."""
    if not is_address(place):
        return [(log, False, []) for log in work]
    there = RemoteStore(place).done()
    pieces: list[_Piece] = []
    for log in work:
        unit, again, *earlier = task.places(log)
        pieces.append((log, unit in there and again not in there, [name for name in [again, *earlier] if name in there]))
    return pieces


def _hash(_: None, some: list[str]) -> list[_Log]:
    hashed = []
    for name in some:
        with content(name) as file:
            hashed.append(_phugoid.fleet_hash(name, file))
    return hashed


def _this_call() -> str:
    """What tells one call from the next: files may have changed between them, and processes of Ray outlive a call."""
    return uuid.uuid4().hex


@functools.lru_cache(maxsize=1)
def _fleet_task(call: str, recipe: _Recipe) -> Any:
    """The task, made once for a call in each process: reading the model takes as long as a short log."""
    return _phugoid.FleetTask(*recipe, begin=False)


@functools.lru_cache(maxsize=1)
def _campaign_task(call: str, file: str) -> Any:
    """The campaign, read and laid out once for a call in each process."""
    return _phugoid.CampaignTask(file)


def _estimate(shared: tuple[str, _Recipe], some: list[_Piece]) -> list[Optional[tuple[int, bool]]]:
    """Does some logs: of each `None` where the store has it, else the number of rows and whether it was refused."""
    call, recipe = shared
    model_name, model_text, place, method, segments, table = recipe
    outcomes: list[Optional[tuple[int, bool]]] = []
    with _beside(place) as here:
        if here == place:
            task = _fleet_task(call, recipe)
        else:
            task = _phugoid.FleetTask(model_name, model_text, here, method, segments, table, begin=False)
        for log, is_found, _ in some:
            if is_found:
                task.note(log)
                outcomes.append(None)
                continue
            with content(log[0]) as file:
                outcomes.append(task.one(log, file))
        if here != place:
            RemoteStore(place).send(here, [name for _, _, earlier in some for name in earlier])
    return outcomes


def _help(shared: tuple[str, list[str], str], shard: str) -> None:
    """Makes the runs of a shard. A program that a signal has ended goes on from what is in the store.

    :raises PhugoidError: if it ends with an error.
    """
    program, arguments, folder = shared
    words = [program, *arguments, "--shard", shard]
    for _ in range(RETRIES):
        ended = subprocess.run(
            words, cwd=folder, env={**os.environ, "RAYON_NUM_THREADS": "1"}, capture_output=True, text=True, check=False
        )
        if ended.returncode == 0:
            return
        if ended.returncode > 0:
            raise PhugoidError(f"shard {shard} of `{' '.join(words)}` ended with {ended.returncode}: {ended.stderr.strip()}")
    raise PhugoidError(f"shard {shard} of `{' '.join(words)}` was killed {RETRIES} times")


def _fly(shared: tuple[str, str, str], block: tuple[int, str]) -> dict[str, int]:
    """Does one block, by its number and by where its rows are to stand.

    :raises PhugoidError: if the files of the campaign are not those any more that it began with.
    """
    call, file, place = shared
    number, name = block
    task = _campaign_task(call, file)
    if task.place(number) != name:
        raise PhugoidError(f"`{file}`: the campaign or a file that it names has changed since it began. Begin it again")
    with _beside(place) as here:
        outcome: dict[str, int] = json.loads(task.one(number, here))
        if here != place:
            RemoteStore(place).send(here)
    return outcome
