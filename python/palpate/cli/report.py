"""Results in words and tables, for people. Contacts and hypotheses are counted from 1, faces from 0."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from palpate import Found, Hypothesis, Recognition
from palpate.cli.documents import components, excursion_bound, hypothesis_count
from palpate.contacts import Evidence
from palpate.contacts.entry import MM_PER_UNIT

MOST_ROWS = 40
MOST_OFF = 2.0  # contacts farther apart, in sizes of the largest model, are in another unit rather than wrong

# What ended a search before it knew all, and what to do; {flag} names the flag that allows more.
STOPPED_BY = {
    "time": "The limit of time ended the search: what it had not looked at may be other parts or poses. "
    "Remedy: more time{flag}, a prior, or another contact.",
    "effort": "The search has spent its effort: what is not proved may be other parts or poses, or none. "
    "Remedy: more effort{flag}, a prior, or another contact.",
    "tolerance": "Within the tolerance it can't be told whether some poses explain the contacts. "
    "Remedy: another contact, or tighter bounds.",
    "hypotheses": "Other parts or poses may explain the contacts: raise --max-hypotheses, or give a prior.",
}

USUAL_CAUSES = (
    "Usual causes: bounds that are too small, another unit, degrees taken for radians or the reverse, "
    "normals that point into the part, a part that is not among the models."
)


def print_recognition(
    console: Console,
    found: Recognition | Found,
    *,
    evidence: Evidence,
    labels: Sequence[str],
    notes: Sequence[str] = (),
    unit: str,
    num_listed: int = 0,
    flags: Mapping[str, str] | None = None,
    size: float | None = None,
) -> None:
    """What was found: a sentence, a table of hypotheses, and what the reader must know to trust it.

    `labels` are names of the models that tell them apart, `notes` what is to be known of them, `flags` those
    that allow more where "time" or "effort" ended the search, `size` that of the largest model.
    """
    given = f"{count(len(evidence.contacts), 'contact')}, {count(len(labels), 'model')}"
    console.print(f"{given}: {_verdict(found, labels)}")
    for note in notes:
        console.print(f"  {note}", markup=False, soft_wrap=True)
    if found.stopped_by is not None:
        flag = (flags or {}).get(found.stopped_by)
        sentence = STOPPED_BY[found.stopped_by].format(flag=f" ({flag})" if flag else "")
        console.print(sentence, markup=False, soft_wrap=True)
    if not found.hypotheses:
        if found.conflict is not None:
            console.print(conflict_sentence(found.conflict, evidence), markup=False, soft_wrap=True)
            apart = None if size is None else too_far_apart(evidence, size=size, unit=unit)
            if apart is not None:
                console.print(apart, markup=False, soft_wrap=True)
            console.print(USUAL_CAUSES, soft_wrap=True)
        return
    console.print(_hypothesis_table(found.hypotheses[:MOST_ROWS], labels))
    if len(found.hypotheses) > MOST_ROWS:
        console.print(f"... and {len(found.hypotheses) - MOST_ROWS} more; --json lists all of them.")
    in_space = found.hypotheses[0].model.dimension == 3
    angles = "; rx, ry, rz: the axis times the angle, in degrees" if in_space else ", angles in degrees"
    console.print(
        f"x, y, {'z, ' if in_space else ''}shift in {unit}{angles}. Turn, shift: no two poses of one "
        "hypothesis differ by more; the shift is that of any vertex of the part."
    )
    if any(hypothesis.marginal and hypothesis.proved for hypothesis in found.hypotheses):
        console.print("* marginal: holds only within the tolerance of the search.")
    if not all(hypothesis.proved for hypothesis in found.hypotheses):
        console.print(
            "? not proved: the search ended before it knew whether a pose explains every contact; the pose "
            "is a guess.",
            soft_wrap=True,
        )
    for number, hypothesis in enumerate(found.hypotheses[: MOST_ROWS if num_listed else 0], start=1):
        label = labels[hypothesis.model_number]
        console.print(f"interpretations of {number}, {escape(label)}:")
        _print_interpretations(console, hypothesis, num_listed=num_listed)


def print_counters(console: Console, found: Recognition, labels: Sequence[str]) -> None:
    """What the search did, model by model."""
    table = Table(box=box.SIMPLE_HEAD, title="search", title_justify="left")
    table.add_column("")
    for label in labels:
        table.add_column(escape(label), justify="right")
    for name in found.counters[0]:
        table.add_row(name.replace("_", " "), *(str(counters[name]) for counters in found.counters))
    console.print(table)


def conflict_sentence(conflict: Sequence[int], evidence: Evidence) -> str:
    """The conflict in words, contacts counted from 1."""
    beside = [
        words
        for words, there in (("the misses", evidence.misses), ("the prior", evidence.prior is not None))
        if there
    ]
    given = f" given {' and '.join(beside)}" if beside else ""
    at = _places([evidence.places[index] for index in conflict] if evidence.places else [])
    numbers = [str(index + 1) for index in conflict]
    if len(numbers) == 1:
        return f"Contact {numbers[0]}{at} can't hold on any model{given}, even alone."
    rest = "" if len(numbers) == len(evidence.contacts) else "; the others are not needed for that"
    return f"Contacts {words(numbers)}{at} can't hold together on any model{given}{rest}."


def too_far_apart(evidence: Evidence, *, size: float, unit: str) -> str | None:
    """Two contacts that are farther apart than any model is large, and the unit that would make up for it."""
    far: tuple[float, int, int] = (0.0, 0, 0)
    for (j, a), (k, b) in itertools.combinations(enumerate(evidence.contacts), 2):
        slack = a.tip_radius + a.position_error + b.tip_radius + b.position_error
        far = max(far, (math.dist(a.center, b.center) - slack, j, k))
    if far[0] <= size:
        return None
    first, second = far[1:]
    apart = math.dist(evidence.contacts[first].center, evidence.contacts[second].center)
    sentence = (
        f"Contacts {first + 1} and {second + 1} are {apart:.4g} {unit} apart, "
        f"no model is larger than {size:.4g} {unit}"
    )
    fits = [(mm, name) for name, mm in MM_PER_UNIT.items() if size * mm / MM_PER_UNIT[unit] >= far[0]]
    if far[0] < MOST_OFF * size or not fits:
        return f"{sentence}."
    larger = min(fits)[1]
    return (
        f"{sentence}: is the model's file in {larger}? Then give --unit {larger}, and say # unit: {unit} "
        "in the file of the contacts."
    )


def _places(places: Sequence[str]) -> str:
    """Where contacts are in their file, which counts comments, blank lines and misses too."""
    if not places:
        return ""
    if all(place.startswith("line ") for place in places):
        lines = [place.removeprefix("line ") for place in places]
        return f" (line{'' if len(lines) == 1 else 's'} {words(lines)} of the file)"
    return f" ({words(places)} of the file)"


def words(items: Sequence[str]) -> str:
    """`1, 3 and 4`."""
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def _verdict(found: Recognition | Found, labels: Sequence[str]) -> str:
    numbers = list(dict.fromkeys(hypothesis.model_number for hypothesis in found.hypotheses))
    parts = [escape(labels[number]) for number in numbers]
    interpretations = _at_least(found.interpretation_count, found.interpretation_count_exact)
    counts = f"{count(len(found.hypotheses), 'hypothesis')}, {interpretations} in all"
    if not found.complete:
        number = hypothesis_count(found)
        listed = len(found.hypotheses)
        reached = [
            f"{count(number, 'hypothesis')} reached"
            + ("" if number == listed else f", the first {listed} listed")
        ]
        unproved = sum(not hypothesis.proved for hypothesis in found.hypotheses)
        if unproved:
            reached.append("none of them proved" if unproved == number else f"{unproved} of them not proved")
        if found.interpretation_count:
            reached.append(interpretations)
        few = found.stopped_by == "hypotheses"
        head = "not all hypotheses were found" if few else "not everything was decided"
        return f"[bold]{head}[/bold]; {', '.join(reached)}."
    if not parts:
        return "[bold]no part at any pose explains them.[/bold]"
    if len(parts) == 1:
        return f"it is [bold]{parts[0]}[/bold]; {counts}."
    return f"one of {', '.join(parts)}; {counts}."


def _hypothesis_table(hypotheses: Sequence[Hypothesis], labels: Sequence[str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("#", justify="right")
    table.add_column("part", style="bold")
    poses = [components(hypothesis.world_from_model) for hypothesis in hypotheses]
    for head in ("interpr.", *(name.removesuffix("_deg") for name in poses[0]), "turn ≤", "shift ≤"):
        table.add_column(head, justify="right")
    size = min(hypothesis.model.size for hypothesis in hypotheses)
    for number, (hypothesis, pose) in enumerate(zip(hypotheses, poses, strict=True), start=1):
        table.add_row(
            str(number),
            escape(labels[hypothesis.model_number]) + _doubt(hypothesis),
            _at_least_number(hypothesis.interpretation_count, hypothesis.interpretation_count_exact),
            *(f"{v:.2f}" if name.endswith("_deg") else decimal(v, size) for name, v in pose.items()),
            *_extents(hypothesis),
        )
    return table


def _extents(hypothesis: Hypothesis) -> tuple[str, str]:
    """The bounds of turn and shift. Of what is not proved they say only what was not looked at."""
    if not hypothesis.proved:
        return "unknown", "unknown"
    return _bound(math.degrees(hypothesis.poses.rotation_bound)), _bound(excursion_bound(hypothesis))


def _print_interpretations(console: Console, hypothesis: Hypothesis, *, num_listed: int) -> None:
    for interpretation in itertools.islice(hypothesis.interpretations, num_listed):
        features = (
            f"{contact} on {kind} {index}"
            for contact, (kind, index) in enumerate(interpretation.assignment, 1)
        )
        marginal = " (marginal)" if interpretation.marginal else ""
        console.print(f"  {', '.join(features)}{marginal}")


def count(number: int, noun: str) -> str:
    """`1 face`, `2 faces`."""
    plurals = {"hypothesis": "hypotheses", "vertex": "vertices"}
    return f"{number} {noun if number == 1 else plurals.get(noun, noun + 's')}"


def _at_least(number: int, exact: bool) -> str:
    if exact or number == 1:
        return f"{'' if exact else 'at least '}{count(number, 'interpretation')}"
    return f"at least {_truncated(number)} interpretations"


def _at_least_number(number: int, exact: bool) -> str:
    if not exact and number == 0:
        return "unknown"
    return f"{number}" if exact else f"≥ {_truncated(number)}"


def _truncated(number: int) -> str:
    """A lower bound in few digits: still one, and shorter."""
    digits = str(number)
    return digits if len(digits) <= 7 else f"{digits[0]}.{digits[1]}e{len(digits) - 1}"


def decimal(value: float, size: float) -> str:
    """To three decimals, or as many more as a part of `size` needs."""
    decimals = 3 if size >= 1.0 or size <= 0.0 else 3 - math.floor(math.log10(size))
    if decimals > 12:
        return f"{value:.6g}"
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def _bound(value: float) -> str:
    """To two decimals, small ones to two digits, never below `value`: it must still be a bound."""
    if value <= 0.0:
        return "0.00"
    decimals = 2 if value >= 0.1 else 1 - math.floor(math.log10(value))
    step = 10.0**-decimals
    # A value that is printed as it is stays: 1e-9 of a step is what rounding in floats may add.
    rounded = math.ceil(value / step - 1e-9) * step
    return f"{rounded:.{decimals}f}" if decimals <= 9 else f"{rounded:.1e}"


def _doubt(hypothesis: Hypothesis) -> str:
    if not hypothesis.proved:
        return " ?"
    return " *" if hypothesis.marginal else ""
