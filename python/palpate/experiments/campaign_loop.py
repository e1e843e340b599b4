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

from palpate.experiments import blind, campaign, closed_loop, loop_tables, strangers
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment
from palpate.experiments.pages import rewrite
from palpate.experiments.thesis_sensor import parts
from palpate.usual import NORMAL_ERROR_DEG, POSITION_ERROR

FINE = {"position_error": POSITION_ERROR, "normal_error_deg": NORMAL_ERROR_DEG}
COARSE = {"position_error": 4.0, "normal_error_deg": 5.0}
RIVALS = ["entropy", "chance"]
TIGHT = {"until": [1.0, 1.0]}
REPEATS = 10  # problems with each part, as an experiment of its own


def _loops(rows: list[Row]) -> str:
    tables = [loop_tables.ends(loop_tables.by_noise(rows)), loop_tables.distribution(rows)]
    return "\n\n".join([*tables, loop_tables.by_part(rows)])


def _beside(rows: list[Row]) -> str:
    return loop_tables.beside({"": rows})


def _strangers(rows: list[Row]) -> str:
    return loop_tables.strangers({"": rows})


@dataclass(frozen=True)
class Part:
    """A campaign of its own: `share` of the problems, and how the page names it."""

    title: str
    task: Callable[..., Row]
    settings: dict[str, Any]
    share: float
    table: Callable[[list[Row]], str]

    @property
    def truth_is_in(self) -> bool:
        """Whether the promise's conditions hold."""
        return self.task is not strangers.task


# Their names are those of `palpate experiment`, and of the files with their rows.
PARTS = {
    "loops": Part("±0.5, ±4°", closed_loop.task, FINE, 1.0, _loops),
    "loops-coarse": Part("±4, ±5°", closed_loop.task, COARSE, 0.2, _loops),
    "loops-mixed": Part(
        "±0.5, ±4°, tips, path errors, overtravel", closed_loop.task, {**FINE, "mixed": True}, 0.1, _loops
    ),
    "blind": Part("more blind contacts", blind.task, FINE, 0.05, blind.markdown),
    "beside-scan": Part("scans, ±0.5, ±4°", closed_loop.task, {**FINE, "beside": RIVALS}, 0.05, _beside),
    "beside-drawn": Part(
        "two contacts, ±0.5, ±4°",
        closed_loop.task,
        {**FINE, "start": "drawn", "beside": RIVALS},
        0.05,
        _beside,
    ),
    "beside-coarse": Part(
        "two contacts, ±4, ±5°",
        closed_loop.task,
        {**COARSE, "start": "drawn", "beside": RIVALS},
        0.01,
        _beside,
    ),
    "strange-part": Part(
        "a part that is not in the library", strangers.task, {**FINE, "kind": "part"}, 0.1, _strangers
    ),
    "strange-readings": Part(
        "errors 2 to 5 times their bounds", strangers.task, {**FINE, "kind": "readings"}, 0.1, _strangers
    ),
    "strange-part-verified": Part(
        "the first, `until=` 1 and 1°", strangers.task, {**FINE, "kind": "part", **TIGHT}, 0.03, _strangers
    ),
    "strange-readings-verified": Part(
        "the second, `until=` 1 and 1°",
        strangers.task,
        {**FINE, "kind": "readings", **TIGHT},
        0.03,
        _strangers,
    ),
}

EXPERIMENTS = {
    name: Experiment(
        title=f"Closed loops: {part.title}",
        task=part.task,
        table=part.table,
        groups=len(parts()),
        repeats=REPEATS,
        settings=part.settings,
        of_thesis=False,
    )
    for name, part in PARTS.items()
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
            if row["lost"] and PARTS[name].truth_is_in:
                said.append(f"{name}, number {row['number']}: the truth is in no hypothesis left")
            if row["contradicted"]:
                count = row["contradicted"]
                said.append(f"{name}, number {row['number']}: {count} hypotheses contradict the evidence")
    return said


def sections(done: dict[str, list[Row]]) -> dict[str, str]:
    """The parts of the page that are made."""
    groups = {
        f"{PARTS[name].title}: {noise}": rows
        for name in ("loops", "loops-coarse", "loops-mixed")
        for noise, rows in loop_tables.by_noise(done[name]).items()
    }
    rivals = {part.title: done[name] for name, part in PARTS.items() if "beside" in part.settings}
    strange = {part.title: done[name] for name, part in PARTS.items() if not part.truth_is_in}
    fine = done["loops"]
    return {
        "ends": loop_tables.ends(groups),
        "touches": f"{loop_tables.distribution(fine)}\n\n{loop_tables.by_part(fine)}",
        "rivals": loop_tables.beside(rivals),
        "blind": blind.markdown(done["blind"]),
        "strangers": loop_tables.strangers(strange),
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
