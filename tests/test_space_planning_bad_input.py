"""Bad input of planning in space, and the plane mixed with it: each gets one line."""

import numpy as np
import pytest
from brackets import bracket, touches
from conftest import hypotheses_of, usual_sensor

import palpate

HANDS = hypotheses_of("human-hand")
FOUND = palpate.recognize([bracket()], touches()[:2]).hypotheses
SENSOR = usual_sensor()
MIXED = "don't mix the plane and space"
DOWN = np.array([0.0, 0.0, -1.0])


def judge(start=(0, 0, 90), direction=DOWN, hypotheses=FOUND):
    return palpate.judge(hypotheses, SENSOR, start, direction)


def plan(hypotheses=FOUND, sensor=SENSOR, **rest):
    return palpate.plan(hypotheses, sensor, **rest)


def refuting(*move):
    return palpate.refuting_moves(FOUND, [move])


def verify(hypothesis=FOUND[0], **rest):
    return palpate.verification_path(hypothesis, SENSOR, **rest)


def sensor(stem):
    return usual_sensor(stem=stem)


BAD = [
    (plan, {"hypotheses": [*FOUND, HANDS[0]]}, f"hypotheses[{len(FOUND)}]: is of dimension 2, the first of the hypotheses of dimension 3", MIXED),
    (plan, {"hypotheses": [HANDS[0], FOUND[0]]}, "hypotheses[1]: is of dimension 3, the first of the hypotheses of dimension 2", MIXED),
    (plan, {"planner": "complete"}, "planner: there is no such planner in space (got 'complete')", 'give "auto"'),
    (plan, {"planner": "ellis"}, "planner: there is no such planner in space (got 'ellis')", 'give "auto"'),
    (plan, {"planner": "best"}, "planner: unknown planner (got 'best')", 'give "auto"'),
    (plan, {"hypotheses": HANDS, "planner": "optimized"}, "planner: there is no such planner in the plane (got 'optimized')", 'give "auto", "complete", "ellis", "grimson" or "schneiter"'),
    (plan, {"hypotheses": HANDS, "sensor": sensor((DOWN, 1, 50))}, "stem: is of space only", "leave it out"),
    (plan, {"sensor": sensor(((0, 0, 1), 0, 1e12))}, "stem: is more than", "models' unit"),
    (plan, {"workspace": [(0, 0), (9, 9)]}, "workspace: must have shape (2, 3), has (2, 2)", MIXED),
    (plan, {"workspace": [(0, 0, 0), (9, 9, 0)]}, "workspace: must have a volume", "opposite corners"),
    (plan, {"hypotheses": HANDS, "workspace": [(0, 0, 0), (9, 9, 9)]}, "workspace: must have shape (2, 2), has (2, 3)", MIXED),
    (plan, {"directions": ((0, 1), 1)}, "directions[0]: must have shape (3,), has (2,)", MIXED),
    (plan, {"directions": ((0, 0, 0), 1)}, "directions: must not point nowhere", "((dx, dy, dz), half_angle)"),
    (plan, {"directions": (1,)}, "directions: must be a direction and a half angle", "((dx, dy, dz), half_angle)"),
    (plan, {"tried": [((0, 0), (0, 1))]}, "tried[0][0]: must have shape (3,), has (2,)", MIXED),
    (plan, {"features": ()}, "features: must not be empty", '"edge"'),
    (plan, {"cells": 64}, "cells: the planner has no such grid", "grimson"),
    (plan, {"planner": "grimson", "cells": 513}, "cells: must be from 8 to 512 (got 513)", "usual grid"),
    (plan, {"planner": "grimson", "directions_tried": 7201}, "directions_tried: must be from 1 to 7200", "usual grid"),
    (plan, {"planner": "schneiter", "cells": 129}, "cells: must be from 8 to 128 (got 129)", "usual grid"),
    (judge, {"start": (0, 0)}, "start: must have shape (3,), has (2,)", MIXED),
    (judge, {"direction": (0, 1)}, "direction: must have shape (3,), has (2,)", MIXED),
    (judge, {"direction": (0, 0, 0)}, "direction: must not be zero", "any length"),
    (judge, {"hypotheses": HANDS}, "start: must have shape (2,), has (3,)", MIXED),
    (lambda: judge().outcome_of(palpate.Contact((1, 2), position_error=1)), {}, "contact: is of the plane; the path is of space", "3 coordinates"),
    (lambda: refuting((0, 0), DOWN, 9, SENSOR, None), {}, "moves[0][0]: must have shape (3,), has (2,)", MIXED),
    (lambda: refuting(DOWN, DOWN, 9, SENSOR, palpate.Contact((1, 2), position_error=1)), {}, "moves[0][4]: must be a contact of space", "contact or None"),
    (verify, {"line": ((0, 0), (0, 1))}, "line[0]: must have shape (3,), has (2,)", MIXED),
    (lambda: palpate.Lines(FOUND, SENSOR).judge(0, 0), {}, "judge: works in the plane only", "judge_through"),
    (lambda: palpate.Lines(FOUND, SENSOR).scores([0], [0]), {}, "scores: works in the plane only", "scores_through"),
    (lambda: palpate.Lines(HANDS, SENSOR).judge_through(DOWN, DOWN), {}, "judge_through: works in space only", "judge or scores"),
    (lambda: palpate.Lines(FOUND, SENSOR).judge_through((0, 0, 0), DOWN), {}, "direction: must not be zero", "any length"),
    (lambda: palpate.Lines(FOUND, SENSOR).scores_through([DOWN], [DOWN, DOWN]), {}, "points: must be as many as directions, which are 1 (got 2)", "one for each"),
    (lambda: palpate.Lines(FOUND, SENSOR).least_scores([DOWN, (0, 0, 0)], [DOWN, DOWN]), {}, "directions[1]: must not be zero", "any length"),
    (lambda: palpate.projection_space(FOUND, SENSOR), {}, "hypotheses[0]: is of a part in space; projection_space works in the plane only", "dimension 2"),
    (sensor, {"stem": 3}, "stem: must be a sequence of a direction, a radius and a length", "(direction, radius, length)"),
    (sensor, {"stem": (DOWN, 1)}, "stem: must be a direction, a radius and a length", "(direction, radius, length)"),
    (sensor, {"stem": ((0, 1), 1, 1)}, "stem[0]: must have shape (3,), has (2,)", MIXED),
    (sensor, {"stem": ((0, 0, 0), 1, 1)}, "stem: its direction must not be zero", "along the rod"),
    (sensor, {"stem": (DOWN, -1, 1)}, "stem: must be a finite number, zero or more (got -1)", "as a length"),
    (sensor, {"stem": (DOWN, 1, 0)}, "stem: its length must be above zero (got 0)", "reaches"),
    (sensor, {"stem": (DOWN, "1", 1)}, "stem[1]: must be a number (got '1')", "float"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "given", "begins", "holds"), BAD)
def test_bad_input_is_refused_with_one_line(call, given, begins, holds):
    with pytest.raises(ValueError) as caught:
        call(**given)
    message = str(caught.value)
    assert message.startswith(begins) and holds in message and "\n" not in message
    assert "(got " in message and ";" in message
