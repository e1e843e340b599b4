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


@dataclass(frozen=True, eq=False)
class Row:
    """A tick. Lengths in mm, forces in N, times in s; places and directions of shape `(d,)`."""

    time: float
    """At the end of the tick."""
    state: State
    base: Array
    """Where encoders have the tip, if it were not bent."""
    force: Array
    """As sensed, on the tip."""
    velocity: Array
    """As commanded, mm/s."""
    tip: Array
    """Where the tip's centre truly is."""
    normal: Array
    """True one of the place that bears most; NaN where nothing touches."""


class Recording:
    """Grows by a row at every tick."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.segments: list[Segment] = []

    def __len__(self) -> int:
        return len(self.rows)

    def column(self, name: Literal["time", "base", "force", "velocity", "tip", "normal"]) -> Array:
        """A field of all rows, shape `(n,)` or `(n, d)`."""
        return np.array([getattr(row, name) for row in self.rows])

    @property
    def states(self) -> NDArray[np.int64]:
        """Numbers in `STATES`, shape `(n,)`."""
        return np.array([STATES.index(row.state) for row in self.rows], dtype=np.int64)
