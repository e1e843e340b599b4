"""The closed loop: nothing true is lost, every status is reached, a killed run goes on."""

import itertools
import json
import math
import time
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import pose, usual_sensor
from test_cli import validate

import palpate
import palpate.loop.run
from palpate.experiments import closed_loop
from palpate.loop.acquire import Scans, independent, smallest_width
from palpate.loop.journal import Journal
from palpate.loop.refuted import refuted
from palpate.loop.route import length_of
from palpate.loop.settings import settings_of
from palpate.loop.tightness import GAIN, PATIENCE, Tightness
from palpate.loop.tour import Tour
from palpate.loop.wander import path_error_of, wandering

PARTS = palpate.load_models(list(palpate.part_names()))
EVIDENCE = (palpate.Hit, palpate.Miss, palpate.Skid)
CHOSEN = {
    "prior": None, "contacts": (), "misses": (), "blind": None, "planner": "auto", "stop": "perfect",
    "directions": None, "margin": 1e-3, "effort": 1000, "time_limit": None, "features": None,
    "max_touches": 50, "max_hypotheses": 100, "until": None, "seed": 0, "unit": "mm",
}  # fmt: skip


def placed_at_random(number):
    """One of the bundled parts somewhere in a workspace that is three sizes of it across."""
    model = PARTS[number % len(PARTS)]
    random = np.random.default_rng(number)
    world_from_model = pose(random.uniform(-math.pi, math.pi))
    turned = model.vertices @ world_from_model[:2, :2].T
    half = 1.5 * model.size
    room = 0.05 * model.size
    world_from_model[:2, 2] = random.uniform(
        room - half - turned.min(axis=0), half - room - turned.max(axis=0)
    )
    return model, world_from_model, [[-half, -half], [half, half]]


class Watched:
    """A probe that is watched: guarded moves begin at the tip, free moves never go through."""

    def __init__(self, probe, workspace, *, answers=None):
        self.probe, self.workspace = probe, np.array(workspace, dtype=float)
        self.answers = dict(answers or {})  # number of a question -> what is answered in its place
        self.questions = []
        self.travel = 0.0
        self.at = None
        self.back = None

    @property
    def position(self):
        return self.probe.position

    @property
    def simulation(self):
        return self.probe.simulation

    def made(self, start, end):
        self.probe.made(start, end)

    def touch(self, start, end):
        assert self.at is None or np.array_equal(self.at, start)
        self.questions.append(("touch", np.array(start), np.array(end)))
        reply = self.answers.get(len(self.questions)) or self.probe.touch(start, end)
        self.at = np.array(start) if self.probe.position is None else self.probe.position
        self.back = None if isinstance(reply, palpate.Miss) and self.on_border(end) else np.array(start)
        if isinstance(reply, palpate.Skid):
            self.at = reply.free.end
        self.travel += math.dist(start, self.at)
        return reply

    def move(self, points):
        self.questions.append(("move", np.array(points)))
        way = [self.at, *points]
        self.travel += length_of(way)
        for k, (a, b) in enumerate(itertools.pairwise(way)):
            if k == 0 and self.back is not None:
                assert np.array_equal(b, self.back)  # as it came
            else:
                assert self.on_border(a) and self.on_border(b) and self.on_border((a + b) / 2)
        reply = self.answers.get(len(self.questions)) or self.probe.move(points)
        self.at, self.back = np.array(points[-1]), None
        return reply

    def on_border(self, point):
        low, high = self.workspace
        near = 1e-9 * (high - low).max()
        return bool(
            (np.minimum(np.abs(point - low), np.abs(point - high)) <= near).any()
            and (point >= low - near).all()
            and (point <= high + near).all()
        )


def holds_truth(result, model, world_from_model):
    return any(one.model == model and one.poses.contains(world_from_model) for one in result.hypotheses)


@pytest.mark.parametrize("number", range(27))
def test_the_truth_is_never_lost(number):
    model, world_from_model, workspace = placed_at_random(number)
    noise = ("uniform", "bounds")[number % 2]
    sensor = usual_sensor(tip_radius=2.0 * (number % 3 == 0), path_error=0.3 * (number % 4 == 0))
    simulated = palpate.SimulatedProbe(
        model, world_from_model, sensor, seed=number, noise=noise, overtravel=0.1
    )
    probe = Watched(simulated, workspace)
    result = palpate.identify(PARTS, probe, sensor, workspace)
    assert holds_truth(result, model, world_from_model), result.status
    assert result.status in ("solved", "inseparable")
    assert (result.status == "solved") == (len(result.hypotheses) == 1)
    assert result.touches == sum(kind == "touch" for kind, *_ in probe.questions)
    assert result.travel == pytest.approx(probe.travel)
    # The evidence that is told is the evidence that counted.
    again = palpate.recognize(PARTS, result.contacts, misses=result.misses)
    assert len(again.hypotheses) == len(result.found.recognition.hypotheses)
    assert len(again.hypotheses) == len(result.hypotheses) + len(result.found.refuted)


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
def test_ways_count_where_the_tip_leaves_its_line_by_more_than_the_position_error(noise):
    sensor = usual_sensor(tip_radius=3.0, path_error=1.5)
    for number in range(6):
        model, world_from_model, workspace = placed_at_random(number)
        probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=number, noise=noise)
        result = palpate.identify(PARTS, probe, sensor, workspace)
        assert holds_truth(result, model, world_from_model)
        assert all(contact.start is None for contact in result.contacts)
        assert len(result.misses) == 4 + result.touches


