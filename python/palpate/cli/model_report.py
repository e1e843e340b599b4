"""What was read of models, in words and tables, for people. Models are counted from 1, all else from 0."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from palpate import Model
from palpate.cli.documents import planar
from palpate.cli.parts import Parts, slack_words, with_flags
from palpate.cli.report import MOST_ROWS, count, decimal, words
from palpate.rotations import vector_of
from palpate.solids.faces import face_areas, face_places

MOST_IN_LINE = 8  # numbers that are listed one by one


def print_models(console: Console, parts: Parts, *, unit: str, faces: bool) -> None:
    """What was read of each model; what was changed in reading comes first. `faces`: each of them too."""
    for number, (model, label) in enumerate(zip(parts.models, parts.labels, strict=True), start=1):
        kind = "closed" if model.closed else "open"
        numbers = {"face": len(model.faces), "edge": len(model.edges), "vertex": len(model.vertices)}
        counts = ", ".join(count(n, noun) for noun, n in numbers.items() if noun != "edge" or n)
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
                console.print(f"  {nouns} that can't be touched, by number: {_numbers(untouchable)}")
        if faces:
            console.print(_face_table(model, unit=unit))
            if len(model.faces) > MOST_ROWS:
                console.print(
                    f"  ... and {len(model.faces) - MOST_ROWS} more faces; --json lists all of them."
                )


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
        several = words([f"{number} by {angle}" for angle, number in angles.items()])
        which = f": {several}" if len(angles) <= MOST_IN_LINE else ", which --json lists"
        said.append(f"looks the same after {count(angles.total(), 'turn')}{which}")
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
