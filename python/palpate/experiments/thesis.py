"""The pages docs/experiments.md and docs/rig.md, from what `palpate experiment` left in a folder.

    python -m palpate.experiments.thesis target/experiments docs/experiments.md
    python -m palpate.experiments.thesis target/rig docs/rig.md --rig

A table whose rows are not in the folder stays as it is. A few of the figures go to docs/pictures.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.experiments.campaign import read
from palpate.experiments.pages import rewrite
from palpate.experiments.registry import ALL, EXPERIMENTS, named

SHOWN = ("table-4.3", "table-4.4", "figure-4.1", "figure-4.5", "figure-4.7", "figure-4.15")
RIG = ("rig-sensor", "rig-control", "rig-drill")
SHOWN_OF_RIG = ("rig-sensor", "rig-overshoot", "rig-steps", "rig-recording", "rig-figure-4.12", "rig-figure-4.13")


def write(folder: Path, page: Path, *, rig: bool = False) -> None:
    """Write the tables of the page anew, and its pictures."""
    experiments = {name: EXPERIMENTS[name] for name in RIG} if rig else named(ALL)
    shown = SHOWN_OF_RIG if rig else SHOWN
    for name, experiment in experiments.items():
        file = folder / f"{name}.jsonl"
        if not file.exists():
            continue
        _, rows = read(file)
        rewrite(page, name, experiment.table(rows))
        for picture in experiment.pictures(rows):
            if picture.name in shown:
                (page.parent / "pictures" / f"{picture.name}.svg").write_bytes(picture.svg)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="the tables and pictures of docs/experiments.md or docs/rig.md")
    parser.add_argument("folder", type=Path, help="of palpate experiment all")
    parser.add_argument("page", type=Path, help="page of the documentation that is written anew")
    parser.add_argument("--rig", action="store_true", help="the experiments of the rig, and its page")
    given = parser.parse_args()
    write(given.folder, given.page, rig=given.rig)


if __name__ == "__main__":
    main()
