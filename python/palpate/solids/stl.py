"""STL: triangles and nothing else; binary or text. Its numbers have no unit."""

from __future__ import annotations

import re
from typing import NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.solids.mesh import Scene, body_of, check_count

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER = 84

# The words of a facet, and where its nine coordinates are among them.
_WORDS = "facet normal . . . outer loop vertex . . . vertex . . . vertex . . . endloop endfacet".split()
_KEYWORDS = [k for k, word in enumerate(_WORDS) if word != "."]
_COORDINATES = [k for k, word in enumerate(_WORDS) if word == "."][3:]


def read_stl(file: str, data: bytes) -> Scene:
    """The bodies of an STL file; normals are those of the triangles, whatever the file says of them."""
    if len(data) >= _HEADER:
        count = int.from_bytes(data[80:84], "little")
        size = _HEADER + _TRIANGLE.itemsize * count
        # Many binary files begin with the word that text begins with: their length tells.
        if len(data) == size or (len(data) > size > _HEADER and b"\0" in data):
            return _read_binary(file, data, count)
    if b"\0" not in data and data.lstrip(b"\xef\xbb\xbf \t\r\n")[:5].lower() == b"solid":
        return _read_text(file, data.decode("utf-8-sig", errors="replace"))
    if len(data) >= _HEADER and b"\0" in data:
        there = (len(data) - _HEADER) // _TRIANGLE.itemsize
        refuse(
            file,
            f"it is cut off, or no STL: it announces {count} triangles and has {there}",
            "export or copy it again",
        )
    refuse(file, "not a readable STL file: neither binary nor text", "export it again as STL")


def _read_binary(file: str, data: bytes, count: int) -> Scene:
    check_count(file, count)
    triangles = np.frombuffer(data, dtype=_TRIANGLE, count=count, offset=_HEADER)
    scene = Scene()
    left = len(data) - _HEADER - _TRIANGLE.itemsize * count
    if left:
        scene.notes.append(f"left out: {left} byte(s) after the last triangle")
    if count:
        scene.bodies.append(body_of(file, triangles["corners"], np.arange(3 * count).reshape(-1, 3)))
    return scene


def _read_text(file: str, text: str) -> Scene:
    *solids, rest = re.split(r"(?im)^[ \t]*endsolid\b.*$", text)
    if rest.strip():
        line = text.count("\n", 0, len(text) - len(rest)) + 1
        refuse(file, f"it is cut off: the solid at line {line} has no end", "export or copy it again")
    scene = Scene()
    line = 1
    for solid in solids:
        begun = re.match(r"(?i)\s*solid\b([^\n]*)", solid)
        if begun is None:
            refuse(f"{file}, line {line}", "a solid ends that has not begun", "export or copy it again")
        corners = _corners(file, solid[begun.end() :], line + solid.count("\n", 0, begun.end()))
        if len(corners):
            numbers = np.arange(len(corners)).reshape(-1, 3)
            scene.bodies.append(body_of(file, corners, numbers, name=begun[1].strip()))
        line += solid.count("\n")
    return scene


def _corners(file: str, text: str, line: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Corners of the facets in a solid that begins at `line`, shape `(3 m, 3)`."""
    words = np.array(text.lower().split())
    width = len(_WORDS)
    whole = words[: len(words) // width * width].reshape(-1, width)
    check_count(file, len(whole))
    right = np.all(whole[:, _KEYWORDS] == np.array(_WORDS)[_KEYWORDS], axis=1)
    if not np.all(right) or whole.size < words.size:
        at = len(whole) if np.all(right) else int(np.argmin(right))
        _refuse_facet(file, text, at, line)
    try:
        return whole[:, _COORDINATES].astype(float).reshape(-1, 3)
    except ValueError:
        bad = next(k for k, row in enumerate(whole[:, _COORDINATES]) if not all(map(_is_number, row)))
        _refuse_facet(file, text, bad, line)


def _refuse_facet(file: str, text: str, facet: int, line: int) -> NoReturn:  # noqa: PLR0917
    begins = [match.start() for match in re.finditer(r"(?i)\bfacet\b", text)]
    line += text.count("\n", 0, begins[min(facet, len(begins) - 1)] if begins else 0)
    refuse(f"{file}, line {line}", "not a facet with three corners", "export or copy the file again")


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
