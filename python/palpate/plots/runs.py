"""A run of the loop: a picture for each step, and one of the whole (figures 4.12 to 4.16)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from palpate._core import Hypothesis
from palpate.loop import Result, Step
from palpate.loop.result import PURPOSES, hypotheses_words
from palpate.plots import solids
from palpate.plots.pictures import MOST_DRAWN
from palpate.plots.shapes import Array, add_axes, draw_contact, draw_model, fit, placed
from palpate.plots.style import FAINT, RC, SENSED, new_figure, part_style, shape_of
from palpate.probe import Hit, Skid

PAPER = "#FAFAF7"
BORDER = "#C4C4C0"
EARLIER = "#6A6A6A"  # contacts of the steps before


def plot_run(
    result: Result, step: int | None = None, *, unit: str = "mm", part_names: Sequence[str] | None = None
) -> Figure:
    """A step of a run, or all of it: hypotheses, paths as planned dashed, as travelled solid, contacts.

    A part has the same colour at every step. The contact of the step has a ring.

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
    low, high = _frame(result, [step])
    with mpl.rc_context(RC):
        figure = new_figure(shape_of(low, high))
        axes = add_axes(figure, len(low))
        drawn = _draw(axes, result, step)
        axes.set_title(_title(result, step, _many(_left(result, step))))
        _add_legend(figure, drawn, names=part_names)
        _set_frame(axes, low, high, unit=unit)
    return figure


def plot_turning_point(
    result: Result, *, unit: str = "mm", part_names: Sequence[str] | None = None
) -> Figure:
    """A run in two pictures: the step before which most hypotheses were left, and what is left in the end.

    A run of no steps has the second alone. The arguments are those of `plot_run`.
    """
    counts = [len(_left(result, step)) for step in range(len(result.steps))]
    shown: list[int | None] = [counts.index(max(counts)), None] if counts else [None]
    low, high = _frame(result, shown)
    with mpl.rc_context(RC):
        width, height = shape_of(low, high)
        figure = new_figure((0.82 * width * len(shown), 0.82 * height))
        drawn: list[Hypothesis] = []
        for place, step in enumerate(shown, start=1):
            axes = add_axes(figure, len(low), 1, len(shown), place)
            drawn += _draw(axes, result, step)
            axes.set_title(_title(result, step, _many(_left(result, step))))
            _set_frame(axes, low, high, unit=unit)
        _add_legend(figure, drawn, names=part_names)
    return figure


def _frame(result: Result, steps: Sequence[int | None]) -> tuple[Array, Array]:
    """Around the workspace and all that is drawn of the steps."""
    points = [result.workspace]
    for step in steps:
        points += [placed(one.world_from_model, one.model.vertices) for one in _drawn(result, step)]
        points += [np.array([one.start, one.end]) for one in _shown(result, step)]
    low, high = np.vstack(points).min(axis=0), np.vstack(points).max(axis=0)
    margin = 0.015 * float((high - low).max())
    return low - margin, high + margin


def _draw(axes: Axes, result: Result, step: int | None) -> list[Hypothesis]:
    """A step, or the whole run; returns the hypotheses that were drawn."""
    border = result.workspace
    _draw_border(axes, border)
    drawn = _drawn(result, step)
    _draw_hypotheses(axes, drawn)
    shown = _shown(result, step)
    for number, one in enumerate(shown):
        _draw_step(axes, one, faint=step is not None and number < step)
    contacts = result.contacts[: len(result.contacts) - _num_hits(result.steps) + _num_hits(shown)]
    spike = float(np.ptp(border, axis=0).max()) / 24
    new = len(contacts) if step is None or isinstance(shown[-1].reply, Hit) else len(contacts) + 1
    for number, contact in enumerate(contacts, start=1):
        color = SENSED if step is None or number == new else EARLIER
        draw_contact(axes, contact, number=number, spike=spike, color=color, swept=False)
        if step is not None and number == new:
            axes.plot(*contact.center[:, None], marker="o", ms=11, mfc="none", mec=SENSED, mew=1.2, zorder=10)
    return drawn


def _shown(result: Result, step: int | None) -> list[Step]:
    return result.steps if step is None else result.steps[: step + 1]


def _left(result: Result, step: int | None) -> list[Hypothesis]:
    """What was left when the step was planned, or in the end."""
    return result.hypotheses if step is None else _before(result, step)


