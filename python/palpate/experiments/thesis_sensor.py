"""Bounds and planners of the thesis's simulations (4.2)."""

from __future__ import annotations

import math
from functools import cache
from typing import Any, Literal, TypeAlias

from palpate import Model, Sensor, bundled_parts
from palpate.usual import MAX_INCIDENCE_DEG

SENSOR = {"position_error": 0.5, "normal_error_deg": 4.0, "max_incidence_deg": 89.0}
Planner: TypeAlias = Literal["auto", "ellis"]
PLANNERS: tuple[Planner, ...] = ("auto", "ellis")
TOLD = tuple(f"`{planner}`" for planner in PLANNERS)
DRAWN_ANEW = (
    "The parts are drawn anew: the thesis's outlines are not available, only their names, their numbers "
    "of faces and the number of interpretations at its standard points. Whatever depends on the outlines "
    "differs."
)
COMPARED = (
    "*Thesis* is what it prints, CPU seconds of a VAX 11/750 with recognition in LISP and planning in C. "
    "`auto` is the planner that is used if none is named, `ellis` the thesis's own search, both judged "
    "by the same judge over all poses of each hypothesis; their times are CPU seconds too."
)


def sensor_of(
    *, position_error: float, normal_error_deg: float, max_incidence_deg: float = MAX_INCIDENCE_DEG
) -> Sensor:
    """A sensor of points and normals, whose angles are in degrees; a point for a tip."""
    return Sensor(position_error, math.radians(normal_error_deg), math.radians(max_incidence_deg))


@cache
def parts() -> dict[str, Model]:
    """The bundled parts by name."""
    return {model.name: model for model in bundled_parts()}


def sensor_words(settings: dict[str, Any]) -> str:
    """The bounds in words."""
    return (
        f"±{settings['position_error']:g} mm, ±{settings['normal_error_deg']:g}°, "
        f"Ω {settings['max_incidence_deg']:g}°"
    )
