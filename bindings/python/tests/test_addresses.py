"""Logs and stores behind addresses: the same rows as on a disk. The object store is moto's server in this process."""

import urllib.request

import phugoid
import pytest
from conftest import content

fsspec = pytest.importorskip("fsspec")
pytest.importorskip("s3fs", reason="pip install s3fs")
moto_server = pytest.importorskip("moto.server", reason="pip install 'moto[server]'")

CAMPAIGN = """
name = "in blocks"
scenarios = ["hfb320"]
models = ["hfb320"]
methods = ["smpe"]
seeds = 6
block = 3
"""


@pytest.fixture
def bucket(monkeypatch):
    """A bucket of its own server, which the variables of the environment lead to."""
    server = moto_server.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "test")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    fsspec.get_filesystem_class("s3").clear_instance_cache()
    fsspec.filesystem("s3").mkdir("flights")
    yield "s3://flights"
    fsspec.get_filesystem_class("s3").clear_instance_cache()
    # The buckets of all servers of a process are the same.
    urllib.request.urlopen(urllib.request.Request(f"http://{host}:{port}/moto-api/reset", method="POST")).close()
    server.stop()


def files_in(address):
    """Every object of a store behind an address."""
    files, folder = fsspec.core.url_to_fs(address)
    files.invalidate_cache()
    return {name[len(folder) + 1 :]: files.cat_file(name) for name in files.find(folder)}


def test_a_store_behind_an_address_holds_the_bytes_of_one_on_the_disk(logs, bucket, tmp_path):
    phugoid.fleet(str(logs), "f16-model", tmp_path / "disk")
    done = []
    summary = phugoid.fleet(str(logs), "f16-model", f"{bucket}/fleet", workers=2, progress=done.append)
    assert (summary["estimated"], summary["copies"], summary["refused"]) == (4, 1, 1)
    assert done[-1] == 1.0
    assert files_in(f"{bucket}/fleet") == content(tmp_path / "disk")
    # Nothing is estimated twice, and shards complete what is missing.
    assert phugoid.fleet(str(logs), "f16-model", f"{bucket}/fleet")["found"] == 4
    for shard in ("2/2", "1/2"):
        phugoid.fleet(str(logs), "f16-model", f"{bucket}/shards", shard=shard)
    assert files_in(f"{bucket}/shards") == content(tmp_path / "disk")
    told = phugoid.fleet_tell(f"{bucket}/fleet")
    assert told == phugoid.fleet_tell(tmp_path / "disk")


def test_logs_behind_an_address_give_the_rows_of_those_on_the_disk(logs, bucket, tmp_path):
    phugoid.fleet(str(logs), "f16-model", tmp_path / "disk")
    files = fsspec.filesystem("s3")
    files.put(str(logs), f"{bucket}/logs/N17", recursive=True)
    for name, words in (("folder", f"{bucket}/logs"), ("pattern", [f"{bucket}/logs/*/*.csv"])):
        store = tmp_path / name
        assert phugoid.fleet(words, "f16-model", store)["estimated"] == 4
        ours, theirs = content(tmp_path / "disk"), content(store)
        assert set(ours) == set(theirs)
        # What is known of a log holds its path, which is another one.
        assert {name: ours[name] == theirs[name] for name in ours if not name.startswith("logs")} == {
            name: True for name in ours if not name.startswith("logs")
        }
        airframes = phugoid.fleet_tell(store)["airframes"]
        assert [airframe["name"] for airframe in airframes] == ["N17"]


def test_a_log_that_could_not_be_read_has_no_row_of_that_any_more_once_it_can(logs, bucket, tmp_path):
    link = tmp_path / "N17" / "flight.csv"
    link.parent.mkdir()
    link.symlink_to(tmp_path / "nowhere")
    for store in (f"{bucket}/fleet", str(tmp_path / "disk")):
        summary = phugoid.fleet(str(link.parent / "*.csv"), "f16-model", store)
        assert (summary["estimated"], summary["refused"]) == (1, 1)
    assert files_in(f"{bucket}/fleet") == content(tmp_path / "disk")
    link.unlink()
    link.write_bytes((logs / "flight-1.csv").read_bytes())
    for store in (f"{bucket}/fleet", str(tmp_path / "disk")):
        assert phugoid.fleet(str(link), "f16-model", store)["refused"] == 0
    assert files_in(f"{bucket}/fleet") == content(tmp_path / "disk")
    assert not any(name.startswith("again/") for name in files_in(f"{bucket}/fleet"))


def test_a_campaign_behind_an_address_is_that_of_the_disk(bucket, tmp_path):
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    summary = phugoid.campaign(tmp_path / "c.toml", tmp_path / "disk", workers=2)
    assert (summary["files"], summary["estimated"], summary["refused"]) == (6, 6, 0)
    for shard in ("1/2", "2/2"):
        phugoid.campaign(tmp_path / "c.toml", f"{bucket}/study", shard=shard)
    assert files_in(f"{bucket}/study") == content(tmp_path / "disk")
    assert phugoid.campaign(tmp_path / "c.toml", f"{bucket}/study")["found"] == 6


def test_what_is_wrong_with_an_address_is_told_before_anything_is_estimated(logs, bucket):
    files = fsspec.filesystem("s3")
    files.pipe_file(f"{bucket}/other/file.txt", b"something")
    with pytest.raises(phugoid.PhugoidError, match="no store"):
        phugoid.fleet(str(logs), "f16-model", f"{bucket}/other")
    files.pipe_file(f"{bucket}/old/phugoid-fleet-store.txt", b"0\n")
    with pytest.raises(phugoid.PhugoidError, match="schema 0"):
        phugoid.fleet(str(logs), "f16-model", f"{bucket}/old")
    with pytest.raises(phugoid.PhugoidError, match="nothing is there"):
        phugoid.fleet(f"{bucket}/nowhere/*.csv", "f16-model", f"{bucket}/new")
    with pytest.raises(phugoid.PhugoidError, match="there is no store"):
        phugoid.fleet_tell(f"{bucket}/nowhere")
    with pytest.raises(phugoid.PhugoidError, match="no-such-protocol"):
        phugoid.fleet(str(logs), "f16-model", "no-such-protocol://bucket/fleet")


def test_an_object_cannot_lead_out_of_the_folder(logs, bucket):
    phugoid.fleet(str(logs), "f16-model", f"{bucket}/fleet")
    files, folder = fsspec.core.url_to_fs(f"{bucket}/fleet")
    files.pipe_file(f"{folder}/estimates/../../../../outside.txt", b"not a row")
    with pytest.raises(phugoid.PhugoidError, match="outside.txt"):
        phugoid.fleet_tell(f"{bucket}/fleet")
