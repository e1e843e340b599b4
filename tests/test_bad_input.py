"""Bad input from Python, each with the message it gets: the argument, what is wrong, the value and the remedy."""

import math

import numpy as np
import pytest

import palpate

NAN = math.nan
SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]
BOW = [[0, 0], [10, 10], [10, 0], [0, 10]]
EYE = np.eye(3)


def contact(point=(1, 2), normal=None, *, position_error=0.5, **rest):
    return palpate.Contact(point, normal, position_error=position_error, **rest)


def tip(center=(1, 2), tip_radius=1.0, *, position_error=0.5, **rest):
    return palpate.Contact.from_tip(center, tip_radius, position_error=position_error, **rest)


def prior(world_from_model=EYE, *, translation=1.0, rotation=0.1):
    return palpate.Prior(world_from_model, translation=translation, rotation=rotation)


def polygon(vertices=SQUARE, **rest):
    return palpate.Model.polygon(vertices, **rest)


def segments(ends=(((0, 0), (1, 0)),), **rest):
    return palpate.Model.segments(ends, **rest)


def recognize(models=None, contacts=None, **rest):
    models = [polygon(name="plate")] if models is None else models
    return palpate.recognize(models, [contact()] if contacts is None else contacts, **rest)


def poses():
    return recognize().hypotheses[0].poses