@pytest.mark.parametrize(
    ("position_error", "normal_error_deg", "tip_radius", "count"),
    [(0.5, 4.0, 0.0, 180), (4.0, 5.0, 0.0, 45), (0.5, 4.0, 5.0, 45), (0.5, None, 0.0, 27)],
)
def test_a_tip_that_wanders_by_the_position_error_loses_no_truth(
    position_error, normal_error_deg, tip_radius, count
):
    """A sensor that states no path error, and a tip that leaves every line by the whole position error."""
    normal_error = None if normal_error_deg is None else math.radians(normal_error_deg)
    bounds = {"position_error": position_error, "normal_error": normal_error, "tip_radius": tip_radius}
    sensor, made = usual_sensor(**bounds), usual_sensor(**bounds, path_error=position_error)
    assert sensor.path_error == 0.0
    lost, refuted = [], 0
    for number in range(count):
        problem = closed_loop.problem_of(number, PARTS, PARTS[number % len(PARTS)], sensor=made)
        probe = palpate.SimulatedProbe(
            problem.truth, problem.world_from_truth, made, seed=number, noise="bounds", believed=sensor
        )
        result = palpate.identify(PARTS, probe, sensor, problem.workspace)
        assert result.status in ("solved", "inseparable", "budget")
        lost += [] if problem.kept(result.hypotheses) else [number]
        refuted += len(result.found.refuted)
    assert not lost
    assert refuted or position_error < 4.0


def test_a_path_error_that_is_not_stated_is_the_position_error():
    """Of the sensor, of a contact that states a larger one, of misses; what is stated is kept."""
    model, world_from_model, workspace = placed_at_random(3)
    sensor = usual_sensor(tip_radius=2.0)
    probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=3)
    given = palpate.Miss((900, 900), (910, 900))
    stated = palpate.Miss((900, 900), (910, 900), path_error=0.01)
    result = palpate.identify(PARTS, probe, sensor, workspace, misses=[given, stated])
    border, swept = result.misses[:4], result.misses[4:]
    assert [miss.path_error for miss in border] == [sensor.position_error] * 4
    assert [miss.path_error for miss in swept[:2]] == [sensor.position_error, 0.01]
    assert {miss.path_error for miss in swept[2:]} <= {sensor.position_error}
    for sure in (usual_sensor(path_error=0.01), usual_sensor(path_error=3.0)):
        assert path_error_of(sure) == wandering(sure).path_error == sure.path_error
        assert path_error_of(sure, 9.0) == sure.path_error
    assert path_error_of(sensor, 9.0) == 9.0
    # Paths promise for such a tip.
    told = straight = planned = 0.0
    for number in range(9):
        before = None
        for step in run(number).steps:
            if step.path is not None:
                line = step.path.start, step.path.direction, step.path.length
                both = (wandering(usual_sensor()), usual_sensor())
                margins = [palpate.judge(before, one, *line).margin for one in both]
                planned, told, straight = planned + step.path.margin, told + margins[0], straight + margins[1]
            before = step.hypotheses
    assert planned == told < straight
    # The border is outside of the part, however far the tip may leave it.
    probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=3)
    far = palpate.identify(PARTS, probe, usual_sensor(tip_radius=2.0, path_error=3.0), workspace)
    assert {(miss.tip_radius, miss.path_error) for miss in far.misses[:4]} == {(2.0, 2.0)}


def test_kinds_that_a_path_may_touch_say_nothing_of_scans():
    """A scan with a ball meets corners, whatever kinds paths are to touch."""
    parts = [PARTS[k] for k in (2, 3, 4)]
    sensor = usual_sensor(tip_radius=5.0)
    met_corners = 0
    for number in range(30):
        model, world_from_model, workspace = placed_at_random(9 * number + (2, 3, 4)[number % 3])
        probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=number)
        result = palpate.identify(parts, probe, sensor, workspace, features=("face",))
        assert holds_truth(result, model, world_from_model), (number, result.status)
        truth = [one for one in result.hypotheses if one.model == model]
        met_corners += any(
            kind == "vertex" for one in truth for kind, _ in next(iter(one.interpretations)).assignment
        )
        for path in result.paths:
            kinds = {touch.feature[0] for outcome in path.outcomes for touch in outcome.touches}
            assert kinds <= {"face"}
    assert met_corners > 2


def coarse(number, **settings):
    """A loop in which a path promises more than its contact tells where it is taken as a mere place."""
    sensor = usual_sensor(position_error=4.0, normal_error=math.radians(5), path_error=0.01)
    problem = closed_loop.problem_of(number, PARTS, PARTS[number % len(PARTS)], sensor=sensor)
    return problem, palpate.identify(PARTS, problem.probe, sensor, problem.workspace, **settings)


