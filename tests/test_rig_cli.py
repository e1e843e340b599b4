"""`palpate identify --probe rig` at the command line."""

import json

import pytest
from test_cli import run, validate

from palpate.cli import main

RUN = ("identify", "drill-left", "drill-right", "--probe", "rig", "--seed", 3)


def test_a_part_is_identified_through_the_rig(tmp_path, capsys):
    record, film = tmp_path / "run.svg", tmp_path / "run.html"
    made = json.loads(run(capsys, *RUN, "--json", "--record", record, "--film", film))
    validate(made, "result-1")
    assert made["status"] == "solved"
    assert "<svg" in record.read_text("utf-8") and "<script" in film.read_text("utf-8")
    again = json.loads(run(capsys, *RUN, "--json"))
    assert again["found"]["hypotheses"] == made["found"]["hypotheses"]


def test_the_story_says_how_it_ended(capsys):
    told = run(capsys, *RUN, "--guard-speed", 10, "--without", "drift,creep")
    assert "solved" in told and "simulated" in told


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (("--probe", "rig", "--noise", "none"), "--noise none: is of --probe sim"),
        (("--probe", "rig", "--position-error", "0.01"), "position_error must hold"),
        (("--probe", "rig", "--without", "rust"), "must be some of drift,creep,noise"),
        (("--probe", "rig", "--press-force", "30"), "must stay below what the beam bears"),
        (("--probe", "rig", "--film", "run.txt"), "must end in .html"),
        (("--probe", "sim", "--guard-speed", "5"), "--guard-speed 5.0: is of the rig"),
        (
            (
                "--probe",
                "arm",
            ),
            "must be sim or rig",
        ),
    ],
)
def test_bad_flags_are_one_line(flags, said, capsys):
    assert main(["identify", "drill-left", *flags]) == 2
    out, err = capsys.readouterr()
    assert not out and said in " ".join(err.split()) and "Traceback" not in err
