"""Recognition in space from Python: shapes, known poses, symmetries, the same bits however many threads."""

import copy
import hashlib
import math
import os
import pickle
import signal
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from brackets import ARMS, FANS, POINTS, POSE, SQUARE, bracket, cube, prism, touches, turned
from conftest import usual_sensor

import palpate


def copies_of(thing):
    return [pickle.loads(pickle.dumps(thing)), copy.copy(thing), copy.deepcopy(thing)]


def face_of(model, normal, point):
    """The number of the face with this normal through this point."""
    planes = zip(model.face_normals, model.faces, strict=True)
    fits = [np.allclose(n, normal) and abs(n @ (np.array(point) - face[0])) < 1e-9 for n, face in planes]
    (number,) = np.flatnonzero(fits)
    return number


def test_a_mesh_has_faces_edges_and_vertices():
    model = bracket(untouchable=range(4), position_slack=0.25, normal_slack=0.125)
    assert (model.name, model.dimension, model.closed, model.mends) == ("bracket", 3, True, [])
    assert Counter(len(face) for face in model.faces) == {6: 2, 4: 6}
    assert len(model.edges) == 18 and {edge.shape for edge in model.edges} == {(2, 3)}
    assert sorted(map(tuple, model.vertices)) == sorted(map(tuple, prism(ARMS, FANS, 25)[0]))
    assert model.face_normals.shape == (8, 3)
    for normal, face in zip(model.face_normals, model.faces, strict=True):
        # Counter-clockwise from outside: Newell's normal is the outward one, and a solid's areas balance.
        newell = sum(np.cross(a, b) for a, b in zip(face, np.roll(face, -1, axis=0), strict=True))
        assert np.allclose(newell / np.linalg.norm(newell), normal)
    assert model.size == pytest.approx(math.hypot(60, 40, 25))
    assert (model.position_slack, model.normal_slack) == (0.25, 0.125)
    assert np.array_equal(model.symmetries, [np.eye(4)]) and model.symmetry_axes == []
    bottom = face_of(model, (0, 0, -1), (0, 0, 0))
    assert [k for k, one in enumerate(model.face_surfaces) if one == "untouchable"] == [bottom]
    # Edges at the untouchable bottom can't be touched, nor the one in the corner of the arms.
    assert model.touchable_edges.sum() == 18 - 6 - 1
    assert model.touchable_vertices.sum() == 5
    assert repr(model) == '<Model "bracket": 8 faces, 18 edges, 12 vertices, size 76.321688>'


def test_triangles_cover_the_faces():
    model = bracket()
    corners = model.vertices[model.triangles]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    assert np.sum(np.linalg.norm(crosses, axis=1)) == pytest.approx(2 * (60 * 15 + 25 * 15) + 25 * 200)
    normals = crosses / np.linalg.norm(crosses, axis=1)[:, None]
    assert np.allclose(normals, model.face_normals[model.triangle_faces])
    planar = palpate.Model.polygon(SQUARE)
    assert planar.triangles.shape == (0, 3) and planar.triangle_faces.shape == (0,)


def test_a_cube_has_the_turns_of_a_cube():
    model = cube()
    assert model.symmetries.shape == (24, 4, 4)
    for motion in model.symmetries:
        moved = model.vertices @ motion[:3, :3].T + motion[:3, 3]
        assert sorted(map(tuple, moved.round(6) + 0.0)) == sorted(map(tuple, model.vertices))


def test_a_fine_cylinder_is_round():
    steps = np.linspace(0, 2 * math.pi, 32, endpoint=False)
    outline = np.c_[20 * np.cos(steps), 20 * np.sin(steps)]
    fans = [(0, k, k + 1) for k in range(1, 31)]
    half = math.pi / 32
    slacks = {"position_slack": 20 * (1 - math.cos(half)), "normal_slack": half}
    model = palpate.Model.mesh(*prism(outline, fans, 50), name="pin", **slacks)
    ((point, direction),) = model.symmetry_axes
    assert np.allclose(point[:2], 0) and np.allclose(np.abs(direction), (0, 0, 1))