def test_what_a_path_promised_is_kept_with_coarse_readings():
    """Whatever a path met: none is left that its judge says can't have answered so; no move is in vain."""
    planned = refuted = 0
    for number in [35, *range(900, 940)]:
        problem, result = coarse(number)
        assert problem.kept(result.hypotheses)
        refuted += len(result.found.refuted)
        before = None
        for step in result.steps:
            if step.path is not None and before is not None and step.hypotheses is not None:
                planned += 1
                answered = step.path.outcome_of(
                    step.reply.contact if isinstance(step.reply, palpate.Hit) else None
                )
                models = sorted(before[k].model_number for k in answered)
                left = sorted(one.model_number for one in step.hypotheses)
                assert not step.path.guaranteed or len(left) < len(before)
                assert set(left) <= set(models)
            before = step.hypotheses
    assert planned > 20 and refuted > 5


def test_a_wider_path_error_refutes_less():
    """The same moves and readings, judged by a sensor whose tip may leave its line."""
    problem, result = coarse(35)
    moves = [(step.start, step.end, step.reply) for step in result.steps]
    found = palpate.recognize(problem.models, result.contacts, misses=result.misses).hypotheses
    on_line = refuted(found, moves, problem.sensor)
    wide = palpate.Sensor(4.0, math.radians(5), math.radians(60), 0.0, 200.0)
    assert on_line and not refuted(found, moves, wide)
    assert set(on_line.values()) <= set(range(len(moves)))
    nothing = [(start, end, palpate.AlreadyTouching()) for start, end, _ in moves]
    assert refuted(found, nothing, problem.sensor) == {}


def run(number=0, models=PARTS, sensor=None, probe=None, **settings):
    model, world_from_model, workspace = placed_at_random(number)
    sensor = sensor or usual_sensor()
    probe = probe or palpate.SimulatedProbe(model, world_from_model, sensor, seed=number)
    return palpate.identify(models, probe, sensor, workspace, **settings)


def test_solved():
    result = run(0)
    assert result.status == "solved" and len(result.hypotheses) == 1 and result.until_met is None
    assert result.hypotheses[0].model == PARTS[0] and result.conflict is None
    purposes = [step.purpose for step in result.steps]
    assert purposes == sorted(purposes, key=("scan", "path").index) and "path" in purposes
    assert len(result.paths) == purposes.count("path")
    counts = [len(step.hypotheses) for step in result.steps if step.hypotheses is not None]
    assert counts[0] > 1 and counts[-1] == 1
    assert result.recognition_time > 0 and result.planning_time > 0


def test_inseparable():
    """Two parts that differ by less than any reading tells."""
    corners = np.array([[0, 0], [80, 0], [80, 15], [20, 15], [20, 60], [0, 60]], dtype=float)
    twins = [
        palpate.Model.polygon(corners, name="one"),
        palpate.Model.polygon(corners * 1.0002, name="other"),
    ]
    workspace = [[-120, -120], [120, 120]]
    probe = palpate.SimulatedProbe(twins[0], pose(0.3), usual_sensor())
    result = palpate.identify(twins, probe, usual_sensor(), workspace)
    assert result.status == "inseparable" and result.proved
    assert {one.model.name for one in result.hypotheses} == {"one", "other"}
    assert holds_truth(result, twins[0], pose(0.3))


def test_no_usable_path():
    """A planner that looks only at lines through faces, of which so small an incidence allows none."""
    first = palpate.standard_contacts("boot")
    sensor = usual_sensor(max_incidence=math.radians(1))
    probe = palpate.SimulatedProbe(PARTS[3], np.eye(3), sensor)
    settings = {"contacts": first, "directions": ((0, -1), 0.01), "planner": "ellis"}
    result = palpate.identify(PARTS, probe, sensor, [[-400, -400], [400, 400]], **settings)
    assert result.status == "no_usable_path" and not result.proved and result.touches == 0
    assert holds_truth(result, PARTS[3], np.eye(3))


def test_budget():
    model, world_from_model, _ = placed_at_random(0)
    early = run(0, max_touches=2)
    assert early.status == "budget" and early.touches == 2 and early.contacts
    assert holds_truth(early, model, world_from_model)
    result = run(0, max_touches=3)
    assert result.status == "budget" and result.touches == 3 and len(result.hypotheses) > 1


def test_budget_of_planning():
    corners = np.array([[0, 0], [80, 0], [80, 15], [20, 15], [20, 60], [0, 60]], dtype=float)
    twins = [
        palpate.Model.polygon(corners, name="one"),
        palpate.Model.polygon(corners * 1.0002, name="other"),
    ]
    probe = palpate.SimulatedProbe(twins[0], pose(0.3), usual_sensor())
    result = palpate.identify(twins, probe, usual_sensor(), [[-120, -120], [120, 120]], effort=1)
    assert result.status == "budget" and "planning" in result.reason and len(result.hypotheses) == 2


def test_inseparable_says_that_it_is_not_proved():
    corners = np.array([[0, 0], [80, 0], [80, 15], [20, 15], [20, 60], [0, 60]], dtype=float)
    twins = [palpate.Model.polygon(scale * corners, name=f"times {scale}") for scale in (1.0, 1.0002)]
    probe = palpate.SimulatedProbe(twins[0], pose(0.3), usual_sensor())
    result = palpate.identify(twins, probe, usual_sensor(), [[-120, -120], [120, 120]], planner="grimson")
    assert result.status == "inseparable" and not result.proved and "not proved" in result.reason


