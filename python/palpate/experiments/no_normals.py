"""Contacts without normals: the six objects of the thesis, trigger probes, with and without a prior.

    python -m palpate.experiments.no_normals

A trigger probe knows where it stopped and which way it went, but no normal. Writes the table of the docs.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from palpate import Contact, Model, Prior, load_models, recognize

from . import campaign
from .campaign import Row
from .pages import machine, table
from .problems import matrix
from .shapes import Array, Shape, point_distances, signed_distances

OBJECTS = ("robot-hand", "human-hand", "telephone", "boot", "camera", "beer-bottle")
COUNTS = (3, 4, 5, 6, 7, 8)
RADII = (0.0, 1.0)
POSITION_ERROR = 0.5
MAX_INCIDENCE = math.radians(60.0)
PRIOR_TRANSLATION, PRIOR_ROTATION = 20.0, math.radians(15.0)


@dataclass(frozen=True)
class Setting:
    """A row of the table."""

    contacts: int
    tip_radius: float
    prior: bool


SETTINGS = [Setting(count, radius, prior) for prior in (True, False) for radius in RADII for count in COUNTS]


@cache
def objects() -> tuple[Model, ...]:
    """The six objects, mm."""
    return tuple(load_models(list(OBJECTS)))


def trigger_contact(random: Random, shape: Shape, truth: Array, *, radius: float) -> Contact:
    """A touch at the end of a random straight move: the first place where the tip meets the part."""
    while True:
        angle, offset = random.uniform(-math.pi, math.pi), random.uniform(-0.6, 0.6) * shape.model.size
        direction = np.array([math.cos(angle), math.sin(angle)])
        middle = shape.corners.mean(axis=0)
        at = middle - 2.0 * shape.model.size * direction + offset * np.array([-direction[1], direction[0]])
        center = _stopped(shape, at, direction, radius=radius)
        if center is None or -direction @ _normal_at(shape, center, radius) < math.cos(MAX_INCIDENCE):
            continue
        away, where = POSITION_ERROR * math.sqrt(random.random()), random.uniform(-math.pi, math.pi)
        turn, shift = truth[:2, :2], truth[:2, 2]
        sensed = turn @ center + shift + [away * math.cos(where), away * math.sin(where)]
        return Contact.from_tip(sensed, radius, position_error=POSITION_ERROR, approach=turn @ direction)


def _stopped(shape: Shape, at: Array, direction: Array, *, radius: float) -> Array | None:
    """Where a tip that moves from `at` meets the part; None if it passes by."""
    gone = 0.0
    while gone < 4.0 * shape.model.size:
        free = float(signed_distances(shape, at)) - radius
        if free < 1e-10 * shape.model.size:
            return at
        # Nothing is nearer: the tip may go so far.
        at, gone = at + free * direction, gone + free
    return None


def _normal_at(shape: Shape, center: Array, radius: float) -> Array:
    """The outward normal where a tip rests."""
    distances = point_distances(center, shape.starts, shape.ends)
    face = int(np.argmin(distances))
    span = shape.ends[face] - shape.starts[face]
    along = np.clip((center - shape.starts[face]) @ span / (span @ span), 0.0, 1.0)
    offset = center - shape.starts[face] - along * span
    return offset / np.linalg.norm(offset) if radius > 0.0 else shape.normals[face]


def task(number: int, *, trials: int) -> Row:
    """One object in one setting."""
    setting, true = SETTINGS[number // len(OBJECTS)], number % len(OBJECTS)
    answers, seconds = zip(*(answer(setting, true, trial=trial) for trial in range(trials)), strict=True)
    return {"answers": answers, "seconds": seconds}


def answer(setting: Setting, true: int, *, trial: int) -> tuple[Row, float]:
    """Put one problem to the recognizer: what it answers, and how long it takes."""
    random = Random(f"{setting} {OBJECTS[true]} {trial}")
    shape = Shape.of(objects()[true])
    truth = matrix(random.uniform(-math.pi, math.pi), *(random.uniform(-300, 300) for _ in "xy"))
    contacts = [
        trigger_contact(random, shape, truth, radius=setting.tip_radius) for _ in range(setting.contacts)
    ]
    prior = _prior_around(random, truth) if setting.prior else None
    started = time.perf_counter()
    found = recognize(objects(), contacts, prior=prior)
    seconds = time.perf_counter() - started
    held = [one.model_number == true and one.poses.contains(truth) for one in found.hypotheses]
    return {"found": any(held), "hypotheses": len(found.hypotheses), "complete": found.complete}, seconds


def _prior_around(random: Random, truth: Array) -> Prior:
    """Off the truth by up to its bounds."""
    angle = math.atan2(truth[1, 0], truth[0, 0]) + random.uniform(-1.0, 1.0) * PRIOR_ROTATION
    x, y = (truth[k, 2] + random.uniform(-1.0, 1.0) * PRIOR_TRANSLATION for k in (0, 1))
    return Prior(matrix(angle, x, y), translation=PRIOR_TRANSLATION, rotation=PRIOR_ROTATION)


def row_of(setting: Setting, rows: list[Row]) -> Row:
    """A row of the table. Lost: a complete answer without the truth."""
    answers = [one for row in rows for one in row["answers"]]
    hypotheses = np.array([one["hypotheses"] for one in answers])
    seconds = np.array([one for row in rows for one in row["seconds"]])
    complete = np.array([one["complete"] for one in answers])
    found = np.array([one["found"] for one in answers])
    return {
        "prior": setting.prior,
        "tip_radius": setting.tip_radius,
        "contacts": setting.contacts,
        "problems": len(answers),
        "truth_lost": int((complete & ~found).sum()),
        "hypotheses_median": float(np.median(hypotheses)),
        "hypotheses_max": int(hypotheses.max()),
        "time_median_ms": round(1e3 * float(np.median(seconds)), 2),
        "time_p90_ms": round(1e3 * float(np.quantile(seconds, 0.9)), 2),
        "time_max_ms": round(1e3 * float(seconds.max()), 2),
        "incomplete_share": float(1.0 - complete.mean()),
    }


HEADINGS = {
    "prior": "prior",
    "tip_radius": "tip radius",
    "contacts": "contacts",
    "truth_lost": "truth lost",
    "hypotheses_median": "hypotheses, median",
    "hypotheses_max": "max",
    "time_median_ms": "ms, median",
    "time_p90_ms": "90 %",
    "time_max_ms": "max",
    "incomplete_share": "incomplete",
}


def cells_of(row: dict[str, Any]) -> list[str]:
    """A row as text."""
    shown = {**row, "prior": "±20, ±15°" if row["prior"] else "none"}
    shown["incomplete_share"] = f"{100.0 * row['incomplete_share']:.0f} %"
    return [f"{shown[key]:g}" if isinstance(shown[key], float) else str(shown[key]) for key in HEADINGS]


def markdown_of(rows: list[dict[str, Any]]) -> str:
    """The table for the docs."""
    lines = [
        "# Contacts without normals",
        "",
        f"One of the six objects was touched, all six are asked for; {rows[0]['problems']} problems a row.",
        f"Trigger contacts: the tip's centre within ±{POSITION_ERROR:g}, the direction of travel, no normal,",
        "no free path; incidence up to 60°. At most 1,000 hypotheses are returned; where there are more, the",
        "answer says that it is incomplete. Lost: an answer said to be complete, without the true object",
        "and pose.",
        f"Times on one core of: {machine()}.",
        "",
        "Written by `make table-no-normals`.",
        "",
        table(list(HEADINGS.values()), [cells_of(row) for row in rows]),
    ]
    return "\n".join(lines) + "\n"


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if no truth was lost."""
    parser = argparse.ArgumentParser(prog="no_normals", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--trials", type=int, default=20, help="problems for each object and row (20)")
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/no-normals"), help="folder of the results")
    page = Path("docs/tables/no-normals.md")
    parser.add_argument("--table", type=Path, default=page, help=f"the page ({page})")
    options = parser.parse_args(arguments)
    if options.trials < 1:
        parser.error("--trials must be 1 or more")
    numbers, file = range(len(SETTINGS) * len(OBJECTS)), options.out / "rows.jsonl"
    settings = {"trials": options.trials}
    try:
        done = campaign.run("no-normals", settings, numbers, task, file, cluster=options.cluster)
    except (ValueError, ConnectionError) as error:
        parser.error(str(error))
    rows = [
        row_of(setting, done[len(OBJECTS) * k : len(OBJECTS) * (k + 1)]) for k, setting in enumerate(SETTINGS)
    ]
    _write(rows, options.table)
    return 1 if any(row["truth_lost"] for row in rows) else 0


def _write(rows: list[dict[str, Any]], path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(markdown_of(rows), encoding="utf-8")
    document = {"schema": "palpate-no-normals", "version": 1, "machine": machine(), "rows": rows}
    path.with_suffix(".json").write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    shown = Table(title="contacts without normals")
    for heading in HEADINGS.values():
        shown.add_column(heading, justify="right")
    for row in rows:
        shown.add_row(*cells_of(row))
    Console(width=None if sys.stdout.isatty() else 120, highlight=False).print(shown)


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import no_normals

    sys.exit(no_normals.main())
