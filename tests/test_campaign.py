"""Campaigns: the same rows here, on a cluster, and after kills."""

import json
import os
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager, nullcontext
from pathlib import Path

import campaigning
import jsonschema
import pytest

import palpate
from palpate.experiments import campaign, closed_loop
from palpate.experiments import cluster as on_cluster
from palpate.experiments.build import build

COUNT = 30
PATIENCE = 120.0  # seconds; an idle machine needs three
THIRDS = [{"number": number, "third": number / 3} for number in range(COUNT)]
SETTINGS = {"pause": 0.0, "folder": "."}
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}


@contextmanager
def started(*arguments):
    """A process of Python's that finds the campaign of these tests; killed in the end."""
    command = [sys.executable, *map(str, arguments)]
    with subprocess.Popen(
        command, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def wait_until(condition, *, alive=None):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert alive is None or alive.poll() is None, alive.stderr.read()
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)


def rows_in(file):
    """The rows on disk, without what depends on the machine."""
    return [campaign.without_times(row) for row in campaign.read(file)[1]]


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_rows_are_on_disk_in_order_under_a_header(tmp_path):
    file = tmp_path / "deep" / "rows.jsonl"
    rows = campaign.run("thirds", SETTINGS | {"folder": str(tmp_path)}, [2, 0, 1], campaigning.task, file)
    header, read = campaign.read(file)
    assert rows == read and [row["number"] for row in rows] == [0, 1, 2]
    assert header["name"] == "thirds" and header["settings"]["pause"] == 0.0
    assert header["palpate"] and header["schema"] == "palpate-rows" and header["version"] == 1
    assert header["build"] == build()


def test_more_numbers_are_added_to_those_that_are_there(tmp_path):
    calls = []

    def task(number):
        calls.append(number)
        return {"double": 2 * number}

    for count in (3, 5, 2):
        rows = campaign.run("doubles", {}, range(count), task, tmp_path / "rows")
        assert [row["double"] for row in rows] == [2 * number for number in range(count)]
    assert calls == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"name": "others"}, "holds other rows (name is 'thirds', not 'others')"),
        ({"settings": {"pause": 1.0}}, "holds other rows (settings"),
        ({"numbers": [1, 2]}, "holds rows of other numbers"),
    ],
)
def test_a_file_of_another_campaign_is_refused(tmp_path, change, words):
    usual = {"name": "thirds", "settings": {}, "numbers": [2, 3]}
    campaign.run(*usual.values(), lambda number: {}, tmp_path / "rows")
    with pytest.raises(ValueError, match=r"^file: ") as refused:
        campaign.run(*(usual | change).values(), lambda number, **settings: {}, tmp_path / "rows")
    assert words in str(refused.value)


def test_rows_of_another_build_are_refused(tmp_path, monkeypatch):
    """Of the same version: the file, and a worker."""
    campaign.run("thirds", {}, [1], lambda number: {}, tmp_path / "rows")
    monkeypatch.setattr(campaign, "build", lambda: "another")
    with pytest.raises(ValueError, match=r"holds other rows \(build is "):
        campaign.run("thirds", {}, [1, 2], lambda number: {}, tmp_path / "rows")
    with pytest.raises(ValueError, match="a worker has another build"):
        on_cluster._row(lambda number: {}, {}, "another", 1)


def test_a_build_is_known_by_its_sources(tmp_path, monkeypatch):
    folder = Path(campaign.__file__).parents[1]
    made = build.__wrapped__()
    assert made == build() and len(made) == 32
    copy = tmp_path / "palpate"
    shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(palpate, "__file__", str(copy / "__init__.py"))
    assert build.__wrapped__() == made
    with (copy / "truth.py").open("a") as source:
        source.write("# changed\n")
    assert build.__wrapped__() != made


