"""Random problems of space, thousands of them: is anything true lost, is anything false kept?

    python -m palpate.experiments.public_parts
    python -m palpate.experiments.campaign_space --problems 10000 --parts target/parts --cluster local
    python -m palpate.experiments.campaign_space --parts target/parts --family no-normals --problems 1000
    python -m palpate.experiments.campaign_space --parts target/parts --replay 4711

Problem `k` of campaign `s` has the seed `s · 10⁹ + k`, that of one family the `k`-th of these seeds whose
problem is of it; with other parts it is another problem. What was checked is on disk after every chunk;
killed and started again, the campaign goes on where it was, and its summary is the same but for answers that
were cut after `MOST_SECONDS`. With `--page` the tables of that page are written anew.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Sequence
from functools import cache, partial
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np

from . import campaign, checked, pages
from .campaign import Row
from .public_parts import load_parts
from .solid_checks import FAULTS, check
from .solid_problems import FAMILIES, family_of, random_problem
from .solids import Solid

NAME = "campaign-space"
CHUNK = 20
MOST_LETTERS = 600
COUNTERS = {
    "problems": "problems",
    **FAULTS,
    "incomplete": "incomplete answer",
    "incomplete_without_truth": "incomplete without the truth",
    "marginal": "truth marginal",
    "hypotheses": "hypotheses",
    "interpretations": "interpretations",
    "poses_checked": "poses checked",
    "searched": "poses found by search",
    "others": "other valid poses tried",
    "contained": "other poses contained",
}
#: What is looked at, and what must not come of it.
CHECKS = {
    "problems": ("truths_lost", "poses_lost", "errors"),
    "others": ("valid_poses_lost",),
    "contained": ("falsely_contained",),
    "poses_checked": ("invalid_witnesses", "invalid_samples", "bounds_exceeded"),
}


@cache
def parts_in(folder: str | None) -> tuple[Solid, ...]:
    """The parts in a folder, in the order of its manifest; none without a folder."""
    return tuple(load_parts(Path(folder))) if folder else ()


def digest(folder: str | None) -> int:
    """Of the parts in a folder: rows of other parts are of other problems. 0 without a folder."""
    total = 0
    for solid in parts_in(folder):
        total = zlib.crc32(solid.vertices.tobytes() + solid.triangles.tobytes(), total)
    return total


@cache
def seeds_of(problems: int, seed: int, family: str | None) -> Sequence[int]:
    """The seeds of the first `problems` of a campaign, all or those of one family."""
    first = seed * checked.SEEDS_PER_CAMPAIGN
    if family is None:
        return range(first, first + problems)
    return list(islice((one for one in count(first) if family_of(one) == family), problems))


def task(chunk: int, *, problems: int, seed: int, family: str | None, parts: str | None, digest: int) -> Row:
    """Check a chunk of the first `problems` of a campaign."""
    seeds = seeds_of(problems, seed, family)[CHUNK * chunk : CHUNK * (chunk + 1)]
    outcomes = [check(one, parts_in(parts)) for one in seeds]
    return {
        **checked.row_of(outcomes),
        "hypotheses": [(one.family, one.counts["hypotheses"]) for one in outcomes],
        "seconds": [(one.family, round(one.seconds, 4), one.seed) for one in outcomes],
    }


def run(settings: Row, out: Path, *, cluster: str | None, page: Path | None) -> bool:
    """Check all problems, write and print the summary; whether nothing was wrong."""
    chunks = range(-(-settings["problems"] // CHUNK))
    rows = campaign.run(NAME, settings, chunks, task, out / "rows.jsonl", cluster=cluster)
    said = {key: value for key, value in settings.items() if key != "parts"}
    summary = checked.summary_of(said, rows, families=FAMILIES, faults=FAULTS)
    title = f"{summary['problems']} random problems of space, seed {summary['seed']}"
    table = checked.table_of(title, summary, COUNTERS, faults=FAULTS)
    times = by_family(rows, "seconds")
    names = [*FAMILIES, "total"]
    spreads = [spread(times[name]) for name in names]
    for which, column in zip(("median", "90 %", "largest"), zip(*spreads, strict=True), strict=True):
        table.add_row(f"seconds of the core, {which}", *column)
    slowest = ((seconds, seed) for row in rows for _, seconds, seed in row["seconds"])
    good = checked.write(summary, table, slowest, out=out, most_letters=MOST_LETTERS)
    if page:
        family = settings["family"]
        pages.rewrite(page, f"{NAME}-{family}" if family else NAME, section(summary, rows))
    return good


def by_family(rows: list[Row], key: str) -> dict[str, list[float]]:
    """A number of each problem, by family and of all."""
    found: dict[str, list[float]] = {name: [] for name in (*FAMILIES, "total")}
    for row in rows:
        for family, value, *_ in row[key]:
            found[family].append(value)
            found["total"].append(value)
    return found


def spread(times: list[float]) -> tuple[str, str, str]:
    """Median, 90th percentile and largest of some seconds; nothing of none."""
    if not times:
        return ("", "", "")
    median, most = np.quantile(times, [0.5, 0.9])
    return (pages.duration(median), pages.duration(most), pages.duration(max(times)))


def section(summary: dict[str, Any], rows: list[Row]) -> str:
    """The part of the page that is made: by family, and what was checked how often."""
    times, hypotheses = by_family(rows, "seconds"), by_family(rows, "hypotheses")
    lines = []
    for name, counts in {**summary["families"], "total": summary["total"]}.items():
        if not counts.get("problems") or (name == "total" and summary["family"]):
            continue
        lost = sum(counts.get(fault, 0) for fault in ("truths_lost", "poses_lost"))
        lines.append(
            [
                "all" if name == "total" else name,
                f"{counts['problems']:,}",
                f"{100.0 * (1.0 - counts.get('incomplete', 0) / counts['problems']):.1f} %",
                f"{np.median(hypotheses[name]):g}",
                f"{lost}",
                f"{counts.get('incomplete_without_truth', 0)}",
                *spread(times[name]),
            ]
        )
    head = [
        "family",
        "problems",
        "complete",
        "hypotheses, median",
        "truth lost",
        "incomplete without the truth",
    ]
    families = pages.table([*head, "time, median", "time, 90 %", "time, largest"], lines)
    total = summary["total"]
    checks = pages.table(
        ["what must not be", "faults", "looked at"],
        [
            [FAULTS[fault], f"{total.get(fault, 0)}", f"{total.get(looked, 0):,} {COUNTERS[looked]}"]
            for looked, faults in CHECKS.items()
            for fault in faults
        ],
    )
    said = "Times are those of `recognize`, a part's tables included when it is seen first in a process"
    return f"{families}\n\n{checks}\n\n{said}: {pages.machine()}."


def replay(seed: int, parts: str | None) -> bool:
    """Print the problem of a seed and what is wrong with its answer."""
    problem = random_problem(seed, parts_in(parts))
    names = [f"{solid.name} ({solid.num_faces} faces)" for solid in problem.solids]
    sys.stdout.write(f"# seed {seed}, {problem.family}; {', '.join(names)}; true is {problem.true}\n")
    sys.stdout.write(f"contacts = {list(problem.contacts)!r}\nmisses = {list(problem.misses)!r}\n")
    sys.stdout.write(f"prior = {problem.prior!r}\ntruth = {problem.world_from_model.tolist()}\n")
    return checked.say(check(seed, parts_in(parts)))


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if nothing was wrong."""
    parser = checked.parser_of(NAME, (__doc__ or "").splitlines()[0], problems=10_000)
    parser.add_argument(
        "--parts", type=Path, help="folder of public_parts; else only parts that are made here"
    )
    parser.add_argument("--family", choices=FAMILIES, help="only problems of this family")
    parser.add_argument("--out", type=Path, help=f"folder of the results (out/{NAME}, or out/{NAME}-FAMILY)")
    parser.add_argument("--page", type=Path, help="write the tables of this page anew")
    options = checked.parsed(parser, arguments)
    folder = str(options.parts.resolve()) if options.parts else None
    if folder and not parts_in(folder):
        parser.error(f"--parts: {str(options.parts)!r} has no parts; fetch them with public_parts")
    if options.replay is not None:
        return 0 if replay(options.replay, folder) else 1
    settings = {
        "problems": options.problems,
        "seed": options.seed,
        "family": options.family,
        "parts": folder,
        "digest": digest(folder),
    }
    out = options.out or Path("out") / (f"{NAME}-{options.family}" if options.family else NAME)
    return checked.ended(parser, partial(run, settings, out, cluster=options.cluster, page=options.page))


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import campaign_space

    sys.exit(campaign_space.main())
