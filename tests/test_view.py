"""A session of the viewer, what is drawn of it and what is said, without a viewer or a browser."""

from __future__ import annotations

import builtins
import json
import math

import numpy as np
import pytest
from conftest import pose, usual_sensor
from test_cli import validate

import palpate
from palpate.cli import main
from palpate.view import NO_VISER, Session, words
from palpate.view.meshes import ball, cone, dashes, fan, mesh_of
from palpate.view.picture import Bodies, Look, Strokes, frame_of, same, shapes_of, spread
from palpate.view.scene import Scene


@pytest.fixture
def session():
    boot, camera = palpate.load_models(["boot", "camera"])
    truth = pose(0.5, 20.0, -10.0)
    contacts = palpate.random_contacts(boot, truth, usual_sensor(), count=2, seed=8)
    return Session([boot, camera], usual_sensor(), contacts=contacts, truth=(boot, truth), seed=3)


@pytest.fixture
def solids():
    touches = [
        ((175.4, 160.2, 96.4), (-0.415, 0.769, 0.486)),
        ((223.3, 37.7, 82.5), (0.412, -0.761, -0.5)),
        ((216.9, 138.9, 83.1), (0.91, 0.326, 0.257)),
        ((221.1, 23.7, 109.5), (-0.012, -0.559, 0.829)),
    ]
    bounds = {"position_error": 0.5, "normal_error": math.radians(4)}
    contacts = [palpate.Contact(*touch, **bounds) for touch in touches]
    return Session(palpate.bundled_solids(), usual_sensor(), contacts=contacts, seed=1)


def until_one(session):
    """Recognize, plan and touch until one hypothesis is left."""
    session.recognize()
    while len(session.state.hypotheses) > 1:
        session.plan()
        session.touch()
        assert len(session.state.moves) < 10


def test_what_it_recognizes_is_what_palpate_recognizes(session):
    session.recognize()
    found = palpate.recognize(session.models, session.state.contacts)
    assert [one.model for one in session.state.hypotheses] == [one.model for one in found.hypotheses]
    assert all(
        np.array_equal(one.world_from_model, other.world_from_model)
        for one, other in zip(session.state.hypotheses, found.hypotheses, strict=True)
    )


def test_touches_keep_the_truth_and_undo_leads_all_the_way_back(session):
    until_one(session)
    assert session.state.hypotheses[0].poses.contains(session.state.truth.world_from_model)
    assert len(session.state.contacts) + sum(
        not isinstance(move.reply, palpate.Hit) for move in session.state.moves
    ) == 2 + len(session.state.moves)
    said = [state.said for state in session.states]
    for expected in reversed(said[:-1]):
        assert session.undo().said == expected
    assert session.state.left is None and len(session.state.contacts) == 2
    with pytest.raises(ValueError, match="nothing was done yet"):
        session.undo()


def test_after_undo_the_same_touch_meets_the_same(session):
    session.recognize()
    session.plan()
    first = session.touch().moves[-1].reply
    session.undo()
    assert session.touch().moves[-1].reply == first


def test_solids_are_touched_at_a_pose_that_was_drawn(solids):
    until_one(solids)
    truth = solids.state.truth
    assert truth.drawn_from is not None
    assert solids.state.hypotheses[0].poses.contains(truth.world_from_model)


def test_what_is_stale_is_not_planned(session):
    session.recognize()
    session.plan()
    state = session.add_contact(session.contact_of((200.0, 200.0), (0.0, 1.0)))
    assert state.stale and state.path is None and state.hypotheses
    with pytest.raises(ValueError, match="recognize first"):
        session.plan()
    with pytest.raises(ValueError, match="plan one first"):
        session.touch()
    left = session.recognize().left
    assert left.hypotheses == [] and left.conflict
    assert "can't hold together" in words.answer(session, session.state, Look())
    with pytest.raises(ValueError, match="none is left"):
        session.plan()


