"""Planning in space from Python: shapes, pickles, and what is refused."""

import copy
import json
import math
import pickle
from importlib.resources import files

import jsonschema
import numpy as np
import pytest
from brackets import POINTS, POSE, bracket, touches
from conftest import hypotheses_of, usual_sensor

import palpate
from palpate.plan_json import path_entry

HANDS = hypotheses_of("human-hand")
FOUND = palpate.recognize([bracket()], touches()[:2]).hypotheses
SENSOR = usual_sensor()
STEM = ((0, 0, 2), 1.5, 80.0)

#: A point of the bracket's top and its outward normal, world frame.
POINT, NORMAL = (POSE[:3, :3] @ POINTS[0][0] + POSE[:3, 3], POSE[:3, :3] @ POINTS[0][1])


def judged(shift=0.0):
    """The path straight at that point."""
    return palpate.judge(FOUND, SENSOR, POINT + 50 * NORMAL + shift, -NORMAL)


def test_a_stem_is_part_of_the_sensor():
    plain, carried = SENSOR, usual_sensor(stem=STEM)
    assert plain.stem is None and plain != carried and carried == usual_sensor(stem=((0, 0, 5), 1.5, 80))
    direction, radius, length = carried.stem
    assert np.array_equal(direction, (0, 0, 1)) and (radius, length) == (1.5, 80.0)
    assert "stem" not in repr(plain) and repr(carried).endswith(", stem=((0.0, 0.0, 1.0), 1.5, 80.0))")
    tilted = usual_sensor(stem=((1, 2, 3), 0, 1e-3))
    for one in (plain, carried, tilted):
        for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
            assert again == one
    assert eval(repr(carried), {"Sensor": palpate.Sensor}) == carried
    maker, state = plain.__reduce__()
    assert maker(*state[:-1]) == plain  # as it was written before there were stems


def test_a_path_in_space_has_three_coordinates():
    assert len(FOUND) > 1
    path = judged()
    assert path.start.shape == path.direction.shape == path.end.shape == (3,)
    assert np.array_equal(path.start, POINT + 50 * NORMAL)
    assert np.allclose(path.direction, -NORMAL, rtol=0, atol=1e-12)
    assert np.allclose(path.end, path.start + path.length * path.direction)
    assert path == judged() and path != judged(shift=1.0)
    assert path == palpate.judge(FOUND, SENSOR, path.start, path.direction, path.length)
    assert " along (" in repr(path) and "°" not in repr(path)
    assert path.members == list(range(len(FOUND))) == [one.hypothesis for one in path.outcomes]
    assert path.outcome_of(None) == path.no_contact
    assert path.faults == [(k, one.fault) for k, one in enumerate(path.outcomes) if one.fault]


def test_what_is_met_is_among_what_the_truth_may_answer():
    (truth,) = [k for k, one in enumerate(FOUND) if one.poses.contains(POSE)]
    path = judged()
    met = palpate.Contact(POINT, NORMAL, position_error=0.5, normal_error=0.07)
    assert truth in path.outcome_of(met)
    assert palpate.refuting_moves(FOUND, [(path.start, -NORMAL, 400, SENSOR, met)])[truth] is None
    assert path.outcomes[truth].touches
    for touch in path.outcomes[truth].touches:
        axis, angle = touch.normal_cap
        assert axis.shape == (3,) and np.linalg.norm(axis) == pytest.approx(1) and 0 <= angle <= math.pi
        assert touch.feature[0] in ("face", "edge", "vertex") and touch.depth[0] <= touch.depth[1]
        with pytest.raises(ValueError, match=r"^normals: works in the plane only .*normal_cap"):
            _ = touch.normals
        assert touch == touch and "at depth" in repr(touch)


def test_normals_of_the_plane_are_in_their_cap():
    path = palpate.plan(HANDS, SENSOR)
    touched = [touch for outcome in path.outcomes for touch in outcome.touches]
    assert touched
    for touch in touched:
        axis, angle = touch.normal_cap
        start, end = touch.normals
        for side, at in ((-angle, start), (angle, end)):
            turned = math.atan2(axis[1], axis[0]) + side
            assert math.cos(turned - at) == pytest.approx(1, abs=1e-12)


#: Four parts that the same four touches explain.
PARTS = palpate.load_models(["l-bracket", "rib-plate", "hexagon", "flange"])
TOUCHED = [
    palpate.Contact(point, normal, position_error=0.5, normal_error=math.radians(4))
    for point, normal in [
        ((175.4, 160.2, 96.4), (-0.415, 0.769, 0.486)),
        ((223.3, 37.7, 82.5), (0.412, -0.761, -0.5)),
        ((216.9, 138.9, 83.1), (0.91, 0.326, 0.257)),
        ((221.1, 23.7, 109.5), (-0.012, -0.559, 0.829)),
    ]
]
SPACE_PLANNERS = ("auto", "grimson", "schneiter", "decoupled", "linearized", "optimized")


LEFT = palpate.recognize(PARTS, TOUCHED).hypotheses
BLUNT = palpate.Sensor(0.5, math.radians(4), math.radians(60))


@pytest.mark.parametrize("planner", SPACE_PLANNERS)
def test_every_planner_of_space_finds_what_tells_all_apart(planner):
    report = palpate.plan_report(LEFT, BLUNT, planner=planner)
    assert len(LEFT) > 1 and report.path.score == 1.0 and report.why == "perfect"
    again = palpate.judge(LEFT, BLUNT, report.path.start, report.path.direction, report.path.length)
    assert again == report.path and not again.faults


