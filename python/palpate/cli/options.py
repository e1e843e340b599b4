"""Arguments and flags that commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def real(text: str | float) -> float:
    """A number; whether it is sensible is decided where it is used."""
    try:
        return float(text)
    except ValueError:
        raise typer.BadParameter(f"must be a number (got {text!r})") from None


def whole(text: str | int) -> int:
    """A whole number; whether it is sensible is decided where it is used."""
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"must be a whole number (got {text!r})") from None


Models = Annotated[
    list[str],
    typer.Argument(metavar="MODEL", help="Files, folders or names of bundled parts.", show_default=False),
]
ContactsFile = Annotated[
    Path, typer.Option("--contacts", metavar="FILE", help="Contacts, as .csv or .json.", show_default=False)
]
PositionError = Annotated[
    float | None,
    typer.Option(
        parser=real,
        metavar="LENGTH",
        help="Bound on the position error of contacts whose own is not in the file.",
        rich_help_panel="Sensor",
    ),
]
NormalErrorDeg = Annotated[
    float | None,
    typer.Option(
        parser=real, metavar="DEG", help="The same for the error of their normals.", rich_help_panel="Sensor"
    ),
]
TipRadius = Annotated[
    float | None,
    typer.Option(
        parser=real,
        metavar="LENGTH",
        help="The same for the radius of the tip; else 0.",
        rich_help_panel="Sensor",
    ),
]
PathError = Annotated[
    float | None,
    typer.Option(
        parser=real,
        metavar="LENGTH",
        help="How far the tip may leave its line in a miss; else its position error.",
        rich_help_panel="Sensor",
    ),
]
PriorPose = Annotated[
    str | None,
    typer.Option(metavar="X,Y,DEG", help="The part lies near this pose.", rich_help_panel="Prior"),
]
PriorTranslation = Annotated[
    float | None,
    typer.Option(
        parser=real,
        metavar="LENGTH",
        help="x and y are within this of the prior pose.",
        rich_help_panel="Prior",
    ),
]
PriorRotationDeg = Annotated[
    float | None,
    typer.Option(
        parser=real,
        metavar="DEG",
        help="The rotation is within this of it; else free.",
        rich_help_panel="Prior",
    ),
]
Features = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="What may be touched: face, vertex or face,vertex. Else faces; both if a tip has a radius.",
    ),
]
MaxHypotheses = Annotated[
    int | None,
    typer.Option(
        parser=whole, metavar="N", help="Stop at so many hypotheses, and say so.", show_default=False
    ),
]
ListInterpretations = Annotated[
    int, typer.Option(parser=whole, metavar="N", help="List up to N interpretations of each hypothesis.")
]
Unit = Annotated[
    str, typer.Option(help="Unit of the models: um, mm, cm, m, in or ft. Files in another are converted.")
]
Plot = Annotated[Path | None, typer.Option(metavar="FILE", help="Draw a picture: .svg, .png or .pdf.")]
PlotRange = Annotated[
    int | None,
    typer.Option(
        parser=whole, metavar="K", help="Draw the range of poses of hypothesis K alone, not all of them."
    ),
]
Stats = Annotated[bool, typer.Option("--stats", help="Show what the search did.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for machines.")]
