"""What is drawn of a state, as arrays and colours: meshes, lines and words. Nothing of a viewer is in here.

Parts have their colours, as in `palpate.plots`; what was sensed is black. What is drawn of a range of poses
is said by `range_words`: sampled poses are valid and not all there are; shaded places hold every pose.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import lru_cache

import numpy as np

from palpate._core import Contact, Hypothesis, Model, Path
from palpate.plots.style import COLORS, CONFLICT, FAINT, SENSED
from palpate.probe import Skid
from palpate.view import meshes
from palpate.view.meshes import Mesh
from palpate.view.session import Session
from palpate.view.state import Array, Placement, State

Color = tuple[int, int, int]

RANGE: Color = (70, 70, 80)
MOST_NUMBERED = 25  # hypotheses that have their numbers, and bars beside the path
MOST_RANGED = 12  # hypotheses whose ranges are drawn at once
MOST_LINES = 60_000  # of hypotheses; above, those of the chosen one alone
MOST_CORNERS = 96  # of all solids, around which it is shown where they may be, but 24 of each
SAMPLES = 16  # poses of a hypothesis
THICKNESS = 0.03  # of planar parts, in sizes
SPIKE = 0.16  # of normals, in sizes
WIDEST_DEG = 60.0  # cones are drawn no wider


@dataclass(frozen=True, eq=False)
class Bodies:
    """One mesh at some places."""

    name: str
    mesh: Mesh
    poses: Array
    """Shape `(n, 4, 4)`."""
    color: Color
    opacity: float
    scales: Array | None = None
    """Shape `(n,)`."""
    closed: bool = False
    """Whether its triangles are seen from outside alone."""
    model_number: int | None = None
    """Of hypotheses: the model; then the places are those of its placements, in order."""


@dataclass(frozen=True, eq=False)
class Strokes:
    """Straight lines."""

    name: str
    segments: Array
    """Shape `(n, 2, 3)`."""
    color: Color
    width: float
    """In pixels."""


@dataclass(frozen=True, eq=False)
class Words:
    """A few letters at a place."""

    name: str
    text: str
    place: Array
    """Shape `(3,)`."""


Shape = Bodies | Strokes | Words


@dataclass(frozen=True)
class Look:
    """What is to be seen."""

    chosen: int | None = None
    """The number of a hypothesis; None: all alike."""
    samples: bool = False
    bounds: bool = False
    """Sampled poses, and the places that hold every pose."""
    truth: bool = False


def color_of(model_number: int) -> Color:
    """That of a part, as in all pictures."""
    return rgb(COLORS[model_number % len(COLORS)])


def rgb(text: str) -> Color:
    """`#RRGGBB`."""
    red, green, blue = (int(text[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


def shapes_of(session: Session, state: State, look: Look) -> list[Shape]:
    """Everything."""
    drawn = _Drawn(session, state, look)
    return [
        *drawn.parts(),
        *drawn.ranges(),
        *drawn.contacts(),
        *drawn.sweeps(),
        *drawn.moves(),
        *drawn.path(),
        *drawn.truth(),
        *drawn.surroundings(),
    ]


def ranged(state: State, look: Look) -> list[int]:
    """Numbers of the hypotheses whose ranges are drawn."""
    if look.chosen is not None:
        return [look.chosen] if look.chosen < len(state.hypotheses) else []
    return list(range(min(len(state.hypotheses), MOST_RANGED)))


def corners_each(count: int) -> int:
    """Corners of each of so many solids around which it is shown where they may be."""
    return max(4, min(24, MOST_CORNERS // max(1, count)))


@lru_cache(maxsize=8192)
def reach(hypothesis: Hypothesis, *corner: float) -> float:
    """How far apart two poses can move a corner, model frame: asked of the core once."""
    return hypothesis.poses.excursion(corner)


def frame_of(shapes: Sequence[Shape]) -> tuple[Array, Array]:
    """Two opposite corners of the box around all that is drawn."""
    points: list[Array] = []
    for shape in shapes:
        if isinstance(shape, Words):
            continue
        if isinstance(shape, Strokes):
            points.append(shape.segments.reshape(-1, 3))
            continue
        low, high = shape.mesh.vertices.min(axis=0), shape.mesh.vertices.max(axis=0)
        corners = np.array(
            [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
        )
        scales = np.ones(len(shape.poses)) if shape.scales is None else shape.scales
        points.append(
            np.concatenate(
                [
                    meshes.placed(pose[None], scale * corners)[0]
                    for pose, scale in zip(shape.poses, scales, strict=True)
                ]
            )
        )
    everything = np.concatenate(points)
    return everything.min(axis=0), everything.max(axis=0)


def same(one: object, other: object) -> bool:
    """Whether two shapes are drawn alike."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(np.asarray(one), np.asarray(other))
    if is_dataclass(one) and type(one) is type(other):
        return one is other or all(
            same(getattr(one, each.name), getattr(other, each.name)) for each in fields(one)
        )
    return one == other


