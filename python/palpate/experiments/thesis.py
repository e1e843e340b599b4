"""The page docs/experiments.md, from what `palpate experiment all` left in a folder.

    python -m palpate.experiments.thesis target/experiments docs/experiments.md

A table whose rows are not in the folder stays as it is. A few of the figures go to docs/pictures.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.experiments.campaign import read
from palpate.experiments.pages import rewrite
from palpate.experiments.registry import ALL, named

SHOWN = ("table-4.3", "table-4.4", "figure-4.1", "figure-4.5", "figure-4.7", "figure-4.15")


def write(folder: Path, page: Path) -> None:
    """Write the tables of the page anew, and its pictures."""
    for name, experiment in named(ALL).items():
        file = folder / f"{name}.jsonl"
        if not file.exists():
            continue
        _, rows = read(file)
        rewrite(page, name, experiment.table(rows))
        for picture in experiment.pictures(rows):
            if picture.name in SHOWN:
                (page.parent / "pictures" / f"{picture.name}.svg").write_bytes(picture.svg)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="the tables and pictures of docs/experiments.md")
    parser.add_argument("folder", type=Path, help="of palpate experiment all")
    parser.add_argument("page", type=Path, help="page of the documentation that is written anew")
    given = parser.parse_args()
    write(given.folder, given.page)


if __name__ == "__main__":
    main()
