"""Random problems of space whose answer is known: a solid, where it is, and evidence that agrees with it.

Everything follows from the problem's seed and the parts. A third of the contacts have their errors at the
bounds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from .random_solids import random_solid
from .solid_oracle import ALL_KINDS
from .solid_particles import in_ball, rotations
from .solid_sweeps import keep_off, outside
from .solids import Array, Solid

Random = np.random.Generator

PRIOR_TRANSLATION, PRIOR_ROTATION = 20.0, math.radians(15.0)
#: Where contacts are: all around, near each other, on one side.
MANNERS = ("around", "around", "cluster", "side")
#: What a problem may be about, and the share of each.
FAMILIES = {"points": 45, "tips": 20, "no-normals": 10, "free-paths": 15, "library": 10}


@dataclass(frozen=True)
class Touch:
    """A contact, as `palpate.Contact.from_tip` takes it; world frame."""

    center: Array
    tip_radius: float
    position_error: float
    normal: Array | None
    normal_error: float | None
    approach: Array | None = None
    start: Array | None = None


@dataclass(frozen=True)
class Sweep:
    """A miss, as `palpate.Miss` takes it; world frame."""

    start: Array
    end: Array
    tip_radius: float
    path_error: float


@dataclass(frozen=True)
class Known:
    """A prior, as `palpate.Prior` takes it."""

    world_from_model: Array
    translation: float
    rotation: float


@dataclass(frozen=True)
class Problem:
    """What is given to the recognizer, and the truth: `solids[true]` at `world_from_model`."""

    seed: int
    family: str
    solids: tuple[Solid, ...]
    true: int
    world_from_model: Array
    contacts: tuple[Touch, ...]
    misses: tuple[Sweep, ...]
    prior: Known | None

    @property
    def solid(self) -> Solid:
        """The true part."""
        return self.solids[self.true]

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of features that contacts may lie on."""
        return ALL_KINDS if any(one.tip_radius > 0.0 for one in self.contacts) else ("face",)


@dataclass(frozen=True)
class Bounds:
    """Of a problem's readings: lengths, parts being 200 across, and an angle in radians."""

    position_error: float
    normal_error: float
    tip_radius: float = 0.0
    bare: bool = False
    approach: bool = False


def random_problem(seed: int, parts: Sequence[Solid] = ()) -> Problem:
    """The problem of this seed, of one of the parts in two of three."""
    random = np.random.default_rng(seed)
    family = _family(random)
    count = int(random.integers(2, 5)) if family == "library" else 1
    solids = tuple(_part(random, parts) for _ in range(count))
    true = int(random.integers(count))
    tips = family == "tips" or (family in ("no-normals", "free-paths") and random.random() < 0.3)
    bounds = Bounds(
        position_error=log_uniform(random, 0.05, 2.0),
        normal_error=math.radians(log_uniform(random, 0.5, 8.0)),
        tip_radius=float(random.uniform(0.5, 6.0)) if tips else 0.0,
        bare=family == "no-normals",
        approach=bool(random.random() < 0.3),
    )
    truth = random_pose(random, 300.0)
    contacts = draw_contacts(random, solids[true], truth, bounds=bounds, count=int(random.integers(3, 13)))
    misses: tuple[Sweep, ...] = ()
    if family == "free-paths":
        contacts = [_with_start(random, one, solids[true], truth=truth) for one in contacts]
        drawn = [_random_miss(random, solids[true], truth) for _ in range(int(random.integers(1, 4)))]
        misses = tuple(miss for miss in drawn if miss is not None)
    known = bounds.bare or random.random() < 0.1
    prior = _random_prior(random, truth) if known else None
    return Problem(seed, family, solids, true, truth, tuple(contacts), misses, prior)


def family_of(seed: int) -> str:
    """The family of the problem of this seed."""
    return _family(np.random.default_rng(seed))


def _family(random: Random) -> str:
    """What is drawn first of a problem."""
    shares = np.array(list(FAMILIES.values()), dtype=float)
    return list(FAMILIES)[int(random.choice(len(shares), p=shares / shares.sum()))]


def log_uniform(random: Random, low: float, high: float) -> float:
    """A number whose logarithm is spread evenly."""
    return float(low * (high / low) ** random.random())


def _part(random: Random, parts: Sequence[Solid]) -> Solid:
    made = random_solid(random)  # drawn in any case, so that all else of a problem is the same without parts
    share, which = random.random(2)
    return parts[int(which * len(parts))] if parts and share < 2.0 / 3.0 else made


