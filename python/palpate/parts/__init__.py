"""Parts that come with palpate: the thesis's six objects and three parts of a drill.

They are drawn anew: the thesis's own outlines are not available. Names and numbers of faces are the thesis's
where it gives them. Lengths in mm.

Two contacts come with each part. Those of the six objects were chosen so that as many interpretations explain
them as in the thesis's table 4.1.
"""

from __future__ import annotations

from pathlib import Path

from palpate._core import Contact
from palpate.contacts import read_contacts

_FOLDER = Path(__file__).parent

THESIS_OBJECTS = ("robot-hand", "human-hand", "telephone", "boot", "camera", "beer-bottle")
DRILL_PARTS = ("drill-left", "drill-right", "armature")


def part_names() -> tuple[str, ...]:
    """Names that can stand for a model file."""
    return THESIS_OBJECTS + DRILL_PARTS


def part_path(name: str) -> Path | None:
    """The file of a bundled part; None if there is none of this name."""
    return _FOLDER / f"{name}.json" if name in part_names() else None


def standard_contacts(name: str) -> list[Contact]:
    """The two contacts bundled with a part, in its own frame.

    They are exact points of its outline, with bounds of ±0.5 mm and ±4°.

    Raises:
        ValueError: No bundled part of this name.
    """
    if name not in part_names():
        raise ValueError(f"name: no such bundled part (got {name!r}); give one of {', '.join(part_names())}")
    return read_contacts(_FOLDER / "contacts" / f"{name}.json").contacts