@pytest.mark.parametrize("tip_radius", [0.0, 3.0])
def test_a_click_is_where_the_tip_would_be(tip_radius):
    models = palpate.load_models(["boot", "camera"])
    session = Session(models, usual_sensor(tip_radius=tip_radius, normal_error=None))
    placement = session.placements(session.state)[1]
    middle = placement.world_from_model[:2, 2]
    contact = session.contact_on(placement, (*middle, 500.0), (0.0, 0.0, -1.0))
    distance = placement.model.distance(placement.world_from_model, contact.center)
    assert distance == pytest.approx(tip_radius, abs=1e-9)
    assert contact.normal is None and contact.approach is not None


def test_a_click_on_a_solid_is_its_first_contact(solids):
    placement = solids.placements(solids.state)[0]
    center = placement.model.vertices.mean(axis=0) @ placement.world_from_model[:3, :3].T
    center += placement.world_from_model[:3, 3]
    origin = center + np.array([500.0, 40.0, 30.0])
    contact = solids.contact_on(placement, origin, center - origin)
    met = placement.model.first_contact(placement.world_from_model, origin, center - origin)
    assert np.array_equal(contact.center, met.center)
    with pytest.raises(ValueError, match="passes by"):
        solids.contact_on(placement, origin, origin - center)


def test_a_recorded_run_is_told_move_by_move(tmp_path):
    models = palpate.load_models(["boot", "camera", "telephone"])
    probe = palpate.SimulatedProbe(models[0], pose(1.2, 40.0, -60.0), usual_sensor(), seed=1)
    area = [[-300, -300], [300, 300]]
    result = palpate.identify(models, probe, usual_sensor(), area, log=tmp_path / "run.jsonl")
    session = Session.of_log(tmp_path / "run.jsonl")
    assert len(session.states) == result.touches + 1
    for number, step in enumerate(result.steps):
        state = session.states[number]
        assert len(state.moves) == number and (state.path is None) == (step.path is None)
        if step.path is not None:
            assert state.path == step.path and step.path.members == list(range(len(state.hypotheses)))
    assert list(session.state.contacts) == result.contacts
    assert len(session.state.hypotheses) == len(result.hypotheses)


def volume(mesh):
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c)) / 6)


def test_prisms_are_closed_and_as_large_as_their_parts():
    holed = palpate.Model.polygon(
        [[0, 0], [60, 0], [60, 40], [0, 20]], holes=[[[20, 8], [30, 8], [30, 16], [20, 16]]]
    )
    assert volume(mesh_of(holed, 2.0)) == pytest.approx(2.0 * (1800 - 80))
    for model in palpate.bundled_parts():
        ends = np.array(model.faces)
        area = np.sum(ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 0, 1] * ends[:, 1, 0]) / 2
        assert volume(mesh_of(model, 3.0)) == pytest.approx(3.0 * area)
    assert volume(ball()) == pytest.approx(4 / 3 * math.pi, rel=0.05)
    loose = palpate.Model.segments([[[0, 0], [40, 0]], [[40, 0], [40, 15]]])
    assert len(mesh_of(loose, 1.0).triangles) == 4


def test_marks_are_where_they_say():
    axis = np.array([0.0, 0.6, 0.8])
    rim = cone(axis, 10.0, math.radians(20)).vertices[1:]
    away = rim / np.linalg.norm(rim, axis=1)[:, None]
    assert np.degrees(np.arccos(away @ axis)) == pytest.approx(20.0)
    pieces = dashes(np.zeros(3), np.array([30.0, 0.0, 0.0]), 3.0)
    assert pieces[0, 0, 0] == 0.0 and pieces[-1, 1, 0] < 30.0
    assert np.sum(pieces[:, 1, 0] - pieces[:, 0, 0]) == pytest.approx(18.0)
    assert fan(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), 2.0).vertices[:, 2].tolist() == [2.0] * 4
    assert len(spread(np.random.default_rng(0).normal(size=(50, 3)), 7)) == 7


def named(shapes, beginning):
    return [shape for shape in shapes if shape.name.startswith(beginning)]


