"""Do more blind contacts beat planning (thesis 4.2)? The same problems with 2 to 6 of them, and with none.

A loop that scans for so many contacts plans too if several hypotheses are left then. What the scans
alone came to is told beside what the whole took.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate import Result
from palpate.experiments.campaign import Row
from palpate.experiments.closed_loop import problem_of, row_of
from palpate.experiments.drill import travels
from palpate.experiments.pages import digits, share, table
from palpate.experiments.thesis_sensor import parts, sensor_of
from palpate.experiments.tune import Costs

WAYS: dict[str, int | None] = {"planning": None, **{f"blind {count}": count for count in range(2, 7)}}
COSTS = Costs(speed=100.0, per_touch=1.0)


def task(number: int, *, position_error: float, normal_error_deg: float) -> Row:
    """One problem in all ways."""
    models = list(parts().values())
    sensor = sensor_of(position_error=position_error, normal_error_deg=normal_error_deg)
    row: Row = {"lost": False, "contradicted": 0, "seconds": {}}
    for name, blind in WAYS.items():
        problem = problem_of(number, models, models[number % len(models)], sensor=sensor)
        results: list[Result] = []
        loop = row_of(problem, number, blind=blind, seen=results.append)
        scanned, planned = travels(results[0])
        row["lost"] |= loop["lost"]
        row["contradicted"] += loop["contradicted"]
        row["seconds"][name] = {"loop": loop["seconds"]["loop"], "planning": loop["seconds"]["planning"]}
        told = ("status", "scans", "first", "touches")
        row[name] = {key: loop[key] for key in told} | {"scanned": scanned, "planned": planned}
    return row


def markdown(rows: Sequence[Row]) -> str:
    """A row for each way."""
    header = [
        "",
        "problems",
        "scans",
        "their travel",
        "hypotheses then",
        "one left then",
        "solved",
        "guarded moves",
        "travel",
        "planning, s",
        "a part, s",
    ]
    return table(header, [_line(name, rows) for name in WAYS])


def _line(name: str, rows: Sequence[Row]) -> list[str]:
    ways = [row[name] for row in rows]

    def mean(values: Sequence[float]) -> float:
        return float(np.mean(values))

    travel = mean([way["scanned"] + way["planned"] for way in ways])
    touches = mean([way["touches"] for way in ways])
    computing = mean([row["seconds"][name]["loop"] for row in rows])
    return [
        name,
        f"{len(rows):,}",
        digits(mean([way["scans"] for way in ways])),
        digits(mean([way["scanned"] for way in ways])),
        digits(mean([way["first"] for way in ways])),
        share(mean([way["first"] == 1 for way in ways])),
        share(mean([way["status"] == "solved" for way in ways])),
        digits(touches),
        digits(travel),
        digits(mean([row["seconds"][name]["planning"] for row in rows])),
        digits(COSTS.of(travel, touches) + computing),
    ]
