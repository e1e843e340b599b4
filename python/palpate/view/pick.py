"""Which place of a part in the plane was clicked."""

from __future__ import annotations

import numpy as np

from palpate._core import Model
from palpate.view.state import Array


def nearest_face_point(
    model: Model, world_from_model: Array, *, origin: Array, direction: Array
) -> tuple[Array, Array]:
    """The point of a touchable face that is nearest to where a ray meets the plane, and the normal there.

    Args:
        model: A part of the plane.
        world_from_model: Where it is drawn, shape `(3, 3)`.
        origin: Where the ray begins, shape `(3,)`; the plane is z = 0.
        direction: Its direction, shape `(3,)`.

    Returns:
        Point and unit outward normal, shape `(2,)` each, world frame.

    Raises:
        ValueError: The ray runs beside the plane, or nothing can be touched.
    """
    if direction[2] == 0.0:
        raise ValueError("click: runs beside the plane; look at it from above")
    clicked = (origin - origin[2] / direction[2] * direction)[:2]
    rotation, translation = world_from_model[:2, :2], world_from_model[:2, 2]
    touchable = np.array([surface == "touchable" for surface in model.face_surfaces])
    if not touchable.any():
        raise ValueError(f"click: no face of {model.name} can be touched; choose another part")
    ends = np.array(model.faces)[touchable] @ rotation.T + translation
    along = ends[:, 1] - ends[:, 0]
    share = np.sum((clicked - ends[:, 0]) * along, axis=1) / np.sum(along * along, axis=1)
    points = ends[:, 0] + np.clip(share, 0.0, 1.0)[:, None] * along
    nearest = int(np.argmin(np.sum((points - clicked) ** 2, axis=1)))
    return points[nearest], model.face_normals[touchable][nearest] @ rotation.T
