#!/usr/bin/env python3
"""Writes the parts list (SBOM) of the program as CycloneDX 1.5 in JSON.

It has every crate whose code, or the code that its macros write, is in `phugoid`, with its version, licence, source and
check sum, and what depends on what.

    scripts/sbom.py [--features all-formats] [--target TRIPLE] [--out phugoid.cdx.json]

Without --out it goes to standard output. All facts come from `cargo metadata` and Cargo.lock, so that the same sources
give the same bytes: there is no date in it and no random number. Before anything is written the document is checked:
every reference leads to a part, every part is reached from the program, and every part from a registry has a licence
and a check sum. CycloneDX: ECMA-424.
"""

import argparse
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = "phugoid-cli"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    told = "features of the program beyond its default ones, separated by commas"
    parser.add_argument("--features", default="", help=told)
    parser.add_argument("--target", help="target triple [default: that of this machine]")
    parser.add_argument("--out", type=Path, help="file to write")
    return parser.parse_args()


def host() -> str:
    told = subprocess.run(["rustc", "-vV"], check=True, capture_output=True, text=True).stdout
    return re.search(r"^host: (.+)$", told, re.MULTILINE).group(1)


def metadata(features: str, target: str) -> dict:
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", target]
    # The features are those of the program: without its manifest, those of all crates of the workspace would be taken.
    command += ["--manifest-path", str(ROOT / "crates" / PROGRAM / "Cargo.toml")]
    if features:
        command += ["--features", features]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def linked(graph: dict, root: str) -> dict[str, list[str]]:
    """The parts that end up in the program, and for each the parts that it uses: no dependencies of builds or tests."""
    nodes = {node["id"]: node for node in graph["resolve"]["nodes"]}
    found: dict[str, list[str]] = {}
    ahead = [root]
    while ahead:
        part = ahead.pop()
        if part in found:
            continue
        normal = [dep["pkg"] for dep in nodes[part]["deps"] if any(kind["kind"] is None for kind in dep["dep_kinds"])]
        found[part] = sorted(set(normal))
        ahead.extend(normal)
    return found


def purl(package: dict) -> str:
    return f"pkg:cargo/{package['name']}@{package['version']}"


def component(package: dict, checksums: dict[tuple[str, str], str], kind: str) -> dict:
    part = {"type": kind, "bom-ref": purl(package), "name": package["name"], "version": package["version"]}
    if package.get("license"):
        # Some crates still write the alternative with a slash.
        part["licenses"] = [{"expression": package["license"].replace("/", " OR ")}]
    checksum = checksums.get((package["name"], package["version"]))
    if package.get("source"):
        part["purl"] = purl(package)
        part["hashes"] = [{"alg": "SHA-256", "content": checksum}] if checksum else []
        part["externalReferences"] = [{"type": "distribution", "url": package["source"].removeprefix("registry+")}]
    return part


def document(features: str, target: str) -> dict:
    graph = metadata(features, target)
    packages = {package["id"]: package for package in graph["packages"]}
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text(encoding="utf-8"))
    checksums = {(part["name"], part["version"]): part.get("checksum") for part in lock["package"]}
    root = next(id for id, package in packages.items() if package["name"] == PROGRAM)
    used = linked(graph, root)
    parts = sorted(used, key=lambda id: (packages[id]["name"], packages[id]["version"]))
    facts = {"target": target, "features": features or "default"}
    properties = [{"name": f"phugoid:{name}", "value": value} for name, value in facts.items()]
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": component(packages[root], checksums, "application"), "properties": properties},
        "components": [component(packages[id], checksums, "library") for id in parts if id != root],
        "dependencies": [
            {"ref": purl(packages[id]), "dependsOn": [purl(packages[other]) for other in used[id]]} for id in parts
        ],
    }


def check(sbom: dict) -> list[str]:
    """What is wrong with the document; empty if nothing is."""
    root = sbom["metadata"]["component"]["bom-ref"]
    parts = [part["bom-ref"] for part in sbom["components"]]
    uses = {entry["ref"]: entry["dependsOn"] for entry in sbom["dependencies"]}
    wrong = [f"{part} stands in it twice" for part in sorted({part for part in parts if parts.count(part) > 1})]
    known = {root, *parts}
    wrong += [f"{part} has no entry of what it uses" for part in sorted(known - set(uses))]
    pairs = [(ref, other) for ref, others in uses.items() for other in others]
    wrong += [f"{ref} uses {other}, which is no part" for ref, other in pairs if other not in known]
    reached, ahead = set(), [root]
    while ahead:
        part = ahead.pop()
        if part not in reached:
            reached.add(part)
            ahead.extend(uses.get(part, []))
    wrong += [f"{part} is not reached from the program" for part in sorted(known - reached)]
    for part in sbom["components"]:
        if not part.get("licenses"):
            wrong.append(f"{part['bom-ref']} has no licence")
        if "hashes" in part and not re.fullmatch(r"[0-9a-f]{64}", (part["hashes"] or [{"content": ""}])[0]["content"]):
            wrong.append(f"{part['bom-ref']} has no check sum")
    if len(parts) < 20:
        wrong.append(f"{len(parts)} parts are too few")
    return wrong


def main() -> None:
    asked = arguments()
    sbom = document(asked.features, asked.target or host())
    wrong = check(sbom)
    if wrong:
        sys.exit("the parts list is wrong:\n  " + "\n  ".join(wrong))
    text = json.dumps(sbom, indent=2) + "\n"
    if asked.out:
        asked.out.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)
    print(f"{len(sbom['components'])} parts, each with its licence and check sum", file=sys.stderr)


if __name__ == "__main__":
    main()
