"""One run of the loop, in the order of the thesis's section 4.1."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from palpate._core import (
    Contact,
    Hypothesis,
    Miss,
    Path,
    judge,
    recognize,
    verification_path,
    verification_report,
)
from palpate.loop.dimension import FINER
from palpate.loop.entries import planned_event, recognized_event
from palpate.loop.journal import Interrupted, Journal
from palpate.loop.planning import HARDLY_ANY, is_promising, next_path
from palpate.loop.refuted import refuted, without_way
from palpate.loop.result import Array, Found, Purpose, Result, Status, Step
from palpate.loop.settings import Settings
from palpate.loop.tightness import PATIENCE, Tightness
from palpate.loop.tour import Tour
from palpate.loop.wander import as_swept, path_error_of
from palpate.probe import AlreadyTouching, Fault, Hit, Probe, Reply, Skid, UnexpectedTouch


class _Ended(Exception):
    """The run is over."""

    def __init__(self, status: Status, reason: str, *, proved: bool = False) -> None:
        super().__init__(reason)
        self.status: Status = status
        self.reason = reason
        self.proved = proved


def check_told(told: Any) -> None:
    """That it can be called.

    Raises:
        ValueError: It can't.
    """
    if told is not None and not callable(told):
        raise ValueError(f"told: must be a function of a Step, or None (got {told!r}); leave it out")


class Run:
    """The evidence so far, and what to do next."""

    def __init__(
        self,
        settings: Settings,
        probe: Probe | None,
        journal: Journal,
        *,
        position: Array | None,
        told: Callable[[Step], None] | None = None,
    ) -> None:
        self._settings = settings
        self._journal = journal
        self._tour = Tour(settings, probe, journal, position=position)
        self._told = told or (lambda step: None)
        self._contacts: list[Contact] = list(settings.contacts)
        self._misses: list[Miss] = settings.known
        self._steps: list[Step] = []
        self._num_told = 0
        self._found: Found | None = None
        self._tightness = None if settings.until is None else Tightness(settings.until)
        self._seconds = {"recognition": 0.0, "planning": 0.0}
        self._spent = 0.0  # seconds on the last recognition
        self._width = settings.dimension.smallest_width(settings.models)
        self._scans = settings.dimension.acquisition(settings.search(self._contacts), self._width / FINER)
        self._explored = 0
        self._fewest = sys.maxsize  # hypotheses that were left so far

    def result(self) -> Result:
        """Run to the end."""
        try:
            end = self._end()
            self._conclude(end)
        except Interrupted:
            end = _Ended("interrupted", "the log ends here")
        tightness, left = self._tightness, [] if self._found is None else self._found.hypotheses
        return Result(
            end.status,
            end.reason,
            end.proved,
            self._found,
            self._settings.workspace,
            self._contacts,
            self._misses,
            self._steps,
            until_met=None if tightness is None else len(left) == 1 and tightness.reached(left[0]),
            travel=self._tour.travel,
            recognition_time=self._seconds["recognition"],
            planning_time=self._seconds["planning"],
        )

    def _end(self) -> _Ended:
        """What the loop comes to."""
        try:
            self._acquire()
            while True:
                self._decide(self._recognize())
        except _Ended as end:
            return end

    def _conclude(self, end: _Ended) -> None:
        """The last event; what was touched before it is recognized, whatever cut the run short."""
        if self._contacts and self._found is None:
            self._recognize()
        self._tell()
        self._journal.record(
            {
                "event": "end",
                "status": end.status,
                "reason": end.reason,
                "proved": end.proved,
                "touches": len(self._steps),
                "travel": self._tour.travel,
            }
        )

    def _acquire(self) -> None:
        """First contacts: by binary subdivision of the workspace, in space by exploring what was touched."""
        settings = self._settings
        if settings.contacts and settings.blind is None:
            return
        finest = self._width if settings.blind is None else self._width / FINER
        # As fine as it goes where nothing is known to be there: a part with holes may have been missed.
        while not self._is_enough() and self._scan(finest if self._contacts else self._width / FINER):
            pass
        if not self._contacts:
            raise _Ended("nothing_found", "no scan of the workspace made a reliable contact")

    def _is_enough(self) -> bool:
        """Whether acquisition may end: independent normals, or as many as a blind search is to have."""
        settings, contacts = self._settings, self._contacts
        blind, reads_normals = settings.blind, settings.sensor.normal_error is not None
        if blind is not None:
            return sum(one.normal is not None or not reads_normals for one in contacts) >= blind
        if not reads_normals:
            return len(contacts) >= settings.dimension.without_normals
        least = settings.dimension.with_balls if settings.sensor.tip_radius > 0.0 else 0
        return len(contacts) >= least and settings.dimension.independent(contacts)

    def _scan(self, finest: float) -> bool:
        """The next scan; False if all are made."""
        scan = self._scans.next(finest)
        if scan is None:
            return False
        reply = self._touch(scan.start, scan.end, purpose="scan")
        self._scans.made(missed=isinstance(reply, Miss))
        return True

    def _recognize(self) -> Found:
        """All evidence anew, without what the guarded moves refute.

        With every kind of feature that the tip can meet: `features` is about paths, and scans can't choose.
        """
        settings = self._settings
        began = time.perf_counter()
        contacts, misses = self._recognized()
        recognition = recognize(
            settings.models,
            contacts,
            misses=misses,
            prior=settings.prior,
            max_hypotheses=settings.max_hypotheses,
        )
        moves = [(step.start, step.end, step.reply) for step in self._steps]
        found = Found(recognition, refuted(recognition.hypotheses, moves, settings.sensor))
        self._spent = time.perf_counter() - began
        self._seconds["recognition"] += self._spent
        self._found = found
        self._journal.record(recognized_event(found))
        if self._steps:
            self._steps[-1] = replace(self._steps[-1], hypotheses=found.hypotheses)
        self._tell()
        return found

    def _recognized(self) -> tuple[list[Contact], list[Miss]]:
        """Contacts and misses for recognition: in space without what the loop's own moves swept.

        With that it takes minutes where the poses are not known well. It is left to `refuted`, which drops
        what can't have answered a move but cuts no poses.
        """
        settings = self._settings
        if settings.dimension.recognizes_ways:
            return self._contacts, self._misses
        known = len(settings.contacts)
        return [*self._contacts[:known], *map(without_way, self._contacts[known:])], settings.known

    def _decide(self, found: Found) -> None:
        """Touch once more, or end."""
        if not found.complete:
            if not self._scan(self._width / FINER):
                raise _Ended("budget", "more hypotheses are left than are wanted, and no scan is")
        elif not found.hypotheses:
            if found.refuted:
                raise _Ended(
                    "unexplained", "no model explains what was met first on the lines of the guarded moves"
                )
            raise _Ended("unexplained", "no model explains what was touched, missed and swept")
        elif len(found.hypotheses) == 1:
            self._verify(found.hypotheses[0])
        else:
            self._tell_apart(found.hypotheses)

    def _verify(self, last: Hypothesis) -> None:
        """Touch the last hypothesis until its poses are tight enough."""
        if self._tightness is None:
            raise _Ended("solved", "one hypothesis is left")
        if self._tightness.reached(last):
            raise _Ended("solved", "one hypothesis is left, its poses as tight as was asked")
        if self._tightness.in_vain(last):
            raise _Ended(
                "budget", f"one hypothesis is left; the last {PATIENCE} touches made its poses no tighter"
            )
        self._check_budget()
        began = time.perf_counter()
        path, why = self._plan_verification(last)
        self._seconds["planning"] += time.perf_counter() - began
        if path is None and why in ("time", "effort"):
            raise _Ended("budget", "the search for a touch that makes the poses tighter was cut short")
        if path is None:
            raise _Ended("solved", "one hypothesis is left; no touch was found that makes its poses tighter")
        self._touch(path.start, path.end, purpose="verify", path=path)

    def _plan_verification(self, last: Hypothesis) -> tuple[Path | None, str]:
        """The path, and why it is that one; that of the log, if it has one."""
        settings = self._settings
        known = self._journal.peek("planned")
        if known is None:
            report = verification_report(
                last,
                settings.moved,
                time_limit=self._time_left(),
                effort=settings.effort,
                **settings.placed,
                **settings.judged,
            )
            path = None if report.path is None else self._within(report.path, [last])
            self._journal.record(planned_event(path, report))
            return path, report.why
        self._journal.record(known)
        path = None
        if known["path"] is not None:
            line = (known["path"]["start"], known["path"]["direction"])
            path = verification_path(last, settings.moved, line=line, **settings.judged)
            path = None if path is None else self._within(path, [last])
        return path, known["why"]

    def _tell_apart(self, hypotheses: list[Hypothesis]) -> None:
        """Go along the best path, if it tells anything."""
        self._check_budget()
        fewer, self._fewest = len(hypotheses) < self._fewest, min(len(hypotheses), self._fewest)
        if fewer and len(hypotheses) > self._settings.dimension.many and self._explore():
            return
        began = time.perf_counter()
        path, why, proved = self._plan(hypotheses)
        self._seconds["planning"] += time.perf_counter() - began
        cut_short = why in ("time", "effort")
        if not is_promising(path, len(hypotheses)) and not proved and self._explore():
            return
        if path is None:
            if cut_short:
                raise _Ended("budget", "planning was cut short before it found a path that can be used")
            raise _Ended("no_usable_path", "no path that can be used was found", proved=proved)
        if not is_promising(path, len(hypotheses)):
            if cut_short:
                raise _Ended("budget", "planning was cut short before it found a path that tells anything")
            known = "" if proved else "; it is not proved that none is certain to"
            raise _Ended(
                "inseparable",
                f"no path that was found is certain or expected to tell those left apart{known}",
                proved=proved,
            )
        self._touch(path.start, path.end, purpose="path", path=path)

    def _explore(self) -> bool:
        """One more move as for first contacts; False if enough of them were made, or none is left."""
        if self._explored >= self._settings.dimension.explores:
            return False
        self._explored += 1
        return self._scan(self._width / FINER)

    def _within(self, path: Path, hypotheses: list[Hypothesis]) -> Path:
        """The path, or as much of it as is in the workspace, where that is all that is free for the tip."""
        settings = self._settings
        if settings.dimension.ends_within is None:
            return path
        length = settings.dimension.ends_within(settings.workspace, path.start, path.direction)
        if path.length <= length:
            return path
        return judge(hypotheses, settings.moved, path.start, path.direction, length, **settings.judged)

    def _plan(self, hypotheses: list[Hypothesis]) -> tuple[Path | None, str, bool]:
        """The path, why it is that one, and whether it is proved best; that of the log, if it has one."""
        settings = self._settings
        known = self._journal.peek("planned")
        if known is None:
            report = next_path(hypotheses, settings, self._steps, time_limit=self._time_left())
            path = None if report.path is None else self._within(report.path, hypotheses)
            self._journal.record(planned_event(path, report))
            return path, report.why, report.proved
        self._journal.record(known)
        path = None
        if known["path"] is not None:
            line = (known["path"][name] for name in ("start", "direction", "length"))
            path = judge(hypotheses, settings.moved, *line, **settings.judged)
        return path, known["why"], known["proved"]

    def _time_left(self) -> float | None:
        """Of the step, for its planning; None: no limit. Where nothing is left, the search says so."""
        limit = self._settings.time_limit
        return None if limit is None else max(HARDLY_ANY, limit - self._spent)

    def _check_budget(self) -> None:
        """End, if no more guarded moves may be made: before one, and before the search for one."""
        if len(self._steps) >= self._settings.max_touches:
            raise _Ended("budget", f"{self._settings.max_touches} guarded moves were made")

    def _touch(self, start: Array, end: Array, *, purpose: Purpose, path: Path | None = None) -> Reply:
        """The tip goes there and makes the guarded move; what it says is evidence."""
        self._check_budget()
        self._tell()
        route, failed = self._tour.go_to(start)
        if failed is not None:
            raise _Ended("fault", _reason(failed))
        reply = self._tour.touch(start, end, purpose)
        self._take(reply, start, end)
        self._steps.append(Step(purpose, start, end, route, reply, path))
        if isinstance(reply, AlreadyTouching | UnexpectedTouch | Fault):
            raise _Ended("fault", _reason(reply))
        if path is not None and isinstance(reply, Skid):
            # Unexpected data (3.4): on a path that can be used, none of them can be touched first beyond the
            # largest reliable incidence. The free part of the way alone may leave them.
            self._recognize()
            raise _Ended(
                "unexplained", "the tip skidded where no hypothesis left can be touched so obliquely"
            )
        return reply

    def _tell(self) -> None:
        """Of each step once, when all is known of it."""
        if self._num_told < len(self._steps):
            self._num_told = len(self._steps)
            self._told(self._steps[-1])

    def _take(self, reply: Reply, start: Array, end: Array) -> None:
        """As evidence. An unexpected touch is none: the bounds of readings don't hold for free moves."""
        if isinstance(reply, Miss):
            self._misses.append(as_swept(reply, self._settings.sensor))
        elif isinstance(reply, Skid):
            self._misses.append(as_swept(reply.free, self._settings.sensor))
        elif isinstance(reply, Hit):
            self._contacts.append(reply.contact)
            if reply.contact.start is None:
                self._misses.append(self._way_before(reply.contact, start, end))

    def _way_before(self, contact: Contact, start: Array, end: Array) -> Miss:
        """The free way before a contact that says nothing of it, to within the path error."""
        direction = (end - start) / np.hypot.reduce(end - start)
        free = max(0.0, float(direction @ (contact.center - start)) - contact.position_error)
        path_error = path_error_of(self._settings.sensor, contact.position_error)
        return Miss(start, start + free * direction, tip_radius=contact.tip_radius, path_error=path_error)


def _reason(reply: Reply) -> str:
    match reply:
        case AlreadyTouching():
            return "the tip touched something where a guarded move was to begin"
        case UnexpectedTouch():
            return f"a free move touched something at {np.asarray(reply.where).tolist()}"
        case Fault():
            return f"the probe can't go on: {reply.reason}"
    return repr(reply)
