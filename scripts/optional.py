#!/usr/bin/env python3
"""Builds what is off by default (all formats of flights, fleets and campaigns), and runs tests of it.

    scripts/optional.py test PACKAGE [FILTER]...      tests of a package, all or those whose names contain a filter
    scripts/optional.py examples NAME...              builds examples into quick/examples of the target folder

Every call asks cargo for the same packages with the same features, so that no library is built twice, and for the profile
`quick`, because the libraries of Parquet, Arrow and MCAP take minutes to optimise.
"""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SELECTION = ["--locked", "--profile", "quick", "-p", "phugoid-flight-data", "-p", "phugoid-fleet", "-p", "phugoid-cli"]
SELECTION += ["--features", "phugoid-cli/all-formats,phugoid-cli/fleet,phugoid-fleet/parquet"]


def cargo(command, *more):
    """Runs cargo on the selection; ends the script where cargo fails. The artifacts that it reports."""
    build = subprocess.run(
        ["cargo", command, *SELECTION, *more, "--quiet", "--message-format", "json-render-diagnostics"], cwd=ROOT, stdout=subprocess.PIPE
    )
    if build.returncode != 0:
        sys.exit(build.returncode)
    messages = map(json.loads, build.stdout.splitlines())
    return [message for message in messages if message["reason"] == "compiler-artifact"]


def test(package, *filters):
    folder = ROOT / "crates" / package
    artifacts = cargo("test", "--no-run", "--lib", "--test", "integration")
    programs = [
        artifact["executable"]
        for artifact in artifacts
        if artifact["executable"] and artifact["profile"]["test"] and artifact["manifest_path"] == str(folder / "Cargo.toml")
    ]
    if not programs:
        sys.exit(f"optional.py: {package} has no tests among the packages that are built here")
    ran = 0
    for program in programs:
        listed = subprocess.run([program, "--list", *filters], cwd=folder, check=True, capture_output=True, text=True).stdout
        ran += listed.count(": test\n")
        # In the folder of the package, as cargo does.
        if subprocess.run([program, "--quiet", *filters], cwd=folder).returncode != 0:
            sys.exit(f"optional.py: tests of {package} failed: {program}")
    if ran == 0:
        sys.exit(f"optional.py: no test of {package} has a name with {' or '.join(filters)}")


def main():
    match sys.argv[1:]:
        case ["test", package, *filters]:
            test(package, *filters)
        case ["examples", first, *names]:
            cargo("build", "-p", "phugoid-identification", *(word for name in (first, *names) for word in ("--example", name)))
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()
