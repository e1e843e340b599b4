"""Whether poses satisfy the evidence, by the definition of validity: plain array code, no part of the core.

A pose is valid if for every contact there are a point `x` of a placed feature and an outward normal `n` there
with `|center − (x + r n)| <= position_error`, an angle of at most `normal_error` between `n` and the sensed
normal, and `−approach · n >= 0`; if no sweep is nearer to the placed part than its clearance; and if the
prior allows it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from palpate import Contact, Miss, Prior

from .shapes import Array, Mask, Shape, point_distances, wrap
from .sweeps import least_distances

Feature = tuple[Literal["face", "edge", "vertex"], int]
Assignment = list[Feature]

#: Rounding, as a share of the lengths that occur.
ROUNDING = 1e-11


@dataclass(frozen=True)
class Slack:
    """What is allowed beyond the bounds: a length, and an angle in radians."""

    length: float
    angle: float


@dataclass(frozen=True)
class Evidence:
    """What was observed, as arrays. Shapes `(n, ...)` for contacts, `(s, ...)` for sweeps, world frame."""

    shape: Shape
    centers: Array
    radii: Array
    bounds: Array
    #: Middle and half width of the normals that the reading allows, and of those that the approach allows.
    readings: Array
    sweep_starts: Array
    sweep_ends: Array
    clearances: Array
    prior: tuple[Array, float, float, float] | None

    @classmethod
    def of(
        cls,
        shape: Shape,
        contacts: Sequence[Contact],
        *,
        misses: Sequence[Miss] = (),
        prior: Prior | None = None,
    ) -> Evidence:
        """The evidence as one model sees it: its slacks are added to the bounds."""
        model = shape.model
        readings = [
            [_reading(c.normal, c.normal_error, model.normal_slack), _facing(c.approach, model.normal_slack)]
            for c in contacts
        ]
        sweeps = [_of_miss(miss) for miss in misses] + [
            sweep for sweep in map(_of_contact, contacts) if sweep is not None
        ]
        known = None
        if prior is not None:
            middle = np.array(prior.world_from_model)
            known = (middle[:2, 2], angle_of(middle), prior.translation, prior.rotation)
        return cls(
            shape=shape,
            centers=np.array([c.center for c in contacts]),
            radii=np.array([c.tip_radius for c in contacts]),
            bounds=np.array([c.position_error for c in contacts]) + model.position_slack,
            readings=np.array(readings),
            sweep_starts=np.array([sweep[0] for sweep in sweeps]).reshape(-1, 2),
            sweep_ends=np.array([sweep[1] for sweep in sweeps]).reshape(-1, 2),
            clearances=np.array([sweep[2] for sweep in sweeps]) - model.position_slack,
            prior=known,
        )

    def tolerance(self, relative: float) -> Slack:
        """τ: a share of the part's size as a length, the share itself as an angle; and rounding."""
        size = self.shape.model.size
        reach = size + float(np.abs(self.centers).max()) + float(np.abs(self.shape.corners).max())
        return Slack(relative * size + ROUNDING * reach, relative * (1.0 + 1e-6) + ROUNDING * reach / size)


def angle_of(pose: Array) -> float:
    """Rotation of a homogeneous matrix, radians."""
    return math.atan2(pose[1, 0], pose[0, 0])


def _reading(normal: Array | None, error: float | None, slack: float) -> tuple[float, float]:
    if normal is None or error is None:
        return 0.0, math.inf
    return math.atan2(normal[1], normal[0]), error + slack


def _facing(approach: Array | None, slack: float) -> tuple[float, float]:
    if approach is None:
        return 0.0, math.inf
    return math.atan2(-approach[1], -approach[0]), 0.5 * math.pi + slack


def _of_miss(miss: Miss) -> tuple[Array, Array, float]:
    return np.array(miss.start), np.array(miss.end), miss.tip_radius - miss.path_error


def _of_contact(contact: Contact) -> tuple[Array, Array, float] | None:
    """The free part of a contact's own move: it ends the position error short of the sensed centre."""
    if contact.start is None:
        return None
    way = np.array(contact.center) - np.array(contact.start)
    length = float(np.hypot(*way))
    left = length - contact.position_error
    if left <= 0.0:
        return None
    end = np.array(contact.start) + way * (left / length)
    return np.array(contact.start), end, contact.tip_radius - contact.position_error


@dataclass(frozen=True)
class Explained:
    """Whether each face and each corner explains a contact at a pose; shapes `(p, n, f)` and `(p, n, v)`."""

    faces: Mask
    corners: Mask

    def anyhow(self, kinds: Sequence[str]) -> Mask:
        """Whether all contacts are explained by some feature of the kinds; shape `(p,)`."""
        none = np.zeros(self.faces.shape[:2], dtype=bool)
        by_face = self.faces.any(axis=2) if "face" in kinds else none
        by_corner = self.corners.any(axis=2) if "vertex" in kinds else none
        held: Mask = np.all(by_face | by_corner, axis=1)
        return held

    def by(self, assignment: Assignment) -> Mask:
        """Whether all contacts are explained by their features; shape `(p,)`."""
        held = np.ones(len(self.faces), dtype=bool)
        for contact, (kind, number) in enumerate(assignment):
            held &= (self.faces if kind == "face" else self.corners)[:, contact, number]
        return held


