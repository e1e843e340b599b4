"""The guarded move: along a line, slowly, until something touches (A.2)."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.servo import PositionServo
from palpate.rig.specification import Control

Array: TypeAlias = NDArray[np.float64]


class Line:
    """From a start along a unit direction."""

    def __init__(self, start: Array, end: Array) -> None:
        way = end - start
        self.start, self.end = start, end
        self.length = float(np.hypot.reduce(way))
        self.direction = way / self.length

    def depth(self, place: Array) -> float:
        """How far along."""
        return float((place - self.start) @ self.direction)

    def aside(self, place: Array) -> Array:
        """How far off the line, and to where, shape `(d,)`."""
        return np.asarray(place - self.start - self.depth(place) * self.direction)

    def at(self, depth: float) -> Array:
        """The place so far along."""
        return np.asarray(self.start + depth * self.direction)


class GuardedMove:
    """A position servo along the line, that keeps to it."""

    def __init__(self, control: Control, line: Line) -> None:
        """From rest at the start of the line."""
        self._control = control
        self._line = line
        self._servo = PositionServo(control, control.guard_speed)

    def velocity(self, base: Array) -> Array:
        """Forward, and back to the line."""
        ahead = self._line.length - self._line.depth(base)
        forward = np.sign(ahead) * self._servo.speed_for(abs(ahead)) * self._line.direction
        return np.asarray(forward - self._control.lateral_gain * self._line.aside(base))

    def off_line(self, base: Array) -> bool:
        """Whether it has left the line by more than it may."""
        return float(np.hypot.reduce(self._line.aside(base))) > self._control.off_line
