"""Whether a reply can be of its guarded move at all; what is only out of bounds is left to recognition."""

from __future__ import annotations

import math

import numpy as np

from palpate._core import Miss
from palpate.loop.route import Array
from palpate.loop.settings import Settings
from palpate.probe import Hit, Reply, Skid

# HEURISTIC: a contact that is farther off its line than both is of another move, frame or unit.
TIMES_ITS_BOUNDS = 10.0
OF_THE_SIZE = 0.1  # of the largest part


def impossible(reply: Reply, start: Array, end: Array, *, settings: Settings) -> str | None:
    """Why a reply can't be of the move from `start` to `end`; None: it can."""
    path_error = settings.moved.path_error
    size = max(model.size for model in settings.models)
    slack = settings.sensor.position_error + path_error + settings.margin * size
    if isinstance(reply, Hit):
        contact = reply.contact
        most = max(TIMES_ITS_BOUNDS * (contact.position_error + path_error), OF_THE_SIZE * size)
        if _distance(contact.center, start, end) > most:
            return f"the contact at {contact.center.tolist()} is nowhere near the line of its move"
        begin = contact.start
        if begin is not None and _distance(begin, start, end) > slack + contact.position_error:
            return f"the contact's start at {begin.tolist()} is not on the line of its move"
    if isinstance(reply, Miss):
        reach = slack + reply.path_error
        if math.dist(reply.start, start) > reach or math.dist(reply.end, end) > reach:
            return (
                f"a miss from {reply.start.tolist()} to {reply.end.tolist()} is not one of the whole move; "
                "it must be, or a Skid with its free part"
            )
    if isinstance(reply, Skid):
        reach = slack + reply.free.path_error
        if any(_distance(place, start, end) > reach for place in (reply.free.start, reply.free.end)):
            ends = f"{reply.free.start.tolist()} to {reply.free.end.tolist()}"
            return f"the free part from {ends} is not on the line of its move"
    return None


def _distance(place: Array, start: Array, end: Array) -> float:
    """Of a place from the way between two others."""
    way = end - start
    share = float(np.clip((place - start) @ way / (way @ way), 0.0, 1.0))
    return math.dist(place, start + share * way)
