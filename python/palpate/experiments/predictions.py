"""What two planners of space predict of themselves, beside what comes out (thesis 5.3 and 5.4.4).

`linearized` flattens faces. How much of what a line sees is wrong then the thesis bounds
(`palpate.linearization_error`, corrected). Measured is the area that a face and its flat substitute do not
share, by a library of polygons, and what the paths leave beside those of `optimized`, which flattens nothing.

`decoupled` takes faces for the rectangles around them. What share of lines through a rectangle hits the face
it predicts (`palpate.predicted_hit_rate`); measured is the share of random ones whose first contact it is.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from . import pages
from .campaign import Row
from .solids import Array

#: Lines that are drawn in a rectangle.
NUM_LINES = 200
#: Turns of the chart about the generator's normal, over a right angle.
NUM_TURNS = 12
#: Upper ends of the ranges of predicted errors, as shares of a face.
ERRORS = (0.02, 0.1, 0.3, math.inf)
ROUNDING = 1e-9


class Chart:
    """Coordinates about a face, its outward normal as Z; a line is `(x, y) + z (α, β)`."""

    def __init__(self, origin: Array, normal: Array, turn: float = 0.0) -> None:
        least = np.eye(3)[int(np.argmin(np.abs(normal)))]
        right = np.cross(normal, least)
        right /= np.linalg.norm(right)
        up = np.cross(normal, right)
        cosine, sine = math.cos(turn), math.sin(turn)
        self.origin, self.axes = (
            origin,
            np.array([cosine * right + sine * up, cosine * up - sine * right, normal]),
        )

    def points(self, world: Array) -> Array:
        """Of points `(k, 3)` of the world."""
        placed: Array = (world - self.origin) @ self.axes.T
        return placed

    def slopes(self, direction: Array) -> Array:
        """α and β of a direction of travel."""
        x, y, z = self.axes @ direction
        return np.array([x / z, y / z])

    def place(self, at: Array) -> Array:
        """A place of the plane of the face, world frame."""
        placed: Array = self.origin + at @ self.axes[:2]
        return placed


def seen(corners: Array, slopes: Array) -> Array:
    """Where corners of the chart are seen, `(k, 2)`."""
    return corners[:, :2] - corners[:, 2:] * slopes


class Face:
    """A face without holes that a path meets first, of one hypothesis at its nominal pose."""

    def __init__(self, hypothesis: Any, met: Any) -> None:
        self.model, self.pose, self.feature = hypothesis.model, hypothesis.world_from_model, met.feature
        outline = self.model.faces[met.feature[1]]
        self.corners = outline @ self.pose[:3, :3].T + self.pose[:3, 3]
        self.normal = met.normal


def faces_met(hypotheses: list[Any], path: Any) -> list[Face]:
    """What a point on the path meets, of each hypothesis that it meets on such a face."""
    found = []
    for one in hypotheses:
        met = one.model.first_contact(one.world_from_model, path.start, path.direction, 0.0)
        if met and met.feature[0] == "face" and len(one.model.face_loops[met.feature[1]]) == 1:
            found.append(Face(one, met))
    return found


def of_linearized(hypotheses: list[Any], path: Any) -> list[Row]:
    """Of each face that the path meets the predicted error and the measured, as shares of the face."""
    import palpate

    faces = faces_met(hypotheses, path)
    if not faces:
        return []
    chart = Chart(faces[0].corners.mean(axis=0), faces[0].normal)
    slopes = chart.slopes(path.direction)
    found = []
    for face in faces:
        corners = chart.points(face.corners)
        flat = corners * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.5 * (corners[:, 2].min() + corners[:, 2].max())]
        size, apart = _apart(seen(corners, slopes), seen(flat, slopes))
        if size > ROUNDING:
            bound = palpate.linearization_error(corners, slopes)[1]
            found.append({"predicted": bound / size, "measured": apart / size})
    return found


def _apart(one: Array, other: Array) -> tuple[float, float]:
    """The area of one polygon, and the area that is in one of two only."""
    from shapely import Polygon

    a, b = (Polygon(each).buffer(0.0) for each in (one, other))
    return float(a.area), float(a.symmetric_difference(b).area)


def of_decoupled(hypotheses: list[Any], path: Any, random: np.random.Generator) -> Row:
    """Of each face that the path meets the hit rate, predicted in two charts, and measured in the turned one.

    And, of lines in all rectangles at once, the share that meets all faces first; predicted is the product.
    """
    faces = faces_met(hypotheses, path)
    if not faces:
        return {"faces": [], "all": None}
    origin, normal = faces[0].corners.mean(axis=0), faces[0].normal
    charts = [Chart(origin, normal, 0.5 * math.pi * k / NUM_TURNS) for k in range(NUM_TURNS)]
    chart = min(
        charts, key=lambda chart: sum(_rectangle(chart.points(face.corners)[:, :2]) for face in faces)
    )
    rows = []
    for face in faces:
        predicted, box = _predicted(face, chart, path.direction)
        lines = random.uniform(*box, size=(NUM_LINES, 2))
        hits = sum(_meets(face, chart.place(at), path) for at in lines)
        unturned = _predicted(face, charts[0], path.direction)[0]
        rows.append({"predicted": predicted, "measured": hits / NUM_LINES, "unturned": unturned})
    return {"faces": rows, "all": _all_at_once(faces, chart, path, random=random)}


def _all_at_once(faces: list[Face], chart: Chart, path: Any, *, random: np.random.Generator) -> Row | None:
    """Lines that two decoupled problems hold to meet all faces: predicted and measured share."""
    both = [_predicted(face, chart, path.direction) for face in faces]
    low = np.max([box[0] for _, box in both], axis=0)
    high = np.min([box[1] for _, box in both], axis=0)
    if not (low < high).all():
        return None
    lines = random.uniform(low, high, size=(NUM_LINES, 2))
    hits = sum(all(_meets(face, chart.place(at), path) for face in faces) for at in lines)
    return {"predicted": math.prod(rate for rate, _ in both), "measured": hits / NUM_LINES}


def _predicted(face: Face, chart: Chart, direction: Array) -> tuple[float, tuple[Array, Array]]:
    """The predicted hit rate of a face, and its rectangle's opposite corners."""
    import palpate

    corners, slopes = chart.points(face.corners), chart.slopes(direction)
    at = seen(corners, slopes)
    return palpate.predicted_hit_rate(corners, slopes), (at.min(axis=0), at.max(axis=0))


