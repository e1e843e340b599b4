"""Every name of the compiled core, called with something other than its defaults, and what it returns."""

import ast
import copy
import inspect
import math
import pickle
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest
from conftest import pose

import palpate

OUTLINE = [[0, 0], [30, 0], [30, 20], [0, 20]]
HOLE = [[5, 5], [10, 5], [5, 10]]


def plate(**changes):
    return palpate.Model.polygon(OUTLINE, name="plate", holes=[HOLE], **changes)


def touch(point, normal, **changes):
    return palpate.Contact(point, normal, **({"position_error": 0.5, "normal_error": 0.07} | changes))


def bottom_and_right(model):
    """What is found for contacts on faces 0 and 1 of the wedge at the identity."""
    return palpate.recognize([model], [touch((30, 0), (0, -1)), touch((60, 12), (1, 0))])


def copies_of(thing):
    return [pickle.loads(pickle.dumps(thing)), copy.copy(thing), copy.deepcopy(thing)]


def test_version_is_the_installed_one():
    from importlib.metadata import version

    assert palpate.__version__ == version("palpate")


STUB = Path(palpate.__file__).with_name("_core.pyi")
DOCS_RS = Path(__file__).parent.parent / "crates/palpate-python/src/docs.rs"


def documented():
    """Every name of the stub that has a text, `Model.size` say, with it. A class tells of its constructor."""
    texts = {}
    for node in ast.parse(STUB.read_text()).body:
        if isinstance(node, ast.FunctionDef):
            texts[node.name] = ast.get_docstring(node)
        elif isinstance(node, ast.ClassDef):
            own = [ast.get_docstring(node)]
            texts[node.name] = ""  # before its members
            for member in node.body:
                text = ast.get_docstring(member) if isinstance(member, ast.FunctionDef) else None
                if text and member.name == "__new__":
                    own.append(text)
                elif text:
                    texts[f"{node.name}.{member.name}"] = text
            texts[node.name] = "\n\n".join(own)
    return texts


def raw(text):
    """A raw string of Rust."""
    hash_mark = "#" if '"' in text else ""
    return f'r{hash_mark}"{text}"{hash_mark}'


def docs_rs():
    """The texts of the stub for the compiled module."""
    rules = "".join(
        f'    ("{name}") => {{\n        {raw(text)}\n    }};\n' for name, text in documented().items()
    )
    return f"""\
//! What `help()` shows, the texts of `python/palpate/_core.pyi`. Change them there, then write this file anew
//! with `python tests/test_bindings.py`.

/// The text of a class, a function, a method or a property.
macro_rules! doc {{
{rules}}}
"""


def test_the_texts_of_the_compiled_module_are_those_of_the_stub():
    assert DOCS_RS.read_text() == docs_rs(), "run python tests/test_bindings.py"


@pytest.mark.parametrize("name", documented())
def test_help_shows_the_text_of_the_stub(name):
    thing = attrgetter(name)(palpate)
    assert inspect.getdoc(thing) == documented()[name]


def test_everything_public_has_a_text():
    told = documented()
    for name in {name.split(".")[0] for name in told}:
        thing = getattr(palpate, name)
        members = [member for member in vars(thing) if member[0] != "_"] if inspect.isclass(thing) else []
        assert [member for member in members if f"{name}.{member}" not in told] == []
    shown = inspect.getdoc(palpate.recognize)
    for word in ("Args:", "Returns:", "Raises:", "world frame", "radians", "unit"):
        assert word in shown


