"""How near a swept segment comes to a part: the least signed distance over the segment."""

from __future__ import annotations

import numpy as np

from .shapes import Array, Shape, inside, point_distances

#: The least distance is found to this share of the part's size.
SHARE = 1e-10


def least_distances(shape: Shape, starts: Array, ends: Array) -> Array:
    """The least signed distance to the part over each segment, model frame; `(..., 2)` both, shape `(...)`.

    Outside, the nearest points of two segments that do not cross include an end of one of them. Inside, it is
    the greatest depth.
    """
    faces = shape.solid
    to_faces = np.minimum(point_distances(starts, *faces), point_distances(ends, *faces)).min(axis=-1)
    corners = np.concatenate(faces)
    least = np.minimum(to_faces, _corner_distances(corners, starts, ends))
    crossing = np.any(_crosses(shape, starts, ends), axis=-1)
    least = np.where(crossing, 0.0, least)
    if shape.model.closed:
        deep = crossing | inside(shape, starts) | inside(shape, ends)
        for at in np.argwhere(deep):
            place = tuple(at)
            least[place] = -depth(shape, starts[place], ends[place])
    return least


def _corner_distances(corners: Array, starts: Array, ends: Array) -> Array:
    """From the nearest of the corners `(c, 2)` to each segment."""
    span = (ends - starts)[..., None, :]
    offset = corners - starts[..., None, :]
    length_sq = np.maximum((span * span).sum(axis=-1), 1e-300)
    along = np.clip((offset * span).sum(axis=-1) / length_sq, 0.0, 1.0)
    gap = offset - along[..., None] * span
    return np.hypot(gap[..., 0], gap[..., 1]).min(axis=-1)


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _crosses(shape: Shape, starts: Array, ends: Array) -> np.ndarray:
    """Whether each segment `(..., 2)` crosses each face that is there; shape `(..., f)`."""
    first, last = shape.solid
    p, q = starts[..., None, :], ends[..., None, :]
    apart = _cross(last - first, p - first) * _cross(last - first, q - first) < 0.0
    astride = _cross(q - p, first - p) * _cross(q - p, last - p) < 0.0
    return np.asarray(apart & astride)


def depth(shape: Shape, start: Array, end: Array) -> float:
    """How deep in the part a segment reaches, at most; zero if it stays outside.

    The distance to each face is convex along the segment, so that between two points it is no more than at
    the farther one: the least of these over all faces bounds the depth between them.
    """
    faces = shape.solid
    span = end - start
    sides = _cross(faces[1] - faces[0], span)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossings = -_cross(faces[1] - faces[0], start - faces[0]) / sides
    crossings = crossings[np.isfinite(crossings) & (crossings > 0.0) & (crossings < 1.0)]
    marks = np.unique(np.concatenate([[0.0], crossings, [1.0]]))
    middles = start + 0.5 * (marks[1:] + marks[:-1])[:, None] * span
    within = inside(shape, middles)
    low, high = marks[:-1][within], marks[1:][within]
    deepest = 0.0
    finest = SHARE * shape.model.size
    while len(low):
        middle = 0.5 * (low + high)
        at = [point_distances(start + t[:, None] * span, *faces) for t in (low, middle, high)]
        deepest = max(deepest, max(float(distances.min(axis=1).max()) for distances in at))
        bounds = [np.maximum(at[k], at[k + 1]).min(axis=1) > deepest + finest for k in (0, 1)]
        low, high = (
            np.concatenate([low[bounds[0]], middle[bounds[1]]]),
            np.concatenate([middle[bounds[0]], high[bounds[1]]]),
        )
    return deepest
