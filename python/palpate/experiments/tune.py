"""Design parameters for a set of models: stop rule, number of first contacts, bounds (thesis 6.1, point 5).

The loop runs on the same random problems with one parameter after the other changed. What a part costs is
the time to move, to touch and to compute; the last is measured here, all else is the same on every machine.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from palpate import Model, Sensor
from palpate.experiments.campaign import Row
from palpate.experiments.closed_loop import problem_of, row_of, scaled
from palpate.experiments.experiment import SEEDS

Stop: TypeAlias = str | tuple[str, float]

STOPS: tuple[Stop, ...] = ("perfect", ("unique", 1), ("unique", 3), ("share", 0.5))
BLINDS = (None, 3, 4, 6, 8)
FACTORS = (0.25, 0.5, 1.0, 2.0)  # wider bounds than twice the sensor's own may take minutes a loop
MAX_TOUCHES = 50  # a part that needs more is not solved
SOLVED = 0.95  # of the loops: bounds are good enough
HARDLY = 0.01  # of the cost or of the loops: no reason to choose another setting


@dataclass(frozen=True)
class Setting:
    """What is tried; the defaults are those of `identify`."""

    stop: Stop = "perfect"
    blind: int | None = None
    factor: float = 1.0

    @property
    def stop_text(self) -> str:
        """As `--stop` takes it."""
        return self.stop if isinstance(self.stop, str) else f"{self.stop[0]}:{self.stop[1]:g}"

    @property
    def blind_text(self) -> str:
        """As `--blind` takes it."""
        return "auto" if self.blind is None else str(self.blind)


@dataclass(frozen=True)
class Costs:
    """What moving and touching take: lengths per second, seconds for each guarded move."""

    speed: float
    per_touch: float


@dataclass(frozen=True)
class Tried:
    """A setting, and how its loops ended."""

    setting: Setting
    loops: int
    status: dict[str, int]
    lost: int
    touches: float
    touches_95: float
    travel: float
    computing: float
    seconds: float

    @property
    def solved(self) -> float:
        """Share of the loops."""
        return self.status.get("solved", 0) / self.loops


@dataclass(frozen=True)
class Advice:
    """What was tried, and what is best of it."""

    tried: list[Tried]
    best: Tried
    widest: Tried | None
    """With the widest bounds at which enough loops are solved; None if none are."""


def settings() -> list[Setting]:
    """Bounds, stop rules and first contacts, one after the other."""
    bounds = [Setting(factor=factor) for factor in FACTORS]
    stops = [Setting(stop=stop) for stop in STOPS[1:]]
    return [*bounds, *stops, *(Setting(blind=blind) for blind in BLINDS[1:])]


def tune(
    models: Sequence[Model],
    sensor: Sensor,
    costs: Costs,
    *,
    problems: int,
    seed: int = 0,
    advance: Callable[[], None] = lambda: None,
) -> Advice:
    """Try all settings, and the best stop rule with the best number of first contacts.

    Args:
        models: The parts that are to be told apart; each in turn is the true one.
        sensor: Bounds that the sensor has.
        costs: Of a machine.
        problems: Loops for each setting.
        seed: Chooses the problems.
        advance: Is called after each loop; there are `num_loops(problems)`, or as many less as `problems`.
    """

    def trial(setting: Setting) -> Tried:
        rows = []
        for number in range(problems):
            rows.append(_loop(models, sensor, setting, number=seed * SEEDS + number))
            advance()
        return _tried(setting, rows, costs)

    tried = [trial(setting) for setting in settings()]
    stop = _best([one for one in tried if one.setting.factor == 1.0 and one.setting.blind is None])
    blind = _best([one for one in tried if one.setting.factor == 1.0 and one.setting.stop == "perfect"])
    both = Setting(stop=stop.setting.stop, blind=blind.setting.blind)
    if both not in [one.setting for one in tried]:
        tried.append(trial(both))
    enough = [one for one in tried[: len(FACTORS)] if one.solved >= SOLVED]
    best = _best([one for one in tried if one.setting.factor == 1.0])
    return Advice(tried, best, max(enough, key=lambda one: one.setting.factor, default=None))


def num_loops(problems: int) -> int:
    """How many loops are run for so many problems, at most."""
    return problems * (len(settings()) + 1)


def _loop(models: Sequence[Model], sensor: Sensor, setting: Setting, *, number: int) -> Row:
    felt = scaled(sensor, setting.factor)
    problem = problem_of(number, models, models[number % len(models)], sensor=felt)
    return row_of(problem, number, stop=setting.stop, blind=setting.blind, max_touches=MAX_TOUCHES)


def _tried(setting: Setting, rows: Sequence[Row], costs: Costs) -> Tried:
    touches = np.array([row["touches"] for row in rows], dtype=float)
    travel = float(np.mean([row["travel"] for row in rows]))
    computing = float(np.mean([row["seconds"]["loop"] for row in rows]))
    return Tried(
        setting,
        len(rows),
        dict(Counter(row["status"] for row in rows)),
        lost=sum(row["wrong"] for row in rows),
        touches=float(touches.mean()),
        touches_95=float(np.percentile(touches, 95)),
        travel=travel,
        computing=computing,
        seconds=travel / costs.speed + costs.per_touch * float(touches.mean()) + computing,
    )


def _best(tried: Sequence[Tried]) -> Tried:
    """The cheapest of those that solve nearly as many as any; of nearly equal ones the first."""
    most = max(one.solved for one in tried)
    good = [one for one in tried if one.solved >= most - HARDLY]
    least = min(one.seconds for one in good)
    return next(one for one in good if one.seconds <= (1.0 + HARDLY) * least)


def document(
    advice: Advice, models: Sequence[Model], sensor: Sensor, *, unit: str, seed: int
) -> dict[str, Any]:
    """The `palpate-tune` document."""
    return {
        "schema": "palpate-tune",
        "version": 1,
        "unit": unit,
        "models": [model.name for model in models],
        "seed": seed,
        "loops": advice.tried[0].loops,
        "tried": [_entry(one, sensor) for one in advice.tried],
        "recommended": _entry(advice.best, sensor),
        "widest_bounds": None if advice.widest is None else _entry(advice.widest, sensor),
    }


def _entry(one: Tried, sensor: Sensor) -> dict[str, Any]:
    felt = scaled(sensor, one.setting.factor)
    return {
        "stop": one.setting.stop_text,
        "blind": one.setting.blind,
        "position_error": felt.position_error,
        "normal_error_deg": None if felt.normal_error is None else float(np.degrees(felt.normal_error)),
        "status": one.status,
        "lost": one.lost,
        "touches": one.touches,
        "touches_95": one.touches_95,
        "travel": one.travel,
        "computing_seconds": one.computing,
        "part_seconds": one.seconds,
    }
