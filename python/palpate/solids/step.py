"""STEP: exact surfaces made into triangles, and what that costs.

OpenCASCADE makes them, through cascadio (`palpate[step]`).
"""

from __future__ import annotations

import json
import math
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from palpate.contacts.entry import refuse
from palpate.curves import Tolerance
from palpate.solids.mesh import Array, Body, Numbers, Scene, body_of
from palpate.solids.surfaces import bounds

_AGAIN = "export it again as STEP (AP214 or AP242), or as STL"
_COLOUR = re.compile(rb"COLOUR_RGB\s*\(\s*'(?:[^']|'')*'\s*,[^)]*\)")
_MOST_SECONDS = 600.0
_GLB_IN_MM = 1000.0
_TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3}


def read_step(file: Path, *, mm_per_unit: float, tolerance: Tolerance) -> Scene:
    """The bodies of a STEP file, in its own places, converted to the models' unit.

    Raises:
        ValueError: If it is damaged, has no surface, or cascadio is not installed.
    """
    text = file.read_bytes().strip()
    if not text.startswith(b"ISO-10303-21"):
        refuse(file.name, "not a readable STEP file: it does not begin with ISO-10303-21", _AGAIN)
    if not text.endswith(b"END-ISO-10303-21;"):
        refuse(file.name, "it is cut off: END-ISO-10303-21 is missing", "export or copy it again")
    # Of neighbouring chords the tangents differ by twice what a chord is off.
    glb = _glb(
        file.name, _in_one_colour(text), linear=tolerance.distance * mm_per_unit, angular=2.0 * tolerance.turn
    )
    document, buffer = _chunks(file.name, glb)
    scene = Scene()
    free = 0
    for node, world_from_node in _nodes(document):
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            body, free_faces = _body(file.name, document, buffer, primitive, world_from_node)
            free += free_faces
            scene.bodies.append(_scaled(file.name, body, node.get("name", ""), tolerance, mm_per_unit))
    if free:
        scene.notes.append(
            f"{free} free-form face(s): OpenCASCADE was asked to keep the slack there, which is not proved"
        )
    return scene


def _scaled(file: str, body: Body, name: str, tolerance: Tolerance, mm_per_unit: float) -> Body:  # noqa: PLR0917
    """In the models' unit; where a surface is curved, so are edges, which are kept to the tolerance."""
    scaled = body_of(file, body.vertices, body.triangles, name=name, scale=_GLB_IN_MM / mm_per_unit)
    curved = body.position_slack > 0.0
    slack = max(body.position_slack * _GLB_IN_MM / mm_per_unit, tolerance.distance) if curved else 0.0
    return Body(scaled.vertices, scaled.triangles, name, position_slack=slack, normal_slack=body.normal_slack)


def _in_one_colour(text: bytes) -> bytes:
    """The file with all colours the same: cascadio describes the surfaces of one colour only."""
    return _COLOUR.sub(rb"COLOUR_RGB('',0.5,0.5,0.5)", text)


def _glb(name: str, text: bytes, *, linear: float, angular: float) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "part.step", Path(folder) / "part.glb"
        source.write_bytes(text)
        command = [sys.executable, "-m", "palpate.solids.step_process", str(source), str(target)]
        try:
            done = subprocess.run(
                [*command, repr(linear), repr(angular)],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=_MOST_SECONDS,
                check=False,
            )
        except subprocess.TimeoutExpired:
            refuse(
                name, f"it takes more than {_MOST_SECONDS:g} s to make triangles of it", "raise flattening"
            )
        if done.returncode == 2:
            refuse(
                name,
                "reading STEP takes cascadio, which is not installed",
                'run pip install "palpate[step]", or export the part as STL or 3MF',
            )
        if done.returncode != 0 or not target.exists():
            refuse(name, f"not a readable STEP file{_reason(done.stdout + done.stderr)}", _AGAIN)
        return target.read_bytes()


def _reason(printed: bytes) -> str:
    """What OpenCASCADE said, without its colours and stars."""
    for line in printed.decode("utf-8", errors="replace").splitlines():
        if "ERR" in line:
            words = line.split("ERR", 1)[1].replace("*", " ").replace("\x1b[0m", " ").split()
            return f": {' '.join(words)[:120]}"
    return ": OpenCASCADE can't make triangles of it"


