"""Which build computes: rows of two builds must not be mixed, even if both are called the same version."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import palpate
from palpate import _core


@cache
def build() -> str:
    """A hash of the core as it is loaded and of the package's Python sources, hexadecimal."""
    folder = Path(palpate.__file__).parent
    made = hashlib.sha256()
    for file in [Path(_core.__file__), *sorted(folder.rglob("*.py"))]:
        name = file.relative_to(folder).as_posix() if file.suffix == ".py" else "_core"
        made.update(f"{name}\0{hashlib.sha256(file.read_bytes()).hexdigest()}\n".encode())
    return made.hexdigest()[:32]
