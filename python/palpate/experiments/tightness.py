"""The table of tightness in docs/accuracy.md, from what the Rust example `tightness` measured.

python -m palpate.experiments.tightness FIGURES.json docs/accuracy.md
"""

from __future__ import annotations

from .pages import Figures, arguments, rewrite, table

COLUMNS = {"median": "median", "q90": "90 %", "q99": "99 %", "max": "largest"}
ROWS = (
    ("interpretation", "rotation", "`rotation_bound` of an interpretation"),
    ("interpretation", "excursion", "`excursion` of an interpretation"),
    ("hypothesis", "rotation", "`rotation_bound` of a hypothesis"),
    ("hypothesis", "excursion", "`excursion` of a hypothesis"),
)


def section(figures: Figures) -> str:
    """The table, and whether any bound was too small."""
    rows = []
    for kind, bound, name in ROWS:
        spread = figures[kind][bound]
        rows.append([name, *(f"{spread[key]:.4f}" for key in COLUMNS), f"{spread['count']:,}"])
    too_small = sum(sum(figures[kind]["below_one"]) for kind in ("interpretation", "hypothesis"))
    return "\n\n".join(
        [
            table(["bound / sampled", *COLUMNS.values(), "problems"], rows),
            f"Bounds that were smaller than what sampling found: {too_small}.",
        ]
    )


def main() -> None:
    """Write the table anew."""
    figures, page = arguments("the table of tightness in docs/accuracy.md")
    rewrite(page, "tightness", section(figures))


if __name__ == "__main__":
    main()
