"""Whether poses of a solid satisfy the evidence, by the definition of validity: no part of the core.

A pose is valid if for every contact there are a point `x` of the placed surface and an outward normal `n`
there with `|center − (x + r n)| <= position_error`, an angle of at most `normal_error` between `n` and the
sensed normal, and `−approach · n >= 0`; if no sweep is nearer to the placed part than its clearance; and if
the prior allows it. A triangle has one normal, a convex edge those between its faces, a convex vertex those
between its edges.

Where the corners of a mesh are known only to a length, so are its normals: those of narrow triangles least.

Contacts, misses and priors are anything with the attributes of `palpate.Contact`, `palpate.Miss` and
`palpate.Prior`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .solid_sweeps import keep_off, nearest, to_segments, to_triangles
from .solids import Array, Cone, Edges, Mask, Solid

#: Rounding, as a share of the lengths that occur; what is left out for its distance is farther by as much.
ROUNDING = 1e-11
#: Points of a circle or sphere of normals that are this near to an allowed one, as a cosine or sine, are
#: allowed.
ON_BOUND = 1e-12
#: Pairs of a pose and an edge that are looked at at once.
MOST_AT_ONCE = 100_000

ALL_KINDS = ("face", "edge", "vertex")


@dataclass(frozen=True)
class Slack:
    """What is allowed beyond the bounds: a length, and an angle in radians. Negative: less is allowed.

    `corners` is how far the corners of the part may be from where they are said to be: as much as that may
    turn its normals is allowed. Negative: that must not matter.
    """

    length: float = 0.0
    angle: float = 0.0
    corners: float = 0.0


NONE = Slack()


def tolerance(solid: Solid, contacts: Sequence[Any], relative: float) -> Slack:
    """τ: a share of the part's size as a length, the share itself as an angle; and rounding."""
    farthest = max((float(np.abs(one.center).max()) for one in contacts), default=0.0)
    reach = solid.size + farthest + float(np.abs(solid.vertices).max())
    share = ROUNDING * reach
    return Slack(relative * solid.size + share, relative * (1.0 + 1e-6) + share / solid.size)


def missed_by_centers(asymmetry: tuple[float, float], contacts: Sequence[Any]) -> float:
    """How far a tip's centre may be off where a model's symmetries miss points and normals by so much.

    A normal that is off by ω moves the centre of a ball of radius r by 2 r sin(ω / 2) (docs/theory.md, T10).
    """
    missed, turned = asymmetry
    radius = max((float(one.tip_radius) for one in contacts), default=0.0)
    return missed + 2.0 * radius * math.sin(turned / 2.0)


def valid(  # noqa: PLR0917 - what is placed, where, what was observed, and how strictly
    solid: Solid,
    poses: Array,
    contacts: Sequence[Any],
    slack: Slack = NONE,
    *,
    misses: Sequence[Any] = (),
    prior: Any = None,
    kinds: Sequence[str] = ("face",),
) -> Mask:
    """Whether poses `(p, 4, 4)` satisfy all of the evidence; shape `(p,)`."""
    held = expected(poses, prior, slack)
    for contact in contacts:
        if not held.any():
            break
        held[held] = explained(solid, poses[held], contact, slack, kinds=kinds)
    if held.any():
        held[held] = clear(solid, poses[held], contacts, slack, misses=misses)
    return held


def explained(  # noqa: PLR0917 - as above
    solid: Solid, poses: Array, contact: Any, slack: Slack = NONE, *, kinds: Sequence[str] = ("face",)
) -> Mask:
    """Whether poses let a contact lie on some feature of the kinds; shape `(p,)`."""
    most = contact.position_error + slack.length
    return np.asarray(gaps(solid, poses, contact, slack, kinds=kinds, most=most) <= most)


