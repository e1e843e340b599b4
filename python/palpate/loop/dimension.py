"""What the loop asks of the plane and of space: all else of it is the same in both."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Contact, Miss, Model, Prior, Sensor
from palpate.loop import acquire, explore
from palpate.loop.acquire import FINER, Scan, Scans
from palpate.loop.explore import Explorations, region_of
from palpate.loop.route import on_border, perimeter_route
from palpate.loop.surface import open_sides, sides_of, surface_route

Array: TypeAlias = NDArray[np.float64]
Directions: TypeAlias = tuple[ArrayLike, float] | None


class Acquisition(Protocol):
    """Guarded moves that make the first contacts, one after the other."""

    def next(self, finest: float) -> Scan | None:
        """The next one; None if all are made that `finest` asks for."""
        ...

    def made(self, *, missed: bool) -> None:
        """The next one was made; whether it touched nothing."""
        ...


@dataclass(frozen=True)
class Search:
    """Where first contacts are looked for, and what for."""

    models: Sequence[Model]
    workspace: Array
    directions: Directions
    sensor: Sensor
    prior: Prior | None
    contacts: Sequence[Contact]
    """As they are at any time."""


@dataclass(frozen=True)
class Dimension:
    """The plane, or space."""

    kinds: tuple[str, ...]
    """Kinds of features."""
    directions: str
    """How to give them."""
    without_normals: int
    """Contacts that are acquired of a probe that reads no normals: one more than a pose has unknowns."""
    with_balls: int
    """Contacts that are acquired at least with a tip that has a radius."""
    independent: Callable[[Sequence[Contact]], bool]
    """Whether normals are as far from parallel as two are to be (4.1); in space three, from one plane."""
    smallest_width: Callable[[Sequence[Model]], float]
    """Of the thinnest model."""
    acquisition: Callable[[Search, float], Acquisition]
    """First contacts, as blindly as down to a width."""
    border: Callable[[Array, Sensor], list[Miss]]
    """What of the workspace's border is evidence; the sensor has a path error."""
    is_open: Callable[[Array, Array, Directions], bool]
    """Whether the tip may rest at a place between guarded moves: on the border of the workspace."""
    route: Callable[[Array, Array, Array, Directions], list[Array]]
    """From one such place to another."""
    ends_within: Callable[[Array, Array, Array], float] | None
    """How far the tip may go from a place along a direction, if paths are to end in the workspace."""
    recognizes_ways: bool
    """Whether recognition is asked of what the loop's own moves swept."""
    explores: int
    """More moves at most as for first contacts, where no path is promising or many hypotheses are left."""
    many: float
    """Hypotheses above which one more such move comes before a search, so long as it leaves fewer."""


def _perimeter(workspace: Array, sensor: Sensor) -> list[Miss]:
    """The perimeter of the workspace, which is assumed to be unoccupied (4.1).

    However far the tip may leave it, the part is within the workspace.
    """
    (x0, y0), (x1, y1) = workspace
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    radius = sensor.tip_radius
    tip = {"tip_radius": radius, "path_error": min(sensor.path_error, radius)}
    return [Miss(a, b, **tip) for a, b in pairwise(corners)]


def _explorations(search: Search, finest: float) -> Acquisition:
    return Explorations(
        search.workspace,
        finest,
        search.directions,
        region=region_of(search.models, search.workspace, search.prior),
        contacts=search.contacts,
        width=explore.smallest_width(search.models),
        size=max(model.size for model in search.models),
        stem=None if search.sensor.stem is None else search.sensor.stem[0],
    )


def _is_on_open_side(workspace: Array, point: Array, directions: Directions) -> bool:
    return not set(open_sides(directions)).isdisjoint(sides_of(workspace, point))


PLANE = Dimension(
    kinds=("face", "vertex"),
    directions="((dx, dy), half_angle)",
    without_normals=4,
    with_balls=0,
    independent=acquire.independent,
    smallest_width=acquire.smallest_width,
    acquisition=lambda search, finest: Scans(search.workspace, finest, search.directions),
    border=_perimeter,
    is_open=lambda workspace, point, directions: on_border(workspace, point),
    route=lambda workspace, start, end, directions: perimeter_route(workspace, start, end),
    ends_within=None,
    recognizes_ways=True,
    explores=0,
    many=math.inf,
)

# The surface of a box is no line that a tip could have swept: it is free for the tip, and no evidence.
SPACE = Dimension(
    kinds=("face", "edge", "vertex"),
    directions="((dx, dy, dz), half_angle)",
    without_normals=7,
    # A ball may rest on any edge: three contacts leave hundreds of hypotheses, slower than two moves.
    with_balls=5,
    independent=explore.independent,
    smallest_width=explore.smallest_width,
    acquisition=_explorations,
    border=lambda workspace, sensor: [],
    is_open=_is_on_open_side,
    route=lambda workspace, start, end, directions: surface_route(
        workspace, start, end, sides=open_sides(directions)
    ),
    ends_within=explore.way_within,
    recognizes_ways=False,
    explores=12,
    many=24,
)

DIMENSIONS = {2: PLANE, 3: SPACE}
"""By number."""

__all__ = ["DIMENSIONS", "FINER", "Acquisition", "Array", "Dimension", "Directions", "Search"]
