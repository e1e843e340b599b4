"""Poses that explain contacts, by a set of particles with tolerances that shrink step by step.

After Petrovskaya and Khatib, *Global Localization of Objects via Touch* (2011): a wide tolerance is halved a
few times; each time the particles that satisfy it are spread evenly and scattered anew. Made as strong as
could be: the first particles come from pairs of contacts on pairs of places that fit them, and each is moved
by a step of least squares. It finds much and promises nothing: the campaign takes the poses that it finds,
where the oracle agrees, as a test of the core; the comparison takes it as the best known rival.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .solid_oracle import Slack, valid
from .solids import Array, Mask, Numbers, Solid

#: Multiples of the bounds, of positions and of normals, to which the tolerances shrink.
TOLERANCES = ((16.0, 3.0), (8.0, 2.0), (4.0, 1.5), (2.0, 1.2), (1.3, 1.1), (1.0, 1.0))


@dataclass(frozen=True)
class Settings:
    """How much is tried."""

    num_places: int = 20_000
    num_paired: int = 700
    num_first: int = 12_000
    num_particles: int = 2_000
    most_kept: int = 400
    #: How many are led on to where the worst contact is best explained, and in how many rounds.
    num_lowered: int = 24
    rounds: int = 10
    #: Whether particles cover all that the tolerances allow, rather than the best of it.
    even: bool = False


DEFAULT = Settings()


@dataclass(frozen=True)
class Places:
    """Where a tip's centre may be `(m, 3)`, model frame, and the normals there; with a tree over both."""

    points: Array
    normals: Array
    spacing: float
    tree: Any
    scale: float


def touchable(  # noqa: PLR0917 - of what, how many, for which tip, and how normals count
    solid: Solid, random: np.random.Generator, count: int, radius: float, scale: float
) -> Places:
    """Places drawn evenly over the surface at the tip's radius; a radian counts as `scale` of length."""
    from scipy.spatial import cKDTree

    drawn = solid.places(random, count)
    points, normals = [drawn.points + radius * drawn.normals], [drawn.normals]
    if radius > 0.0:
        rounded = [_on_edges(solid, random, count), _on_vertices(solid, random)]
        points += [one + radius * out for one, out in rounded]
        normals += [out for _, out in rounded]
    all_points, all_normals = np.concatenate(points), np.concatenate(normals)
    spacing = float(np.sqrt(solid.areas.sum() / count))
    tree = cKDTree(np.concatenate([all_points, scale * all_normals], axis=1) if scale > 0.0 else all_points)
    return Places(all_points, all_normals, spacing, tree, scale)


