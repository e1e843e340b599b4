"""A run once more, from its log alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from palpate.loop.entries import settings_in
from palpate.loop.journal import Journal, read_log
from palpate.loop.result import Result, Step
from palpate.loop.run import Run
from palpate.probe.simulated import point_of


def replay(log: str | Path, *, told: Callable[[Step], None] | None = None) -> Result:
    """The result that the run of a log had, without a probe; `"interrupted"` if the log has no end.

    Args:
        log: The file.
        told: As for `identify`.

    Raises:
        ValueError: No file, no log, or one of another version.
    """
    events = read_log(Path(log))
    if not events:
        raise ValueError(f"log: {str(log)!r} is empty; name the log of a run")
    settings = settings_in(events[0])
    position = events[0]["position"]
    at = None if position is None else point_of("position", position)
    return Run(settings, None, Journal(events[1:], ends=True), position=at, told=told).result()
