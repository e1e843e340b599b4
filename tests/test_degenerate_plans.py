"""Problems without an ordinary answer, and the keyhole: each with the answer that it must have."""

import math
from pathlib import Path

import palpate

EXAMPLES = Path(__file__).parent.parent / "examples"
SENSOR = palpate.Sensor(0.5, 0.07, math.radians(60))
WEDGE = [[0, 0], [60, 0], [60, 25], [0, 40]]
HIGHER = [[0, 0], [60, 0], [60, 25], [0, 45]]


def touch(point, normal):
    return palpate.Contact(point, normal, position_error=0.01, normal_error=0.001)


LEFT_OPEN = [
    touch((10, 0), (0, -1)),
    touch((50, 0), (0, -1)),
    touch((0, 10), (-1, 0)),
    touch((60, 20), (1, 0)),
]


def wedge(outline=WEDGE, **rest):
    return palpate.Model.polygon(outline, **rest)


def hypotheses(*models, contacts=LEFT_OPEN):
    return palpate.recognize(models, contacts).hypotheses


def test_identical_parts_are_inseparable():
    found = hypotheses(wedge(name="one"), wedge(name="two"))
    report = palpate.plan_report(found, SENSOR)
    assert (report.why, report.proved, report.bound) == ("inseparable", True, 2.0)
    assert report.path.classes == [[0, 1]] and not report.path.guaranteed
    tree = palpate.plan_tree(found, SENSOR)
    assert tree.root.status == "inseparable" and not tree.solved
    assert (tree.expected_touches, tree.worst_touches) == (1.0, 1)  # one of two, counted as one more touch
    assert "inseparable, counts 1" in tree.to_text()


def test_coincident_faces_are_told_apart_by_the_one_that_differs():
    found = hypotheses(wedge(), wedge(HIGHER))
    along_common = palpate.judge(found, SENSOR, (30, -20), (0, 1))
    assert along_common.classes == [[0, 1]]
    path = palpate.plan(found, SENSOR)
    assert path.classes == [[0], [1]]
    assert ("face", 2) in [touch.feature for outcome in path.outcomes for touch in outcome.touches]


def test_no_line_of_the_workspace_can_be_used():
    found = hypotheses(wedge(), wedge(HIGHER))
    report = palpate.plan_report(found, SENSOR, workspace=[[10, 5], [20, 10]], effort=3000)
    assert (report.path, report.why, report.proved, report.bound) == (None, "no_usable_path", True, 2.0)
    assert palpate.plan(found, SENSOR, workspace=[[10, 5], [20, 10]], effort=3000) is None
    inside = palpate.judge(found, SENSOR, (15, 5), (0, 1))
    assert inside.faults == [(0, "start"), (1, "start")]


def test_faces_that_can_not_be_touched_block_the_way():
    parts = [wedge(outline, untouchable=[1, 2, 3]) for outline in (WEDGE, HIGHER)]
    found = hypotheses(*parts, contacts=[touch((10, 0), (0, -1)), touch((50, 0), (0, -1))])
    down = palpate.judge(found, SENSOR, (30, 100), (0, -1))
    assert "untouchable" in [fault for _, fault in down.faults] and not down.guaranteed
    report = palpate.plan_report(found, SENSOR, effort=3000)
    assert report.path is not None and not report.path.faults and not report.path.guaranteed
    touches = [touch for outcome in report.path.outcomes for touch in outcome.touches]
    assert all(touch.feature == ("face", 0) for touch in touches)


def test_vertices_alone_can_not_be_aimed_at_with_a_point():
    found = hypotheses(wedge(), wedge(HIGHER))
    report = palpate.plan_report(found, SENSOR, features=("vertex",), effort=3000)
    assert report.path is not None and not report.path.guaranteed  # it passes by everything
    assert report.path.no_contact == [0, 1] and not any(o.touches for o in report.path.outcomes)


def test_all_faces_parallel():
    rails = [
        palpate.Model.segments([[[0, 0], [40, 0]], [[40, width], [0, width]]], name=f"rail-{width}")
        for width in (10, 20)
    ]
    found = hypotheses(*rails, contacts=[touch((10, 0), (0, -1)), touch((30, 0), (0, -1))])
    assert len(found) == 2
    path = palpate.plan(found, SENSOR)
    assert path.classes == [[0], [1]] and path.fault is None
    for planner in ("complete", "ellis", "grimson", "schneiter"):
        assert palpate.plan(found, SENSOR, planner=planner).fault is None


def test_one_hypothesis_needs_no_path():
    (found,) = hypotheses(wedge())
    report = palpate.plan_report([found], SENSOR)
    assert (report.path, report.why, report.proved, report.bound) == (None, "solved", True, 1.0)
    tree = palpate.plan_tree([found], SENSOR)
    assert tree.solved and tree.root.status == "solved" and tree.root.path is None
    assert (tree.expected_touches, tree.worst_touches, tree.entropy_bound) == (0.0, 0, 0.0)
    alone = palpate.judge([found], SENSOR, (20, 100), (0, -1))
    assert (alone.score, alone.guaranteed, alone.classes) == (1.0, False, [[0]])


def test_exact_sensors_do_not_divide_by_zero():
    found = hypotheses(wedge(), wedge(HIGHER))
    exact = palpate.Sensor(0.0, 0.0, 1.0)
    path = palpate.plan(found, exact)
    assert path.score == 1.0 and path.margin > 0.0


def keyholes():
    models = palpate.load_models(EXAMPLES / "keyhole")
    evidence = palpate.read_contacts(EXAMPLES / "keyhole-contacts.csv")
    return palpate.recognize(models, evidence.contacts).hypotheses


def test_only_a_line_down_the_slot_opens_the_keyhole():
    found = keyholes()
    assert len(found) == 2
    sensor = palpate.Sensor(0.25, math.radians(2), math.radians(60), path_error=0.02)
    as_printed = palpate.plan_report(found, sensor, planner="ellis")
    assert as_printed.path.classes == [[0, 1]] and not as_printed.proved
    for planner in ("complete", "auto"):
        report = palpate.plan_report(found, sensor, planner=planner)
        assert report.path.classes == [[0], [1]] and report.why == "perfect"
        assert report.path.direction[1] < -0.9 and 4.5 < (report.path.start + report.path.end)[0] / 2 < 5.6
