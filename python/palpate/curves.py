"""Curves made into chords, with a bound on what that costs.

The bounds are proved, not sampled. An arc of an ellipse is farthest from its chord half-way and turns one way
only. A rational Bézier curve with positive weights lies in the hull of its control points, its tangents in
the cone of the vectors from each control point to each later one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Halvings of a piece before its bounds are read off: they are then within a few per cent of the truth.
_REFINEMENTS = 3
# A piece this small, as a share of the tolerance, is a corner: it turns, but has no length to be touched on.
_CORNER_SHARE = 1e-3
_MOST_CHORDS = 20_000
# Drawn chords are thinned if they are no longer than this many times the tolerance.
_FINE = 10.0


class CurveError(ValueError):
    """A curve that can't be made into chords."""


@dataclass(frozen=True)
class Tolerance:
    """How far chords may be from their curve."""

    distance: float
    """In the models' unit."""
    turn: float
    """Between a chord and the curve's tangents, radians."""


@dataclass(frozen=True)
class Piece:
    """A run of chords, and how far the curve it stands for may be from them."""

    points: Array
    """Shape `(n, 2)`, the models' unit."""
    position_slack: float = 0.0
    """Largest distance of the curve from its chords."""
    normal_slack: float = 0.0
    """Largest angle between the curve's normals and its chords', radians."""
    layer: str = ""
    """Of the drawing; empty if it has none."""

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return len(self.points) > 2 and bool(np.all(self.points[0] == self.points[-1]))

    @property
    def extent(self) -> float:
        """The longer side of the box around it."""
        return float(np.max(np.ptp(self.points, axis=0)))

    @property
    def length(self) -> float:
        """Of all its chords."""
        return float(np.sum(np.hypot(*np.diff(self.points, axis=0).T)))


@dataclass(frozen=True)
class Chords:
    """A run of chords, each with its own slacks."""

    points: Array
    """Shape `(n, 2)`, the models' unit."""
    position: Array
    """Largest distance of what was drawn from each chord, shape `(n - 1,)`."""
    normal: Array
    """Largest angle between its normals and each chord's, radians, shape `(n - 1,)`."""

    @classmethod
    def of(cls, piece: Piece) -> Chords:
        """The chords of a piece."""
        count = len(piece.points) - 1
        return cls(piece.points, np.full(count, piece.position_slack), np.full(count, piece.normal_slack))

    @classmethod
    def joined(cls, runs: list[Chords]) -> Chords:
        """One run; each begins where the one before it ends."""
        points = np.concatenate([runs[0].points, *(run.points[1:] for run in runs[1:])])
        return cls(
            points,
            np.concatenate([run.position for run in runs]),
            np.concatenate([run.normal for run in runs]),
        )

    @property
    def lengths(self) -> Array:
        """Of each chord."""
        return np.asarray(np.hypot(*np.diff(self.points, axis=0).T))

    def reversed(self) -> Chords:
        """The same run from its end to its start."""
        return Chords(self.points[::-1], self.position[::-1], self.normal[::-1])

    def with_ends(self, start: Array, end: Array, *, turn: float) -> tuple[Chords, float]:
        """The run from `start` to `end`, and how far its ends were from there.

        Its ends move there, and the slacks of their chords say so. Where that would turn one of them by more
        than `turn`, a chord of its own is put before and behind the run instead.
        """
        gaps = np.hypot(*(np.stack([start, end]) - self.points[[0, -1]]).T)
        if not np.any(gaps):
            return self, 0.0
        points = self.points.copy()
        points[0], points[-1] = start, end
        turned = _angles(np.diff(self.points, axis=0), np.diff(points, axis=0))
        if np.max(turned) <= turn:
            moved = np.zeros(len(turned))
            moved[0], moved[-1] = gaps
            if len(moved) == 1:
                moved[0] = np.max(gaps)
            return Chords(points, self.position + moved, self.normal + turned), float(np.max(gaps))
        points = np.concatenate([start[None], self.points, end[None]])
        position = np.concatenate([gaps[:1], self.position, gaps[1:]])
        keep = np.concatenate([gaps[:1] > 0.0, np.full(len(self.position), True), gaps[1:] > 0.0])
        normal = np.concatenate([[0.0], self.normal, [0.0]])
        kept_points = np.concatenate([points[:1], points[1:][keep]])
        return Chords(kept_points, position[keep], normal[keep]), float(np.max(gaps))