def _on_edges(solid: Solid, random: np.random.Generator, count: int) -> tuple[Array, Array]:
    edges = solid.edges
    if not len(edges.starts):
        return np.zeros((0, 3)), np.zeros((0, 3))
    weights = np.linalg.norm(edges.ends - edges.starts, axis=1)
    chosen = random.choice(len(weights), size=count // 4, p=weights / weights.sum())
    along, around = random.random((2, len(chosen), 1))
    first, second = edges.first_normals[chosen], edges.second_normals[chosen]
    width = np.arccos(np.clip(np.einsum("ni,ni->n", first, second), -1.0, 1.0))[:, None]
    normals = (np.sin((1.0 - around) * width) * first + np.sin(around * width) * second) / np.sin(width)
    return edges.starts[chosen] + along * (edges.ends - edges.starts)[chosen], normals


def _on_vertices(solid: Solid, random: np.random.Generator) -> tuple[Array, Array]:
    points, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for cone in solid.cones:
        mixed = random.dirichlet(np.ones(len(cone.rays)), size=12) @ cone.rays
        normals.append(mixed / np.linalg.norm(mixed, axis=1, keepdims=True))
        points.append(np.broadcast_to(cone.point, (12, 3)))
    return np.concatenate(points), np.concatenate(normals)


@dataclass(frozen=True)
class Readings:
    """Contacts as arrays: centres and normals `(n, 3)`, bounds `(n,)`; `bare` if none has a normal."""

    centers: Array
    normals: Array
    position_errors: Array
    normal_errors: Array
    bare: bool

    @classmethod
    def of(cls, contacts: Sequence[Any]) -> Readings:
        """Those of contacts; one normal that is missing lets go of all."""
        bare = any(one.normal is None for one in contacts)
        count = len(contacts)
        return cls(
            np.array([one.center for one in contacts]),
            np.zeros((count, 3)) if bare else np.array([one.normal for one in contacts]),
            np.array([max(one.position_error, 1e-6) for one in contacts]),
            np.ones(count) if bare else np.array([max(one.normal_error, 1e-6) for one in contacts]),
            bare,
        )


def scale_of(readings: Readings) -> float:
    """The length that counts as much as a radian: what the bounds allow of either."""
    return float(readings.position_errors.max() / readings.normal_errors.max())


def search(  # noqa: PLR0917 - of what, for what, and how much
    solid: Solid,
    contacts: Sequence[Any],
    seed: int,
    settings: Settings = DEFAULT,
    *,
    prior: Any = None,
    around: Array | None = None,
    only_valid: bool = True,
    kinds: Sequence[str] = ("face",),
    places: Places | None = None,
) -> Array:
    """Distinct poses `(p, 4, 4)` that explain the contacts, most of them far apart; none or many.

    Args:
        solid: The part.
        contacts: Anything with the attributes of `palpate.Contact`; tips of one radius.
        seed: Of all that is drawn.
        settings: How much is tried.
        prior: Where to look, if contacts have no normals.
        around: Poses near which to look, too.
        only_valid: Only poses that the oracle calls valid; else all particles at the end, the best first.
        kinds: On which contacts may lie.
        places: Those of the part, if they are drawn already.
    """
    random = np.random.default_rng(seed)
    readings = Readings.of(contacts)
    if places is None:
        scale = 0.0 if readings.bare else scale_of(readings)
        radius = float(contacts[0].tip_radius)
        places = touchable(solid, random, settings.num_places, radius, scale)
    poses = _first(places, readings, random, settings=settings, prior=prior)
    if around is not None:
        poses = np.concatenate([poses, around])
    if not len(poses):
        return np.zeros((0, 4, 4))
    for length, angle in TOLERANCES:
        # A step draws all of a region to its middle: done while regions are looked for, not while they are
        # filled.
        poses = step(places, readings, poses) if length > 2.0 else poses
        worst = worst_of(places, readings, poses, (length, angle))
        drawn = random if settings.even else None
        kept = _spread(poses, worst, readings, length=length, most=settings.most_kept, random=drawn)
        poses = _scattered(kept, readings, random, length=0.5 * length, count=settings.num_particles)
    least = _lowered(places, readings, kept[: settings.num_lowered], random, rounds=settings.rounds)
    within = poses[worst_of(places, readings, poses, (1.0, 1.0)) <= 1.05]
    within = _explored(places, readings, np.concatenate([within, least, kept]), random, settings=settings)
    if not only_valid:
        return np.concatenate([least, within])
    order = np.argsort(worst_of(places, readings, within, (1.0, 1.0)), kind="stable")
    poses = np.concatenate([least, kept, within[order[: settings.most_kept]]])
    return np.asarray(poses[valid(solid, poses, contacts, Slack(), prior=prior, kinds=kinds)])


def _first(
    places: Places, readings: Readings, random: np.random.Generator, *, settings: Settings, prior: Any
) -> Array:
    """Poses that lay a pair of contacts on a pair of places, or that the prior allows."""
    if readings.bare or len(readings.centers) < 2:
        return _allowed(prior, random, settings.num_first)
    from scipy.spatial import cKDTree

    some = random.choice(len(places.points), size=min(settings.num_paired, len(places.points)), replace=False)
    points, normals = places.points[some], places.normals[some]
    i, j = (one.ravel() for one in np.nonzero(~np.eye(len(some), dtype=bool)))
    size = float(np.ptp(places.points, axis=0).max())
    room = max(float(readings.position_errors.max()), 0.5 * size / np.sqrt(len(some)))
    # Half a million pairs are asked for a few times: a tree that is made fast is the better one.
    features = _features(points[i], points[j], normals[i], normals[j], room=room)
    tree = cKDTree(features, balanced_tree=False, compact_nodes=False)
    pairs = _telling_pairs(readings)
    each = settings.num_first // len(pairs)
    found = []
    for a, b in pairs:
        asked = _features(
            readings.centers[[a]],
            readings.centers[[b]],
            readings.normals[[a]],
            readings.normals[[b]],
            room=room,
        )
        _, near = tree.query(asked[0], k=min(each, len(i)))
        mine = np.broadcast_to(_vectors(readings.centers[a], readings.centers[b]), (len(near), 3))
        theirs = _vectors(points[i[near]], points[j[near]])
        from_model = [theirs, normals[i[near]], normals[j[near]]]
        to_world = [mine, *(np.broadcast_to(readings.normals[k], (len(near), 3)) for k in (a, b))]
        turns = _turned(from_model, to_world)
        middle = 0.5 * (points[i[near]] + points[j[near]])
        shift = 0.5 * (readings.centers[a] + readings.centers[b]) - np.einsum("pij,pj->pi", turns, middle)
        found.append(_poses(turns, shift))
    return np.concatenate(found)


def _features(  # noqa: PLR0917 - two points and their normals
    p: Array, q: Array, m: Array, n: Array, *, room: float
) -> Array:
    """Distance, angle of the normals and of each with the way; what is seen of a pair whatever the pose."""
    way = q - p
    length = np.linalg.norm(way, axis=1)
    unit = way / np.maximum(length, 1e-12)[:, None]
    cosines = [np.einsum("ni,ni->n", *two) for two in ((m, n), (m, unit), (n, unit))]
    # Chirality: without it half of the pairs would be mirror images.
    triple = np.einsum("ni,ni->n", np.cross(m, n), unit)
    return np.stack([length / room, *(8.0 * one for one in cosines), 8.0 * triple], axis=1)


def _telling_pairs(readings: Readings, most: int = 6) -> list[tuple[int, int]]:
    """The pairs of contacts that fix a pose best: far apart, with normals that differ."""
    count = len(readings.centers)
    pairs = [(a, b) for a in range(count) for b in range(a + 1, count)]
    apart = [
        float(np.linalg.norm(readings.centers[a] - readings.centers[b]))
        * (0.1 + float(np.linalg.norm(np.cross(readings.normals[a], readings.normals[b]))))
        for a, b in pairs
    ]
    return [pairs[k] for k in np.argsort(apart, kind="stable")[::-1][:most]]


def _vectors(p: Array, q: Array) -> Array:
    way = q - p
    return np.asarray(way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-12))


