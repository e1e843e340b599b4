"""The page docs/rig.md, from what `palpate experiment rig-...` left in a folder.

    python -m palpate.experiments.rig_page target/rig docs/rig.md

A table whose rows are not in the folder stays as it is. Pictures go to docs/pictures.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from palpate.experiments import rig_control, rig_drill, rig_sensor, rig_solids
from palpate.experiments.campaign import read
from palpate.experiments.pages import rewrite, table
from palpate.rig import SIZE, RigSpec, bounds_of

EXPERIMENTS = {
    "rig-sensor": rig_sensor.EXPERIMENT,
    "rig-control": rig_control.EXPERIMENT,
    "rig-drill": rig_drill.EXPERIMENT,
    "rig-solids": rig_solids.EXPERIMENT,
}


def write(folder: Path, page: Path) -> None:
    """Write the tables of the page anew, and its pictures."""
    rewrite(page, "rig-bounds", bounds_markdown())
    for name, experiment in EXPERIMENTS.items():
        file = folder / f"{name}.jsonl"
        if not file.exists():
            continue
        _, rows = read(file)
        rewrite(page, name, experiment.table(rows))
        for picture in experiment.pictures(rows):
            (page.parent / "pictures" / f"{picture.name}.svg").write_bytes(picture.svg)


def bounds_markdown() -> str:
    """Every source, in the plane and in space."""
    plane, space = (bounds_of(RigSpec(), dimension=d, size=SIZE[d]) for d in (2, 3))
    cells: list[list[str]] = []
    for title, unit, name in (
        ("force beside its share", "N", "forces"),
        ("resting place", "mm", "rest"),
        ("place of the first touch", "mm", "slide"),
        ("path", "mm", "path"),
    ):
        for source, value in getattr(plane, name).items():
            other = getattr(space, name)[source]
            cells.append([title, source, f"{value:.4f} {unit}", f"{other:.4f} {unit}"])
    angles = (
        ("calibrated gains, γ", [math.asin(one.gain) for one in (plane, space)]),
        ("of a single place", [one.planar_normal_error for one in (plane, space)]),
        ("a corner unnoticed", [one.corner + one.repeat for one in (plane, space)]),
        ("**`normal_error`**", [one.normal_error for one in (plane, space)]),
    )
    cells += [["normal", what, *(f"{math.degrees(angle):.3f}°" for angle in both)] for what, both in angles]
    cells.append(["**`position_error`**", "", *(f"{one.position_error:.3f} mm" for one in (plane, space))])
    cells.append(["**`path_error`**", "", *(f"{one.path_error:.3f} mm" for one in (plane, space))])
    return table(["bound of", "source", "plane", "space"], cells)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="the tables and pictures of docs/rig.md")
    parser.add_argument("folder", type=Path, help="of palpate experiment rig-sensor and the others")
    parser.add_argument("page", type=Path, help="page of the documentation that is written anew")
    given = parser.parse_args()
    write(given.folder, given.page)


if __name__ == "__main__":
    main()
