"""Where the faces of a model in space are, and how large."""

from __future__ import annotations

import numpy as np

from palpate._core import Model
from palpate.curves import Array


def face_areas(model: Model) -> Array:
    """The area of each face, shape `(n,)`; a seam has none."""
    areas = np.zeros(len(model.faces))
    np.add.at(areas, model.triangle_faces, _areas(model))
    return areas


def face_places(model: Model) -> Array:
    """A point well inside each face, the middle of its largest triangle, shape `(n, 3)`; NaN for a seam."""
    places = np.full((len(model.faces), 3), np.nan)
    # The largest triangle of each face is the last to be written; of equal ones the first.
    shares = np.round(_areas(model) / model.size**2, 9)
    order = np.lexsort((-np.arange(len(shares)), shares))
    places[model.triangle_faces[order]] = model.vertices[model.triangles[order]].mean(axis=1)
    return places


def _areas(model: Model) -> Array:
    a, b, c = (model.vertices[model.triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
