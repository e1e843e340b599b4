"""The command line on solids: files in, answers, documents and pictures out; the same as the API says."""

import json
import math
from pathlib import Path
from random import Random

import numpy as np
import pytest
import step_files
from brackets import ARMS, FANS, POINTS, POSE, bracket, prism, touches, turned
from test_cli import run, validate

import palpate
from palpate.experiments.solid_shapes import FAMILIES, random_solid
from palpate.rotations import rotation_of, vector_of
from palpate.solids.faces import face_areas, face_places

NEAR = "110,-40,70,-37,49.5,102.5"  # POSE, to within a degree or so


def stl_text(vertices, triangles):
    rows = ["solid part"]
    for corners in vertices[triangles].tolist():
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex " + " ".join(map(repr, corner)) for corner in corners]
        rows += ["endloop", "endfacet"]
    return "\n".join([*rows, "endsolid part", ""])


def obj_text(vertices, triangles):
    rows = ["v " + " ".join(map(repr, vertex)) for vertex in vertices.tolist()]
    rows += ["f " + " ".join(str(corner + 1) for corner in triangle) for triangle in triangles.tolist()]
    return "\n".join([*rows, ""])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a bracket in three formats, and with contacts of it."""
    monkeypatch.chdir(tmp_path)
    mesh = prism(ARMS, FANS, 25)
    Path("bracket.stl").write_text(stl_text(*mesh))
    Path("bracket.obj").write_text(obj_text(*mesh))
    palpate.save_model(bracket(), "bracket.json")
    palpate.write_contacts("touches.csv", touches())
    palpate.write_contacts("touches.json", touches())
    return tmp_path


def answer(capsys, *arguments):
    document = json.loads(run(capsys, "recognize", *arguments, "--json"))
    validate(document, "recognition-1")
    return document


def assert_same(document, found):
    """A document holds the answer of the API, bit for bit."""
    assert document["complete"] == found.complete and document["conflict"] == found.conflict
    assert document["interpretation_count"] == found.interpretation_count
    assert len(document["hypotheses"]) == len(found.hypotheses)
    for entry, hypothesis in zip(document["hypotheses"], found.hypotheses, strict=True):
        pose = hypothesis.world_from_model
        assert entry["model_number"] == hypothesis.model_number
        assert np.array_equal(entry["world_from_model"], pose) and pose.shape == (4, 4)
        assert [entry[name] for name in "xyz"] == pose[:3, 3].tolist()
        vector = np.radians([entry[f"r{name}_deg"] for name in "xyz"])
        assert np.allclose(rotation_of(vector), pose[:3, :3], rtol=0.0, atol=1e-12)
        assert entry["rotation_bound_deg"] == math.degrees(hypothesis.poses.rotation_bound)
        assert entry["excursion_bound"] == max(map(hypothesis.poses.excursion, hypothesis.model.vertices))
        assert "angle_deg" not in entry


@pytest.mark.parametrize("model", ["bracket.stl", "bracket.obj", "bracket.json"])
@pytest.mark.parametrize("contacts", ["touches.csv", "touches.json"])
def test_a_solid_is_recognized_from_its_file(folder, capsys, *, model, contacts):
    document = answer(capsys, model, "--contacts", contacts, "--list-interpretations", "3")
    evidence = palpate.read_contacts(contacts)
    found = palpate.recognize(palpate.load_models(model), evidence.contacts)
    assert_same(document, found)
    assert any(hypothesis.poses.contains(POSE) for hypothesis in found.hypotheses)
    listed = [entry["assignment"] for one in document["hypotheses"] for entry in one["interpretations"]]
    assert listed == [
        [list(feature) for feature in one.assignment]
        for h in found.hypotheses
        for one in h.interpretations[:3]
    ]


def test_a_step_file_is_recognized(folder, capsys):
    pytest.importorskip("cascadio", reason="cascadio is in the extra palpate[step]")
    Path("box.step").write_text(step_files.step_text(step_files.box((30, 20, 10))))
    (box,) = palpate.load_models("box.step")
    ends = [((0, -1, 0), 0), ((1, 0, 0), 1), ((0, 0, 1), 2)]
    faces = [int(np.argmax(box.face_normals @ normal)) for normal, _ in ends]
    points = [(face_places(box)[face], box.face_normals[face]) for face in faces]
    palpate.write_contacts("box.csv", touches(points))
    document = answer(capsys, "box.step", "--contacts", "box.csv")
    found = palpate.recognize([box], palpate.read_contacts("box.csv").contacts)
    assert_same(document, found)
    assert any(hypothesis.poses.contains(POSE) for hypothesis in found.hypotheses)


def random_problem(seed):
    """A solid, its pose, contacts that agree with it, misses and maybe a prior."""
    random = Random(seed)
    solid = random_solid(random, random.choice(list(FAMILIES)))
    model = palpate.Model.mesh(solid.vertices, solid.triangles, name="part")
    pose = turned(*(random.uniform(-3, 3) for _ in range(3)), [random.uniform(-99, 99) for _ in range(3)])
    chosen = random.choices(range(len(model.faces)), weights=face_areas(model), k=random.randint(3, 5))
    with_tips = seed % 2 == 1
    contacts = []
    for face in chosen:
        normal = pose[:3, :3] @ model.face_normals[face]
        point = pose[:3, :3] @ face_places(model)[face] + pose[:3, 3]
        # Within the bounds: 0.5 along each axis is 0.87 in all.
        shift = np.array([random.uniform(-0.5, 0.5) for _ in range(3)])
        if with_tips:
            contacts.append(
                palpate.Contact.from_tip(
                    point + 2.0 * normal + shift, 2.0, position_error=0.9, approach=-normal
                )
            )
        else:
            contacts.append(palpate.Contact(point + shift, normal, position_error=0.9, normal_error=0.07))
    prior = palpate.Prior(pose, translation=4.0, rotation=math.radians(6.0)) if with_tips else None
    far = pose[:3, 3] + 900.0
    misses = [palpate.Miss(far, far + 50.0, tip_radius=2.0)]
    return model, pose, contacts, misses, prior


@pytest.mark.parametrize("seed", range(12))
def test_random_problems_are_answered_as_by_the_api(tmp_path, monkeypatch, capsys, *, seed):
    monkeypatch.chdir(tmp_path)
    model, pose, contacts, misses, prior = random_problem(seed)
    palpate.save_model(model, "part.json")
    palpate.write_contacts("touches.json", contacts, misses=misses, prior=prior)
    palpate.write_contacts("touches.csv", contacts, misses=misses)
    evidence = palpate.read_contacts("touches.json")
    # A rotation is made one again when it is read, which may change its last bit.
    assert prior is None or np.allclose(evidence.prior.world_from_model, pose, rtol=0.0, atol=1e-13)
    assert evidence.misses == misses
    models = palpate.load_models("part.json")
    found = palpate.recognize(models, evidence.contacts, misses=misses, prior=evidence.prior)
    assert_same(answer(capsys, "part.json", "--contacts", "touches.json"), found)
    assert any(hypothesis.poses.contains(pose) for hypothesis in found.hypotheses)
    if prior is None:
        assert_same(answer(capsys, "part.json", "--contacts", "touches.csv"), found)
    else:
        flags = ("--prior-translation", "4", "--prior-rotation-deg", "6")
        place, turn = pose[:3, 3], np.degrees(vector_of(pose[:3, :3]))
        said = ",".join(map(repr, [*place.tolist(), *turn.tolist()]))
        by_flags = answer(capsys, "part.json", "--contacts", "touches.csv", "--prior-pose", said, *flags)
        assert len(by_flags["hypotheses"]) == len(found.hypotheses)


def test_the_table_has_the_pose_and_rounds_bounds_up(folder, capsys):
    out = run(capsys, "recognize", "bracket.json", "--contacts", "touches.csv")
    assert "x, y, z, shift in mm; rx, ry, rz: the axis times the angle, in degrees." in out
    found = palpate.recognize(
        palpate.load_models("bracket.json"), palpate.read_contacts("touches.csv").contacts
    )
    rows = [line.split() for line in out.splitlines() if line.split()[1:2] == ["bracket"]]
    for row, hypothesis in zip(rows, found.hypotheses, strict=True):
        pose, shown = hypothesis.world_from_model, [float(cell) for cell in row[3:]]
        assert np.allclose(shown[:3], pose[:3, 3], rtol=0.0, atol=6e-4)
        assert np.allclose(rotation_of(np.radians(shown[3:6])), pose[:3, :3], rtol=0.0, atol=3e-4)
        assert 0.0 <= shown[6] - math.degrees(hypothesis.poses.rotation_bound) <= 0.0101
        assert -1e-9 <= shown[7] - max(map(hypothesis.poses.excursion, hypothesis.model.vertices)) <= 0.0101


def test_a_prior_is_given_as_flags(folder, capsys):
    palpate.write_contacts("few.csv", touches(POINTS[:3]))
    few = palpate.read_contacts("few.csv").contacts
    models = palpate.load_models("bracket.json")
    prior = palpate.Prior(POSE, translation=5.0, rotation=math.radians(20.0))
    without = palpate.recognize(models, few)
    flags = ("--prior-pose", NEAR, "--prior-translation", "5", "--prior-rotation-deg", "20")
    document = answer(capsys, "bracket.json", "--contacts", "few.csv", *flags)
    assert len(palpate.recognize(models, few, prior=prior).hypotheses) == len(document["hypotheses"])
    assert 1 <= len(document["hypotheses"]) < len(without.hypotheses)
    for entry in document["hypotheses"]:
        assert np.all(np.abs(np.array([entry[name] for name in "xyz"]) - [110, -40, 70]) <= 5.0)


def test_a_part_lies_on_a_table(folder, capsys):
    lying = turned(0, 0, 0.7, (20, 30, 0))
    palpate.write_contacts("lying.csv", touches(POINTS[:4], lying))
    flags = ("--prior-pose", "0,0,0,0,0,0", "--prior-translation", "100", "--on-table", "0.5,1")
    document = answer(capsys, "bracket.json", "--contacts", "lying.csv", *flags)
    models, evidence = palpate.load_models("bracket.json"), palpate.read_contacts("lying.csv")
    rest = {"rotation": math.pi, "height": 0.5, "tilt": math.radians(1.0)}
    prior = palpate.Prior.on_plane(np.eye(4), translation=100.0, **rest)
    assert_same(document, palpate.recognize(models, evidence.contacts, prior=prior))
    assert document["hypotheses"]
    for entry in document["hypotheses"]:
        assert abs(entry["z"]) <= 0.5 + 1e-3
        assert entry["world_from_model"][2][2] >= math.cos(math.radians(1.0)) - 1e-4


def test_edges_may_be_touched(folder, capsys):
    s = math.sqrt(0.5)
    edge = [((0, 20, 25), (-s, 0, s))]
    palpate.write_contacts("edge.csv", touches([*POINTS[:4], *edge]))
    arguments = ("bracket.json", "--contacts", "edge.csv", "--list-interpretations", "20")
    kinds = {
        kind
        for one in answer(capsys, *arguments, "--features", "face,edge")["hypotheses"]
        for entry in one["interpretations"]
        for kind, _ in entry["assignment"]
    }
    assert kinds == {"face", "edge"}
    assert answer(capsys, *arguments, "--features", "face")["hypotheses"] == []


def balls(file):
    """Ball contacts without normals, as many tips have them: far too little to tell a pose."""
    centers = [np.add(contact.center, 2.0 * contact.normal) for contact in touches()]
    palpate.write_contacts(
        file, [palpate.Contact.from_tip(center, 2.0, position_error=0.5) for center in centers]
    )


@pytest.mark.parametrize(
    ("flags", "limit", "remedy"),
    [
        (("--effort", "50"), "effort", "more effort (--effort), a prior, or another contact"),
        (("--time-limit", "0.001"), "time", "more time (--time-limit), a prior, or another contact"),
    ],
)
def test_the_limit_that_ended_the_search_is_said_with_its_remedy(folder, capsys, *, flags, limit, remedy):
    balls("balls.csv")
    arguments = ("bracket.stl", "--contacts", "balls.csv", *flags)
    out = run(capsys, "recognize", *arguments)
    assert ": not everything was decided; " in out and remedy in out
    assert "--max-hypotheses" not in out and "at least 0" not in out
    (row,) = [line.split() for line in out.splitlines() if line.split()[1:3] == ["bracket", "?"]]
    assert row[3] == "unknown" and row[-2:] == ["unknown", "unknown"]
    document = answer(capsys, *arguments)
    assert (document["complete"], document["stopped_by"]) == (False, limit)
    assert document["hypotheses"][-1]["proved"] is False


def test_an_answer_that_is_complete_names_no_limit(folder, capsys):
    assert answer(capsys, "bracket.stl", "--contacts", "touches.csv")["stopped_by"] is None
    few = answer(capsys, "bracket.stl", "--contacts", "touches.csv", "--features", "face,edge,vertex")
    assert few["complete"]


def test_one_interpretation_is_counted_as_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("balls.csv").write_text(
        "x,y,z,approach_x,approach_y,approach_z\n261.34,105.8,6,0.1,-1,0\n233.53,102.38,6.01,0.1,-1,0\n"
        "295.25,67.65,6.02,-1,-0.1,0\n275.46,-9.32,91.99,0,0,-1\n276.46,-17.27,60,-0.1,1,0\n"
        "265.93,43.91,14.01,0,0,-1\n"
    )
    bounds = ("--position-error", "0.05", "--tip-radius", "2")
    prior = ("--prior-pose", "300,-10,0,0,0,90", "--prior-translation", "15", "--prior-rotation-deg", "15")
    out = run(
        capsys, "recognize", "l-bracket", "--contacts", "balls.csv", *bounds, *prior, "--on-table", "0.5,1"
    )
    assert ": it is l-bracket; 1 hypothesis, at least 1 interpretation in all.\n" in out


def test_contacts_in_another_unit_are_told(folder, capsys):
    """A file in metres, taken as millimetres."""
    vertices, triangles = prism(ARMS, FANS, 25)
    Path("metres.stl").write_text(stl_text(np.asarray(vertices) / 1000, triangles))
    out = run(capsys, "recognize", "metres.stl", "--contacts", "touches.csv", "--max-hypotheses", "5")
    apart = [
        (math.dist(a.center, b.center), j + 1, k + 1)
        for k, b in enumerate(touches())
        for j, a in enumerate(touches()[:k])
    ]
    most, first, second = max(apart)
    said = f"Contacts {first} and {second} are {most:.4g} mm apart, no model is larger than 0.07632 mm: "
    assert said + "is the model's file in m? Then give --unit m, and say # unit: mm in the file of" in out
    # What it says to do helps.
    right = Path("touches.csv").read_text()
    assert right.startswith("# unit: mm")
    document = answer(capsys, "metres.stl", "--contacts", "touches.csv", "--unit", "m")
    assert any(one["proved"] for one in document["hypotheses"])
    Path("far.csv").write_text("x,y,z,position_error\n0,0,0,0.5\n100,0,0,0.5\n")
    out = run(capsys, "recognize", "bracket.stl", "--contacts", "far.csv")
    assert "Contacts 1 and 2 are 100 mm apart, no model is larger than 76.32 mm.\nUsual causes: " in out


def test_models_of_space_are_told_and_drawn(folder, capsys):
    brief = run(capsys, "models", "bracket.stl", "hexagon")
    out = run(capsys, "models", "bracket.stl", "hexagon", "--faces", "--plot", "models.png")
    assert set(brief.splitlines()) < set(out.splitlines()) and "touchable" not in brief
    assert "bracket: 8 faces, 18 edges, 12 vertices, closed, size 76.3217 mm" in out
    assert "symmetries: none" in out
    assert "symmetries: looks the same after 5 turns: 2 by 60°, 2 by 120° and 1 by 180°" in out
    assert "edges that can't be touched, by number: 15\n" in out
    row = next(line.split() for line in out.splitlines() if line.split()[:2] == ["3", "4"])
    assert row[3:] == ["60.000,", "5.000,", "8.333", "375", "1.000,", "0.000,", "0.000", "touchable"]
    assert Path("models.png").stat().st_size > 10_000


def test_models_of_space_as_json(folder, capsys):
    palpate.save_model(
        palpate.Model.facets([[p for p, _ in POINTS[:3]]], name="loose", seams=[]), "loose.json"
    )
    outline = [[20 * math.cos(a), 20 * math.sin(a)] for a in np.linspace(0, math.tau, 32, endpoint=False)]
    slacks = {"position_slack": 0.1, "normal_slack": math.pi / 32}
    pin = palpate.Model.mesh(*prism(outline, [(0, k, k + 1) for k in range(1, 31)], 50), name="pin", **slacks)
    palpate.save_model(pin, "pin.json")
    names = ("bracket.json", "loose.json", "pin.json", "flange", "boot")
    document = json.loads(run(capsys, "models", *names, "--json"))
    validate(document, "model-report-1")
    for entry, model in zip(document["models"], palpate.load_models(names), strict=True):
        assert (entry["dimension"], entry["closed"]) == (model.dimension, model.closed)
        assert np.array_equal(entry["symmetries"], model.symmetries)
        if model.dimension == 3:
            loops = [face["loops"] for face in entry["faces"]]
            assert loops == [[loop.tolist() for loop in face] for face in model.face_loops]
            assert [edge["touchable"] for edge in entry["edges"]] == model.touchable_edges.tolist()
            assert len(entry["symmetry_axes"]) == len(model.symmetry_axes) == (model.name == "pin")
        else:
            assert "edges" not in entry and "start" in entry["faces"][0]
    words = "symmetries: looks the same after 63 turns, which --json lists; any turn about (0.000, 0.000, "
    assert words in run(capsys, "models", "pin.json")


def test_parts_lists_the_plane_and_space(capsys):
    rows = [line.split() for line in run(capsys, "parts").splitlines()]
    for names, dimension in ((palpate.part_names(), "2"), (palpate.solid_part_names(), "3")):
        assert [row[1] for row in rows if row and row[0] in names] == [dimension] * len(names)
    document = json.loads(run(capsys, "parts", "--json"))
    validate(document, "model-report-1")
    assert [model["name"] for model in document["models"]] == [
        *palpate.part_names(),
        *palpate.solid_part_names(),
    ]


@pytest.mark.parametrize("name", ["boot", "l-bracket"])
def test_contacts_come_with_a_bundled_part(tmp_path, monkeypatch, capsys, *, name):
    monkeypatch.chdir(tmp_path)
    document = answer(capsys, name, "--contacts", name)
    found = palpate.recognize(palpate.load_models(name), palpate.standard_contacts(name))
    poses = [entry["world_from_model"] for entry in document["hypotheses"]]
    assert np.array_equal(poses, [hypothesis.world_from_model for hypothesis in found.hypotheses])


@pytest.mark.parametrize("extra", [(), ("--plot-range", "1")])
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_solids_are_drawn(folder, capsys, *, extra, suffix):
    arguments = ("bracket.stl", "--contacts", "touches.csv", "--plot", f"found.{suffix}", *extra)
    assert run(capsys, "recognize", *arguments).endswith(f"picture: found.{suffix}\n")
    assert Path(f"found.{suffix}").stat().st_size > 10_000