def test_facets_need_not_close():
    floor = [[0, 0, 0], [90, 0, 0], [90, 50, 0], [0, 50, 0]]
    hole = [[10, 10, 0], [10, 20, 0], [20, 20, 0], [20, 10, 0]]
    wall = [[0, 50, 0], [90, 50, 0], [90, 50, 70], [0, 50, 70]]
    model = palpate.Model.facets([[floor, hole], wall], name="corner", untouchable=[1])
    assert (len(model.faces), model.closed, model.dimension) == (2, False, 3)
    assert [[len(one) for one in loops] for loops in model.face_loops] == [[4, 4], [4]]
    assert model.face_surfaces == ["touchable", "untouchable"]
    assert palpate.Model.facets(np.array([floor, wall])) == palpate.Model.facets([[floor], [wall]])
    assert palpate.Model.facets([floor, wall], seams=[1]).face_surfaces == ["touchable", "seam"]
    for twin in copies_of(model):
        assert twin == model and hash(twin) == hash(model)


def test_mends_are_told():
    vertices, triangles = prism(ARMS, FANS, 25)
    model = palpate.Model.mesh(vertices, triangles[:, ::-1], mends=["a unit was guessed"])
    assert model.mends[0] == "a unit was guessed" and len(model.mends) > 1
    assert model == palpate.Model.mesh(vertices, triangles[:, ::-1], mends=["a unit was guessed"])
    assert sorted(map(tuple, model.face_normals)) == sorted(map(tuple, bracket().face_normals))


def test_models_are_equal_by_their_numbers_and_can_be_pickled():
    model = bracket(untouchable=[3], position_slack=0.1, mends=["a unit was guessed"])
    for twin in copies_of(model):
        assert twin == model and hash(twin) == hash(model)
        assert twin.mends == model.mends and twin.face_surfaces == model.face_surfaces
    assert model != bracket() and bracket() != cube() and bracket() == bracket()
    flat = palpate.Model.polygon(SQUARE, name="cube")
    assert flat != cube() and cube() != flat


def test_distance_in_space():
    model = bracket()
    there = POSE[:3, :3] @ (30, 8, 32) + POSE[:3, 3]
    assert model.distance(POSE, there) == pytest.approx(7)
    assert model.distance(np.eye(4), (5, 7, 12)) == pytest.approx(-5)


def test_first_contact_in_space():
    part, there = cube(), turned(0, 0, 0, (0, 100, 0))
    met = part.first_contact(there, (-4, 115, 90), (0, 0, -2), 5.0)
    assert (met.depth, met.feature[0], met.touchable) == (pytest.approx(57.0), "edge", True)
    assert np.allclose(met.center, (-4, 115, 33)) and np.allclose(met.normal, (-0.8, 0, 0.6))
    assert np.allclose(part.edges[met.feature[1]], [[0, 0, 30], [0, 30, 30]]) or np.allclose(
        part.edges[met.feature[1]], [[0, 30, 30], [0, 0, 30]]
    )
    assert met == part.first_contact(there, (-4, 115, 90), (0, 0, -2), tip_radius=5.0)
    assert part.first_contact(there, (-4, 115, 90), (0, 0, -2)) is None
    assert part.first_contact(there, (-4, 115, 90), (0, 0, 1), 5.0) is None
    assert repr(met) == f"<FirstContact: edge {met.feature[1]} at depth 57.000000>"
    # Where the face ends, the ball rests on it; a point meets it there.
    for radius in (0.0, 5.0):
        met = part.first_contact(there, (0, 115, 90), (0, 0, -1), radius)
        assert (met.depth, met.feature) == (60 - radius, ("face", face_of(part, (0, 0, 1), (0, 0, 30))))
    with pytest.raises(ValueError, match="read-only"):
        met.normal[0] = 1.0


