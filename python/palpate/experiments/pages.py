"""Pages of the documentation, parts of which a command writes anew.

Such a part stands between two lines, `<!-- made: NAME -->` and `<!-- end: NAME -->`; the rest of a page
is its author's.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

Figures = dict[str, Any]


def arguments(what: str) -> tuple[Figures, Path]:
    """The figures and the page that the command line names; `what` says in a line what becomes of them."""
    parser = argparse.ArgumentParser(description=what)
    parser.add_argument("figures", type=Path, help="JSON that the Rust example of the same name prints")
    parser.add_argument("page", type=Path, help="page of the documentation that is written anew")
    given = parser.parse_args()
    return json.loads(given.figures.read_text(encoding="utf-8")), given.page


def rewrite(page: Path, name: str, text: str) -> None:
    """Put `text` in the place of the part `name`.

    Raises:
        ValueError: If the page has no such part.
    """
    begin, end = f"<!-- made: {name} -->", f"<!-- end: {name} -->"
    old = page.read_text(encoding="utf-8")
    head, found, rest = old.partition(begin)
    _, closed, tail = rest.partition(end)
    if not (found and closed):
        raise ValueError(f"{page}: has no part {begin} … {end}; add the two lines where the text belongs")
    new = f"{head}{begin}\n\n{text.strip()}\n\n{end}{tail}"
    partial = page.with_name(f".{page.name}.{os.getpid()}")
    partial.write_text(new, encoding="utf-8")
    partial.replace(page)


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; all columns but the first are aligned to the right."""
    rule = ["---", *("---:" for _ in header[1:])]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [header, rule, *rows])


def duration(seconds: float) -> str:
    """In the unit that suits it, to two or three digits."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{digits(seconds / size)} {unit}"
    return f"{digits(seconds / 1e-9)} ns"


def digits(value: float) -> str:
    """To three digits, none after the point that say nothing."""
    if value >= 100.0:
        return f"{value:,.0f}"
    return f"{value:.1f}" if value >= 10.0 else f"{value:.2f}"


def share(value: float) -> str:
    """A share as a percentage."""
    if 0.0 < value < 0.01:
        return f"{100.0 * value:.1f} %"
    return f"{100.0 * value:.0f} %"


def machine() -> str:
    """The kind of processor and the number of its cores, where the system says."""
    cores = os.cpu_count() or 1
    listing = Path("/proc/cpuinfo")
    names: list[str] = []
    if listing.exists():
        lines = listing.read_text(encoding="utf-8").splitlines()
        names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    kind = names[0] if names else "unknown processor"
    return f"{kind}, {cores} core{'s' if cores > 1 else ''}"