def _drawn(result: Result, step: int | None) -> list[Hypothesis]:
    return _left(result, step)[:MOST_DRAWN]


def _before(result: Result, step: int) -> list[Hypothesis]:
    """What was left when the step was planned."""
    known = [one.hypotheses for one in result.steps[:step] if one.hypotheses is not None]
    return known[-1] if known else []


def _num_hits(steps: Sequence[Step]) -> int:
    return sum(isinstance(one.reply, Hit) for one in steps)


def _draw_border(axes: Axes, border: Array) -> None:
    if border.shape[1] == 3:
        solids.draw_box(axes, border, color=BORDER)
        return
    width, height = border[1] - border[0]
    axes.add_patch(
        Rectangle(tuple(border[0]), width, height, facecolor=PAPER, edgecolor=BORDER, lw=0.9, zorder=0)
    )


def _draw_hypotheses(axes: Axes, drawn: Sequence[Hypothesis]) -> None:
    for one in drawn:
        color, dash = part_style(one.model_number)
        fill = 0.16 / max(1.0, len(drawn) / 4)
        draw_model(axes, one.model, one.world_from_model, color=color, dash=dash, fill=fill, width=1.2)


def _draw_step(axes: Axes, step: Step, *, faint: bool) -> None:
    """Planned dashed, travelled solid, the free move before it dotted."""
    color = FAINT if faint or step.path is None else SENSED
    alpha = 0.5 if faint else 1.0
    stopped = step.stopped
    if len(step.start) == 3 and not isinstance(step.reply, Hit):
        # Many go through all the box: those that met nothing must not hide the part, nor free moves either.
        if stopped is not None:
            axes.plot(*np.array([step.start, stopped]).T, color=color, alpha=0.3 * alpha, lw=0.8, zorder=1)
        return
    ahead = np.array([step.start if stopped is None else stopped, step.end])
    axes.plot(*ahead.T, color=color, alpha=alpha, lw=1.0, ls=(0, (5, 3)), zorder=6)
    if stopped is not None:
        axes.plot(*np.array([step.start, stopped]).T, color=color, alpha=alpha, lw=1.6, zorder=7)
    if len(step.route) > 1 and len(step.start) == 2:
        axes.plot(*np.array(step.route).T, color=FAINT, alpha=0.5 * alpha, lw=0.9, ls=(0, (1, 2)), zorder=1)
    axes.plot(*step.start[:, None], marker="o", ms=3.5, color=color, alpha=alpha, zorder=8)
    if isinstance(step.reply, Skid):
        axes.plot(*step.reply.free.end[:, None], marker="x", ms=6, color=color, alpha=alpha, zorder=8)


def _many(hypotheses: Sequence[Hypothesis]) -> str:
    count = len(hypotheses)
    drawn = f", the first {MOST_DRAWN} drawn" if count > MOST_DRAWN else ""
    return f"{hypotheses_words(count)}{drawn}" if count else ""


def _title(result: Result, step: int | None, many: str) -> str:
    if step is None:
        ended = f"{result.status.replace('_', ' ')} after {result.touches} guarded moves"
        return f"{ended}: {many or 'no hypothesis'}"
    purpose = PURPOSES[result.steps[step].purpose]
    return f"guarded move {step + 1}, {purpose}" + (f": {many} before it" if many else "")


def _set_frame(axes: Axes, low: Array, high: Array, *, unit: str) -> None:
    """The border of the workspace is frame enough."""
    fit(axes, low, high, unit=unit)
    if len(low) == 3:
        return
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)


def _add_legend(figure: Figure, drawn: Sequence[Hypothesis], *, names: Sequence[str] | None) -> None:
    handles: list[Line2D] = []
    for number, own in sorted({one.model_number: one.model.name for one in drawn}.items()):
        color, dash = part_style(number)
        label = own if names is None else names[number]
        handles.append(Line2D([], [], color=color, ls=dash, lw=2.0, label=label))
    handles.append(Line2D([], [], color=SENSED, ls=(0, (5, 3)), lw=1.0, label="planned"))
    handles.append(Line2D([], [], color=SENSED, lw=1.6, label="travelled"))
    rows = math.ceil(len(handles) / (8 if figure.get_figwidth() > 8.0 else 4))
    figure.legend(handles=handles, loc="outside lower center", ncols=math.ceil(len(handles) / rows))
