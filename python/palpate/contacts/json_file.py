"""Contacts as JSON: the `palpate-contacts` document, version 1."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any, NoReturn, cast

from palpate.contacts.entry import (
    SCALARS,
    Entry,
    Lying,
    Point,
    PriorEntry,
    Sheet,
    check_dimension,
    refuse,
)

SCHEMA = "palpate-contacts"
VERSION = 1

CONTACT_POINTS = ("center", "normal", "approach", "start")
CONTACT_KEYS = (*CONTACT_POINTS, "position_error", "normal_error_deg", "tip_radius")
MISS_POINTS = ("start", "end")
MISS_KEYS = (*MISS_POINTS, "tip_radius", "path_error", "position_error")
PRIOR_KEYS = ("world_from_model", "translation", "rotation_deg")
LYING_KEYS = ("height", "tilt_deg", "normal")
LARGEST = sys.float_info.max
TOP_KEYS = ("schema", "version", "unit", "contacts", "misses", "prior")


def parse_json(name: str, text: str) -> Sheet:
    """The sheet of a JSON file called `name`."""
    try:
        document = json.loads(text, parse_constant=lambda constant: _refuse_constant(name, constant))
    except json.JSONDecodeError as error:
        refuse(f"{name}, line {error.lineno}", f"not JSON: {error.msg}", "mend it, or write CSV")
    except RecursionError:
        refuse(name, "its brackets are nested too deeply", "write it anew, see the schema")
    top = _object(name, document, TOP_KEYS)
    if top.get("schema") != SCHEMA:
        refuse(f"{name}: schema", f"{top.get('schema')!r} is not {SCHEMA!r}", f'say "schema": "{SCHEMA}"')
    if top.get("version") != VERSION:
        refuse(f"{name}: version", f"{top.get('version')!r} can't be read here", f'say "version": {VERSION}')
    unit = top.get("unit")
    if not isinstance(unit, str):
        refuse(f"{name}: unit", f"{unit!r} is not a unit", 'say, for example, "unit": "mm"')
    sheet = Sheet(
        unit,
        [_entry(*item, CONTACT_KEYS) for item in _items(name, top, "contacts")],
        [_entry(*item, MISS_KEYS) for item in _items(name, top, "misses")],
        _prior(f"{name}: prior", top["prior"]) if top.get("prior") is not None else None,
    )
    check_dimension(_dimensions(sheet), remedy="give all as [x, y], or all as [x, y, z]")
    return sheet


def _dimensions(sheet: Sheet) -> Iterator[tuple[str, int]]:
    """Where a point is, and how many coordinates it has."""
    for entry in (*sheet.contacts, *sheet.misses):
        for key, point in entry.points.items():
            yield f"{entry.where}: {key}", len(point)
    if sheet.prior is not None:
        yield f"{sheet.prior.where}: world_from_model", len(sheet.prior.world_from_model) - 1


def document_of(sheet: Sheet) -> dict[str, Any]:
    """The document that `parse_json` reads as `sheet`."""
    document: dict[str, Any] = {"schema": SCHEMA, "version": VERSION, "unit": sheet.unit}
    document["contacts"] = [_flat(entry) for entry in sheet.contacts]
    document["misses"] = [_flat(entry) for entry in sheet.misses]
    if sheet.prior is not None:
        document["prior"] = {key: getattr(sheet.prior, key) for key in PRIOR_KEYS}
        if sheet.prior.lying is not None:
            document["prior"] |= asdict(sheet.prior.lying) | {"normal": list(sheet.prior.lying.normal)}
    return document


def _flat(entry: Entry) -> dict[str, Any]:
    return {name: list(point) for name, point in entry.points.items()} | dict(entry.scalars)


def _refuse_constant(name: str, constant: str) -> NoReturn:
    refuse(name, f"{constant} is not a finite number", "write finite numbers")


def _object(where: str, value: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    """`value` as an object with none but `keys`: a misspelt key would be evidence silently lost."""
    if not isinstance(value, dict):
        refuse(where, f"{_brief(value)} is not an object", "write {...}")
    found = cast(dict[str, Any], value)
    for key in found:
        if key not in keys:
            refuse(f"{where}: {key}", "unknown key", f"the keys here are {', '.join(keys)}")
    return found


def _items(name: str, top: dict[str, Any], key: str) -> list[tuple[str, Any]]:
    items = top.get(key, [])
    if not isinstance(items, list):
        refuse(f"{name}: {key}", f"{_brief(items)} is not a list", "write [...]")
    return [(f"{name}: {key}[{k}]", item) for k, item in enumerate(cast(list[Any], items))]


def _entry(where: str, value: Any, keys: tuple[str, ...]) -> Entry:
    found = {k: v for k, v in _object(where, value, keys).items() if v is not None}
    required = ("center",) if "center" in keys else MISS_POINTS
    for key in required:
        if key not in found:
            refuse(f"{where}: {key}", "absent", "give it as [x, y], in space as [x, y, z]")
    points = {key: _point(f"{where}: {key}", found[key]) for key in found if key not in SCALARS}
    scalars = {key: _number(f"{where}: {key}", found[key]) for key in found if key in SCALARS}
    return Entry(where, points, scalars)


def _prior(where: str, value: Any) -> PriorEntry:
    found = {k: v for k, v in _object(where, value, (*PRIOR_KEYS, *LYING_KEYS)).items() if v is not None}
    for key in PRIOR_KEYS:
        if key not in found:
            refuse(f"{where}: {key}", "absent", "a prior has " + ", ".join(PRIOR_KEYS))
    rows = found["world_from_model"]
    pose_at = f"{where}: world_from_model"
    if not isinstance(rows, list) or len(cast(list[Any], rows)) not in (3, 4):
        refuse(
            pose_at, f"{_brief(rows)} is not a 3 by 3 matrix", "give three rows of three numbers, or 4 by 4"
        )
    pose = [_row(pose_at, row, len(cast(list[Any], rows))) for row in cast(list[Any], rows)]
    translation, rotation_deg = (_number(f"{where}: {key}", found[key]) for key in PRIOR_KEYS[1:])
    return PriorEntry(where, pose, translation, rotation_deg, _lying(where, found, in_space=len(pose) == 4))


def _lying(where: str, found: dict[str, Any], *, in_space: bool) -> Lying | None:
    """What a prior says of a part that lies on a plane, None if nothing."""
    said = [key for key in LYING_KEYS if key in found]
    if not said:
        return None
    if not in_space:
        refuse(f"{where}: {said[0]}", "is of space, the pose of the plane", "give 4 by 4, or leave it out")
    for key in ("height", "tilt_deg"):
        if key not in found:
            refuse(f"{where}: {key}", f"absent, though there is {said[0]}", "give height and tilt_deg")
    normal_at = f"{where}: normal"
    normal = _point(normal_at, found.get("normal", [0.0, 0.0, 1.0]))
    if len(normal) != 3:
        refuse(normal_at, f"{_brief(found['normal'])} is of the plane", "give it as [x, y, z]")
    height, tilt_deg = (_number(f"{where}: {key}", found[key]) for key in ("height", "tilt_deg"))
    return Lying(height, tilt_deg, normal)


def _row(where: str, value: Any, count: int) -> list[float]:
    if not isinstance(value, list) or len(cast(list[Any], value)) != count:
        problem = f"{_brief(value)} is not a row of {count} numbers"
        refuse(where, problem, f"give {count} rows of {count} numbers")
    return [_number(where, number) for number in cast(list[Any], value)]


def _point(where: str, value: Any) -> Point:
    if not isinstance(value, list) or len(cast(list[Any], value)) not in (2, 3):
        refuse(where, f"{_brief(value)} is not a point", "give [x, y], in space [x, y, z]")
    return tuple(_number(where, coordinate) for coordinate in cast(list[Any], value))


def _number(where: str, value: Any) -> float:
    # An integer in JSON can be too large for a float, hence the comparison and not isfinite.
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
        refuse(where, f"{_brief(value)} is not a finite number", "write a number")
    return float(value)


def _brief(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "..."
