"""Model files: what JSON, DXF and SVG files become, what curves cost, and what is refused."""

# ruff: noqa: E501 (tables are easier to read with a case to a line)

import json
import math
import re
from pathlib import Path
from random import Random

import ezdxf
import jsonschema
import numpy as np
import pytest
from brackets import bracket
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate import Model, recognize
from palpate.curves import Tolerance, bezier, elliptic_arc, spline
from palpate.experiments.solid_shapes import DRAWN, FAMILIES, bundled_files, random_solid
from palpate.models import bundled_parts, bundled_solids, load_models, save_model
from palpate.parts import contacts_path, part_names, part_path, solid_part_names, standard_contacts
from palpate.rotations import rotation_of

SCHEMA = Path(str(part_path("boot"))).parents[1] / "schemas" / "model-1.json"
SQUARE = [[0, 0], [40, 0], [40, 30], [0, 30]]


def area(model):
    """Of the material: holes count against it, since their faces run the other way."""
    return 0.5 * sum(float(a[0] * b[1] - a[1] * b[0]) for a, b in model.faces)


def extent(model):
    return [*np.min(model.vertices, axis=0), *np.max(model.vertices, axis=0)]


# --- bundled parts --------------------------------------------------------------------------------

FACES = {
    "robot-hand": 12, "human-hand": 18, "telephone": 12, "boot": 13, "camera": 12, "beer-bottle": 8,
    "drill-left": 18, "drill-right": 20, "armature": 20,
}  # fmt: skip


def test_bundled_parts_are_clean_and_have_the_faces_they_should():
    parts = bundled_parts()
    assert {part.name: len(part.faces) for part in parts} == FACES
    for part in parts:
        assert part.closed
        assert part.mends == []
        assert len(part.symmetries) == 1
        assert 100.0 <= part.size <= 200.0


def test_a_part_is_found_by_name_unless_a_file_has_that_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert [model.name for model in load_models(["camera", "boot"])] == ["camera", "boot"]
    (tmp_path / "boot").mkdir()
    save_model(Model.polygon(SQUARE, name="plate"), tmp_path / "boot" / "plate.json")
    assert [model.name for model in load_models("boot")] == ["plate"]


def test_parts_follow_the_schema_and_say_that_they_are_drawn_anew():
    schema = json.loads(SCHEMA.read_text())
    for name in part_names():
        document = json.loads(Path(str(part_path(name))).read_text())
        jsonschema.validate(document, schema)
        assert "rawn anew" in document["note"]


# --- JSON -----------------------------------------------------------------------------------------

MODELS = [
    Model.polygon(SQUARE, name="plate", untouchable=[1], position_slack=0.25, normal_slack=0.125),
    Model.polygon(
        SQUARE, holes=[[[5, 5], [5, 10], [10, 5]], [[20, 5], [20, 10], [25, 5]]], untouchable=[4, 7]
    ),
    Model.segments([[[0, 0], [10, 0]], [[10, 0], [10, 9]], [[0, 0], [0, 9]]], seams=[2], untouchable=[0]),
]


@pytest.mark.parametrize("model", MODELS)
def test_a_saved_model_comes_back(model, tmp_path):
    save_model(model, tmp_path / "model.json", unit="cm")
    jsonschema.validate(json.loads((tmp_path / "model.json").read_text()), json.loads(SCHEMA.read_text()))
    (back,) = load_models([tmp_path / "model.json"], unit="cm")
    assert np.array_equal(back.faces, model.faces)
    assert (back.name, back.face_surfaces, back.closed) == (model.name, model.face_surfaces, model.closed)
    assert back.position_slack == model.position_slack
    assert back.normal_slack == pytest.approx(model.normal_slack, rel=1e-15)
    (in_mm,) = load_models([tmp_path / "model.json"])
    assert in_mm.size == pytest.approx(10.0 * model.size)
    assert in_mm.position_slack == pytest.approx(10.0 * model.position_slack)


