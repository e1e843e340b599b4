"""Parts that come with palpate: the thesis's six objects and three parts of a drill; four solids.

The thesis's parts are drawn anew: its own outlines are not available. Names and numbers of faces are the
thesis's where it gives them. Lengths in mm.

Two contacts come with each part in the plane. Those of the six objects were chosen so that as many
interpretations explain them as in the thesis's table 4.1.

The solids are drawn by the project: `python -m palpate.experiments.solid_shapes FOLDER` writes them. Four
contacts come with each.
"""

from __future__ import annotations

from pathlib import Path

from palpate._core import Contact
from palpate.contacts import read_contacts

_FOLDER = Path(__file__).parent

THESIS_OBJECTS = ("robot-hand", "human-hand", "telephone", "boot", "camera", "beer-bottle")
DRILL_PARTS = ("drill-left", "drill-right", "armature")
SOLIDS = ("l-bracket", "rib-plate", "hexagon", "flange")


def part_names() -> tuple[str, ...]:
    """Names of parts in the plane that can stand for a model file."""
    return THESIS_OBJECTS + DRILL_PARTS


def solid_part_names() -> tuple[str, ...]:
    """Names of parts in space that can stand for a model file."""
    return SOLIDS


def part_path(name: str) -> Path | None:
    """The file of a bundled part; None if there is none of this name."""
    return _FOLDER / f"{name}.json" if name in part_names() + solid_part_names() else None


def contacts_path(name: str) -> Path | None:
    """The file of the contacts that come with a bundled part; None if there is none of this name."""
    return None if part_path(name) is None else _FOLDER / "contacts" / f"{name}.json"


def standard_contacts(name: str) -> list[Contact]:
    """The contacts bundled with a part, in its own frame: two in the plane, four in space.

    They are exact points of its outline or surface, with bounds of ±0.5 mm and ±4°.

    Raises:
        ValueError: No bundled part of this name.
    """
    file = contacts_path(name)
    if file is None:
        known = ", ".join(part_names() + solid_part_names())
        raise ValueError(f"name: no such bundled part (got {name!r}); give one of {known}")
    return read_contacts(file).contacts
