"""Design parameters for a set of models: stop rule, number of first contacts, bounds (thesis 6.1, point 5).

The loop runs on the same random problems with one parameter after the other changed. What a part costs is
the time to move, to touch and to compute; the last is measured here, all else is the same on every machine.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from palpate import Model, Sensor
from palpate.experiments import campaign
from palpate.experiments.build import build
from palpate.experiments.campaign import Row
from palpate.experiments.closed_loop import problem_of, row_of, scaled
from palpate.experiments.experiment import SEEDS
from palpate.model_json import document_of
from palpate.models import model_of
from palpate.probe.simulated import sensor_entry

Stop: TypeAlias = str | tuple[str, float]

STOPS: tuple[Stop, ...] = ("perfect", ("unique", 1), ("unique", 3), ("share", 0.5))
BLINDS = (None, 3, 4, 6, 8)
FACTORS = (0.25, 0.5, 1.0, 2.0)  # wider bounds than twice the sensor's own may take minutes a loop
MAX_TOUCHES = 50  # a part that needs more is not solved
MOST_DOUBLINGS = 2  # of the problems of the best two, where they are close
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

    def of(self, travel: float, touches: float) -> float:
        """Seconds."""
        return travel / self.speed + self.per_touch * touches


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
    out: Path,
    seed: int = 0,
    cluster: str | None = None,
) -> Advice:
    """Try all settings, and the best stop rule with the best number of first contacts.

    Of the best two, if they cost nearly the same for the spread of their problems, more problems are tried.

    Args:
        models: The parts that are to be told apart; each in turn is the true one.
        sensor: Bounds that the sensor has.
        costs: Of a machine.
        problems: Loops for each setting.
        out: Folder of the rows; those that are there are not computed again.
        seed: Chooses the problems.
        cluster: As for `campaign.run`.

    Raises:
        ValueError: As `campaign.run`.
        ConnectionError: As `campaign.run`.
    """
    given = {
        "models": [document_of(model, "mm") for model in models],  # lengths are as they are
        "sensor": sensor_entry(sensor),
    }
    digest = hashlib.sha256(json.dumps([build(), given, seed], sort_keys=True).encode()).hexdigest()[:12]

    def rows_of(name: str, numbers: range, task: Callable[..., Row], **more: Any) -> list[Row]:
        file = out / f"{digest}-{name}.jsonl"
        return campaign.run(
            f"tune-{name}", {**given, **more}, numbers, task, file, cluster=cluster, quiet=True
        )

    def more_of(setting: Setting, first: int, count: int) -> list[Row]:
        name = f"{setting.stop_text.replace(':', '-')}-{setting.blind_text}-{first}"
        told = {"stop": setting.stop, "blind": setting.blind}
        begin = seed * SEEDS + first
        return rows_of(name, range(begin, begin + count), more_task, **told)

    every = settings()
    begin = seed * SEEDS
    rows = rows_of("all", range(begin, begin + len(every) * problems), task)
    known = {setting: rows[k :: len(every)] for k, setting in enumerate(every)}

    def tried() -> dict[Setting, Tried]:
        return {setting: _tried(setting, members, costs) for setting, members in known.items()}

    own = [one for one in tried().values() if one.setting.factor == 1.0]
    stop = _best([one for one in own if one.setting.blind is None])
    blind = _best([one for one in own if one.setting.stop == "perfect"])
    both = Setting(stop=stop.setting.stop, blind=blind.setting.blind)
    if both not in known:
        known[both] = more_of(both, 0, problems)
    for _ in range(MOST_DOUBLINGS):
        own = [one for one in tried().values() if one.setting.factor == 1.0]
        best, second = _best_two(own)
        if second is None or not _close(known[best.setting], known[second.setting], costs):
            break
        for setting in (best.setting, second.setting):
            count = len(known[setting])
            known[setting] = [*known[setting], *more_of(setting, count, count)]
    made = tried()
    enough = [made[setting] for setting in every[: len(FACTORS)] if made[setting].solved >= SOLVED]
    best = _best([one for one in made.values() if one.setting.factor == 1.0])
    return Advice(list(made.values()), best, max(enough, key=lambda one: one.setting.factor, default=None))


def task(number: int, *, models: list[dict[str, Any]], sensor: dict[str, Any]) -> Row:
    """The loop on a problem with one of the settings: problem by problem, all of them."""
    seed, place = divmod(number, SEEDS)
    problem, which = divmod(place, len(settings()))
    return _loop(models, sensor, settings()[which], number=seed * SEEDS + problem)


def more_task(
    number: int, *, models: list[dict[str, Any]], sensor: dict[str, Any], stop: Any, blind: int | None
) -> Row:
    """The loop on a problem with another setting, or on more problems."""
    setting = Setting(stop=stop if isinstance(stop, str) else tuple(stop), blind=blind)
    return _loop(models, sensor, setting, number=number)


def _loop(documents: list[dict[str, Any]], sensor: dict[str, Any], setting: Setting, *, number: int) -> Row:
    models = [model_of(f"models[{k}]", document) for k, document in enumerate(documents)]
    felt = scaled(Sensor(**sensor), setting.factor)
    problem = problem_of(number, models, models[number % len(models)], sensor=felt)
    return row_of(problem, number, stop=setting.stop, blind=setting.blind, max_touches=MAX_TOUCHES)


def _seconds(row: Row, costs: Costs) -> float:
    return costs.of(row["travel"], row["touches"]) + float(row["seconds"]["loop"])


def _tried(setting: Setting, rows: Sequence[Row], costs: Costs) -> Tried:
    touches = np.array([row["touches"] for row in rows], dtype=float)
    return Tried(
        setting,
        len(rows),
        dict(Counter(row["status"] for row in rows)),
        lost=sum(row["lost"] for row in rows),
        touches=float(touches.mean()),
        touches_95=float(np.percentile(touches, 95)),
        travel=float(np.mean([row["travel"] for row in rows])),
        computing=float(np.mean([row["seconds"]["loop"] for row in rows])),
        seconds=float(np.mean([_seconds(row, costs) for row in rows])),
    )


def _best_two(tried: Sequence[Tried]) -> tuple[Tried, Tried | None]:
    """The best, and the best of those that go another way: whose loops are not all the same."""
    best = _best(tried)
    rest = [one for one in tried if (one.touches, one.travel) != (best.touches, best.travel)]
    return best, _best(rest) if rest else None


def _close(ones: Sequence[Row], others: Sequence[Row], costs: Costs) -> bool:
    """Whether the mean difference of what they cost on the same problems is within two standard errors."""
    gaps = np.array(
        [_seconds(a, costs) - _seconds(b, costs) for a, b in zip(ones, others, strict=False)], dtype=float
    )
    if len(gaps) < 2:
        return False
    return abs(float(gaps.mean())) <= 2.0 * float(gaps.std(ddof=1)) / math.sqrt(len(gaps))


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
        "loops": one.loops,
        "lost": one.lost,
        "touches": one.touches,
        "touches_95": one.touches_95,
        "travel": one.travel,
        "computing_seconds": one.computing,
        "part_seconds": one.seconds,
    }
