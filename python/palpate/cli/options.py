"""Arguments and flags that commands share."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from palpate.parts import contacts_path

KINDS = ("face", "edge", "vertex")
MOST_LISTED = 1_000_000
MOST_HYPOTHESES = 1_000_000_000
MOST_EFFORT = 1_000_000_000_000


def number(low: float, high: float, meaning: str) -> Callable[[str | float], float]:
    """A parser of numbers from `low` to `high`; a message has the flag's name and what was typed."""

    def parse(text: str | float) -> float:
        try:
            value = float(text)
        except ValueError:
            raise typer.BadParameter(f"must be a number (got {text!r})") from None
        if not (math.isfinite(value) and low <= value <= high):
            raise typer.BadParameter(f"must be {meaning} (got {text})")
        return value

    return parse


def whole(least: int = 0, most: int | None = None) -> Callable[[str | int], int]:
    """A parser of whole numbers from `least` to `most`."""
    meaning = f", {least} or more" if most is None else f" from {least} to {most}"

    def parse(text: str | int) -> int:
        try:
            value = int(text)
        except ValueError:
            raise typer.BadParameter(f"must be a whole number (got {text!r})") from None
        if value < least or (most is not None and value > most):
            raise typer.BadParameter(f"must be a whole number{meaning} (got {text})")
        return value

    return parse


length = number(0.0, math.inf, "a length, zero or more, in the models' unit")
direction_error_deg = number(0.0, 90.0, "an angle in degrees, from 0 to 90")
slack_deg = number(0.0, 89.0, "an angle in degrees, from 0 to 89")
LONGEST_S = 1e9
seconds = number(1e-3, LONGEST_S, f"a time in seconds, from 0.001 to {LONGEST_S:g}")
rotation_deg = number(0.0, 180.0, "an angle in degrees, from 0 to 180")


def numbers_of(text: str, count: int, meaning: str) -> list[float]:
    """So many finite numbers, separated by commas."""
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise typer.BadParameter(f"must be {meaning} (got {text!r})")
    return values


def on_table(text: str) -> str:
    """A height and an angle."""
    height, tilt_deg = numbers_of(text, 2, "a length and an angle, LENGTH,DEG")
    if height < 0.0 or not 0.0 <= tilt_deg <= 180.0:
        raise typer.BadParameter(f"must be zero or more, the angle at most 180 (got {text!r})")
    return text


def contacts_file(text: str) -> Path:
    """A file, or that of the contacts that come with a bundled part."""
    bundled = None if Path(text).exists() else contacts_path(text)
    return bundled or Path(text)


def kinds(text: str) -> str:
    """Kinds of features, separated by commas: `face,vertex`."""
    names = [name.strip() for name in text.split(",")]
    if any(name not in KINDS for name in names):
        raise typer.BadParameter(f"must be some of {','.join(KINDS)} (got {text!r})")
    return ",".join(names)


def names(text: str) -> str:
    """Names separated by commas."""
    if not all(name.strip() for name in text.split(",")):
        raise typer.BadParameter(f"must be names separated by commas (got {text!r})")
    return text


