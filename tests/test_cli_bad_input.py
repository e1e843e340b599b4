"""The command line on bad input: one line on standard error that says what is wrong, and exit code 2."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from palpate.cli import main

FILES = {
    "square.json": json.dumps(
        {
            "schema": "palpate-model",
            "version": 1,
            "name": "square",
            "unit": "mm",
            "outer": [[0, 0], [9, 0], [9, 9], [0, 9]],
        }
    ),
    "crossed.json": json.dumps(
        {
            "schema": "palpate-model",
            "version": 1,
            "name": "crossed",
            "unit": "mm",
            "outer": [[0, 0], [9, 9], [9, 0], [0, 8]],
        }
    ),
    "good.csv": "x,y,nx,ny,position_error,normal_error_deg\n0,0,0,1,0.5,4\n5,0,0,1,0.5,4\n",
    "bare.csv": "x,y\n0,0\n",
    "no-bound.csv": "x,y,nx,ny,position_error\n0,0,0,1,0.5\n",
    "letters.csv": "x,y,position_error\n0,left,0.5\n",
    "zero-normal.csv": "x,y,nx,ny,position_error,normal_error_deg\n0,0,0,0,0.5,4\n",
    "space.csv": "x,y,z,position_error\n0,0,0,0.5\n",
    "empty.csv": "",
    "header.csv": "x,y,position_error\n",
    "broken.json": '{"schema": ',
    "other.json": '{"schema": "palpate-model", "version": 1}',
    "touches.txt": "x,y\n0,0\n",
    "part.step": "",
}

RECOGNIZE = ["recognize", "square.json", "--contacts", "good.csv"]

CASES = [
    (["recognise"], "No such command 'recognise'"),
    (["--verbose"], "No such option: --verbose"),
    (["recognize"], "Missing argument 'MODEL'"),
    (["recognize", "square.json"], "Missing option '--contacts'"),
    ([*RECOGNIZE, "--position-err", "1"], "No such option: --position-err"),
    (
        [*RECOGNIZE, "--position-error", "small"],
        "Invalid value for '--position-error': must be a number (got 'small')",
    ),
    (
        [*RECOGNIZE, "--max-hypotheses", "many"],
        "Invalid value for '--max-hypotheses': must be a whole number (got 'many')",
    ),
    ([*RECOGNIZE, "--max-hypotheses", "0"], "max_hypotheses: "),
    ([*RECOGNIZE, "--list-interpretations", "-1"], "--list-interpretations: must be zero or more (got -1)"),
    ([*RECOGNIZE, "--features", "faces"], "features: "),
    ([*RECOGNIZE, "--features", ""], "features: "),
    ([*RECOGNIZE, "--unit", "furlong"], "unit: unknown unit 'furlong'; give one of um, mm"),
    ([*RECOGNIZE, "--prior-translation", "5"], "--prior-translation: there is no --prior-pose (got 5.0)"),
    ([*RECOGNIZE, "--prior-rotation-deg", "5"], "--prior-rotation-deg: there is no --prior-pose (got 5.0)"),
    ([*RECOGNIZE, "--prior-pose", "0,0,0"], "--prior-translation: must be given with --prior-pose"),
    (
        [*RECOGNIZE, "--prior-pose", "0,0", "--prior-translation", "5"],
        "--prior-pose: must be three numbers (got '0,0')",
    ),
    (
        [*RECOGNIZE, "--prior-pose", "0,0,nan", "--prior-translation", "5"],
        "--prior-pose: must be three numbers",
    ),
    ([*RECOGNIZE, "--prior-pose", "0,0,0", "--prior-translation", "-5"], "translation: "),
    (
        [*RECOGNIZE, "--prior-pose", "0,0,0", "--prior-translation", "5", "--prior-rotation-deg", "200"],
        "rotation: ",
    ),
    (
        [*RECOGNIZE, "--plot", "found.gif"],
        "found.gif: pictures can't be saved as '.gif'; name it .svg, .png, .pdf",
    ),
    (
        [*RECOGNIZE, "--plot", "nowhere/found.svg"],
        "nowhere/found.svg: there is no folder nowhere; make it first",
    ),
    ([*RECOGNIZE, "--plot-range", "1"], "--plot-range: there is no --plot"),
    ([*RECOGNIZE, "--plot", "found.svg", "--plot-range", "99"], "--plot-range: no such hypothesis (got 99)"),
    (["recognize", "pear", "--contacts", "good.csv"], "pear: no such file or folder"),
    (["recognize", "part.step", "--contacts", "good.csv"], "part.step: unknown suffix '.step'"),
    (["recognize", "crossed.json", "--contacts", "good.csv"], "crossed.json: "),
    (["recognize", "other.json", "--contacts", "good.csv"], "other.json: name: None is not text"),
    (["recognize", "square.json", "--contacts", "none.csv"], "none.csv: No such file or directory"),
    (["recognize", "square.json", "--contacts", "."], ".: is a folder"),
    (["recognize", "square.json", "--contacts", "touches.txt"], "touches.txt: suffix '.txt' is not known"),
    (["recognize", "square.json", "--contacts", "empty.csv"], "empty.csv: no header in it"),
    (["recognize", "square.json", "--contacts", "header.csv"], "header.csv: no contact and no miss in it"),
    (["recognize", "square.json", "--contacts", "bare.csv"], "bare.csv, line 2, position_error: absent"),
    (
        ["recognize", "square.json", "--contacts", "bare.csv", "--position-error", "-1"],
        "bare.csv, line 2: position_error: ",
    ),
    (
        ["recognize", "square.json", "--contacts", "bare.csv", "--position-error", "nan"],
        "bare.csv, line 2: position_error: ",
    ),
    (
        ["recognize", "square.json", "--contacts", "bare.csv", "--position-error", "1", "--tip-radius", "-1"],
        "bare.csv, line 2: tip_radius: ",
    ),
    (
        ["recognize", "square.json", "--contacts", "no-bound.csv"],
        "no-bound.csv, line 2, normal_error_deg: absent",
    ),
    (
        ["recognize", "square.json", "--contacts", "no-bound.csv", "--normal-error-deg", "95"],
        "no-bound.csv, line 2: normal_error: ",
    ),
    (
        ["recognize", "square.json", "--contacts", "letters.csv"],
        "letters.csv, line 2, column y: 'left' is not a finite number",
    ),
    (["recognize", "square.json", "--contacts", "zero-normal.csv"], "zero-normal.csv, line 2: normal: "),
    (
        ["recognize", "square.json", "--contacts", "space.csv"],
        "space.csv, line 1, column z: contacts in space",
    ),
    (["recognize", "square.json", "--contacts", "broken.json"], "broken.json, line 1: not JSON"),
    (["recognize", "square.json", "--contacts", "other.json"], "other.json: schema: 'palpate-model' is not"),
    (["models"], "Missing argument 'MODEL'"),
    (["models", "pear"], "pear: no such file or folder"),
    (["models", "crossed.json", "--json"], "crossed.json: "),
    (["models", "boot", "--plot", "boot"], "boot: pictures can't be saved as ''"),
    (["demo", "--part", "teapot"], "part: no such bundled part (got 'teapot')"),
    (["demo", "--seed", "x"], "Invalid value for '--seed': must be a whole number (got 'x')"),
    (["demo", "--seed", "-1"], "seed: "),
    (["demo", "--out", "demo.txt"], "demo.txt: pictures can't be saved as '.txt'"),
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        Path(name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "message"), CASES, ids=lambda value: " ".join(value) if isinstance(value, list) else ""
)
def test_bad_input_is_refused_in_one_line(folder, capsys, *, arguments, message):
    before = sorted(folder.iterdir())
    status = main(arguments)
    out, err = capsys.readouterr()
    assert (status, out) == (2, "")
    assert err.startswith(f"palpate: {message}")
    assert err.endswith("\n")
    assert err.count("\n") == 1
    assert sorted(folder.iterdir()) == before, "nothing is left behind"


@pytest.mark.parametrize(
    "arguments", [["recognize"], ["models", "pear"], [*RECOGNIZE[:2], "--contacts", "letters.csv"]]
)
def test_the_process_says_no_more_than_that(folder, arguments):
    shown = subprocess.run(
        [sys.executable, "-m", "palpate.cli", *arguments], capture_output=True, text=True, check=False
    )
    assert (shown.returncode, shown.stdout) == (2, "")
    assert shown.stderr.startswith("palpate: ")
    assert shown.stderr.count("\n") == 1


def test_a_file_that_can_t_be_read(folder, capsys):
    Path("locked").mkdir()
    Path("locked.csv").symlink_to("locked.csv")  # a loop: unreadable for everyone, an administrator included
    assert main(["recognize", "square.json", "--contacts", "locked.csv"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