@pytest.mark.parametrize("name", palpate.solid_part_names())
def test_points_meet_what_trimesh_says(name):
    trimesh = pytest.importorskip("trimesh", reason="trimesh is in the extra palpate[test]")
    pytest.importorskip("rtree", reason="trimesh casts rays with rtree")
    (model,) = palpate.load_models([name])
    mesh = trimesh.Trimesh(model.vertices, model.triangles, process=False)
    random = np.random.default_rng(4)
    starts = 1.3 * model.size * unit(random.normal(size=(500, 3))) + mesh.bounds.mean(axis=0)
    directions = unit(random.uniform(*mesh.bounds, size=(500, 3)) - starts)
    places, rays, triangles = mesh.ray.intersects_location(starts, directions)
    depths = np.full(500, math.inf)
    np.minimum.at(depths, rays, np.einsum("ni,ni->n", places - starts[rays], directions[rays]))
    num_met = 0
    for k, (start, direction) in enumerate(zip(starts, directions, strict=True)):
        world = POSE[:3, :3] @ start + POSE[:3, 3], POSE[:3, :3] @ direction
        met = model.first_contact(POSE, *world)
        assert (met is None) == math.isinf(depths[k])
        if met is None:
            continue
        num_met += 1
        assert met.depth == pytest.approx(depths[k], abs=1e-6)
        of_ray = rays == k
        nearest = triangles[of_ray][np.argmin(np.linalg.norm(places[of_ray] - start, axis=1))]
        assert met.feature == ("face", model.triangle_faces[nearest]) and met.touchable
        assert np.allclose(met.normal, POSE[:3, :3] @ mesh.face_normals[nearest], atol=1e-6)
    assert num_met > 200


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def test_contacts_and_misses_of_space():
    contact = palpate.Contact.from_tip(
        (1, 2, 3),
        1.5,
        position_error=0.02,
        approach=(0, 0, -2),
        normal=(0, 3, 4),
        normal_error=0.1,
        start=(1, 2, 9),
    )
    assert np.array_equal(contact.center, (1, 2, 3)) and np.allclose(contact.normal, (0, 0.6, 0.8))
    assert np.array_equal(contact.approach, (0, 0, -1)) and np.array_equal(contact.start, (1, 2, 9))
    assert (contact.tip_radius, contact.position_error, contact.normal_error) == (1.5, 0.02, 0.1)
    shown = repr(contact)
    assert shown.startswith("Contact.from_tip((1.0, 2.0, 3.0), 1.5, position_error=0.02, normal=(0.0, 0.6")
    miss = palpate.Miss((0, 0, 1), (0, 5, 1), tip_radius=2, path_error=0.5)
    assert np.array_equal(miss.end, (0, 5, 1))
    assert repr(miss) == "Miss((0.0, 0.0, 1.0), (0.0, 5.0, 1.0), tip_radius=2.0, path_error=0.5)"
    for thing in (contact, miss):
        assert copies_of(thing) == [thing] * 3
    assert miss != palpate.Miss((0, 0), (0, 5), tip_radius=2, path_error=0.5)


def test_priors_of_space():
    prior = palpate.Prior(POSE, translation=2, rotation=0.3)
    assert np.allclose(prior.world_from_model, POSE, atol=1e-15)
    assert (prior.translation, prior.rotation, prior.height, prior.tilt, prior.normal) == (
        2,
        0.3,
        None,
        None,
        None,
    )
    table = palpate.Prior.on_plane(
        POSE, translation=20, rotation=math.pi, height=1, tilt=0.05, normal=(0, 0, 2)
    )
    assert (table.translation, table.rotation, table.height, table.tilt) == (20, math.pi, 1, 0.05)
    assert np.array_equal(table.normal, (0, 0, 1))
    assert (
        table == palpate.Prior.on_plane(POSE, translation=20, rotation=math.pi, height=1, tilt=0.05) != prior
    )
    flat = palpate.Prior(np.eye(3), translation=2, rotation=0.3)
    assert (flat.height, flat.tilt, flat.normal) == (None, None, None) and flat != prior
    assert "on_plane" in repr(table) and "on_plane" not in repr(prior)
    for thing in (prior, table, flat):
        assert copies_of(thing) == [thing] * 3


