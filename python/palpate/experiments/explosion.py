"""The table of exploding assignments in docs/speed.md, from what the Rust example `explosion` measured.

python -m palpate.experiments.explosion FIGURES.json docs/speed.md
"""

from __future__ import annotations

from statistics import median

from .pages import Figures, arguments, duration, rewrite, table

HEADER = [
    "part",
    "±, normals ±",
    "contacts",
    "median",
    "longest",
    "hypotheses",
    "most interpretations, at least",
    "listing ten of each",
    "memory",
]


def section(figures: Figures) -> str:
    """A row for each case, and what the cases together say."""
    cases: list[Figures] = figures["cases"]
    problems = [problem for case in cases for problem in case["problems"]]
    late = sum(not case["in_time"] for case in cases)
    lost = sum(not problem["true_pose_contained"] for problem in problems)
    cut = sum(not problem["complete"] for problem in problems)
    uncounted = sum(not problem["interpretations"] for problem in problems)
    summary = (
        f"{len(problems)} problems, {figures['problems']} in each case. True pose in no hypothesis: {lost}. "
        f"Answers that are not complete: {cut}. Cases stopped after {figures['longest']} s: {late}. "
        f"Problems without an interpretation among the 10,000 choices tried for a count: {uncounted}."
    )
    return "\n\n".join([table(HEADER, [_row(case, figures["longest"]) for case in cases]), summary])


def _row(case: Figures, longest: int) -> list[str]:
    bounds = f"{case['position_error']:g}, {case['normal_error_deg']:g}°"
    found: list[Figures] = case["problems"]
    start = [case["part"], bounds, str(case["contacts"])]
    if not found or not case["in_time"]:
        return [*start, "—", f"more than {longest} s", *("—" for _ in HEADER[5:])]
    times = [problem["seconds"] for problem in found]
    memory = [problem["peak_bytes"] for problem in found if problem["peak_bytes"]]
    return [
        *start,
        duration(median(times)),
        duration(max(times)),
        _range([problem["hypotheses"] for problem in found]),
        f"{max(problem['interpretations'] for problem in found):,}",
        duration(max(problem["listing"]["seconds"] for problem in found)),
        f"{max(memory) / 1e6:.0f} MB" if memory else "—",
    ]


def _range(values: list[int]) -> str:
    low, high = min(values), max(values)
    return str(low) if low == high else f"{low} to {high}"


def main() -> None:
    """Write the table anew."""
    figures, page = arguments("the table of exploding assignments in docs/speed.md")
    rewrite(page, "explosion", section(figures))


if __name__ == "__main__":
    main()
