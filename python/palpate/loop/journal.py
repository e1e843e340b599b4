"""The log of a run: each event is on disk before the next begins, so that a killed run goes on from there."""

from __future__ import annotations

import json
import os
from collections import deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import IO

from palpate.loop.entries import Event
from palpate.loop.reading import check_rest, read_log, whole


class Interrupted(Exception):
    """The log ends here, and there is no probe to ask."""


class Journal:
    """Events of a run: those that are known already, then new ones.

    A run goes its whole way again, from its first event. So long as events are known, it must make the same
    ones, and the replies in the log stand for those of the probe, which is not asked. From there on, each is
    written and kept.
    """

    def __init__(
        self, known: Iterable[Event] = (), file: IO[bytes] | None = None, *, ends: bool = False
    ) -> None:
        """A journal that knows some events.

        Args:
            known: Events of before.
            file: Where new ones go; None: nowhere.
            ends: There is no probe: `Interrupted` is raised where the known events end.
        """
        self._known = deque(known)
        self._file = file
        self._ends = ends
        self._number = 0

    @property
    def live(self) -> bool:
        """Whether nothing more is known."""
        return not self._known

    def record(self, event: Event) -> None:
        """Something that the run did."""
        event = json.loads(json.dumps(event, allow_nan=False))
        if self.live:
            self._write(event)
            return
        known = self._known.popleft()
        self._number += 1
        if known != event:
            raise ValueError(
                f"log: line {self._number} says {_brief(known)}, the run now comes to {_brief(event)}; "
                "resume with the same arguments and version, or begin another log"
            )

    def peek(self, kind: str) -> Event | None:
        """The next known event, if it is of this kind; asked before work that its answer saves."""
        if self.live and self._ends:
            raise Interrupted
        return self._known[0] if self._known and self._known[0]["event"] == kind else None

    def answer(self, question: Callable[[], Event]) -> Event:
        """The known reply, or that of the probe, written at once."""
        if self._known:
            event = self._known.popleft()
            self._number += 1
            if event["event"] != "reply":
                raise ValueError(
                    f"log: line {self._number} says {_brief(event)} where a reply should be; it was changed"
                )
            return event
        if self._ends:
            raise Interrupted
        reply: Event = json.loads(json.dumps(question(), allow_nan=False))
        self._write(reply)
        return reply

    def _write(self, event: Event) -> None:
        if self._ends:
            raise Interrupted
        if self._file is not None:
            self._file.write(json.dumps(event, separators=(",", ":"), allow_nan=False).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())


def open_log(path: Path, *, resume: bool) -> tuple[list[Event], IO[bytes]]:
    """The events in a log, and the log to go on with. A last line that was cut short is cut off.

    Raises:
        ValueError: A log that is there already and not to be resumed, a file that is none: it stays as it is.
    """
    if path.is_dir():
        raise ValueError(f"log: {str(path)!r} is a folder; name a file")
    if not path.parent.is_dir():
        raise ValueError(f"log: there is no folder {str(path.parent)!r}; make it first")
    there = path.exists() and path.stat().st_size > 0
    if there and not resume:
        raise ValueError(f"log: {str(path)!r} is there already; resume it, name another file, or remove it")
    known = read_log(path) if there else []
    text = path.read_bytes() if there else b""
    check_rest(path, text)
    file = path.open("r+b" if there else "wb")
    file.truncate(whole(text))
    file.seek(0, os.SEEK_END)
    return known, file


def _brief(event: Event) -> str:
    text = json.dumps(event)
    return text if len(text) <= 100 else text[:99] + "…"