FLOOR = [[0, 0, 0], [90, 0, 0], [90, 50, 0], [0, 50, 0]]
HOLE = [[10, 10, 0], [10, 20, 0], [20, 20, 0], [20, 10, 0]]
WALL = [[0, 50, 0], [90, 50, 0], [90, 50, 70], [0, 50, 70]]
SOLIDS = [
    *(
        Model.mesh(solid.vertices, solid.triangles, name=solid.name)
        for solid in (make() for make in DRAWN.values())
    ),
    *(
        Model.mesh(s.vertices, s.triangles, name="any")
        for s in (random_solid(Random(7), name) for name in FAMILIES)
    ),
    bracket(untouchable=[0, 1, 2, 3], position_slack=0.25, normal_slack=0.125),
    Model.facets([[FLOOR, HOLE], WALL], name="corner", untouchable=[1]),
    Model.facets([[FLOOR, HOLE], WALL], name="corner", seams=[1]),
]


@pytest.mark.parametrize("model", SOLIDS, ids=lambda model: model.name)
def test_a_saved_solid_comes_back(model, tmp_path):
    save_model(model, tmp_path / "model.json", unit="cm")
    jsonschema.validate(json.loads((tmp_path / "model.json").read_text()), json.loads(SCHEMA.read_text()))
    (back,) = load_models([tmp_path / "model.json"], unit="cm")
    assert [len(loops) for loops in back.face_loops] == [len(loops) for loops in model.face_loops]
    for loops, others in zip(back.face_loops, model.face_loops, strict=True):
        assert all(np.array_equal(loop, other) for loop, other in zip(loops, others, strict=True))
    assert np.array_equal(back.vertices, model.vertices) and np.array_equal(back.edges, model.edges)
    assert np.allclose(back.face_normals, model.face_normals, rtol=0.0, atol=1e-12)
    assert np.array_equal(back.symmetries, model.symmetries)
    assert (back.name, back.face_surfaces, back.closed) == (model.name, model.face_surfaces, model.closed)
    assert back.position_slack == model.position_slack
    assert back.normal_slack == pytest.approx(model.normal_slack, rel=1e-15)


def test_corners_off_their_planes_cost_slack_again(tmp_path):
    solid = DRAWN["flange"]()
    turn = rotation_of((0.3, 0.5, 0.7))
    rounded = (solid.vertices @ turn.T).astype(np.float32).astype(float)
    model = Model.mesh(rounded, solid.triangles)
    save_model(model, tmp_path / "model.json")
    (back,) = load_models([tmp_path / "model.json"])
    assert np.array_equal(back.faces[0], model.faces[0]) and len(back.faces) == len(model.faces)
    assert 0.0 < model.position_slack <= back.position_slack <= 2.0 * model.position_slack < 1e-4


def alike(one, other):
    """Documents with the same numbers, but for what sines of other machines are off."""
    if isinstance(one, dict):
        return list(one) == list(other) and alike(list(one.values()), list(other.values()))
    if isinstance(one, list):
        return len(one) == len(other) and all(map(alike, one, other))
    return one == (pytest.approx(other, abs=1e-12) if isinstance(other, float) else other)


def test_bundled_solids_are_as_the_code_makes_them():
    for model in bundled_solids():
        files = part_path(model.name), contacts_path(model.name)
        for file, made in zip(files, bundled_files(model.name), strict=True):
            assert alike(json.loads(file.read_text()), json.loads(made))
        document = json.loads(files[0].read_text())
        jsonschema.validate(document, json.loads(SCHEMA.read_text()))
        assert "Drawn by the project" in document["note"]
        assert (model.dimension, model.closed, model.mends) == (3, True, [])
        assert 100.0 <= model.size <= 200.0
    files = [file for name in solid_part_names() for file in (part_path(name), contacts_path(name))]
    assert sum(file.stat().st_size for file in files) < 20_000
    assert not set(solid_part_names()) & set(part_names())


@pytest.mark.parametrize("name", solid_part_names())
def test_the_contacts_of_a_bundled_solid_fit_it_as_it_stands(name):
    found = recognize(bundled_solids(), standard_contacts(name))
    assert found.complete
    assert any(h.model.name == name and h.poses.contains(np.eye(4)) for h in found.hypotheses)


