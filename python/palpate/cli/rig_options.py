"""Flags of `palpate identify --probe rig`, and the rig that they make."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from palpate.cli import options
from palpate.contacts.entry import mm_per
from palpate.loop.route import Array
from palpate.rig import SIZE, RigSpec, without_errors

PANEL = "Rig"
FASTEST = 1000.0  # mm/s
ERRORS = ("drift", "creep", "noise")

FLAGS = {
    "spec.control.guard_speed": "--guard-speed",
    "spec.control.free_speed": "--free-speed",
    "spec.control.force": "--press-force",
    "spec.control.rate_hz": "--rate-hz",
    "spec.bearing.radius": "--tip-radius",
    "max_incidence:": "--max-incidence-deg:",
    "sensor: its position_error": "--position-error:",
    "sensor: its path_error": "--path-error:",
    "sensor: its normal_error": "--normal-error-deg:",
}
"""By what Python calls them."""

_speed = options.number(0.1, FASTEST, f"a speed in mm/s, from 0.1 to {FASTEST:g}")
_force = options.number(0.1, 1000.0, "a force in N, from 0.1 to 1000")
_rate = options.number(10.0, 1000.0, "a rate in Hz, from 10 to 1000")


def without(text: str) -> str:
    """Names of errors, separated by commas."""
    names = [name.strip() for name in text.split(",")]
    if any(name not in ERRORS for name in names):
        raise typer.BadParameter(f"must be some of {','.join(ERRORS)} (got {text!r})")
    return ",".join(names)


def film(text: str) -> Path:
    """A page."""
    path = Path(text)
    if path.suffix.lower() != ".html" or not path.parent.is_dir():
        raise typer.BadParameter(f"must end in .html, in a folder that is there (got {text!r})")
    return path


GuardSpeed = Annotated[
    float | None,
    typer.Option(
        parser=_speed,
        metavar="MM/S",
        help="Of guarded moves; else 20.",
        rich_help_panel=PANEL,
        show_default=False,
    ),
]
FreeSpeed = Annotated[
    float | None,
    typer.Option(
        parser=_speed,
        metavar="MM/S",
        help="Of free moves; else 100.",
        rich_help_panel=PANEL,
        show_default=False,
    ),
]
PressForce = Annotated[
    float | None,
    typer.Option(
        parser=_force,
        metavar="N",
        help="At which a contact is read; else 9. The beam bears 22.",
        rich_help_panel=PANEL,
        show_default=False,
    ),
]
RateHz = Annotated[
    float | None,
    typer.Option(
        parser=_rate, metavar="HZ", help="Of its control; else 60.", rich_help_panel=PANEL, show_default=False
    ),
]
Without = Annotated[
    str | None,
    typer.Option(
        parser=without,
        metavar="LIST",
        help="Errors of the force sensor that it has not: drift,creep,noise.",
        rich_help_panel=PANEL,
        show_default=False,
    ),
]
Record = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Draw force, position and state over time: .svg, .png or .pdf.",
        rich_help_panel=PANEL,
        show_default=False,
    ),
]
Film = Annotated[
    Path | None,
    typer.Option(
        parser=film,
        metavar="FILE",
        help="Write a page that plays the run: .html, with nothing to load.",
        rich_help_panel=PANEL,
        show_default=False,
    ),
]


@dataclass(frozen=True)
class RigFlags:
    """As they were given; None: not given."""

    guard_speed: float | None
    free_speed: float | None
    press_force: float | None
    rate_hz: float | None
    without: str | None
    record: Path | None
    film: Path | None

    def check_unused(self) -> None:
        """Refuse them where the probe is another one.

        Raises:
            ValueError: Naming the first.
        """
        for name, value in vars(self).items():
            if value is not None:
                flag = f"--{name.replace('_', '-')}"
                raise ValueError(f"{flag} {value}: is of the rig; give it with --probe rig, or leave it out")

    def check_files(self) -> None:
        """Refuse pictures that can't be drawn, before the run."""
        if self.record is not None:
            from palpate.plots.style import check_picture_path

            check_picture_path(self.record)

    def spec(self, tip_radius: float | None) -> RigSpec:
        """The rig, with a bearing of this radius in mm."""
        spec = RigSpec()
        given = {
            "guard_speed": self.guard_speed,
            "free_speed": self.free_speed,
            "force": self.press_force,
            "rate_hz": self.rate_hz,
        }
        control = replace(spec.control, **{name: value for name, value in given.items() if value is not None})
        spec = replace(spec, control=control)
        if tip_radius is not None:
            spec = replace(spec, bearing=replace(spec.bearing, radius=tip_radius))
        return without_errors(spec, *(() if self.without is None else self.without.split(",")))


@contextmanager
def flags_named() -> Iterator[None]:
    """Errors of the rig name the flag where they would name what Python calls it."""
    try:
        yield
    except ValueError as error:
        message = str(error)
        for name, flag in FLAGS.items():
            if message.startswith(name):
                raise ValueError(flag + message.removeprefix(name)) from None
        raise


def rig_workspace(dimension: int, *, unit: str) -> Array:
    """That of the thesis's rig, in the unit."""
    return np.array([np.zeros(dimension), SIZE[dimension]]) / mm_per(unit, "unit")
