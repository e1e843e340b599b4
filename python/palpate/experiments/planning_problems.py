"""Random planning problems of space: what a few contacts leave of parts that are hard to tell apart.

Everything follows from the problem's number and the parts that others made, if there are any. Parts are 200
across; their readings are off by as much as the next one may be.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .random_solids import FAMILIES as SHAPES
from .random_solids import prism, random_solid
from .solid_problems import Bounds, Random, draw_contacts, for_core, log_uniform, random_pose
from .solid_problems import Problem as Touched
from .solids import Array, Solid

#: Hypotheses of a problem.
FEWEST, MOST = 2, 40
#: What recognition may take for one that may become a problem: combinations of features.
EFFORT = 20_000
MAX_INCIDENCE = math.radians(60.0)
#: A contact that is not a face's is one of a tip.
TIP_RADII = (0.0, 0.0, 2.0)


@dataclass(frozen=True)
class Problem:
    """Hypotheses among which the next touch is to tell; `truth` is where the true part is."""

    number: int
    family: str
    hypotheses: list[Any]
    """Of `palpate.Hypothesis`, all with a pose that is proved."""
    sensor: Any
    """A `palpate.Sensor`."""
    truth: Array


def _convex(random: Random, _: Sequence[Solid]) -> list[Solid]:
    box, _star, _bracket, _stairs, frustum, hull = SHAPES
    return [(box, frustum, hull)[int(random.integers(3))](random)]


def _bracket(random: Random, _: Sequence[Solid]) -> list[Solid]:
    _box, star, bracket, stairs, _frustum, _hull = SHAPES
    return [(star, bracket, stairs)[int(random.integers(3))](random)]


def _two(random: Random, _: Sequence[Solid]) -> list[Solid]:
    return [random_solid(random), random_solid(random)]


def _public(random: Random, parts: Sequence[Solid]) -> list[Solid]:
    return [parts[int(random.integers(len(parts)))]]


def _one_face(random: Random, _: Sequence[Solid]) -> list[Solid]:
    """Angle brackets of which one face lies elsewhere, by a fiftieth of the part to a fifth."""
    a, b = random.uniform(60.0, 100.0, size=2)
    s, t = random.uniform(15.0, 30.0, size=2)
    height = float(random.uniform(30.0, 80.0))
    steps = [0.0, *(float(step) for step in random.uniform(2.0, 20.0, size=int(random.integers(1, 3))))]
    return [
        prism(
            f"bracket-{k}",
            np.array([[0.0, 0.0], [a, 0.0], [a, s + step], [t, s + step], [t, b], [0.0, b]]),
            height,
        )
        for k, step in enumerate(steps)
    ]


def _mirrored(random: Random, _: Sequence[Solid]) -> list[Solid]:
    """A part and what a mirror shows of it."""
    one = random_solid(random)
    return [one, Solid("mirror", one.vertices * [-1.0, 1.0, 1.0], one.triangles[:, ::-1])]


def _nearly_symmetric(random: Random, _: Sequence[Solid]) -> list[Solid]:
    """Blocks and regular prisms whose symmetry a side misses by 1 to 8 in 200."""
    count = int(random.choice([4, 4, 6, 8]))
    angles = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    outline = 90.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    outline[[0, -1], 0] += float(random.uniform(1.0, 8.0))  # the side across the x axis
    return [prism("nearly", outline, float(random.uniform(40.0, 120.0)))]


#: A problem is of the family of its number, one after the other; the last three are hard.
FAMILIES: dict[str, Callable[[Random, Sequence[Solid]], list[Solid]]] = {
    "convex": _convex,
    "brackets": _bracket,
    "two parts": _two,
    "of others": _public,
    "one face": _one_face,
    "mirror images": _mirrored,
    "nearly symmetric": _nearly_symmetric,
}


def planning_problem(number: int, parts: Sequence[Solid] = ()) -> Problem:
    """The problem of this number; without parts of others those of their family are of two parts."""
    import palpate

    random = np.random.default_rng([number, 6])
    family = list(FAMILIES)[number % len(FAMILIES)]
    if family == "of others" and not parts:
        family = "two parts"
    while True:
        solids = tuple(one.moved_to(200.0) for one in FAMILIES[family](random, parts))
        bounds = Bounds(
            position_error=log_uniform(random, 0.05, 1.0),
            normal_error=math.radians(log_uniform(random, 0.5, 5.0)),
            tip_radius=float(random.choice(TIP_RADII)),
        )
        truth, true = random_pose(random, 300.0), int(random.integers(len(solids)))
        contacts = draw_contacts(random, solids[true], truth, bounds=bounds, count=int(random.integers(3, 6)))
        touched = Touched(number, family, solids, true, truth, tuple(contacts), (), None)
        found = palpate.recognize(**for_core(touched), effort=EFFORT)
        usable = found.complete and all(one.proved for one in found.hypotheses)
        if usable and FEWEST <= len(found.hypotheses) <= MOST:
            sensor = palpate.Sensor(
                bounds.position_error, bounds.normal_error, MAX_INCIDENCE, tip_radius=bounds.tip_radius
            )
            return Problem(number, family, found.hypotheses, sensor, truth)