def test_a_known_pose_is_recognized():
    model = bracket()
    found = palpate.recognize([cube(), model], touches())
    assert found.complete and found.conflict is None and len(found.counters) == 2
    (right,) = [one for one in found.hypotheses if one.poses.contains(POSE)]
    assert right.model is model and right.model_number == 1 and not right.marginal
    truth = [("face", face_of(model, normal, point)) for point, normal in POINTS]
    assert truth in [one.assignment for one in right.interpretations]
    assert found.interpretation_count == len(list(found.interpretations))
    poses = right.poses
    samples = poses.sample(20, seed=3)
    assert samples.shape == (20, 4, 4) and poses.sample(0).shape == (0, 4, 4)
    assert np.array_equal(samples, poses.sample(20, 3)) and not np.array_equal(samples, poses.sample(20, 4))
    assert len(np.unique(samples.round(9), axis=0)) > 10
    for pose in [*samples, poses.witness, right.world_from_model]:
        assert poses.contains(pose)
    turn, shift = poses.rotation_bound, poses.excursion((60, 15, 25))
    for a in samples:
        for b in samples:
            cosine = (np.trace(a[:3, :3].T @ b[:3, :3]) - 1) / 2
            assert math.acos(np.clip(cosine, -1, 1)) <= turn + 1e-7
            moved = (a - b) @ (60, 15, 25, 1)
            assert np.linalg.norm(moved) <= shift + 1e-9
    assert not poses.contains(turned(0.4, -0.9, 2.1, (113, -40, 70)))
    assert not poses.contains(turned(0.4, -0.9, 2.4, (110, -40, 70)))
    assert turn < 0.3 and poses.excursion((0, 0, 0)) < 20
    assert repr(right).startswith('<Hypothesis: "bracket" at (') and "rotations within" in repr(poses)


def test_an_interpretation_has_its_own_poses():
    found = palpate.recognize([bracket()], touches(POINTS[:4]))
    for one in found.interpretations[:3]:
        assert one.poses.contains(one.world_from_model) and one.poses.sample(2).shape == (2, 4, 4)
        assert one.poses.rotation_bound <= math.pi
        assert repr(one).startswith('<Interpretation: "bracket" on face')
        assert found.hypotheses[0].model is one.model and one.model_number == 0


def test_the_truth_is_valid_up_to_symmetry():
    points = [((10, 12, 30), (0, 0, 1)), ((30, 14, 8), (1, 0, 0)), ((9, 0, 17), (0, -1, 0))]
    model = cube()
    found = palpate.recognize([model], touches(points))
    for motion in model.symmetries:
        assert any(one.poses.contains(POSE @ motion) for one in found.hypotheses)


def test_a_tip_may_rest_on_edges_and_vertices():
    model = cube()
    s = math.sqrt(0.5)
    faces = [((10, 12, 30), (0, 0, 1)), ((9, 0, 17), (0, -1, 0))]
    edge = np.array([30, 14, 30]) + 2 * np.array([s, 0, s])
    contacts = [
        palpate.Contact.from_tip(
            np.add(point, np.multiply(2, normal)), 2, position_error=0.1, normal=normal, normal_error=0.05
        )
        for point, normal in faces
    ]
    contacts.append(
        palpate.Contact.from_tip(edge, 2, position_error=0.1, normal=(s, 0, s), normal_error=0.05)
    )

    def kinds(**rest):
        found = palpate.recognize([model], contacts, **rest)
        assert found.hypotheses == [] or any(one.poses.contains(np.eye(4)) for one in found.hypotheses)
        return {kind for one in found.interpretations for kind, _ in one.assignment}

    assert kinds() == kinds(features=("face", "edge", "vertex")) == {"face", "edge"}
    assert kinds(features=["edge", "face"]) == {"face", "edge"}
    assert kinds(features=("face",)) == set()
    assert palpate.recognize([model], contacts, features=("face",)).conflict == [0, 2]


