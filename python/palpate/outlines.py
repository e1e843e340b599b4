"""Drawn pieces joined to outlines, and outlines sorted into parts."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from palpate.curves import Array, Piece


@dataclass
class Drawing:
    """What was read of a drawing, in the models' unit."""

    pieces: list[Piece] = field(default_factory=list[Piece])
    notes: list[str] = field(default_factory=list[str])


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


@dataclass(frozen=True)
class _Chain:
    piece: Piece
    closed: bool


def shapes_of(pieces: list[Piece], *, join: float) -> list[Shape]:
    """The parts that `pieces` draw, from left to right.

    Ends closer than `join` are one. What is closed is an outline, or a hole of the one around it. Where
    nothing is closed, all of it is one part of loose faces, outward on their right. None if there is nothing.
    """
    notes: list[str] = []
    chains = _chains(_distinct(pieces, join, notes), join, notes)
    closed = [chain.piece for chain in chains if chain.closed]
    open_ = [chain.piece for chain in chains if not chain.closed]
    if closed:
        if open_:
            notes.append(f"{len(open_)} open line(s) left out, since there are closed ones")
        shapes = _nested(closed)
    elif open_:
        notes.append(f"nothing closed: {len(open_)} open line(s) read as loose faces, outward on their right")
        shapes = [_shape(open_, closed=False)]
    else:
        shapes = []
    for shape in shapes:
        shape.notes += notes
    return sorted(shapes, key=lambda shape: tuple(np.min(shape.loops[0], axis=0)))


def _shape(pieces: list[Piece], *, closed: bool) -> Shape:
    position_slack = max(piece.position_slack for piece in pieces)
    normal_slack = max(piece.normal_slack for piece in pieces)
    return Shape([piece.points for piece in pieces], closed, position_slack, normal_slack)


def _nested(loops: list[Piece]) -> list[Shape]:
    """Each loop inside an even number of others, with those just inside it."""
    around = [
        [j for j, other in enumerate(loops) if j != k and _contains(other.points, loop.points[0])]
        for k, loop in enumerate(loops)
    ]
    shapes: list[Shape] = []
    for k, loop in enumerate(loops):
        if len(around[k]) % 2 == 0:
            holes = [
                hole
                for j, hole in enumerate(loops)
                if k in around[j] and len(around[j]) == len(around[k]) + 1
            ]
            shapes.append(_shape([_turned(loop, 1.0), *(_turned(hole, -1.0) for hole in holes)], closed=True))
    return shapes


def _turned(loop: Piece, sense: float) -> Piece:
    """The loop counter-clockwise, or clockwise: a drawing has no opinion on that, so it needs no mention."""
    x, y = (loop.points - loop.points[0]).T
    area = float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    return loop if area * sense >= 0.0 else replace(loop, points=loop.points[::-1])


def _contains(outline: Array, point: Array) -> bool:
    a, b = outline, np.roll(outline, -1, axis=0)
    crossed = (a[:, 1] <= point[1]) != (b[:, 1] <= point[1])
    a, b = a[crossed], b[crossed]
    x = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return int(np.sum(x > point[0])) % 2 == 1


