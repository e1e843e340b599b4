"""Models as JSON: the `palpate-model` document, version 1."""

from __future__ import annotations

import json
import math
from typing import Any, NoReturn, cast

import numpy as np

from palpate._core import Model
from palpate.contacts.entry import mm_per, refuse, shortest_degrees

SCHEMA = "palpate-model"
VERSION = 1

_OUTLINE_KEYS = ("outer", "holes")
_LOOSE_KEYS = ("segments", "seams")
_SPACE_KEYS = ("vertices", "faces", "seams")
# What a document must have one of, and which keys go with it.
_KINDS = {"outer": _OUTLINE_KEYS, "segments": _LOOSE_KEYS, "faces": _SPACE_KEYS}
_COMMON_KEYS = (
    "schema",
    "version",
    "name",
    "unit",
    "note",
    "untouchable",
    "position_slack",
    "normal_slack_deg",
)
_KEYS = tuple(dict.fromkeys((*_COMMON_KEYS, *_OUTLINE_KEYS, *_LOOSE_KEYS, *_SPACE_KEYS)))

Points = list[list[float]]


def parse_model(name: str, text: str, *, mm_per_unit: float) -> dict[str, Any]:
    """The constructor's arguments in a file called `name`, lengths converted to a unit of `mm_per_unit`."""
    try:
        document = json.loads(text, parse_constant=lambda constant: _refuse_constant(name, constant))
    except json.JSONDecodeError as error:
        refuse(f"{name}, line {error.lineno}", f"not JSON: {error.msg}", "mend it, or give another format")
    except RecursionError:
        refuse(name, "its brackets are nested too deeply", "write it anew with save_model")
    top = _checked_top(name, document)
    scale = mm_per(str(top["unit"]), f"{name}: unit") / mm_per_unit
    arguments: dict[str, Any] = {
        "name": str(top["name"]),
        "untouchable": _numbers(f"{name}: untouchable", top.get("untouchable", [])),
        "position_slack": scale * _number(f"{name}: position_slack", top.get("position_slack", 0.0)),
        "normal_slack": math.radians(_number(f"{name}: normal_slack_deg", top.get("normal_slack_deg", 0.0))),
    }
    if "outer" in top:
        arguments["outer"] = _points(f"{name}: outer", top["outer"], scale)
        holes = _list(f"{name}: holes", top.get("holes", []))
        arguments["holes"] = [_points(f"{name}: holes[{k}]", hole, scale) for k, hole in enumerate(holes)]
    elif "faces" in top:
        arguments["faces"] = _loops_by_number(name, top, scale)
        arguments["seams"] = _numbers(f"{name}: seams", top.get("seams", []))
    else:
        segments = _list(f"{name}: segments", top["segments"])
        arguments["segments"] = np.array(
            [_segment(f"{name}: segments[{k}]", segment, scale) for k, segment in enumerate(segments)]
        ).reshape(-1, 2, 2)
        arguments["seams"] = _numbers(f"{name}: seams", top.get("seams", []))
    return arguments


def document_of(model: Model, unit: str) -> dict[str, Any]:
    """The document that `parse_model` reads as `model`."""
    faces = [np.asarray(face).tolist() for face in model.faces]
    surfaces = list(model.face_surfaces)
    document: dict[str, Any] = {"schema": SCHEMA, "version": VERSION, "name": model.name, "unit": unit}
    if model.dimension == 3:
        document["vertices"] = model.vertices.tolist()
        numbers = {tuple(vertex): k for k, vertex in enumerate(document["vertices"])}
        document["faces"] = [
            [[numbers[tuple(corner)] for corner in loop.tolist()] for loop in loops]
            for loops in model.face_loops
        ]
    elif model.closed:
        document["outer"], *document["holes"] = _loops(faces)
    else:
        document["segments"] = faces
    if "outer" not in document:
        document["seams"] = [k for k, surface in enumerate(surfaces) if surface == "seam"]
    document["untouchable"] = [k for k, surface in enumerate(surfaces) if surface == "untouchable"]
    document["position_slack"] = model.position_slack
    document["normal_slack_deg"] = shortest_degrees(model.normal_slack)
    return document


def text_of(document: dict[str, Any]) -> str:
    """The document as text, a key to a line: files of solids stay small, and lines can be compared."""
    lines = (f" {json.dumps(key)}: {json.dumps(value)}" for key, value in document.items())
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _loops(faces: list[Points]) -> list[Points]:
    """The corners of each loop; a loop ends with the face that comes back to its first corner."""
    loops: list[Points] = []
    corners: Points = []
    for start, end in faces:
        corners.append(start)
        if end == corners[0]:
            loops.append(corners)
            corners = []
    return loops


