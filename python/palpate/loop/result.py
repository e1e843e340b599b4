"""What the loop answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate._core import Contact, Hypothesis, Miss, Path, Recognition
from palpate.probe import Hit, Reply, Skid

Array: TypeAlias = NDArray[np.float64]
Purpose: TypeAlias = Literal["scan", "path", "verify"]
Status: TypeAlias = Literal[
    "solved",
    "inseparable",
    "no_usable_path",
    "budget",
    "unexplained",
    "nothing_found",
    "fault",
    "interrupted",
]


PURPOSES: dict[Purpose, str] = {"scan": "scan", "path": "path", "verify": "one more touch"}
"""In words."""


def hypotheses_words(count: int) -> str:
    """So many of them."""
    return f"{count} hypothes{'is' if count == 1 else 'es'}"


def stop_of(reply: Reply, end: Array) -> Array | None:
    """Where the tip stopped on a guarded move that was to go to `end`; None if it did not go."""
    if isinstance(reply, Hit):
        return reply.contact.center
    if isinstance(reply, Skid):
        return reply.free.end
    return end if isinstance(reply, Miss) else None


@dataclass(frozen=True, eq=False)
class Step:
    """One guarded move: why it was made, what it met, and what was left then."""

    purpose: Purpose
    """`"scan"`: to acquire contacts. `"path"`: to tell hypotheses apart. `"verify"`: to tighten one."""
    start: Array
    """Shape `(d,)`, world frame; the same for `end`."""
    end: Array
    """Where it was to end."""
    route: list[Array]
    """The free move before it: places that the tip went to, `start` last. Empty if the tip was there."""
    reply: Reply
    path: Path | None = None
    """The planned path; its numbers are those of `hypotheses` of the step before."""
    hypotheses: list[Hypothesis] | None = None
    """What explains all evidence up to here; None where that was not asked."""

    @property
    def stopped(self) -> Array | None:
        """Where the tip stopped; None if it did not go."""
        return stop_of(self.reply, self.end)


@dataclass(frozen=True, eq=False)
class Found:
    """What explains all contacts, misses and guarded moves: a recognition without what moves refute."""

    recognition: Recognition
    """Of contacts and misses alone, as `recognize` gives it."""
    refuted: Mapping[int, int] = field(default_factory=dict[int, int])
    """Numbers of its hypotheses that can't have answered a guarded move, with the number of that step."""

    @property
    def hypotheses(self) -> list[Hypothesis]:
        """Those that are left, in the order of the models."""
        return [one for k, one in enumerate(self.recognition.hypotheses) if k not in self.refuted]

    @property
    def conflict(self) -> list[int] | None:
        """As `Recognition.conflict`; None too if it is a guarded move that refutes the last hypothesis."""
        return self.recognition.conflict

    @property
    def complete(self) -> bool:
        """As `Recognition.complete`."""
        return self.recognition.complete

    @property
    def stopped_by(self) -> str | None:
        """As `Recognition.stopped_by`."""
        return self.recognition.stopped_by

    @property
    def interpretation_count(self) -> int:
        """Of the hypotheses that are left; at least, where `interpretation_count_exact` is false."""
        if not self.refuted:
            return self.recognition.interpretation_count
        return sum(one.interpretation_count for one in self.hypotheses)

    @property
    def interpretation_count_exact(self) -> bool:
        """Whether `interpretation_count` is all of them."""
        if not self.refuted:
            return self.recognition.interpretation_count_exact
        return self.complete and all(one.interpretation_count_exact for one in self.hypotheses)

    @property
    def counters(self) -> list[dict[str, int]]:
        """As `Recognition.counters`, but for `hypotheses`, which are those that are left."""
        counted = [dict(counters) for counters in self.recognition.counters]
        for number in self.refuted:
            counted[self.recognition.hypotheses[number].model_number]["hypotheses"] -= 1
        return counted


@dataclass(frozen=True, eq=False)
class Result:
    """What is left, and how it came to that (4.1)."""

    status: Status
    """How it ended.

    `"solved"`: one hypothesis is left. `"inseparable"`: no path tells those left apart. `"no_usable_path"`:
    none can be used. `"budget"`: `max_touches`, `effort` or `time_limit` cut it short, or touches for `until`
    made the poses no tighter. `"unexplained"`: no
    model explains all that was met; after a skid on a planned path `hypotheses` are those that it
    contradicts. `"nothing_found"`: no contact was made. `"fault"`: the probe can't go on. `"interrupted"`:
    the log has no end.
    """
    reason: str
    """The same in a sentence."""
    proved: bool
    """Of `"inseparable"` and `"no_usable_path"`: whether it is proved for all paths of margin m or more."""
    found: Found | None
    """What the last recognition left; None if there was no contact, whatever the status."""
    workspace: Array
    """Its corners of the least and the largest coordinates, shape `(2, d)`, world frame."""
    contacts: list[Contact] = field(default_factory=list[Contact])
    """Everything that was touched reliably, in order."""
    misses: list[Miss] = field(default_factory=list[Miss])
    """Everything that was swept freely; in the plane the border of the workspace first."""
    steps: list[Step] = field(default_factory=list[Step])
    """Every guarded move, in order."""
    until_met: bool | None = None
    """Whether the poses of the last hypothesis are as tight as `until` asks; None if it was not asked."""
    travel: float = 0.0
    """How far the tip went, free moves included."""
    recognition_time: float = 0.0
    """Seconds; the same for `planning_time`."""
    planning_time: float = 0.0

    @property
    def hypotheses(self) -> list[Hypothesis]:
        """What explains all contacts, misses and guarded moves."""
        return [] if self.found is None else self.found.hypotheses

    @property
    def conflict(self) -> list[int] | None:
        """Numbers of `contacts` that can't hold together, if nothing explains them."""
        return None if self.found is None else self.found.conflict

    @property
    def paths(self) -> list[Path]:
        """The paths that were planned and moved along."""
        return [step.path for step in self.steps if step.path is not None]

    @property
    def touches(self) -> int:
        """How many guarded moves were made, those that met nothing included."""
        return len(self.steps)
