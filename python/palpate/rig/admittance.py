"""Admittance control: a firm contact, where it was touched first (A.2, figure A.9).

Two parts are added. Along the sensed normal a velocity in proportion to the error of the force, whose gain
is scheduled by that error: low where the force falls short, so that the tip goes on gently; higher where it
is nearly right; highest, and away from the part, where it is too high. Along the surface a nominal velocity
that takes the tip back to the line on which it came, from which the last of its way has pushed it aside.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.guarded import Line
from palpate.rig.specification import Control

Array: TypeAlias = NDArray[np.float64]

LEAST_COSINE = 0.2
"""Of the incidence, beyond which the way back along the surface would be far: it is cut."""


class Admittance:
    """Presses a tip of known stiffness against what it touched."""

    def __init__(self, control: Control, line: Line, stiffness: float) -> None:
        """`line` is the one on which the tip came, shifted to where it was; `stiffness` in N/mm."""
        self._control = control
        self._line = line
        self._stiffness = stiffness
        self._normal = -line.direction

    def velocity(self, base: Array, force: Array) -> Array:
        """Of the axes, mm/s."""
        control = self._control
        magnitude = float(np.hypot.reduce(force))
        if magnitude > control.guard_force:
            self._normal = force / magnitude
        lacking = control.force - magnitude
        if lacking > control.force_band:
            gain = control.light_gain
        elif lacking < -control.force_band:
            gain = control.back_gain
        else:
            gain = control.firm_gain
        velocity = -gain * lacking * self._normal
        if magnitude > control.guard_force:
            velocity = velocity + control.near_gain * self.way_back(base, force)
        speed = float(np.hypot.reduce(velocity))
        return velocity * min(1.0, control.most_pressing / speed) if speed > 0.0 else velocity

    def way_back(self, base: Array, force: Array) -> Array:
        """Along the surface to the line, shape `(d,)`, mm."""
        tip = base + force / self._stiffness
        cosine = max(LEAST_COSINE, -float(self._line.direction @ self._normal))
        ahead = float((tip - self._line.start) @ self._normal) / -cosine
        met = self._line.at(ahead)
        way = met - tip
        return np.asarray(way - (way @ self._normal) * self._normal)

    def cosine(self, force: Array) -> float:
        """Of the incidence, by the force of the moment; 1 where there is too little of it."""
        magnitude = float(np.hypot.reduce(force))
        if magnitude <= self._control.guard_force:
            return 1.0
        return -float(self._line.direction @ force) / magnitude

    def firm(self, base: Array, force: Array) -> bool:
        """Whether the force is right and the tip on its line."""
        control = self._control
        right = abs(float(np.hypot.reduce(force)) - control.force) <= control.force_band
        tip = base + force / self._stiffness
        return right and float(np.hypot.reduce(self._line.aside(tip))) <= control.on_line
