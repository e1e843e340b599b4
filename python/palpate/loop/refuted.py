"""What guarded moves refute: hypotheses that could not have been met as they were (`docs/theory.md`, T15).

Recognition takes a contact as a place and a way as swept. It does not ask whether a tip on this very line may
have stopped there first; the judge of paths does.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeAlias

import numpy as np

from palpate._core import Contact, Hypothesis, Miss, Sensor, refuting_moves
from palpate.loop.result import Array
from palpate.loop.wander import path_error_of
from palpate.probe import Hit, Reply, Skid

# Of a part's size, and radians; rounding and images of nearly symmetric parts are off by less.
GRANTED = 1e-6

_Move: TypeAlias = tuple[Array, Array, float, Sensor, Contact | None]


def refuted(
    hypotheses: Sequence[Hypothesis], moves: Iterable[tuple[Array, Array, Reply]], sensor: Sensor
) -> dict[int, int]:
    """Numbers of hypotheses that can't have answered a move, each with the number of the first such move.

    Args:
        hypotheses: What recognition left.
        moves: Start, end and reply of each guarded move. What is no reading refutes nothing.
        sensor: The path error is its own, or, if it states none, the position error; the other bounds are
            those of each reading.
    """
    if not hypotheses:
        return {}
    granted = GRANTED * max(one.model.size for one in hypotheses)
    asked: list[tuple[int, _Move]] = []
    for number, (start, end, reply) in enumerate(moves):
        move = None
        if isinstance(reply, Hit):
            move = _touched(start, end, reply.contact, sensor=sensor, granted=granted)
        elif isinstance(reply, Miss | Skid):
            free = reply.free if isinstance(reply, Skid) else reply
            move = _passed(free, sensor=sensor, granted=granted)
        if move is not None:
            asked.append((number, move))
    # Poses of a solid that are undecided are hardly known: it takes long to ask, and refutes nothing.
    numbers = [k for k, one in enumerate(hypotheses) if one.proved or one.model.dimension == 2]
    first = refuting_moves([hypotheses[k] for k in numbers], [move for _, move in asked]) if numbers else []
    return {k: asked[place][0] for k, place in zip(numbers, first, strict=True) if place is not None}


def without_way(contact: Contact) -> Contact:
    """The contact as a place alone; what was swept on the way to it is in its guarded move."""
    return Contact.from_tip(
        contact.center,
        contact.tip_radius,
        position_error=contact.position_error,
        approach=contact.approach,
        normal=contact.normal,
        normal_error=contact.normal_error,
    )


def _touched(start: Array, end: Array, contact: Contact, *, sensor: Sensor, granted: float) -> _Move:
    """That it was touched first where the contact says, all along this line."""
    normal_error = contact.normal_error
    felt = Sensor(
        contact.position_error + granted,
        None if normal_error is None else min(normal_error + GRANTED, np.pi / 2),
        sensor.max_incidence,
        contact.tip_radius,
        path_error_of(sensor, contact.position_error) + granted,
    )
    return start, end - start, float(np.hypot.reduce(end - start)) + granted, felt, contact


def _passed(free: Miss, *, sensor: Sensor, granted: float) -> _Move | None:
    """That it was passed by; None: the way is too short to tell."""
    way = free.end - free.start
    length = float(np.hypot.reduce(way)) - granted
    if not length > 0.0:
        return None
    felt = Sensor(
        sensor.position_error,
        sensor.normal_error,
        sensor.max_incidence,
        free.tip_radius,
        max(path_error_of(sensor), free.path_error) + granted,
    )
    return free.start, way, length, felt, None
