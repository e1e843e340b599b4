"""Bad input of planning from Python, each with the message it gets: argument, what is wrong, value, remedy."""

import math

import pytest
from conftest import hypotheses_of, usual_sensor

import palpate

NAN = math.nan
HANDS = hypotheses_of("human-hand")
SENSOR = usual_sensor()
SENSED = (0, HANDS[0].interpretations[0].assignment[0][1])


def sensor(position_error=0.5, normal_error=0.1, max_incidence=1.0, **rest):
    return palpate.Sensor(position_error, normal_error, max_incidence, **rest)


def plan(hypotheses=HANDS, sensor=SENSOR, **rest):
    return palpate.plan(hypotheses, sensor, **rest)


def judge(start=(0, 0), direction=(1, 0), length=None, **rest):
    return palpate.judge(HANDS, SENSOR, start, direction, length, **rest)


def tree(**rest):
    return palpate.plan_tree(HANDS, SENSOR, **rest)


def lines(angles=(0,), offsets=(0,)):
    return palpate.Lines(HANDS, SENSOR).scores(angles, offsets)


def line(angle=0, offset=0):
    return palpate.Lines(HANDS, SENSOR).judge(angle, offset)


def verify(hypothesis=HANDS[0], **rest):
    return palpate.verification_path(hypothesis, SENSOR, **rest)


def space(generator=None, **rest):
    return palpate.projection_space(HANDS, SENSOR, generator, **rest)


def overlaps(slope):
    return space((0, 1)).overlaps(slope)


def projected(slopes, of="inner"):
    return getattr(space((0, 1)).sheaves[0], of)(slopes)


def outcome_of(contact):
    return plan().outcome_of(contact)


def to_json(unit):
    return tree().to_json(unit=unit)


