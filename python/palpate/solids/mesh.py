"""Solids as arrays: triangles of bodies as files have them, and how they hang together."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Model
from palpate.contacts.entry import refuse

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

# The core divides a solid into features; what has more triangles than this is no part that is met by touch.
MOST_TRIANGLES = 1_000_000
# Coordinates beyond this have squares that are not finite.
_LARGEST = 1e100


@dataclass(frozen=True)
class SolidMesh:
    """A part as it was read: the arguments of `palpate.Model.mesh`."""

    name: str
    vertices: Array
    """Shape `(n, 3)`, the models' unit; no two are the same."""
    triangles: Numbers
    """Shape `(m, 3)`, numbers of vertices, counter-clockwise from outside."""
    position_slack: float = 0.0
    """How far the true surface may lie from the triangles."""
    normal_slack: float = 0.0
    """How far its normals may be from theirs, radians."""
    mends: tuple[str, ...] = ()
    """What was mended or left out, one line each."""


@dataclass(frozen=True)
class Body:
    """A piece of a file: an object, a group, a component. Not yet cleaned."""

    vertices: Array
    triangles: Numbers
    name: str = ""
    """What the file calls it; empty if nothing."""
    position_slack: float = 0.0
    normal_slack: float = 0.0


@dataclass
class Scene:
    """What a reader makes of a file."""

    bodies: list[Body] = field(default_factory=list[Body])
    notes: list[str] = field(default_factory=list[str])


def body_of(
    file: str, vertices: ArrayLike, triangles: ArrayLike, *, name: str = "", scale: float = 1.0
) -> Body:
    """A body whose numbers make sense; `scale` converts its lengths to the models' unit.

    Raises:
        ValueError: If a coordinate is not finite, or a triangle names a vertex that is not there.
    """
    points = np.asarray(vertices, dtype=float).reshape(-1, 3) * scale
    numbers = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    check_count(file, len(numbers))
    bad = np.flatnonzero(~np.all(np.abs(points) < _LARGEST, axis=1))
    if len(bad):
        refuse(
            file, f"vertex {bad[0]} is not a finite point: {said(points[bad[0]])}", "export the part again"
        )
    stray = np.flatnonzero(np.any((numbers < 0) | (numbers >= len(points)), axis=1))
    if len(stray):
        refuse(
            file,
            f"triangle {stray[0]} names a vertex that is not among the {len(points)} of its body",
            "the file may be cut off: export or copy it again",
        )
    return Body(points, numbers, name)


def check_count(file: str, count: int) -> None:
    """Refuse a mesh that is too large, if possible before it is read."""
    if count > MOST_TRIANGLES:
        refuse(
            file,
            f"{count} triangles are more than {MOST_TRIANGLES}",
            "export it coarser, or simplify the mesh",
        )


def cleaned(body: Body, notes: list[str]) -> Body:
    """The body with equal vertices made one, without triangles that have no corner or are there twice."""
    # Minus zero is zero: as bytes they differ.
    vertices, numbers = np.unique(body.vertices + 0.0, axis=0, return_inverse=True)
    numbers = numbers.reshape(-1)[body.triangles]
    apart = (
        (numbers[:, 0] != numbers[:, 1]) & (numbers[:, 1] != numbers[:, 2]) & (numbers[:, 2] != numbers[:, 0])
    )
    if not np.all(apart):
        notes.append(f"{int(np.sum(~apart))} triangle(s) with two equal corners left out")
        numbers = numbers[apart]
    numbers = _without_doubles(numbers, notes)
    # Numbered in the order in which the triangles first name them.
    used, first = np.unique(numbers, return_index=True)
    order = used[np.argsort(first, kind="stable")]
    place = np.full(len(vertices), -1, dtype=np.int64)
    place[order] = np.arange(len(order))
    return replace(body, vertices=vertices[order], triangles=place[numbers])


def _without_doubles(numbers: Numbers, notes: list[str]) -> Numbers:
    """Without triangles that are there twice, corner for corner and the same way round."""
    if not len(numbers):
        return numbers
    lowest = np.argmin(numbers, axis=1)
    turned = np.take_along_axis(numbers, (lowest[:, None] + np.arange(3)) % 3, axis=1)
    _, first = np.unique(turned, axis=0, return_index=True)
    if len(first) < len(numbers):
        notes.append(f"{len(numbers) - len(first)} triangle(s) given twice read once")
    return numbers[np.sort(first)]


def joined(bodies: list[Body]) -> Body:
    """All bodies as one, without a name; slacks are the largest."""
    counts = [0, *(len(body.vertices) for body in bodies)]
    starts = np.cumsum(counts)
    return Body(
        np.concatenate([body.vertices for body in bodies]),
        np.concatenate([body.triangles + start for body, start in zip(bodies, starts, strict=False)]),
        position_slack=max(body.position_slack for body in bodies),
        normal_slack=max(body.normal_slack for body in bodies),
    )


def pieces_of(body: Body) -> list[Body]:
    """Its connected pieces, by corners that triangles share, in the order of their first triangles."""
    if not len(body.triangles):
        return []
    label = components(len(body.vertices), body.triangles)[body.triangles[:, 0]]
    _, first = np.unique(label, return_index=True)
    return [part_of(body, body.triangles[label == mark]) for mark in label[np.sort(first)]]


