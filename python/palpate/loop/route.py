"""Ways of the tip between guarded moves: back as it came, then along the perimeter (thesis 4.1)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]

ON_BORDER = 1e-9  # of the larger side: a place so near to the border is on it


def workspace_of(workspace: ArrayLike, dimension: int = 2) -> Array:
    """The corners with the least and the largest coordinates, shape `(2, d)`, of a rectangle or a box.

    Raises:
        ValueError: Another shape, no area or volume, a number that is not finite.
    """
    try:
        corners = np.array(workspace, dtype=float)
    except (TypeError, ValueError):
        corners = np.array([])
    good = corners.shape == (2, dimension) and np.isfinite(corners).all()
    if not good or (corners[0] == corners[1]).any():
        what, example = {
            2: ("an area", "[[x0, y0], [x1, y1]]"),
            3: ("a volume", "[[x0, y0, z0], [x1, y1, z1]]"),
        }[dimension]
        raise ValueError(
            f"workspace: must be two opposite corners with {what}, shape (2, {dimension}) "
            f"(got {workspace!r}); give {example}"
        )
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def perimeter_route(workspace: ArrayLike, start: ArrayLike, end: ArrayLike) -> list[Array]:
    """The shorter way along the perimeter of the workspace; counter-clockwise if both are equally long.

    Args:
        workspace: Two opposite corners, shape `(2, 2)`, world frame.
        start: A place on the perimeter, shape `(2,)`.
        end: Another one.

    Returns:
        The corners on the way, and `end`; nothing if the tip is there.

    Raises:
        ValueError: A place that is not on the perimeter, a workspace without area.
    """
    corners = workspace_of(workspace)
    places = [_place_of(name, corners, point) for name, point in (("start", start), ("end", end))]
    total = 2.0 * float((corners[1] - corners[0]).sum())
    forth = (places[1] - places[0]) % total
    finish = np.array(end, dtype=float)
    if min(forth, total - forth) <= ON_BORDER * total:
        return [] if np.array_equal(np.asarray(start, dtype=float), finish) else [finish]
    ahead = forth <= total - forth
    way = forth if ahead else total - forth
    gone = {
        ((at - places[0]) % total if ahead else (places[0] - at) % total): corner
        for at, corner in _corners(corners)
    }
    between = [
        gone[distance] for distance in sorted(gone) if ON_BORDER * total < distance < way * (1.0 - 1e-12)
    ]
    return [*between, finish]


def nearest_on_border(workspace: Array, point: Array) -> Array | None:
    """The nearest place of the border to a point on it or outside of it; None for a point inside."""
    low, high = workspace
    reach = ON_BORDER * float((high - low).max())
    if ((point > low + reach) & (point < high - reach)).all():
        return None
    return np.clip(point, low, high)


def on_border(workspace: Array, point: Array) -> bool:
    """Whether a point is on the border."""
    nearest = nearest_on_border(workspace, point)
    reach = ON_BORDER * float((workspace[1] - workspace[0]).max())
    return nearest is not None and math.dist(nearest, point) <= reach


def rest_of(points: Sequence[Array], position: Array, *, within: float) -> list[Array] | None:
    """What is left of a polyline for a tip that stopped somewhere on it; None if it is nowhere near."""
    for k in range(len(points) - 1, 0, -1):
        start, way = points[k - 1], points[k] - points[k - 1]
        length_sq = float(way @ way)
        share = float(np.clip((position - start) @ way / length_sq, 0.0, 1.0)) if length_sq else 0.0
        if math.dist(start + share * way, position) <= within:
            return list(points[k:])
    return None


def length_of(points: Sequence[Array]) -> float:
    """The length of a polyline."""
    return math.fsum(math.dist(a, b) for a, b in pairwise(points))


def _corners(workspace: Array) -> list[tuple[float, Array]]:
    """Corners with their places along the perimeter, counter-clockwise from the lower left one."""
    (x0, y0), (x1, y1) = workspace
    width, height = x1 - x0, y1 - y0
    places = (0.0, width, width + height, 2.0 * width + height)
    return list(zip(places, (np.array(c) for c in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))), strict=True))


def _place_of(name: str, workspace: Array, point: ArrayLike) -> float:
    """How far along the perimeter a point is, counter-clockwise from the lower left corner."""
    at = np.array(point, dtype=float)
    if at.shape != (2,) or not np.isfinite(at).all() or not on_border(workspace, at):
        raise ValueError(
            f"{name}: must be on the perimeter of the workspace (got {point!r}); "
            "give a point with x or y of a corner of it"
        )
    (x0, y0), (x1, y1) = workspace
    width, height = float(x1 - x0), float(y1 - y0)
    x, y = (float(v) for v in np.clip(at, workspace[0], workspace[1]) - workspace[0])
    sides = (
        (y, x),
        (width - x, width + y),
        (height - y, 2.0 * width + height - x),
        (x, 2.0 * (width + height) - y),
    )
    return min(sides, key=lambda side: side[0])[1]
