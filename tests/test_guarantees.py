"""What the recognizer promises, on random problems: nothing true is lost, nothing false is kept."""

import json
import subprocess
import sys
import time

import pytest

from palpate.experiments import campaign_plane, no_normals

CAMPAIGN = [sys.executable, "-m", "palpate.experiments.campaign_plane"]


def campaign(out, *, problems, cluster=None, seed=0):
    """Arguments of a campaign."""
    where = [] if cluster is None else ["--cluster", cluster]
    return ["--problems", str(problems), "--seed", str(seed), "--out", str(out), *where]


def test_a_slice_of_the_campaign(tmp_path):
    """1,500 of the 100,000 problems of `make campaign-plane`."""
    done = subprocess.run(
        [*CAMPAIGN, *campaign(tmp_path / "out", problems=1500, cluster="local:2")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    total = summary["total"]
    assert total["problems"] == 1500
    assert summary["seeds_with_faults"] == [], done.stdout + done.stderr
    assert total.get("incomplete", 0) == 0
    assert all(counts["problems"] > 20 for counts in summary["families"].values())
    assert summary["total"]["neighbours"] > 500


def test_a_campaign_that_was_killed_goes_on_where_it_was(tmp_path):
    """Killed without warning and started again: the same summary, and nothing is checked twice."""
    problems = 6 * campaign_plane.CHUNK
    command = [*CAMPAIGN, *campaign(tmp_path / "killed", problems=problems, cluster="local:2")]
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rows = tmp_path / "killed" / "rows.jsonl"
    try:
        while not (rows.exists() and rows.read_text().count("\n") >= 2):
            assert started.poll() is None
            time.sleep(0.02)
    finally:
        started.kill()
        started.wait()
    before = rows.read_text()
    # As if the last line had been cut short.
    rows.write_text(before + '{"number":3,"fam')
    campaign_plane.main(campaign(tmp_path / "killed", problems=problems))
    assert rows.read_text().startswith(before)
    campaign_plane.main(campaign(tmp_path / "whole", problems=problems))
    assert (tmp_path / "killed" / "summary.json").read_bytes() == (
        tmp_path / "whole" / "summary.json"
    ).read_bytes()


def test_a_campaign_does_not_mix_with_another(tmp_path, capsys):
    campaign_plane.main(campaign(tmp_path, problems=3))
    with pytest.raises(SystemExit) as stopped:
        campaign_plane.main(campaign(tmp_path, problems=4))
    assert stopped.value.code == 2
    assert "holds other rows" in capsys.readouterr().err


def test_a_fault_is_told_and_fails(tmp_path, monkeypatch, capsys):
    """The campaign would notice: a recognizer that loses every other hypothesis."""
    honest = campaign_plane.check.__globals__["_look_at"]

    def forgetful(problem, found, evidence):
        answer = honest(problem, found, evidence)
        answer.true.clear()
        return answer

    monkeypatch.setitem(campaign_plane.check.__globals__, "_look_at", forgetful)
    assert campaign_plane.main(campaign(tmp_path, problems=5)) == 1
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["total"]["poses_lost"] == 5
    assert {fault["seed"] for fault in summary["seeds_with_faults"]} == set(range(5))
    assert campaign_plane.main(["--replay", "3"]) == 1
    assert "true pose outside" in capsys.readouterr().out


def test_contacts_without_normals_lose_no_truth(tmp_path):
    """One problem for each object and row of the table that `make table-no-normals` writes."""
    page = tmp_path / "tables" / "no-normals.md"
    assert no_normals.main(["--trials", "1", "--out", str(tmp_path / "out"), "--table", str(page)]) == 0
    document = json.loads(page.with_suffix(".json").read_text())
    assert len(document["rows"]) == len(no_normals.SETTINGS) == 24
    assert all(row["problems"] == 6 and row["truth_lost"] == 0 for row in document["rows"])
    assert all(row["incomplete_share"] == 0.0 for row in document["rows"] if row["prior"])
    assert page.read_text().count("\n| ") == 2 + 24
