"""Drawn pieces joined to outlines, and outlines sorted into parts.

What lies on no closed run (a bridge of the graph of ends) can't be outline beside closed ones. What is left
must be plain loops: else it is not clear which are meant.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from palpate.curves import Array, Chords, Piece, Tolerance, thinned
from palpate.end_graph import Ends, bridges, connected, near_pairs

# An open run that misses closing by less than this share of its length was meant to be closed.
_NEARLY_CLOSED = 0.02
# A rectangle around a single thing that fills this share of it may be the frame of the sheet.
_FRAME_SHARE = 0.4


class OutlineError(ValueError):
    """Lines of which no outline can be made without guessing."""


@dataclass
class Drawing:
    """What was read of a drawing, in the models' unit."""

    pieces: list[Piece] = field(default_factory=list[Piece])
    notes: list[str] = field(default_factory=list[str])
    layered: bool = False
    """Whether `layers=` can choose among the pieces."""


@dataclass
class Shape:
    """A part as it was drawn."""

    loops: list[Array]
    """The outer outline, then its holes; if it isn't closed, its open chains."""
    closed: bool
    position_slack: float = 0.0
    normal_slack: float = 0.0
    notes: list[str] = field(default_factory=list[str])
    """What was mended or left out."""


@dataclass
class _Run:
    """Pieces end to end."""

    chords: Chords
    layers: Counter[str]
    gap: float = 0.0
    """Largest distance between ends that were joined."""

    @property
    def points(self) -> Array:
        return self.chords.points

    @property
    def count(self) -> int:
        """Of its pieces."""
        return self.layers.total()


def shapes_of(drawing: Drawing, *, tolerance: Tolerance) -> list[Shape]:
    """The parts that a drawing shows, from left to right.

    Ends closer than `tolerance.distance` are one. What is closed is an outline, or a hole of that around it.
    Where nothing is closed, all of it is one part of loose faces, outward on their right. None if there is
    nothing.

    Raises:
        OutlineError: If lines branch so that it is not clear which are the outline, or an outline is open.
    """
    notes: list[str] = []
    remedy = "name the layers of the part with layers=, or delete" if drawing.layered else "delete"
    pieces = _drawn(drawing.pieces, tolerance.distance, notes)
    loops, open_ = _runs(pieces, tolerance, remedy)
    if loops:
        loops = _without_doubles(loops, tolerance.distance, notes)
        if open_:
            _refuse_open_outlines(loops, open_, remedy)
            notes.append(_left_out_note(loops, open_))
        used = loops
    else:
        used = open_
        if open_:
            notes.append(_loose_note(open_))
    gap = max((run.gap for run in used), default=0.0)
    if gap > 1e-9 * tolerance.distance:
        notes.append(f"gaps of up to {gap:.2g} between ends closed; the slacks include them")
    used = _thinned(used, tolerance, notes)
    if loops:
        shapes = _nested(used, remedy, notes)
    else:
        shapes = [_shape(used, closed=False)] if used else []
    for shape in shapes:
        shape.notes += notes
    return sorted(shapes, key=lambda shape: tuple(np.min(shape.loops[0], axis=0)))


# --- what counts ----------------------------------------------------------------------------------


