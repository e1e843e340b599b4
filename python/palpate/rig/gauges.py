"""From the force on the tip to numbers in the computer (thesis A.1, figure A.5).

A pair of gauges on opposite faces of the beam, wired as adjacent arms of a bridge, so that each direction
reads twice the strain of one gauge and equal warming cancels. An instrumentation amplifier and an A/D
converter follow. All errors are drawn within the bounds of `Electronics`.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.beam import Beam
from palpate.rig.specification import BURSTS, Electronics

Array: TypeAlias = NDArray[np.float64]

SWING_TIMES = (41.0, 97.0)
"""Periods of what drifts beside warming up, s."""


class Gauges:
    """As many channels as the tip has directions; it keeps its own time, for drift and creep."""

    def __init__(
        self, beam: Beam, electronics: Electronics, *, dimension: int, random: np.random.Generator
    ) -> None:
        """Channels with errors of their own."""
        self._electronics = electronics
        self._random = random
        d = dimension
        self.sensitivity = self._drawn_sensitivity(beam, d)
        """Counts for each newton, shape `(d, d)`: row i is channel i."""
        self._offset = electronics.offset * random.uniform(-1.0, 1.0, d) * 2 ** (electronics.bits - 1)
        self._drift_signs = random.choice([-1.0, 1.0], (3, d)) * random.uniform(0.5, 1.0, (3, d))
        self._phases = random.uniform(0.0, 2.0 * math.pi, (2, d))
        self._time = 0.0
        self._crept = np.zeros(d)

    def _drawn_sensitivity(self, beam: Beam, d: int) -> Array:
        electronics, random = self._electronics, self._random
        axes = np.array(
            [turned(axis, electronics.axis_spread * random.uniform(), random) for axis in np.eye(d)]
        )
        # Volts of the bridge for a newton, and the gain that brings `full_scale` to the end of the range.
        bridge = electronics.excitation * electronics.gauge_factor * beam.strain_per_force / 2.0
        gain = electronics.range_volts / (bridge * electronics.full_scale)
        volts = bridge * gain * (1.0 + electronics.gain_spread * random.uniform(-1.0, 1.0, d))
        return np.asarray(volts[:, None] * axes / count_volts(electronics))

    def read(self, forces: Array, seconds: float) -> Array:
        """Counts, the mean of a tick's bursts, shape `(d,)`.

        Args:
            forces: On the tip, at each burst, shape `(BURSTS, d)`, N.
            seconds: That the tick takes.
        """
        electronics, d = self._electronics, len(self._crept)
        self._time += seconds
        decay = math.exp(-seconds / electronics.creep_time)
        steady = electronics.creep * forces.mean(axis=0)
        self._crept = steady + (self._crept - steady) * decay
        felt = (forces - self._crept + self.drifted(self._time)) @ self.sensitivity.T + self._offset
        counts = np.repeat(felt[:, None, :], electronics.burst, axis=1)
        if electronics.noise > 0.0:
            clip = electronics.noise_clip
            noise = np.clip(self._random.standard_normal((BURSTS, electronics.burst, d)), -clip, clip)
            counts = counts + electronics.noise * noise
        limit = 2 ** (electronics.bits - 1)
        return np.clip(np.rint(counts), -limit, limit - 1).mean(axis=(0, 1))

    def drifted(self, time: float) -> Array:
        """What warming has added by now, shape `(d,)`, N: never faster than `Electronics.drift`."""
        electronics = self._electronics
        warming = electronics.warming * (1.0 - math.exp(-time / electronics.warming))
        drift = 0.5 * self._drift_signs[0] * warming
        for k, period in enumerate(SWING_TIMES):
            turn = 2.0 * math.pi / period
            swing = np.sin(turn * time + self._phases[k]) - np.sin(self._phases[k])
            drift = drift + 0.25 * self._drift_signs[1 + k] * swing / turn
        return np.asarray(electronics.drift * drift)


def turned(axis: Array, angle: float, random: np.random.Generator) -> Array:
    """A unit vector, shape `(d,)`, turned by an angle to a random side."""
    aside = random.normal(size=len(axis))
    aside -= (aside @ axis) * axis
    return np.asarray(math.cos(angle) * axis + math.sin(angle) * aside / np.linalg.norm(aside))


def count_volts(electronics: Electronics) -> float:
    """Step of the converter, V."""
    return float(electronics.range_volts / 2 ** (electronics.bits - 1))


def count_force(electronics: Electronics) -> float:
    """The same as a force on a nominal channel, N."""
    return float(electronics.full_scale / 2 ** (electronics.bits - 1))
