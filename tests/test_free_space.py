"""Misses and free paths: what they exclude, against the rule itself measured by another library."""

import math
from random import Random

import numpy as np
import pytest
from oracle import intrusion, placed

import palpate
from palpate.experiments.problems import matrix
from palpate.experiments.random_parts import random_part

TOLERANCE = 1e-6


def scene(seed):
    """A part where it is, one loose contact on it, and sweeps that pass near it or through it."""
    random = Random(seed)
    part = random_part(random, random.choice(["star", "comb", "holes", "bundled"]))
    truth = matrix(random.uniform(-math.pi, math.pi), random.uniform(-9, 9), random.uniform(-9, 9))
    size = part.size
    face = random.choice([k for k, kind in enumerate(part.face_surfaces) if kind == "touchable"])
    ends, normal = np.array(part.faces[face]), np.array(part.face_normals[face])
    point = truth[:2, :2] @ ends.mean(axis=0) + truth[:2, 2]
    normal = truth[:2, :2] @ normal
    misses = []
    for _ in range(random.randint(1, 3)):
        middle = point + size * (random.gauss(0.02, 0.1) * normal + random.gauss(0, 0.2) * normal[::-1])
        way = 0.5 * size * random.random() * np.array([math.cos(a := random.uniform(0, 7)), math.sin(a)])
        misses.append(
            palpate.Miss(
                middle - way,
                middle + way,
                tip_radius=size * random.choice((0.0, 0.01, 0.05)),
                path_error=size * random.choice((0.0, 0.01, 0.03)),
            )
        )
    start = point + size * random.uniform(0.2, 1.0) * normal
    contact = palpate.Contact.from_tip(
        point,
        0.0,
        position_error=0.05 * size,
        normal=normal,
        normal_error=0.3,
        start=start if random.random() < 0.5 else None,
    )
    return part, truth, contact, misses


def sweeps_of(contact, misses, slack):
    """Start, end and clearance of each sweep (DESIGN §2)."""
    sweeps = [(miss.start, miss.end, miss.tip_radius - miss.path_error - slack) for miss in misses]
    if contact.start is not None:
        way = contact.center - contact.start
        free = 1.0 - contact.position_error / np.linalg.norm(way)
        clearance = contact.tip_radius - contact.position_error - slack
        sweeps.append((contact.start, contact.start + free * way, clearance))
    return sweeps


def without_start(contact):
    return palpate.Contact(
        contact.center,
        contact.normal,
        position_error=contact.position_error,
        normal_error=contact.normal_error,
    )


@pytest.mark.parametrize("seed", range(60))
def test_contains_agrees_with_the_rule(seed):
    part, _, contact, misses = scene(seed)
    without = palpate.recognize([part], [without_start(contact)])
    found = palpate.recognize([part], [contact], misses=misses)
    sweeps = sweeps_of(contact, misses, part.position_slack)
    decided = 0
    for one in without.hypotheses[:3]:
        for pose in one.poses.sample(15, seed=seed):
            polygon = placed(part, pose)
            measured = [intrusion(polygon, *sweep) for sweep in sweeps]
            worst = max(by for by, _ in measured)
            # How far the way inside the part was sampled, and the tolerance.
            band = max(step for _, step in measured) + 2.0 * TOLERANCE * part.size
            if abs(worst) <= band:
                continue
            decided += 1
            contained = any(other.poses.contains(pose) for other in found.hypotheses)
            assert contained == (worst < 0.0), f"intrusion {worst}, {pose.tolist()}"
    assert decided > 0


@pytest.mark.parametrize("seed", range(60))
def test_a_free_pose_is_never_lost(seed):
    """Misses that the truth allows leave the truth, and what is left of each hypothesis is free."""
    part, truth, contact, misses = scene(seed)
    polygon = placed(part, truth)
    allowed = [
        miss
        for miss in misses
        if intrusion(polygon, *sweeps_of(without_start(contact), [miss], part.position_slack)[0])[0] < 0.0
    ]
    found = palpate.recognize([part], [without_start(contact)], misses=allowed)
    assert found.complete
    assert any(one.poses.contains(truth) for one in found.hypotheses)
    for one in found.hypotheses:
        for pose in [one.poses.witness, one.world_from_model, *one.poses.sample(5, seed=seed)]:
            placed_part = placed(part, pose)
            for sweep in sweeps_of(without_start(contact), allowed, part.position_slack):
                assert intrusion(placed_part, *sweep)[0] <= 1.01 * TOLERANCE * part.size