def _drawn(pieces: list[Piece], join: float, notes: list[str]) -> list[Piece]:
    """Without pieces that have no length, and those drawn twice."""
    low = np.min([np.min(piece.points, axis=0) for piece in pieces], axis=0, initial=math.inf)
    high = np.max([np.max(piece.points, axis=0) for piece in pieces], axis=0, initial=-math.inf)
    rounding = 1e-12 * float(np.max(np.abs([low, high]))) if pieces else 0.0
    long = [piece for piece in pieces if piece.extent > rounding]
    if len(long) < len(pieces):
        notes.append(f"{len(pieces) - len(long)} line(s) without length left out")
    kept: list[Piece] = []
    cell = _same_distance(join)
    by_place: dict[tuple[int, ...], list[Piece]] = {}
    for piece in long:
        # Neighbouring cells hold what rounding moves over a border.
        x, y = (int(c) for c in np.floor(np.min(piece.points, axis=0) / cell))
        near = [(len(piece.points), x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        if not any(_same(piece, other, join) for key in near for other in by_place.get(key, [])):
            kept.append(piece)
            by_place.setdefault((len(piece.points), x, y), []).append(piece)
    if len(kept) < len(long):
        notes.append(f"{len(long) - len(kept)} line(s) drawn twice read once")
    return kept


def _same_distance(join: float) -> float:
    """Points this close are drawn as one: what files with few digits make of it."""
    return 1e-3 * join


def _same(a: Piece, b: Piece, join: float) -> bool:
    # Fine chords lie close to each other without being the same.
    limit = min(_same_distance(join), 0.25 * min(a.extent, b.extent))
    return any(float(np.max(np.abs(a.points - points))) <= limit for points in (b.points, b.points[::-1]))


def _without_doubles(loops: list[_Run], join: float, notes: list[str]) -> list[_Run]:
    """Without outlines that are drawn twice, say as a polyline and as lines."""
    kept: list[_Run] = []
    lows: list[Array] = []
    for loop in loops:
        low = np.min(loop.points, axis=0)
        limit = min(_same_distance(join), 1e-3 * float(np.max(np.ptp(loop.points, axis=0))))
        near = np.flatnonzero(np.max(np.abs(np.reshape(lows, (-1, 2)) - low), axis=1) <= limit)
        if not any(_same_outline(loop.points, kept[k].points, limit) for k in near):
            kept.append(loop)
            lows.append(low)
    if len(kept) < len(loops):
        notes.append(f"{len(loops) - len(kept)} outline(s) drawn twice read once")
    return kept


# --- runs -----------------------------------------------------------------------------------------


def _runs(pieces: list[Piece], tolerance: Tolerance, remedy: str) -> tuple[list[_Run], list[_Run]]:
    """Closed runs, and open ones as far as no other line meets them."""
    join = tolerance.distance
    closed = [piece for piece in pieces if piece.closed]
    others = [piece for piece in pieces if not piece.closed]
    loops = [_Run(Chords.of(piece), Counter({piece.layer: 1})) for piece in closed]
    if not others:
        return loops, []
    ends = Ends(others, same=_same_distance(join), join=join)
    cut = bridges(ends.of_piece)
    at_node = ends.at_node(k for k in range(len(others)) if not cut[k])
    for node, meeting in at_node.items():
        if len(meeting) > 2:
            _refuse_branch(ends.point(node), [others[k] for k in meeting], remedy)
    used = cut.copy()
    for k in range(len(others)):
        if not used[k]:
            loops.append(_joined(_followed(k, ends, at_node, used), others, ends, tolerance))
    used = [not on_bridge for on_bridge in cut]
    at_node = ends.at_node(k for k in range(len(others)) if cut[k])
    open_ = [
        _joined(_followed(k, ends, at_node, used), others, ends, tolerance)
        for k in range(len(others))
        if not used[k]
    ]
    return loops, open_


def _refuse_branch(point: Array, meeting: Sequence[Piece], remedy: str) -> None:
    layers = sorted({piece.layer for piece in meeting if piece.layer})
    of_layers = f" (layers {', '.join(layers)})" if len(layers) > 1 else ""
    raise OutlineError(
        f"{len(meeting)} lines{of_layers} meet at {_at(point)}, and each could be part of the outline; "
        f"{remedy} the lines that are not"
    )


def _followed(  # noqa: PLR0917
    first: int, ends: Ends, at_node: dict[int, list[int]], used: list[bool]
) -> list[tuple[int, bool]]:
    """Pieces from one to the next, each with whether it runs along; they are now used."""
    used[first] = True
    head, tail = ends.of_piece[first]
    members = [(first, True)]

    def following(node: int, other_end: int) -> int | None:
        if node == other_end or len(at_node[node]) != 2:
            return None
        found = next((k for k in at_node[node] if not used[k]), None)
        if found is not None:
            used[found] = True
        return found

    while (k := following(tail, head)) is not None:
        start, end = ends.of_piece[k]
        members.append((k, start == tail))
        tail = end if start == tail else start
    before: list[tuple[int, bool]] = []
    while (k := following(head, tail)) is not None:
        start, end = ends.of_piece[k]
        before.append((k, end == head))
        head = start if end == head else end
    return before[::-1] + members


def _joined(  # noqa: PLR0917
    members: list[tuple[int, bool]], pieces: list[Piece], ends: Ends, tolerance: Tolerance
) -> _Run:
    """One run through the pieces, their ends moved to the nodes or joined to them by a short chord."""
    runs: list[Chords] = []
    gap = 0.0
    for k, along in members:
        piece = pieces[k]
        start, end = (ends.point(node) for node in ends.of_piece[k])
        chords, moved = Chords.of(piece).with_ends(start, end, turn=tolerance.turn)
        gap = max(gap, moved)
        runs.append(chords if along else chords.reversed())
    layers = Counter(pieces[k].layer for k, _ in members)
    return _Run(Chords.joined(runs), layers, gap)


def _thinned(runs: list[_Run], tolerance: Tolerance, notes: list[str]) -> list[_Run]:
    """Runs of fine chords made coarser, as far as curves may be."""
    coarse = [replace(run, chords=thinned(run.chords, tolerance)) for run in runs]
    before, after = (sum(len(run.points) for run in all_) for all_ in (runs, coarse))
    if after < before:
        notes.append(f"{before - after} point(s) of finely drawn runs dropped; the slacks include it")
    return coarse


# --- what is left out -----------------------------------------------------------------------------


def _left_out_note(loops: list[_Run], open_: list[_Run]) -> str:
    note = f"{sum(run.count for run in open_)} open line(s) left out, since there are closed ones"
    if len({layer for run in [*loops, *open_] for layer in run.layers}) > 1:
        layers = sum((run.layers for run in open_), Counter[str]())
        note += ": " + ", ".join(
            f"{count} on layer {layer}" for layer, count in sorted(layers.items()) if layer
        )
    return note


def _loose_note(open_: list[_Run]) -> str:
    lines = sum(run.count for run in open_)
    note = f"nothing closed: {lines} open line(s) read as loose faces, outward on their right"
    openings = _openings(open_)
    if openings and lines > 1:
        distance, a, b = openings[0]
        note += (
            f"; the ends {_at(a)} and {_at(b)} are {distance:.3g} apart: close them if an outline is meant"
        )
    return note


def _openings(open_: list[_Run]) -> list[tuple[float, Array, Array]]:
    """Pairs of ends that nearly meet, the nearest first, with their distance."""
    ends = np.concatenate([run.points[[0, -1]] for run in open_])
    reach = _NEARLY_CLOSED * float(np.max(np.ptp(np.concatenate([run.points for run in open_]), axis=0)))
    long = [float(np.sum(run.chords.lengths)) * _NEARLY_CLOSED for run in open_]
    pairs = near_pairs(ends, reach)
    return [(d, ends[a], ends[b]) for d, a, b in pairs if d > 0.0 and (a // 2 != b // 2 or d <= long[a // 2])]


def _refuse_open_outlines(loops: list[_Run], open_: list[_Run], remedy: str) -> None:
    """Refuses open lines that nearly close around what is closed: an outline with a gap was meant.

    Without it, its holes would be taken for parts.
    """
    openings = _openings(open_)
    if not openings:
        return
    joints = [np.array([a, b]) for _, a, b in openings]
    outer = [k for k, around in enumerate(_inside_of([loop.points for loop in loops])) if not around]
    for group in connected([*(run.points[[0, -1]] for run in open_), *joints]):
        runs = [open_[k] for k in group if k < len(open_)]
        gaps = [openings[k - len(open_)] for k in group if k >= len(open_)]
        points = np.concatenate([run.points for run in runs])
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        closes = len(runs) == 1 and runs[0].count > 1
        encloses = any(
            np.all(np.min(loops[k].points, axis=0) > low) and np.all(np.max(loops[k].points, axis=0) < high)
            for k in outer
        )
        if gaps and (closes or (encloses and sum(run.count for run in runs) > 2)):
            distance, a, b = gaps[0]
            raise OutlineError(
                f"an outline is open: its ends {_at(a)} and {_at(b)} are {distance:.3g} apart; "
                f"close it, raise flattening, or {remedy} it if it is no outline"
            )


# --- parts ----------------------------------------------------------------------------------------


def _shape(runs: list[_Run], *, closed: bool) -> Shape:
    position_slack = max(float(np.max(run.chords.position)) for run in runs)
    normal_slack = max(float(np.max(run.chords.normal)) for run in runs)
    return Shape([run.points for run in runs], closed, position_slack, normal_slack)


def _nested(loops: list[_Run], remedy: str, notes: list[str]) -> list[Shape]:
    """Each loop inside an even number of others, with those just inside it."""
    around = _inside_of([loop.points for loop in loops])
    within: dict[int, list[int]] = {}
    for k, others in enumerate(around):
        for j in others:
            if len(others) == len(around[j]) + 1:
                within.setdefault(j, []).append(k)
    outers = [k for k, others in enumerate(around) if len(others) % 2 == 0]
    crossed = _crossing_of([loops[k].points for k in outers])
    if crossed is not None:
        raise OutlineError(f"two outlines cross near {_at(crossed)}; {remedy} one of them")
    shapes: list[Shape] = []
    for k in outers:
        holes = within.get(k, [])
        runs = [_turned(loops[k], 1.0), *(_turned(loops[hole], -1.0) for hole in holes)]
        shapes.append(_shape(runs, closed=True))
        if _may_be_frame(loops[k], [loops[hole] for hole in holes], any(hole in within for hole in holes)):
            low, high = np.min(loops[k].points, axis=0), np.max(loops[k].points, axis=0)
            notes.append(
                f"the rectangle from {_at(low)} to {_at(high)} is read as a part, what is in it as holes; "
                f"if it is the frame of the sheet, {remedy} it"
            )
    layers = Counter(layer for k in outers for layer in loops[k].layers)
    if len(layers) > 1:
        said = ", ".join(f"{layer} {count}" for layer, count in sorted(layers.items()))
        notes.append(f"outlines are on several layers ({said}); layers= chooses among them")
    return shapes


def _may_be_frame(outer: _Run, holes: list[_Run], islands: bool) -> bool:
    """Whether a part may be the frame around the drawing of another one."""
    corners = outer.points[:-1]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    if not holes or len(corners) != 4 or not np.all((corners == low) | (corners == high)):
        return False
    filled = max(float(np.max(np.ptp(hole.points, axis=0) / (high - low))) for hole in holes)
    other_layers = all(not set(hole.layers) & set(outer.layers) for hole in holes)
    return islands or other_layers or (len(holes) == 1 and filled >= _FRAME_SHARE)


def _turned(loop: _Run, sense: float) -> _Run:
    """The loop counter-clockwise, or clockwise: a drawing has no opinion on that, so it needs no mention."""
    x, y = (loop.points - loop.points[0]).T
    area = float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    return loop if area * sense >= 0.0 else replace(loop, chords=loop.chords.reversed())


def _at(point: Iterable[float]) -> str:
    return "({}, {})".format(*(f"{x:.6g}" for x in point))


# --- outlines in the plane ------------------------------------------------------------------------


def _inside_of(loops: list[Array]) -> list[list[int]]:
    """For each loop, those around it; judged by its first point, as loops that cross are refused later."""
    lows = np.array([np.min(loop, axis=0) for loop in loops])
    highs = np.array([np.max(loop, axis=0) for loop in loops])
    around: list[list[int]] = []
    for k, loop in enumerate(loops):
        near = np.flatnonzero(np.all((lows <= lows[k]) & (highs >= highs[k]), axis=1))
        around.append([int(j) for j in near if j != k and _contains(loops[j], loop[0])])
    return around


def _contains(outline: Array, point: Array) -> bool:
    a, b = outline[:-1], outline[1:]
    crossed = (a[:, 1] <= point[1]) != (b[:, 1] <= point[1])
    a, b = a[crossed], b[crossed]
    x = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return int(np.sum(x > point[0])) % 2 == 1


def _crossing_of(loops: list[Array]) -> Array | None:
    """A place where two of the loops cross; None if there is none."""
    lows = np.array([np.min(loop, axis=0) for loop in loops]).reshape(-1, 2)
    highs = np.array([np.max(loop, axis=0) for loop in loops]).reshape(-1, 2)
    for k, loop in enumerate(loops):
        near = np.flatnonzero(np.all((lows <= highs[k]) & (highs >= lows[k]), axis=1))
        for j in near[near > k]:
            low, high = np.maximum(lows[k], lows[j]), np.minimum(highs[k], highs[j])
            place = _crossing(_chords_in(loop, low, high), _chords_in(loops[j], low, high))
            if place is not None:
                return place
    return None


def _chords_in(loop: Array, low: Array, high: Array) -> Array:
    """The chords that reach into a box, shape `(n, 2, 2)`."""
    chords = np.stack([loop[:-1], loop[1:]], axis=1)
    return chords[np.all((np.min(chords, axis=1) <= high) & (np.max(chords, axis=1) >= low), axis=1)]


def _crossing(first: Array, second: Array) -> Array | None:
    def sides(points: Array, chords: Array) -> Array:
        """On which side of each chord each point is, shape `(chords, points)`."""
        along, away = chords[:, 1] - chords[:, 0], points[None] - chords[:, :1]
        return np.sign(along[:, :1] * away[..., 1] - along[:, 1:] * away[..., 0])

    # A few rows at a time keep the tables small.
    for row in range(0, len(first), 256):
        some = first[row : row + 256]
        parted = sides(second[:, 0], some) * sides(second[:, 1], some) < 0
        parting = (sides(some[:, 0], second) * sides(some[:, 1], second) < 0).T
        crossing = np.argwhere(parted & parting)
        if len(crossing):
            return np.asarray(np.mean(some[crossing[0, 0]], axis=0))
    return None


def _same_outline(a: Array, b: Array, limit: float) -> bool:
    """Whether the corners of each lie on the other."""
    return all(_farthest_from(points, outline) <= limit for points, outline in ((a, b), (b, a)))


def _farthest_from(points: Array, outline: Array) -> float:
    starts, along = outline[:-1], np.diff(outline, axis=0)
    length_sq = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
    farthest = 0.0
    for point in points:
        share = np.clip(np.sum((point - starts) * along, axis=1) / length_sq, 0.0, 1.0)
        nearest = starts + share[:, None] * along
        farthest = max(farthest, float(np.min(np.hypot(*(nearest - point).T))))
    return farthest
