"""What does pieces of work: threads of this process, or tasks of Ray on this machine or on a cluster."""

from __future__ import annotations

import concurrent.futures
import os
from typing import Any, Callable, Iterator, Optional, Sequence, TypeVar

from ._phugoid import PhugoidError

_Piece = TypeVar("_Piece")
_Result = TypeVar("_Result")

#: How often Ray does a task again whose process has died: often enough for machines that come and go, and an end for work that
#: kills its process each time.
RETRIES = 20


def chunks(pieces: Sequence[_Piece], workers: int, most: int = 64) -> list[list[_Piece]]:
    """Consecutive pieces together, because a task of an engine costs a millisecond or more by itself: not more than ``most``,
    and so few that each worker has at least eight of them to do."""
    size = max(1, min(most, len(pieces) // (8 * max(1, workers))))
    return [list(pieces[first : first + size]) for first in range(0, len(pieces), size)]


class Threads:
    """Threads of this process; the work leaves Python while it estimates."""

    def __init__(self, workers: int) -> None:
        self.workers = workers or os.cpu_count() or 1
        self._pool = concurrent.futures.ThreadPoolExecutor(self.workers)

    def each(
        self, function: Callable[[Any, _Piece], _Result], shared: Any, pieces: Sequence[_Piece]
    ) -> Iterator[tuple[_Piece, _Result]]:
        """Each piece with its result, in the order in which they are done. Few are begun before they are asked for."""
        waiting: dict[concurrent.futures.Future[_Result], _Piece] = {}
        rest = iter(pieces)
        while True:
            for piece in rest:
                waiting[self._pool.submit(function, shared, piece)] = piece
                if len(waiting) >= 2 * self.workers:
                    break
            if not waiting:
                return
            done, _ = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in done:
                yield waiting.pop(future), future.result()

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)


class Ray:
    """Tasks of Ray. Without an address it is begun on this machine, with ``workers`` tasks at a time (0: one per core)."""

    def __init__(self, workers: int, address: Optional[str]) -> None:
        try:
            import ray
        except ImportError as error:
            raise PhugoidError('engine="ray" needs Ray: pip install "phugoid[fleet]"') from error
        # Ray has types for a part of itself.
        self._ray: Any = ray
        if not ray.is_initialized():
            # Without an address it is this machine: Ray otherwise joins what it finds running.
            how = {"address": address} if address else {"address": "local", "num_cpus": workers or None}
            ray.init(log_to_driver=False, include_dashboard=None if address else False, **how)
        self.workers = workers or int(self._ray.cluster_resources().get("CPU", 1))

    def each(
        self, function: Callable[[Any, _Piece], _Result], shared: Any, pieces: Sequence[_Piece]
    ) -> Iterator[tuple[_Piece, _Result]]:
        """Each piece with its result, in the order in which they are done. A piece whose process died is done again, by another
        one; few are handed out before they are asked for, so that a cluster holds no list of a million."""
        ray = self._ray
        task, common = ray.remote(max_retries=RETRIES)(function), ray.put(shared)
        waiting: dict[Any, _Piece] = {}
        rest = iter(pieces)
        while True:
            for piece in rest:
                waiting[task.remote(common, piece)] = piece
                if len(waiting) >= 4 * self.workers:
                    break
            if not waiting:
                return
            (done, *_), _ = ray.wait(list(waiting))
            piece = waiting.pop(done)
            try:
                result = ray.get(done)
            except ray.exceptions.WorkerCrashedError as error:
                raise PhugoidError(f"its process died {RETRIES + 1} times, for want of memory or killed: {piece!r}") from error
            yield piece, result

    def close(self) -> None:
        """A cluster of this process goes on: the next call begins without waiting for it."""


def engine(name: str, workers: int, address: Optional[str]) -> Threads | Ray:
    """The engine of this name."""
    if name == "local":
        return Threads(workers)
    if name == "ray":
        return Ray(workers, address)
    raise PhugoidError(f'the engine is "local" or "ray", not "{name}"')
