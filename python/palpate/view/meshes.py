"""Triangles and lines of what is drawn, as arrays: prisms of planar parts, cones, balls, dashes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from ezdxf.math.triangulation import mapbox_earcut_2d
from numpy.typing import NDArray

from palpate._core import Model
from palpate.plots.solids import sharp_edges
from palpate.view.state import Array

Numbers = NDArray[np.int64]
SIDES = 24  # of a cone or a disc


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles, counter-clockwise as seen from outside."""

    vertices: Array
    """Shape `(n, 3)`."""
    triangles: Numbers
    """Shape `(m, 3)`."""


@lru_cache(maxsize=256)
def mesh_of(model: Model, thickness: float) -> Mesh:
    """A solid as it is; a part of the plane as a prism, from z = 0 upward. Loose edges have walls alone."""
    if model.dimension == 3:
        return Mesh(np.asarray(model.vertices), np.asarray(model.triangles, dtype=np.int64))
    faces = np.array(model.faces)
    walls = np.concatenate([_at(faces, 0.0), _at(faces, thickness)], axis=1)  # start, end; then above
    corners, triangles = [walls.reshape(-1, 3)], [_numbered([[0, 1, 3], [0, 3, 2]], len(faces), 4)]
    if model.closed:
        lid = _lid(model)
        for z, order in ((thickness, (0, 1, 2)), (0.0, (0, 2, 1))):
            first = sum(len(some) for some in corners)
            corners.append(_at(lid.reshape(-1, 2), z))
            triangles.append(first + np.arange(3 * len(lid)).reshape(-1, 3)[:, order])
    return Mesh(np.concatenate(corners), np.concatenate(triangles))


@lru_cache(maxsize=256)
def edges_of(model: Model, thickness: float) -> Array:
    """What is drawn as lines, shape `(n, 2, 3)`, model frame: an outline at the top, edges that are seen."""
    if model.dimension == 3:
        return np.asarray(model.vertices)[sharp_edges(model)]
    faces = np.array(model.faces)[[surface != "seam" for surface in model.face_surfaces]]
    return _at(faces, thickness)


def in_space(world_from_model: Array) -> Array:
    """Poses of the plane as poses of space, shape `(..., 4, 4)`; those of space as they are."""
    pose = np.asarray(world_from_model, dtype=float)
    if pose.shape[-1] == 4:
        return pose
    lifted = np.zeros((*pose.shape[:-2], 4, 4))
    lifted[..., :2, :2], lifted[..., :2, 3] = pose[..., :2, :2], pose[..., :2, 2]
    lifted[..., 2, 2] = lifted[..., 3, 3] = 1.0
    return lifted


def placed(poses: Array, points: Array) -> Array:
    """Points, shape `(..., 3)`, at each of some poses, shape `(n, 4, 4)`: shape `(n, ..., 3)`."""
    return np.einsum("nij,...j->n...i", poses[:, :3, :3], points) + poses[:, :3, 3].reshape(
        -1, *[1] * (points.ndim - 1), 3
    )


def cone(axis: Array, length: float, half_angle: float) -> Mesh:
    """From its apex at the origin along a unit axis, shape `(3,)`; without a bottom."""
    rim = length * axis + length * math.tan(half_angle) * _ring(axis)
    after = 1 + (np.arange(SIDES) + 1) % SIDES
    triangles = np.column_stack([np.zeros(SIDES, dtype=int), after, 1 + np.arange(SIDES)])
    return Mesh(np.vstack([np.zeros(3), rim]), triangles)


def wedge(axis: Array, length: float, half_angle: float) -> Mesh:
    """The same in the plane z = 0: a sector of a disc."""
    angles = math.atan2(axis[1], axis[0]) + np.linspace(-half_angle, half_angle, SIDES + 1)
    rim = length * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(SIDES + 1)])
    steps = 1 + np.arange(SIDES)
    return Mesh(
        np.vstack([np.zeros(3), rim]), np.column_stack([np.zeros(SIDES, dtype=int), steps, steps + 1])
    )


