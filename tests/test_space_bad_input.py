"""Bad input in space, the plane mixed with it, and what works in the plane only: each gets one line."""

import math

import numpy as np
import pytest
from brackets import ARMS, FANS, POSE, SQUARE, bracket, prism, touches
from conftest import usual_sensor

import palpate

NAN = math.nan


# What is known of the plane only.
def hypotheses():
    return palpate.recognize([bracket()], touches()).hypotheses


PLANE_ONLY = [
    lambda: hypotheses()[0].poses.outline((0, 0, 0)),
    lambda: hypotheses()[0].poses.thesis_pose.excursion((0, 0, 0)),
    lambda: palpate.projection_space(hypotheses(), usual_sensor()),
    lambda: palpate.Lines(hypotheses(), usual_sensor()).judge(0, 0),
    lambda: palpate.Lines(hypotheses(), usual_sensor()).scores([0], [0]),
]


@pytest.mark.parametrize("call", PLANE_ONLY)
def test_what_works_in_the_plane_only_says_so(call):
    with pytest.raises(ValueError, match=r"plane|planar|dimension 2") as caught:
        call()
    assert "\n" not in str(caught.value)


def mesh(vertices=None, triangles=None, **rest):
    given = prism(ARMS, FANS, 25)
    vertices, triangles = (
        given[0] if vertices is None else vertices,
        given[1] if triangles is None else triangles,
    )
    return palpate.Model.mesh(vertices, triangles, **rest)


def recognize(models=None, contacts=None, **rest):
    return palpate.recognize(models or [bracket()], contacts or touches(), **rest)


def prior(world_from_model=POSE, **changes):
    return palpate.Prior.on_plane(
        world_from_model, **({"translation": 1, "rotation": 1, "height": 1, "tilt": 1} | changes)
    )


def contact(point=(1, 2, 3), **rest):
    return palpate.Contact(point, position_error=0.5, **rest)


def first_contact(**changes):
    given = {"world_from_model": POSE, "start": (0, 0, 90), "direction": (0, 0, -1), "tip_radius": 1.0}
    return bracket().first_contact(**(given | changes))


def poses():
    return hypotheses()[0].poses


FLAT = palpate.Model.polygon(SQUARE)
MIXED = "don't mix the plane and space"