def _turned(source: list[Array], target: list[Array]) -> Array:
    """Rotations that lead vectors to others best (Kabsch); `(p, 3, 3)`."""
    table = sum(np.einsum("pi,pj->pij", b, a) for a, b in zip(source, target, strict=True))
    u, _, vt = np.linalg.svd(table)
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]
    return np.asarray(u @ vt)


def _poses(turns: Array, shifts: Array) -> Array:
    poses = np.broadcast_to(np.eye(4), (len(turns), 4, 4)).copy()
    poses[:, :3, :3], poses[:, :3, 3] = turns, shifts
    return poses


def rotations(vectors: Array) -> Array:
    """Rotation matrices of rotation vectors `(p, 3)` (Rodrigues)."""
    angles = np.linalg.norm(vectors, axis=1)
    axes = vectors / np.maximum(angles, 1e-300)[:, None]
    cross = np.zeros((len(vectors), 3, 3))
    x, y, z = axes.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross[:, 1, 0], cross[:, 2, 0], cross[:, 2, 1] = z, -y, x
    sine, versine = np.sin(angles)[:, None, None], (1.0 - np.cos(angles))[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + versine * (cross @ cross))


def in_ball(random: np.random.Generator, count: int) -> Array:
    """Vectors drawn evenly from the unit ball, `(count, 3)`."""
    ways = random.normal(size=(count, 3))
    return np.asarray(
        ways * (random.random((count, 1)) ** (1.0 / 3.0) / np.linalg.norm(ways, axis=1, keepdims=True))
    )


def _allowed(prior: Any, random: np.random.Generator, count: int) -> Array:
    if prior is None:
        return np.zeros((0, 4, 4))
    middle = np.array(prior.world_from_model)
    turns = rotations(prior.rotation * in_ball(random, count)) @ middle[:3, :3]
    shifts = middle[:3, 3] + prior.translation * random.uniform(-1.0, 1.0, size=(count, 3))
    return _poses(turns, shifts)


@dataclass(frozen=True)
class _Seen:
    """Of each pose and contact: the nearest place and what is left of it."""

    heights: Array  # along the placed normal, (p, n)
    asides: Array  # across it, beyond the spacing of the places
    angles: Array
    normals: Array  # of the place, model frame, (p, n, 3)
    offsets: Array  # centre − point, model frame, (p, n, 3)


