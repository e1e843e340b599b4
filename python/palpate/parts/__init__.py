"""Parts that come with palpate: the thesis's six objects and three parts of a drill.

They are drawn anew: the thesis's own outlines are not available. Names and numbers of faces are the thesis's
where it gives them. Lengths in mm.
"""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent

THESIS_OBJECTS = ("robot-hand", "human-hand", "telephone", "boot", "camera", "beer-bottle")
DRILL_PARTS = ("drill-left", "drill-right", "armature")


def part_names() -> tuple[str, ...]:
    """Names that can stand for a model file."""
    return THESIS_OBJECTS + DRILL_PARTS


def part_path(name: str) -> Path | None:
    """The file of a bundled part; None if there is none of this name."""
    return _FOLDER / f"{name}.json" if name in part_names() else None
