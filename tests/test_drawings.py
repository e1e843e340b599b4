"""Drawings as people make them: whatever the lines, the faces follow them, or the drawing is refused."""

import math
import random
import re

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.curves import Piece, Tolerance
from palpate.models import load_models
from palpate.outlines import Drawing, OutlineError, shapes_of

SQUARE = [(0, 0), (40, 0), (40, 30), (0, 30)]
SLOT = [(10, 10), (20, 10), (20, 20), (10, 20)]


def dxf(tmp_path, draw, *, units=4):
    document = ezdxf.new("R2010")
    document.units = units
    draw(document.modelspace())
    path = tmp_path / "part.dxf"
    document.saveas(path)
    return path


def svg(tmp_path, content):
    path = tmp_path / "part.svg"
    size = 'width="100mm" height="100mm" viewBox="0 0 100 100"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{content}</svg>')
    return path


def lines(space, points, *, closed=True, layer="PART"):
    ends = [*points[1:], points[0]] if closed else points[1:]
    for start, end in zip(points, ends, strict=False):
        space.add_line(start, end, dxfattribs={"layer": layer})


# --- the check, with formulas of its own ------------------------------------------------


def samples(points, count=5):
    """Points on a polyline, and the directions there."""
    starts, along = points[:-1], np.diff(points, axis=0)
    keep = np.hypot(*along.T) > 0.0
    starts, along = starts[keep], along[keep]
    shares = (np.arange(count) + 0.5) / count
    places = starts[:, None] + shares[:, None] * along[:, None]
    directions = np.repeat(along / np.hypot(*along.T)[:, None], count, axis=0)
    return places.reshape(-1, 2), directions