def fan(polygon: Array, z: float) -> Mesh:
    """A convex polygon, shape `(n, 2)`, as triangles at a height."""
    steps = np.arange(1, len(polygon) - 1)
    return Mesh(_at(polygon, z), np.column_stack([np.zeros(len(steps), dtype=int), steps, steps + 1]))


@cache
def ball() -> Mesh:
    """A unit ball about the origin, of 320 triangles."""
    t = (1.0 + math.sqrt(5.0)) / 2.0
    corners = [(0, 1, t), (0, -1, t), (0, 1, -t), (0, -1, -t)]
    vertices = np.array([np.roll(corner, turn) for turn in range(3) for corner in corners], dtype=float)
    triangles = np.array(
        [
            (a, b, c)
            for a in range(12)
            for b in range(a + 1, 12)
            for c in range(b + 1, 12)
            if all(math.dist(vertices[i], vertices[j]) < 2.1 for i, j in ((a, b), (b, c), (a, c)))
        ]
    )
    for _ in range(2):
        corner = vertices[triangles]
        middle = (corner + np.roll(corner, -1, axis=1)) / 2
        a, b, c = corner.transpose(1, 0, 2)
        ab, bc, ca = middle.transpose(1, 0, 2)
        pieces = np.stack([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]])  # (4, 3, m, 3)
        vertices = pieces.transpose(0, 2, 1, 3).reshape(-1, 3)
        triangles = np.arange(len(vertices)).reshape(-1, 3)
    vertices = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    inward = np.sum(np.cross(b - a, c - a) * a, axis=1) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    return Mesh(vertices, triangles)


def joined(meshes: list[Mesh]) -> Mesh:
    """Several as one."""
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + k for mesh, k in zip(meshes, first, strict=False)]),
    )


def dashes(start: Array, end: Array, length: float) -> Array:
    """A way in pieces of about a length, and gaps two thirds of that, shape `(n, 2, 3)`."""
    way = end - start
    total = float(np.linalg.norm(way))
    count = max(1, min(200, round(total / (5 * length / 3))))
    begins = np.arange(count) / count
    shares = np.stack([begins, begins + 0.6 / count], axis=1)
    return start + shares[..., None] * way


def square_to(direction: Array, near: Array) -> Array:
    """A unit vector square to a unit direction, in the plane of it and another one that is not parallel."""
    aside = near - (near @ direction) * direction
    return np.asarray(aside / np.linalg.norm(aside))


def _ring(axis: Array) -> Array:
    aside = square_to(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    turns = math.tau * np.arange(SIDES)[:, None] / SIDES
    return np.cos(turns) * aside + np.sin(turns) * np.cross(axis, aside)


def _at(points: Array, z: float) -> Array:
    """Points of the plane at a height."""
    return np.concatenate([points, np.full((*points.shape[:-1], 1), z)], axis=-1)


def _numbered(pattern: list[list[int]], count: int, step: int) -> Numbers:
    return (np.array(pattern) + step * np.arange(count)[:, None, None]).reshape(-1, 3)


def _lid(model: Model) -> Array:
    """Triangles of the inside, counter-clockwise, shape `(n, 3, 2)`."""
    loops: list[list[Array]] = []
    for face in model.faces:
        if loops and np.array_equal(loops[-1][-1], face[0]):
            loops[-1].append(face[1])
        else:
            loops.append([face[0], face[1]])
    rings = [np.array(loop[:-1]) for loop in loops]
    outer = max(range(len(rings)), key=lambda k: _area(rings[k]))
    # ezdxf has points of its own kind; any pair of numbers will do.
    from ezdxf.math import Vec2

    made = mapbox_earcut_2d(
        [Vec2(point) for point in rings[outer]],
        [[Vec2(point) for point in ring] for k, ring in enumerate(rings) if k != outer],
    )
    triangles = np.array([[tuple(point) for point in triangle] for triangle in made], dtype=float)
    clockwise = (
        np.cross(
            np.pad(triangles[:, 1] - triangles[:, 0], ((0, 0), (0, 1))),
            np.pad(triangles[:, 2] - triangles[:, 0], ((0, 0), (0, 1))),
        )[:, 2]
        < 0.0
    )
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return triangles


def _area(ring: Array) -> float:
    x, y = ring.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
