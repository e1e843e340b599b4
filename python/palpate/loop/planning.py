"""Which path the loop takes next."""

from __future__ import annotations

import time
from collections.abc import Sequence

from palpate._core import Hypothesis, Path, PlanReport, plan_report
from palpate.loop.result import Step
from palpate.loop.settings import Settings

HARDLY = 0.05  # so many hypotheses less, in the mean, are hardly worth a touch
HARDLY_ANY = 1e-9  # seconds, where no time is left
QUICK = 2_000  # boxes of lines; more may take minutes, in which a promising touch tells more


def next_path(
    hypotheses: list[Hypothesis], settings: Settings, steps: Sequence[Step], *, time_limit: float | None
) -> PlanReport:
    """The best path by a quick look; if that is not promising, by as long a one as the settings allow.

    A search of all lines begins where no sampled line is certain to tell. It may be long, and is needless
    where an untried path is expected to tell: the next look is after its touch. Both looks together keep to
    the time limit, in seconds.
    """
    began = time.perf_counter()
    tried = [(step.start, step.end - step.start) for step in steps]

    def look(effort: int) -> PlanReport:
        spent = time.perf_counter() - began
        left = None if time_limit is None else max(HARDLY_ANY, time_limit - spent)
        return plan_report(
            hypotheses,
            settings.moved,
            tried=tried,
            effort=effort,
            time_limit=left,
            **settings.searched,
            **settings.placed,
            **settings.judged,
        )

    if settings.planner == "auto" and settings.effort > QUICK:
        report = look(QUICK)
        if report.why != "effort" or is_promising(report.path, len(hypotheses)):
            return report
    return look(settings.effort)


def is_promising(path: Path | None, count: int) -> bool:
    """Whether a path among so many hypotheses is certain to tell some apart, or expected to leave fewer."""
    return path is not None and (path.guaranteed or path.expected_score < count - HARDLY)