@pytest.mark.parametrize("purpose", ["path", "verify"])
def test_a_skid_on_a_planned_path_ends_the_run(purpose):
    model, world_from_model, workspace = placed_at_random(0)
    settings = {"until": (0.1, 1e-3)}
    usual = run(0, **settings)
    place = next(k for k, step in enumerate(usual.steps) if step.purpose == purpose)
    simulated = palpate.SimulatedProbe(model, world_from_model, usual_sensor(), seed=0)

    class Sliding(Watched):
        def touch(self, start, end):
            reply = super().touch(start, end)
            if sum(kind == "touch" for kind, *_ in self.questions) <= place:
                return reply
            short = start + 0.01 * (end - start)
            return palpate.Skid(palpate.Miss(start, short))

    result = palpate.identify(PARTS, Sliding(simulated, workspace), usual_sensor(), workspace, **settings)
    assert result.status == "unexplained" and "skidded" in result.reason
    assert result.touches == place + 1 and result.hypotheses


def test_unexplained():
    """The part is none of the models."""
    result = run(9, models=[PARTS[5]])
    assert result.status == "unexplained" and result.hypotheses == []
    assert len(result.conflict) == 2 and set(result.conflict) <= set(range(len(result.contacts)))


def test_readings_outside_of_their_bounds_are_unexplained_with_a_conflict():
    model, world_from_model, workspace = placed_at_random(1)
    believed = usual_sensor(position_error=0.02, normal_error=math.radians(0.2))
    probe = palpate.SimulatedProbe(
        model, world_from_model, usual_sensor(position_error=3.0), believed=believed, noise="bounds"
    )
    result = palpate.identify([model], probe, believed, workspace, blind=6)
    assert result.status == "unexplained" and result.conflict
    contacts = [result.contacts[k] for k in result.conflict]
    assert palpate.recognize([model], contacts, misses=result.misses).hypotheses == []


def test_nothing_found():
    far = palpate.SimulatedProbe(PARTS[0], pose(0, 1e5, 0), usual_sensor())
    result = run(0, probe=far)
    assert result.status == "nothing_found" and result.contacts == [] and result.found is None
    # Two scans for each of the lines of each subdivision, none from the other side.
    assert result.touches == 2 * (2 ** round(math.log2((result.touches / 2) + 1)) - 1)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (palpate.Fault("no pressure"), "no pressure"),
        (palpate.AlreadyTouching(), "was to begin"),
        (palpate.UnexpectedTouch(np.array([1.0, 2.0])), "[1.0, 2.0]"),
    ],
)
def test_fault(answer, reason):
    model, world_from_model, workspace = placed_at_random(0)

    def simulated():
        return palpate.SimulatedProbe(model, world_from_model, usual_sensor())

    usual = Watched(simulated(), workspace)
    palpate.identify(PARTS, usual, usual_sensor(), workspace)
    for number, (kind, *_) in enumerate(usual.questions, start=1):
        if kind == "move" and isinstance(answer, palpate.AlreadyTouching):
            continue
        probe = Watched(simulated(), workspace, answers={number: answer})
        result = palpate.identify(PARTS, probe, usual_sensor(), workspace)
        assert result.status == "fault" and reason in result.reason
        assert len(probe.questions) == number
        # Each move that was made is evidence; that which failed is not.
        kinds = Counter(type(step.reply) for step in result.steps)
        assert len(result.contacts) == kinds[palpate.Hit]
        assert len(result.misses) == 4 + kinds[palpate.Miss] + kinds[palpate.Skid]
        assert kinds.total() - sum(kinds[kind] for kind in EVIDENCE) == (kind == "touch")
        assert (result.found is not None) == bool(result.contacts)


def test_until_tightens_the_last_hypothesis():
    loose = run(0)
    tight = run(0, until=(2.0, math.radians(0.8)))
    assert tight.status == "solved" and tight.until_met
    assert [step.purpose for step in tight.steps].count("verify") > 0
    last = tight.hypotheses[0]
    assert last.poses.rotation_bound <= math.radians(0.8) < loose.hypotheses[0].poses.rotation_bound
    assert max(last.poses.excursion(vertex) for vertex in last.model.vertices) <= 2.0
    assert run(0, until=(1e-6, 1e-6)).until_met is False


def knob():
    """A plate with corners so round that the tip lies on any of several faces."""
    quarters = np.linspace(0.0, math.pi / 2, 6)
    centers = [(70, 42), (6, 50), (6, 6), (66, 6)]
    outline = [
        (x + 6.0 * math.cos(turn + quarter), y + 6.0 * math.sin(turn + quarter))
        for (x, y), turn in zip(centers, np.arange(4) * math.pi / 2, strict=True)
        for quarter in quarters
    ]
    return palpate.Model.polygon(outline, name="knob", position_slack=0.1, normal_slack=0.16)


