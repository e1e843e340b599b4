"""A run once more, from its log alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from palpate.loop.journal import Journal
from palpate.loop.reading import read_log, settings_of_log
from palpate.loop.result import Result, Step
from palpate.loop.run import Run, check_told
from palpate.probe.simulated import point_of


def replay(log: str | Path, *, told: Callable[[Step], None] | None = None) -> Result:
    """The result that the run of a log had, without a probe; `"interrupted"` if the log has no end.

    Args:
        log: The file.
        told: As for `identify`.

    Raises:
        ValueError: No file, no log, one of another version, or one that was changed; the line is named.
    """
    check_told(told)
    events = read_log(Path(log))
    settings = settings_of_log(Path(log), events)
    position = events[0]["position"]
    at = None if position is None else point_of("position", position, settings.models[0].dimension)
    journal = Journal(events, ends=True)
    journal.record(events[0])
    return Run(settings, None, journal, position=at, told=told).result()
