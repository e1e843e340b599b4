"""Random problems of space, thousands of them: is anything true lost, is anything false kept?

    python -m palpate.experiments.public_parts
    python -m palpate.experiments.campaign_space --problems 10000 --parts target/parts --cluster local
    python -m palpate.experiments.campaign_space --parts target/parts --replay 4711

Problem `k` of campaign `s` has the seed `s · 10⁹ + k`; with other parts it is another problem. What was
checked is on disk after every chunk; killed and started again, the campaign goes on where it was, and its
summary is the same.
"""

from __future__ import annotations

import argparse
import json
import sys
import zlib
from collections import Counter
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from palpate import __version__

from . import campaign
from .campaign import Row
from .public_parts import load_parts
from .solid_checks import FAULTS, check
from .solid_problems import FAMILIES, random_problem
from .solids import Solid

CHUNK = 20
SEEDS_PER_CAMPAIGN = 10**9
MOST_SLOW = 8


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


def task(chunk: int, *, problems: int, seed: int, parts: str | None, digest: int) -> Row:
    """Check a chunk of the first `problems` of a campaign."""
    first = seed * SEEDS_PER_CAMPAIGN
    numbers = range(CHUNK * chunk, min(CHUNK * (chunk + 1), problems))
    outcomes = [check(first + number, parts_in(parts)) for number in numbers]
    families: dict[str, Counter[str]] = {}
    for one in outcomes:
        families.setdefault(one.family, Counter()).update(one.counts)
    return {
        "families": families,
        "faults": [{"seed": one.seed, "said": one.faults} for one in outcomes if one.faults],
        "seconds": _slowest((round(one.seconds, 3), one.seed) for one in outcomes),
        "hypotheses": [one.counts["hypotheses"] for one in outcomes],
    }


def _slowest(times: Iterable[tuple[float, int]]) -> list[tuple[float, int]]:
    return sorted(times, reverse=True)[:MOST_SLOW]


def summary_of(settings: Row, rows: list[Row]) -> dict[str, Any]:
    """Counts by family and in total, and every problem with a fault. No times: the same on every machine."""
    families = {family: Counter[str]() for family in FAMILIES}
    for row in rows:
        for family, counts in row["families"].items():
            families[family].update(counts)
    total: Counter[str] = sum(families.values(), Counter())
    return {
        "schema": "palpate-campaign",
        "version": 1,
        "palpate": __version__,
        **{key: value for key, value in settings.items() if key != "parts"},
        "faults": sum(total[fault] for fault in FAULTS),
        "total": dict(sorted(total.items())),
        "families": {family: dict(sorted(counts.items())) for family, counts in families.items()},
        "seeds_with_faults": [fault for row in rows for fault in row["faults"]],
    }


def table_of(summary: dict[str, Any]) -> Table:
    """The summary for a person."""
    table = Table(title=f"{summary['problems']} random problems of space, seed {summary['seed']}")
    table.add_column("")
    columns = {**summary["families"], "total": summary["total"]}
    for name in columns:
        table.add_column(name, justify="right")
    rows = {
        "problems": "problems",
        **FAULTS,
        "incomplete": "incomplete answer",
        "marginal": "truth marginal",
        "hypotheses": "hypotheses",
        "interpretations": "interpretations",
        "poses_checked": "poses checked",
        "searched": "poses found by search",
        "others": "other valid poses tried",
    }
    for key, title in rows.items():
        counts = [one.get(key, 0) for one in columns.values()]
        style = "bold red" if key in FAULTS and counts[-1] else None
        table.add_row(title, *map(str, counts), style=style)
    return table


def run(settings: Row, out: Path, *, cluster: str | None) -> bool:
    """Check all problems, write and print the summary; whether nothing was wrong."""
    chunks = range(-(-settings["problems"] // CHUNK))
    rows = campaign.run("campaign-space", settings, chunks, task, out / "rows.jsonl", cluster=cluster)
    summary = summary_of(settings, rows)
    (out / "summary.json").write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    console = Console(width=None if sys.stdout.isatty() else 120, highlight=False)
    console.print(table_of(summary))
    slowest = _slowest((seconds, seed) for row in rows for seconds, seed in row["seconds"])
    console.print("slowest:", ", ".join(f"seed {seed} {seconds:.2f} s" for seconds, seed in slowest))
    for fault in summary["seeds_with_faults"][:20]:
        console.print(f"seed {fault['seed']}: {'; '.join(fault['said'])[:600]}", markup=False)
    return summary["faults"] == 0


def replay(seed: int, parts: str | None) -> bool:
    """Print the problem of a seed and what is wrong with its answer."""
    problem = random_problem(seed, parts_in(parts))
    names = [f"{solid.name} ({solid.num_faces} faces)" for solid in problem.solids]
    sys.stdout.write(f"# seed {seed}, {problem.family}; {', '.join(names)}; true is {problem.true}\n")
    sys.stdout.write(f"contacts = {list(problem.contacts)!r}\nmisses = {list(problem.misses)!r}\n")
    sys.stdout.write(f"prior = {problem.prior!r}\ntruth = {problem.world_from_model.tolist()}\n")
    outcome = check(seed, parts_in(parts))
    sys.stdout.write(f"# {outcome.seconds:.3f} s, {dict(outcome.counts)}\n")
    for fault in outcome.faults or ["nothing is wrong"]:
        sys.stdout.write(f"# {fault}\n")
    return not outcome.faults


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if nothing was wrong."""
    parser = argparse.ArgumentParser(prog="campaign_space", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--problems", type=int, default=10_000, help="how many (10000)")
    parser.add_argument("--seed", type=int, default=0, help="which campaign (0)")
    parser.add_argument(
        "--parts", type=Path, help="folder of public_parts; else only parts that are made here"
    )
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/campaign-space"), help="folder of the results")
    parser.add_argument("--replay", type=int, metavar="SEED", help="check one problem, and print it")
    options = parser.parse_args(arguments)
    if options.problems < 1 or options.seed < 0:
        parser.error("--problems must be 1 or more, --seed 0 or more")
    folder = str(options.parts.resolve()) if options.parts else None
    if folder and not parts_in(folder):
        parser.error(f"--parts: {str(options.parts)!r} has no parts; fetch them with public_parts")
    if options.replay is not None:
        return 0 if replay(options.replay, folder) else 1
    try:
        settings = {"problems": options.problems, "seed": options.seed, "parts": folder}
        good = run({**settings, "digest": digest(folder)}, options.out, cluster=options.cluster)
    except (ValueError, ConnectionError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    return 0 if good else 1


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import campaign_space

    sys.exit(campaign_space.main())
