"""Flags of `palpate identify`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from palpate.cli import options
from palpate.cli.options import numbers_of
from palpate.cli.plan_options import one_of
from palpate.usual import NORMAL_ERROR_DEG, POSITION_ERROR

PROBES = ("sim", "rig")
NOISES = ("uniform", "bounds", "none")


def pose(text: str) -> str:
    """A pose, or a random one."""
    if text != "random":
        in_space = text.count(",") == 5
        numbers_of(text, 6 if in_space else 3, "a pose, X,Y,DEG, in space X,Y,Z,RX,RY,RZ, or random")
    return text


def until(text: str) -> str:
    """A length and an angle."""
    if not all(bound > 0.0 for bound in numbers_of(text, 2, "a length and an angle, LENGTH,DEG")):
        raise typer.BadParameter(f"must be above zero (got {text!r})")
    return text


def until_of(text: str | None) -> tuple[float, float] | None:
    """The same as Python has it."""
    if text is None:
        return None
    length, angle = (float(part) for part in text.split(","))
    return length, math.radians(angle)


def normal_error_deg_of(degrees: float | None, *, no_normal: bool) -> float | None:
    """The bound, the usual one if none is given; None: readings have no normal."""
    if no_normal and degrees is not None:
        raise ValueError(f"--normal-error-deg {degrees:g}: must be given without --no-normal; choose one")
    return None if no_normal else NORMAL_ERROR_DEG if degrees is None else degrees


def probe(text: str) -> str:
    """The name of a probe."""
    if text not in PROBES:
        raise typer.BadParameter(
            f"must be {' or '.join(PROBES)}; equipment of your own is for Python (got {text!r})"
        )
    return text


Probe = Annotated[
    str,
    typer.Option(
        parser=probe,
        metavar="NAME",
        help="sim: a simulated one, with errors within bounds. rig: the thesis's rig in a physics engine, "
        "with bounds that follow from how it is built. Equipment of your own is for Python.",
        rich_help_panel="Simulation",
    ),
]
Truth = Annotated[
    str | None,
    typer.Option(
        metavar="MODEL",
        help="The part that lies there: a file, a bundled part, or one of MODEL by its name. Else the first.",
        rich_help_panel="Simulation",
        show_default=False,
    ),
]
Pose = Annotated[
    str,
    typer.Option(
        parser=pose,
        metavar="X,Y,DEG",
        help="Where it lies, in space X,Y,Z,RX,RY,RZ; random: in the workspace, as the prior has it.",
        rich_help_panel="Simulation",
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(
        parser=one_of(NOISES),
        metavar="NAME",
        help="Errors of readings of sim: uniform within the bounds, at the bounds, or none.",
        rich_help_panel="Simulation",
        show_default="uniform",
    ),
]
Overtravel = Annotated[
    float | None,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="The tip of sim presses on by up to this before it is read; a part of the position error.",
        rich_help_panel="Simulation",
        show_default="0",
    ),
]
PositionError = Annotated[
    float,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="Bound on the error of the sensed place.",
        rich_help_panel="Sensor",
    ),
]
TipRadius = Annotated[
    float,
    typer.Option(parser=options.length, metavar="LENGTH", help="Of the tip.", rich_help_panel="Sensor"),
]
PathError = Annotated[
    float,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="How far the tip may leave its line; not given, or 0: as far as the position error.",
        rich_help_panel="Sensor",
    ),
]
# Where the probe may be the rig, whose bounds are derived if none are given.
ProbePositionError = Annotated[
    float | None,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="Bound on the error of the sensed place.",
        rich_help_panel="Sensor",
        show_default=f"{POSITION_ERROR:g}; of the rig, derived",
    ),
]
NormalErrorDeg = Annotated[
    float | None,
    typer.Option(
        parser=options.direction_error_deg,
        metavar="DEG",
        help="Bound on the error of the sensed normal.",
        rich_help_panel="Sensor",
        show_default=f"{NORMAL_ERROR_DEG:g}",
    ),
]
ProbeNormalErrorDeg = Annotated[
    float | None,
    typer.Option(
        parser=options.direction_error_deg,
        metavar="DEG",
        help="Bound on the error of the sensed normal.",
        rich_help_panel="Sensor",
        show_default=f"{NORMAL_ERROR_DEG:g}; of the rig, derived",
    ),
]
NoNormal = Annotated[
    bool,
    typer.Option("--no-normal", metavar="", help="Readings have no normal.", rich_help_panel="Sensor"),
]
ProbeTipRadius = Annotated[
    float | None,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="Of the tip; of the rig, its bearing.",
        rich_help_panel="Sensor",
        show_default="0; of the rig, 5 mm",
    ),
]
ProbePathError = Annotated[
    float | None,
    typer.Option(
        parser=options.length,
        metavar="LENGTH",
        help="How far the tip may leave its line; 0: as far as the position error.",
        rich_help_panel="Sensor",
        show_default="0; of the rig, derived",
    ),
]
ContactsFile = Annotated[
    Path | None,
    typer.Option(
        "--contacts",
        parser=options.contacts_file,
        metavar="FILE",
        help="What was touched before, as for palpate recognize; nothing is scanned then, but for --blind.",
        show_default=False,
    ),
]
Drawn = Annotated[
    int | None,
    typer.Option(
        parser=options.whole(1, 10**6),
        metavar="N",
        help="Begin with N contacts at random places of the part instead of scans.",
        rich_help_panel="Simulation",
        show_default=False,
    ),
]
Blind = Annotated[
    int | None,
    typer.Option(
        parser=options.whole(1, 10**6),
        metavar="N",
        help="Go on with blind scans until N contacts are had, instead of two independent normals (in space "
        "three).",
        show_default=False,
    ),
]
MaxTouches = Annotated[
    int,
    typer.Option(parser=options.whole(1, 10**6), metavar="N", help="Make at most so many guarded moves."),
]
Effort = Annotated[
    int,
    typer.Option(
        parser=options.whole(1, 10**15),
        metavar="N",
        help="A limit on each search for a path that gives the same answer everywhere.",
    ),
]
Until = Annotated[
    str | None,
    typer.Option(
        parser=until,
        metavar="LENGTH,DEG",
        help="Touch the last hypothesis until its poses differ by no more.",
        show_default=False,
    ),
]
Log = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Keep every event, as JSON lines.", show_default=False),
]
Resume = Annotated[
    bool, typer.Option("--resume", metavar="", help="Go on with the log of a run that was stopped.")
]
Plot = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Draw the run: .svg, .png or .pdf; or a folder, for a picture of each step.",
        show_default=False,
    ),
]
LogFile = Annotated[Path, typer.Argument(metavar="FILE", help="The log of a run.", show_default=False)]
