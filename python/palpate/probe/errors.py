"""The errors that a simulated probe makes on one guarded move, in the plane and in space."""

from __future__ import annotations

import math
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rotations import rotation_of

Array: TypeAlias = NDArray[np.float64]
Noise: TypeAlias = Literal["uniform", "bounds", "none"]


class PlanarErrors:
    """Drawn one after another from `random`.

    As many numbers are drawn whatever the bounds are, so that errors of other kinds stay the same.
    """

    def __init__(self, random: np.random.Generator, noise: Noise) -> None:
        """Errors as large as `noise` says, as for `SimulatedProbe`."""
        self.random = random
        self.noise = noise

    def signed(self, bound: float) -> float:
        """A number from `-bound` to `bound`."""
        drawn = self.random.uniform(-1.0, 1.0)
        return {"uniform": drawn, "bounds": math.copysign(1.0, drawn), "none": 0.0}[self.noise] * bound

    def across(self, direction: Array, bound: float) -> Array:
        """A shift of a line by up to `bound`, shape `(d,)`, square to its unit direction."""
        return self.signed(bound) * np.array([-direction[1], direction[0]])

    def anywhere(self, bound: float) -> Array:
        """A shift by up to `bound`, shape `(d,)`: uniform in the disc or ball."""
        radius = 0.0 if self.noise == "none" else bound
        if self.noise == "uniform":
            radius *= math.sqrt(self.random.uniform())
        toward = self.random.uniform(-math.pi, math.pi)
        return radius * np.array([math.cos(toward), math.sin(toward)])

    def turned(self, normal: Array, bound: float) -> Array:
        """A unit vector, shape `(d,)`, within `bound` radians of another one: uniform in the arc or cone."""
        turn = self.signed(bound)
        cosine, sine = math.cos(turn), math.sin(turn)
        x, y = normal
        return np.array([cosine * x - sine * y, sine * x + cosine * y])


class SpatialErrors(PlanarErrors):
    """The same in space: what is to one of two sides in the plane goes any way around."""

    def across(self, direction: Array, bound: float) -> Array:  # noqa: D102 - as in the plane
        return bound * math.sqrt(self._share()) * self._around(direction)

    def anywhere(self, bound: float) -> Array:  # noqa: D102
        share, height = self._share(), self.random.uniform(-1.0, 1.0)
        axis = np.array([0.0, 0.0, 1.0])
        unit = height * axis + math.sqrt(1.0 - height * height) * self._around(axis)
        return bound * share ** (1.0 / 3.0) * unit

    def turned(self, normal: Array, bound: float) -> Array:  # noqa: D102
        # The area of a cap is proportional to the square of its chord.
        turn = 2.0 * math.asin(math.sqrt(self._share()) * math.sin(0.5 * bound))
        return math.cos(turn) * normal + math.sin(turn) * self._around(normal)

    def _share(self) -> float:
        """Of an area or a volume that is nearer to its middle."""
        drawn = self.random.uniform()
        return {"uniform": drawn, "bounds": 1.0, "none": 0.0}[self.noise]

    def _around(self, axis: Array) -> Array:
        """A unit vector square to a unit axis: uniform on the circle."""
        least = np.eye(3)[np.argmin(np.abs(axis))]
        first = np.cross(axis, least)
        first /= np.linalg.norm(first)
        angle = self.random.uniform(-math.pi, math.pi)
        return math.cos(angle) * first + math.sin(angle) * np.cross(axis, first)


ERRORS = {2: PlanarErrors, 3: SpatialErrors}
"""By dimension."""


def random_rotation(dimension: int, random: np.random.Generator) -> Array:
    """Any rotation, shape `(d, d)`, evenly."""
    if dimension == 2:
        angle = random.uniform(-math.pi, math.pi)
        cosine, sine = math.cos(angle), math.sin(angle)
        return np.array([[cosine, -sine], [sine, cosine]])
    scalar, *along = random.normal(size=4)  # of a quaternion
    length = math.hypot(*along)
    return rotation_of(2.0 * math.atan2(length, scalar) / length * np.array(along))
