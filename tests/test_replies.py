"""Probes that raise, answer nonsense, or answer what can't be: a fault with what was found, or a line."""

import json
import math

import numpy as np
import pytest
from conftest import pose, usual_sensor
from test_cli import validate

import palpate
from palpate.cli import main
from palpate.loop.refuted import GRANTED, refuted

AREA = [[-150.0, -150.0], [150.0, 150.0]]
PARTS = palpate.load_models(["boot", "camera"])
PLACE = pose(0.4, 12.0, -7.0)
BOUNDS = {"position_error": 0.5, "normal_error": 0.07}


class Altered:
    """A simulated probe, one of whose answers is another."""

    def __init__(self, number, answer, *, of="touch"):
        self.probe = palpate.SimulatedProbe(PARTS[0], PLACE, usual_sensor(), seed=1)
        self.number, self.answer, self.of = number, answer, of
        self.asked = {"touch": 0, "move": 0, "position": 0}

    def _answers(self, kind, usual, *arguments):
        self.asked[kind] += 1
        if kind == self.of and self.asked[kind] == self.number:
            return self.answer(*arguments) if callable(self.answer) else self.answer
        return usual(*arguments)

    @property
    def position(self):
        return self._answers("position", lambda: self.probe.position)

    def touch(self, start, end):
        return self._answers("touch", self.probe.touch, np.array(start), np.array(end))

    def move(self, points):
        return self._answers("move", self.probe.move, points)


def run(probe, **settings):
    return palpate.identify(PARTS, probe, usual_sensor(), AREA, seed=1, **settings)


def burn(*_):
    raise RuntimeError("arm on fire")


@pytest.mark.parametrize(("number", "of"), [(1, "touch"), (3, "touch"), (1, "move"), (3, "position")])
def test_what_a_probe_raises_is_a_fault(tmp_path, number, of):
    log = tmp_path / "run.jsonl"
    result = run(Altered(number, burn, of=of), log=log)
    assert result.status == "fault" and result.reason.endswith("it raised RuntimeError: arm on fire")
    assert palpate.replay(log).reason == result.reason
    for line in log.read_text().splitlines():
        validate(json.loads(line), "run-1")
    assert (result.found is not None) == bool(result.contacts)


def test_what_ends_the_program_is_not_the_probes():
    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(Altered(1, stop))


@pytest.mark.parametrize(
    "answer",
    [
        palpate.Hit(None),
        palpate.Skid(None),
        palpate.Hit(palpate.Miss((0, 0), (1, 1))),
        palpate.Skid(palpate.Hit(None)),
        palpate.Hit,
        "hit",
    ],
)
def test_what_is_no_reply_is_named(answer):
    with pytest.raises(ValueError, match="probe: answered"):
        run(Altered(1, lambda *_: answer))


def normal_to(start, end):
    way = (end - start) / np.hypot(*(end - start))
    return np.array([-way[1], way[0]])


def touched(at, **more):
    return palpate.Hit(palpate.Contact(at, (-1, 0), **BOUNDS, **more))


@pytest.mark.parametrize(
    "answer",
    [
        lambda start, end: touched((5000, 5000)),
        lambda start, end: touched((1e12, 0)),
        lambda start, end: touched(start - 50.0 * (end - start) / np.hypot(*(end - start))),
        lambda start, end: touched(end + 50.0 * (end - start) / np.hypot(*(end - start))),
        lambda start, end: touched((start + end) / 2, start=start + 40.0 * normal_to(start, end)),
        lambda start, end: palpate.Miss(start, start),
        lambda start, end: palpate.Miss(start, (start + end) / 2),
        lambda start, end: palpate.Miss((0, 0), (1, 1)),
        lambda start, end: palpate.Skid(palpate.Miss(start, end + 3.0 * (end - start))),
    ],
)
def test_answers_that_can_not_be_of_their_move_are_faults(tmp_path, answer):
    log = tmp_path / "run.jsonl"
    result = run(Altered(2, answer), log=log)
    assert result.status == "fault" and "impossible" in result.reason and result.touches == 2
    assert len(result.contacts) + len(result.misses) == 4 + 1, "it is no evidence"
    assert palpate.replay(log).reason == result.reason


