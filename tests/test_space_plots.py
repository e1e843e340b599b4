"""Pictures of space: whole files, the same every time, and true to what they show."""

import math

import numpy as np
import pytest
from brackets import ARMS, FANS, POINTS, POSE, bracket, cube, prism, touches
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

import palpate
from palpate.plots import plot_models, plot_pose_range, plot_recognition, save_figure
from palpate.plots.solids import ELEVATION, in_sight, sharp_edges, to_viewer
from palpate.solids.faces import face_areas, face_places

MISSES = [palpate.Miss((0, 0, 200), (50, 90, 200), tip_radius=2.0)]


@pytest.fixture(scope="module")
def found():
    return palpate.recognize([bracket(), cube()], touches(POINTS[:3]))


@pytest.fixture(params=["recognition", "pose range", "models"])
def figure(request, found):
    if request.param == "recognition":
        return plot_recognition(found, touches(POINTS[:3]), misses=MISSES, unit="in")
    if request.param == "pose range":
        truth = {"world_from_truth": POSE}
        return plot_pose_range(found.hypotheses[0], touches(POINTS[:3]), misses=MISSES, unit="in", **truth)
    return plot_models([bracket(), cube()], unit="in")


def of_kind(axes, kind):
    return [collection for collection in axes.collections if isinstance(collection, kind)]


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_same_picture_is_the_same_whole_file(found, tmp_path, suffix):
    for name in ("one", "two"):
        save_figure(plot_recognition(found, touches(POINTS[:3])), tmp_path / f"{name}.{suffix}")
    content = (tmp_path / f"one.{suffix}").read_bytes()
    assert len(content) > 10_000 and content == (tmp_path / f"two.{suffix}").read_bytes()


def test_axes_are_equal_and_say_their_unit(figure):
    for axes in figure.axes:
        assert [getattr(axes, f"get_{name}label")() for name in "xyz"] == ["x (in)", "y (in)", "z (in)"]
        spans = [np.ptp(getattr(axes, f"get_{name}lim")()) for name in "xyz"]
        assert np.ptp(axes._box_aspect / spans) < 1e-12


def test_nothing_is_drawn_beyond_the_picture(figure):
    figure.draw_without_rendering()
    width, height = figure.canvas.get_width_height()
    for axes in figure.axes:
        labels = [getattr(axes, f"{name}axis").label for name in "xyz"]
        for text in (axes.title, *labels):
            box = text.get_window_extent()
            assert 0 <= box.x0 < box.x1 <= width and 0 <= box.y0 < box.y1 <= height, text.get_text()


class Recorded(Poly3DCollection):
    """Keeps what it is made of, which matplotlib keeps in another form in each release."""

    def __init__(self, polygons, **look):
        super().__init__(polygons, **look)
        self.polygons, self.look = np.concatenate([np.array(polygon) for polygon in polygons]), look


@pytest.fixture
def polygons(monkeypatch):
    monkeypatch.setattr(palpate.plots.solids, "Poly3DCollection", Recorded)


def shaft(arrow):
    """Where an arrow begins and ends: its longest line, up to where those of its head begin."""
    *head, line = sorted(np.array(arrow._segments3d), key=lambda line: np.linalg.norm(line[1] - line[0]))
    assert head and all(np.array_equal(one[0], head[0][0]) for one in head)
    return sorted(line, key=lambda end: np.linalg.norm(end - head[0][0]), reverse=True)


def test_hypotheses_are_drawn_where_they_are(found, polygons):
    axes = plot_recognition(found, touches(POINTS[:3])).axes[0]
    solids = [
        one for one in of_kind(axes, Recorded) if "facecolors" in one.look and len(one.look["facecolors"]) > 7
    ]
    assert len(solids) == len(found.hypotheses) >= 2
    for solid, hypothesis in zip(solids, found.hypotheses, strict=True):
        world = hypothesis.world_from_model
        placed = hypothesis.model.vertices @ world[:3, :3].T + world[:3, 3]
        drawn = np.unique(solid.polygons.round(6), axis=0)
        assert np.allclose(drawn, np.unique(placed.round(6), axis=0), rtol=0.0, atol=2e-6)
        alphas = solid.look["facecolors"][:, 3]
        assert np.all((alphas > 0.0) & (alphas < 0.5)), "translucent"
    # Edges of the parts, and an arrow for each contact.
    assert len(of_kind(axes, Line3DCollection)) == len(found.hypotheses) + 3


