"""A run of the loop: a picture for each step, and one of the whole (figures 4.12 to 4.16)."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from palpate._core import Hypothesis, Miss
from palpate.loop import Result, Step
from palpate.plots.pictures import MOST_DRAWN, spike_for
from palpate.plots.shapes import Array, draw_contact, draw_model, evidence_points, placed
from palpate.plots.style import FAINT, RC, SENSED, frame_of, new_figure, part_style, set_frame, shape_of
from palpate.probe import Hit, Skid


def plot_run(
    result: Result, step: int | None = None, *, unit: str = "mm", part_names: Sequence[str] | None = None
) -> Figure:
    """A step of a run, or all of it: hypotheses, paths as planned dashed, as travelled solid, contacts.

    Args:
        result: Of `identify` or `replay`.
        step: Number of a step, from 0: what was known when it was planned, and what it met. None: the whole
            run, with what is left.
        unit: Of the models, for the axes.
        part_names: What to call the models, in their order; else they have their own names.

    Raises:
        ValueError: There is no such step.
    """
    if step is not None and not 0 <= step < len(result.steps):
        raise ValueError(
            f"step: must be from 0 to {len(result.steps) - 1} (got {step}); the run has no other"
        )
    shown = result.steps if step is None else result.steps[: step + 1]
    hypotheses = result.hypotheses if step is None else _before(result, step)
    drawn = hypotheses[:MOST_DRAWN]
    corners = [placed(one.world_from_model, one.model.vertices) for one in drawn]
    border = _border(result)
    contacts = result.contacts[: len(result.contacts) - _num_hits(result.steps) + _num_hits(shown)]
    spike = spike_for([*corners, border], contacts) / 2
    ends = [point for one in shown for point in (one.start, one.end)]
    low, high = frame_of(np.vstack([*corners, border, *ends, *evidence_points(contacts, [], spike=spike)]))
    with mpl.rc_context(RC):
        figure = new_figure(shape_of(low, high))
        axes = figure.add_subplot()
        _draw_border(axes, border)
        colors = _draw_hypotheses(axes, drawn)
        for number, one in enumerate(shown):
            _draw_step(axes, one, faint=step is not None and number < step)
        for number, contact in enumerate(contacts, start=1):
            draw_contact(axes, contact, number=number, spike=spike)
        axes.set_title(_title(result, step, len(hypotheses)))
        _add_legend(figure, drawn, colors, names=part_names)
        set_frame(axes, low, high, unit=unit)
    return figure


def _before(result: Result, step: int) -> list[Hypothesis]:
    """What was left when the step was planned."""
    known = [one.hypotheses for one in result.steps[:step] if one.hypotheses is not None]
    return known[-1] if known else []


def _num_hits(steps: Sequence[Step]) -> int:
    return sum(isinstance(one.reply, Hit) for one in steps)


def _border(result: Result) -> Array:
    """Corners of the workspace: its border is what was known to be free first."""
    ends = np.array([miss.start for miss in result.misses[:4]])
    return np.array([ends.min(axis=0), ends.max(axis=0)])


def _draw_border(axes: Axes, border: Array) -> None:
    width, height = border[1] - border[0]
    axes.add_patch(Rectangle(tuple(border[0]), width, height, fill=False, ec=FAINT, lw=0.8, zorder=1))


def _draw_hypotheses(axes: Axes, drawn: Sequence[Hypothesis]) -> dict[int, int]:
    """A colour for each model, in order of its first hypothesis."""
    colors: dict[int, int] = {}
    for one in drawn:
        color, dash = part_style(colors.setdefault(one.model_number, len(colors)))
        fill = 0.14 / max(1.0, len(drawn) / 4)
        draw_model(axes, one.model, one.world_from_model, color=color, dash=dash, fill=fill, width=1.1)
    return colors


def _draw_step(axes: Axes, step: Step, *, faint: bool) -> None:
    """Planned dashed, travelled solid, the free move before it dotted."""
    color = FAINT if faint or step.path is None else SENSED
    alpha = 0.5 if faint else 1.0
    axes.plot(*np.array([step.start, step.end]).T, color=color, alpha=alpha, lw=1.0, ls=(0, (5, 3)), zorder=6)
    stopped = _stopped(step)
    if stopped is not None:
        axes.plot(*np.array([step.start, stopped]).T, color=color, alpha=alpha, lw=1.6, zorder=7)
    if len(step.route) > 1:
        axes.plot(*np.array(step.route).T, color=FAINT, alpha=0.5 * alpha, lw=0.9, ls=(0, (1, 2)), zorder=1)
    axes.plot(*step.start, marker="o", ms=3.5, color=color, alpha=alpha, zorder=8)
    if isinstance(step.reply, Skid):
        axes.plot(*step.reply.free.end, marker="x", ms=6, color=color, alpha=alpha, zorder=8)


def _stopped(step: Step) -> Array | None:
    """Where the tip stopped; None if it did not go."""
    if isinstance(step.reply, Hit):
        return step.reply.contact.center
    if isinstance(step.reply, Skid):
        return step.reply.free.end
    return step.end if isinstance(step.reply, Miss) else None


def _title(result: Result, step: int | None, count: int) -> str:
    drawn = f", the first {MOST_DRAWN} drawn" if count > MOST_DRAWN else ""
    many = f"{count} hypothes{'is' if count == 1 else 'es'}{drawn}"
    if step is None:
        return f"{result.status.replace('_', ' ')} after {result.touches} guarded moves: {many}"
    purpose = {"scan": "scan", "path": "path", "verify": "one more touch"}[result.steps[step].purpose]
    return f"guarded move {step + 1}, {purpose}" + (f": {many} before it" if count else "")


def _add_legend(
    figure: Figure, drawn: Sequence[Hypothesis], colors: dict[int, int], *, names: Sequence[str] | None
) -> None:
    handles: list[Line2D] = []
    for number, index in colors.items():
        color, dash = part_style(index)
        own = next(one.model.name for one in drawn if one.model_number == number)
        label = own if names is None else names[number]
        handles.append(Line2D([], [], color=color, ls=dash, lw=2.0, label=label))
    handles.append(Line2D([], [], color=SENSED, ls=(0, (5, 3)), lw=1.0, label="planned"))
    handles.append(Line2D([], [], color=SENSED, lw=1.6, label="travelled"))
    figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)))
