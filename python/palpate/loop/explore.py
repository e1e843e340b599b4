"""The first contacts in space: through the region in which the part is, then at what was touched."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Contact, Model, Prior
from palpate.loop.acquire import APART, Scan

Array: TypeAlias = NDArray[np.float64]
Directions: TypeAlias = tuple[ArrayLike, float] | None

NUM_DIRECTIONS = 96  # evenly spread over the sphere; those that are allowed are looked along
MOST_AIMED = 60  # lines at what was touched
UNDER = 0.02  # of the smallest width: so far under the surface a line at a contact aims
TIMES_ITS_BOUND = 3.0  # and at least so many position errors
AT_FIRST = 5  # lines at contacts, before every second one goes beside them
BELOW = 0.05  # of the size: so far under the contacts' middle lines beside them go
REPEATED = 2.0  # HEURISTIC: how much a line that resembles one before it is worth less
SHARPNESS = 8  # HEURISTIC: at which power of the cosine of their angle two directions resemble each other


def independent(contacts: Sequence[Contact]) -> bool:
    """Whether three normals leave no rotation free: two as in the plane, a third far from their plane."""
    sensed = [
        (c.normal, c.normal_error) for c in contacts if c.normal is not None and c.normal_error is not None
    ]
    for three in combinations(sensed, 3):
        (a, error_a), (b, error_b), (c, error_c) = three
        across = np.cross(a, b)
        sine = float(np.linalg.norm(across))
        if math.atan2(sine, abs(float(a @ b))) <= error_a + error_b + APART:
            continue
        if math.asin(min(1.0, abs(float(c @ across)) / sine)) > error_a + error_b + error_c + APART:
            return True
    return False


def smallest_width(models: Sequence[Model]) -> float:
    """How thin the thinnest model is: between planes along one of its faces, or square to an axis."""
    return min(float(_widths(model).min()) for model in models)


def _widths(model: Model) -> Array:
    """Across each face and each axis, shape `(n,)`; what is as good as flat counts as a share of its size."""
    normals = np.vstack([model.face_normals, np.eye(3)])
    along = model.vertices @ normals.T
    return np.asarray(np.maximum(np.ptp(along, axis=0), model.size / 16))


def region_of(models: Sequence[Model], workspace: Array, prior: Prior | None) -> Array:
    """Two opposite corners of where the part is: the workspace, or what of it a prior leaves.

    Returns:
        Shape `(2, 3)`, world frame; the workspace where the two have nothing in common.
    """
    if prior is None:
        return workspace
    turn, shift = prior.rotation + (prior.tilt or 0.0), max(prior.translation, prior.height or 0.0)
    pose = prior.world_from_model
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for model in models:
        placed = model.vertices @ pose[:3, :3].T + pose[:3, 3]
        farthest = float(np.linalg.norm(model.vertices, axis=1).max())
        reach = shift + 2.0 * math.sin(min(turn, math.pi) / 2.0) * farthest
        low, high = np.minimum(low, placed.min(axis=0) - reach), np.maximum(high, placed.max(axis=0) + reach)
    region = np.array([np.maximum(low, workspace[0]), np.minimum(high, workspace[1])])
    return region if (region[0] < region[1]).all() else workspace


class Explorations:
    """Guarded moves through the workspace that make contacts in space, one after the other.

    Where nothing was touched, they go through the middle of the region, then of its halves, quarters, ...,
    along its axes, as `Scans` do in the plane. From then on each goes through a place just under one that was
    touched: there the part is, so that it is touched again; and it goes where a new normal is to be expected,
    square to those that were met. After a few, every second one passes beside the contacts: faces that no
    such line meets, as sides of a part that is touched from above only, are sought as far as it may reach.
    """

    def __init__(
        self,
        workspace: Array,
        finest: float,
        directions: Directions,
        *,
        region: Array,
        contacts: Sequence[Contact],
        width: float,
        size: float,
        stem: ArrayLike | None = None,
    ) -> None:
        """Explorations of a workspace.

        Args:
            workspace: Two opposite corners, shape `(2, 3)`, world frame: all begin and end on its surface.
            finest: The last subdivision is the first whose `Scan.width` is no more than this.
            directions: A direction and an angle: only moves within the angle of it are made.
            region: As `region_of` gives it.
            contacts: What was touched; what is added to it later counts from then on.
            width: Of the thinnest part.
            size: Of the largest.
            stem: Where the probe's stem goes from the tip, shape `(3,)`.
        """
        self._workspace = workspace
        self._contacts = contacts
        self._under = UNDER * width
        self._width, self._size = width, size
        allowed = _allowed(directions)
        spread = [d for d in _spread(NUM_DIRECTIONS) if allowed(d)]
        axes = [side * axis for side in (1.0, -1.0) for axis in np.eye(3) if allowed(side * axis)]
        own = [] if directions is None else [_unit(np.array(directions[0], dtype=float))]
        along = None if stem is None else -_unit(np.array(stem, dtype=float))
        if along is not None and allowed(along):
            # A stem no thicker than the tip goes where the tip has been: it touches nothing first.
            axes, spread = [along], []
        self._ways = np.array([*axes, *spread] or own)
        self._missed = False
        self._ahead = self._through_region(region, axes or own, finest)
        self._next = next(self._ahead, None)
        self._aimed: list[tuple[int, Array]] = []

    def next(self, finest: float) -> Scan | None:
        """The next move; None if all are made that `finest` asks for, or as many as are sensible."""
        if self._contacts:
            return self._at_what_was_touched()
        return None if self._next is None or 2.0 * self._next.width <= finest else self._next

    def made(self, *, missed: bool) -> None:
        """The next move was made; whether it touched nothing."""
        if not self._aimed:
            self._missed = missed
            self._next = next(self._ahead, None)

    def _through_region(self, region: Array, ways: Sequence[Array], finest: float) -> Iterator[Scan]:
        """Lines along each way, on a grid square to it; what was passed freely is not passed backwards."""
        middle, width = region.mean(axis=0), float(np.ptp(region, axis=0).max())
        corners = np.array(list(np.ndindex(2, 2, 2)), dtype=float) * (region[1] - region[0]) + region[0]
        passed: list[tuple[Array, Array]] = []
        count = 1
        while width > finest:
            width /= 2.0
            for way in ways:
                first, second = _square_to(way)
                reach = [float(np.abs((corners - middle) @ across).max()) for across in (first, second)]
                for place in np.ndindex(count, count):
                    shares = [(2 * k + 1) / count - 1.0 for k in place]
                    through = middle + sum(
                        share * half * across
                        for share, half, across in zip(shares, reach, (first, second), strict=True)
                    )
                    ends = _ends(self._workspace, through, way)
                    if ends is None or any(_same_line((through, way), line) for line in passed):
                        continue
                    yield Scan(*ends, width)
                    if self._missed:
                        passed.append((through, way))
            count *= 2

    def _at_what_was_touched(self) -> Scan | None:
        """Under the contact, and in the direction, from which most is to be learnt."""
        if len(self._aimed) >= MOST_AIMED:
            return None
        if len(self._ways) == 1:
            return self._around()
        normals = np.array([_outward(contact) for contact in self._contacts])
        tries = len(self._aimed)
        beside = self._beside(normals, tries // 2) if tries >= AT_FIRST and tries % 2 else None
        if beside is not None:
            return beside
        # A face is met straight on along its normal: least of what is known already is met square to all.
        known = np.sum((self._ways @ normals.T) ** 2, axis=1) / len(normals)
        best: tuple[float, int, int] | None = None
        for number in range(len(self._contacts)):
            before = [way for k, way in self._aimed if k == number]
            elsewhere = [way for k, way in self._aimed if k != number]
            alike = _resemblance(self._ways, before) + 0.25 * _resemblance(self._ways, elsewhere)
            for k, worth in enumerate(known + REPEATED * alike + 0.05 * len(before)):
                if best is None or (float(worth), number, k) < best:
                    ends = self._aim(number, self._ways[k])
                    best = best if ends is None else (float(worth), number, k)
        if best is None:
            return None
        _, number, k = best
        ends = self._aim(number, self._ways[k])
        assert ends is not None
        self._aimed.append((number, self._ways[k]))
        return Scan(*ends, self._width)

    def _around(self) -> Scan | None:
        """Along the only way, about the contacts as far as the part may reach (Halton's sequence)."""
        (way,) = self._ways
        middle = np.mean([contact.center for contact in self._contacts], axis=0)
        across = np.array(_square_to(way))
        while len(self._aimed) < MOST_AIMED:
            number = len(self._aimed) + 1
            self._aimed.append((-1, way))
            shares = np.array([_mirrored(number, 2), _mirrored(number, 3)]) - 0.5
            ends = _ends(self._workspace, middle + self._size * (shares @ across), way)
            if ends is not None:
                return Scan(*ends, self._width)
        return None

    def _beside(self, normals: Array, number: int) -> Scan | None:
        """Towards the middle of the contacts from where least is known of, on either side in turn.

        Shares of the size as in the van der Corput sequence: halves, quarters, eighths, ...
        """
        seldom, side = np.linalg.svd(normals)[2][-1], 1.0 if number % 2 else -1.0
        share = _mirrored(number // 2 + 1, 2)
        middle = np.mean([contact.center for contact in self._contacts], axis=0)
        place = middle + side * share * self._size * seldom - BELOW * self._size * normals.mean(axis=0)
        way = self._ways[int(np.argmax(self._ways @ (-side * seldom)))]
        ends = _ends(self._workspace, place, way)
        if ends is None:
            return None
        self._aimed.append((-1, way))
        return Scan(*ends, self._width)

    def _aim(self, number: int, way: Array) -> tuple[Array, Array] | None:
        """Through the place under a contact; None if that is not within the workspace."""
        contact = self._contacts[number]
        under = contact.tip_radius + max(self._under, TIMES_ITS_BOUND * contact.position_error)
        return _ends(self._workspace, contact.center - under * _outward(contact), way)


def _mirrored(number: int, base: int) -> float:
    """Its digits mirrored at the point: a member of the van der Corput sequence."""
    share, digit = 0.0, 1.0
    while number:
        digit /= base
        share += digit * (number % base)
        number //= base
    return share


def _outward(contact: Contact) -> Array:
    """The normal, or else the way back."""
    if contact.normal is not None:
        return contact.normal
    return np.zeros(3) if contact.approach is None else -contact.approach


def _resemblance(ways: Array, others: Sequence[Array]) -> Array:
    """How much each of the ways resembles the others, summed; backwards counts a half."""
    if not others:
        return np.zeros(len(ways))
    cosines = ways @ np.array(others).T
    return np.asarray(np.sum(np.where(cosines > 0.0, 1.0, 0.5) * np.abs(cosines) ** SHARPNESS, axis=1))


def _ends(workspace: Array, through: Array, way: Array) -> tuple[Array, Array] | None:
    """Where a line enters and leaves the workspace; None if it does not pass through it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = (workspace - through) / way
    along = np.abs(way) > 1e-12
    inside = (through >= workspace[0]) & (through <= workspace[1])
    if not inside[~along].all() or not along.any():
        return None
    enter = float(sides.min(axis=0)[along].max())
    leave = float(sides.max(axis=0)[along].min())
    if not enter < leave:
        return None
    low, high = workspace
    return np.clip(through + enter * way, low, high), np.clip(through + leave * way, low, high)


def way_within(workspace: Array, start: Array, direction: Array) -> float:
    """How far a line from its border goes within the workspace."""
    ends = _ends(workspace, start, direction)
    return 0.0 if ends is None else float((ends[1] - start) @ direction)


def _same_line(line: tuple[Array, Array], other: tuple[Array, Array]) -> bool:
    """Whether two lines, each a place and a way, are one, traveled backwards."""
    (through, way), (place, back) = line, other
    apart = through - place
    return bool(way @ back < -1.0 + 1e-12 and np.linalg.norm(apart - (apart @ way) * way) < 1e-9)


def _square_to(way: Array) -> tuple[Array, Array]:
    """Two unit vectors square to a unit one and to each other; along axes if it is along one."""
    least = np.eye(3)[np.argmin(np.abs(way))]
    first = _unit(np.cross(way, least))
    return first, np.cross(way, first)


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def _allowed(directions: Directions) -> Callable[[Array], bool]:
    if directions is None:
        return lambda way: True
    axis, half = _unit(np.array(directions[0], dtype=float)), directions[1]
    return lambda way: math.atan2(float(np.linalg.norm(np.cross(axis, way))), float(axis @ way)) <= half


def _spread(count: int) -> Array:
    """Directions evenly over the sphere (a Fibonacci lattice), shape `(count, 3)`."""
    k = np.arange(count)
    height = 1.0 - 2.0 * (k + 0.5) / count
    around = math.pi * (3.0 - math.sqrt(5.0)) * k
    across = np.sqrt(1.0 - height * height)
    return np.column_stack([across * np.cos(around), across * np.sin(around), height])
