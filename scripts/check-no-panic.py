#!/usr/bin/env python3
"""Checks that no method that flies can panic on a Cortex-M.

Builds the images of crates/phugoid-estimators/onboard for thumbv7em-none-eabihf, one per method, and looks whether
Rust's panic handler is in them. The linker leaves out what nothing reaches, so that its absence says that the compiler
has proved every index, slice, division and `clamp` of all that a user can call. An image that does panic is looked at
too: when nothing is found there, the check itself is at fault.

Lists the places that are left: function, what it calls, and the source line where that is known. Needs rustup's target
and nothing else. Usage: scripts/check-no-panic.py [METHOD ...]
"""

import collections
import os
import pathlib
import re
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ONBOARD = ROOT / "crates" / "phugoid-estimators" / "onboard"
TARGET = "thumbv7em-none-eabihf"
# The image that has to fail.
CONTROL = "control"

Symbol = collections.namedtuple("Symbol", "name address size kind")


class Image:
    """Symbols and relocations of a linked 32-bit little-endian ELF file, which the linker's --emit-relocs keeps."""

    def __init__(self, path):
        self.data = path.read_bytes()
        if self.data[:6] != b"\x7fELF\x01\x01":
            sys.exit(f"{path} is not a 32-bit little-endian ELF file")
        (table,) = struct.unpack_from("<I", self.data, 32)
        size, count, _ = struct.unpack_from("<3H", self.data, 46)
        # name, type, flags, address, offset, size, link, info, alignment, entry size
        self.sections = [struct.unpack_from("<10I", self.data, table + i * size) for i in range(count)]
        [symbols] = [section for section in self.sections if section[1] == 2]
        names = self.sections[symbols[6]][4]
        self.symbols = []
        for at in range(symbols[4], symbols[4] + symbols[5], 16):
            name, value, length, info, _, _ = struct.unpack_from("<IIIBBH", self.data, at)
            text = self.data[names + name : self.data.index(b"\0", names + name)].decode()
            # The lowest bit of a function's address says that its code is Thumb.
            kind = info & 15
            self.symbols.append(Symbol(text, value & ~1 if kind == 2 else value, length, kind))

    def functions(self):
        return sorted((s for s in self.symbols if s.kind == 2 and s.size), key=lambda s: s.address)

    def relocations(self):
        """(address, symbol) of every reference."""
        for section in self.sections:
            if section[1] == 9:
                for at in range(section[4], section[4] + section[5], 8):
                    address, info = struct.unpack_from("<II", self.data, at)
                    yield address, self.symbols[info >> 8]

    def bytes_at(self, address, length):
        """What is loaded at an address; nothing where no section of the file is."""
        for section in self.sections:
            if section[1] == 1 and section[2] & 2 and section[3] <= address < section[3] + section[5]:
                start = section[4] + address - section[3]
                return self.data[start : start + min(length, section[3] + section[5] - address)]
        return b""

    def location(self, symbol):
        """The source line of a `core::panic::Location`, or nothing if the symbol is none."""
        if symbol.kind == 2 or symbol.size != 16:
            return None
        raw = self.bytes_at(symbol.address, 16)
        if len(raw) < 16:
            return None
        address, length, line, column = struct.unpack("<4I", raw)
        file = self.bytes_at(address, length) if length < 1000 else b""
        if len(file) != length or not re.fullmatch(rb"[\x20-\x7e]+\.rs", file):
            return None
        return re.sub(r".*/(?=library/|[^/]+/src/)", "", file.decode()) + f":{line}:{column}"


def readable(name):
    """The path in a mangled name, old or new, without hashes, crate numbers and generics."""
    if name.startswith("_ZN"):
        parts, rest = [], name[3:]
        while match := re.match(r"\d+", rest):
            end = match.end() + int(match.group())
            parts.append(rest[match.end() : end])
            rest = rest[end:]
        text = "::".join(part for part in parts if not re.fullmatch(r"h[0-9a-f]{16}", part))
        signs = (("LT", "<"), ("GT", ">"), ("u20", " "), ("C", ","), ("RF", "&"), ("u7b", "{"), ("u7d", "}"))
        for code, sign in signs:
            text = text.replace(f"${code}$", sign)
        return re.sub(r"<[^<>]*_[^<>]*>", "", text.replace("..", "::")).lstrip("_")
    if name.startswith("_R"):
        parts, at = [], 0
        while match := re.compile(r"(?<![\dA-Za-z])?(\d+)_?([A-Za-z_])").search(name, at):
            length = int(match.group(1))
            word = name[match.start(2) : match.start(2) + length]
            if len(word) == length:
                parts.append(word)
            at = match.start(2) + max(length, 1)
        return "::".join(parts)
    return name


