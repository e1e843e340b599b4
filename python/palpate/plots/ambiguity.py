"""The ambiguity tree as a picture: figure 3.9, laid on its side so that names have room."""

from __future__ import annotations

import math

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate._core import AmbiguityBranch, AmbiguityNode, AmbiguityTree, Path
from palpate.plots.style import COLORS, CONFLICT, FAINT, RC, new_figure

ROW = 0.3  # inches for a leaf
COLUMN = 3.3  # inches for a level
TURN = 0.7  # of a column: where branches part
MOST_NAMED = 6  # hypotheses that are named at one node
HIGHEST = 60.0  # inches

ANSWERS = {"contact": "contact", "no_contact": "no contact", "either": "contact or none"}
STATUS = {
    "inseparable": "inseparable",
    "no_usable_path": "no usable path",
    "effort": "search cut short",
    "unexpanded": "not planned for",
}


def plot_ambiguity_tree(tree: AmbiguityTree, *, unit: str = "mm") -> Figure:
    """Nodes with the hypotheses that are left, branches with the answers that lead on, touch by touch.

    `I1` is the first hypothesis, `S1` the first answer, as in the thesis. What no path divides is red; each
    path is told by its direction of travel and its margin.
    """
    rows: dict[int, float] = {}
    num_rows = _place(tree.root, rows, next_row=0.0)
    depth = max(node.level for node in tree.nodes)
    with mpl.rc_context(RC):
        height = min(HIGHEST, ROW * num_rows + 1.0)
        figure = new_figure((COLUMN * (depth + 0.75), max(2.0, height)))
        axes = figure.add_subplot()
        for node in tree.nodes:
            _draw_node(axes, tree, node, row=rows[node.number], unit=unit)
            for number, branch in enumerate(node.branches, start=1):
                _draw_branch(axes, node, branch, number=number, rows=rows)
        axes.set_xlim(-0.05, depth + 0.7)
        axes.set_ylim(num_rows - 0.4, -0.6)
        axes.set_axis_off()
        axes.set_title(
            f"{len(tree.names)} hypotheses: {tree.expected_touches:.2f} touches expected, "
            f"{tree.worst_touches} at worst, at least {tree.entropy_bound:.2f} by entropy"
        )
    return figure


def _place(node: AmbiguityNode, rows: dict[int, float], *, next_row: float) -> float:
    """Gives each leaf a row and each other node the middle of its branches; returns the next free row."""
    ahead = [branch.node for branch in node.branches if branch.node is not None]
    if not ahead:
        rows[node.number] = next_row
        return next_row + 1.0
    for below in ahead:
        next_row = _place(below, rows, next_row=next_row)
    rows[node.number] = (rows[ahead[0].number] + rows[ahead[-1].number]) / 2
    return next_row


def _draw_node(axes: Axes, tree: AmbiguityTree, node: AmbiguityNode, *, row: float, unit: str) -> None:
    color = COLORS[2] if node.status == "solved" else COLORS[0] if node.path is not None else CONFLICT
    text = _members(tree, node)
    if node.path is not None:
        text += f"\npath {_way(node.path)} margin {node.path.margin:.3g} {unit}"
    elif node.status != "solved":
        text += f"\n{STATUS[node.status]}"
    axes.text(
        node.level,
        row,
        text,
        color="#222222",
        fontsize=7,
        ha="left",
        va="center",
        bbox={"boxstyle": "round,pad=0.3", "fc": "white", "ec": color, "lw": 1.2},
        zorder=3,
    )


def _way(path: Path) -> str:
    """In the plane its angle, in space its direction."""
    if len(path.direction) == 2:
        x, y = path.direction
        return f"at {math.degrees(math.atan2(y, x)):.1f}°,"
    return f"along ({', '.join(f'{component:.2f}' for component in path.direction)}),\n"


def _members(tree: AmbiguityTree, node: AmbiguityNode) -> str:
    if node.status == "solved":
        return f"I{node.members[0] + 1} {tree.names[node.members[0]]}"
    few = ", ".join(f"I{member + 1}" for member in node.members[:MOST_NAMED])
    return few if len(node.members) <= MOST_NAMED else f"{few}, ... ({len(node.members)})"


def _draw_branch(
    axes: Axes, node: AmbiguityNode, branch: AmbiguityBranch, *, number: int, rows: dict[int, float]
) -> None:
    if branch.node is None:
        return  # the unexpected leads out of the tree, from every node
    row, next_row = rows[node.number], rows[branch.node.number]
    turn = node.level + TURN
    across = [node.level, turn - 0.04, turn, node.level + 1]
    axes.plot(across, [row, row, next_row, next_row], color=FAINT, lw=0.9, zorder=1)
    axes.text(
        turn + 0.01,
        next_row,
        f"S{number} {ANSWERS[branch.answers]}",
        fontsize=6,
        color="#555555",
        va="bottom",
        zorder=2,
    )
