"""Closed loops where the promise's conditions do not hold: is what contradicts a model ever said to fit it?

`"part"`: the part that lies there is not among the models: by turns a bundled part that is left out of
them, and a random star. `"readings"`: the part is among them, but errors are up to two to five times as large
as their stated bounds. The truth may be lost then; but whatever is left must explain every contact and miss.
"""

from __future__ import annotations

import math
from random import Random
from typing import Any, Literal

import numpy as np

from palpate.experiments.closed_loop import Row, problem_of, row_of
from palpate.experiments.random_parts import random_part
from palpate.experiments.thesis_sensor import parts, sensor_of

Kind = Literal["part", "readings"]

FACTORS = (2.0, 5.0)  # by how much errors exceed their bounds, from and to
STAR_SIZES = (100.0, 200.0)  # as the bundled parts


def task(
    number: int,
    *,
    kind: Kind,
    position_error: float,
    normal_error_deg: float,
    until: tuple[float, float] | None = None,
) -> Row:
    """One loop whose conditions don't hold; `until` is that of `identify`, a length and degrees."""
    sensor = sensor_of(position_error=position_error, normal_error_deg=normal_error_deg)
    models = list(parts().values())
    truth = models[number % len(models)]
    said: dict[str, Any] = {}
    if kind == "readings":
        factor = float(np.random.default_rng([number, 3]).uniform(*FACTORS))
        problem = problem_of(number, models, truth, sensor=sensor, factor=factor)
        said["factor"] = factor
    elif (number // len(models)) % 2:
        problem = problem_of(number, models, _star(number), sensor=sensor)
    else:
        problem = problem_of(number, [one for one in models if one is not truth], truth, sensor=sensor)
    tight = None if until is None else (until[0], math.radians(until[1]))
    return {**row_of(problem, number, until=tight), **said}


def _star(number: int) -> Any:
    random = Random(number)
    while True:
        part = random_part(random, "star")
        if STAR_SIZES[0] <= part.size <= STAR_SIZES[1] and set(part.face_surfaces) == {"touchable"}:
            return part