def distances(points, faces):
    """Of each point to each face, shape `(points, faces)`."""
    start, along = faces[:, 0], faces[:, 1] - faces[:, 0]
    away = points[:, None] - start
    share = np.clip(np.sum(away * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
    return np.linalg.norm(away - share[..., None] * along, axis=2)


def check_follows(drawn, faces, position_slack, normal_slack):
    """Each drawn point has a face within both slacks."""
    places, directions = samples(drawn)
    along = (faces[:, 1] - faces[:, 0]) / np.hypot(*(faces[:, 1] - faces[:, 0]).T)[:, None]
    near = distances(places, faces) <= position_slack + 1e-9
    # A drawing has no sense of direction: its lines may run either way.
    sines = np.abs(directions[:, :1] * along[:, 1] - directions[:, 1:] * along[:, 0])
    turned = np.arcsin(np.clip(sines, 0.0, 1.0))
    assert np.all(np.any(near & (turned <= normal_slack + 1e-7), axis=1))


def closed_faces(loops):
    return np.concatenate([np.stack([loop[:-1], loop[1:]], axis=1) for loop in loops])


# --- fine drawings ----------------------------------------------------------------------------------


def rounded(corners, radius, chords):
    """A polygon whose corners are arcs, as points: `chords` of them to a corner."""
    corners = np.asarray(corners, dtype=float)
    points = []
    for k, corner in enumerate(corners):
        before, after = corners[k - 1], corners[(k + 1) % len(corners)]
        back, on = (before - corner) / math.dist(before, corner), (after - corner) / math.dist(after, corner)
        half = 0.5 * math.acos(np.clip(back @ on, -1.0, 1.0))
        middle = (back + on) / np.hypot(*(back + on))
        center = corner + middle * radius / math.sin(half)
        first = corner + back * radius / math.tan(half) - center
        turn = (math.pi - 2 * half) * np.sign(back[1] * on[0] - back[0] * on[1])
        for k in range(chords + 1):
            c, s = math.cos(turn * k / chords), math.sin(turn * k / chords)
            points.append(center + np.array([[c, -s], [s, c]]) @ first)
    return np.array(points)


def lobes(count, size=50.0):
    angle = 2 * np.pi * np.arange(count) / count
    radius = size * (1.0 + 0.1 * np.sin(7 * angle))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


FINE = {"fillets": rounded(SQUARE, 0.3, 10), **{f"{n} chords": lobes(n) for n in (1000, 5000, 12000)}}


@pytest.mark.parametrize("kind", ["polyline", "lines", "path"])
@pytest.mark.parametrize("points", FINE.values(), ids=FINE.keys())
def test_fine_chords_stay_one_closed_outline(tmp_path, points, kind):
    if kind == "path":
        d = "M" + " L".join(f"{x:.9f},{-y:.9f}" for x, y in points) + "Z"
        path = svg(tmp_path, f'<path d="{d}"/>')
    elif kind == "lines":
        path = dxf(tmp_path, lambda space: lines(space, points.tolist()))
    else:
        path = dxf(tmp_path, lambda space: space.add_lwpolyline(points.tolist(), close=True))
    (model,) = load_models(path)
    assert model.closed
    assert len(model.faces) <= 150
    assert model.position_slack <= 0.05 * (1 + 1e-9)
    assert model.normal_slack <= math.radians(7.5) * (1 + 1e-9)
    assert dropped_points(model.mends) == len(points) - len(model.faces)
    drawn = np.vstack([points, points[:1]])[:: max(1, len(points) // 600)]
    check_follows_points(np.vstack([points, points[:1]]), drawn, model)


def dropped_points(mends):
    """How many points the mends say were dropped."""
    return sum(int(mend.split()[0]) for mend in mends if "point(s)" in mend and "dropped" in mend)


def check_follows_points(outline, some, model):
    faces = np.array(model.faces)
    assert np.max(np.min(distances(some, faces), axis=1)) <= model.position_slack + 1e-7
    pieces = np.stack([outline[:-1], outline[1:]], axis=1)
    corners = model.vertices
    assert np.max([np.min(distances(corner[None], pieces)) for corner in corners]) <= 1e-7


def test_polygons_of_long_sides_are_left_as_drawn(tmp_path):
    angle = 2 * np.pi * np.arange(64) / 64
    points = np.stack([20 * np.cos(angle), 20 * np.sin(angle)], axis=1).tolist()
    (model,) = load_models(dxf(tmp_path, lambda space: space.add_lwpolyline(points, close=True)))
    assert (len(model.faces), len(model.symmetries)) == (64, 64)
    assert (model.position_slack, model.normal_slack, model.mends) == (0.0, 0.0, [])


def test_short_faces_that_turn_stay(tmp_path):
    chamfered = [(0, 0), (40, 0), (40, 30), (0.02, 30), (0, 29.98)]
    (model,) = load_models(dxf(tmp_path, lambda space: lines(space, chamfered)))
    assert len(model.faces) == 5
    assert (model.position_slack, model.mends) == (0.0, [])


# --- random drawings --------------------------------------------------------------------------------


def drawing_of(seed):
    """The lines of a drawing of one outline, lines that touch it, and whether gaps are wider than chords."""
    rng = random.Random(seed)
    count = rng.randrange(3, 9)
    angles = [2 * math.pi * (k + 0.6 * rng.random()) / count for k in range(count)]
    corners = [(r * math.cos(a), r * math.sin(a)) for a in angles for r in [rng.uniform(20, 60)]]
    points = rounded(corners, rng.choice([0.01, 0.1, 0.3, 2.0]), rng.choice([1, 3, 10, 40])).tolist()
    points = [point for point in points for _ in range(1 + (rng.random() < 0.1))]  # doubled
    gap = rng.choice([0.0, 1e-9, 1e-6, 0.003])
    segments = []
    for start, end in zip(points, [*points[1:], points[0]], strict=True):
        length = math.dist(start, end)
        ends = np.array([start, end])
        if length > 20.0 * gap:
            angle = rng.uniform(0, 2 * math.pi)
            ends[1] += gap * np.array([math.cos(angle), math.sin(angle)])
        segments.append(ends if rng.random() < 0.5 else ends[::-1])
    rng.shuffle(segments)
    dangling = []
    for corner in rng.sample(points, rng.randrange(0, 3)):
        away = np.array(corner) / np.hypot(*corner)
        dangling.append(np.array([corner, np.array(corner) + away * rng.uniform(1.0, 30.0)]))
    shortest = min(length for segment in segments if (length := math.dist(*segment)) > 0.0)
    return segments, dangling, gap > 0.25 * shortest


@given(st.integers(0, 10**9))
@settings(deadline=None, max_examples=150)
def test_random_outlines_are_closed_and_followed(seed):
    segments, dangling, is_unclear = drawing_of(seed)
    pieces = [Piece(segment) for segment in segments]
    pieces += [Piece(line, layer="DIM") for line in dangling]
    random.Random(seed).shuffle(pieces)
    try:
        (shape,) = shapes_of(Drawing(pieces), tolerance=Tolerance(0.05, math.radians(7.5)))
    except OutlineError as error:
        # An end may miss its own chord and meet another: the place is named.
        assert is_unclear and re.search(r"(meet at|its ends) \(", str(error))
        return
    assert shape.closed
    (loop,) = shape.loops
    assert np.all(loop[0] == loop[-1])
    assert shape.position_slack <= 0.1
    assert shape.normal_slack <= math.radians(15.0)
    if dangling:
        assert any(f"{len(dangling)} open line(s) left out" in note for note in shape.notes)
    faces = closed_faces(shape.loops)
    for segment in segments:
        check_follows(segment, faces, shape.position_slack, shape.normal_slack)
    places, _ = samples(loop)
    drawn = np.array([segment for segment in segments if math.dist(*segment) > 0.0])
    assert np.max(np.min(distances(places, drawn), axis=1)) <= shape.position_slack + 1e-9


@given(st.integers(0, 10**9))
@settings(deadline=None, max_examples=25)
def test_random_files_with_arcs_and_holes_are_followed(tmp_path_factory, seed):
    """Arcs as entities and as bulges, an island in a hole, all of it shuffled; through a file."""
    rng = random.Random(seed)
    radius, chords = rng.choice([0.02, 0.4, 3.0]), 400
    outer = [
        (-rng.uniform(30, 90), -rng.uniform(30, 90)),
        (rng.uniform(30, 90), -40),
        (50, rng.uniform(30, 90)),
        (-40, 45),
    ]
    loops = [outer, [(-5, -5), (8, -6), (rng.uniform(4, 9), 9), (-6, 7)]]

    def draw(space):
        todo = []
        for corners in loops:
            points = rounded(corners, radius, 1).reshape(-1, 2, 2)
            bulge = [math.tan(0.25 * _turn(points, k)) for k in range(len(points))]
            if rng.random() < 0.5:
                vertices = [(*p, b) for (first, last), b in zip(points, bulge, strict=True)
                            for p, b in ((first, b), (last, 0.0))]  # fmt: skip
                todo.append(lambda v=vertices: space.add_lwpolyline(v, format="xyb", close=True))
                continue
            for k, (first, last) in enumerate(points):
                ends = [last, points[(k + 1) % len(points)][0]]
                ends = ends if rng.random() < 0.5 else ends[::-1]
                todo.append(lambda e=ends: space.add_line(*e))
                todo.append(
                    lambda a=first, b=last, c=bulge[k]: space.add_lwpolyline(
                        [(*a, c), (*b, 0.0)], format="xyb"
                    )
                )
        rng.shuffle(todo)
        for add in todo:
            add()

    (model,) = load_models(dxf(tmp_path_factory.mktemp("files"), draw))
    assert model.closed
    faces = np.array(model.faces)
    for corners in loops:
        fine = rounded(corners, radius, chords)
        # Arcs are sampled by chords of their own: their normals are off by half of one's turn.
        check_follows(
            np.vstack([fine, fine[:1]]), faces, model.position_slack + 1e-6, model.normal_slack + 0.01
        )


def _turn(points, k):
    """By how much the outline turns from before the `k`-th arc to after it."""
    before = points[k][0] - points[k - 1][1]
    after = points[(k + 1) % len(points)][0] - points[k][1]
    return math.atan2(before[0] * after[1] - before[1] * after[0], before @ after)


# --- lines that are no outline ----------------------------------------------------------------------


def test_lines_that_touch_the_outline_are_left_out_and_said(tmp_path):
    def draw(space):
        lines(space, SQUARE)
        lines(space, SLOT)
        for start, end in [((0, 0), (0, -15)), ((40, 0), (40, -15)), ((40, 30), (55, 30)), ((0, 0), (-9, 0))]:
            space.add_line(start, end, dxfattribs={"layer": "DIM"})
        space.add_line((40, 30), (20, 20), dxfattribs={"layer": "LEADER"})  # from outline to slot

    (model,) = load_models(dxf(tmp_path, draw))
    assert sorted(map(tuple, model.vertices.tolist())) == sorted([*SQUARE, *SLOT])
    assert model.mends == [
        "5 open line(s) left out, since there are closed ones: 4 on layer DIM, 1 on layer LEADER"
    ]


def test_a_line_that_could_be_outline_is_refused_unless_its_layer_is(tmp_path):
    def draw(space):
        lines(space, SQUARE)
        space.add_line((0, 0), (40, 30), dxfattribs={"layer": "BEND"})

    path = dxf(tmp_path, draw)
    with pytest.raises(
        ValueError,
        match=r"part\.dxf: 3 lines \(layers BEND, PART\) meet at \(0, 0\), .*; name the layers .* layers=",
    ):
        load_models(path)
    (model,) = load_models(path, layers=["part"])
    assert len(model.faces) == 4
    assert model.mends == ["left out: 1 LINE on a layer that is not named"]
    with pytest.raises(ValueError, match=r"part\.dxf: there is no layer 'bent'; give some of 0, .*BEND"):
        load_models(path, layers=["BENT"])
    with pytest.raises(ValueError, match="layers: 'PART' is not a list of names"):
        load_models(path, layers="PART")


def test_an_outline_with_a_gap_is_not_given_up_for_its_holes(tmp_path):
    def draw(space, gap):
        lines(space, [(0, 0), (40, 0), (40, 30), (0, 30), (0, gap)], closed=False)
        lines(space, SLOT)

    with pytest.raises(ValueError, match=r"its ends \(0, 0\) and \(0, 0\.2\) are 0\.2 apart; close it"):
        load_models(dxf(tmp_path, lambda space: draw(space, 0.2)))
    (model,) = load_models(dxf(tmp_path, lambda space: draw(space, 0.04)))
    assert len(model.faces) == 8
    assert model.position_slack == pytest.approx(0.04)


def test_an_outline_with_two_gaps_is_not_given_up_for_its_holes(tmp_path):
    def draw(space):
        lines(space, [(0, 0), (40, 0), (40, 30)], closed=False)
        lines(space, [(39.8, 30), (0, 30), (0, 0.3)], closed=False)
        lines(space, SLOT)

    with pytest.raises(ValueError, match=r"an outline is open: its ends \(40, 30\) and \(39\.8, 30\)"):
        load_models(dxf(tmp_path, draw))


def test_a_gap_beside_fine_chords_turns_none_of_them(tmp_path):
    points = rounded(SQUARE, 0.3, 10).tolist()
    points[4] = [points[4][0] + 0.02, points[4][1] + 0.02]

    def draw(space):
        lines(space, [*rounded(SQUARE, 0.3, 10).tolist()[:4], points[4]], closed=False)
        lines(space, [*rounded(SQUARE, 0.3, 10).tolist()[4:], points[0]], closed=False)

    (model,) = load_models(dxf(tmp_path, draw))
    assert model.closed
    assert model.normal_slack <= math.radians(15.0)
    assert any("gaps of up to 0.028" in mend for mend in model.mends)


def test_outlines_that_cross_are_refused(tmp_path):
    def draw(space):
        space.add_lwpolyline(SQUARE, close=True)
        space.add_lwpolyline([(-5, 10), (60, 10), (60, 20), (-5, 20)], close=True)

    with pytest.raises(ValueError, match=r"part\.dxf: two outlines cross near \(.*\); name the layers"):
        load_models(dxf(tmp_path, draw))


def test_an_outline_drawn_twice_in_different_ways_is_read_once(tmp_path):
    def draw(space):
        space.add_lwpolyline(SQUARE, close=True)
        lines(space, [SQUARE[k] for k in (2, 1, 0, 3)], layer="0")

    (model,) = load_models(dxf(tmp_path, draw))
    assert len(model.faces) == 4
    assert model.mends == ["1 outline(s) drawn twice read once"]


def test_a_frame_is_named(tmp_path):
    frame = [(-50, -50), (90, -50), (90, 80), (-50, 80)]

    def draw(space):
        lines(space, frame, layer="FRAME")
        lines(space, [(0, 0), (40, 0), (40, 30), (0, 20)])

    path = dxf(tmp_path, draw)
    (sheet,) = load_models(path)
    assert sheet.mends == [
        "the rectangle from (-50, -50) to (90, 80) is read as a part, what is in it as holes; "
        "if it is the frame of the sheet, name the layers of the part with layers=, or delete it"
    ]
    (model,) = load_models(path, layers=["PART"])
    assert len(model.faces) == 4
    # A plate with small holes on its own layer is none.
    (plate,) = load_models(dxf(tmp_path, lambda space: (lines(space, SQUARE), lines(space, SLOT))))
    assert plate.mends == []


def test_parts_on_several_layers_are_said(tmp_path):
    def draw(space):
        lines(space, SQUARE)
        space.add_lwpolyline([(50, 0), (53, 1), (53, -1)], close=True, dxfattribs={"layer": "DIM"})
        space.add_solid([(60, 0), (63, 1), (63, -1)], dxfattribs={"layer": "DIM"})

    models = load_models(dxf(tmp_path, draw))
    assert len(models) == 2
    assert models[0].mends == [
        "left out: 1 SOLID",
        "outlines are on several layers (DIM 1, PART 1); layers= chooses among them",
    ]


# --- height, visibility -----------------------------------------------------------------------------


def test_what_is_not_flat_is_refused(tmp_path):
    tilted = [(0, 0, 0), (50, 0, 9), (50, 30, 9), (0, 30, 0)]
    with pytest.raises(
        ValueError, match=r"LINE at \(0, 0\) is not parallel to the plane.* z goes from 0 to 9; draw"
    ):
        load_models(dxf(tmp_path, lambda space: space.add_polyline3d(tilted, close=True)))
    with pytest.raises(ValueError, match=r"CIRCLE at \(1, .*\) is not parallel to the plane"):
        tilt = {"extrusion": (0, 1, 1)}
        load_models(dxf(tmp_path, lambda space: space.add_circle((-1, 2), 5, dxfattribs=tilt)))


def test_a_flat_part_at_any_height_is_read_and_different_heights_are_said(tmp_path):
    def draw(space, heights):
        for points, z in zip((SQUARE, SLOT), heights, strict=True):
            space.add_lwpolyline(points, close=True, dxfattribs={"elevation": z})

    (model,) = load_models(dxf(tmp_path, lambda space: draw(space, (5, 5))))
    assert model.mends == []
    (model,) = load_models(dxf(tmp_path, lambda space: draw(space, (0, 5))))
    assert model.mends == ["lines at different heights, z from 0 to 5, read as one plane"]


def test_invisible_entities_and_layers_in_blocks_are_left_out(tmp_path):
    def draw(space):
        lines(space, SQUARE)
        space.add_circle((25, 15), 5, dxfattribs={"invisible": 1})
        space.doc.layers.add("H").off()
        block = space.doc.blocks.new("B")
        block.add_circle((30, 20), 2, dxfattribs={"layer": "H"})
        block.add_lwpolyline(SLOT, close=True)
        space.add_blockref("B", (0, 0), dxfattribs={"layer": "PART"})

    (model,) = load_models(dxf(tmp_path, draw), layers=["PART", "0"])
    assert len(model.faces) == 8
    assert model.mends == ["left out: 1 CIRCLE on a hidden layer", "left out: 1 CIRCLE that is invisible"]


RECT = '<rect x="5" y="5" width="80" height="40"/>'


@pytest.mark.parametrize(
    ("content", "faces", "mends"),
    [
        ('<circle r="5" cx="20" cy="20" visibility="hidden"/>', 4, ["left out: 1 circle that is hidden"]),
        (
            '<g style="visibility: hidden"><circle r="5" cx="20" cy="20"/></g>',
            4,
            ["left out: 1 circle that is hidden"],
        ),
        (
            '<circle r="5" cx="20" cy="20" style="display:none"/>',
            4,
            ["left out: 1 circle with display: none"],
        ),
        ('<g display="none"><circle r="5" cx="20" cy="20"/></g>', 4, ["left out: 1 g with display: none"]),
        ('<marker id="m"><path d="M 10 10 h 5 v 5 z"/></marker>', 4, ["left out: 1 marker"]),
        (
            '<symbol id="s"><path d="M 10 10 h 5 v 5 z"/></symbol><use href="#s"/><use href="#s" x="30"/>',
            10,
            [],
        ),
        ('<symbol id="s"><path d="M 10 10 h 5 v 5 z"/></symbol>', 4, []),
        ('<metadata><title/></metadata><path id="empty"/><path d="M 10 10 h 5 v 5 z"/>', 7, []),
    ],
)
def test_what_an_svg_does_not_show_is_not_read(tmp_path, content, faces, mends):
    (model,) = load_models(svg(tmp_path, RECT + content))
    assert len(model.faces) == faces
    assert model.mends == mends


def test_the_frame_of_an_svg_is_its_upper_left_corner_with_y_up(tmp_path):
    path = tmp_path / "part.svg"
    view = 'width="100mm" height="50mm" viewBox="-60 -20 200 100"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {view}><rect width="20" height="40"/></svg>')
    (model,) = load_models(path)
    assert np.min(model.vertices, axis=0) == pytest.approx([30, -30])
    assert np.max(model.vertices, axis=0) == pytest.approx([40, -10])


# --- refusals ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('<g transform="rotate(">' + RECT + "</g>", r"transform of <g> can't be read from 'rotate\(' on"),
        ('<path d="M 0 0 L 10 x 5 Z"/>', r"d of <path> can't be read from 'x 5 Z' on"),
        ('<path d="M 0 0 L 1e400 5 L 5 5 Z"/>', "a coordinate is not finite"),
        ('<symbol id="s" viewBox="0 0 9 9"/>', "symbol 's' has a viewBox of its own"),
    ],
)
def test_bad_svg_is_refused_with_the_place(tmp_path, content, message, recwarn):
    with pytest.raises(ValueError, match=rf"part\.svg: .*{message}"):
        load_models(svg(tmp_path, content))
    assert not recwarn.list


def test_a_flattening_that_is_not_small_is_refused(tmp_path):
    path = dxf(tmp_path, lambda space: lines(space, SQUARE))
    with pytest.raises(
        ValueError,
        match=r"part\.dxf: flattening: 0\.05 m is not small .* 0\.04 m across; give, for example, 4e-05",
    ):
        load_models(path, unit="m", flattening=0.05)
    small = [(1e-3 * x, 1e-3 * y) for x, y in SQUARE]
    with pytest.raises(ValueError, match=r"flattening: 0\.05 mm is not small"):
        load_models(dxf(tmp_path, lambda space: lines(space, small)))
    (model,) = load_models(dxf(tmp_path, lambda space: lines(space, small)), flattening=4e-5)
    assert len(model.faces) == 4


def test_a_file_that_is_cut_off_is_refused(tmp_path):
    path = dxf(tmp_path, lambda space: (lines(space, SQUARE), lines(space, SLOT)))
    text = path.read_text()
    path.write_text(text[: text.rindex("LINE")])
    with pytest.raises(ValueError, match=r"part\.dxf: it is cut off: the last line is not EOF; export"):
        load_models(path)


def test_damage_is_said_and_damaged_numbers_are_refused(tmp_path, capfd):
    path = dxf(tmp_path, lambda space: lines(space, SQUARE))
    text = path.read_text()
    path.write_text(text.replace("ENDSEC\n  0\nSECTION\n  2\nOBJECTS", "SECTION\n  2\nOBJECTS"))
    (model,) = load_models(path)
    assert model.mends == ["the file was damaged, 1 place(s) mended: compare the picture with the drawing"]
    path.write_text(text.replace("AcDbLine\n 10\n0.0", "AcDbLine\n 10\n4o.0"))
    with pytest.raises(ValueError, match=r"part\.dxf: a number in it is damaged; export or copy it again"):
        load_models(path)
    path.write_text(text.replace("AcDbLine\n 10\n", "AcDbLine\nten\n", 1))
    with pytest.raises(ValueError, match=r"part\.dxf: not a readable DXF file: it is damaged"):
        load_models(path)
    assert capfd.readouterr() == ("", "")


def test_paper_space_is_named(tmp_path):
    def draw(space):
        space.doc.layout("Layout1").add_lwpolyline(SQUARE, close=True)

    with pytest.raises(ValueError, match=r"no outline in it .*paper space is not read"):
        load_models(dxf(tmp_path, draw))


@pytest.mark.parametrize("paths", [3, None, [3], [["boot"]]])
def test_paths_that_are_none_are_refused(paths):
    with pytest.raises(ValueError, match=r"paths: .* is not the name of a file"):
        load_models(paths)


def test_svg_has_no_layers(tmp_path):
    with pytest.raises(ValueError, match=r"layers: part\.svg is an SVG, which has none"):
        load_models(svg(tmp_path, RECT), layers=["PART"])


def test_ambiguous_lines_without_layers_are_refused_in_plain_words():
    ends = [[(0, 0), (9, 0)], [(9, 0), (9, 9)], [(9, 9), (0, 0)], [(9, 0), (20, 20)], [(20, 20), (9, 9)]]
    pieces = [Piece(np.array(pair, dtype=float)) for pair in ends]
    with pytest.raises(
        OutlineError, match=r"3 lines meet at \(9, 0\), and each .*; delete the lines that are not"
    ):
        shapes_of(Drawing(pieces), tolerance=Tolerance(0.05, 0.1))


def test_many_holes_take_no_time(tmp_path):
    def draw(space):
        lines(space, [(-10, -10), (310, -10), (310, 310), (-10, 310)])
        for k in range(900):
            space.add_circle((k // 30 * 10, k % 30 * 10), 3, dxfattribs={"layer": "PART"})

    (model,) = load_models(dxf(tmp_path, draw))
    assert len(model.faces) == 4 + 900 * 25
