"""The graph of drawn pieces: its edges are the pieces, its nodes their ends, those that are one united."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from palpate.curves import Array, Piece


class Ends:
    """Ends of open pieces; those that are one are a node."""

    def __init__(self, pieces: list[Piece], *, same: float, join: float) -> None:
        self._points = np.array([piece.points[k] for piece in pieces for k in (0, -1)])
        self._parent = list(range(len(self._points)))
        self._lengths = [piece.length for piece in pieces]
        # Ends of fine chords are nearer to each other than what is drawn as one point elsewhere.
        reach = np.repeat([min(same, 0.25 * piece.extent) for piece in pieces], 2).tolist()
        for distance, a, b in near_pairs(self._points, same):
            first, second = sorted((self._root(a), self._root(b)))
            if distance <= min(reach[first], reach[second]):
                self._parent[second] = first
                reach[first] = min(reach[first], reach[second])
        self._close_gaps(join)
        self.of_piece = [(self._root(2 * k), self._root(2 * k + 1)) for k in range(len(pieces))]

    def point(self, node: int) -> Array:
        """Where a node is: at the end that was drawn first."""
        return np.asarray(self._points[node])

    def at_node(self, pieces: Iterable[int]) -> dict[int, list[int]]:
        """The pieces that end at each node; twice, if both ends are there."""
        found: dict[int, list[int]] = {}
        for k in pieces:
            for node in self.of_piece[k]:
                found.setdefault(node, []).append(k)
        return found

    def _root(self, end: int) -> int:
        while self._parent[end] != end:
            self._parent[end] = self._parent[self._parent[end]]
            end = self._parent[end]
        return end

    def _close_gaps(self, join: float) -> None:
        """Unites ends that nothing meets: with each other, the nearest first, then with what is nearest."""
        meeting: dict[int, list[int]] = {}
        for end in range(len(self._points)):
            meeting.setdefault(self._root(end), []).append(end)
        nodes = sorted(meeting)
        if all(len(meeting[node]) > 1 for node in nodes):
            return
        pairs = [(nodes[i], nodes[j]) for _, i, j in near_pairs(self._points[nodes], join)]
        behind = self._loose(meeting, pairs, join)
        loose = set(behind)
        for a, b in pairs:
            if a in loose and b in loose and a not in behind[b] and b not in behind[a]:
                self._parent[b] = a
                loose -= {a, b}
        for a, b in pairs:
            for end, other in ((a, b), (b, a)):
                if end in loose and other not in behind[end]:
                    self._parent[end] = self._root(other)
                    loose.discard(end)

    def _loose(
        self, meeting: dict[int, list[int]], pairs: list[tuple[int, int]], join: float
    ) -> dict[int, set[int]]:
        """The nodes that wait for another one near them, with those that they must not be united with.

        Those are nodes back along their own run, whose chords may be as fine as the gap. A line that ends in
        the open, with nothing near, does not count where it touches an outline.
        """
        near: dict[int, set[int]] = {}
        for a, b in pairs:
            near.setdefault(a, set()).add(b)
            near.setdefault(b, set()).add(a)
        meeting = {node: list(ends) for node, ends in meeting.items()}
        found: dict[int, set[int]] = {}
        pending = [node for node, ends in sorted(meeting.items()) if len(ends) == 1]
        while pending:
            node = pending.pop()
            if not meeting[node]:
                continue
            behind = self._behind(node, meeting, 4.0 * join)
            if near.get(node, set()) - behind:
                found[node] = behind
                continue
            end = meeting[node][0]
            other = self._root(end ^ 1)
            meeting[other].remove(end ^ 1)
            if len(meeting[other]) == 1 and self._lengths[end // 2] > join:
                pending.append(other)
        return found

    def _behind(self, node: int, meeting: dict[int, list[int]], reach: float) -> set[int]:
        """The nodes along the run that ends at `node`, as far as `reach`."""
        found: set[int] = set()
        end = meeting[node][0]
        walked = self._lengths[end // 2]
        while walked <= reach:
            node = self._root(end ^ 1)
            if node in found:
                break
            found.add(node)
            going_on = [other for other in meeting[node] if other != end ^ 1]
            if len(going_on) != 1:
                break
            end = going_on[0]
            walked += self._lengths[end // 2]
        return found


def near_pairs(points: Array, reach: float) -> list[tuple[float, int, int]]:
    """Pairs of points no farther apart than `reach`, with their distance, the nearest first."""
    cells: dict[tuple[int, int], list[int]] = {}
    places = points.tolist()
    pairs: list[tuple[float, int, int]] = []
    for b, key in enumerate(np.floor(points / reach).astype(int).tolist()):
        x, y = key
        for i, j in [(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]:
            for a in cells.get((i, j), ()):
                distance = math.dist(places[a], places[b])
                if distance <= reach:
                    pairs.append((distance, a, b))
        cells.setdefault((x, y), []).append(b)
    return sorted(pairs)


def bridges(edges: list[tuple[int, int]]) -> list[bool]:
    """Which edges lie on no closed run (Tarjan 1974, without recursion)."""
    at_node: dict[int, list[int]] = {}
    for k, nodes in enumerate(edges):
        for node in nodes:
            at_node.setdefault(node, []).append(k)
    order: dict[int, int] = {}
    lowest: dict[int, int] = {}
    cut = [False] * len(edges)
    for root in at_node:
        if root in order:
            continue
        order[root] = lowest[root] = len(order)
        stack = [(root, -2, iter(at_node[root]))]
        while stack:
            node, came_by, going_on = stack[-1]
            k = next(going_on, -1)
            if k < 0:
                stack.pop()
                if stack:
                    parent = stack[-1][0]
                    lowest[parent] = min(lowest[parent], lowest[node])
                    cut[came_by] = lowest[node] > order[parent]
            elif k != came_by:
                other = edges[k][1] if edges[k][0] == node else edges[k][0]
                if other in order:
                    lowest[node] = min(lowest[node], order[other])
                else:
                    order[other] = lowest[other] = len(order)
                    stack.append((other, k, iter(at_node[other])))
    return cut


def connected(runs: list[Array]) -> list[list[int]]:
    """Groups of runs whose end points, exactly the same, hold together."""
    group_at: dict[tuple[float, ...], set[int]] = {}
    groups: dict[int, set[int]] = {}
    for k, ends in enumerate(runs):
        group = {k}
        for end in ends:
            group |= group_at.get(tuple(end.tolist()), set())
        for j in group:
            groups[j] = group
            for end in runs[j]:
                group_at[tuple(end.tolist())] = group
    return [sorted(group) for group in {id(group): group for group in groups.values()}.values()]
