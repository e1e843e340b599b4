"""How near points and segments come to triangles: exactly, but for a sweep through a solid.

Triangles that are too far away to matter are told by the balls about them, before distances are worked out:
this changes no answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from .solids import Array, Mask, Numbers, Solid, winding

#: Points on a segment that passes through the part, at which its depth is asked; and of how many one is asked
#: first.
NUM_POINTS, EVERY = 257, 16
#: Pairs of a point or segment and a triangle whose distance is worked out at once.
MOST_AT_ONCE = 100_000
#: What rounding may add to a distance, as a share of it and of the largest ball.
ROUNDING = 1e-9


def least_distances(solid: Solid, start: Array, end: Array) -> tuple[float, float]:
    """Bounds of the least signed distance to the part on a segment, model frame; negative inside.

    To a part that isn't watertight distances have no sign.
    """
    apart = outside(solid, start, end)
    if apart > 0.0 or not solid.watertight:
        return apart, apart
    high = min(0.0, -_deepest(solid, start, end))
    return high - _half_step(start, end), high


def outside(solid: Solid, start: Array, end: Array) -> float:
    """Distance of a segment to the part, model frame; 0 where it crosses the surface or is inside."""
    inside = _inside(solid, start[None])[0]
    return 0.0 if inside else float(_unsigned(solid, start[None], end[None], most=math.inf)[0])


def keep_off(solid: Solid, starts: Array, ends: Array, *, least: float, cautious: bool) -> Mask:
    """Whether the least signed distance on segments `(p, 3)`, model frame, is `least` or more; `(p,)`.

    By the lower of the bounds of `least_distances` if `cautious`, else by the higher.
    """
    apart = _unsigned(solid, starts, ends, most=max(0.0, least))
    held = (apart > 0.0) & (apart >= least)
    held[held] = ~_inside(solid, starts[held])
    if least > 0.0:
        return np.asarray(held)
    for number in np.flatnonzero(~held):
        start, end = starts[number], ends[number]
        allowed = -least - (_half_step(start, end) if cautious else 0.0)
        held[number] = not solid.watertight or (
            allowed >= 0.0 and _deepest(solid, start, end, enough=allowed) <= allowed
        )
    return np.asarray(held)


def _half_step(start: Array, end: Array) -> float:
    return 0.5 * float(np.linalg.norm(end - start)) / (NUM_POINTS - 1)


def _inside(solid: Solid, points: Array) -> Mask:
    """Whether a part holds points `(n, 3)`; one that isn't watertight holds none."""
    low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    held = ((points >= low) & (points <= high)).all(axis=1) & solid.watertight
    held[held] = winding(solid, points[held]) > 0.5
    return np.asarray(held)


def _deepest(solid: Solid, start: Array, end: Array, *, enough: float = math.inf) -> float:
    """How deep inside the deepest of some points on a segment is; minus infinity if none is.

    Or the depth of another point, if it is more than enough.
    """
    points = np.linspace(start, end, NUM_POINTS)
    for some in (points[::EVERY], points):
        deepest = float(_depths(solid, some).max())
        if deepest > enough:
            break
    return deepest


def _depths(solid: Solid, points: Array) -> Array:
    """Of points on a line, in order, `(n, 3)`: distances to the surface, minus infinity outside."""
    distances = point_distances(solid, points)
    # No surface is between neighbours one of which is farther from it than from the other: both are inside or
    # neither is, so that the first of such a run tells of all.
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    begins = np.concatenate([[True], np.maximum(distances[1:], distances[:-1]) <= 1.001 * steps])
    inside = _inside(solid, points[begins])[np.cumsum(begins) - 1]
    return np.where(inside, distances, -math.inf)


def point_distances(solid: Solid, points: Array) -> Array:
    """Unsigned, of points `(n, 3)` to the surface; `(n,)`."""
    middles, radii = solid.balls
    apart = np.linalg.norm(points[:, None] - middles, axis=2)
    return nearest(apart, radii, lambda some, triangle: to_triangles(points[some], solid.corners[triangle]))


def _unsigned(solid: Solid, starts: Array, ends: Array, *, most: float) -> Array:
    """Of segments `(n, 3)` to the surface, 0 where they cross it; `(n,)`. As `nearest` says of `most`."""
    middles, radii = solid.balls

    def exact(some: Numbers, triangle: Numbers) -> Array:
        return segments_to_triangles(starts[some], ends[some], solid.corners[triangle])

    return nearest(to_segments(middles, starts[:, None], ends[:, None]), radii, exact, most)


