"""DXF drawings: lines and curves of model space, blocks exploded, as pieces of outlines."""

from __future__ import annotations

import logging
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.curves import Array, CurveError, Piece, Tolerance, closed_run, elliptic_arc, line, spline
from palpate.outlines import Drawing

# Millimetres per unit of $INSUNITS; 0 is "no unit".
_MM_PER_INSUNIT = {
    1: 25.4, 2: 304.8, 3: 1_609_344.0, 4: 1.0, 5: 10.0, 6: 1000.0, 7: 1e6, 8: 2.54e-5, 9: 0.0254, 10: 914.4,
    11: 1e-7, 12: 1e-6, 13: 1e-3, 14: 100.0, 15: 1e4, 16: 1e5,
}  # fmt: skip

_FROZEN = "on a frozen layer"


@dataclass
class _Reader:
    scale: float
    tolerance: Tolerance
    shows: Callable[[str], str]
    """Why a layer is not read; empty if it is."""
    pieces: list[Piece] = field(default_factory=list[Piece])
    left_out: Counter[str] = field(default_factory=Counter[str])
    heights: list[float] = field(default_factory=list[float])

    def read_all(self, entities: Any, layer: str = "0") -> None:
        """Entities of the drawing, or those of a block that is inserted on `layer`."""
        for entity in entities:
            kind = entity.dxftype()
            # Kinds that the library does not know have no attributes at all.
            own = entity.dxf.layer if entity.dxf.is_supported("layer") else "0"
            on = layer if own == "0" else own
            why = self.shows(on)
            if kind == "INSERT" and why != _FROZEN:
                for copy in entity.multi_insert() if entity.mcount > 1 else [entity]:
                    self.read_all(copy.virtual_entities(), on)
            elif why:
                self.left_out[f"{kind} {why}"] += 1
            elif entity.dxf.is_supported("invisible") and entity.dxf.get("invisible", 0):
                self.left_out[f"{kind} that is invisible"] += 1
            else:
                first = len(self.pieces)
                self.read(entity, kind)
                self.pieces[first:] = [replace(piece, layer=on) for piece in self.pieces[first:]]

    def read(self, entity: Any, kind: str) -> None:
        if kind == "LWPOLYLINE" or (
            kind == "POLYLINE" and not (entity.is_polygon_mesh or entity.is_poly_face_mesh)
        ):
            self.read_polyline(entity, kind)
        elif kind == "LINE":
            self.check_flat(kind, entity.dxf.start, entity.dxf.end)
            self.pieces.append(line(self.place(entity.dxf.start), self.place(entity.dxf.end)))
        elif kind in ("ARC", "CIRCLE", "ELLIPSE"):
            self.read_arc(entity, kind)
        elif kind == "SPLINE":
            self.read_spline(entity)
        else:
            self.left_out[kind] += 1

    def read_polyline(self, entity: Any, kind: str) -> None:
        first = len(self.pieces)
        for part in entity.virtual_entities():
            self.read(part, part.dxftype())
        pieces = self.pieces[first:]
        closed = entity.closed if kind == "LWPOLYLINE" else entity.is_closed
        comes_back = len(pieces) > 2 and any(
            np.all(pieces[0].points[0] == end) for end in pieces[-1].points[[0, -1]]
        )
        if closed or comes_back:
            self.pieces[first:] = closed_run(pieces, join=self.tolerance.distance)

    def check_flat(self, kind: str, *points: Any) -> None:
        heights = [self.scale * point.z for point in points]
        if not all(map(math.isfinite, heights)):
            raise CurveError("a coordinate is not finite; draw the part anew or delete the damaged line")
        if max(heights) - min(heights) > self.tolerance.distance:
            low, high = min(heights), max(heights)
            self.refuse_tilted(kind, points[0], f"its z goes from {low:.6g} to {high:.6g}")
        self.heights += heights

    def refuse_tilted(self, kind: str, place: Any, what: str) -> NoReturn:
        x, y = self.place(place)
        raise CurveError(
            f"the {kind} at ({x:.6g}, {y:.6g}) is not parallel to the plane of the drawing: {what}; "
            "draw the part flat in x and y, or name its layers with layers="
        )

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
        self.check_flat(kind, center, center + axis_x, center + axis_y)
        sweep = (end - start) % math.tau
        if sweep < 1e-9:
            sweep = math.tau
        frame = (self.place(center), self.place(axis_x), self.place(axis_y))
        self.pieces.append(elliptic_arc(frame, start, sweep, tolerance=self.tolerance))

    def read_spline(self, entity: Any) -> None:
        tool = entity.construction_tool()
        points = self.scale * np.array([(p.x, p.y) for p in tool.control_points])
        self.check_flat("SPLINE", *tool.control_points)
        weights = np.array(tool.weights() or [1.0] * len(points), dtype=float)
        if np.any(weights <= 0.0):
            raise CurveError("a SPLINE has a weight that is not positive; draw it with arcs and polylines")
        controls = np.column_stack([points * weights[:, None], weights])
        self.pieces += spline(controls, np.array(tool.knots(), dtype=float), tolerance=self.tolerance)

    def place(self, vector: Any) -> Array:
        return self.scale * np.array([vector.x, vector.y])