def gaps(  # noqa: PLR0917 - as above
    solid: Solid,
    poses: Array,
    contact: Any,
    slack: Slack = NONE,
    *,
    kinds: Sequence[str] = ("face",),
    most: float = math.inf,
) -> Array:
    """How far the sensed centre is from where the tip's centre may be with an allowed normal; shape `(p,)`.

    Infinite if no feature has an allowed normal. What is more than `most` may be told as any more than that.
    """
    turns, offsets = poses[:, :3, :3], np.asarray(contact.center) - poses[:, :3, 3]
    center = np.einsum("pji,pj->pi", turns, offsets)  # in the model's frame
    bounds = []  # (direction in the model's frame, largest angle to it)
    if contact.normal is not None:
        normal = np.einsum("pji,j->pi", turns, np.asarray(contact.normal))
        bounds.append((normal, contact.normal_error + slack.angle))
    if getattr(contact, "approach", None) is not None:
        away = np.einsum("pji,j->pi", turns, -np.asarray(contact.approach))
        bounds.append((away, 0.5 * math.pi + slack.angle))
    radius = float(contact.tip_radius)
    best = np.full(len(poses), np.inf)
    doubts = partial(_doubts, moved=slack.corners)
    if "face" in kinds:
        doubt = doubts(solid.heights)
        best = np.minimum(best, _face_gaps(solid, center, bounds, radius=radius, most=most, doubt=doubt))
    if "edge" in kinds:
        doubt = doubts(solid.edges.heights)
        best = np.minimum(best, _edge_gaps(solid, center, bounds, radius=radius, most=most, doubt=doubt))
    if "vertex" in kinds and solid.cones:
        apart = np.linalg.norm(center[:, None] - np.array([cone.point for cone in solid.cones]), axis=2)
        doubt = doubts(np.array([cone.height for cone in solid.cones]))
        # Whichever normals are allowed.
        beyond = most * (1.0 + ROUNDING) + ROUNDING * solid.size
        near = np.abs(apart - radius) <= beyond + radius * np.abs(doubt)
        for number in np.flatnonzero(near.any(axis=0)):
            some = near[:, number]
            part = [(direction[some], largest) for direction, largest in bounds]
            gap = _vertex_gaps(
                solid.cones[number], center[some], part, radius=radius, doubt=float(doubt[number])
            )
            best[some] = np.minimum(best[some], gap)
    return best


Bounds = Sequence[tuple[Array, float | Array]]


def _doubts(heights: Array, moved: float) -> Array:
    """By how much corners that are off turn normals of triangles so high, radians; signed as `moved`."""
    return np.asarray(np.copysign(np.arctan2(2.0 * abs(moved), heights), moved))


def _least(largest: float | Array) -> Array:
    """The least cosine of angles up to this."""
    return np.asarray(np.cos(np.clip(largest, 0.0, math.pi)))


def _face_gaps(
    solid: Solid, center: Array, bounds: Bounds, *, radius: float, most: float, doubt: Array
) -> Array:
    """Of centres `(p, 3)`, model frame, to the triangles moved out by the radius."""
    out = radius * solid.normals
    middles, radii = solid.balls
    radii = radii + radius * np.abs(doubt)
    agree = np.broadcast_to(solid.areas > 0.0, (len(center), len(radii)))
    for direction, largest in bounds:
        agree = agree & (direction @ solid.normals.T >= _least(largest + doubt) - ON_BOUND)
    apart = np.full(agree.shape, np.inf)
    poses, triangles = np.nonzero(agree)
    apart[poses, triangles] = np.linalg.norm(center[poses] - (middles + out)[triangles], axis=1)
    placed = solid.corners + out[:, None]
    return nearest(apart, radii, lambda p, t: to_triangles(center[p], placed[t]) - radius * doubt[t], most)