class _Drawn:
    """A state, by its layers."""

    def __init__(self, session: Session, state: State, look: Look) -> None:
        self._session, self._state, self._look = session, state, look
        self._flat = session.dimension == 2
        self._size = session.size
        self._thickness = THICKNESS * session.size if self._flat else 0.0
        self._above = 1.5 * self._thickness  # lines in the plane lie above all parts
        self._spike = SPIKE * session.size
        self._placements = session.placements(state)

    def parts(self) -> Iterator[Shape]:
        """The models, each in its colour, translucent."""
        for number in dict.fromkeys(one.model_number for one in self._placements):
            own = [one for one in self._placements if one.model_number == number]
            poses = np.array([self._lifted(one) for one in own])
            color = color_of(number)
            yield Bodies(
                f"parts/{number}",
                meshes.mesh_of(own[0].model, self._thickness),
                poses,
                color,
                _opacity(len(self._placements)),
                closed=own[0].model.closed,
                model_number=number,
            )
            edges = meshes.edges_of(own[0].model, self._thickness)
            if len(edges) * len(self._placements) <= MOST_LINES:
                yield Strokes(f"edges/{number}", meshes.placed(poses, edges).reshape(-1, 2, 3), color, 1.6)
        chosen = self._chosen()
        if chosen is not None:
            edges = meshes.edges_of(chosen.model, self._thickness)
            pose = self._lifted(chosen)[None]
            color = color_of(chosen.model_number)
            yield Bodies("chosen", meshes.mesh_of(chosen.model, self._thickness), pose, color, 0.5)
            yield Strokes("chosen-edges", meshes.placed(pose, edges)[0], color, 3.5)
        for shown in self._placements[:MOST_NUMBERED]:
            name = self._session.labels[shown.model_number]
            text = name if shown.hypothesis is None else f"{shown.hypothesis + 1} {name}"
            yield Words(f"numbers/{shown.hypothesis}-{shown.model_number}", text, self._name_place(shown))

    def ranges(self) -> Iterator[Shape]:
        """Not one pose: those that are valid, and the places that hold all."""
        for number in ranged(self._state, self._look):
            one = self._state.hypotheses[number]
            if self._look.samples:
                poses = np.array([self._pose(pose) for pose in one.poses.sample(SAMPLES, seed=number)])
                edges = meshes.placed(poses, meshes.edges_of(one.model, self._thickness)).reshape(-1, 2, 3)
                if len(edges) <= MOST_LINES:
                    yield Strokes(f"samples/{number}", edges, _paler(color_of(one.model_number)), 1.0)
            if self._look.bounds and one.proved:
                yield from self._bounds(number, one)

    def _bounds(self, number: int, one: Hypothesis) -> Iterator[Shape]:
        """In the plane a polygon for each corner; in space a ball, around where it is at the pose shown."""
        if self._flat:
            outlines = [meshes.fan(one.poses.outline(vertex), self._above) for vertex in one.model.vertices]
            yield Bodies(f"bounds/{number}", meshes.joined(outlines), np.eye(4)[None], RANGE, 0.45)
            return
        corners = spread(np.asarray(one.model.vertices), corners_each(len(ranged(self._state, self._look))))
        poses = np.tile(np.eye(4), (len(corners), 1, 1))
        poses[:, :3, 3] = meshes.placed(self._pose(one.world_from_model)[None], corners)[0]
        radii = np.array([reach(one, *corner) for corner in corners.tolist()])
        yield Bodies(f"bounds/{number}", meshes.ball(), poses, RANGE, 0.2, scales=radii)

    def contacts(self) -> Iterator[Shape]:
        """The place with its error, the tip, the normal with its cone, else the approach."""
        conflict = (self._state.left.conflict if self._state.left else None) or []
        for number, contact in enumerate(self._state.contacts):
            color = rgb(CONFLICT if number in conflict else SENSED)
            yield from self._contact(f"contacts/{number}", contact, color)
            yield Words(f"contacts/{number}/number", f"{number + 1}", self._beyond(contact))

    def _contact(self, name: str, contact: Contact, color: Color) -> Iterator[Shape]:
        center = self._point(contact.center)
        dot = 0.006 * self._size
        yield _ball(f"{name}/dot", center, dot, color=color, opacity=1.0)
        if contact.position_error > dot:
            yield _ball(f"{name}/error", center, contact.position_error, color=color, opacity=0.25)
        if contact.tip_radius > dot:
            yield _ball(f"{name}/tip", center, contact.tip_radius, color=color, opacity=0.2)
        away = _away(contact)
        if away is None:
            return
        axis = self._vector(away)
        ends = np.array([[center, center + self._spike * axis]])
        yield Strokes(f"{name}/{'normal' if contact.normal is not None else 'approach'}", ends, color, 1.8)
        if contact.normal is None:
            head = meshes.cone(axis, 0.35 * self._spike, math.radians(18))
            yield Bodies(f"{name}/toward", head, _at(center), color, 1.0)
        elif contact.normal_error:
            half = min(contact.normal_error, math.radians(WIDEST_DEG))
            make = meshes.wedge if self._flat else meshes.cone
            yield Bodies(f"{name}/cone", make(axis, self._spike, half), _at(center), color, 0.25)

    def sweeps(self) -> Iterator[Shape]:
        """What was swept freely before the session."""
        for number, miss in enumerate(self._state.misses):
            ends = self._point(miss.start), self._point(miss.end)
            yield Strokes(f"sweeps/{number}", meshes.dashes(*ends, 0.5 * self._spike), rgb(FAINT), 1.2)

    def moves(self) -> Iterator[Shape]:
        """Travelled solid, what was planned beyond it dashed. Scans that met nothing are faint."""
        color = rgb(SENSED)
        for number, move in enumerate(self._state.moves):
            stopped = move.stopped
            start, end = self._point(move.start), self._point(move.end)
            faint = move.purpose == "scan" and stopped is not None and np.array_equal(stopped, move.end)
            color = rgb(FAINT if faint else SENSED)
            at = start if stopped is None else self._point(stopped)
            if not np.array_equal(at, start):
                yield Strokes(
                    f"moves/{number}/travelled", np.array([[start, at]]), color, 1.0 if faint else 2.2
                )
            if not np.array_equal(at, end):
                yield Strokes(f"moves/{number}/ahead", meshes.dashes(at, end, 0.25 * self._spike), color, 1.0)
            if isinstance(move.reply, Skid):
                yield _ball(f"moves/{number}/skid", at, 0.01 * self._size, color=rgb(CONFLICT), opacity=1.0)

    def path(self) -> Iterator[Shape]:
        """Planned, dashed; beside it for each hypothesis where it may be touched."""
        path = self._state.path
        if path is None:
            return
        start, end = self._point(path.start), self._point(path.end)
        color = rgb(SENSED)
        yield Strokes("path/planned", meshes.dashes(start, end, 0.4 * self._spike), color, 3.0)
        tip = max(self._session.sensor.tip_radius, 0.012 * self._size)
        yield _ball("path/tip", start, tip, color=color, opacity=0.8)
        back = -self._vector(path.direction)
        yield Bodies(
            "path/toward", meshes.cone(back, 0.3 * self._spike, math.radians(16)), _at(end), color, 1.0
        )
        yield Words("path/name", "planned", start)
        yield from self._lanes(path, start)

    def _lanes(self, path: Path, start: Array) -> Iterator[Shape]:
        along = self._vector(path.direction)
        aside = meshes.square_to(along, np.array([-along[1], along[0], 0.3]) if self._flat else _up(along))
        if self._flat:
            aside = np.array([-along[1], along[0], 0.0])
        met = [outcome for outcome in path.outcomes if outcome.touches]
        for lane, outcome in enumerate(met[:MOST_NUMBERED], start=1):
            depths = np.array([touch.depth for touch in outcome.touches])
            begin = start + lane * 0.018 * self._size * aside
            ends = begin + depths[..., None] * along
            short = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) < 0.01 * self._size
            ends[short] += 0.005 * self._size * np.array([[-along], [along]]).transpose(1, 0, 2)
            number = self._state.hypotheses[outcome.hypothesis].model_number
            yield Strokes(f"path/lanes/{outcome.hypothesis}", ends, color_of(number), 5.0)

    def truth(self) -> Iterator[Shape]:
        """The part that answers."""
        truth = self._state.truth
        if truth is None or not self._look.truth:
            return
        pose = self._pose(truth.world_from_model)[None]
        edges = meshes.placed(pose, meshes.edges_of(truth.model, 1.2 * self._thickness))[0]
        dashed = [meshes.dashes(start, end, 0.02 * self._size) for start, end in edges]
        yield Strokes("truth", np.concatenate(dashed), rgb(SENSED), 2.0)

    def surroundings(self) -> Iterator[Shape]:
        """The workspace, if there is one."""
        if self._session.workspace is None:
            return
        low, high = (self._point(corner) for corner in self._session.workspace)
        if self._flat:
            low[2] = high[2] = 0.0
        corners = [
            np.array([x, y, z])
            for x in (low[0], high[0])
            for y in (low[1], high[1])
            for z in (low[2], high[2])
        ]
        ends = [(a, b) for a in corners for b in corners if (b - a > 0.0).sum() == 1 and (b >= a).all()]
        yield Strokes("workspace", np.array(ends), rgb("#B8B8B4"), 1.0)

    def _chosen(self) -> Placement | None:
        wanted = self._look.chosen
        found = [one for one in self._placements if one.hypothesis is not None and one.hypothesis == wanted]
        return found[0] if found else None

    def _name_place(self, shown: Placement) -> Array:
        """At a corner that is far to one side, each hypothesis another."""
        corners = meshes.placed(self._pose(shown.world_from_model)[None], self._vertices(shown.model))[0]
        if shown.hypothesis is None:
            return np.array(
                [corners[:, 0].mean(), corners[:, 1].min() - 0.06 * self._size, corners[:, 2].max()]
            )
        turn = 2.4 * shown.hypothesis  # the golden angle, nearly: neighbours differ much
        return np.asarray(corners[int(np.argmax(corners @ [math.cos(turn), math.sin(turn), 0.2]))])

    def _vertices(self, model: Model) -> Array:
        vertices = np.asarray(model.vertices)
        return np.column_stack([vertices, np.full(len(vertices), self._above)]) if self._flat else vertices

    def _beyond(self, contact: Contact) -> Array:
        away = _away(contact)
        aside = np.zeros(3) if away is None else self._vector(away)
        return self._point(contact.center) + 1.25 * self._spike * aside

    def _pose(self, world_from_model: Array) -> Array:
        return meshes.in_space(np.array(world_from_model, dtype=float))

    def _lifted(self, shown: Placement) -> Array:
        """In the plane each a little above the one before: faces at one height would flicker."""
        pose = self._pose(shown.world_from_model)
        pose[2, 3] += 0.25 * self._thickness * (shown.hypothesis or 0) / len(self._placements)
        return pose

    def _point(self, point: Array) -> Array:
        return np.append(point, self._above) if self._flat else np.array(point)

    def _vector(self, vector: Array) -> Array:
        return np.append(vector, 0.0) if self._flat else np.array(vector)


def spread(points: Array, most: int) -> Array:
    """So many of the points at most, far from each other."""
    if len(points) <= most:
        return points
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    distances = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < most:
        chosen.append(int(np.argmax(distances)))
        distances = np.minimum(distances, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return points[chosen]


def _opacity(count: int) -> float:
    """So that many that lie upon each other can still be told apart."""
    return float(np.clip(0.34 / math.sqrt(max(1.0, count / 2)), 0.03, 0.34))


def _paler(color: Color) -> Color:
    red, green, blue = (round(0.55 * value + 0.45 * 255) for value in color)
    return red, green, blue


def _away(contact: Contact) -> Array | None:
    if contact.normal is not None:
        return contact.normal
    return None if contact.approach is None else -contact.approach


def _up(along: Array) -> Array:
    return np.eye(3)[2] if abs(along[2]) < 0.9 else np.eye(3)[0]


def _at(place: Array) -> Array:
    pose = np.eye(4)[None]
    pose[0, :3, 3] = place
    return pose


def _ball(name: str, place: Array, radius: float, *, color: Color, opacity: float) -> Bodies:
    return Bodies(name, meshes.ball(), _at(place), color, opacity, scales=np.array([radius]))
