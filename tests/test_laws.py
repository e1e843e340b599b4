"""Laws of recognition, each on many small problems with contacts, misses, priors and tips of all kinds."""

import os
import subprocess
import sys
from random import Random

import numpy as np
import pytest

import palpate
from palpate.experiments.problems import matrix, random_problem
from palpate.experiments.shapes import Shape


def small_problem(seed):
    """A problem with one model and few enough assignments that all are listed."""
    while True:
        problem = random_problem(seed)
        bare = any(contact.normal is None for contact in problem.contacts)
        if len(problem.models) == 1 and not (bare and problem.prior is None) and len(problem.contacts) <= 6:
            return problem
        seed += 10**8


def solve(problem, **changes):
    """The answer, with some of the evidence replaced."""
    given = {
        "contacts": problem.contacts,
        "features": problem.features,
        "misses": problem.misses,
        "prior": problem.prior,
    } | changes
    return palpate.recognize(given.pop("models", problem.models), given.pop("contacts"), **given)


def assignments(found):
    """What is listed."""
    return sorted(tuple(one.assignment) for one in found.interpretations)


def moved_contact(contact, motion, *, scale=1.0):
    """The contact as seen after a motion of the world, and in another unit."""

    def point(p):
        return None if p is None else scale * (motion[:2, :2] @ p + motion[:2, 2])

    def direction(v):
        return None if v is None else motion[:2, :2] @ v

    return palpate.Contact.from_tip(
        point(contact.center),
        scale * contact.tip_radius,
        position_error=scale * contact.position_error,
        normal=direction(contact.normal),
        normal_error=contact.normal_error,
        approach=direction(contact.approach),
        start=point(contact.start),
    )


def moved_miss(miss, motion, *, scale=1.0):
    """The same of a miss."""
    start, end = (scale * (motion[:2, :2] @ p + motion[:2, 2]) for p in (miss.start, miss.end))
    return palpate.Miss(start, end, tip_radius=scale * miss.tip_radius, path_error=scale * miss.path_error)


def scaled(pose, scale):
    """A pose in another unit."""
    pose = np.array(pose)
    pose[:2, 2] *= scale
    return pose


SEEDS = range(5000, 5060)


@pytest.mark.parametrize("seed", SEEDS)
def test_moving_the_world_moves_every_hypothesis_alike(seed):
    problem = small_problem(seed)
    random = Random(seed)
    new_from_old = matrix(random.uniform(-4, 4), random.uniform(-500, 500), random.uniform(-500, 500))
    if problem.prior is not None:
        # A box of translations does not turn with the world.
        new_from_old[:2, :2] = np.eye(2)
    before = solve(problem)
    prior = problem.prior and palpate.Prior(
        new_from_old @ problem.prior.world_from_model,
        translation=problem.prior.translation,
        rotation=problem.prior.rotation,
    )
    after = solve(
        problem,
        contacts=[moved_contact(contact, new_from_old) for contact in problem.contacts],
        misses=[moved_miss(miss, new_from_old) for miss in problem.misses],
        prior=prior,
    )
    assert assignments(after) == assignments(before)
    assert len(after.hypotheses) == len(before.hypotheses)
    for old in before.hypotheses:
        for pose in [old.poses.witness, *old.poses.sample(3, seed=seed)]:
            # Both obey the bounds only up to the tolerance: the pose may use all of it.
            assert any(new.poses.contains(new_from_old @ pose) for new in after.hypotheses)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_contacts_is_irrelevant(seed):
    problem = small_problem(seed)
    order = list(range(len(problem.contacts)))
    Random(seed).shuffle(order)
    before = solve(problem)
    after = solve(problem, contacts=[problem.contacts[k] for k in order])
    assert len(after.hypotheses) == len(before.hypotheses)
    permuted = orbit_minima(problem, [tuple(one[k] for k in order) for one in assignments(before)])
    assert permuted == orbit_minima(problem, assignments(after))


def orbit_minima(problem, listed):
    """Of assignments that symmetry takes into each other, one."""
    if problem.prior is not None:
        return sorted(listed)
    maps = [(faces, corners) for _, faces, corners in Shape.of(problem.models[0]).symmetries]
    return sorted(
        min(
            tuple((kind, faces[k] if kind == "face" else corners[k]) for kind, k in one)
            for faces, corners in maps
        )
        for one in listed
    )


def rescaled(model, scale):
    """The same part in another unit."""
    numbers = {
        kind: [k for k, surface in enumerate(model.face_surfaces) if surface == kind]
        for kind in ("seam", "untouchable")
    }
    known = {
        "untouchable": numbers["untouchable"],
        "position_slack": scale * model.position_slack,
        "normal_slack": model.normal_slack,
    }
    faces = scale * np.array(model.faces)
    if not model.closed:
        return palpate.Model.segments(faces, seams=numbers["seam"], **known)
    ends = [
        k + 1 for k in range(len(faces)) if not np.array_equal(faces[k, 1], faces[(k + 1) % len(faces), 0])
    ]
    loops = np.split(faces[:, 0], ends[:-1]) if ends else [faces[:, 0]]
    return palpate.Model.polygon(loops[0], holes=loops[1:], **known)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("scale", [1.0 / 25.4, 1000.0])