def _see(places: Places, readings: Readings, poses: Array) -> _Seen:
    turns, shifts = poses[:, :3, :3], poses[:, :3, 3]
    centers = (readings.centers - shifts[:, None]) @ turns
    asked = centers
    if places.scale > 0.0:
        own = readings.normals @ turns
        asked = np.concatenate([centers, places.scale * own], axis=2)
    _, near = places.tree.query(asked.reshape(-1, asked.shape[2]))
    near = near.reshape(centers.shape[:2])
    offsets = centers - places.points[near]
    normals = places.normals[near]
    heights = np.einsum("pni,pni->pn", offsets, normals)
    asides = np.linalg.norm(offsets - heights[..., None] * normals, axis=2)
    angles = np.zeros_like(heights)
    if places.scale > 0.0:
        angles = 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(own - normals, axis=2), 0.0, 1.0))
    return _Seen(
        heights,
        np.maximum(asides - places.spacing, 0.0),
        angles,
        normals,
        offsets,
    )


def worst_of(  # noqa: PLR0917 - as in `search`
    places: Places, readings: Readings, poses: Array, tolerances: tuple[float, float]
) -> Array:
    """By how many tolerances the worst contact is off; `(p,)`."""
    seen = _see(places, readings, poses)
    away = np.hypot(seen.heights, seen.asides) / (tolerances[0] * readings.position_errors)
    turned = seen.angles / (tolerances[1] * readings.normal_errors)
    return np.asarray(np.maximum(away, turned).max(axis=1))


def step(places: Places, readings: Readings, poses: Array) -> Array:
    """A step of damped least squares on heights and normals, each with the places that are nearest now."""
    seen = _see(places, readings, poses)
    pivot = readings.centers.mean(axis=0)
    normals, offsets = (one @ poses[:, :3, :3].swapaxes(1, 2) for one in (seen.normals, seen.offsets))
    arms = readings.centers - pivot - offsets
    weight = 1.0 / readings.position_errors[:, None]
    # A turn ω and a shift t of the part move its point by ω × arm + t; what is left along the normal shrinks
    # by that.
    lines = np.concatenate([np.cross(arms, normals), normals], axis=2) * weight
    left = seen.heights * weight[:, 0]
    system = np.einsum("pni,pnj->pij", lines, lines)
    target = np.einsum("pni,pn->pi", lines, left)
    if places.scale > 0.0:
        weights = 1.0 / readings.normal_errors**2
        outer = np.einsum("pni,pnj,n->pij", normals, normals, weights)
        system[:, :3, :3] += weights.sum() * np.eye(3) - outer
        target[:, :3] += np.einsum("pni,n->pi", np.cross(normals, readings.normals), weights)
    reach = max(1.0, float(np.linalg.norm(readings.centers - pivot, axis=1).max()))
    error = float(readings.position_errors.min())
    damping = np.diag([(0.03 * reach / error) ** 2] * 3 + [(0.03 / error) ** 2] * 3)
    move = np.linalg.solve(system + damping, target[..., None])[..., 0]
    size = np.linalg.norm(move[:, :3], axis=1, keepdims=True)
    turns = rotations(move[:, :3] * np.minimum(1.0, 0.5 / np.maximum(size, 1e-12)))
    shifted = np.einsum("pij,pj->pi", turns, poses[:, :3, 3] - pivot) + pivot + move[:, 3:]
    return _poses(turns @ poses[:, :3, :3], shifted)


def _spread(
    poses: Array,
    worst: Array,
    readings: Readings,
    *,
    length: float,
    most: int,
    random: np.random.Generator | None,
) -> Array:
    """Those within tolerance, the best of each cell of poses: no crowd pushes others out.

    Of too many cells the best, or with `random` any.
    """
    order = np.argsort(worst, kind="stable")
    within = order[worst[order] <= 1.0]
    if len(within) < 20:
        within = order[:20]
    keys = cells(poses[within], readings.centers, 2.0 * length * float(readings.position_errors.max()))
    _, first = np.unique(keys, axis=0, return_index=True)
    first = np.sort(first)
    if random is not None and len(first) > most:
        first = np.sort(random.choice(first, size=most, replace=False))
    return np.asarray(poses[within[first][:most]])


