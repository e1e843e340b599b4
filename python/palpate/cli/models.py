"""`palpate models`: what was read of model files."""

from __future__ import annotations

from palpate.cli import options
from palpate.cli.console import patiently, results
from palpate.cli.documents import models_document, print_document
from palpate.cli.model_report import print_models
from palpate.cli.parts import load_parts


def models(
    models: options.Models,
    *,
    unit: options.Unit = "mm",
    layers: options.Layers = None,
    flattening: options.Flattening = None,
    position_slack: options.PositionSlack = 0.0,
    normal_slack_deg: options.NormalSlackDeg = 0.0,
    faces: options.Faces = False,
    plot: options.Plot = None,
    json: options.Json = False,
) -> None:
    """What was read of each model: counts, size, symmetries, slack, what was mended, its faces if wanted."""
    if plot is not None:
        from palpate.plots.style import check_picture_path

        check_picture_path(plot)
    parts = patiently(
        lambda: load_parts(
            models,
            unit=unit,
            layers=layers,
            flattening=flattening,
            position_slack=position_slack,
            normal_slack_deg=normal_slack_deg,
        ),
        saying="reading models",
    )
    console = results()
    if json:
        print_document(models_document(parts.models, unit=unit))
    else:
        print_models(console, parts, unit=unit, faces=faces)
    if plot is not None:
        # After what was read is printed: a picture that fails takes nothing with it.
        from palpate.plots import plot_models, save_figure

        console.file.flush()
        save_figure(plot_models(parts.models, unit=unit), plot)
        if not json:
            console.print(f"picture: {plot}", markup=False)
