"""The three pictures: models, recognition, range of poses."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from palpate._core import Contact, Hypothesis, Miss, Model, Recognition
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
from palpate.plots.solids import in_sight, to_viewer
from palpate.plots.style import (
    CONFLICT,
    RC,
    SENSED,
    at_most,
    frame_of,
    new_figure,
    part_style,
    shape_of,
    thinned,
    words,
)
from palpate.solids.faces import face_places

TRUE_DASH = (0, (4, 3))
MOST_DRAWN = 25  # hypotheses in one picture; more can't be told apart
MOST_NUMBERED = 60  # faces of a model that fills its frame that get a number
LEAST_TURNED = 0.2  # towards the viewer, as the cosine of the angle: a face in space that gets a number
SMALLEST_SEEN = 0.004  # of the frame: less than the width of a line


def plot_recognition(
    found: Recognition,
    contacts: Sequence[Contact],
    *,
    misses: Sequence[Miss] = (),
    unit: str = "mm",
    title: str | None = None,
    part_names: Sequence[str] | None = None,
) -> Figure:
    """All hypotheses superposed, each part in its colour, with the contacts and misses they explain.

    Beyond 25 hypotheses the first 25 are drawn, and the title says so. `part_names` says what to call the
    models, in their order; else they have their own names, with their numbers, counted from 1, where several
    have the same.
    """
    drawn = list(found.hypotheses[:MOST_DRAWN])
    parts = list(dict.fromkeys(hypothesis.model_number for hypothesis in found.hypotheses))
    corners = [placed(h.world_from_model, h.model.vertices) for h in drawn]
    spike = spike_for(corners, contacts)
    low, high = frame_of(np.vstack([*corners, *evidence_points(contacts, misses, spike=spike)]))
    with mpl.rc_context(RC):
        figure = new_figure(shape_of(low, high))
        axes = add_axes(figure, len(low))
        fill = 0.16 / max(1.0, len(drawn) / 4)
        numbers_at = number_places(corners, [np.asarray(contact.center) for contact in contacts])
        for number, hypothesis in enumerate(drawn, start=1):
            color, dash = part_style(parts.index(hypothesis.model_number))
            pose = hypothesis.world_from_model
            draw_model(axes, hypothesis.model, pose, color=color, dash=dash, fill=fill, width=1.3)
            place = numbers_at[number - 1]
            axes.text(*place, str(number), color=color, ha="center", va="center", path_effects=HALO, zorder=6)
        conflict = found.conflict or []
        for index, contact in enumerate(contacts):
            color = CONFLICT if index in conflict else SENSED
            draw_contact(axes, contact, number=index + 1, spike=spike, color=color)
        for miss in misses:
            draw_miss(axes, miss)
        axes.set_title(title if title is not None else _recognition_title(found))
        _add_part_legend(figure, found, part_names)
        fit(axes, low, high, unit=unit)
    return figure


def plot_pose_range(
    hypothesis: Hypothesis,
    contacts: Sequence[Contact] = (),
    *,
    misses: Sequence[Miss] = (),
    unit: str = "mm",
    num_samples: int = 60,
    seed: int = 0,
    world_from_truth: ArrayLike | None = None,
) -> Figure:
    """The range of poses of one hypothesis, as in figure 2.4 of the thesis.

    Faint: sampled poses, each of them valid. Bold: the pose of largest slack. Shaded, in the plane: where
    each vertex may be. Dashed, where it is known: the part at its true pose.
    """
    model, poses = hypothesis.model, hypothesis.poses
    in_plane = model.dimension == 2
    samples = poses.sample(num_samples, seed=seed)
    ranges = [np.asarray(poses.outline(vertex)) for vertex in model.vertices] if in_plane else []
    corners = [placed(pose, model.vertices) for pose in [*samples, hypothesis.world_from_model]]
    spike = spike_for(corners[-1:], contacts)
    low, high = frame_of(np.vstack([*corners, *ranges, *evidence_points(contacts, misses, spike=spike)]))
    color, _ = part_style(0)
    with mpl.rc_context(RC):
        figure = new_figure(shape_of(low, high))
        axes = add_axes(figure, len(low))
        for region in ranges:
            axes.add_patch(
                Polygon(region, facecolor="#E69F00", edgecolor="#B87C00", alpha=0.3, lw=0.7, zorder=1)
            )
        for pose in samples:
            draw_model(axes, model, pose, color=color, alpha=0.22, width=0.6, zorder=2)
        draw_model(axes, model, hypothesis.world_from_model, color=color, fill=0.08, width=2.0, zorder=3)
        truth: list[Line2D] = []
        if world_from_truth is not None:
            pose = np.asarray(world_from_truth, dtype=float)
            draw_model(axes, model, pose, color=SENSED, dash=TRUE_DASH, width=1.2, zorder=4)
            truth = [Line2D([], [], color=SENSED, ls=TRUE_DASH, lw=1.2, label="the truth")]
        for index, contact in enumerate(contacts):
            draw_contact(axes, contact, number=index + 1, spike=spike)
        for miss in misses:
            draw_miss(axes, miss)
        shift = max(poses.excursion(vertex) for vertex in model.vertices)
        turn = math.degrees(poses.rotation_bound)
        turns, moves = (
            f"turns by at most {at_most(turn)}°",
            f"vertices move by at most {at_most(shift)} {unit}",
        )
        axes.set_title(f"{model.name}: {turns}, {moves}")
        best = "pose of largest slack"
        if shift < SMALLEST_SEEN * float((high - low).max()):
            handles = [Line2D([], [], color=color, lw=2.0, label=f"{best}; the others lie under its lines")]
        else:
            handles = [
                Line2D([], [], color=color, lw=2.0, label=best),
                Line2D([], [], color=color, lw=0.8, alpha=0.5, label=f"{len(samples)} sampled poses"),
            ]
            if ranges:
                shaded = {"marker": "s", "ls": "", "color": "#E69F00", "alpha": 0.5}
                handles.append(Line2D([], [], **shaded, label="where each vertex may be"))
        figure.legend(handles=[*handles, *truth], loc="outside lower center", ncols=3 + len(truth))
        fit(axes, low, high, unit=unit)
    return figure


def plot_models(
    models: Sequence[Model], *, contacts: Sequence[Sequence[Contact]] | None = None, unit: str = "mm"
) -> Figure:
    """Each model in its frame: faces and their numbers, outward normals, vertices; what can't be touched.

    `contacts`, a list for each model in its frame, are drawn in place of normals and numbers (figure 4.1).
    """
    if not models:
        raise ValueError("models: nothing to draw (got none); give at least one model")
    if contacts is not None and len(contacts) != len(models):
        raise ValueError(
            f"contacts: must have a list for each of {len(models)} models (got {len(contacts)}); "
            "give empty ones too"
        )
    num_columns = math.ceil(math.sqrt(len(models)))
    num_rows = math.ceil(len(models) / num_columns)
    with mpl.rc_context(RC):
        frames = _frames_of(models)
        cell = 6.5 if len(models) == 1 else 4.2
        # Space is drawn in a square, with the numbers of z at the right.
        in_space = any(model.dimension == 3 for model in models)
        sizes = [np.ones(2) if len(low) == 3 else high - low for low, high in frames]
        aspect = max(float(height / width) for width, height in sizes)
        width = cell + (0.8 if in_space else 0.0)
        # The axes of a cell leave 0.6 inches for numbers at the left, 0.8 for the title and numbers below.
        figure = new_figure((width * num_columns, ((cell - 0.6) * min(1.5, aspect) + 0.8) * num_rows))
        for index, model in enumerate(models):
            axes = add_axes(figure, model.dimension, num_rows, num_columns, index + 1)
            low, high = frames[index]
            if contacts is None:
                share = model.size / float((high - low).max())
                _draw_labelled(axes, model, color=part_style(index)[0], most=math.ceil(share * MOST_NUMBERED))
            else:
                _draw_touched(
                    axes, model, contacts[index], color=part_style(index)[0], spike=0.1 * (high - low).max()
                )
            fit(axes, *frames[index], unit=unit)
    return figure


def _frames_of(models: Sequence[Model]) -> list[tuple[Array, Array]]:
    """A frame for each model; all of one size, so that parts compare, unless one part would then be tiny."""
    own = [
        frame_of(np.vstack([np.vstack(model.faces) + 0.04 * model.size * d for d in (-1, 1)]))
        for model in models
    ]
    if len({model.dimension for model in models}) > 1:
        return own
    sizes = np.array([high - low for low, high in own])
    if sizes.max() > 5.0 * sizes.max(axis=1).min():
        return own
    half = sizes.max(axis=0) / 2
    middles = [(low + high) / 2 for low, high in own]
    return [(middle - half, middle + half) for middle in middles]


def _draw_labelled(axes: Axes, model: Model, *, color: str, most: int) -> None:
    draw_model(axes, model, np.eye(model.dimension + 1), color=color, fill=0.12, width=1.5)
    tick = 0.035 * model.size
    in_space = model.dimension == 3
    given = [k for k, surface in enumerate(model.face_surfaces) if surface != "seam"]
    numbered, step = thinned(given, most // 2 if in_space else most)
    middles = face_places(model) if in_space else np.array([face.mean(axis=0) for face in model.faces])
    if in_space:
        # Numbers of what is turned away or hidden would stand among those of the faces before it.
        turned = model.face_normals[numbered] @ to_viewer() > LEAST_TURNED
        numbered = [
            k for k, seen in zip(numbered, turned & in_sight(model, middles[numbered]), strict=True) if seen
        ]
    places = middles[numbered] if in_space else _face_number_places(model, numbered, tick=tick)
    for index, place in zip(numbered, places, strict=True):
        middle = middles[index]
        axes.plot(*np.array([middle, middle + tick * model.face_normals[index]]).T, color=color, lw=0.9)
        axes.text(
            *place, str(index), ha="center", va="center", fontsize=7, color="#333333", path_effects=HALO
        )
    touchable = np.asarray(model.touchable_vertices, dtype=bool)
    many = in_space and len(touchable) > MOST_NUMBERED
    for chosen, fill in () if many else ((touchable, color), (~touchable, "white")):
        axes.plot(
            *model.vertices[chosen].T, ls="", marker="o", ms=3.2, mfc=fill, mec=color, mew=0.9, zorder=5
        )
    turns = len(model.symmetries)
    also = f", {turns} symmetries" if turns > 1 else ""
    thin = f", every {step}{'nd' if step == 2 else 'th'} numbered" if step > 1 else ""
    axes.set_title(f"{model.name}: {len(model.faces)} faces{also}{thin}")


def _draw_touched(axes: Axes, model: Model, contacts: Sequence[Contact], *, color: str, spike: float) -> None:
    draw_model(axes, model, np.eye(model.dimension + 1), color=color, fill=0.12, width=1.5)
    for number, contact in enumerate(contacts, start=1):
        draw_contact(axes, contact, number=number, spike=spike)
    axes.set_title(f"{model.name}: {len(model.faces)} faces")


def _face_number_places(model: Model, numbered: Sequence[int], *, tick: float) -> list[Array]:
    """Where each face gets its number: inside the part or beyond its normal, where there is room."""
    starts, ends = (np.array([face[end] for face in model.faces]) for end in (0, 1))
    places: list[Array] = []
    for index in numbered:
        # Inside at the middle; inside nearer to an end, where a narrow part has another number at the middle;
        # beyond the normal.
        candidates = [
            starts[index]
            + share * (ends[index] - starts[index])
            + distance * tick * model.face_normals[index]
            for distance, share in ((-1.0, 0.5), (-1.0, 0.3), (-1.0, 0.7), (1.8, 0.5), (1.8, 0.3), (1.8, 0.7))
        ]
        rooms: list[float] = []
        for place in candidates:
            to_faces = _distances(place, starts, ends)
            to_faces[index] = np.inf
            to_places = [1.5 * tick, *(0.6 * math.dist(place, other) for other in places)]
            rooms.append(min(float(to_faces.min()), *to_places))
        # The first candidate that has all the room a number needs, else the one that has most.
        enough = [place for place, room in zip(candidates, rooms, strict=True) if room >= 0.8 * tick]
        places.append(enough[0] if enough else candidates[int(np.argmax(rooms))])
    return places


def _distances(point: Array, starts: Array, ends: Array) -> Array:
    """Distance of `point` from each of the segments `starts[k]` to `ends[k]`."""
    along = ends - starts
    share = np.sum((point - starts) * along, axis=1) / np.sum(along * along, axis=1)
    nearest = starts + np.clip(share, 0.0, 1.0)[:, None] * along
    return np.hypot(*(point - nearest).T)


def spike_for(corners: Sequence[Array], contacts: Sequence[Contact]) -> float:
    """How long normals are drawn: a twelfth of the picture."""
    points = np.vstack([*corners, *([c.center] for c in contacts)])
    return max(
        float(np.ptp(points, axis=0).max()) / 12,
        max((2.5 * c.tip_radius for c in contacts), default=0.0),
        1e-9,
    )


def number_places(corners: Sequence[Array], centers: Sequence[Array]) -> list[Array]:
    """Where each hypothesis gets its number: just inside a corner, far from contacts and other numbers."""
    if not corners:
        return []
    everything = np.vstack(corners)
    middle = np.mean(centers, axis=0) if centers else everything.mean(axis=0)
    room = 0.15 * float(np.ptp(everything, axis=0).max())
    places: list[Array] = []
    for points in corners:
        inside = points + 0.08 * (points.mean(axis=0) - points)
        worth = np.linalg.norm(inside - middle, axis=1)
        for place in places:
            # A number on top of another can't be read; beyond `room` the distance no longer matters.
            worth -= 4.0 * np.maximum(0.0, room - np.linalg.norm(inside - place, axis=1))
        places.append(inside[np.argmax(worth)])
    return places


def _recognition_title(found: Recognition) -> str:
    count = len(found.hypotheses)
    if not count:
        if not found.complete:
            return "the search was cut short: no hypothesis so far"
        if not found.conflict:
            return "no model explains the contacts"
        return f"no model explains the contacts: {words([k + 1 for k in found.conflict])} can't hold together"
    more = "" if found.complete else "more than "
    title = f"{more}{count} hypothes{'is' if count == 1 else 'es'}"
    return title if count <= MOST_DRAWN else f"{title}, the first {MOST_DRAWN} drawn"


def _add_part_legend(figure: Figure, found: Recognition, part_names: Sequence[str] | None) -> None:
    names = {hypothesis.model_number: hypothesis.model.name for hypothesis in found.hypotheses}
    handles: list[Line2D] = []
    for index, (part, name) in enumerate(names.items()):
        if part_names is not None:
            name = part_names[part]
        elif list(names.values()).count(name) > 1:
            name = f"{name} (model {part + 1})"
        numbers = [n for n, h in enumerate(found.hypotheses, start=1) if h.model_number == part]
        which = ", ".join(map(str, numbers)) if len(numbers) <= 6 else f"{len(numbers)} hypotheses"
        color, dash = part_style(index)
        handles.append(Line2D([], [], color=color, ls=dash, lw=2.0, label=f"{name} ({which})"))
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=min(3, len(handles)))
