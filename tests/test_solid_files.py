"""Solid model files: what STL, OBJ, PLY, OFF, 3MF and STEP become, how bodies make parts, what is refused."""

# ruff: noqa: E501 (tables are easier to read with a case to a line)

import math
import re
import struct
import subprocess
import sys
import time
import zipfile

import brackets
import numpy as np
import pytest
import step_files

import palpate.models
from palpate.experiments import solid_shapes
from palpate.models import load_models
from palpate.solids import read_solid
from palpate.solids.mesh import Body, cleaned, is_consistent, shells_of, volume
from palpate.solids.polygons import triangulated, with_holes
from palpate.solids.surfaces import bounds

trimesh = pytest.importorskip("trimesh", reason="trimesh is in the extra palpate[test]")

NO_UNIT = "the file names no unit: taken as mm"


def mesh_of(part):
    return trimesh.Trimesh(part.vertices, part.triangles, process=False)


def shape(name):
    solid = solid_shapes.DRAWN[name]()
    return trimesh.Trimesh(solid.vertices, solid.triangles, process=False)


def box(size, at=(0.0, 0.0, 0.0)):
    """From `at`, its lower corner."""
    made = trimesh.creation.box(size)
    made.apply_translation(np.array(at) + 0.5 * np.array(size))
    return made


def inverted(mesh):
    mesh = mesh.copy()
    mesh.invert()
    return mesh


# --- what trimesh writes --------------------------------------------------------------------------

SHAPES = {
    "box": lambda: box((10, 20, 30)),
    "cylinder": lambda: trimesh.creation.cylinder(10, 40, sections=24),
    **{name: (lambda name=name: shape(name)) for name in solid_shapes.DRAWN},
}

# How a file is written, and how many digits it keeps.
WRITTEN = {
    "stl": ({}, 1e-6),
    "ascii.stl": ({"file_type": "stl_ascii"}, 1e-12),
    "obj": ({}, 1e-8),
    "ply": ({}, 1e-6),
    "ascii.ply": ({"encoding": "ascii"}, 1e-6),
    "off": ({}, 1e-9),
    "3mf": ({}, 1e-12),
}


def write(mesh, path, **options):
    if path.suffix == ".3mf":
        pytest.importorskip("lxml", reason="trimesh writes 3MF with lxml")
        pytest.importorskip("networkx", reason="trimesh writes 3MF with networkx")
    path.write_bytes(as_bytes(mesh.export(file_type=options.pop("file_type", path.suffix[1:]), **options)))
    return path


def as_bytes(written):
    return written.encode() if isinstance(written, str) else written


@pytest.mark.parametrize("form", WRITTEN)
@pytest.mark.parametrize("name", SHAPES)
def test_what_another_program_writes_comes_back(tmp_path, name, form):
    options, off = WRITTEN[form]
    mesh = SHAPES[name]()
    (part,) = read_solid(write(mesh, tmp_path / f"{name}.{form}", **options))
    back = mesh_of(part)
    assert part.name == f"{name}.{form}".rpartition(".")[0]
    assert back.is_watertight and back.is_winding_consistent
    assert back.volume == pytest.approx(mesh.volume, rel=10 * off)
    assert back.bounds == pytest.approx(mesh.bounds, rel=off, abs=100 * off)
    assert len(part.triangles) == len(mesh.faces)
    assert len(part.vertices) == len(mesh.vertices)
    assert (part.position_slack, part.normal_slack) == (0.0, 0.0)
    if form != "3mf":
        assert part.mends == (NO_UNIT,)


@pytest.mark.parametrize(
    ("unit", "mm"),
    [
        ("micron", 1e-3),
        ("millimeter", 1),
        ("centimeter", 10),
        ("inch", 25.4),
        ("foot", 304.8),
        ("meter", 1000),
    ],
)
def test_the_unit_of_a_3mf_is_converted(tmp_path, unit, mm):
    path = three_mf(tmp_path, [("1", box((1, 2, 3)))], unit=unit)
    (part,) = read_solid(path)
    assert np.ptp(part.vertices, axis=0) == pytest.approx(mm * np.array([1, 2, 3]))
    (in_inches,) = read_solid(path, unit="in")
    assert in_inches.vertices * 25.4 == pytest.approx(part.vertices)


def test_formats_without_a_unit_are_in_the_models(tmp_path):
    path = write(box((1, 2, 3)), tmp_path / "box.stl")
    (part,) = read_solid(path, unit="in")
    assert np.ptp(part.vertices, axis=0).tolist() == [1, 2, 3]
    assert part.mends == ("the file names no unit: taken as in",)


def test_names_need_not_be_ascii_and_links_are_followed(tmp_path):
    (tmp_path / "größe").mkdir()
    path = write(box((1, 2, 3)), tmp_path / "größe" / "Träger ß №1.STL".replace(".STL", ".stl"))
    upper = path.rename(path.with_suffix(".STL"))
    (part,) = read_solid(upper)
    assert part.name == "Träger ß №1"
    link = tmp_path / "link.stl"
    link.symlink_to(upper)
    assert np.array_equal(read_solid(link)[0].vertices, part.vertices)


# --- 3MF ------------------------------------------------------------------------------------------

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/model.model" '
    'Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def mesh_xml(mesh):
    vertices = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*v) for v in mesh.vertices)
    triangles = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*t) for t in mesh.faces)
    return f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"


def model_xml(objects, build, unit="millimeter"):
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><model unit="{unit}" xmlns="{CORE}" xmlns:p="{PRODUCTION}">'
        f"<resources>{objects}</resources><build>{build}</build></model>"
    )


def packed(path, files):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return path


