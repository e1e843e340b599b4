"""What every line would tell, by its direction and its place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from palpate._core import Hypothesis, Lines, Path, Sensor
from palpate.plots.style import CONFLICT, RC, new_figure

NUM_ANGLES = 360
NUM_OFFSETS = 240


def plot_lines(
    hypotheses: Sequence[Hypothesis],
    sensor: Sensor,
    path: Path | None = None,
    *,
    unit: str = "mm",
    **where: Any,
) -> Figure:
    """The score of every line of a grid; a path is marked.

    A point is a line: across, the angle at which the tip travels; upward, how far it passes to the left of
    the middle of all hypotheses. Dark is good, 1 separates all. White can't be used. The thesis draws the
    projections of one generator in such a plane (figures 3.5 to 3.7); here are all faces at once, with all
    poses and errors.

    Args:
        hypotheses: As for `palpate.plan`.
        sensor: As for `palpate.plan`.
        path: A path to mark.
        unit: Of the models, for the axes.
        **where: `workspace`, `directions`, `features`, `avoid_assigned` as for `palpate.plan`.
    """
    lines = Lines(hypotheses, sensor, **where)
    # Half a step off the axes: lines that run exactly along faces would stand for their neighbours.
    angles = -math.pi + 2.0 * math.pi * (np.arange(NUM_ANGLES) + 0.5) / NUM_ANGLES
    offsets = lines.radius * (2.0 * (np.arange(NUM_OFFSETS) + 0.5) / NUM_OFFSETS - 1.0)
    scores = lines.scores(angles, offsets)
    with mpl.rc_context(RC):
        figure = new_figure((8.0, 4.8))
        axes = figure.add_subplot()
        extent = (-180.0, 180.0, -lines.radius, lines.radius)
        image = axes.imshow(
            scores.T,
            origin="lower",
            extent=extent,
            aspect="auto",
            cmap="viridis",
            interpolation="nearest",
            vmin=1.0,
            vmax=max(1.0 + 1e-9, float(len(hypotheses))),
        )
        figure.colorbar(image, ax=axes, label=f"score, of {len(hypotheses)}")
        if path is not None:
            x, y = path.direction
            offset = float(np.dot([-y, x], path.start - lines.middle))
            axes.plot(math.degrees(math.atan2(y, x)), offset, marker="+", ms=14, mew=2.0, color=CONFLICT)
        axes.set_xticks(range(-180, 181, 45))
        axes.set_xlabel("direction of travel (°)")
        axes.set_ylabel(f"passes to the left of the middle ({unit})")
        usable = float(np.mean(~np.isnan(scores)))
        axes.set_title(f"what each line would tell; {usable:.0%} of them can be used")
    return figure
