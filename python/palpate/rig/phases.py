"""The phases of table 4.4, of a run through the rig, in simulated seconds."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.loop.result import Result
from palpate.rig.recording import Recording


@dataclass(frozen=True)
class Phases:
    """Where the rig's time went; free moves count for the guarded move that they lead to."""

    initial_data: float
    """Until the initial data were had, s."""
    execution: float
    """From there on, s."""


def phases_of(result: Result, recording: Recording) -> Phases:
    """Of a run that the rig of this recording made; of a resumed run, what was made since."""
    ends = [segment.end for segment in recording.segments if segment.kind == "touch"]
    spent = [end - begin for begin, end in zip([0.0, *ends], ends, strict=False)]
    steps = result.steps[len(result.steps) - len(spent) :]
    scanned = sum(seconds for step, seconds in zip(steps, spent, strict=True) if step.purpose == "scan")
    return Phases(scanned, sum(spent) - scanned)