def _chunks(file: str, glb: bytes) -> tuple[dict[str, Any], bytes]:
    """The document and the numbers of a GLB file."""
    (length,) = struct.unpack_from("<I", glb, 12)
    document = json.loads(glb[20 : 20 + length])
    if "meshes" not in document:
        refuse(file, "there is no surface in it", _AGAIN)
    return document, glb[20 + length + 8 :]


def _nodes(document: dict[str, Any]) -> Iterator[tuple[dict[str, Any], Array]]:
    """Each placed mesh, with `world_from_node`, in the order of the file."""
    nodes = document.get("nodes", [])
    roots = [node for scene in document.get("scenes", []) for node in scene.get("nodes", [])]
    left = [(number, np.eye(4)) for number in reversed(roots)]
    while left:
        number, world_from_parent = left.pop()
        node = nodes[number]
        world_from_node = world_from_parent @ _placement(node)
        if "mesh" in node:
            yield node, world_from_node
        left += [(child, world_from_node) for child in reversed(node.get("children", []))]


def _placement(node: dict[str, Any]) -> Array:
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    placed = np.eye(4)
    placed[:3, :3] = turn * np.array(node.get("scale", (1.0, 1.0, 1.0)), dtype=float)
    placed[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return placed


def _body(  # noqa: PLR0917
    file: str, document: dict[str, Any], buffer: bytes, primitive: dict[str, Any], world_from_node: Array
) -> tuple[Body, int]:
    """In metres; and how many of its faces are of no kind whose slack is proved."""
    points = _array(document, buffer, primitive["attributes"]["POSITION"])
    numbers = _array(document, buffer, primitive["indices"]).astype(np.int64).reshape(-1, 3)
    extension = primitive.get("extensions", {}).get("TM_brep_faces", {})
    faces = extension.get("faces") or []
    face_of = np.full(len(numbers), -1, dtype=np.int64)
    if "faceIndices" in extension:
        face_of = _array(document, buffer, extension["faceIndices"]).astype(np.int64).reshape(-1)
    normals: Array | None = None
    if "NORMAL" in primitive["attributes"]:
        normals = _array(document, buffer, primitive["attributes"]["NORMAL"])
    position, normal, free = _slacks(points, numbers, normals, faces, face_of)
    turn = world_from_node[:3, :3]
    if np.linalg.det(turn) < 0.0:
        numbers = numbers[:, ::-1]
    growth = float(np.linalg.norm(turn, ord=2))
    placed = points @ turn.T + world_from_node[:3, 3]
    return Body(placed, numbers, position_slack=position * growth, normal_slack=normal), free


def _slacks(  # noqa: PLR0917
    points: Array, numbers: Numbers, normals: Array | None, faces: list[Any], face_of: Numbers
) -> tuple[float, float, int]:
    """The largest distance and angle between triangles and surfaces; the number of free-form faces."""
    position = normal = 0.0
    free = 0
    for face in np.unique(face_of):
        chosen = numbers[face_of == face]
        surface = faces[face] if 0 <= face < len(faces) else None
        found = bounds(surface, points[chosen])
        if found is None:
            free += 1
            found = (math.ulp(0.0), _free_angle(points[chosen], None if normals is None else normals[chosen]))
        position, normal = max(position, found[0]), max(normal, found[1])
    return position, normal, free


def _free_angle(corners: Array, normals: Array | None) -> float:
    """How far normals are from the triangles' at corners, and half of how far they turn between them."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    keep = length[:, 0] > 0.0
    if normals is None or not np.any(keep):
        return 0.0
    across = across[keep] / length[keep]
    ours = normals[keep]
    at = np.arccos(np.clip(np.abs(np.einsum("ki,kni->kn", across, ours)), 0.0, 1.0))
    between = np.arccos(np.clip(np.einsum("kni,kni->kn", ours, np.roll(ours, 1, axis=1)), -1.0, 1.0))
    return float(np.max(np.max(at, axis=1) + 0.5 * np.max(between, axis=1)))


def _array(document: dict[str, Any], buffer: bytes, number: int) -> Array:
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    kind, width = np.dtype(_TYPES[accessor["componentType"]]), _WIDTHS[accessor["type"]]
    return np.ndarray(
        (accessor["count"], width),
        dtype=kind,
        buffer=buffer,
        offset=view.get("byteOffset", 0) + accessor.get("byteOffset", 0),
        strides=(view.get("byteStride", kind.itemsize * width), kind.itemsize),
    ).astype(float)
