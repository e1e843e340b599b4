"""Pictures: whole files, the same every time, and true to what they show."""

import math
import struct
import xml.etree.ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from conftest import pose
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, Polygon, Wedge

import palpate
from palpate import Contact, Miss, Model
from palpate.plots import plot_models, plot_pose_range, plot_recognition, save_figure
from palpate.plots.shapes import outline_of
from palpate.plots.style import COLORS, at_most


@pytest.fixture(scope="module")
def bracket():
    return Model.polygon([[0, 0], [80, 0], [80, 15], [20, 15], [20, 60], [0, 60]], name="bracket")


@pytest.fixture(scope="module")
def touches():
    rotation, shift = pose(0.5)[:2, :2], np.array([30.0, -10.0])
    places = [((30, 0), (0, -1)), ((0, 20), (-1, 0))]
    return [
        Contact(rotation @ p + shift, rotation @ n, position_error=0.5, normal_error=math.radians(4))
        for p, n in places
    ]


@pytest.fixture(scope="module")
def found(bracket, touches):
    plate = Model.polygon([[0, 0], [50, 0], [50, 40], [0, 40]], name="plate")
    return palpate.recognize([bracket, plate], touches)


@pytest.fixture(params=["recognition", "pose range", "models"])
def figure(request, found, *, bracket, touches):
    if request.param == "recognition":
        return plot_recognition(found, touches, misses=[Miss((0, 100), (50, 90), tip_radius=2.0)])
    if request.param == "pose range":
        return plot_pose_range(found.hypotheses[0], touches)
    return plot_models([bracket, bracket])


def test_svg_is_whole(figure, tmp_path):
    save_figure(figure, tmp_path / "picture.svg")
    root = ET.parse(tmp_path / "picture.svg").getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 10


def test_png_is_whole(figure, tmp_path):
    save_figure(figure, tmp_path / "picture.png")
    content = (tmp_path / "picture.png").read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", content[16:24])
    assert min(width, height) > 500
    assert content.endswith(b"IEND\xaeB`\x82")


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_same_picture_is_the_same_file(found, touches, *, tmp_path, suffix):
    for name in ("one", "two"):
        save_figure(plot_recognition(found, touches), tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"one.{suffix}").read_bytes() == (tmp_path / f"two.{suffix}").read_bytes()


def test_drawing_leaves_matplotlib_as_it_was(found, touches, tmp_path):
    before = dict(mpl.rcParams)
    save_figure(plot_recognition(found, touches), tmp_path / "picture.svg")
    assert dict(mpl.rcParams) == before


def test_nothing_is_left_of_a_picture_that_fails(figure, tmp_path):
    with pytest.raises(ValueError, match=r"pictures can't be saved as '\.bmp'"):
        save_figure(figure, tmp_path / "picture.bmp")
    assert list(tmp_path.iterdir()) == []


def test_hypotheses_are_drawn_where_they_are(found, touches):
    figure = plot_recognition(found, touches)
    drawn = [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]
    assert len(drawn) == len(found.hypotheses)
    for lines, hypothesis in zip(drawn, found.hypotheses, strict=True):
        world = hypothesis.world_from_model
        expected = [face @ world[:2, :2].T + world[:2, 2] for face in hypothesis.model.faces]
        assert np.allclose(np.array(lines.get_segments()), np.array(expected))


def test_each_part_has_its_colour_and_its_place_in_the_legend(found, touches):
    figure = plot_recognition(found, touches)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    parts = list(dict.fromkeys(hypothesis.model.name for hypothesis in found.hypotheses))
    assert [label.split(" (")[0] for label in labels] == parts
    colors = [mpl.colors.to_hex(line.get_color()).upper() for line in figure.legends[0].get_lines()]
    assert colors == list(COLORS[: len(parts)])


def test_errors_are_drawn_to_scale(found):
    contact = Contact.from_tip(
        (10, 20), 3.0, position_error=0.5, normal=(0, 1), normal_error=math.radians(10)
    )
    axes = plot_recognition(found, [contact]).axes[0]
    radii = {patch.radius for patch in axes.patches if isinstance(patch, Circle)}
    assert radii == {0.5, 3.0}
    (cone,) = (patch for patch in axes.patches if isinstance(patch, Wedge))
    assert (cone.theta1, cone.theta2) == (pytest.approx(80.0), pytest.approx(100.0))


def test_axes_are_equal_and_say_their_unit(found, bracket, touches):
    figures = (
        plot_recognition(found, touches, unit="in"),
        plot_pose_range(found.hypotheses[0], unit="in"),
        plot_models([bracket], unit="in"),
    )
    for figure in figures:
        axes = figure.axes[0]
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (in)", "y (in)")
        assert axes.get_aspect() == 1.0


def test_every_sample_lies_in_the_shaded_ranges(found, touches):
    hypothesis = found.hypotheses[0]
    axes = plot_pose_range(hypothesis, touches).axes[0]
    regions = [patch.get_path() for patch in axes.patches if type(patch) is Polygon]
    assert len(regions) == len(hypothesis.model.vertices)
    for world in hypothesis.poses.sample(20, seed=5):
        for vertex, region in zip(hypothesis.model.vertices, regions, strict=True):
            place = world[:2, :2] @ vertex + world[:2, 2]
            assert region.contains_point(place, radius=1e-6) or region.contains_point(place, radius=-1e-6)


