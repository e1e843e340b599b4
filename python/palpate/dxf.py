"""DXF drawings: lines and curves of model space, blocks exploded, as pieces of outlines."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.curves import Array, CurveError, Piece, Tolerance, elliptic_arc, line, spline
from palpate.outlines import Drawing

# Millimetres per unit of $INSUNITS; 0 is "no unit".
_MM_PER_INSUNIT = {
    1: 25.4, 2: 304.8, 3: 1_609_344.0, 4: 1.0, 5: 10.0, 6: 1000.0, 7: 1e6, 8: 2.54e-5, 9: 0.0254, 10: 914.4,
    11: 1e-7, 12: 1e-6, 13: 1e-3, 14: 100.0, 15: 1e4, 16: 1e5,
}  # fmt: skip

_SPLIT = ("LWPOLYLINE", "POLYLINE")


@dataclass
class _Reader:
    scale: float
    tolerance: Tolerance
    pieces: list[Piece] = field(default_factory=list[Piece])
    left_out: Counter[str] = field(default_factory=Counter[str])

    def read(self, entity: Any) -> None:
        kind = entity.dxftype()
        if kind == "INSERT":
            for copy in entity.multi_insert() if entity.mcount > 1 else [entity]:
                self.read_all(copy.virtual_entities())
        elif kind in _SPLIT and not (
            kind == "POLYLINE" and (entity.is_polygon_mesh or entity.is_poly_face_mesh)
        ):
            self.read_all(entity.virtual_entities())
        elif kind == "LINE":
            start, end = entity.dxf.start, entity.dxf.end
            self.pieces.append(line(*((p.x * self.scale, p.y * self.scale) for p in (start, end))))
        elif kind in ("ARC", "CIRCLE", "ELLIPSE"):
            self.read_arc(entity, kind)
        elif kind == "SPLINE":
            self.read_spline(entity)
        else:
            self.left_out[kind] += 1

    def read_all(self, entities: Any) -> None:
        for entity in entities:
            self.read(entity)

    def read_arc(self, entity: Any, kind: str) -> None:
        dxf = entity.dxf
        if kind == "ELLIPSE":
            center, axis_x, axis_y = dxf.center, dxf.major_axis, entity.minor_axis
            start, end = dxf.start_param, dxf.end_param
        else:
            # In its own plane; seen from behind, the axis x is the other way round.
            to_world = entity.ocs().to_wcs
            center, axis_x, axis_y = (
                to_world(dxf.center),
                to_world((dxf.radius, 0, 0)),
                to_world((0, dxf.radius, 0)),
            )
            start, end = (
                math.radians(a) for a in ((0, 360) if kind == "CIRCLE" else (dxf.start_angle, dxf.end_angle))
            )
        if any(abs(axis.z) > 1e-9 * axis.magnitude for axis in (axis_x, axis_y)):
            self.left_out[f"{kind} that is not parallel to the plane"] += 1
            return
        sweep = (end - start) % math.tau
        if sweep < 1e-9:
            sweep = math.tau
        frame = (self.place(center), self.place(axis_x), self.place(axis_y))
        self.pieces.append(elliptic_arc(frame, start, sweep, tolerance=self.tolerance))

    def read_spline(self, entity: Any) -> None:
        tool = entity.construction_tool()
        points = self.scale * np.array([(p.x, p.y) for p in tool.control_points])
        weights = np.array(tool.weights() or [1.0] * len(points), dtype=float)
        if np.any(weights <= 0.0):
            raise CurveError("a SPLINE has a weight that is not positive; draw it with arcs and polylines")
        controls = np.column_stack([points * weights[:, None], weights])
        self.pieces += spline(controls, np.array(tool.knots(), dtype=float), tolerance=self.tolerance)

    def place(self, vector: Any) -> Array:
        return self.scale * np.array([vector.x, vector.y])


def read_dxf(path: Path, *, mm_per_unit: float, unit: str, tolerance: Tolerance) -> Drawing:
    """The lines and curves of a DXF file.

    Args:
        path: The file.
        mm_per_unit: Of the models' unit.
        unit: Its name; taken for the drawing's where the drawing names none.
        tolerance: For curves.

    Raises:
        ValueError: If it is no DXF file, or its unit is not known.
    """
    notes: list[str] = []
    try:
        document = _document(path, notes)
    except Exception as error:  # on damaged files the library raises whatever comes up, assertions included
        _refuse_unreadable(path, error)
    reader = _Reader(_scale(document, path.name, mm_per_unit, unit, notes), tolerance)
    try:
        off = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
        for entity in document.modelspace():
            # Kinds that the library does not know have no attributes at all.
            layer = entity.dxf.layer if entity.dxf.is_supported("layer") else "0"
            if layer.lower() in off:
                reader.left_out[f"{entity.dxftype()} on a hidden layer"] += 1
            else:
                reader.read(entity)
    except CurveError:
        raise
    except RecursionError:
        refuse(path.name, "its blocks contain each other", "explode the blocks in the CAD program")
    except Exception as error:
        _refuse_unreadable(path, error)
    notes += [f"left out: {count} {kind}" for kind, count in sorted(reader.left_out.items())]
    return Drawing(reader.pieces, notes)


def _document(path: Path, notes: list[str]) -> Any:
    import ezdxf
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFStructureError

    try:
        return ezdxf.readfile(path)
    except (DXFStructureError, UnicodeDecodeError):
        document, auditor = recover.readfile(path)
        notes.append(f"the file was damaged: {len(auditor.errors) + len(auditor.fixes)} place(s) mended")
        return document


def _refuse_unreadable(path: Path, error: Exception) -> NoReturn:
    reason = " ".join(str(error).split()) or type(error).__name__
    refuse(path.name, f"not a readable DXF file: {reason}", "export it again as DXF, version 2000 or later")


def _scale(document: Any, name: str, mm_per_unit: float, unit: str, notes: list[str]) -> float:  # noqa: PLR0917
    """Models' units in one unit of the drawing."""
    code = int(document.header.get("$INSUNITS", 0))
    if code == 0:
        notes.append(f"the drawing names no unit: taken as {unit}")
        return 1.0
    if code not in _MM_PER_INSUNIT:
        refuse(
            name,
            f"its unit ($INSUNITS {code}) is not known",
            "set the drawing's unit to millimetres or inches",
        )
    return _MM_PER_INSUNIT[code] / mm_per_unit
