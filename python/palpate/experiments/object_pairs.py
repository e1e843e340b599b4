"""Table 4.2: two contacts that either of two objects may explain; perfect paths, and limited search."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np

from palpate import Contact, plan_report, plan_tree, random_contacts, recognize, standard_contacts
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment, timed
from palpate.experiments.pages import duration, machine, table
from palpate.experiments.printed import STANDARD_PAIRS, TABLE_4_2
from palpate.experiments.thesis_sensor import (
    COMPARED,
    DRAWN_ANEW,
    PLANNERS,
    SENSOR,
    TOLD,
    parts,
    sensor_of,
    sensor_words,
)

RUNS = 5  # of which the median time is told
TWO_UNIQUE: tuple[Literal["unique"], int] = ("unique", 2)

# The thesis's pairs share their contacts: each object has as many interpretations as in table 4.1, and
# limited search takes two paths. Seeds of `random_contacts` on the first object of each pair, the smallest
# with which that is so.
COMMON_SEEDS = dict(zip(STANDARD_PAIRS, (63, 1591, 21), strict=True))


def common_contacts(pair: tuple[str, str]) -> list[Contact]:
    """Contacts that both objects of a pair explain, each as often as in the thesis."""
    sensor = sensor_of(**SENSOR)
    return random_contacts(parts()[pair[0]], np.eye(3), sensor, seed=COMMON_SEEDS[pair], noise="none")


def task(number: int, **bounds: Any) -> Row:
    """A pair of objects, with contacts common to both or with the standard points of either."""
    seed, place = divmod(number, SEEDS)
    kind, which = divmod(place, len(STANDARD_PAIRS))
    pair = STANDARD_PAIRS[which]
    own = None if kind == 0 else pair[kind - 1]
    sensor = sensor_of(**bounds)
    contacts = common_contacts(pair) if own is None else standard_contacts(own)
    found = recognize([parts()[name] for name in pair], contacts)
    counts = [sum(one.model.name == name for one in found.hypotheses) for name in pair]
    row: Row = {
        "pair": list(pair),
        "standard_points_of": own,
        "hypotheses": counts,
        "planners": {},
        "seconds": {},
    }
    for planner in PLANNERS:
        planning = partial(plan_report, found.hypotheses, sensor, planner=planner, seed=seed)
        report, perfect = timed(planning, runs=RUNS)
        _, first = timed(partial(planning, stop=TWO_UNIQUE), runs=RUNS)
        tree = plan_tree(found.hypotheses, sensor, planner=planner, stop=TWO_UNIQUE, seed=seed)
        row["planners"][planner] = {
            "score": None if report.path is None else report.path.score,
            "identified": tree.identified[1:],
        }
        row["seconds"][planner] = {"perfect": perfect, "two_unique": first}
    return row


def markdown(rows: list[Row]) -> str:
    """The tables, and what is to be known of them."""
    common = [row for row in rows if row["standard_points_of"] is None]
    own = [row for row in rows if row["standard_points_of"] is not None]
    perfect = ["objects", "interpretations, thesis", "ours", "perfect path, thesis", *TOLD]
    limited = ["objects", "2-unique path, thesis", *TOLD, "identified, thesis", *TOLD]
    alone = ["objects", "standard points of", "interpretations", *(f"perfect path, {one}" for one in TOLD)]
    alone += [f"identified, {one}" for one in TOLD]
    return "\n\n".join(
        [
            f"Two contacts of {sensor_words(SENSOR)} that either of two objects may explain. {COMPARED} "
            f"Median of {RUNS} runs on: {machine()}. A time in brackets is of a path that is the "
            "planner's best, but not perfect.",
            table(perfect, [_perfect_cells(row) for row in common]),
            "With search that stops at a path that identifies two; *identified* is how many the paths of "
            "each level of the ambiguity tree identify:",
            table(limited, [_limited_cells(row) for row in common]),
            f"{DRAWN_ANEW} As in the thesis the two contacts are common to both objects, each object "
            "explains them as often as in table 4.1, and the limited search takes two paths: of the "
            "pairs of contacts drawn from the first object with the seeds 0, 1, 2 and so on, the first "
            "of which that is true was taken.",
            "The same pairs with the standard points of one of them, which the other explains by chance, "
            "if at all:",
            table(alone, [_alone_cells(row) for row in own]),
        ]
    )


def _perfect_cells(row: Row) -> list[str]:
    printed = TABLE_4_2[tuple(row["pair"])]
    return [
        ", ".join(row["pair"]),
        _sum(printed.interpretations),
        _sum(row["hypotheses"]),
        f"{printed.perfect_path} s",
        *(_perfect(row, planner) for planner in PLANNERS),
    ]


def _limited_cells(row: Row) -> list[str]:
    printed = TABLE_4_2[tuple(row["pair"])]
    return [
        ", ".join(row["pair"]),
        f"{printed.two_unique} s",
        *(duration(row["seconds"][planner]["two_unique"]) for planner in PLANNERS),
        _levels(printed.identified),
        *(_levels(row["planners"][planner]["identified"]) for planner in PLANNERS),
    ]


def _alone_cells(row: Row) -> list[str]:
    return [
        ", ".join(row["pair"]),
        row["standard_points_of"],
        _sum(row["hypotheses"]),
        *(_perfect(row, planner) for planner in PLANNERS),
        *(_levels(row["planners"][planner]["identified"]) for planner in PLANNERS),
    ]


def _sum(counts: Any) -> str:
    return " + ".join(map(str, counts))


def _levels(identified: Any) -> str:
    return ", ".join(map(str, identified)) or "none"


def _perfect(row: Row, planner: str) -> str:
    told = duration(row["seconds"][planner]["perfect"])
    return told if row["planners"][planner]["score"] == 1.0 else f"({told})"


EXPERIMENT = Experiment(
    title="Table 4.2: Distinguishing multiple objects",
    task=task,
    table=markdown,
    groups=3 * len(STANDARD_PAIRS),
    settings=SENSOR,
)
