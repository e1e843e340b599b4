"""A path among superposed hypotheses, with what each of them would answer (figures 4.2 to 4.8)."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from palpate._core import Contact, Hypothesis, Miss, Model, Outcome, Path
from palpate.plots import solids
from palpate.plots.pictures import MOST_DRAWN, number_places, spike_for
from palpate.plots.shapes import (
    HALO,
    Array,
    add_axes,
    draw_contact,
    draw_miss,
    draw_model,
    evidence_points,
    fit,
    placed,
)
from palpate.plots.style import RC, SENSED, frame_of, new_figure, part_style, shape_of

LANES = 0.22  # of the frame, at most, for all predictions beside the path
LANE = 0.022  # for one of them


def plot_path(
    hypotheses: Sequence[Hypothesis],
    path: Path | None,
    contacts: Sequence[Contact] = (),
    *,
    misses: Sequence[Miss] = (),
    unit: str = "mm",
    part_names: Sequence[str] | None = None,
    tip_radius: float = 0.0,
) -> Figure:
    """Hypotheses superposed, with a path among them and where it may touch each.

    Beside the path each hypothesis that it may touch has a bar: the ways after which the tip may touch it.
    Faces that may be touched are bold, at the pose of largest slack. The legend says what each may answer.
    Beyond 25 hypotheses the first 25 are drawn, and the title says so.

    Args:
        hypotheses: Those among which the path was planned.
        path: The path; None draws the hypotheses alone.
        contacts: What was touched so far.
        misses: What was missed so far.
        unit: Of the models, for the axes.
        part_names: What to call the models, in their order; else they have their own names.
        tip_radius: Of the next reading; the tip is drawn where the path starts.
    """
    if not hypotheses:
        raise ValueError("hypotheses: must not be empty (got []); give found.hypotheses of a recognition")
    drawn = list(hypotheses[:MOST_DRAWN])
    corners = [placed(h.world_from_model, h.model.vertices) for h in drawn]
    spike = spike_for(corners, contacts)
    ends = [] if path is None else [path.start, path.end]
    low, high = frame_of(np.vstack([*corners, *ends, *evidence_points(contacts, misses, spike=spike)]))
    outcomes = {} if path is None else {outcome.hypothesis: outcome for outcome in path.outcomes}
    with mpl.rc_context(RC):
        figure = new_figure(shape_of(low, high))
        axes = add_axes(figure, len(low))
        fill = 0.14 / max(1.0, len(drawn) / 4)
        places = number_places(corners, [np.asarray(contact.center) for contact in contacts])
        for number, hypothesis in enumerate(drawn):
            color, dash = part_style(number)
            pose = hypothesis.world_from_model
            draw_model(axes, hypothesis.model, pose, color=color, dash=dash, fill=fill, width=1.1)
            _label(axes, places[number], number, color=color)
            if number in outcomes:
                _draw_touched(axes, hypothesis, outcomes[number], color=color)
        for index, contact in enumerate(contacts):
            draw_contact(axes, contact, number=index + 1, spike=spike)
        for miss in misses:
            draw_miss(axes, miss)
        if path is not None:
            _draw_path(axes, path, tip_radius=tip_radius)
            _draw_lanes(axes, path, num_drawn=len(drawn), extent=float((high - low).max()))
        axes.set_title(_title(path, len(hypotheses)))
        names = [
            hypothesis.model.name if part_names is None else part_names[hypothesis.model_number]
            for hypothesis in drawn
        ]
        _add_legend(figure, names, outcomes)
        fit(axes, low, high, unit=unit)
    return figure


def _label(axes: Axes, place: Array, number: int, *, color: str) -> None:
    axes.text(*place, str(number + 1), color=color, ha="center", va="center", path_effects=HALO, zorder=6)


def _draw_touched(axes: Axes, hypothesis: Hypothesis, outcome: Outcome, *, color: str) -> None:
    """The features that may be touched, bold."""
    for kind, index in (touch.feature for touch in outcome.touches):
        points = placed(hypothesis.world_from_model, _feature_points(hypothesis.model, kind, index))
        marker = "o" if kind == "vertex" else ""
        axes.plot(*points.T, color=color, lw=3.0, marker=marker, ms=6, alpha=0.85, zorder=4)


def _feature_points(model: Model, kind: str, index: int) -> Array:
    """Its corners, model frame: of a face in space all around it."""
    if kind == "vertex":
        return model.vertices[index : index + 1]
    if kind == "edge":
        return np.asarray(model.edges[index])
    return np.asarray(model.faces[index]) if model.dimension == 2 else solids.outline_in_space(model, index)


def _draw_path(axes: Axes, path: Path, *, tip_radius: float) -> None:
    if len(path.start) == 3:
        solids.draw_way(axes, path.start, path.end, color=SENSED)
        axes.plot(*path.start[:, None], marker="o", ms=4, color=SENSED, zorder=9)
        if tip_radius > 0.0:
            solids.draw_ball(axes, path.start, tip_radius, color=SENSED)
        return
    axes.annotate(
        "",
        xy=tuple(path.end),
        xytext=tuple(path.start),
        arrowprops={"arrowstyle": "-|>", "color": SENSED, "lw": 1.4, "shrinkA": 0, "shrinkB": 0},
        zorder=9,
    )
    axes.plot(*path.start, marker="o", ms=4, color=SENSED, zorder=9)
    if tip_radius > 0.0:
        axes.add_patch(Circle(tuple(path.start), tip_radius, fill=False, ec=SENSED, lw=0.9, zorder=9))


def _draw_lanes(axes: Axes, path: Path, *, num_drawn: int, extent: float) -> None:
    """Beside the path, one lane for each hypothesis: where along it the tip may touch."""
    touched = [o for o in path.outcomes if o.touches and o.hypothesis < num_drawn]
    lane = min(LANE, LANES / max(1, len(touched))) * extent
    left = _aside(path.direction)
    for place, outcome in enumerate(touched, start=1):
        color, _ = part_style(outcome.hypothesis)
        aside = path.start + place * lane * left
        for near, far in (touch.depth for touch in outcome.touches):
            ends = np.array([aside + near * path.direction, aside + far * path.direction])
            axes.plot(*ends.T, color=color, lw=4.0, alpha=0.8, solid_capstyle="butt", zorder=8)
            axes.plot(*ends.mean(axis=0)[:, None], color=color, marker="o", ms=4.5, zorder=8)
        last = max(touch.depth[1] for touch in outcome.touches)
        at = aside + (last + 0.02 * extent) * path.direction
        axes.text(
            *at,
            str(outcome.hypothesis + 1),
            color=color,
            ha="center",
            va="center",
            fontsize=7,
            fontweight="bold",
            path_effects=HALO,
            zorder=9,
            clip_on=True,
        )


def _aside(direction: Array) -> Array:
    """To the left, as the path is seen."""
    if len(direction) == 2:
        return np.array([-direction[1], direction[0]])
    across = np.cross(solids.to_viewer(), direction)
    length = float(np.linalg.norm(across))
    return across / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])


def _title(path: Path | None, count: int) -> str:
    drawn = f", the first {MOST_DRAWN} drawn" if count > MOST_DRAWN else ""
    many = f"{count} hypothes{'is' if count == 1 else 'es'}{drawn}"
    if path is None:
        return f"{many}: no path"
    if path.fault is not None:
        return f"{many}: the path can't be used ({path.fault[1]} at {path.fault[0] + 1})"
    sure = "guaranteed" if path.guaranteed else "only expected to tell"
    classes = f"{len(path.classes)} class{'' if len(path.classes) == 1 else 'es'}"
    return f"{many}: {classes}, score {path.score:.3g}, {sure}"


def _add_legend(figure: Figure, names: Sequence[str], outcomes: dict[int, Outcome]) -> None:
    handles: list[Line2D] = []
    for number, name in enumerate(names):
        color, dash = part_style(number)
        answer = f": {_answer(outcomes[number])}" if number in outcomes else ""
        handles.append(Line2D([], [], color=color, ls=dash, lw=2.0, label=f"{number + 1} {name}{answer}"))
    figure.legend(handles=handles, loc="outside lower center", ncols=2 if len(names) <= 8 else 3, fontsize=8)


def _answer(outcome: Outcome) -> str:
    """What a hypothesis may answer, in few words."""
    if outcome.fault is not None:
        return outcome.fault
    words = [f"{kind} {index}" for kind, index in (touch.feature for touch in outcome.touches[:3])]
    if len(outcome.touches) > 3:
        words.append("...")
    if outcome.may_miss:
        words.append("no contact")
    return " or ".join(words)
