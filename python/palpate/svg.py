"""SVG drawings: shapes with their transforms applied, as pieces of outlines. Up is +y; the origin stays."""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.curves import Array, Piece, Tolerance, bezier, elliptic_arc, line
from palpate.outlines import Drawing

_MM_PER_PX = 25.4 / 96.0
_PX_PER_UNIT = {
    "mm": 96.0 / 25.4, "cm": 960.0 / 25.4, "q": 24.0 / 25.4, "in": 96.0, "pt": 96.0 / 72.0, "pc": 16.0,
    "px": 1.0, "": 1.0,
}  # fmt: skip
_LENGTH = re.compile(r"\s*([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)\s*([a-z]*)\s*", re.IGNORECASE)


def read_svg(path: Path, *, mm_per_unit: float, tolerance: Tolerance) -> Drawing:
    """The lines and curves of an SVG file.

    Args:
        path: The file.
        mm_per_unit: Of the models' unit.
        tolerance: For curves.

    Raises:
        ValueError: If it is no SVG file.
    """
    import svgelements

    notes: list[str] = []
    source = _in_px(path, notes)
    try:
        # Transforms are kept apart: arcs can't be trusted once the library has skewed them.
        document: Any = svgelements.SVG.parse(source, ppi=96.0, reify=False)
        elements = list(document.elements())
    except Exception as error:  # on damaged files the library raises whatever comes up
        _refuse_unreadable(path, error)
    pieces: list[Piece] = []
    left_out: Counter[str] = Counter()
    for element in elements:
        if isinstance(element, svgelements.Shape):
            placement = _Placement(element.transform, _MM_PER_PX / mm_per_unit)
            for segment in element.segments(transformed=False):
                pieces += _pieces(segment, placement, tolerance)
        elif isinstance(element, (svgelements.Text, svgelements.Image)):
            left_out[type(element).__name__.lower()] += 1
    notes += [f"left out: {count} {kind}" for kind, count in sorted(left_out.items())]
    return Drawing(pieces, notes)


def _in_px(path: Path, notes: list[str]) -> io.BytesIO:
    """The file with its width and height in pixels, and a note if they were not physical."""
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        _refuse_unreadable(path, error)
    if root.tag.rpartition("}")[2] != "svg":
        refuse(path.name, f"its root is <{root.tag}>, not <svg>", "export it again as plain SVG")
    found = [_LENGTH.fullmatch(root.get(side, "")) for side in ("width", "height")]
    sizes = [(float(match[1]), match[2].lower()) for match in found if match is not None]
    known = [(size * _PX_PER_UNIT[suffix], suffix) for size, suffix in sizes if suffix in _PX_PER_UNIT]
    if len(known) == 2:
        width, height = (px for px, _ in known)
    else:
        try:
            box = [float(number) for number in root.get("viewBox", "").replace(",", " ").split()]
        except ValueError as error:
            _refuse_unreadable(path, error)
        width, height = box[2:] if len(box) == 4 else (1000.0, 1000.0)
    if len(known) < 2 or any(suffix in ("", "px") for _, suffix in known):
        notes.append(
            "width and height are not both given in a physical unit: lengths taken as pixels, 96 to the inch"
        )
    root.set("width", repr(width))
    root.set("height", repr(height))
    return io.BytesIO(ElementTree.tostring(root))


def _refuse_unreadable(path: Path, error: Exception) -> NoReturn:
    reason = " ".join(str(error).split())
    refuse(path.name, f"not a readable SVG file: {reason}", "export it again as plain SVG")


class _Placement:
    """`p_drawing = scale * matrix * p_shape`, y turned up."""

    def __init__(self, matrix: Any, scale: float) -> None:
        flip = scale * np.array([1.0, -1.0])[:, None]
        self._linear = flip * np.array([[matrix.a, matrix.c], [matrix.b, matrix.d]])
        self._shift = flip[:, 0] * np.array([matrix.e, matrix.f])

    def point(self, point: Any) -> Array:
        return self._linear @ np.array([point.x, point.y]) + self._shift

    def vector(self, start: Any, end: Any) -> Array:
        return self._linear @ np.array([end.x - start.x, end.y - start.y])


def _pieces(segment: Any, placement: _Placement, tolerance: Tolerance) -> list[Piece]:
    """A segment of a path; moves draw nothing."""
    import svgelements

    if isinstance(segment, (svgelements.Line, svgelements.Close)):
        if segment.start is None or segment.end is None or segment.start == segment.end:
            return []
        return [line(placement.point(segment.start), placement.point(segment.end))]
    if isinstance(segment, svgelements.Arc):
        axis_x, axis_y = (placement.vector(segment.center, end) for end in (segment.prx, segment.pry))
        frame = (placement.point(segment.center), axis_x, axis_y)
        return [elliptic_arc(frame, segment.get_start_t(), segment.sweep, tolerance=tolerance)]
    if isinstance(segment, (svgelements.QuadraticBezier, svgelements.CubicBezier)):
        points = np.array([placement.point(point) for point in segment])
        return [bezier(np.column_stack([points, np.ones(len(points))]), tolerance=tolerance)]
    return []
