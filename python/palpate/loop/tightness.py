"""How tight the poses of the last hypothesis are, and whether touches still make them tighter."""

from __future__ import annotations

from palpate._core import Hypothesis

# HEURISTIC: on small arcs touches may tell nothing, and then one does. In five runs on parts with arcs no
# more than six in a row told nothing before one did.
PATIENCE = 10
GAIN = 0.01  # a share of the least so far; the enclosure of a pose set varies by about as much


class Tightness:
    """Against what was asked: a shift of any corner, and a turn."""

    def __init__(self, until: tuple[float, float]) -> None:
        self._until = until
        self._least: tuple[float, float] | None = None
        self._in_vain = 0

    def reached(self, last: Hypothesis) -> bool:
        """Whether no two of its poses differ by more than was asked."""
        shift, turn = self._excess(last)
        return shift <= 1.0 and turn <= 1.0

    def in_vain(self, last: Hypothesis) -> bool:
        """Asked once after each touch: whether as many as `PATIENCE` in a row have made neither less.

        What is as small as was asked need not get less.
        """
        excess = tuple(max(1.0, ratio) for ratio in self._excess(last))
        least = self._least or excess
        gained = any(now < (1.0 - GAIN) * before for now, before in zip(excess, least, strict=True))
        self._in_vain = 0 if gained or self._least is None else self._in_vain + 1
        self._least = (min(excess[0], least[0]), min(excess[1], least[1]))
        return self._in_vain >= PATIENCE

    def _excess(self, last: Hypothesis) -> tuple[float, float]:
        """Shift and turn, each in what was asked."""
        shift = max(last.poses.excursion(vertex) for vertex in last.model.vertices)
        return shift / self._until[0], last.poses.rotation_bound / self._until[1]
