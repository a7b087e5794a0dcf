"""What scripts share that kill programs and look at what is left in a store."""

from __future__ import annotations

import os
import signal
from pathlib import Path


def content(store: Path) -> dict[str, bytes]:
    """Every file of a store; what is half written has another name and is no part of it."""
    files = (file for file in store.rglob("*") if file.is_file() and not file.name.startswith(".phugoid-"))
    return {str(file.relative_to(store)): file.read_bytes() for file in files}


def descendants(of: int) -> list[tuple[int, str]]:
    """Number and command line of every process that this one has begun, and that those have."""
    parents: dict[int, tuple[int, str]] = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                parent = int((folder / "stat").read_text().rsplit(")", 1)[1].split()[1])
                command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            except OSError:
                continue
            parents[int(folder.name)] = (parent, command)
    found, new = [], [of]
    while new:
        new = [number for number, (parent, _) in parents.items() if parent in new]
        found.extend((number, parents[number][1]) for number in new)
    return found


def kill(number: int) -> bool:
    try:
        os.kill(number, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True
