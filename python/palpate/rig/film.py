"""A run through the rig as a page that plays it: one file, nothing to load."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from palpate._core import Model
from palpate.loop.result import Result
from palpate.probe import Hit, Skid
from palpate.rig.recording import STATES, Array, Recording

FRAMES_PER_SECOND = 20.0
NEEDLE = 12.0  # mm, of a drawn normal


def save_film(
    path: str | Path,
    recording: Recording,
    result: Result,
    *,
    model: Model,
    world_from_model: Array,
    tip_radius: float,
    unit_mm: float = 1.0,
) -> None:
    """Write the page, whole or not at all.

    Args:
        path: Ends in `.html`.
        recording: Of the rig that made the run; it has moved.
        result: Of the run.
        model: The part that lay there, at `world_from_model`.
        world_from_model: Its pose.
        tip_radius: Of the bearing, mm.
        unit_mm: Millimetres in the unit of the model and of the result.

    Raises:
        ValueError: Another suffix.
        OSError: It can't be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".html":
        raise ValueError(f"path: must end in .html (got {str(path)!r}); name it so")
    document = _document(
        recording, result, model=model, pose=world_from_model, tip_radius=tip_radius, unit_mm=unit_mm
    )
    page = resources.files("palpate.rig").joinpath("film.html").read_text(encoding="utf-8")
    # What would end the script that holds it, or begin a comment in it, is written otherwise.
    text = json.dumps(document, separators=(",", ":")).replace("</", "<\\/").replace("<!--", "<\\!--")
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        partial.write_text(page.replace("/*RUN*/null", text), encoding="utf-8")
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def _document(
    recording: Recording,
    result: Result,
    *,
    model: Model,
    pose: Array,
    tip_radius: float,
    unit_mm: float,
) -> dict[str, Any]:
    d = model.dimension
    times = recording.column("time")
    rate = 1.0 / float(np.median(np.diff(times))) if len(times) > 1 else FRAMES_PER_SECOND
    every = max(1, round(rate / FRAMES_PER_SECOND))
    last = len(times) - 1
    kept = np.unique([*range(0, last, every), last])
    # No peak is left out between two frames.
    peaks = np.maximum.reduceat(np.hypot.reduce(recording.column("force"), axis=1), kept)
    edges = [face for face in model.faces] if d == 2 else model.edges
    lines = [unit_mm * (np.asarray(edge) @ pose[:d, :d].T + pose[:d, d]) for edge in edges]
    return {
        "title": f"{model.name}: {result.status.replace('_', ' ')} after {result.touches} guarded moves",
        "dimension": d,
        "workspace": _rounded(unit_mm * result.workspace),
        "part": [_rounded(line) for line in lines],
        "radius": tip_radius,
        "times": _rounded(times[kept], 3),
        "tips": _rounded(recording.column("tip")[kept]),
        "bases": _rounded(recording.column("base")[kept]),
        "forces": _rounded(peaks),
        "states": recording.states[kept].tolist(),
        "names": list(STATES),
        "steps": _steps(recording, result, unit_mm),
    }


def _steps(recording: Recording, result: Result, unit_mm: float) -> list[dict[str, Any]]:
    """Guarded moves with the time of their end, what they met, and how many hypotheses were left."""
    ends = [segment.end for segment in recording.segments if segment.kind == "touch"]
    told: list[dict[str, Any]] = []
    for end, step in zip(ends, result.steps[len(result.steps) - len(ends) :], strict=True):
        entry: dict[str, Any] = {
            "end": round(end, 3),
            "purpose": step.purpose,
            "line": _rounded(unit_mm * np.array([step.start, step.end])),
            "reply": type(step.reply).__name__,
            "left": None if step.hypotheses is None else len(step.hypotheses),
        }
        if isinstance(step.reply, Hit):
            contact = step.reply.contact
            center = unit_mm * np.asarray(contact.center)
            entry["center"] = _rounded(center)
            if contact.normal is not None:
                entry["needle"] = _rounded(center + NEEDLE * np.asarray(contact.normal))
        elif isinstance(step.reply, Skid):
            entry["center"] = _rounded(unit_mm * np.asarray(step.reply.free.end))
        told.append(entry)
    return told


def _rounded(values: Array, digits: int = 2) -> Sequence[Any]:
    return list(np.round(np.asarray(values, dtype=float), digits).tolist())
