"""When an answer of a peer is the truth, and how much is in the pose sets of an answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .solid_particles import distinct
from .solids import Array, Mask, Solid

#: Lengths, of parts 200 across, and an angle in radians.
WITHIN, TURNED = 2.0, 0.02
ACROSS = 200.0
#: Answers that place the contacts alike to this are counted once.
APART = 2.0
MOST_VERTICES = 100
NUM_SAMPLES = 4000


def mean_distances(solid: Solid, poses: Array, truth: Array) -> Array:
    """How far the part is from where it truly is, `(p,)`: ADD-S, the usual measure of symmetric objects.

    The mean over vertices, a hundred of them if there are more, of the distance to the nearest vertex of the
    part at `truth` (Hinterstoisser 2012, Xiang 2018). Distances above ten times `WITHIN` count as that.
    """
    from scipy.spatial import cKDTree

    vertices = solid.vertices
    if len(vertices) > MOST_VERTICES:
        chosen = np.random.default_rng(0).choice(len(vertices), size=MOST_VERTICES, replace=False)
        vertices = vertices[chosen]
    most = 10.0 * WITHIN
    tree = cKDTree(_placed(truth[None], solid.vertices)[0])
    distances, _ = tree.query(_placed(poses, vertices).reshape(-1, 3), distance_upper_bound=most)
    return np.asarray(np.minimum(distances, most).reshape(len(poses), len(vertices)).mean(axis=1))


def close_poses(solid: Solid, poses: Array, truth: Array) -> Mask:
    """Which poses `(p, 4, 4)` are within `WITHIN` at the centroid and `TURNED`, up to symmetry; `(p,)`."""
    import palpate

    symmetries = palpate.Model.mesh(solid.vertices, solid.triangles).symmetries
    middle = solid.vertices.mean(axis=0)[None]
    placed = _placed(poses, middle)[:, 0]
    held = np.zeros(len(poses), dtype=bool)
    for alike in truth @ symmetries:
        shift = np.linalg.norm(placed - _placed(alike[None], middle)[0, 0], axis=1)
        trace = np.einsum("pij,ij->p", poses[:, :3, :3], alike[:3, :3])
        held |= (shift <= WITHIN) & (trace >= 1.0 + 2.0 * math.cos(TURNED))
    return held


def _placed(poses: Array, points: Array) -> Array:
    return np.asarray(np.einsum("pij,vj->pvi", poses[:, :3, :3], points) + poses[:, None, :3, 3])


def share_of_all(turns: Sequence[float], shifts: Sequence[float]) -> float:
    """At most this share of all poses is in sets with these bounds on turns and on ways of the middle.

    All poses: any rotation, the middle in a cube 200 across. A set with a bound θ is within the rotations by
    θ from any of its poses, (θ − sin θ)/π of all, and its middle in a ball.
    """
    whole = 0.0
    for turn, shift in zip(turns, shifts, strict=True):
        rotations = (turn - math.sin(turn)) / math.pi
        whole += rotations * min(1.0, 4.0 / 3.0 * math.pi * (shift / ACROSS) ** 3)
    return min(1.0, whole)


def number_of_places(sets: Sequence[Any], centers: Array) -> int:
    """How many poses are among samples of pose sets, counted as particles are: at least what they hold."""
    if not sets:
        return 0
    each = -(-NUM_SAMPLES // len(sets))
    poses = np.concatenate([one.sample(each) for one in sets])
    return len(distinct(poses, centers, APART))