def three_mf(tmp_path, objects, *, unit="millimeter", build=None):
    written = "".join(f'<object id="{key}">{mesh_xml(mesh)}</object>' for key, mesh in objects)
    items = build or "".join(f'<item objectid="{key}"/>' for key, _ in objects)
    return packed(
        tmp_path / "part.3mf", {"_rels/.rels": RELATIONS, "3D/model.model": model_xml(written, items, unit)}
    )


def test_components_are_put_where_they_belong(tmp_path):
    bar = f'<object id="1" name="bar">{mesh_xml(box((10, 2, 2)))}</object>'
    # The second is turned by 90° about z, the third is mirrored in x.
    pair = (
        '<object id="2"><components><component objectid="1"/>'
        '<component objectid="1" transform="0 1 0 -1 0 0 0 0 1 100 0 0"/>'
        '<component objectid="1" transform="-1 0 0 0 1 0 0 0 1 -50 0 0"/></components></object>'
    )
    build = '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 0 5"/>'
    path = packed(tmp_path / "bars.3mf", {"3D/model.model": model_xml(bar + pair, build)})
    mirrored, plain, turned = read_solid(path)
    assert [part.name for part in (mirrored, plain, turned)] == ["bars-1", "bars-2", "bars-3"]
    assert mesh_of(mirrored).bounds.tolist() == [[-60, 0, 5], [-50, 2, 7]]
    assert mesh_of(plain).bounds.tolist() == [[0, 0, 5], [10, 2, 7]]
    assert mesh_of(turned).bounds.tolist() == [[98, 0, 5], [100, 10, 7]]
    assert all(mesh_of(part).volume == pytest.approx(40) for part in (mirrored, plain, turned))
    assert plain.mends == ("the file calls it bar",)


def test_objects_may_be_in_other_files_of_the_archive_and_supports_are_left_out(tmp_path):
    other = model_xml(f'<object id="7">{mesh_xml(box((1, 1, 1)))}</object>', "", unit="centimeter")
    here = (
        '<object id="1"><components><component objectid="7" p:path="/3D/Objects/other.model"/></components></object>'
        f'<object id="2" type="support">{mesh_xml(box((9, 9, 9)))}</object>'
    )
    files = {
        "_rels/.rels": RELATIONS,
        "3D/Objects/other.model": other,
        "3D/model.model": model_xml(here, '<item objectid="1"/><item objectid="2"/>'),
    }
    (part,) = read_solid(packed(tmp_path / "part.3mf", files))
    assert mesh_of(part).volume == pytest.approx(1000)
    assert part.mends == ("left out: 1 object of type support",)


# --- faces with many corners ----------------------------------------------------------------------

ELL = [(0, 0), (40, 0), (40, 10), (10, 10), (10, 40), (0, 40)]


def ell_prism(shift):
    """An L as six-sided faces and quads; the first corner of each is turned on by `shift`."""
    points = [(x, y, z) for z in (0, 10) for x, y in ELL]
    faces = [
        [5, 4, 3, 2, 1, 0],
        [6, 7, 8, 9, 10, 11],
        *([k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k] for k in range(6)),
    ]
    return points, [face[shift % len(face) :] + face[: shift % len(face)] for face in faces]


def written_faces(form, points, faces):
    rows = "".join("{} {} {}\n".format(*point) for point in points)
    if form == "off":
        lines = "".join(f"{len(face)} {' '.join(map(str, face))} 255 0 0\n" for face in faces)
        return f"OFF # a comment\n{len(points)} {len(faces)} 0\n\n{rows}{lines}"
    if form == "obj":
        lines = "".join(
            "f " + " ".join(f"{k + 1}/1/1" if k % 2 else f"{k - len(points)}" for k in face) + "\n"
            for face in faces
        )
        return "".join(f"v {row}\n" for row in rows.splitlines()) + "vt 0 0\nvn 0 0 1\n" + lines
    lines = "".join(f"{len(face)} {' '.join(map(str, face))}\n" for face in faces)
    head = "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n"
    return head.format(len(points), len(faces)) + rows + lines


@pytest.mark.parametrize("form", ["off", "obj", "ply"])
@pytest.mark.parametrize("shift", range(6))
def test_faces_that_are_not_convex_stay_within_themselves(tmp_path, form, shift):
    path = tmp_path / f"ell.{form}"
    path.write_text(written_faces(form, *ell_prism(shift)))
    (part,) = read_solid(path)
    mesh = mesh_of(part)
    assert mesh.is_watertight and mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(7000)
    # A fan that leaves its face has more area than the face.
    assert mesh.area == pytest.approx(2 * 700 + 160 * 10)


@pytest.mark.parametrize("order", ["little", "big"])
def test_binary_ply_with_faces_of_several_sizes_and_other_properties(tmp_path, order):
    mark = {"little": "<", "big": ">"}[order]
    points, faces = ell_prism(2)
    head = (
        f"ply\nformat binary_{order}_endian 1.0\ncomment by hand\nelement vertex 12\nproperty uchar red\nproperty double x\n"
        "property double y\nproperty double z\nelement edge 1\nproperty int a\nelement face 8\nproperty float quality\n"
        "property list uchar ushort vertex_index\nproperty list int float other\nend_header\n"
    )
    body = b"".join(struct.pack(f"{mark}B3d", 7, *point) for point in points) + struct.pack(f"{mark}i", 1)
    for face in faces:
        body += struct.pack(f"{mark}fB{len(face)}Hi2f", 0.5, len(face), *face, 2, 1.0, 2.0)
    (tmp_path / "ell.ply").write_bytes(head.encode() + body)
    (part,) = read_solid(tmp_path / "ell.ply")
    assert mesh_of(part).volume == pytest.approx(7000)


