"""What the tests of fleets share."""

from pathlib import Path

import phugoid
import pytest


def content(store):
    """Every file of a store on the disk."""
    return {str(file.relative_to(store)): file.read_bytes() for file in Path(store).rglob("*") if file.is_file()}


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Three flights, a copy of one, and a file that is no flight."""
    folder = tmp_path_factory.mktemp("fleet") / "N17"
    folder.mkdir()
    for seed in (1, 2, 3):
        phugoid.simulate("f16-calm", seed=seed)[0].write_csv(folder / f"flight-{seed}.csv")
    (folder / "copy.csv").write_bytes((folder / "flight-1.csv").read_bytes())
    (folder / "broken.csv").write_text("no flight\n1\n")
    return folder