def explain(evidence: Evidence, poses: Array, slack: Slack) -> Explained:
    """Which features explain which contacts, for poses of shape `(p, 3, 3)`."""
    angles = np.arctan2(poses[:, 1, 0], poses[:, 0, 0])
    offsets = evidence.centers[None] - poses[:, None, :2, 2]
    places = np.einsum("pji,pnj->pni", poses[:, :2, :2], offsets)
    bounds = evidence.bounds[None, :, None] + slack.length
    faces = (_face_distances(evidence, places) <= bounds) & _faces_agree(evidence, angles, slack)
    corners = _corner_distances(evidence, places, angles, slack=slack) <= bounds
    return Explained(
        faces & evidence.shape.touchable_faces[None, None],
        corners & evidence.shape.touchable_corners[None, None],
    )


def _face_distances(evidence: Evidence, places: Array) -> Array:
    """From the centres of tips, `(p, n, 2)`, model frame, to the faces moved out by the radius."""
    shape = evidence.shape
    distances = []
    for contact, radius in enumerate(evidence.radii):
        out = radius * shape.normals
        distances.append(point_distances(places[:, contact], shape.starts + out, shape.ends + out))
    return np.stack(distances, axis=1)


def _faces_agree(evidence: Evidence, angles: Array, slack: Slack) -> Mask:
    """Whether the faces' normals are among those that the readings allow; `(p, n, f)`."""
    normals = angles[:, None] + evidence.shape.normal_angles[None]
    middles, halves = evidence.readings[:, :, 0], evidence.readings[:, :, 1]
    turned = np.abs(wrap(middles[None, :, :, None] - normals[:, None, None, :]))
    return np.asarray((turned <= halves[None, :, :, None] + slack.angle).all(axis=2))


def _corner_distances(evidence: Evidence, places: Array, angles: Array, *, slack: Slack) -> Array:
    """From the centres of tips to the arcs of the tip's radius about the corners; infinite where none agrees.

    The nearest point of an arc, or of the common part of several, is straight from its centre or an end of
    one of them.
    """
    shape = evidence.shape
    offsets = places[:, :, None] - shape.corners
    own = np.broadcast_to(shape.cone_middles, offsets.shape[:3])
    arcs = [(own, np.broadcast_to(shape.cone_halves, own.shape) + 1e-12)]
    for kind in (0, 1):
        middles = evidence.readings[None, :, kind, 0] - angles[:, None]
        halves = np.minimum(evidence.readings[:, kind, 1] + slack.angle, 10.0)
        arcs.append(
            (
                np.broadcast_to(middles[..., None], own.shape),
                np.broadcast_to(halves[None, :, None], own.shape),
            )
        )
    tried = [np.arctan2(offsets[..., 1], offsets[..., 0])]
    tried += [middle + sign * half for middle, half in arcs for sign in (-1.0, 1.0)]
    best = np.full(own.shape, np.inf)
    for normal in tried:
        allowed = np.all([np.abs(wrap(normal - middle)) <= half + 1e-12 for middle, half in arcs], axis=0)
        tip = evidence.radii[None, :, None, None] * np.stack([np.cos(normal), np.sin(normal)], axis=-1)
        gap = offsets - tip
        best = np.minimum(best, np.where(allowed, np.hypot(gap[..., 0], gap[..., 1]), np.inf))
    return best


def clear(evidence: Evidence, poses: Array, slack: Slack) -> Mask:
    """Whether every sweep keeps its clearance from the placed part; shape `(p,)`."""
    if not len(evidence.clearances):
        return np.ones(len(poses), dtype=bool)
    return np.asarray((room(evidence, poses) >= -slack.length).all(axis=1))


def room(evidence: Evidence, poses: Array) -> Array:
    """By how much each sweep is farther from the placed part than its clearance; shape `(p, s)`."""
    ends = [
        np.einsum("pji,psj->psi", poses[:, :2, :2], points[None] - poses[:, None, :2, 2])
        for points in (evidence.sweep_starts, evidence.sweep_ends)
    ]
    return least_distances(evidence.shape, ends[0], ends[1]) - evidence.clearances


def expected(evidence: Evidence, poses: Array, slack: Slack) -> Mask:
    """Whether the prior allows the poses; shape `(p,)`."""
    if evidence.prior is None:
        return np.ones(len(poses), dtype=bool)
    middle, angle, translation, rotation = evidence.prior
    moved = np.abs(poses[:, :2, 2] - middle).max(axis=1) <= translation + slack.length
    turned = np.abs(wrap(np.arctan2(poses[:, 1, 0], poses[:, 0, 0]) - angle)) <= rotation + slack.angle
    return np.asarray(moved & turned)


def valid(evidence: Evidence, poses: Array, *, kinds: Sequence[str], slack: Slack) -> Mask:
    """Whether poses satisfy all of the evidence, each contact on some feature of the kinds; shape `(p,)`."""
    explained = explain(evidence, poses, slack).anyhow(kinds)
    return explained & clear(evidence, poses, slack) & expected(evidence, poses, slack)


def valid_on(evidence: Evidence, poses: Array, assignment: Assignment, *, slack: Slack) -> Mask:
    """Whether poses satisfy all of the evidence, each contact on its feature; shape `(p,)`."""
    explained = explain(evidence, poses, slack).by(assignment)
    return explained & clear(evidence, poses, slack) & expected(evidence, poses, slack)
