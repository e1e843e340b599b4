"""A planar model as plain arrays, and distances to it: what the checks measure with, apart from the core."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from palpate import Model

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def wrap(angle: Array) -> Array:
    """Angles brought into `[-π, π)`."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@dataclass(frozen=True)
class Shape:
    """Faces and corners of a model; normals and cones are worked out here, from the ends of the faces.

    `starts`, `ends` and `normals` have shape `(f, 2)`, `corners` `(v, 2)`, model frame. The outward normals
    of a corner are within `cone_halves` of `cone_middles`; it can be touched where `touchable_corners`.
    """

    model: Model
    starts: Array
    ends: Array
    normals: Array
    touchable_faces: Mask
    solid_faces: Mask
    corners: Array
    touchable_corners: Mask
    cone_middles: Array
    cone_halves: Array

    @classmethod
    def of(cls, model: Model) -> Shape:
        """The shape of a model, from the ends of its faces and what they are to a probe."""
        faces = np.array(model.faces)
        starts, ends = faces[:, 0], faces[:, 1]
        along = (ends - starts) / np.linalg.norm(ends - starts, axis=1, keepdims=True)
        surfaces = np.array(model.face_surfaces)
        touchable = surfaces == "touchable"
        corners = np.array(model.vertices).reshape(-1, 2)
        open_corners, middles, halves = _cones(corners, faces, surfaces, size=model.size)
        return cls(
            model=model,
            starts=starts,
            ends=ends,
            normals=np.stack([along[:, 1], -along[:, 0]], axis=1),
            touchable_faces=touchable,
            solid_faces=surfaces != "seam",
            corners=corners,
            touchable_corners=open_corners,
            cone_middles=middles,
            cone_halves=halves,
        )

    @cached_property
    def normal_angles(self) -> Array:
        """Directions of the faces' normals, shape `(f,)`."""
        return np.arctan2(self.normals[:, 1], self.normals[:, 0])

    @cached_property
    def lengths(self) -> Array:
        """Of the faces, shape `(f,)`."""
        return np.linalg.norm(self.ends - self.starts, axis=1)

    @cached_property
    def solid(self) -> tuple[Array, Array]:
        """Starts and ends of the faces that are there."""
        return self.starts[self.solid_faces], self.ends[self.solid_faces]

    @cached_property
    def symmetries(self) -> list[tuple[Array, list[int], list[int]]]:
        """Each motion of the model onto itself, and to which face and corner it takes each."""
        faces = np.concatenate([self.starts, self.ends], axis=1)
        corners = np.concatenate([self.corners, self.corners], axis=1)
        motions = np.array(self.model.symmetries)
        return [(motion, _images(faces, motion), _images(corners, motion)) for motion in motions]


def _images(marks: Array, motion: Array) -> list[int]:
    """Numbers of the marks, two points each, shape `(m, 4)`, on which the motion brings each of them."""
    moved = np.concatenate(
        [part @ motion[:2, :2].T + motion[:2, 2] for part in (marks[:, :2], marks[:, 2:])], axis=1
    )
    gaps = np.linalg.norm(moved[:, None] - marks[None], axis=2)
    return [int(k) for k in np.argmin(gaps, axis=1)]


def _cones(
    corners: Array, faces: Array, surfaces: NDArray[np.str_], *, size: float
) -> tuple[Mask, Array, Array]:
    """Which corners can be touched, and the middles and halves of their cones of normals."""
    there = surfaces != "seam"
    near = 1e-9 * size
    touchable = np.zeros(len(corners), dtype=bool)
    middles, halves = np.zeros(len(corners)), np.zeros(len(corners))
    for number, corner in enumerate(corners):
        ending = np.flatnonzero(there & (np.linalg.norm(faces[:, 1] - corner, axis=1) <= near))
        starting = np.flatnonzero(there & (np.linalg.norm(faces[:, 0] - corner, axis=1) <= near))
        if len(ending) != 1 or len(starting) != 1:
            continue
        before, after = (faces[k][1] - faces[k][0] for k in (ending[0], starting[0]))
        turn = math.atan2(before[0] * after[1] - before[1] * after[0], before @ after)
        both = surfaces[ending[0]] == surfaces[starting[0]] == "touchable"
        touchable[number] = both and turn > 0.0
        first = math.atan2(-before[0], before[1])
        middles[number], halves[number] = first + 0.5 * turn, 0.5 * abs(turn)
    return touchable, middles, halves


def point_distances(points: Array, starts: Array, ends: Array) -> Array:
    """From each of `points` `(..., 2)` to each of the segments `(f, 2)`; shape `(..., f)`."""
    span = ends - starts
    offset = points[..., None, :] - starts
    along = np.einsum("...fk,fk->...f", offset, span) / np.einsum("fk,fk->f", span, span)
    gap = offset - np.clip(along, 0.0, 1.0)[..., None] * span
    return np.hypot(gap[..., 0], gap[..., 1])


def inside(shape: Shape, points: Array) -> Mask:
    """Whether points `(..., 2)` are in the material of a closed model; never in an open one."""
    if not shape.model.closed:
        return np.zeros(points.shape[:-1], dtype=bool)
    starts, ends = shape.solid
    x, y = points[..., None, 0], points[..., None, 1]
    straddles = (starts[:, 1] > y) != (ends[:, 1] > y)
    rise = np.where(ends[:, 1] == starts[:, 1], 1.0, ends[:, 1] - starts[:, 1])
    at = starts[:, 0] + (y - starts[:, 1]) / rise * (ends[:, 0] - starts[:, 0])
    crossed: Mask = (np.sum(straddles & (x < at), axis=-1) % 2).astype(bool)
    return crossed


def signed_distances(shape: Shape, points: Array) -> Array:
    """To the outline, negative in the material of a closed model; points `(..., 2)`, shape `(...)`."""
    nearest = point_distances(points, *shape.solid).min(axis=-1)
    return np.where(inside(shape, points), -nearest, nearest)