def test_a_folder_gives_its_models_by_name_and_leaves_other_documents(tmp_path):
    for name in ("b", "a", "c"):
        save_model(Model.polygon(SQUARE, name=name), tmp_path / f"{name}.json")
    (tmp_path / "touches.json").write_text('{"schema": "palpate-contacts", "version": 1}')
    (tmp_path / "notes.txt").write_text("not a model")
    assert [model.name for model in load_models([tmp_path])] == ["a", "b", "c"]


# --- DXF ------------------------------------------------------------------------------------------


def dxf(tmp_path, draw, *, units=4, name="part"):
    document = ezdxf.new("R2010")
    document.units = units
    draw(document.modelspace())
    path = tmp_path / f"{name}.dxf"
    document.saveas(path)
    return path


@pytest.mark.parametrize(
    ("units", "unit", "factor"), [(4, "mm", 1.0), (1, "mm", 25.4), (6, "in", 1000 / 25.4), (5, "um", 1e4)]
)
def test_dxf_units_are_converted(tmp_path, units, unit, factor):
    path = dxf(tmp_path, lambda space: space.add_lwpolyline(SQUARE, close=True), units=units)
    (model,) = load_models([path], unit=unit)
    assert extent(model) == pytest.approx([0, 0, 40 * factor, 30 * factor])
    assert (model.mends, model.position_slack, model.normal_slack) == ([], 0.0, 0.0)


def test_a_dxf_without_unit_is_in_the_models_and_says_so(tmp_path):
    path = dxf(tmp_path, lambda space: space.add_lwpolyline(SQUARE, close=True), units=0)
    (model,) = load_models([path], unit="in")
    assert model.size == pytest.approx(50.0)
    assert model.mends == ["the drawing names no unit: taken as in"]


def test_loose_lines_and_arcs_are_chained_in_any_order(tmp_path):
    def draw(space):
        space.add_arc((40, 15), 15, -90, 90)
        space.add_line((0, 30), (40, 30))
        space.add_line((0, 30), (0, 0))
        space.add_line((40, 0), (0, 0))

    (model,) = load_models([dxf(tmp_path, draw)])
    assert model.closed
    assert area(model) == pytest.approx(1200 + 0.5 * math.pi * 15**2, rel=1e-3)
    assert extent(model)[2] == pytest.approx(55.0, abs=model.position_slack)


def test_bulges_are_arcs_of_the_angle_they_say(tmp_path):
    half_turn = dxf(tmp_path, lambda s: s.add_lwpolyline([(0, 0, 1), (20, 0, 1)], format="xyb", close=True))
    (disc,) = load_models([half_turn])
    assert np.hypot(*(disc.vertices - [10, 0]).T) == pytest.approx(10.0)
    inward = [(0, 0, 0), (20, 0, 0), (20, 20, -1), (0, 20, 0)]
    (bay,) = load_models([dxf(tmp_path, lambda s: s.add_lwpolyline(inward, format="xyb", close=True))])
    assert area(bay) == pytest.approx(400 - 50 * math.pi, rel=5e-3)


def test_holes_islands_and_several_outlines(tmp_path):
    def draw(space):
        space.add_lwpolyline([(100, 0), (150, 0), (150, 50), (100, 50)], close=True)
        space.add_circle((20, 15), 12)
        space.add_lwpolyline(SQUARE, close=True)
        space.add_lwpolyline([(18, 13), (22, 13), (20, 17)], close=True)

    plate, island, other = load_models([dxf(tmp_path, draw, name="sheet")])
    assert [plate.name, island.name, other.name] == ["sheet-1", "sheet-2", "sheet-3"]
    assert area(plate) == pytest.approx(1200 - math.pi * 144, rel=5e-3)
    assert (len(island.faces), len(other.faces)) == (3, 4)


def test_blocks_are_exploded_where_they_are_inserted(tmp_path):
    def draw(space):
        block = space.doc.blocks.new("nut")
        block.add_circle((0, 0), 10)
        inner = space.doc.blocks.new("pair")
        inner.add_blockref("nut", (0, 0))
        inner.add_blockref("nut", (30, 0), dxfattribs={"xscale": 0.5, "yscale": 0.25})
        space.add_blockref("pair", (100, 50), dxfattribs={"rotation": 90})

    small, round_ = sorted(load_models([dxf(tmp_path, draw)]), key=area)
    assert extent(round_) == pytest.approx([90, 40, 110, 60], abs=0.1)
    assert extent(small) == pytest.approx([97.5, 75, 102.5, 85], abs=0.1)


