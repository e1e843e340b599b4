"""A recorded run as the states of a session, one for each guarded move."""

from __future__ import annotations

from dataclasses import replace

from palpate.loop.result import PURPOSES, Result
from palpate.probe import Hit
from palpate.view.state import Left, Move, State


def states_of(result: Result, first: State) -> list[State]:
    """What was known before each guarded move, with the path that was planned, and what is left in the end.

    Args:
        result: Of `palpate.replay` or `palpate.identify`.
        first: The state before the first move: contacts and misses that were given.
    """
    num_given = len(first.contacts)
    known: Left | None = None
    moves: list[Move] = []
    states: list[State] = []
    num_hits = 0
    for number, step in enumerate([*result.steps, None]):
        contacts = tuple(result.contacts[: num_given + num_hits])
        path = None if step is None else step.path
        said = f"{result.status.replace('_', ' ')}: {result.reason}"
        if step is not None:
            said = f"before guarded move {number + 1} ({PURPOSES[step.purpose]})"
            if known is not None:
                said += f": {len(known.hypotheses)} left"
        elif result.found is not None:
            found = result.found
            known = Left(
                found.hypotheses, found.complete, found.stopped_by, found.conflict, len(found.refuted)
            )
        states.append(
            replace(
                first,
                said=said,
                contacts=contacts,
                moves=tuple(moves),
                left=known,
                path=path,
                why=None if path is None else "recorded",
            )
        )
        if step is None:
            break
        moves.append(Move(step.start, step.end, step.reply, step.purpose))
        num_hits += isinstance(step.reply, Hit)
        if step.hypotheses is not None:
            known = Left(step.hypotheses)
    return states