def test_a_miss_through_a_hypothesis_removes_it():
    """Two sides fit a square plate with a slit in several ways; a sweep through all poses of one ends it."""
    plate = palpate.Model.polygon(
        [[0, 0], [60, 0], [60, 60], [32, 60], [32, 35], [28, 35], [28, 60], [0, 60]], name="slit plate"
    )
    contacts = [
        palpate.Contact((30, 0), (0, -1), position_error=0.3, normal_error=0.05),
        palpate.Contact((60, 30), (1, 0), position_error=0.3, normal_error=0.05),
    ]
    before = palpate.recognize([plate], contacts)
    assert len(before.hypotheses) >= 3

    # Down the slit of the plate as it is at the identity: only there is it free.
    through = palpate.Miss((30, 70), (30, 40), tip_radius=0.5)
    after = palpate.recognize([plate], contacts, misses=[through])
    assert [one for one in after.hypotheses if one.poses.contains(np.eye(3))]
    assert 1 <= len(after.hypotheses) < len(before.hypotheses)
    for one in before.hypotheses:
        excluded = [
            intrusion(placed(plate, pose), (30, 70), (30, 40), 0.5)[0] > 0.1 for pose in one.poses.sample(20)
        ]
        left = any(other.poses.contains(one.poses.witness) for other in after.hypotheses)
        assert left != all(excluded)

    # A sweep right through the part leaves nothing, and it is not the contacts that conflict.
    none = palpate.recognize([plate], contacts, misses=[palpate.Miss((-50, 30), (150, 30))])
    assert none.hypotheses == []
    assert none.conflict is not None


def test_a_sweep_that_just_touches_its_clearance_is_kept():
    """A tip that slid along a face touched nothing; one pressed in by more than the tolerance would have."""
    square = palpate.Model.polygon([[0, 0], [50, 0], [50, 30], [0, 30]], name="plate")
    contact = palpate.Contact((25, 0), (0, -1), position_error=0.4, normal_error=0.1)
    here = palpate.Prior(np.eye(3), translation=0.0, rotation=0.0)
    slid = palpate.Miss((-10, 32), (60, 32), tip_radius=2.0)
    assert palpate.recognize([square], [contact], misses=[slid], prior=here).hypotheses
    pressed = palpate.Miss((-10, 32), (60, 32), tip_radius=2.0 + 1e-3)
    assert not palpate.recognize([square], [contact], misses=[pressed], prior=here).hypotheses


def test_the_way_to_a_contact_was_free():
    """Of two faces that explain a contact, the one that can be reached from the start of the move is left."""
    u = palpate.Model.polygon(
        [[0, 0], [90, 0], [90, 60], [70, 60], [70, 20], [20, 20], [20, 60], [0, 60]], name="u"
    )
    here = palpate.Prior(np.eye(3), translation=25.0, rotation=0.05)
    known = {"position_error": 0.3, "normal": (-1, 0), "normal_error": 0.05}
    outside = palpate.Contact.from_tip((70, 40), 0.0, **known)
    both = palpate.recognize([u], [outside], prior=palpate.Prior(np.eye(3), translation=80.0, rotation=0.05))
    assert {tuple(one.assignment) for one in both.interpretations} == {(("face", 3),), (("face", 7),)}
    # From the left, the way to the inner face leads through the left leg.
    from_left = palpate.Contact.from_tip((70, 40), 0.0, start=(30, 40), **known)
    found = palpate.recognize([u], [from_left], prior=here)
    for one in found.hypotheses:
        assert intrusion(placed(u, one.world_from_model), (30, 40), (69.7, 40), -0.3)[0] <= 1e-4