def test_polygon():
    model = plate(untouchable=[2], position_slack=0.25, normal_slack=0.125)
    assert model.name == "plate"
    assert model.dimension == 2
    assert len(model.faces) == 7
    assert np.array_equal(model.faces[1], [[30, 0], [30, 20]])
    assert np.array_equal(model.vertices[:4], OUTLINE)
    assert model.vertices.shape == (7, 2)
    assert np.array_equal(model.face_normals[:4], [[0, -1], [1, 0], [0, 1], [-1, 0]])
    assert model.face_surfaces == ["touchable"] * 2 + ["untouchable"] + ["touchable"] * 4
    # Corners of the untouchable face can't be touched, nor can the reflex ones of the hole.
    assert model.touchable_vertices.tolist() == [True, True] + [False] * 5
    assert (model.position_slack, model.normal_slack) == (0.25, 0.125)
    assert model.size == pytest.approx(math.hypot(30, 20))
    assert model.closed
    assert model.edges == [] and model.symmetry_axes == []


def test_mends_are_told():
    assert plate().mends != []  # the hole is given counter-clockwise
    assert palpate.Model.polygon(OUTLINE).mends == []
    assert plate(mends=["a gap was closed"]).mends == ["a gap was closed", *plate().mends]
    ends = [[[0, 0], [1, 0]]]
    assert palpate.Model.segments(ends, mends=("a line was left out",)).mends == ["a line was left out"]
    assert np.array_equal(palpate.Model.polygon(OUTLINE[::-1]).face_normals.sum(axis=0), [0, 0])


def test_symmetries_map_the_model_onto_itself():
    model = palpate.Model.polygon(OUTLINE)
    assert model.symmetries.shape == (2, 3, 3)
    assert np.array_equal(model.symmetries[0], np.eye(3))
    turned = np.c_[model.vertices, np.ones(4)] @ model.symmetries[1].T
    assert np.allclose(sorted(map(tuple, turned[:, :2].round(9))), sorted(map(tuple, model.vertices)))


def test_first_contact(wedge):
    met = wedge.first_contact(pose(0, 100, 0), (130, -20), (0, 2), 4.0)
    assert (met.depth, met.feature, met.touchable) == (pytest.approx(16.0), ("face", 0), True)
    assert np.allclose(met.center, (130, -4)) and np.allclose(met.normal, (0, -1))
    assert met == wedge.first_contact(pose(0, 100, 0), (130, -20), (0, 2), tip_radius=4.0)
    assert met != wedge.first_contact(pose(0, 100, 0), (130, -20), (0, 2))
    assert repr(met) == "<FirstContact: face 0 at depth 16.000000>"
    assert wedge.first_contact(np.eye(3), (30, -20), (0, -1)) is None
    assert wedge.distance(np.eye(3), (30, 10)) == pytest.approx(-10)
    for given in ((np.eye(2), (0, 0), (1, 0)), (np.eye(3), (0, 0), (0, 0)), (np.eye(3), (0, 0), (1, 0), -1)):
        with pytest.raises(ValueError, match=r"world_from_model|direction|tip_radius"):
            wedge.first_contact(*given)


def test_segments():
    ends = [[[0, 0], [40, 0]], [[40, 0], [40, 15]], [[40, 15], [0, 15]]]
    model = palpate.Model.segments(
        ends, name="rail", seams=[1], untouchable=[2], position_slack=0.5, normal_slack=0.25
    )
    assert (model.name, model.closed, model.position_slack, model.normal_slack) == ("rail", False, 0.5, 0.25)
    assert model.face_surfaces == ["touchable", "seam", "untouchable"]
    assert np.array_equal(model.faces[2], ends[2])


def test_contact_at_a_point():
    contact = palpate.Contact(
        (1, 2), (3, 4), position_error=0.5, normal_error=0.1, approach=(0, -2), start=(1, 9)
    )
    assert contact.center.tolist() == [1, 2]
    assert contact.tip_radius == 0
    assert contact.position_error == 0.5
    assert contact.normal == pytest.approx([0.6, 0.8])
    assert contact.normal_error == 0.1
    assert contact.approach == pytest.approx([0, -1])
    assert contact.start == pytest.approx([1, 9])