def test_entities_seen_from_behind_are_mirrored(tmp_path):
    def draw(space):
        back = {"extrusion": (0, 0, -1)}
        space.add_arc((-40, 15), 15, 90, 270, dxfattribs=back)
        space.add_lwpolyline([(-40, 0), (0, 0), (0, 30), (-40, 30)], dxfattribs=back)

    (model,) = load_models([dxf(tmp_path, draw)])
    assert model.closed
    assert extent(model) == pytest.approx([0, 0, 55, 30], abs=0.1)


def test_the_corners_of_an_ellipse_are_on_it(tmp_path):
    (model,) = load_models([dxf(tmp_path, lambda s: s.add_ellipse((5, 0), major_axis=(30, 40), ratio=0.4))])
    along, across = ((model.vertices - [5, 0]) @ np.array([[0.6, -0.8], [0.8, 0.6]])).T
    assert np.hypot(along / 50, across / 20) == pytest.approx(1.0)
    assert len(model.symmetries) == 2


def test_a_rational_spline_is_the_circle_it_stands_for(tmp_path):
    def draw(space):
        corners, weights = (
            [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)],
            [1, 0.5**0.5],
        )
        knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
        points = [(30 * x, 30 * y) for x, y in corners]
        space.add_rational_spline(points, [weights[k % 2] for k in range(9)], degree=2, knots=knots)

    (model,) = load_models([dxf(tmp_path, draw)])
    assert np.hypot(*model.vertices.T) == pytest.approx(30.0)
    assert 0.0 < model.position_slack <= 0.05


def test_gaps_within_the_tolerance_are_closed_and_counted(tmp_path):
    corners = [(0, 0), (40, 0), (40, 30), (0, 30.02)]

    def draw(space):
        for start, end in zip(corners, [(40, 0), (40, 30), (0, 30), (0.015, 0)], strict=True):
            space.add_line(start, end)

    (model,) = load_models([dxf(tmp_path, draw)])
    assert model.closed
    assert model.position_slack == pytest.approx(0.02, abs=1e-9)
    assert model.normal_slack == pytest.approx(0.015 / 30, rel=1e-2)
    assert "gaps of up to 0.02" in model.mends[0]
    (apart,) = load_models([dxf(tmp_path, draw)], flattening=0.001)
    assert not apart.closed


def test_open_lines_are_loose_faces_or_left_out(tmp_path):
    (corner,) = load_models([dxf(tmp_path, lambda s: s.add_lwpolyline([(0, 0), (40, 0), (40, 30)]))])
    assert not corner.closed
    assert [face.tolist() for face in corner.faces] == [[[0, 0], [40, 0]], [[40, 0], [40, 30]]]
    assert corner.face_normals[0].tolist() == [0, -1]
    assert corner.touchable_vertices.tolist() == [False, True, False]

    def draw(space):
        space.add_lwpolyline(SQUARE, close=True)
        space.add_line((-10, 15), (50, 15))
        space.add_text("plate")

    (plate,) = load_models([dxf(tmp_path, draw)])
    assert len(plate.faces) == 4
    assert plate.mends == ["left out: 1 TEXT", "1 open line(s) left out, since there are closed ones"]


def test_entities_of_unknown_kinds_are_left_out(tmp_path):
    path = dxf(tmp_path, lambda s: (s.add_lwpolyline(SQUARE, close=True), s.add_point((1, 1))))
    path.write_text(path.read_text().replace("\nPOINT\n", "\nGADGET\n"))
    (model,) = load_models([path])
    assert len(model.faces) == 4
    assert model.mends == ["left out: 1 GADGET"]


def test_lines_drawn_twice_and_hidden_layers_do_not_count(tmp_path):
    def draw(space):
        space.doc.layers.add("hidden").off()
        space.add_circle((20, 15), 5, dxfattribs={"layer": "hidden"})
        for start, end in [*zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True), (SQUARE[1], SQUARE[0])]:
            space.add_line(start, end)

    (model,) = load_models([dxf(tmp_path, draw)])
    assert len(model.faces) == 4
    assert model.mends == ["left out: 1 CIRCLE on a hidden layer", "1 line(s) drawn twice read once"]


