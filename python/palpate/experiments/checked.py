"""Random problems whose answers are checked: what is counted of each, and of thousands.

Shared by the campaigns of the plane and of space.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.table import Table

from palpate import __version__

from . import campaign
from .campaign import Row

SEEDS_PER_CAMPAIGN = 10**9
MOST_SLOW = 8
MOST_SAID = 20

Found = TypeVar("Found")


@dataclass
class Outcome:
    """What was counted for a problem, what was wrong, and how long it took, seconds.

    `titles` names the counters of what must not happen.
    """

    seed: int
    family: str
    titles: Mapping[str, str]
    counts: Counter[str] = field(default_factory=lambda: Counter(problems=1))
    faults: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def expect(self, holds: bool, fault: str, said: str = "") -> None:
        """Count a fault where something does not hold."""
        if not holds:
            self.counts[fault] += 1
            self.faults.append(f"{self.titles[fault]}{': ' if said else ''}{said}")

    def answer(self, ask: Callable[[], Found]) -> Found | None:
        """What `ask` returns, and how long it took; None if it failed, which is a fault."""
        started = time.perf_counter()
        try:
            return ask()
        except Exception as error:
            self.expect(False, "errors", str(error))
        except BaseException as error:  # a panic of the core is none of Exception's
            if isinstance(error, (KeyboardInterrupt, SystemExit)):
                raise
            self.expect(False, "errors", f"panic: {error}")
        finally:
            self.seconds = time.perf_counter() - started
        return None


def row_of(outcomes: Sequence[Outcome]) -> Row:
    """A campaign's row for some problems."""
    families: dict[str, Counter[str]] = {}
    for one in outcomes:
        families.setdefault(one.family, Counter()).update(one.counts)
    return {
        "families": families,
        "faults": [{"seed": one.seed, "said": one.faults} for one in outcomes if one.faults],
    }


def slowest(times: Iterable[tuple[float, int]]) -> list[tuple[float, int]]:
    """The longest of times, each with its seed."""
    return sorted(times, reverse=True)[:MOST_SLOW]


def summary_of(
    settings: Row, rows: list[Row], *, families: Iterable[str], faults: Iterable[str]
) -> dict[str, Any]:
    """Counts by family and in total, and every problem with a fault. No times: the same on every machine."""
    counted = {family: Counter[str]() for family in families}
    for row in rows:
        for family, counts in row["families"].items():
            counted[family].update(counts)
    total: Counter[str] = sum(counted.values(), Counter())
    return {
        "schema": "palpate-campaign",
        "version": 1,
        "palpate": __version__,
        **settings,
        "faults": sum(total[fault] for fault in faults),
        "total": dict(sorted(total.items())),
        "families": {family: dict(sorted(counts.items())) for family, counts in counted.items()},
        "seeds_with_faults": [fault for row in rows for fault in row["faults"]],
    }


def table_of(
    title: str, summary: dict[str, Any], counters: Mapping[str, str], *, faults: Iterable[str]
) -> Table:
    """The summary for a person: a row for each counter, with its title."""
    table = Table(title=title)
    table.add_column("")
    columns = {**summary["families"], "total": summary["total"]}
    for name in columns:
        table.add_column(name, justify="right")
    for key, said in counters.items():
        counts = [one.get(key, 0) for one in columns.values()]
        style = "bold red" if key in faults and counts[-1] else None
        table.add_row(said, *map(str, counts), style=style)
    return table


def write(
    summary: dict[str, Any],
    table: Table,
    times: Iterable[tuple[float, int]],
    *,
    out: Path,
    most_letters: int | None = None,
) -> bool:
    """Write and print a summary, with the slowest of all times; whether nothing was wrong.

    Of what is wrong with a problem so many letters are printed, or all.
    """
    (out / "summary.json").write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    console = Console(width=None if sys.stdout.isatty() else 120, highlight=False)
    console.print(table)
    console.print("slowest:", ", ".join(f"seed {seed} {seconds:.2f} s" for seconds, seed in slowest(times)))
    for fault in summary["seeds_with_faults"][:MOST_SAID]:
        console.print(f"seed {fault['seed']}: {'; '.join(fault['said'])[:most_letters]}", markup=False)
    return bool(summary["faults"] == 0)


def say(outcome: Outcome) -> bool:
    """Print the outcome of a problem that is replayed; whether nothing was wrong."""
    sys.stdout.write(f"# {outcome.seconds:.3f} s, {dict(outcome.counts)}\n")
    for fault in outcome.faults or ["nothing is wrong"]:
        sys.stdout.write(f"# {fault}\n")
    return not outcome.faults


def parser_of(name: str, what: str, *, problems: int) -> argparse.ArgumentParser:
    """The options that all campaigns have; `problems` is how many are checked if it is not said."""
    parser = argparse.ArgumentParser(prog=name.replace("-", "_"), description=what)
    parser.add_argument("--problems", type=int, default=problems, help=f"how many ({problems})")
    parser.add_argument("--seed", type=int, default=0, help="which campaign (0)")
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--replay", type=int, metavar="SEED", help="check one problem, and print it")
    return parser


def parsed(parser: argparse.ArgumentParser, arguments: list[str] | None) -> argparse.Namespace:
    """The options, of which those that all campaigns have are looked at."""
    options = parser.parse_args(arguments)
    if options.problems < 1 or options.seed < 0:
        parser.error("--problems must be 1 or more, --seed 0 or more")
    return options


def ended(parser: argparse.ArgumentParser, run: Callable[[], bool]) -> int:
    """The exit code of a run, which says what was wrong with its options or that it was stopped."""
    try:
        return 0 if run() else 1
    except (ValueError, ConnectionError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