@pytest.mark.parametrize("seed", range(200))
def test_any_simple_polygon_is_made_of_its_triangles(seed):
    random = np.random.default_rng(seed)
    count = int(random.integers(4, 40))
    angles = np.sort(random.uniform(0, math.tau, count))
    flat = (random.uniform(0.2, 1.0, count) * np.array([np.cos(angles), np.sin(angles)])).T
    if np.max(np.diff(angles, append=angles[0] + math.tau)) > 3.0:
        return  # it need not go round the origin
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    points = np.column_stack([flat, np.zeros(count)]) @ turn.T + random.normal(size=3)
    triangles = triangulated("file", points, [list(range(count))])
    assert len(triangles) == count - 2
    areas = np.cross(
        points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]]
    )
    x, y = flat.T
    true = np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    # All on one side, and their areas add up: nothing is left out, nothing twice.
    assert np.sum(np.linalg.norm(areas, axis=1)) == pytest.approx(abs(true), rel=1e-9)
    assert np.all(areas @ np.sum(areas, axis=0) > 0.0)


def test_loops_that_cross_are_refused():
    square = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)
    with pytest.raises(ValueError, match="loops: "):
        with_holes([np.array([[0, 0], [10, 10], [10, 0], [0, 10]], dtype=float)])
    with pytest.raises(ValueError, match="loops: "):
        with_holes([square, square[::-1] + 50.0])


# --- bodies and parts -----------------------------------------------------------------------------


def written(tmp_path, *meshes, name="bodies.stl"):
    return write(trimesh.util.concatenate(list(meshes)), tmp_path / name)


def test_bodies_apart_are_parts_from_left_to_right(tmp_path):
    path = written(tmp_path, box((10, 10, 10), (50, 0, 0)), box((5, 5, 5)), box((1, 1, 1), (20, 0, 0)))
    parts = read_solid(path)
    assert [part.name for part in parts] == ["bodies-1", "bodies-2", "bodies-3"]
    assert [round(mesh_of(part).volume) for part in parts] == [125, 1, 1000]


@pytest.mark.parametrize(
    ("shift", "volume"), [((5, 2, 1), 2000 - 5 * 8 * 9), ((10, 0, 0), 2000), ((10, 3, 4), 2000)]
)
def test_bodies_that_overlap_or_touch_are_joined(tmp_path, shift, volume):
    pytest.importorskip("manifold3d", reason="joining takes the extra palpate[union]")
    path = written(tmp_path, box((10, 10, 10)), box((10, 10, 10), shift))
    (part,) = read_solid(path)
    assert mesh_of(part).is_watertight
    assert mesh_of(part).volume == pytest.approx(volume)
    assert part.mends == (NO_UNIT, "2 bodies that meet joined")


@pytest.mark.parametrize("shift", [(10, 0, 0), (10, 10, 0), (10, 10, 10)])
def test_shells_of_boxes_that_share_corners_are_the_boxes(shift):
    both = trimesh.util.concatenate([box((10, 10, 10)), box((10, 10, 10), shift)])
    welded = cleaned(Body(both.vertices, both.faces), [])
    assert len(welded.vertices) < 16
    shells = shells_of(welded)
    # Two that share no more than a corner are apart as they are; those with a common wall have it twice.
    assert [round(volume(shell)) for shell in shells] == [1000, 1000]
    assert all(is_consistent(shell) and len(shell.triangles) == 12 for shell in shells)


def test_bodies_that_touch_in_an_edge_stay_one_part(tmp_path):
    pytest.importorskip("manifold3d", reason="joining takes the extra palpate[union]")
    (part,) = read_solid(written(tmp_path, box((10, 10, 10)), box((10, 10, 10), (10, 10, 0))))
    assert mesh_of(part).volume == pytest.approx(2000)


def test_without_manifold3d_the_remedy_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    path = written(tmp_path, box((10, 10, 10)), box((10, 10, 10), (5, 2, 1)))
    with pytest.raises(
        ValueError,
        match=r'bodies\.stl: 2 bodies meet near .* takes manifold3d; run pip install "palpate\[union\]"',
    ):
        read_solid(path)


def test_a_bolt_with_clearance_is_a_part_of_its_own(tmp_path):
    pytest.importorskip("manifold3d", reason="joining takes the extra palpate[union]")
    ring = trimesh.creation.annulus(6, 12, 10)
    bolt = trimesh.creation.cylinder(5, 30)
    inner, outer = sorted(
        read_solid(written(tmp_path, ring, bolt)), key=lambda part: mesh_of(part).extents[0]
    )
    assert mesh_of(inner).volume == pytest.approx(bolt.volume, rel=1e-5)
    assert mesh_of(outer).volume == pytest.approx(ring.volume, rel=1e-5)


