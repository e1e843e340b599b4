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
    "reverse.csv": "kind,x,y,nx,ny,approach_x,approach_y,start_x,start_y,position_error,normal_error_deg\n"
    "miss,0,50,,,,,9,50,1,\ncontact,5,0,0,1,0,1,,,1,4\n",
    "space.csv": "x,y,z,position_error\n0,0,0,0.5\n",
    "empty.csv": "",
    "header.csv": "x,y,position_error\n",
    "broken.json": '{"schema": ',
    "other.json": '{"schema": "palpate-model", "version": 1}',
    "touches.txt": "x,y\n0,0\n",
    "part.iges": "",
}


def no_length(flag):
    return f"Invalid value for '--{flag}': must be a length, zero or more, in the models' unit"


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
    (
        [*RECOGNIZE, "--max-hypotheses", "0"],
        "Invalid value for '--max-hypotheses': must be a whole number from 1 to 1000000000 (got 0)",
    ),
    (
        [*RECOGNIZE, "--list-interpretations", "-1"],
        "Invalid value for '--list-interpretations': must be a whole number from 0 to 1000000 (got -1)",
    ),
    (
        [*RECOGNIZE, "--list-interpretations", "9" * 20],
        "Invalid value for '--list-interpretations': must be a whole number from 0 to 1000000 (got 99999",
    ),
    (
        [*RECOGNIZE, "--features", "faces"],
        "Invalid value for '--features': must be some of face,edge,vertex (got 'faces')",
    ),
    (
        [*RECOGNIZE, "--features", ""],
        "Invalid value for '--features': must be some of face,edge,vertex (got '')",
    ),
    ([*RECOGNIZE, "--unit", "furlong"], "--unit: unknown unit 'furlong'; give one of um, mm"),
    ([*RECOGNIZE, "--prior-translation", "5"], "--prior-translation 5: must be given with --prior-pose; "),
    ([*RECOGNIZE, "--prior-rotation-deg", "5"], "--prior-rotation-deg 5: must be given with --prior-pose; "),
    ([*RECOGNIZE, "--prior-pose", "0,0,0"], "--prior-pose: must be given with --prior-translation; "),
    (
        [*RECOGNIZE, "--prior-pose", "0,0", "--prior-translation", "5"],
        "--prior-pose: must be three numbers (got '0,0')",
    ),
    (
        [*RECOGNIZE, "--prior-pose", "0,0,nan", "--prior-translation", "5"],
        "--prior-pose: must be three numbers",
    ),
    (
        [*RECOGNIZE, "--prior-pose", "0,0,0", "--prior-translation", "-5"],
        f"{no_length('prior-translation')} (got -5)",
    ),
    (
        [*RECOGNIZE, "--prior-pose", "0,0,0", "--prior-translation", "5", "--prior-rotation-deg", "400"],
        "Invalid value for '--prior-rotation-deg': must be an angle in degrees, from 0 to 180 (got 400)",
    ),
    (
        [*RECOGNIZE, "--plot", "found.gif"],
        "found.gif: pictures can't be saved as '.gif'; name it .svg, .png, .pdf",
    ),
    (
        [*RECOGNIZE, "--plot", "nowhere/found.svg"],
        "nowhere/found.svg: there is no folder nowhere; make it first",
    ),
    ([*RECOGNIZE, "--plot-range", "1"], "--plot-range 1: must be given with --plot; name the file"),
    (
        [*RECOGNIZE, "--plot", "found.svg", "--plot-range", "3", "--max-hypotheses", "2"],
        "--plot-range 3: no more than --max-hypotheses 2 are returned; raise it",
    ),
    ([*RECOGNIZE, "--effort", "0"], "Invalid value for '--effort': must be a whole number from 1 to "),
    (["recognize", "pear", "--contacts", "good.csv"], "pear: no such file or folder"),
    (["recognize", "part.iges", "--contacts", "good.csv"], "part.iges: unknown suffix '.iges'"),
    (["recognize", "crossed.json", "--contacts", "good.csv"], "crossed.json: "),
    (["recognize", "other.json", "--contacts", "good.csv"], "other.json: name: "),
    (["recognize", "square.json", "--contacts", "none.csv"], "none.csv: no such file; give a .csv"),
    (["recognize", "square.json", "--contacts", "."], ".: is a folder"),
    (["recognize", "square.json", "--contacts", "touches.txt"], "touches.txt: suffix '.txt' is not known"),
    (["recognize", "square.json", "--contacts", "empty.csv"], "empty.csv: no header in it"),
    (["recognize", "square.json", "--contacts", "header.csv"], "header.csv: no contact and no miss in it"),
    (["recognize", "square.json", "--contacts", "bare.csv"], "bare.csv, line 2, position_error: absent"),
    (
        ["recognize", "square.json", "--contacts", "bare.csv", "--position-error", "-1"],
        f"{no_length('position-error')} (got -1)",
    ),
    (
        ["recognize", "square.json", "--contacts", "bare.csv", "--position-error", "nan"],
        f"{no_length('position-error')} (got nan)",
    ),
    (
        ["recognize", "square.json", "--contacts", "bare.csv", "--position-error", "1", "--tip-radius", "-1"],
        f"{no_length('tip-radius')} (got -1)",
    ),
    (
        ["recognize", "square.json", "--contacts", "no-bound.csv"],
        "no-bound.csv, line 2, normal_error_deg: absent",
    ),
    (
        ["recognize", "square.json", "--contacts", "no-bound.csv", "--normal-error-deg", "95"],
        "Invalid value for '--normal-error-deg': must be an angle in degrees, from 0 to 90 (got 95)",
    ),
    (
        ["recognize", "square.json", "--contacts", "letters.csv"],
        "letters.csv, line 2, column y: 'left' is not a finite number",
    ),
    (["recognize", "square.json", "--contacts", "zero-normal.csv"], "zero-normal.csv, line 2: normal: "),
    (
        ["recognize", "square.json", "--contacts", "space.csv"],
        "space.csv, line 2: is of dimension 3, the first of the models of dimension 2 (got Contact(",
    ),
    (["recognize", "square.json", "--contacts", "broken.json"], "broken.json, line 1: not JSON"),
    (["recognize", "square.json", "--contacts", "other.json"], "other.json: schema: 'palpate-model' is not"),
    (
        ["recognize", "square.json", "--contacts", "reverse.csv"],
        "reverse.csv, line 3: the normal points along the approach",
    ),
    (["models"], "Missing argument 'MODEL'"),
    (["models", "pear"], "pear: no such file or folder"),
    (["models", "crossed.json", "--json"], "crossed.json: "),
    (["models", "boot", "--plot", "boot"], "boot: pictures can't be saved as ''"),
    (["demo", "--part", "teapot"], "--part: no such bundled part (got 'teapot')"),
    (["demo", "--seed", "x"], "Invalid value for '--seed': must be a whole number (got 'x')"),
    (
        ["demo", "--seed", "-1"],
        "Invalid value for '--seed': must be a whole number, 0 or more (got -1)",
    ),
    (["demo", "--plot", "demo.txt"], "demo.txt: pictures can't be saved as '.txt'"),
    (["demo", "--out", "square.json"], "--out: 'square.json' is no folder"),
    (["demo", "--out", "nowhere/demo"], "--out: there is no folder 'nowhere'"),
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


def test_a_hypothesis_that_is_not_there_is_not_drawn_but_the_answer_is_given(folder, capsys):
    assert main([*RECOGNIZE, "--plot", "found.svg", "--plot-range", "99"]) == 2
    out, err = capsys.readouterr()
    assert out.startswith("2 contacts, 1 model: it is square; ")
    assert err == "palpate: --plot-range 99: no such hypothesis; give a number from 1 to 1\n"
    assert not Path("found.svg").exists()


@pytest.mark.parametrize(
    ("closed", "arguments", "err"),
    [
        (
            ">&-",
            ["models", "square.json"],
            "palpate: standard output is closed; leave it open, or send it to a file\n",
        ),
        ("2>&-", ["models", "pear"], ""),
        (">&- 2>&-", ["models", "square.json"], ""),
        (">/dev/full", ["models", "square.json"], "palpate: No space left on device\n"),
        (">/dev/full", ["models", "square.json", "--json"], "palpate: No space left on device\n"),
    ],
)
def test_nowhere_to_write_is_no_fault_of_ours(folder, closed, *, arguments, err):
    command = " ".join([sys.executable, "-m", "palpate.cli", *arguments, closed])
    shown = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert (shown.returncode, shown.stdout, shown.stderr) == (2, "", err)