def test_another_unit_changes_nothing_but_the_unit(seed, scale):
    problem = small_problem(seed)
    model = problem.models[0]
    larger = rescaled(model, scale)
    before = solve(problem)
    prior = problem.prior and palpate.Prior(
        scaled(problem.prior.world_from_model, scale),
        translation=scale * problem.prior.translation,
        rotation=problem.prior.rotation,
    )
    after = solve(
        problem,
        models=[larger],
        contacts=[moved_contact(contact, np.eye(3), scale=scale) for contact in problem.contacts],
        misses=[moved_miss(miss, np.eye(3), scale=scale) for miss in problem.misses],
        prior=prior,
    )
    assert assignments(after) == assignments(before)
    assert len(after.hypotheses) == len(before.hypotheses)
    for old, new in zip(before.hypotheses, after.hypotheses, strict=True):
        assert new.poses.contains(scaled(old.poses.witness, scale))
        assert new.poses.rotation_bound == pytest.approx(old.poses.rotation_bound, rel=0.02, abs=1e-5)
        point = model.vertices[0]
        expected = scale * old.poses.excursion(point)
        assert new.poses.excursion(scale * point) == pytest.approx(
            expected, rel=0.02, abs=1e-4 * scale * model.size
        )


def wider(contact, *, by):
    """The contact with larger bounds."""
    return palpate.Contact.from_tip(
        contact.center,
        contact.tip_radius,
        position_error=by * contact.position_error,
        normal=contact.normal,
        normal_error=contact.normal_error and by * contact.normal_error,
        approach=contact.approach,
        start=contact.start,
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_wider_bounds_lose_no_interpretation(seed):
    problem = small_problem(seed)
    before = solve(problem)
    after = solve(problem, contacts=[wider(contact, by=1.3) for contact in problem.contacts])
    if after.interpretation_count_exact and after.complete:
        assert set(assignments(before)) <= set(assignments(after))
    for one in before.hypotheses:
        assert any(other.poses.contains(one.poses.witness) for other in after.hypotheses)


@pytest.mark.parametrize("seed", SEEDS)
def test_one_more_contact_adds_no_interpretation_of_the_others(seed):
    problem = small_problem(seed)
    fewer = solve(problem, contacts=problem.contacts[:-1], features=problem.kinds)
    more = solve(problem, features=problem.kinds)
    if fewer.interpretation_count_exact and fewer.complete:
        restricted = orbit_minima(problem, [one[:-1] for one in assignments(more)])
        assert set(restricted) <= set(orbit_minima(problem, assignments(fewer)))
    for one in more.hypotheses:
        for pose in [one.poses.witness, *one.poses.sample(3, seed=seed)]:
            assert any(other.poses.contains(pose) for other in fewer.hypotheses)


def test_a_pose_is_contained_up_to_symmetry():
    """A square of which one side was touched: its four placements are one answer."""
    square = palpate.Model.polygon([[0, 0], [40, 0], [40, 40], [0, 40]])
    contacts = [
        palpate.Contact((10, 0), (0, -1), position_error=0.2, normal_error=0.02),
        palpate.Contact((40, 15), (1, 0), position_error=0.2, normal_error=0.02),
    ]
    found = palpate.recognize([square], contacts)
    assert len(square.symmetries) == 4
    assert len(found.hypotheses) == 1
    assert all(found.hypotheses[0].poses.contains(motion) for motion in square.symmetries)
    # With a prior, the poses that it excludes are no longer meant by themselves.
    prior = palpate.Prior(np.eye(3), translation=5.0, rotation=0.1)
    known = palpate.recognize([square], contacts, prior=prior)
    assert [tuple(one.assignment) for one in known.interpretations] == [(("face", 0), ("face", 1))]


FINGERPRINT = """
import hashlib, numpy as np
from palpate.experiments.problems import random_problem
digest = hashlib.sha256()
for seed in range(7000, 7080):
    problem = random_problem(seed)
    found = problem.recognize()
    digest.update(repr([found.complete, found.interpretation_count, found.counters]).encode())
    for one in found.hypotheses[:50]:
        poses = one.poses
        for array in (poses.witness, one.world_from_model, poses.sample(3), poses.outline((1.0, 2.0))):
            digest.update(np.ascontiguousarray(array).tobytes())
        digest.update(repr([poses.rotation_bound, poses.excursion((1.0, 2.0))]).encode())
print(digest.hexdigest())
"""


def test_the_same_bits_with_one_thread_and_with_two():
    prints = {
        subprocess.run(
            [sys.executable, "-c", FINGERPRINT],
            env={**os.environ, "RAYON_NUM_THREADS": threads},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for threads in ("1", "2", "2")
    }
    assert len(prints) == 1