def test_normals_are_arrows_and_tips_are_to_scale(found, polygons):
    s = math.sqrt(0.5)
    bounds = {"position_error": 0.5, "normal_error": math.radians(10)}
    contact = palpate.Contact.from_tip((10, 20, 30), 3.0, normal=(s, 0, s), start=(40, 20, 60), **bounds)
    axes = plot_recognition(found, [contact]).axes[0]
    begin, end = shaft(of_kind(axes, Line3DCollection)[-1])
    assert np.allclose(begin, contact.center)
    assert np.allclose((end - begin) / np.linalg.norm(end - begin), contact.normal)
    cone = of_kind(axes, Recorded)[-1].polygons - contact.center
    sides = cone[np.linalg.norm(cone, axis=1) > 1e-9]
    cosines = sides @ contact.normal / np.linalg.norm(sides, axis=1)
    assert len(sides) and np.allclose(np.degrees(np.arccos(cosines)), 10.0)
    rings = [np.array(line.get_data_3d()).T for line in axes.lines if len(line.get_data_3d()[0]) > 2]
    assert len(rings) == 3
    for ring in rings:
        assert np.allclose(np.linalg.norm(ring - contact.center, axis=1), 3.0)


def test_the_approach_points_at_a_contact_without_normal(found):
    contact = palpate.Contact((10, 20, 30), position_error=0.5, approach=(0, 0, -1))
    axes = plot_recognition(found, [contact]).axes[0]
    begin, end = shaft(of_kind(axes, Line3DCollection)[-1])
    assert np.allclose(end, contact.center) and np.array_equal(begin[:2], (10, 20)) and begin[2] > 30


def test_the_range_shows_samples_and_the_truth(found):
    figure = plot_pose_range(found.hypotheses[0], num_samples=7, world_from_truth=POSE)
    (axes,) = figure.axes
    assert len(of_kind(axes, Line3DCollection)) == 7 + 1 + 1
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "pose of largest slack",
        "7 sampled poses",
        "the truth",
    ]
    turn = float(axes.get_title().split("at most ")[1].split("°")[0])
    assert math.degrees(found.hypotheses[0].poses.rotation_bound) <= turn


def test_no_hypothesis_is_a_picture_of_the_conflict():
    contacts = touches([((0, 0, 0), (0, 0, 1)), ((0, 0, 400), (0, 0, -1))], np.eye(4))
    found = palpate.recognize([bracket()], contacts)
    (axes,) = plot_recognition(found, contacts).axes
    assert axes.get_title() == "no model explains the contacts: 1 and 2 can't hold together"


def test_the_plane_and_space_are_drawn_side_by_side():
    flat = palpate.Model.polygon(ARMS, name="arms")
    solid, plane = plot_models([bracket(), flat]).axes
    assert (solid.name, plane.name) == ("3d", "rectilinear")


def test_faces_in_sight_are_numbered():
    model = bracket()
    (axes,) = plot_models([model]).axes
    numbers = [int(text.get_text()) for text in axes.texts]
    normals = model.face_normals[numbers]
    assert np.all(normals @ to_viewer() > 0.0)
    # The top, the front, the end: those at the right of the viewer's, less what the arm hides.
    assert {tuple(normal) for normal in normals.round(6)} == {(0, 0, 1), (0, -1, 0), (1, 0, 0)}


def test_what_is_behind_is_not_in_sight():
    model = cube()
    below, above = face_places(model)[
        [int(np.argmin(model.face_normals[:, 2])), int(np.argmax(model.face_normals[:, 2]))]
    ]
    assert ELEVATION > 0.0 and in_sight(model, np.array([below, above])).tolist() == [False, True]


def test_edges_of_a_curved_surface_are_not_drawn():
    angles = np.linspace(0.0, math.tau, 48, endpoint=False)
    outline = np.c_[30 * np.cos(angles), 30 * np.sin(angles)]
    pin = palpate.Model.mesh(*prism(outline, [(0, k, k + 1) for k in range(1, 47)], 80), name="pin")
    assert len(pin.edges) == 3 * 48 and len(sharp_edges(pin)) == 2 * 48
    assert len(sharp_edges(bracket())) == len(bracket().edges)
    # Of open surfaces the ends are seen.
    loose = palpate.Model.mesh(*(part for part in (prism(ARMS, FANS, 25)[0], prism(ARMS, FANS, 25)[1][:8])))
    assert len(sharp_edges(loose)) == 12


def test_areas_and_places_of_faces():
    model = bracket()
    areas, places = face_areas(model), face_places(model)
    assert sorted(areas) == pytest.approx(sorted([1275, 1275, 1500, 375, 1125, 625, 375, 1000]))
    for place, face, normal in zip(places, model.faces, model.face_normals, strict=True):
        assert (place - face[0]) @ normal == pytest.approx(0.0)
        assert model.distance(np.eye(4), place) == pytest.approx(0.0, abs=1e-9)
        assert model.distance(np.eye(4), place - 1e-3 * normal) < 0.0
    seamed = palpate.Model.facets([face for face in model.faces], seams=[2])
    assert face_areas(seamed)[2] == 0.0 and np.isnan(face_places(seamed)[2]).all()
