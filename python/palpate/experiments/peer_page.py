"""The page of the peers, `docs/tables/peers.md`, from the header and the rows of each method."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .campaign import Row
from .pages import duration, table
from .peer_methods import EXPLAINED, METHODS
from .peer_truth import APART, NUM_SAMPLES, TURNED, WITHIN

OURS = "palpate"
Saved = dict[str, tuple[Row, list[Row]]]
Cell = Callable[[list[Row]], str]

INTRODUCTION = f"""\
# Peers in space

Other ways to find a part by touch, given the same contacts as `palpate`: how often are they right, how much
do they answer, and how long do they take? Written by `make bench-peers`.

**Problems.** A part of a public package, 200 across, at a random pose; contacts all around it, within ±0.5
and ±4°. The part is known, its pose is not. Each part is touched with each number of contacts; {{problems}}
problems for each number.

**Right.** An answer of a peer is right if one of its poses is within {WITHIN:g} of the true one by ADD-S: the
mean distance of the part's vertices to the nearest vertex of the part where it truly is. That is the usual
measure for symmetric objects, and a mild one: a part that is nearly symmetric may lie the other way round.
An answer of `palpate` is right if a hypothesis contains the exact true pose, up to symmetry."""

TABLES: dict[str, tuple[str, Cell]] = {
    "Right": (
        "Share of the problems whose answer contains the true pose. In brackets, of peers: with a pose "
        f"within {WITHIN:g} at the centroid and {TURNED:g} rad of the true one, up to symmetry.",
        lambda rows: f"{_share(rows, 'true')} ({_share(rows, 'strict')})",
    ),
    "The first answer alone": (
        "Share of the problems where the first pose is right by ADD-S: of peers the one that explains the "
        "contacts best, of `palpate` the pose of largest slack of the first hypothesis. Where few contacts "
        "leave many poses, no single one can be right each time.",
        lambda rows: _share(rows, "best"),
    ),
    "How much is answered": (
        "Median number of poses, of which those are counted once that place the contacts alike to "
        f"{APART:g}; of `palpate` among {NUM_SAMPLES:,} samples of all its pose sets, counted in the same "
        "way, so that they may hold more. Symmetric poses count apart for peers, and once for `palpate`.",
        lambda rows: f"{_median(rows, 'places'):,.0f}",
    ),
    "Time": (
        "Median and longest CPU time of one thread. What peers do once for a part, such as clouds, trees and "
        "training, is left out; what `palpate` does once for a part is not.",
        lambda rows: f"{duration(_median(rows, 'seconds'))}, {duration(max(row['seconds'] for row in rows))}",
    ),
}


def markdown(saved: Saved) -> str:
    """The page: what is measured, then tables with a row for each method and a column for each count."""
    counts = sorted({row["contacts"] for _, rows in saved.values() for row in rows})
    problems = max(sum(row["contacts"] == counts[0] for row in rows) for _, rows in saved.values())
    blocks = [INTRODUCTION.format(problems=problems)]
    for title, (said, cell) in TABLES.items():
        lines = [[name, *_cells(rows, counts, cell)] for name, (_, rows) in saved.items()]
        blocks += [f"## {title}", _filled(said), table(_header(counts), lines)]
    if OURS in saved:
        blocks += _sets(saved[OURS][1], counts)
    blocks += _settings(saved)
    return "\n\n".join(blocks) + "\n"


def _filled(text: str, indent: str = "") -> str:
    return textwrap.fill(text, 110, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def _header(counts: Sequence[int]) -> list[str]:
    return ["", *(f"{count} contacts" for count in counts)]


def _cells(rows: list[Row], counts: Sequence[int], cell: Cell) -> list[str]:
    return [cell([row for row in rows if row["contacts"] == count]) for count in counts]


def _share(rows: list[Row], key: str) -> str:
    return f"{100.0 * float(np.mean([row[key] for row in rows])):.0f} %"


def _median(rows: list[Row], key: str) -> float:
    return float(np.median([row[key] for row in rows]))


def _sets(rows: list[Row], counts: Sequence[int]) -> list[str]:
    """What palpate's answers consist of, so that returning everything can't win."""
    asked: dict[str, Cell] = {
        "hypotheses": lambda some: f"{_median(some, 'answers'):g}",
        "most hypotheses": lambda some: f"{max(row['answers'] for row in some)}",
        "turn": lambda some: f"{math.degrees(_median(some, 'turn')):.2g}°",
        "way of the middle": lambda some: f"{_median(some, 'shift'):.2g}",
        "share of all poses": lambda some: f"{_median(some, 'share'):.0e}",
        "incomplete answers": lambda some: f"{sum(not row['complete'] for row in some)}",
    }
    return [
        "## palpate's pose sets",
        _filled(
            "Who returns everything is always right; this is how little is returned. Turn and way of the "
            "middle: the most by which two poses of a hypothesis differ (`rotation_bound`, `excursion`), in "
            "a problem's largest. Share of all poses: what the hypotheses of a problem fill together, at "
            "most, of all rotations with the middle of the part in a cube 200 across. Medians."
        ),
        table(_header(counts), [[name, *_cells(rows, counts, cell)] for name, cell in asked.items()]),
    ]


def _settings(saved: Saved) -> list[str]:
    lines = []
    for name, (header, _) in saved.items():
        said = METHODS[name].settings if name != OURS else "default settings"
        package: Any = header["settings"]["package"]
        lines.append(_filled(f"- {name} ({package}): {said}.", "  "))
    return [
        "## Settings",
        _filled(
            "Every peer is given the part, the contacts with their normals, and the bounds. The scaling "
            "series (Petrovskaya and Khatib 2011) answers with all of its particles, the others with every "
            f"pose that explains each contact within {EXPLAINED:g} of its bounds, or else the best alone."
        ),
        "\n".join(lines),
        _measured_on(saved),
    ]


def _measured_on(saved: Saved) -> str:
    """On which machine; where there are several, on which one each method was."""
    machines: dict[str, list[str]] = {}
    for name, (header, _) in saved.items():
        machines.setdefault(header["settings"]["machine"], []).append(name)
    several = [f"{machine} ({'; '.join(names)})" for machine, names in machines.items()]
    return _filled(f"Measured on: {' and '.join(several if len(several) > 1 else machines)}.")