# (what is called, what is passed, the whole message)
CASES = [
    # points
    (contact, {"point": 3}, "point: must have shape (2,) or (3,), has () (got 3); give an array of shape (2,) or (3,)"),
    (contact, {"point": "ab"}, "point: must be an array of numbers (got 'ab'); give an array of shape (2,) or (3,)"),
    (contact, {"point": None}, "point: must be an array of numbers (got None); give an array of shape (2,) or (3,)"),
    (contact, {"point": (1, 2, 3, 4)}, "point: must have shape (2,) or (3,), has (4,) (got (1, 2, 3, 4)); give an array of shape (2,) or (3,)"),
    (contact, {"point": [1]}, "point: must have shape (2,) or (3,), has (1,) (got [1]); give an array of shape (2,) or (3,)"),
    (contact, {"point": [[1, 2]]}, "point: must have shape (2,) or (3,), has (1, 2) (got [[1, 2]]); give an array of shape (2,) or (3,)"),
    (contact, {"point": [[1, 2], [3]]}, "point: must be an array of numbers (got [[1, 2], [3]]); give an array of shape (2,) or (3,)"),
    (contact, {"point": (1, 2j)}, "point: must be an array of numbers (got (1, 2j)); give an array of shape (2,) or (3,)"),
    (contact, {"point": (True, False)}, "point: must be an array of numbers (got (True, False)); give an array of shape (2,) or (3,)"),
    (contact, {"point": {1: 2}}, "point: must be an array of numbers (got {1: 2}); give an array of shape (2,) or (3,)"),
    (contact, {"point": (1, NAN)}, "point: must be finite (got (1, nan)); give finite numbers"),
    (contact, {"point": (math.inf, 0)}, "point: must be finite (got (inf, 0)); give finite numbers"),
    (tip, {"center": (1, NAN)}, "center: must be finite (got (1, nan)); give finite numbers"),
    (tip, {"center": (1, 2, 3, 4)}, "center: must have shape (2,) or (3,), has (4,) (got (1, 2, 3, 4)); give an array of shape (2,) or (3,)"),
    # bounds
    (contact, {"position_error": None}, "position_error: must be a number (got None); give a single int or float"),
    (contact, {"position_error": "0.5"}, "position_error: must be a number (got '0.5'); give a single int or float"),
    (contact, {"position_error": [1, 2]}, "position_error: must be a number (got [1, 2]); give a single int or float"),
    (contact, {"position_error": True}, "position_error: must be a number (got True); give a single int or float"),
    (contact, {"position_error": -1}, "position_error: must be a finite number, zero or more (got -1); give the bound as a length"),
    (contact, {"position_error": NAN}, "position_error: must be a finite number, zero or more (got NaN); give the bound as a length"),
    (contact, {"position_error": math.inf}, "position_error: must be a finite number, zero or more (got inf); give the bound as a length"),
    (tip, {"tip_radius": -2}, "tip_radius: must be a finite number, zero or more (got -2); give the bound as a length"),
    (tip, {"tip_radius": "2 mm"}, "tip_radius: must be a number (got '2 mm'); give a single int or float"),
    # normals and directions
    (contact, {"normal": (0, 1)}, "normal_error: must be given with normal (got None); give its bound in radians, or leave normal out"),
    (contact, {"normal_error": 0.1}, "normal: must be given with normal_error (got None); give the outward normal, or leave normal_error out"),
    (contact, {"normal": (0, 0), "normal_error": 0.1}, "normal: must not be zero (got [0, 0]); give a direction, of any length"),
    (contact, {"normal": (NAN, 0), "normal_error": 0.1}, "normal: must be finite (got (nan, 0)); give finite numbers"),
    (contact, {"normal": (0, 0, 1), "normal_error": 0.1}, "normal: must have shape (2,), has (3,) (got (0, 0, 1)); don't mix the plane and space: give an array of shape (2,)"),
    (contact, {"normal": (0, 1), "normal_error": -0.1}, "normal_error: must be an angle in radians from 0 to 1.5708 (got -0.1); give radians, or leave the normal out if nothing is known of it"),
    (contact, {"normal": (0, 1), "normal_error": 4}, "normal_error: must be an angle in radians from 0 to 1.5708 (got 4); give radians, or leave the normal out if nothing is known of it"),
    (contact, {"approach": (0, 0)}, "approach: must not be zero (got [0, 0]); give a direction, of any length"),
    (contact, {"approach": 90}, "approach: must have shape (2,), has () (got 90); give an array of shape (2,)"),
    (contact, {"start": (0, NAN)}, "start: must be finite (got (0, nan)); give finite numbers"),
    # misses
    (palpate.Miss, {"start": (0, 0), "end": (0, 0, 0)}, "end: must have shape (2,), has (3,) (got (0, 0, 0)); don't mix the plane and space: give an array of shape (2,)"),
    (palpate.Miss, {"start": "here", "end": (0, 0)}, "start: must be an array of numbers (got 'here'); give an array of shape (2,) or (3,)"),
    (palpate.Miss, {"start": (0, 0), "end": (1, 0), "tip_radius": -1}, "tip_radius: must be a finite number, zero or more (got -1); give the bound as a length"),
    (palpate.Miss, {"start": (0, 0), "end": (1, 0), "path_error": NAN}, "path_error: must be a finite number, zero or more (got NaN); give the bound as a length"),
    # priors
    (prior, {"world_from_model": np.eye(2)}, "world_from_model: must have shape (3, 3) or (4, 4), has (2, 2) (got array([[1., 0.], [0., 1.]])); give an array of shape (3, 3) or (4, 4)"),
    (prior, {"world_from_model": [[0] * 4] * 4}, "world_from_model: must be a rigid motion, a homogeneous 4x4 matrix (got [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]); give [[R, t], [0, 0, 0, 1]] with a rotation matrix R, its determinant 1"),
    (prior, {"world_from_model": np.diag([1, -1, 1])}, "world_from_model: must be a rigid motion, a homogeneous 3x3 matrix (got [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]); give [[c,-s,x],[s,c,y],[0,0,1]] with c²+s²=1"),
    (prior, {"translation": -1}, "translation: must be a finite number, zero or more (got -1); give the bound as a length"),
    (prior, {"translation": (1, 2)}, "translation: must be a number (got (1, 2)); give a single int or float"),
    (prior, {"rotation": 15}, "rotation: must be an angle in radians from 0 to 3.1416 (got 15); give radians; π leaves the rotation free"),
    # models
    (polygon, {"vertices": "boot"}, "vertices: must be an array of numbers (got 'boot'); give an array of shape (n, 2)"),
    (polygon, {"vertices": [[0, 0, 0]]}, "vertices: must have shape (n, 2), has (1, 3) (got [[0, 0, 0]]); don't mix the plane and space: give an array of shape (n, 2)"),
    (polygon, {"vertices": []}, "vertices: must have shape (n, 2), has (0,) (got []); give an array of shape (n, 2)"),
    (polygon, {"vertices": [[0, 0], [1, NAN], [1, 1]]}, "vertices: must be finite (got [[0, 0], [1, nan], [1, 1]]); give finite numbers"),
    (polygon, {"name": 3}, "name: must be a text (got 3); give a str"),
    (polygon, {"holes": 3}, "holes: must be a sequence of outlines (got 3); give a list of (n, 2) arrays"),
    (polygon, {"holes": SQUARE}, "holes[0]: must have shape (n, 2), has (2,) (got [0, 0]); give an array of shape (n, 2)"),
    (polygon, {"untouchable": 3}, "untouchable: must be a sequence of face numbers (got 3); give a list of int"),
    (polygon, {"untouchable": "top"}, "untouchable: must be a sequence of face numbers (got 'top'); give a list of int"),
    (polygon, {"untouchable": [-1]}, "untouchable[0]: must be a whole number, 0 or more (got -1); give an int in range"),
    (polygon, {"untouchable": [1.5]}, "untouchable[0]: must be a whole number, 0 or more (got 1.5); give an int in range"),
    (polygon, {"position_slack": "fine"}, "position_slack: must be a number (got 'fine'); give a single int or float"),
    (polygon, {"mends": "closed a gap"}, "mends: must be a sequence of texts (got 'closed a gap'); give a list of str"),
    (polygon, {"mends": [1]}, "mends[0]: must be a text (got 1); give a str"),
    (segments, {"ends": SQUARE}, "segments: must have shape (n, 2, 2), has (4, 2) (got [[0, 0], [10, 0], [10, 10], [0, 10]]); give an array of shape (n, 2, 2)"),
    (segments, {"ends": [[[0, 0, 0], [1, 1, 1]]]}, "segments: must have shape (n, 2, 2), has (1, 2, 3) (got [[[0, 0, 0], [1, 1, 1]]]); don't mix the plane and space: give an array of shape (n, 2, 2)"),
    (segments, {"seams": ["a"]}, "seams[0]: must be a whole number, 0 or more (got 'a'); give an int in range"),
    # recognition
    (recognize, {"models": []}, "models: must not be empty (got []); give at least one model"),
    (recognize, {"models": "boot"}, "models: must be a sequence of Model (got 'boot'); give a list, as load_models does"),
    (recognize, {"models": polygon()}, "models: must be a sequence of Model (got <Model \"part\": 4 faces, 4 vertices, size 14.142136>); give a list, as load_models does"),
    (recognize, {"models": ["boot"]}, "models[0]: must be a Model (got 'boot'); give a list, as load_models does"),
    (recognize, {"contacts": []}, "contacts: must not be empty (got []); give at least one contact"),
    (recognize, {"contacts": 5}, "contacts: must be a sequence of Contact (got 5); give a list of palpate.Contact"),
    (recognize, {"contacts": contact()}, "contacts: must be a sequence of Contact (got Contact((1.0, 2.0), position_error=0.5)); give a list of palpate.Contact"),
    (recognize, {"contacts": [contact(), (1, 2)]}, "contacts[1]: must be a Contact (got (1, 2)); give a list of palpate.Contact"),
    (recognize, {"misses": [contact()]}, "misses[0]: must be a Miss (got Contact((1.0, 2.0), position_error=0.5)); give a list of palpate.Miss"),
    (recognize, {"misses": palpate.Miss}, "misses: must be a sequence of Miss (got <class 'palpate._core.Miss'>); give a list of palpate.Miss"),
    (recognize, {"prior": 20}, "prior: must be a Prior (got 20); give palpate.Prior, or leave it out"),
    (recognize, {"features": ()}, "features: must not be empty (got ()); give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"),
    (recognize, {"features": "face"}, "features: must be a sequence of names (got 'face'); give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"),
    (recognize, {"features": ("edge",)}, "features: no edges in the plane (got 'edge'); give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"),
    (recognize, {"features": ("faces",)}, "features: unknown kind (got 'faces'); give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"),
    (recognize, {"features": (0,)}, "features[0]: must be a text (got 0); give a str"),
    (recognize, {"tolerance": 0}, "tolerance: is out of range (got 0); give a share of the part's size from 1e-9 to 0.01, such as 1e-6"),
    (recognize, {"tolerance": "fine"}, "tolerance: must be a number (got 'fine'); give a single int or float"),
    (recognize, {"max_hypotheses": 0}, "max_hypotheses: must be a whole number, 1 or more (got 0); give an int in range"),
    (recognize, {"max_hypotheses": 2.5}, "max_hypotheses: must be a whole number, 1 or more (got 2.5); give an int in range"),
    (lambda pose: poses().contains(pose), {"pose": np.zeros(2)}, "world_from_model: must have shape (3, 3), has (2,) (got array([0., 0.])); give an array of shape (3, 3)"),
    (lambda n: poses().sample(n), {"n": -1}, "n: must be a whole number, 0 or more (got -1); give an int in range"),
    (lambda n: poses().sample(n), {"n": 10**12}, "n: is more than ten million (got 1000000000000); sample in parts, each with its own seed"),
    (lambda n: poses().sample(n), {"n": 10**30}, "n: must be a whole number, 0 or more (got 1000000000000000000000000000000); give an int in range"),
    (lambda seed: poses().sample(2, seed), {"seed": "x"}, "seed: must be a whole number, 0 or more (got 'x'); give an int in range"),
    (lambda point: poses().excursion(point), {"point": (0, NAN)}, "point: must be finite (got (0, nan)); give finite numbers"),
    (lambda point: poses().outline(point), {"point": (0, 0, 0)}, "point: must have shape (2,), has (3,) (got (0, 0, 0)); don't mix the plane and space: give an array of shape (2,)"),
]  # fmt: skip

