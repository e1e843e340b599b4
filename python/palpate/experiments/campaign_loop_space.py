"""Closed loops over solids: is a truth ever lost, how do they end, how many touches do they take?

    python -m palpate.experiments.campaign_loop_space --problems 1000 --cluster local

Problem `k` of seed `s` has the number `s · 10⁹ + k`. A solid lies at a random pose in a cube, two sizes of
the largest across, and may be any of four: the bundled ones, or four made by code of the families of
`random_solids` or `solid_shapes`; with `--parts`, every fourth time of that folder. Tips are points, or
balls with `--tip-radius`. In one of three problems every error is as large as its bound, in the others it is
uniform within. Killed and started again, it goes on where it was.
"""

from __future__ import annotations

import argparse
import math
import random as chance
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from palpate import Model, Sensor, load_models, solid_part_names
from palpate.experiments import (
    campaign,
    closed_loop,
    loop_tables,
    pages,
    public_parts,
    random_solids,
    solid_shapes,
)
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS
from palpate.usual import MAX_INCIDENCE_DEG, NORMAL_ERROR_DEG, POSITION_ERROR

LIBRARY = 4  # models that it may be
RIVALS = ["nominal", "chance"]
BESIDE = 100  # problems on which the rivals are asked too, unless another number is given


@cache
def _bundled() -> list[Model]:
    return load_models(list(solid_part_names()))


@cache
def _public(folder: str | None) -> list[Model]:
    parts = [] if folder is None else public_parts.load_parts(Path(folder))
    return [Model.mesh(one.vertices, one.triangles, name=one.name) for one in parts]


def library_of(number: int, parts: str | None) -> list[Model]:
    """The models of a problem; the truth is the first."""
    public, kind = _public(parts), number % (3 if parts is None else 4)
    random = np.random.default_rng([number, 5])
    if kind == 0:
        models = _bundled()
        first = number // 3 % len(models)
        return [*models[first:], *models[:first]]
    if kind == 3:
        return [public[k] for k in random.choice(len(public), size=LIBRARY, replace=False)]
    made = []
    for k in range(LIBRARY):
        if kind == 1:
            solid = random_solids.random_solid(random)
            made.append(Model.mesh(solid.vertices, solid.triangles, name=f"{solid.name}-{k}"))
        else:
            family = str(random.choice(list(solid_shapes.FAMILIES)))
            shape = solid_shapes.random_solid(chance.Random(int(random.integers(2**32))), family)
            made.append(Model.mesh(shape.vertices, shape.triangles, name=f"{family}-{k}"))
    return made


def task(number: int, *, parts: str | None = None, tip_radius: float = 0.0, num_beside: int = 0) -> Row:
    """One loop, and the rivals on the same problem if its number is one of the first."""
    models = library_of(number, parts)
    sensor = Sensor(
        POSITION_ERROR,
        math.radians(NORMAL_ERROR_DEG),
        math.radians(MAX_INCIDENCE_DEG),
        tip_radius,
    )
    problem = closed_loop.problem_of(number, models, models[0], sensor=sensor)
    beside = RIVALS if number % SEEDS < num_beside else []
    row = closed_loop.row_of(problem, number, beside=beside)
    kind = ("bundled", "random_solids", "solid_shapes", "parts")[number % (3 if parts is None else 4)]
    return {**row, "solid": row["part"], "part": kind}


def sections(rows: list[Row]) -> list[str]:
    """Tables of the rows."""
    beside = [row for row in rows if all(name in row for name in RIVALS)]
    return [
        loop_tables.ends(loop_tables.by_noise(rows)),
        loop_tables.distribution(rows),
        loop_tables.by_part(rows),
        *([loop_tables.beside({"after the first contacts": beside})] if beside else []),
    ]


def faults(rows: list[Row]) -> list[str]:
    """Everything that must not be."""
    lost = [f"number {row['number']}: the truth is in no hypothesis left" for row in rows if row["lost"]]
    wrong = [f"number {row['number']}: hypotheses contradict contacts" for row in rows if row["contradicted"]]
    stopped = [f"number {row['number']}: {row['status']}" for row in rows if row["status"] == "fault"]
    return lost + wrong + stopped


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if nothing was wrong."""
    parser = argparse.ArgumentParser(prog="campaign_loop_space", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--problems", type=int, default=1_000, help="how many (1000)")
    parser.add_argument("--seed", type=int, default=0, help="which problems (0)")
    parser.add_argument("--parts", type=Path, help="folder of public parts; left out if it is not there")
    parser.add_argument("--tip-radius", type=float, default=0.0, help="of a ball (0: a point)")
    parser.add_argument(
        "--beside", type=int, default=BESIDE, help=f"so many beside other ways to choose the touch ({BESIDE})"
    )
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument(
        "--out", type=Path, default=Path("out/campaign-loop-space.jsonl"), help="file of the rows"
    )
    parser.add_argument("--page", type=Path, help="write the tables of this page anew")
    options = parser.parse_args(arguments)
    if (
        options.problems < 1
        or min(options.seed, options.beside) < 0
        or not 0.0 <= options.tip_radius < math.inf
    ):
        parser.error("--problems must be 1 or more, --seed, --beside and --tip-radius 0 or more")
    parts = None if options.parts is None or not options.parts.is_dir() else str(options.parts)
    settings: dict[str, Any] = {
        "parts": parts,
        "tip_radius": options.tip_radius,
        "num_beside": options.beside,
    }
    first = options.seed * SEEDS
    try:
        numbers = range(first, first + options.problems)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        rows = campaign.run("loops-space", settings, numbers, task, options.out, cluster=options.cluster)
    except (ValueError, OSError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    made = "\n\n".join(sections(rows))
    if options.page:
        pages.rewrite(options.page, "solids", made)
    sys.stdout.write(made + "\n")
    wrong = faults(rows)
    for line in wrong:
        sys.stdout.write(line + "\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import campaign_loop_space

    sys.exit(campaign_loop_space.main())
