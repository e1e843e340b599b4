"""Every name of planning, called with something other than its defaults, and what it returns."""

import copy
import json
import math
import pickle
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import hypotheses_of, usual_sensor

import palpate


@pytest.fixture(scope="module")
def hands():
    """Three poses of the human hand, and a boot."""
    return hypotheses_of("human-hand")


@pytest.fixture(scope="module")
def many():
    """Twelve of the hypotheses that two contacts leave."""
    touches = [
        palpate.Contact(point, normal, position_error=0.5, normal_error=0.07)
        for point, normal in (((0, 0), (0, -1)), ((14, 14), (1, 0)))
    ]
    six = palpate.load_models(list(palpate.part_names())[:6])
    return palpate.recognize(six, touches).hypotheses[:12]


@pytest.fixture(scope="module")
def path(hands):
    return palpate.plan(hands, usual_sensor())


def test_sensor():
    sensor = palpate.Sensor(0.25, 0.125, 1.0, tip_radius=2.0, path_error=0.5)
    numbers = (sensor.position_error, sensor.normal_error, sensor.max_incidence)
    assert numbers == (0.25, 0.125, 1.0)
    assert (sensor.tip_radius, sensor.path_error) == (2.0, 0.5)
    assert repr(sensor) == "Sensor(0.25, 0.125, 1.0, tip_radius=2.0, path_error=0.5)"
    assert eval(repr(sensor), {"Sensor": palpate.Sensor}) == sensor
    for other in (pickle.loads(pickle.dumps(sensor)), copy.copy(sensor), copy.deepcopy(sensor)):
        assert other == sensor
    bare = palpate.Sensor(0, None, 1)
    assert (bare.normal_error, bare.tip_radius, bare.path_error) == (None, 0.0, 0.0)
    assert bare != sensor
    assert palpate.Sensor(0.25, 0.125, 1.0, 2.0, 0.5) == sensor


def test_path(hands, path):
    assert path.start.shape == path.direction.shape == path.end.shape == (2,)
    assert math.hypot(*path.direction) == pytest.approx(1.0)
    assert np.allclose(path.end, path.start + path.length * path.direction)
    assert path.margin > 0.1 and path.score == 1.0 and path.guaranteed
    assert path.expected_score == pytest.approx(1.0)
    assert path.members == [0, 1, 2, 3]
    assert path.classes == [[0], [1], [2], [3]]
    assert path.no_contact == [k for k, outcome in enumerate(path.outcomes) if outcome.may_miss]
    assert path.fault is None and path.faults == []
    assert "score 1.0000 of 4" in repr(path)
    with pytest.raises(ValueError, match="read-only"):
        path.start[0] = 0.0


def test_outcomes(path):
    last = max(touch.depth[1] for outcome in path.outcomes for touch in outcome.touches)
    # Past the last contact also where the path is shifted by its margin, at up to 60° of incidence.
    assert last < path.length < last + 2.0 + 2.0 * path.margin
    for k, outcome in enumerate(path.outcomes):
        assert outcome.hypothesis == k and outcome.fault is None
        assert outcome.touches or outcome.may_miss
        for touch in outcome.touches:
            kind, number = touch.feature
            assert kind == "face" and number >= 0
            assert 0.0 < touch.depth[0] <= touch.depth[1]
            assert touch.normals[0] <= touch.normals[1] < touch.normals[0] + 1.0
            # A touch comes from the front.
            assert path.direction @ [math.cos(touch.normals[0]), math.sin(touch.normals[0])] < 0.0
            assert f"{kind} {number} at depth" in repr(touch) and repr(touch)[8:-1] in repr(outcome)


def reading(path, touch, *, normal=True):
    depth, angle = sum(touch.depth) / 2, sum(touch.normals) / 2
    sensed = {"normal": (math.cos(angle), math.sin(angle)), "normal_error": 0.1} if normal else {}
    return palpate.Contact(path.start + depth * path.direction, position_error=9.0, **sensed)


def test_outcome_of(path):
    for k, outcome in enumerate(path.outcomes):
        for touch in outcome.touches:
            assert path.outcome_of(reading(path, touch)) == [k]
            assert k in path.outcome_of(reading(path, touch, normal=False))
    assert path.outcome_of(None) == path.no_contact
    assert path.outcome_of(palpate.Contact(path.start, position_error=0.5)) == []
    far_aside = path.start + 100.0 * path.direction + 5.0 * path.direction[::-1] * [-1, 1]
    assert path.outcome_of(palpate.Contact(far_aside, position_error=0.5)) == []