def nearest(  # noqa: PLR0917 - bounds, how to know better, and where that is of no use
    apart: Array, radii: Array, exact: Callable[[Numbers, Numbers], Array], most: float = math.inf
) -> Array:
    """The least distance of each of `n` things to any of `t` others; `(n,)`.

    Args:
        apart: To the middles of balls that hold the others, `(n, t)`; infinite for pairs that don't count.
        radii: Of these balls, `(t,)`.
        exact: Distances of pairs, of their numbers of both kinds.
        most: What is more than this may be told as any more than that.
    """
    reach = np.minimum(most, (apart + radii).min(axis=1, initial=math.inf))[:, None]
    near = apart - radii <= reach + ROUNDING * (reach + radii.max(initial=0.0))
    # Infinity is not nearer than infinity.
    numbers, others = np.nonzero(near & np.isfinite(apart))
    best = np.full(len(apart), np.inf)
    for first in range(0, len(numbers), MOST_AT_ONCE):
        some, other = numbers[first : first + MOST_AT_ONCE], others[first : first + MOST_AT_ONCE]
        np.minimum.at(best, some, exact(some, other))
    return best


def segments_to_triangles(starts: Array, ends: Array, corners: Array) -> Array:
    """Distances of segments `(n, 3)` to as many triangles `(n, 3, 3)`; 0 where they cross."""
    a, b, c = np.moveaxis(corners, 1, 0)
    best = np.minimum(to_triangles(starts, corners), to_triangles(ends, corners))
    for first, second in ((a, b), (b, c), (c, a)):
        best = np.minimum(best, between_segments(starts, ends, first, second))
    return np.where(_cross(starts, ends, corners), 0.0, best)


def _cross(starts: Array, ends: Array, corners: Array) -> Mask:
    """Whether segments pass through triangles: their ends on two sides of them, and they within."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    heights = [np.einsum("ni,ni->n", points - a, normals) for points in (starts, ends)]
    two_sides = heights[0] * heights[1] <= 0.0
    ways = ends - starts
    turns = [
        np.einsum("ni,ni->n", ways, np.cross(first - starts, second - starts))
        for first, second in ((a, b), (b, c), (c, a))
    ]
    same = np.all([turn >= 0.0 for turn in turns], axis=0) | np.all([turn <= 0.0 for turn in turns], axis=0)
    flat = np.abs(np.einsum("ni,ni->n", ways, normals)) <= 1e-14 * lengths * np.linalg.norm(ways, axis=1)
    return np.asarray(two_sides & same & ~flat & (lengths > 0.0))


def between_segments(  # noqa: PLR0917 - two kinds of segments by their ends
    start: Array, end: Array, starts: Array, ends: Array
) -> Array:
    """Distances of segments to others, all `(n, 3)`: where their lines are nearest, or at ends."""
    way, ways = end - start, ends - starts
    best = np.minimum(to_segments(start, starts, ends), to_segments(end, starts, ends))
    best = np.minimum(best, np.minimum(to_segments(starts, start, end), to_segments(ends, start, end)))
    normal = np.cross(way, ways)
    square = np.einsum("ni,ni->n", normal, normal)
    gap = starts - start
    safe = np.maximum(square, 1e-300)
    at_mine = np.einsum("ni,ni->n", np.cross(gap, ways), normal) / safe
    at_other = np.einsum("ni,ni->n", np.cross(gap, way), normal) / safe
    within = (square > 0.0) & (at_mine >= 0) & (at_mine <= 1) & (at_other >= 0) & (at_other <= 1)
    apart = np.abs(np.einsum("ni,ni->n", gap, normal)) / np.sqrt(safe)
    return np.asarray(np.where(within, np.minimum(best, apart), best))


def to_triangles(points: Array, corners: Array) -> Array:
    """Distances of points `(n, 3)` to as many triangles `(n, 3, 3)`."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(length, 1e-300)[:, None]
    inside = length > 0.0
    best = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ni,ni->n", np.cross(normal, end - start), points - start) >= 0.0
        best = np.minimum(best, to_segments(points, start, end))
    height = np.abs(np.einsum("ni,ni->n", points - a, normal))
    return np.asarray(np.where(inside, height, best))


def to_segments(points: Array, starts: Array, ends: Array) -> Array:
    """Distances of points to segments, all `(..., 3)`."""
    along = ends - starts
    squares = np.maximum(np.einsum("...i,...i->...", along, along), 1e-300)
    share = np.clip(np.einsum("...i,...i->...", points - starts, along) / squares, 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - starts - share[..., None] * along, axis=-1))
