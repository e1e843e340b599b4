"""Solid models from files: STL, OBJ, PLY, OFF and 3MF, and STEP with `palpate[step]`.

Each format has a reader that gives bodies and says what it left out; `bodies.py` makes parts of them. A file
that is cut off or damaged is refused wherever its format lets that be seen, never read in part. The readers
are our own: of files that are cut off, common libraries lose the end without a word.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from palpate.contacts.entry import MM_PER_UNIT, mm_per, refuse
from palpate.curves import Tolerance
from palpate.solids.mesh import Scene
from palpate.solids.mesh import SolidMesh as SolidMesh

SOLID_SUFFIXES = (".stl", ".obj", ".ply", ".off", ".3mf", ".step", ".stp")


def read_solid(
    path: str | Path, *, unit: str = "mm", flattening: float | None = None, turn_deg: float = 7.5
) -> list[SolidMesh]:
    """The parts of a solid model file, from left to right: arguments of `palpate.Model.mesh`.

    STL, OBJ, PLY and OFF name no unit: their numbers are taken as they are. 3MF and STEP name theirs, and are
    converted.

    Args:
        path: The file.
        unit: Of what is returned.
        flattening: How far triangles may be from the curved surfaces of a STEP file, in `unit`. Else 0.05 mm.
        turn_deg: How far the normals of triangles may be from those of the surfaces, degrees.

    Raises:
        ValueError: If it is missing, damaged, of an unknown kind or without a surface; names it.
    """
    file = Path(path)
    mm_per_unit = mm_per(unit, "unit")
    distance = 0.05 / mm_per_unit if flattening is None else flattening
    if file.suffix.lower() not in SOLID_SUFFIXES:
        refuse(str(path), f"unknown suffix {file.suffix!r}", f"give a {', '.join(SOLID_SUFFIXES)} file")
    tolerance = Tolerance(distance, math.radians(turn_deg))
    try:
        return solid_parts(file, unit=unit, tolerance=tolerance)
    except OSError as error:
        refuse(file.name, f"can't be read: {error.strerror}", "check its name and permissions")


def solid_parts(file: Path, *, unit: str, tolerance: Tolerance) -> list[SolidMesh]:
    """The parts of a file whose suffix is one of `SOLID_SUFFIXES`."""
    # Readers are imported when there is something to read: the command line starts sooner.
    from palpate.solids.bodies import parts_of

    # What overflows is refused with its place; numpy need not warn as well.
    with np.errstate(all="ignore"):
        return parts_of(file.name, file.stem, _scene(file, unit, tolerance))


def _scene(file: Path, unit: str, tolerance: Tolerance) -> Scene:
    suffix = file.suffix.lower()
    if suffix in (".step", ".stp"):
        from palpate.solids.step import read_step

        return read_step(file, mm_per_unit=MM_PER_UNIT[unit], tolerance=tolerance)
    data = file.read_bytes()
    if not data.strip():
        refuse(file.name, "is empty", "export or copy it again")
    if suffix == ".3mf":
        from palpate.solids.three_mf import read_three_mf

        return read_three_mf(file.name, data, mm_per_unit=MM_PER_UNIT[unit])
    from palpate.solids.ply import read_ply
    from palpate.solids.stl import read_stl
    from palpate.solids.text_meshes import read_obj, read_off

    read = {".stl": read_stl, ".ply": read_ply, ".obj": read_obj, ".off": read_off}[suffix]
    scene = read(file.name, data)
    scene.notes.insert(0, f"the file names no unit: taken as {unit}")
    return scene
