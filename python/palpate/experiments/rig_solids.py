"""Solids, identified through the rig: three axes, the stem above the tip, and a part that lies anyhow.

Moves go down, not too flat, and planned ones keep the stem clear. The first contacts go straight down, where
the stem follows the tip: by then nothing is known of where else it may go.
"""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np

from palpate import Model, Result, identify, load_models
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment
from palpate.experiments.pages import duration, machine, table
from palpate.experiments.rig_drill import ROOM
from palpate.experiments.shapes import Array
from palpate.probe import random_pose
from palpate.rig import FROM_ABOVE, SIZE, RigProbe, phases_of
from palpate.truth import number_of_truth

RUNS = 5  # of each group
MOST_SECONDS = 5.0  # for recognition and a path between two moves
GROUPS = (("hexagon",), ("l-bracket",), ("l-bracket", "rib-plate", "hexagon"))
COLUMNS = ["objects", "statuses", "wrong", "first hypotheses", "paths", "guarded moves"]
TIMES = ["initial data", "recognition", "path planning", "path execution"]


@cache
def _part(name: str) -> Model:
    (model,) = load_models(name)
    return model


def run(number: int) -> tuple[Result, RigProbe, Model, Array]:
    """The loop, the rig, and what truly lies there."""
    names = GROUPS[number % SEEDS % len(GROUPS)]
    models = [_part(name) for name in names]
    truth = models[number % SEEDS // len(GROUPS) % len(models)]
    workspace = np.array([np.zeros(3), SIZE[3]])
    random = np.random.default_rng([number, 9])
    pose = random_pose(truth, workspace, room=ROOM, random=random)
    probe = RigProbe(truth, pose, workspace=workspace, seed=int(random.integers(2**32)))
    result = identify(models, probe, probe.sensor, workspace, directions=FROM_ABOVE, time_limit=MOST_SECONDS)
    return result, probe, truth, pose


def task(number: int) -> Row:
    """One run of the loop."""
    result, probe, truth, pose = run(number)
    phases = phases_of(result, probe.recording)
    kept = number_of_truth(result.hypotheses, truth, pose) is not None
    return {
        "number": number,
        "truth": truth.name,
        "status": result.status,
        "reason": result.reason,
        "lost": bool(result.contacts) and not kept,
        "hypotheses": len(result.hypotheses),
        "first_hypotheses": next((len(s.hypotheses) for s in result.steps if s.hypotheses is not None), 0),
        "paths": len(result.paths),
        "touches": result.touches,
        "initial_data": phases.initial_data,
        "execution": phases.execution,
        "recognition": result.recognition_time,
        "planning": result.planning_time,
    }


def markdown(rows: list[Row]) -> str:
    """How the runs ended, and what they took."""
    lines: list[list[str]] = []
    for group, names in enumerate(GROUPS):
        some = [row for row in rows if row["number"] % SEEDS % len(GROUPS) == group]
        if not some:
            continue

        def mean(name: str, some: list[Row] = some) -> float:
            return float(np.mean([row[name] for row in some]))

        statuses = Counter(row["status"].replace("_", " ") for row in some)
        lines.append(
            [
                ", ".join(names),
                ", ".join(f"{count} {status}" for status, count in statuses.most_common()),
                str(sum(row["lost"] for row in some)),
                *(f"{mean(name):.2f}" for name in ("first_hypotheses", "paths", "touches")),
                f"{mean('initial_data'):.0f} s",
                *(duration(mean(name)) if mean(name) else "none" for name in ("recognition", "planning")),
                f"{mean('execution'):.0f} s",
            ]
        )
    lost = sum(row["lost"] for row in rows)
    faults = Counter(row["reason"] for row in rows if row["status"] == "fault")
    told_faults = "; ".join(f"{count} × {reason}" for reason, count in faults.items())
    return "\n\n".join(
        [
            f"{len(rows)} runs through the rig; **wrong: {lost}**; faults: {told_faults or 'none'}. A "
            "bundled solid is turned anyhow in a workspace of 290 × 320 × 200 mm, its pose unknown. "
            f"Between two moves {MOST_SECONDS:g} s are computed at most. "
            "Initial data and execution are simulated seconds of the rig; computing is measured on: "
            f"{machine()}. Means over the runs.",
            table([*COLUMNS, *TIMES], lines),
        ]
    )


EXPERIMENT = Experiment(
    title="The rig with three axes: solids that lie anyhow",
    task=task,
    table=markdown,
    groups=len(GROUPS),
    repeats=RUNS,
    of_thesis=False,
)
