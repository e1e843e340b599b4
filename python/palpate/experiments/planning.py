"""The tables of docs/planning-figures.md, from what the Rust examples of planning measured.

python -m palpate.experiments.planning target/figures docs/planning-figures.md

A part whose figures are not in the folder stays as it is.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from .pages import Figures, digits, duration, machine, rewrite, share, table

PLANNERS = ("auto", "ellis", "grimson", "schneiter")
WAYS = {
    "greedy": "`complete`, greedy tree",
    "ahead": "`complete`, looking ahead",
    "optimal": "`complete`, optimal tree",
    "ellis": "`ellis`, greedy tree",
    "best of 500": "best of 500 random lines by information gain",
    "one line": "one random line",
    "entropy": "entropy bound",
}
QUANTILES = {"median": "median", "q90": "90 %", "q99": "99 %", "max": "longest"}
ROUNDING = 1e-9


def campaign(lines: list[Figures]) -> str:
    """How often each planner reaches `complete`, and whether anything was better than it."""
    header, problems = lines[0], lines[1:]
    families = list(dict.fromkeys(one["family"] for one in problems))
    rows = []
    for family in [*families, "all"]:
        some = [one for one in problems if family in (one["family"], "all")]
        worse = [one for one in some if one["better"]]
        cells = [
            len(some),
            sum(one["proved"] for one in some),
            sum(one["proved"] for one in worse),
            sum(not one["proved"] for one in worse),
            *(sum(_reaches(one, planner) for one in some) for planner in PLANNERS),
        ]
        rows.append([family, *(f"{cell:,}" for cell in cells)])
    columns = ["problems", "proved", "beaten, proved", "beaten, cut short"]
    judged = sum(one["judged"] for one in problems)
    return "\n\n".join(
        [
            f"{len(problems):,} problems, {header['lines']:,} random lines each, of which {judged:,} needed "
            f"the judge; `complete` examined up to {header['effort']:,} boxes.",
            table(["", *columns, *(f"`{name}` reaches it" for name in PLANNERS)], rows),
        ]
    )


def _reaches(problem: Figures, planner: str) -> bool:
    own, least = problem["others"][planner]["score"], problem["complete"]["score"]
    return own is not None and (least is None or own <= least + ROUNDING)


def promises(figures: Figures) -> str:
    """Simulated readings and broken promises."""
    contacts = figures["readings"] - figures["misses"]
    return (
        f"{figures['readings']:,} simulated readings ({contacts:,} contacts, {figures['misses']:,} misses) "
        f"of {figures['paths']:,} usable paths, of {figures['problems']:,} problems. "
        f"The truth was not in `outcome_of`: {figures['lost']}. "
        f"Outside of the promised class, or separated from the truth: {figures['broken']}. "
        f"Touched at more than Ω: {figures['skids']}."
    )


def touches(figures: Figures) -> str:
    """Mean expected touches of each way to choose."""
    families = figures["families"]
    rows = [[name, *(f"{one['mean'][way]:.3f}" for one in families.values())] for way, name in WAYS.items()]
    more: dict[str, Callable[[Figures], str]] = {
        "hypotheses, mean": lambda one: f"{one['hypotheses']:.2f}",
        "greedy / optimal, of the means": lambda one: f"{one['greedy_over_optimal']:.4f}",
        "greedy / optimal, at most": lambda one: f"{one['worst_greedy_over_optimal']:.3f}",
        "greedy is as good as optimal": lambda one: str(one["greedy_is_optimal"]),
        "proved that no tree at all is better": lambda one: str(one["proved_optimal"]),
        "`ellis` or the best of 500 is better than optimal": lambda one: str(one["optimal_is_beaten"]),
        "all told apart": lambda one: str(one["solved"]),
    }
    rows += [[name, *(of(one) for one in families.values())] for name, of in more.items()]
    return "\n\n".join(
        [
            f"{figures['problems']} problems of each kind, 2 to 12 hypotheses; {figures['effort']:,} boxes.",
            table(["", *families], rows),
        ]
    )


def speed(figures: Figures) -> str:
    """Times on one core, and the fitted growth."""
    parts = {
        "`auto`, first path, 2 to 30 hypotheses": figures["first_path"],
        "`auto`, whole tree, 20 to 25 hypotheses": figures["tree"],
        "`complete`, to its proof or its effort, 20 to 25 hypotheses": figures["proof"],
        "`auto`, one path, 100 hypotheses of 12 faces": figures["hundred"],
    }
    rows = [
        [name, *(duration(one["seconds"][key]) for key in QUANTILES), str(one["seconds"]["count"])]
        for name, one in parts.items()
    ]
    proof, growth = figures["proof"], figures["growth"]
    first = figures["first_path"]
    perfect = first["perfect"] / first["seconds"]["count"]
    sizes = [
        [
            str(one["faces"]),
            duration(one["auto"]["median"]),
            duration(one["complete"]["median"]),
            duration(one["complete"]["max"]),
            f"{one['proved']} of {one['complete']['count']}",
        ]
        for one in growth
    ]
    return "\n\n".join(
        [
            f"Measured on: {machine()}; one of them is used.",
            table(["", *QUANTILES.values(), "problems"], rows),
            f"`complete` proved {proof['proved']} of {proof['seconds']['count']} within {proof['effort']:,} "
            f"boxes; median {digits(proof['boxes']['median'])} boxes. "
            f"All trees of 20 to 25 hypotheses expect {figures['tree']['expected_touches']:.2f} touches in "
            f"the mean; {share(perfect)} of the first paths are perfect.",
            f"Growth with the faces of a part, {figures['grown']} hypotheses, "
            f"m = {figures['margin']:g} of the part:",
            table(["faces", "`auto`", "`complete`", "at most", "proved"], sizes),
            f"Fitted to the medians: `auto` takes faces^{_exponent(growth, 'auto'):.2f}. The times of "
            "`complete` depend on the problem far more than on the number of faces.",
        ]
    )


def counts(figures: Figures) -> str:
    """Operations of the thesis's search beside what its section 3.5 expects."""
    one = figures["counts"]
    ratio = one["candidates"] / max(1, one["generators"])
    rows = [
        [
            "inner products of normals, for candidate sets",
            "M(M − 1)/2 + MK",
            f"{one['inner_products_thesis']:,}",
            f"{one['inner_products']:,}",
        ],
        [
            "critical points examined",
            "4N + 3 for each generator",
            f"{one['critical_points_thesis']:,}",
            f"{one['critical_points']:,}",
        ],
        ["critical points kept", "", "", f"{one['critical_kept']:,}"],
        ["overlaps tested", "", "", f"{one['overlaps']:,}"],
        ["paths evaluated", "", "", f"{one['paths']:,}"],
    ]
    return "\n\n".join(
        [
            f"{one['problems']} problems, {one['generators']:,} generators searched before a perfect path or "
            f"the end; a candidate set has {ratio:.1f} members in the mean over generators.",
            table(["", "the thesis's count", "that is", "counted"], rows),
        ]
    )


def _exponent(growth: list[Figures], planner: str) -> float:
    faces = np.log([one["faces"] for one in growth])
    return float(np.polyfit(faces, np.log([one[planner]["median"] for one in growth]), 1)[0])


def main() -> None:
    """Write the tables anew whose figures there are."""
    parser = argparse.ArgumentParser(description="the tables of docs/planning-figures.md")
    parser.add_argument("figures", type=Path, help="folder with what the examples printed")
    parser.add_argument("page", type=Path, help="page of the documentation that is written anew")
    given = parser.parse_args()
    lines = given.figures / "campaign_plan.jsonl"
    if lines.exists():
        whole = lines.read_text(encoding="utf-8").splitlines()
        rewrite(given.page, "campaign", campaign([json.loads(line) for line in whole]))
    parts = {"promises": promises, "promises_space": promises, "touches": touches, "plan_speed": speed}
    for name, part in parts.items():
        path = given.figures / f"{name}.json"
        if path.exists():
            rewrite(given.page, name, part(json.loads(path.read_text(encoding="utf-8"))))
            if name == "plan_speed":
                rewrite(given.page, "counts", counts(json.loads(path.read_text(encoding="utf-8"))))


if __name__ == "__main__":
    main()
