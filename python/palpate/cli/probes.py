"""The probes of `palpate identify`, with the part in front of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from palpate import Model, Prior, Sensor, SimulatedProbe
from palpate.cli import plan_options
from palpate.cli.recognize import pose_of
from palpate.cli.rig_options import RigFlags, flags_named, rig_workspace
from palpate.contacts.entry import mm_per
from palpate.loop.route import Array, workspace_of
from palpate.probe import Noise, random_pose
from palpate.rig import FROM_ABOVE, RigProbe, rig_sensor
from palpate.usual import NORMAL_ERROR_DEG, POSITION_ERROR

ACROSS = {2: 3.0, 3: 2.0}  # the workspace in sizes of the largest part, if it is not given
ROOM = 0.02  # of the part, between it and the border, at a random pose


@dataclass(frozen=True)
class SensorFlags:
    """As they were given; None: not given. Lengths in the unit of the models."""

    position_error: float | None
    normal_error_deg: float | None
    reads_normals: bool
    max_incidence_deg: float
    tip_radius: float | None
    path_error: float | None


@dataclass(frozen=True)
class Bench:
    """A probe, what its readings are good for, and the part in its workspace."""

    probe: SimulatedProbe | RigProbe
    sensor: Sensor
    workspace: Array
    world_from_truth: Array
    directions: Any
    """From which it probes, if that is restricted."""


def simulated(
    truth: Model,
    felt: SensorFlags,
    *,
    workspace: str | None,
    pose: str,
    prior: Prior | None,
    size: float,
    directions: Any,
    noise: str | None,
    overtravel: float | None,
    seed: int,
) -> Bench:
    """A tip with errors within bounds; `size` is that of the largest part."""
    degrees = NORMAL_ERROR_DEG if felt.normal_error_deg is None else felt.normal_error_deg
    sensor = Sensor(
        POSITION_ERROR if felt.position_error is None else felt.position_error,
        math.radians(degrees) if felt.reads_normals else None,
        math.radians(felt.max_incidence_deg),
        felt.tip_radius or 0.0,
        felt.path_error or 0.0,
    )
    area = _workspace(workspace, pose, prior, size=size, dimension=truth.dimension)
    placed = _pose(pose, truth, prior, workspace=area, sensor=sensor, seed=seed)
    probe = SimulatedProbe(
        truth,
        placed,
        sensor,
        seed=seed,
        noise=cast(Noise, noise or "uniform"),
        overtravel=overtravel or 0.0,
    )
    return Bench(probe, sensor, area, placed, directions)


def rig(
    truth: Model,
    felt: SensorFlags,
    flags: RigFlags,
    *,
    workspace: str | None,
    pose: str,
    prior: Prior | None,
    directions: Any,
    unit: str,
    seed: int,
) -> Bench:
    """The rig, with its derived bounds where no others are asked for."""
    d, mm = truth.dimension, mm_per(unit, "--unit")
    corners = plan_options.workspace_of(workspace, d)
    area = rig_workspace(d, unit=unit) if corners is None else workspace_of(corners, d)
    with flags_named():
        spec = flags.spec(None if felt.tip_radius is None else felt.tip_radius * mm)
        derived = rig_sensor(
            spec,
            dimension=d,
            size=tuple(float(side) * mm for side in np.ptp(area, axis=0)),
            max_incidence=math.radians(felt.max_incidence_deg),
            unit=unit,
        )
        asked = felt.normal_error_deg
        normal_error = derived.normal_error if asked is None else math.radians(asked)
        sensor = Sensor(
            derived.position_error if felt.position_error is None else felt.position_error,
            normal_error if felt.reads_normals else None,
            derived.max_incidence,
            derived.tip_radius,
            derived.path_error if felt.path_error is None else felt.path_error,
            stem=derived.stem,
        )
        placed = _pose(pose, truth, prior, workspace=area, sensor=sensor, seed=seed)
        probe = RigProbe(truth, placed, sensor, spec=spec, workspace=area, unit=unit, seed=seed)
    return Bench(probe, sensor, area, placed, FROM_ABOVE if directions is None and d == 3 else directions)


def _workspace(text: str | None, pose: str, prior: Prior | None, *, size: float, dimension: int) -> Array:
    corners = plan_options.workspace_of(text, dimension)
    if corners is not None:
        return workspace_of(corners, dimension)
    middle = np.zeros(dimension) if prior is None else prior.world_from_model[:-1, -1]
    if pose != "random":
        middle = pose_of(pose, "--pose", dimension)[:-1, -1]
    half = ACROSS[dimension] / 2 * size
    return np.array([middle - half, middle + half])


def _pose(
    text: str, model: Model, prior: Prior | None, *, workspace: Array, sensor: Sensor, seed: int
) -> Array:
    """That of the flag, or a random one at which the part lies inside of the workspace."""
    if text != "random":
        world_from_model = pose_of(text, "--pose", model.dimension)
        placed = model.vertices @ world_from_model[:-1, :-1].T + world_from_model[:-1, -1]
        if (placed < workspace[0]).any() or (placed > workspace[1]).any():
            raise ValueError(
                f"--pose: {model.name} does not lie within the workspace (got {text}); "
                "give another pose, or a larger --workspace"
            )
        return world_from_model
    random = np.random.default_rng([seed, 1])
    room = ROOM * model.size + 2.0 * sensor.tip_radius + sensor.path_error
    try:
        return random_pose(model, workspace, room=room, random=random, prior=prior)
    except ValueError as error:
        raise ValueError(f"--{error}") from None
