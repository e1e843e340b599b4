"""The parts that a command line names: where each comes from, and how they are told apart."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from palpate import Model, load_models


@dataclass(frozen=True)
class Parts:
    """Models, with what was named to load each of them."""

    models: list[Model]
    sources: list[str]

    @property
    def dimension(self) -> int:
        """That of the first; recognition refuses others beside it."""
        return self.models[0].dimension

    @property
    def labels(self) -> list[str]:
        """A name for each: its own, with its number, counted from 1, where another one has it too."""
        names = [model.name for model in self.models]
        return [
            name if names.count(name) == 1 else f"{name} (model {number})"
            for number, name in enumerate(names, start=1)
        ]


def load_parts(
    paths: Sequence[str],
    *,
    unit: str,
    layers: str | None,
    flattening: float | None,
    position_slack: float,
    normal_slack_deg: float,
) -> Parts:
    """The models of files, folders and bundled parts, in this order; `layers` are separated by commas."""
    names = None if layers is None else [name.strip() for name in layers.split(",")]
    try:
        loaded = [
            (model, path)
            for path in paths
            for model in load_models(
                path,
                unit=unit,
                layers=names,
                flattening=flattening,
                position_slack=position_slack,
                normal_slack=math.radians(normal_slack_deg),
            )
        ]
    except ValueError as error:
        raise ValueError(with_flags(str(error))) from None
    return Parts([model for model, _ in loaded], [path for _, path in loaded])


def plane_only(models: Sequence[Model], what: str) -> None:
    """Refuse parts in space for what works in the plane only as yet."""
    for model in models:
        if model.dimension != 2:
            raise ValueError(
                f"{model.name}: is a part in space, {what} works in the plane only as yet; "
                "give parts in the plane"
            )


def with_flags(text: str) -> str:
    """What is said of arguments of Python, said of the flags of the command line."""
    text = re.sub(r"\blayers(=|(?=: ))", "--layers", text)
    return re.sub(r"\bflattening(=|(?=: ))", "--flattening", text)


def part_notes(parts: Parts, *, unit: str) -> list[str]:
    """A line for each part of which the reader of an answer must know more than its name."""
    names = [model.name for model in parts.models]
    lines: list[str] = []
    for number, (model, label) in enumerate(zip(parts.models, parts.labels, strict=True), start=1):
        first = 1 + parts.models.index(model)
        notes = [] if names.count(model.name) == 1 else [f"from {parts.sources[number - 1]}"]
        if first != number:
            notes.append(f"the same as model {first}: what fits one fits the other")
        if model.position_slack or model.normal_slack:
            notes.append(f"slack {slack_words(model, unit=unit)}, added to the errors of every contact")
        notes += [f"mended: {with_flags(mend)}" for mend in model.mends]
        if notes:
            lines.append(f"{label}: {'; '.join(notes)}")
    return lines


def slack_words(model: Model, *, unit: str) -> str:
    """How far the true outline may be from that of the model."""
    return f"{model.position_slack:.4g} {unit} and {math.degrees(model.normal_slack):.4g}°"
