"""Logs as they are read: whole lines, each an event of the schema, in an order that a run can have."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from palpate.loop.entries import SCHEMA, VERSION, Event, reply_in, settings_in
from palpate.loop.settings import Settings
from palpate.loop.shape import problem_of

FIRST = f'{{"event":"start","schema":"{SCHEMA}","version":{VERSION},'.encode()
POINTS = ("start", "end", "center", "normal", "approach", "where", "direction")
LATER = b'{"event":"'


def read_log(path: Path) -> list[Event]:
    """The whole events in a log.

    Raises:
        ValueError: Another file than a log, or a log that was changed; the line is named.
    """
    if not path.is_file():
        raise ValueError(f"log: there is no file {str(path)!r}; name the log of a run")
    text = path.read_bytes()
    events: list[Event] = []
    for number, line in enumerate(text[: whole(text)].split(b"\n")[:-1], start=1):
        event = _event(line)
        if event is None:
            _refuse(path, number, "is no event of a run; name the log of a run")
        _check(path, number, event, before=events)
        events.append(event)
    return events


def settings_of_log(path: Path, events: list[Event]) -> Settings:
    """What the run of a log was to do.

    Raises:
        ValueError: No event at all, or settings that no run can have.
    """
    if not events:
        raise ValueError(f"log: {str(path)!r} is empty; name the log of a run")
    try:
        return settings_in(events[0])
    except ValueError as error:
        _refuse(path, 1, f"can't be understood: {error}")


def whole(text: bytes) -> int:
    """Up to the end of the last whole line."""
    return text.rfind(b"\n") + 1


def check_rest(path: Path, text: bytes) -> None:
    """Refuse to drop what follows the last whole line, if a run can't have begun to write it.

    Raises:
        ValueError: It is no beginning of an event.
    """
    end = whole(text)
    rest, begins = text[end:], LATER if end else FIRST
    if not (rest.startswith(begins) or begins.startswith(rest)):
        _refuse(path, text.count(b"\n") + 1, "is no beginning of an event of a run; name the log of a run")


def _event(line: bytes) -> Event | None:
    """None: this is none."""
    try:
        event: Any = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return event if isinstance(event, dict) and isinstance(event.get("event"), str) else None


def _check(path: Path, number: int, event: Event, *, before: list[Event]) -> None:
    """That an event is of the schema, and may follow those before it."""
    if not before and (event.get("schema"), event.get("version")) != (SCHEMA, VERSION):
        raise ValueError(
            f"log: {str(path)!r} is no {SCHEMA} of version {VERSION}; name the log of a run, of this version"
        )
    problem = problem_of(event)
    if problem is not None:
        _refuse(path, number, f"is no event of a run: {problem}")
    if (event["event"] == "start") != (not before):
        _refuse(path, number, "is out of place: a log has one start, its first line")
    if before and before[-1]["event"] == "end":
        _refuse(path, number, "comes after the end of the run; remove it")
    if before:
        wanted = len(before[0]["workspace"][0])
        for found in _coordinates(event):
            if found != wanted:
                _refuse(path, number, f"has a point of {found} coordinates in a run of {wanted}")
    if event["event"] == "reply":
        try:
            reply_in(event)
        except ValueError as error:
            _refuse(path, number, f"is no reply: {error}")


def _coordinates(value: Any) -> Iterator[int]:
    """How many each point in an event has, by the names that points have."""
    for name, member in value.items() if isinstance(value, dict) else ():
        if name in POINTS and member is not None:
            yield len(member)
        elif name == "points":
            yield from map(len, member)
        else:
            yield from _coordinates(member)


def _refuse(path: Path, number: int, problem: str) -> NoReturn:
    raise ValueError(f"log: {str(path)!r}, line {number} {problem}")
