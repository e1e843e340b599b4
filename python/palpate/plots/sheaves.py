"""The projection space of a generator, beside the plane that it stands for (figures 3.1 and 3.5 to 3.7)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from palpate._core import Hypothesis, Overlap, ProjectionSpace, Sheaf
from palpate.plots.pictures import MOST_DRAWN, number_places
from palpate.plots.shapes import HALO, Array, draw_model, placed
from palpate.plots.style import CONFLICT, FAINT, RC, SENSED, frame_of, new_figure, part_style, set_frame

NUM_SLOPES = 601
ASIDE = 0.3  # of the generator's length: how far to either side of it projection space is drawn
MOST_LABELLED = 12  # sheaves
NUM_PLACES = 48  # where a label may stand, across and upward
SHAPE = np.array([1.0, 0.35])  # a label is wider than high: steps upward and across weigh as much
ROOM = 2.5  # steps around a label; more is of no use
CROWDED = 0.6  # so many of them are given for being in one region less


def plot_projection_space(
    hypotheses: Sequence[Hypothesis],
    space: ProjectionSpace,
    *,
    unit: str = "mm",
    part_names: Sequence[str] | None = None,
) -> Figure:
    """The hypotheses with the generator on the X axis, and beside them the lines through it as points.

    On the right a point is a line: across, where it crosses the generator's axis; upward, its slope. Filled
    are the inner sheaves of the generator and of the faces that the path is to pierce, dashed their outer
    bounds; thin are those of the other candidates. Dark is what all that are filled share. Dots are critical
    points, dashes at the left critical slopes. The bar is the overlap in whose middle the path lies. Without
    a path only the generator's sheaf is filled. Beyond 25 hypotheses the parts of the first 25 are drawn, and
    the title says so.

    Args:
        hypotheses: Those for which the space was made.
        space: What `palpate.projection_space` returns.
        unit: Of the models, for the axes.
        part_names: What to call the models, in their order; else they have their own names.

    Raises:
        ValueError: Fewer hypotheses than those for which the space was made.
    """
    last = max(sheaf.hypothesis for sheaf in space.sheaves)
    if len(hypotheses) <= last:
        raise ValueError(
            f"hypotheses: must be those of the projection space, which knows number {last} "
            f"(got {len(hypotheses)}); give the same to both"
        )
    names = [
        hypothesis.model.name if part_names is None else part_names[hypothesis.model_number]
        for hypothesis in hypotheses
    ]
    overlap = _path_overlap(space)
    pierced = [space.sheaves[number] for number in (overlap.sheaves if overlap else [0])]
    with mpl.rc_context(RC):
        figure = new_figure((11.0, 6.2))
        plane, lines = figure.subplots(1, 2, width_ratios=(1.0, 1.2))
        _draw_plane(plane, hypotheses, space, pierced=pierced, unit=unit)
        _draw_space(lines, space, pierced, unit=unit)
        if overlap is not None:
            _draw_path(lines, space, overlap)
        figure.suptitle(_title(space, names), fontsize=11)
        _add_legend(figure, names, shared=len(pierced) > 1, path=overlap is not None)
    return figure


def _path_overlap(space: ProjectionSpace) -> Overlap | None:
    """The overlap in whose middle the path lies."""
    position, slope = space.path_position, space.path_slope
    if position is None or slope is None:
        return None
    found = [(sum(overlap.positions) / 2, overlap) for overlap in space.overlaps(slope) if overlap.positions]
    return min(found, key=lambda one: abs(one[0] - position))[1]


def _title(space: ProjectionSpace, names: Sequence[str]) -> str:
    number, face = space.generator
    drawn = f", the first {MOST_DRAWN} of {len(names)} parts drawn" if len(names) > MOST_DRAWN else ""
    head = f"projection space of face {face} of {number + 1} {names[number]}{drawn}"
    if space.path is None or space.path_slope is None:
        return f"{head}: no path"
    incidence = math.degrees(math.atan(space.path_slope))
    at = f"α = {space.path_slope:.3f} ({incidence:.1f}°)".replace("-", "−")
    return f"{head}: path at {at}, score {space.path.score:.3g} of {len(names)}"


# --- the plane ------------------------------------------------------------------------------------


def _nominal_pose(hypothesis: Hypothesis) -> Array:
    """Where the thesis places it."""
    thesis = hypothesis.poses.thesis_pose
    return hypothesis.poses.witness if thesis is None else thesis.world_from_model


def _draw_plane(
    axes: Axes, hypotheses: Sequence[Hypothesis], space: ProjectionSpace, *, pierced: list[Sheaf], unit: str
) -> None:
    drawn = list(hypotheses[:MOST_DRAWN])
    generator_from_world = np.linalg.inv(space.world_from_generator).astype(np.float64)
    poses = [generator_from_world @ _nominal_pose(hypothesis) for hypothesis in drawn]
    corners = [placed(pose, h.model.vertices) for pose, h in zip(poses, drawn, strict=True)]
    shown = [*corners, *(sheaf.ends for sheaf in pierced)]
    ends = None
    if space.path is not None:
        ends = placed(generator_from_world, np.array([space.path.start, space.path.end]))
        shown.append(ends)
    low, high = frame_of(np.vstack(shown))
    places = number_places(corners, [])
    axes.axhline(0.0, color=FAINT, lw=0.7, ls=(0, (6, 3)), zorder=1)
    for number, hypothesis in enumerate(drawn):
        color, dash = part_style(number)
        fill = 0.12 / max(1.0, len(drawn) / 4)
        draw_model(axes, hypothesis.model, poses[number], color=color, dash=dash, fill=fill, width=0.9)
        _write(axes, places[number], str(number + 1), color=color)
    for sheaf in pierced:
        color, _ = part_style(sheaf.hypothesis)
        axes.plot(*sheaf.ends.T, color=color, lw=3.4, solid_capstyle="butt", zorder=5)
        middle = sheaf.ends.mean(axis=0)
        _write(axes, middle, f"face {sheaf.face}", color=color, size=8)
    if ends is not None:
        arrow = {"arrowstyle": "-|>", "color": CONFLICT, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", xy=tuple(ends[1]), xytext=tuple(ends[0]), arrowprops=arrow, zorder=7)
        axes.plot(*ends[0], marker="o", ms=4, color=CONFLICT, zorder=7)
        # The tip stops at what it touches first; the line goes on through all that it pierces.
        depth = min(float(sheaf.ends[:, 1].min()) for sheaf in pierced)
        if depth < ends[1, 1]:
            along = (ends[1] - ends[0]) / (ends[0, 1] - ends[1, 1])
            beyond = np.array([ends[1], ends[1] + along * (ends[1, 1] - depth)])
            axes.plot(*beyond.T, color=CONFLICT, lw=0.8, ls=(0, (3, 2)), zorder=6)
    axes.set_title("the plane, generator on the X axis")
    set_frame(axes, low, high, unit=unit)


def _write(axes: Axes, place: Array, text: str, *, color: str, size: float = 9.0) -> None:
    axes.text(
        *place,
        text,
        color=color,
        fontsize=size,
        ha="center",
        va="center",
        path_effects=HALO,
        zorder=9,
        clip_on=True,
    )


# --- projection space -----------------------------------------------------------------------------


def _draw_space(axes: Axes, space: ProjectionSpace, pierced: list[Sheaf], *, unit: str) -> None:
    slopes = np.linspace(-space.max_slope, space.max_slope, NUM_SLOPES)
    positions = np.sort(space.sheaves[0].ends[:, 0])
    aside = ASIDE * float(np.ptp(positions))
    left, right = float(positions[0]) - aside, float(positions[1]) + aside
    regions = [_pierceable(sheaf, sheaf.inner(slopes), slopes) for sheaf in pierced]
    for sheaf in space.sheaves[1:]:
        if sheaf not in pierced:
            _draw_other(axes, sheaf, slopes)
    for sheaf, region in zip(pierced, regions, strict=True):
        width = 1.8 if sheaf is pierced[0] else 1.1
        _draw_sheaf(axes, sheaf, slopes, inner=region, width=width)
    if len(pierced) > 1:
        _draw_shared(axes, np.array(regions), slopes)
    axes.plot(*space.critical_points.T, ls="", marker="o", ms=2.6, color=SENSED, zorder=6)
    # As in figure 3.7: critical slopes are marked on the slope's own axis.
    marks = {"color": SENSED, "lw": 0.6, "transform": axes.get_yaxis_transform(), "zorder": 6}
    axes.hlines(space.critical_slopes, 0.0, 0.018, **marks)
    grid = np.linspace(left, right, NUM_PLACES)
    places = _label_places(regions[:MOST_LABELLED], slopes, grid)
    for place, sheaf in zip(places, pierced[:MOST_LABELLED], strict=True):
        color, _ = part_style(sheaf.hypothesis)
        if place is not None:
            _write(axes, place, f"{sheaf.hypothesis + 1}: face {sheaf.face}", color=color, size=8)
    axes.set_xlim(left, right)
    steepest = 1.04 * space.max_slope or 1.0
    axes.set_ylim(-steepest, steepest)
    _add_axes(axes, space, unit=unit)


def _label_places(regions: list[Array], slopes: Array, grid: Array) -> list[Array | None]:
    """A place in each region, in few others, far from its border and from other labels; None without room."""
    some = np.linspace(0, len(slopes) - 1, NUM_PLACES).astype(int)
    held = np.array([(grid >= region[some, :1]) & (grid <= region[some, 1:]) for region in regions])
    crowd = held.sum(axis=0)
    # What leaves the frame has its border there.
    held[:, [0, -1]] = held[:, :, [0, -1]] = False
    cells = np.argwhere(np.ones_like(crowd)) * SHAPE
    taken: list[Array] = []
    places: list[Array | None] = []
    for inside in held:
        if not inside.any():
            places.append(None)
            continue
        others = np.vstack([cells[~inside.ravel()], *taken])
        mine = np.argwhere(inside)
        rooms = np.array([np.hypot(*(others - cell * SHAPE).T).min() for cell in mine])
        row, column = mine[np.argmax(np.minimum(rooms, ROOM) - CROWDED * crowd[inside])]
        taken.append(np.array([row, column]) * SHAPE)
        places.append(np.array([grid[column], slopes[some[row]]]))
    return places


def _add_axes(axes: Axes, space: ProjectionSpace, *, unit: str) -> None:
    axes.set_title("projection space: each point is a line")
    axes.set_xlabel(f"position on the generator's axis ({unit})")
    axes.set_ylabel("slope α of the line")
    steepest = math.degrees(math.atan(space.max_slope))
    step = next(step for step in (1, 2, 5, 15) if steepest <= 5 * step or step == 15)
    degrees = np.arange(-90 + step, 90, step)
    degrees = degrees[np.abs(degrees) <= steepest + 1e-9]
    right = axes.secondary_yaxis("right")
    right.set_yticks(np.tan(np.radians(degrees)), [f"{degree}°".replace("-", "−") for degree in degrees])
    right.set_ylabel("angle to the generator's normal")
    axes.spines["top"].set_visible(False)


def _pierceable(sheaf: Sheaf, ranges: Array, slopes: Array) -> Array:
    """Nothing where lines would skid: there a face is not to be pierced."""
    return np.where(sheaf.skids(slopes)[:, None], np.nan, ranges)


def _outline(region: Array, slopes: Array) -> Array:
    """The closed outline of a region, shape `(n, 2)`."""
    known = ~np.isnan(region[:, 0])
    left, right = (np.column_stack([region[known, side], slopes[known]]) for side in (0, 1))
    return np.vstack([left, right[::-1], left[:1]])


def _draw_other(axes: Axes, sheaf: Sheaf, slopes: Array) -> None:
    color, dash = part_style(sheaf.hypothesis)
    outline = _outline(_pierceable(sheaf, sheaf.inner(slopes), slopes), slopes)
    axes.plot(*outline.T, color=color, ls=dash, lw=0.5, alpha=0.35, zorder=2)


def _draw_sheaf(axes: Axes, sheaf: Sheaf, slopes: Array, *, inner: Array, width: float) -> None:
    color, _ = part_style(sheaf.hypothesis)
    outer = _pierceable(sheaf, sheaf.outer(slopes), slopes)
    axes.fill_betweenx(slopes, *inner.T, color=color, alpha=0.09, lw=0, zorder=3)
    axes.plot(*_outline(inner, slopes).T, color=color, lw=width, zorder=4)
    axes.plot(*_outline(outer, slopes).T, color=color, lw=0.7, ls=(0, (4, 3)), zorder=4)


def _draw_shared(axes: Axes, regions: Array, slopes: Array) -> None:
    """The sheaf polygon: lines that pierce all of them."""
    shared = np.column_stack([regions[:, :, 0].max(axis=0), regions[:, :, 1].min(axis=0)])
    shared[shared[:, 0] > shared[:, 1]] = np.nan
    axes.fill_betweenx(slopes, *shared.T, color=SENSED, alpha=0.3, lw=0, zorder=5)
    axes.plot(*_outline(shared, slopes).T, color=SENSED, lw=1.3, zorder=5)


def _draw_path(axes: Axes, space: ProjectionSpace, overlap: Overlap) -> None:
    slope = space.path_slope
    bar = {"color": CONFLICT, "lw": 2.2, "solid_capstyle": "butt", "zorder": 7}
    axes.plot(overlap.positions, [slope, slope], **bar)
    axes.plot(space.path_position, slope, marker="+", ms=13, mew=2.0, color=CONFLICT, zorder=8)


# --- legend ---------------------------------------------------------------------------------------


def _add_legend(figure: Figure, names: Sequence[str], *, shared: bool, path: bool) -> None:
    handles: list[Line2D | Patch] = []
    for number, name in enumerate(names[:MOST_DRAWN]):
        color, dash = part_style(number)
        handles.append(Line2D([], [], color=color, ls=dash, lw=2.0, label=f"{number + 1} {name}"))
    handles += [
        Patch(fc="#E8E8E8", ec=FAINT, lw=1.4, label="inner sheaf of a pierced face"),
        Line2D([], [], color=FAINT, lw=0.9, ls=(0, (4, 3)), label="its outer bounds"),
        Line2D([], [], color=FAINT, lw=0.5, label="inner sheaf of another candidate"),
        Line2D([], [], color=SENSED, ls="", marker="o", ms=3, label="critical point"),
    ]
    if shared:
        handles.append(Patch(fc="#A8A8A8", ec=SENSED, lw=1.3, label="shared by all pierced"))
    if path:
        cross = {"color": CONFLICT, "lw": 2.2, "marker": "+", "ms": 9, "mew": 2.0}
        handles.append(Line2D([], [], **cross, label="overlap, and the path"))
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=8)