def shells_of(body: Body) -> list[Body]:
    """Its shells: bodies that touch share edges and corners, and each is a shell of its own.

    At an edge where more than two triangles meet, two hang together if they bound one wedge of material. The
    body must be consistent.
    """
    edges = half_edges(body.triangles)
    count = len(body.triangles)
    ordered = np.sort(edges, axis=1)
    order = np.lexsort((ordered[:, 1], ordered[:, 0]))
    _, sizes = np.unique(ordered, axis=0, return_counts=True)
    ends = np.cumsum(sizes)
    plain = ends[sizes == 2]
    pairs = [np.stack([order[plain - 2], order[plain - 1]], axis=1)]
    for end, size in zip(ends[sizes > 2], sizes[sizes > 2], strict=True):
        pairs.append(_wedges(body, edges, order[end - size : end]))
    together = np.concatenate(pairs) % count
    label = components(count, together)
    return [part_of(body, body.triangles[label == mark]) for mark in np.unique(label)]


def _wedges(body: Body, edges: Numbers, around: Numbers) -> Numbers:
    """Pairs of half edges along one edge, each around a wedge of material.

    A triangle whose half edge runs along faces counter-clockwise about the edge: material is clockwise of it,
    up to the next one that runs back.
    """
    count = len(body.triangles)
    start, end = body.vertices[np.sort(edges[around[0]])]
    along = (end - start) / np.linalg.norm(end - start)
    # Corner k of a triangle begins its half edge k; the one after the next is the corner off the edge.
    corners = body.vertices[body.triangles[around % count, (around // count + 2) % 3]] - start
    away = corners - np.multiply.outer(corners @ along, along)
    x = away[0] / np.linalg.norm(away[0])
    angles = np.arctan2(away @ np.cross(along, x), away @ x)
    runs_along = edges[around, 0] < edges[around, 1]
    ahead, back = np.flatnonzero(runs_along), np.flatnonzero(~runs_along)
    # A wall of no thickness lies against one of the neighbour's: a whole turn away, not none.
    turns = (angles[ahead][:, None] - angles[back] - 1e-6) % (2.0 * np.pi)
    pairs: list[tuple[int, int]] = []
    while len(pairs) < len(ahead):
        row, column = np.unravel_index(int(np.argmin(turns)), turns.shape)
        pairs.append((int(around[ahead[row]]), int(around[back[column]])))
        turns[row, :] = turns[:, column] = np.inf
    return np.array(pairs, dtype=np.int64)


def split_open(body: Body) -> tuple[list[Body], Body, Numbers]:
    """Its closed pieces, the triangles of all others, and for each of these which piece it belongs to."""
    label = components(len(body.vertices), body.triangles)[body.triangles[:, 0]]
    edges = np.sort(half_edges(body.triangles), axis=1)
    _, place, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    is_open = np.zeros(len(body.vertices), dtype=bool)
    is_open[np.tile(label, 3)[counts[place.reshape(-1)] % 2 == 1]] = True
    left = is_open[label]
    closed = part_of(body, body.triangles[~left])
    return pieces_of(closed), part_of(body, body.triangles[left]), label[left]


def sewn(file: str, body: Body, notes: list[str]) -> Body:
    """The body as the core cleans it: corners welded where it ended, as far as rounding may have parted them.

    Raises:
        ValueError: If its coordinates leave no digits.
    """
    try:
        vertices, triangles, slacks, mends = Model._sewn(body.vertices, body.triangles)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
    notes += mends
    return replace(
        body,
        vertices=vertices,
        triangles=triangles.astype(np.int64),
        position_slack=body.position_slack + slacks[0],
        normal_slack=body.normal_slack + slacks[1],
    )


def part_of(body: Body, triangles: Numbers) -> Body:
    """Some of its triangles, with the vertices that they name."""
    used, numbers = np.unique(triangles, return_inverse=True)
    return replace(body, vertices=body.vertices[used], triangles=numbers.reshape(-1, 3))


def components(count: int, groups: Numbers) -> Numbers:
    """For each of `count` things the least one that it hangs together with; each row of `groups` does."""
    label = np.arange(count)
    while True:
        before = label.copy()
        least = np.min(label[groups], axis=1)
        for column in groups.T:
            np.minimum.at(label, column, least)
        # Each takes the label of its label: long chains are walked in few rounds.
        label = label[label]
        if np.array_equal(before, label):
            return label


def half_edges(triangles: Numbers) -> Numbers:
    """From each corner to the next, shape `(3m, 2)`."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def open_edges(body: Body) -> int:
    """How many of its edges have an odd number of triangles, as where a surface ends."""
    _, counts = np.unique(np.sort(half_edges(body.triangles), axis=1), axis=0, return_counts=True)
    return int(np.sum(counts % 2))


def is_branched(body: Body) -> bool:
    """Whether more than two of its triangles meet at an edge."""
    _, counts = np.unique(np.sort(half_edges(body.triangles), axis=1), axis=0, return_counts=True)
    return bool(np.any(counts > 2))


def is_consistent(body: Body) -> bool:
    """Whether it is closed, and neighbours run opposite ways along the edges they share."""
    edges = half_edges(body.triangles)
    marks = edges[:, 0] * len(body.vertices) + edges[:, 1]
    back = edges[:, 1] * len(body.vertices) + edges[:, 0]
    return bool(np.array_equal(np.sort(marks), np.sort(back)))


def volume(body: Body) -> float:
    """Of what is inside its triangles; negative if they face inward. Of a closed body."""
    if not len(body.triangles):
        return 0.0
    a, b, c = (body.vertices[body.triangles[:, k]] - body.vertices[0] for k in range(3))
    return float(np.sum(a * np.cross(b, c))) / 6.0


def inside_out(body: Body) -> Body:
    """The body with its triangles facing the other way."""
    return replace(body, triangles=body.triangles[:, ::-1])


def box(body: Body) -> tuple[Array, Array]:
    """Lower and upper corner of its box."""
    return np.min(body.vertices, axis=0), np.max(body.vertices, axis=0)


def said(point: ArrayLike) -> str:
    """A point in words."""
    return "({})".format(", ".join(f"{x:.6g}" for x in np.asarray(point, dtype=float)))
