"""The position servo: velocities that bring the tip to a place, with scheduled gains (A.2, figure A.8)."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.specification import Control

Array: TypeAlias = NDArray[np.float64]

THERE = 0.03
"""mm: so near is there."""
BRAKE = 0.5
"""Of the acceleration is planned with for braking; the rest makes up for the lag of the loop."""


class PositionServo:
    """The gain depends on how far it is: full speed, then as braking asks, then a constant gain."""

    def __init__(self, control: Control, speed: float) -> None:
        """A servo at rest, that goes no faster than `speed`, mm/s."""
        self._control = control
        self._speed = speed
        self._last = 0.0

    def speed_for(self, distance: float) -> float:
        """The speed that is asked for at a distance, no faster than the ramp up allows."""
        control = self._control
        braking = math.sqrt(2.0 * BRAKE * control.acceleration * distance)
        wanted = min(self._speed, braking, control.near_gain * distance)
        self._last = min(wanted, self._last + control.acceleration / control.rate_hz)
        return self._last

    def velocity(self, place: Array, goal: Array) -> Array:
        """Straight to the goal, mm/s."""
        way = goal - place
        distance = float(np.hypot.reduce(way))
        return way * (self.speed_for(distance) / distance) if distance > 0.0 else np.zeros_like(way)


def seconds_for(control: Control, length: float, speed: float) -> float:
    """More than a servo takes for a way: a move that takes longer is stuck."""
    return 2.0 + 1.5 * (length / speed + speed / control.acceleration + 5.0 / control.near_gain)
