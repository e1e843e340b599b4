"""`palpate plan`, `identify` and `replay` on solids: words, documents, pictures, and what is refused."""

import json
from pathlib import Path

import pytest
from test_cli import run, validate

import palpate
from palpate.cli import main

SOLIDS = list(palpate.solid_part_names())
TOUCHES = """\
x,y,z,nx,ny,nz,position_error,normal_error_deg
175.4,160.2,96.4,-0.415,0.769,0.486,0.5,4
223.3,37.7,82.5,0.412,-0.761,-0.5,0.5,4
216.9,138.9,83.1,0.91,0.326,0.257,0.5,4
221.1,23.7,109.5,-0.012,-0.559,0.829,0.5,4
"""
PLAN = ["plan", *SOLIDS, "--contacts", "touches.csv"]
HEXAGON = ["identify", *SOLIDS, "--truth", "hexagon", "--seed", "3"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with four touches that two poses each of two solids explain."""
    monkeypatch.chdir(tmp_path)
    Path("touches.csv").write_text(TOUCHES)
    return tmp_path


def test_plan_says_where_to_go_in_space(folder, capsys):
    out = run(capsys, *PLAN, "--plot", "next.png", "--plot-tree", "tree.svg", "--directions", "0,0,-1,100")
    (line,) = [line for line in out.splitlines() if line.startswith("next path: from (")]
    start, direction = (line.split(after)[1].split(")")[0].split(", ") for after in ("from (", "direction ("))
    assert len(start) == len(direction) == 3 and "Guaranteed: it separates all 4 (score 1)." in out
    assert out.count("off the way back") >= 2 and "recognize again" in out
    assert Path("next.png").stat().st_size > 10_000 and "along (" in Path("tree.svg").read_text("utf-8")


def test_plan_documents_hold_a_stem(folder, capsys):
    rod = ["--stem", "0,0,1,1,50"]
    document = json.loads(run(capsys, *PLAN, *rod, "--json"))
    validate(document, "plan-1")
    assert document["sensor"]["stem"] == [[0.0, 0.0, 1.0], 1.0, 50.0]
    plain = json.loads(run(capsys, *PLAN, "--json"))
    assert "stem" not in plain["sensor"] and len(plain["path"]["direction"]) == 3
    tree = json.loads(run(capsys, *PLAN, *rod, "--tree", "--json"))
    validate(tree, "tree-1")
    assert tree["sensor"]["stem"] == document["sensor"]["stem"]
    assert "on a stem along (0, 0, 1) of radius 1 mm, 50 mm long" in run(capsys, *PLAN, *rod)


def test_identify_tells_a_run_and_replay_tells_it_again(folder, capsys):
    out = run(capsys, *HEXAGON, "--log", "run.jsonl", "--plot", "run.png")
    assert "solved: one hypothesis is left." in out and "among what is left." in out
    assert "the truth: hexagon lies at x " in out and ", z " in out
    told = [line for line in out.splitlines() if " from (" in line]
    assert all(line.split(" from (")[1].split(")")[0].count(",") == 2 for line in told)
    assert all(" along (" in line for line in told)
    again = run(capsys, "replay", "run.jsonl", "--plot", "steps")
    assert [line for line in again.splitlines() if " from (" in line] == told
    assert len(list(Path("steps").glob("step-*.svg"))) == len(told)
    for line in Path("run.jsonl").read_text("utf-8").splitlines():
        validate(json.loads(line), "run-1")


def test_identify_on_a_table_as_json(folder, capsys):
    document = json.loads(
        run(
            capsys, "identify", *SOLIDS, "--truth", "rib-plate", "--pose", "5,-10,0,0,0,30", "--json",
            "--workspace", "-200,-200,-20,200,200,200", "--directions", "0,0,-1,57",
            "--prior-pose", "0,0,0,0,0,0", "--prior-translation", "40", "--on-table", "0.5,1",
        )
    )  # fmt: skip
    validate(document, "result-1")
    assert document["status"] == "solved" and len(document["contacts"][0]["center"]) == 3
    for step in document["steps"]:
        assert step["start"][2] > step["end"][2] and step["start"][2] > -20
        assert all(point[2] > -20 for point in step["route"])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([*PLAN, "--workspace", "0,0,1,1"], "--workspace: must be X0,Y0,Z0,X1,Y1,Z1 for parts in space"),
        ([*PLAN, "--directions", "90,45"], "--directions: must be DX,DY,DZ,HALF for parts in space"),
        ([*PLAN, "--directions", "0,0,0,45"], "'--directions': must point somewhere"),
        ([*PLAN, "--plot-projection", "a.png"], "--plot-projection: draws lines of the plane only"),
        ([*PLAN, "--plot-sheaves", "a.png"], "--plot-sheaves: draws lines of the plane only"),
        ([*PLAN, "--planner", "ellis"], "planner"),
        ([*PLAN, "--stem", "0,0,0,1,50"], "'--stem': must point somewhere"),
        ([*PLAN, "--stem", "0,0,1,1"], "'--stem': must be a rod from the tip"),
        ([*PLAN, "boot"], 'models[4]: "boot" is of dimension 2'),
        ([*HEXAGON, "--pose", "1,2,3"], "--pose: must be six numbers for parts in space"),
        ([*HEXAGON, "--pose", "1,2,3,4"], "'--pose': must be a pose"),
        ([*HEXAGON[:-4], "--truth", "boot"], "--truth: boot has 2 dimensions, l-bracket has 3"),
        (["identify", "boot", "l-bracket"], "models: must be all of the plane or all of space"),
        (
            ["identify", "boot", "--directions", "0,0,-1,45"],
            "--directions: must be DEG,HALF for parts in the",
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(folder, capsys, arguments, said):
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == "" and said in err and len(err.strip().splitlines()) == 1
