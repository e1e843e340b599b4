"""Pictures in the manner of the thesis: parts, superposed hypotheses, pose ranges, paths, trees, runs.

Each function returns a matplotlib `Figure` that belongs to no window; `save_figure` writes it as SVG, PNG or
PDF, by the suffix, and the same figure gives the same file every time.
"""

from palpate.plots.ambiguity import plot_ambiguity_tree
from palpate.plots.lines import plot_lines
from palpate.plots.paths import plot_path
from palpate.plots.pictures import plot_models, plot_pose_range, plot_recognition
from palpate.plots.recordings import plot_recording
from palpate.plots.runs import plot_run, plot_turning_point
from palpate.plots.sheaves import plot_projection_space
from palpate.plots.style import save_figure

__all__ = [
    "plot_ambiguity_tree",
    "plot_lines",
    "plot_models",
    "plot_path",
    "plot_pose_range",
    "plot_projection_space",
    "plot_recognition",
    "plot_recording",
    "plot_run",
    "plot_turning_point",
    "save_figure",
]
