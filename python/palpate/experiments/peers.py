"""What other ways make of the same contacts: how often are they right, and how long do they take?

    python -m palpate.experiments.peers --parts target/parts --page docs/tables/peers.md
    python -m palpate.experiments.peers --parts target/parts --page docs/tables/peers.md --methods palpate

Contacts are ±0.5 and ±4°, all around parts that are 200 across. Rows are on disk as they come, a file for
each method. With `--methods` only those are asked: their rows of another build are made anew, those of all
others are taken as they are, and the page is written from both. `peer_truth` says when an answer is true.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
import time
from collections.abc import Callable, Sequence
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import palpate

from . import campaign
from .build import build
from .campaign import Row
from .campaign_space import digest, parts_in
from .pages import machine
from .peer_methods import METHODS, Ask
from .peer_page import OURS, markdown
from .peer_truth import APART, WITHIN, close_poses, mean_distances, number_of_places, share_of_all
from .random_solids import random_solid
from .solid_particles import distinct
from .solid_problems import Bounds, Problem, draw_contacts, for_core, random_pose
from .solids import Solid

COUNTS = (3, 4, 6, 9)
BOUNDS = Bounds(position_error=0.5, normal_error=math.radians(4.0))
SCALE = BOUNDS.position_error / BOUNDS.normal_error
NAMES = (OURS, *METHODS)


def problem(number: int, parts: Sequence[Solid]) -> Problem:
    """The problem of a row: each part is touched with each number of contacts in turn, anew."""
    solid = _part(number // len(COUNTS), parts)
    random = np.random.default_rng([number, 5])
    truth = random_pose(random, 300.0)
    count = COUNTS[number % len(COUNTS)]
    contacts = draw_contacts(random, solid, truth, bounds=BOUNDS, count=count, manners=("around",))
    return Problem(number, "peers", (solid,), 0, truth, tuple(contacts), (), None)


def _part(number: int, parts: Sequence[Solid]) -> Solid:
    random = np.random.default_rng([number, 6])
    return parts[int(random.integers(len(parts)))] if parts else random_solid(random)


def task(number: int, *, parts: str | None, digest: int, method: str, package: str, machine: str) -> Row:
    """One problem put to a method."""
    one = problem(number, parts_in(parts))
    if method == OURS:
        answer = _ours(one)
    else:
        answer = _theirs(one, _prepared(method, number // len(COUNTS), parts))
    return {"contacts": len(one.contacts), "part": one.solid.name, "faces": one.solid.num_faces, **answer}


@lru_cache(maxsize=1)
def _prepared(method: str, number: int, parts: str | None) -> Ask:
    return METHODS[method].prepare(_part(number, parts_in(parts)), SCALE)


def _theirs(one: Problem, ask: Ask) -> Row:
    started = time.process_time()
    poses = ask(one.contacts, one.seed)
    seconds = time.process_time() - started
    away = mean_distances(one.solid, poses, one.world_from_model)
    centers = np.array([contact.center for contact in one.contacts])
    return {
        "true": bool((away <= WITHIN).any()),
        "strict": bool(close_poses(one.solid, poses, one.world_from_model).any()),
        "best": bool((away[:1] <= WITHIN).any()),
        "answers": len(poses),
        "places": len(distinct(poses, centers, APART)),
        "seconds": seconds,
    }


def _ours(one: Problem) -> Row:
    """Whether some hypothesis contains the true pose, how many there are, and how large they are."""
    given = for_core(one)
    started = time.process_time()
    found = palpate.recognize(**given)
    seconds = time.process_time() - started
    sets = [hypothesis.poses for hypothesis in found.hypotheses]
    true = any(poses.contains(one.world_from_model) for poses in sets)
    best = np.array([hypothesis.world_from_model for hypothesis in found.hypotheses[:1]]).reshape(-1, 4, 4)
    middle = one.solid.vertices.mean(axis=0)
    turns, shifts = [poses.rotation_bound for poses in sets], [poses.excursion(middle) for poses in sets]
    return {
        "true": true,
        "strict": true,
        "best": bool((mean_distances(one.solid, best, one.world_from_model) <= WITHIN).any()),
        "answers": len(sets),
        "places": number_of_places(sets, np.array([contact.center for contact in one.contacts])),
        "complete": found.complete,
        "turn": max(turns, default=0.0),
        "shift": max(shifts, default=0.0),
        "share": share_of_all(turns, shifts),
        "seconds": seconds,
    }


@cache
def _cube() -> Solid:
    return random_solid(np.random.default_rng(0))


def installed(names: Sequence[str], say: Callable[[str], Any]) -> list[str]:
    """Those methods whose packages are there; what is absent is said."""
    there = []
    for name in names:
        try:
            if name != OURS:
                METHODS[name].prepare(_cube(), SCALE)
        except (ImportError, OSError) as error:  # a shared library that is missing is the latter
            say(f"{name}: left out, {error}\n")
            continue
        there.append(name)
    return there


def file_of(folder: Path, method: str) -> Path:
    """Where the rows of a method are."""
    return folder / f"{re.sub('[^a-z0-9]+', '-', method.lower())}.jsonl"


def _settings(method: str, parts: str | None) -> dict[str, Any]:
    package = METHODS[method].package if method != OURS else OURS
    known = palpate.__version__ if method == OURS else version(package)
    return {
        "parts": parts,
        "digest": digest(parts),
        "method": method,
        "package": f"{package} {known}",
        "machine": machine(),
    }


def forget_others(file: Path) -> None:
    """Remove rows of another build."""
    if file.exists() and campaign.read(file)[0].get("build") != build():
        file.unlink()


def saved(file: Path, numbers: Sequence[int], known: int) -> tuple[Row, list[Row]] | None:
    """Header and rows of these numbers, if all are there, and of parts with the digest `known`."""
    if not file.exists():
        return None
    header, rows = campaign.read(file)
    by_number = {row["number"]: row for row in rows}
    if header["settings"]["digest"] != known or not by_number.keys() >= set(numbers):
        return None
    return header, [by_number[number] for number in numbers]


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="peers", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=50, help=f"for each of {COUNTS} contacts (50)")
    parser.add_argument("--parts", type=Path, help="folder of public_parts; else parts that are made here")
    parser.add_argument("--methods", choices=NAMES, nargs="+", help="ask these anew; rows of others are kept")
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/peers"), help="folder of the rows")
    parser.add_argument("--page", type=Path, help="file that the tables are written to, Markdown")
    options = parser.parse_args(arguments)
    if options.runs < 1:
        parser.error("--runs must be 1 or more")
    folder = str(options.parts.resolve()) if options.parts else None
    numbers = range(options.runs * len(COUNTS))
    try:
        for name in installed(options.methods or NAMES, sys.stderr.write):
            file = file_of(options.out, name)
            if options.methods:
                forget_others(file)
            campaign.run(
                f"peers, {name}", _settings(name, folder), numbers, task, file, cluster=options.cluster
            )
        rows = {name: saved(file_of(options.out, name), numbers, digest(folder)) for name in NAMES}
    except (ValueError, ConnectionError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    for name in (name for name in NAMES if rows[name] is None):
        file = file_of(options.out, name)
        sys.stderr.write(f"{name}: not on the page, {file} has no rows of these problems\n")
    text = markdown({name: one for name, one in rows.items() if one is not None})
    if options.page:
        options.page.parent.mkdir(parents=True, exist_ok=True)
        options.page.write_text(text, encoding="utf-8")
    sys.stdout.write(text)
    return 0


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import peers

    sys.exit(peers.main())
