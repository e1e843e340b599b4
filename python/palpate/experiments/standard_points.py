"""Table 4.1: each of the six objects at its standard points, and a perfect path among its interpretations."""

from __future__ import annotations

from functools import partial
from typing import Any

from palpate import plan_report, recognize, standard_contacts
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment, timed
from palpate.experiments.pages import duration, machine, table
from palpate.experiments.printed import TABLE_4_1
from palpate.experiments.thesis_sensor import (
    COMPARED,
    DRAWN_ANEW,
    PLANNERS,
    SENSOR,
    parts,
    sensor_of,
    sensor_words,
)

RUNS = 5  # of which the median time is told


def task(number: int, **bounds: Any) -> Row:
    """One object."""
    seed, place = divmod(number, SEEDS)
    name = list(TABLE_4_1)[place]
    model, sensor = parts()[name], sensor_of(**bounds)
    contacts = standard_contacts(name)
    found, seconds = timed(lambda: recognize([model], contacts), runs=RUNS)
    row: Row = {
        "object": name,
        "faces": len(model.faces),
        "hypotheses": len(found.hypotheses),
        "interpretations": found.interpretation_count,
        "score": {},
        "seconds": {"recognition": seconds},
    }
    for planner in PLANNERS:
        planning = partial(plan_report, found.hypotheses, sensor, planner=planner, seed=seed)
        report, seconds = timed(planning, runs=RUNS)
        row["score"][planner] = None if report.path is None else report.path.score
        row["seconds"][planner] = seconds
    return row


def markdown(rows: list[Row]) -> str:
    """The table, and what is to be known of it."""
    header = ["object", "faces, thesis", "ours", "interpretations, thesis", "ours"]
    header += ["recognition, thesis", "ours", "perfect path, thesis", "`auto`", "`ellis`"]
    cells = []
    for row in rows:
        printed = TABLE_4_1[row["object"]]
        cells.append(
            [
                row["object"],
                str(printed.faces),
                str(row["faces"]),
                str(printed.interpretations),
                str(row["interpretations"]),
                f"{printed.recognition:.1f} s",
                duration(row["seconds"]["recognition"]),
                f"{printed.perfect_path:.1f} s",
                *(_path(row, planner) for planner in PLANNERS),
            ]
        )
    return "\n\n".join(
        [
            f"Two contacts of {sensor_words(SENSOR)}. {COMPARED} Median of {RUNS} runs on: {machine()}.",
            table(header, cells),
            f"{DRAWN_ANEW} The standard points were chosen so that the thesis's numbers of "
            "interpretations come out. A time in brackets is of a path that is the planner's best, but "
            "not perfect.",
        ]
    )


def _path(row: Row, planner: str) -> str:
    told = duration(row["seconds"][planner])
    return told if row["score"][planner] == 1.0 else f"({told})"


EXPERIMENT = Experiment(
    title="Table 4.1: Interpretations of standard points",
    task=task,
    table=markdown,
    groups=len(TABLE_4_1),
    settings=SENSOR,
)