def test_a_path_is_the_same_every_time(hands, path):
    again = palpate.plan(hands, usual_sensor(), time_limit=100.0)
    assert again == path and again.outcomes == path.outcomes
    assert again.outcomes[0].touches == path.outcomes[0].touches
    assert palpate.plan(hands[1:], usual_sensor()) != path


@pytest.mark.parametrize("planner", ["auto", "complete", "ellis", "grimson", "schneiter"])
def test_planners(hands, planner):
    report = palpate.plan_report(hands, usual_sensor(), planner=planner)
    path = palpate.plan(hands, usual_sensor(), planner=planner)
    assert report.path == path and path.fault is None and path.score <= 2.0
    assert (report.why, report.proved, report.bound) == ("perfect", True, 1.0) or path.score > 1.0
    assert report.num_judged > 0
    assert (report.counters is not None) == (planner == "ellis")
    assert f"score {path.score:.4f} of 4" in repr(report)
    if planner == "ellis":
        assert report.counters["paths"] == report.num_judged
        assert report.counters["sensed"] == 8
        assert report.counters["predicted_inner_products"] >= report.counters["inner_products"] > 0
        assert report.counters["predicted_critical_points"] >= report.counters["critical_points"] > 0
        assert report.counters["critical_points"] >= report.counters["critical_kept"] > 0
        assert report.counters["generators"] > 0 and report.counters["candidates"] > 0
        assert report.counters["unsensed"] > report.counters["sensed"] and report.counters["overlaps"] > 0


def test_grids_change_what_is_found(hands):
    def judged(planner, **grid):
        return palpate.plan_report(hands, usual_sensor(), planner=planner, **grid).num_judged

    few = palpate.plan(hands, usual_sensor(), planner="grimson", cells=16, directions_tried=2)
    assert few is None or few != palpate.plan(hands, usual_sensor(), planner="grimson")
    assert judged("grimson", directions_tried=1) < judged("grimson", directions_tried=720) + 1
    assert palpate.plan(
        hands, usual_sensor(), planner="grimson", cells=256, directions_tried=72
    ) == palpate.plan(hands, usual_sensor(), planner="grimson", cells=None, directions_tried=None)
    assert palpate.plan(hands, usual_sensor(), planner="schneiter", cells=256) == palpate.plan(
        hands, usual_sensor(), planner="schneiter"
    )


def test_stops(hands):
    sensor = usual_sensor(normal_error=None)
    for stop, enough in ((("unique", 1), 1), (("share", 0.25), 1), (("unique", 2), 2), (("share", 0.5), 2)):
        path = palpate.plan(hands, sensor, stop=stop)
        assert sum(len(members) == 1 for members in path.classes) >= enough
    lazy = palpate.plan_report(hands, sensor, stop=("unique", 1))
    assert lazy.num_judged <= palpate.plan_report(hands, sensor).num_judged
    assert lazy.why in ("enough", "perfect")


def test_where_paths_may_run(hands):
    corners = [[300, 250], [-250, -200]]
    path = palpate.plan(hands, usual_sensor(), workspace=corners)
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    assert np.isclose([path.start - low, high - path.start], 0.0, atol=1e-9).any()
    down = palpate.plan(hands, usual_sensor(), directions=((0, -3), 0.25))
    assert math.acos(down.direction @ [0, -1]) <= 0.25 + 1e-9


def test_assigned_faces_can_be_avoided(hands):
    lines = palpate.Lines(hands, usual_sensor(), avoid_assigned=True)
    faults = {
        lines.judge(angle, offset).fault for angle in np.arange(-3, 3, 0.3) for offset in range(-80, 81, 20)
    }
    assert "assigned" in {fault[1] for fault in faults if fault is not None}
    path = palpate.plan(hands, usual_sensor(), avoid_assigned=True)
    same = palpate.judge(hands, usual_sensor(), path.start, path.direction, avoid_assigned=True)
    assert path.fault is None and same.fault is None


def test_what_may_be_touched(hands):
    path = palpate.plan(hands, usual_sensor(tip_radius=3.0), features=("face",))
    assert {touch.feature[0] for outcome in path.outcomes for touch in outcome.touches} == {"face"}
    aimed = palpate.judge(hands, usual_sensor(), (200, 40), (-1, 0), features=("vertex",))
    assert "kind" in [fault for _, fault in aimed.faults]


def test_margin_is_a_share_of_the_part(hands):
    coarse = palpate.plan(hands, usual_sensor(), margin=0.02)
    size = max(hypothesis.model.size for hypothesis in hands)
    step = 0.02 * size / 8
    assert coarse.margin / step == pytest.approx(round(coarse.margin / step), abs=1e-6)


