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
from palpate.planner_names import PLANNERS

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
    d = 3 if text.count(",") == 5 else 2
    corners = numbers_of(text, 2 * d, "two opposite corners, X0,Y0,X1,Y1, or X0,Y0,Z0,X1,Y1,Z1 in space")
    if any(a == b for a, b in zip(corners[:d], corners[d:], strict=True)):
        raise typer.BadParameter(f"must have {'an area' if d == 2 else 'a volume'} (got {text!r})")
    return text


def directions(text: str) -> str:
    """A direction and an angle."""
    count = 4 if text.count(",") == 3 else 2
    *toward, half = numbers_of(
        text, count, "a direction and how far from it, DEG,HALF, or DX,DY,DZ,HALF in space"
    )
    if not 0.0 <= half <= 180.0:
        raise typer.BadParameter(f"must have a half angle from 0 to 180 degrees (got {text!r})")
    if count == 4 and not any(toward):
        raise typer.BadParameter(f"must point somewhere (got {text!r})")
    return text


def workspace_of(text: str | None, dimension: int) -> list[list[float]] | None:
    """The same as Python has it, for parts of a dimension."""
    if text is None:
        return None
    corners = [float(part) for part in text.split(",")]
    if len(corners) != 2 * dimension:
        form = {2: "X0,Y0,X1,Y1 for parts in the plane", 3: "X0,Y0,Z0,X1,Y1,Z1 for parts in space"}
        raise ValueError(f"--workspace: must be {form[dimension]} (got {text!r}); give so many numbers")
    return [corners[:dimension], corners[dimension:]]


def directions_of(text: str | None, dimension: int) -> tuple[tuple[float, ...], float] | None:
    """The same as Python has it, for parts of a dimension."""
    if text is None:
        return None
    *toward, half_deg = (float(part) for part in text.split(","))
    if len(toward) != {2: 1, 3: 3}[dimension]:
        form = {2: "DEG,HALF for parts in the plane", 3: "DX,DY,DZ,HALF for parts in space"}
        raise ValueError(f"--directions: must be {form[dimension]} (got {text!r}); give so many numbers")
    half = min(math.radians(half_deg), math.pi)
    if dimension == 3:
        return tuple(toward), half
    angle = math.radians(toward[0])
    return (math.cos(angle), math.sin(angle)), half


def stem(text: str) -> str:
    """A rod: direction, radius, length."""
    *direction, radius, length = numbers_of(text, 5, "a rod from the tip, DX,DY,DZ,RADIUS,LENGTH")
    if not any(direction) or radius < 0.0 or length <= 0.0:
        raise typer.BadParameter(f"must point somewhere and have a length above zero (got {text!r})")
    return text


def stem_of(text: str | None) -> tuple[tuple[float, ...], float, float] | None:
    """The same as Python has it."""
    if text is None:
        return None
    *direction, radius, length = (float(part) for part in text.split(","))
    return tuple(direction), radius, length


def sensor_of(
    contacts: Sequence[Contact],
    *,
    position_error: float | None,
    normal_error_deg: float | None,
    no_normal: bool,
    max_incidence_deg: float,
    tip_radius: float | None,
    path_error: float | None,
    stem: str | None = None,
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
        stem=stem_of(stem),
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
Stem = Annotated[
    str | None,
    typer.Option(
        parser=stem,
        metavar="DX,DY,DZ,RADIUS,LENGTH",
        help="In space, the rod that carries the tip: only paths on which it surely touches nothing first.",
        rich_help_panel="Sensor",
    ),
]
Planner = Annotated[
    str,
    typer.Option(
        parser=one_of(PLANNERS),
        metavar="NAME",
        help="auto, grimson or schneiter; in the plane complete (all lines) or ellis; in space optimized, "
        "linearized or decoupled.",
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
        help="Paths begin at the border of this rectangle, or box (X0,Y0,Z0,X1,Y1,Z1); else just outside of "
        "all hypotheses.",
    ),
]
Directions = Annotated[
    str | None,
    typer.Option(
        parser=directions,
        metavar="DEG,HALF",
        help="Only directions of travel within HALF degrees of DEG; in space DX,DY,DZ,HALF.",
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
