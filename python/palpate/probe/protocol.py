"""What the loop asks of a probe, and what a probe may answer.

Points have the d coordinates of the models: shape `(2,)` in the plane, where the tip is a disc, and `(3,)` in
space, where it is a ball.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Contact, Miss


@dataclass(frozen=True)
class Hit:
    """The tip rests on the part, and the reading is reliable."""

    contact: Contact
    """With the bounds of this reading, tip radius, approach, and start: the way from there was free.

    Without a start, if the tip may have left its line by more than the position error.
    """


@dataclass(frozen=True)
class Skid:
    """The part was touched, but no reading can be trusted; evidence of the free part of its path only.

    It was touched at more than the largest reliable incidence, or where a model says that it can't be.
    """

    free: Miss
    """From the start, ending `position_error` short of the sensed place."""


@dataclass(frozen=True)
class AlreadyTouching:
    """The tip was not clear of the part where the guarded move was to begin; it was not made."""


@dataclass(frozen=True, eq=False)
class UnexpectedTouch:
    """A free move touched something and stopped. No evidence: no bounds hold for free moves."""

    where: NDArray[np.float64]
    """Centre of the tip, shape `(d,)`."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, UnexpectedTouch) and np.array_equal(self.where, other.where)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True)
class Fault:
    """The equipment can't go on."""

    reason: str


Reply: TypeAlias = Hit | Miss | Skid | AlreadyTouching | UnexpectedTouch | Fault


@runtime_checkable
class Probe(Protocol):
    """A probe that makes guarded moves. Implement it to put real equipment into the loop."""

    @property
    def position(self) -> NDArray[np.float64] | None:
        """Where the centre of the tip is, shape `(d,)`; None if that is not known before the first move."""
        ...

    def touch(self, start: ArrayLike, end: ArrayLike) -> Reply:
        """Make one straight guarded move, and stop at the first touch.

        The tip is at `start`, or, before the first move, wherever it may go there from straight. After a
        `Hit` or a `Skid` it stays where it stopped; after a miss it is at `end`.

        Args:
            start: Where the centre of the tip begins, shape `(d,)`.
            end: Where it ends if it touches nothing, shape `(d,)`.

        Returns:
            `Hit`: it touched, and the contact holds within its bounds. `palpate.Miss`: it touched nothing
            all the way, off its line by no more than the miss says. `Skid`: it touched where no reading is
            reliable. `AlreadyTouching`: it was not clear at `start`. `UnexpectedTouch`: it touched on the
            way to `start`. `Fault`: it can't go on.
        """
        ...

    def move(self, points: ArrayLike) -> UnexpectedTouch | Fault | None:
        """Move freely, straight from where the tip is to the first point, then from each to the next.

        The first point after a touch is the start of its guarded move: the tip goes back the way it came.

        Args:
            points: Places of the tip's centre, shape `(n, d)`.

        Returns:
            None: it is at the last point and touched nothing. `UnexpectedTouch`: it touched, and stopped
                there. `Fault`: it can't go on.
        """
        ...