def test_seed_draws_other_poses(hands):
    line = ((200, 60), (-1, -0.2))
    scores = {palpate.judge(hands, usual_sensor(), *line, seed=seed).expected_score for seed in range(6)}
    assert len(scores) > 1


def test_judge(hands, path):
    again = palpate.judge(hands, usual_sensor(), path.start, 7.0 * path.direction)
    assert (again.score, again.classes, again.margin) == (path.score, path.classes, path.margin)
    assert again.length == pytest.approx(path.length)
    short = palpate.judge(hands, usual_sensor(), path.start, path.direction, 20.0)
    assert short.length == 20.0 and short.no_contact == [0, 1, 2, 3] and not short.guaranteed
    inside = palpate.judge(hands, usual_sensor(), (0, 40), (1, 0))
    assert (1, "start") in inside.faults and inside.fault in inside.faults and not inside.guaranteed
    assert inside.outcomes[1].fault == "start" and "start" in repr(inside)


def test_the_line_of_a_path_is_that_path_again(hands, path):
    assert palpate.judge(hands, usual_sensor(), path.start, path.direction, path.length) == path
    for other in hypotheses_of("camera"), hypotheses_of("boot"):
        path = palpate.plan(other, usual_sensor())
        assert palpate.judge(other, usual_sensor(), path.start, path.direction, path.length) == path


def test_a_line_that_ends_before_anything_has_no_fault(hands):
    path = palpate.judge(hands, usual_sensor(), (0, 300), (0, -1), 1.0)
    assert not path.faults
    assert path.score == len(hands) and path.margin == 0.0
    assert path.no_contact == list(range(len(hands))) and not any(o.touches for o in path.outcomes)
    assert palpate.judge(hands, usual_sensor(), (0, 300), (0, -1)).faults


def test_a_direction_may_have_any_length(hands):
    paths = [palpate.judge(hands, usual_sensor(), (0, 300), (0, -y)) for y in (1.0, 1e-300, 5e-324, 1e308)]
    assert all(path == paths[0] for path in paths)
    with pytest.raises(ValueError, match="direction: must not be zero"):
        palpate.judge(hands, usual_sensor(), (0, 300), (0, 0))


@pytest.mark.parametrize("planner", ["auto", "complete", "grimson"])
@pytest.mark.parametrize("half", [0.0, 1e-12, 1e-5, 2e-4, 0.01])
def test_one_direction_is_enough(hands, planner, half):
    """What `Lines` finds in the only direction that is allowed, planners find."""
    angle = math.radians(45.0)
    lines = palpate.Lines(hands, usual_sensor())
    judged = [lines.judge(angle, aside) for aside in np.linspace(-100, 100, 401)]
    best = min(path.score for path in judged if not path.faults)
    cone = ((math.cos(angle), math.sin(angle)), half)
    report = palpate.plan_report(hands, usual_sensor(), planner=planner, directions=cone)
    assert best < len(hands) and report.path is not None and report.path.score <= best
    assert math.acos(min(1.0, report.path.direction @ np.array(cone[0]))) <= half + 1e-7


def test_exact_readings_are_answered_whatever_the_rounding(hands):
    sensor = palpate.Sensor(0.0, None, math.radians(60))
    path = palpate.plan(hands, sensor)
    for outcome in path.outcomes:
        for touch in outcome.touches:
            for depth in np.linspace(*touch.depth, 52)[1:-1]:
                contact = palpate.Contact(path.start + depth * path.direction, position_error=0.0)
                assert outcome.hypothesis in path.outcome_of(contact)


def test_schneiter_heeds_the_time(hands):
    many, sensor = list(hands) * 25, palpate.Sensor(8.0, None, 1.047, path_error=5.0)
    began = time.monotonic()
    report = palpate.plan_report(many, sensor, planner="schneiter", cells=2048, time_limit=0.01)
    assert report.why == "time" and time.monotonic() - began < 20.0


def test_a_workspace_that_cuts_in_leaves_nothing_proved(hands):
    narrow = palpate.Sensor(2.0, math.radians(4), 0.35, path_error=2.0)
    corners = [[-60, -20], [130, 200]]
    report = palpate.plan_report(hands, narrow, planner="complete", workspace=corners, margin=0.05)
    assert report.path is not None and report.path.score > 1.0
    assert not report.proved and report.bound == 1.0


