"""The tables and pictures of times in docs/speed.md, from what the Rust example `speed` measured.

python -m palpate.experiments.speed FIGURES.json docs/speed.md
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from palpate.plots.style import COLORS, RC, new_figure, save_figure

from .pages import Figures, arguments, duration, machine, rewrite, share, table

Curve = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
MARKERS = ("o", "s")

#: The exponent is fitted from here on: below, what every recognition does once is most of the time.
FITTED_FACES = 90.0


def two_contacts(figures: Figures) -> str:
    """Two contacts on the six objects, and what is asked of pose sets."""
    pairs = figures["pairs"]
    header = ["", "median", "90 %", "99 %", "longest"]
    quantiles = ("median", "q90", "q99", "max")
    times = [
        ["against all six", *(duration(pairs["six"][key]) for key in quantiles)],
        ["against the right one", *(duration(pairs["single"][key]) for key in quantiles)],
        ["hypotheses, of all six", *(f"{pairs['hypotheses'][key]:.0f}" for key in quantiles)],
    ]
    bundled = [[row["part"], duration(row["seconds"]), str(row["hypotheses"])] for row in figures["bundled"]]
    queries = [
        [row["query"], *(duration(row["seconds"][key]) for key in quantiles)] for row in figures["queries"]
    ]
    num_queries = figures["queries"][0]["seconds"]["count"]
    return "\n\n".join(
        [
            f"Measured on: {machine()}; one of them is used. Bounds: ±{figures['position_error']:g} and "
            f"±{figures['normal_error_deg']:g}°.",
            f"{pairs['six']['count']} random pairs of contacts, each object as often as the others; "
            f"{share(pairs['within_1ms'])} of them take 1 ms or less against all six:",
            table(header, times),
            "The bundled contacts of each object, against all six:",
            table(["", "time", "hypotheses, of all six"], bundled),
            f"What is asked of a true hypothesis's pose set, {num_queries} times:",
            table(header, queries),
        ]
    )


def growth(figures: Figures) -> str:
    """How the times grow: the fitted exponents, and where points rest on fewer problems."""
    faces, contacts = _face_curves(figures), _contact_curves(figures)
    rows = [[name, f"faces^{_exponent(curve, FITTED_FACES):.2f}"] for name, curve in faces.items()]
    rows += [[name, f"contacts^{_exponent(curve):.2f}"] for name, curve in contacts.items()]
    every = [*figures["faces"], *figures["contacts"]]
    few = [row for row in every if row["seconds"]["count"] < figures["problems"]]
    cut = [row for row in every if not row["complete"]]
    largest = max(every, key=lambda row: row["seconds"]["max"])
    notes = [
        f"Each point is the median over {figures['problems']} random problems, of stars on 4 of them. The "
        f"slowest of all took {duration(largest['seconds']['max'])} ({_name(largest)}).",
        f"Points that rest on fewer problems, as these took too long together: {_names(few)}.",
        f"Points with answers of more than 1,000 hypotheses, which are cut there and say so: {_names(cut)}.",
    ]
    return "\n\n".join([table(["", "median time grows with"], rows), *notes])


def _names(rows: list[Figures]) -> str:
    return "; ".join(_name(row) for row in rows) or "none"


def _name(row: Figures) -> str:
    faces = f", {row['faces']} faces" if "faces" in row else ""
    return f"{row['shape']}{faces}, {row['contacts']} contacts"


def _face_curves(figures: Figures) -> dict[str, Curve]:
    rows = figures["faces"]
    kinds = dict.fromkeys((row["shape"], row["contacts"]) for row in rows)
    return {
        f"{shape}, {contacts} contacts": _curve(
            [row for row in rows if (row["shape"], row["contacts"]) == (shape, contacts)], "faces"
        )
        for shape, contacts in kinds
    }


def _contact_curves(figures: Figures) -> dict[str, Curve]:
    rows = figures["contacts"]
    shapes = dict.fromkeys(row["shape"] for row in rows)
    return {shape: _curve([row for row in rows if row["shape"] == shape], "contacts") for shape in shapes}


def _curve(rows: list[Figures], key: str) -> Curve:
    median, upper = ([row["seconds"][name] for row in rows] for name in ("median", "q90"))
    return np.array([row[key] for row in rows], float), np.array(median), np.array(upper)


def _exponent(curve: Curve, least: float = 0.0) -> float:
    return float(_fit(curve, least)[0])


def _fit(curve: Curve, least: float) -> NDArray[np.float64]:
    size, median, _ = curve
    fitted = size >= least
    return np.polyfit(np.log(size[fitted]), np.log(median[fitted]), 1)


def draw(panels: Sequence[dict[str, Curve]], path: Path, *, of: str, least: float = 0.0) -> None:
    """Panels beside each other: medians, the range up to 90 %, and the fitted power with its exponent."""
    with mpl.rc_context(RC):
        figure = new_figure((9.0, 4.2))
        for number, axes in enumerate(figure.subplots(1, len(panels), sharey=True)):
            for place, (name, curve) in enumerate(panels[number].items()):
                style = COLORS[place], MARKERS[place]
                _draw_curve(axes, curve, label=f"{name}:  ∝ {of}", style=style, least=least)
            _finish(axes, of)
            if number == 0:
                axes.set_ylabel("time on one core")
        for suffix in (".svg", ".png"):
            save_figure(figure, path.with_suffix(suffix))


def _draw_curve(axes: Axes, curve: Curve, *, label: str, style: tuple[str, str], least: float) -> None:
    size, median, upper = curve
    slope, offset = _fit(curve, least)
    color, marker = style
    axes.fill_between(size, median, upper, color=color, alpha=0.12, linewidth=0)
    exponent = f"$^{{\\,{slope:.2f}}}$"
    axes.plot(
        size, median, linestyle="none", marker=marker, color=color, markersize=4.5, label=label + exponent
    )
    fitted = size[size >= least]
    axes.plot(fitted, np.exp(offset) * fitted**slope, color=color, linewidth=1.2)


def _finish(axes: Axes, of: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = [8, 20, 50, 100, 200, 400, 800] if of == "faces" else [2, 3, 4, 5, 6, 8, 10, 12]
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel(of)
    axes.yaxis.set_major_locator(LogLocator(numticks=20))
    axes.yaxis.set_major_formatter(lambda value, _: power_of_ten(value))
    axes.grid(which="major", color="#E4E4E4", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper left", handlelength=1.0)


def power_of_ten(seconds: float) -> str:
    """A tick: `10 µs`, `1 ms`, `100 s`."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= 0.999 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds / 1e-9:.0f} ns"


def _halves(curves: dict[str, Curve]) -> list[dict[str, Curve]]:
    both = list(curves.items())
    return [dict(both[:2]), dict(both[2:])]


def main() -> None:
    """Write the tables and draw the pictures anew."""
    figures, page = arguments("the tables and pictures of times in docs/speed.md")
    pictures = page.parent / "pictures"
    pictures.mkdir(exist_ok=True)
    draw(_halves(_face_curves(figures)), pictures / "growth-faces.svg", of="faces", least=FITTED_FACES)
    draw(_halves(_contact_curves(figures)), pictures / "growth-contacts.svg", of="contacts")
    rewrite(page, "two-contacts", two_contacts(figures))
    rewrite(page, "growth", growth(figures))


if __name__ == "__main__":
    main()
