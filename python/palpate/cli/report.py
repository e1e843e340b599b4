"""Results in words and tables, for people. Contacts and hypotheses are counted from 1, faces from 0."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from palpate import Hypothesis, Model, Recognition
from palpate.cli.documents import excursion_bound, planar
from palpate.contacts import Evidence

MOST_ROWS = 40


def print_recognition(
    console: Console,
    found: Recognition,
    *,
    evidence: Evidence,
    num_models: int,
    unit: str,
    num_listed: int = 0,
) -> None:
    """What was found: a sentence, a table of hypotheses, and what the reader must know to trust it."""
    given = f"{_count(len(evidence.contacts), 'contact')}, {_count(num_models, 'model')}"
    console.print(f"{given}: {_verdict(found)}")
    if not found.complete:
        console.print(
            "Other parts or poses may explain the contacts: raise --max-hypotheses, or give a prior."
        )
    if not found.hypotheses:
        if found.conflict is not None:
            console.print(conflict_sentence(found.conflict, evidence))
        return
    console.print(_hypothesis_table(found.hypotheses[:MOST_ROWS]))
    if len(found.hypotheses) > MOST_ROWS:
        console.print(f"... and {len(found.hypotheses) - MOST_ROWS} more; --json lists all of them.")
    console.print(
        f"x, y, shift in {unit}, angles in degrees. Turn, shift: no two poses of one hypothesis differ "
        "by more; the shift is that of any vertex of the part."
    )
    if any(hypothesis.marginal for hypothesis in found.hypotheses):
        console.print("* marginal: holds only within the tolerance of the search.")
    for number, hypothesis in enumerate(found.hypotheses[: MOST_ROWS if num_listed else 0], start=1):
        _print_interpretations(console, hypothesis, number=number, num_listed=num_listed)


def print_counters(console: Console, found: Recognition, models: Sequence[Model]) -> None:
    """What the search did, model by model."""
    table = Table(box=box.SIMPLE_HEAD, title="search", title_justify="left")
    table.add_column("")
    for model in models:
        table.add_column(escape(model.name), justify="right")
    for name in found.counters[0]:
        table.add_row(name.replace("_", " "), *(str(counters[name]) for counters in found.counters))
    console.print(table)


def print_models(console: Console, models: Sequence[Model], *, unit: str) -> None:
    """What was read of each model."""
    for model in models:
        kind = "closed" if model.closed else "open"
        counts = f"{_count(len(model.faces), 'face')}, {_count(len(model.vertices), 'vertex')}"
        console.print(f"[bold]{escape(model.name)}[/bold]: {counts}, {kind}, size {model.size:.6g} {unit}")
        console.print(f"  symmetries: {_symmetries(model)}")
        if model.position_slack or model.normal_slack:
            slack = f"{model.position_slack:.4g} {unit} and {math.degrees(model.normal_slack):.4g}°"
            console.print(f"  slack of the outline: {slack}, added to the errors of every contact")
        reflex = [str(index) for index, touchable in enumerate(model.touchable_vertices) if not touchable]
        if reflex:
            console.print(f"  vertices that can't be touched: {', '.join(reflex)}")
        for mend in model.mends:
            console.print(f"  mended: {escape(mend)}")
        console.print(_face_table(model, unit=unit))
        if len(model.faces) > MOST_ROWS:
            console.print(f"  ... and {len(model.faces) - MOST_ROWS} more faces; --json lists all of them.")


def conflict_sentence(conflict: Sequence[int], evidence: Evidence) -> str:
    """The conflict in words, contacts counted from 1."""
    beside = [
        words
        for words, there in (("the misses", evidence.misses), ("the prior", evidence.prior is not None))
        if there
    ]
    given = f" given {' and '.join(beside)}" if beside else ""
    numbers = [str(index + 1) for index in conflict]
    if not numbers:
        return f"No model at any pose is possible{given}, whatever was touched."
    if len(numbers) == 1:
        return f"Contact {numbers[0]} can't hold on any model{given}, even alone."
    which = ", ".join(numbers[:-1]) + " and " + numbers[-1]
    rest = "" if len(numbers) == len(evidence.contacts) else "; the others are not needed for that"
    return f"Contacts {which} can't hold together on any model{given}{rest}."


def _verdict(found: Recognition) -> str:
    parts = list(dict.fromkeys(hypothesis.model.name for hypothesis in found.hypotheses))
    interpretations = _at_least(found.interpretation_count, found.interpretation_count_exact)
    counts = f"{_count(len(found.hypotheses), 'hypothesis')}, {interpretations} in all"
    if not found.complete:
        return f"[bold]not all hypotheses were found[/bold]; {counts} so far."
    if not parts:
        return "[bold]no part at any pose explains them.[/bold]"
    if len(parts) == 1:
        return f"it is [bold]{escape(parts[0])}[/bold]; {counts}."
    return f"one of {escape(', '.join(parts))}; {counts}."


def _hypothesis_table(hypotheses: Sequence[Hypothesis]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("#", justify="right")
    table.add_column("part", style="bold")
    for head in ("interpr.", "x", "y", "angle", "turn ≤", "shift ≤"):
        table.add_column(head, justify="right")
    for number, hypothesis in enumerate(hypotheses, start=1):
        x, y, angle_deg = planar(hypothesis.world_from_model)
        table.add_row(
            str(number),
            escape(hypothesis.model.name) + (" *" if hypothesis.marginal else ""),
            _at_least_number(hypothesis.interpretation_count, hypothesis.interpretation_count_exact),
            _decimal(x),
            _decimal(y),
            f"{angle_deg:.2f}",
            f"{_rounded_up(math.degrees(hypothesis.poses.rotation_bound)):.2f}",
            f"{_rounded_up(excursion_bound(hypothesis)):.2f}",
        )
    return table


def _print_interpretations(console: Console, hypothesis: Hypothesis, *, number: int, num_listed: int) -> None:
    console.print(f"interpretations of {number}, {escape(hypothesis.model.name)}:")
    for interpretation in itertools.islice(hypothesis.interpretations, num_listed):
        features = (
            f"{contact} on {kind} {index}"
            for contact, (kind, index) in enumerate(interpretation.assignment, 1)
        )
        marginal = " (marginal)" if interpretation.marginal else ""
        console.print(f"  {', '.join(features)}{marginal}")


def _face_table(model: Model, *, unit: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    for head in ("face", f"from ({unit})", f"to ({unit})", "length", "normal (°)"):
        table.add_column(head, justify="right")
    table.add_column("surface")
    for index, (start, end) in enumerate(model.faces[:MOST_ROWS]):
        table.add_row(
            str(index),
            f"{_decimal(start[0])}, {_decimal(start[1])}",
            f"{_decimal(end[0])}, {_decimal(end[1])}",
            _decimal(math.hypot(*(end - start))),
            f"{_direction_deg(model.face_normals[index]):.1f}",
            model.face_surfaces[index],
        )
    return table


def _direction_deg(vector: NDArray[np.float64]) -> float:
    # Adding zero turns -0.0, whose direction would be -180 or -0.0, into 0.0.
    return math.degrees(math.atan2(vector[1] + 0.0, vector[0] + 0.0))


def _symmetries(model: Model) -> str:
    turns = [planar(motion)[2] % 360.0 for motion in model.symmetries]
    others = sorted(f"{turn:.4g}°" for turn in turns if 1e-6 < turn < 360.0 - 1e-6)
    return "none" if not others else f"looks the same turned by {', '.join(others)}"


def _count(number: int, noun: str) -> str:
    plurals = {"hypothesis": "hypotheses", "vertex": "vertices"}
    return f"{number} {noun if number == 1 else plurals.get(noun, noun + 's')}"


def _at_least(number: int, exact: bool) -> str:
    return _count(number, "interpretation") if exact else f"at least {_truncated(number)} interpretations"


def _at_least_number(number: int, exact: bool) -> str:
    return f"{number}" if exact else f"≥ {_truncated(number)}"


def _truncated(number: int) -> str:
    """A lower bound in few digits: still one, and shorter."""
    digits = str(number)
    return digits if len(digits) <= 7 else f"{digits[0]}.{digits[1]}e{len(digits) - 1}"


def _decimal(value: float) -> str:
    text = f"{value:.3f}"
    return "0.000" if text == "-0.000" else text


def _rounded_up(value: float) -> float:
    """To two decimals, never below `value`: a bound that is printed must still be a bound."""
    return math.ceil(value * 100.0 - 1e-9) / 100.0
