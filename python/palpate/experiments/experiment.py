"""What an experiment is: tasks that are computed one by one, and how their rows are told."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from palpate.experiments.campaign import Row

Answer = TypeVar("Answer")

SEEDS = 10**9  # numbers of problems that a seed has


@dataclass(frozen=True)
class Picture:
    """A drawing that belongs to an experiment."""

    name: str
    """Of its file, without the suffix."""
    svg: bytes
    caption: str
    """Markdown."""


def _no_pictures(rows: list[Row]) -> list[Picture]:
    del rows
    return []


@dataclass(frozen=True)
class Experiment:
    """One of `palpate experiment`; `campaign.run` computes its rows."""

    title: str
    task: Callable[..., Row]
    """`task(number, **settings)`; number `s * SEEDS + k * groups + g` is problem k of kind g with seed s."""
    table: Callable[[list[Row]], str]
    """Markdown: the tables, and what is to be known of them."""
    groups: int
    """Kinds of problems."""
    repeats: int | None = None
    """Problems of each kind, unless other many are asked for. None: its problems are fixed, one of a kind."""
    settings: dict[str, Any] = field(default_factory=dict[str, Any])
    """What the task is given, beside its number."""
    pictures: Callable[[list[Row]], list[Picture]] = _no_pictures
    of_thesis: bool = True
    """Whether it is part of `palpate experiment all`."""

    def numbers(self, problems: int | None = None, *, seed: int = 0) -> range:
        """Of the tasks, if each kind has so many problems; those of fewer are the first of them."""
        repeats = 1 if self.repeats is None else self.repeats if problems is None else problems
        return range(seed * SEEDS, seed * SEEDS + self.groups * repeats)


def timed(work: Callable[[], Answer], *, runs: int = 1) -> tuple[Answer, float]:
    """The answer, and the CPU seconds that it took, of all threads: the median of so many runs.

    The thesis's times are such too, and what else the machine does counts less.
    """
    times: list[float] = []
    while True:
        began = time.process_time()
        answer = work()
        times.append(time.process_time() - began)
        if len(times) >= runs:
            return answer, sorted(times)[len(times) // 2]
