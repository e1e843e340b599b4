"""Runs of the loop in words, as JSON and as pictures. Guarded moves are counted from 1."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console

from palpate import AlreadyTouching, Fault, Hit, Miss, Model, Result, Skid, Step, UnexpectedTouch
from palpate.cli.console import patiently
from palpate.cli.documents import recognition_document
from palpate.cli.report import decimal, print_recognition
from palpate.contacts import Evidence
from palpate.loop.entries import contact_entry, miss_entry, path_told, reply_event
from palpate.loop.result import PURPOSES, hypotheses_words
from palpate.rig.phases import Phases

STATUS = {
    "solved": "green",
    "inseparable": "yellow",
    "no_usable_path": "yellow",
    "budget": "yellow",
    "interrupted": "yellow",
    "unexplained": "red",
    "nothing_found": "red",
    "fault": "red",
}


class Story:
    """Tells each guarded move when it is understood."""

    def __init__(self, console: Console, *, size: float, heading: str | None = None) -> None:
        """Told on a console; `size` is that of the smallest part, for how many digits are worth printing.

        The heading comes before the first move: what is bad input is known by then.
        """
        self._console = console
        self._heading = heading
        self._size = size
        self._number = 0

    def begin(self) -> None:
        """The heading, once."""
        if self._heading is not None:
            self._console.print(self._heading, soft_wrap=True)
            self._heading = None

    def __call__(self, step: Step) -> None:
        """One line."""
        self.begin()
        self._number += 1
        met = _met(step, self._size)
        left = "" if step.hypotheses is None else f"; {hypotheses_words(len(step.hypotheses))} left"
        self._console.print(
            f"{self._number:3} {PURPOSES[step.purpose]} from {_place(step.start, self._size)}"
            f" {_way(step.end - step.start)}: {met}{left}",
            markup=False,
            soft_wrap=True,
        )


def print_result(
    console: Console,
    result: Result,
    labels: Sequence[str],
    *,
    notes: Sequence[str] = (),
    unit: str,
    size: float,
) -> None:
    """How it ended, and what is left."""
    color = STATUS[result.status]
    proved = " (proved)" if result.proved else ""
    console.print(
        f"[bold {color}]{result.status.replace('_', ' ')}[/]: {result.reason}{proved}.",
        soft_wrap=True,
    )
    console.print(
        f"{result.touches} guarded moves, {len(result.contacts)} contacts, the tip went "
        f"{decimal(result.travel, size)} {unit}."
    )
    if result.until_met is not None:
        console.print(f"The poses are {'' if result.until_met else 'not '}as tight as was asked.")
    if result.found is not None:
        if result.found.refuted:
            refuted = hypotheses_words(len(result.found.refuted))
            console.print(f"{refuted} more would explain the contacts, but not what the moves met first.")
        evidence = Evidence(result.contacts, result.misses)
        print_recognition(console, result.found, evidence=evidence, labels=labels, notes=notes, unit=unit)


def result_document(
    result: Result, models: Sequence[Model], *, unit: str, phases: Phases | None = None
) -> dict[str, Any]:
    """The `palpate-result` document; of a run through the rig with its `phases`."""
    found = None
    if result.found is not None:
        count = len(result.contacts)
        found = recognition_document(result.found, models, num_contacts=count, unit=unit)
    return {
        "schema": "palpate-result",
        "version": 1,
        "unit": unit,
        "status": result.status,
        "reason": result.reason,
        "proved": result.proved,
        "until_met": result.until_met,
        "touches": result.touches,
        "travel": result.travel,
        "contacts": [contact_entry(contact) for contact in result.contacts],
        "misses": [miss_entry(miss) for miss in result.misses],
        "steps": [_step(step) for step in result.steps],
        "found": found,
        "seconds": {"recognition": result.recognition_time, "planning": result.planning_time},
        **({} if phases is None else {"rig_seconds": asdict(phases)}),
    }


def check_run_picture(path: Path | None) -> None:
    """Refuse what can't be drawn to, before the run. No suffix: a folder."""
    if path is None:
        return
    if path.is_dir() or not path.suffix:
        if not path.parent.is_dir():
            raise ValueError(f"--plot: there is no folder {str(path.parent)!r}; make it first")
        if path.exists() and not path.is_dir():
            raise ValueError(f"--plot: {str(path)!r} is a file without suffix; name another folder")
        return
    from palpate.plots.style import check_picture_path

    check_picture_path(path)


def draw_run(result: Result, path: Path, *, unit: str, labels: Sequence[str]) -> list[Path]:
    """The whole run to a file; or, to a folder, a picture of each step and one of the whole."""
    from palpate.plots import plot_run, save_figure

    def draw() -> list[Path]:
        if path.suffix and not path.is_dir():
            save_figure(plot_run(result, unit=unit, part_names=labels), path)
            return [path]
        path.mkdir(exist_ok=True)
        drawn: list[Path] = []
        for number in [*range(len(result.steps)), None]:
            name = "run.svg" if number is None else f"step-{number + 1:03}.svg"
            save_figure(plot_run(result, number, unit=unit, part_names=labels), path / name)
            drawn.append(path / name)
        return drawn

    return patiently(draw, saying="drawing")


def _step(step: Step) -> dict[str, Any]:
    answer = reply_event(step.reply)
    return {
        "purpose": step.purpose,
        "start": step.start.tolist(),
        "end": step.end.tolist(),
        "route": [point.tolist() for point in step.route],
        "path": None if step.path is None else path_told(step.path),
        "reply": answer["kind"],
        "hypothesis_count": None if step.hypotheses is None else len(step.hypotheses),
    }


def _met(step: Step, size: float) -> str:
    match step.reply:
        case Hit(contact):
            normal = "" if contact.normal is None else f", normal {_toward(contact.normal)}"
            return f"touched at {_place(contact.center, size)}{normal}"
        case Miss():
            return "touched nothing"
        case Skid():
            return "skidded; only its free way counts"
        case AlreadyTouching():
            return "touched already where it was to begin"
        case UnexpectedTouch(where):
            return f"touched on a free move at {_place(where, size)}"
        case Fault(reason):
            return f"fault: {reason}"


def _place(point: Any, size: float) -> str:
    return f"({', '.join(decimal(coordinate, size) for coordinate in point)})"


def _way(direction: Any) -> str:
    return f"{'at' if len(direction) == 2 else 'along'} {_toward(direction)}"


def _toward(direction: Any) -> str:
    """In the plane an angle, in space a unit vector."""
    if len(direction) == 2:
        return f"{math.degrees(math.atan2(direction[1], direction[0])):.1f}°"
    unit = direction / math.hypot(*direction)
    return f"({', '.join(f'{component:.3f}' for component in unit)})"