def test_lines_that_were_tried_are_refused_where_nothing_is_certain(hands, path):
    tried = [(path.start, path.direction)]
    assert path.guaranteed and palpate.plan(hands, usual_sensor(), tried=tried) == path
    bracket = np.array([[0, 0], [80, 0], [80, 15], [20, 15], [20, 60], [0, 60]])
    twins = [palpate.Model.polygon(bracket * size) for size in (1.0, 1.02)]
    touches = [
        palpate.Contact(point, normal, position_error=0.5, normal_error=0.07)
        for point, normal in (((30, 0), (0, -1)), ((0, 20), (-1, 0)))
    ]
    alike = [one for one in palpate.recognize(twins, touches).hypotheses if one.poses.contains(np.eye(3))]
    first = palpate.plan(alike, usual_sensor(), effort=500)
    assert not first.guaranteed and first.expected_score < 1.9
    m = 1e-3 * max(one.model.size for one in alike)
    aside = np.array([-first.direction[1], first.direction[0]])
    for shift, refused in ((0.0, True), (0.9 * m, True), (1.5 * m, False)):
        line = (first.start + shift * aside, 3.0 * first.direction)
        again = palpate.plan(alike, usual_sensor(), effort=500, tried=[line])
        assert (again != first) == refused and not again.guaranteed
    for bad in (3, [3], [((0, 0), (0, 0))], [((0, 0, 0), (0, 1))]):
        with pytest.raises(ValueError, match="tried"):
            palpate.plan(alike, usual_sensor(), tried=bad)


def test_effort_limits_the_search_and_the_bound_tells():
    # Two parts that are nearly the same: no path tells, and it takes a search to say so.
    outlines = {"one": [[0, 0], [60, 0], [60, 25], [0, 40]], "two": [[0, 0], [60, 0], [60, 25.001], [0, 40]]}
    twins = [palpate.Model.polygon(outline, name=name) for name, outline in outlines.items()]
    touches = [palpate.Contact(p, n, position_error=0.01, normal_error=0.001) for p, n in
               [((10, 0), (0, -1)), ((50, 0), (0, -1)), ((0, 10), (-1, 0)), ((60, 20), (1, 0))]]  # fmt: skip
    found = palpate.recognize(twins, touches).hypotheses
    report = palpate.plan_report(found, usual_sensor(), effort=100)
    assert (report.why, report.proved) == ("effort", False)
    assert 1.0 <= report.bound < 2.0 and 100 <= report.num_boxes <= 1000
    begin = time.monotonic()
    late = palpate.plan_report(found, usual_sensor(), planner="complete", time_limit=0.02, margin=1e-5)
    assert (late.why, late.proved) == ("time", False) and time.monotonic() - begin < 5.0


def test_a_search_ends_with_an_interrupt():
    code = """
import palpate
outline = [[0, 0], [60, 0], [60, 25], [0, 40]]
twins = [palpate.Model.polygon(outline, name=name) for name in ("one", "two")]
touches = [palpate.Contact((10, 0), (0, -1), position_error=0.5, normal_error=0.1)]
found = palpate.recognize(twins, touches * 2).hypotheses
print("planning", flush=True)
palpate.plan(found, palpate.Sensor(0.5, 0.1, 1.0), planner="complete", margin=1e-6, effort=10**12)
"""
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout.readline() == "planning\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    finally:
        process.kill()
    assert err.rstrip().endswith("KeyboardInterrupt")


def test_lines(hands):
    lines = palpate.Lines(hands, usual_sensor(), directions=((1, 0), 1.0), seed=3)
    scores = lines.scores([0.5, 0.75, 3.0], [-20.0, 0.0, 20.0, 1e3])
    assert scores.shape == (3, 4) and np.isnan(scores[2]).all()
    assert lines.judge(3.0, 0.0) is None
    for i, angle in enumerate((0.5, 0.75)):
        for j, offset in enumerate((-20.0, 0.0, 20.0)):
            path = lines.judge(angle, offset)
            left = np.array([-math.sin(angle), math.cos(angle)])
            assert left @ (path.start - lines.middle) == pytest.approx(offset)
            assert math.isclose(
                math.dist(path.start, lines.middle), math.hypot(lines.radius, offset), rel_tol=0.05
            )
            assert np.isnan(scores[i, j]) if path.fault else scores[i, j] == path.score
    assert scores[0, 3] == len(hands)  # passes by everything
    assert "Lines within" in repr(lines)


def test_verification_path(hands):
    path = palpate.verification_path(hands[1], usual_sensor(), directions=((0, -1), 1.5), seed=2)
    assert path.direction[1] < 0.1 and path.members == [0]
    (outcome,) = path.outcomes
    assert outcome.touches and not outcome.may_miss and path.margin > 0.5
    assigned = next(iter(hands[1].interpretations)).assignment
    assert not {touch.feature for touch in outcome.touches} & set(assigned)
    assert palpate.verification_path(hands[1], usual_sensor(), features=("vertex",)) is None