def test_misses_and_priors_are_obeyed():
    model = bracket()
    some = touches(POINTS[:2] + POINTS[3:4])
    inside = POSE[:3, :3] @ (30, 8, 12) + POSE[:3, 3]
    found = palpate.recognize([model], some)
    assert any(one.poses.contains(POSE) for one in found.hypotheses)
    near = palpate.recognize([model], some, prior=palpate.Prior(POSE, translation=3, rotation=0.2))
    assert any(one.poses.contains(POSE) for one in near.hypotheses)
    for pose in [pose for one in near.hypotheses for pose in one.poses.sample(10)]:
        assert np.all(np.abs(pose[:3, 3] - POSE[:3, 3]) <= 3 + 1e-3)
    through = palpate.Miss(inside, inside + 1)
    narrow = palpate.Prior(POSE, translation=3, rotation=0.2)
    missed = palpate.recognize([model], touches(), misses=[through], prior=narrow)
    assert not any(one.poses.contains(POSE) for one in missed.hypotheses)
    table = palpate.Prior.on_plane(np.eye(4), translation=10, rotation=0.5, height=1, tilt=0.02)
    lying = palpate.recognize([model], touches(POINTS[:4], np.eye(4)), prior=table)
    assert any(one.poses.contains(np.eye(4)) for one in lying.hypotheses)
    for pose in [pose for one in lying.hypotheses for pose in one.poses.sample(10)]:
        assert abs(pose[2, 3]) <= 1 + 1e-3 and math.acos(min(pose[2, 2], 1)) <= 0.02 + 1e-3


def test_contacts_that_no_pose_explains_are_in_conflict():
    contacts = touches([((0, 0, 0), (0, 0, 1)), ((0, 0, 400), (0, 0, -1))], np.eye(4))
    found = palpate.recognize([bracket()], contacts)
    assert found.hypotheses == [] and found.conflict == [0, 1] and not found.interpretations
    assert "conflict" in repr(found)


def test_a_path_of_the_plane_takes_no_contact_of_space(wedge):
    contacts = [palpate.Contact((30, 0), (0, -1), position_error=0.5, normal_error=0.07)]
    found = palpate.recognize([wedge], contacts).hypotheses[:2]
    path = palpate.judge(found, usual_sensor(), (30, -50), (0, 1))
    with pytest.raises(ValueError, match="contact: is of space; the path is of the plane"):
        path.outcome_of(touches()[0])


def test_damaged_pickles_are_refused():
    maker, state = bracket().__reduce__()
    for broken in (("cube", *state[1:]), (state[0], [[[0.0, 1.0]]], *state[2:]), (state[0], [], *state[2:])):
        with pytest.raises(ValueError):
            maker(*broken)
    maker, state = touches()[0].__reduce__()
    with pytest.raises(ValueError, match="damaged"):
        maker([1.0], *state[1:])
    with pytest.raises(ValueError, match="damaged"):
        maker([1.0, 2.0], *state[1:])  # a normal of three numbers
    maker, state = palpate.Prior(POSE, translation=1, rotation=1).__reduce__()
    with pytest.raises(ValueError, match="damaged"):
        maker(state[0][1:], *state[1:])