def thinned(chords: Chords, tolerance: Tolerance) -> Chords:
    """The run with fewer points where it is drawn in finer chords than curves are made into.

    Chords longer than `_FINE` times the tolerance stay as they are drawn. Others make way for one chord as
    long as all of them, and the curves they stand for, keep the tolerance; its slacks include what they miss.
    """
    fine = chords.lengths <= _FINE * tolerance.distance
    if not np.any(fine[1:] & fine[:-1]):
        return chords
    chords = _from_corner(chords, fine)
    fine = chords.lengths <= _FINE * tolerance.distance
    # Of each chord, where the fine ones from there on end.
    coarse = np.append(np.flatnonzero(~fine), len(fine))
    ends = coarse[np.searchsorted(coarse, np.arange(len(fine)))]
    kept, position, normal = [0], list[float](), list[float]()
    while (first := kept[-1]) < len(fine):
        last, (distance, turn) = _longest(
            chords, first, max(int(ends[first]), first + 1), tolerance=tolerance
        )
        kept.append(last)
        position.append(distance)
        normal.append(turn)
    return Chords(chords.points[kept], np.array(position), np.array(normal))


def _from_corner(chords: Chords, fine: NDArray[np.bool_]) -> Chords:
    """A closed run begun anew at a long chord or its sharpest corner, so that no run of fine ones is cut."""
    points = chords.points
    if not np.all(points[0] == points[-1]) or not (fine[0] and fine[-1]):
        return chords
    along = np.diff(points, axis=0)
    turns = _angles(np.roll(along, 1, axis=0), along)
    turns[~(fine & np.roll(fine, 1))] += math.tau
    first = int(np.argmax(turns))
    around = np.append(np.roll(points[:-1], -first, axis=0), points[first][None], axis=0)
    return Chords(around, np.roll(chords.position, -first), np.roll(chords.normal, -first))