def _checked_top(name: str, document: Any) -> dict[str, Any]:
    if not isinstance(document, dict):
        refuse(name, f"{_brief(document)} is not an object", f'write {{"schema": "{SCHEMA}", ...}}')
    top = cast(dict[str, Any], document)
    if top.get("schema") != SCHEMA:
        refuse(
            f"{name}: schema", f"{_brief(top.get('schema'))} is not {SCHEMA!r}", f'say "schema": "{SCHEMA}"'
        )
    if top.get("version") != VERSION:
        refuse(
            f"{name}: version",
            f"{_brief(top.get('version'))} can't be read here",
            f'say "version": {VERSION}',
        )
    for key in top:
        if key not in _KEYS:
            refuse(f"{name}: {key}", "unknown key", f"the keys here are {', '.join(_KEYS)}")
    for key, example in (("name", '"bracket"'), ("unit", '"mm"')):
        if key not in top:
            refuse(f"{name}: {key}", "is missing", f'say, for example, "{key}": {example}')
        if not isinstance(top.get(key), str):
            refuse(
                f"{name}: {key}",
                f"{_brief(top.get(key))} is not text",
                f'say, for example, "{key}": {example}',
            )
    kinds = [kind for kind in _KINDS if kind in top]
    if len(kinds) != 1:
        refuse(
            name,
            "must have either outer or segments, or faces in space",
            "give the outline as outer, loose faces as segments, a solid as vertices and faces",
        )
    own = _KINDS[kinds[0]]
    for key in top:
        if key not in (*_COMMON_KEYS, *own):
            rest = ", ".join(other for other in own if other != kinds[0])
            refuse(f"{name}: {key}", f"does not go with {kinds[0]}", f"with it go {rest}")
    return top


def _points(where: str, value: Any, scale: float, *, dimension: int = 2) -> Any:
    given = enumerate(_list(where, value))
    points = [_point(f"{where}[{k}]", point, scale, dimension=dimension) for k, point in given]
    return np.array(points, dtype=float).reshape(-1, dimension)


def _loops_by_number(name: str, top: dict[str, Any], scale: float) -> list[list[Any]]:
    """The loops of each face, whose corners are given by numbers of vertices."""
    if "vertices" not in top:
        refuse(f"{name}: vertices", "is missing", "give the corners, to which faces refer by number")
    vertices = _points(f"{name}: vertices", top["vertices"], scale, dimension=3)
    faces: list[list[Any]] = []
    for k, face in enumerate(_list(f"{name}: faces", top["faces"])):
        faces.append([])
        for j, loop in enumerate(_list(f"{name}: faces[{k}]", face)):
            where = f"{name}: faces[{k}][{j}]"
            corners = _numbers(where, loop, "vertices")
            if corners and max(corners) >= len(vertices):
                number_from_0 = f"number the {len(vertices)} vertices from 0"
                refuse(where, f"there is no vertex {max(corners)}", number_from_0)
            faces[-1].append(vertices[np.array(corners, dtype=int)])
    return faces


def _segment(where: str, value: Any, scale: float) -> Points:
    ends = _list(where, value)
    if len(ends) != 2:
        refuse(where, f"{_brief(value)} is not a pair of points", "write [[x, y], [x, y]]")
    return [_point(f"{where}[{k}]", point, scale) for k, point in enumerate(ends)]


def _point(where: str, value: Any, scale: float, *, dimension: int = 2) -> list[float]:
    if not isinstance(value, list) or len(cast(list[Any], value)) != dimension:
        form = "[x, y]" if dimension == 2 else "[x, y, z]"
        refuse(where, f"{_brief(value)} is not a point", f"write {form}")
    return [scale * _number(where, coordinate) for coordinate in cast(list[Any], value)]


def _number(where: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e300:
        refuse(where, f"{_brief(value)} is not a finite number", "write a number")
    return float(value)


def _numbers(where: str, value: Any, of: str = "faces") -> list[int]:
    for k, number in enumerate(_list(where, value)):
        if isinstance(number, bool) or not isinstance(number, int) or number < 0:
            kind = "face" if of == "faces" else "vertex"
            refuse(f"{where}[{k}]", f"{_brief(number)} is not a {kind} number", f"number the {of} from 0")
    return cast(list[int], value)


def _list(where: str, value: Any) -> list[Any]:
    if not isinstance(value, list):
        refuse(where, f"{_brief(value)} is not a list", "write [...]")
    return cast(list[Any], value)


def _refuse_constant(name: str, constant: str) -> NoReturn:
    refuse(name, f"{constant} is not a finite number", "write finite numbers")


def _brief(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
