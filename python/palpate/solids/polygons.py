"""Faces with more than three corners, made into triangles.

A fan serves where a face is convex. Others are cut by their ears: a fan over them would leave the face.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from palpate.contacts.entry import refuse
from palpate.solids.mesh import Array, Numbers, check_count, said


def triangulated(file: str, points: Array, polygons: Sequence[Sequence[int]] | Numbers) -> Numbers:
    """The triangles of polygons, in their order, shape `(m, 3)`.

    Args:
        file: Its name, for messages.
        points: Shape `(n, 3)`; the polygons name them from 0.
        polygons: Three or more corners each.

    Raises:
        ValueError: A polygon of fewer corners, of corners that are not there, or one that crosses itself.
    """
    if not len(polygons):
        return np.empty((0, 3), dtype=np.int64)
    sizes = np.array([len(polygon) for polygon in polygons])
    if np.min(sizes) < 3:
        place = int(np.argmin(sizes))
        refuse(file, f"face {place} has {sizes[place]} corner(s)", "export the part again")
    check_count(file, int(np.sum(sizes - 2)))
    found: list[Numbers] = []
    places: list[Numbers] = []
    for size in np.unique(sizes):
        chosen = np.flatnonzero(sizes == size)
        try:
            numbers = np.array([polygons[int(k)] for k in chosen], dtype=np.int64)
        except OverflowError:
            numbers = np.full((len(chosen), size), -1, dtype=np.int64)
        stray = np.flatnonzero(np.any((numbers < 0) | (numbers >= len(points)), axis=1))
        if len(stray):
            refuse(
                file,
                f"face {chosen[stray[0]]} names a vertex that is not among the {len(points)} of the file",
                "the file may be cut off: export or copy it again",
            )
        triangles = _fans(numbers)
        if size > 3:
            for k in np.flatnonzero(~_convex(points[numbers])):
                cut = _ears(points[numbers[k]])
                if cut is None:
                    corner = said(points[numbers[k][0]])
                    refuse(file, f"the face at {corner} crosses itself", "export the part as triangles")
                triangles[k] = numbers[k][cut]
        found.append(triangles.reshape(-1, 3))
        places.append(np.repeat(chosen, size - 2))
    order = np.argsort(np.concatenate(places), kind="stable")
    return np.asarray(np.concatenate(found)[order])


def with_holes(loops: Sequence[Array]) -> Numbers:
    """Triangles of a polygon in the plane: numbers of the points of its loops in order, shape `(m, 3)`.

    Args:
        loops: The outline, counter-clockwise, then its holes, clockwise, each of shape `(k, 2)`, simple and
            apart from each other.

    Raises:
        ValueError: They do.
    """
    flat = np.concatenate(loops)
    starts = np.cumsum([0, *map(len, loops)])
    rings = [list(range(a, b)) for a, b in pairwise(starts.tolist())]
    outer, holes = rings[0], rings[1:]
    while holes:
        outer = _bridged(flat, outer, holes)
    cut = _ears_of(flat[outer])
    if cut is None:
        raise ValueError("loops: cross each other or themselves; give simple ones")
    return np.array(outer)[cut]


def _bridged(flat: Array, outer: list[int], holes: list[list[int]]) -> list[int]:
    """The outline with one of the holes, by the shortest way there and back; the hole is taken."""
    rings = [outer, *holes]
    starts = np.array([k for ring in rings for k in ring])
    ends = np.array([k for ring in rings for k in [*ring[1:], ring[0]]])
    ways = [
        (float(np.hypot(*(flat[a] - flat[b]))), at, hole, place)
        for hole, ring in enumerate(holes)
        for place, b in enumerate(ring)
        for at, a in enumerate(outer)
    ]
    for _, at, hole, place in sorted(ways):
        a, b = flat[outer[at]], flat[holes[hole][place]]
        # Where the outline already goes there and back, the bridge must leave between its two sides there.
        before, after = flat[outer[at - 1]], flat[outer[(at + 1) % len(outer)]]
        if not _leaves_between(before, a, after, b):
            continue
        if not _crosses(a, b, flat[starts], flat[ends]):
            ring = holes.pop(hole)
            return [*outer[: at + 1], *ring[place:], *ring[: place + 1], *outer[at:]]
    raise ValueError("loops: a hole is outside the outline or crosses it; give simple ones")


def _leaves_between(before: Array, at: Array, after: Array, to: Array) -> bool:  # noqa: PLR0917
    """Whether a way from a corner leads into what is left of the outline there."""
    if _turn(before, at, after) > 0.0:
        return _turn(before, at, to) > 0.0 and _turn(at, after, to) > 0.0
    return _turn(before, at, to) > 0.0 or _turn(at, after, to) > 0.0


def _crosses(a: Array, b: Array, starts: Array, ends: Array) -> bool:  # noqa: PLR0917
    """Whether a way meets a side anywhere but at ends that they share."""

    def sides(p: Array, q: Array, points: Array) -> Array:
        along, away = q - p, points - p
        return np.asarray(np.sign(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]))

    shared = np.zeros(len(starts), dtype=bool)
    for p in (a, b):
        shared |= np.all(starts == p, axis=1) | np.all(ends == p, axis=1)
    parted = sides(a, b, starts) * sides(a, b, ends) <= 0.0
    parting = sides(starts, ends, a) * sides(starts, ends, b) <= 0.0
    return bool(np.any(parted & parting & ~shared))


def _fans(numbers: Numbers) -> Numbers:
    """Shape `(k, n - 2, 3)` of corners `(k, n)`."""
    first = np.broadcast_to(numbers[:, :1], numbers[:, 1:-1].shape)
    return np.stack([first, numbers[:, 1:-1], numbers[:, 2:]], axis=2)


def _normals(corners: Array) -> Array:
    """Twice the area vectors of polygons, shape `(k, n, 3)` (Newell)."""
    away = corners - corners[:, :1]
    return np.asarray(np.sum(np.cross(away, np.roll(away, -1, axis=1)), axis=1))


def _convex(corners: Array) -> NDArray[np.bool_]:
    """Whether every corner turns the way of the whole polygon, and it goes round once."""
    normals = _normals(corners)
    along = np.roll(corners, -1, axis=1) - corners
    turns = np.einsum("kni,ki->kn", np.cross(np.roll(along, 1, axis=1), along), normals)
    # A polygon that goes round twice turns one way at every corner too; its fan has a triangle that doesn't.
    fan = np.cross(corners[:, 1:-1] - corners[:, :1], corners[:, 2:] - corners[:, :1])
    return np.asarray(
        np.all(turns > 0.0, axis=1) & np.all(np.einsum("kni,ki->kn", fan, normals) > 0.0, axis=1)
    )


def _ears(corners: Array) -> Numbers | None:
    """Triangles of a simple polygon `(n, 3)`, as numbers of its corners; None if it crosses itself."""
    normal = _normals(corners[None])[0]
    length = float(np.linalg.norm(normal))
    if length == 0.0:
        # Without area: a fan of nothing, which the core leaves out.
        return _fans(np.arange(len(corners))[None])[0]
    drop = int(np.argmax(np.abs(normal)))
    keep = [[1, 2], [2, 0], [0, 1]][drop]
    # Seen from the side to which its normal points.
    return _ears_of(corners[:, keep] * (math.copysign(1.0, normal[drop]), 1.0))


def _ears_of(flat: Array) -> Numbers | None:
    """The same of a polygon in the plane, counter-clockwise, shape `(n, 2)`."""
    left = list(range(len(flat)))
    cut: list[tuple[int, int, int]] = []
    while len(left) > 3:
        ear = _best_ear(flat, left)
        if ear is None:
            return None
        cut.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    a, b, c = left
    if _turn(flat[a], flat[b], flat[c]) < 0.0:
        return None
    cut.append((a, b, c))
    return np.array(cut, dtype=np.int64)


def _best_ear(flat: Array, left: list[int]) -> int | None:
    """The ear with the largest least height: slivers come last, or never."""
    points = flat[left]
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    sides = [points - before, after - points, before - after]
    longest = np.sqrt(np.max([np.sum(side**2, axis=1) for side in sides], axis=0))
    doubled = sides[0][:, 0] * sides[1][:, 1] - sides[0][:, 1] * sides[1][:, 0]
    heights = doubled / np.maximum(longest, np.finfo(float).tiny)
    for k in np.argsort(-heights, kind="stable"):
        if heights[k] <= 0.0:
            return None
        corners = (before[k], points[k], after[k])
        inside = np.ones(len(left), dtype=bool)
        for p, q in ((0, 1), (1, 2), (2, 0)):
            (x, y), (u, v) = corners[p], corners[q] - corners[p]
            inside &= u * (points[:, 1] - y) >= v * (points[:, 0] - x)
        # Corners of the ear are no obstacle, nor are others in their places.
        for corner in corners:
            inside &= np.any(points != corner, axis=1)
        if not np.any(inside):
            return int(k)
    return None


def _turn(a: Array, b: Array, c: Array) -> float:
    """Twice the area of a triangle, positive if it runs counter-clockwise."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