def test_contact_of_a_tip():
    contact = palpate.Contact.from_tip((1, 2), 1.5, position_error=0.5, normal=(0, 1), normal_error=0.1)
    assert contact.tip_radius == 1.5
    assert contact.normal == pytest.approx([0, 1])
    bare = palpate.Contact.from_tip((1, 2), 1.5, position_error=0.5, approach=(2, 0), start=(0, 2))
    assert bare.normal is None and bare.normal_error is None
    assert bare.approach == pytest.approx([1, 0]) and bare.start == pytest.approx([0, 2])
    plain = palpate.Contact((1, 2), position_error=0.5)
    assert plain.approach is None and plain.start is None


def test_miss():
    miss = palpate.Miss((0, 1), (5, 2), tip_radius=1, path_error=0.25)
    assert (miss.start.tolist(), miss.end.tolist()) == ([0, 1], [5, 2])
    assert (miss.tip_radius, miss.path_error) == (1, 0.25)
    assert palpate.Miss((0, 1), (5, 2)) == palpate.Miss((0, 1), (5, 2), tip_radius=0.0, path_error=0.0)


def test_prior():
    prior = palpate.Prior(pose(0.5, 3, 4), translation=20, rotation=0.26)
    assert prior.world_from_model == pytest.approx(pose(0.5, 3, 4))
    assert (prior.translation, prior.rotation) == (20, 0.26)


# A normal whose length is not a power of two, so that normalizing it twice would show.
VALUES = [
    plate(untouchable=[2], position_slack=0.25, mends=["a gap was closed"]),
    palpate.Model.segments([[[0, 0], [3, 0]], [[3, 0], [3, 5]]], seams=[1], normal_slack=0.1),
    palpate.Contact((0.1, 0.2), (0.3, 0.7), position_error=0.5, normal_error=0.1, approach=(-0.3, -0.7)),
    palpate.Contact.from_tip((0.1, 0.2), 3, position_error=0.5, start=(0.7, 0.1)),
    palpate.Miss((0.1, 0.2), (3, 4), tip_radius=0.1, path_error=0.2),
    palpate.Prior(pose(0.3, 1, 2), translation=0.1, rotation=0.2),
]


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_values_survive_pickling_and_copying(value):
    assert copies_of(value) == [value] * 3
    assert value != VALUES[VALUES.index(value) - 1]
    assert value != "something else"


@pytest.mark.parametrize("value", VALUES[2:5], ids=repr)
def test_contacts_and_misses_read_back_from_their_repr(value):
    back = eval(repr(value), vars(palpate))
    assert repr(back) == repr(value) or back.center == pytest.approx(value.center)


def test_models_can_be_keys():
    assert {plate(): 1}[pickle.loads(pickle.dumps(plate()))] == 1


def test_reprs_tell_what_it_is():
    assert repr(plate()) == '<Model "plate": 7 faces, 7 vertices, size 36.055513>'
    assert "open" in repr(VALUES[1])
    assert repr(palpate.Prior(np.eye(3), translation=1, rotation=2)).endswith(
        "translation=1.0, rotation=2.0)"
    )


def test_reprs_of_tiny_parts_keep_their_digits():
    tiny = palpate.Model.polygon(np.array(OUTLINE) * 1e-7, name="tiny")
    assert repr(tiny) == '<Model "tiny": 4 faces, 4 vertices, size 0.0000036056>'
    bounds = {"position_error": 1e-8, "normal_error": 0.01}
    contacts = [palpate.Contact(p, n, **bounds) for p, n in (((1e-6, 0), (0, -1)), ((3e-6, 1e-6), (1, 0)))]
    hypothesis = palpate.recognize([tiny], contacts).hypotheses[0]
    for text in (repr(hypothesis), repr(hypothesis.poses)):
        x, y = map(float, text.split("at (")[1].split(")")[0].split(", "))
        assert (x, y) == pytest.approx(tuple(hypothesis.poses.witness[:2, 2]), abs=1e-7)
        assert len(text) < 120


