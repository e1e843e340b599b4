"""Model files: JSON, drawings and solids into models, and models into JSON.

A JSON file is a `palpate-model` document (`schemas/model-1.json`), of the plane or of space. DXF and SVG are
drawings: closed lines are outlines, and holes of the ones around them; several outlines are several models,
numbered from left to right; where nothing is closed, the lines are loose faces. Curves become chords, and the
model says what that costs: `position_slack` and `normal_slack` are added to the bounds of every contact.

STL, OBJ, PLY, OFF, 3MF and STEP files are solids. Bodies that don't meet are several models, as outlines are.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate._core import Model
from palpate.contacts.entry import MM_PER_UNIT, mm_per, refuse, write_text
from palpate.curves import CurveError, Tolerance
from palpate.model_json import document_of, parse_model, text_of
from palpate.outlines import Drawing, OutlineError, Shape, shapes_of
from palpate.parts import part_names, part_path, solid_part_names
from palpate.solids import SOLID_SUFFIXES, solid_parts

SUFFIXES = (".json", ".dxf", ".svg", *SOLID_SUFFIXES)

_FLATTENING_MM = 0.05
# As a share of the drawing.
_LARGEST_FLATTENING = 0.1


def load_models(
    paths: str | Path | Sequence[str | Path],
    *,
    unit: str = "mm",
    flattening: float | None = None,
    turn_deg: float = 7.5,
    layers: Sequence[str] | None = None,
    position_slack: float = 0.0,
    normal_slack: float = 0.0,
) -> list[Model]:
    """Models of files, folders and bundled parts, in this order; a folder's files by name.

    Args:
        paths: Files of models, drawings and solids, folders of them, or bundled parts by name, as "boot".
        unit: Unit of the models that are returned; files in another one are converted.
        flattening: How far chords may be from their curves, triangles from the surfaces of a STEP file, and
            ends that are to be joined from each other, in `unit`. Else 0.05 mm.
        turn_deg: How far the normals of chords may be from those of the curves, degrees.
        layers: Names of the DXF layers to read; else all that are shown.
        position_slack: How far the true parts may lie from what their files say, in `unit`, as by
            tessellation: added to the slack that is known from the files.
        normal_slack: The same for their normals, radians.

    Raises:
        ValueError: If a file is missing, malformed, of an unknown kind or without an outline; names it.
    """
    mm_per_unit = mm_per(unit, "unit")
    distance = _FLATTENING_MM / mm_per_unit if flattening is None else flattening
    if not (math.isfinite(distance) and distance > 0.0):
        refuse(
            "flattening",
            f"{distance!r} is not a length above zero",
            f"give, for example, 0.05 for parts in {unit}",
        )
    if not 0.0 < turn_deg <= 45.0:
        refuse("turn_deg", f"{turn_deg!r} is not above 0 and at most 45", "give, for example, 7.5")
    if isinstance(layers, str) or (layers is not None and not all(isinstance(name, str) for name in layers)):
        refuse("layers", f"{layers!r} is not a list of names", 'give, for example, ["PART"]')
    if not (math.isfinite(position_slack) and position_slack >= 0.0):
        refuse(
            "position_slack", f"{position_slack!r} is not a length, zero or more", "give 0 for exact files"
        )
    if not 0.0 <= normal_slack < 0.5 * math.pi:
        refuse(
            "normal_slack", f"{normal_slack!r} is not an angle of 0 to π/2 radians", "give 0 for exact files"
        )
    slacks = {"position_slack": position_slack, "normal_slack": normal_slack}
    options = _Options(unit, Tolerance(distance, math.radians(turn_deg)), layers, slacks)
    given = _given(paths)
    if not given:
        refuse("paths", "no model is named", f"name a file, a folder or one of {_bundled_words()}")
    return [model for path in given for file in _files(path) for model in _load(file, options)]


def model_of(name: str, document: dict[str, Any]) -> Model:
    """The model of a `palpate-model` document in its own unit; `name` is where it stands, for messages.

    Raises:
        ValueError: If it is none.
    """
    mm_per_unit = mm_per(str(document.get("unit")), f"{name}: unit")
    return _model(name, parse_model(name, json.dumps(document), mm_per_unit=mm_per_unit))


@dataclass(frozen=True)
class _Options:
    """How files are read."""

    unit: str
    tolerance: Tolerance
    layers: Sequence[str] | None
    slacks: dict[str, float]
    """Added to those of every model."""


def _given(paths: str | Path | Sequence[str | Path]) -> list[str | Path]:
    given: list[Any] = [paths]
    if not isinstance(paths, (str, Path)):
        given = list(paths) if isinstance(paths, Iterable) else given
    for path in given:
        if not isinstance(path, (str, Path)):
            refuse(
                "paths",
                f"{path!r} is not the name of a file",
                "give names of files, folders or bundled parts",
            )
    return given


def save_model(model: Model, path: str | Path, *, unit: str = "mm") -> None:
    """Write a model as JSON. Reading it back gives the same faces, in the same order.

    In space, what corners are off the planes of their faces is found anew, and added to the slacks again.

    Args:
        model: In `unit`.
        path: A .json file.
        unit: Said in the file.

    Raises:
        ValueError: If the suffix is another, the unit is not known, or the file can't be written.
    """
    path = Path(path)
    mm_per(unit, "unit")
    if path.suffix.lower() != ".json":
        refuse(path.name, f"models are written as JSON, not {path.suffix!r}", "name the file .json")
    write_text(path, text_of(document_of(model, unit)))


def bundled_parts() -> list[Model]:
    """The parts in the plane that come with palpate, in mm."""
    return load_models(part_names())


def bundled_solids() -> list[Model]:
    """The parts in space that come with palpate, in mm."""
    return load_models(solid_part_names())


def _bundled_words() -> str:
    return ", ".join(part_names() + solid_part_names())


def _files(path: str | Path) -> list[Path]:
    """The model files that `path` names."""
    file = Path(path)
    if file.is_dir():
        files = sorted(
            f for f in file.iterdir() if f.suffix.lower() in SUFFIXES and not _is_of_another_kind(f)
        )
        if not files:
            refuse(str(path), "no model file in this folder", f"put {', '.join(SUFFIXES)} files there")
        return files
    if file.is_file():
        if file.suffix.lower() not in SUFFIXES:
            refuse(str(path), f"unknown suffix {file.suffix!r}", f"give a {', '.join(SUFFIXES)} file")
        return [file]
    bundled = part_path(str(path))
    if bundled is None:
        refuse(str(path), "no such file or folder", f"give a model file or one of {_bundled_words()}")
    return [bundled]


def _is_of_another_kind(file: Path) -> bool:
    """A document of ours that is no model, such as contacts kept beside the parts."""
    if file.suffix.lower() != ".json":
        return False
    try:
        document = json.loads(file.read_text(encoding="utf-8-sig"))
    except ValueError:
        return False
    schema = document.get("schema") if isinstance(document, dict) else None
    return isinstance(schema, str) and schema.startswith("palpate-") and schema != "palpate-model"


def _load(file: Path, options: _Options) -> list[Model]:
    try:
        if file.suffix.lower() == ".json":
            arguments = parse_model(file.name, _text_of(file), mm_per_unit=MM_PER_UNIT[options.unit])
            return [_model(file.name, _slackened(arguments, options))]
        if file.suffix.lower() in SOLID_SUFFIXES:
            return _load_solid(file, options)
        return _load_drawing(file, options)
    except OSError as error:
        refuse(file.name, f"can't be read: {error.strerror}", "check the file's permissions")


def _load_solid(file: Path, options: _Options) -> list[Model]:
    return [
        _model(
            file.name,
            _slackened(
                {
                    "vertices": part.vertices,
                    "triangles": part.triangles,
                    "name": part.name,
                    "position_slack": part.position_slack,
                    "normal_slack": part.normal_slack,
                    "mends": list(part.mends),
                },
                options,
            ),
        )
        for part in solid_parts(file, unit=options.unit, tolerance=options.tolerance)
    ]


def _slackened(arguments: dict[str, Any], options: _Options) -> dict[str, Any]:
    return arguments | {name: arguments[name] + more for name, more in options.slacks.items()}


def _load_drawing(file: Path, options: _Options) -> list[Model]:
    try:
        drawing = _drawing(file, options)
        _check_size(drawing, options)
        shapes = shapes_of(drawing, tolerance=options.tolerance)
    except (CurveError, OutlineError) as error:
        raise ValueError(f"{file.name}: {error}") from None
    if not shapes:
        said = "".join(f" ({note})" for note in drawing.notes)
        refuse(file.name, f"no outline in it{said}", "draw the part with lines, arcs and curves")
    names = [file.stem] if len(shapes) == 1 else [f"{file.stem}-{k}" for k in range(1, len(shapes) + 1)]
    try:
        return [
            _model(
                file.name,
                _slackened(_arguments_of(shape), options)
                | {"name": name, "mends": [*drawing.notes, *shape.notes]},
            )
            for name, shape in zip(names, shapes, strict=True)
        ]
    except ValueError as error:
        if len({piece.layer for piece in drawing.pieces}) < 2:
            raise
        raise ValueError(f"{error}; or name the layers of the part with layers=") from None


def _check_size(drawing: Drawing, options: _Options) -> None:
    """Refuses a flattening that would swallow the drawing, as one in another unit does."""
    if not drawing.pieces:
        return
    points = np.concatenate([piece.points for piece in drawing.pieces])
    size = float(np.max(np.ptp(points, axis=0)))
    flattening = options.tolerance.distance
    if flattening > _LARGEST_FLATTENING * size > 0.0:
        raise OutlineError(
            f"flattening: {flattening:g} {options.unit} is not small against the drawing, which is "
            f"{size:.3g} {options.unit} across; give, for example, {1e-3 * size:.1g}"
        )


def _drawing(file: Path, options: _Options) -> Drawing:
    mm_per_unit = MM_PER_UNIT[options.unit]
    # What overflows is refused with its place; numpy need not warn as well.
    with np.errstate(all="ignore"):
        if file.suffix.lower() == ".svg":
            if options.layers is not None:
                refuse("layers", f"{file.name} is an SVG, which has none", "leave layers= out, or give a DXF")
            from palpate.svg import read_svg

            return read_svg(file, mm_per_unit=mm_per_unit, tolerance=options.tolerance)
        from palpate.dxf import read_dxf

        return read_dxf(
            file,
            mm_per_unit=mm_per_unit,
            unit=options.unit,
            tolerance=options.tolerance,
            layers=options.layers,
        )


def _arguments_of(shape: Shape) -> dict[str, Any]:
    slacks: dict[str, Any] = {"position_slack": shape.position_slack, "normal_slack": shape.normal_slack}
    if shape.closed:
        outer, *holes = (loop[:-1] for loop in shape.loops)  # the last point is the first again
        return slacks | {"outer": outer, "holes": holes}
    segments = np.concatenate([np.stack([chain[:-1], chain[1:]], axis=1) for chain in shape.loops])
    return slacks | {"segments": segments}


def _model(file_name: str, arguments: dict[str, Any]) -> Model:
    """The model of its constructor's arguments; `outer`, `segments`, `faces` or `triangles` says of which."""
    arguments = dict(arguments)
    try:
        if "triangles" in arguments:
            return Model.mesh(arguments.pop("vertices"), arguments.pop("triangles"), **arguments)
        if "outer" in arguments:
            return Model.polygon(arguments.pop("outer"), **arguments)
        if "faces" in arguments:
            return Model.facets(arguments.pop("faces"), **arguments)
        return Model.segments(arguments.pop("segments"), **arguments)
    except ValueError as error:
        raise ValueError(f"{file_name}: {error}") from None


def _text_of(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        refuse(file.name, "is not UTF-8 text", "save it as UTF-8")
