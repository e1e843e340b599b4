"""`palpate demo`: the main job end to end on bundled parts."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.text import Text

from palpate import Step, part_names
from palpate.cli import options
from palpate.cli.console import patiently, results
from palpate.cli.demo_words import Teller, answer_words, task_words, truth_words
from palpate.cli.documents import print_document
from palpate.cli.run_report import result_document
from palpate.demo import DEFAULT_SEED, UNIT, Demonstration, check_choice, demonstrate

BEGIN = " " * 5  # of what belongs to a numbered line


def demo(
    *,
    part: Annotated[
        str | None, typer.Option(help="The bundled part that lies there.", show_default="one at random")
    ] = None,
    seed: Annotated[
        int,
        typer.Option(
            parser=options.whole(),
            metavar="N",
            help="Chooses the part, its pose and the errors of the probe.",
        ),
    ] = DEFAULT_SEED,
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where pictures, page and log are left.")
    ] = Path("palpate-demo"),
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw the run in short here, too: .svg, .png or .pdf."),
    ] = None,
    json: options.Json = False,
) -> None:
    """Hide a bundled part at random, find it by touch, tell how; leaves pictures and a page.

    Exit code 0: it was found; 1: it was not, which is a fault; 2: bad input.
    """
    from palpate.cli.demo_page import LOG, PAGE, make_ready, write_folder
    from palpate.plots import plot_turning_point, save_figure
    from palpate.plots.style import check_picture_path

    if plot is not None:
        check_picture_path(plot)
    check_choice(part, seed)
    make_ready(out)
    console = results()
    story = None if json else _Story(console)
    if not json:
        _print_paragraph(console, task_words(len(part_names())))
    shown = patiently(
        lambda: demonstrate(part, seed=seed, log=out / LOG, told=story), saying="feeling around"
    )
    if json:
        print_document(_document(shown, page=out / PAGE, log=out / LOG))
    else:
        _print_paragraph(console, [*answer_words(shown), truth_words(shown)], style="bold")
    console.file.flush()
    write_folder(shown, out)
    if plot is not None:
        save_figure(plot_turning_point(shown.result, unit=UNIT), plot)
    if not json:
        console.print(f"page: {out / PAGE}", markup=False)
    if shown.truth_number is None:
        raise typer.Exit(1)


class _Story:
    """Tells each guarded move when it is understood."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._teller = Teller()
        self._number = 0

    def __call__(self, step: Step) -> None:
        told = self._teller.tell(step)
        self._number += 1
        _print_text(self._console, told.why, style="dim", begin=f"{self._number:3}  ")
        _print_text(self._console, told.met, begin=BEGIN)
        if told.left:
            _print_text(self._console, told.left, style="bold cyan", begin=BEGIN)


def _print_text(console: Console, text: str, *, style: str = "", begin: str = "") -> None:
    # Wrapped here: rich would fill lines up with spaces, or begin them at the margin.
    lines = textwrap.wrap(text, console.width - len(begin), break_on_hyphens=False)
    shown = Text(begin + f"\n{' ' * len(begin)}".join(lines))
    shown.stylize(style, len(begin))
    console.print(shown, soft_wrap=True)


def _print_paragraph(console: Console, sentences: Sequence[str], *, style: str = "") -> None:
    console.print()
    for sentence in sentences:
        _print_text(console, sentence, style=style)
    console.print()


def _document(shown: Demonstration, *, page: Path, log: Path) -> dict[str, Any]:
    return {
        "schema": "palpate-demo",
        "version": 2,
        "seed": shown.seed,
        "truth": {"model": shown.truth.name, "world_from_model": shown.world_from_truth.tolist()},
        "result": result_document(shown.result, shown.models, unit=UNIT),
        "truth_found": shown.truth_number is not None,
        "page": str(page),
        "log": str(log),
    }
