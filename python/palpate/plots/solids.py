"""Solids, contacts and misses in space, on matplotlib's axes of three dimensions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

from palpate._core import Contact, Miss, Model
from palpate.curves import Array
from palpate.plots.style import FAINT, SENSED

# From where all is seen, degrees.
ELEVATION, AZIMUTH = 24.0, -58.0
_LIGHT = np.array([0.25, -0.5, 0.83])
# Faces of one curved surface meet at less: their edges are not drawn.
_SHARP_DEG = 20.0
_ROUND = np.linspace(0.0, 2.0 * math.pi, 33)


def add_space(figure: Figure, *place: int) -> Any:
    """Axes for space, seen from the front, the right and above, without perspective: lengths compare."""
    axes: Any = figure.add_subplot(*place, projection="3d", proj_type="ortho", computed_zorder=False)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    return axes


def to_viewer() -> Array:
    """The unit vector towards whoever looks at the picture."""
    elevation, azimuth = math.radians(ELEVATION), math.radians(AZIMUTH)
    across = math.cos(elevation)
    return np.array([across * math.cos(azimuth), across * math.sin(azimuth), math.sin(elevation)])


def set_space(axes: Any, low: Array, high: Array, *, unit: str) -> None:
    """Equal axes over the frame, with the unit on all."""
    # Beside others it is smaller than its place, and its title in it: the layout leaves no room for either.
    alone = axes.get_subplotspec().get_gridspec().get_geometry() == (1, 1)
    # matplotlib gives all boxes one diagonal; these have one longest side.
    share = float(np.linalg.norm(high - low) / (math.sqrt(3.0) * (high - low).max()))
    axes.set_box_aspect(high - low, zoom=share * (1.04 if alone else 0.94))
    if not alone:
        axes.set_title(axes.get_title(), y=0.96)
    for name, a, b in zip("xyz", low, high, strict=True):
        axis = getattr(axes, f"{name}axis")
        getattr(axes, f"set_{name}lim")(float(a), float(b))
        getattr(axes, f"set_{name}label")(f"{name} ({unit})")
        axis.set_pane_color((0.975, 0.975, 0.975, 1.0))
        # Ticks of a short axis would run into each other.
        axis.set_major_locator(MaxNLocator(nbins=max(2, round(6 * (b - a) / float(max(high - low))))))
        axis._axinfo["grid"].update(color="#E4E4E4", linewidth=0.6)


def sharp_edges(model: Model) -> Array:
    """Corners of edges that are seen, by number, shape `(k, 2)`: ends of surfaces, and where faces turn."""
    sides = np.sort(model.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    faces = np.repeat(model.triangle_faces, 3)
    edges, first, counts = np.unique(sides, axis=0, return_index=True, return_counts=True)
    last = len(sides) - 1 - np.unique(sides[::-1], axis=0, return_index=True)[1]
    cosines = np.sum(model.face_normals[faces[first]] * model.face_normals[faces[last]], axis=1)
    return edges[(counts == 1) | (cosines < math.cos(math.radians(_SHARP_DEG)))]


def in_sight(model: Model, points: Array) -> NDArray[np.bool_]:
    """Which points on the surface of the model, in its frame, no other face hides from the viewer."""
    way = to_viewer()
    a, b, c = (model.vertices[model.triangles[:, k]] for k in range(3))
    # The line of sight meets a triangle at a + u (b - a) + v (c - a), a way s off (Möller and Trumbore 1997).
    across = np.cross(way, c - a)
    scale = np.sum(across * (b - a), axis=1)
    from_a = points[:, None] - a
    turned = np.cross(from_a, b - a)
    # Triangles seen edge on hide nothing: what is divided by zero is in no range.
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = np.sum(across * from_a, axis=2) / scale, turned @ way / scale
        s = np.sum(turned * (c - a), axis=2) / scale
    hidden = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (s > 1e-6 * model.size)
    return np.asarray(~hidden.any(axis=1))


def draw_solid(axes: Any, model: Model, world_from_model: Array, **look: Any) -> None:
    """The part at a pose: faces translucent and shaded, edges as lines.

    Faces that can't be touched are fainter. `look`: as for `draw_model`.
    """
    zorder = look.get("zorder", 2.0)

    def placed(points: Array) -> Array:
        return points @ world_from_model[:3, :3].T + world_from_model[:3, 3]

    if look.get("fill", 0.0) > 0.0:
        faint = {"touchable": 1.0, "untouchable": 0.35, "seam": 0.0}
        alphas = look["fill"] * np.array([faint[surface] for surface in model.face_surfaces])
        lit = np.clip(model.face_normals @ world_from_model[:3, :3].T @ _LIGHT, 0.0, 1.0)
        shades = (0.6 + 0.4 * lit)[:, None] * np.array(mpl.colors.to_rgb(look["color"]))
        # Without smoothing, which would leave light lines between faces of a curved surface.
        axes.add_collection3d(
            Poly3DCollection(
                [placed(_outline(loops)) for loops in model.face_loops],
                facecolors=np.column_stack([shades, alphas]),
                edgecolors="none",
                antialiased=False,
                zorder=zorder,
            ),
            autolim=False,
        )
    axes.add_collection3d(
        Line3DCollection(
            placed(model.vertices)[sharp_edges(model)],
            colors=look["color"],
            linestyles=[look.get("dash", "solid")],
            linewidths=0.55 * look.get("width", 1.2),
            alpha=look.get("alpha", 1.0),
            capstyle="round",
            zorder=zorder,
        ),
        autolim=False,
    )


def draw_touch(axes: Any, contact: Contact, *, spike: float, color: str, swept: bool) -> Array | None:
    """A contact: tip to scale, its normal with the cone of its error, else the approach, `spike` long.

    Returns the way to where its number belongs, None if it has neither.
    """
    center = np.asarray(contact.center)
    if contact.tip_radius > 0.0:
        draw_ball(axes, center, contact.tip_radius, color=color)
    away = None
    if contact.normal is not None and contact.normal_error is not None:
        away = np.asarray(contact.normal)
        _draw_arrow(axes, center, spike * away, color=color)
        # No wider than a cone that still looks like one.
        width = spike * math.tan(min(contact.normal_error, math.radians(60.0)))
        rim = center + spike * away + width * _circle(away)
        cone = np.stack([np.broadcast_to(center, rim[1:].shape), rim[:-1], rim[1:]], axis=1)
        axes.add_collection3d(
            Poly3DCollection(cone, facecolors=color, edgecolors="none", alpha=0.15, zorder=8), autolim=False
        )
    elif contact.approach is not None:
        away = -np.asarray(contact.approach)
        _draw_arrow(axes, center + spike * away, -spike * away, color=color)
    if swept and contact.start is not None:
        axes.plot(*np.array([contact.start, center]).T, color=FAINT, lw=0.9, ls=(0, (1, 2)), zorder=7)
    axes.plot(*center[:, None], marker="o", ms=3.6, color=color, zorder=10)
    return away


def draw_free(axes: Any, miss: Miss) -> None:
    """A guarded move that touched nothing, with the tip to scale at its end."""
    swept = np.array([miss.start, miss.end])
    axes.plot(*swept.T, color=FAINT, lw=1.3, ls=(0, (4, 3)), zorder=7)
    axes.plot(*swept[1:].T, marker="x", ms=5, color=FAINT, zorder=7)
    if miss.tip_radius > 0.0:
        draw_ball(axes, swept[1], miss.tip_radius, color=FAINT)


def draw_way(axes: Any, start: Array, end: Array, *, color: str, alpha: float = 1.0) -> None:
    """A way of the tip, dashed, with an arrow at its end, shape `(3,)` each."""
    axes.plot(*np.array([start, end]).T, color=color, alpha=alpha, lw=1.2, ls=(0, (5, 3)), zorder=9)
    head = 0.06 * (end - start)
    axes.quiver(*(end - head), *head, color=color, alpha=alpha, lw=1.3, arrow_length_ratio=1.0, zorder=9)


def draw_box(axes: Any, corners: Array, *, color: str) -> None:
    """The edges of a box between two opposite corners, shape `(2, 3)`."""
    places = np.array(list(np.ndindex(2, 2, 2)))
    edges = [(a, b) for a in places for b in places if (b - a).sum() == 1 and (b >= a).all()]
    ends = np.take_along_axis(corners[None], np.array(edges), axis=1)
    axes.add_collection3d(Line3DCollection(ends, colors=color, linewidths=0.8, zorder=0), autolim=False)


def outline_in_space(model: Model, face: int) -> Array:
    """A face as one closed loop, model frame, shape `(n, 3)`."""
    return _outline(model.face_loops[face])


def _outline(loops: Sequence[Array]) -> Array:
    """A face as one loop: to each hole and back along a line, which has no area."""
    outer, *holes = (np.vstack([loop, loop[:1]]) for loop in loops)
    return np.vstack([outer, *(np.vstack([hole, outer[:1]]) for hole in holes)])


def _draw_arrow(axes: Any, start: Array, along: Array, *, color: str = SENSED) -> None:
    axes.quiver(*start, *along, color=color, lw=1.3, arrow_length_ratio=0.25, zorder=9)


def draw_ball(axes: Any, center: Array, radius: float, *, color: str) -> None:
    """A ball as its three great circles."""
    for axis in np.eye(3):
        axes.plot(*(center + radius * _circle(axis)).T, color=color, lw=0.6, zorder=9)


def _circle(axis: Array) -> Array:
    """A unit circle about an axis, closed, shape `(33, 3)`."""
    aside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    aside /= np.linalg.norm(aside)
    return np.cos(_ROUND)[:, None] * aside + np.sin(_ROUND)[:, None] * np.cross(axis, aside)