# --- SVG ------------------------------------------------------------------------------------------

MM = 'width="200mm" height="100mm" viewBox="0 0 200 100"'


def svg(tmp_path, content, size=MM):
    path = tmp_path / "drawing.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{content}</svg>')
    return path


@pytest.mark.parametrize(
    ("size", "mm", "physical"),
    [
        (MM, 1.0, True),
        ('width="2in" height="1in" viewBox="0 0 200 100"', 0.254, True),
        ('width="20cm" height="10cm" viewBox="0 0 100 50"', 2.0, True),
        ('width="200" height="100"', 25.4 / 96, False),
        ('width="200px" height="100px" viewBox="0 0 100 50"', 2 * 25.4 / 96, False),
        ('viewBox="0 0 200 100"', 25.4 / 96, False),
        ('width="100%" height="100%" viewBox="0 0 200 100"', 25.4 / 96, False),
        ("", 25.4 / 96, False),
    ],
)
def test_svg_units_and_the_direction_of_y(tmp_path, size, mm, physical):
    (model,) = load_models([svg(tmp_path, '<polygon points="10,10 50,10 50,40"/>', size)])
    assert np.array(sorted(model.vertices.tolist())) == pytest.approx(
        mm * np.array([[10, -10], [50, -40], [50, -10]])
    )
    assert any("pixels" in mend for mend in model.mends) == (not physical)


def test_svg_shapes_transforms_and_uses(tmp_path):
    content = """
      <defs><rect id="tile" width="20" height="10"/></defs>
      <g transform="translate(100, 50) rotate(90)"><rect x="-10" y="-5" width="20" height="10"/></g>
      <use href="#tile" x="150" y="20"/>
      <circle cx="30" cy="30" r="20"/><ellipse cx="30" cy="30" rx="10" ry="5"/>
      <text x="1" y="1">part</text><rect width="5" height="5" display="none"/>"""
    disc, upright, tile = load_models([svg(tmp_path, content)])
    assert area(disc) == pytest.approx(math.pi * (400 - 50), rel=3e-3)
    assert extent(upright) == pytest.approx([95, -60, 105, -40])
    assert extent(tile) == pytest.approx([150, -30, 170, -20])
    assert disc.name == "drawing-1"
    assert disc.mends == ["left out: 1 rect with display: none", "left out: 1 text"]


def test_skewed_arcs_stay_on_their_ellipse(tmp_path):
    (model,) = load_models([svg(tmp_path, '<circle r="20" transform="translate(80,40) skewX(30)"/>')])
    x, y = (model.vertices - [80, -40]).T
    assert np.hypot(x + math.tan(math.radians(30)) * y, y) == pytest.approx(20.0)


def test_svg_paths_with_curves_and_holes(tmp_path):
    content = '<path d="M 20 20 h 60 v 40 q -30 20 -60 0 z m 10 10 v 10 h 10 z"/>'
    (model,) = load_models([svg(tmp_path, content)])
    assert area(model) == pytest.approx(60 * 40 + 2 / 3 * 60 * 10 - 50, rel=1e-3)
    assert 0.0 < model.position_slack <= 0.05


# --- what curves cost -----------------------------------------------------------------------------

lengths = st.floats(0.5, 200.0)
numbers = st.floats(-100.0, 100.0).map(lambda x: round(x, 3))
tolerances = st.builds(Tolerance, st.floats(0.01, 1.0), st.floats(0.05, 0.7))


