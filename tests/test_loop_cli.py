"""`palpate identify` and `palpate replay`: what they print, what they write, how they end."""

import json
import signal
import subprocess
import time
from pathlib import Path

import pytest
from test_cli import PALPATE, run, validate

import palpate
from palpate.cli import main

NINE = list(palpate.part_names())
AREA = ("--workspace", "-300,-300,300,300")
BOOT = (*NINE, "--truth", "boot", "--pose", "10,20,30", "--seed", 3)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def same(one, other):
    """But for times."""
    return {**one, "seconds": None} == {**other, "seconds": None}


def test_contacts_of_a_file_come_before_all_scans(folder, capsys):
    drawn = json.loads(run(capsys, "identify", *BOOT, "--json", "--drawn", 2, "--log", "run.jsonl"))
    validate(drawn, "result-1")
    assert drawn["status"] == "solved" and drawn["found"]["hypotheses"][0]["model"] == "boot"
    assert len(drawn["contacts"]) - 2 == sum(step["reply"] == "hit" for step in drawn["steps"])
    assert not any(step["purpose"] == "scan" for step in drawn["steps"])
    contacts = [
        {
            "center": contact["center"],
            "normal": contact["normal"],
            "approach": contact["approach"],
        }
        for contact in drawn["contacts"][:2]
    ]
    file = {"schema": "palpate-contacts", "version": 1, "unit": "mm", "contacts": contacts}
    Path("first.json").write_text(json.dumps(file))
    given = json.loads(run(capsys, "identify", *BOOT, "--json", "--contacts", "first.json"))
    assert given["contacts"] == drawn["contacts"] and given["steps"] == drawn["steps"]
    assert main(["identify", *map(str, BOOT), "--contacts", "first.json", "--drawn", "2"]) == 2
    assert "choose one" in capsys.readouterr().err


def test_another_truth_is_not_resumed(folder, capsys):
    run(capsys, "identify", *BOOT, *AREA, "--log", "run.jsonl")
    lines = Path("run.jsonl").read_bytes().splitlines(keepends=True)
    Path("run.jsonl").write_bytes(b"".join(lines[:4]))
    for flags in (["--truth", "camera"], ["--pose", "11,20,30"], ["--noise", "bounds"]):
        arguments = ["identify", *map(str, BOOT), *flags, *AREA]
        assert main([*arguments, "--log", "run.jsonl", "--resume"]) == 2
        assert "simulation: is not that of the log" in capsys.readouterr().err


def test_the_story(folder, capsys):
    out = run(capsys, "identify", *BOOT, "--probe", "sim", "--plot", "run.svg")
    lines = out.splitlines()
    assert lines[0].startswith("sensor: position ± 0.5 mm, normal ± 4°")
    assert lines[1].startswith("  1 scan from (") and "touched at (" in lines[1] and "normal" in lines[1]
    assert "hypotheses left" in out and "path from (" in out and "1 hypothesis left" in out
    assert "solved: one hypothesis is left." in out
    assert "boot lies at x 10, y 20, turned by 30°: among what is left." in out
    assert "picture: run.svg" in out and Path("run.svg").stat().st_size > 1000


def test_json_and_replay(folder, capsys):
    document = json.loads(run(capsys, "identify", *BOOT, "--json", "--log", "run.jsonl"))
    validate(document, "result-1")
    assert document["status"] == "solved" and document["found"]["hypotheses"][0]["model"] == "boot"
    assert document["touches"] == len(document["steps"])
    for line in Path("run.jsonl").read_text().splitlines():
        validate(json.loads(line), "run-1")
    planned = [step["path"] for step in document["steps"] if step["path"] is not None]
    assert planned and all(sum(map(len, path["classes"])) > 1 for path in planned)
    assert [step["purpose"] for step in document["steps"]].count("path") == len(planned)
    taken = document["seconds"]
    assert taken["recognition"] > 0.0 and taken["planning"] > 0.0
    assert same(json.loads(run(capsys, "replay", "run.jsonl", "--json")), document)
    resumed = run(capsys, "identify", *BOOT, "--json", "--log", "run.jsonl", "--resume")
    assert same(json.loads(resumed), document)
    told = run(capsys, "replay", "run.jsonl", "--plot", "pictures")
    assert "solved: one hypothesis is left." in told and "pictures: pictures" in told
    names = sorted(path.name for path in Path("pictures").iterdir())
    assert names == ["run.svg", *(f"step-{k + 1:03}.svg" for k in range(document["touches"]))]


