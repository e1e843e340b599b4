"""The tip on its way: guarded moves, the free moves between them, and what was answered."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from palpate._core import Miss
from palpate.loop.entries import Event, check_dimension, reply_event, reply_in
from palpate.loop.journal import Journal
from palpate.loop.possible import impossible
from palpate.loop.result import Purpose, stop_of
from palpate.loop.route import Array, length_of, nearest_on_border, on_border, rest_of
from palpate.loop.settings import Settings
from palpate.probe import Fault, Probe, Reply, UnexpectedTouch
from palpate.probe.simulated import point_of

Answer = TypeVar("Answer")


class _Raised(Exception):
    """The probe raised an exception of its own."""


class Tour:
    """Moves a probe, by way of the journal: what that knows is not asked again."""

    def __init__(
        self, settings: Settings, probe: Probe | None, journal: Journal, *, position: Array | None
    ) -> None:
        self._settings = settings
        self._workspace = settings.workspace
        self._slack = (
            settings.sensor.position_error
            + settings.moved.path_error
            + settings.margin * max(model.size for model in settings.models)
        )
        self._probe = probe
        self._journal = journal
        self._at = position
        self._back: Array | None = None
        self._asked = False
        self.travel = 0.0

    def go_to(self, start: Array) -> tuple[list[Array], UnexpectedTouch | Fault | None]:
        """Bring the tip to where a guarded move begins: back as it came, and along the perimeter."""
        if self._at is None:
            return [], None
        points: list[Array] = [] if self._back is None else [self._back]
        outside = points[-1] if points else self._at
        nearest = nearest_on_border(self._workspace, outside)
        if nearest is None:
            raise ValueError(
                f"probe: its tip is at {outside.tolist()}, in the workspace; bring it to the border first"
            )
        points += [] if np.array_equal(nearest, outside) or on_border(self._workspace, outside) else [nearest]
        points += self._settings.dimension.route(self._workspace, nearest, start, self._settings.directions)
        if not points:
            return [], None
        self._journal.record({"event": "move", "points": [point.tolist() for point in points]})
        way = [self._at, *points]
        reply = self._answered(lambda: self._moved(way))
        if reply is not None:
            if not isinstance(reply, UnexpectedTouch | Fault):
                raise ValueError(
                    f"probe: a free move was answered {reply!r}; it must be None, UnexpectedTouch or Fault"
                )
            return points, reply
        self.travel += length_of(way)
        self._at, self._back = start, None
        return points, None

    def touch(self, start: Array, end: Array, purpose: Purpose) -> Reply:
        """Make the guarded move; the tip is at its start."""
        event: Event = {"event": "touch", "purpose": purpose, "start": start.tolist(), "end": end.tolist()}
        self._journal.record(event)
        if not self._journal.live and self._probe is not None:
            # Errors of a simulated probe depend on how often it made the move: so it must know of this one.
            made = getattr(self._probe, "made", None)
            if made is not None:
                made(start, end)
        reply = self._answered(lambda: self._touched(start, end))
        if reply is None:
            raise ValueError("probe: a guarded move was answered by nothing; it must answer a reply")
        problem = impossible(reply, start, end, settings=self._settings)
        if problem is not None:
            reply = Fault(f"what it answered is impossible: {problem}")
        went_to = stop_of(reply, end)
        stopped = start if went_to is None else went_to
        self.travel += math.dist(start, stopped)
        self._at = stopped
        may_rest = self._settings.dimension.is_open(self._workspace, end, self._settings.directions)
        on_far_side = isinstance(reply, Miss) and may_rest
        self._back = None if on_far_side else start
        return reply

    def _answered(self, question: Callable[[], Reply | None]) -> Reply | None:
        """The known reply, or that of the probe; what the probe raises is a fault of it."""

        def asked() -> Event:
            try:
                reply = question()
            except _Raised as raised:
                reply = Fault(str(raised))
            check_dimension(reply, self._workspace.shape[1])
            return reply_event(reply)

        return reply_in(self._journal.answer(asked))

    def _moved(self, way: list[Array]) -> UnexpectedTouch | Fault | None:
        points = self._taken_up(way)
        return self._ask(lambda probe: probe.move(np.array(points))) if points else None

    def _touched(self, start: Array, end: Array) -> Reply:
        # Stopped on its way: it goes back as it came.
        if self._taken_up([start, end]):
            position = self._position()
            if position is not None and not np.array_equal(position, start):
                failed = self._ask(lambda probe: probe.move(np.array([start])))
                if failed is not None:
                    return failed
        return self._ask(lambda probe: probe.touch(start, end))

    def _ask(self, question: Callable[[Probe], Answer]) -> Answer:
        """What the probe answers.

        Raises:
            _Raised: What it raised; Ctrl-C and its like are not the probe's and end the program.
        """
        try:
            return question(self._live())
        except Exception as error:
            raise _Raised(f"it raised {type(error).__name__}: {error}") from error

    def _live(self) -> Probe:
        assert self._probe is not None
        return self._probe

    def _position(self) -> Array | None:
        position = self._ask(lambda probe: probe.position)
        return None if position is None else point_of("probe.position", position, self._workspace.shape[1])

    def _taken_up(self, way: list[Array]) -> list[Array]:
        """What is left of a way: a run that was killed may have stopped on it."""
        first, self._asked = not self._asked, True
        position = self._position() if first else None
        if position is None:
            return way[1:]
        rest = rest_of(way, position, within=self._slack)
        if rest is None:
            raise ValueError(
                f"probe: its tip is at {position.tolist()}, and the run goes on from {way[0].tolist()}; "
                "bring it there first"
            )
        return rest
