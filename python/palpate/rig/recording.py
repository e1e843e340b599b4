"""What happened in the rig: force, position and state at every tick, and which moves were made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
State: TypeAlias = Literal["rest", "free", "guarded", "contact", "rock", "reading", "back off", "zero"]

STATES: tuple[State, ...] = ("rest", "free", "guarded", "contact", "rock", "reading", "back off", "zero")


@dataclass(frozen=True, eq=False)
class Segment:
    """A free or a guarded move, from its first tick to its last."""

    kind: Literal["move", "touch"]
    begin: float
    """Simulated seconds; the same for `end`."""
    end: float
    reply: str
    """Name of the class of the reply; `None` of a free move that touched nothing."""


class Recording:
    """Grows by a row at every tick. Lengths in mm, forces in N, times in s."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, int, Array, Array, Array, Array]] = []
        self.segments: list[Segment] = []

    def add(  # noqa: PLR0917 - a row, in the order of the properties
        self, time: float, state: State, base: Array, tip: Array, force: Array, velocity: Array
    ) -> None:
        """A tick."""
        self._rows.append((time, STATES.index(state), base, tip, force, velocity))

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def times(self) -> Array:
        """At the end of each tick, shape `(n,)`."""
        return np.array([row[0] for row in self._rows])

    @property
    def states(self) -> NDArray[np.int64]:
        """Numbers in `STATES`, shape `(n,)`."""
        return np.array([row[1] for row in self._rows], dtype=np.int64)

    @property
    def bases(self) -> Array:
        """Where encoders have the tip, if it were not bent, shape `(n, d)`."""
        return np.array([row[2] for row in self._rows])

    @property
    def tips(self) -> Array:
        """Where the tip's centre truly was, shape `(n, d)`."""
        return np.array([row[3] for row in self._rows])

    @property
    def forces(self) -> Array:
        """As sensed, on the tip, shape `(n, d)`."""
        return np.array([row[4] for row in self._rows])

    @property
    def velocities(self) -> Array:
        """As commanded, shape `(n, d)`, mm/s."""
        return np.array([row[5] for row in self._rows])