# (what is called, what is passed, the whole message)
CASES = [
    (sensor, {"position_error": -1}, "position_error: must be a finite number, zero or more (got -1); give the bound as a length"),
    (sensor, {"position_error": NAN}, "position_error: must be a finite number, zero or more (got NaN); give the bound as a length"),
    (sensor, {"position_error": "0.5"}, "position_error: must be a number (got '0.5'); give a single int or float"),
    (sensor, {"normal_error": 4}, "normal_error: must be an angle from 0 to π/2 (got 4); give radians, or leave it out if the sensor reads no normal"),
    (sensor, {"normal_error": -0.1}, "normal_error: must be an angle from 0 to π/2 (got -0.1); give radians, or leave it out if the sensor reads no normal"),
    (sensor, {"normal_error": NAN}, "normal_error: must be an angle from 0 to π/2 (got NaN); give radians, or leave it out if the sensor reads no normal"),
    (sensor, {"normal_error": "x"}, "normal_error: must be a number (got 'x'); give a single int or float"),
    (sensor, {"max_incidence": 0}, "max_incidence: must be an angle between 0 and π/2 (got 0); give radians, such as 1.047 for 60°"),
    (sensor, {"max_incidence": 60}, "max_incidence: must be an angle between 0 and π/2 (got 60); give radians, such as 1.047 for 60°"),
    (sensor, {"max_incidence": None}, "max_incidence: must be a number (got None); give a single int or float"),
    (sensor, {"tip_radius": -2}, "tip_radius: must be a finite number, zero or more (got -2); give the bound as a length"),
    (sensor, {"tip_radius": (1, 2)}, "tip_radius: must be a number (got (1, 2)); give a single int or float"),
    (sensor, {"path_error": math.inf}, "path_error: must be a finite number, zero or more (got inf); give the bound as a length"),
    (plan, {"hypotheses": []}, "hypotheses: must not be empty (got []); give found.hypotheses of a recognition"),
    (plan, {"hypotheses": 5}, "hypotheses: must be a sequence of Hypothesis (got 5); give found.hypotheses of a recognition"),
    (plan, {"hypotheses": ["boot"]}, "hypotheses[0]: must be a Hypothesis (got 'boot'); give found.hypotheses of a recognition"),
    (plan, {"hypotheses": "boot"}, "hypotheses: must be a sequence of Hypothesis (got 'boot'); give found.hypotheses of a recognition"),
    (plan, {"sensor": 0.5}, "sensor: must be a Sensor (got 0.5); give palpate.Sensor"),
    (plan, {"sensor": None}, "sensor: must be a Sensor (got None); give palpate.Sensor"),
    (plan, {"planner": "best"}, "planner: unknown planner (got 'best'); give \"auto\", \"complete\", \"ellis\", \"grimson\" or \"schneiter\""),
    (plan, {"planner": 3}, "planner: must be a text (got 3); give a str"),
    (plan, {"planner": None}, "planner: must be a text (got None); give a str"),
    (plan, {"stop": "unique"}, "stop: must say when a path is good enough (got 'unique'); give \"perfect\", (\"unique\", 2) or (\"share\", 0.5)"),
    (plan, {"stop": ("unique",)}, "stop: must say when a path is good enough (got ('unique',)); give \"perfect\", (\"unique\", 2) or (\"share\", 0.5)"),
    (plan, {"stop": ("unique", 0)}, "stop: must be a whole number, 1 or more (got 0); give an int in range"),
    (plan, {"stop": ("unique", 1.5)}, "stop: must be a whole number, 1 or more (got 1.5); give an int in range"),
    (plan, {"stop": ("share", 0)}, 'stop: the share must be above 0 and at most 1 (got 0); give ("share", 0.5)'),
    (plan, {"stop": ("share", 1.5)}, 'stop: the share must be above 0 and at most 1 (got 1.5); give ("share", 0.5)'),
    (plan, {"stop": ("share", NAN)}, 'stop: the share must be above 0 and at most 1 (got NaN); give ("share", 0.5)'),
    (plan, {"stop": ("most", 1)}, "stop: must say when a path is good enough (got ('most', 1)); give \"perfect\", (\"unique\", 2) or (\"share\", 0.5)"),
    (plan, {"stop": None}, 'stop: must say when a path is good enough (got None); give "perfect", ("unique", 2) or ("share", 0.5)'),
    (plan, {"workspace": [0, 0, 1, 1]}, "workspace: must have shape (2, 2), has (4,) (got [0, 0, 1, 1]); give an array of shape (2, 2)"),
    (plan, {"workspace": [[0, 0], [0, 1]]}, "workspace: must have an area (got [[0, 0], [0, 1]]); give two opposite corners"),
    (plan, {"workspace": [[0, 0], [NAN, 1]]}, "workspace: must be finite (got [[0, 0], [nan, 1]]); give finite numbers"),
    (plan, {"workspace": [[0, 0, 0], [1, 1, 1]]}, "workspace: must have shape (2, 2), has (2, 3) (got [[0, 0, 0], [1, 1, 1]]); don't mix the plane and space: give an array of shape (2, 2)"),
    (plan, {"workspace": "table"}, "workspace: must be an array of numbers (got 'table'); give an array of shape (2, 2)"),
    (plan, {"directions": (0, 1)}, "directions[0]: must have shape (2,), has () (got 0); give an array of shape (2,)"),
    (plan, {"directions": 3}, "directions: must be a sequence of a direction and a half angle (got 3); give ((dx, dy), half_angle), the angle in radians"),
    (plan, {"directions": ((0, 0), 1)}, "directions: must not point nowhere (got [0, 0]); give ((dx, dy), half_angle), of any length but zero"),
    (plan, {"directions": ((0, 1), 4)}, "directions: the half angle must be from 0 to π (got 4); give radians; π allows all directions"),
    (plan, {"directions": ((0, 1), -1)}, "directions: the half angle must be from 0 to π (got -1); give radians; π allows all directions"),
    (plan, {"directions": ((0, 1), "x")}, "directions[1]: must be a number (got 'x'); give a single int or float"),
    (plan, {"directions": ((0, 1),)}, "directions: must be a direction and a half angle (got ((0, 1),)); give ((dx, dy), half_angle), the angle in radians"),
    (plan, {"time_limit": 0}, "time_limit: must be above zero and finite (got 0); give seconds, or leave it out"),
    (plan, {"time_limit": NAN}, "time_limit: must be above zero and finite (got nan); give seconds, or leave it out"),
    (plan, {"time_limit": "1 s"}, "time_limit: must be a number (got '1 s'); give a single int or float"),
    (plan, {"effort": 0}, "effort: must be a whole number, 1 or more (got 0); give an int in range"),
    (plan, {"effort": 1e6}, "effort: must be a whole number, 1 or more (got 1000000.0); give an int in range"),
    (plan, {"seed": -1}, "seed: must be a whole number, 0 or more (got -1); give an int in range"),
    (plan, {"seed": "x"}, "seed: must be a whole number, 0 or more (got 'x'); give an int in range"),
    (plan, {"features": ()}, 'features: must not be empty (got ()); give ("face",), ("vertex",) or ("face", "vertex")'),
    (plan, {"features": "face"}, "features: must be a sequence of names (got 'face'); give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"),
    (plan, {"features": ("edge",)}, "features: no edges in the plane (got 'edge'); give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"),
    (plan, {"avoid_assigned": 1}, "avoid_assigned: must be True or False (got 1); give a bool"),
    (plan, {"margin": 0}, "margin: is out of range (got 0); give a share of the part's size from 1e-6 to 0.1, such as 1e-3"),
    (plan, {"margin": 0.5}, "margin: is out of range (got 0.5); give a share of the part's size from 1e-6 to 0.1, such as 1e-3"),
    (plan, {"margin": "fine"}, "margin: must be a number (got 'fine'); give a single int or float"),
    (plan, {"cells": 64}, 'cells: the planner has no such grid (got 64); leave it out, or plan with "grimson" or, for cells, "schneiter"'),
    (plan, {"planner": "ellis", "directions_tried": 9}, 'directions_tried: the planner has no such grid (got 9); leave it out, or plan with "grimson" or, for cells, "schneiter"'),
    (plan, {"planner": "schneiter", "directions_tried": 9}, 'directions_tried: the planner has no such grid (got 9); leave it out, or plan with "grimson" or, for cells, "schneiter"'),
    (plan, {"planner": "grimson", "cells": 4}, "cells: must be from 8 to 16384 (got 4); leave it out for the usual grid"),
    (plan, {"planner": "grimson", "directions_tried": 10000}, "directions_tried: must be from 1 to 7200 (got 10000); leave it out for the usual grid"),
    (plan, {"planner": "schneiter", "cells": 5000}, "cells: must be from 8 to 2048 (got 5000); leave it out for the usual grid"),
    (plan, {"planner": "grimson", "cells": "many"}, "cells: must be a whole number, 1 or more (got 'many'); give an int in range"),
    (judge, {"start": (0, 0, 0)}, "start: must have shape (2,), has (3,) (got (0, 0, 0)); don't mix the plane and space: give an array of shape (2,)"),
    (judge, {"start": (0, NAN)}, "start: must be finite (got (0, nan)); give finite numbers"),
    (judge, {"direction": (0, 0)}, "direction: must not be zero (got [0, 0]); give a direction, of any length"),
    (judge, {"direction": 5}, "direction: must have shape (2,), has () (got 5); give an array of shape (2,)"),
    (judge, {"length": 0}, "length: must be above zero and finite (got 0); leave it out to go past the last possible contact"),
    (judge, {"length": -3}, "length: must be above zero and finite (got -3); leave it out to go past the last possible contact"),
    (judge, {"length": NAN}, "length: must be above zero and finite (got NaN); leave it out to go past the last possible contact"),
    (judge, {"length": "far"}, "length: must be a number (got 'far'); give a single int or float"),
    (tree, {"method": "best"}, "method: unknown method (got 'best'); give \"greedy\", \"ahead\" or \"optimal\""),
    (tree, {"method": None}, "method: must be a text (got None); give a str"),
    (tree, {"max_nodes": -1}, "max_nodes: must be a whole number, 0 or more (got -1); give an int in range"),
    (lines, {"angles": 0.5}, "angles: must have shape (n,), has () (got 0.5); give an array of shape (n,)"),
    (lines, {"offsets": [NAN]}, "offsets: must be finite (got [nan]); give finite numbers"),
    (line, {"angle": "x"}, "angle: must be a number (got 'x'); give a single int or float"),
    (line, {"offset": math.inf}, "offset: must be finite (got inf); give a finite number"),
    (verify, {"hypothesis": HANDS}, 'hypothesis: must be a Hypothesis (got [<Hypothesis: "human-hand" at (24.699502, 2.420022), turned 1.330460 rad>, <Hypo…); give one of found.hypotheses'),
    (verify, {"margin": 1}, "margin: is out of range (got 1); give a share of the part's size from 1e-6 to 0.1, such as 1e-3"),
    (space, {"generator": (9, 0)}, "generator: there is no such hypothesis (got (9, 0)); give (hypothesis, face), the hypothesis below 4"),
    (space, {"generator": (0, 99)}, "generator: its part has no such face (got (0, 99)); give a face below 18"),
    (space, {"generator": SENSED}, f"generator: a contact is assigned to the face (got {SENSED}); give one that was not sensed"),
    (space, {"generator": 3}, "generator: must be a sequence of a hypothesis' and a face's number (got 3); give (hypothesis, face)"),
    (space, {"generator": "0,0"}, "generator: must be a sequence of a hypothesis' and a face's number (got '0,0'); give (hypothesis, face)"),
    (space, {"generator": (0,)}, "generator: must be a hypothesis' and a face's number (got (0,)); give (hypothesis, face)"),
    (space, {"generator": (-1, 0)}, "generator[0]: must be a whole number, 0 or more (got -1); give an int in range"),
    (space, {"generator": (0, 1.5)}, "generator[1]: must be a whole number, 0 or more (got 1.5); give an int in range"),
    (space, {"margin": 1}, "margin: is out of range (got 1); give a share of the part's size from 1e-6 to 0.1, such as 1e-3"),
    (overlaps, {"slope": NAN}, "slope: must be finite (got NaN); give a finite number"),
    (overlaps, {"slope": "steep"}, "slope: must be a number (got 'steep'); give a single int or float"),
    (projected, {"slopes": 0.5}, "slopes: must have shape (n,), has () (got 0.5); give an array of shape (n,)"),
    (projected, {"slopes": [math.inf], "of": "outer"}, "slopes: must be finite (got [inf]); give finite numbers"),
    (projected, {"slopes": [[1.0]], "of": "skids"}, "slopes: must have shape (n,), has (1, 1) (got [[1.0]]); give an array of shape (n,)"),
    (outcome_of, {"contact": (1, 2)}, "contact: must be a Contact (got (1, 2)); give palpate.Contact, or None for a miss"),
    (outcome_of, {"contact": palpate.Contact.from_tip((1, 2), 1.0, position_error=0.5)}, "contact: must have the sensor's tip radius 0.0 (got Contact.from_tip((1.0, 2.0), 1.0, position_error=0.5)); make it with Contact.from_tip and that radius"),
    (to_json, {"unit": "parsec"}, "unit: unknown unit 'parsec'; give one of um, mm, cm, m, in, ft"),
    (to_json, {"unit": 3}, "unit: unknown unit '3'; give one of um, mm, cm, m, in, ft"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "arguments", "message"), CASES)
