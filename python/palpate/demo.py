"""The main job on bundled parts: one of them lies hidden somewhere on a table and is found by touch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate._core import Hypothesis, Model
from palpate.loop import Result, Step, identify
from palpate.models import load_models
from palpate.parts import part_names, solid_part_names
from palpate.probe import SimulatedProbe, random_pose
from palpate.truth import number_of_truth
from palpate.usual import usual_sensor

Array: TypeAlias = NDArray[np.float64]

# In its run two planned paths leave one of 14 hypotheses, and more touches tighten its pose.
DEFAULT_SEED = 5

UNIT = "mm"
TABLE = 400.0  # the side of the square on which the part lies
SENSOR = usual_sensor()
ENOUGH = (2.5, math.radians(1))  # it goes on touching until the pose is known so well

_ROOM = 5.0  # between the part and the border of the table


@dataclass(frozen=True, eq=False)
class Demonstration:
    """What lay there, and the run that found it; lengths in `UNIT`."""

    models: list[Model]
    truth: Model
    world_from_truth: Array
    result: Result
    seed: int

    @property
    def truth_number(self) -> int | None:
        """The hypothesis, counted from 1, that holds the true part and pose."""
        number = number_of_truth(self.result.hypotheses, self.truth, self.world_from_truth)
        return None if number is None else number + 1


def demonstrate(
    part: str | None = None,
    *,
    seed: int = DEFAULT_SEED,
    log: Path | None = None,
    told: Callable[[Step], None] | None = None,
) -> Demonstration:
    """Hide a bundled part at a random pose, and find it by touch among all of them.

    Args:
        part: Name of a bundled part; None: one at random.
        seed: Chooses the part, its pose and the errors of the readings.
        log: As for `identify`.
        told: As for `identify`.

    Raises:
        ValueError: No such part, a negative seed, a log that is there already.
    """
    check_choice(part, seed)
    names = part_names()
    models = load_models(names)
    drawn = int(np.random.default_rng([seed, 0]).integers(len(names)))
    truth = models[drawn if part is None else names.index(part)]
    world_from_truth = random_pose(truth, table(), room=_ROOM, random=np.random.default_rng([seed, 1]))
    probe = SimulatedProbe(truth, world_from_truth, SENSOR, seed=seed)
    result = identify(models, probe, SENSOR, table(), until=ENOUGH, unit=UNIT, log=log, told=told)
    return Demonstration(models, truth, world_from_truth, result, seed)


def check_choice(part: str | None, seed: int) -> None:
    """Refuse what `demonstrate` would refuse, before anything is made ready for it."""
    names = part_names()
    if part in solid_part_names():
        raise ValueError(
            f"part: {part} is a part in space, the demo works in the plane only as yet; "
            f"give one of {', '.join(names)}"
        )
    if part is not None and part not in names:
        raise ValueError(f"part: no such bundled part (got {part!r}); give one of {', '.join(names)}")
    if seed < 0:
        raise ValueError(f"seed: must be zero or more (got {seed}); give another one")


def table() -> Array:
    """Two opposite corners of it, shape `(2, 2)`, world frame."""
    return np.array([[-TABLE / 2, -TABLE / 2], [TABLE / 2, TABLE / 2]])


def deviation(found: Hypothesis, world_from_truth: Array) -> tuple[float, float]:
    """How far the pose of a hypothesis lies from another of its model, up to symmetry.

    Returns:
        Length: the largest way of a corner. Radians: the turn.
    """
    pose = found.world_from_model
    other = nearest(found, world_from_truth)
    turned = pose[:2, :2].T @ other[:2, :2]
    return _way(found.model, pose, other), abs(math.atan2(turned[1, 0], turned[0, 0]))


def nearest(found: Hypothesis, world_from_truth: Array) -> Array:
    """That of the poses at which the model lies as at `world_from_truth` that moves its corners least."""
    poses = [world_from_truth @ symmetry for symmetry in np.asarray(found.model.symmetries)]
    return min(poses, key=lambda pose: _way(found.model, found.world_from_model, pose))


def _way(model: Model, one: Array, other: Array) -> float:
    corners = np.column_stack([model.vertices, np.ones(len(model.vertices))])
    return float(np.hypot(*(corners @ (one - other).T)[:, :2].T).max())