def fingerprint():
    """Of all that is told of a problem that has several hypotheses."""
    digest = hashlib.sha256()
    found = palpate.recognize([bracket(), cube()], touches(POINTS[:4]))
    digest.update(repr([found.complete, found.interpretation_count, found.counters]).encode())
    for one in found.hypotheses:
        poses = one.poses
        for array in (poses.witness, one.world_from_model, poses.sample(5, seed=1)):
            digest.update(np.ascontiguousarray(array).tobytes())
        digest.update(repr([poses.rotation_bound, poses.excursion((1, 2, 3))]).encode())
        digest.update(repr([each.assignment for each in one.interpretations]).encode())
    return len(found.hypotheses), digest.hexdigest()


def test_the_same_bits_with_one_thread_and_with_two():
    def told(threads):
        environment = {**os.environ, "RAYON_NUM_THREADS": threads, "PYTHONPATH": str(Path(__file__).parent)}
        script = "from test_space_bindings import fingerprint; print(fingerprint())"
        run = [sys.executable, "-c", script]
        return subprocess.run(run, env=environment, capture_output=True, text=True, check=True).stdout

    assert {told("1"), told("2")} == {f"{fingerprint()}\n"}
    assert fingerprint()[0] > 0


def test_recognition_runs_beside_other_threads():
    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(lambda _: fingerprint(), range(8)))
    assert set(answers) == {fingerprint()}


class Alarm(Exception):
    """What the handler of a signal raises."""


def test_a_signal_ends_a_long_recognition():
    def ring(*_):
        raise Alarm

    blind = [palpate.Contact(one.center, position_error=3.0) for one in touches()]
    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        started = time.monotonic()
        with pytest.raises(Alarm):
            palpate.recognize([bracket()], blind, features=("face", "edge", "vertex"))
        assert time.monotonic() - started < 20
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_the_thesis_has_a_pose_in_space():
    poses = palpate.recognize([bracket()], touches()).hypotheses[0].poses
    thesis = poses.thesis_pose
    nominal = thesis.world_from_model
    assert nominal.shape == (4, 4) and poses.contains(nominal)
    np.testing.assert_array_equal(nominal[:3, :3], thesis.rotation)
    np.testing.assert_array_equal(nominal[:3, 3], thesis.translation)
    np.testing.assert_allclose(thesis.first_rotation, POSE[:3, :3], atol=1e-9)
    assert poses.rotation_bound < thesis.residual_rotation < 0.3
    assert 0 < thesis.rotation_error < 0.5 * thesis.residual_rotation
    # Corners of the translations: three faces at right angles, a cube.
    away = np.linalg.norm(thesis.translation_region - thesis.translation, axis=1)
    np.testing.assert_allclose(away, thesis.translation_error, atol=1e-6)
    assert repr(thesis).startswith("<ThesisPose rotation ")


def test_a_single_contact_has_no_thesis_pose():
    hypotheses = palpate.recognize([bracket()], touches()[:1]).hypotheses
    assert all(one.poses.thesis_pose is None for one in hypotheses)


def test_a_limit_of_time_or_effort_loses_nothing():
    part = cube()
    faces = [((10, 12, 30), (0, 0, 1)), ((9, 0, 17), (0, -1, 0)), ((0, 20, 21), (-1, 0, 0))]
    contacts = [
        palpate.Contact.from_tip(
            np.add(point, np.multiply(3, normal)), 3, position_error=2, normal=normal, normal_error=0.2
        )
        for point, normal in faces
    ]
    for limit in ({"time_limit": 1e-4}, {"effort": 1}, {}):
        found = palpate.recognize([part], contacts, **limit)
        assert any(one.poses.contains(np.eye(4)) for one in found.hypotheses)
        assert all(one.proved for one in found.hypotheses) or not found.complete
        for one in found.hypotheses:
            assert one.interpretation_count >= one.proved
            assert not one.proved or one.poses.contains(one.world_from_model)
            for interpretation in list(one.interpretations)[:3]:
                assert interpretation.world_from_model.shape == (4, 4)
    for bad in ({"time_limit": 0.0}, {"time_limit": math.nan}, {"effort": 0}, {"effort": 1.5}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            palpate.recognize([part], contacts, **bad)
