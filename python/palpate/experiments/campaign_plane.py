"""Random planar problems, thousands of them: is anything true lost, is anything false kept?

    python -m palpate.experiments.campaign_plane --problems 100000 --cluster local
    python -m palpate.experiments.campaign_plane --replay 4711

Problem `k` of campaign `s` has the seed `s · 10⁹ + k`. What was checked is on disk after every chunk; killed
and started again, the campaign goes on where it was, and its summary is the same.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

from . import campaign, checked
from .campaign import Row
from .checks import FAULTS, check
from .problems import described, random_problem
from .random_parts import FAMILIES

CHUNK = 100
COUNTERS = {
    "problems": "problems",
    **FAULTS,
    "incomplete": "incomplete answer",
    "undecided": "undecided, kept",
    "not_listed": "too many to list",
    "hypotheses": "hypotheses",
    "poses_checked": "poses checked",
    "neighbours": "other valid poses tried",
}


def task(chunk: int, *, problems: int, seed: int) -> Row:
    """Check a chunk of the first `problems` of a campaign."""
    first = seed * checked.SEEDS_PER_CAMPAIGN
    numbers = range(CHUNK * chunk, min(CHUNK * (chunk + 1), problems))
    outcomes = [check(first + number) for number in numbers]
    seconds = checked.slowest((round(one.seconds, 3), one.seed) for one in outcomes)
    return {**checked.row_of(outcomes), "seconds": seconds}


def run(settings: Row, out: Path, *, cluster: str | None) -> bool:
    """Check all problems, write and print the summary; whether nothing was wrong."""
    chunks = range(-(-settings["problems"] // CHUNK))
    rows = campaign.run("campaign-plane", settings, chunks, task, out / "rows.jsonl", cluster=cluster)
    summary = checked.summary_of(settings, rows, families=FAMILIES, faults=FAULTS)
    title = f"{summary['problems']} random planar problems, seed {summary['seed']}"
    table = checked.table_of(title, summary, COUNTERS, faults=FAULTS)
    times = ((seconds, seed) for row in rows for seconds, seed in row["seconds"])
    return checked.write(summary, table, times, out=out)


def replay(seed: int) -> bool:
    """Print the problem of a seed and what is wrong with its answer."""
    for line in described(random_problem(seed)):
        sys.stdout.write(line + "\n")
    return checked.say(check(seed))


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if nothing was wrong."""
    what = (__doc__ or "").splitlines()[0]
    parser = checked.parser_of("campaign-plane", what, problems=100_000)
    parser.add_argument("--out", type=Path, default=Path("out/campaign-plane"), help="folder of the results")
    options = checked.parsed(parser, arguments)
    if options.replay is not None:
        return 0 if replay(options.replay) else 1
    settings = {"problems": options.problems, "seed": options.seed}
    return checked.ended(parser, partial(run, settings, options.out, cluster=options.cluster))


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import campaign_plane

    sys.exit(campaign_plane.main())
