"""Random planar problems whose answer is known: a part, where it is, and evidence that agrees with it.

Everything follows from the problem's seed. A third of the contacts have their noise at the bounds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from random import Random

import numpy as np

from palpate import Contact, Miss, Model, Prior, Recognition, recognize

from .oracle import Assignment, Evidence, Feature
from .random_free_space import add_misses, with_start
from .random_parts import FAMILIES, bundled, log_uniform, random_part
from .shapes import Array, Shape


@dataclass(frozen=True)
class Problem:
    """What is given to the recognizer, and the truth. Lengths in the part's unit."""

    seed: int
    family: str
    models: tuple[Model, ...]
    contacts: tuple[Contact, ...]
    misses: tuple[Miss, ...]
    prior: Prior | None
    features: tuple[str, ...] | None
    shape: Shape
    world_from_model: Array
    assignment: Assignment

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of features that contacts may lie on."""
        tips = any(contact.tip_radius > 0.0 for contact in self.contacts)
        return self.features or (("face", "vertex") if tips else ("face",))

    @property
    def size(self) -> float:
        """Of the true part."""
        return self.shape.model.size

    def evidence(self) -> Evidence:
        """As the true model sees it."""
        return Evidence.of(self.shape, self.contacts, misses=self.misses, prior=self.prior)

    def recognize(self) -> Recognition:
        """The answer of the core."""
        return recognize(
            self.models, self.contacts, features=self.features, misses=self.misses, prior=self.prior
        )


@dataclass(frozen=True)
class Bounds:
    """Of a problem's readings. Lengths in the part's unit, angles in radians."""

    position_error: float
    normal_error: float
    tip_radius: float
    #: Chances that a contact has no normal, that it has an approach, and that it says where it began.
    bare: float
    approach: float
    start: float
    #: All contacts have their noise at the bounds, not just a third.
    extreme: bool


def matrix(angle: float, x: float, y: float) -> Array:
    """A pose as a homogeneous matrix."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, x], [s, c, y], [0.0, 0.0, 1.0]])


def random_problem(seed: int) -> Problem:
    """The problem of this seed."""
    random = Random(seed)
    family = random.choices(list(FAMILIES), list(FAMILIES.values()))[0]
    part = random_part(random, family)
    models = bundled() if family == "bundled" and random.random() < 0.15 else (part,)
    unit = part.size / 150.0
    bounds = _random_bounds(random, unit)
    reach = unit * (1e5 if random.random() < 0.03 else 300.0)
    truth = matrix(
        random.uniform(-math.pi, math.pi), random.uniform(-reach, reach), random.uniform(-reach, reach)
    )
    shape = Shape.of(part)
    vertices = bool(shape.touchable_corners.any()) and (bounds.tip_radius > 0.0 or random.random() < 0.05)
    touches = [
        _random_touch(random, shape, truth, bounds=bounds, vertices=vertices)
        for _ in range(random.randint(2, 8))
    ]
    tips = any(contact.tip_radius > 0.0 for contact, _ in touches)
    features = ("face", "vertex") if vertices and not tips else None
    prior = _random_prior(random, truth, unit, likely=bounds.bare > 0.0)
    misses = add_misses(random, shape, truth) if random.random() < 0.15 else ()
    return Problem(
        seed=seed,
        family=family,
        models=models,
        contacts=tuple(contact for contact, _ in touches),
        misses=misses,
        prior=prior,
        features=features,
        shape=shape,
        world_from_model=truth,
        assignment=[feature for _, feature in touches],
    )


def _random_bounds(random: Random, unit: float) -> Bounds:
    bare = random.random()
    return Bounds(
        position_error=unit * log_uniform(random, 0.01, 4.0),
        normal_error=math.radians(log_uniform(random, 0.1, 15.0)),
        tip_radius=unit * random.uniform(0.5, 3.0) if random.random() < 0.3 else 0.0,
        bare=1.0 if bare < 0.04 else 0.4 if bare < 0.12 else 0.0,
        approach=random.choice((0.0, 0.0, 0.5, 1.0)),
        start=random.choice((0.0, 0.0, 0.0, 0.0, 0.5, 1.0)),
        extreme=random.random() < 0.1,
    )


