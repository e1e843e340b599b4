"""The core's judge is never more optimistic than sampled poses and another library's ray casting."""

import itertools
import math

import numpy as np
import pytest
from casting import Placed
from conftest import pose
from shapely.geometry import Point

import palpate

NUM_POSES = 16
NEAR = 1e-3  # what shapely's arcs may be off, and rounding
ERROR, TURN = 0.5, math.radians(4)


def parts():
    return palpate.load_models(list(palpate.part_names())[:6])


def random_contacts(random, model, world_from_model):
    """Two contacts on different faces, with errors inside their bounds."""
    rotation, shift = world_from_model[:2, :2], world_from_model[:2, 2]
    contacts = []
    for face in random.choice(len(model.faces), 2, replace=False):
        start, end = model.faces[face]
        point = start + random.uniform(0.1, 0.9) * (end - start)
        noise = random.uniform(-1, 1, 2) * ERROR / 2
        angle = math.atan2(*model.face_normals[face][::-1]) + random.uniform(-1, 1) * TURN
        normal = rotation @ [math.cos(angle), math.sin(angle)]
        center = rotation @ point + shift + noise
        contacts.append(palpate.Contact(center, normal, position_error=ERROR, normal_error=TURN))
    return contacts


def problem(seed):
    """Hypotheses of two random contacts, and a random sensor."""
    models = parts()
    random = np.random.default_rng(seed)
    while True:
        model = models[random.integers(len(models))]
        world_from_model = pose(random.uniform(-3, 3), *random.uniform(-50, 50, 2))
        found = palpate.recognize(models, random_contacts(random, model, world_from_model))
        if 2 <= len(found.hypotheses) <= 9:
            break
    sensor = palpate.Sensor(
        random.choice([0.2, 0.5]),
        random.choice([None, TURN, TURN]),
        math.radians(random.choice([45, 60, 80])),
        tip_radius=[0.0, 2.0][seed % 2],
        path_error=random.choice([0.0, 0.3]),
    )
    return random, found.hypotheses, sensor


def usable_paths(random, hypotheses, sensor):
    """The planner's path, and some random ones that can be used."""
    planned = palpate.plan(hypotheses, sensor, effort=2000)
    paths = [] if planned is None else [planned]
    lines = palpate.Lines(hypotheses, sensor)
    for _ in range(60):
        path = lines.judge(random.uniform(-3.14, 3.14), random.uniform(-0.9, 0.9) * lines.radius)
        if path.fault is None and len(path.classes) > 1:
            paths.append(path)
    return paths[:7]


def readings(random, placed, path, sensor):
    """First touches with the tip on its line, and on either side of it."""
    left = np.array([-path.direction[1], path.direction[0]])
    for aside in {0.0, sensor.path_error, -sensor.path_error, random.uniform(-1, 1) * sensor.path_error}:
        yield aside, placed.first(path.start + aside * left, path.direction)


def check_outcome(outcome, reading, sensor):
    """The reading is one that the outcome foresees, and it is reliable."""
    if reading is None:
        assert outcome.may_miss
        return
    depth, feature, normal, incidence = reading
    assert incidence <= sensor.max_incidence + NEAR
    angle = math.atan2(normal[1], normal[0])
    assert any(
        touch.feature == feature
        and touch.depth[0] - NEAR <= depth <= touch.depth[1] + NEAR
        and off_arc(angle, touch.normals) <= NEAR
        for touch in outcome.touches
    ), (feature, depth, angle, outcome)


def off_arc(angle, arc):
    middle, half = (arc[0] + arc[1]) / 2, (arc[1] - arc[0]) / 2
    return max(0.0, abs(math.remainder(angle - middle, math.tau)) - half)


def same(a, b, sensor):
    """Whether one reading of the sensor fits both, by a little."""
    if a is None or b is None:
        return a is b
    close = abs(a[0] - b[0]) <= 2 * sensor.position_error - NEAR
    if sensor.normal_error is None:
        return close
    turn = math.acos(min(1.0, max(-1.0, float(a[2] @ b[2]))))
    return close and turn <= 2 * sensor.normal_error - NEAR


def noisy(random, path, aside, *, reading, sensor):
    """The reading as the sensor may give it."""
    depth, _, normal, _ = reading
    left = np.array([-path.direction[1], path.direction[0]])
    error = (
        sensor.position_error
        * random.uniform()
        * np.array([math.cos(a := random.uniform(0, 6.3)), math.sin(a)])
    )
    center = path.start + aside * left + depth * path.direction + error
    sensed = {}
    if sensor.normal_error is not None:
        angle = math.atan2(normal[1], normal[0]) + random.uniform(-1, 1) * sensor.normal_error
        sensed = {"normal": (math.cos(angle), math.sin(angle)), "normal_error": sensor.normal_error}
    return palpate.Contact.from_tip(center, sensor.tip_radius, position_error=sensor.position_error, **sensed)


@pytest.mark.parametrize("seed", range(40))
def test_the_judge_is_never_more_optimistic(seed):
    random, hypotheses, sensor = problem(seed)
    placed = [
        [Placed(h.model, world, sensor.tip_radius) for world in h.poses.sample(NUM_POSES, seed=seed)]
        for h in hypotheses
    ]
    for path in usable_paths(random, hypotheses, sensor):
        seen = [
            [reading for one in poses for reading in readings(random, one, path, sensor)] for poses in placed
        ]
        for k, outcome in enumerate(path.outcomes):
            for aside, reading in seen[k]:
                check_outcome(outcome, reading, sensor)
                answer = (
                    None if reading is None else noisy(random, path, aside, reading=reading, sensor=sensor)
                )
                left = path.outcome_of(answer)
                # What was promised: the truth is left, and nothing of another class.
                assert k in left
                assert set(left) <= set(next(members for members in path.classes if k in members))
        outcomes = path.outcomes
        for a, b in itertools.combinations(range(len(seen)), 2):
            if not apart(outcomes[a], outcomes[b], sensor):
                continue
            assert not any(same(one, other, sensor) for _, one in seen[a] for _, other in seen[b])
        for poses in placed:
            assert not any(one.grown.intersects(Point(path.start)) for one in poses)


def test_the_score_is_that_of_pairs_whose_outcomes_are_apart():
    for seed in range(8):
        random, hypotheses, sensor = problem(100 + seed)
        for path in usable_paths(random, hypotheses, sensor):
            n = len(hypotheses)
            left = sum(not apart(a, b, sensor) for a in path.outcomes for b in path.outcomes)
            assert path.score == pytest.approx(left / n, abs=1e-12)
            assert path.guaranteed == (path.score < n)
            assert path.no_contact == [k for k, outcome in enumerate(path.outcomes) if outcome.may_miss]
            assert 1.0 <= path.expected_score <= n


def apart(a, b, sensor):
    """By the ranges that the outcomes tell (DESIGN's definition, written anew)."""
    if a.may_miss and b.may_miss:
        return False
    for one in a.touches:
        for other in b.touches:
            gap = max(one.depth[0] - other.depth[1], other.depth[0] - one.depth[1])
            turned = (
                sensor.normal_error is not None
                and arc_gap(one.normals, other.normals) > 2 * sensor.normal_error
            )
            if gap <= 2 * sensor.position_error and not turned:
                return False
    return True


def arc_gap(a, b):
    middles = math.remainder((a[0] + a[1]) / 2 - (b[0] + b[1]) / 2, math.tau)
    return abs(middles) - (a[1] - a[0]) / 2 - (b[1] - b[0]) / 2
