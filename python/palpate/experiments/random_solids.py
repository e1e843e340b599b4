"""Random solids that are made here: boxes, prisms, brackets, stairs, frusta, convex hulls."""

from __future__ import annotations

import numpy as np

from .solids import Array, Numbers, Solid

Random = np.random.Generator

ACROSS = 200.0


def prism(name: str, outline: Array, height: float, *, top: Array | None = None) -> Solid:
    """Over a simple outline `(n, 2)`, counter-clockwise, from z = 0 to `height`, where it is `top`."""
    count = len(outline)
    upper = outline if top is None else top
    vertices = np.concatenate(
        [np.column_stack([outline, np.zeros(count)]), np.column_stack([upper, np.full(count, height)])]
    )
    caps = ears(outline)
    around = np.arange(count)
    after = (around + 1) % count
    sides = [
        np.stack([around, after, after + count], axis=1),
        np.stack([around, after + count, around + count], axis=1),
    ]
    return Solid(name, vertices, np.concatenate([caps[:, ::-1], caps + count, *sides]))


def ears(outline: Array) -> Numbers:
    """A simple polygon, counter-clockwise, cut into triangles."""
    left = list(range(len(outline)))
    triangles = []
    while len(left) > 3:
        # The largest first: a sliver now may leave no ear later.
        ears_now = [k for k in range(len(left)) if _is_ear(outline, left, k)]
        at = max(ears_now, key=lambda k: _turn(*outline[[left[k - 1], left[k], left[(k + 1) % len(left)]]]))
        triangles.append([left[at - 1], left[at], left[(at + 1) % len(left)]])
        del left[at]
    return np.array([*triangles, left], dtype=np.int64)


def _is_ear(outline: Array, left: list[int], at: int) -> bool:
    corner = [left[at - 1], left[at], left[(at + 1) % len(left)]]
    a, b, c = outline[corner]
    if _turn(a, b, c) <= 0.0:
        return False
    others = [outline[k] for k in left if k not in corner]
    return not any(_turn(a, b, p) >= 0.0 and _turn(b, c, p) >= 0.0 and _turn(c, a, p) >= 0.0 for p in others)


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def random_solid(random: Random) -> Solid:
    """One of a random family, 200 across."""
    family = FAMILIES[int(random.integers(len(FAMILIES)))]
    return family(random).moved_to(ACROSS)


def _box(random: Random) -> Solid:
    """All its symmetries at times: sides in simple ratios."""
    a, b, c = random.choice([50.0, 75.0, 100.0, 100.0], size=3)
    if random.random() < 0.5:
        a, b, c = a * random.uniform(0.8, 1.2), b * random.uniform(0.8, 1.2), c
    return prism("box", np.array([[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]]), float(c))


def _star(random: Random) -> Solid:
    count = int(random.integers(3, 12))
    angles = 2.0 * np.pi * (np.arange(count) + 0.6 * random.random(count)) / count
    radii = random.uniform(40.0, 100.0, size=count)
    outline = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    return prism("star", outline, float(random.uniform(20.0, 150.0)))


def _bracket(random: Random) -> Solid:
    a, b = random.uniform(60.0, 100.0, size=2)
    s, t = random.uniform(10.0, 30.0, size=2)
    outline = np.array([[0.0, 0.0], [a, 0.0], [a, s], [t, s], [t, b], [0.0, b]])
    return prism("bracket", outline, float(random.uniform(20.0, 80.0)))


def _stairs(random: Random) -> Solid:
    """Many parallel faces: what explains data on one explains it on others."""
    steps = int(random.integers(2, 6))
    run, rise = random.uniform(10.0, 25.0, size=2)
    # From the top left, each tread ends where the next riser begins.
    treads = [point for k in range(steps) for point in ((k, steps - k), (k + 1, steps - k))]
    outline = [(0, -1), (steps, -1), *reversed(treads)]
    # Cut into triangles while its numbers are whole: many corners are on one line.
    unit = prism("stairs", np.array(outline, dtype=float), 1.0)
    return Solid("stairs", unit.vertices * [run, rise, random.uniform(20.0, 80.0)], unit.triangles)


def _frustum(random: Random) -> Solid:
    count = int(random.integers(3, 9))
    angles = 2.0 * np.pi * np.arange(count) / count
    outline = 80.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    share = float(random.uniform(0.3, 0.9))
    return prism("frustum", outline, float(random.uniform(40.0, 150.0)), top=share * outline)


def _hull(random: Random) -> Solid:
    """Of points on an ellipsoid, with no two faces alike."""
    count = int(random.integers(6, 24))
    points = random.normal(size=(count, 3))
    points *= random.uniform(40.0, 100.0, size=3) / np.linalg.norm(points, axis=1, keepdims=True)
    return Solid("hull", points, _hull_of(points))


def _hull_of(points: Array) -> Numbers:
    """Triangles of the convex hull of points in general position: all others on one side."""
    i, j, k = np.array(
        [
            (a, b, c)
            for a in range(len(points))
            for b in range(a + 1, len(points))
            for c in range(b + 1, len(points))
        ]
    ).T
    normals = np.cross(points[j] - points[i], points[k] - points[i])
    heights = np.einsum("tni,ti->tn", points[None] - points[i, None], normals)
    for corner in (i, j, k):
        heights[np.arange(len(i)), corner] = 0.0
    out, inward = (heights <= 0.0).all(axis=1), (heights >= 0.0).all(axis=1)
    return np.concatenate([np.stack([i, j, k], axis=1)[out], np.stack([i, k, j], axis=1)[inward]]).astype(
        np.int64
    )


FAMILIES = (_box, _star, _bracket, _stairs, _frustum, _hull)
