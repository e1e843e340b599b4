"""SVG drawings: shapes with their transforms applied, as pieces of outlines.

`(x, y)` of the model is `(x, -y)` of the drawing, from its upper left corner: an SVG's y runs down.
"""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.curves import Array, Piece, Tolerance, bezier, closed_run, elliptic_arc, line
from palpate.outlines import Drawing

_MM_PER_PX = 25.4 / 96.0
_PX_PER_UNIT = {
    "mm": 96.0 / 25.4, "cm": 960.0 / 25.4, "q": 24.0 / 25.4, "in": 96.0, "pt": 96.0 / 72.0, "pc": 16.0,
    "px": 1.0, "": 1.0,
}  # fmt: skip
_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_LENGTH = re.compile(rf"\s*({_NUMBER})\s*([a-z]*)\s*", re.IGNORECASE)
_ONE_TRANSFORM = rf"(?:matrix|translate|scale|rotate|skewX|skewY)\s*\((?:[\s,]*{_NUMBER}[a-z%]*)+\s*\)"
_TRANSFORM = re.compile(rf"(?:[\s,]*{_ONE_TRANSFORM})*[\s,]*(?:none)?\s*", re.IGNORECASE)
_PATH = re.compile(rf"(?:[\s,]*(?:[MmZzLlHhVvCcSsQqTtAa]|{_NUMBER}))*[\s,]*")

# Not drawn where they stand in the file.
_TEMPLATES = ("marker", "pattern", "clipPath", "mask", "linearGradient", "radialGradient", "filter")
# Words about the drawing, on which the library stumbles.
_WORDS = ("metadata", "title", "desc")


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
    left_out: Counter[str] = Counter()
    source = _in_px(path, notes, left_out)
    try:
        # Transforms are kept apart: arcs can't be trusted once the library has skewed them.
        document: Any = svgelements.SVG.parse(source, ppi=96.0, reify=False)
        elements = list(document.elements())
    except RecursionError:
        refuse(path.name, "its <use> elements contain each other", "export it again as plain SVG")
    except Exception:  # on damaged files the library raises whatever comes up
        _refuse_unreadable(path, "a value in it can't be understood")
    pieces: list[Piece] = []
    for element in elements:
        kind = type(element).__name__.lower()
        if isinstance(element, svgelements.Shape):
            if str(element.values.get("visibility", "")).strip() in ("hidden", "collapse"):
                left_out[f"{kind} that is hidden"] += 1
            else:
                pieces += _outlines(
                    element, _Placement(element.transform, _MM_PER_PX / mm_per_unit), tolerance
                )
        elif isinstance(element, (svgelements.Text, svgelements.Image)):
            left_out[kind] += 1
    notes += [f"left out: {count} {kind}" for kind, count in sorted(left_out.items())]
    return Drawing(pieces, notes)


def _outlines(element: Any, placement: _Placement, tolerance: Tolerance) -> list[Piece]:
    """The pieces of a shape; each of its runs that comes back to its start is one."""
    import svgelements

    pieces: list[Piece] = []
    run: list[Piece] = []
    for segment in [*element.segments(transformed=False), None]:
        if segment is not None:
            run += _pieces(segment, placement, tolerance)
        closes = isinstance(segment, svgelements.Close)
        # What follows a "z" without a move begins a run of its own.
        if closes or segment is None or isinstance(segment, svgelements.Move):
            comes_back = len(run) > 1 and bool(np.all(run[0].points[0] == run[-1].points[-1]))
            pieces += closed_run(run, join=tolerance.distance) if closes or comes_back else run
            run = []
    return pieces


def _in_px(path: Path, notes: list[str], left_out: Counter[str]) -> io.BytesIO:
    """The file with its size in pixels and without what is not drawn; a note, if it has no physical size."""
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        line, column = error.position
        _refuse_unreadable(path, f"not XML from line {line}, column {column + 1} on")
    except (ValueError, LookupError):
        _refuse_unreadable(path, "its encoding is not known")
    if _tag(root) != "svg":
        refuse(path.name, f"its root is <{_tag(root)}>, not <svg>", "export it again as plain SVG")
    _check_values(path, root)
    _without_undrawn(path, root, left_out)
    found = [_LENGTH.fullmatch(root.get(side, "")) for side in ("width", "height")]
    sizes = [(float(match[1]), match[2].lower()) for match in found if match is not None]
    known = [(size * _PX_PER_UNIT[suffix], suffix) for size, suffix in sizes if suffix in _PX_PER_UNIT]
    if len(known) == 2:
        width, height = (px for px, _ in known)
    else:
        try:
            box = [float(number) for number in root.get("viewBox", "").replace(",", " ").split()]
        except ValueError:
            _refuse_unreadable(path, f"viewBox {root.get('viewBox')!r} is not four numbers")
        width, height = box[2:] if len(box) == 4 else (1000.0, 1000.0)
    if len(known) < 2 or any(suffix in ("", "px") for _, suffix in known):
        notes.append(
            "width and height are not both given in a physical unit: lengths taken as pixels, 96 to the inch"
        )
    root.set("width", repr(width))
    root.set("height", repr(height))
    return io.BytesIO(ElementTree.tostring(root))


def _tag(element: ElementTree.Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _check_values(path: Path, root: ElementTree.Element) -> None:
    """Refuses what the library would leave out without a word."""
    for element in root.iter():
        for attribute, pattern in (("transform", _TRANSFORM), ("d", _PATH)):
            text = element.get(attribute, "")
            # The longest match says where it stops making sense.
            match = pattern.match(text)
            if attribute == "d" and _tag(element) != "path":
                continue
            if match is None or match.end() < len(text):
                at = 0 if match is None else match.end()
                _refuse_unreadable(
                    path, f"{attribute} of <{_tag(element)}> can't be read from {text[at : at + 20]!r} on"
                )


def _without_undrawn(path: Path, root: ElementTree.Element, left_out: Counter[str]) -> None:
    """Takes out what is not drawn where it stands; symbols are drawn where they are used only."""
    for parent in list(root.iter()):
        if _tag(parent) == "style" and re.search(r"display\s*:\s*none", parent.text or ""):
            left_out["style sheet's choice of elements (display: none)"] += 1
        for child in list(parent):
            tag = _tag(child)
            style = re.search(r"(?:^|;)\s*display\s*:\s*none", child.get("style", ""))
            if tag == "path" and not child.get("d", "").strip():
                parent.remove(child)
            elif tag in _WORDS or tag in _TEMPLATES:
                parent.remove(child)
                if tag in ("marker", "mask", "clipPath"):
                    left_out[tag] += 1
            elif style or child.get("display", "").strip() == "none":
                parent.remove(child)
                left_out[f"{tag} with display: none"] += 1
            elif tag == "symbol":
                if child.get("viewBox"):
                    remedy = "draw it in place of <use>"
                    refuse(
                        path.name,
                        f"symbol {child.get('id')!r} has a viewBox of its own, which is not read",
                        remedy,
                    )
                parent.remove(child)
                prefix = str(child.tag).rpartition("symbol")[0]
                ElementTree.SubElement(parent, f"{prefix}defs").append(child)


def _refuse_unreadable(path: Path, reason: str) -> NoReturn:
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
