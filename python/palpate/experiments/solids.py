"""Parts of space as triangles, with normals, edges, cones of vertices and planar faces worked out.

Only NumPy: what is measured with it shares no code with the core.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Numbers = NDArray[np.int64]

#: Normals closer than this, radians, and planes closer than this share of the size, are of one planar face.
COPLANAR = 1e-6
#: A cone of normals thinner than this, as a sine, is that of an edge or a face.
THIN = 1e-6


class Places(NamedTuple):
    """Points on the surface `(n, 3)`, outward normals there `(n, 3)` and the triangles `(n,)`."""

    points: Array
    normals: Array
    triangles: Numbers


@dataclass(frozen=True)
class Edges:
    """Convex edges: ends `(e, 3)`, two normals `(e, 3)`, the lesser height of the two triangles `(e,)`."""

    starts: Array
    ends: Array
    first_normals: Array
    second_normals: Array
    heights: Array

    def only(self, numbers: Numbers) -> Edges:
        """Those of some numbers, in their order."""
        return Edges(
            self.starts[numbers],
            self.ends[numbers],
            self.first_normals[numbers],
            self.second_normals[numbers],
            self.heights[numbers],
        )


@dataclass(frozen=True)
class Cone:
    """A convex vertex: `n` is a normal there iff `n · leaving <= 0` for all ways that leave it.

    `leaving` has shape `(k, 3)`; `rays` are the corners of that cone, `(j, 3)`, unit; `height` is the least
    of the triangles there.
    """

    point: Array
    leaving: Array
    rays: Array
    height: float


@dataclass(frozen=True, eq=False)
class Solid:
    """Triangles of a part, counter-clockwise from outside: `vertices` `(v, 3)`, `triangles` `(t, 3)`.

    Each is only equal to itself, so that what is known of it can be kept.
    """

    name: str
    vertices: Array
    triangles: Numbers

    @cached_property
    def corners(self) -> Array:
        """Of the triangles, `(t, 3, 3)`."""
        return np.asarray(self.vertices[self.triangles])

    @cached_property
    def _crosses(self) -> Array:
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return np.cross(b - a, c - a)

    @cached_property
    def areas(self) -> Array:
        """Of the triangles, `(t,)`."""
        return np.asarray(0.5 * np.linalg.norm(self._crosses, axis=1))

    @cached_property
    def normals(self) -> Array:
        """Outward, of the triangles, `(t, 3)`; zero for a triangle without area."""
        lengths = np.linalg.norm(self._crosses, axis=1, keepdims=True)
        units = np.divide(self._crosses, lengths, out=np.zeros_like(self._crosses), where=lengths > 0.0)
        return np.asarray(units)

    @cached_property
    def heights(self) -> Array:
        """The least of each triangle, `(t,)`."""
        longest = np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2).max(axis=1)
        return np.asarray(2.0 * self.areas / longest)

    @cached_property
    def balls(self) -> tuple[Array, Array]:
        """A ball that holds each triangle: middles `(t, 3)` and radii `(t,)`."""
        middles = 0.5 * (self.corners.min(axis=1) + self.corners.max(axis=1))
        return middles, np.linalg.norm(self.corners - middles[:, None], axis=2).max(axis=1)

    @cached_property
    def size(self) -> float:
        """The diagonal of the box around the part: as large as the core's, or a little larger."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @cached_property
    def across(self) -> float:
        """The longest side of the box around the part."""
        return float(np.ptp(self.vertices, axis=0).max())

    @cached_property
    def volume(self) -> float:
        """Positive, if it is watertight and its normals point out."""
        a, b, c = np.moveaxis(self.corners - self.vertices.mean(axis=0), 1, 0)
        return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6.0)

    @cached_property
    def _sides(self) -> tuple[Numbers, Numbers]:
        """Directed sides of the triangles, `(3t, 2)`, and the triangle of each."""
        sides = np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        return sides, np.tile(np.arange(len(self.triangles)), 3)

    @cached_property
    def pairs(self) -> tuple[Numbers, Numbers]:
        """Sides that two triangles share in opposite directions: vertices `(s, 2)`, triangles `(s, 2)`."""
        sides, owners = self._sides
        forward = {(int(a), int(b)): int(t) for (a, b), t in zip(sides, owners, strict=True)}
        found = [(a, b, t, forward[b, a]) for (a, b), t in forward.items() if a < b and (b, a) in forward]
        table = np.array(found, dtype=np.int64).reshape(-1, 4)
        return table[:, :2], table[:, 2:]

    @cached_property
    def watertight(self) -> bool:
        """Every side is shared by exactly two triangles, once in each direction."""
        sides, _ = self._sides
        return len({(int(a), int(b)) for a, b in sides}) == len(sides) == 2 * len(self.pairs[0])

    @cached_property
    def planar_faces(self) -> Numbers:
        """The planar face of each triangle, `(t,)`: coplanar neighbours are of one face, numbered from 0."""
        _, twos = self.pairs
        first, second = self.normals[twos[:, 0]], self.normals[twos[:, 1]]
        turned = np.linalg.norm(np.cross(first, second), axis=1)
        same = (turned <= COPLANAR) & (np.einsum("si,si->s", first, second) > 0.0)
        return _joined(len(self.triangles), twos[same])

    @cached_property
    def bodies(self) -> Numbers:
        """The connected surface of each triangle, `(t,)`, numbered from 0."""
        return _joined(len(self.triangles), self.pairs[1])

    @cached_property
    def num_faces(self) -> int:
        """How many planar faces it has."""
        return int(self.planar_faces.max()) + 1 if len(self.triangles) else 0

    @cached_property
    def edges(self) -> Edges:
        """Those that a ball can rest on."""
        shared, twos = self.pairs
        first, second = self.normals[twos[:, 0]], self.normals[twos[:, 1]]
        starts, ends = self.vertices[shared[:, 0]], self.vertices[shared[:, 1]]
        # Seen along a side from its start to its end, its own triangle is on the left.
        turn = np.einsum("si,si->s", np.cross(first, second), ends - starts)
        convex = turn > THIN * np.linalg.norm(ends - starts, axis=1)
        heights = self.heights[twos].min(axis=1)
        return Edges(starts[convex], ends[convex], first[convex], second[convex], heights[convex])

    @cached_property
    def cones(self) -> list[Cone]:
        """Vertices that a ball can rest on with normals of more than an edge."""
        shared, _ = self.pairs
        leaving: dict[int, list[Array]] = {}
        for a, b in shared:
            for here, there in ((a, b), (b, a)):
                leaving.setdefault(int(here), []).append(self.vertices[there] - self.vertices[here])
        cones = (self._cone(vertex, np.array(ways)) for vertex, ways in sorted(leaving.items()))
        return [cone for cone in cones if cone is not None]

    def _cone(self, vertex: int, ways: Array) -> Cone | None:
        lengths = np.linalg.norm(ways, axis=1)
        directions = ways / lengths[:, None]
        i, j = np.triu_indices(len(directions), 1)
        crosses = np.cross(directions[i], directions[j])
        sines = np.linalg.norm(crosses, axis=1)
        crosses = crosses[sines > THIN] / sines[sines > THIN, None]
        rays = np.concatenate([crosses, -crosses])
        rays = rays[(rays @ directions.T <= 1e-9).all(axis=1)]
        if not len(rays):
            return None
        rays = rays[np.sort(np.unique(np.round(rays, 7), axis=0, return_index=True)[1])]
        middle = rays.sum(axis=0)
        if np.linalg.norm(middle) < THIN or len(rays) < 3 or np.linalg.svd(rays)[1][2] < THIN:
            return None
        # A pit is a cone too, but its normals would point into the part.
        above = self.vertices[vertex] + 1e-3 * lengths.min() * middle / np.linalg.norm(middle)
        if winding(self, above[None])[0] > 0.5:
            return None
        height = float(self.heights[(self.triangles == vertex).any(axis=1)].min())
        return Cone(self.vertices[vertex], directions, rays, height)

    def moved_to(self, across: float) -> Solid:
        """The same part, so many across, the middle of its box at the origin."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        scaled = (self.vertices - 0.5 * (low + high)) * (across / self.across)
        return Solid(self.name, scaled, self.triangles)

    def places(self, random: np.random.Generator, count: int) -> Places:
        """Points drawn evenly over the surface."""
        chosen = random.choice(len(self.areas), size=count, p=self.areas / self.areas.sum())
        u, v = random.random((2, count))
        root = np.sqrt(u)
        weights = np.stack([1.0 - root, root * (1.0 - v), root * v], axis=1)
        points = np.einsum("nk,nki->ni", weights, self.corners[chosen])
        return Places(points, self.normals[chosen], chosen.astype(np.int64))


def _joined(count: int, links: Numbers) -> Numbers:
    """Numbers from 0 for the components of a graph, in the order of their first members."""
    parent = list(range(count))

    def root(one: int) -> int:
        while parent[one] != one:
            parent[one] = parent[parent[one]]
            one = parent[one]
        return one

    for a, b in links.tolist():
        first, second = sorted((root(a), root(b)))
        parent[second] = first
    return np.unique([root(one) for one in range(count)], return_inverse=True)[1].astype(np.int64)


def winding(solid: Solid, points: Array) -> Array:
    """How often the surface goes around points `(n, 3)`: 1 inside of a watertight part, 0 outside.

    Van Oosterom and Strackee (1983), equation 8.
    """
    total = np.zeros(len(points))
    for number, point in enumerate(points):
        a, b, c = np.moveaxis(solid.corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
        triple = np.einsum("ti,ti->t", a, np.cross(b, c))
        dots = [np.einsum("ti,ti->t", *pair) for pair in ((a, b), (b, c), (c, a))]
        below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
        total[number] = np.arctan2(triple, below).sum() / (2.0 * np.pi)
    return total


def welded(name: str, corners: Array) -> Solid:
    """A part of loose triangles `(t, 3, 3)`: equal corners become one vertex, empty triangles go."""
    flat = corners.reshape(-1, 3)
    unit = float(np.ptp(flat, axis=0).max()) * 1e-7
    _, first, back = np.unique(np.round(flat / unit), axis=0, return_index=True, return_inverse=True)
    triangles = back.reshape(-1, 3).astype(np.int64)
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    solid = Solid(name, flat[first], triangles[whole])
    return Solid(name, solid.vertices, solid.triangles[solid.areas > 1e-12 * solid.size**2])


def read_obj(name: str, text: str) -> list[tuple[str, Array, Numbers]]:
    """Objects of a Wavefront file: name, vertices of the whole file, triangles. Polygons become fans."""
    vertices: list[list[float]] = []
    objects: list[tuple[str, list[list[int]]]] = []
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "o":
            objects.append((words[1] if len(words) > 1 else name, []))
        elif words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words[0] == "f":
            if not objects:
                objects.append((name, []))
            corners = [int(word.split("/")[0]) for word in words[1:]]
            numbers = [one - 1 if one > 0 else len(vertices) + one for one in corners]
            objects[-1][1].extend([numbers[0], *two] for two in pairwise(numbers[1:]))
    points = np.array(vertices, dtype=float).reshape(-1, 3)
    return [(one, points, np.array(faces, dtype=np.int64)) for one, faces in objects if faces]


def load_obj(file: Path, name: str) -> Solid:
    """The only object of a Wavefront file that `save_obj` wrote."""
    [(_, vertices, triangles)] = read_obj(name, file.read_text(encoding="utf-8"))
    return Solid(name, vertices, triangles)


def save_obj(file: Path, solid: Solid) -> None:
    """The part as a Wavefront file, its numbers in full."""
    lines = [f"o {solid.name}"]
    lines += ["v " + " ".join(map(repr, vertex)) for vertex in solid.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in solid.triangles.tolist()]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
