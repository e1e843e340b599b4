"""The outer loop: which compensator has the axes, and when it hands them on (A.2, figure A.7).

Every loop in here ends: by what it waits for, or by its time, which makes it a fault.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.admittance import Admittance
from palpate.rig.bounds import Bounds
from palpate.rig.guarded import GuardedMove, Line
from palpate.rig.machine import Machine, RigFault, Sensed
from palpate.rig.recording import State
from palpate.rig.servo import THERE, PositionServo, seconds_for
from palpate.rig.specification import Control

Array: TypeAlias = NDArray[np.float64]

LOST = 0.3
"""s without force: the tip has slipped off what it touched."""
HEAVY = 1.0
"""s with more force than a reading may have: more than creep is reckoned with (B4)."""
STEEPER = math.radians(3)
"""The sensed direction of a single tick is no better."""


@dataclass(frozen=True)
class Met:
    """A guarded move that touched."""

    free: float
    """Depth up to which nothing was touched."""
    reached: float
    """Depth at which the tip stood: the touch was between the two."""
    line: Line
    """The line of the move, shifted to where the tip was just before it touched."""
    most_force: float
    """N, until the tip stood."""


@dataclass(frozen=True)
class Reading:
    """A contact that was read."""

    center: Array
    """Of the tip, shape `(d,)`, mm."""
    normal: Array
    """Unit, out of the part."""
    corner: bool
    """Whether the force turned against the motion: two places may touch, and the normal is none."""
    force: float
    """N."""


class OuterLoop:
    """Moves of the tip, one at a time."""

    def __init__(self, machine: Machine, bounds: Bounds) -> None:
        """A tip at rest, clear of everything; `bounds` are those of its readings."""
        self.machine = machine
        self._bounds = bounds
        steepest = bounds.max_incidence + 2.0 * bounds.normal_error
        self._least_cosine = math.cos(min(math.pi / 2, steepest + STEEPER))
        self._control: Control = machine.spec.control
        self._stiffness = machine.spec.beam.stiffness

    def zero(self) -> Sensed | None:
        """Take the zero at rest; None if the tip is not clear: moved a little it would feel the same (B8).

        Raises:
            RigFault: Moving took too long.
        """
        machine, control, bounds = self.machine, self._control, self._bounds
        machine.rest(control.quiet, "rest")
        read = machine.averaged(machine.rest(control.reading, "zero"))
        for side in _sides(machine.plant.dimension):
            self.go(read.base + control.clear * side, speed=control.most_pressing, state="zero")
            machine.rest(control.quiet, "zero")
            felt = machine.averaged(machine.rest(control.quiet, "zero"))
            changed = machine.newtons_per_count @ (felt.counts - read.counts)
            most = bounds.still + bounds.creeping * (felt.time - read.time)
            if float(np.hypot.reduce(changed)) > most:
                return None
            if felt.time - read.time > control.clear_within:
                raise RigFault("it took too long to see that the tip is clear")
        self.go(read.base, speed=control.most_pressing, state="zero")
        machine.zero.reset(read.counts)
        return read

    def go(self, goal: Array, *, speed: float, state: State) -> Sensed | None:
        """Freely to a place; what was sensed where it touched, or None.

        Raises:
            RigFault: It did not get there in time.
        """
        machine = self.machine
        servo = PositionServo(self._control, speed)
        base = machine.plant.encoders
        length = float(np.hypot.reduce(goal - base))
        for _ in range(machine.ticks(seconds_for(self._control, length, speed))):
            if float(np.hypot.reduce(goal - base)) <= THERE:
                machine.rest(machine.tick_seconds, state)
                return None
            sensed = machine.tick(servo.velocity(base, goal), state)
            base = sensed.base
            if state == "free":
                machine.zero.follow(sensed.counts)
                if sensed.magnitude > self._control.guard_force:
                    machine.rest(self._control.quiet, state)
                    return sensed
        raise RigFault(f"a move of {length:.1f} mm did not end in time")

    def guarded(self, line: Line) -> Met | None:
        """Along the line until something touches; None if nothing did.

        Raises:
            RigFault: It left its line, or did not get to its end in time.
        """
        machine, control = self.machine, self._control
        move = GuardedMove(control, line)
        base = machine.plant.encoders
        for _ in range(machine.ticks(seconds_for(control, line.length, control.guard_speed))):
            if abs(line.length - line.depth(base)) <= THERE:
                machine.rest(machine.tick_seconds, "guarded")
                return None
            if move.off_line(base):
                raise RigFault(f"a guarded move left its line by more than {control.off_line:g} mm")
            sensed = machine.tick(move.velocity(base), "guarded")
            if sensed.magnitude > control.guard_force:
                stopped = machine.rest(machine.tick_seconds, "guarded")
                shifted = Line(line.start + line.aside(base), line.end + line.aside(base))
                most = max(one.magnitude for one in [sensed, *stopped])
                return Met(max(0.0, line.depth(base)), line.depth(stopped[-1].base), shifted, most)
            base = sensed.base
        raise RigFault(f"a guarded move of {line.length:.1f} mm did not end in time")

    def read(self, met: Met) -> Reading | None:
        """Press, rock, press again and read; then back off and take the zero.

        None: the tip slipped off or past what it touched, or touches too steeply.

        Raises:
            RigFault: The contact does not settle, or the tip does not come clear.
        """
        machine, control = self.machine, self._control
        until = machine.time + control.settle
        press = Admittance(control, met.line, self._stiffness)
        firm = self._press(press, until)
        if firm is None:
            self._back_off(met, met.free)
            return None
        tangents = _tangents(firm.force)
        rocked = [
            (side * tangent, self._rocked(firm, side * tangent, until))
            for tangent in tangents
            for side in (1.0, -1.0)
        ]
        read = self._read_at_rest(press, until)
        if read is None:
            self._back_off(met, met.free)
            return None
        zero = self._back_off(met, met.line.depth(read.base + read.force / self._stiffness))
        if zero.time - read.time > control.zero_within:
            raise RigFault("the zero came too late after the reading")
        if read.time - rocked[0][1].time > control.rock_within * len(tangents):
            raise RigFault("the reading came too late after the tip was rocked")
        force = machine.force_of(read.counts)
        if abs(float(np.hypot.reduce(force)) - control.force) > 2.0 * control.force_band:
            raise RigFault("the contact was not held at its force")
        normal = force / np.hypot.reduce(force)
        center = read.base + force / self._stiffness
        depth = met.line.depth(center)
        if not met.free - self._bounds.position_error <= depth <= met.reached + self._bounds.position_error:
            return None
        corner = any(self._against(normal, machine.force_of(one.counts), motion) for motion, one in rocked)
        return Reading(center, normal, corner, float(np.hypot.reduce(force)))

    def _against(self, normal: Array, force: Array, motion: Array) -> bool:
        """Whether the force turned against a motion by more than it may seem to."""
        turn = force / np.hypot.reduce(force) - normal
        return float(turn @ motion) < -np.sin(np.radians(self._control.rock_turn_deg))

    def _press(self, press: Admittance, until: float) -> Sensed | None:
        """Until the contact is firm for a while; None: the tip slipped off, or touches too steeply."""
        machine, control = self.machine, self._control
        sensed = machine.rest(machine.tick_seconds, "contact")[-1]
        held = lost = steep = heavy = 0
        while machine.time < until:
            sensed = machine.tick(press.velocity(sensed.base, sensed.force), "contact")
            held = held + 1 if press.firm(sensed.base, sensed.force) else 0
            lost = lost + 1 if sensed.magnitude < control.guard_force else 0
            steep = steep + 1 if press.cosine(sensed.force) < self._least_cosine else 0
            heavy = heavy + 1 if sensed.magnitude > control.force + 2.0 * control.force_band else 0
            if held >= machine.ticks(control.quiet):
                return sensed
            if heavy >= machine.ticks(HEAVY):
                raise RigFault("the contact was not held at its force")
            if max(lost, steep) >= machine.ticks(LOST):
                return None
        raise RigFault("the contact did not settle")

    def _rocked(self, firm: Sensed, motion: Array, until: float) -> Sensed:
        """The tip rolled aside, and read there."""
        machine, control = self.machine, self._control
        self.go(firm.base + control.rock * motion, speed=control.most_pressing, state="rock")
        machine.rest(control.quiet, "rock")
        if machine.time >= until:
            raise RigFault("the contact did not settle")
        return machine.averaged(machine.rest(control.reading, "rock"))

    def _read_at_rest(self, press: Admittance, until: float) -> Sensed | None:
        """A reading during which nothing moves; None: the tip slipped off."""
        machine, control = self.machine, self._control
        while machine.time < until:
            if self._press(press, until) is None:
                return None
            machine.rest(control.quiet, "reading")
            ticks = machine.rest(control.reading, "reading")
            read = machine.averaged(ticks)
            if machine.at_rest(ticks) and press.firm(read.base, read.force):
                return read
        raise RigFault("the contact did not settle")

    def _back_off(self, met: Met, depth: float) -> Sensed:
        """Back along the line, clear of what was touched; the zero there.

        Raises:
            RigFault: It still touches.
        """
        control = self._control
        self.go(met.line.at(max(0.0, depth - control.back_off)), speed=control.back_speed, state="back off")
        read = self.zero()
        if read is None:
            raise RigFault("the tip still touches after it backed off")
        return read


def _sides(dimension: int) -> Array:
    """Corners of a triangle or a tetrahedron: one of them goes 1/d along any direction, at least."""
    if dimension == 2:
        turns = 2.0 * math.pi / 3.0 * np.arange(3)
        return np.column_stack([np.cos(turns), np.sin(turns)])
    return np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]) / math.sqrt(
        3.0
    )


def _tangents(force: Array) -> list[Array]:
    """Unit directions square to a force and to each other: one in the plane, two in space."""
    normal = force / np.hypot.reduce(force)
    if len(normal) == 2:
        return [np.array([-normal[1], normal[0]])]
    least = np.eye(3)[np.argmin(np.abs(normal))]
    first = np.cross(normal, least)
    first /= np.linalg.norm(first)
    return [first, np.cross(normal, first)]
