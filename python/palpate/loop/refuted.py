"""What guarded moves refute: hypotheses that could not have been met as they were (`docs/theory.md`, T15).

Recognition takes a contact as a place and a way as swept. It does not ask whether a tip on this very line may
have stopped there first; the judge of paths does.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from palpate._core import Contact, Hypothesis, Miss, Sensor, judge
from palpate.loop.result import Array
from palpate.probe import Hit, Reply, Skid

# Of a part's size, and radians; rounding and images of nearly symmetric parts are off by less.
GRANTED = 1e-6


def refuted(
    hypotheses: Sequence[Hypothesis], moves: Iterable[tuple[Array, Array, Reply]], sensor: Sensor
) -> dict[int, int]:
    """Numbers of hypotheses that can't have answered a move, each with the number of the first such move.

    Args:
        hypotheses: What recognition left.
        moves: Start, end and reply of each guarded move. What is no reading refutes nothing.
        sensor: The path error is its own; the other bounds are those of each reading.
    """
    known: dict[int, int] = {}
    granted = GRANTED * max((one.model.size for one in hypotheses), default=0.0)
    for number, (start, end, reply) in enumerate(moves):
        asked = [k for k in range(len(hypotheses)) if k not in known]
        if not asked:
            break
        among = [hypotheses[k] for k in asked]
        answered: list[int] | None = None
        if isinstance(reply, Hit):
            answered = _touched(among, start, end, reply.contact, sensor=sensor, granted=granted)
        elif isinstance(reply, Miss | Skid):
            free = reply.free if isinstance(reply, Skid) else reply
            answered = _passed(among, free, sensor=sensor, granted=granted)
        if answered is not None:
            known |= {asked[k]: number for k in range(len(asked)) if k not in answered}
    return known


def _touched(  # noqa: PLR0917 - a line, and what it met
    among: list[Hypothesis], start: Array, end: Array, contact: Contact, *, sensor: Sensor, granted: float
) -> list[int]:
    """Those that may have been touched first where the contact says, all along this line."""
    normal_error = contact.normal_error
    felt = Sensor(
        contact.position_error + granted,
        None if normal_error is None else min(normal_error + GRANTED, np.pi / 2),
        sensor.max_incidence,
        contact.tip_radius,
        sensor.path_error + granted,
    )
    length = float(np.hypot(*(end - start))) + granted
    return judge(among, felt, start, end - start, length).outcome_of(contact)


def _passed(among: list[Hypothesis], free: Miss, *, sensor: Sensor, granted: float) -> list[int] | None:
    """Those that such a way may pass by; None: it is too short to tell."""
    way = free.end - free.start
    length = float(np.hypot(*way)) - granted
    if not length > 0.0:
        return None
    felt = Sensor(
        sensor.position_error,
        sensor.normal_error,
        sensor.max_incidence,
        free.tip_radius,
        max(sensor.path_error, free.path_error) + granted,
    )
    return judge(among, felt, free.start, way, length).outcome_of(None)
