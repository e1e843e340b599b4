"""Tables of closed loops, from the rows of their campaigns, in Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import get_args

import numpy as np

from palpate.experiments.campaign import Row
from palpate.experiments.pages import digits, share, table
from palpate.loop.result import Status

WAYS = {
    "loop": "`identify`",
    "entropy": "most entropy, 500 random lines",
    "nominal": "nominal poses told apart best, 500 random lines",
    "chance": "random lines",
}
SEVERAL = ("inseparable", "no_usable_path")
STATUSES = [status for status in get_args(Status) if status != "interrupted"]


def ends(groups: dict[str, list[Row]]) -> str:
    """How the loops of each group end, and whether what is left is true; a row for each group."""
    header = ["", "loops", "lost", "contradicted", *(f"`{status}`" for status in STATUSES), "`budget`, share"]
    rows = []
    for name, members in groups.items():
        status = Counter(row["status"] for row in members)
        rows.append(
            [
                name,
                f"{len(members):,}",
                str(sum(row["lost"] for row in members)),
                str(sum(row["contradicted"] for row in members)),
                *(f"{status[one]:,}" for one in STATUSES),
                share(status["budget"] / len(members)),
            ]
        )
    return table(header, rows)


def by_noise(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Groups of rows: errors within the bounds, at the bounds, and all."""
    names = {"uniform": "errors within the bounds", "bounds": "errors at the bounds"}
    groups = {title: [row for row in rows if row["noise"] == name] for name, title in names.items()}
    return {**{title: some for title, some in groups.items() if some}, "all": list(rows)}


def by_part(rows: Sequence[Row]) -> str:
    """Touches, hypotheses after the first contacts and times for each part."""
    header = [
        "part",
        "loops",
        "scans",
        "hypotheses then",
        "touches, mean",
        "95 %",
        "most",
        "s, median",
        "95 %",
    ]
    parts = dict.fromkeys(row["part"] for row in rows)
    groups = {part: [row for row in rows if row["part"] == part] for part in parts}
    return table(header, (_part(name, members) for name, members in {**groups, "all": list(rows)}.items()))


def _part(name: str, rows: Sequence[Row]) -> list[str]:
    touches = [row["touches"] for row in rows]
    seconds = [row["seconds"]["loop"] for row in rows]
    return [
        name,
        f"{len(rows):,}",
        digits(_mean(row["scans"] for row in rows)),
        digits(_mean(row["first"] for row in rows)),
        digits(_mean(touches)),
        f"{np.percentile(touches, 95):.0f}",
        str(max(touches)),
        digits(float(np.median(seconds))),
        digits(float(np.percentile(seconds, 95))),
    ]


def beside(groups: dict[str, list[Row]]) -> str:
    """Touches of the loop and its rivals after the first contacts, where those left several hypotheses."""
    most = 6
    header = [
        "",
        "problems",
        "open",
        "solved",
        "touches, mean",
        *map(str, range(1, most + 1)),
        f"more than {most}",
        "most",
        "s, mean",
    ]
    lines = []
    for title, rows in groups.items():
        open_rows = [row for row in rows if row["first"] > 1]
        for name in [name for name in WAYS if open_rows and (name == "loop" or name in open_rows[0])]:
            lines.append(_way(title, name, rows, open_rows=open_rows, most=most))
    return table(header, lines)


def _way(title: str, name: str, rows: list[Row], *, open_rows: list[Row], most: int) -> list[str]:
    def of(row: Row) -> Row:
        return row if name == "loop" else row[name]

    later = [of(row)["touches"] - row["before"] for row in open_rows]
    counts = Counter(min(count, most + 1) for count in later)
    return [
        f"{title}: {WAYS[name]}",
        f"{len(rows):,}",
        f"{len(open_rows):,}",
        share(sum(of(row)["status"] == "solved" for row in open_rows) / len(open_rows)),
        digits(_mean(later)),
        *(str(counts[count]) for count in range(1, most + 2)),
        str(max(later)),
        digits(_mean(row["seconds"][name] for row in open_rows)),
    ]


def distribution(rows: Sequence[Row]) -> str:
    """How many loops need how many guarded moves."""
    counts = Counter(_band(row["touches"]) for row in rows)
    bands = sorted(counts)
    return table(
        ["guarded moves", *(_named(band) for band in bands)],
        [["loops", *(f"{counts[band]:,}" for band in bands)]],
    )


def _band(count: int) -> int:
    return count if count <= 10 else 10 + 5 * -(-(count - 10) // 5)


def _named(band: int) -> str:
    return str(band) if band <= 10 else f"{band - 4}–{band}"


def _mean(values: Iterable[float]) -> float:
    return float(np.mean(list(values)))


def strangers(groups: dict[str, list[Row]]) -> str:
    """What is said where the conditions of the promise don't hold; a row for each group."""
    header = [
        "",
        "loops",
        "contradicted",
        "`unexplained`",
        "solved, the truth",
        "solved, something else that fits",
        "several left",
        "cut short",
        "touches, mean",
    ]
    lines = []
    for name, rows in groups.items():
        solved = [row for row in rows if row["status"] == "solved"]
        other = sum(row["lost"] for row in solved)
        several = sum(row["status"] in SEVERAL for row in rows)
        unexplained = sum(row["status"] == "unexplained" for row in rows)
        lines.append(
            [
                name,
                f"{len(rows):,}",
                str(sum(row["contradicted"] for row in rows)),
                f"{unexplained:,}",
                f"{len(solved) - other:,}",
                f"{other:,}",
                f"{several:,}",
                f"{len(rows) - len(solved) - unexplained - several:,}",
                digits(_mean(row["touches"] for row in rows)),
            ]
        )
    return table(header, lines)