def test_no_hypothesis_is_a_picture_of_the_conflict(bracket):
    contacts = [Contact(place, position_error=0.1) for place in ((0, 0), (30, 0), (1000, 0))]
    found = palpate.recognize([bracket], contacts)
    title = plot_recognition(found, contacts).axes[0].get_title()
    assert title.startswith("no model explains the contacts: ")
    assert title.endswith(" can't hold together")


def test_holes_and_gaps_begin_a_new_run():
    square = np.array([[0, 0], [10, 0], [10, 10], [0, 10]])
    holed = Model.polygon(square, holes=[square * 0.2 + 4])
    codes = outline_of(holed).codes
    assert list(codes).count(1) == 2
    loose = Model.segments([[[0, 0], [1, 0]], [[1, 0], [1, 1]], [[5, 5], [6, 5]]], seams=[2])
    assert list(outline_of(loose).codes).count(1) == 2


def test_models_show_face_numbers_and_what_can_t_be_touched():
    model = Model.segments([[[0, 0], [9, 0]], [[9, 0], [9, 9]], [[9, 9], [0, 9]]], seams=[1], untouchable=[2])
    axes = plot_models([model]).axes[0]
    assert [text.get_text() for text in axes.texts] == ["0", "2"]
    assert len([c for c in axes.collections if isinstance(c, LineCollection)]) == 3


def test_no_models_can_t_be_drawn():
    with pytest.raises(ValueError, match="models: nothing to draw"):
        plot_models([])


def test_bounds_are_rounded_outward():
    assert [at_most(value) for value in (1.3527, 0.0, 12.31, 100.0, 0.25, 123456.0, 1.2e-7)] == [
        "1.36",
        "0",
        "12.4",
        "100",
        "0.25",
        "1.24e+05",
        "1.2e-07",
    ]
    for value in np.random.default_rng(0).uniform(1e-9, 1.0, 500):
        assert value * (1 - 1e-9) <= float(at_most(value)) <= 1.011 * value


def test_the_title_of_a_range_is_a_bound(found, touches):
    hypothesis = found.hypotheses[0]
    title = plot_pose_range(hypothesis, touches).axes[0].get_title()
    turn = float(title.split("at most ")[1].split("°")[0])
    assert math.degrees(hypothesis.poses.rotation_bound) <= turn


def test_what_is_too_small_to_be_seen_is_not_in_the_legend(found, touches, bracket):
    assert len(plot_pose_range(found.hypotheses[0], touches).legends[0].get_texts()) == 3
    bounds = {"position_error": 0.01, "normal_error": 1e-4}
    exact = [Contact((30, 0), (0, -1), **bounds), Contact((0, 20), (-1, 0), **bounds)]
    hypothesis = palpate.recognize([bracket], exact).hypotheses[0]
    (text,) = plot_pose_range(hypothesis, exact).legends[0].get_texts()
    assert text.get_text() == "pose of largest slack; the others lie under its lines"


def test_face_numbers_are_thinned_where_there_are_many():
    angles = np.linspace(0.0, 2.0 * math.pi, 150, endpoint=False)
    axes = plot_models([Model.polygon(np.c_[np.cos(angles), np.sin(angles)] * 50)]).axes[0]
    assert [text.get_text() for text in axes.texts] == [str(k) for k in range(0, 150, 5)]
    assert axes.get_title().endswith(", every 5th numbered")
    assert [title_of(sides).split("faces")[1].split(", ")[-1] for sides in (40, 100)] == [
        "40 symmetries",
        "every 2nd numbered",
    ]


def title_of(sides):
    angles = np.linspace(0.0, 2.0 * math.pi, sides, endpoint=False)
    return plot_models([Model.polygon(np.c_[np.cos(angles), np.sin(angles)])]).axes[0].get_title()


def test_a_model_that_is_drawn_small_has_fewer_numbers():
    angles = np.linspace(0.0, 2.0 * math.pi, 40, endpoint=False)
    disc = Model.polygon(np.c_[np.cos(angles), np.sin(angles)] * 20)
    plate = Model.polygon([[0, 0], [120, 0], [120, 120], [0, 120]])
    axes, _ = plot_models([disc, plate]).axes
    assert [text.get_text() for text in axes.texts] == [str(k) for k in range(0, 40, 5)]


def test_models_of_one_name_are_told_apart(bracket, touches):
    other = Model.polygon(bracket.vertices * [1, 2], name="bracket")
    found = palpate.recognize([bracket, other], touches)
    for names, expected in (
        (None, ["bracket (model 1)", "bracket (model 2)"]),
        (["left", "right"], ["left", "right"]),
    ):
        texts = plot_recognition(found, touches, part_names=names).legends[0].get_texts()
        assert [text.get_text().rsplit(" (", 1)[0] for text in texts] == expected