# (what is called, what is passed, how the message begins, and what else is in it)
BAD = [
    (mesh, {"vertices": [[0, 0], [1, 0], [0, 1]]}, "vertices: must have shape (n, 3), has (3, 2)", MIXED),
    (mesh, {"vertices": "cube"}, "vertices: must be an array of numbers (got 'cube')", "(n, 3)"),
    (mesh, {"vertices": [[0, 0, NAN]] * 12}, "vertices: must be finite", "give finite numbers"),
    (mesh, {"vertices": [[k, 0, 0] for k in range(12)]}, "triangles: ", "area"),
    (mesh, {"triangles": [[0, 1]]}, "triangles: must have shape (m, 3), has (1, 2)", "(m, 3)"),
    (mesh, {"triangles": []}, "triangles: must have shape (m, 3), has (0,)", "(m, 3)"),
    (mesh, {"triangles": [[0, 1, 2], [0, 1, 2.5]]}, "triangles[1]: must be numbers of vertices", "from 0"),
    (mesh, {"triangles": [[0, 1, -2]]}, "triangles[0]: must be numbers of vertices", "from 0"),
    (mesh, {"triangles": [[0, 1, 2**33]]}, "triangles[0]: must be numbers of vertices", "from 0"),
    (mesh, {"triangles": [[0, 1, 12]]}, "triangles: triangle 0 names a vertex", "12"),
    (mesh, {"untouchable": [99]}, "untouchable: ", "99"),
    (mesh, {"untouchable": 3}, "untouchable: must be a sequence of face numbers", "list of int"),
    (mesh, {"name": " "}, "name: must not be empty", "give the part a name"),
    (mesh, {"position_slack": -1}, "position_slack: ", "-1"),
    (mesh, {"normal_slack": 2}, "normal_slack: ", "2"),
    (palpate.Model.facets, {"loops": "cube"}, "loops: must be a sequence of faces", "'cube'"),
    (palpate.Model.facets, {"loops": []}, "loops: has no face", "at least one"),
    (palpate.Model.facets, {"loops": [SQUARE]}, "loops[0]: must have shape (n, 3), has (4, 2)", MIXED),
    (palpate.Model.facets, {"loops": [[SQUARE]]}, "loops[0][0]: must have shape (n, 3), has (4, 2)", MIXED),
    (palpate.Model.facets, {"loops": [[[0, 0, NAN]] * 3]}, "loops[0]", "give"),
    (palpate.Model.facets, {"loops": [5]}, "loops[0]: must be a sequence of loops (got 5)", "(n, 3)"),
    (contact, {"point": (1, 2, 3, 4)}, "point: must have shape (2,) or (3,), has (4,)", "(2,) or (3,)"),
    (contact, {"point": (1, 2, NAN)}, "point: must be finite", "give finite numbers"),
    (contact, {"normal": (0, 1), "normal_error": 0.1}, "normal: must have shape (3,), has (2,)", MIXED),
    (contact, {"normal": (0, 0, 0), "normal_error": 0.1}, "normal: must not be zero", "any length"),
    (contact, {"normal": (0, 0, 1)}, "normal_error: must be given with normal", "radians"),
    (contact, {"approach": (0, 1)}, "approach: must have shape (3,), has (2,)", MIXED),
    (contact, {"approach": (0, 0, 0)}, "approach: must not be zero", "any length"),
    (contact, {"start": (0, 1)}, "start: must have shape (3,), has (2,)", MIXED),
    (contact, {"start": (0, 1, math.inf)}, "start: must be finite", "give finite numbers"),
    (palpate.Miss, {"start": (0, 0, 0), "end": (1, 0)}, "end: must have shape (3,), has (2,)", MIXED),
    (palpate.Miss, {"start": (0, 0, 0), "end": (1, 0, 0), "path_error": -1}, "path_error: ", "-1"),
    (prior, {"world_from_model": np.eye(3)}, "world_from_model: must have shape (4, 4), has (3, 3)", MIXED),
    (prior, {"world_from_model": np.diag([1, 1, -1, 1])}, "world_from_model: must be a rigid motion", "4x4"),
    (prior, {"world_from_model": np.full((4, 4), NAN)}, "world_from_model: must be finite", "finite"),
    (prior, {"height": -1}, "height: must be a finite number, zero or more (got -1)", "length"),
    (prior, {"tilt": 4}, "tilt: must be an angle in radians from 0 to 3.1416 (got 4)", "radians"),
    (prior, {"tilt": "5 deg"}, "tilt: must be a number (got '5 deg')", "int or float"),
    (prior, {"rotation": 4}, "rotation: must be an angle in radians from 0 to 3.1416 (got 4)", "radians"),
    (prior, {"normal": (0, 0, 0)}, "normal: must not be zero", "any length"),
    (prior, {"normal": (0, 1)}, "normal: must have shape (3,), has (2,)", MIXED),
    (recognize, {"models": [bracket(), FLAT]}, "models[1]: \"part\" is of dimension 2, the first of the models, \"bracket\", of dimension 3 (got <Model", MIXED),
    (recognize, {"models": [FLAT]}, "contacts[0]: is of dimension 3, the first of the models of dimension 2 (got Contact(", MIXED),
    (recognize, {"contacts": [contact(), contact((1, 2))]}, "contacts[1]: is of dimension 2", MIXED),
    (recognize, {"misses": [palpate.Miss((0, 0), (1, 0))]}, "misses[0]: is of dimension 2", MIXED),
    (recognize, {"prior": palpate.Prior(np.eye(3), translation=1, rotation=1)}, "prior: is of dimension 2", MIXED),
    (recognize, {"features": ()}, "features: must not be empty", "edge"),
    (recognize, {"features": ("corner",)}, "features: unknown kind (got 'corner')", '"edge"'),
    (recognize, {"features": "edge"}, "features: must be a sequence of names (got 'edge')", '"edge"'),
    (recognize, {"tolerance": 0.5}, "tolerance: is out of range (got 0.5)", "1e-6"),
    (recognize, {"contacts": [contact((0, 0, 1e12))]}, "contacts[0]: is more than", "models' unit"),
    (
        recognize,
        {"contacts": [contact(normal=(0, 0, 1), normal_error=0.1, approach=(0, 0, 1))]},
        "contacts[0]: the normal points along the approach",
        "faulty normal",
    ),
    (lambda pose: poses().contains(pose), {"pose": np.eye(3)}, "world_from_model: must have shape (4, 4), has (3, 3)", MIXED),
    (lambda pose: poses().contains(pose), {"pose": 2 * np.eye(4)}, "world_from_model: must be a rigid motion", "4x4"),
    (lambda point: poses().excursion(point), {"point": (0, 0)}, "point: must have shape (3,), has (2,)", MIXED),
    (lambda n: poses().sample(n), {"n": -1}, "n: must be a whole number, 0 or more (got -1)", "int"),
    (lambda n: poses().sample(n), {"n": 10**12}, "n: is more than ten million", "in parts"),
    (lambda point: bracket().distance(np.eye(4), point), {"point": (0, 0)}, "point: must have shape (3,), has (2,)", MIXED),
    (first_contact, {"world_from_model": np.eye(3)}, "world_from_model: must have shape (4, 4), has (3, 3)", MIXED),
    (first_contact, {"start": (0, 0)}, "start: must have shape (3,), has (2,)", MIXED),
    (first_contact, {"direction": (0, 0, 0)}, "direction: must not be zero", "any length"),
    (first_contact, {"direction": (0, 0, NAN)}, "direction: must be finite", "give finite numbers"),
    (first_contact, {"tip_radius": -1}, "tip_radius: must be a finite number, zero or more (got -1)", "length"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "given", "begins", "holds"), BAD)
def test_bad_input_is_refused_with_one_line(call, given, begins, holds):
    with pytest.raises(ValueError) as caught:
        call(**given)
    message = str(caught.value)
    assert message.startswith(begins) and holds in message and "\n" not in message
    assert "(got " in message and ";" in message
