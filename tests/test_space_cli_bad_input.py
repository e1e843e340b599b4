"""The command line on bad input of space: one line on standard error, and exit code 2."""

import json
from pathlib import Path

import numpy as np
import pytest
from test_space_cli import folder as folder

from palpate.cli import main

PLANE_ONLY = "is a part in space, {} works in the plane only as yet; give parts in the plane"
SIX = "--prior-pose: must be six numbers for parts in space"
WITH_PRIOR = ["recognize", "bracket.json", "--contacts", "touches.csv", "--prior-pose", "0,0,0,0,0,0"]
BAD = [
    (["tune", "l-bracket"], "l-bracket: " + PLANE_ONLY.format("tuning")),
    (["demo", "--part", "l-bracket"], "--part: l-bracket is a part in space, the demo works in the plane only as yet;"),
    (["identify", "boot", "--contacts", "touches.csv", "--pose", "0,0,0"], "contacts[0]: is of dimension 3"),
    (["recognize", "bracket.stl", "boot", "--contacts", "touches.csv"], 'models[1]: "boot" is of dimension 2'),
    (["recognize", "boot", "--contacts", "touches.csv"], "touches.csv, line 3: is of dimension 3"),
    (["recognize", "bracket.stl", "--contacts", "boot"], "boot.json: contacts[0]: is of dimension 2"),
    (["recognize", "bracket.stl", "--contacts", "flat-prior.json"], "flat-prior.json: prior: world_from_model: the plane"),
    ([*WITH_PRIOR[:-1], "1,2,3", "--prior-translation", "5"], f"{SIX} (got '1,2,3'); give it as X,Y,Z,RX,RY,RZ"),
    ([*WITH_PRIOR[:-1], "1,2,3,0,0,inf", "--prior-translation", "5"], f"{SIX} (got '1,2,3,0,0,inf'); give"),
    (WITH_PRIOR, "--prior-pose: must be given with --prior-translation; say how far x, y and z may be from it"),
    (
        ["recognize", "boot", "--contacts", "boot", "--prior-pose", "1,2,3,0,0,0", "--prior-translation", "5"],
        "--prior-pose: must be three numbers (got '1,2,3,0,0,0'); give it as X,Y,DEG",
    ),
    ([*WITH_PRIOR[:-2], "--on-table", "1,2"], "--on-table 1,2: must be given with --prior-pose; give it as X,Y,Z"),
    (
        [*WITH_PRIOR, "--prior-translation", "5", "--on-table", "1"],
        "Invalid value for '--on-table': must be a length and an angle, LENGTH,DEG (got '1')",
    ),
    (
        [*WITH_PRIOR, "--prior-translation", "5", "--on-table", "1,-2"],
        "Invalid value for '--on-table': must be zero or more, the angle at most 180 (got '1,-2')",
    ),
    (
        ["recognize", "boot", "--contacts", "boot", "--prior-pose", "1,2,3", "--prior-translation", "5", "--on-table", "1,2"],
        "--on-table 1,2: must be given with parts in space; leave it out",
    ),
    (["recognize", "boot", "--contacts", "boot", "--features", "edge"], "--features: no edges in the plane (got 'edge')"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "message"), BAD, ids=lambda value: " ".join(value) if isinstance(value, list) else ""
)
def test_bad_input_of_space_is_refused_in_one_line(folder, capsys, *, arguments, message):
    document = json.loads(Path("touches.json").read_text())
    prior = {"world_from_model": np.eye(3).tolist(), "translation": 1, "rotation_deg": 10}
    Path("flat-prior.json").write_text(json.dumps(document | {"prior": prior}))
    before = sorted(folder.iterdir())
    status = main(arguments)
    out, err = capsys.readouterr()
    assert (status, out) == (2, "")
    assert err.startswith(f"palpate: {message}"), err
    assert err.count("\n") == 1 and err.endswith("\n")
    assert sorted(folder.iterdir()) == before, "nothing is left behind"
