"""What an event of a log may look like: that much of JSON Schema as `schemas/run-1.json` is written in."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

Node = dict[str, Any]

KINDS: dict[str, type | tuple[type, ...]] = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "number": (int, float),
    "integer": int,
    "null": type(None),
}
LARGEST = 1e300  # a number beyond is none that a computation can begin with


@dataclass(frozen=True)
class _Problem:
    """What is wrong, and where."""

    where: tuple[str, ...]
    what: str
    names: float = math.inf
    """How many of the names that the value gives itself, `event` and `kind`, are right; all: ∞."""


def problem_of(event: Any) -> str | None:
    """What is wrong with an event, in one line; None: it is of the schema. Models have their own reader."""
    problem = _problem(event, _schema(), ())
    if problem is None:
        return None
    return f"{'.'.join(problem.where).replace('.[', '[')}: {problem.what}".removeprefix(": ")


@cache
def _schema() -> Node:
    schema: Node = json.loads(files("palpate").joinpath("schemas").joinpath("run-1.json").read_text("utf-8"))
    return schema


def _problem(value: Any, node: Node, where: tuple[str, ...]) -> _Problem | None:
    if "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        model = {"type": "object"}
        return _problem(value, _schema()["$defs"].get(name, model), where)
    if "oneOf" in node:
        return _of_choices(value, node["oneOf"], where)
    if "const" in node or "enum" in node:
        choices = node.get("enum", [node.get("const")])
        if any(type(value) is type(choice) and value == choice for choice in choices):
            return None
        return _Problem(where, f"must be {' or '.join(map(repr, choices))} (got {_brief(value)})")
    kind = node["type"]
    if not isinstance(value, KINDS[kind]) or (isinstance(value, bool) and kind != "boolean"):
        return _Problem(where, f"must be of the type {kind} (got {_brief(value)})")
    if isinstance(value, dict):
        return _of_object(value, node, where)
    if isinstance(value, list):
        return _of_array(value, node, where)
    if isinstance(value, int | float) and kind != "boolean":
        return _of_number(value, node, where)
    return None


def _of_choices(value: Any, choices: list[Node], where: tuple[str, ...]) -> _Problem | None:
    """Of the choice that fits best: where the value calls itself so, then where the problem is deepest."""
    problems: list[_Problem] = []
    for choice in choices:
        problem = _problem(value, choice, where)
        if problem is None:
            return None
        problems.append(problem)
    return max(problems, key=lambda problem: (problem.names, len(problem.where)))


def _of_object(value: Node, node: Node, where: tuple[str, ...]) -> _Problem | None:
    known = node.get("properties", {})
    own_names = [name for name in known if "const" in known[name] and name in value]
    for k, name in enumerate(own_names):
        problem = _problem(value[name], known[name], (*where, name))
        if problem is not None:
            return _Problem(problem.where, problem.what, names=k)
    for name in node.get("required", ()):
        if name not in value:
            return _Problem((*where, name), "is missing")
    for name, member in value.items():
        if name in known:
            problem = _problem(member, known[name], (*where, name))
            if problem is not None:
                return problem
        elif node.get("additionalProperties") is False:
            return _Problem((*where, _brief(name)), "is unknown")
    return None


def _of_array(value: list[Any], node: Node, where: tuple[str, ...]) -> _Problem | None:
    if not node.get("minItems", 0) <= len(value) <= node.get("maxItems", len(value)):
        few, many = node["minItems"], node["maxItems"]
        return _Problem(where, f"has {len(value)} members, not {few if few == many else f'{few} to {many}'}")
    first = node.get("prefixItems", [])
    for k, member in enumerate(value):
        problem = _problem(member, first[k] if k < len(first) else node["items"], (*where, f"[{k}]"))
        if problem is not None:
            return problem
    return None


def _of_number(value: float, node: Node, where: tuple[str, ...]) -> _Problem | None:
    low: Any = node.get("minimum", node.get("exclusiveMinimum", -math.inf))
    if not abs(value) < LARGEST:
        return _Problem(where, f"must be finite (got {_brief(value)})")
    if value < low or ("exclusiveMinimum" in node and value == low):
        return _Problem(where, f"must be {low} or more (got {_brief(value)})")
    return None


def _brief(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:59] + "…"
