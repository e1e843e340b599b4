"""Closed loops over all bundled parts, thousands of them: how do they end, and is the truth ever lost?

Problem `k` of seed `s` has the number `s · 10⁹ + k`. Each bundled part in turn lies at a random pose in a
square workspace, two sizes of the largest part across, and may be any of the bundled parts. In one of three
problems every error is as large as its bound, in the others it is uniform within.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from palpate import (
    Contact,
    Hypothesis,
    Model,
    Result,
    Sensor,
    SimulatedProbe,
    identify,
    random_contacts,
)
from palpate.experiments import rivals, solid_oracle
from palpate.experiments.checks import TOLERANCE
from palpate.experiments.oracle import Evidence, valid
from palpate.experiments.shapes import Array, Shape
from palpate.experiments.solids import Solid
from palpate.experiments.thesis_sensor import parts, sensor_of
from palpate.probe import Noise, random_pose
from palpate.truth import number_of_truth

Row = dict[str, Any]
Start = Literal["scan", "drawn"]

ACROSS = 2.0  # the workspace, in sizes of the largest part
ROOM = 0.02  # of the part, between it and the border
AT_BOUNDS = 1.0 / 3.0  # of the problems
DRAWN = 2  # contacts, where the first ones are drawn from the part

# What is drawn for mixed problems; lengths in the parts' unit.
TIP_RADII = (0.0, 2.0, 5.0)
PATH_ERRORS = (0.0, 0.3, 1.0)
OVERTRAVELS = (0.0, 0.5, 1.0)  # of the position error
WITHOUT_NORMALS = 0.25  # of the problems
MIXED_EFFORT = 20_000  # for each path: without normals many hypotheses are left at first


@dataclass(frozen=True)
class Problem:
    """A part somewhere in a workspace, and how it is felt."""

    models: list[Model]
    truth: Model
    world_from_truth: Array
    workspace: Array
    sensor: Sensor
    probe: SimulatedProbe
    noise: Noise

    def kept(self, hypotheses: Sequence[Hypothesis]) -> bool:
        """Whether the true part and pose are among them."""
        return number_of_truth(hypotheses, self.truth, self.world_from_truth) is not None


def scaled(sensor: Sensor, factor: float) -> Sensor:
    """The same with errors so many times as large; normals within a right angle."""
    normal = sensor.normal_error
    return Sensor(
        factor * sensor.position_error,
        None if normal is None else min(factor * normal, math.pi / 2),
        sensor.max_incidence,
        sensor.tip_radius,
        factor * sensor.path_error,
    )


def problem_of(
    number: int,
    models: Sequence[Model],
    truth: Model,
    *,
    sensor: Sensor,
    factor: float = 1.0,
    overtravel: float = 0.0,
) -> Problem:
    """The truth at a random pose; errors are `factor` times as large as the bounds that are claimed."""
    random = np.random.default_rng([number, 1])
    half, room = ACROSS / 2.0 * max(model.size for model in [*models, truth]), ROOM * truth.size
    room += 2.0 * sensor.tip_radius + factor * sensor.path_error
    workspace = half * np.array([[-1.0], [1.0]]) * np.ones(truth.dimension)
    pose = random_pose(truth, workspace, room=room, random=random)
    noise: Noise = "bounds" if random.uniform() < AT_BOUNDS else "uniform"
    made = scaled(sensor, factor)
    probe = SimulatedProbe(
        truth, pose, made, seed=number, noise=noise, overtravel=overtravel, believed=sensor
    )
    return Problem(list(models), truth, pose, workspace, sensor, probe, noise)


def task(
    number: int,
    *,
    position_error: float,
    normal_error_deg: float,
    start: Start = "scan",
    beside: Sequence[str] = (),
    mixed: bool = False,
) -> Row:
    """One loop, and the `rivals` named by `beside` on the same problem.

    `start` says where the first contacts come from: scans of the workspace (4.1), or two places drawn from
    the part itself (4.2). `mixed` draws a radius of the tip, a path error, overtravel, and whether normals
    are read, for each problem.
    """
    models = list(parts().values())
    truth = models[number % len(models)]
    sensor = sensor_of(position_error=position_error, normal_error_deg=normal_error_deg)
    if not mixed:
        return row_of(problem_of(number, models, truth, sensor=sensor), number, start=start, beside=beside)
    random = np.random.default_rng([number, 4])
    tip_radius, path_error = random.choice(TIP_RADII), random.choice(PATH_ERRORS)
    overtravel = float(random.choice(OVERTRAVELS)) * position_error
    normal_error = None if random.uniform() < WITHOUT_NORMALS else sensor.normal_error
    felt = Sensor(position_error, normal_error, sensor.max_incidence, float(tip_radius), float(path_error))
    problem = problem_of(number, models, truth, sensor=felt, overtravel=overtravel)
    drawn = {
        "tip_radius": felt.tip_radius,
        "path_error": felt.path_error,
        "overtravel": overtravel,
        "normals": normal_error is not None,
    }
    return {**row_of(problem, number, start=start, beside=beside, effort=MIXED_EFFORT), **drawn}


def row_of(
    problem: Problem,
    number: int,
    *,
    start: Start = "scan",
    beside: Sequence[str] = (),
    seen: Callable[[Result], None] = lambda result: None,
    **how: Any,
) -> Row:
    """The loop on a problem, and what is said of it; `how` is for `identify`, `seen` is shown the result."""
    contacts = _drawn(problem, number) if start == "drawn" else []
    began = time.perf_counter()
    result = identify(
        problem.models,
        problem.probe,
        problem.sensor,
        problem.workspace,
        contacts=contacts,
        seed=number,
        **how,
    )
    seconds = {"loop": time.perf_counter() - began, "planning": result.planning_time}
    seen(result)
    planned = [k for k, step in enumerate(result.steps) if step.path is not None]
    row: Row = {
        "part": problem.truth.name,
        "noise": problem.noise,
        "status": result.status,
        "proved": result.proved,
        "lost": bool(result.contacts) and not problem.kept(result.hypotheses),
        "nothing_found": not result.contacts,
        "complete": result.found is not None and result.found.complete,
        "touches": result.touches,
        "scans": sum(step.purpose == "scan" for step in result.steps),
        "before": planned[0] if planned else result.touches,
        "refuted": 0 if result.found is None else len(result.found.refuted),
        "first": sum(map(len, result.paths[0].classes)) if result.paths else len(result.hypotheses),
        "left": len(result.hypotheses),
        "travel": result.travel,
        **(contradicted if problem.truth.dimension == 2 else contradicted_in_space)(result),
    }
    for name in beside:
        began = time.perf_counter()
        row[name] = rivals.touches(name, problem, result, number=number)
        seconds[name] = time.perf_counter() - began
    return {**row, "seconds": seconds}


def _drawn(problem: Problem, number: int) -> list[Contact]:
    return random_contacts(
        problem.truth,
        problem.world_from_truth,
        problem.sensor,
        count=DRAWN,
        seed=number,
        noise=problem.noise,
    )


def contradicted(result: Result) -> Row:
    """How many of the hypotheses left have a pose that contradicts a contact or a miss, by plain geometry.

    Asked of `experiments.oracle`, which shares nothing with the core. Undecided ones, of a search that met
    its limit and says so, have no such pose to check.
    """
    contradicting = undecided = 0
    for one in result.hypotheses:
        evidence = Evidence.of(Shape.of(one.model), result.contacts, misses=result.misses)
        if result.found is not None and not result.found.complete and one.marginal:
            undecided += not one.poses.contains(one.poses.witness)
            continue
        balls = any(contact.tip_radius > 0.0 for contact in result.contacts)
        kinds = ("face", "vertex") if balls else ("face",)
        poses = np.stack([one.poses.witness, one.world_from_model])
        contradicting += not valid(evidence, poses, kinds=kinds, slack=evidence.tolerance(TOLERANCE)).all()
    return {"contradicted": contradicting, "undecided": undecided}


def contradicted_in_space(result: Result) -> Row:
    """The same in space, of contacts alone: what was swept refutes whole hypotheses there, and cuts no poses.

    Asked of `experiments.solid_oracle`.
    """
    contradicting = undecided = 0
    for one in result.hypotheses:
        solid = Solid(one.model.name, one.model.vertices, one.model.triangles.astype(np.int64))
        if not one.proved:
            undecided += 1
            continue
        balls = any(contact.tip_radius > 0.0 for contact in result.contacts)
        kinds = ("face", "edge", "vertex") if balls else ("face",)
        poses = np.stack([one.poses.witness, one.world_from_model])
        least = solid_oracle.tolerance(solid, result.contacts, TOLERANCE)
        asymmetry = one.model.asymmetry
        missed = solid_oracle.missed_by_centers(asymmetry, result.contacts)
        slack = solid_oracle.Slack(
            least.length + 2.0 * (one.model.position_slack + missed),
            least.angle + 2.0 * (one.model.normal_slack + asymmetry[1]),
        )
        explained = [
            solid_oracle.explained(solid, poses, contact, slack, kinds=kinds).all()
            for contact in result.contacts
        ]
        contradicting += not all(explained)
    return {"contradicted": contradicting, "undecided": undecided}
