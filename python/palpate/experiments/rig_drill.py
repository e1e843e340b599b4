"""Parts of a drill, identified through the rig: table 4.4 in simulated seconds, and figures 4.12 to 4.16.

Each run is a part at a random pose in the thesis's workspace. It is run twice over: with ±5° and 4 mm, which
the thesis took to allow for errors of its models, and with what the rig's own bounds are.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import numpy as np

from palpate import Result, Sensor, identify
from palpate.experiments.campaign import Row
from palpate.experiments.drill import GROUPS, PHASES, WORKSPACE
from palpate.experiments.experiment import SEEDS, Experiment, Picture
from palpate.experiments.pages import duration, machine, table
from palpate.experiments.printed import TABLE_4_4
from palpate.experiments.shapes import Array
from palpate.experiments.thesis_sensor import parts
from palpate.probe import random_pose
from palpate.rig import RigProbe, phases_of, rig_sensor
from palpate.truth import number_of_truth

RUNS = 34  # of each kind: 204 in all
ROOM = 12.0  # mm, between the part and the border: the bearing passes there
EFFORT = 20_000
BROAD = (4.0, 5.0)  # mm and degrees (4.3)
BOUNDS = ("broad", "own")
SHOWN = {
    "4.12": ("Path for the right section of the drill casing", 0, "broad", True),
    "4.13": ("First path for the left and right sections of the drill casing", 1, "broad", True),
    "4.14": ("Final state for the left and right sections of the drill casing", 1, "broad", False),
    "4.15": ("First path for the right drill casing, low uncertainty", 0, "own", True),
    "4.16": ("Final state for the right drill casing, low uncertainty", 0, "own", False),
}
"""Figures: title, kind, bounds, and whether it is the first path or the final state."""


def kind_of(number: int) -> tuple[int, str]:
    """Which parts, and which bounds."""
    group = number % SEEDS % (len(GROUPS) * len(BOUNDS))
    return group % len(GROUPS), BOUNDS[group // len(GROUPS)]


def task(number: int) -> Row:
    """One run of the loop."""
    group, bounds = kind_of(number)
    result, probe, truth, pose = run(number)
    phases = phases_of(result, probe.recording)
    kept = number_of_truth(result.hypotheses, parts()[truth], pose) is not None
    replies = Counter(type(step.reply).__name__ for step in result.steps)
    return {
        "number": number,
        "parts": list(GROUPS[group][0]),
        "bounds": bounds,
        "truth": truth,
        "status": result.status,
        "reason": result.reason,
        "lost": bool(result.contacts) and not kept,
        "touches": result.touches,
        "paths": len(result.paths),
        "contacts": len(result.contacts),
        "replies": dict(replies),
        "first_hypotheses": next((len(s.hypotheses) for s in result.steps if s.hypotheses is not None), 0),
        "hypotheses": len(result.hypotheses),
        "initial_data": phases.initial_data,
        "execution": phases.execution,
        "seconds": {"recognition": result.recognition_time, "planning": result.planning_time},
    }


def run(number: int) -> tuple[Result, RigProbe, str, Array]:
    """The loop, the rig, and what truly lies there."""
    group, bounds = kind_of(number)
    names, truths = GROUPS[group]
    truth = truths[number % SEEDS // (len(GROUPS) * len(BOUNDS)) % len(truths)]
    model = parts()[truth]
    # The same part at the same pose for both bounds.
    random = np.random.default_rng([number - len(GROUPS) * BOUNDS.index(bounds), 8])
    pose = random_pose(model, WORKSPACE, room=ROOM, random=random)
    sensor = sensor_of(bounds)
    probe = RigProbe(model, pose, sensor, workspace=WORKSPACE, seed=int(random.integers(2**32)))
    models = [parts()[name] for name in names]
    return identify(models, probe, sensor, WORKSPACE, effort=EFFORT), probe, truth, pose


def sensor_of(bounds: str) -> Sensor:
    """The rig's own bounds, or the thesis's broad ones."""
    own = rig_sensor()
    if bounds == "own":
        return own
    position, normal_deg = BROAD
    return Sensor(position, math.radians(normal_deg), own.max_incidence, own.tip_radius, own.path_error)


def markdown(rows: list[Row]) -> str:
    """Table 4.4 through the rig, and how the runs ended."""
    own = rig_sensor()
    words = {
        "broad": "±4 mm, ±5°",
        "own": f"±{own.position_error:.2f} mm, ±{math.degrees(own.normal_error or 0.0):.2f}°",
    }
    phases: list[list[str]] = []
    ends: list[list[str]] = []
    for group, (names, _) in enumerate(GROUPS):
        if names in TABLE_4_4:
            printed = [f"{seconds:g} s" for seconds in TABLE_4_4[names]]
            phases.append([", ".join(names), "thesis", *printed])
        for bounds in BOUNDS:
            some = [row for row in rows if kind_of(row["number"]) == (group, bounds)]
            if not some:
                continue
            told = [f"{_mean(some, 'initial_data'):.1f} s", *(duration(_mean(some, p)) for p in PHASES[1:3])]
            phases.append([", ".join(names), words[bounds], *told, f"{_mean(some, 'execution'):.1f} s"])
            ends.append(_ended(", ".join(names), words[bounds], some))
    lost = sum(row["lost"] for row in rows)
    faults = Counter(row["reason"] for row in rows if row["status"] == "fault")
    header = ["objects", "", "initial data", "recognition", "path planning", "path execution"]
    columns = ["objects", "bounds", "statuses", "wrong", "first hypotheses", "paths", "guarded moves"]
    told_faults = "; ".join(f"{count} × {reason}" for reason, count in faults.items())
    return "\n\n".join(
        [
            f"{len(rows)} runs through the rig; **wrong: {lost}**; faults: {told_faults or 'none'}. A drill "
            "part, drawn anew, lies at a random pose in a workspace of 290 × 320 mm. Initial data and "
            "execution are simulated seconds of the rig, free moves, settling and zeros included; computing "
            f"is measured on: {machine()}. Means over the runs.",
            table(header, phases),
            table(columns, ends),
        ]
    )


def _mean(rows: list[Row], phase: str) -> float:
    return float(np.mean([row[phase] if phase in row else row["seconds"][phase] for row in rows]))


def _ended(names: str, bounds: str, rows: list[Row]) -> list[str]:
    statuses = Counter(row["status"].replace("_", " ") for row in rows)
    return [
        names,
        bounds,
        ", ".join(f"{count} {status}" for status, count in statuses.most_common()),
        str(sum(row["lost"] for row in rows)),
        *(f"{_mean(rows, name):.2f}" for name in ("first_hypotheses", "paths", "touches")),
    ]


def pictures(rows: list[Row]) -> list[Picture]:
    """The phases, figures 4.12 to 4.16 through the rig, and the recording of one run."""
    from palpate.experiments.charts import phases_chart
    from palpate.plots import plot_recording, plot_run
    from palpate.plots.style import svg_of

    bars: dict[str, list[float]] = {}
    for group, (names, _) in enumerate(GROUPS):
        label = " or ".join(names)
        if names in TABLE_4_4:
            bars[f"{label}\nthesis"] = list(map(float, TABLE_4_4[names]))
        for bounds in BOUNDS:
            some = [row for row in rows if kind_of(row["number"]) == (group, bounds)]
            if some:
                bars[f"{label}\nrig, {bounds}"] = [_mean(some, phase) for phase in PHASES]
    drawn = [Picture("rig-table-4.4", phases_chart(bars), "Table 4.4 through the rig.")]
    runs: dict[int, tuple[Result, RigProbe]] = {}
    for figure, (title, group, bounds, is_first) in SHOWN.items():
        number = _exemplary(rows, group, bounds)
        if number is None:
            continue
        if number not in runs:
            result, probe, _, _ = run(number)
            runs[number] = result, probe
        result, probe = runs[number]
        step = next(k for k, one in enumerate(result.steps) if one.purpose == "path") if is_first else None
        caption = f"**Figure {figure} through the rig.** {title}, drawn anew."
        drawn.append(Picture(f"rig-figure-{figure}", svg_of(plot_run(result, step)), caption))
        if figure == "4.12":
            recorded = svg_of(plot_recording(probe.recording))
            told = "Force, position and state in the run of figure 4.12."
            drawn.append(Picture("rig-recording", recorded, told))
    return drawn


def _exemplary(rows: list[Row], group: int, bounds: str) -> int | None:
    """Of a run in which two contacts leave about three hypotheses, and one path decides."""
    shown: list[tuple[Any, ...]] = [
        (abs(row["first_hypotheses"] - 3), row["touches"], row["number"])
        for row in rows
        if kind_of(row["number"]) == (group, bounds)
        and row["status"] == "solved"
        and row["paths"] >= 1
        and row["first_hypotheses"] > 1
    ]
    return min(shown)[-1] if shown else None


EXPERIMENT = Experiment(
    title="The rig: table 4.4 and figures 4.12 to 4.16 with its hardware simulated",
    task=task,
    table=markdown,
    groups=len(GROUPS) * len(BOUNDS),
    repeats=RUNS,
    pictures=pictures,
    of_thesis=False,
)
