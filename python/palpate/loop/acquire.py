"""The first contacts in the plane: binary subdivision of the workspace (thesis 4.1)."""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Contact, Model

Array: TypeAlias = NDArray[np.float64]

APART = math.radians(15)  # beyond the errors of two normals: so far apart, they are independent
FINER = 4  # times the smallest width: the finest scans of a blind search
THINNEST = 16  # the length of a part in its width: thinner ones are scanned as if they were as wide


@dataclass(frozen=True)
class Scan:
    """A guarded move across the workspace, from one side to the other."""

    start: Array
    end: Array
    width: float
    """Any part of this width inside of the workspace is met by one of the scans up to this subdivision."""


class Scans:
    """Scans from the perimeter: at the middle in x, in y, both from the other side, then at the quarters, ...

    What was passed from one side, nothing touched, is not scanned from the other.
    """

    def __init__(
        self, workspace: Array, finest: float, directions: tuple[ArrayLike, float] | None = None
    ) -> None:
        """Scans of a workspace.

        Args:
            workspace: Lower left and upper right corner, shape `(2, 2)`, world frame.
            finest: The last subdivision is the first whose `Scan.width` is no more than this.
            directions: A direction and an angle: only scans within the angle of it are made.
        """
        self._free: set[tuple[int, float]] = set()
        self._ahead = self._all(workspace, finest, directions)
        self._next = next(self._ahead, None)

    def next(self, finest: float) -> Scan | None:
        """The next scan; None if all are made that `finest`, no finer than that of all, asks for."""
        return None if self._next is None or 2.0 * self._next.width <= finest else self._next

    def made(self, *, missed: bool) -> None:
        """The next scan was made; whether it touched nothing."""
        try:
            self._next = self._ahead.send(missed)
        except StopIteration:
            self._next = None

    def _all(
        self, workspace: Array, finest: float, directions: tuple[ArrayLike, float] | None
    ) -> Generator[Scan, bool, None]:
        width = float((workspace[1] - workspace[0]).max())
        count = 1
        while width > finest:
            width /= 2.0
            for turned in (False, True):
                for axis in (0, 1):
                    for k in range(count):
                        line = (axis, (2 * k + 1) / (2 * count))
                        scan = _scan(workspace, *line, turned=turned, width=width)
                        if line not in self._free and _allowed(scan, directions) and (yield scan):
                            self._free.add(line)
            count *= 2


def independent(contacts: Sequence[Contact]) -> bool:
    """Whether two normals are further than their errors and 15° from parallel and from opposite (4.1)."""
    sensed = [
        (c.normal, c.normal_error) for c in contacts if c.normal is not None and c.normal_error is not None
    ]
    for k, (a, error_a) in enumerate(sensed):
        for b, error_b in sensed[:k]:
            angle = math.atan2(abs(float(a[0] * b[1] - a[1] * b[0])), abs(float(a @ b)))
            if angle > error_a + error_b + APART:
                return True
    return False


def smallest_width(models: Sequence[Model]) -> float:
    """The least distance of two parallel lines that hold a model between them; of all models.

    A part that is as good as a line counts as having a share of its length.
    """
    return min(max(_width(model.vertices), model.size / THINNEST) for model in models)


def _scan(workspace: Array, axis: int, share: float, *, turned: bool, width: float) -> Scan:
    """Along the axis, at a share of the way across."""
    low, high = workspace
    across = low[1 - axis] + share * (high[1 - axis] - low[1 - axis])
    start, end = np.empty(2), np.empty(2)
    start[axis], end[axis] = (high[axis], low[axis]) if turned else (low[axis], high[axis])
    start[1 - axis] = end[1 - axis] = across
    return Scan(start, end, width)


def _allowed(scan: Scan, directions: tuple[ArrayLike, float] | None) -> bool:
    if directions is None:
        return True
    axis, half = np.asarray(directions[0], dtype=float), directions[1]
    way = scan.end - scan.start
    angle = math.atan2(float(axis[0] * way[1] - axis[1] * way[0]), float(axis @ way))
    return abs(angle) <= half


def _width(points: Array) -> float:
    """Of the convex hull: least across one of its sides."""
    hull = _hull(points)
    widths = [
        float(np.max(np.abs((hull - a) @ np.array([-(b - a)[1], (b - a)[0]])))) / math.dist(a, b)
        for a, b in zip(hull, np.roll(hull, -1, axis=0), strict=True)
        if not np.array_equal(a, b)
    ]
    return min(widths)


def _hull(points: Array) -> Array:
    """Corners of the convex hull, counter-clockwise (monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})

    def half(places: list[tuple[float, float]]) -> list[tuple[float, float]]:
        kept: list[tuple[float, float]] = []
        for x, y in places:
            while len(kept) > 1 and _left_turn(kept[-2], kept[-1], (x, y)) <= 0.0:
                kept.pop()
            kept.append((x, y))
        return kept[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _left_turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
