"""Solids made by code: four that are drawn, and random ones by families, for tests, campaigns and pages.

All are closed, and their triangles run counter-clockwise from outside. Most are some 50 to 200 across.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

import numpy as np
from numpy.typing import NDArray

from palpate._core import Contact, Model
from palpate.contacts import contacts_document
from palpate.curves import Array
from palpate.experiments import random_parts
from palpate.model_json import document_of, text_of
from palpate.solids.faces import face_places
from palpate.solids.mesh import Body, Numbers, SolidMesh, half_edges, pieces_of
from palpate.solids.polygons import with_holes
from palpate.usual import NORMAL_ERROR_DEG, POSITION_ERROR

# From the lower to the upper corner.
Box = tuple[Sequence[float], Sequence[float]]
Mask = NDArray[np.bool_]
Loop = Sequence[tuple[float, float]] | Array

#: Shares of the families among the problems.
FAMILIES = {"boxes": 30, "prism": 25, "pocketed": 20, "hull": 15, "plate": 10}


# --- solids that are drawn ------------------------------------------------------------------------


def bracket() -> SolidMesh:
    """An angle of two plates with a rib between them and a slot in its foot: 16 faces, without symmetry."""
    return _of_boxes(
        "bracket",
        [((0, 0, 0), (120, 80, 12)), ((0, 0, 12), (12, 80, 90)), ((12, 50, 12), (52, 60, 52))],
        less=[((70, 20, 0), (100, 36, 12))],
    )


def hexagon() -> SolidMesh:
    """A hexagonal prism with a hexagonal pocket in its top, turned by 15°: six symmetries."""
    return prism("hexagon", _ring(6, 60.0), height=50.0, pockets=[(_ring(6, 30.0, turned=15.0), 30.0)])


def rib_plate() -> SolidMesh:
    """A plate with three ribs across it and one along, unevenly spaced."""
    ribs = [((x, 0, 10), (x + 8, 90, 10 + height)) for x, height in ((20, 30), (70, 30), (130, 18))]
    along = ((0, 40, 10), (150, 46, 25))
    return _of_boxes("rib-plate", [((0, 0, 0), (150, 90, 10)), *ribs, along])


def flange() -> SolidMesh:
    """A plate with 24 sides, a square bore and five of six holes around it."""
    holes = [
        _ring(8, 8.0, center=(58.0 * math.cos(k * math.pi / 3), 58.0 * math.sin(k * math.pi / 3)))
        for k in range(5)
    ]
    return prism("flange", _ring(24, 80.0), height=16.0, holes=[_ring(4, 28.0), *holes])


DRAWN: dict[str, Callable[[], SolidMesh]] = {
    "bracket": bracket,
    "hexagon": hexagon,
    "rib-plate": rib_plate,
    "flange": flange,
}


# --- those that come with palpate -----------------------------------------------------------------

# Which are bundled, by the names they then have, and on which faces their contacts lie.
BUNDLED = {
    "l-bracket": (bracket, (3, 4, 9, 14)),
    "rib-plate": (rib_plate, (2, 13, 22, 32)),
    "hexagon": (hexagon, (0, 2, 9, 14)),
    "flange": (flange, (0, 41, 63, 68)),
}


def bundled_files(name: str) -> tuple[str, str]:
    """A bundled solid and its contacts, as their files have them."""
    make, touched = BUNDLED[name]
    solid = make()
    model = Model.mesh(solid.vertices, solid.triangles, name=name)
    note = "Drawn by the project, in experiments/solid_shapes.py."
    places = face_places(model)
    bounds = {"position_error": POSITION_ERROR, "normal_error": math.radians(NORMAL_ERROR_DEG)}
    contacts = [Contact(places[face], model.face_normals[face], **bounds) for face in touched]
    texts = ({**document_of(model, "mm"), "note": note}, contacts_document(contacts, unit="mm"))
    return text_of(texts[0]), text_of(texts[1])


# --- random solids --------------------------------------------------------------------------------


def random_solid(random: Random, family: str) -> SolidMesh:
    """A solid of a family of `FAMILIES`, somewhere about the origin."""
    make = {
        "boxes": _random_boxes,
        "prism": _random_prism,
        "pocketed": _random_pocketed,
        "hull": _random_hull,
        "plate": _random_plate,
    }[family]
    while True:
        made = make(random)
        if made is not None:
            shift = np.array([random.uniform(-80.0, 80.0) for _ in range(3)])
            return SolidMesh(family, made.vertices + shift, made.triangles)


def _random_boxes(random: Random) -> SolidMesh | None:
    """Boxes that overlap, on a grid of 5 mm; None if some touch in an edge or a corner only."""
    boxes: list[Box] = []
    for _ in range(random.randint(2, 6)):
        # Each begins within the last one, so that all hang together.
        low, high = boxes[-1] if boxes else ([0.0] * 3, [5.0] * 3)
        begin = [5.0 * random.randrange(int(a / 5.0), int(b / 5.0)) for a, b in zip(low, high, strict=True)]
        boxes.append((begin, [at + 5.0 * random.randint(2, 16) for at in begin]))
    return _usable(_of_boxes("boxes", boxes))


def _random_pocketed(random: Random) -> SolidMesh | None:
    """A box with pockets in its top and ribs on it."""
    width, depth, height = (float(random.randint(*span)) for span in ((90, 160), (60, 110), (25, 60)))

    def footprint() -> tuple[float, float, float, float]:
        x, y = random.uniform(5.0, width - 35.0), random.uniform(5.0, depth - 30.0)
        return x, y, random.uniform(x + 8.0, width - 5.0), random.uniform(y + 6.0, depth - 5.0)

    more: list[Box] = [((0.0, 0.0, 0.0), (width, depth, height))]
    less: list[Box] = []
    for _ in range(random.randint(1, 3)):
        x, y, u, v = footprint()
        # A share goes through.
        bottom = 0.0 if random.random() < 0.2 else random.uniform(0.2, 0.8) * height
        less.append(((x, y, bottom), (u, v, height)))
    for _ in range(random.randint(0, 2)):
        x, y, u, v = footprint()
        more.append(((x, y, height), (u, min(v, y + 10.0), height + random.uniform(5.0, 40.0))))
    return _usable(_of_boxes("pocketed", more, less=less))


def _random_prism(random: Random) -> SolidMesh | None:
    return _extruded(random, random.uniform(20.0, 120.0))


def _random_plate(random: Random) -> SolidMesh | None:
    return _extruded(random, random.uniform(0.5, 4.0))


def _extruded(random: Random, height: float) -> SolidMesh | None:
    outline, holes = random.choice(
        (random_parts.star_part, random_parts.comb, random_parts.with_holes, random_parts.symmetric)
    )(random)
    try:
        checked = Model.polygon(outline, holes=holes)
    except ValueError:
        return None  # it crosses itself, or a hole is outside
    loops: list[list[tuple[float, float]]] = [[]]
    for start, end in checked.faces:
        loops[-1].append((float(start[0]), float(start[1])))
        if tuple(end) == loops[-1][0]:
            loops.append([])
    return prism("prism", loops[0], height=height, holes=loops[1:-1])


def _random_hull(random: Random) -> SolidMesh | None:
    from scipy.spatial import ConvexHull

    axes = [random.uniform(30.0, 90.0) for _ in range(3)]
    points = np.array(
        [[axis * random.gauss(0.0, 1.0) for axis in axes] for _ in range(random.randint(4, 40))]
    )
    # On an ellipsoid, most of them are corners.
    points *= (1.0 / np.linalg.norm(points / np.array(axes), axis=1))[:, None]
    hull = ConvexHull(points)
    corners = points[hull.simplices]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(across * hull.equations[:, :3], axis=1) < 0.0
    triangles = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices).astype(np.int64)
    used, numbers = np.unique(triangles, return_inverse=True)
    return SolidMesh("hull", points[used], numbers.reshape(-1, 3))


# --- how they are made ----------------------------------------------------------------------------


def prism(
    name: str,
    outline: Loop,
    *,
    height: float,
    holes: Sequence[Loop] = (),
    pockets: Sequence[tuple[Loop, float]] = (),
) -> SolidMesh:
    """What stands on `z = 0` on an outline, to `height`.

    Args:
        name: Of the solid.
        outline: Simple, counter-clockwise, without its first point repeated.
        height: Above zero.
        holes: Through all of it, clockwise or not; inside the outline and apart from each other.
        pockets: Likewise, each with its depth below the top.
    """
    outer = _turned(outline, 1.0)
    through = [_turned(hole, -1.0) for hole in holes]
    blind = [(_turned(loop, -1.0), height - depth) for loop, depth in pockets]
    vertices: list[Array] = []
    triangles: list[Numbers] = []

    def put(loop: Array, z: float) -> Numbers:
        first = sum(map(len, vertices))
        vertices.append(np.column_stack([loop, np.full(len(loop), z)]))
        return np.arange(first, first + len(loop))

    def wall(low: Numbers, high: Numbers) -> None:
        after_low, after_high = np.roll(low, -1), np.roll(high, -1)
        triangles.append(np.stack([low, after_low, after_high], axis=1))
        triangles.append(np.stack([low, after_high, high], axis=1))

    bottom = [put(loop, 0.0) for loop in (outer, *through)]
    top = [put(loop, height) for loop in (outer, *through)]
    for low, high in zip(bottom, top, strict=True):
        wall(low, high)
    flat_bottom = with_holes([outer, *through])
    triangles.append(np.concatenate(bottom)[flat_bottom][:, ::-1])
    for loop, floor in blind:
        low, high = put(loop, floor), put(loop, height)
        wall(low, high)
        top.append(high)
        triangles.append(low[::-1][with_holes([loop[::-1]])])
    triangles.append(np.concatenate(top)[with_holes([outer, *through, *(loop for loop, _ in blind)])])
    return SolidMesh(name, np.concatenate(vertices), np.concatenate(triangles))


def grid_solid(name: str, planes: Sequence[Array], filled: Mask) -> SolidMesh:
    """The filled cells of a grid.

    Args:
        name: Of the solid.
        planes: Increasing coordinates of the grid's planes, one array for each axis.
        filled: Which cells are, one fewer along each axis than planes.
    """
    counts = [len(axis) for axis in planes]
    numbers = np.arange(int(np.prod(counts))).reshape(counts)
    padded = np.pad(filled, 1)
    quads: list[Numbers] = []
    for axis in range(3):
        # In this order of axes the next two turn counter-clockwise about the first.
        order = (axis, (axis + 1) % 3, (axis + 2) % 3)
        cells = padded.transpose(order)[:, 1:-1, 1:-1]
        corners = numbers.transpose(order)
        square = np.stack(
            [corners[:, :-1, :-1], corners[:, 1:, :-1], corners[:, 1:, 1:], corners[:, :-1, 1:]], axis=-1
        )
        below, above = cells[:-1], cells[1:]
        quads += [square[below & ~above], square[above & ~below][:, ::-1]]
    quad = np.concatenate(quads)
    triangles = np.concatenate([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])
    used, renumbered = np.unique(triangles, return_inverse=True)
    points = np.stack(np.meshgrid(*planes, indexing="ij"), axis=-1).reshape(-1, 3)
    return SolidMesh(name, points[used], renumbered.reshape(-1, 3))


def _of_boxes(
    name: str,
    boxes: Sequence[Box],
    *,
    less: Sequence[Box] = (),
) -> SolidMesh:
    """The union of boxes, without those in `less`."""
    corners = np.array([*boxes, *less], dtype=float)
    planes = [np.unique(corners[..., axis]) for axis in range(3)]
    middles = np.meshgrid(*(0.5 * (axis[1:] + axis[:-1]) for axis in planes), indexing="ij")
    places = np.stack(middles, axis=-1)

    def inside(of: Sequence[Box]) -> Mask:
        found = np.zeros(places.shape[:-1], dtype=bool)
        for low, high in of:
            found |= np.all((places > np.array(low)) & (places < np.array(high)), axis=-1)
        return found

    return grid_solid(name, planes, inside(boxes) & ~inside(less))


def _usable(solid: SolidMesh) -> SolidMesh | None:
    """The solid, if it is one piece of which exactly two triangles meet at each edge."""
    body = Body(solid.vertices, solid.triangles)
    _, counts = np.unique(np.sort(half_edges(solid.triangles), axis=1), axis=0, return_counts=True)
    return solid if np.all(counts == 2) and len(pieces_of(body)) == 1 else None


def _ring(
    count: int, radius: float, *, center: tuple[float, float] = (0.0, 0.0), turned: float = 0.0
) -> Array:
    """A regular polygon; `turned` in degrees."""
    angles = math.radians(turned) + np.arange(count) * (2.0 * math.pi / count)
    return np.array(center) + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _turned(loop: Loop, sense: float) -> Array:
    """The loop counter-clockwise, or clockwise for a `sense` below zero."""
    points = np.asarray(loop, dtype=float)
    x, y = (points - points[0]).T
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return points if area * sense > 0.0 else points[::-1]


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for bundled in BUNDLED:
        solid_text, contacts_text = bundled_files(bundled)
        (folder / f"{bundled}.json").write_text(solid_text, encoding="utf-8")
        (folder / "contacts" / f"{bundled}.json").write_text(contacts_text, encoding="utf-8")
