#!/usr/bin/env python3
"""Packs files into an archive that is the same, byte for byte, wherever and whenever it is packed.

    scripts/pack.py OUT.tar.gz|OUT.zip FOLDER FILE ...      FOLDER is the name of the folder inside the archive
    scripts/pack.py --sums FOLDER                           writes FOLDER/SHA256SUMS of all other files there
    scripts/pack.py --verify FOLDER                         checks them: none missing, none changed, none that is not listed

The times in the archive are those of the commit (SOURCE_DATE_EPOCH where it is set), owners and groups are nobody, and a file
is executable in it where it is `phugoid` or `phugoid.exe`.
"""

import gzip
import hashlib
import io
import os
import subprocess
import sys
import tarfile
import time
import zipfile
from pathlib import Path

SUMS = "SHA256SUMS"


def moment() -> int:
    """The time of all files, s from 1970."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given:
        return int(given)
    told = subprocess.run(["git", "log", "-1", "--format=%ct"], check=True, capture_output=True, text=True).stdout
    return int(told)


def mode(file: Path) -> int:
    return 0o755 if file.name in ("phugoid", "phugoid.exe") else 0o644


def packed(folder: str, files: list[Path], zipped: bool) -> bytes:
    out = io.BytesIO()
    at = moment()
    if zipped:
        with zipfile.ZipFile(out, "w") as archive:
            for file in files:
                entry = zipfile.ZipInfo(f"{folder}/{file.name}", time.gmtime(max(at, 315_532_800))[:6])
                entry.compress_type = zipfile.ZIP_DEFLATED
                # As on Unix, wherever it is packed.
                entry.create_system, entry.external_attr = 3, (0o100000 | mode(file)) << 16
                archive.writestr(entry, file.read_bytes())
        return out.getvalue()
    with gzip.GzipFile(filename="", fileobj=out, mode="wb", compresslevel=6, mtime=at) as compressed:
        with tarfile.open(fileobj=compressed, mode="w", format=tarfile.PAX_FORMAT) as archive:
            for file in files:
                entry = tarfile.TarInfo(f"{folder}/{file.name}")
                entry.size, entry.mtime, entry.mode = file.stat().st_size, at, mode(file)
                with file.open("rb") as content:
                    archive.addfile(entry, content)
    return out.getvalue()


def sums(folder: Path) -> str:
    files = sorted(file for file in folder.iterdir() if file.is_file() and file.name != SUMS)
    return "".join(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in files)


def main() -> None:
    match sys.argv[1:]:
        case ["--sums", folder]:
            (Path(folder) / SUMS).write_text(sums(Path(folder)), newline="\n")
        case ["--verify", folder]:
            if (Path(folder) / SUMS).read_text() != sums(Path(folder)):
                sys.exit(f"pack: {folder}/{SUMS} is not that of the files beside it: pack them again")
        case [out, folder, *files] if files:
            files = sorted((Path(file) for file in files), key=lambda file: file.name)
            names = [file.name for file in files]
            if len(set(names)) < len(names):
                sys.exit(f"pack: two files have the same name: {', '.join(names)}")
            Path(out).write_bytes(packed(folder, files, out.endswith(".zip")))
        case _:
            sys.exit(__doc__)


main()
