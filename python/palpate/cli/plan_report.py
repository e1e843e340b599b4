"""Paths in words. Hypotheses are counted from 1, faces from 0."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from palpate import Outcome, Path, PlanReport, Sensor
from palpate.cli.report import decimal
from palpate.loop.planning import HARDLY

MOST_FEATURES = 4  # that are named in one answer

WHY = {
    "solved": "One hypothesis is left: there is nothing to tell apart.",
    "perfect": "No path can be better: it separates all.",
    "enough": "It is as good as --stop asks for; there may be a better one.",
    "best": "Proved: no usable path of margin {m} or more has a better score.",
    "inseparable": "Proved: no usable path of margin {m} or more is certain to tell any two apart.",
    "no_usable_path": "Proved: no path of margin {m} or more can be used.",
    "time": "--time-limit cut the search short; proved so far: no score is below {bound}.",
    "effort": "The limit of effort cut the search short; proved so far: no score is below {bound}. "
    "--effort allows more.",
    "incomplete": "One hypothesis is listed of more that may be left: see above.",
    "searched": "This planner looks at some lines only; --planner complete looks at all.",
    "searched in space": "The search looks at some lines only: there may be a better one.",
}


def sensor_words(sensor: Sensor, *, unit: str) -> str:
    """The sensor of the next reading."""
    normal = (
        "no normal" if sensor.normal_error is None else f"normal ± {math.degrees(sensor.normal_error):.4g}°"
    )
    words = f"position ± {sensor.position_error:g} {unit}, {normal}"
    words += f", reliable up to {math.degrees(sensor.max_incidence):.4g}° of incidence"
    if sensor.tip_radius:
        words += f", tip radius {sensor.tip_radius:g} {unit}"
    if sensor.path_error:
        words += f", off its line by up to {sensor.path_error:g} {unit}"
    if sensor.stem is not None:
        (x, y, z), radius, length = sensor.stem
        words += f", on a stem along ({x:.4g}, {y:.4g}, {z:.4g})"
        words += f" of radius {radius:g} {unit}, {length:g} {unit} long"
    return words


def print_plan(
    console: Console,
    report: PlanReport,
    labels: Sequence[str],
    *,
    size: float,
    margin: float,
    unit: str,
    complete: bool,
) -> None:
    """The next path; `labels` name each hypothesis's part, `size` is that of the smallest part."""
    name: str = "incomplete" if report.why == "solved" and not complete else report.why
    if name == "searched" and report.path is not None and len(report.path.direction) == 3:
        name = "searched in space"
    why = WHY[name].format(m=f"{margin:.3g} {unit}", bound=f"{report.bound:.4g}")
    if report.path is None:
        if report.why != "solved":
            console.print("[bold]no path[/bold] that can be used was found.")
        console.print(why, soft_wrap=True)
        return
    path = report.path
    start = ", ".join(decimal(coordinate, size) for coordinate in path.start)
    direction = ", ".join(f"{component:.4f}" for component in path.direction)
    at = f"from ({start}) in direction ({direction})"
    if len(path.direction) == 2:
        at += f", {math.degrees(math.atan2(path.direction[1], path.direction[0])):.2f}°"
    console.print(
        f"[bold]next path[/bold]: {at}, up to {decimal(path.length, size)} {unit}",
        soft_wrap=True,
    )
    for line in (_worth(path), _margin(path, margin, unit=unit), why):
        console.print(f"  {line}", markup=False, soft_wrap=True)
    console.print(_answers(path, labels, size=size, unit=unit))


def _worth(path: Path) -> str:
    """What it tells for certain, and what it may be expected to tell."""
    n = len(path.members)
    expected = f"expected: {path.expected_score:.3g}"
    if path.guaranteed:
        if path.score <= 1.0:
            return f"Guaranteed: it separates {'both' if n == 2 else f'all {n}'} (score 1)."
        return f"Guaranteed: at most {path.score:.4g} of {n} are left, in the mean (score); {expected}."
    hardly = ", hardly worth a touch" if path.expected_score >= n - HARDLY else ""
    return (
        f"Only expected to tell, nothing is certain: score {path.score:.4g} of {n}; {expected} left{hardly}."
    )


def _margin(path: Path, wanted: float, *, unit: str) -> str:
    if path.margin <= 0.0:
        return "It tells this only where it is: its margin is 0."
    small = "" if path.margin >= wanted else f", less than the {wanted:.3g} {unit} that are wanted"
    return f"It tells the same when it is shifted by up to {path.margin:.3g} {unit}{small}."


def _answers(path: Path, labels: Sequence[str], *, size: float, unit: str) -> Table:
    """What each answer would leave."""
    table = Table(box=box.SIMPLE_HEAD)
    in_plane = len(path.direction) == 2
    for head in ("answer", f"at ({unit})", "normal (°)" if in_plane else "normal", "on", "leaves"):
        table.add_column(head)
    outcome_of = {outcome.hypothesis: outcome for outcome in path.outcomes}
    for members in path.classes:
        among = [outcome_of[member] for member in members]
        depths = [touch.depth for outcome in among for touch in outcome.touches]
        low, high = min((d[0] for d in depths), default=0.0), max((d[1] for d in depths), default=0.0)
        table.add_row(
            _answer(among),
            f"{decimal(low, size)} to {decimal(high, size)}" if depths else "",
            (_normals if in_plane else _caps)(path, among),
            _features(among),
            ", ".join(f"{member + 1} {escape(labels[member])}" for member in members),
        )
    table.add_row("anything else", "", "", "", "recognize again")
    return table


def _answer(outcomes: Sequence[Outcome]) -> str:
    touch, miss = any(o.touches for o in outcomes), any(o.may_miss for o in outcomes)
    return "contact or none" if touch and miss else "contact" if touch else "no contact"


def _normals(path: Path, outcomes: Sequence[Outcome]) -> str:
    """From the least to the largest angle, counted from the way back, which all normals are near."""
    back = math.atan2(-path.direction[1], -path.direction[0])
    near: list[float] = []
    for start, end in (touch.normals for outcome in outcomes for touch in outcome.touches):
        low = math.remainder((start + end) / 2 - back, math.tau) - (end - start) / 2
        near += [low, low + end - start]
    if not near:
        return ""
    return f"{math.degrees(back + min(near)):.1f} to {math.degrees(back + max(near)):.1f}"


def _caps(path: Path, outcomes: Sequence[Outcome]) -> str:
    """In space: how steeply to the line they are met."""
    back = -path.direction
    caps = [touch.normal_cap for outcome in outcomes for touch in outcome.touches]
    off = [(math.acos(max(-1.0, min(1.0, float(axis @ back)))), angle) for axis, angle in caps]
    if not off:
        return ""
    low = max(0.0, min(middle - angle for middle, angle in off))
    high = min(math.pi, max(middle + angle for middle, angle in off))
    return f"{math.degrees(low):.1f}° to {math.degrees(high):.1f}° off the way back"


def _features(outcomes: Sequence[Outcome]) -> str:
    features = {
        f"{kind} {number} of {outcome.hypothesis + 1}": None
        for outcome in outcomes
        for kind, number in (touch.feature for touch in outcome.touches)
    }
    few = ", ".join(list(features)[:MOST_FEATURES])
    return few if len(features) <= MOST_FEATURES else f"{few}, ..."
