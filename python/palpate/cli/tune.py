"""`palpate tune`: design parameters for a set of models, from loops over random data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from palpate import Sensor
from palpate.cli import identify_options, options, plan_options
from palpate.cli.console import results
from palpate.cli.documents import print_document
from palpate.cli.parts import load_parts, plane_only
from palpate.usual import MAX_INCIDENCE_DEG, POSITION_ERROR

Problems = Annotated[
    int,
    typer.Option(parser=options.whole(1, 10**6), metavar="N", help="Random problems for each setting."),
]
Speed = Annotated[
    float,
    typer.Option(
        parser=options.number(1e-9, math.inf, "above zero, in the models' unit per second"),
        metavar="LENGTH",
        help="How far the tip moves in a second.",
        rich_help_panel="Machine",
    ),
]
TouchTime = Annotated[
    float,
    typer.Option(
        parser=options.number(0.0, math.inf, "seconds, zero or more"),
        metavar="SECONDS",
        help="What a guarded move takes beside its travel.",
        rich_help_panel="Machine",
    ),
]
Out = Annotated[
    Path,
    typer.Option(metavar="FOLDER", help="Where rows go. Rows that are there are not computed again."),
]

HEADINGS = [
    "stop",
    "contacts",
    "bounds",
    "loops",
    "lost",
    "solved",
    "others",
    "touches",
    "95 %",
    "travel",
    "computed",
    "a part",
]


def tune(
    models: options.Models,
    *,
    problems: Problems = 30,
    position_error: identify_options.PositionError = POSITION_ERROR,
    normal_error_deg: identify_options.NormalErrorDeg = None,
    no_normal: identify_options.NoNormal = False,
    max_incidence_deg: plan_options.MaxIncidenceDeg = MAX_INCIDENCE_DEG,
    tip_radius: identify_options.TipRadius = 0.0,
    path_error: identify_options.PathError = 0.0,
    speed: Speed = 100.0,
    touch_time: TouchTime = 1.0,
    seed: plan_options.Seed = 0,
    cluster: options.Cluster = None,
    out: Out = Path("palpate-tune"),
    unit: options.Unit = "mm",
    layers: options.Layers = None,
    flattening: options.Flattening = None,
    position_slack: options.PositionSlack = 0.0,
    normal_slack_deg: options.NormalSlackDeg = 0.0,
    json: options.Json = False,
) -> None:
    """Which stop rule, how many first contacts, which bounds for a set of models (thesis 6.1).

    Closed loops with simulated parts at random poses, each setting on the same problems. What a part costs is
    the time to move, to touch and to compute; the last is measured here. Where the best two settings cost
    nearly the same, they get more problems.

    Exit code 0: there is an answer; 1: a loop lost the truth, which is a fault; 2: bad input.
    """
    from palpate.experiments import tune as tuning

    parts = load_parts(
        models,
        unit=unit,
        layers=layers,
        flattening=flattening,
        position_slack=position_slack,
        normal_slack_deg=normal_slack_deg,
    )
    plane_only(parts.models, "tuning")
    normal_error_deg = identify_options.normal_error_deg_of(normal_error_deg, no_normal=no_normal)
    normal_error = None if normal_error_deg is None else math.radians(normal_error_deg)
    sensor = Sensor(position_error, normal_error, math.radians(max_incidence_deg), tip_radius, path_error)
    costs = tuning.Costs(speed, touch_time)
    advice = tuning.tune(parts.models, sensor, costs, problems=problems, out=out, seed=seed, cluster=cluster)
    made = tuning.document(advice, parts.models, sensor, unit=unit, seed=seed)
    if json:
        print_document(made)
    else:
        _print(results(), made, unit=unit)
    if any(one["lost"] for one in made["tried"]):
        raise typer.Exit(1)


def _print(console: Console, made: dict[str, Any], *, unit: str) -> None:
    title = f"{made['loops']} loops for each setting, more for the best two if close; seed {made['seed']}"
    shown = Table(title=title)
    for heading in HEADINGS:
        shown.add_column(heading, justify="right")
    for one in made["tried"]:
        shown.add_row(*cells(one))
    console.print(shown)
    for line in advice_lines(made, unit=unit):
        console.print(line, soft_wrap=True)


def cells(one: dict[str, Any]) -> list[str]:
    """A row of the table, as `HEADINGS`."""
    status = dict(one["status"])
    solved, loops = status.pop("solved", 0), one["loops"]
    return [
        one["stop"],
        "auto" if one["blind"] is None else str(one["blind"]),
        bounds_words(one, unit=""),
        str(loops),
        str(one["lost"]),
        f"{100 * solved / loops:.0f} %",
        ", ".join(f"{count} {name}" for name, count in sorted(status.items())) or "-",
        f"{one['touches']:.1f}",
        f"{one['touches_95']:.0f}",
        f"{one['travel']:.0f}",
        f"{one['computing_seconds']:.2f} s",
        f"{one['part_seconds']:.1f} s",
    ]


def bounds_words(one: dict[str, Any], *, unit: str) -> str:
    """Both bounds of a reading."""
    angle = "" if one["normal_error_deg"] is None else f", ±{one['normal_error_deg']:g}°"
    return f"±{one['position_error']:g}{unit and ' '}{unit}{angle}"


def advice_lines(made: dict[str, Any], *, unit: str) -> Sequence[str]:
    """The recommendation in words."""
    best, widest = made["recommended"], made["widest_bounds"]
    first = "until two normals are independent" if best["blind"] is None else f"--blind {best['blind']}"
    said = f"recommended: --stop {best['stop']}, first contacts {first}"
    lines = [f"{said}: {best['part_seconds']:.1f} s a part"]
    if widest is None:
        lines.append("bounds: none of those tried solve 95 % of the loops; these parts need finer readings")
    else:
        wider = any(one["position_error"] > widest["position_error"] for one in made["tried"])
        rest = "wider ones are not" if wider else "wider ones were not tried"
        words = bounds_words(widest, unit=unit)
        lines.append(f"bounds: {words} are enough, 95 % of the loops are solved; {rest}")
    return lines
