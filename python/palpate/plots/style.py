"""How pictures look, and how they are saved."""

from __future__ import annotations

import io
import math
import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

# Okabe and Ito's colours, told apart with any colour vision; black is kept for what was sensed.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C6D1F")
DASHES = ("solid", (0, (5, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2)))
SENSED = "#111111"
CONFLICT = "#C00000"
FAINT = "#8A8A8A"

_LEAST_SIDE = 0.6  # of a frame in space, as a share of its largest

FORMATS = (".svg", ".png", ".pdf")

RC: dict[str, Any] = {
    "axes.edgecolor": "#B0B0B0",
    "axes.labelcolor": "#444444",
    "axes.linewidth": 0.8,
    "axes.titlesize": 11,
    "figure.dpi": 100,
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same letters on every machine
    "font.size": 9,
    "legend.frameon": False,
    "savefig.dpi": 160,
    "text.parse_math": False,  # a part may be called $5
    "svg.hashsalt": "palpate",  # identifiers of SVG elements: the same every time
    "xtick.color": "#666666",
    "ytick.color": "#666666",
}


def part_style(number: int) -> tuple[str, Any]:
    """Colour and dash of part `number`; the dash changes where the colours begin anew."""
    return COLORS[number % len(COLORS)], DASHES[number // len(COLORS) % len(DASHES)]


def new_figure(shape: tuple[float, float]) -> Figure:
    """An empty figure of `shape` (width, height) inches."""
    return Figure(figsize=shape, layout="constrained")


def frame_of(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Opposite corners of a frame around `points` `(n, d)`, with a margin."""
    low, high = points.min(axis=0), points.max(axis=0)
    most = float((high - low).max())
    margin = 0.06 * most or 1.0  # a single point gets a frame too
    if len(low) == 3:
        # The axes of a flat or slender box would leave no room for their labels.
        margin = np.maximum(margin, 0.5 * (_LEAST_SIDE * most - (high - low)))
    return low - margin, high + margin


def shape_of(low: NDArray[np.float64], high: NDArray[np.float64]) -> tuple[float, float]:
    """Inches for a picture of the frame `low` to `high`: 7 wide, as high as it needs, within reason."""
    if len(low) == 3:
        return 7.0, 6.4
    width, height = high - low
    return 7.0, float(np.clip(6.3 * height / width + 1.2, 3.6, 8.5))


def set_frame(axes: Axes, low: NDArray[np.float64], high: NDArray[np.float64], *, unit: str) -> None:
    """Equal axes over the frame, with the unit on both."""
    axes.set_xlim(float(low[0]), float(high[0]))
    axes.set_ylim(float(low[1]), float(high[1]))
    axes.set_aspect("equal")
    axes.set_xlabel(f"x ({unit})")
    axes.set_ylabel(f"y ({unit})")
    axes.spines[["top", "right"]].set_visible(False)


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write `figure` to `path`; the suffix says how: .svg, .png or .pdf.

    Raises:
        ValueError: If the suffix is none of these.
    """
    path = Path(path)
    check_picture_path(path)
    # Whole or not at all: an interrupted run leaves no half of a picture.
    partial = path.with_name(f".{path.name}.{os.getpid()}{path.suffix}")
    try:
        _write(figure, partial, path.suffix.lower()[1:])
        partial.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None
    finally:
        partial.unlink(missing_ok=True)


def svg_of(figure: Figure) -> bytes:
    """`figure` as an SVG file holds it."""
    drawn = io.BytesIO()
    _write(figure, drawn, "svg")
    return drawn.getvalue()


def _write(figure: Figure, file: Path | io.BytesIO, kind: str) -> None:
    metadata = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(kind)
    with mpl.rc_context(RC), warnings.catch_warnings():
        # A name in letters that the font lacks is drawn as boxes; that needs no lines on stderr.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        figure.savefig(file, format=kind, metadata=metadata)


def check_picture_path(path: str | Path) -> None:
    """Refuse a picture that could not be saved, before the work that leads to it."""
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path}: is a folder; give the name of a file in it")
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: pictures can't be saved as {path.suffix!r}; name it {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}; make it first")


def words(items: Sequence[object]) -> str:
    """`1, 3 and 4`."""
    texts = [str(item) for item in items]
    return texts[0] if len(texts) == 1 else ", ".join(texts[:-1]) + " and " + texts[-1]


def at_most(value: float) -> str:
    """A bound in three digits or so, rounded up: what is printed must still be a bound."""
    if value <= 0.0:
        return "0"
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{math.ceil(value / step - 1e-9) * step:.4g}"


def thinned(numbers: Sequence[int], most: int) -> tuple[list[int], int]:
    """At most `most` of the numbers, those that a round step divides, and that step."""
    steps = (factor * 10**power for power in range(10) for factor in (1, 2, 5))
    for step in steps:
        kept = [number for number in numbers if number % step == 0]
        if len(kept) <= most:
            break
    return kept, step
