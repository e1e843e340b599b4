"""Contacts as JSON: the `palpate-contacts` document, version 1."""

from __future__ import annotations

import json
import sys
from typing import Any, NoReturn, cast

from palpate.contacts.entry import SCALARS, Entry, Point, PriorEntry, Sheet, refuse

SCHEMA = "palpate-contacts"
VERSION = 1

CONTACT_POINTS = ("center", "normal", "approach", "start")
CONTACT_KEYS = (*CONTACT_POINTS, "position_error", "normal_error_deg", "tip_radius")
MISS_POINTS = ("start", "end")
MISS_KEYS = (*MISS_POINTS, "tip_radius", "path_error", "position_error")
PRIOR_KEYS = ("world_from_model", "translation", "rotation_deg")
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
    return Sheet(
        unit,
        [_entry(*item, CONTACT_KEYS) for item in _items(name, top, "contacts")],
        [_entry(*item, MISS_KEYS) for item in _items(name, top, "misses")],
        _prior(f"{name}: prior", top["prior"]) if top.get("prior") is not None else None,
    )


def document_of(sheet: Sheet) -> dict[str, Any]:
    """The document that `parse_json` reads as `sheet`."""
    document: dict[str, Any] = {"schema": SCHEMA, "version": VERSION, "unit": sheet.unit}
    document["contacts"] = [_flat(entry) for entry in sheet.contacts]
    document["misses"] = [_flat(entry) for entry in sheet.misses]
    if sheet.prior is not None:
        document["prior"] = {key: getattr(sheet.prior, key) for key in PRIOR_KEYS}
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
            refuse(f"{where}: {key}", "absent", "give it as [x, y]")
    points = {key: _point(f"{where}: {key}", found[key]) for key in found if key not in SCALARS}
    scalars = {key: _number(f"{where}: {key}", found[key]) for key in found if key in SCALARS}
    return Entry(where, points, scalars)


def _prior(where: str, value: Any) -> PriorEntry:
    found = _object(where, value, PRIOR_KEYS)
    for key in PRIOR_KEYS:
        if key not in found:
            refuse(f"{where}: {key}", "absent", "a prior has " + ", ".join(PRIOR_KEYS))
    rows = found["world_from_model"]
    pose_at = f"{where}: world_from_model"
    if not isinstance(rows, list) or len(cast(list[Any], rows)) != 3:
        refuse(pose_at, f"{_brief(rows)} is not a 3 by 3 matrix", "give three rows of three numbers")
    pose = [_row(pose_at, row) for row in cast(list[Any], rows)]
    translation = _number(f"{where}: translation", found["translation"])
    return PriorEntry(where, pose, translation, _number(f"{where}: rotation_deg", found["rotation_deg"]))


def _row(where: str, value: Any) -> list[float]:
    if not isinstance(value, list) or len(cast(list[Any], value)) != 3:
        refuse(where, f"{_brief(value)} is not a row of three numbers", "give three rows of three numbers")
    return [_number(where, number) for number in cast(list[Any], value)]


def _point(where: str, value: Any) -> Point:
    if isinstance(value, list) and len(cast(list[Any], value)) == 3:
        refuse(where, f"{_brief(value)} is in space, which is not supported yet", "give [x, y]")
    if not isinstance(value, list) or len(cast(list[Any], value)) != 2:
        refuse(where, f"{_brief(value)} is not a point", "give [x, y]")
    x, y = cast(list[Any], value)
    return _number(where, x), _number(where, y)


def _number(where: str, value: Any) -> float:
    # An integer in JSON can be too large for a float, hence the comparison and not isfinite.
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
        refuse(where, f"{_brief(value)} is not a finite number", "write a number")
    return float(value)


def _brief(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "..."