def read_dxf(
    path: Path, *, mm_per_unit: float, unit: str, tolerance: Tolerance, layers: Sequence[str] | None = None
) -> Drawing:
    """The lines and curves of a DXF file.

    Args:
        path: The file.
        mm_per_unit: Of the models' unit.
        unit: Its name; taken for the drawing's where the drawing names none.
        tolerance: For curves.
        layers: Names of those to read; else all that are shown.

    Raises:
        ValueError: If it is no DXF file, its unit is not known, or a layer is not in it.
    """
    notes: list[str] = []
    document = _document(path, notes)
    scale = _scale(document, path.name, mm_per_unit, unit, notes)
    reader = _Reader(scale, tolerance, _shown(document, path.name, layers))
    try:
        reader.read_all(document.modelspace())
    except CurveError:
        raise
    except RecursionError:
        refuse(path.name, "its blocks contain each other", "explode the blocks in the CAD program")
    except Exception:  # the library may find the damage only now
        _refuse_unreadable(path)
    notes += [f"left out: {count} {kind}" for kind, count in sorted(reader.left_out.items())]
    if reader.heights and max(reader.heights) - min(reader.heights) > tolerance.distance:
        low, high = min(reader.heights), max(reader.heights)
        notes.append(f"lines at different heights, z from {low:.6g} to {high:.6g}, read as one plane")
    if not reader.pieces and any(
        len(document.layout(name)) for name in document.layout_names() if name != "Model"
    ):
        notes.append("what is drawn in paper space is not read: draw it in model space")
    return Drawing(reader.pieces, notes, layered=True)


def _shown(document: Any, name: str, layers: Sequence[str] | None) -> Callable[[str], str]:
    frozen = {layer.dxf.name.lower() for layer in document.layers if layer.is_frozen()}
    off = {layer.dxf.name.lower() for layer in document.layers if layer.is_off()}
    wanted = None if layers is None else {layer.lower() for layer in layers}
    names = {layer.dxf.name.lower(): layer.dxf.name for layer in document.layers}
    names |= {e.dxf.layer.lower(): e.dxf.layer for e in document.entitydb.values() if e.dxf.hasattr("layer")}
    for layer in sorted((wanted or set()) - set(names)):
        refuse(name, f"there is no layer {layer!r}", f"give some of {', '.join(sorted(names.values()))}")

    def why_not(layer: str) -> str:
        layer = layer.lower()
        if layer in frozen:
            return _FROZEN
        if layer in off:
            return "on a hidden layer"
        return "" if wanted is None or layer in wanted else "on a layer that is not named"

    return why_not


def _document(path: Path, notes: list[str]) -> Any:
    import ezdxf
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFStructureError

    heard: list[str] = []
    try:
        try:
            document = ezdxf.readfile(path)
        except (DXFStructureError, UnicodeDecodeError):
            with _listening("ezdxf", heard):
                document, auditor = recover.readfile(path)
            mended = len(auditor.errors) + len(auditor.fixes)
            count = f"{mended} place(s) mended" if mended else "what could be read is read"
            notes.append(f"the file was damaged, {count}: compare the picture with the drawing")
    except OSError as error:
        if error.errno is not None:
            raise
        _refuse_unreadable(path)
    except Exception:  # on damaged files the library raises whatever comes up, assertions included
        _refuse_unreadable(path)
    if any("invalid" in message for message in heard):
        # The library takes what is left of a number for it: lines would be elsewhere.
        refuse(path.name, "a number in it is damaged", "export or copy it again")
    text = path.read_bytes()
    if not text.startswith(b"AutoCAD Binary DXF") and not text.rstrip(b"\x00\x1a \r\n\t").endswith(b"EOF"):
        refuse(path.name, "it is cut off: the last line is not EOF", "export or copy it again")
    return document


@contextmanager
def _listening(name: str, heard: list[str]) -> Iterator[None]:
    """Keeps what a library logs, in place of printing it."""
    logger, handler = logging.getLogger(name), logging.Handler()
    handler.emit = lambda record: heard.append(record.getMessage())  # type: ignore[method-assign]
    propagated, logger.propagate = logger.propagate, False
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.propagate = propagated


def _refuse_unreadable(path: Path) -> NoReturn:
    refuse(
        path.name,
        "not a readable DXF file: it is damaged, or of another kind",
        "export it again as DXF, version 2000 or later",
    )


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
