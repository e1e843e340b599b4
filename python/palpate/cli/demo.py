"""`palpate demo`: the main job end to end on bundled parts."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from palpate import Contact
from palpate.cli import options
from palpate.cli.console import patiently, results
from palpate.cli.documents import planar, print_document, recognition_document
from palpate.cli.report import print_recognition
from palpate.contacts import Evidence, contacts_document
from palpate.demo import DEFAULT_PART, Demonstration, demonstrate


def demo(
    *,
    part: Annotated[str, typer.Option(help="The bundled part that lies there.")] = DEFAULT_PART,
    seed: Annotated[
        int,
        typer.Option(
            parser=options.whole(), metavar="N", help="Chooses its pose and the errors of the contacts."
        ),
    ] = 0,
    out: Annotated[
        Path, typer.Option("--plot", "--out", metavar="FILE", help="The picture: .svg, .png or .pdf.")
    ] = Path("palpate-demo.svg"),
    json: options.Json = False,
) -> None:
    """Touch a bundled part twice, find every part and pose that explains it, draw the answer."""
    from palpate.plots import plot_recognition, save_figure
    from palpate.plots.style import check_picture_path

    check_picture_path(out)
    shown = patiently(lambda: demonstrate(part, seed=seed), saying="recognizing")
    console = results()
    if json:
        print_document(_document(shown, out))
    else:
        _print(console, shown)
    console.file.flush()
    save_figure(plot_recognition(shown.found, shown.contacts, unit=shown.unit), out)
    if not json:
        console.print(f"picture: {out}", markup=False)
    if shown.truth_number is None:
        raise typer.Exit(1)


def _print(console: Console, shown: Demonstration) -> None:
    x, y, angle_deg = planar(shown.world_from_truth)
    at = f"x {x:.2f}, y {y:.2f} {shown.unit}, turned by {angle_deg:.2f}°"
    console.print(
        f"On the table, unknown to the recognizer: [bold]{escape(shown.truth.name)}[/bold] at {at}."
    )
    for number, contact in enumerate(shown.contacts, start=1):
        console.print(f"  touch {number} {_touch(contact, unit=shown.unit)}")
    print_recognition(
        console,
        shown.found,
        evidence=Evidence(shown.contacts),
        labels=[model.name for model in shown.models],
        unit=shown.unit,
    )
    if shown.truth_number is None:
        console.print(
            "[bold]The true part and pose are in none of them: this is a fault, please report it.[/bold]"
        )
    else:
        console.print(f"The true part and pose are in hypothesis {shown.truth_number}.")


def _touch(contact: Contact, *, unit: str) -> str:
    x, y = contact.center
    words = f"at ({x:.2f}, {y:.2f}) ± {contact.position_error:g} {unit}"
    if contact.normal is None or contact.normal_error is None:
        return words
    angle_deg = math.degrees(math.atan2(contact.normal[1], contact.normal[0]))
    return f"{words}, normal at {angle_deg:.1f}° ± {math.degrees(contact.normal_error):.3g}°"


def _document(shown: Demonstration, out: Path) -> dict[str, object]:
    return {
        "schema": "palpate-demo",
        "version": 1,
        "truth": {"model": shown.truth.name, "world_from_model": shown.world_from_truth.tolist()},
        "contacts": contacts_document(shown.contacts, unit=shown.unit),
        "found": recognition_document(
            shown.found, shown.models, num_contacts=len(shown.contacts), unit=shown.unit
        ),
        "truth_found": shown.truth_number is not None,
        "picture": str(out),
    }