def worst(piece, points, tangents):
    """Largest distance of curve points from the chords, and angle of their tangents to the nearest chord."""
    starts, chords = piece.points[:-1], np.diff(piece.points, axis=0)
    keep = np.hypot(*chords.T) > 0
    starts, chords = starts[keep], chords[keep]
    if not keep.any():
        return np.hypot(*(points - piece.points[0]).T).max(), 0.0
    away = points[:, None] - starts
    along = np.clip(np.sum(away * chords, axis=2) / np.sum(chords**2, axis=1), 0.0, 1.0)
    distances = np.linalg.norm(away - along[..., None] * chords, axis=2)
    nearest = np.argsort(distances, axis=1)[:, :2]
    cross = tangents[:, :1] * chords[nearest][..., 1] - tangents[:, 1:] * chords[nearest][..., 0]
    dot = np.sum(tangents[:, None] * chords[nearest], axis=2)
    # Near a corner of the chords either neighbour may be the nearest: the better of the two is meant.
    return distances.min(axis=1).max(), np.min(np.abs(np.arctan2(cross, dot)), axis=1).max()


@given(lengths, lengths, st.floats(-3, 3), st.floats(0.1, math.tau), st.booleans(), tolerances)
@settings(deadline=None, max_examples=60)
def test_arcs_stay_within_their_slack(a, b, start, sweep, clockwise, tolerance):
    frame = (np.array([3.0, 4.0]), np.array([a, 0.0]), np.array([0.3 * b, b]))
    sweep = -sweep if clockwise else sweep
    piece = elliptic_arc(frame, start, sweep, tolerance=tolerance)
    t = start + sweep * np.linspace(0, 1, 2001)
    points = frame[0] + np.outer(np.cos(t), frame[1]) + np.outer(np.sin(t), frame[2])
    tangents = np.sign(sweep) * (np.outer(np.cos(t), frame[2]) - np.outer(np.sin(t), frame[1]))
    distance, turn = worst(piece, points, tangents)
    assert distance <= piece.position_slack * (1 + 1e-6) + 1e-9 <= tolerance.distance * (1 + 2e-6) + 1e-9
    assert turn <= piece.normal_slack + 1e-6 <= tolerance.turn + 2e-6


@given(st.lists(st.tuples(numbers, numbers, st.floats(0.2, 5.0)), min_size=3, max_size=4), tolerances)
@settings(deadline=None, max_examples=60)
def test_bezier_curves_stay_within_their_slack(controls, tolerance):
    x, y, w = np.array(controls).T
    homogeneous = np.column_stack([w * x, w * y, w])
    piece = bezier(homogeneous, tolerance=tolerance)
    points, _ = sampled(homogeneous)
    distance, _ = worst(piece, points, np.ones_like(points))
    assert distance <= piece.position_slack + 1e-9 <= tolerance.distance + 2e-9
    assert piece.normal_slack <= tolerance.turn


def sampled(homogeneous):
    """Points and tangents of a rational Bézier curve."""
    t, n = np.linspace(0, 1, 4001), len(homogeneous) - 1
    basis = np.stack([math.comb(n, k) * t**k * (1 - t) ** (n - k) for k in range(n + 1)], axis=1)
    curve = basis @ homogeneous
    points = curve[:, :2] / curve[:, 2:]
    return points, np.gradient(points, axis=0)


def test_the_normals_of_bezier_curves_stay_within_their_slack():
    tolerance = Tolerance(0.1, 0.15)
    for controls in (
        [(0, 0, 1), (30, 60, 1), (60, -60, 2), (90, 0, 1)],
        [(0, 0, 1), (50, 50, 3), (80, -20, 1)],
    ):
        x, y, w = np.array(controls, dtype=float).T
        homogeneous = np.column_stack([w * x, w * y, w])
        piece = bezier(homogeneous, tolerance=tolerance)
        distance, turn = worst(piece, *sampled(homogeneous))
        assert 0.9 * distance <= piece.position_slack <= 1.3 * distance
        assert turn <= piece.normal_slack + 1e-3 <= 1.3 * turn + 1e-3


def test_a_spline_is_cut_into_its_bezier_pieces_exactly():
    interpolate = pytest.importorskip("scipy.interpolate")
    rng = np.random.default_rng(5)
    for degree in (2, 3, 4):
        for knots in (
            np.array([0.0] * (degree + 1) + [1, 2, 2, 3] + [4.0] * (degree + 1)),  # clamped, one knot double
            np.arange(degree + 9, dtype=float),  # not clamped
        ):
            controls = rng.uniform(-50, 50, (len(knots) - degree - 1, 2))
            pieces = spline(
                np.column_stack([controls, np.ones(len(controls))]), knots, tolerance=Tolerance(0.01, 0.1)
            )
            curve = interpolate.BSpline(knots, controls, degree)
            t = np.linspace(knots[degree], knots[-degree - 1], 50_001)
            dense = curve(t)
            for piece in pieces:
                for point in piece.points:
                    assert np.min(np.hypot(*(dense - point).T)) < 0.02
            assert pieces[0].points[0] == pytest.approx(curve(t[0]))
            assert pieces[-1].points[-1] == pytest.approx(curve(t[-1]))