def test_contacts_on_small_arcs_do_not_stop_the_loop():
    """They leave thousands of pieces; the pose of largest slack, asked at each step, is soon found."""
    models, place, sensor = [knob()], pose(0.4, 10.0, -20.0), usual_sensor(tip_radius=3.0)
    probe = palpate.SimulatedProbe(models[0], place, sensor, seed=2)
    asked = {"until": (0.01, 0.001), "effort": 2000, "max_touches": 10}
    result = palpate.identify(models, probe, sensor, [[-130, -130], [130, 130]], **asked)
    assert result.status == "budget" and result.touches == 10
    (last,) = palpate.recognize(models, result.contacts, misses=result.misses).hypotheses
    assert last.poses.contains(place)
    began = time.perf_counter()
    assert last.poses.contains(last.world_from_model)
    assert time.perf_counter() - began < 10.0


def test_touches_that_make_nothing_tighter_end_the_run(tmp_path):
    """Without any limit of time, alike each time."""
    log = tmp_path / "run.jsonl"
    number = 44
    model = PARTS[number % len(PARTS)]
    asked = {"models": [model], "until": (0.01, 0.001), "effort": 1000}
    result = run(number, log=log, **asked)
    assert result.status == "budget" and result.until_met is False
    assert f"the last {PATIENCE} touches made its poses no tighter" in result.reason
    assert [step.purpose for step in result.steps[-PATIENCE:]] == ["verify"] * PATIENCE
    before, *later = [step.hypotheses[0].poses for step in result.steps[-PATIENCE - 1 :]]
    shifts = [max(poses.excursion(corner) for corner in model.vertices) for poses in (before, *later)]
    assert min(shifts[1:]) >= (1.0 - GAIN) * shifts[0]
    assert min(poses.rotation_bound for poses in later) >= (1.0 - GAIN) * before.rotation_bound
    again = run(number, **asked)
    assert (again.touches, again.reason) == (result.touches, result.reason)
    assert palpate.replay(log).reason == result.reason


def test_touches_in_vain_are_counted_from_the_last_that_told():
    def last(shift, turn):
        poses = SimpleNamespace(rotation_bound=turn, excursion=lambda vertex: shift)
        return SimpleNamespace(poses=poses, model=SimpleNamespace(vertices=[(0, 0)]))

    told = Tightness((1.0, 0.1))
    assert not told.in_vain(last(4.0, 0.2))
    assert [told.in_vain(last(4.1, 0.2)) for _ in range(PATIENCE - 1)] == [False] * (PATIENCE - 1)
    assert not told.in_vain(last(4.1, 0.15)), "the turn is less"
    assert [told.in_vain(last(3.97, 0.15)) for _ in range(PATIENCE)] == [False] * (PATIENCE - 1) + [True]
    assert not told.reached(last(0.9, 0.11)) and told.reached(last(0.9, 0.1))
    small = Tightness((1.0, 0.1))
    assert not small.in_vain(last(4.0, 0.05))
    turns = [0.04 / (k + 1) for k in range(PATIENCE)]
    assert [small.in_vain(last(4.0, turn)) for turn in turns][-1], "the turn was small enough"


def test_a_time_limit_holds_for_recognition_and_planning_together(monkeypatch, tmp_path):
    """Of a recognition that takes longer nothing is planned."""
    recognize, log = palpate.loop.run.recognize, tmp_path / "run.jsonl"

    def slow(*arguments, **settings):
        time.sleep(0.3)
        return recognize(*arguments, **settings)

    monkeypatch.setattr(palpate.loop.run, "recognize", slow)
    assert run(0, time_limit=60.0).status == "solved"
    for settings in ({"log": log}, {"until": (0.01, 0.001)}):
        result = run(0, time_limit=0.25, **settings)
        assert result.status == "budget" and "cut short" in result.reason
        assert {step.purpose for step in result.steps} == {"scan"} and len(result.hypotheses) > 1
    monkeypatch.undo()
    assert palpate.replay(log).reason == run(0, time_limit=1e-9).reason
    short = run(1, time_limit=1e-9, until=(1.0, 0.01), models=[PARTS[1]])
    assert short.status == "budget" and len(short.hypotheses) == 1


def test_blind_contacts():
    few, many = run(0), run(0, blind=8)
    assert [step.purpose for step in many.steps].count("scan") > [step.purpose for step in few.steps].count(
        "scan"
    )
    assert len([contact for contact in many.contacts if contact.normal is not None]) >= 8
    assert many.travel > few.travel


def test_contacts_given_by_the_user_are_not_acquired_again():
    model, world_from_model, _ = placed_at_random(0)
    drawn = palpate.random_contacts(model, world_from_model, usual_sensor(), seed=4)
    result = run(0, contacts=drawn)
    assert result.status == "solved" and all(step.purpose == "path" for step in result.steps)
    assert result.contacts[:2] == drawn and holds_truth(result, model, world_from_model)


def test_without_normals():
    model, world_from_model, workspace = placed_at_random(0)
    sensor = usual_sensor(normal_error=None, position_error=0.05)
    prior = palpate.Prior(world_from_model, translation=20.0, rotation=0.3)
    probe = palpate.SimulatedProbe(model, world_from_model, sensor)
    result = palpate.identify([model], probe, sensor, workspace, prior=prior)
    assert len(result.contacts) >= 4 and holds_truth(result, model, world_from_model)


