"""Random planar problems, thousands of them: is anything true lost, is anything false kept?

    python -m palpate.experiments.campaign_plane --problems 100000 --cluster local
    python -m palpate.experiments.campaign_plane --replay 4711

Problem `k` of campaign `s` has the seed `s · 10⁹ + k`. What was checked is on disk after every chunk; killed
and started again, the campaign goes on where it was, and its summary is the same.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from palpate import __version__

from . import campaign
from .campaign import Row
from .checks import FAULTS, check
from .problems import described, random_problem
from .random_parts import FAMILIES

CHUNK = 100
SEEDS_PER_CAMPAIGN = 10**9
MOST_SLOW = 8


def task(chunk: int, *, problems: int, seed: int) -> Row:
    """Check a chunk of the first `problems` of a campaign."""
    first = seed * SEEDS_PER_CAMPAIGN
    numbers = range(CHUNK * chunk, min(CHUNK * (chunk + 1), problems))
    outcomes = [check(first + number) for number in numbers]
    families: dict[str, Counter[str]] = {}
    for one in outcomes:
        families.setdefault(one.family, Counter()).update(one.counts)
    return {
        "families": families,
        "faults": [{"seed": one.seed, "said": one.faults} for one in outcomes if one.faults],
        "seconds": _slowest((round(one.seconds, 3), one.seed) for one in outcomes),
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
        **settings,
        "faults": sum(total[fault] for fault in FAULTS),
        "total": dict(sorted(total.items())),
        "families": {family: dict(sorted(counts.items())) for family, counts in families.items()},
        "seeds_with_faults": [fault for row in rows for fault in row["faults"]],
    }


def table_of(summary: dict[str, Any]) -> Table:
    """The summary for a person."""
    table = Table(title=f"{summary['problems']} random planar problems, seed {summary['seed']}")
    table.add_column("")
    columns = {**summary["families"], "total": summary["total"]}
    for name in columns:
        table.add_column(name, justify="right")
    rows = {
        "problems": "problems",
        **FAULTS,
        "incomplete": "incomplete answer",
        "undecided": "undecided, kept",
        "not_listed": "too many to list",
        "hypotheses": "hypotheses",
        "poses_checked": "poses checked",
        "neighbours": "other valid poses tried",
    }
    for key, title in rows.items():
        counts = [one.get(key, 0) for one in columns.values()]
        style = "bold red" if key in FAULTS and counts[-1] else None
        table.add_row(title, *map(str, counts), style=style)
    return table


def run(settings: Row, out: Path, *, cluster: str | None) -> bool:
    """Check all problems, write and print the summary; whether nothing was wrong."""
    chunks = range(-(-settings["problems"] // CHUNK))
    rows = campaign.run("campaign-plane", settings, chunks, task, out / "rows.jsonl", cluster=cluster)
    summary = summary_of(settings, rows)
    (out / "summary.json").write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    console = Console(width=None if sys.stdout.isatty() else 120, highlight=False)
    console.print(table_of(summary))
    slowest = _slowest((seconds, seed) for row in rows for seconds, seed in row["seconds"])
    console.print("slowest:", ", ".join(f"seed {seed} {seconds:.2f} s" for seconds, seed in slowest))
    for fault in summary["seeds_with_faults"][:20]:
        console.print(f"seed {fault['seed']}: {'; '.join(fault['said'])}", markup=False)
    return summary["faults"] == 0


def replay(seed: int) -> bool:
    """Print the problem of a seed and what is wrong with its answer."""
    for line in described(random_problem(seed)):
        sys.stdout.write(line + "\n")
    outcome = check(seed)
    sys.stdout.write(f"# {outcome.seconds:.3f} s, {dict(outcome.counts)}\n")
    for fault in outcome.faults or ["nothing is wrong"]:
        sys.stdout.write(f"# {fault}\n")
    return not outcome.faults


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if nothing was wrong."""
    parser = argparse.ArgumentParser(prog="campaign_plane", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--problems", type=int, default=100_000, help="how many (100000)")
    parser.add_argument("--seed", type=int, default=0, help="which campaign (0)")
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/campaign-plane"), help="folder of the results")
    parser.add_argument("--replay", type=int, metavar="SEED", help="check one problem, and print it")
    options = parser.parse_args(arguments)
    if options.problems < 1 or options.seed < 0:
        parser.error("--problems must be 1 or more, --seed 0 or more")
    if options.replay is not None:
        return 0 if replay(options.replay) else 1
    try:
        settings = {"problems": options.problems, "seed": options.seed}
        good = run(settings, options.out, cluster=options.cluster)
    except (ValueError, ConnectionError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    return 0 if good else 1


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import campaign_plane

    sys.exit(campaign_plane.main())