def test_bad_input_is_named_with_its_value_and_the_remedy(call, arguments, message):
    with pytest.raises(ValueError) as caught:
        call(**arguments)
    assert str(caught.value) == message
    assert "\n" not in message


def test_the_table_is_long_enough():
    assert len(CASES) >= 25


def test_the_grid_is_named_where_directions_are_given_too():
    with pytest.raises(ValueError, match=r"^directions_tried: must be from 1 to 7200"):
        plan(planner="grimson", directions=((0, 1), 1.0), directions_tried=10000)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: plan(best=True), "plan.*'best'"),
        (lambda: judge(planner="auto"), "judge.*'planner'"),
        (lambda: tree(way="short"), "plan_tree.*'way'"),
        (lambda: palpate.plan_report(HANDS, SENSOR, method="greedy"), "plan_report.*'method'"),
        (lambda: palpate.Lines(HANDS, SENSOR, effort=3), "Lines.*'effort'"),
        (lambda: verify(avoid_assigned=True), "verification_path.*'avoid_assigned'"),
        (lambda: space(planner="ellis"), "projection_space.*'planner'"),
        (lambda: palpate.Sensor(0.5), "normal_error"),
        (lambda: palpate.plan(HANDS), "sensor"),
    ],
)
def test_missing_and_unknown_arguments_are_named(call, name):
    with pytest.raises(TypeError, match=name):
        call()


def test_a_face_that_cannot_be_touched_is_no_generator():
    outline = [[0, 0], [60, 0], [60, 25], [0, 40]]
    touches = [
        palpate.Contact(point, normal, position_error=0.5, normal_error=0.07)
        for point, normal in (((30, 0), (0, -1)), ((60, 12), (1, 0)))
    ]

    def found(untouchable):
        model = palpate.Model.polygon(outline, untouchable=untouchable)
        return palpate.recognize([model], touches).hypotheses

    with pytest.raises(ValueError, match=r"^generator: the face can't be touched \(got \(0, 2\)\); give"):
        palpate.projection_space(found([2]), SENSOR, (0, 2))
    with pytest.raises(ValueError, match=r"^hypotheses: every face that can be touched has a contact"):
        palpate.projection_space(found([2, 3]), SENSOR)
