"""How far triangles are from surfaces on which their corners lie: planes, cylinders, cones, spheres, tori.

The bounds are proved, not sampled. Let a triangle's corners lie on a cone or cylinder, their directions from
the axis within an arc of width Δ < 2π/3. The radius at a corner is linear in the height; the projection of a
point of the triangle on the middle of the arc is therefore no less than cos Δ/2 of the radius at its height,
and the surface is no farther out than R (1 − cos Δ/2), R being the largest radius. The product of the
triangle's normal and the surface's is concave over the arc: the largest angle is at a corner. Of a sphere,
what lies on the rays from its centre through a triangle is no farther than its plane is from the pole, and
the angle is again largest at a corner. On a torus, the error of linear interpolation is at most an eighth of
the second differential over the range of both angles, and normals turn by no more than the angles do, of
which two thirds lie between a point and its weightiest corner.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.curves import Array

# Corners farther from their surface than this share of all coordinates are not on it: single precision.
_ON = 1e-5


@dataclass(frozen=True)
class _Triangles:
    corners: Array
    """Shape `(m, 3, 3)`."""
    normals: Array
    """Unit, shape `(m, 3)`."""
    allowed: float
    """How far corners may be from the surface."""


def bounds(surface: dict[str, Any] | None, corners: Array) -> tuple[float, float] | None:
    """The largest distance and the largest angle, radians, between triangles and their surface.

    Args:
        surface: As cascadio describes it; None if it can't.
        corners: Of the triangles, shape `(m, 3, 3)`.

    Returns:
        None if nothing is proved: the surface is of none of these kinds, or the corners are not on it.
    """
    if not len(corners):
        return 0.0, 0.0
    kind = None if surface is None else surface.get("type")
    make = {"plane": _plane, "cylinder": _cylinder, "cone": _cone, "sphere": _sphere, "torus": _torus}
    if surface is None or kind not in make:
        return None
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1)
    # A sliver without area has no normal, and is left out of the part.
    keep = length > 0.0
    corners, normals = corners[keep], across[keep] / length[keep][:, None]
    if not len(corners):
        return 0.0, 0.0
    allowed = _ON * float(np.max(np.abs(corners)))
    return make[kind](surface, _Triangles(corners, normals, allowed))


def _plane(surface: dict[str, Any], given: _Triangles) -> tuple[float, float] | None:
    off = (given.corners - _vector(surface, "origin")) @ _unit(surface, "normal")
    return (0.0, 0.0) if np.max(np.abs(off)) <= given.allowed else None


def _cylinder(surface: dict[str, Any], given: _Triangles) -> tuple[float, float] | None:
    corners, normals, allowed = given.corners, given.normals, given.allowed
    radius = float(surface["radius"])
    away = _from_axis(corners - _vector(surface, "origin"), _unit(surface, "axis"))
    radii = np.linalg.norm(away, axis=2)
    if np.max(np.abs(radii - radius)) > allowed:
        return None
    outward = away / radii[..., None]
    return _round(radius, _span(outward), _angle(normals, outward))


def _cone(surface: dict[str, Any], given: _Triangles) -> tuple[float, float] | None:
    corners, normals, allowed = given.corners, given.normals, given.allowed
    axis, half = _unit(surface, "axis"), abs(float(surface["semi_angle"]))
    from_apex = corners - _vector(surface, "apex")
    along = from_apex @ axis
    away = _from_axis(from_apex, axis)
    radii = np.linalg.norm(away, axis=2)
    if np.max(np.abs(radii - np.abs(along) * math.tan(half))) * math.cos(half) > allowed:
        return None
    # The apex has no normal of its own: it is one of those on the sides that end there.
    farthest = np.argmax(radii, axis=1)[:, None, None]
    apex = (radii <= allowed)[..., None]
    away = np.where(apex, np.take_along_axis(away, farthest, axis=1), away)
    outward = away / np.linalg.norm(away, axis=2, keepdims=True)
    side = np.sign(np.take_along_axis(along, farthest[..., 0], axis=1))[..., None]
    tilted = math.cos(half) * outward - math.sin(half) * side * axis
    return _round(float(np.max(radii)), _span(outward), _angle(normals, tilted))


def _sphere(surface: dict[str, Any], given: _Triangles) -> tuple[float, float] | None:
    corners, normals, allowed = given.corners, given.normals, given.allowed
    radius = float(surface["radius"])
    away = corners - _vector(surface, "center")
    lengths = np.linalg.norm(away, axis=2)
    if np.max(np.abs(lengths - radius)) > allowed:
        return None
    depth = np.abs(np.sum(away[:, 0] * normals, axis=1))
    return float(np.max(radius - depth)), float(np.max(_angle(normals, away / lengths[..., None])))


def _torus(surface: dict[str, Any], given: _Triangles) -> tuple[float, float] | None:
    corners, normals, allowed = given.corners, given.normals, given.allowed
    axis = _unit(surface, "axis")
    major, minor = float(surface["major_radius"]), float(surface["minor_radius"])
    from_center = corners - _vector(surface, "center")
    away = _from_axis(from_center, axis)
    radii = np.linalg.norm(away, axis=2)
    if np.min(radii) <= allowed:
        return None
    outward = away / radii[..., None]
    height = from_center @ axis
    tube = np.hypot(radii - major, height)
    if np.max(np.abs(tube - minor)) > allowed or np.min(tube) <= allowed:
        return None
    normal = ((radii - major)[..., None] * outward + height[..., None] * axis) / tube[..., None]
    around = _span(outward)
    along = _span(np.stack([(radii - major) / tube, height / tube], axis=2))
    error = ((major + minor) * around**2 + 2.0 * minor * around * along + minor * along**2) / 8.0
    turned = _angle(normals, normal) + (around + along) * 2.0 / 3.0
    return float(np.max(error)), float(np.max(turned))


def _round(radius: float, span: Array, angle: Array) -> tuple[float, float] | None:
    """Of triangles around an axis."""
    if np.max(span) >= 2.0 * math.pi / 3.0:
        return None
    return radius * (1.0 - math.cos(0.5 * float(np.max(span)))), float(np.max(angle))


def _from_axis(points: Array, axis: Array) -> Array:
    return np.asarray(points - (points @ axis)[..., None] * axis)


def _span(directions: Array) -> Array:
    """The largest angle between two of three unit vectors, for each triangle; `(m, 3, d)`."""
    others = np.roll(directions, 1, axis=1)
    chord = np.linalg.norm(directions - others, axis=2)
    return np.asarray(2.0 * np.arcsin(np.minimum(1.0, 0.5 * np.max(chord, axis=1))))


def _angle(normals: Array, outward: Array) -> Array:
    """The largest angle between a triangle's normal and those of the surface, which side is outside aside."""
    cosines = np.abs(np.einsum("ki,kni->kn", normals, outward))
    return np.asarray(np.arccos(np.minimum(1.0, np.min(cosines, axis=1))))


def _vector(surface: dict[str, Any], name: str) -> Array:
    return np.array(surface[name], dtype=float)


def _unit(surface: dict[str, Any], name: str) -> Array:
    vector = _vector(surface, name)
    return np.asarray(vector / np.linalg.norm(vector))