def test_a_log_without_an_end(folder, capsys):
    run(capsys, "identify", *BOOT, "--log", "run.jsonl")
    text = Path("run.jsonl").read_text()
    Path("run.jsonl").write_text(text[: len(text) // 2])
    document = json.loads(run(capsys, "replay", "run.jsonl", "--json"))
    validate(document, "result-1")
    assert document["status"] == "interrupted"
    run(capsys, "identify", *BOOT, "--log", "run.jsonl", "--resume")
    assert Path("run.jsonl").read_text() == text


def test_flags_of_the_loop(folder, capsys):
    arguments = (
        "identify", *BOOT, "--json", "--position-error", 0.2, "--normal-error-deg", 2,
        "--max-incidence-deg", 50,
        "--tip-radius", 1, "--path-error", 0.1, "--noise", "bounds", "--overtravel", 0.05, "--workspace",
        "-300,-250,300,350", "--blind", 3, "--until", "5,2", "--max-touches", 60, "--planner", "complete",
        "--stop", "share=0.5", "--effort", 20000, "--features", "face,vertex", "--max-hypotheses", 500,
        "--prior-pose", "0,0,0", "--prior-translation", 100, "--log", "run.jsonl",
    )  # fmt: skip
    document = json.loads(run(capsys, *arguments))
    validate(document, "result-1")
    assert document["status"] == "solved" and document["until_met"]
    start = json.loads(Path("run.jsonl").read_text().splitlines()[0])
    assert start["sensor"]["tip_radius"] == 1.0 and start["workspace"] == [[-300.0, -250.0], [300.0, 350.0]]
    assert start["settings"]["planner"] == "complete" and start["settings"]["blind"] == 3
    assert start["settings"]["stop"] == ["share", 0.5] and start["prior"]["translation"] == 100
    bare = json.loads(
        run(capsys, "identify", "boot", "--json", "--no-normal", "--pose", "random", "--max-touches", 4)
    )
    assert all(contact["normal"] is None for contact in bare["contacts"])


def test_a_killed_run_is_resumed(folder, capsys):
    arguments = ["identify", *map(str, BOOT), "--until", "1,0.5", "--log", "run.jsonl", "--json"]
    process = subprocess.Popen([*PALPATE, *arguments], stdout=subprocess.DEVNULL)
    log = Path("run.jsonl")
    deadline = time.monotonic() + 60
    while (not log.exists() or log.read_bytes().count(b"\n") < 6) and time.monotonic() < deadline:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    before = log.read_bytes()
    assert b'"event":"end"' not in before
    resumed = json.loads(run(capsys, *arguments, "--resume"))
    assert log.read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    arguments[arguments.index("run.jsonl")] = "whole.jsonl"
    assert same(json.loads(run(capsys, *arguments)), resumed)
    assert Path("whole.jsonl").read_bytes() == log.read_bytes()


BAD = [
    (["--probe", "cmm"], "'cmm'"),
    (["--truth", "nothing"], "nothing"),
    (["--pose", "1,2"], "'1,2'"),
    (["--workspace", "0,0,0,1"], "'0,0,0,1'"),
    (["--workspace", "0,0,10,10"], "--workspace"),
    (["--noise", "loud"], "'loud'"),
    (["--overtravel", "2"], "overtravel"),
    (["--until", "1"], "'1'"),
    (["--until", "0,1"], "'0,1'"),
    (["--blind", "0"], "0"),
    (["--max-touches", "0"], "0"),
    (["--resume"], "--log"),
    (["--log", "missing/run.jsonl"], "missing"),
    (["--plot", "run.gif"], "'.gif'"),
    (["--plot", "missing/pictures"], "missing"),
    (["--position-error", "-1"], "-1"),
]


@pytest.mark.parametrize(("flags", "named"), BAD)
def test_bad_flags_are_one_line(folder, capsys, *, flags, named):
    status = main(["identify", "boot", "--json", *flags])
    out, err = capsys.readouterr()
    assert (status, out) == (2, "")
    assert err.startswith("palpate: ") and err.count("\n") == 1 and named in err


def test_bad_logs_are_one_line(folder, capsys):
    Path("other.jsonl").write_text("nonsense\n")
    Path("empty.jsonl").write_text("")
    for name, named in (("other.jsonl", "line 1"), ("empty.jsonl", "empty"), ("missing.jsonl", "no file")):
        assert main(["replay", name]) == 2
        err = capsys.readouterr().err
        assert err.count("\n") == 1 and named in err
    assert main(["identify", "boot", "--log", "other.jsonl"]) == 2
    assert "is there already" in capsys.readouterr().err


def test_help_has_an_example(capsys):
    assert "Example: palpate identify" in run(capsys, "identify", "--help")
    assert "Example: palpate replay" in run(capsys, "replay", "--help")