# What the core says of outlines; tests of the core own the wording, so that only its parts are compared here.
REFUSED_BY_THE_CORE = [
    (polygon, {"vertices": [[0, 0], [1, 1]]}, ["vertices: ", "three", "got 2", ";"]),
    (polygon, {"vertices": [[0, 0], [1, 1], [2, 2]]}, ["vertices: ", "got ", ";"]),
    (polygon, {"vertices": [[4, 4]] * 5}, ["vertices: ", "got ", ";"]),
    (polygon, {"vertices": BOW}, ["vertices: ", "crosses", "got ", ";"]),
    (polygon, {"holes": [[[20, 20], [21, 20], [20, 21]]]}, ["holes[0]: ", "got ", ";"]),
    (polygon, {"holes": [[[5, 5], [15, 5], [5, 6]]]}, ["holes[0]", "got ", ";"]),
    (polygon, {"untouchable": [4]}, ["untouchable: ", "got 4", ";"]),
    (polygon, {"position_slack": -1}, ["position_slack: ", "got -1", ";"]),
    (polygon, {"normal_slack": 5}, ["normal_slack: ", "got 5", ";"]),
    (polygon, {"name": ""}, ["name: ", "got ", ";"]),
    (
        recognize,
        {"contacts": [contact(normal=(0, 1), normal_error=0.1, approach=(0, 1))]},
        ["contacts[0]: ", "normal", "approach", "got ", ";"],
    ),
    (segments, {"ends": np.zeros((0, 2, 2))}, ["segments: ", "got ", ";"]),
    (segments, {"seams": [0]}, ["segments: ", "got ", ";"]),
    (segments, {"seams": [1]}, ["seams: ", "got 1", ";"]),
]


