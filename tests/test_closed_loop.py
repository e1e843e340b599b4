"""Slices of the campaigns of the closed loop; that they would notice what must not be; `palpate tune`."""

import json
from dataclasses import replace

import numpy as np
import pytest
from test_cli import run, validate

from palpate import Contact, Sensor, identify, load_models
from palpate.cli import main
from palpate.experiments import campaign, campaign_loop, closed_loop, rivals, strangers, tune

FINE = {"position_error": 0.5, "normal_error_deg": 4.0}
COARSE = {"position_error": 4.0, "normal_error_deg": 5.0}
NOT_FOUND = {"budget", "nothing_found", "fault", "unexplained"}


@pytest.mark.parametrize(("settings", "count"), [(FINE, 54), (COARSE, 18), ({**FINE, "start": "drawn"}, 27)])
def test_no_truth_is_lost(settings, count):
    rows = [closed_loop.task(1000 + number, **settings) for number in range(count)]
    assert not [row for row in rows if row["wrong"] or row["false"] or not row["complete"]]
    assert not NOT_FOUND & {row["status"] for row in rows}
    assert {row["noise"] for row in rows} == {"uniform", "bounds"}
    assert {row["part"] for row in rows} == {model.name for model in closed_loop.library()}


@pytest.mark.parametrize("kind", ["part", "readings"])
def test_what_contradicts_every_model_is_not_explained(kind):
    rows = [strangers.task(1000 + number, kind=kind, **FINE) for number in range(18)]
    assert not any(row["false"] for row in rows)
    assert sum(row["status"] == "unexplained" for row in rows) > 6


def test_a_part_that_is_not_in_the_library_is_not_touched_for_ever():
    """The tip skids where none of five hypotheses could be touched so obliquely."""
    row = strangers.task(527, kind="part", **FINE)
    assert (row["status"], row["left"], row["touches"]) == ("unexplained", 5, 4)


def test_readings_outside_their_bounds_are_made():
    """Errors are larger than is claimed, by about the factor."""
    models = closed_loop.library()
    sensor = closed_loop.sensor_of(0.5, 4.0)
    problem = closed_loop.problem_of(3, models, models[3], sensor=sensor, factor=4.0)
    result = identify(problem.models, problem.probe, sensor, problem.workspace)
    assert all(contact.position_error == 0.5 for contact in result.contacts)
    off = [abs(problem.truth.distance(problem.world_from_truth, c.center)) for c in result.contacts]
    assert 0.5 < max(off) <= 2.0


def test_a_hypothesis_that_contradicts_a_contact_would_be_noticed():
    models = closed_loop.library()
    problem = closed_loop.problem_of(4, models, models[4], sensor=closed_loop.sensor_of(0.5, 4.0))
    result = identify(problem.models, problem.probe, problem.sensor, problem.workspace)
    assert closed_loop.contradicted(result) == {"false": 0, "undecided": 0}
    moved = [
        Contact(c.center + 10.0 * c.normal, c.normal, position_error=0.5, normal_error=c.normal_error)
        for c in result.contacts
    ]
    assert closed_loop.contradicted(replace(result, contacts=moved))["false"] == len(result.hypotheses) == 1


def test_random_lines_cross_the_workspace():
    models = closed_loop.library()
    problem = closed_loop.problem_of(0, models, models[0], sensor=closed_loop.sensor_of(0.5, 4.0))
    low, high = problem.workspace
    random = np.random.default_rng(0)
    for _ in range(100):
        start, end = rivals.by_chance(problem, [], random)
        for place in (start, end):
            assert (low - 1e-9 <= place).all() and (place <= high + 1e-9).all()
            assert np.isclose(np.abs(place), high).any()
        assert np.hypot(*(end - start)) > 0.0


def test_rivals_come_to_the_same_part():
    row = closed_loop.task(6, **FINE, start="drawn", beside=["chance", "gain"])
    assert row["first"] == 9 and row["status"] == "solved" and row["touches"] == 1
    for name in ("chance", "gain"):
        assert row[name]["status"] == "solved" and row[name]["touches"] >= row["touches"]


def test_the_campaign_writes_its_page_and_tells_a_lost_truth(tmp_path, monkeypatch, capsys):
    page = tmp_path / "page.md"
    names = ("ends", "touches", "rivals", "strangers")
    page.write_text("".join(f"<!-- made: {name} -->\n<!-- end: {name} -->\n" for name in names))
    few = [name for name in campaign_loop.PARTS if name != "rivals-coarse"]
    monkeypatch.setattr(campaign_loop, "PARTS", {name: campaign_loop.PARTS[name] for name in few})
    arguments = ["--problems", "9", "--page", str(page), "--out"]
    assert campaign_loop.main([*arguments, str(tmp_path / "good")]) == 0
    assert "| ±0.5, ±4°: all | 9 | 0 | 0 | 9 |" in page.read_text()
    again = [len(campaign.read(tmp_path / "good" / f"{name}.jsonl")[1]) for name in few]
    assert again[0] == 9 and all(again)
    written = page.read_text()
    assert campaign_loop.main([*arguments, str(tmp_path / "good"), "--as-is"]) == 0
    assert page.read_text() == written
    monkeypatch.setattr(closed_loop.Problem, "kept", lambda self, hypotheses: False)
    capsys.readouterr()
    assert campaign_loop.main([*arguments, str(tmp_path / "bad")]) == 1
    assert "fine, number 8: the truth is in no hypothesis left" in capsys.readouterr().out


def test_tune_tries_each_parameter_on_the_same_problems(capsys):
    told = run(capsys, "tune", "boot", "camera", "--problems", 2, "--json")
    document = json.loads(told)
    validate(document, "tune-1")
    tried = document["tried"]
    assert {one["stop"] for one in tried} == {"perfect", "unique:1", "unique:3", "share:0.5"}
    assert {one["blind"] for one in tried} == {None, 3, 4, 6, 8}
    assert {one["position_error"] for one in tried} == {0.125, 0.25, 0.5, 1.0}
    assert all(sum(one["status"].values()) == 2 and one["lost"] == 0 for one in tried)
    assert document["recommended"] in tried
    # More blind contacts need more moves.
    touches = [one["touches"] for one in tried if one["blind"] and one["stop"] == "perfect"]
    assert touches == sorted(touches)


def test_tune_recommends_the_cheapest_that_solves_most():
    models = load_models(["boot", "camera"])
    calls = []
    advice = tune.tune(
        models,
        Sensor(0.5, 0.07, 1.05),
        tune.Costs(speed=1e-3, per_touch=0.0),
        problems=1,
        advance=lambda: calls.append(1),
    )
    own = [one for one in advice.tried if one.setting.factor == 1.0]
    # Where moving is all that counts, it is the way.
    assert advice.best.travel <= 1.01 * min(one.travel for one in own)
    assert tune.num_loops(1) - 1 <= len(calls) == len(advice.tried) <= tune.num_loops(1)
    assert advice.widest is not None and advice.widest.setting.factor == 2.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["boot", "--problems", "0"], "--problems"),
        (["boot", "--speed", "0"], "--speed"),
        (["boot", "--touch-time", "nan"], "--touch-time"),
        (["nothing-like-it"], "nothing-like-it"),
    ],
)
def test_bad_input_is_one_line(arguments, words, capsys):
    assert main(["tune", *arguments]) == 2
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