# --- refusals -------------------------------------------------------------------------------------

HEAD = '"schema": "palpate-model", "version": 1, "name": "p", "unit": "mm"'
OUTER = '"outer": [[0, 0], [1, 0], [0, 1]]'
CORNERS = '"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]'

REFUSED = {
    "a.json": [
        ("{", r"a\.json, line 1: not JSON: .*; mend it"),
        ("[1]", r"a\.json: \[1\] is not an object; write"),
        ('{"schema": "other"}', r"a\.json: schema: 'other' is not 'palpate-model'; say"),
        ('{"schema": "palpate-model", "version": 2}', r"a\.json: version: 2 can't be read here; say \"version\": 1"),
        (f'{{{HEAD.replace("mm", "furlong")}, {OUTER}}}', r"a\.json: unit: unknown unit 'furlong'; give one of um, mm"),
        (f'{{{HEAD}, "hole": [], {OUTER}}}', r"a\.json: hole: unknown key; the keys here are"),
        (f'{{{HEAD.replace(chr(34) + "p" + chr(34), "7")}, {OUTER}}}', r"a\.json: name: 7 is not text; say"),
        (f"{{{HEAD}}}", r"a\.json: must have either outer or segments, or faces in space; give"),
        (f'{{{HEAD}, {OUTER}, "segments": []}}', r"a\.json: must have either outer or segments, or faces in space; give"),
        (f'{{{HEAD}, {OUTER}, "seams": [0]}}', r"a\.json: seams: does not go with outer; with it go holes"),
        (f'{{{HEAD}, "faces": [[[0, 1, 2]]]}}', r"a\.json: vertices: is missing; give the corners"),
        (f'{{{HEAD}, {CORNERS}, "faces": 5}}', r"a\.json: faces: 5 is not a list; write"),
        (f'{{{HEAD}, {CORNERS}, "faces": [5]}}', r"a\.json: faces\[0\]: 5 is not a list; write"),
        (f'{{{HEAD}, {CORNERS}, "faces": [[[0, 1, 3]]]}}', r"a\.json: faces\[0\]\[0\]: there is no vertex 3; number the 3 vertices from 0"),
        (f'{{{HEAD}, {CORNERS}, "faces": [[[0, 1, -1]]]}}', r"a\.json: faces\[0\]\[0\]\[2\]: -1 is not a vertex number; number the vertices"),
        (f'{{{HEAD}, {CORNERS}, "faces": [[[0, 1, 2]]], "holes": []}}', r"a\.json: holes: does not go with faces; with it go vertices, seams"),
        (f'{{{HEAD}, "vertices": [[0, 0]], "faces": [[[0]]]}}', r"a\.json: vertices\[0\]: \[0, 0\] is not a point; write \[x, y, z\]"),
        (f'{{{HEAD}, {CORNERS}, "faces": [[[0, 1, 1]]]}}', r"a\.json: loops\[0\]"),
        (f'{{{HEAD}, "outer": 5}}', r"a\.json: outer: 5 is not a list; write"),
        (f'{{{HEAD}, "outer": [[0, 0], [1]]}}', r"a\.json: outer\[1\]: \[1\] is not a point; write \[x, y\]"),
        (f'{{{HEAD}, "outer": [[0, "1"]]}}', r"a\.json: outer\[0\]: '1' is not a finite number; write a number"),
        (f'{{{HEAD}, "outer": [[0, NaN]]}}', r"a\.json: NaN is not a finite number; write finite numbers"),
        (f'{{{HEAD}, "outer": [[0, 1e999]]}}', r"a\.json: outer\[0\]: inf is not a finite number"),
        (f'{{{HEAD}, "segments": [[[0, 0]]]}}', r"a\.json: segments\[0\]: .* is not a pair of points; write"),
        (f'{{{HEAD}, {OUTER}, "untouchable": [-1]}}', r"a\.json: untouchable\[0\]: -1 is not a face number; number"),
        (f'{{{HEAD}, {OUTER}, "untouchable": [3]}}', r"a\.json: untouchable: there is no face .* \(got 3\); number"),
        (f'{{{HEAD}, {OUTER}, "normal_slack_deg": 90}}', r"a\.json: normal_slack: must be an angle .*; give 0"),
        (f'{{{HEAD}, "outer": [[0, 0], [2, 2], [2, 0], [0, 1]]}}', r"a\.json: vertices: crosses or touches itself: faces 0 and 2"),
    ],
    "a.dxf": [
        ("no drawing", r"a\.dxf: not a readable DXF file: .*; export it again"),
        ("", r"a\.dxf: not a readable DXF file: .*; export it again"),
    ],
    "a.svg": [
        ("<svg", r"a\.svg: not a readable SVG file: .*; export it again"),
        ("<html></html>", r"a\.svg: its root is <html>, not <svg>; export it again"),
        ('<svg xmlns="http://www.w3.org/2000/svg"/>', r"a\.svg: no outline in it .*; draw the part"),
    ],
    "a.iges": [("", r".*a\.iges: unknown suffix '\.iges'; give a \.json, \.dxf, \.svg.* file")],
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text", "message"), [(n, *case) for n, cases in REFUSED.items() for case in cases]
)
def test_bad_files_are_refused_with_the_reason(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(ValueError) as refusal:
        load_models([tmp_path / name])
    assert re.match(message, str(refusal.value)), str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_what_is_not_there_is_refused(tmp_path):
    with pytest.raises(
        ValueError, match=r"gone\.json: no such file or folder; give a model file or one of robot-hand"
    ):
        load_models([tmp_path / "gone.json"])
    with pytest.raises(
        ValueError, match=r"no model file in this folder; put \.json, \.dxf, \.svg.* files there"
    ):
        load_models([tmp_path])
    with pytest.raises(ValueError, match="paths: no model is named"):
        load_models([])
    with pytest.raises(ValueError, match=r"x\.json: its folder is not there; make the folder first"):
        save_model(load_models("boot")[0], tmp_path / "gone" / "x.json")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"unit": "furlong"}, "unit: unknown unit 'furlong'; give one of"),
        ({"flattening": 0.0}, "flattening: 0.0 is not a length above zero; give"),
        ({"flattening": math.nan}, "flattening: nan is not a length above zero; give"),
        ({"turn_deg": 60}, "turn_deg: 60 is not above 0 and at most 45; give"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        load_models(["boot"], **arguments)


def test_a_dxf_with_nothing_to_read_or_an_unknown_unit_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"part\.dxf: no outline in it \(left out: 1 TEXT\); draw"):
        load_models([dxf(tmp_path, lambda space: space.add_text("empty"))])
    with pytest.raises(ValueError, match=r"part\.dxf: its unit \(\$INSUNITS 18\) is not known; set"):
        load_models([dxf(tmp_path, lambda space: space.add_circle((0, 0), 1), units=18)])


def test_an_outline_that_crosses_itself_is_refused_with_the_file(tmp_path):
    bow = [(0, 0), (10, 10), (10, 0), (0, 10)]
    with pytest.raises(ValueError, match=r"part\.dxf: vertices: crosses or touches itself"):
        load_models([dxf(tmp_path, lambda space: space.add_lwpolyline(bow, close=True))])


def test_curves_that_take_too_many_chords_are_refused(tmp_path):
    path = dxf(tmp_path, lambda space: space.add_circle((0, 0), 1e6))
    with pytest.raises(
        ValueError, match=r"part\.dxf: a curve needs more than 20000 chords; raise flattening"
    ):
        load_models([path], flattening=1e-6)


def test_models_are_saved_as_json_only(tmp_path):
    with pytest.raises(
        ValueError, match=r"part\.dxf: models are written as JSON, not '\.dxf'; name the file \.json"
    ):
        save_model(MODELS[0], tmp_path / "part.dxf")