def test_reprs_have_no_noise(wedge):
    (hypothesis,) = [one for one in bottom_and_right(wedge).hypotheses if one.poses.contains(np.eye(3))]
    assert max(len(repr(hypothesis)), len(repr(hypothesis.poses))) < 90


def test_arrays_that_are_returned_are_read_only():
    model, contact = plate(), VALUES[2]
    for array in (model.vertices, model.faces[0], model.symmetries, model.touchable_vertices, contact.center):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.parametrize(
    "kind", [list, tuple, np.array, lambda x: np.array(x, dtype=np.float32), lambda x: np.asfortranarray(x)]
)
def test_any_kind_of_array_is_read(kind):
    assert np.array_equal(palpate.Model.polygon(kind(OUTLINE)).vertices, OUTLINE)


def test_views_with_strides_are_read():
    wide = np.arange(8.0).reshape(2, 4)
    assert palpate.Miss(wide[:, 1], wide[::-1, 2]).end.tolist() == [6, 2]


def test_recognition(wedge):
    other = palpate.Model.polygon([[0, 0], [5, 0], [0, 5]], name="tiny")
    found = palpate.recognize([other, wedge], [touch((30, 0), (0, -1)), touch((60, 12), (1, 0))])
    assert [hypothesis.model.name for hypothesis in found.hypotheses] == ["wedge"] * len(found.hypotheses)
    assert found.complete is True
    assert found.conflict is None
    assert (
        found.interpretation_count
        == len(found.interpretations)
        == sum(h.interpretation_count for h in found.hypotheses)
    )
    assert found.interpretation_count_exact is True
    assert [sorted(counters) for counters in found.counters] == [
        [
            "feasible",
            "hypotheses",
            "nodes",
            "pose_boxes",
            "pruned_by_angle",
            "pruned_by_direction",
            "pruned_by_distance",
        ]
    ] * 2
    assert [counters["hypotheses"] for counters in found.counters] == [0, len(found.hypotheses)]
    assert found.counters[1]["nodes"] > 0
    assert "hypotheses" in repr(found)


def test_hypothesis(wedge):
    found = bottom_and_right(wedge)
    (hypothesis,) = [one for one in found.hypotheses if one.poses.contains(np.eye(3))]
    assert hypothesis.model is wedge
    assert hypothesis.model_number == 0
    assert hypothesis.marginal is False
    assert hypothesis.interpretation_count == len(list(hypothesis.interpretations))
    assert hypothesis.interpretation_count_exact is True
    assert hypothesis.poses.contains(hypothesis.world_from_model)
    # Two faces at a right angle fix rotation and translation; the contacts fit exactly at the identity.
    assert hypothesis.world_from_model == pytest.approx(np.eye(3), abs=1e-3)
    assert "wedge" in repr(hypothesis)


def test_interpretation(wedge):
    found = bottom_and_right(wedge)
    (right,) = [one for one in found.interpretations if one.assignment == [("face", 0), ("face", 1)]]
    assert right.model is wedge
    assert right.model_number == 0
    assert right.marginal is False
    assert right.poses.contains(np.eye(3))
    assert right.poses.contains(right.world_from_model)
    assert repr(right) == '<Interpretation: "wedge" on face 0, face 1>'


def test_interpretations_are_a_sequence(wedge):
    found = bottom_and_right(wedge)
    listed = [one.assignment for one in found.interpretations]
    count = len(found.interpretations)
    assert len(listed) == count > 1
    assert bool(found.interpretations)
    assert [found.interpretations[k].assignment for k in range(-count, count)] == listed * 2
    assert [one.assignment for one in found.interpretations[::-1]] == listed[::-1]
    assert found.interpretations[count:] == []
    assert repr(found.interpretations) == f"<Interpretations: {count}>"
    for number in (count, -count - 1):
        with pytest.raises(IndexError):
            found.interpretations[number]
    with pytest.raises(TypeError):
        found.interpretations["first"]