def test_a_cavity_belongs_to_the_body_around_it_and_needs_no_library(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    hollow = (box((10, 10, 10)), inverted(box((4, 4, 4), (3, 3, 3))))
    (part,) = read_solid(written(tmp_path, *hollow))
    assert mesh_of(part).volume == pytest.approx(1000 - 64)
    (turned,) = read_solid(written(tmp_path, *map(inverted, hollow)))
    assert mesh_of(turned).volume == pytest.approx(1000 - 64)
    assert turned.mends == (NO_UNIT, "triangles faced inward: turned")


def test_a_body_in_a_cavity_is_a_part_of_its_own(tmp_path):
    pytest.importorskip("manifold3d", reason="joining takes the extra palpate[union]")
    path = written(
        tmp_path, box((10, 10, 10)), inverted(box((8, 8, 8), (1, 1, 1))), box((2, 2, 2), (4, 4, 4))
    )
    assert sorted(mesh_of(part).volume for part in read_solid(path)) == pytest.approx([8, 1000 - 512])


def test_groups_of_an_obj_that_are_patches_are_sewn(tmp_path):
    points, faces = ell_prism(0)
    text = written_faces("obj", points, faces).splitlines()
    patches = [f"g patch{k}\n{line}" if line.startswith("f") else line for k, line in enumerate(text)]
    (tmp_path / "ell.obj").write_text("\n".join(patches))
    (part,) = read_solid(tmp_path / "ell.obj")
    assert mesh_of(part).is_watertight and mesh_of(part).volume == pytest.approx(7000)


def test_an_open_surface_is_one_part_and_says_so(tmp_path):
    mesh = box((10, 10, 10))
    mesh.update_faces(np.arange(10))
    (part,) = read_solid(write(mesh, tmp_path / "open.stl"))
    assert len(part.triangles) == 10
    assert part.mends[1:] == (
        "the surface is open: 4 edge(s) where it ends; inside and outside are not known",
    )


# --- corners that rounding has parted -------------------------------------------------------------


def soup(path, triangles):
    """A binary STL whose triangles have corners of their own, shape `(m, 3, 3)`."""
    facets = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")])
    facets["corners"] = triangles
    path.write_bytes(bytes(80) + struct.pack("<I", len(facets)) + facets.tobytes())
    return path


@pytest.mark.parametrize("noise", [1e-7, 1e-6, 1e-5])
def test_corners_apart_by_rounding_are_welded_and_the_truth_is_kept(tmp_path, noise):
    random = np.random.default_rng(3)
    vertices, triangles = brackets.prism(brackets.ARMS, brackets.FANS, 25)
    corners = trimesh.Trimesh(vertices, triangles, process=False).subdivide().triangles
    corners = corners + random.normal(0.0, noise, corners.shape)
    (from_file,) = load_models(soup(tmp_path / "bracket.stl", corners))
    numbers = np.arange(3 * len(corners)).reshape(-1, 3)
    for model in (from_file, palpate.Model.mesh(corners.reshape(-1, 3), numbers)):
        assert model.closed and len(model.faces) == 8
        assert any("welded" in mend for mend in model.mends)
        assert not any("turned" in mend or "open" in mend for mend in model.mends)
        assert 0.0 < model.position_slack < 10 * noise + 1e-5
        found = palpate.recognize([model], brackets.touches())
        assert [one.poses.contains(brackets.POSE) for one in found.hypotheses] == [True]


def test_bodies_whose_corners_are_apart_are_parts_from_left_to_right(tmp_path):
    random = np.random.default_rng(4)
    bodies = [box((5, 5, 5)), inverted(box((10, 10, 10), (50, 0, 0))), box((1, 1, 1), (20, 0, 0))]
    corners = np.concatenate([body.triangles for body in bodies])
    path = soup(tmp_path / "bodies.stl", corners + random.normal(0.0, 1e-7, corners.shape))
    parts = read_solid(path)
    assert [round(mesh_of(part).volume) for part in parts] == [125, 1, 1000]
    assert all(len(part.vertices) == 8 and 0.0 < part.position_slack < 1e-5 for part in parts)


def test_corners_too_far_apart_to_be_welded_are_refused(tmp_path):
    random = np.random.default_rng(5)
    corners = box((10, 20, 30)).triangles
    path = soup(tmp_path / "box.stl", corners + random.normal(0.0, 3e-4, corners.shape))
    with pytest.raises(
        ValueError, match=r"box\.stl: vertices: 36 of 36 edges .*; weld the corners"
    ) as refusal:
        load_models(path)
    assert "\n" not in str(refusal.value)


def test_reading_many_loose_triangles_takes_no_more_than_seconds(tmp_path):
    random = np.random.default_rng(6)
    corners = trimesh.creation.icosphere(5, 40.0).triangles
    path = soup(tmp_path / "ball.stl", corners + random.normal(0.0, 1e-6, corners.shape))
    begin = time.perf_counter()
    (model,) = load_models(path)
    assert model.closed and len(model.faces) == len(corners) == 20480
    assert time.perf_counter() - begin < 30.0  # it takes 3; what is quadratic takes minutes


def test_openness_is_judged_after_what_is_dropped(tmp_path):
    flat = [[[2, 0, 0], [5, 0, 0], [9, 0, 0]], [[0, 0, 0], [5, 0, 0], [10, 0, 0]]]
    path = soup(tmp_path / "box.stl", np.concatenate([box((10, 20, 30)).triangles, flat]))
    (model,) = load_models(path)
    assert model.closed
    assert model.mends == [NO_UNIT, "triangles: 2 triangle(s) without area dropped"]


@pytest.mark.parametrize(("sides", "order"), [(6, 12), (48, 96)])
def test_symmetries_outlast_single_precision(tmp_path, sides, order):
    mesh = trimesh.creation.cylinder(25, 40, sections=sides)
    mesh.apply_transform(brackets.POSE)
    (model,) = load_models(write(mesh, tmp_path / "prism.stl"))
    assert len(model.faces) == sides + 2 and len(model.symmetries) == order
    contacts = [(mesh.triangles[k].mean(axis=0), mesh.face_normals[k]) for k in range(0, 4 * sides, 3)][:6]
    found = palpate.recognize([model], brackets.touches(contacts))
    assert [one.poses.contains(brackets.POSE) for one in found.hypotheses] == [True]


def test_triangles_twice_or_without_corners_are_left_out(tmp_path):
    mesh = box((10, 10, 10))
    corners = np.concatenate([mesh.triangles, mesh.triangles[:2, [1, 2, 0]], mesh.triangles[:1, [0, 0, 1]]])
    numbers = np.arange(3 * len(corners)).reshape(-1, 3)
    odd = trimesh.Trimesh(corners.reshape(-1, 3), numbers, process=False)
    (part,) = read_solid(write(odd, tmp_path / "odd.off"))
    assert len(part.triangles) == 12 and mesh_of(part).is_watertight
    assert part.mends[1:] == (
        "1 triangle(s) with two equal corners left out",
        "2 triangle(s) given twice read once",
    )


# --- what is refused ------------------------------------------------------------------------------

TETRA = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"

REFUSED = {
    "a.stl": [
        ("", r"a\.stl: is empty; export"),
        ("hello", r"a\.stl: not a readable STL file: neither binary nor text; export"),
        ("solid x\nendsolid x\n", r"a\.stl: no triangle in it .*; export"),
        (f"solid x\n{FACET}", r"a\.stl: it is cut off: the solid at line 1 has no end; export"),
        (f"solid x\n{FACET}endsolid\nsolid y\n{FACET}", r"a\.stl: it is cut off: the solid at line 9 has no end|a\.stl: it is cut off: the solid at line 10"),
        (f"solid x\n{FACET.replace('vertex 1 0 0', 'vertex 1 0')}endsolid x\n", r"a\.stl, line 2: not a facet with three corners; export"),
        (f"solid x\n{FACET}{FACET.replace('1 0 0', '1,0 0 0')}endsolid x\n", r"a\.stl, line 9: not a facet"),
        (f"solid x\n{FACET.replace('1 0 0', 'nan 0 0')}endsolid x\n", r"a\.stl: vertex 1 is not a finite point: \(nan, 0, 0\); export"),
        (f"solid x\n{FACET.replace('1 0 0', '1e200 0 0')}endsolid x\n", r"a\.stl: vertex 1 is not a finite point"),
        (f"solid x\n{FACET.replace('1 0 0', '0 0 0')}endsolid x\n", r"a\.stl: none of its triangles has an area; export"),
        (b"\0" * 80 + struct.pack("<I", 1000) + b"\0" * 500, r"a\.stl: it is cut off, or no STL: it announces 1000 triangles and has 10; export"),
        (b"\0" * 80 + struct.pack("<I", 0), r"a\.stl: no triangle in it .*; export"),
    ],
    "a.obj": [
        ("hello\n", r"a\.obj: not a readable OBJ file: there is no vertex in it; export"),
        ("v 0 0 0\0", r"a\.obj: not a readable OBJ file: it is no text; export"),
        (TETRA, r"a\.obj: no triangle in it .*; export"),
        (TETRA + "f 1 2 5\n", r"a\.obj: face 0 names a vertex that is not among the 4 of the file; the file may be cut off"),
        (TETRA + f"f 1 2 {10**30}\n", r"a\.obj: face 0 names a vertex that is not among"),
        (TETRA + "f 1 2 -5\n", r"a\.obj, line 5: there is no vertex -5; export"),
        (TETRA + "f 0 1 2\n", r"a\.obj, line 5: there is no vertex 0; export"),
        (TETRA + "f 1 2\n", r"a\.obj, line 5: a face has 2 corner\(s\); export"),
        (TETRA + "f 1 x 2\n", r"a\.obj, line 5: 'x' is no corner of a face; export"),
        ("v 0 0\n", r"a\.obj, line 1: a vertex has 2 coordinate\(s\); export"),
        ("v 0 0 zero\n", r"a\.obj, line 1: '0 0 zero' is not a vertex; export"),
        ("v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"a\.obj: vertex 0 is not a finite point"),
        ("v 0 0 0\nv 9 9 0\nv 9 0 0\nv 0 7 0\nf 1 2 3 4\n", r"a\.obj: the face at \(0, 0, 0\) crosses itself; export"),
    ],
    "a.off": [
        ("hello\n", r"a\.off: not a readable OFF file: it does not begin with OFF; export"),
        ("OFF\n", r"a\.off, line 1: no numbers of vertices and faces; export"),
        ("OFF BINARY\n3 1 0\n", r"a\.off: this kind of OFF \(OFF BINARY\) is not read; export"),
        ("OFF\n4 -1 0\n", r"a\.off, line 2: a number of vertices or faces is negative; export"),
        ("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", r"a\.off: it is cut off: it announces 3 vertices and 2 faces, and has 4 lines of them; export"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", r"a\.off, line 6: a face of 3 corners has 2; export"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", r"a\.off: face 0 names a vertex that is not among the 3"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", r"a\.off: face 0 names a vertex that is not among the 3"),
    ],
    "a.ply": [
        ("hello\n", r"a\.ply: not a readable PLY file: it has no whole header; export"),
        (PLY.replace("float z", "vec3 z"), r"a\.ply: its header has 'property vec3 z', which is not known; export"),
        (PLY.replace("format ascii 1.0\n", ""), r"a\.ply: its header has no format; export"),
        (PLY.replace(" z", " w") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", r"a\.ply: its vertices have no z; export"),
        (PLY + "0 0 0\n1 0 0\n0 1 0\n", r"a\.ply: it is cut off: it announces 1 rows of 'face' and has 0; export"),
        (PLY + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", r"a\.ply: row 1 of 'vertex': it is too short; export"),
        (PLY + "0 0 0\n1 0 0 5\n0 1 0\n3 0 1 2\n", r"a\.ply: row 1 of 'vertex': it is too long; export"),
        (PLY + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n", r"a\.ply: row 0 of 'face': 2\.5 is not a whole number; export"),
        (PLY + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", r"a\.ply: face 0 names a vertex that is not among the 3"),
        (PLY.replace("vertex 3", "vertex 3000000000"), r"a\.ply: it is cut off: 3000000000 rows of 'vertex' don't fit in it; export"),
        (PLY + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", r"a\.ply: face 0 has 2 corner\(s\); export"),
    ],
    "a.3mf": [
        ("hello\n", r"a\.3mf: not a readable 3MF file: File is not a zip file; export"),
        ({"readme.txt": "x"}, r"a\.3mf: there is no model in this archive; export"),
        ({"3D/a.model": "<model"}, r"a\.3mf: 3D/a\.model is not XML: .*; export"),
        ({"3D/a.model": "<html/>"}, r"a\.3mf: 3D/a\.model has <html>, not <model>; export"),
        ({"3D/a.model": '<!DOCTYPE x [<!ENTITY a "b">]><model/>'}, r"a\.3mf: 3D/a\.model has a document type, which 3MF forbids; export"),
        ({"3D/a.model": model_xml("", "", unit="furlong")}, r"a\.3mf: its unit 'furlong' is not known; it may be micron"),
        ({"3D/a.model": model_xml("", "")}, r"a\.3mf: no triangle in it; export"),
        ({"3D/a.model": model_xml("", '<item objectid="3"/>')}, r"a\.3mf: it places object '3', which is not in it; export"),
        ({"3D/a.model": model_xml('<object id="1"><components><component objectid="1"/></components></object>', '<item objectid="1"/>')}, r"a\.3mf: object '1' is a component of itself; export"),
        ({"3D/a.model": model_xml("", '<item objectid="1" transform="1 0 0"/>')}, r"a\.3mf: '1 0 0' is not a transform of 12 numbers; export"),
        ({"3D/a.model": model_xml('<object id="1"><mesh><vertices><vertex x="a" y="0" z="0"/></vertices></mesh></object>', "")}, r"a\.3mf: a vertex or triangle has what is no number: .*; export"),
        ({"3D/a.model": model_xml('<object id="1"><mesh><vertices><vertex x="1" y="0"/></vertices></mesh></object>', "")}, r"a\.3mf: a vertex or triangle has no 'z'; export"),
        ({"_rels/.rels": RELATIONS}, r"a\.3mf: its part '/3D/model\.model' is not in the archive; export"),
    ],
    "a.step": [
        ("hello\n", r"a\.step: not a readable STEP file: it does not begin with ISO-10303-21; export"),
        ("ISO-10303-21;\nHEADER;\n", r"a\.step: it is cut off: END-ISO-10303-21 is missing; export"),
    ],
    "a.iges": [("", r".*a\.iges: unknown suffix '\.iges'; give a \.stl, \.obj, .* file")],
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "content", "message"), [(n, *case) for n, cases in REFUSED.items() for case in cases]
)
def test_bad_files_are_refused_with_the_reason(tmp_path, name, content, message):
    if isinstance(content, dict):
        packed(tmp_path / name, content)
    else:
        (tmp_path / name).write_bytes(as_bytes(content))
    with pytest.raises(ValueError) as refusal:
        read_solid(tmp_path / name)
    assert re.match(message, str(refusal.value)), str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert ";" in str(refusal.value)


@pytest.mark.parametrize("form", WRITTEN)
def test_a_file_cut_off_anywhere_is_refused_or_open(tmp_path, form):
    """Never read as another closed part, and never an error of another kind."""
    options, _ = WRITTEN[form]
    path = write(SHAPES["cylinder"](), tmp_path / f"part.{form}", **options)
    whole = path.read_bytes()
    (part,) = read_solid(path)
    refused = 0
    for length in range(0, len(whole), 50):
        path.write_bytes(whole[:length])
        try:
            parts = read_solid(path)
        except ValueError as error:
            assert str(error).startswith(path.name) and "\n" not in str(error)
            refused += 1
            continue
        # Of text whose last number is cut, or whose last faces are missing, nothing but an open surface is left.
        said_open = any("the surface is open" in mend for one in parts for mend in one.mends)
        same = len(parts) == 1 and len(parts[0].triangles) == len(part.triangles)
        assert form == "obj" and (said_open or same), (length, parts)
    assert refused > (10 if form == "obj" else len(whole) / 50 - 1)


def nearest(model, part):
    """How far the corners of a part are from the surface of a model, at most."""
    return max(abs(model.distance(np.eye(4), corner)) for corner in part.vertices)


@pytest.mark.parametrize("form", WRITTEN)
def test_damaged_bytes_are_refused_or_read_without_any_other_error(tmp_path, form):
    options, _ = WRITTEN[form]
    path = write(SHAPES["bracket"](), tmp_path / f"part.{form}", **options)
    data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    (whole,) = load_models(path)
    random = np.random.default_rng(7)
    refused = 0
    for _ in range(150):
        damaged = data.copy()
        damaged[random.integers(0, len(data), size=3)] = random.integers(0, 256, size=3)
        path.write_bytes(damaged.tobytes())
        try:
            parts = read_solid(path)
            for part in parts:
                assert np.all(np.isfinite(part.vertices))
                assert np.all((part.triangles >= 0) & (part.triangles < len(part.vertices)))
        except ValueError as error:
            assert str(error).startswith(path.name) and "\n" not in str(error)
            refused += 1
            continue
        if "stl" in form:
            # Each corner is written for several triangles: where one of them moves by more than rounding does,
            # there is a gap.
            said_open = any("the surface is open" in mend for part in parts for mend in part.mends)
            assert said_open or all(nearest(whole, part) <= part.position_slack + 1e-9 for part in parts)
    assert refused > 0 or form == "stl"


def test_too_many_triangles_are_refused_before_they_are_read(tmp_path):
    (tmp_path / "a.ply").write_text(
        PLY.replace("face 1", "face 1000001") + "0 0 0\n" * 3 + "3 0 1 2\n" * 200_000
    )
    with pytest.raises(
        ValueError, match=r"a\.ply: 1000001 triangles are more than 1000000; export it coarser"
    ):
        read_solid(tmp_path / "a.ply")


def test_a_3mf_that_swells_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("palpate.solids.three_mf._MOST_BYTES", 1000)
    with pytest.raises(ValueError, match=r"part\.3mf: what is packed in it is larger than"):
        read_solid(three_mf(tmp_path, [("1", box((1, 1, 1)))]))


def test_what_is_not_there_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"gone\.stl: can't be read: No such file.*; check"):
        read_solid(tmp_path / "gone.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(ValueError, match=r"folder\.stl: can't be read: Is a directory; check"):
        read_solid(tmp_path / "folder.stl")


# --- STEP -----------------------------------------------------------------------------------------


@pytest.fixture
def cascadio():
    return pytest.importorskip("cascadio", reason="reading STEP takes the extra palpate[step]")


def step(tmp_path, faces, *, unit="mm", name="part.step"):
    (tmp_path / name).write_text(step_files.step_text(faces, unit=unit))
    return tmp_path / name


@pytest.mark.usefixtures("cascadio")
@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("m", 1000.0)])
def test_a_step_of_planes_is_exact_and_in_its_own_unit(tmp_path, unit, factor):
    (part,) = read_solid(step(tmp_path, step_files.box((10, 20, 30)), unit=unit, name="part.stp"))
    assert mesh_of(part).is_watertight and len(part.vertices) == 8
    assert mesh_of(part).bounds == pytest.approx(factor * np.array([[0, 0, 0], [10, 20, 30]]), rel=1e-6)
    assert mesh_of(part).volume == pytest.approx(6000 * factor**3, rel=1e-6)
    assert (part.position_slack, part.normal_slack) == (0.0, 0.0)
    (in_cm,) = read_solid(tmp_path / "part.stp", unit="cm")
    assert in_cm.vertices * 10 == pytest.approx(part.vertices)


@pytest.mark.usefixtures("cascadio")
@pytest.mark.parametrize(("flattening", "turn_deg"), [(0.05, 7.5), (0.5, 30.0), (0.005, 7.5)])
def test_the_slack_of_a_cylinder_covers_it(tmp_path, flattening, turn_deg):
    path = step(tmp_path, step_files.cylinder(40, 25))
    (part,) = read_solid(path, flattening=flattening, turn_deg=turn_deg)
    mesh = mesh_of(part)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(math.pi * 40**2 * 25, rel=0.02)
    angles = np.linspace(0, math.tau, 2000)
    heights = np.tile([0.0, 5.0, 12.5, 25.0], 500)
    on = np.column_stack([40 * np.cos(angles), 40 * np.sin(angles), heights])
    _, distances, triangles = trimesh.proximity.closest_point(mesh, on)
    assert 0.0 < np.max(distances) <= part.position_slack + 1e-5
    side = np.abs(mesh.face_normals[triangles][:, 2]) < 0.5
    cosines = np.sum(
        mesh.face_normals[triangles] * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]), axis=1
    )
    assert np.max(np.arccos(np.minimum(1.0, cosines[side]))) <= part.normal_slack + 1e-6
    assert part.position_slack == pytest.approx(flattening)
    assert part.normal_slack <= math.radians(turn_deg) + 1e-6
    assert not any("free-form" in mend for mend in part.mends)


@pytest.mark.usefixtures("cascadio")
def test_a_cylinder_has_its_axis(tmp_path):
    (model,) = load_models(step(tmp_path, step_files.cylinder(25, 80)))
    assert len(model.symmetries) == 2 * (len(model.faces) - 2) > 100
    ((point, direction),) = model.symmetry_axes
    assert np.abs(direction) == pytest.approx([0, 0, 1], abs=1e-7) and point[:2] == pytest.approx(
        [0, 0], abs=1e-5
    )


@pytest.mark.usefixtures("cascadio")
def test_a_step_reads_the_same_each_time(tmp_path):
    path = step(tmp_path, step_files.cylinder(7, 3))
    first, second = read_solid(path)[0], read_solid(path)[0]
    assert np.array_equal(first.vertices, second.vertices) and np.array_equal(
        first.triangles, second.triangles
    )


@pytest.mark.usefixtures("cascadio")
def test_damaged_step_files_are_refused_in_one_line(tmp_path, capfd):
    path = step(tmp_path, step_files.box((1, 2, 3)))
    text = path.read_text()
    for damage in (
        text.replace("CLOSED_SHELL", "CLOSED)SHELL"),
        step_files.WHOLE.format(""),
        text.replace("DATA;", ""),
    ):
        path.write_text(damage)
        with pytest.raises(ValueError, match=r"^part\.step: [^\n]*; export"):
            read_solid(path)
    assert capfd.readouterr() == ("", "")


def test_without_cascadio_the_remedy_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr("subprocess.run", lambda *_, **__: subprocess.CompletedProcess([], 2, b"", b""))
    with pytest.raises(
        ValueError, match=r'part\.step: reading STEP takes cascadio, .*; run pip install "palpate\[step\]"'
    ):
        read_solid(step(tmp_path, step_files.box((1, 2, 3))))


# --- how far triangles are from surfaces ----------------------------------------------------------

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
SIDE = np.array([1.0, 2.0, 0.0]) / math.sqrt(5.0)
ORIGIN = np.array([3.0, -4.0, 5.0])


def surface_point(kind, u, v):
    """A point and the normal of a surface about `AXIS`."""
    out = np.multiply.outer(np.cos(u), SIDE) + np.multiply.outer(np.sin(u), np.cross(AXIS, SIDE))
    cos_v, sin_v = np.cos(v)[..., None], np.sin(v)[..., None]
    if kind == "cylinder":
        return ORIGIN + 9.0 * out + 5.0 * v[..., None] * AXIS, out
    if kind == "cone":
        along = 10.0 + 5.0 * v[..., None]
        return ORIGIN + along * (AXIS + math.tan(0.4) * out), math.cos(0.4) * out - math.sin(0.4) * AXIS
    normal = cos_v * out + sin_v * AXIS
    return ORIGIN + (9.0 * normal if kind == "sphere" else 9.0 * out + 2.5 * normal), normal


SURFACES = {
    "cylinder": {"origin": ORIGIN, "axis": AXIS, "radius": 9.0},
    "cone": {"apex": ORIGIN, "axis": AXIS, "semi_angle": 0.4},
    "sphere": {"center": ORIGIN, "radius": 9.0},
    "torus": {"center": ORIGIN, "axis": AXIS, "major_radius": 9.0, "minor_radius": 2.5},
}


@pytest.mark.parametrize("kind", SURFACES)
@pytest.mark.parametrize("seed", range(25))
def test_no_point_of_a_surface_is_farther_than_the_bound(kind, seed):
    random = np.random.default_rng(seed)
    u, v = (
        random.uniform(0, 0.5, 3) + random.uniform(0, 6),
        random.uniform(0, 0.5, 3) + random.uniform(-0.8, 0.5),
    )
    corners, _ = surface_point(kind, u, v)
    found = bounds({"type": kind, **SURFACES[kind]}, corners[None])
    assert found is not None
    position, normal = found
    weights = random.dirichlet((0.5, 0.5, 0.5), size=3000)
    triangle = trimesh.Trimesh(corners, [[0, 1, 2]], process=False)
    if kind == "torus":
        points, normals = surface_point(kind, weights @ u, weights @ v)
    else:
        # What is opposite to the triangle, as seen from the axis or the centre.
        flat = weights @ corners - ORIGIN
        height = 0.0 if kind == "sphere" else (flat @ AXIS)[:, None] * AXIS
        outward = (flat - height) / np.linalg.norm(flat - height, axis=1, keepdims=True)
        radius = np.linalg.norm(height, axis=1, keepdims=True) * math.tan(0.4) if kind == "cone" else 9.0
        points = ORIGIN + height + radius * outward
        normals = math.cos(0.4) * outward - math.sin(0.4) * AXIS if kind == "cone" else outward
    _, distances, _ = trimesh.proximity.closest_point(triangle, points)
    assert np.max(distances) <= position * (1 + 1e-9) + 1e-9
    angles = np.arccos(np.minimum(1.0, np.abs(normals @ triangle.face_normals[0])))
    assert np.max(angles) <= normal + 1e-6


def test_nothing_is_said_of_other_surfaces_or_corners_off_them():
    corners = np.array([[[9.0, 0, 0], [0, 9.0, 0], [0, 0, 1.0]]])
    assert bounds(None, corners) is None
    assert bounds({"type": "bspline"}, corners) is None
    assert bounds({"type": "sphere", "center": [0, 0, 0], "radius": 9.0}, corners) is None
    assert bounds({"type": "plane", "origin": [0, 0, 5.0], "normal": [0, 0, 1]}, corners) is None


# --- load_models ----------------------------------------------------------------------------------


def test_load_models_reads_solids_beside_the_rest_of_a_folder(tmp_path):
    write(box((1, 2, 3)), tmp_path / "b.stl")
    write(box((4, 5, 6)), tmp_path / "a.ply")
    (tmp_path / "notes.txt").write_text("not a model")
    palpate.save_model(palpate.Model.polygon([[0, 0], [4, 0], [0, 3]], name="flat"), tmp_path / "c.json")
    first, second, flat = load_models(tmp_path, position_slack=0.25, normal_slack=0.5)
    assert [model.name for model in (first, second, flat)] == ["a", "b", "flat"]
    assert [model.dimension for model in (first, second, flat)] == [3, 3, 2]
    assert np.ptp(second.vertices, axis=0).tolist() == [1, 2, 3] and len(second.faces) == 6
    assert {(model.position_slack, model.normal_slack) for model in (first, second, flat)} == {(0.25, 0.5)}
    assert second.mends == [NO_UNIT]


def test_load_models_refuses_a_bad_solid_by_its_name(tmp_path):
    (tmp_path / "a.stl").write_text("hello")
    with pytest.raises(ValueError, match=r"^a\.stl: not a readable STL file"):
        load_models(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"position_slack": -1.0}, "position_slack: -1.0 is not a length, zero or more; give 0"),
        ({"position_slack": math.nan}, "position_slack: nan is not a length"),
        ({"normal_slack": 1.6}, "normal_slack: 1.6 is not an angle of 0 to π/2 radians; give 0"),
    ],
)
def test_bad_slacks_are_refused(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        load_models(["boot"], **arguments)


def test_the_command_line_adds_the_slacks(tmp_path):
    command = [
        sys.executable,
        "-m",
        "palpate.cli",
        "models",
        "boot",
        "--json",
        "--position-slack",
        "0.25",
        "--normal-slack-deg",
        "2",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert '"position_slack": 0.25' in done.stdout
    assert re.search(r'"normal_slack_deg": 2\.0\b', done.stdout)
    bad = subprocess.run([*command[:-1], "ninety"], capture_output=True, text=True, check=False)
    assert bad.returncode == 2 and bad.stderr.count("\n") <= 2


def test_the_command_line_refuses_a_bad_solid_in_one_line(tmp_path):
    (tmp_path / "a.stl").write_text("hello")
    done = subprocess.run(
        [sys.executable, "-m", "palpate.cli", "models", str(tmp_path / "a.stl")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and "a.stl" in done.stderr and "Traceback" not in done.stderr


def test_nothing_that_is_slow_to_import_is_loaded_before_it_is_needed():
    code = "import sys, palpate.cli, palpate.models; print([m for m in sys.modules if m.partition('.')[0] in ('trimesh', 'cascadio', 'manifold3d', 'scipy', 'zipfile')])"
    assert subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.strip() in ("[]", "['zipfile']")
