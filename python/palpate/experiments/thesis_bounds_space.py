"""The thesis's own bounds in space in docs/accuracy.md, from what `thesis_bounds_space` of the core measured.

python -m palpate.experiments.thesis_bounds_space FIGURES.json docs/accuracy.md
"""

from __future__ import annotations

from collections.abc import Callable

from .pages import Figures, arguments, digits, rewrite, share, table

QUANTILES = {"median": "median", "q90": "90 %", "q99": "99 %"}


def section(figures: Figures) -> str:
    """A table of nominal poses, and one of bounds, with a row for each number of contacts."""
    rows: list[Figures] = figures["rows"]
    nominal = [
        "least squares: a pose of the set",
        "axis and angle: a pose of the set",
        "least squares: no translation found",
        *(f"apart, {name}" for name in QUANTILES.values()),
    ]
    parts = ["### Nominal poses", _table(rows, nominal, _nominal)]
    for title, key in (
        ("2Φ, of two normals, against the sampled extent of rotations", "residual"),
        ("Eq. 2.5, a turn about one axis, against the largest sampled rotation from the nominal one", "turn"),
        ("E_T against the largest sampled translation at the nominal rotation", "translation"),
        ("`rotation_bound` against the sampled extent of rotations", "bound"),
    ):
        columns = [*QUANTILES.values(), "too small"]
        parts += [f"### {title}", _table(rows, columns, _bound(key))]
    return "\n\n".join(parts)


def _table(rows: list[Figures], header: list[str], cells: Callable[[Figures], list[str]]) -> str:
    first = ["contacts", *header, "interpretations"]
    return table(first, [[row["contacts"], *cells(row), str(row["interpretations"])] for row in rows])


def _nominal(row: Figures) -> list[str]:
    apart = [f"{digits(row['first_away_deg'][key])}°" for key in QUANTILES]
    shares = [share(row[key]) for key in ("nominal_valid", "first_valid", "none_at_nominal")]
    return [*shares, *apart]


def _bound(key: str) -> Callable[[Figures], list[str]]:
    def cells(row: Figures) -> list[str]:
        quantiles = [digits(row[key][name]) for name in QUANTILES]
        return [*quantiles, share(row[f"{key}_smaller"])]

    return cells


def main() -> None:
    """Write the tables anew."""
    figures, page = arguments("the tables of the thesis's own bounds in space in docs/accuracy.md")
    rewrite(page, "thesis-bounds-space", section(figures))


if __name__ == "__main__":
    main()
