"""Bodies sorted into parts.

Bodies that meet are one part: where they overlap or lie face to face, what is inside is no surface. Bodies
that don't meet are parts of their own, as outlines of a drawing are; a cavity belongs to the body around it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from palpate.contacts.entry import refuse
from palpate.solids.mesh import (
    Array,
    Body,
    Numbers,
    Scene,
    SolidMesh,
    box,
    cleaned,
    components,
    inside_out,
    is_branched,
    is_consistent,
    joined,
    open_edges,
    part_of,
    pieces_of,
    said,
    sewn,
    shells_of,
    split_open,
    volume,
)

# Boxes this close, as a share of all, meet: more than numbers of single precision are off.
_NEAR = 1e-6


def parts_of(file: str, stem: str, scene: Scene) -> list[SolidMesh]:
    """The parts of a file, from left to right, named by its stem, and numbered if there are several.

    Raises:
        ValueError: If there is no surface in it, or bodies meet and can't be joined.
    """
    if not any(len(body.triangles) for body in scene.bodies):
        said_notes = "".join(f" ({note})" for note in scene.notes)
        refuse(file, f"no triangle in it{said_notes}", "export the part as a mesh or a solid")
    notes = list(scene.notes)
    pieces = _pieces(file, scene.bodies, notes)
    if not pieces:
        refuse(file, "none of its triangles has an area", "export the part again")
    parts: list[tuple[Body, list[str]]] = []
    lows, highs = (np.array(corners) for corners in zip(*map(box, pieces), strict=True))
    for group in _meeting(lows, highs):
        parts += _joined_parts(file, [pieces[k] for k in group])
    parts.sort(key=lambda part: tuple(box(part[0])[0]))
    names = [stem] if len(parts) == 1 else [f"{stem}-{k}" for k in range(1, len(parts) + 1)]
    return [
        SolidMesh(
            name,
            body.vertices,
            body.triangles,
            position_slack=body.position_slack,
            normal_slack=body.normal_slack,
            mends=(*notes, *own),
        )
        for name, (body, own) in zip(names, parts, strict=True)
    ]


def _pieces(file: str, bodies: Sequence[Body], notes: list[str]) -> list[Body]:
    """Connected pieces of bodies, those that are open sewn together."""
    pieces: list[Body] = []
    patches: list[tuple[Body, Numbers]] = []
    for body in bodies:
        whole = _outward(cleaned(body, notes), notes)
        if not open_edges(whole):
            pieces += pieces_of(whole)
            continue
        closed, patch, label = split_open(whole)
        pieces += closed
        patches.append((patch, label))
    for group in _patches_together(patches):
        names = list(dict.fromkeys(patch.name for patch in group))
        whole = replace(_one(group), name=names[0] if len(names) == 1 else "")
        pieces += pieces_of(_outward(sewn(file, cleaned(whole, []), notes), notes))
    return pieces


def _patches_together(patches: Sequence[tuple[Body, Numbers]]) -> list[list[Body]]:
    """Open surfaces in groups with gaps between them, each with what each body has of it.

    A group of a file may be a patch of a surface, such as all of one colour; and a file may have each
    triangle with corners of its own. `patches` are the triangles of each body, with a label of the piece to
    which each belongs.
    """
    if not patches:
        return []
    lows: list[Array] = []
    highs: list[Array] = []
    pieces: list[Numbers] = []
    for patch, label in patches:
        marks, piece = np.unique(label, return_inverse=True)
        corners = patch.vertices[patch.triangles]
        lows.append(np.full((len(marks), 3), np.inf))
        highs.append(np.full((len(marks), 3), -np.inf))
        np.minimum.at(lows[-1], piece, np.min(corners, axis=1))
        np.maximum.at(highs[-1], piece, np.max(corners, axis=1))
        pieces.append(piece + sum(map(len, lows[:-1])))
    groups = _between_gaps(np.concatenate(lows), np.concatenate(highs))
    group_of = np.empty(sum(map(len, lows)), dtype=np.int64)
    for number, group in enumerate(groups):
        group_of[group] = number
    found: list[list[Body]] = [[] for _ in groups]
    for (patch, _), piece in zip(patches, pieces, strict=True):
        of_triangle = group_of[piece]
        for number in np.unique(of_triangle):
            found[number].append(part_of(patch, patch.triangles[of_triangle == number]))
    return found


def _outward(body: Body, notes: list[str]) -> Body:
    """The body, turned if all its triangles face inward; what is mixed the core sorts out."""
    if not is_consistent(body) or volume(body) >= 0.0:
        return body
    notes.append("triangles faced inward: turned")
    return inside_out(body)


def _joined_parts(file: str, group: list[Body]) -> list[tuple[Body, list[str]]]:
    """The parts that bodies make whose boxes meet, each with notes of its own."""
    named = list(dict.fromkeys(body.name for body in group if body.name))
    called = [f"the file calls it {', '.join(named)}"[:100]] if named else []
    openings = sum(map(open_edges, group))
    if openings:
        # Nothing is said of inside and outside, so that surfaces inside do no harm.
        note = f"the surface is open: {openings} edge(s) where it ends; inside and outside are not known"
        more = [f"{len(group)} pieces kept as they are"] if len(group) > 1 else []
        return [(_one(group), [*called, note, *more])]
    consistent = all(map(is_consistent, group))
    if len(group) == 1 and not (consistent and is_branched(group[0])):
        return [(group[0], called)]
    if not consistent:
        refuse(
            file,
            f"{len(group)} bodies meet near {said(box(group[0])[0])}, and triangles of some face both ways",
            "make the normals of each body consistent, or export them as one solid",
        )
    solids = _solids([shell for body in group for shell in shells_of(body)])
    if len(solids) == 1:
        return [(_one(group), called)]
    try:
        united = _solids(pieces_of(_united(file, solids)))
    except ValueError:
        if len(group) > 1:
            raise
        return [(group[0], [*called, "at some edges more than two triangles meet: kept as they are"])]
    joint = [f"{len(solids)} bodies that meet joined"] if len(united) < len(solids) else []
    return [(solid, [*called, *joint]) for solid in united]


def _one(group: list[Body]) -> Body:
    """All of them in one, corners that are in the same place made one."""
    return cleaned(joined(group), []) if len(group) > 1 else group[0]


def _between_gaps(lows: Array, highs: Array) -> list[Numbers]:
    """Groups of boxes that planes across the axes part, each in order.

    They are no less than those that meet, and sooner found.
    """
    near = _near(lows, highs)
    open_groups = [np.arange(len(lows))]
    groups: list[Numbers] = []
    while open_groups:
        group = open_groups.pop()
        for axis in range(3):
            order = group[np.argsort(lows[group, axis], kind="stable")]
            reached = np.maximum.accumulate(highs[order, axis])[:-1]
            gaps = np.flatnonzero(lows[order[1:], axis] > reached + near) + 1
            if len(gaps):
                open_groups += [np.sort(part) for part in np.split(order, gaps)]
                break
        else:
            groups.append(group)
    return sorted(groups, key=lambda group: int(group[0]))


def _near(lows: Array, highs: Array) -> float:
    return _NEAR * float(np.max(np.max(highs, axis=0) - np.min(lows, axis=0)))


def _meeting(lows: Array, highs: Array) -> list[list[int]]:
    """Groups of boxes that meet, each in order."""
    near = _near(lows, highs)
    order = np.argsort(lows[:, 0], kind="stable")
    pairs: list[Numbers] = []
    for at, k in enumerate(order):
        after = order[at + 1 :]
        until = np.searchsorted(lows[after, 0], highs[k, 0] + near, side="right")
        some = after[:until]
        meet = some[np.all((lows[some] <= highs[k] + near) & (highs[some] >= lows[k] - near), axis=1)]
        pairs.append(np.stack([np.full(len(meet), k), meet], axis=1))
    label = components(len(lows), np.concatenate(pairs))
    by_label = np.argsort(label, kind="stable")
    ends = np.flatnonzero(np.diff(label[by_label])) + 1
    return [group.tolist() for group in np.split(by_label, ends)]


def _united(file: str, group: list[Body]) -> Body:
    """Their union, by manifold3d.

    Its triangles lie on those of the bodies to within the rounding of what it computes.
    """
    try:
        import manifold3d
    except ImportError:
        refuse(
            file,
            f"{len(group)} bodies meet near {said(box(group[0])[0])}, and joining them takes manifold3d",
            'run pip install "palpate[union]", or join them in the CAD program',
        )
    solids: list[Any] = []
    for body in group:
        triangles = np.ascontiguousarray(body.triangles, dtype=np.uint64)
        made = manifold3d.Manifold(manifold3d.Mesh64(np.ascontiguousarray(body.vertices), triangles))
        if made.status() != manifold3d.Error.NoError:
            refuse(
                file,
                f"the body near {said(box(body)[0])} bounds no solid ({made.status().name})",
                "mend it, or join the bodies in the CAD program",
            )
        solids.append(made)
    mesh = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).to_mesh64()
    vertices: Array = np.asarray(mesh.vert_properties, dtype=float)[:, :3]
    numbers: Numbers = np.asarray(mesh.tri_verts, dtype=np.int64)
    if not len(numbers):
        refuse(file, "nothing is left of its bodies when they are joined", "export the part as one solid")
    whole = joined(group)
    return cleaned(
        Body(vertices, numbers, position_slack=whole.position_slack, normal_slack=whole.normal_slack),
        [],
    )


def _solids(pieces: list[Body]) -> list[Body]:
    """Pieces that face outward, each with the cavities in it; what faces inward and is in none is turned."""
    outer = [piece for piece in pieces if volume(piece) > 0.0]
    cavities: list[list[Body]] = [[] for _ in outer]
    turned: list[Body] = []
    for piece in pieces:
        if volume(piece) > 0.0:
            continue
        low, high = box(piece)
        around = [
            k
            for k, solid in enumerate(outer)
            if np.all(box(solid)[0] <= low) and np.all(box(solid)[1] >= high) and _holds(solid, piece)
        ]
        if around:
            # The smallest: a cavity may be in a solid that is itself in a cavity.
            cavities[min(around, key=lambda k: volume(outer[k]))].append(piece)
        else:
            turned.append(inside_out(piece))
    return [_one([solid, *inside]) for solid, inside in zip(outer, cavities, strict=True)] + turned


def _holds(solid: Body, piece: Body) -> bool:
    """Whether a corner of `piece`, which does not cross `solid`, is inside it: by solid angles."""
    a, b, c = (solid.vertices[solid.triangles[:, k]] - piece.vertices[0] for k in range(3))
    lengths = [np.linalg.norm(side, axis=1) for side in (a, b, c)]
    triple = np.sum(a * np.cross(b, c), axis=1)
    dots = [np.sum(p * q, axis=1) for p, q in ((a, b), (b, c), (c, a))]
    below = np.prod(lengths, axis=0) + dots[0] * lengths[2] + dots[1] * lengths[0] + dots[2] * lengths[1]
    return float(np.sum(np.arctan2(triple, below))) > np.pi  # half of the 4π, over 2
