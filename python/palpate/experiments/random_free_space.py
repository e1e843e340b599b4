"""Random sweeps that keep clear of a placed part, some of them just."""

from __future__ import annotations

import math
from random import Random

import numpy as np

from palpate import Contact, Miss

from .random_parts import log_uniform
from .shapes import Array, Shape
from .sweeps import least_distances


def in_model(truth: Array, point: Array) -> Array:
    """A world point in the frame of the model placed at `truth`."""
    placed: Array = truth[:2, :2].T @ (point - truth[:2, 2])
    return placed


def in_world(truth: Array, point: Array) -> Array:
    """A model point in the world, the model placed at `truth`."""
    placed: Array = truth[:2, :2] @ point + truth[:2, 2]
    return placed


def with_start(random: Random, contact: Contact, shape: Shape, *, truth: Array, normal: Array) -> Contact:
    """The contact with a start from which the tip came freely; the same contact if three tries find none."""
    for _ in range(3):
        turn = random.uniform(-1.2, 1.2)
        c, s = math.cos(turn), math.sin(turn)
        back = np.array([c * normal[0] - s * normal[1], s * normal[0] + c * normal[1]])
        length = contact.position_error + shape.model.size * log_uniform(random, 0.01, 1.0)
        start = np.asarray(contact.center) + length * back
        # The free part ends the position error short of the sensed centre (DESIGN §2).
        end = np.asarray(contact.center) + contact.position_error * back
        ends = [in_model(truth, point)[None] for point in (start, end)]
        clearance = contact.tip_radius - contact.position_error - shape.model.position_slack
        if least_distances(shape, ends[0], ends[1])[0] >= clearance:
            return Contact.from_tip(
                contact.center,
                contact.tip_radius,
                position_error=contact.position_error,
                normal=contact.normal,
                normal_error=contact.normal_error,
                approach=contact.approach,
                start=start,
            )
    return contact


def add_misses(random: Random, shape: Shape, truth: Array) -> tuple[Miss, ...]:
    """Up to three sweeps past the part."""
    misses = [_random_miss(random, shape, truth) for _ in range(random.randint(1, 3))]
    return tuple(miss for miss in misses if miss is not None)


def _random_miss(random: Random, shape: Shape, truth: Array) -> Miss | None:
    """Along or past a random face; its clearance is at most what the truth leaves, often just that."""
    size = shape.model.size
    for _ in range(5):
        start, end = _random_sweep(random, shape)
        least = float(least_distances(shape, start[None], end[None])[0])
        if least < -0.05 * size:
            continue
        # The clearance may be as large as `least`: tip_radius − path_error − position_slack.
        most = least + shape.model.position_slack
        share = 1.0 if random.random() < 1.0 / 3.0 else random.random()
        path_error = random.choice((0.0, 0.02 * size * random.random()))
        clearance = most * share if most >= 0.0 else most
        radius = clearance + path_error
        if radius < 0.0:
            radius, path_error = 0.0, -clearance
        return Miss(in_world(truth, start), in_world(truth, end), tip_radius=radius, path_error=path_error)
    return None


def _random_sweep(random: Random, shape: Shape) -> tuple[Array, Array]:
    """A segment, model frame, that passes near a face; one in five is parallel to it."""
    size = shape.model.size
    face = random.randrange(len(shape.starts))
    normal = shape.normals[face]
    along = np.array([-normal[1], normal[0]])
    near = shape.starts[face] + random.random() * (shape.ends[face] - shape.starts[face])
    near = near + size * log_uniform(random, 1e-4, 0.3) * normal
    turn = 0.0 if random.random() < 0.2 else random.gauss(0.0, 0.7)
    direction = math.cos(turn) * along + math.sin(turn) * normal
    before, after = (size * log_uniform(random, 0.01, 1.0) for _ in range(2))
    return near - before * direction, near + after * direction
