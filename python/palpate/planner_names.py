"""The core's planners, by the names that it knows them by."""

from __future__ import annotations

from typing import Literal, TypeAlias

Planner: TypeAlias = Literal[
    "auto", "complete", "ellis", "grimson", "schneiter", "optimized", "linearized", "decoupled"
]

PLANNERS_OF: dict[int, tuple[Planner, ...]] = {
    2: ("auto", "complete", "ellis", "grimson", "schneiter"),
    3: ("auto", "grimson", "schneiter", "optimized", "linearized", "decoupled"),
}
"""By dimension."""

PLANNERS: tuple[Planner, ...] = tuple(dict.fromkeys(name for names in PLANNERS_OF.values() for name in names))
