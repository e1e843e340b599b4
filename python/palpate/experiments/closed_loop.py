"""Closed loops over all bundled parts, thousands of them: how do they end, and is the truth ever lost?

Problem `k` of seed `s` has the number `s · 10⁹ + k`. Each bundled part in turn lies at a random pose in a
square workspace, two sizes of the largest part across, and may be any of the bundled parts. In one of three
problems every error is as large as its bound, in the others it is uniform within.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np

from palpate import (
    Contact,
    Hypothesis,
    Model,
    Result,
    Sensor,
    SimulatedProbe,
    bundled_parts,
    identify,
    random_contacts,
)
from palpate.experiments import rivals
from palpate.experiments.checks import TOLERANCE
from palpate.experiments.oracle import Evidence, valid
from palpate.experiments.shapes import Array, Shape
from palpate.probe import Noise, random_pose

Row = dict[str, Any]
Start = Literal["scan", "drawn"]

ACROSS = 2.0  # the workspace, in sizes of the largest part
ROOM = 0.02  # of the part, between it and the border
MAX_INCIDENCE = math.radians(60.0)
AT_BOUNDS = 1.0 / 3.0  # of the problems
DRAWN = 2  # contacts, where the first ones are drawn from the part


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
        return any(
            one.model == self.truth and one.poses.contains(self.world_from_truth) for one in hypotheses
        )


@cache
def library() -> tuple[Model, ...]:
    """The bundled parts."""
    return tuple(bundled_parts())


def sensor_of(position_error: float, normal_error_deg: float) -> Sensor:
    """A point for a tip, reliable up to 60°."""
    return Sensor(position_error, math.radians(normal_error_deg), MAX_INCIDENCE)


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
    number: int, models: Sequence[Model], truth: Model, *, sensor: Sensor, factor: float = 1.0
) -> Problem:
    """The truth at a random pose; errors are `factor` times as large as the bounds that are claimed."""
    random = np.random.default_rng([number, 1])
    half, room = ACROSS / 2.0 * max(model.size for model in [*models, truth]), ROOM * truth.size
    room += 2.0 * sensor.tip_radius + factor * sensor.path_error
    workspace = np.array([[-half, -half], [half, half]])
    pose = random_pose(truth, workspace, room=room, random=random)
    noise: Noise = "bounds" if random.uniform() < AT_BOUNDS else "uniform"
    made = scaled(sensor, factor)
    probe = SimulatedProbe(truth, pose, made, seed=number, noise=noise, believed=sensor)
    return Problem(list(models), truth, pose, workspace, sensor, probe, noise)


def task(
    number: int,
    *,
    position_error: float,
    normal_error_deg: float,
    start: Start = "scan",
    beside: Sequence[str] = (),
) -> Row:
    """One loop, and the `rivals` named by `beside` on the same problem.

    `start` says where the first contacts come from: scans of the workspace (4.1), or two places drawn from
    the part itself (4.2).
    """
    models = library()
    sensor = sensor_of(position_error, normal_error_deg)
    problem = problem_of(number, models, models[number % len(models)], sensor=sensor)
    return row_of(problem, number, start=start, beside=beside)


def row_of(
    problem: Problem, number: int, *, start: Start = "scan", beside: Sequence[str] = (), **how: Any
) -> Row:
    """The loop on a problem, and what is to say of it; `how` goes on to `identify`."""
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
    scans = sum(step.purpose == "scan" for step in result.steps)
    row: Row = {
        "part": problem.truth.name,
        "noise": problem.noise,
        "status": result.status,
        "proved": result.proved,
        "wrong": result.found is not None and not problem.kept(result.hypotheses),
        "complete": result.found is not None and result.found.complete,
        "touches": result.touches,
        "scans": scans,
        "first": sum(map(len, result.paths[0].classes)) if result.paths else len(result.hypotheses),
        "left": len(result.hypotheses),
        "travel": result.travel,
        **contradicted(result),
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
    false = undecided = 0
    for one in result.hypotheses:
        evidence = Evidence.of(Shape.of(one.model), result.contacts, misses=result.misses)
        if result.found is not None and not result.found.complete and one.marginal:
            undecided += not one.poses.contains(one.poses.witness)
            continue
        poses = np.stack([one.poses.witness, one.world_from_model])
        false += not valid(evidence, poses, kinds=("face",), slack=evidence.tolerance(TOLERANCE)).all()
    return {"false": false, "undecided": undecided}
