"""Random parts: stars, combs with many parallel faces, with holes, symmetric, loose faces, bundled."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from random import Random

from palpate import Model, bundled_parts

Point = tuple[float, float]

#: Shares of the families among the problems.
FAMILIES = {"star": 30, "comb": 20, "holes": 15, "bundled": 25, "symmetric": 6, "loose": 4}


@cache
def bundled() -> tuple[Model, ...]:
    """The parts that come with palpate."""
    return tuple(bundled_parts())


def log_uniform(random: Random, low: float, high: float) -> float:
    """A number whose logarithm is spread evenly."""
    return low * (high / low) ** random.random()


def random_part(random: Random, family: str) -> Model:
    """A part of a family of `FAMILIES`, some 100 to 200 across; few are in another unit, or have slacks."""
    if family == "bundled":
        return random.choice(bundled())
    make: Callable[[Random], tuple[list[Point], list[list[Point]]]] = {
        "star": star_part,
        "comb": comb,
        "holes": with_holes,
        "symmetric": symmetric,
        "loose": star_part,
    }[family]
    scale = random.choice((1e-3, 1.0 / 25.4, 1e3)) if random.random() < 0.1 else 1.0
    origin = (random.uniform(-80.0, 80.0), random.uniform(-80.0, 80.0))
    slacks = (0.0, 0.0)
    if random.random() < 0.1:
        slacks = (scale * random.uniform(0.0, 0.5), random.uniform(0.0, 0.05))
    while True:
        outline, holes = make(random)
        loops = [
            [(scale * (x + origin[0]), scale * (y + origin[1])) for x, y in loop]
            for loop in (outline, *holes)
        ]
        count = sum(map(len, loops))
        untouchable = random.sample(range(count), random.randint(1, 2)) if random.random() < 0.1 else []
        try:
            if family == "loose":
                part = _loose(random, loops[0], slacks)
                if "touchable" in part.face_surfaces:
                    return part
                continue
            return Model.polygon(
                loops[0],
                name=family,
                holes=loops[1:],
                untouchable=untouchable,
                position_slack=slacks[0],
                normal_slack=slacks[1],
            )
        except ValueError:
            continue  # it crosses itself, or a hole is outside: another one


def _star(random: Random, count: int, radii: tuple[float, float]) -> list[Point]:
    corners = []
    for k in range(count):
        angle = 2.0 * math.pi * (k + 0.6 * random.random()) / count
        radius = random.uniform(*radii)
        corners.append((radius * math.cos(angle), radius * math.sin(angle)))
    return corners


def star_part(random: Random) -> tuple[list[Point], list[list[Point]]]:
    """A star, and no holes."""
    return _star(random, random.randint(3, 14), (25.0, 80.0)), []


def comb(random: Random) -> tuple[list[Point], list[list[Point]]]:
    """Teeth upward on a bar; in one of three every corner is a little off, and nothing quite parallel."""
    teeth = random.randint(1, 6)
    pitch, height = random.uniform(8.0, 20.0), random.uniform(10.0, 40.0)
    corners = [(0.0, 0.0), (pitch * teeth, 0.0)]
    for tooth in reversed(range(teeth)):
        left, right = pitch * tooth, pitch * (tooth + 0.5)
        corners += [(right + 0.5 * pitch, 20.0), (right, 20.0), (right, 20.0 + height), (left, 20.0 + height)]
    # The first tooth stands flush with the bar's left end.
    if random.random() < 1.0 / 3.0:
        off = log_uniform(random, 1e-3, 0.5)
        corners = [(x + random.uniform(-off, off), y + random.uniform(-off, off)) for x, y in corners]
    return corners, []


def with_holes(random: Random) -> tuple[list[Point], list[list[Point]]]:
    """A star with one or two holes."""
    outline = _star(random, random.randint(5, 10), (50.0, 80.0))
    holes = []
    for side in random.sample((-1.0, 1.0), random.randint(1, 2)):
        hole = _star(random, random.randint(3, 5), (5.0, 14.0))
        holes.append([(x + 17.0 * side, y + random.uniform(-5.0, 5.0)) for x, y in hole])
    return outline, holes


def symmetric(random: Random) -> tuple[list[Point], list[list[Point]]]:
    """The same sector, several times around."""
    order = random.choice((2, 2, 3, 4, 5, 6, 8, 12))
    fewest = 2 if order < 3 else 1
    sector = [
        (random.uniform(0.0, 0.9) + k, random.uniform(40.0, 80.0)) for k in range(random.randint(fewest, 3))
    ]
    step = 2.0 * math.pi / order
    return [
        (r * math.cos(step * (t + at / len(sector))), r * math.sin(step * (t + at / len(sector))))
        for t in range(order)
        for at, r in sector
    ], []


def _loose(random: Random, corners: list[Point], slacks: tuple[float, float]) -> Model:
    """Most faces of an outline; some of them seams, some untouchable."""
    faces = [(corner, corners[(k + 1) % len(corners)]) for k, corner in enumerate(corners)]
    left = [face for face in faces if random.random() < 0.85]
    numbers = [random.random() for _ in left]
    seams = [k for k, number in enumerate(numbers) if number < 0.1]
    untouchable = [k for k, number in enumerate(numbers) if number > 0.9]
    return Model.segments(
        left,
        name="loose",
        seams=seams,
        untouchable=untouchable,
        position_slack=slacks[0],
        normal_slack=slacks[1],
    )
