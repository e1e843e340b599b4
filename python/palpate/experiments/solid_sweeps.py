"""How near points and segments come to triangles: exactly, but for a sweep through a solid."""

from __future__ import annotations

import numpy as np

from .solids import Array, Solid, winding

#: Points on a segment that passes through the part, at which its depth is asked.
NUM_POINTS = 257


def least_distances(solid: Solid, start: Array, end: Array) -> tuple[float, float]:
    """Bounds of the least signed distance to the part on a segment, model frame; negative inside.

    To a part that isn't watertight distances have no sign.
    """
    inside = solid.watertight and winding(solid, start[None])[0] > 0.5
    apart = unsigned(solid, start, end)
    if apart > 0.0 and not inside:
        return apart, apart
    if not solid.watertight:
        return 0.0, 0.0
    points = np.linspace(start, end, NUM_POINTS)
    depths = np.where(winding(solid, points) > 0.5, -point_distances(solid, points), 0.0)
    high = min(0.0, float(depths.min()))
    return high - 0.5 * float(np.linalg.norm(end - start)) / (NUM_POINTS - 1), high


def point_distances(solid: Solid, points: Array) -> Array:
    """Unsigned, of points `(n, 3)` to the surface."""
    return np.array(
        [to_triangles(np.broadcast_to(p, (len(solid.corners), 3)), solid.corners).min() for p in points]
    )


def unsigned(solid: Solid, start: Array, end: Array) -> float:
    """Distance of a segment to the surface; 0 where it crosses it."""
    a, b, c = np.moveaxis(solid.corners, 1, 0)
    if _crosses(solid, start, end):
        return 0.0
    count = len(a)
    least = min(
        float(to_triangles(np.broadcast_to(point, (count, 3)), solid.corners).min()) for point in (start, end)
    )
    for first, second in ((a, b), (b, c), (c, a)):
        least = min(least, float(between_segments(start, end, first, second).min()))
    return least


def _crosses(solid: Solid, start: Array, end: Array) -> bool:
    """Whether a segment passes through a triangle: its ends on two sides of it, and it within."""
    a, b, c = np.moveaxis(solid.corners, 1, 0)
    heights = [np.einsum("ti,ti->t", point - a, solid.normals) for point in (start, end)]
    two_sides = heights[0] * heights[1] <= 0.0
    way = end - start
    turns = [
        np.einsum("i,ti->t", way, np.cross(first - start, second - start))
        for first, second in ((a, b), (b, c), (c, a))
    ]
    same = np.all([turn >= 0.0 for turn in turns], axis=0) | np.all([turn <= 0.0 for turn in turns], axis=0)
    flat = np.abs(np.einsum("i,ti->t", way, solid.normals)) <= 1e-14 * np.linalg.norm(way)
    return bool((two_sides & same & ~flat & (solid.areas > 0.0)).any())


def between_segments(  # noqa: PLR0917 - two kinds of segments by their ends
    start: Array, end: Array, starts: Array, ends: Array
) -> Array:
    """Distances of a segment to others, `(n, 3)`: where their lines are nearest, or at ends."""
    way, ways = end - start, ends - starts
    count = len(starts)
    best = np.minimum(
        to_segments(np.broadcast_to(start, (count, 3)), starts, ends),
        to_segments(np.broadcast_to(end, (count, 3)), starts, ends),
    )
    mine = np.broadcast_to(start, (count, 3)), np.broadcast_to(end, (count, 3))
    best = np.minimum(best, np.minimum(to_segments(starts, *mine), to_segments(ends, *mine)))
    normal = np.cross(way, ways)
    square = np.einsum("ni,ni->n", normal, normal)
    gap = starts - start
    safe = np.maximum(square, 1e-300)
    at_mine = np.einsum("ni,ni->n", np.cross(gap, ways), normal) / safe
    at_other = np.einsum("ni,ni->n", np.cross(gap, way[None]), normal) / safe
    within = (square > 0.0) & (at_mine >= 0) & (at_mine <= 1) & (at_other >= 0) & (at_other <= 1)
    apart = np.abs(np.einsum("ni,ni->n", gap, normal)) / np.sqrt(safe)
    return np.asarray(np.where(within, np.minimum(best, apart), best))


def to_triangles(points: Array, corners: Array) -> Array:
    """Distances of points `(n, 3)` to as many triangles `(n, 3, 3)`."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    inside = np.ones(len(points), dtype=bool)
    best = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ni,ni->n", np.cross(normal, end - start), points - start) >= 0.0
        best = np.minimum(best, to_segments(points, start, end))
    height = np.abs(np.einsum("ni,ni->n", points - a, normal))
    return np.asarray(np.where(inside, height, best))


def to_segments(points: Array, starts: Array, ends: Array) -> Array:
    """Distances of points to segments, both `(n, 3)`."""
    along = ends - starts
    squares = np.maximum(np.einsum("ni,ni->n", along, along), 1e-300)
    share = np.clip(np.einsum("ni,ni->n", points - starts, along) / squares, 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - starts - share[:, None] * along, axis=1))