def random_pose(random: Random, reach: float) -> Array:
    """Any rotation, evenly, and a place in a cube."""
    w, x, y, z = (one := random.normal(size=4)) / np.linalg.norm(one)
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, 3] = random.uniform(-reach, reach, size=3)
    return pose


def draw_contacts(
    random: Random,
    solid: Solid,
    truth: Array,
    *,
    bounds: Bounds,
    count: int,
    manners: Sequence[str] = MANNERS,
) -> list[Touch]:
    """Contacts with a placed part: all around, in a cluster, or on the side that a robot sees."""
    manner = random.choice(manners)
    points, normals = _touched(random, solid, 40 * count + 200, rounded=bounds.tip_radius > 0.0)
    if manner == "side":
        seen = normals @ in_ball(random, 1)[0] > 0.0
        points, normals = points[seen], normals[seen]
    chosen = random.permutation(len(points))[:count]
    if manner == "cluster":
        near = np.argsort(np.linalg.norm(points - points[chosen[0]], axis=1), kind="stable")
        chosen = random.permutation(near[: 4 * count])[:count]
    extreme = bool(random.random() < 0.1)
    return [
        _sensed(random, points[one], normals[one], truth=truth, bounds=bounds, extreme=extreme)
        for one in chosen
    ]


def _touched(random: Random, solid: Solid, count: int, *, rounded: bool) -> tuple[Array, Array]:
    """Points of the surface and normals there, model frame; with edges and vertices if `rounded`."""
    drawn = solid.places(random, count)
    points, normals = [drawn.points], [drawn.normals]
    # Some are on the sides of triangles: where faces end.
    some = random.random(count) < 0.1
    corners = solid.corners[drawn.triangles[some], random.integers(3, size=int(some.sum()))]
    drawn.points[some] = corners
    if rounded:
        for kind in (_edge_places, _vertex_places):
            more = kind(random, solid, count // 2)
            points.append(more[0])
            normals.append(more[1])
    return np.concatenate(points), np.concatenate(normals)


def _edge_places(random: Random, solid: Solid, count: int) -> tuple[Array, Array]:
    edges = solid.edges
    if not len(edges.starts):
        return np.zeros((0, 3)), np.zeros((0, 3))
    chosen = random.integers(len(edges.starts), size=count)
    first, second = edges.first_normals[chosen], edges.second_normals[chosen]
    along, around = random.random((2, count, 1))
    around = np.where(random.random((count, 1)) < 0.1, np.round(around), around)
    normals = (1.0 - around) * first + around * second
    points = edges.starts[chosen] + along * (edges.ends - edges.starts)[chosen]
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    whole = lengths[:, 0] > 0.1  # a knife's edge leaves no way between its faces
    return points[whole], (normals / np.maximum(lengths, 1e-9))[whole]


def _vertex_places(random: Random, solid: Solid, count: int) -> tuple[Array, Array]:
    points, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    if solid.cones:
        for chosen in random.integers(len(solid.cones), size=count):
            cone = solid.cones[chosen]
            mixed = random.dirichlet(np.ones(len(cone.rays))) @ cone.rays
            if np.linalg.norm(mixed) > 0.1:
                points.append(cone.point[None])
                normals.append((mixed / np.linalg.norm(mixed))[None])
    return np.concatenate(points), np.concatenate(normals)


def _sensed(
    random: Random, point: Array, normal: Array, *, truth: Array, bounds: Bounds, extreme: bool
) -> Touch:
    turn, shift = truth[:3, :3], truth[:3, 3]
    out = turn @ normal
    at_bounds = extreme or random.random() < 1.0 / 3.0
    error = in_ball(random, 1)[0]
    if at_bounds:
        error /= np.linalg.norm(error)
    # A hair within, so that rounding leaves the truth true.
    center = turn @ point + shift + bounds.tip_radius * out + (1.0 - 1e-12) * bounds.position_error * error
    tilt = bounds.normal_error * (1.0 if at_bounds else math.sqrt(random.random()))
    return Touch(
        center=center,
        tip_radius=bounds.tip_radius,
        position_error=bounds.position_error,
        normal=None if bounds.bare else tilted(random, out, tilt),
        normal_error=None if bounds.bare else bounds.normal_error,
        approach=tilted(random, -out, float(random.uniform(0.0, 1.0))) if bounds.approach else None,
    )


def tilted(random: Random, direction: Array, angle: float) -> Array:
    """A unit vector at an angle to another, any way round."""
    across = np.cross(direction, in_ball(random, 1)[0])
    across /= np.linalg.norm(across)
    return np.asarray(math.cos(angle) * direction + math.sin(angle) * across)


def _random_prior(random: Random, truth: Array) -> Known:
    """One that allows the truth; in a third of them it is at the bounds."""
    shift, turn = random.uniform(-1.0, 1.0, size=3), in_ball(random, 1)[0]
    if random.random() < 1.0 / 3.0:
        shift, turn = np.sign(shift), turn / np.linalg.norm(turn)
    middle = truth.copy()
    middle[:3, :3] = rotations((1.0 - 1e-12) * PRIOR_ROTATION * turn[None])[0] @ truth[:3, :3]
    middle[:3, 3] += (1.0 - 1e-12) * PRIOR_TRANSLATION * shift
    return Known(middle, PRIOR_TRANSLATION, PRIOR_ROTATION)


def _in_model(truth: Array, point: Array) -> Array:
    return np.asarray((point - truth[:3, 3]) @ truth[:3, :3])


def _with_start(random: Random, touch: Touch, solid: Solid, *, truth: Array) -> Touch:
    """The contact with a start from which the tip came freely, if a few tries find one; in half of them."""
    if random.random() < 0.5:
        return touch
    for _ in range(4):
        base = touch.normal if touch.normal is not None else in_ball(random, 1)[0]
        back = tilted(random, base / np.linalg.norm(base), float(random.uniform(0.0, 1.0)))
        start = touch.center + (touch.position_error + log_uniform(random, 2.0, 200.0)) * back
        end = touch.center + touch.position_error * back
        ends = _in_model(truth, start)[None], _in_model(truth, end)[None]
        if keep_off(solid, *ends, least=touch.tip_radius - touch.position_error, cautious=True)[0]:
            return replace(touch, start=start)
    return touch


def _random_miss(random: Random, solid: Solid, truth: Array) -> Sweep | None:
    """A sweep that passes near a face, as near as it says in a third of them; None if no try keeps clear."""
    for _ in range(6):
        place = solid.places(random, 1)
        normal = place.normals[0]
        near = place.points[0] + log_uniform(random, 0.05, 60.0) * normal
        direction = tilted(random, normal, 0.5 * math.pi + float(random.normal(0.0, 0.5)))
        before, after = log_uniform(random, 2.0, 200.0), log_uniform(random, 2.0, 200.0)
        ends = near - before * direction, near + after * direction
        least = outside(solid, *ends)
        if least <= 0.0:
            continue
        share = 1.0 - 1e-12 if random.random() < 1.0 / 3.0 else float(random.random())
        path_error = float(random.choice([0.0, random.uniform(0.0, 2.0)]))
        world = [truth[:3, :3] @ end + truth[:3, 3] for end in ends]
        return Sweep(world[0], world[1], share * least + path_error, path_error)
    return None


def new_model(solid: Solid, name: str) -> Any:
    """The core's model of a solid."""
    import palpate

    return palpate.Model.mesh(solid.vertices, solid.triangles, name=name)


#: Models by their solid, and by their name among the models of a problem.
_KEPT: WeakKeyDictionary[Solid, dict[str, Any]] = WeakKeyDictionary()


def kept_model(solid: Solid, name: str) -> Any:
    """The core's model of a solid, with the tables that it has made by now: one for all problems."""
    known = _KEPT.setdefault(solid, {})
    if name not in known:
        known[name] = new_model(solid, name)
    return known[name]


def for_core(problem: Problem, model_of: Callable[[Solid, str], Any] = new_model) -> dict[str, Any]:
    """The arguments of `palpate.recognize`, its models new or as told."""
    import palpate

    contacts = [
        palpate.Contact.from_tip(
            one.center,
            one.tip_radius,
            position_error=one.position_error,
            approach=one.approach,
            normal=one.normal,
            normal_error=one.normal_error,
            start=one.start,
        )
        for one in problem.contacts
    ]
    misses = [
        palpate.Miss(one.start, one.end, tip_radius=one.tip_radius, path_error=one.path_error)
        for one in problem.misses
    ]
    prior = None
    if problem.prior is not None:
        known = problem.prior
        prior = palpate.Prior(known.world_from_model, translation=known.translation, rotation=known.rotation)
    models = [model_of(solid, f"{number}-{solid.name}") for number, solid in enumerate(problem.solids)]
    return {"models": models, "contacts": contacts, "misses": misses, "prior": prior}
