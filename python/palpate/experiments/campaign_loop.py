"""Thousands of closed loops over all bundled parts: is a truth ever lost, how do they end, how many touches?

    python -m palpate.experiments.campaign_loop --problems 10000 --cluster local
    python -m palpate.experiments.campaign_loop --page docs/closed-loop.md

Beside the main campaign, smaller ones: coarse bounds, other ways to choose the next touch on the same
problems, and loops in which the promise's conditions don't hold. Killed and started again, it goes on where
it was. With `--page` the tables of that page are written anew from what is on disk then.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palpate.experiments import campaign, closed_loop, loop_tables, strangers
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment
from palpate.experiments.pages import rewrite

FINE = {"position_error": 0.5, "normal_error_deg": 4.0}
COARSE = {"position_error": 4.0, "normal_error_deg": 5.0}
RIVALS = list(loop_tables.WAYS)[1:]
TIGHT = {"until": [1.0, 1.0]}


@dataclass(frozen=True)
class Part:
    """A campaign of its own: `share` of the problems, and how the page names it."""

    title: str
    task: Callable[..., Row]
    settings: dict[str, Any]
    share: float
    truth_is_in: bool = True


PARTS = {
    "fine": Part("±0.5, ±4°", closed_loop.task, FINE, 1.0),
    "coarse": Part("±4, ±5°", closed_loop.task, COARSE, 0.2),
    "rivals-scan": Part("scans, ±0.5, ±4°", closed_loop.task, {**FINE, "beside": RIVALS}, 0.05),
    "rivals-drawn": Part(
        "two contacts, ±0.5, ±4°", closed_loop.task, {**FINE, "start": "drawn", "beside": RIVALS}, 0.05
    ),
    "rivals-coarse": Part(
        "two contacts, ±4, ±5°", closed_loop.task, {**COARSE, "start": "drawn", "beside": RIVALS}, 0.01
    ),
    "part": Part("a part that is not in the library", strangers.task, {**FINE, "kind": "part"}, 0.1, False),
    "readings": Part(
        "errors 2 to 5 times their bounds", strangers.task, {**FINE, "kind": "readings"}, 0.1, False
    ),
    "part-verified": Part(
        "the first, `until=` 1 and 1°", strangers.task, {**FINE, "kind": "part", **TIGHT}, 0.03, False
    ),
    "readings-verified": Part(
        "the second, `until=` 1 and 1°", strangers.task, {**FINE, "kind": "readings", **TIGHT}, 0.03, False
    ),
}


def _loops(rows: list[Row]) -> str:
    tables = [loop_tables.ends(loop_tables.by_noise(rows)), loop_tables.distribution(rows)]
    return "\n\n".join([*tables, loop_tables.by_part(rows)])


def _experiment(name: str, table: Callable[[list[Row]], str]) -> Experiment:
    part = PARTS[name]
    return Experiment(
        title=f"Closed loops: {part.title}",
        task=part.task,
        table=table,
        groups=len(closed_loop.library()),
        repeats=10,
        settings=part.settings,
        of_thesis=False,
    )


EXPERIMENTS = {
    "loops": _experiment("fine", _loops),
    "loops-coarse": _experiment("coarse", _loops),
    "loops-beside": _experiment("rivals-drawn", loop_tables.beside),
    "loops-strange-part": _experiment("part", lambda rows: loop_tables.strangers({"": rows})),
    "loops-strange-readings": _experiment("readings", lambda rows: loop_tables.strangers({"": rows})),
}


def run(problems: int, seed: int, out: Path, *, cluster: str | None) -> dict[str, list[Row]]:
    """The rows of all campaigns."""
    done = {}
    for name, part in PARTS.items():
        first = seed * SEEDS
        numbers = range(first, first + max(1, round(part.share * problems)))
        file = out / f"{name}.jsonl"
        done[name] = campaign.run(name, part.settings, numbers, part.task, file, cluster=cluster)
    return done


def on_disk(out: Path) -> dict[str, list[Row]]:
    """What is there of all campaigns."""
    return {name: campaign.read(out / f"{name}.jsonl")[1] for name in PARTS}


def faults(done: dict[str, list[Row]]) -> list[str]:
    """Everything that must not be: a truth that was lost, a hypothesis that contradicts its evidence."""
    said = []
    for name, rows in done.items():
        for row in rows:
            if row["wrong"] and PARTS[name].truth_is_in:
                said.append(f"{name}, number {row['number']}: the truth is in no hypothesis left")
            if row["false"]:
                said.append(
                    f"{name}, number {row['number']}: {row['false']} hypotheses contradict the evidence"
                )
    return said


def sections(done: dict[str, list[Row]]) -> dict[str, str]:
    """The parts of the page that are made."""
    groups = {
        f"{PARTS['fine'].title}: {name}": rows for name, rows in loop_tables.by_noise(done["fine"]).items()
    }
    groups |= {
        f"{PARTS['coarse'].title}: {name}": rows
        for name, rows in loop_tables.by_noise(done["coarse"]).items()
    }
    told = [name for name, part in PARTS.items() if "beside" in part.settings]
    return {
        "ends": loop_tables.ends(groups),
        "touches": f"{loop_tables.distribution(done['fine'])}\n\n{loop_tables.by_part(done['fine'])}",
        "rivals": "\n\n".join(f"**{PARTS[name].title}.** {loop_tables.beside(done[name])}" for name in told),
        "strangers": loop_tables.strangers(
            {part.title: done[name] for name, part in PARTS.items() if not part.truth_is_in}
        ),
    }


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if nothing was wrong."""
    parser = argparse.ArgumentParser(prog="campaign_loop", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--problems", type=int, default=10_000, help="in the main campaign (10000)")
    parser.add_argument("--seed", type=int, default=0, help="which problems (0)")
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/campaign-loop"), help="folder of the rows")
    parser.add_argument("--page", type=Path, help="write the tables of this page anew")
    parser.add_argument(
        "--as-is", action="store_true", help="compute nothing: tables of what is in the folder"
    )
    options = parser.parse_args(arguments)
    if options.problems < 1 or options.seed < 0:
        parser.error("--problems must be 1 or more, --seed 0 or more")
    try:
        if options.as_is:
            done = on_disk(options.out)
        else:
            done = run(options.problems, options.seed, options.out, cluster=options.cluster)
        made = sections(done)
        for name, text in made.items() if options.page else ():
            rewrite(options.page, name, text)
    except (ValueError, OSError) as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    sys.stdout.write("\n\n".join(made.values()) + "\n")
    wrong = faults(done)
    for line in wrong:
        sys.stdout.write(line + "\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import campaign_loop

    sys.exit(campaign_loop.main())
