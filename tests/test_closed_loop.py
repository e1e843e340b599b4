"""Slices of the campaigns of the closed loop; that they would notice what must not be; `palpate tune`."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import pose
from test_cli import run, validate

import palpate
from palpate import Contact, Sensor, identify, load_models
from palpate.cli import main
from palpate.experiments import blind, campaign, campaign_loop, closed_loop, rivals, strangers, tune
from palpate.usual import usual_sensor

FINE = {"position_error": 0.5, "normal_error_deg": 4.0}
COARSE = {"position_error": 4.0, "normal_error_deg": 5.0}
MODELS = palpate.bundled_parts()
SENSOR = usual_sensor()
MIXED = {**FINE, "mixed": True}
NOT_FOUND = {"budget", "nothing_found", "fault", "unexplained"}


@pytest.mark.parametrize(
    ("settings", "count"), [(FINE, 54), (COARSE, 18), ({**FINE, "start": "drawn"}, 27), (MIXED, 36)]
)
def test_no_truth_is_lost(settings, count):
    rows = [closed_loop.task(1000 + number, **settings) for number in range(count)]
    assert not [row for row in rows if row["lost"] or row["contradicted"] or not row["complete"]]
    assert not NOT_FOUND & {row["status"] for row in rows}
    assert {row["noise"] for row in rows} == {"uniform", "bounds"}
    assert {row["part"] for row in rows} == {model.name for model in MODELS}


def test_mixed_problems_have_tips_path_errors_and_overtravel():
    rows = [closed_loop.task(2000 + number, **MIXED) for number in range(18)]
    for name in ("tip_radius", "path_error", "overtravel", "normals"):
        assert len({row[name] for row in rows}) > 1
    again = closed_loop.task(2003, **MIXED)
    assert campaign.without_times(again) == campaign.without_times(rows[3])


def test_a_truth_is_lost_only_where_something_was_touched(monkeypatch):
    """A loop that is cut short counts, if it has a contact; one that touched nothing is named apart."""
    problem = closed_loop.problem_of(4, MODELS, MODELS[4], sensor=SENSOR)
    short = closed_loop.row_of(problem, 4, max_touches=1)
    assert short["status"] == "budget" and not short["lost"]
    assert short["nothing_found"] == (short["left"] == 0)
    problem = closed_loop.problem_of(4, MODELS, MODELS[4], sensor=SENSOR)
    monkeypatch.setattr(closed_loop.Problem, "kept", lambda self, hypotheses: False)
    touched = closed_loop.row_of(problem, 4, max_touches=3)
    assert touched["status"] == "budget" and touched["lost"]
    far = replace(problem, probe=palpate.SimulatedProbe(MODELS[4], pose(0, 1e5, 0), SENSOR))
    row = closed_loop.row_of(far, 4)
    assert (row["status"], row["lost"], row["nothing_found"]) == ("nothing_found", False, True)


def test_more_blind_contacts_beside_planning():
    rows = [blind.task(number, **FINE) for number in range(9)]
    assert not any(row["lost"] or row["contradicted"] for row in rows)
    for row in rows:
        scans = [row[name]["scans"] for name in blind.WAYS if name != "planning"]
        assert scans == sorted(scans) and len(set(scans)) > 1
        for name in blind.WAYS:
            assert row[name]["scanned"] > 0.0 and row[name]["touches"] >= row[name]["scans"]
    told = blind.markdown(rows)
    assert [line.split(" | ")[0] for line in told.splitlines()[2:]] == [f"| {name}" for name in blind.WAYS]


@pytest.mark.parametrize("kind", ["part", "readings"])
def test_what_contradicts_every_model_is_not_explained(kind):
    rows = [strangers.task(1000 + number, kind=kind, **FINE) for number in range(18)]
    assert not any(row["contradicted"] for row in rows)
    assert sum(row["status"] == "unexplained" for row in rows) > 6


def test_a_part_that_is_not_in_the_library_is_not_touched_for_ever():
    """The tip skids where none of five hypotheses could be touched so obliquely."""
    row = strangers.task(527, kind="part", **FINE)
    assert (row["status"], row["left"], row["touches"]) == ("unexplained", 5, 4)


def test_readings_outside_their_bounds_are_made():
    """Errors are larger than is claimed, by about the factor."""
    problem = closed_loop.problem_of(3, MODELS, MODELS[3], sensor=SENSOR, factor=4.0)
    result = identify(problem.models, problem.probe, SENSOR, problem.workspace)
    assert all(contact.position_error == 0.5 for contact in result.contacts)
    off = [abs(problem.truth.distance(problem.world_from_truth, c.center)) for c in result.contacts]
    assert 0.5 < max(off) <= 2.0


def test_a_hypothesis_that_contradicts_a_contact_would_be_noticed():
    problem = closed_loop.problem_of(4, MODELS, MODELS[4], sensor=SENSOR)
    result = identify(problem.models, problem.probe, problem.sensor, problem.workspace)
    assert closed_loop.contradicted(result) == {"contradicted": 0, "undecided": 0}
    moved = [
        Contact(c.center + 10.0 * c.normal, c.normal, position_error=0.5, normal_error=c.normal_error)
        for c in result.contacts
    ]
    assert (
        closed_loop.contradicted(replace(result, contacts=moved))["contradicted"]
        == len(result.hypotheses)
        == 1
    )


def test_random_lines_cross_the_workspace():
    problem = closed_loop.problem_of(0, MODELS, MODELS[0], sensor=SENSOR)
    low, high = problem.workspace
    random = np.random.default_rng(0)
    for _ in range(100):
        start, end = rivals.by_chance(problem, [], random)
        for place in (start, end):
            assert (low - 1e-9 <= place).all() and (place <= high + 1e-9).all()
            assert np.isclose(np.abs(place), high).any()
        assert np.hypot(*(end - start)) > 0.0


def test_rivals_come_to_the_same_part():
    row = closed_loop.task(6, **FINE, start="drawn", beside=["chance", "entropy"])
    assert row["first"] == 9 and row["status"] == "solved" and row["touches"] == 1
    for name in ("chance", "entropy"):
        assert row[name]["status"] == "solved" and row[name]["touches"] >= row["touches"]


def test_the_campaign_writes_its_page_and_tells_a_lost_truth(tmp_path, monkeypatch, capsys):
    page = tmp_path / "page.md"
    names = ("ends", "touches", "rivals", "blind", "strangers")
    page.write_text("".join(f"<!-- made: {name} -->\n<!-- end: {name} -->\n" for name in names))
    few = [name for name in campaign_loop.PARTS if name != "beside-coarse"]
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
    assert "loops, number 8: the truth is in no hypothesis left" in capsys.readouterr().out


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_tune_tries_each_parameter_on_the_same_problems(folder, capsys):
    arguments = ("tune", "boot", "camera", "--problems", 2, "--json", "--out", "rows")
    document = json.loads(run(capsys, *arguments))
    validate(document, "tune-1")
    tried = document["tried"]
    assert {one["stop"] for one in tried} == {"perfect", "unique:1", "unique:3", "share:0.5"}
    assert {one["blind"] for one in tried} == {None, 3, 4, 6, 8}
    assert {one["position_error"] for one in tried} == {0.125, 0.25, 0.5, 1.0}
    assert all(sum(one["status"].values()) == one["loops"] >= 2 and one["lost"] == 0 for one in tried)
    assert document["recommended"] in tried
    # More blind contacts need more moves.
    equally = [one for one in tried if one["loops"] == 2]
    touches = [one["touches"] for one in equally if one["blind"] and one["stop"] == "perfect"]
    assert touches == sorted(touches)
    # Times are on disk too: it is all taken up, nothing is computed again.
    assert json.loads(run(capsys, *arguments)) == document
    told = run(capsys, "tune", "boot", "camera", "--problems", 2, "--out", "rows")
    assert "lost" in told and "recommended:" in told


def test_tune_goes_on_and_spreads(folder, capsys, monkeypatch):
    """Killed after some rows, it goes on; a cluster gives the same rows."""
    models, costs = load_models(["boot", "camera"]), tune.Costs(100.0, 1.0)
    usual, calls = tune.row_of, []

    def counted(*args, **how):
        calls.append(1)
        if len(calls) == 8:
            raise KeyboardInterrupt
        return usual(*args, **how)

    monkeypatch.setattr(tune, "row_of", counted)
    with pytest.raises(KeyboardInterrupt):
        tune.tune(models, SENSOR, costs, problems=2, out=folder / "a")
    advice = tune.tune(models, SENSOR, costs, problems=2, out=folder / "a")
    num_loops = sum(one.loops for one in advice.tried)
    assert len(calls) == num_loops + 1
    monkeypatch.setattr(tune, "row_of", usual)
    tune.tune(models, SENSOR, costs, problems=2, out=folder / "b", cluster="local:1")
    first = [next((folder / name).glob("*-all.jsonl")) for name in ("a", "b")]
    ours, theirs = ([campaign.without_times(row) for row in campaign.read(file)[1]] for file in first)
    assert ours == theirs and len(ours) == 2 * len(tune.settings())


def test_tune_tries_more_problems_where_the_best_two_are_close():
    costs = tune.Costs(100.0, 1.0)

    def rows(*touches):
        return [{"travel": 0.0, "touches": count, "seconds": {"loop": 0.0}} for count in touches]

    assert tune._close(rows(4, 6, 8), rows(5, 5, 8), costs)
    assert not tune._close(rows(4, 6, 8), rows(6, 8, 10), costs)
    assert not tune._close(rows(4), rows(4), costs)


def test_tune_tells_a_lost_truth(folder, capsys, monkeypatch):
    monkeypatch.setattr(closed_loop.Problem, "kept", lambda self, hypotheses: False)
    assert main(["tune", "boot", "--problems", "1", "--json"]) == 1
    assert all(one["lost"] == one["loops"] for one in json.loads(capsys.readouterr().out)["tried"])


def test_tune_recommends_the_cheapest_that_solves_most(tmp_path):
    models = load_models(["boot", "camera"])
    costs = tune.Costs(speed=1e-3, per_touch=0.0)
    advice = tune.tune(models, Sensor(0.5, 0.07, 1.05), costs, problems=1, out=tmp_path)
    own = [one for one in advice.tried if one.setting.factor == 1.0]
    # Where moving is all that counts, it is the way.
    assert advice.best.travel <= 1.01 * min(one.travel for one in own)
    assert len(tune.settings()) <= len(advice.tried) <= len(tune.settings()) + 1
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
