"""Of simulations, where the truth is known: whether it is among what is left."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from palpate._core import Hypothesis, Model


def number_of_truth(
    hypotheses: Sequence[Hypothesis], truth: Model, world_from_truth: ArrayLike
) -> int | None:
    """The number, from 0, of the first hypothesis that holds the true part and pose; None: none does."""
    for number, one in enumerate(hypotheses):
        if one.model == truth and one.poses.contains(world_from_truth):
            return number
    return None
