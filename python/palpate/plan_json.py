"""Sensors, paths and ambiguity trees as JSON; the schemas are `schemas/plan-1.json` and `tree-1.json`."""

from __future__ import annotations

import json
import math
from typing import Any

from palpate._core import (
    AmbiguityBranch,
    AmbiguityNode,
    AmbiguityTree,
    Outcome,
    Path,
    PlanReport,
    Sensor,
    Touch,
)
from palpate.probe.simulated import stem_entry


def _degrees(angle: float) -> float:
    """Of radians that were degrees: without the rounding of both ways."""
    return round(math.degrees(angle), 12)


def sensor_entry(sensor: Sensor) -> dict[str, Any]:
    """A sensor, its angles in degrees."""
    return {
        "position_error": sensor.position_error,
        "normal_error_deg": None if sensor.normal_error is None else _degrees(sensor.normal_error),
        "max_incidence_deg": _degrees(sensor.max_incidence),
        "tip_radius": sensor.tip_radius,
        "path_error": sensor.path_error,
        **stem_entry(sensor),
    }


def path_entry(path: Path) -> dict[str, Any]:
    """All that there is to say of a path. Hypotheses are numbered from 0."""
    direction = path.direction
    in_plane = len(direction) == 2
    return {
        "start": path.start.tolist(),
        "direction": direction.tolist(),
        **({"angle_deg": math.degrees(math.atan2(direction[1], direction[0]))} if in_plane else {}),
        "length": path.length,
        "margin": path.margin,
        "score": path.score,
        "expected_score": path.expected_score,
        "guaranteed": path.guaranteed,
        "members": path.members,
        "classes": path.classes,
        "no_contact": path.no_contact,
        "outcomes": [_outcome(outcome) for outcome in path.outcomes],
    }


def report_entries(report: PlanReport) -> dict[str, Any]:
    """A planner's answer."""
    return {
        "path": None if report.path is None else path_entry(report.path),
        "why": report.why,
        "proved": report.proved,
        "bound": report.bound,
        "num_judged": report.num_judged,
        "num_boxes": report.num_boxes,
        "counters": report.counters,
    }


def tree_document(tree: AmbiguityTree, *, unit: str | None = None) -> dict[str, Any]:
    """The `palpate-tree` document of a tree."""
    return {
        "schema": "palpate-tree",
        "version": 1,
        "unit": unit,
        "method": tree.method,
        "names": tree.names,
        "expected_touches": tree.expected_touches,
        "worst_touches": tree.worst_touches,
        "max_outcomes": tree.max_outcomes,
        "entropy_bound": tree.entropy_bound,
        "worst_bound": tree.worst_bound,
        "lower_bound": tree.lower_bound,
        "identified": tree.identified,
        "solved": tree.solved,
        "nodes": [_node(node) for node in tree.nodes],
    }


def tree_json(tree: AmbiguityTree, unit: str | None = None) -> str:
    """That document as text."""
    if unit is not None:
        from palpate.contacts.entry import mm_per

        mm_per(str(unit), "unit")
    return json.dumps(tree_document(tree, unit=unit), indent=2, allow_nan=False)


def _outcome(outcome: Outcome) -> dict[str, Any]:
    return {
        "hypothesis": outcome.hypothesis,
        "touches": [_touch(touch) for touch in outcome.touches],
        "may_miss": outcome.may_miss,
    }


def _touch(touch: Touch) -> dict[str, Any]:
    axis, angle = touch.normal_cap
    in_space = {"normal_axis": axis.tolist(), "normal_angle_deg": math.degrees(angle)}
    in_plane = len(axis) == 2
    return {
        "feature": list(touch.feature),
        "depth": list(touch.depth),
        **({"normals_deg": [math.degrees(end) for end in touch.normals]} if in_plane else in_space),
    }


def _node(node: AmbiguityNode) -> dict[str, Any]:
    return {
        "number": node.number,
        "members": node.members,
        "level": node.level,
        "status": node.status,
        "path": None if node.path is None else path_entry(node.path),
        "branches": [_branch(branch) for branch in node.branches],
    }


def _branch(branch: AmbiguityBranch) -> dict[str, Any]:
    return {
        "answers": branch.answers,
        "members": branch.members,
        "node": None if branch.node is None else branch.node.number,
    }