def test_places_of_corners_hold_every_pose(session, solids):
    session.recognize()
    shapes = shapes_of(session, session.state, Look(bounds=True))
    for number, one in enumerate(session.state.hypotheses):
        (drawn,) = named(shapes, f"bounds/{number}")
        low, high = drawn.mesh.vertices.min(axis=0), drawn.mesh.vertices.max(axis=0)
        for sample in one.poses.sample(30, seed=5):
            corners = one.model.vertices @ sample[:2, :2].T + sample[:2, 2]
            assert (corners >= low[:2] - 1e-9).all() and (corners <= high[:2] + 1e-9).all()
    solids.recognize()
    one = solids.state.hypotheses[0]
    (drawn,) = named(shapes_of(solids, solids.state, Look(chosen=0, bounds=True)), "bounds/0")
    corners = spread(np.asarray(one.model.vertices), 24)
    for sample in one.poses.sample(30, seed=5):
        places = corners @ sample[:3, :3].T + sample[:3, 3]
        away = np.linalg.norm(places - drawn.poses[:, :3, 3], axis=1)
        assert (away <= drawn.scales + 1e-9).all()


def test_planned_is_dashed_and_travelled_is_solid(session):
    session.recognize()
    session.plan()
    (planned,) = named(shapes_of(session, session.state, Look()), "path/planned")
    assert len(planned.segments) > 5
    assert np.allclose(planned.segments[0, 0, :2], session.state.path.start)
    lanes = named(shapes_of(session, session.state, Look()), "path/lanes")
    assert len(lanes) == sum(bool(one.touches) for one in session.state.path.outcomes)
    session.touch()
    (travelled,) = named(shapes_of(session, session.state, Look()), "moves/0/travelled")
    assert travelled.segments.shape == (1, 2, 3)
    assert np.allclose(travelled.segments[0, 1, :2], session.state.moves[0].stopped)


def test_the_panel_tells_what_the_core_says(session):
    session.recognize()
    session.plan()
    state, path = session.state, session.state.path
    told = words.reasons(session, state)
    for outcome in path.outcomes:
        assert (
            f"{outcome.hypothesis + 1} {session.labels[state.hypotheses[outcome.hypothesis].model_number]}"
            in told
        )
        for touch in outcome.touches:
            assert f"{touch.feature[0]} {touch.feature[1]}: {touch.depth[0]:.4g} to" in told
    session.grow_tree()
    tree = words.tree_words(session, session.state)
    assert tree.count("<li>") == sum(len(node.branches) for node in session.state.tree.nodes)
    assert "sampled poses" in words.range_words(session, session.state, Look(samples=True))


def test_names_are_shown_letter_by_letter():
    odd = palpate.Model.polygon([[0, 0], [60, 0], [60, 25], [0, 40]], name="<b>&amp;")
    session = Session(
        [odd],
        usual_sensor(),
        contacts=[palpate.Contact((30, 0), (0, -1), position_error=0.5, normal_error=0.07)],
    )
    session.recognize()
    assert "&lt;b&gt;&amp;amp;" in words.answer(session, session.state, Look())


class _Recorder:
    """Stands in for a viser server: what is added and removed."""

    def __init__(self):
        self.log = []

    def __getattr__(self, name):
        def call(*arguments, **keywords):
            if name.startswith("add_"):
                self.log.append(("add", arguments[0]))
                node = _Recorder()
                node.remove = lambda: self.log.append(("remove", arguments[0]))
                return node
            return contextless() if name == "atomic" else {}

        return call


def contextless():
    from contextlib import nullcontext

    return nullcontext()


def test_what_stays_is_not_sent_again(session):
    pytest.importorskip("viser")
    server = _Recorder()
    server.scene, server.initial_camera = server, _Recorder()
    scene = Scene(server, dimension=2, size=session.size)
    session.recognize()
    scene.draw(shapes_of(session, session.state, Look()))
    server.log.clear()
    scene.draw(shapes_of(session, session.state, Look()))
    assert server.log == []
    session.plan()
    scene.draw(shapes_of(session, session.state, Look()))
    assert server.log and {name.split("/")[1] for _, name in server.log} == {"path"}


def test_frames_hold_what_is_drawn(session):
    shapes = [
        shape for shape in shapes_of(session, session.state, Look()) if isinstance(shape, Bodies | Strokes)
    ]
    low, high = frame_of(shapes)
    for shape in shapes:
        assert same(shape, shape)
        if isinstance(shape, Strokes):
            points = shape.segments.reshape(-1, 3)
            assert (points >= low - 1e-9).all() and (points <= high + 1e-9).all()


