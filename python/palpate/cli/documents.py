"""Results as JSON documents; the schemas are in `palpate/schemas`."""

from __future__ import annotations

import itertools
import json
import math
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from palpate import Found, Hypothesis, Interpretation, Model, Recognition
from palpate.rotations import vector_of


def print_document(document: dict[str, Any]) -> None:
    """`document` on stdout; a number that JSON can't hold is our mistake, hence an error."""
    sys.stdout.write(json.dumps(document, indent=2, allow_nan=False) + "\n")


def planar(pose: Any) -> tuple[float, float, float]:
    """x, y and the angle in degrees, -180 to 180, of a 3 by 3 pose."""
    matrix = np.asarray(pose, dtype=float)
    return float(matrix[0, 2]), float(matrix[1, 2]), math.degrees(math.atan2(matrix[1, 0], matrix[0, 0]))


def components(pose: Any) -> dict[str, float]:
    """A pose as people read it: `x, y, angle_deg`; in space `x, y, z` and the vector `rx_deg, ...`."""
    matrix = np.asarray(pose, dtype=float)
    if len(matrix) == 3:
        return dict(zip(("x", "y", "angle_deg"), planar(matrix), strict=True))
    turn = np.degrees(vector_of(matrix[:3, :3]))
    names = ("x", "y", "z", "rx_deg", "ry_deg", "rz_deg")
    return {name: float(value) for name, value in zip(names, [*matrix[:3, 3], *turn], strict=True)}


def excursion_bound(hypothesis: Hypothesis) -> float:
    """No two poses of the hypothesis move any vertex of its model further apart."""
    return max(hypothesis.poses.excursion(vertex) for vertex in hypothesis.model.vertices)


def hypothesis_count(found: Recognition | Found) -> int:
    """How many were found: more than are returned, where there are more than were asked for."""
    return sum(counters["hypotheses"] for counters in found.counters)


def recognition_document(
    found: Recognition | Found,
    models: Sequence[Model],
    *,
    num_contacts: int,
    unit: str,
    num_listed: int = 0,
    stats: bool = False,
) -> dict[str, Any]:
    """The `palpate-recognition` document; with up to `num_listed` interpretations of each hypothesis."""
    document: dict[str, Any] = {
        "schema": "palpate-recognition",
        "version": 1,
        "unit": unit,
        "models": [model.name for model in models],
        "readings": [_reading(model) for model in models],
        "contact_count": num_contacts,
        "complete": found.complete,
        "stopped_by": found.stopped_by,
        "hypothesis_count": hypothesis_count(found),
        "interpretation_count": found.interpretation_count,
        "interpretation_count_exact": found.interpretation_count_exact,
        "conflict": found.conflict,
        "hypotheses": [_hypothesis(h, num_listed=num_listed) for h in found.hypotheses],
    }
    if stats:
        document["counters"] = [dict(counters) for counters in found.counters]
    return document


def models_document(models: Sequence[Model], *, unit: str) -> dict[str, Any]:
    """The `palpate-model-report` document."""
    return {
        "schema": "palpate-model-report",
        "version": 1,
        "unit": unit,
        "models": [_model(model) for model in models],
    }


def _reading(model: Model) -> dict[str, Any]:
    """What reading a model changed, and what that costs."""
    return {
        "position_slack": model.position_slack,
        "normal_slack_deg": math.degrees(model.normal_slack),
        "mends": list(model.mends),
    }


def _hypothesis(hypothesis: Hypothesis, *, num_listed: int) -> dict[str, Any]:
    document: dict[str, Any] = {
        "model": hypothesis.model.name,
        "model_number": hypothesis.model_number,
        "marginal": hypothesis.marginal,
        "proved": hypothesis.proved,
        "interpretation_count": hypothesis.interpretation_count,
        "interpretation_count_exact": hypothesis.interpretation_count_exact,
        "world_from_model": _rows(hypothesis.world_from_model),
        **components(hypothesis.world_from_model),
        "rotation_bound_deg": math.degrees(hypothesis.poses.rotation_bound),
        "excursion_bound": excursion_bound(hypothesis),
    }
    if num_listed:
        listed = itertools.islice(hypothesis.interpretations, num_listed)
        document["interpretations"] = [_interpretation(interpretation) for interpretation in listed]
    return document


def _interpretation(interpretation: Interpretation) -> dict[str, Any]:
    return {
        "assignment": [[kind, int(index)] for kind, index in interpretation.assignment],
        "marginal": interpretation.marginal,
        "world_from_model": _rows(interpretation.world_from_model),
    }


def _model(model: Model) -> dict[str, Any]:
    faces = [
        {**_bounds(loops), "normal": _rows(normal), "surface": surface}
        for loops, normal, surface in zip(
            model.face_loops, model.face_normals, model.face_surfaces, strict=True
        )
    ]
    vertices = [
        {"point": _rows(vertex), "touchable": bool(touchable)}
        for vertex, touchable in zip(model.vertices, model.touchable_vertices, strict=True)
    ]
    return {
        "name": model.name,
        "dimension": model.dimension,
        "closed": model.closed,
        "size": model.size,
        "faces": faces,
        "vertices": vertices,
        "symmetries": _rows(model.symmetries),
        **(_of_space(model) if model.dimension == 3 else {}),
        **_reading(model),
    }


def _bounds(loops: Sequence[Any]) -> dict[str, Any]:
    """What bounds a face: two ends in the plane, loops in space."""
    if len(loops[0]) == 2:
        return {"start": _rows(loops[0][0]), "end": _rows(loops[0][1])}
    return {"loops": [_rows(loop) for loop in loops]}


def _of_space(model: Model) -> dict[str, Any]:
    edges = [
        {"start": _rows(start), "end": _rows(end), "touchable": bool(touchable)}
        for (start, end), touchable in zip(model.edges, model.touchable_edges, strict=True)
    ]
    axes = [{"point": _rows(point), "direction": _rows(along)} for point, along in model.symmetry_axes]
    return {"edges": edges, "symmetry_axes": axes}


def _rows(array: Any) -> Any:
    return np.asarray(array, dtype=float).tolist()
