"""`palpate experiment`: the thesis's tables and figures, and the comparisons."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markdown import Markdown

from palpate import __version__
from palpate.cli import options
from palpate.cli.console import results
from palpate.cli.documents import print_document
from palpate.experiments.registry import ALL, EXPERIMENTS, named

MOST_PROBLEMS = 10_000_000
MOST_SEEDS = 1_000_000


def _name(text: str) -> str:
    try:
        named(text)
    except ValueError as error:
        raise typer.BadParameter(str(error).removeprefix("name: ")) from None
    return text


def experiment(
    name: Annotated[
        str, typer.Argument(metavar="NAME", parser=_name, help=f"{', '.join(EXPERIMENTS)}, or {ALL}.")
    ],
    *,
    cluster: options.Cluster = None,
    out: Annotated[
        Path,
        typer.Option(
            metavar="FOLDER",
            help="Where rows, pictures and report.html go. Rows that are there are not computed again.",
        ),
    ] = Path("palpate-experiments"),
    problems: Annotated[
        int | None,
        typer.Option(
            parser=options.whole(1, MOST_PROBLEMS),
            metavar="N",
            help="Random problems of each kind; else as many as the thesis has, or the experiment says.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[
        int,
        typer.Option(parser=options.whole(0, MOST_SEEDS), metavar="S", help="Chooses the random problems."),
    ] = 0,
    json: options.Json = False,
) -> None:
    """The thesis's experiments again: its tables, its numbers beside ours, and its figures, as one page."""
    from palpate.experiments.conduct import REPORT, conduct, save_report

    outcomes = conduct(name, out, problems=problems, seed=seed, cluster=cluster)
    report = out / REPORT
    save_report(outcomes, report)
    if json:
        entries = [
            {
                "name": one.name,
                "title": one.experiment.title,
                "settings": one.experiment.settings,
                "rows": [{key: value for key, value in row.items() if key != "svg"} for row in one.rows],
                "pictures": [str(picture) for picture, _ in one.pictures],
            }
            for one in outcomes
        ]
        print_document(
            {
                "schema": "palpate-experiment",
                "version": 1,
                "palpate": __version__,
                "seed": seed,
                "experiments": entries,
                "report": str(report),
            }
        )
        return
    console = results()
    for one in outcomes:
        console.print(Markdown(f"# {one.experiment.title}\n\n{one.markdown}"))
    console.print(f"report: {report}", markup=False)