def _longest(
    chords: Chords, first: int, end: int, *, tolerance: Tolerance
) -> tuple[int, tuple[float, float]]:
    """How far a chord from point `first` may reach, at most to `end`; with its slacks."""
    good, slacks = first + 1, (float(chords.position[first]), float(chords.normal[first]))
    step, bad = 1, end + 1
    while bad - good > 1:
        last = min(good + step, bad - 1)
        found = _slacks_of(chords, first, last)
        if found[0] <= tolerance.distance and found[1] <= tolerance.turn:
            good, slacks, step = last, found, 2 * step
        else:
            bad, step = last, max(1, (last - good) // 2)
    return good, slacks


def _slacks_of(chords: Chords, first: int, last: int) -> tuple[float, float]:
    """What one chord from point `first` to point `last` misses."""
    points = chords.points[first : last + 1]
    chord = points[-1] - points[0]
    length = float(np.hypot(*chord))
    if length == 0.0:
        return math.inf, math.inf
    distances = np.abs(_cross(points - points[0], chord)) / length
    turns = _angles(np.diff(points, axis=0), chord)
    distance = np.max(np.maximum(distances[1:], distances[:-1]) + chords.position[first:last])
    return float(distance), float(np.max(turns + chords.normal[first:last]))


def line(*points: ArrayLike) -> Piece:
    """Straight from point to point."""
    piece = Piece(np.array(points, dtype=float))
    _check_finite(piece.points)
    return piece


def elliptic_arc(
    frame: tuple[Array, Array, Array], start: float, sweep: float, *, tolerance: Tolerance
) -> Piece:
    """The arc `center + cos(t) axis_x + sin(t) axis_y`, for `t` from `start` on through `sweep`.

    Args:
        frame: Center and the two axes, conjugate half-diameters; a circle's are equal and at right angles.
        start: Where it begins, radians.
        sweep: How far it goes on, radians; negative for clockwise, if the axes are counter-clockwise.
        tolerance: Kept by each chord.
    """
    _check_finite(np.concatenate([*frame, [start, sweep]]))
    _, axis_x, axis_y = frame
    skew = max(abs(axis_x @ axis_y), abs(axis_x @ axis_x - axis_y @ axis_y))
    is_circle = skew <= 1e-9 * (axis_x @ axis_x)
    count = max(1, math.ceil(abs(sweep) / (math.pi / 2)))
    if is_circle:
        # The sagitta of half a step `h` is `radius * (1 - cos(h))`, and the chord turns by `h` at its ends.
        sagitta = min(1.0, tolerance.distance / max(float(np.hypot(*axis_x)), np.finfo(float).tiny))
        half_step = min(math.pi / 4, tolerance.turn, 2.0 * math.asin(math.sqrt(0.5 * sagitta)))
        _check_count(0.5 * abs(sweep) / half_step)
        count = max(count, math.ceil(0.5 * abs(sweep) / half_step - 1e-9))
    t = start + sweep * np.linspace(0.0, 1.0, count + 1)
    while True:
        points, distances, turns = _arc_chords(frame, t)
        too_long = (distances > tolerance.distance) | (turns > tolerance.turn)
        if not too_long.any():
            break
        if is_circle:  # all steps alike: the fewest that do, but for rounding
            count += max(1, count // 256)
            t = start + sweep * np.linspace(0.0, 1.0, count + 1)
        else:
            t = np.insert(t, np.flatnonzero(too_long) + 1, 0.5 * (t[1:] + t[:-1])[too_long])
        _check_count(len(t))
    if abs(abs(sweep) - 2.0 * math.pi) < 1e-12:
        points[-1] = points[0]
    return Piece(points, float(np.max(distances)), float(np.max(turns)))


def _arc_chords(frame: tuple[Array, Array, Array], t: Array) -> tuple[Array, Array, Array]:
    """Points of the arc at `t`; of each chord, the distance of its arc and the largest angle to tangents."""
    center, axis_x, axis_y = frame
    middle, half_step = 0.5 * (t[1:] + t[:-1]), 0.5 * (t[1:] - t[:-1])
    points = center + np.outer(np.cos(t), axis_x) + np.outer(np.sin(t), axis_y)
    rays = np.outer(np.cos(middle), axis_x) + np.outer(np.sin(middle), axis_y)
    tangents = np.sign(half_step[0]) * (np.outer(np.cos(t), axis_y) - np.outer(np.sin(t), axis_x))
    chords = np.diff(points, axis=0)
    lengths = np.maximum(np.hypot(*chords.T), np.finfo(float).tiny)
    # Half-way the arc is at `center + ray`, the chord at `center + cos(half_step) ray`.
    distances = np.abs(_cross(chords, rays)) / lengths * (1.0 - np.cos(half_step))
    turns = np.maximum(_angles(chords, tangents[:-1]), _angles(chords, tangents[1:]))
    return points, distances, turns


def bezier(controls: Array, *, tolerance: Tolerance) -> Piece:
    """A Bézier curve, rational or not.

    Args:
        controls: Homogeneous control points `(w x, w y, w)`, shape `(degree + 1, 3)`, with `w > 0`.
        tolerance: Pieces are halved until each keeps it.
    """
    _check_finite(controls)
    points = [_affine(controls)[0]]
    distance = turn = 0.0
    pending = [controls]
    while pending:
        piece = pending.pop()
        plane = _affine(piece)
        extent = float(np.hypot(*np.ptp(plane, axis=0)))
        corner = extent <= _CORNER_SHARE * tolerance.distance
        piece_distance, piece_turn = (extent, 0.0) if corner else _bounds(piece)
        if piece_distance <= tolerance.distance and piece_turn <= tolerance.turn:
            points.append(plane[-1])
            # Below these it is rounding: the piece is straight.
            distance = max(distance, piece_distance if piece_distance > 1e-12 * extent else 0.0)
            turn = max(turn, piece_turn if piece_turn > 1e-9 else 0.0)
        else:
            first, second = _halves(piece[None])
            pending += [second, first]
            _check_count(len(points) + len(pending))
    return Piece(np.array(points), distance, turn)


def spline(controls: Array, knots: Array, *, tolerance: Tolerance) -> list[Piece]:
    """A B-spline: its Bézier pieces, exactly, each made into chords.

    Args:
        controls: Homogeneous control points, shape `(n, 3)`.
        knots: `n + degree + 1` of them, not falling.
        tolerance: Kept by each piece.
    """
    _check_finite(knots)
    degree = len(knots) - len(controls) - 1
    low, high = knots[degree], knots[len(controls)]
    for knot in np.unique(knots[(knots >= low) & (knots <= high)]):
        for _ in range(degree - int(np.sum(knots == knot))):
            controls, knots = _insert(controls, knots, knot, degree)
    distinct = np.unique(knots[(knots >= low) & (knots < high)])
    firsts = [int(np.searchsorted(knots, knot, side="right")) - 1 - degree for knot in distinct]
    return [bezier(controls[first : first + degree + 1], tolerance=tolerance) for first in firsts]


def closed_run(pieces: list[Piece], *, join: float) -> list[Piece]:
    """The pieces of a polyline that comes back to its start, as one; as they are, if they do not meet."""
    pieces = [piece for piece in pieces if piece.length > 0.0]
    if len(pieces) < 2:
        return pieces
    runs = _one_way(pieces)
    for run, after in zip(runs, [*runs[1:], runs[0]], strict=True):
        # An arc ends where the next piece begins, up to rounding.
        if math.dist(run[-1], after[0]) > min(1e-6 * join, 1e-6 * math.dist(run[-1], run[-2])):
            return pieces
        run[-1] = after[0]
    points = np.concatenate([runs[0], *(run[1:] for run in runs[1:])])
    slacks = (max(piece.position_slack for piece in pieces), max(piece.normal_slack for piece in pieces))
    return [Piece(points, *slacks, layer=pieces[0].layer)]


def _one_way(pieces: list[Piece]) -> list[Array]:
    """The points of consecutive pieces, turned so that each begins where the one before it ends."""
    first, after = pieces[0].points, pieces[1].points
    to_start = min(math.dist(first[0], after[0]), math.dist(first[0], after[-1]))
    to_end = min(math.dist(first[-1], after[0]), math.dist(first[-1], after[-1]))
    runs = [first[::-1].copy() if to_start < to_end else first.copy()]
    for piece in pieces[1:]:
        turned = math.dist(runs[-1][-1], piece.points[-1]) < math.dist(runs[-1][-1], piece.points[0])
        runs.append(piece.points[::-1].copy() if turned else piece.points.copy())
    return runs


def _check_finite(numbers: Array) -> None:
    if not np.all(np.isfinite(numbers)):
        raise CurveError("a coordinate is not finite; draw the part anew or delete the damaged line")


def _check_count(count: float) -> None:
    if count > _MOST_CHORDS:
        raise CurveError(f"a curve needs more than {_MOST_CHORDS} chords; raise flattening or turn_deg")


def _insert(controls: Array, knots: Array, knot: float, degree: int) -> tuple[Array, Array]:  # noqa: PLR0917
    """The same spline with one more `knot` (Boehm 1980)."""
    span = min(int(np.searchsorted(knots, knot, side="right")) - 1, len(controls) - 1)
    index = np.arange(span - degree + 1, span + 1)
    width = knots[index + degree] - knots[index]
    share = ((knot - knots[index]) / np.where(width > 0.0, width, 1.0))[:, None]
    between = (1.0 - share) * controls[index - 1] + share * controls[index]
    controls = np.concatenate([controls[: span - degree + 1], between, controls[span:]])
    return controls, np.insert(knots, span + 1, knot)


def _bounds(controls: Array) -> tuple[float, float]:
    """Upper bounds: distance of a Bézier curve from its chord, angle of its tangents to the chord."""
    pieces = controls[None]
    for _ in range(_REFINEMENTS):
        pieces = _halves(pieces)
    plane = _affine(pieces)
    start, chord = plane[0, 0], plane[-1, -1] - plane[0, 0]
    length = float(np.hypot(*chord))
    extent = float(np.hypot(*np.ptp(plane.reshape(-1, 2), axis=0)))
    if length <= 1e-9 * extent or extent == 0.0:
        return extent, math.pi if extent > 0.0 else 0.0
    along = np.clip((plane - start) @ chord / length**2, 0.0, 1.0)[..., None]
    distance = np.max(np.linalg.norm(plane - start - along * chord, axis=-1))
    first, second = np.triu_indices(plane.shape[1], k=1)
    vectors = (plane[:, second] - plane[:, first]).reshape(-1, 2)
    vectors = vectors[np.hypot(*vectors.T) > 1e-9 * extent]
    return float(distance), float(np.max(_angles(np.broadcast_to(chord, vectors.shape), vectors)))


def _halves(pieces: Array) -> Array:
    """Each Bézier curve of `(m, degree + 1, 3)` cut in two (de Casteljau), in order."""
    left, right = [pieces[:, 0]], [pieces[:, -1]]
    while pieces.shape[1] > 1:
        pieces = 0.5 * (pieces[:, :-1] + pieces[:, 1:])
        left.append(pieces[:, 0])
        right.append(pieces[:, -1])
    both = np.stack([np.stack(left, axis=1), np.stack(right[::-1], axis=1)], axis=1)
    return both.reshape(-1, *both.shape[2:])


def _affine(controls: Array) -> Array:
    return controls[..., :2] / controls[..., 2:]


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _angles(a: Array, b: Array) -> Array:
    return np.abs(np.arctan2(_cross(a, b), np.sum(a * b, axis=-1)))
