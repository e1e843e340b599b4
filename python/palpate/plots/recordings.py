"""What happened in the rig: force, position and state over time."""

from __future__ import annotations

from itertools import pairwise

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from palpate.plots.style import COLORS, FAINT, RC, SENSED, new_figure
from palpate.rig.recording import STATES, Array, Recording

STATE_COLORS = dict(
    zip(
        STATES,
        ("#E4E4E0", "#C9DDEE", COLORS[5], COLORS[1], COLORS[3], COLORS[2], COLORS[4], "#B8C9A3"),
        strict=True,
    )
)


def plot_recording(recording: Recording, *, begin: float = 0.0, end: float | None = None) -> Figure:
    """Force, position and state at every tick.

    Args:
        recording: Of a `palpate.rig.RigProbe`.
        begin: From this simulated second on.
        end: Up to this one; None: to the last.

    Raises:
        ValueError: No tick is between them.
    """
    times = recording.column("time")
    shown = (times >= begin) & (times <= (np.inf if end is None else end))
    if not shown.any():
        raise ValueError(
            f"begin: leaves no tick of the recording (got {begin:g} to {end}); "
            f"it has {len(recording)}, and ends at {times[-1] if len(times) else 0.0:g} s"
        )
    times, forces = times[shown], recording.column("force")[shown]
    with mpl.rc_context(RC):
        figure = new_figure((9.0, 5.2))
        grid = figure.add_gridspec(3, 1, height_ratios=(6, 6, 1))
        upper = figure.add_subplot(grid[0])
        middle = figure.add_subplot(grid[1], sharex=upper)
        lower = figure.add_subplot(grid[2], sharex=upper)
        for k, name in enumerate("xyz"[: forces.shape[1]]):
            upper.plot(times, forces[:, k], lw=0.9, color=COLORS[k], label=name)
            middle.plot(times, recording.column("base")[shown][:, k], lw=1.1, color=COLORS[k], label=name)
        upper.plot(times, np.hypot.reduce(forces, axis=1), lw=1.3, color=SENSED, label="all")
        upper.set_ylabel("sensed force (N)")
        middle.set_ylabel("encoders (mm)")
        for axes in (upper, middle):
            axes.spines[["top", "right"]].set_visible(False)
            axes.tick_params(labelbottom=False)
        figure.legend(*upper.get_legend_handles_labels(), loc="outside upper right", ncols=4)
        _draw_states(lower, times, recording.states[shown])
        lower.set_xlabel("simulated time (s)")
        upper.set_xlim(times[0], times[-1])
        used = sorted(set(recording.states[shown].tolist()))
        handles = [Patch(color=STATE_COLORS[STATES[k]], label=STATES[k]) for k in used]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def _draw_states(axes: Axes, times: Array, states: np.ndarray) -> None:
    """A strip, a colour for each state."""
    changes = np.flatnonzero(np.diff(states)) + 1
    edges = [0, *changes.tolist(), len(states) - 1]
    for first, last in pairwise(edges):
        axes.axvspan(times[first], times[last], color=STATE_COLORS[STATES[states[first]]], lw=0.0)
    axes.set_yticks([])
    axes.spines[:].set_visible(False)
    axes.tick_params(color=FAINT)