def test_readings_that_are_only_out_of_bounds_are_no_faults():
    def five_off(start, end):
        contact = palpate.SimulatedProbe(PARTS[0], PLACE, usual_sensor(), seed=1).touch(start, end).contact
        return palpate.Hit(palpate.Contact(contact.center + 5.0, contact.normal, **BOUNDS))

    assert run(Altered(1, five_off)).status == "unexplained"


# One more touch


def found():
    result = run(Altered(0, None))
    return result.hypotheses[0]


def test_the_search_for_one_more_touch_keeps_to_its_limits():
    one = found()
    whole = palpate.verification_report(one, usual_sensor(), workspace=AREA)
    assert whole.why == "searched" and whole.num_judged > 1 and not whole.proved
    assert palpate.verification_report(one, usual_sensor(), workspace=AREA, effort=1).why == "effort"
    late = palpate.verification_report(one, usual_sensor(), workspace=AREA, time_limit=1e-9)
    assert late.why == "time" and late.path is None
    again = palpate.verification_path(one, usual_sensor(), line=(whole.path.start, whole.path.direction))
    told = [(p.start.tolist(), p.direction.tolist(), p.length, p.margin) for p in (again, whole.path)]
    assert told[0] == told[1]
    assert palpate.verification_path(one, usual_sensor(), line=((900, 900), (1, 0))) is None
    with pytest.raises(ValueError, match="direction: must not be zero"):
        palpate.verification_path(one, usual_sensor(), line=((900, 900), (0, 0)))


def test_until_ends_with_the_budget_of_its_search(tmp_path):
    log = tmp_path / "run.jsonl"
    before = run(Altered(0, None))
    evidence = {"contacts": before.contacts, "misses": before.misses}
    result = run(Altered(0, None), until=(0.01, 0.001), time_limit=1e-9, log=log, **evidence)
    assert result.status == "budget" and "cut short" in result.reason
    assert len(result.hypotheses) == 1 and result.until_met is False
    assert palpate.replay(log).status == "budget"


def test_a_log_says_where_one_more_touch_was(tmp_path):
    """With a time limit another search might end elsewhere."""
    log = tmp_path / "run.jsonl"
    result = run(Altered(0, None), until=(1.0, 0.01), time_limit=60.0, max_touches=8, log=log)
    again = palpate.replay(log)
    paths = [(one.path.start.tolist(), one.path.margin) for one in result.steps if one.purpose == "verify"]
    assert paths and paths == [
        (one.path.start.tolist(), one.path.margin) for one in again.steps if one.purpose == "verify"
    ]


def test_what_moves_refute_is_what_paths_say():
    """As each path's `outcome_of`, one by one."""
    random = np.random.default_rng(5)
    result = run(Altered(0, None))
    first = palpate.recognize(PARTS, result.contacts[:1]).hypotheses
    assert len(first) > 5
    sensor = usual_sensor()
    whole = [step for step in result.steps if not isinstance(step.reply, palpate.Skid)]
    moves = [(step.start, step.end, step.reply) for step in whole]
    for _ in range(20):
        angle, aside = random.uniform(-math.pi, math.pi), random.uniform(-60, 60)
        way = np.array([math.cos(angle), math.sin(angle)])
        start = -150.0 * way + aside * np.array([-way[1], way[0]])
        moves.append((start, start + 300.0 * way, palpate.Miss(start, start + 300.0 * way)))
    known = {}
    for number, (start, end, reply) in enumerate(moves):
        contact = reply.contact if isinstance(reply, palpate.Hit) else None
        granted = GRANTED * max(one.model.size for one in first)
        length = math.dist(start, end) + (granted if contact is not None else -granted)
        felt = palpate.Sensor(
            0.5 + (granted if contact is not None else 0.0),
            sensor.normal_error,
            sensor.max_incidence,
            0.0,
            sensor.position_error + granted,  # it states no path error
        )
        left = palpate.judge(first, felt, start, end - start, length).outcome_of(contact)
        known |= {k: number for k in range(len(first)) if k not in left and k not in known}
    assert known == refuted(first, moves, sensor) and known


# Flags


def test_flags_that_contradict_each_other_are_one_line(capsys):
    for flags, named in (
        (["--no-normal", "--normal-error-deg", "3"], "--normal-error-deg"),
        (["--pose", "900,0,0", "--workspace", "-200,-200,200,200"], "--pose"),
        (["--pose", "190,0,0", "--workspace", "-200,-200,200,200"], "--pose"),
    ):
        assert main(["identify", "boot", "--json", *flags]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1 and named in err
