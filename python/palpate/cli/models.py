"""`palpate models`: what was read of model files."""

from __future__ import annotations

from palpate import load_models
from palpate.cli import options
from palpate.cli.console import patiently, results
from palpate.cli.documents import models_document, print_document
from palpate.cli.report import print_models


def models(
    models: options.Models,
    *,
    unit: options.Unit = "mm",
    plot: options.Plot = None,
    json: options.Json = False,
) -> None:
    """What was read of each model: faces, vertices, size, symmetries, slack, and what was mended."""
    if plot is not None:
        from palpate.plots.style import check_picture_path

        check_picture_path(plot)
    parts = patiently(lambda: load_models(models, unit=unit), saying="reading models")
    if plot is not None:
        from palpate.plots import plot_models, save_figure

        save_figure(plot_models(parts, unit=unit), plot)
    if json:
        print_document(models_document(parts, unit=unit))
        return
    console = results()
    print_models(console, parts, unit=unit)
    if plot is not None:
        console.print(f"picture: {plot}", markup=False)
