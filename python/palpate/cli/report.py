"""Results in words and tables, for people. Contacts and hypotheses are counted from 1, faces from 0."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from palpate import Found, Hypothesis, Model, Recognition
from palpate.cli.documents import components, excursion_bound, hypothesis_count, planar
from palpate.cli.parts import Parts, slack_words, with_flags
from palpate.contacts import Evidence
from palpate.rotations import vector_of
from palpate.solids.faces import face_areas, face_places

MOST_ROWS = 40
MOST_IN_LINE = 8  # numbers that are listed one by one

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
) -> None:
    """What was found: a sentence, a table of hypotheses, and what the reader must know to trust it.

    `labels` are names of the models that tell them apart, `notes` what is to be known of them.
    """
    given = f"{_count(len(evidence.contacts), 'contact')}, {_count(len(labels), 'model')}"
    console.print(f"{given}: {_verdict(found, labels)}")
    for note in notes:
        console.print(f"  {note}", markup=False, soft_wrap=True)
    if not found.complete:
        console.print(
            "Other parts or poses may explain the contacts: raise --max-hypotheses, or give a prior."
        )
    if not found.hypotheses:
        if found.conflict is not None:
            console.print(conflict_sentence(found.conflict, evidence), markup=False, soft_wrap=True)
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
    if any(hypothesis.marginal for hypothesis in found.hypotheses):
        console.print("* marginal: holds only within the tolerance of the search.")
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


def print_models(console: Console, parts: Parts, *, unit: str) -> None:
    """What was read of each model; what was changed in reading comes first."""
    for number, (model, label) in enumerate(zip(parts.models, parts.labels, strict=True), start=1):
        kind = "closed" if model.closed else "open"
        numbers = {"face": len(model.faces), "edge": len(model.edges), "vertex": len(model.vertices)}
        counts = ", ".join(_count(n, noun) for noun, n in numbers.items() if noun != "edge" or n)
        console.print(f"[bold]{escape(label)}[/bold]: {counts}, {kind}, size {model.size:.6g} {unit}")
        for mend in model.mends:
            console.print(f"  mended: {with_flags(mend)}", markup=False, soft_wrap=True)
        if label != model.name:
            console.print(f"  from {parts.sources[number - 1]}", markup=False)
        first = 1 + parts.models.index(model)
        if first != number:
            console.print(f"  the same as model {first}")
        if model.position_slack or model.normal_slack:
            slack = slack_words(model, unit=unit)
            of = "outline" if model.dimension == 2 else "surface"
            console.print(f"  slack of the {of}: {slack}, added to the errors of every contact")
        console.print(f"  symmetries: {_symmetries(model)}", soft_wrap=True)
        for nouns, touchable in (("edges", model.touchable_edges), ("vertices", model.touchable_vertices)):
            untouchable = [int(k) for k in np.flatnonzero(~np.asarray(touchable))]
            if untouchable:
                console.print(f"  {nouns} that can't be touched: {_numbers(untouchable)}")
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
    at = _places([evidence.places[index] for index in conflict] if evidence.places else [])
    numbers = [str(index + 1) for index in conflict]
    if len(numbers) == 1:
        return f"Contact {numbers[0]}{at} can't hold on any model{given}, even alone."
    rest = "" if len(numbers) == len(evidence.contacts) else "; the others are not needed for that"
    return f"Contacts {_words(numbers)}{at} can't hold together on any model{given}{rest}."


def _places(places: Sequence[str]) -> str:
    """Where contacts are in their file, which counts comments, blank lines and misses too."""
    if not places:
        return ""
    if all(place.startswith("line ") for place in places):
        lines = [place.removeprefix("line ") for place in places]
        return f" (line{'' if len(lines) == 1 else 's'} {_words(lines)} of the file)"
    return f" ({_words(places)} of the file)"


def _words(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def _verdict(found: Recognition | Found, labels: Sequence[str]) -> str:
    numbers = list(dict.fromkeys(hypothesis.model_number for hypothesis in found.hypotheses))
    parts = [escape(labels[number]) for number in numbers]
    interpretations = _at_least(found.interpretation_count, found.interpretation_count_exact)
    counts = f"{_count(len(found.hypotheses), 'hypothesis')}, {interpretations} in all"
    if not found.complete:
        number = hypothesis_count(found)
        listed = len(found.hypotheses)
        reached = f"{_count(number, 'hypothesis')} reached"
        shown = "" if number == listed else f", the first {listed} listed"
        return f"[bold]not all hypotheses were found[/bold]; {reached}{shown}, {interpretations}."
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
            escape(labels[hypothesis.model_number]) + (" *" if hypothesis.marginal else ""),
            _at_least_number(hypothesis.interpretation_count, hypothesis.interpretation_count_exact),
            *(f"{v:.2f}" if name.endswith("_deg") else decimal(v, size) for name, v in pose.items()),
            _bound(math.degrees(hypothesis.poses.rotation_bound)),
            _bound(excursion_bound(hypothesis)),
        )
    return table


def _print_interpretations(console: Console, hypothesis: Hypothesis, *, num_listed: int) -> None:
    for interpretation in itertools.islice(hypothesis.interpretations, num_listed):
        features = (
            f"{contact} on {kind} {index}"
            for contact, (kind, index) in enumerate(interpretation.assignment, 1)
        )
        marginal = " (marginal)" if interpretation.marginal else ""
        console.print(f"  {', '.join(features)}{marginal}")


def _face_table(model: Model, *, unit: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    if model.dimension == 3:
        return _flat_face_table(table, model, unit=unit)
    for head in ("face", f"from ({unit})", f"to ({unit})", "length", "normal (°)"):
        table.add_column(head, justify="right")
    table.add_column("surface")
    for index, (start, end) in enumerate(model.faces[:MOST_ROWS]):
        table.add_row(
            str(index),
            f"{decimal(start[0], model.size)}, {decimal(start[1], model.size)}",
            f"{decimal(end[0], model.size)}, {decimal(end[1], model.size)}",
            decimal(math.hypot(*(end - start)), model.size),
            f"{_direction_deg(model.face_normals[index]):.1f}",
            model.face_surfaces[index],
        )
    return table


def _flat_face_table(table: Table, model: Model, *, unit: str) -> Table:
    for head in ("face", "corners", "holes", f"inside ({unit})", f"area ({unit}²)", "normal"):
        table.add_column(head, justify="right")
    table.add_column("surface")
    areas, places = face_areas(model), face_places(model)
    for index, loops in enumerate(model.face_loops[:MOST_ROWS]):
        seam = model.face_surfaces[index] == "seam"
        table.add_row(
            str(index),
            str(sum(map(len, loops))),
            str(len(loops) - 1),
            # A seam has neither: nothing is there.
            "" if seam else ", ".join(decimal(value, model.size) for value in places[index]),
            "" if seam else f"{areas[index]:.5g}",
            ", ".join(decimal(value, 1.0) for value in model.face_normals[index]),
            model.face_surfaces[index],
        )
    return table


def _direction_deg(vector: NDArray[np.float64]) -> float:
    # Adding zero turns -0.0, whose direction would be -180 or -0.0, into 0.0.
    return math.degrees(math.atan2(vector[1] + 0.0, vector[0] + 0.0))


def _symmetries(model: Model) -> str:
    if model.dimension == 3:
        return _symmetries_in_space(model)
    turns = sorted(planar(motion)[2] % 360.0 for motion in model.symmetries)
    others = [f"{turn:.4g}°" for turn in turns if 1e-6 < turn < 360.0 - 1e-6]
    if not others:
        return "none"
    if len(others) > MOST_IN_LINE:
        # All are turns, so that they are the multiples of the smallest.
        return f"looks the same turned by multiples of {others[0]}, {len(turns)} in a full turn"
    return f"looks the same turned by {', '.join(others)}"


def _symmetries_in_space(model: Model) -> str:
    turns = [np.degrees(vector_of(motion[:3, :3])) for motion in model.symmetries]
    degrees = sorted(round(float(np.linalg.norm(turn)), 6) for turn in turns)
    angles = Counter(f"{angle:.5g}°" for angle in degrees if angle > 0.0)
    said = []
    if angles:
        several = _words([f"{number} by {angle}" for angle, number in angles.items()])
        which = f": {several}" if len(angles) <= MOST_IN_LINE else ", which --json lists"
        said.append(f"looks the same after {_count(angles.total(), 'turn')}{which}")
    for point, along in model.symmetry_axes:
        axis, through = (
            ", ".join(decimal(v, s) for v in of) for of, s in ((along, 1.0), (point, model.size))
        )
        said.append(f"any turn about ({axis}) through ({through})")
    return "; ".join(said) or "none"


def _numbers(numbers: Sequence[int]) -> str:
    if len(numbers) <= MOST_IN_LINE:
        return ", ".join(map(str, numbers))
    few = ", ".join(map(str, numbers[: MOST_IN_LINE - 3]))
    return f"{len(numbers)} of them, {few} ... {numbers[-1]}; --json lists them"


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