def test_too_many_hypotheses_call_for_more_scans():
    usual, few = run(0), run(0, max_hypotheses=2)
    assert [step.purpose for step in few.steps].count("scan") > [step.purpose for step in usual.steps].count(
        "scan"
    )
    assert few.status == "solved"


def test_same_input_same_run():
    def told(result):
        return [(step.start.tolist(), step.end.tolist(), step.reply) for step in result.steps], result.travel

    assert told(run(0)) == told(run(0)) != told(run(9))


def test_every_step_is_told_once():
    steps = []
    result = run(0, told=steps.append)
    assert steps == result.steps


# Acquisition


def test_scans_subdivide_the_workspace():
    scans = Scans(np.array([[0.0, 0.0], [80.0, 40.0]]), 20.0)
    made = []
    while (scan := scans.next(20.0)) is not None:
        made.append((scan.start.tolist(), scan.end.tolist()))
        scans.made(missed=len(made) == 2)
    assert made[:3] == [([0, 20], [80, 20]), ([40, 0], [40, 40]), ([80, 20], [0, 20])]
    assert made[3:7] == [([0, 10], [80, 10]), ([0, 30], [80, 30]), ([20, 0], [20, 40]), ([60, 0], [60, 40])]
    # The line in y that was free is not scanned from the other side.
    assert ([40, 40], [40, 0]) not in made and len(made) == 3 + 8


def test_scans_end_at_the_smallest_width():
    strip = palpate.Model.polygon([[0, 0], [100, 0], [100, 7], [0, 7]])
    assert smallest_width([PARTS[0], strip]) == pytest.approx(7)
    turned = palpate.Model.polygon(np.array([[0, 0], [100, 0], [100, 7], [0, 7]]) @ pose(0.6)[:2, :2].T)
    assert smallest_width([turned]) == pytest.approx(7)
    assert smallest_width([palpate.Model.segments([[[0, 0], [32, 0]]])]) == 2.0
    scans = Scans(np.array([[0.0, 0.0], [100.0, 100.0]]), 7.0)
    last = None
    while (scan := scans.next(7.0)) is not None:
        last = scan
        scans.made(missed=True)
    assert last.width <= 7.0 < 2.0 * last.width


def test_scans_keep_to_the_directions():
    scans = Scans(np.array([[0.0, 0.0], [80.0, 80.0]]), 20.0, ((0, -1), 0.5))
    starts = []
    while (scan := scans.next(20.0)) is not None:
        starts.append(scan.start.tolist())
        scans.made(missed=False)
    assert starts == [[40, 80], [20, 80], [60, 80]]


def test_acquisition_stops_at_independent_normals():
    def contact(angle):
        normal = (math.cos(angle), math.sin(angle))
        return palpate.Contact((0, 0), normal, position_error=0.5, normal_error=math.radians(4))

    for apart, expected in (
        (0, False),
        (22, False),
        (24, True),
        (90, True),
        (156, True),
        (158, False),
        (180, False),
    ):
        assert independent([contact(0.4), contact(0.4 + math.radians(apart))]) == expected
    result = run(0)
    scanned = [
        step.reply.contact
        for step in result.steps
        if step.purpose == "scan" and hasattr(step.reply, "contact")
    ]
    assert independent(scanned) and not independent(scanned[:-1])


def test_random_contacts_lie_on_the_part():
    for k, model in enumerate(PARTS):
        for radius in (0.0, 2.0):
            sensor = usual_sensor(tip_radius=radius)
            contacts = palpate.random_contacts(model, pose(k), sensor, count=3, seed=k)
            assert len(contacts) == 3 and independent(contacts)
            found = palpate.recognize([model], contacts)
            assert any(one.poses.contains(pose(k)) for one in found.hypotheses)
    assert palpate.random_contacts(PARTS[0], pose(0), usual_sensor(), seed=1) == palpate.random_contacts(
        PARTS[0], pose(0), usual_sensor(), seed=1
    )
    with pytest.raises(ValueError, match="count"):
        palpate.random_contacts(PARTS[0], pose(0), usual_sensor(), count=0)


def test_routes_go_the_shorter_way_round():
    area = [[0, 0], [10, 4]]

    def route(start, end):
        return [point.tolist() for point in palpate.perimeter_route(area, start, end)]

    assert route((0, 2), (10, 2)) == [[0, 0], [10, 0], [10, 2]]  # both as long: counter-clockwise
    assert route((0, 3), (10, 3)) == [[0, 4], [10, 4], [10, 3]]
    assert route((2, 0), (7, 0)) == [[7, 0]] and route((2, 0), (2, 0)) == []
    assert route((0, 0), (10, 4)) == [[10, 0], [10, 4]]
    for name, ends in (("start", ((5, 2), (0, 0))), ("end", ((0, 0), (11, 2)))):
        with pytest.raises(ValueError, match=f"{name}: must be on the perimeter"):
            palpate.perimeter_route(area, *ends)


# Logs

UNTIL = (3.0, math.radians(1.5))


@pytest.fixture
def logged(tmp_path):
    path = tmp_path / "run.jsonl"
    return path, run(18, log=path, until=UNTIL)


