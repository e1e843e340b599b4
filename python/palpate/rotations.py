"""Rotations in space as vectors: along the axis, as long as the angle, as UR robots write them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from palpate.curves import Array


def rotation_of(vector: ArrayLike) -> Array:
    """The rotation, shape `(3, 3)`, about `vector` by its length in radians (Rodrigues)."""
    x, y, z = np.asarray(vector, dtype=float)
    angle = math.hypot(x, y, z)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # sin(a)/a and (1 - cos(a))/a², which are defined at zero too; numpy's sinc has a π in it.
    sine, versine = np.sinc(angle / math.pi), 0.5 * np.sinc(0.5 * angle / math.pi) ** 2
    return np.eye(3) + sine * cross + versine * (cross @ cross)


def vector_of(rotation: ArrayLike) -> Array:
    """The vector, shape `(3,)`, at most π long, of a rotation `(3, 3)`: `rotation_of(vector_of(r)) = r`."""
    r = np.asarray(rotation, dtype=float)
    (a, b, c), trace = np.diag(r), float(np.trace(r))
    d, e, f = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    g, h, k = r[1, 0] + r[0, 1], r[0, 2] + r[2, 0], r[2, 1] + r[1, 2]
    # 4 q qᵀ of the unit quaternion q, scalar first: the column of the largest component has most digits.
    outer = np.array(
        [
            [1.0 + trace, d, e, f],
            [d, 1.0 + a - b - c, g, h],
            [e, g, 1.0 - a + b - c, k],
            [f, h, k, 1.0 - a - b + c],
        ]
    )
    scalar, *along = outer[np.argmax(np.diag(outer))]
    sine = math.hypot(*along)
    if sine == 0.0:
        return np.zeros(3)
    angle = 2.0 * math.atan2(sine, abs(scalar))
    return math.copysign(angle / sine, scalar) * np.array(along)