Models = Annotated[
    list[str],
    typer.Argument(metavar="MODEL", help="Files, folders or names of bundled parts.", show_default=False),
]
ContactsFile = Annotated[
    Path,
    typer.Option(
        "--contacts",
        parser=contacts_file,
        metavar="FILE",
        help="Contacts, as .csv or .json; or the name of a bundled part, for those that come with it.",
        show_default=False,
    ),
]
PositionError = Annotated[
    float | None,
    typer.Option(
        parser=length,
        metavar="LENGTH",
        help="Bound on the position error of contacts whose own is not in the file.",
        rich_help_panel="Sensor",
    ),
]
NormalErrorDeg = Annotated[
    float | None,
    typer.Option(
        parser=direction_error_deg,
        metavar="DEG",
        help="The same for the error of their normals.",
        rich_help_panel="Sensor",
    ),
]
TipRadius = Annotated[
    float | None,
    typer.Option(
        parser=length,
        metavar="LENGTH",
        help="The same for the radius of the tip; else 0.",
        rich_help_panel="Sensor",
    ),
]
PathError = Annotated[
    float | None,
    typer.Option(
        parser=length,
        metavar="LENGTH",
        help="How far the tip may leave its line in a miss; else its position error.",
        rich_help_panel="Sensor",
    ),
]
PriorPose = Annotated[
    str | None,
    typer.Option(
        metavar="POSE",
        help="The part lies near this pose: X,Y,DEG; in space X,Y,Z,RX,RY,RZ, where RX,RY,RZ is the rotation "
        "vector: along its axis, as long as its angle, in degrees.",
        rich_help_panel="Prior",
    ),
]
PriorTranslation = Annotated[
    float | None,
    typer.Option(
        parser=length,
        metavar="LENGTH",
        help="x and y, in space z, are within this of the prior pose.",
        rich_help_panel="Prior",
    ),
]
PriorRotationDeg = Annotated[
    float | None,
    typer.Option(
        parser=rotation_deg,
        metavar="DEG",
        help="The rotation is within this of it; else free.",
        rich_help_panel="Prior",
    ),
]
OnTable = Annotated[
    str | None,
    typer.Option(
        parser=on_table,
        metavar="LENGTH,DEG",
        help="In space: it lies on a table, level as at the prior pose. Its z is within LENGTH of that, and "
        "it tilts by DEG at most; the other bounds are along the table and about z.",
        rich_help_panel="Prior",
    ),
]
Features = Annotated[
    str | None,
    typer.Option(
        parser=kinds,
        metavar="LIST",
        help="What may be touched: face, vertex and, in space, edge. Else faces; all if a tip has a radius.",
    ),
]
MaxHypotheses = Annotated[
    int | None,
    typer.Option(
        parser=whole(1, MOST_HYPOTHESES),
        metavar="N",
        help="Return at most so many hypotheses, and say if there are more.",
        show_default=False,
    ),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        parser=seconds,
        metavar="SECONDS",
        help="Then what was found so far is the answer, and it says that it is not complete.",
        show_default=False,
    ),
]
Effort = Annotated[
    int | None,
    typer.Option(
        parser=whole(1, MOST_EFFORT),
        metavar="N",
        help="Where poses are divided, examine about so many cells of each model at most: a limit that gives "
        "the same answer every time. Else 2,000,000 in the plane, 20,000 in space.",
        show_default=False,
    ),
]
ListInterpretations = Annotated[
    int,
    typer.Option(
        parser=whole(0, MOST_LISTED), metavar="N", help="List up to N interpretations of each hypothesis."
    ),
]
Unit = Annotated[
    str, typer.Option(help="Unit of the models: um, mm, cm, m, in or ft. Files in another are converted.")
]
Layers = Annotated[
    str | None,
    typer.Option(
        parser=names,
        metavar="NAME,...",
        help="Layers of DXF drawings to read; else all that are shown.",
        rich_help_panel="Model files",
    ),
]
Flattening = Annotated[
    float | None,
    typer.Option(
        parser=length,
        metavar="LENGTH",
        help="How far chords may be from curves of a drawing, triangles from those of STEP; else 0.05 mm.",
        rich_help_panel="Model files",
    ),
]
PositionSlack = Annotated[
    float,
    typer.Option(
        parser=length,
        metavar="LENGTH",
        help="How far the true parts may lie from what their files say, beyond what is known of it.",
        rich_help_panel="Model files",
    ),
]
NormalSlackDeg = Annotated[
    float,
    typer.Option(
        parser=slack_deg,
        metavar="DEG",
        help="The same for their normals.",
        rich_help_panel="Model files",
    ),
]
Faces = Annotated[
    bool, typer.Option("--faces", metavar="", help="List the faces of each model, with their numbers.")
]
Plot = Annotated[Path | None, typer.Option(metavar="FILE", help="Draw a picture: .svg, .png or .pdf.")]
PlotRange = Annotated[
    int | None,
    typer.Option(
        parser=whole(1), metavar="K", help="Draw the range of poses of hypothesis K alone, not all of them."
    ),
]
Stats = Annotated[bool, typer.Option("--stats", metavar="", help="Show what the search did.")]
Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Compute on a Dask cluster: local, local:N, or a scheduler such as tcp://host:8786. "
        "Else in this process.",
    ),
]
Json = Annotated[bool, typer.Option("--json", metavar="", help="Print JSON, for machines.")]
