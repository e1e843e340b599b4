"""The computer of the rig at its tick: it reads gauges and encoders, and commands velocities (A.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.rig.bounds import quiet_counts
from palpate.rig.calibration import Zero, calibrated
from palpate.rig.gauges import Gauges, count_force
from palpate.rig.plant import Plant
from palpate.rig.recording import Recording, Row, State
from palpate.rig.specification import RigSpec

Array: TypeAlias = NDArray[np.float64]


class RigFault(Exception):
    """The rig can't go on; the text says why."""


@dataclass(frozen=True)
class Sensed:
    """What the computer knows after a tick, or averaged over several."""

    counts: Array
    """Of the gauges, shape `(d,)`."""
    base: Array
    """Where the encoders have the tip, if it were not bent, shape `(d,)`, mm."""
    force: Array
    """On the tip by the zero of the moment, shape `(d,)`, N."""
    time: float
    """Middle of the ticks, s."""

    @property
    def magnitude(self) -> float:
        """Of the force, N."""
        return float(np.hypot.reduce(self.force))


class Machine:
    """One tick after another; every tick is recorded, and watched for what must not happen."""

    def __init__(self, plant: Plant, gauges: Gauges, spec: RigSpec, *, random: np.random.Generator) -> None:
        """Calibrate the gauges in the jig, whose errors are `random`, then mount them; nothing moves yet."""
        self.plant = plant
        self.spec = spec
        self.tick_seconds = 1.0 / spec.control.rate_hz
        self.time = 0.0
        self.recording = Recording()
        self._gauges = gauges
        self.newtons_per_count, first = calibrated(gauges, spec, random=random)
        self._quiet_counts = quiet_counts(spec)
        near = spec.control.guard_force / 2.0 / count_force(spec.electronics)
        self.zero = Zero(first, rate_hz=spec.control.rate_hz, near=near)

    def tick(self, velocity: Array, state: State) -> Sensed:
        """Command a velocity, mm/s, for a tick.

        Raises:
            RigFault: The stem touches, or the beam bears more than it is made for.
        """
        forces = self.plant.tick(velocity)
        counts = self._gauges.read(forces, self.tick_seconds)
        self.time += self.tick_seconds
        sensed = Sensed(counts, self.plant.encoders, self.force_of(counts), self.time)
        plant = self.plant
        self.recording.rows.append(
            Row(self.time, state, sensed.base, sensed.force, velocity, plant.tip, plant.normal)
        )
        if self.plant.stem_touches:
            raise RigFault("the stem touched the part before the tip did")
        most = self.spec.beam.most_force
        if not sensed.magnitude < most:
            raise RigFault(f"the beam bore {sensed.magnitude:.1f} N, and is made for {most:g} N")
        return sensed

    def force_of(self, counts: Array) -> Array:
        """On the tip, N, by the zero of the moment."""
        return np.asarray(self.newtons_per_count @ (counts - self.zero.value))

    def ticks(self, seconds: float) -> int:
        """How many ticks last so long."""
        return max(1, round(seconds * self.spec.control.rate_hz))

    def rest(self, seconds: float, state: State) -> list[Sensed]:
        """Hold still; every tick of it."""
        still = np.zeros(self.plant.dimension)
        return [self.tick(still, state) for _ in range(self.ticks(seconds))]

    def averaged(self, ticks: list[Sensed]) -> Sensed:
        """Ticks of a rest as one reading."""
        counts = np.mean([one.counts for one in ticks], axis=0)
        base = np.mean([one.base for one in ticks], axis=0)
        middle = 0.5 * (ticks[0].time - self.tick_seconds + ticks[-1].time)
        return Sensed(counts, base, self.force_of(counts), middle)

    def at_rest(self, ticks: list[Sensed]) -> bool:
        """Whether ticks of a rest differ by no more than noise, and a little."""
        counts = np.array([one.counts for one in ticks])
        return bool((np.ptp(counts, axis=0) <= self._quiet_counts).all())