@pytest.mark.parametrize("planner", SPACE_PLANNERS)
@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (0, -1, 0)])
def test_every_planner_of_space_heeds_what_is_allowed(planner, axis):
    options = {"directions": (axis, 1.0), "workspace": [(-500,) * 3, (500,) * 3], "planner": planner}
    path = palpate.plan(LEFT, BLUNT, **options)
    assert path.score < len(LEFT) and not path.faults
    assert float(path.direction @ axis) >= math.cos(1.0) - 1e-9
    assert np.max(np.abs(path.start)) == pytest.approx(500)
    assert palpate.plan(LEFT, BLUNT, **options) == path
    assert palpate.plan_report(LEFT, BLUNT, **options, effort=2).num_judged <= 2
    assert palpate.plan_report(LEFT, BLUNT, **options, time_limit=1e-9).path is None


def test_grids_of_space_are_its_own():
    for planner, cells in (("grimson", 32), ("schneiter", 48)):
        usual = palpate.plan(LEFT, BLUNT, planner=planner)
        assert palpate.plan(LEFT, BLUNT, planner=planner, cells=cells) == usual
        assert palpate.plan(LEFT, BLUNT, planner=planner, cells=9) != usual
    usual = palpate.plan(LEFT, BLUNT, planner="grimson")
    assert palpate.plan(LEFT, BLUNT, planner="grimson", directions_tried=96) == usual


def test_a_planned_touch_leaves_the_truth_alone():
    path = palpate.plan(LEFT, BLUNT)
    assert len(LEFT) > 1 and path.score == 1.0
    document = path_entry(path)
    assert "angle_deg" not in document and len(document["direction"]) == 3
    schema = json.loads((files(palpate) / "schemas" / "plan-1.json").read_text(encoding="utf-8"))
    jsonschema.validate(document, {"$ref": "#/$defs/path", "$defs": schema["$defs"]})
    for number, hypothesis in enumerate(LEFT):
        for seed, pose in enumerate(hypothesis.poses.sample(3, seed=2)):
            probe = palpate.SimulatedProbe(hypothesis.model, pose, BLUNT, seed=seed, noise="bounds")
            reply = probe.touch(path.start, path.end)
            contact = reply.contact if isinstance(reply, palpate.Hit) else None
            assert path.outcome_of(contact) == [number]
            after = palpate.recognize(PARTS, [*TOUCHED, *([] if contact is None else [contact])]).hypotheses
            assert any(one.model.name == hypothesis.model.name and one.poses.contains(pose) for one in after)


def test_a_stem_is_not_simulated():
    with pytest.raises(ValueError, match="sensor: its stem is not simulated"):
        palpate.SimulatedProbe(bracket(), POSE, usual_sensor(stem=STEM))


def test_one_hypothesis_needs_no_path():
    report = palpate.plan_report(FOUND[:1], SENSOR, workspace=[(-500,) * 3, (500,) * 3])
    assert (report.path, report.why, report.proved) == (None, "solved", True)
    tree = palpate.plan_tree(FOUND[:1], SENSOR, directions=(NORMAL, 0.5))
    assert tree.solved and tree.names == ["bracket"] and tree.root.members == [0]
    assert tree.root.path is None and tree.root.status == "solved"
    assert "I1 bracket" in tree.to_text()


def test_the_planner_answers_the_same_again():
    options = {
        "directions": (-NORMAL, 1.0),
        "tried": [(POINT, -NORMAL)],
        "features": ("face", "edge"),
        "effort": 9,
    }
    report, again = (palpate.plan_report(FOUND, SENSOR, **options) for _ in range(2))
    assert (report.path, report.why, report.num_judged) == (again.path, again.why, again.num_judged)
    assert 0 < report.num_judged <= 9 and report.counters is None and report.num_boxes == 0
    if report.path is not None:
        assert report.path.direction @ -NORMAL >= math.cos(1.0) - 1e-9


@pytest.mark.parametrize("length", [1e-200, 1e200])
def test_directions_are_of_any_length(length):
    usual = palpate.plan(LEFT, BLUNT, directions=((0, 0, -1), 0.8))
    assert palpate.plan(LEFT, BLUNT, directions=((0, 0, -length), 0.8)) == usual
    assert math.acos(-usual.direction[2]) <= 0.8 + 1e-9


def test_lines_of_space_are_scored_as_they_are_judged():
    lines = palpate.Lines(LEFT, BLUNT)
    random = np.random.default_rng(4)
    directions = random.normal(size=(400, 3))
    points = lines.middle + 0.5 * lines.radius * random.normal(size=(400, 3))
    scores, least = lines.scores_through(directions, points), lines.least_scores(directions, points)
    assert scores.shape == least.shape == (400,)
    usable = np.isfinite(scores)
    assert 20 < usable.sum() < 400
    # What can't be used at one pose can't be used, and no score is below the least.
    assert np.all(least[usable] <= scores[usable] + 1e-12)
    for k in range(0, 400, 10):
        path = lines.judge_through(directions[k], points[k])
        assert bool(path.faults) == (not usable[k])
        assert path.faults or path.score == pytest.approx(scores[k], abs=1e-12)
    # The planner looks at lines as these are.
    assert palpate.plan(LEFT, BLUNT).score <= np.nanmin(scores)
