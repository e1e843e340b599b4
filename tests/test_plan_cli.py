"""`palpate plan` on good and on bad input: what it prints, what it writes, how it ends."""

import json
import math
from pathlib import Path

import pytest
from test_cli import run, validate

import palpate
from palpate.cli import main
from palpate.contacts import write_contacts

EXAMPLES = Path(__file__).parent.parent / "examples"
SIX = list(palpate.part_names())[:6]
TWO_PARTS = [str(EXAMPLES / "keyhole"), "--contacts", str(EXAMPLES / "keyhole-contacts.csv")]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the contacts of one of the six objects, and with two that leave many hypotheses."""
    monkeypatch.chdir(tmp_path)
    write_contacts("hand.json", palpate.standard_contacts("human-hand"))
    touches = [
        palpate.Contact(point, normal, position_error=0.5, normal_error=0.07)
        for point, normal in (((0, 0), (0, -1)), ((14, 14), (1, 0)))
    ]
    write_contacts("many.json", touches)
    return tmp_path


def test_plan_says_where_to_go_and_what_each_answer_leaves(folder, capsys):
    out = run(capsys, "plan", *SIX, "--contacts", "hand.json")
    assert "4 hypotheses" in out
    assert "sensor: position ± 0.5 mm, normal ± 4°, reliable up to 60° of incidence" in out
    assert "next path: from (" in out
    assert "Guaranteed: it separates all 4 (score 1)." in out
    rows = [line for line in out.splitlines() if " face " in line and " of " in line]
    assert len(rows) == 4 and "anything else" in out and "recognize again" in out
    assert all(row.rstrip().endswith(("human-hand", "boot")) for row in rows)


def test_plan_as_json(folder, capsys):
    document = json.loads(
        run(
            capsys, "plan", *SIX, "--contacts", "hand.json", "--planner", "ellis", "--json", "--tip-radius", 2
        )
    )
    validate(document, "plan-1")
    found = palpate.recognize(palpate.load_models(SIX), palpate.standard_contacts("human-hand"))
    sensor = palpate.Sensor(0.5, math.radians(4), math.radians(60))
    assert document["sensor"]["tip_radius"] == 2.0
    assert len(document["found"]["hypotheses"]) == len(found.hypotheses) == 4
    plain = json.loads(run(capsys, "plan", *SIX, "--contacts", "hand.json", "--json"))
    validate(plain, "plan-1")
    path = palpate.plan(found.hypotheses, sensor)
    assert plain["path"]["start"] == pytest.approx(path.start.tolist())
    assert plain["path"]["classes"] == path.classes
    assert plain["counters"] is None and plain["why"] == "perfect" and plain["planner"] == "auto"
    assert document["counters"]["paths"] == document["num_judged"]


def test_the_flags_of_the_sensor(folder, capsys):
    arguments = (
        "plan", *SIX, "--contacts", "hand.json", "--json", "--position-error", 1, "--no-normal",
        "--max-incidence-deg", 50, "--path-error", 0.25,
    )  # fmt: skip
    sensor = json.loads(run(capsys, *arguments))["sensor"]
    assert sensor["position_error"] == 1.0 and sensor["normal_error_deg"] is None
    assert sensor["max_incidence_deg"] == pytest.approx(50) and sensor["path_error"] == 0.25
    arguments = ("plan", *SIX, "--contacts", "hand.json", "--json", "--normal-error-deg", 10)
    assert json.loads(run(capsys, *arguments))["sensor"]["normal_error_deg"] == pytest.approx(10)


def test_where_and_how_to_search(folder, capsys):
    arguments = (
        "plan", *SIX, "--contacts", "hand.json", "--json", "--workspace", "-250,-200,300,250", "--directions",
        "-90,30", "--avoid-assigned", "--stop", "share=0.5", "--seed", 3, "--effort", 1000, "--time-limit",
        60, "--features", "face",
    )  # fmt: skip
    document = json.loads(run(capsys, *arguments))
    path = document["path"]
    assert path["start"][1] == pytest.approx(250) and abs(path["angle_deg"] + 90) <= 30 + 1e-9
    assert sum(len(members) == 1 for members in path["classes"]) >= 2


def test_the_tree(folder, capsys):
    arguments = ("plan", *SIX, "--contacts", "many.json", "--no-normal", "--tree", "--effort", 1000)
    out = run(capsys, *arguments)
    assert "touches: " in out and "├─ S1" in out and "unexpected: recognize again" in out
    assert "next path" not in out
    document = json.loads(run(capsys, *arguments, "--json", "--method", "ahead"))
    validate(document, "tree-1")
    assert document["method"] == "ahead" and document["unit"] == "mm"
    assert len(document["names"]) == len(document["found"]["hypotheses"])
    validate(json.loads(palpate.plan_tree(keyholes(), palpate.Sensor(0.25, None, 1.0)).to_json()), "tree-1")


def keyholes():
    evidence = palpate.read_contacts(EXAMPLES / "keyhole-contacts.csv")
    return palpate.recognize(palpate.load_models(EXAMPLES / "keyhole"), evidence.contacts).hypotheses


def test_the_keyhole(folder, capsys):
    sensor = ("--position-error", 0.25, "--normal-error-deg", 2, "--path-error", 0.02)
    out = run(capsys, "plan", *TWO_PARTS, *sensor)
    assert "Guaranteed: it separates both (score 1)." in out
    out = run(capsys, "plan", *TWO_PARTS, *sensor, "--planner", "ellis", "--stats")
    assert "Only expected to tell" in out and "hardly worth a touch" in out
    assert "--planner complete looks at all" in out and "generators: " in out and "lines judged: " in out


def test_what_is_not_guaranteed_is_marked(folder, capsys):
    # With so coarse a sensor nothing is certain, but poses that are drawn tell.
    out = run(
        capsys,
        "plan",
        *SIX,
        "--contacts",
        "hand.json",
        "--position-error",
        40,
        "--no-normal",
        "--effort",
        500,
    )
    assert "Guaranteed" in out or "Only expected to tell, nothing is certain" in out


def test_one_hypothesis_and_none(folder, capsys):
    far_apart = (((0, 0), (0, 1)), ((1, 0), (1, 0)), ((500, 0), (0, 1)))
    write_contacts(
        "none.json",
        [palpate.Contact(p, n, position_error=0.01, normal_error=0.001) for p, n in far_apart],
    )
    out = run(capsys, "plan", "boot", "--contacts", "none.json", "--plot", "no.svg", "--tree")
    assert "no part at any pose explains them" in out and "next path" not in out
    document = json.loads(run(capsys, "plan", "boot", "--contacts", "none.json", "--json"))
    validate(document, "plan-1")
    assert (document["path"], document["why"]) == (None, "unexplained")
    shallow = str(EXAMPLES / "keyhole/keyhole-shallow.json")
    out = run(capsys, "plan", shallow, *TWO_PARTS[1:])
    assert "One hypothesis is left: there is nothing to tell apart." in out
    document = json.loads(run(capsys, "plan", shallow, *TWO_PARTS[1:], "--json"))
    validate(document, "plan-1")
    assert (document["path"], document["why"]) == (None, "solved")


def test_pictures(folder, capsys):
    arguments = ("--plot", "path.svg", "--plot-tree", "tree.png", "--plot-projection", "lines.png")
    arguments += ("--plot-sheaves", "sheaves.pdf")
    out = run(capsys, "plan", *SIX, "--contacts", "hand.json", *arguments)
    for name in ("path.svg", "tree.png", "lines.png", "sheaves.pdf"):
        assert f"picture: {name}" in out and Path(name).stat().st_size > 1000
    quiet = run(capsys, "plan", *SIX, "--contacts", "hand.json", "--plot", "again.svg", "--json")
    validate(json.loads(quiet), "plan-1")
    assert Path("again.svg").read_bytes() == Path("path.svg").read_bytes()


BAD = [
    (["--planner", "best"], "'best'"),
    (["--method", "best"], "'best'"),
    (["--stop", "soon"], "'soon'"),
    (["--stop", "unique=0"], "'unique=0'"),
    (["--stop", "share=2"], "'share=2'"),
    (["--workspace", "0,0,1"], "'0,0,1'"),
    (["--workspace", "0,0,0,1"], "'0,0,0,1'"),
    (["--directions", "90"], "'90'"),
    (["--directions", "90,200"], "'90,200'"),
    (["--max-incidence-deg", "90"], "90"),
    (["--time-limit", "0"], "0"),
    (["--effort", "0"], "0"),
    (["--seed", "-1"], "-1"),
    (["--position-error", "-1"], "-1"),
    (["--plot", "path.gif"], "'.gif'"),
    (["--plot-tree", "missing/tree.svg"], "missing"),
    (["--plot-projection", "lines"], "lines"),
    (["--plot-sheaves", "sheaves.gif"], "'.gif'"),
    (["--plot-sheaves", "missing/sheaves.svg"], "missing"),
]


@pytest.mark.parametrize(("flags", "named"), BAD)
def test_bad_flags_are_one_line(folder, capsys, *, flags, named):
    status = main(["plan", *SIX, "--contacts", "hand.json", *flags])
    out, err = capsys.readouterr()
    assert (status, out) == (2, "")
    assert err.startswith("palpate: ") and err.count("\n") == 1
    assert (named in err and flags[0] in err) or flags[0].startswith("--plot")


def test_sheaves_that_cannot_be_drawn_are_one_line_after_the_answer(folder, capsys):
    # Every face that can be touched has a contact: no generator is left.
    corner = palpate.Model.segments([[[0, 10], [0, 0]], [[0, 0], [10, 0]]], name="corner")
    palpate.save_model(corner, "corner.json")
    ends = (((0, 5), (-1, 0)), ((5, 0), (0, -1)))
    write_contacts(
        "ends.json", [palpate.Contact(p, n, position_error=0.1, normal_error=0.05) for p, n in ends]
    )
    assert main(["plan", "corner.json", "--contacts", "ends.json", "--plot-sheaves", "sheaves.svg"]) == 2
    out, err = capsys.readouterr()
    assert "One hypothesis is left" in out
    assert err.startswith("palpate: ") and "every face that can be touched has a contact" in err
    assert err.count("\n") == 1 and not Path("sheaves.svg").exists()


def test_misses_alone_are_refused_as_in_recognize(folder, capsys):
    Path("misses.csv").write_text("kind,x,y,start_x,start_y,path_error\nmiss,10,0,0,0,0.1\n")
    assert main(["plan", "boot", "--contacts", "misses.csv"]) == 2
    assert "--position-error" in capsys.readouterr().err


def test_help_has_an_example(capsys):
    out = run(capsys, "plan", "--help")
    assert "Example: palpate plan" in out and "--plot-projection" in out
