"""`palpate demo`: it finds what it hid, says so, and leaves a folder that can be trusted."""

import contextlib
import io
import json
import math
import re
import xml.etree.ElementTree as Xml
from pathlib import Path

import numpy as np
import pytest
from conftest import pose
from shapely.affinity import affine_transform
from shapely.geometry import LineString, Point, Polygon
from test_cli import run, validate

import palpate
from palpate.cli import main
from palpate.cli.demo_words import Teller
from palpate.demo import SENSOR, TABLE, Demonstration, demonstrate, deviation
from palpate.experiments import closed_loop
from palpate.probe import Hit

NINE = palpate.part_names()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def lying(shown: Demonstration) -> Polygon:
    (a, b, x), (c, d, y), _ = shown.world_from_truth
    return affine_transform(Polygon([face[0] for face in shown.truth.faces]), [a, b, c, d, x, y])


@pytest.mark.parametrize("part", NINE)
def test_it_finds_what_it_hid(part):
    shown = demonstrate(part, seed=1)
    assert shown.truth.name == part and shown.truth_number is not None
    hidden = lying(shown)
    assert max(map(abs, hidden.bounds)) < TABLE / 2
    for contact in shown.result.contacts:
        assert hidden.exterior.distance(Point(contact.center)) <= SENSOR.position_error + 1e-9
    found = shown.result.hypotheses[shown.truth_number - 1]
    way, turn = deviation(found, shown.world_from_truth)
    assert way <= max(map(found.poses.excursion, found.model.vertices)) + 1e-9
    assert turn <= found.poses.rotation_bound + 1e-9


def test_every_part_is_drawn_by_some_seed():
    drawn = {NINE[int(np.random.default_rng([seed, 0]).integers(len(NINE)))] for seed in range(60)}
    assert drawn == set(NINE)
    assert demonstrate(seed=1).truth.name == NINE[int(np.random.default_rng([1, 0]).integers(len(NINE)))]


def test_the_default_run_shows_what_planning_does():
    shown = demonstrate()
    planned = [k for k, step in enumerate(shown.result.steps) if step.purpose == "path"]
    before, after = (len(shown.result.steps[k].hypotheses) for k in (planned[0] - 1, planned[-1]))
    assert before > 5 and after == 1 and shown.result.until_met
    free = LineString(
        [shown.result.steps[planned[0]].start, shown.result.steps[planned[0]].reply.contact.center]
    )
    assert free.intersection(lying(shown)).length < 1.0


def test_a_deviation_is_measured_up_to_symmetry():
    square = palpate.Model.polygon([[-1, -1], [1, -1], [1, 1], [-1, 1]], name="square")
    contacts = [
        palpate.Contact(point, normal, position_error=0.01, normal_error=0.01)
        for point, normal in [((0.0, -1.0), (0, -1)), ((1.0, 0.0), (1, 0)), ((0.0, 1.0), (0, 1))]
    ]
    (found,) = palpate.recognize([square], contacts).hypotheses
    way, turn = deviation(found, pose(math.pi / 2 + 0.1))
    assert turn == pytest.approx(0.1, abs=0.02) and way == pytest.approx(0.1 * math.sqrt(2), abs=0.04)


@pytest.mark.parametrize("number", [None, 35, *range(9)])
def test_a_promise_is_kept_and_told(number):
    """In the demonstration, and with coarse readings."""
    if number is None:
        result = demonstrate().result
    else:
        models = palpate.bundled_parts()
        sensor = palpate.Sensor(4.0, math.radians(5), math.radians(60))
        problem = closed_loop.problem_of(number, models, models[number % 9], sensor=sensor)
        result = palpate.identify(models, problem.probe, sensor, problem.workspace)
    teller = Teller()
    known = 0
    for step in result.steps:
        told = teller.tell(step)
        promised = re.search(r"no more than (\d+) are left", told.why)
        if "one answer is left" in told.why:
            assert len(step.hypotheses) == 1
        if promised:
            assert len(step.hypotheses) <= int(promised[1]) < known
        assert ("touches at" in told.met) == isinstance(step.reply, Hit)
        known = len(step.hypotheses or ())