def _distinct(pieces: list[Piece], join: float, notes: list[str]) -> list[Piece]:
    """Without pieces that are too small to have ends, and those drawn twice."""
    long = [piece for piece in pieces if float(np.max(np.ptp(piece.points, axis=0))) > join]
    if len(long) < len(pieces):
        notes.append(f"{len(pieces) - len(long)} line(s) shorter than {join:g} left out")
    kept: list[Piece] = []
    by_shape: dict[tuple[int, ...], list[Piece]] = {}
    for piece in long:
        # Neighbouring cells hold what rounding moves over a border.
        low = np.min(piece.points, axis=0)
        cell = tuple(int(c) for c in np.floor(low / join))
        near = [(len(piece.points), cell[0] + i, cell[1] + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        if not any(_same(piece, other, join) for key in near for other in by_shape.get(key, [])):
            kept.append(piece)
            by_shape.setdefault((len(piece.points), *cell), []).append(piece)
    if len(kept) < len(long):
        notes.append(f"{len(long) - len(kept)} line(s) drawn twice read once")
    return kept


def _same(a: Piece, b: Piece, join: float) -> bool:
    return any(float(np.max(np.abs(a.points - points))) <= join for points in (b.points, b.points[::-1]))


def _chains(pieces: list[Piece], join: float, notes: list[str]) -> list[_Chain]:
    """Pieces that follow one another, end to end, as far as no other meets them there."""
    nodes = _Nodes(join)
    ends = [(nodes.at(piece.points[0]), nodes.at(piece.points[-1])) for piece in pieces]
    at_node: dict[int, list[int]] = {}
    for k, (start, end) in enumerate(ends):
        at_node.setdefault(start, []).append(k)
        at_node.setdefault(end, []).append(k)

    used = [False] * len(pieces)
    chains: list[_Chain] = []
    gap = 0.0
    for k, (head, tail) in enumerate(ends):
        if used[k]:
            continue
        used[k] = True
        members = [(k, True)]
        while (following := _following(tail, head, at_node, used)) is not None:
            first, last = ends[following]
            members.append((following, first == tail))
            tail = last if first == tail else first
        while (following := _following(head, tail, at_node, used)) is not None:
            first, last = ends[following]
            members.insert(0, (following, last == head))
            head = first if last == head else last
        joined = _joined([(pieces[j], ends[j], along) for j, along in members], nodes)
        gap = max(gap, joined.gap)
        chains.append(_Chain(joined.piece, head == tail))
    if gap > 1e-9 * join:
        notes.append(f"gaps of up to {gap:.2g} between ends closed; the slacks include them")
    return chains


def _following(node: int, other_end: int, at_node: dict[int, list[int]], used: list[bool]) -> int | None:  # noqa: PLR0917
    """The piece that goes on at `node`, now used; None at the end, at a branch, or if the chain is closed."""
    if node == other_end or len(at_node[node]) != 2:
        return None
    following = next((j for j in at_node[node] if not used[j]), None)
    if following is not None:
        used[following] = True
    return following


@dataclass(frozen=True)
class _Joined:
    piece: Piece
    gap: float


def _joined(members: list[tuple[Piece, tuple[int, int], bool]], nodes: _Nodes) -> _Joined:
    """One run through the pieces, their ends moved to the nodes; the slacks include what that changes."""
    runs: list[Array] = []
    gap = position_slack = normal_slack = 0.0
    for piece, (start, end), along in members:
        points = piece.points.copy()
        points[0], points[-1] = nodes.points[start], nodes.points[end]
        moved = float(np.max(np.hypot(*(points - piece.points).T)))
        before, after = np.diff(piece.points, axis=0), np.diff(points, axis=0)
        cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        turned = (
            float(np.max(np.abs(np.arctan2(cross, np.sum(before * after, axis=1))))) if moved > 0.0 else 0.0
        )
        gap = max(gap, moved)
        position_slack = max(position_slack, piece.position_slack + moved)
        normal_slack = max(normal_slack, piece.normal_slack + turned)
        run = points if along else points[::-1]
        runs.append(run[1:] if runs else run)
    return _Joined(Piece(np.concatenate(runs), position_slack, normal_slack), gap)


class _Nodes:
    """Ends of pieces; those within `join` of the first one there are one node."""

    def __init__(self, join: float) -> None:
        self.points: list[Array] = []
        self._join = join
        self._cells: dict[tuple[int, int], list[int]] = {}

    def at(self, point: Array) -> int:
        """The number of the node at `point`."""
        x, y = (int(c) for c in np.floor(point / self._join))
        near = [k for i in (-1, 0, 1) for j in (-1, 0, 1) for k in self._cells.get((x + i, y + j), [])]
        within = [k for k in near if float(np.hypot(*(self.points[k] - point))) <= self._join]
        if within:
            return min(within, key=lambda k: (float(np.hypot(*(self.points[k] - point))), k))
        self.points.append(point)
        self._cells.setdefault((x, y), []).append(len(self.points) - 1)
        return len(self.points) - 1