def test_lines_are_as_the_schema_says(tmp_path):
    campaign.run("thirds", SETTINGS | {"folder": str(tmp_path)}, [0, 1], campaigning.task, tmp_path / "rows")
    schema = json.loads((Path(campaign.__file__).parents[1] / "schemas" / "rows-1.json").read_text())
    for line in (tmp_path / "rows").read_text().splitlines():
        jsonschema.validate(json.loads(line), schema)


def test_what_is_no_file_of_rows_is_refused(tmp_path):
    (tmp_path / "rows").write_text("a diary\n")
    with pytest.raises(ValueError, match="is not a file of rows"):
        campaign.run("thirds", {}, [1], campaigning.task, tmp_path / "rows")
    assert (tmp_path / "rows").read_text() == "a diary\n"


@pytest.mark.parametrize("cluster", ["locale", "local:", "local:0", "local:two", "", "tcp://127.0.0.1:9"])
def test_a_cluster_that_is_none_is_refused(tmp_path, cluster, monkeypatch):
    monkeypatch.setattr("palpate.experiments.cluster.ANSWERS_WITHIN", 0.5)
    with pytest.raises(ValueError, match=r"^cluster: "):
        campaign.run("thirds", SETTINGS, [1], campaigning.task, tmp_path / "rows", cluster=cluster)


def test_a_campaign_that_was_killed_goes_on_where_it_was(tmp_path):
    """Killed on a local cluster, its workers end too; finished here, it is as if it had never been killed."""
    file = tmp_path / "rows"
    with started(campaigning.__file__, file, COUNT, 0.2, tmp_path, "local:2") as process:
        wait_until(lambda: file.exists() and file.read_bytes().count(b"\n") > 3, alive=process)
    before = file.read_bytes()
    assert before.count(b"\n") < COUNT
    pids = [int(path.stem) for path in tmp_path.glob("*.pid")]
    assert pids
    wait_until(lambda: not any(map(is_running, pids)))
    file.write_bytes(before[: before.rfind(b"\n") + 1] + b'{"number":')  # as if a line had been cut short
    campaigning.main(file, COUNT, 0.2, str(tmp_path))
    assert file.read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    assert rows_in(file) == THIRDS


@contextmanager
def cluster_without_nannies(folder):
    """A scheduler and two workers that nobody starts again; its address."""
    place = folder / "scheduler.json"
    quiet = ["--no-dashboard", "--scheduler-file", place]
    address = ["--port", 0, "--host", "127.0.0.1"]
    worker = ["-m", "distributed.cli.dask_worker", "--no-nanny", "--nthreads", 1, *quiet]
    with started("-m", "distributed.cli.dask_scheduler", *address, *quiet) as scheduler:
        wait_until(place.exists, alive=scheduler)
        with started(*worker), started(*worker):
            yield json.loads(place.read_text())["address"]


@pytest.mark.parametrize("nanny", [True, False])
def test_a_killed_worker_costs_its_task_not_the_run(tmp_path, nanny):
    """A worker is killed in the middle of task 11; the nanny starts another one, or there is one less."""
    file, victim = tmp_path / "rows", tmp_path / "victim"
    victim.write_text("11")
    with nullcontext("local:2") if nanny else cluster_without_nannies(tmp_path) as at:
        with started(campaigning.__file__, file, COUNT, 0.02, tmp_path, at) as process:
            _, said = process.communicate(timeout=2 * PATIENCE)
    assert process.returncode == 0, said
    assert not victim.exists()
    pids = [int(path.stem) for path in tmp_path.glob("*.pid")]
    assert len(pids) >= 2
    assert rows_in(file) == THIRDS


def test_closed_loops_are_the_same_on_a_cluster(tmp_path):
    """Bit for bit, but for times."""
    settings = {"position_error": 0.5, "normal_error_deg": 4.0, "beside": ["chance", "entropy"]}
    for name, where in (("here", None), ("there", "local:2")):
        campaign.run("loops", settings, range(4), closed_loop.task, tmp_path / name, cluster=where)
    assert rows_in(tmp_path / "here") == rows_in(tmp_path / "there")