def same(a, b):
    def told(result):
        steps = [(s.purpose, s.start.tolist(), s.end.tolist(), s.reply, s.path) for s in result.steps]
        poses = [one.world_from_model.tolist() for one in result.hypotheses]
        return steps, poses, result.contacts, result.misses, result.status, result.reason, result.travel

    return told(a) == told(b)


def test_every_line_of_a_log_is_of_its_schema(logged):
    path, result = logged
    events = [json.loads(line) for line in path.read_text().splitlines()]
    for event in events:
        validate(event, "run-1")
    assert events[0]["event"] == "start" and events[-1]["event"] == "end"
    assert sum(event["event"] == "touch" for event in events) == result.touches
    assert {event["event"] for event in events} == {
        "start",
        "move",
        "touch",
        "reply",
        "recognized",
        "planned",
        "end",
    }


def test_a_run_that_was_killed_anywhere_goes_on(logged, tmp_path):
    path, result = logged
    text = path.read_bytes()
    ends = [0, *itertools.accumulate(len(line) for line in text.splitlines(keepends=True))]
    cut = tmp_path / "cut.jsonl"
    for place in [*ends, *(end + 9 for end in ends[:-1:3])]:
        cut.write_bytes(text[:place])
        again = run(18, log=cut, until=UNTIL, resume=True)
        assert same(again, result)
        assert cut.read_bytes() == text


def test_errors_of_a_move_that_is_made_again_survive_a_kill(tmp_path):
    """The same move four times: it has other errors each time, also if the first ones are in the log."""
    model, world_from_model, workspace = placed_at_random(18)
    sensor = usual_sensor(position_error=3.0, normal_error=math.radians(8))

    def repeated(journal):
        probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=18)
        tour = Tour(settings_of(PARTS, sensor, workspace, **CHOSEN), probe, journal, position=None)
        middle = float(world_from_model[1, 2])
        line = np.array([workspace[0][0], middle]), np.array([workspace[1][0], middle])
        replies = []
        for _ in range(4):
            replies.append(tour.touch(*line, "path"))
            tour.go_to(line[0])
        return replies

    log = tmp_path / "moves.jsonl"
    with log.open("wb") as file:
        whole = repeated(Journal((), file))
    assert len({str(reply) for reply in whole}) == 4
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    for count in range(len(lines)):
        assert repeated(Journal(lines[:count])) == whole


def test_another_simulation_is_refused(logged, tmp_path):
    path, _ = logged
    model, world_from_model, _ = placed_at_random(18)
    sensor = usual_sensor()
    moved = world_from_model.copy()
    moved[0, 2] += 1.0
    others = {
        "truth": palpate.SimulatedProbe(PARTS[1], world_from_model, sensor, seed=18),
        "pose": palpate.SimulatedProbe(model, moved, sensor, seed=18),
        "noise": palpate.SimulatedProbe(model, world_from_model, sensor, seed=18, noise="bounds"),
        "overtravel": palpate.SimulatedProbe(model, world_from_model, sensor, seed=18, overtravel=0.1),
        "seed": palpate.SimulatedProbe(model, world_from_model, sensor, seed=19),
    }
    for probe in others.values():
        with pytest.raises(ValueError, match="simulation: is not that of the log"):
            run(18, log=path, until=UNTIL, resume=True, probe=probe)


def test_replies_in_the_log_are_not_asked_again(logged):
    path, result = logged
    model, world_from_model, workspace = placed_at_random(18)
    probe = Watched(palpate.SimulatedProbe(model, world_from_model, usual_sensor(), seed=18), workspace)
    again = run(18, log=path, until=UNTIL, resume=True, probe=probe)
    assert probe.questions == [] and same(again, result)


def test_the_tip_is_taken_up_where_it_was_left(logged, tmp_path):
    """Killed on a free move or on a guarded one: it goes on from there, or back as it came."""
    path, result = logged
    lines = path.read_bytes().splitlines(keepends=True)
    model, world_from_model, _ = placed_at_random(18)
    cut = tmp_path / "cut.jsonl"
    asked = [k for k, line in enumerate(lines) if json.loads(line)["event"] in ("move", "touch")]
    for k in asked[1:]:
        event = json.loads(lines[k])
        cut.write_bytes(b"".join(lines[: k + 1]))
        if event["event"] == "touch":
            stopped = np.array(event["start"]) + 0.01 * np.subtract(event["end"], event["start"])
        else:
            stopped = np.array(event["points"][0])
        probe = palpate.SimulatedProbe(model, world_from_model, usual_sensor(), seed=18, position=stopped)
        assert same(run(18, log=cut, until=UNTIL, resume=True, probe=probe), result)
        cut.write_bytes(b"".join(lines[: k + 1]))
        lost = palpate.SimulatedProbe(model, world_from_model, usual_sensor(), seed=18, position=(9e3, 9e3))
        with pytest.raises(ValueError, match="probe: its tip is at"):
            run(18, log=cut, until=UNTIL, resume=True, probe=lost)