def test_interpretations_outlive_the_answer(wedge):
    iterator = iter(bottom_and_right(wedge).interpretations)
    assert len(list(iterator)) > 1
    assert next(iterator, None) is None


def test_pose_set(wedge):
    poses = bottom_and_right(wedge).hypotheses[0].poses
    assert poses.contains(poses.witness)
    assert not poses.contains(pose(0.0, 1000.0))
    assert poses.marginal is False
    samples = poses.sample(20, seed=3)
    assert samples.shape == (20, 3, 3)
    assert all(poses.contains(sample) for sample in samples)
    assert np.array_equal(samples, poses.sample(20, 3))
    assert not np.array_equal(samples, poses.sample(20))
    turns = np.arctan2(samples[:, 1, 0], samples[:, 0, 0])
    assert 0 < np.ptp(np.unwrap(turns)) <= poses.rotation_bound < np.pi
    corner = np.array([60.0, 25.0, 1.0])
    places = samples[:, :2] @ corner
    apart = np.linalg.norm(places[:, None] - places, axis=-1)
    assert 0 < apart.max() <= poses.excursion(corner[:2])
    assert "rad" in repr(poses)


def test_outline_holds_every_place_of_the_point(wedge):
    poses = bottom_and_right(wedge).hypotheses[0].poses
    outline = poses.outline((60, 25))
    sides = np.roll(outline, -1, axis=0) - outline
    for place in poses.sample(50)[:, :2] @ [60.0, 25.0, 1.0]:
        offset = place - outline
        assert np.all(sides[:, 0] * offset[:, 1] - sides[:, 1] * offset[:, 0] >= -1e-9)


def test_conflict(wedge):
    contacts = [touch((0, 0), (0, -1)), touch((10, 0), (0, -1)), touch((500, 0), (1, 0))]
    found = palpate.recognize([wedge], contacts)
    assert found.hypotheses == []
    assert found.conflict is not None and 2 in found.conflict
    assert (found.interpretation_count, len(found.interpretations), list(found.interpretations)) == (0, 0, [])
    assert not found.interpretations
    assert "conflict" in repr(found)


def test_options_of_recognition_change_the_answer(wedge):
    contacts = [touch((30, 0), (0, -1)), touch((60, 12), (1, 0))]
    everything = palpate.recognize([wedge], contacts)
    assert len(everything.hypotheses) > 1
    prior = palpate.Prior(np.eye(3), translation=5, rotation=0.3)
    assert len(palpate.recognize([wedge], contacts, prior=prior).hypotheses) == 1
    one = palpate.recognize([wedge], contacts, max_hypotheses=1)
    assert (len(one.hypotheses), one.complete, one.interpretation_count_exact) == (1, False, False)
    through = palpate.Miss((30, 12), (31, 12))
    left = palpate.recognize([wedge], contacts, misses=[through]).hypotheses
    assert not any(hypothesis.poses.contains(np.eye(3)) for hypothesis in left)
    kinds = palpate.recognize([wedge], contacts, features=("vertex",), tolerance=1e-5).interpretations
    assert {kind for one in kinds for kind, _ in one.assignment} <= {"vertex"}


def test_contacts_may_come_in_any_iterable(wedge):
    contacts = (touch((30, 0), (0, -1)), touch((60, 12), (1, 0)))
    assert repr(palpate.recognize(iter([wedge]), iter(contacts))) == repr(
        palpate.recognize((wedge,), contacts)
    )


def test_plots_are_there_when_wanted():
    assert callable(palpate.plots.save_figure)
    with pytest.raises(AttributeError, match="no attribute 'plotz'"):
        _ = palpate.plotz


def test_recognition_runs_beside_other_threads(wedge):
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(lambda _: repr(bottom_and_right(wedge).hypotheses), range(16)))
    assert set(answers) == {repr(bottom_and_right(wedge).hypotheses)}


if __name__ == "__main__":
    DOCS_RS.write_text(docs_rs())
