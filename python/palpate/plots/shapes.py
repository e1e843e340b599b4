"""Parts, contacts and misses as matplotlib shapes; those of space are drawn by `solids.py`."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch, Wedge
from matplotlib.path import Path as Outline
from numpy.typing import NDArray

from palpate._core import Contact, Miss, Model
from palpate.plots import solids
from palpate.plots.style import FAINT, SENSED, set_frame

HALO = [patheffects.withStroke(linewidth=2.5, foreground="white")]

Array = NDArray[np.float64]


def add_axes(figure: Figure, dimension: int, *place: int) -> Any:
    """Axes for the plane or for space."""
    return figure.add_subplot(*place) if dimension == 2 else solids.add_space(figure, *place)


def fit(axes: Any, low: Array, high: Array, *, unit: str) -> None:
    """Equal axes over the frame, with the unit on all of them."""
    (set_frame if len(low) == 2 else solids.set_space)(axes, low, high, unit=unit)


def placed(world_from_model: Array, points_model: Array) -> Array:
    """`points_world`, shape `(n, d)`."""
    return points_model @ world_from_model[:-1, :-1].T + world_from_model[:-1, -1]


def outline_of(model: Model) -> Outline:
    """The faces in order as one path; a face that doesn't begin where the last one ended begins a new run."""
    corners: list[Array] = []
    codes: list[int] = []
    for face in model.faces:
        if not corners or not np.array_equal(face[0], corners[-1]):
            corners.append(face[0])
            codes.append(Outline.MOVETO)
        corners.append(face[1])
        codes.append(Outline.LINETO)
    return Outline(np.array(corners), codes)


def draw_model(axes: Axes, model: Model, world_from_model: Array, **look: Any) -> None:
    """The part at a pose: filled if it is closed, faces that can't be touched dashed, seams dotted.

    `look`: color, dash, width, alpha (of the lines), fill (alpha of the inside), zorder.
    """
    if model.dimension == 3:
        solids.draw_solid(axes, model, world_from_model, **look)
        return
    color, zorder, alpha = look["color"], look.get("zorder", 2.0), look.get("alpha", 1.0)
    if model.closed and look.get("fill", 0.0) > 0.0:
        outline = outline_of(model)
        inside = Outline(placed(world_from_model, np.asarray(outline.vertices)), outline.codes)
        axes.add_patch(
            PathPatch(inside, facecolor=color, edgecolor="none", alpha=look["fill"], zorder=zorder)
        )
    faces = np.array([placed(world_from_model, face) for face in model.faces])
    surfaces = np.array(model.face_surfaces)
    looks: dict[str, tuple[Any, float]] = {
        "touchable": (look.get("dash", "solid"), 1.0),
        "untouchable": ((0, (3, 2)), 0.8),
        "seam": ((0, (1, 3)), 0.5),
    }
    for surface, (dash, thin) in looks.items():
        chosen = faces[surfaces == surface]
        if len(chosen):
            width = thin * look.get("width", 1.2)
            axes.add_collection(
                LineCollection(
                    list(chosen),
                    colors=color,
                    linestyles=[dash],
                    linewidths=width,
                    alpha=alpha,
                    capstyle="round",
                    zorder=zorder,
                ),
                autolim=False,
            )


def draw_contact(
    axes: Axes, contact: Contact, *, number: int, spike: float, color: str = SENSED, swept: bool = True
) -> None:
    """A contact: tip and position error to scale; normal, its cone and the approach `spike` long.

    `swept`: whether its free way is drawn too.
    """
    center = np.asarray(contact.center)
    if len(center) == 3:
        away = solids.draw_touch(axes, contact, spike=spike, color=color, swept=swept)
    else:
        away = _draw_touch(axes, contact, spike=spike, color=color, swept=swept)
    # The number stands beyond the spike, or up and to the right of a bare contact.
    beyond = center + (1.25 * spike * away if away is not None else 0.3 * spike * np.ones(len(center)))
    axes.text(
        *beyond,
        str(number),
        color=color,
        ha="center",
        va="center",
        fontweight="bold",
        path_effects=HALO,
        zorder=11,
    )


def _draw_touch(axes: Axes, contact: Contact, *, spike: float, color: str, swept: bool) -> Array | None:
    """The same in the plane without its number; returns the way to where that belongs, if there is one."""
    center = np.asarray(contact.center)
    axes.add_patch(Circle(tuple(center), contact.position_error, facecolor=color, alpha=0.22, lw=0, zorder=8))
    if contact.tip_radius > 0.0:
        axes.add_patch(Circle(tuple(center), contact.tip_radius, fill=False, ec=color, lw=0.9, zorder=9))
    away = None
    if contact.normal is not None and contact.normal_error is not None:
        away = np.asarray(contact.normal)
        middle, half = np.degrees(np.arctan2(away[1], away[0])), np.degrees(contact.normal_error)
        cone = Wedge(
            tuple(center), spike, middle - half, middle + half, facecolor=color, alpha=0.2, lw=0, zorder=8
        )
        axes.add_patch(cone)
        axes.plot(
            *np.array([center, center + spike * away]).T, color=color, lw=1.3, zorder=9, solid_capstyle="butt"
        )
    if contact.approach is not None and away is None:
        _draw_approach(axes, center, np.asarray(contact.approach), spike=spike, color=color)
        away = -np.asarray(contact.approach)
    if swept and contact.start is not None:
        axes.plot(*np.array([contact.start, center]).T, color=FAINT, lw=0.9, ls=(0, (1, 2)), zorder=7)
    axes.plot(*center, marker="o", ms=3.6, color=color, zorder=10)
    return away


def _draw_approach(axes: Axes, center: Array, approach: Array, *, spike: float, color: str) -> None:
    axes.annotate(
        "",
        xy=tuple(center),
        xytext=tuple(center - spike * approach),
        arrowprops={"arrowstyle": "-|>", "color": color, "lw": 1.0, "shrinkA": 0, "shrinkB": 2},
        zorder=9,
    )


def draw_miss(axes: Axes, miss: Miss) -> None:
    """A guarded move that touched nothing: a dashed line, with the tip to scale at its end."""
    if len(miss.start) == 3:
        solids.draw_free(axes, miss)
        return
    swept = np.array([miss.start, miss.end])
    axes.plot(*swept.T, color=FAINT, lw=1.3, ls=(0, (4, 3)), zorder=7)
    axes.plot(*swept[1], marker="x", ms=5, color=FAINT, zorder=7)
    if miss.tip_radius > 0.0:
        axes.add_patch(Circle(tuple(swept[1]), miss.tip_radius, fill=False, ec=FAINT, lw=0.9, zorder=7))


def evidence_points(contacts: Any, misses: Any, *, spike: float) -> list[Array]:
    """Points that a frame must hold so that the evidence is seen whole."""
    points: list[Array] = []
    for contact in contacts:
        center = np.asarray(contact.center)
        away = contact.normal
        if away is None and contact.approach is not None:
            away = -np.asarray(contact.approach)
        if away is not None:
            points.append(center + 1.3 * spike * np.asarray(away))
        reach = max(contact.tip_radius, contact.position_error)
        points += [center - reach, center + reach]
        if contact.start is not None:
            points.append(np.asarray(contact.start))
    for miss in misses:
        points += [np.asarray(miss.start), np.asarray(miss.end)]
    return points
