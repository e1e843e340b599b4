"""The main job end to end on a bundled part: it lies somewhere, is touched twice, and is recognized."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate._core import Contact, Model, Recognition, recognize
from palpate.models import load_models
from palpate.parts import DRILL_PARTS, THESIS_OBJECTS, standard_contacts

DEFAULT_PART = "telephone"

_TABLE = 150.0  # mm: the part's own origin lies within this of the table's, in x and y


@dataclass(frozen=True)
class Demonstration:
    """What lay there, what was touched, what was found; lengths in `unit`."""

    truth: Model
    world_from_truth: NDArray[np.float64]
    models: list[Model]
    contacts: list[Contact]
    found: Recognition
    truth_number: int | None
    """The hypothesis, counted from 1, that holds the true part and pose."""
    unit: str = "mm"


def demonstrate(part: str = DEFAULT_PART, *, seed: int = 0) -> Demonstration:
    """Lay `part` at a random pose, touch it where its bundled contacts are, recognize it among its kind.

    Args:
        part: Name of a bundled part.
        seed: Chooses the pose, and the errors of the contacts within their bounds.
    """
    kind = next((names for names in (THESIS_OBJECTS, DRILL_PARTS) if part in names), None)
    if kind is None:
        known = ", ".join(THESIS_OBJECTS + DRILL_PARTS)
        raise ValueError(f"part: no such bundled part (got {part!r}); give one of {known}")
    if seed < 0:
        raise ValueError(f"seed: must be zero or more (got {seed}); give another one")
    models = load_models(kind)
    truth = models[kind.index(part)]
    random = np.random.default_rng(seed)
    world_from_truth = _random_pose(random)
    contacts = [_sensed(contact, world_from_truth, random) for contact in standard_contacts(part)]
    found = recognize(models, contacts)
    return Demonstration(
        truth, world_from_truth, models, contacts, found, _number_of(found, truth, world_from_truth)
    )


def _random_pose(random: np.random.Generator) -> NDArray[np.float64]:
    angle = random.uniform(-math.pi, math.pi)
    x, y = random.uniform(-_TABLE, _TABLE, size=2)
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine, x], [sine, cosine, y], [0.0, 0.0, 1.0]])


def _sensed(
    contact_model: Contact, world_from_model: NDArray[np.float64], random: np.random.Generator
) -> Contact:
    """The contact as a sensor would report it from the part at its pose: errors within the bounds."""
    rotation = world_from_model[:2, :2]
    # Uniform in the disc of position errors, a hair inside it: rounding must not carry the truth out.
    radius = 0.999 * contact_model.position_error * math.sqrt(random.uniform())
    toward = random.uniform(-math.pi, math.pi)
    error = radius * np.array([math.cos(toward), math.sin(toward)])
    center = rotation @ contact_model.center + world_from_model[:2, 2] + error
    turn = 0.999 * random.uniform(-1.0, 1.0) * (contact_model.normal_error or 0.0)
    return Contact.from_tip(
        center,
        contact_model.tip_radius,
        position_error=contact_model.position_error,
        normal=None if contact_model.normal is None else _turned(rotation @ contact_model.normal, turn),
        normal_error=contact_model.normal_error,
        approach=None if contact_model.approach is None else rotation @ contact_model.approach,
    )


def _turned(direction: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y = direction
    return np.array([cosine * x - sine * y, sine * x + cosine * y])


def _number_of(found: Recognition, truth: Model, world_from_truth: NDArray[np.float64]) -> int | None:
    numbers: Sequence[int] = [
        number
        for number, hypothesis in enumerate(found.hypotheses, start=1)
        if hypothesis.model == truth and hypothesis.poses.contains(world_from_truth)
    ]
    return numbers[0] if numbers else None