BAD = [
    (["view"], "MODEL: must be given"),
    (["view", "boot", "l-bracket"], "must be all of the plane or all of space"),
    (["view", "boot", "--save", "found.pdf"], "name it .html"),
    (["view", "boot", "--save", "nowhere/found.html"], "make it first"),
    (["view", "boot", "--log", "run.jsonl"], "MODEL: must be given without --log"),
    (["view", "--log", "run.jsonl", "--seed", "1"], "--seed: must be given without --log"),
    (["view", "--log", "run.jsonl"], "there is no file"),
    (["view", "boot", "--truth", "boot"], "--truth boot: must be given with --pose"),
    (["view", "boot", "--stem", "0,0,1,2,100"], "stem: is of space only"),
    (["view", "boot", "--pose", "1,2"], "--pose: must be three numbers"),
    (["view", "boot", "--port", "70000"], "must be a whole number from 0 to 65535"),
    (["view", "boot", "--contacts", "none.csv"], "none.csv"),
    (
        ["view", "boot", "--contacts", "l-bracket"],
        "contacts[0]: is of dimension 3, the models of dimension 2",
    ),
    (
        ["view", "l-bracket", "--contacts", "boot"],
        "contacts[0]: is of dimension 2, the models of dimension 3",
    ),
    (["view", "boot", "--port", "0", "--host", "192.0.2.1"], "host: can't listen at '192.0.2.1'"),
]


@pytest.mark.parametrize(("arguments", "said"), BAD)
def test_bad_input_is_one_line(arguments, said, capsys, tmp_path, monkeypatch):
    pytest.importorskip("viser")
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    complaint = capsys.readouterr().err
    assert said in complaint and complaint.count("\n") == 1


def test_what_machines_are_told_is_as_the_schema_says(capsys, tmp_path):
    pytest.importorskip("viser")
    page = tmp_path / "found.html"
    stem = ["--stem", "0,0,1,2,100"]
    for evidence, expected in ((["--contacts", "l-bracket"], (True, True)), ([], (False, None))):
        arguments = ["view", "l-bracket", *evidence, *stem, "--effort", "10", "--save", str(page), "--json"]
        assert main(arguments) == 0
        document = json.loads(capsys.readouterr().out)
        validate(document, "view-1")
        assert document["page"] == str(page) and page.is_file()
        assert (bool(document["hypothesis_count"]), document["complete"]) == expected


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda models: Session([], usual_sensor()), "models: must be parts"),
        (lambda models: Session(models, "sensor"), "sensor: must be a Sensor"),
        (lambda models: Session(models, usual_sensor()).add_contact((1, 2)), "contact: must be a Contact"),
        (lambda models: Session(models, usual_sensor(), misses=["miss"]), r"misses\[0\]: must be a Miss"),
        (
            lambda models: Session(
                models, usual_sensor(), prior=palpate.Prior(np.eye(4), translation=1.0, rotation=0.1)
            ),
            "prior: is of dimension 3",
        ),
        (lambda models: Session(models, usual_sensor()).recognize(), "contacts"),
        (lambda models: Session(models, usual_sensor(), truth=(models[0], np.ones((3, 3)))), "rigid"),
        (
            lambda models: Session(models, usual_sensor(normal_error=None)).contact_of((0, 0), (0, 1)),
            "normal: the sensor reads none",
        ),
    ],
)
def test_bad_arguments_are_named(call, said):
    with pytest.raises(ValueError, match=said):
        call(palpate.load_models("boot"))


def test_without_viser_one_line_says_what_to_install(capsys, monkeypatch):
    real = builtins.__import__

    def without(name, *arguments, **keywords):
        if name.partition(".")[0] == "viser":
            raise ModuleNotFoundError("No module named 'viser'", name="viser")
        return real(name, *arguments, **keywords)

    def absent(name):
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(builtins, "__import__", without)
    monkeypatch.setattr("palpate.view.opening.import_module", absent)
    assert main(["view", "boot"]) == 2
    assert capsys.readouterr().err == f"palpate: {NO_VISER}\n"
