"""What a run of the loop is to do; everything that its outcome depends on beside the probe's answers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from palpate._core import Contact, Miss, Model, Prior, Sensor
from palpate.contacts.entry import mm_per
from palpate.loop.dimension import DIMENSIONS, Dimension, Search
from palpate.loop.route import Array, workspace_of
from palpate.loop.wander import as_swept, wandering
from palpate.planner_names import PLANNERS_OF

MAX_TOUCHES = 200
MAX_HYPOTHESES = 1000


@dataclass(frozen=True)
class Settings:
    """As `identify` takes them."""

    models: list[Model]
    sensor: Sensor
    workspace: Array
    prior: Prior | None
    contacts: list[Contact]
    misses: list[Miss]
    blind: int | None
    planner: str
    stop: Any
    directions: tuple[list[float], float] | None
    margin: float
    effort: int
    time_limit: float | None
    features: list[str] | None
    max_touches: int
    max_hypotheses: int
    until: tuple[float, float] | None
    seed: int
    unit: str

    @property
    def dimension(self) -> Dimension:
        """The plane, or space."""
        return DIMENSIONS[self.models[0].dimension]

    def search(self, contacts: Sequence[Contact]) -> Search:
        """Where first contacts are looked for, beside those that there are."""
        return Search(self.models, self.workspace, self.directions, self.sensor, self.prior, contacts)

    @property
    def moved(self) -> Sensor:
        """The sensor with a path error: if it states none, its position error."""
        return wandering(self.sensor)

    @property
    def known(self) -> list[Miss]:
        """What was swept freely before the first move: the border, and the misses that were given."""
        border = self.dimension.border(self.workspace, self.moved)
        return [*border, *(as_swept(miss, self.sensor) for miss in self.misses)]

    @property
    def judged(self) -> dict[str, Any]:
        """What a judge is to know."""
        return {"features": self.features, "margin": self.margin, "seed": self.seed}

    @property
    def placed(self) -> dict[str, Any]:
        """Where paths may run."""
        return {"workspace": self.workspace, "directions": self.directions}

    @property
    def searched(self) -> dict[str, Any]:
        """How a planner searches, but for how long."""
        return {"planner": self.planner, "stop": self.stop}


def settings_of(models: Any, sensor: Any, workspace: ArrayLike, **given: Any) -> Settings:
    """Checked; what the core checks is left to it.

    Raises:
        ValueError: Naming the argument.
    """
    listed = _all_of("models", models, Model)
    if not listed:
        raise ValueError("models: must not be empty (got []); give the parts that it may be")
    dimension = listed[0].dimension
    for model in listed:
        if model.dimension != dimension:
            raise ValueError(
                f"models: must be all of the plane or all of space (got {listed[0].name!r} of dimension "
                f"{dimension} and {model.name!r} of {model.dimension}); identify them apart"
            )
    prior, planner = given["prior"], given["planner"]
    if prior is not None and not isinstance(prior, Prior):
        raise ValueError(f"prior: must be a Prior (got {prior!r}); give palpate.Prior, or leave it out")
    if prior is not None and len(prior.world_from_model) != dimension + 1:
        raise ValueError(
            f"prior: must be of dimension {dimension} as the models are (got one of "
            f"{len(prior.world_from_model) - 1}); give a pose of shape {(dimension + 1, dimension + 1)}"
        )
    known = PLANNERS_OF[dimension]
    if planner not in known:
        where = "the plane" if dimension == 2 else "space"
        raise ValueError(f"planner: is none of {where} (got {planner!r}); give one of {', '.join(known)}")
    if not isinstance(sensor, Sensor):
        raise ValueError(f"sensor: must be a Sensor (got {sensor!r}); give palpate.Sensor")
    mm_per(given["unit"], "unit")
    given["contacts"] = _all_of("contacts", given["contacts"], Contact)
    given["misses"] = _all_of("misses", given["misses"], Miss)
    for name in ("max_touches", "max_hypotheses", "blind", "effort"):
        if name != "blind" or given[name] is not None:
            _check_whole(name, given[name], 1)
    _check_whole("seed", given["seed"], 0)
    given["time_limit"] = _time_limit(given["time_limit"])
    if isinstance(given["stop"], list):
        given["stop"] = tuple(given["stop"])
    _check_stop(given["stop"])
    _check_margin(given["margin"])
    given["until"] = _until(given["until"])
    given["directions"] = _directions(given["directions"], dimension)
    given["features"] = _features(given["features"], DIMENSIONS[dimension].kinds)
    return Settings(listed, sensor, workspace_of(workspace, dimension), **given)


def _all_of(name: str, members: Any, kind: Any) -> list[Any]:
    remedy = f"give a list of palpate.{kind.__name__}"
    if isinstance(members, str) or not isinstance(members, Sequence):
        raise ValueError(f"{name}: must be a sequence (got {members!r}); {remedy}")
    for k, member in enumerate(members):
        if not isinstance(member, kind):
            raise ValueError(f"{name}[{k}]: must be a {kind.__name__} (got {member!r}); {remedy}")
    return list(members)


def _check_whole(name: str, value: Any, least: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise ValueError(
            f"{name}: must be a whole number, {least} or more (got {value!r}); give an int in range"
        )


def _time_limit(value: Any) -> float | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < math.inf:
        raise ValueError(
            f"time_limit: must be above zero and finite (got {value!r}); give seconds, or leave it out"
        )
    return value


def _features(value: Any, known: tuple[str, ...]) -> list[str] | None:
    if value is None:
        return None
    kinds = [value] if isinstance(value, str) else list(value)
    if not kinds or not set(kinds) <= set(known):
        each = {2: '("face",), ("vertex",) or both', 3: '("face",), ("edge",), ("vertex",) or several'}
        raise ValueError(f"features: unknown kind (got {value!r}); give {each[len(known)]}")
    return kinds


def _until(value: Any) -> tuple[float, float] | None:
    if value is None:
        return None
    try:
        translation, rotation = (float(bound) for bound in value)
    except (TypeError, ValueError):
        translation = rotation = math.nan
    if not (translation > 0.0 and rotation > 0.0):
        raise ValueError(
            f"until: must be a length and an angle above zero (got {value!r}); give (translation, rotation)"
        )
    return translation, rotation


def _directions(value: Any, dimension: int) -> tuple[list[float], float] | None:
    if value is None:
        return None
    try:
        axis, half = np.array(value[0], dtype=float), float(value[1])
    except (TypeError, ValueError, IndexError):
        axis, half = np.array([]), math.nan
    good = axis.shape == (dimension,) and np.isfinite(axis).all() and axis.any() and 0.0 <= half <= math.pi
    if not good:
        raise ValueError(
            f"directions: must be a direction and a half angle from 0 to π (got {value!r}); "
            f"give {DIMENSIONS[dimension].directions}, the angle in radians"
        )
    # Of a length whose square is no number it would be no direction.
    extreme = not 1e-150 < np.abs(axis).max() < 1e150
    return (axis / np.abs(axis).max() if extreme else axis).tolist(), half


def _check_margin(value: Any) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 1e-6 <= value <= 0.1:
        raise ValueError(
            f"margin: must be a share of the part's size, 1e-6 to 0.1 (got {value!r}); give 1e-3, say"
        )


def _check_stop(value: Any) -> None:
    """As the core does, which is asked only when there is something to plan."""
    if value == "perfect":
        return
    kind, amount = value if isinstance(value, tuple) and len(value) == 2 else (None, None)
    whole = isinstance(amount, int) and not isinstance(amount, bool) and amount >= 1
    share = isinstance(amount, int | float) and not isinstance(amount, bool) and 0.0 < amount <= 1.0
    if not ((kind == "unique" and whole) or (kind == "share" and share)):
        raise ValueError(
            f"stop: must say when a path is good enough (got {value!r}); "
            'give "perfect", ("unique", 2) or ("share", 0.5)'
        )
