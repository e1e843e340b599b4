"""OBJ and OFF: vertices and polygons as text. Their numbers have no unit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.solids.mesh import Scene, body_of
from palpate.solids.polygons import triangulated

_AGAIN = "export or copy the file again"
# Of an OBJ: what says nothing about the surface.
_OBJ_SILENT = {
    "vt",
    "vn",
    "vp",
    "usemtl",
    "mtllib",
    "s",
    "maplib",
    "usemap",
    "shadow_obj",
    "trace_obj",
    "lod",
}


def text_of(data: bytes) -> str:
    """Text whose numbers are ASCII, whatever its names are."""
    return data.decode("utf-8-sig", errors="replace")


@dataclass
class _Group:
    name: str
    polygons: list[list[int]] = field(default_factory=list[list[int]])


def read_obj(file: str, data: bytes) -> Scene:
    """The bodies of an OBJ file: its objects, or its groups where it has no objects."""
    text = text_of(data)
    if "\0" in text:
        refuse(file, "not a readable OBJ file: it is no text", "export it again as OBJ")
    points: list[list[float]] = []
    groups = [_Group("")]
    names_objects = any(line.startswith("o ") for line in text.splitlines())
    left_out: Counter[str] = Counter()
    for number, line in _lines(text.replace("\\\r\n", " ").replace("\\\n", " ")):
        word, *rest = line.split()
        if word == "v":
            points.append(_numbers(f"{file}, line {number}", rest, least=3)[:3])
        elif word == "f":
            groups[-1].polygons.append(_obj_face(f"{file}, line {number}", rest, len(points)))
        elif word == ("o" if names_objects else "g"):
            groups.append(_Group(" ".join(rest)))
        elif word not in _OBJ_SILENT and word not in ("o", "g"):
            left_out[word] += 1
    if not points and left_out:
        refuse(file, "not a readable OBJ file: there is no vertex in it", "export it again as OBJ")
    scene = Scene(notes=[f"left out: {count} {word[:20]}" for word, count in sorted(left_out.items())])
    vertices = np.array(points, dtype=float).reshape(-1, 3)
    for group in groups:
        if group.polygons:
            triangles = triangulated(file, vertices, group.polygons)
            scene.bodies.append(body_of(file, vertices, triangles, name=group.name))
    return scene


def _obj_face(where: str, words: Sequence[str], count: int) -> list[int]:
    """Vertex numbers from 0; in the file they count from 1, or from the last one backwards."""
    numbers: list[int] = []
    for word in words:
        try:
            number = int(word.split("/", 1)[0])
        except ValueError:
            refuse(where, f"{word[:20]!r} is no corner of a face", _AGAIN)
        numbers.append(number - 1 if number > 0 else count + number)
        if number == 0 or numbers[-1] < 0:
            refuse(where, f"there is no vertex {number}", _AGAIN)
    if len(numbers) < 3:
        refuse(where, f"a face has {len(numbers)} corner(s)", _AGAIN)
    return numbers


def read_off(file: str, data: bytes) -> Scene:
    """The body of an OFF file."""
    lines = _lines(text_of(data))
    if not lines or not lines[0][1].split()[0].upper().endswith("OFF"):
        refuse(file, "not a readable OFF file: it does not begin with OFF", "export it again as OFF")
    number, first = lines.pop(0)
    head, *rest = first.split()
    if head.upper().startswith(("4", "N4")) or head.upper() == "NOFF4" or "BINARY" in first.upper():
        refuse(file, f"this kind of OFF ({first[:20]}) is not read", "export it as plain OFF, or as STL")
    if not rest and lines:
        number, counts = lines.pop(0)
        rest = counts.split()
    try:
        vertex_count, face_count = (int(word) for word in rest[:2])
    except ValueError:
        refuse(f"{file}, line {number}", "no numbers of vertices and faces", _AGAIN)
    if not (0 <= vertex_count and 0 <= face_count):
        refuse(f"{file}, line {number}", "a number of vertices or faces is negative", _AGAIN)
    if len(lines) < vertex_count + face_count:
        refuse(
            file,
            f"it is cut off: it announces {vertex_count} vertices and {face_count} faces, and has "
            f"{len(lines)} lines of them",
            _AGAIN,
        )
    points = [_numbers(f"{file}, line {n}", line.split(), least=3)[:3] for n, line in lines[:vertex_count]]
    polygons = [
        _off_face(f"{file}, line {n}", line.split())
        for n, line in lines[vertex_count : vertex_count + face_count]
    ]
    scene = Scene()
    if len(lines) > vertex_count + face_count:
        scene.notes.append(f"left out: {len(lines) - vertex_count - face_count} line(s) after the last face")
    vertices = np.array(points, dtype=float).reshape(-1, 3)
    if polygons:
        scene.bodies.append(body_of(file, vertices, triangulated(file, vertices, polygons)))
    return scene


def _off_face(where: str, words: Sequence[str]) -> list[int]:
    """Vertex numbers; what follows them is colour."""
    try:
        size = int(words[0])
        numbers = [int(word) for word in words[1 : 1 + size]]
    except ValueError:
        _refuse_line(where, words, "a face")
    if len(numbers) < max(size, 3):
        refuse(where, f"a face of {size} corners has {len(numbers)}", _AGAIN)
    return numbers


def _lines(text: str) -> list[tuple[int, str]]:
    """Lines that say something, with their numbers; comments are cut off."""
    cut = ((number, line.partition("#")[0].strip()) for number, line in enumerate(text.splitlines(), start=1))
    return [(number, line) for number, line in cut if line]


def _numbers(where: str, words: Sequence[str], *, least: int) -> list[float]:
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        _refuse_line(where, words, "a vertex")
    if len(numbers) < least:
        refuse(where, f"a vertex has {len(numbers)} coordinate(s)", _AGAIN)
    return numbers


def _refuse_line(where: str, words: Sequence[str], what: str) -> NoReturn:
    refuse(where, f"{' '.join(words)[:40]!r} is not {what}", _AGAIN)