def test_replay(logged, tmp_path):
    path, result = logged
    assert same(palpate.replay(path), result)
    lines = path.read_bytes().splitlines(keepends=True)
    cut = tmp_path / "cut.jsonl"
    for k in range(1, len(lines)):
        cut.write_bytes(b"".join(lines[:k]))
        part = palpate.replay(cut)
        assert part.status == "interrupted" and part.touches <= result.touches
        assert all(np.array_equal(a.start, b.start) for a, b in zip(part.steps, result.steps, strict=False))


def test_logs_keep_models_and_settings(tmp_path):
    """Holes, loose edges, slacks, prior, evidence of before: a replay has them all."""
    plate = palpate.Model.polygon(
        [[0, 0], [90, 0], [90, 60], [0, 50]], holes=[[[20, 20], [30, 20], [30, 30]]], position_slack=0.1,
        normal_slack=0.01, untouchable=[2], name="plate",
    )  # fmt: skip
    loose = palpate.Model.segments([[[0, 0], [50, 0]], [[50, 0], [50, 9]]], seams=[1], name="loose")
    sensor = palpate.Sensor(0.3, 0.05, 1.1, 1.5, 0.2)
    world_from_model = pose(0.2, 5, 5)
    prior = palpate.Prior(world_from_model, translation=30.0, rotation=0.7)
    misses = [palpate.Miss((-150, -150), (-150, 150), tip_radius=1.0)]
    log = tmp_path / "run.jsonl"
    result = palpate.identify(
        [plate, loose], palpate.SimulatedProbe(plate, world_from_model, sensor, position=(-300, -300)),
        sensor, [[-200, -200], [200, 200]], prior=prior, misses=misses, blind=3, stop=("unique", 1),
        margin=2e-3, effort=5000,
        features=("face", "vertex"), max_touches=30, max_hypotheses=50, until=(3.0, 0.1), seed=5,
        directions=((1, 0), 3.1), unit="cm", log=log,
    )  # fmt: skip
    validate(json.loads(log.read_text().splitlines()[0]), "run-1")
    assert same(palpate.replay(log), result) and holds_truth(result, plate, world_from_model)


def test_logs_are_not_overwritten_and_not_mistaken(logged, tmp_path):
    path, _ = logged
    with pytest.raises(ValueError, match=r"log: .* is there already"):
        run(18, log=path)
    with pytest.raises(ValueError, match="settings: is not that of the log"):
        run(18, log=path, resume=True)
    with pytest.raises(ValueError, match="models: is not that of the log"):
        run(18, models=PARTS[:2], log=path, resume=True, until=UNTIL)
    with pytest.raises(ValueError, match="no folder"):
        run(18, log=tmp_path / "missing" / "run.jsonl")
    with pytest.raises(ValueError, match="no file"):
        palpate.replay(tmp_path / "missing.jsonl")
    other = tmp_path / "other.jsonl"
    for text, problem in (
        ("", "empty"),
        ("[]\n", "line 1 is no event"),
        ('{"event": "start"}\n', "palpate-run"),
    ):
        other.write_text(text)
        with pytest.raises(ValueError, match=problem):
            palpate.replay(other)


# Bad input


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"models": []}, "models: must not be empty"),
        ({"models": ["boot"]}, r"models\[0\]"),
        ({"contacts": [1]}, r"contacts\[0\]"),
        ({"misses": [1]}, r"misses\[0\]"),
        ({"blind": 0}, "blind"),
        ({"max_touches": 0}, "max_touches"),
        ({"max_touches": 2.5}, "max_touches"),
        ({"max_hypotheses": 0}, "max_hypotheses"),
        ({"seed": -1}, "seed"),
        ({"until": 3}, "until"),
        ({"until": (0, 1)}, "until"),
        ({"directions": 3}, "directions"),
        ({"unit": "ell"}, "unit"),
        ({"planner": "best"}, "planner"),
        ({"stop": "soon"}, "stop"),
        ({"margin": 1.0}, "margin"),
        ({"time_limit": -1}, "time_limit"),
        ({"features": ("edge",)}, "features"),
        ({"sensor": 3}, "sensor"),
        ({"probe": 3}, "probe"),
    ],
)
def test_bad_input(settings, message):
    with pytest.raises(ValueError, match=message):
        run(0, **settings)


@pytest.mark.parametrize("workspace", [3, [[0, 0], [0, 5]], [[0, 0], [1, math.nan]], [[0, 0, 0], [1, 1, 1]]])
def test_bad_workspaces(workspace):
    probe = palpate.SimulatedProbe(PARTS[0], pose(0), usual_sensor())
    with pytest.raises(ValueError, match="workspace: must be two opposite corners"):
        palpate.identify(PARTS, probe, usual_sensor(), workspace)


def test_a_tip_inside_of_the_workspace_is_refused():
    model, world_from_model, _ = placed_at_random(0)
    probe = palpate.SimulatedProbe(model, world_from_model, usual_sensor(), position=(0, 0))
    with pytest.raises(ValueError, match="in the workspace; bring it to the border"):
        run(0, probe=probe)


def test_a_probe_that_answers_nonsense_is_named():
    class Broken:
        position = None

        def touch(self, start, end):
            return 3

        def move(self, points):
            return None

    with pytest.raises(ValueError, match="probe: answered 3"):
        run(0, probe=Broken())
