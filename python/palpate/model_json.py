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
_KEYS = (*_COMMON_KEYS, *_OUTLINE_KEYS, *_LOOSE_KEYS)

Points = list[list[float]]


def parse_model(name: str, text: str, *, mm_per_unit: float) -> dict[str, Any]:
    """The constructor's arguments in a file called `name`, lengths converted to a unit of `mm_per_unit`."""
    try:
        document = json.loads(text, parse_constant=lambda constant: _refuse_constant(name, constant))
    except json.JSONDecodeError as error:
        refuse(f"{name}, line {error.lineno}", f"not JSON: {error.msg}", "mend it, or give DXF or SVG")
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
    else:
        segments = _list(f"{name}: segments", top["segments"])
        arguments["segments"] = np.array(
            [_segment(f"{name}: segments[{k}]", segment, scale) for k, segment in enumerate(segments)]
        ).reshape(-1, 2, 2)
        arguments["seams"] = _numbers(f"{name}: seams", top.get("seams", []))
    return arguments


def document_of(model: Model, unit: str) -> dict[str, Any]:
    """The document that `parse_model` reads as `model`."""
    if model.dimension != 2:
        refuse(
            "model", f"{model.name!r} is of space; JSON holds the plane only", "keep the file it came from"
        )
    faces = [np.asarray(face).tolist() for face in model.faces]
    surfaces = list(model.face_surfaces)
    document: dict[str, Any] = {"schema": SCHEMA, "version": VERSION, "name": model.name, "unit": unit}
    if model.closed:
        document["outer"], *document["holes"] = _loops(faces)
    else:
        document["segments"] = faces
        document["seams"] = [k for k, surface in enumerate(surfaces) if surface == "seam"]
    document["untouchable"] = [k for k, surface in enumerate(surfaces) if surface == "untouchable"]
    document["position_slack"] = model.position_slack
    document["normal_slack_deg"] = shortest_degrees(model.normal_slack)
    return document


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
    if ("outer" in top) == ("segments" in top):
        refuse(
            name,
            "must have either outer or segments",
            "give the outline as outer, or loose faces as segments",
        )
    stray = [key for key in (_LOOSE_KEYS if "outer" in top else _OUTLINE_KEYS) if key in top]
    if stray:
        refuse(f"{name}: {stray[0]}", "does not go with the rest", "holes go with outer, seams with segments")
    return top


def _points(where: str, value: Any, scale: float) -> Any:
    points = [_point(f"{where}[{k}]", point, scale) for k, point in enumerate(_list(where, value))]
    return np.array(points, dtype=float).reshape(-1, 2)


def _segment(where: str, value: Any, scale: float) -> Points:
    ends = _list(where, value)
    if len(ends) != 2:
        refuse(where, f"{_brief(value)} is not a pair of points", "write [[x, y], [x, y]]")
    return [_point(f"{where}[{k}]", point, scale) for k, point in enumerate(ends)]


def _point(where: str, value: Any, scale: float) -> list[float]:
    if not isinstance(value, list) or len(cast(list[Any], value)) != 2:
        refuse(where, f"{_brief(value)} is not a point", "write [x, y]")
    return [scale * _number(where, coordinate) for coordinate in cast(list[Any], value)]


def _number(where: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e300:
        refuse(where, f"{_brief(value)} is not a finite number", "write a number")
    return float(value)


def _numbers(where: str, value: Any) -> list[int]:
    for k, number in enumerate(_list(where, value)):
        if isinstance(number, bool) or not isinstance(number, int) or number < 0:
            refuse(f"{where}[{k}]", f"{_brief(number)} is not a face number", "number the faces from 0")
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