def _rectangle(at: Array) -> float:
    """The area of the rectangle around places."""
    return float(np.prod(at.max(axis=0) - at.min(axis=0)))


def _meets(face: Face, through: Array, path: Any) -> bool:
    """Whether a line parallel to the path meets the face first."""
    start = through - path.length * path.direction
    met = face.model.first_contact(face.pose, start, path.direction, 0.0)
    return met is not None and met.feature == face.feature


def markdown(rows: list[Row]) -> str:
    """The tables, of rows that have `predictions` and `planners`."""
    return "\n\n".join([_linearized(rows), _decoupled(rows)])


def _linearized(rows: list[Row]) -> str:
    """The largest predicted error among the faces of a path, and what comes out."""
    of_range: list[list[Row]] = [[] for _ in ERRORS]
    for row in rows:
        if faces := row["predictions"]["linearized"]:
            worst = max(face["predicted"] for face in faces)
            of_range[next(k for k, most in enumerate(ERRORS) if worst <= most)].append(row)
    lines, low = [], 0.0
    for most, some in zip(ERRORS, of_range, strict=True):
        said = f"{low:.0%} to {most:.0%}" if math.isfinite(most) else f"more than {low:.0%}"
        low = most
        if not some:
            continue
        faces = [face for row in some for face in row["predictions"]["linearized"]]
        predicted, measured = (np.mean([face[key] for face in faces]) for key in ("predicted", "measured"))
        exceeded = sum(face["measured"] > face["predicted"] + ROUNDING for face in faces)
        scores = [
            [row["planners"][name]["score"] or row["hypotheses"] for name in ("linearized", "optimized")]
            for row in some
        ]
        lost = [(mine - other) / row["hypotheses"] for (mine, other), row in zip(scores, some, strict=True)]
        worse, better = sum(one > ROUNDING for one in lost), sum(one < -ROUNDING for one in lost)
        shares = [f"{predicted:.1%}", f"{measured:.1%}"]
        beside = [f"{worse} / {better}", f"{np.mean(lost):+.1%}"]
        lines.append([said, str(len(some)), str(len(faces)), *shares, str(exceeded), *beside])
    head = [
        "largest predicted error of the path",
        "paths",
        "faces",
        "predicted, mean",
        "measured, mean",
        "above the bound",
    ]
    return pages.table([*head, "leaves more / less than `optimized`", "leaves more by"], lines)


def _decoupled(rows: list[Row]) -> str:
    """Predicted and measured hit rates."""
    found = [row["predictions"]["decoupled"] for row in rows if row["predictions"]["decoupled"]]
    faces = [face for each in found for face in each["faces"]]
    at_once = [each["all"] for each in found if each["all"]]
    lines = []
    for said, some in (("a face", faces), ("all faces of a path at once", at_once)):
        if some:
            predicted, measured = (np.array([one[key] for one in some]) for key in ("predicted", "measured"))
            shares = [f"{np.mean(each):.0%}" for each in (predicted, measured, abs(predicted - measured))]
            lines.append([said, f"{len(some):,}", *shares])
    table = pages.table(["hit rate of", "", "predicted, mean", "measured, mean", "off by, mean"], lines)
    unturned = np.mean([face["unturned"] for face in faces]) if faces else 0.0
    return f"{table}\n\nPredicted for the same faces in a chart that is not turned: {unturned:.0%}."