def _random_touch(
    random: Random, shape: Shape, truth: Array, *, bounds: Bounds, vertices: bool
) -> tuple[Contact, Feature]:
    """A contact on a random place of the part, and the feature it lies on."""
    feature, point, normal_angle = _random_place(random, shape, vertices=vertices)
    turn = math.atan2(truth[1, 0], truth[0, 0])
    angle = normal_angle + turn
    normal = np.array([math.cos(angle), math.sin(angle)])
    # In a workshop some contacts are made with another tip.
    radius = 0.0 if random.random() < 0.1 else bounds.tip_radius
    center = truth[:2, :2] @ point + truth[:2, 2] + radius * normal
    at_bounds = bounds.extreme or random.random() < 1.0 / 3.0
    share = 1.0 if at_bounds else math.sqrt(random.random())
    length = share * (bounds.position_error + shape.model.position_slack)
    where = random.uniform(-math.pi, math.pi)
    sensed = center + length * np.array([math.cos(where), math.sin(where)])
    error = bounds.normal_error + shape.model.normal_slack
    noise = random.choice((-1.0, 1.0)) if at_bounds else random.uniform(-1.0, 1.0)
    reading = None if random.random() < bounds.bare else angle + error * noise
    approach = None
    if random.random() < bounds.approach:
        aside = random.choice((-0.5, 0.5)) if random.random() < 0.1 else random.uniform(-0.4, 0.4)
        approach = angle + math.pi * (1.0 + aside)
    contact = Contact.from_tip(
        sensed,
        radius,
        position_error=bounds.position_error,
        normal=None if reading is None else (math.cos(reading), math.sin(reading)),
        normal_error=None if reading is None else bounds.normal_error,
        approach=None if approach is None else (math.cos(approach), math.sin(approach)),
    )
    if random.random() < bounds.start:
        contact = with_start(random, contact, shape, truth=truth, normal=normal)
    return contact, feature


def _random_place(random: Random, shape: Shape, *, vertices: bool) -> tuple[Feature, Array, float]:
    """A feature, a point of it and the angle of the normal there, model frame. Some are ends of faces."""
    if vertices and random.random() < 0.25:
        corner = random.choice(np.flatnonzero(shape.touchable_corners).tolist())
        aside = random.choice((-1.0, 1.0)) if random.random() < 0.2 else random.uniform(-1.0, 1.0)
        angle = shape.cone_middles[corner] + aside * shape.cone_halves[corner]
        return ("vertex", corner), shape.corners[corner], float(angle)
    weights = shape.lengths * shape.touchable_faces
    face = random.choices(range(len(weights)), weights.tolist())[0]
    along = random.choice((0.0, 1.0)) if random.random() < 0.12 else random.random()
    point = shape.starts[face] + along * (shape.ends[face] - shape.starts[face])
    return ("face", face), point, float(shape.normal_angles[face])


def _random_prior(random: Random, truth: Array, unit: float, *, likely: bool) -> Prior | None:
    """One that allows the truth; in a third of them it is at the bounds."""
    if random.random() > (0.7 if likely else 0.12):
        return None
    translation = unit * log_uniform(random, 0.5, 50.0)
    rotation = math.radians(log_uniform(random, 0.5, 180.0))
    if random.random() < 0.05:
        translation, rotation = 0.0, 0.0

    def offset() -> float:
        return random.choice((-1.0, 1.0)) if random.random() < 1.0 / 3.0 else random.uniform(-1.0, 1.0)

    middle = matrix(
        math.atan2(truth[1, 0], truth[0, 0]) + rotation * offset(),
        truth[0, 2] + translation * offset(),
        truth[1, 2] + translation * offset(),
    )
    return Prior(middle, translation=translation, rotation=rotation)


def described(problem: Problem) -> Sequence[str]:
    """The problem as lines that a person can copy into Python."""
    lines = [f"# seed {problem.seed}, {problem.family}"]
    for model in problem.models:
        faces = [np.asarray(face).tolist() for face in model.faces]
        lines.append(f"# {model.name}: closed {model.closed}, surfaces {model.face_surfaces}, faces {faces}")
    lines += [f"contacts = {list(problem.contacts)!r}", f"misses = {list(problem.misses)!r}"]
    lines += [f"prior = {problem.prior!r}", f"features = {problem.features!r}"]
    lines += [f"truth = {problem.world_from_model.tolist()}", f"assignment = {problem.assignment}"]
    return lines