def is_handler(name):
    return "rust_begin_unwind" in name


def is_of_core(name):
    return "4core" in name.split("_ZN")[-1][:40] or bool(re.match(r"_R\w*?Cs\w+_4core", name))


def panics_of(image):
    """Where functions of ours call what ends in the handler: {caller: {callee: count}}, and {caller: source lines}.

    None if the handler is not in the image.
    """
    functions = image.functions()
    starts = [function.address for function in functions]
    by_address = {function.address: function for function in functions}

    def containing(address):
        low, high = 0, len(starts)
        while low < high:
            middle = (low + high) // 2
            low, high = (middle + 1, high) if starts[middle] <= address else (low, middle)
        if low == 0:
            return None
        function = functions[low - 1]
        return function if address < function.address + function.size else None

    calls, places = collections.Counter(), collections.defaultdict(set)
    for address, symbol in image.relocations():
        caller = containing(address)
        if caller is None:
            continue
        callee = by_address.get(symbol.address) if symbol.kind == 2 else None
        if callee is not None and callee != caller:
            calls[caller, callee] += 1
        elif line := image.location(symbol):
            places[caller].add(line)

    panicking = {function for function in functions if is_handler(function.name)}
    if not panicking:
        return None
    # Functions of the core library that do nothing but fail, or that may: their callers are of interest.
    grown = True
    while grown:
        callers = {a for (a, b) in calls if b in panicking and is_of_core(a.name)}
        grown = not callers <= panicking
        panicking |= callers
    sites = {}
    for (caller, callee), count in calls.items():
        if callee in panicking and caller not in panicking:
            sites.setdefault(caller, collections.Counter())[callee] += count
    return sites, places


def report(name, found):
    sites, places = found
    total = sum(count for callees in sites.values() for count in callees.values())
    print(f"{name}: {total} calls of code that panics, in {len(sites)} functions:")
    for caller in sorted(sites, key=lambda function: function.name):
        callees = ", ".join(f"{readable(c.name)} ({n})" for c, n in sorted(sites[caller].items(), key=str))
        print(f"    {readable(caller.name)}\n        calls {callees}")
        for line in sorted(places[caller]):
            print(f"        at {line}")
    if not sites:
        print("    the panic handler is reached by a way that this script does not follow")
    return total


def main():
    wanted = sys.argv[1:]
    environment = dict(os.environ)
    flags = f"CARGO_TARGET_{TARGET.upper().replace('-', '_')}_RUSTFLAGS"
    environment[flags] = "-C link-arg=--emit-relocs"
    for overriding in ("RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET"):
        environment.pop(overriding, None)
    target = pathlib.Path(environment.setdefault("CARGO_TARGET_DIR", str(ROOT / "target" / "onboard")))
    command = ["cargo", "build", "--locked", "--release", "--target", TARGET]
    for name in wanted and [*wanted, CONTROL]:
        command += ["--bin", name]
    subprocess.run(command, cwd=ONBOARD, env=environment, check=True)

    methods = wanted or sorted(path.stem for path in (ONBOARD / "src" / "bin").glob("*.rs") if path.stem != CONTROL)
    images = {name: Image(target / TARGET / "release" / name) for name in [CONTROL, *methods]}
    control = panics_of(images[CONTROL])
    if not control or not control[0] or not any(control[1].values()):
        sys.exit("check-no-panic: found nothing in the image that does panic: this check does not work")
    failed = []
    for name in methods:
        found = panics_of(images[name])
        if found is None:
            print(f"{name}: does not panic")
        else:
            report(name, found)
            failed.append(name)
    if failed:
        sys.exit(f"check-no-panic: code that panics is left in {', '.join(failed)}")


if __name__ == "__main__":
    main()
