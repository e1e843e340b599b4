"""What other ways make of the same contacts: how often are they right, and how long do they take?

    python -m palpate.experiments.peers --parts target/parts --runs 50 --page docs/tables/peers.md

Contacts are ±0.5 and ±4°, all around parts that are 200 across. An answer is true if every vertex of the part
is within 4 of one of the part where it truly is: 2 for the place, and 2 for a turn by 0.02 rad at 100 from
the middle; symmetric places are one. Times are of CPU, without what is done once for a part. Rows are on disk
as they come.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from . import campaign
from .campaign import Row
from .campaign_space import digest, parts_in
from .pages import duration, table
from .peer_methods import METHODS, Ask
from .random_solids import random_solid
from .solid_particles import distinct, same_place
from .solid_problems import Bounds, Problem, draw_contacts, for_core, random_pose
from .solids import Solid

COUNTS = (3, 4, 6, 9)
WITHIN = 4.0
BOUNDS = Bounds(position_error=0.5, normal_error=math.radians(4.0))
#: Answers that place the contacts alike to this are counted once.
APART = 2.0
OURS = "palpate"


def problem(number: int, parts: Sequence[Solid]) -> Problem:
    """The problem of a row: of each number of contacts in turn."""
    random = np.random.default_rng([number, 5])
    solid = parts[int(random.integers(len(parts)))] if parts else random_solid(random)
    truth = random_pose(random, 300.0)
    count = COUNTS[number % len(COUNTS)]
    contacts = draw_contacts(random, solid, truth, bounds=BOUNDS, count=count, manners=("around",))
    return Problem(number, "peers", (solid,), 0, truth, tuple(contacts), (), None)


def task(number: int, *, parts: str | None, digest: int, methods: list[str]) -> Row:
    """One problem put to each of the methods."""
    one = problem(number, parts_in(parts))
    answers: dict[str, Row] = {}
    seconds: dict[str, float] = {}
    for name in methods:
        answers[name], seconds[name] = _ours(one) if name == OURS else _theirs(one, name)
    return {
        "contacts": len(one.contacts),
        "part": one.solid.name,
        "faces": one.solid.num_faces,
        "answers": answers,
        "seconds": seconds,
    }


def _theirs(one: Problem, name: str) -> tuple[Row, float]:
    ask: Ask = METHODS[name](one.solid)
    started = time.process_time()
    poses = ask(one.contacts, one.seed)
    seconds = time.process_time() - started
    centers = np.array([contact.center for contact in one.contacts])
    found = bool(same_place(one.solid, poses, one.world_from_model, within=WITHIN).any())
    return {"true": found, "answers": len(distinct(poses, centers, APART))}, seconds


def _ours(one: Problem) -> tuple[Row, float]:
    """Whether some hypothesis contains the true pose, how many there are, and how large they are."""
    from palpate import recognize

    given = for_core(one)
    started = time.process_time()
    found = recognize(**given)
    seconds = time.process_time() - started
    sets = [hypothesis.poses for hypothesis in found.hypotheses]
    middle = one.solid.vertices.mean(axis=0)
    return {
        "true": any(poses.contains(one.world_from_model) for poses in sets),
        "answers": len(sets),
        "turn": float(np.median([poses.rotation_bound for poses in sets])) if sets else 0.0,
        "shift": float(np.median([poses.excursion(middle) for poses in sets])) if sets else 0.0,
    }, seconds


@cache
def _cube() -> Solid:
    return random_solid(np.random.default_rng(0))


def installed(names: Sequence[str], say: Callable[[str], Any]) -> list[str]:
    """Those methods whose packages are there; what is absent is said."""
    there = []
    for name in names:
        try:
            if name != OURS:
                METHODS[name](_cube())
        except ImportError as error:
            say(f"{name}: left out, {error}\n")
            continue
        there.append(name)
    return there


def markdown(rows: list[Row], methods: list[str]) -> str:
    """A table for a page: share of true answers, median time and number of answers for each count."""
    header = ["", *(f"{count} contacts" for count in COUNTS)]
    cells = []
    for name in methods:
        line = [name]
        for count in COUNTS:
            some = [row for row in rows if row["contacts"] == count]
            if not some:
                line.append("none")
                continue
            share = np.mean([row["answers"][name]["true"] for row in some])
            often = np.median([row["answers"][name]["answers"] for row in some])
            took = duration(float(np.median([row["seconds"][name] for row in some])))
            line.append(f"{100.0 * share:.0f} %, {took}, {often:.0f}")
        cells.append(line)
    sizes = []
    for count in COUNTS if OURS in methods else ():
        ours = [row["answers"][OURS] for row in rows if row["contacts"] == count]
        some = [one for one in ours if one["answers"]]
        if some:
            turn, shift = (float(np.median([one[key] for one in some])) for key in ("turn", "shift"))
            sizes.append(f"{count} contacts: {math.degrees(turn):.2g}°, {shift:.2g}")
    said = [
        "Share of problems whose answers contain the true place; median CPU time; median number of "
        "distinct answers.",
        table(header, cells),
    ]
    if sizes:
        largest = (
            "The most that two poses of a set of palpate's differ by, turn and way of the middle, median"
        )
        said.append(f"{largest}: {'; '.join(sizes)}.")
    return "\n\n".join(said) + "\n"


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="peers", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=50, help=f"for each of {COUNTS} contacts (50)")
    parser.add_argument("--parts", type=Path, help="folder of public_parts; else parts that are made here")
    names = [OURS, *METHODS]
    parser.add_argument("--without", choices=names, action="append", default=[], help="leave one out")
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/peers"), help="folder of the rows")
    parser.add_argument("--page", type=Path, help="file that the table is written to, Markdown")
    options = parser.parse_args(arguments)
    folder = str(options.parts.resolve()) if options.parts else None
    methods = installed([name for name in names if name not in options.without], sys.stderr.write)
    settings = {"parts": folder, "digest": digest(folder), "methods": methods}
    numbers = range(options.runs * len(COUNTS))
    try:
        rows = campaign.run(
            "peers", settings, numbers, task, options.out / "rows.jsonl", cluster=options.cluster
        )
    except (ValueError, ConnectionError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    text = markdown(rows, methods)
    if options.page:
        options.page.parent.mkdir(parents=True, exist_ok=True)
        options.page.write_text(f"# Peers in space\n\n{text}", encoding="utf-8")
    sys.stdout.write(text)
    return 0


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import peers

    sys.exit(peers.main())
