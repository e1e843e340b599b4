"""What happens in the demonstration, in sentences for someone who sees it for the first time."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from palpate import AlreadyTouching, Fault, Hit, Hypothesis, Miss, Path, Skid, Step, UnexpectedTouch
from palpate.cli.documents import excursion_bound, planar
from palpate.demo import SENSOR, TABLE, UNIT, Demonstration, deviation
from palpate.plots.style import at_most

WHAT = {"scan": "A sweep", "path": "A planned path", "verify": "One more touch"}


@dataclass(frozen=True)
class Told:
    """One guarded move in sentences; plain text."""

    what: str
    why: str
    met: str
    left: str
    """Empty if it is not known yet."""


class Teller:
    """Tells guarded moves in their order; each depends on what was known before it."""

    def __init__(self) -> None:
        """Before the first one."""
        self._known: list[Hypothesis] = []
        self._touched = self._moves = 0

    def tell(self, step: Step) -> Told:
        """The next one."""
        told = Told(WHAT[step.purpose], self._why(step), self._met(step), self._left(step.hypotheses))
        self._moves += 1
        self._touched += isinstance(step.reply, Hit)
        self._known = step.hypotheses or self._known
        return told

    def _why(self, step: Step) -> str:
        if step.purpose == "path" and step.path is not None:
            return _promise(step.path, len(self._known))
        if step.purpose == "verify" and self._known:
            name, shift = self._known[0].model.name, at_most(excursion_bound(self._known[0]))
            return (
                f"It is the {name}, but a corner may still be {shift} {UNIT} off: "
                "the tip touches where it was not yet."
            )
        if self._moves == 0:
            return "Nothing is known yet: the tip sweeps across the middle of the table."
        if self._touched == 0:
            return "Still nothing is known: it sweeps elsewhere."
        if self._touched == 1:
            return "One touch fits almost anything; a side that faces elsewhere is needed: it sweeps again."
        return "That is too little to go by: it sweeps again."

    def _met(self, step: Step) -> str:
        match step.reply:
            case Hit(contact):
                faces = (
                    "" if contact.normal is None else f"; the surface there faces {_angle(contact.normal)}"
                )
                return f"It touches at {_place(contact.center)}{faces}."
            case Miss():
                return "It meets nothing: all of this way is free, and that tells something too."
            case Skid():
                return "It slides off a slanted side: no reading to rely on, but the way there was free."
            case AlreadyTouching():
                return "It touches already where it was to begin."
            case UnexpectedTouch(where):
                return f"It touches at {_place(where)}, where the way should have been free."
            case Fault(reason):
                return f"The probe can't go on: {reason}."

    def _left(self, hypotheses: Sequence[Hypothesis] | None) -> str:
        if hypotheses is None:
            return ""
        if not hypotheses:
            return "No part at any pose fits."
        if len(hypotheses) == 1 == len(self._known):
            return f"Now it is {bounds_words(hypotheses[0])}."
        if len(hypotheses) == 1:
            return f"One answer is left: the {hypotheses[0].model.name}, {bounds_words(hypotheses[0])}."
        counts = Counter(one.model.name for one in hypotheses)
        listed = ", ".join(name if count == 1 else f"{count} × {name}" for name, count in counts.items())
        return f"{len(hypotheses)} answers fit: {listed}."


def task_words(num_parts: int) -> list[str]:
    """What is to be done."""
    return [
        f"{num_parts} parts are known. One of them lies hidden on a table of "
        f"{TABLE:g} × {TABLE:g} {UNIT}, turned by any angle.",
        f"A simulated probe may touch it: its points are true to {SENSOR.position_error:g} {UNIT}, "
        f"the directions it feels to {math.degrees(SENSOR.normal_error or 0.0):.3g}°. "
        "Which part is it, and where?",
    ]


def answer_words(shown: Demonstration) -> list[str]:
    """What was found, and how sure that is."""
    result = shown.result
    moves = f"{result.touches} guarded moves, {len(result.contacts)} contacts"
    if len(result.hypotheses) != 1:
        status = result.status.replace("_", " ")
        return [f"{len(result.hypotheses)} answers are left after {moves}: {status}, {result.reason}."]
    found = result.hypotheses[0]
    return [
        f"It is the {found.model.name}, at {pose_words(found.world_from_model)}, after {moves}.",
        "Proved, if the probe's errors are within their bounds: no other part fits, and this one is "
        f"{bounds_words(found)}.",
    ]


def truth_words(shown: Demonstration) -> str:
    """What the simulation knows."""
    if shown.truth_number is None:
        return "The true part and pose are in none of the answers: this is a fault, please report it."
    found = shown.result.hypotheses[shown.truth_number - 1]
    way, turn = deviation(found, shown.world_from_truth)
    lay = f"Hidden was the {shown.truth.name}, at {pose_words(shown.world_from_truth)}"
    return f"{lay}: the answer is {way:.2f} {UNIT} and {math.degrees(turn):.2f}° off."


def pose_words(pose: Any) -> str:
    """Where a part lies."""
    x, y, angle_deg = planar(pose)
    return f"x {x:.1f}, y {y:.1f} {UNIT}, turned by {angle_deg:.1f}°"


def bounds_words(hypothesis: Hypothesis) -> str:
    """How far its pose may be from the true one."""
    turn = at_most(math.degrees(hypothesis.poses.rotation_bound))
    return f"known to {at_most(excursion_bound(hypothesis))} {UNIT} at its corners and to {turn}° of turn"


def _promise(path: Path, count: int) -> str:
    worst = max(map(len, path.classes), default=count)
    if path.guaranteed and worst < count:
        left = "one answer is left" if worst == 1 else f"no more than {worst} are left"
        return f"A path is planned that tells them apart: whatever the tip meets on it, {left}."
    if path.guaranteed:
        return f"A path is planned that leaves no more than {path.score:.1f} of them in the mean."
    return f"No path is sure to tell them apart; this one is expected to leave {path.expected_score:.1f}."


def _place(point: Any) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f})"


def _angle(direction: Any) -> str:
    return f"{math.degrees(math.atan2(direction[1], direction[0])):.0f}°"
