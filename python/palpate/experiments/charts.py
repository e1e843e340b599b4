"""Charts of tables: the thesis's figures beside ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from palpate.experiments.printed import RandomData, set_name
from palpate.plots.style import COLORS, FAINT, RC, new_figure, svg_of

OURS = COLORS[0]
PHASE_COLORS = {
    "initial data": COLORS[0],
    "recognition": COLORS[1],
    "planning": COLORS[4],
    "execution": COLORS[2],
}


def depth_chart(means: Mapping[tuple[str, ...], tuple[RandomData, float, float]]) -> bytes:
    """For each set of models: mean interpretations and mean depth, the thesis's and ours."""
    labels = [set_name(names) for names in means]
    rows = np.arange(len(labels))
    with mpl.rc_context(RC):
        figure = new_figure((8.4, 0.36 * len(labels) + 1.4))
        left, right = figure.subplots(1, 2, sharey=True)
        printed = [one.interpretations for one, _, _ in means.values()]
        _dots(left, printed, [ours for _, ours, _ in means.values()])
        left.set_xscale("log")
        left.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        left.minorticks_off()
        left.set_title("mean number of interpretations")
        printed = [one.sixty_seconds_depth for one, _, _ in means.values()]
        _dots(right, printed, [depth for _, _, depth in means.values()])
        right.set_xlim(0.95, 1.55)
        right.set_title("depth: touches at worst, mean")
        left.set_yticks(rows, labels)
        left.invert_yaxis()
        handles, names = left.get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=2)
        return svg_of(figure)


def _dots(axes: Axes, thesis: Sequence[float], ours: Sequence[float]) -> None:
    rows = np.arange(len(thesis))
    axes.hlines(rows, thesis, ours, color="#D0D0D0", lw=1.4, zorder=1)
    axes.plot(
        thesis, rows, ls="", marker="o", ms=8.5, mfc="white", mec=FAINT, mew=1.4, label="thesis", zorder=2
    )
    axes.plot(ours, rows, ls="", marker="o", ms=6, color=OURS, label="ours", zorder=3)
    axes.grid(axis="x", color="#EBEBEB", lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)
    axes.spines[["top", "right", "left"]].set_visible(False)


def phases_chart(bars: Mapping[str, Sequence[float]]) -> bytes:
    """A bar for each label, of phases one after the other; seconds."""
    rows = np.arange(len(bars))
    with mpl.rc_context(RC):
        figure = new_figure((8.4, 0.55 * len(bars) + 1.2))
        axes = figure.add_subplot()
        before = np.zeros(len(bars))
        for (phase, color), lengths in zip(
            PHASE_COLORS.items(), zip(*bars.values(), strict=True), strict=True
        ):
            axes.barh(rows, lengths, left=before, height=0.62, color=color, label=phase)
            for row, (start, length) in enumerate(zip(before, lengths, strict=True)):
                if length >= 1.0:
                    axes.text(
                        start + length / 2,
                        row,
                        f"{length:.3g}",
                        color="white",
                        ha="center",
                        va="center",
                        fontsize=8,
                    )
            before += lengths
        axes.set_yticks(rows, list(bars))
        axes.invert_yaxis()
        axes.set_xlabel("seconds")
        axes.tick_params(axis="y", length=0)
        axes.spines[["top", "right", "left"]].set_visible(False)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4)
        return svg_of(figure)
