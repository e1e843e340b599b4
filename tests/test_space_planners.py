"""The experiment of planners in space, on its first problems."""

import math
import re

import numpy as np
import pytest

import palpate
from palpate.experiments import predictions, space_planners
from palpate.experiments.planning_problems import FAMILIES, planning_problem
from palpate.experiments.space_planners import PLANNERS, markdown, random_best, random_lines, task


@pytest.fixture(scope="module")
def rows():
    return [{"number": k, **task(k, parts=None, digest=0, lines=2000)} for k in (0, 4)]


@pytest.mark.parametrize("number", range(len(FAMILIES)))
def test_problems_are_the_same_again_and_hold_the_truth(number):
    one, again = (planning_problem(number) for _ in range(2))
    assert 2 <= len(one.hypotheses) <= 40
    for each, other in zip(one.hypotheses, again.hypotheses, strict=True):
        assert np.array_equal(each.world_from_model, other.world_from_model)
    assert all(each.proved for each in one.hypotheses)
    assert any(each.poses.contains(one.truth) for each in one.hypotheses)


def test_every_planner_is_there_and_every_promise_holds(rows):
    for row in rows:
        assert tuple(row["planners"]) == PLANNERS
        for found in row["planners"].values():
            assert found["readings"] == found["held"]
            assert found["score"] is None or (found["readings"] > 0 and 1.0 <= found["score"])
        # The planner of first choice is as good as the others and as all random lines here.
        scores = [found["score"] for found in row["planners"].values() if found["score"] is not None]
        assert row["planners"]["auto"]["score"] == min(scores)
        assert row["random"]["score"] >= row["planners"]["auto"]["score"]


def test_lines_are_spread_over_the_ball():
    middle, radius = np.array([1.0, 2.0, 3.0]), 4.0
    random = np.random.default_rng(1)
    directions, points = random_lines(random, middle=middle, radius=radius, count=20_000)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    off = np.linalg.norm(points - middle, axis=1)
    # The points are the feet of the middle; half of them are within the circle of half the area.
    assert np.abs(np.sum((points - middle) * directions, axis=1)).max() < 1e-9
    assert off.max() <= radius and np.median(off) == pytest.approx(radius / math.sqrt(2), rel=0.02)
    assert np.abs(directions.mean(axis=0)).max() < 0.02


def test_the_best_random_line_is_the_best_of_all():
    problem = planning_problem(4)
    lines = palpate.Lines(problem.hypotheses, problem.sensor)
    random = np.random.default_rng(3)
    drawn = random_lines(random, middle=lines.middle, radius=lines.radius, count=1500)
    found = random_best(lines, *drawn)
    assert found["score"] == np.nanmin(lines.scores_through(*drawn))
    assert 0 < found["judged"] < found["may_be_used"] <= 1500


def test_what_readings_may_confuse_is_one_class():
    class Met:
        def __init__(self, depth, normal):
            self.depth, self.normal = depth, np.array(normal, dtype=float)

    sensor = palpate.Sensor(0.5, math.radians(4), 1.0)
    up, side = (0, 0, 1), (1, 0, 0)
    chain = [Met(0.0, up), Met(0.9, up), Met(1.8, up)]
    assert space_planners._entropy(chain, sensor) == 0.0
    assert space_planners._entropy([*chain, Met(0.9, side)], sensor) == pytest.approx(
        -0.75 * math.log(0.75) - 0.25 * math.log(0.25)
    )
    assert space_planners._entropy([None, None, Met(0.0, up)], sensor) == pytest.approx(
        -2 / 3 * math.log(2 / 3) - 1 / 3 * math.log(1 / 3)
    )


def test_tables_name_every_planner(rows):
    text = markdown(rows)
    assert all(f"`{name}`" in text for name in PLANNERS)
    assert "| all random lines |" in text and "| most information gain |" in text
    # No path counts as leaving all.
    rows[0]["planners"]["grimson"] = {"score": None, "readings": 0, "held": 0}
    assert "| `grimson` | 50 % |" in markdown(rows)


def test_a_flattened_square_is_off_by_what_its_tilt_makes_of_the_slope():
    # A square of side 2 whose height is its x: at a slope of 0.1 its sides at x = ±1 are seen 0.1 further in.
    corners = np.array([[-1, -1, -1], [1, -1, 1], [1, 1, 1], [-1, 1, -1]], dtype=float)
    assert palpate.linearization_error(corners, (0.1, 0.0)) == pytest.approx((0.1, 0.4))
    assert palpate.linearization_error(corners, (0.0, 0.0)) == (0.0, 0.0)
    seen = predictions.seen(corners, np.array([0.1, 0.0]))
    assert predictions._apart(seen, corners[:, :2]) == pytest.approx((3.6, 0.4))


def test_predicted_hit_rates_are_those_of_simple_faces():
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], dtype=float)
    assert palpate.predicted_hit_rate(square, (0.3, -0.2)) == pytest.approx(1.0)
    assert palpate.predicted_hit_rate(square[:3], (0.0, 0.0)) == pytest.approx(0.5)
    turned = square @ np.array([[1, -1, 0], [1, 1, 0], [0, 0, 1]]) / math.sqrt(2)
    assert palpate.predicted_hit_rate(turned, (0.0, 0.0)) == pytest.approx(0.5)


@pytest.mark.parametrize("ask", [palpate.linearization_error, palpate.predicted_hit_rate])
@pytest.mark.parametrize(
    ("corners", "slopes", "said"),
    [
        ([[0, 0, 0], [1, 0, 0]], (0, 0), "corners: must be three or more"),
        ([[0, 0], [1, 0], [1, 1]], (0, 0), "corners: must have shape"),
        (np.zeros((3, 3)), (0, math.nan), "slopes: must be finite"),
        (np.zeros((3, 3)), (0, 0, 1), "slopes: must have shape"),
    ],
)
def test_predictions_refuse_what_is_no_polygon(ask, corners, slopes, said):
    with pytest.raises(ValueError, match="^" + re.escape(said)) as refused:
        ask(corners, slopes)
    assert "\n" not in str(refused.value)


def test_no_measured_error_is_above_its_bound_and_hit_rates_are_as_predicted(rows):
    faces = [face for row in rows for face in row["predictions"]["linearized"]]
    assert faces
    assert all(face["measured"] <= face["predicted"] + 1e-9 for face in faces)
    rates = [face for row in rows for face in row["predictions"]["decoupled"]["faces"]]
    assert rates
    for face in rates:
        # Fewer where another face is before it; no more than by chance.
        spread = math.sqrt(face["predicted"] * (1.0 - face["predicted"]) / predictions.NUM_LINES)
        assert face["measured"] <= face["predicted"] + 5.0 * spread + 1e-9
