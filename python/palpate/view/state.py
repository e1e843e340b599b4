"""What is known at a moment: immutable, so that any earlier moment can be shown, or gone back to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate._core import AmbiguityTree, Contact, Hypothesis, Miss, Model, Path
from palpate.loop.result import Purpose, stop_of
from palpate.probe import Hit, Reply

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Truth:
    """The part that answers simulated touches."""

    model: Model
    world_from_model: Array
    """Shape `(d + 1, d + 1)`."""
    drawn_from: int | None
    """The number of the hypothesis of whose poses it was drawn; None: it was given."""


@dataclass(frozen=True, eq=False)
class Move:
    """A guarded move that was made."""

    start: Array
    end: Array
    """Where it was to end, shape `(d,)`, world frame; `start` likewise."""
    reply: Reply
    purpose: Purpose = "path"

    @property
    def stopped(self) -> Array | None:
        """Where the tip stopped; None if it did not go."""
        return stop_of(self.reply, self.end)


@dataclass(frozen=True, eq=False)
class Left:
    """What explains the evidence."""

    hypotheses: list[Hypothesis]
    complete: bool = True
    stopped_by: str | None = None
    conflict: list[int] | None = None
    """Numbers of contacts that can't hold together, where nothing explains them."""
    num_refuted: int = 0
    """Hypotheses that would explain the contacts, but not what the moves met first."""


@dataclass(frozen=True, eq=False)
class Placement:
    """A part as it is drawn: at the pose of largest slack of a hypothesis, or laid out beside others."""

    model: Model
    model_number: int
    world_from_model: Array
    hypothesis: int | None
    """Its number; None: nothing is known of the pose, it is only laid out."""


@dataclass(frozen=True, eq=False)
class State:
    """All that is known at a moment, and what was done last."""

    said: str
    """What was done, in a line."""
    contacts: tuple[Contact, ...] = ()
    """Those that were given and those of moves, in order."""
    misses: tuple[Miss, ...] = ()
    """Those that were given."""
    moves: tuple[Move, ...] = ()
    left: Left | None = None
    """None: nothing was recognized yet."""
    stale: bool = False
    """Whether contacts came in since it was recognized."""
    path: Path | None = None
    """The next path; its numbers are those of `left.hypotheses`."""
    why: str | None = None
    """Why it is this path, or none, as `palpate.PlanReport.why`; None: nothing was planned."""
    proved: bool = False
    bound: float = 1.0
    """As of `palpate.PlanReport`; `proved` likewise."""
    tree: AmbiguityTree | None = None
    truth: Truth | None = None

    @property
    def hypotheses(self) -> list[Hypothesis]:
        """What explains the evidence, as far as that is known."""
        return [] if self.left is None else self.left.hypotheses

    @property
    def touched(self) -> int | None:
        """The number of the contact that the last move made; None: it made none."""
        last = self.moves[-1].reply if self.moves else None
        return len(self.contacts) - 1 if isinstance(last, Hit) and self.contacts else None
