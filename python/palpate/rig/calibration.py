"""Zero and gains: what the computer knows of its gauges (thesis A.1).

The zero is averaged at start-up, follows a moving window during free moves, and is taken anew at rest before
each guarded move, during which it stays, and after each contact. Gains come from known weights hung from the
bearing: along each axis to either side, so that the zero drops out.
"""

from __future__ import annotations

from collections import deque
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.gauges import Gauges, turned
from palpate.rig.specification import BURSTS, RigSpec

Array: TypeAlias = NDArray[np.float64]

WINDOW = 1.0
"""s, of the moving zero."""
DELAY = 0.15
"""s, that it lags: the beginning of a contact must not be taken for a zero."""


class Zero:
    """A moving average of counts at almost no force."""

    def __init__(self, first: Array, *, rate_hz: float, near: float) -> None:
        """A zero from the average at start-up; `near`: counts farther off are no zero."""
        self.value = first
        self._near = near
        self._window: deque[Array] = deque(maxlen=max(1, round(WINDOW * rate_hz)))
        self._delay: deque[Array] = deque(maxlen=max(1, round(DELAY * rate_hz)))

    def follow(self, counts: Array) -> None:
        """A tick in which nothing should touch."""
        if np.abs(counts - self.value).max() > self._near:
            # It may be a contact: what was seen last is no zero.
            self._delay.clear()
            return
        if len(self._delay) == self._delay.maxlen:
            self._window.append(self._delay[0])
            self.value = np.mean(self._window, axis=0)
        self._delay.append(counts)

    def reset(self, counts: Array) -> None:
        """A zero that was averaged at rest, clear of everything."""
        self.value = counts
        self._window.clear()
        self._delay.clear()


def calibrated(gauges: Gauges, spec: RigSpec, *, random: np.random.Generator) -> tuple[Array, Array]:
    """Newtons for each count, shape `(d, d)`, and counts at no force, shape `(d,)`.

    From weights in the jig, the beam parallel to the ground, before the sensor is mounted.
    """
    jig, ticks = spec.jig, round(spec.jig.seconds * spec.control.rate_hz)
    columns: list[Array] = []
    zeros: list[Array] = []
    for axis in np.eye(len(gauges.sensitivity)):
        read: list[Array] = []
        for side in (1.0, -1.0):
            pull = side * turned(axis, jig.direction_tolerance * random.uniform(), random)
            weight = jig.weight * (1.0 + jig.weight_tolerance * random.uniform(-1.0, 1.0))
            forces = np.repeat(weight * pull[None, :], BURSTS, axis=0)
            counts = [gauges.read(forces, 1.0 / spec.control.rate_hz) for _ in range(ticks)]
            read.append(np.mean(counts, axis=0))
        columns.append((read[0] - read[1]) / (2.0 * jig.weight))
        zeros.append((read[0] + read[1]) / 2.0)
    return np.asarray(np.linalg.inv(np.column_stack(columns))), np.asarray(np.mean(zeros, axis=0))
