"""Other ways to choose the next touch, on the problems of the closed loop.

Chance; in the plane entropy of classes, in space the line that tells nominal poses apart best. All begin with
the evidence with which the loop planned its first path, touch with the same probe, and recognize anew after
each touch as the loop does. Only the choice of the line is theirs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate import (
    Contact,
    FirstContact,
    Hit,
    Hypothesis,
    Lines,
    Miss,
    Path,
    Recognition,
    Result,
    Sensor,
    Skid,
    recognize,
)
from palpate.experiments.shapes import Array
from palpate.loop.planning import is_promising
from palpate.loop.refuted import refuted, without_way
from palpate.loop.settings import MAX_TOUCHES
from palpate.loop.wander import as_swept, wandering

if TYPE_CHECKING:
    from palpate.experiments.closed_loop import Problem

MOST_TOUCHES = {2: MAX_TOUCHES, 3: 60}
NUM_LINES = 500  # random lines among which the most telling one is chosen

Line = tuple[Array, Array]
Chosen = Callable[["Problem", list[Hypothesis], np.random.Generator], Line | None]


def touches(name: str, problem: Problem, result: Result, *, number: int) -> dict[str, Any]:
    """How many guarded moves a rival makes where the loop came to `result`, first contacts included."""
    contacts, misses, moves = _before_planning(result)
    if moves == result.touches:
        return {"touches": moves, "status": result.status}
    made = [(step.start, step.end, step.reply) for step in result.steps[:moves]]
    random = np.random.default_rng([number, 2])
    while True:
        found = _recognized(problem, contacts, misses)
        gone = refuted(found.hypotheses, made, problem.sensor)
        left = [one for k, one in enumerate(found.hypotheses) if k not in gone]
        if len(left) < 2:
            return {"touches": len(made), "status": "solved" if left else "unexplained"}
        spent = len(made) >= MOST_TOUCHES[problem.truth.dimension]
        line = None if spent else RIVALS[name](problem, left, random)
        if line is None:
            return {"touches": len(made), "status": "budget" if spent else "inseparable"}
        reply = problem.probe.touch(*line)
        made.append((*line, reply))
        if isinstance(reply, Hit):
            contacts.append(reply.contact)
        elif isinstance(reply, Miss | Skid):
            misses.append(as_swept(reply.free if isinstance(reply, Skid) else reply, problem.sensor))


def _recognized(problem: Problem, contacts: list[Contact], misses: list[Miss]) -> Recognition:
    """As the loop does it: in space ways that were swept are left to `refuted`."""
    if problem.truth.dimension == 3:
        return recognize(problem.models, [without_way(contact) for contact in contacts])
    return recognize(problem.models, contacts, misses=misses)


def _before_planning(result: Result) -> tuple[list[Contact], list[Miss], int]:
    """Evidence before the first planned path, and the guarded moves that it took."""
    planned = [k for k, step in enumerate(result.steps) if step.path is not None]
    moves = planned[0] if planned else result.touches
    later = [step.reply for step in result.steps[moves:]]
    hits = sum(isinstance(reply, Hit) for reply in later)
    # A contact that says nothing of its way brings it as a miss.
    free = sum(not isinstance(reply, Hit) or reply.contact.start is None for reply in later)
    return (
        result.contacts[: len(result.contacts) - hits],
        result.misses[: len(result.misses) - free],
        moves,
    )


def by_chance(problem: Problem, hypotheses: list[Hypothesis], random: np.random.Generator) -> Line:
    """A random line through a random place of the workspace, whether it can be used or not."""
    low, high = problem.workspace
    place = random.uniform(low, high)
    if len(place) == 2:
        angle = random.uniform(-math.pi, math.pi)
        way = np.array([math.cos(angle), math.sin(angle)])
    else:
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
    # Where it enters and leaves the rectangle: between the later of the entries and the earlier of the exits.
    sides = np.stack([(low - place) / way, (high - place) / way])
    return place + sides.min(axis=0).max() * way, place + sides.max(axis=0).min() * way


def by_entropy(problem: Problem, hypotheses: list[Hypothesis], random: np.random.Generator) -> Line | None:
    """Of so many random lines the one whose classes have the most entropy, hypotheses as equally likely.

    A class is of hypotheses joined by "not separated": what a reading leaves may be less, so that this is no
    more than the information that is certain to be gained. Where none is certain to tell any apart, that
    which is expected to leave the fewest; None if none does.
    """
    lines = Lines(hypotheses, wandering(problem.sensor), workspace=problem.workspace)
    best: tuple[tuple[float, float], Path] | None = None
    for _ in range(NUM_LINES):
        angle, offset = random.uniform(-math.pi, math.pi), lines.radius * random.uniform(-1.0, 1.0)
        path = lines.judge(angle, offset)
        if path is None or path.faults or not is_promising(path, len(hypotheses)):
            continue
        worth = (_entropy(path), -path.expected_score)
        if best is None or worth > best[0]:
            best = worth, path
    return None if best is None else (best[1].start, best[1].end)


def by_nominal(problem: Problem, hypotheses: list[Hypothesis], random: np.random.Generator) -> Line | None:
    """Of so many random lines the one that leaves the fewest, in the mean, were all poses the nominal ones.

    Two are told apart if the depths at which they are met differ by more than both errors, or the normals by
    more than theirs. None if no line tells any apart.
    """
    sensor = wandering(problem.sensor)
    best: tuple[float, Line] | None = None
    for _ in range(NUM_LINES):
        start, end = by_chance(problem, hypotheses, random)
        way = (end - start) / np.linalg.norm(end - start)
        met = [
            one.model.first_contact(one.world_from_model, start, way, sensor.tip_radius) for one in hypotheses
        ]
        skids = [one for one in met if one is not None and -way @ one.normal < math.cos(sensor.max_incidence)]
        left = len(met) if skids else sum(alike(a, b, sensor) for a in met for b in met) / len(met)
        if left < len(met) and (best is None or left < best[0]):
            best = left, (start, end)
    return None if best is None else best[1]


def alike(a: FirstContact | None, b: FirstContact | None, sensor: Sensor) -> bool:
    """Whether two exact readings may be the same within the bounds."""
    if a is None or b is None:
        return a is b
    apart = math.acos(max(-1.0, min(1.0, float(a.normal @ b.normal))))
    told = sensor.normal_error is not None and apart > 2.0 * sensor.normal_error
    return abs(a.depth - b.depth) <= 2.0 * sensor.position_error and not told


def _entropy(path: Path) -> float:
    """Of the classes, in nats."""
    shares = np.array([len(members) for members in path.classes], dtype=float)
    shares /= shares.sum()
    return -float(shares @ np.log(shares))


RIVALS: dict[str, Chosen] = {"chance": by_chance, "entropy": by_entropy, "nominal": by_nominal}
