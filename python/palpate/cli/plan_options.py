"""Flags of `palpate plan`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from palpate import Contact, Sensor
from palpate.cli import options
from palpate.cli.options import numbers_of, seconds

PLANNERS = ("auto", "complete", "ellis", "grimson", "schneiter")
METHODS = ("greedy", "ahead", "optimal")

incidence_deg = options.number(1e-6, 89.999999, "an angle in degrees, above 0 and below 90")


def one_of(names: tuple[str, ...]) -> Any:
    """A parser of one of some names."""

    def parse(text: str) -> str:
        if text not in names:
            raise typer.BadParameter(f"must be {', '.join(names[:-1])} or {names[-1]} (got {text!r})")
        return text

    return parse


def stop(text: str) -> str:
    """When a path is good enough: `perfect`, `unique=2`, `share=0.5`."""
    stop_of(text)
    return text


def stop_of(text: str) -> Any:
    """The same as Python has it."""
    name, _, amount = text.partition("=")
    try:
        if text == "perfect":
            return text
        if name == "unique" and int(amount) >= 1:
            return ("unique", int(amount))
        if name == "share" and 0.0 < float(amount) <= 1.0:
            return ("share", float(amount))
    except ValueError:
        pass
    raise typer.BadParameter(
        f"must be perfect, unique=K or share=F with F above 0 and at most 1 (got {text!r})"
    )


def workspace(text: str) -> str:
    """Two opposite corners."""
    x0, y0, x1, y1 = numbers_of(text, 4, "two opposite corners, X0,Y0,X1,Y1")
    if x0 == x1 or y0 == y1:
        raise typer.BadParameter(f"must have an area (got {text!r})")
    return text


def directions(text: str) -> str:
    """A direction and an angle."""
    _, half = numbers_of(text, 2, "a direction and how far from it, DEG,HALF")
    if not 0.0 <= half <= 180.0:
        raise typer.BadParameter(f"must have a half angle from 0 to 180 degrees (got {text!r})")
    return text


def workspace_of(text: str | None) -> list[list[float]] | None:
    """The same as Python has it."""
    if text is None:
        return None
    x0, y0, x1, y1 = (float(part) for part in text.split(","))
    return [[x0, y0], [x1, y1]]


def directions_of(text: str | None) -> tuple[tuple[float, float], float] | None:
    """The same as Python has it."""
    if text is None:
        return None
    angle, half = (math.radians(float(part)) for part in text.split(","))
    return (math.cos(angle), math.sin(angle)), min(half, math.pi)


def sensor_of(
    contacts: Sequence[Contact],
    *,
    position_error: float | None,
    normal_error_deg: float | None,
    no_normal: bool,
    max_incidence_deg: float,
    tip_radius: float | None,
    path_error: float | None,
) -> Sensor:
    """That of the flags; what they leave open is as the contacts have it."""
    if position_error is None:
        position_error = max((contact.position_error for contact in contacts), default=None)
    if position_error is None:
        raise ValueError("--position-error: is needed where there is no contact; give the bound as a length")
    if tip_radius is None:
        tip_radius = max((contact.tip_radius for contact in contacts), default=0.0)
    known = [contact.normal_error for contact in contacts if contact.normal_error is not None]
    normal_error = None
    if normal_error_deg is not None:
        normal_error = math.radians(normal_error_deg)
    elif known and len(known) == len(contacts):
        normal_error = max(known)
    return Sensor(
        position_error,
        None if no_normal else normal_error,
        math.radians(max_incidence_deg),
        tip_radius=tip_radius,
        path_error=path_error or 0.0,
    )


MaxIncidenceDeg = Annotated[
    float,
    typer.Option(
        parser=incidence_deg,
        metavar="DEG",
        help="Largest incidence at which a touch is reliable.",
        rich_help_panel="Sensor",
    ),
]
NoNormal = Annotated[
    bool,
    typer.Option(
        "--no-normal",
        metavar="",
        help="The next reading has no normal. Else it has if all contacts have.",
        rich_help_panel="Sensor",
    ),
]
PathError = Annotated[
    float | None,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="How far the tip may leave its line: of the next path, else 0; of misses that don't say, else "
        "their position error.",
        rich_help_panel="Sensor",
    ),
]
Planner = Annotated[
    str,
    typer.Option(
        parser=one_of(PLANNERS),
        metavar="NAME",
        help="auto, complete (all lines), ellis, grimson or schneiter.",
    ),
]
Stop = Annotated[
    str,
    typer.Option(
        parser=stop,
        metavar="WHEN",
        help="When a path is good enough: perfect; unique=K hypotheses identified; share=F of them.",
    ),
]
Workspace = Annotated[
    str | None,
    typer.Option(
        parser=workspace,
        metavar="X0,Y0,X1,Y1",
        help="Paths begin at the border of this rectangle; else just outside of all hypotheses.",
    ),
]
Directions = Annotated[
    str | None,
    typer.Option(
        parser=directions, metavar="DEG,HALF", help="Only directions of travel within HALF degrees of DEG."
    ),
]
AvoidAssigned = Annotated[
    bool,
    typer.Option("--avoid-assigned", metavar="", help="Never touch a face that a contact is assigned to."),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        parser=seconds, metavar="SECONDS", help="Then the best found so far is the answer, without proof."
    ),
]
Effort = Annotated[
    int | None,
    typer.Option(
        parser=options.whole(1, 10**15),
        metavar="N",
        help="A limit on the search that gives the same answer everywhere; else two million.",
        show_default=False,
    ),
]
Seed = Annotated[
    int,
    typer.Option(parser=options.whole(0, 2**63), metavar="N", help="For poses that are drawn at random."),
]
Tree = Annotated[
    bool, typer.Option("--tree", metavar="", help="The whole ambiguity tree, not only the next path.")
]
Method = Annotated[
    str | None,
    typer.Option(
        parser=one_of(METHODS),
        metavar="NAME",
        help="How the tree is chosen: greedy, ahead, or optimal (up to 12 hypotheses); else greedy.",
    ),
]
PlotTree = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Draw the ambiguity tree: .svg, .png or .pdf.")
]
PlotProjection = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Draw what every line would tell, by its direction and its place."),
]
PlotSheaves = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Draw the projection space in which ellis, the thesis's own search, finds its path.",
    ),
]
