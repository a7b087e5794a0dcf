"""Logs and stores behind addresses (``s3://bucket/folder``), with whatever fsspec reads and writes."""

from __future__ import annotations

import contextlib
import os
import tempfile
from typing import Any, Iterator, Sequence

from . import _phugoid
from ._phugoid import PhugoidError

#: The file by which a store is known.
_MARK = "phugoid-fleet-store.txt"


def is_address(word: str) -> bool:
    """Whether a word is an address and not a path."""
    return "://" in word


def _filesystem(address: str) -> tuple[Any, str]:
    try:
        import fsspec

        files, path = fsspec.core.url_to_fs(address)
    except (ImportError, ValueError) as error:
        raise PhugoidError(f'`{address}`: {error}. Addresses need pip install "phugoid[fleet]"') from error
    # Others write there too.
    files.invalidate_cache()
    return files, path.rstrip("/")


def names(words: Sequence[str]) -> list[str]:
    """Files and addresses of all logs that are meant, each once, in one order.

    :raises PhugoidError: if there is nothing at a path or an address.
    """
    remote = [word for word in words if is_address(word)]
    here = [word for word in words if not is_address(word)]
    found = set(_phugoid.fleet_files(here) if here else [])
    for word in remote:
        files, path = _filesystem(word)
        there = files.glob(path) if any(letter in path for letter in "*?[") else files.find(path)
        if not there:
            raise PhugoidError(f"`{word}`: nothing is there")
        found.update(files.unstrip_protocol(one) for one in there if files.isfile(one))
    return sorted(found)


@contextlib.contextmanager
def content(name: str) -> Iterator[str]:
    """A file with the content of a log: the log itself, or a copy for as long as it is needed."""
    if not is_address(name):
        yield name
        return
    # The end of the name is kept, because tables are known by it.
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, os.path.basename(name))
        # What cannot be fetched is found missing by the reader, and becomes a row.
        with contextlib.suppress(OSError):
            files, path = _filesystem(name)
            files.get(path, copy)
        yield copy


class RemoteStore:
    """A store behind an address. What is written goes into a store on this machine first and is then sent file by file; an
    object is there whole or not at all, so that the store is the same as one on a disk: the same names, the same bytes."""

    def __init__(self, address: str) -> None:
        self.address = address
        self._files, self._folder = _filesystem(address)

    def _path(self, name: str) -> str:
        return f"{self._folder}/{name}"

    def _names(self, *folders: str) -> list[str]:
        found: list[str] = []
        for folder in folders:
            with contextlib.suppress(FileNotFoundError):
                found.extend(self._files.find(self._path(folder) if folder else self._folder))
        return [name[len(self._folder) + 1 :] for name in found]

    def _mark(self) -> bytes | None:
        try:
            mark: bytes = self._files.cat_file(self._path(_MARK))
        except FileNotFoundError:
            return None
        return mark

    def begin(self, here: str) -> None:
        """Begins the store, or finds that there is one of the schema that the store in the folder ``here`` has.

        :raises PhugoidError: if something else is there, or a store of another schema.
        """
        with open(os.path.join(here, _MARK), "rb") as file:
            ours = file.read()
        found = self._mark()
        if found is None:
            if self._names(""):
                raise PhugoidError(f"`{self.address}`: something is there that is no store. Name a new folder")
            self._files.pipe_file(self._path(_MARK), ours)
        elif found != ours:
            theirs, own = found.decode(errors="replace").strip(), ours.decode().strip()
            raise PhugoidError(
                f"`{self.address}`: this store has schema {theirs}, this version writes {own}. Name a new folder"
            )

    def done(self) -> set[str]:
        """Names of the files of units, and of the notes of those that are tried again."""
        return set(self._names("estimates", "again"))

    def send(self, here: str, earlier: Sequence[str] = ()) -> None:
        """Sends everything that the store in the folder ``here`` holds. ``earlier`` are files of the store behind the
        address that are removed unless they are sent anew.

        Who is killed in between leaves a store in which the units are tried again: notes that say so come before the rows and go
        after them, and a row that says that a log cannot be read goes before its successors come.
        """
        paths = [os.path.join(folder, file) for folder, _, files in os.walk(here) for file in files]
        ours = {os.path.relpath(path, here).replace(os.sep, "/"): path for path in paths}
        del ours[_MARK]
        late = [name for name in earlier if name not in ours]
        for name in late:
            if not name.startswith("again/"):
                self._remove(name)
        order = {"again": 0, "models": 1, "logs": 2, "estimates": 3}
        for name in sorted(ours, key=lambda name: (order[name.split("/")[0]], name)):
            with open(ours[name], "rb") as file:
                self._files.pipe_file(self._path(name), file.read())
        for name in late:
            if name.startswith("again/"):
                self._remove(name)

    def _remove(self, name: str) -> None:
        with contextlib.suppress(FileNotFoundError):
            self._files.rm_file(self._path(name))

    def fetch(self, here: str) -> None:
        """Copies the store into a folder.

        :raises PhugoidError: if there is no store, or an object whose name would lead out of the folder.
        """
        if self._mark() is None:
            raise PhugoidError(f"`{self.address}`: there is no store")
        for name in self._names(""):
            parts = name.split("/")
            if any(part in ("", ".", "..") or os.path.basename(part) != part for part in parts):
                raise PhugoidError(f"`{self.address}`: no store has an object called `{name}`. Remove it if it is not yours")
            path = os.path.join(here, *parts)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            self._files.get_file(self._path(name), path)


@contextlib.contextmanager
def on_this_machine(store: str) -> Iterator[str]:
    """The folder of a store, or for one behind an address that of a copy, for as long as it is needed."""
    if not is_address(store):
        yield store
        return
    with tempfile.TemporaryDirectory() as here:
        RemoteStore(store).fetch(here)
        yield here