def message_of(call, arguments):
    with pytest.raises(ValueError) as caught:
        call(**arguments)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize(("call", "arguments", "message"), CASES)
def test_bad_input_is_named_with_its_value_and_the_remedy(call, arguments, message):
    assert message_of(call, arguments) == message


@pytest.mark.parametrize(("call", "arguments", "parts"), REFUSED_BY_THE_CORE)
def test_bad_outlines_are_named_with_the_place_and_the_remedy(call, arguments, parts):
    message = message_of(call, arguments)
    assert [part for part in parts if part not in message] == [], message


def test_the_table_is_long_enough():
    assert len(CASES) + len(REFUSED_BY_THE_CORE) >= 40


def test_long_values_are_cut():
    message = message_of(polygon, {"vertices": np.zeros((1000, 3))})
    assert len(message) < 250 and "…" in message


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: palpate.Contact((0, 0)), "position_error"),
        (lambda: palpate.Prior(EYE, translation=1), "rotation"),
        (lambda: palpate.Contact.from_tip((0, 0), position_error=1), "tip_radius"),
        (lambda: palpate.Model(SQUARE), "Model.polygon"),
        (lambda: contact(radius=1), "unexpected keyword argument 'radius'$"),
        (
            lambda: contact(tip_radius=1),
            r"'tip_radius'; give the tip to Contact\.from_tip\(center, tip_radius",
        ),
    ],
)
def test_missing_and_unknown_arguments_are_named(call, name):
    with pytest.raises(TypeError, match=name):
        call()