@pytest.mark.parametrize("tip_radius", [0.0, 2.0])
def test_two_of_one_part_are_inseparable_whatever_the_tip(wedge, tip_radius):
    other = palpate.Model.polygon(wedge.vertices, name="the same")
    touches = [
        palpate.Contact.from_tip(at, tip_radius, position_error=0.5, normal=normal, normal_error=0.07)
        for at, normal in (((30, -tip_radius), (0, -1)), ((-tip_radius, 20), (-1, 0)))
    ]
    found = palpate.recognize([wedge, other], touches).hypotheses
    twins = [one for one in found if np.allclose(one.world_from_model, found[0].world_from_model)]
    assert [one.model.name for one in twins] == ["wedge", "the same"]
    report = palpate.plan_report(twins, usual_sensor(tip_radius=tip_radius), effort=10)
    assert report.why == "inseparable" and report.proved and report.path.expected_score == 2.0


@pytest.mark.parametrize("method", ["greedy", "ahead", "optimal"])
def test_tree(many, method):
    sensor = usual_sensor(normal_error=None)  # one path doesn't do
    tree = palpate.plan_tree(many, sensor, method=method, effort=2000)
    assert tree.method == method and tree.names == [hypothesis.model.name for hypothesis in many]
    assert tree.entropy_bound <= tree.expected_touches <= tree.worst_touches <= 4
    assert 1.0 <= tree.lower_bound <= tree.expected_touches and tree.worst_bound <= tree.worst_touches
    assert tree.max_outcomes >= 2 and sum(tree.identified) == len(many)
    assert tree.root.members == list(range(12)) and tree.root.level == 0 and tree.root.number == 0
    assert len(tree.nodes) > 13 and "touches expected" in repr(tree)
    for node in tree.nodes:
        check_node(many, node, sensor=sensor)
    assert tree.solved == all(node.status in ("solved", "divided") for node in tree.nodes)


def check_node(hypotheses, node, *, sensor):
    """The numbers at every node are those of the list that was given."""
    assert repr(node.members) in repr(node)
    if node.path is None:
        assert node.branches == [] and (node.status == "solved") == (len(node.members) == 1)
        return
    path = node.path
    assert node.status == "divided" and path.members == node.members
    assert [outcome.hypothesis for outcome in path.outcomes] == node.members
    some = [hypotheses[k] for k in node.members]
    alone = palpate.judge(some, sensor, path.start, path.direction)
    assert path.classes == [[node.members[k] for k in members] for members in alone.classes]
    assert path.no_contact == [node.members[k] for k in alone.no_contact]
    *classes, unexpected = node.branches
    assert [branch.members for branch in classes] == path.classes
    assert (unexpected.answers, unexpected.members, unexpected.node) == ("unexpected", [], None)
    for branch in classes:
        assert branch.node.members == branch.members and branch.node.level == node.level + 1
        miss = any(k in path.no_contact for k in branch.members)
        assert (branch.answers in ("no_contact", "either")) == miss
        assert repr(branch.members) in repr(branch)
    for outcome in path.outcomes:
        for touch in outcome.touches:
            assert outcome.hypothesis in path.outcome_of(reading(path, touch, normal=False))


def test_small_trees(hands):
    tree = palpate.plan_tree(hands, usual_sensor(), max_nodes=0)
    assert tree.root.status == "unexpanded" and not tree.solved and tree.expected_touches == 3.0
    tree = palpate.plan_tree(hands, usual_sensor(), time_limit=1e-9)
    assert tree.root.status == "unexpanded"
    tree = palpate.plan_tree(hands, usual_sensor(), planner="ellis", seed=1)
    assert tree.root.path.margin > 0.0


def test_tree_as_text_and_as_json(hands):
    tree = palpate.plan_tree(hands, usual_sensor())
    assert "├─ S4 contact: I4 boot" in tree.to_text()
    document = json.loads(tree.to_json(unit="in"))
    assert (document["schema"], document["version"], document["unit"]) == ("palpate-tree", 1, "in")
    assert json.loads(tree.to_json())["unit"] is None
    assert document["expected_touches"] == tree.expected_touches
    root = document["nodes"][0]
    assert root["members"] == [0, 1, 2, 3]
    assert root["path"]["classes"] == tree.root.path.classes
    assert root["path"]["start"] == tree.root.path.start.tolist()
