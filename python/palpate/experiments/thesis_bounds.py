"""The thesis's own bounds in docs/accuracy.md, from what the Rust example `thesis_bounds` measured.

python -m palpate.experiments.thesis_bounds FIGURES.json docs/accuracy.md
"""

from __future__ import annotations

from collections.abc import Callable

from .pages import Figures, arguments, digits, rewrite, share, table


def section(figures: Figures) -> str:
    """One table for each of the thesis's figures, with a row for each kind of problem."""
    rows: list[Figures] = figures["rows"]
    parts = [
        "### Rotation: γ against the exact range",
        _table(rows, ["equal", "γ larger", "γ smaller", "median", "90 %", "99 %"], _rotation),
        "### Nominal pose: is it one of the poses?",
        _table(rows, ["at φ: not valid", "at θ: not valid", "no translation at φ is valid"], _nominal),
        "### Translation: E_T against the exact spread at φ",
        _table(rows, ["equal", "E_T smaller", "median", "90 %", "99 %"], _translation),
        "### Excursion: the exact one against E_q, and palpate's bound against the exact one",
        _table(
            rows,
            [
                "E_q too small",
                "less than half",
                "exact / E_q: median",
                "90 %",
                "99 %",
                "palpate / exact: median",
                "99 %",
            ],
            _excursion,
        ),
    ]
    return "\n\n".join(parts)


def _table(rows: list[Figures], header: list[str], cells: Callable[[Figures], list[str]]) -> str:
    first = ["±, normals ±, contacts", *header, "interpretations"]
    return table(first, [[_problem(row), *cells(row), str(row["interpretations"])] for row in rows])


def _problem(row: Figures) -> str:
    return f"{row['position_error']:g}, {row['normal_error_deg']:g}°, {row['contacts']}"


def _quantiles(spread: Figures, keys: tuple[str, ...]) -> list[str]:
    return [digits(spread[key]) for key in keys]


def _rotation(row: Figures) -> list[str]:
    found = row["rotation"]
    shares = [share(found[key]) for key in ("equal", "larger", "smaller")]
    return [*shares, *_quantiles(found["ratio"], ("median", "q90", "q99"))]


def _nominal(row: Figures) -> list[str]:
    return [
        share(row["nominal_invalid"]),
        share(row["first_invalid"]),
        share(row["translation"]["none_at_nominal"]),
    ]


def _translation(row: Figures) -> list[str]:
    found = row["translation"]
    shares = [share(found[key]) for key in ("equal", "smaller")]
    return [*shares, *_quantiles(found["ratio"], ("median", "q90", "q99"))]


def _excursion(row: Figures) -> list[str]:
    found = row["excursion"]
    shares = [share(found[key]) for key in ("underestimates", "less_than_half")]
    exact = _quantiles(found["exact_over_printed"], ("median", "q90", "q99"))
    return [*shares, *exact, *_quantiles(found["bound_over_exact"], ("median", "q99"))]


def main() -> None:
    """Write the tables anew."""
    figures, page = arguments("the tables of the thesis's own bounds in docs/accuracy.md")
    rewrite(page, "thesis-bounds", section(figures))


if __name__ == "__main__":
    main()