def _lowered(  # noqa: PLR0917 - what is moved, among what
    places: Places,
    readings: Readings,
    poses: Array,
    random: np.random.Generator,
    *,
    rounds: int,
    tries: int = 40,
) -> Array:
    """Each pose moved to where the worst contact is explained better, by trying neighbours nearer and nearer.

    Least squares end in the middle of the errors; bounds ask for the middle of the extremes.
    """
    best = worst_of(places, readings, poses, (1.0, 1.0))
    for number in range(rounds):
        length = 1.5 * 0.75**number
        tried = _scattered(poses, readings, random, length=length, count=tries * len(poses))[len(poses) :]
        worst = worst_of(places, readings, tried, (1.0, 1.0)).reshape(len(poses), -1)
        first = worst.argmin(axis=1)
        least = worst[np.arange(len(poses)), first]
        tried = tried.reshape(len(poses), -1, 4, 4)[np.arange(len(poses)), first]
        better = least < best
        poses = np.where(better[:, None, None], tried, poses)
        best = np.minimum(best, least)
    return poses[np.argsort(best, kind="stable")]


def _explored(  # noqa: PLR0917 - as in `search`
    places: Places, readings: Readings, poses: Array, random: np.random.Generator, *, settings: Settings
) -> Array:
    """Particles that wander over the regions that satisfy the bounds, so that these are filled evenly."""
    least = worst_of(places, readings, poses, (1.0, 1.0))
    count = settings.num_particles if settings.even else settings.num_particles // 2
    # The best start, or any that are within; where few do, several from each.
    ranks = np.maximum(least, 1.1) + 1e-9 * random.random(len(least)) if settings.even else least
    order = np.argsort(ranks, kind="stable")[:count]
    poses = np.resize(poses[order], (count, 4, 4)) if len(order) else poses
    least = np.resize(least[order], count)
    for number in range(settings.rounds):
        moved = _scattered(poses, readings, random, length=3.0 * 0.6 ** (number % 5), count=count)[count:]
        worst = worst_of(places, readings, moved, (1.0, 1.0))
        # As in annealing, worse than now is taken if it is within the bounds, else only better.
        taken = (worst <= 1.1) | (worst < least)
        poses = np.where(taken[:, None, None], moved, poses)
        least = np.where(taken, worst, least)
    return np.asarray(poses[least <= 1.2])


def cells(poses: Array, centers: Array, width: float) -> Numbers:
    """Whole numbers that are alike for poses that place the contacts alike; `(p, 9)`."""
    middle = centers.mean(axis=0)
    reach = max(1e-9, float(np.linalg.norm(centers - middle, axis=1).max()))
    corners = middle + reach * np.eye(3)
    placed = np.einsum("pji,pkj->pki", poses[:, :3, :3], corners - poses[:, None, :3, 3])
    return np.floor(placed / width).astype(np.int64).reshape(len(poses), 9)


def _scattered(
    kept: Array, readings: Readings, random: np.random.Generator, *, length: float, count: int
) -> Array:
    """The kept ones, and others about them, to so many in all."""
    copies = max(1, count // max(1, len(kept)))
    base = np.repeat(kept, copies, axis=0)
    pivot = readings.centers.mean(axis=0)
    reach = max(1e-9, float(np.linalg.norm(readings.centers - pivot, axis=1).max()))
    far = length * float(readings.position_errors.max())
    turns = rotations(far / reach * in_ball(random, len(base)))
    shifts = np.einsum("pij,pj->pi", turns, base[:, :3, 3] - pivot) + pivot
    shifts += far * in_ball(random, len(base))
    moved = _poses(turns @ base[:, :3, :3], shifts)
    return np.concatenate([kept, moved])


def distinct(poses: Array, centers: Array, width: float) -> Array:
    """One pose of each cell, in their order."""
    if not len(poses):
        return poses
    _, first = np.unique(cells(poses, centers, width), axis=0, return_index=True)
    return np.asarray(poses[np.sort(first)])


def same_place(solid: Solid, pose: Array, other: Array, *, within: float) -> Mask:
    """Whether the part is in the same place in both poses, up to its symmetry.

    Each vertex must be within a length of one of the other's. `pose` has shape `(p, 4, 4)`, `other`
    `(4, 4)`; the answer `(p,)`.
    """
    from scipy.spatial import cKDTree

    if not len(pose):
        return np.zeros(0, dtype=bool)
    tree = cKDTree(solid.vertices @ other[:3, :3].T + other[:3, 3])
    held = np.ones(len(pose), dtype=bool)
    for vertices in (solid.vertices[:: max(1, len(solid.vertices) // 6)], solid.vertices):
        placed = np.einsum("pij,vj->pvi", pose[held, :3, :3], vertices) + pose[held, None, :3, 3]
        distances, _ = tree.query(placed.reshape(-1, 3), distance_upper_bound=1.001 * within + 1e-9)
        held[held] = distances.reshape(len(placed), len(vertices)).max(axis=1) <= within
    return held