@pytest.fixture(scope="module")
def left(tmp_path_factory):
    """What `palpate demo` said, and the folder that it left."""
    folder, said = tmp_path_factory.mktemp("demo"), io.StringIO()
    with contextlib.redirect_stdout(said):
        assert main(["demo", "--out", str(folder / "d"), "--plot", str(folder / "short.png")]) == 0
    return said.getvalue(), folder


def test_the_story(left):
    out, folder = left
    assert "9 parts are known" in out and "14 answers fit" in out and "whatever the tip meets" in out
    assert "It is the drill-left, at x " in out and "Hidden was the drill-left, at x " in out
    assert out.endswith(f"page: {folder}/d/palpate-demo.html\n")
    assert not re.search(r" $", out, flags=re.MULTILINE)
    assert max(len(line) for line in out.splitlines() if str(folder) not in line) <= 110


def test_the_folder(left):
    _, folder = left
    made = sorted(file.name for file in (folder / "d").iterdir())
    result = palpate.replay(folder / "d/run.jsonl")
    steps = [f"step-{number:03}.svg" for number in range(1, len(result.steps) + 1)]
    assert made == ["palpate-demo.html", "run.jsonl", "run.svg", *steps]
    assert result.status == "solved" and result.until_met
    assert (folder / "short.png").read_bytes().startswith(b"\x89PNG")


def test_the_page_is_whole(left):
    _, folder = left
    page = Xml.parse(folder / "d/palpate-demo.html").getroot()
    pictures = [one.get("src") for one in page.iter("{http://www.w3.org/1999/xhtml}img")]
    num_steps = len(list((folder / "d").glob("step-*.svg")))
    assert len(pictures) == num_steps + 3 and all(one.startswith("data:") for one in pictures)
    shown = "".join(page.itertext())
    for words in ("Found by touch: drill-left", "hidden truth", "palpate replay run.jsonl"):
        assert words in shown
    assert (folder / "d/run.jsonl").read_text() in shown


def test_an_earlier_demonstration_is_replaced_and_nothing_else(left, folder, capsys):
    Path("palpate-demo").mkdir()
    for name in ("step-099.svg", "mine.svg"):
        Path("palpate-demo", name).write_text("x")
    run(capsys, "demo", "--out", "palpate-demo")
    made = {file.name: file.read_bytes() for file in Path("palpate-demo").iterdir()}
    assert made.pop("mine.svg") == b"x"
    assert made == {file.name: file.read_bytes() for file in (left[1] / "d").iterdir()}


def test_as_json(folder, capsys):
    document = json.loads(run(capsys, "demo", "--json", "--seed", "1", "--part", "boot"))
    validate(document, "demo-2")
    assert document["truth"]["model"] == "boot" and document["truth_found"] and document["seed"] == 1
    assert Path(document["page"]).is_file() and Path(document["log"]).is_file()


def test_a_part_that_is_not_found_is_a_fault(folder, capsys, monkeypatch):
    monkeypatch.setattr(Demonstration, "truth_number", None)
    assert main(["demo"]) == 1
    out, err = capsys.readouterr()
    assert "this is a fault, please report it" in " ".join(out.split()) and err == ""


def test_bad_choices_leave_the_folder_alone(folder, capsys):
    Path("palpate-demo").mkdir()
    Path("palpate-demo/run.jsonl").write_text("kept")
    assert main(["demo", "--part", "teapot"]) == 2
    assert Path("palpate-demo/run.jsonl").read_text() == "kept"


@pytest.mark.parametrize("extra", [(), ("--json",)])
def test_a_picture_that_fails_leaves_the_answer(folder, capsys, *, monkeypatch, extra):
    def fail(figure, path):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("palpate.plots.save_figure", fail)
    status = main(["demo", *extra])
    out, err = capsys.readouterr()
    assert (status, err) == (2, "palpate: palpate-demo/step-001.svg: No space left on device\n")
    assert json.loads(out) if extra else len(out.splitlines()) > 5
