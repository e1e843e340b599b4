"""Parts in convex pieces, as a physics engine needs them.

A planar part becomes prisms over the triangles of its outline; their diagonals go from corner to corner, so
that no face has a seam. A solid is cut through edges that stick in, until none does.
Both by manifold3d.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate._core import Model
from palpate.model_json import document_of
from palpate.rig.extra import library

Array: TypeAlias = NDArray[np.float64]

MOST_PIECES = 400
STICKS_IN = 1e-4
"""Radians: edges that stick in by less are taken for flat."""
FILLED = 1e-6
"""A piece whose hull is larger than this is not convex."""


def planar_pieces(model: Model, *, low: float, high: float) -> list[Array]:
    """Corners of prisms, each shape `(6, 3)`, in the model's frame and unit, between two heights.

    Raises:
        ValueError: Loose edges, which bound nothing.
    """
    _check_closed(model)
    drawn = document_of(model, "mm")  # lengths are as they are
    rings = [np.asarray(ring, dtype=float) for ring in [drawn["outer"], *drawn["holes"]]]
    corners = np.vstack(rings)
    triangles = library("manifold3d").triangulate(rings)
    pieces: list[Array] = []
    for triangle in triangles:
        flat = corners[np.asarray(triangle)]
        pieces.append(np.vstack([np.column_stack([flat, np.full(3, z)]) for z in (low, high)]))
    return pieces


def solid_pieces(model: Model) -> list[Array]:
    """Corners of convex pieces, each shape `(n, 3)`, in the model's frame and unit.

    Raises:
        ValueError: Loose faces; more than `MOST_PIECES` pieces.
    """
    _check_closed(model)
    manifold3d = library("manifold3d")
    mesh = manifold3d.Mesh64(
        np.array(model.vertices, dtype=float),
        np.array(model.triangles, dtype=np.uint64),
    )
    whole = manifold3d.Manifold(mesh)
    if whole.is_empty():
        raise ValueError(f"model: {model.name!r} is no closed solid; give one whose surface has no gaps")
    waiting: list[Any] = whole.decompose()
    done: list[Array] = []
    while waiting:
        piece = waiting.pop()
        cut = _cut_of(piece)
        if cut is None:
            if piece.hull().volume() > (1.0 + FILLED) * piece.volume():
                raise ValueError(f"model: {model.name!r} can't be cut into convex pieces; simplify it")
            done.append(np.asarray(piece.to_mesh64().vert_properties)[:, :3])
        else:
            halves = [half for half in piece.split_by_plane(*cut) if not half.is_empty()]
            parts = [part for half in halves for part in half.decompose()]
            if len(parts) < 2:
                raise ValueError(f"model: {model.name!r} can't be cut into convex pieces; simplify it")
            waiting += parts
        if len(waiting) + len(done) > MOST_PIECES:
            raise ValueError(
                f"model: {model.name!r} has more than {MOST_PIECES} convex pieces; give a simpler one"
            )
    return done


def _cut_of(piece: Any) -> tuple[list[float], float] | None:
    """The plane that halves the edge that sticks in most, its normal and offset; None: the piece is convex.

    The plane of a face would do with fewer pieces, but cuts along what is there already leave thin sheets.
    """
    mesh = piece.to_mesh64()
    points = np.asarray(mesh.vert_properties)[:, :3]
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    merged = np.arange(len(points))
    merged[np.asarray(mesh.merge_from_vert, dtype=np.int64)] = np.asarray(mesh.merge_to_vert, dtype=np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    across: dict[tuple[int, int], int] = {}
    for number, corners in enumerate(merged[triangles]):
        for k in range(3):
            across[int(corners[k]), int(corners[(k + 1) % 3])] = number
    best: tuple[int, int] | None = None
    least = STICKS_IN
    for (start, end), one in across.items():
        other = across.get((end, start))
        if other is None or start > end:  # each edge once
            continue
        along = points[end] - points[start]
        turn = float(np.cross(normals[one], normals[other]) @ (along / np.linalg.norm(along)))
        if -turn > least:
            best, least = (one, other), -turn
    if best is None:
        return None
    one, other = best
    normal = normals[one] - normals[other]
    normal /= np.linalg.norm(normal)
    shared = points[next(k for k in triangles[one] if merged[k] in merged[triangles[other]])]
    return normal.tolist(), float(normal @ shared)


def _check_closed(model: Model) -> None:
    if not model.closed:
        raise ValueError(
            f"model: {model.name!r} is not closed, so nothing can rest on it in the rig; give a closed part"
        )
