"""Pictures of planning: whole files, the same every time, and true to what they show."""

import math

import numpy as np
import pytest
from conftest import hypotheses_of, usual_sensor
from matplotlib.collections import LineCollection
from matplotlib.path import Path as Outline

import palpate
from palpate.plots import plot_ambiguity_tree, plot_lines, plot_path, plot_projection_space, save_figure


@pytest.fixture(scope="module")
def hands():
    return hypotheses_of("human-hand")


@pytest.fixture(scope="module")
def path(hands):
    return palpate.plan(hands, usual_sensor())


def texts(axes):
    return [text.get_text() for text in axes.texts]


def test_the_path_and_what_it_may_touch(hands, path):
    figure = plot_path(hands, path, palpate.standard_contacts("human-hand"), tip_radius=1.0)
    (axes,) = figure.axes
    assert len([one for one in axes.collections if isinstance(one, LineCollection)]) == 4
    assert axes.get_title() == "4 hypotheses: 4 classes, score 1, guaranteed"
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[3].startswith("4 boot: face ") and len(labels) == 4
    # The bars beside the path begin and end where the outcomes say.
    bars = [line.get_xydata() for line in axes.lines if line.get_linewidth() == 4.0]
    depths = [[float(path.direction @ (end - path.start)) for end in bar] for bar in bars]
    expected = [touch.depth for outcome in path.outcomes for touch in outcome.touches]
    assert np.allclose(depths, expected)


def test_an_unusable_path_and_none(hands):
    inside = palpate.judge(hands, usual_sensor(), (0, 40), (1, 0))
    assert "can't be used (start" in plot_path(hands, inside).axes[0].get_title()
    assert plot_path(hands, None).axes[0].get_title() == "4 hypotheses: no path"
    with pytest.raises(ValueError, match=r"^hypotheses: must not be empty"):
        plot_path([], None)


def test_the_tree_has_every_node(hands):
    tree = palpate.plan_tree(hands, usual_sensor())
    (axes,) = plot_ambiguity_tree(tree).axes
    shown = texts(axes)
    for number, name in enumerate(tree.names, start=1):
        assert f"I{number} {name}" in shown
    assert len(shown) == len(tree.nodes) + 4  # a text for each node and each branch
    assert axes.get_title().startswith("4 hypotheses: 1.00 touches expected")
    lone = palpate.plan_tree(hands, usual_sensor(), max_nodes=0)
    assert "not planned for" in texts(plot_ambiguity_tree(lone).axes[0])[0]


def test_the_plane_of_lines_has_the_scores(hands, path):
    figure = plot_lines(hands, usual_sensor(), path, directions=((0, -1), 1.0))
    axes = figure.axes[0]
    scores = np.asarray(axes.images[0].get_array().filled(math.nan))
    assert scores.shape == (240, 360) and np.nanmin(scores) == 1.0 and np.nanmax(scores) == 4.0
    angles = -math.pi + 2 * math.pi * (np.arange(360) + 0.5) / 360
    allowed = np.abs(angles + math.pi / 2) <= 1.0
    assert np.isnan(scores[:, ~allowed]).all() and not np.isnan(scores[:, allowed]).all()
    lines = palpate.Lines(hands, usual_sensor())
    (mark,) = axes.lines
    (angle,), (offset,) = mark.get_data()
    assert lines.judge(math.radians(angle), offset).score == path.score


def line_of(axes, **look):
    """The points of the one line that looks so."""
    (found,) = [one for one in axes.lines if all(getattr(one, f"get_{k}")() == v for k, v in look.items())]
    return np.asarray(found.get_xydata())


def test_projection_space_has_the_sheaves_the_critical_points_and_the_path(hands):
    space = palpate.projection_space(hands, usual_sensor())
    figure = plot_projection_space(hands, space, unit="cm", part_names=list("abcdef"))
    plane, lines = figure.axes
    assert figure.get_suptitle().startswith("projection space of face 1 of 1 b: path at α = 0.402 (21.9°)")
    assert plane.get_xlabel() == "x (cm)" and lines.get_xlabel() == "position on the generator's axis (cm)"
    assert np.array_equal(line_of(lines, marker="o"), space.critical_points)
    assert np.array_equal(line_of(lines, marker="+"), [[space.path_position, space.path_slope]])
    (marks,) = [one for one in lines.collections if isinstance(one, LineCollection)]
    assert [ends[0][1] for ends in marks.get_segments()] == space.critical_slopes.tolist()
    overlap = next(o for o in space.overlaps(space.path_slope) if np.mean(o.positions) == space.path_position)
    assert np.array_equal(line_of(lines, linewidth=2.2)[:, 0], overlap.positions)
    # What is shared holds the path, and is where the inner projections of all that are pierced overlap.
    shared = line_of(lines, linewidth=1.3)
    assert Outline(shared).contains_point((space.path_position, space.path_slope))
    for number in overlap.sheaves:
        inner = space.sheaves[number].inner(shared[:, 1])
        assert (shared[:, 0] >= inner[:, 0] - 1e-9).all() and (shared[:, 0] <= inner[:, 1] + 1e-9).all()
    named = [f"{space.sheaves[k].hypothesis + 1}: face {space.sheaves[k].face}" for k in overlap.sheaves]
    assert sorted(texts(lines)) == sorted(named)
    assert sum(line.get_linewidth() == 0.5 for line in lines.lines) == len(space.sheaves) - len(named)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    parts = [f"{number} {'abcdef'[hand.model_number]}" for number, hand in enumerate(hands, start=1)]
    assert labels[:4] == parts and labels[-1] == "overlap, and the path"


def test_projection_space_without_a_path_and_of_other_hypotheses(hands):
    lone = palpate.projection_space(hands[:1], usual_sensor())
    figure = plot_projection_space(hands[:1], lone)
    assert figure.get_suptitle() == "projection space of face 1 of 1 human-hand: no path"
    assert "overlap, and the path" not in [text.get_text() for text in figure.legends[0].get_texts()]
    assert texts(figure.axes[1]) == ["1: face 1"]
    space = palpate.projection_space(hands, usual_sensor())
    with pytest.raises(ValueError, match=r"^hypotheses: must be those of the projection space.*\(got 2\)"):
        plot_projection_space(hands[:2], space)


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_files_are_whole_and_the_same_every_time(hands, path, *, tmp_path, suffix):
    tree = palpate.plan_tree(hands, usual_sensor())
    space = palpate.projection_space(hands, usual_sensor())
    makers = (
        lambda: plot_path(hands, path),
        lambda: plot_ambiguity_tree(tree),
        lambda: plot_projection_space(hands, space),
    )
    for make in makers:
        for name in ("one", "two"):
            save_figure(make(), tmp_path / f"{name}.{suffix}")
        assert (tmp_path / f"one.{suffix}").read_bytes() == (tmp_path / f"two.{suffix}").read_bytes()


def test_a_run_and_each_step_of_it(tmp_path):
    model = palpate.load_models("boot")[0]
    probe = palpate.SimulatedProbe(model, np.eye(3), usual_sensor())
    result = palpate.identify([model], probe, usual_sensor(), [[-300, -300], [300, 300]])
    for step in [*range(result.touches), None]:
        figure = palpate.plots.plot_run(result, step)
        axes = figure.axes[0]
        assert axes.get_title() and len(axes.lines) >= (step or 0)
    with pytest.raises(ValueError, match="step"):
        palpate.plots.plot_run(result, result.touches)
