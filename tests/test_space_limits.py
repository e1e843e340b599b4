"""Searches in space that end, by time, effort or number of hypotheses; bounds where contacts say little."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

import palpate

trimesh = pytest.importorskip("trimesh", reason="trimesh is in the extra palpate[test]")

POSE = trimesh.transformations.euler_matrix(0.5, -1.1, 2.3)
POSE[:3, 3] = (100, 50, 20)


def sphere(divisions, *, bumps=0.0):
    """Of radius 40; with bumps, nothing about it is symmetric to more than half a turn."""
    mesh = trimesh.creation.icosphere(divisions, 40)
    x, y = mesh.vertices[:, [0]], mesh.vertices[:, [1]]
    mesh.vertices *= 1 + bumps * np.sin(x / 5) + bumps * np.cos(y / 7)
    return mesh


def torus():
    return trimesh.creation.torus(60, 20, major_sections=100, minor_sections=100)


def touched(mesh, *, tip_radius=0.0, normals=True, count=6):
    """Contacts at random places of the mesh at `POSE`, ±0.5 and 4 degrees."""
    points, faces = trimesh.sample.sample_surface(mesh, count, seed=4)
    contacts = []
    for point, face in zip(points, faces, strict=True):
        normal = POSE[:3, :3] @ mesh.face_normals[face]
        center = POSE[:3, :3] @ point + POSE[:3, 3] + (tip_radius + 0.2) * normal
        sensed = {"normal": normal, "normal_error": math.radians(4)} if normals else {"approach": -normal}
        contacts.append(palpate.Contact.from_tip(center, tip_radius, position_error=0.5, **sensed))
    return contacts


def part(mesh, **slacks):
    return palpate.Model.mesh(mesh.vertices, mesh.faces, name="part", **slacks)


LONG = {
    "ball_1280": lambda: (sphere(3, bumps=0.05), {"tip_radius": 2.0}, {}),
    "ball_without_normals": lambda: (sphere(4, bumps=0.05), {"tip_radius": 2.0, "normals": False}, {}),
    "torus": lambda: (torus(), {}, {}),
    "slack": lambda: (sphere(3), {}, {"position_slack": 0.3, "normal_slack": math.radians(5)}),
    "faces_20480": lambda: (sphere(5), {}, {}),
    "ball_20480": lambda: (sphere(5, bumps=0.05), {"tip_radius": 2.0}, {}),
}


@pytest.mark.parametrize("kind", LONG)
def test_a_limit_of_time_is_kept_on_parts_of_thousands_of_faces(kind):
    mesh, how, slacks = LONG[kind]()
    model, contacts = part(mesh, **slacks), touched(mesh, **how)
    limit = 2.0
    begun = time.monotonic()
    found = palpate.recognize([model], contacts, time_limit=limit)
    assert time.monotonic() - begun < 3 * limit
    assert (found.stopped_by, found.complete) == ("time", False)
    assert any(one.poses.contains(POSE) for one in found.hypotheses)
    # What is asked afterwards takes no search either.
    begun = time.monotonic()
    assert found.interpretation_count_exact is False
    for one in found.hypotheses:
        assert one.world_from_model.shape == (4, 4) and 0.0 <= one.poses.rotation_bound <= math.pi
        assert 0.0 <= one.poses.excursion(model.vertices[0]) < 4 * model.size
        assert one.proved or (one.interpretation_count, list(one.interpretations)) == (0, [])
    assert time.monotonic() - begun < 3 * limit


def test_a_part_of_twenty_thousand_triangles_is_found():
    """Features of two contacts are found by the angle between them, none is left out."""
    mesh = torus()
    found = palpate.recognize([part(mesh)], touched(mesh))
    (only,) = found.hypotheses
    assert found.complete and only.proved and only.poses.contains(POSE)


def test_the_limit_that_ended_a_search_is_named():
    solids = palpate.load_models("l-bracket")
    touches = palpate.standard_contacts("l-bracket")
    assert palpate.recognize(solids, touches).stopped_by is None
    few = palpate.recognize(solids, touches[:3], max_hypotheses=1)
    assert (few.stopped_by, few.complete, len(few.hypotheses)) == ("hypotheses", False, 1)
    assert all(one.proved for one in few.hypotheses) and "of more" in repr(few)
    centers = [contact.center + 2.0 * contact.normal for contact in touches]
    balls = [palpate.Contact.from_tip(center, 2.0, position_error=0.5) for center in centers]
    spent = palpate.recognize(solids, balls, effort=50)
    assert (spent.stopped_by, spent.complete) == ("effort", False)
    assert not spent.hypotheses[-1].proved and "stopped by effort" in repr(spent)
    late = palpate.recognize(solids, balls, time_limit=0.001)
    assert (late.stopped_by, late.complete) == ("time", False) and "stopped by time" in repr(late)


@pytest.mark.parametrize("tip_radius", [0.0, 2.0])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_no_point_leaves_its_contact_by_more_than_the_part_is_large(count, tip_radius):
    (bracket,) = palpate.load_models("l-bracket")
    mesh = trimesh.Trimesh(bracket.vertices, bracket.triangles, process=False)
    contacts = touched(mesh, tip_radius=tip_radius, normals=False, count=count)
    (found,) = palpate.recognize([bracket], contacts, effort=2000).hypotheses
    samples = found.poses.sample(200, seed=1)
    for corner in bracket.vertices:
        bound = found.poses.excursion(corner)
        # Every pose has the tip on the part: no point is farther from it than the part is large.
        assert bound <= 2 * (bracket.size + 0.5 + tip_radius) * (1 + 1e-5)
        places = samples[:, :3, :3] @ corner + samples[:, :3, 3]
        assert np.linalg.norm(places[:, None] - places[None], axis=-1).max() <= bound


def test_an_interpretation_that_holds_without_the_tolerance_is_not_marginal():
    balls = [
        ((261.34, 105.8, 6), (0.1, -1, 0)),
        ((233.53, 102.38, 6.01), (0.1, -1, 0)),
        ((295.25, 67.65, 6.02), (-1, -0.1, 0)),
        ((275.46, -9.32, 91.99), (0, 0, -1)),
        ((276.46, -17.27, 60), (-0.1, 1, 0)),
        ((265.93, 43.91, 14.01), (0, 0, -1)),
    ]
    contacts = [
        palpate.Contact.from_tip(center, 2.0, position_error=0.05, approach=way) for center, way in balls
    ]
    near = [[0, -1, 0, 300], [1, 0, 0, -10], [0, 0, 1, 0], [0, 0, 0, 1]]
    bounds = {"translation": 15.0, "rotation": math.radians(15), "height": 0.5, "tilt": math.radians(1)}
    solids = palpate.load_models("l-bracket")
    (found,) = palpate.recognize(solids, contacts, prior=palpate.Prior.on_plane(near, **bounds)).hypotheses
    one = next(iter(found.interpretations))
    assert not found.marginal and not one.marginal
    # The pose that is said to prove it does, within rounding, on faces named.
    pose = one.world_from_model
    for contact, (kind, number) in zip(contacts, one.assignment, strict=True):
        corners = found.model.faces[number]
        normal = found.model.face_normals[number]
        place = np.linalg.inv(pose) @ [*contact.center, 1.0]
        assert kind == "face"
        assert abs(normal @ (place[:3] - corners[0]) - 2.0) <= 0.05 + 1e-9
