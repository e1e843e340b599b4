"""`palpate parts`: the parts that come with palpate."""

from __future__ import annotations

from rich import box
from rich.table import Table

from palpate import bundled_parts, bundled_solids
from palpate.cli import options
from palpate.cli.console import results
from palpate.cli.documents import models_document, print_document


def parts(*, json: options.Json = False) -> None:
    """The bundled parts: names that can stand for a model file, and for the contacts that come with it."""
    models = [*bundled_parts(), *bundled_solids()]
    if json:
        print_document(models_document(models, unit="mm"))
        return
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("part", style="bold")
    for head in ("dimension", "faces", "size (mm)"):
        table.add_column(head, justify="right")
    for model in models:
        table.add_row(model.name, str(model.dimension), str(len(model.faces)), f"{model.size:.4g}")
    console = results()
    console.print(table)
    console.print(
        "Dimension 2: the plane, after R. E. Ellis's thesis, drawn anew. 3: space, the project's own."
    )
