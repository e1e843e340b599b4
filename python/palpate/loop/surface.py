"""Ways of the tip over the surface of a workspace in space, a box, from one guarded move to the next."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.loop.route import ON_BORDER, length_of

Array: TypeAlias = NDArray[np.float64]
Side: TypeAlias = tuple[int, int]
"""An axis, and whether it is the lower (0) or the upper (1) side."""

SIDES: tuple[Side, ...] = tuple(product(range(3), range(2)))


def open_sides(directions: tuple[ArrayLike, float] | None) -> list[Side]:
    """Sides through which an allowed direction enters: where the tip may be between guarded moves.

    With directions that go down from above, the lower side is none of them: there is the table.
    """
    if directions is None:
        return list(SIDES)
    axis, half = np.array(directions[0], dtype=float), directions[1]
    axis = axis / np.linalg.norm(axis)
    inward = {(k, upper): float(axis[k]) * (-1.0 if upper else 1.0) for k, upper in SIDES}
    return [
        side for side in SIDES if math.acos(max(-1.0, min(1.0, inward[side]))) < half + math.pi / 2 - 1e-9
    ]


def sides_of(workspace: Array, point: Array) -> list[Side]:
    """The sides that a point is on."""
    reach = ON_BORDER * float((workspace[1] - workspace[0]).max())
    return [(k, upper) for k, upper in SIDES if abs(point[k] - workspace[upper, k]) <= reach]


def surface_route(
    workspace: Array, start: Array, end: Array, *, sides: list[Side] | None = None
) -> list[Array]:
    """A short way over the surface of a box: straight over each side, over one edge or two.

    Args:
        workspace: Two opposite corners, shape `(2, 3)`.
        start: A place on the surface, shape `(3,)`.
        end: Another one.
        sides: Those that may be passed; all if not given.

    Returns:
        Places on edges that it goes by, and `end`; nothing if the tip is there.

    Raises:
        ValueError: An end that is on none of these sides.
    """
    if np.array_equal(start, end):
        return []
    passable = SIDES if sides is None else sides
    here, there = (
        _passable(name, point, [side for side in sides_of(workspace, point) if side in passable])
        for name, point in (("start", start), ("end", end))
    )
    ways: list[list[Array]] = []
    for first, last in product(here, there):
        if first == last:
            return [end]
        if first[0] != last[0]:
            ways.append(_over(workspace, (start, end), [first, last]))
        else:
            # Where two opposite sides are open, so is one across: that which the axis enters most.
            between = [side for side in passable if side[0] != first[0]]
            ways += [_over(workspace, (start, end), [first, side, last]) for side in between]
    return min(ways, key=lambda way: round(length_of([start, *way]), 9))


def _passable(name: str, point: Array, sides: list[Side]) -> list[Side]:
    if not sides:
        raise ValueError(
            f"{name}: is on no side of the workspace that allowed directions enter (got {point.tolist()}); "
            "bring the tip to one of these"
        )
    return sides


def _over(workspace: Array, ends: tuple[Array, Array], sides: list[Side]) -> list[Array]:
    """Over sides one after the other, straight where they are unfolded into one plane."""
    start, end = ends
    # How far it is, on each side, square to the edges that are passed.
    edges = [*pairwise(sides)]
    spans = [abs(start[edges[0][1][0]] - _at(workspace, edges[0][1]))]
    spans += [abs(_at(workspace, edges[1][1]) - _at(workspace, edges[0][0]))] if len(edges) == 2 else []
    spans.append(abs(end[edges[-1][0][0]] - _at(workspace, edges[-1][0])))
    total = math.fsum(spans)
    passed = np.cumsum(spans)[:-1]
    along = ({0, 1, 2} - {axis for axis, _ in sides}).pop()
    points: list[Array] = []
    for (one, other), gone in zip(edges, passed, strict=True):
        point = np.empty(3)
        point[one[0]], point[other[0]] = _at(workspace, one), _at(workspace, other)
        share = gone / total if total else 0.0
        point[along] = start[along] + share * (end[along] - start[along])
        points.append(point)
    kept = [point for k, point in enumerate(points) if not np.array_equal(point, [start, *points][k])]
    return [*kept, *([] if kept and np.array_equal(kept[-1], end) else [end])]


def _at(workspace: Array, side: Side) -> float:
    return float(workspace[side[1], side[0]])