def _edge_gaps(
    solid: Solid, center: Array, bounds: Bounds, *, radius: float, most: float, doubt: Array
) -> Array:
    """To the parts of cylinders about the convex edges whose normals are allowed.

    All normals of an edge are square to it, so where the tip is along it and around it are apart. Around it,
    the nearest allowed normal is straight from the edge or an end of one of the ranges that bound it.
    """
    edges = solid.edges
    best = np.full(len(center), np.inf)
    # From the edge itself; whichever normals are allowed, no gap is less.
    apart = np.abs(to_segments(center[:, None], edges.starts, edges.ends) - radius)
    beyond = most * (1.0 + ROUNDING) + ROUNDING * solid.size
    poses, numbers = np.nonzero(apart <= beyond + radius * np.abs(doubt))
    for first in range(0, len(poses), MOST_AT_ONCE):
        pose, edge = poses[first : first + MOST_AT_ONCE], numbers[first : first + MOST_AT_ONCE]
        part = [(direction[pose], largest + doubt[edge]) for direction, largest in bounds]
        gap = _around_edges(edges.only(edge), center[pose], part, radius=radius, doubt=doubt[edge])
        np.minimum.at(best, pose, gap)
    return best


def _around_edges(edges: Edges, center: Array, bounds: Bounds, *, radius: float, doubt: Array) -> Array:
    """Of centres to as many edges."""
    along = edges.ends - edges.starts
    lengths = np.linalg.norm(along, axis=1)
    along = along / lengths[:, None]
    across = np.cross(along, edges.first_normals)  # with the first normal, a frame square to the edge
    width = np.arctan2(_dots(edges.second_normals, across), _dots(edges.second_normals, edges.first_normals))
    offset = center - edges.starts
    at = _dots(offset, along)
    beyond = np.maximum(np.maximum(-at, at - lengths), 0.0)
    x, y = _dots(offset, edges.first_normals), _dots(offset, across)
    # Each range of angles as cos(angle − middle) >= least.
    ranges = [(0.5 * width, _least(0.5 * width + doubt))]
    tried = [np.arctan2(y, x), -doubt, width + doubt]
    for direction, largest in bounds:
        u, v = _dots(direction, edges.first_normals), _dots(direction, across)
        size = np.maximum(np.hypot(u, v), 1e-300)
        middle, cosine = np.arctan2(v, u), _least(largest) / size
        ranges.append((middle, cosine))
        half = np.arccos(np.clip(cosine, -1.0, 1.0))
        tried += [middle - half, middle + half]
    best = np.full(x.shape, np.inf)
    for angle in tried:
        allowed = np.all([np.cos(angle - middle) >= least - ON_BOUND for middle, least in ranges], axis=0)
        aside = np.hypot(x - radius * np.cos(angle), y - radius * np.sin(angle))
        best = np.minimum(best, np.where(allowed, np.hypot(aside, beyond), np.inf))
    return np.asarray(best - radius * doubt)


def _dots(first: Array, second: Array) -> Array:
    return np.einsum("ni,ni->n", first, second)


def _vertex_gaps(cone: Cone, center: Array, bounds: Bounds, *, radius: float, doubt: float = 0.0) -> Array:
    """To the part of a sphere about a convex vertex whose normals are allowed.

    Nearest is the direction to the centre itself, its foot on one of the circles that bound the normals, or a
    point where two of them meet.
    """
    offset = center - cone.point
    best = np.full(len(center), np.inf)
    straight = offset / np.maximum(np.linalg.norm(offset, axis=1, keepdims=True), 1e-300)
    right = _least(0.5 * math.pi + doubt) if doubt else 0.0
    caps = [(np.broadcast_to(-one, center.shape), float(right)) for one in cone.leaving]
    caps += [(direction, float(_least(largest + doubt))) for direction, largest in bounds]
    # From the middle of a circle all of it is equally far: any foot will do, and the middle itself.
    tried = [straight, *(middle for middle, _ in caps)]
    for middle, least in caps:
        foot = straight - np.einsum("pi,pi->p", straight, middle)[:, None] * middle
        length = np.linalg.norm(foot, axis=1, keepdims=True)
        foot = np.where(length > 1e-9, foot / np.maximum(length, 1e-300), _square_to(middle))
        tried.append(least * middle + math.sqrt(max(0.0, 1.0 - least * least)) * foot)
    for k, one in enumerate(caps):
        for other in caps[:k]:
            tried += _meeting(one, other)
    for normal in tried:
        unit = np.abs(np.linalg.norm(normal, axis=1) - 1.0) <= 1e-9
        slip = [np.einsum("pi,pi->p", normal, middle) >= least - 1e-10 for middle, least in caps]
        allowed = unit & np.all(slip, axis=0)
        gap = np.linalg.norm(offset - radius * normal, axis=1)
        best = np.minimum(best, np.where(allowed, gap, np.inf))
    return best - radius * doubt


