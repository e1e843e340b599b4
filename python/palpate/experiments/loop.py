"""Closed loops over all bundled parts, in numbers: `python -m palpate.experiments.loop`.

Each part in turn lies at a random pose in a workspace of three sizes of it, and may be any of the bundled
parts. The numbers go to stdout as JSON: how the loops end, whether the truth is left, touches, and where the
time goes.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate import (
    Contact,
    Model,
    Result,
    Sensor,
    SimulatedProbe,
    identify,
    load_models,
    part_names,
    recognize,
)
from palpate.probe import random_pose

ACROSS = 3.0  # the workspace, in sizes of the part
ROOM = 0.05  # of the part, between it and the border


def problem(models: list[Model], number: int) -> tuple[Model, NDArray[np.float64], NDArray[np.float64]]:
    """The part, its pose and the workspace."""
    model = models[number % len(models)]
    random = np.random.default_rng(number)
    half = ACROSS / 2 * model.size
    workspace = np.array([[-half, -half], [half, half]])
    return model, random_pose(model, workspace, room=ROOM * model.size, random=random), workspace


def measured(models: list[Model], number: int, noise: Any) -> dict[str, Any]:
    """One loop."""
    model, pose, workspace = problem(models, number)
    sensor = Sensor(0.5, math.radians(4), math.radians(60))
    probe = SimulatedProbe(model, pose, sensor, seed=number, noise=noise)
    began = time.perf_counter()
    result = identify(models, probe, sensor, workspace)
    seconds = time.perf_counter() - began
    kept = any(one.model == model and one.poses.contains(pose) for one in result.hypotheses)
    return {
        "status": result.status,
        "wrong": not kept,
        "touches": result.touches,
        "paths": len(result.paths),
        "first_hypotheses": next(len(s.hypotheses) for s in result.steps if s.hypotheses is not None),
        "travel_in_sizes": result.travel / model.size,
        "seconds": seconds,
        "recognition_seconds": result.recognition_time,
        "planning_seconds": result.planning_time,
        **_with_and_without_ways(models, result),
    }


def _with_and_without_ways(models: list[Model], result: Result) -> dict[str, float]:
    """Time of the last recognition, and of the same without misses and free ways, which leaves how many?"""
    bare = [
        Contact.from_tip(
            c.center,
            c.tip_radius,
            position_error=c.position_error,
            approach=c.approach,
            normal=c.normal,
            normal_error=c.normal_error,
        )
        for c in result.contacts
    ]
    began = time.perf_counter()
    recognize(models, result.contacts, misses=result.misses)
    between = time.perf_counter()
    found = recognize(models, bare)
    ended = time.perf_counter()
    return {
        "last_recognition_seconds": between - began,
        "without_ways_seconds": ended - between,
        "without_ways_hypotheses": len(found.hypotheses),
    }


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Mean, median, 95 % and largest of each number."""
    figures: dict[str, Any] = {
        "loops": len(rows),
        "status": dict(Counter(row["status"] for row in rows)),
        "wrong": sum(row["wrong"] for row in rows),
    }
    for name in rows[0]:
        if name not in ("status", "wrong"):
            values = np.array([row[name] for row in rows], dtype=float)
            middle, most = np.percentile(values, [50, 95])
            told = {"mean": values.mean(), "median": middle, "p95": most, "max": values.max()}
            figures[name] = {key: float(f"{value:.3g}") for key, value in told.items()}
    return figures


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--noise", choices=("uniform", "bounds", "none"), default="uniform")
    arguments = parser.parse_args()
    models = load_models(list(part_names()))
    rows = [measured(models, number, arguments.noise) for number in range(arguments.count)]
    json.dump(summary(rows), sys.stdout, indent=1)
    sys.stdout.write("\n")


if __name__ == "__main__":
    main()