def _square_to(middle: Array) -> Array:
    """Some unit vectors square to these, `(p, 3)`."""
    axis = np.eye(3)[np.abs(middle).argmin(axis=1)]
    across = np.cross(middle, axis)
    return np.asarray(across / np.linalg.norm(across, axis=1, keepdims=True))


def _meeting(one: tuple[Array, float], other: tuple[Array, float]) -> list[Array]:
    """The two unit vectors with the least cosine to both middles; not unit where there are none."""
    (a, s), (b, t) = one, other
    dot = np.einsum("pi,pi->p", a, b)
    square = 1.0 - dot * dot
    safe = np.maximum(square, 1e-18)
    base = ((s - t * dot) / safe)[:, None] * a + ((t - s * dot) / safe)[:, None] * b
    rest = 1.0 - np.einsum("pi,pi->p", base, base)
    aside = np.cross(a, b) * np.sqrt(np.maximum(rest, 0.0) / safe)[:, None]
    return [base + aside, base - aside]


def clear(  # noqa: PLR0917 - as above
    solid: Solid, poses: Array, contacts: Sequence[Any], slack: Slack = NONE, *, misses: Sequence[Any] = ()
) -> Mask:
    """Whether every sweep keeps its clearance from the placed part; shape `(p,)`.

    Where a sweep may pass through the part it is decided by points on it: cautiously, if `slack` is negative.
    """
    held = np.ones(len(poses), dtype=bool)
    for start, end, clearance in sweeps(contacts, misses):
        # In the model's frame: `(point − shift) @ turn` of each pose.
        starts, ends = (
            np.einsum("pji,pj->pi", poses[held, :3, :3], point - poses[held, :3, 3]) for point in (start, end)
        )
        least = clearance - slack.length
        held[held] = keep_off(solid, starts, ends, least=least, cautious=slack.length < 0.0)
    return held


def sweeps(contacts: Sequence[Any], misses: Sequence[Any]) -> list[tuple[Array, Array, float]]:
    """Start, end and clearance of what the tip swept freely, world frame."""
    found = [(np.array(m.start), np.array(m.end), m.tip_radius - m.path_error) for m in misses]
    for contact in contacts:
        if getattr(contact, "start", None) is None:
            continue
        way = np.array(contact.center) - np.array(contact.start)
        length = float(np.linalg.norm(way))
        left = length - contact.position_error
        if left > 0.0:
            end = np.array(contact.start) + way * (left / length)
            found.append((np.array(contact.start), end, contact.tip_radius - contact.position_error))
    return found


def angle_between(first: Array, second: Array) -> Array:
    """Of the rotation that leads from one rotation matrix to another, `(..., 3, 3)`, radians."""
    chord = np.linalg.norm(first - second, axis=(-2, -1)) / math.sqrt(8.0)
    return np.asarray(2.0 * np.arcsin(np.clip(chord, 0.0, 1.0)))


def expected(poses: Array, prior: Any, slack: Slack = NONE) -> Mask:
    """Whether a prior, a box of translations and a cone of rotations, allows the poses; shape `(p,)`."""
    if prior is None:
        return np.ones(len(poses), dtype=bool)
    middle = np.array(prior.world_from_model)
    moved = np.abs(poses[:, :3, 3] - middle[:3, 3]).max(axis=1) <= prior.translation + slack.length
    turned = angle_between(poses[:, :3, :3], middle[:3, :3]) <= prior.rotation + slack.angle
    return np.asarray(moved & turned)
