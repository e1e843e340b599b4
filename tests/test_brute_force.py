"""Nothing valid is missing, nothing invalid is kept: against brute force over assignments and rotations."""

import math
from random import Random

import numpy as np
import pytest
from oracle import decide, decide_pairs

import palpate
from palpate.experiments.problems import matrix
from palpate.experiments.random_parts import log_uniform, random_part
from palpate.experiments.shapes import Shape


def random_case(random, *, count, largest_error, bare):
    """A part and contacts on its faces, some without normals; `largest_error` on parts 150 across."""
    while True:
        part = random_part(random, random.choice(["star", "comb", "holes", "bundled", "symmetric", "loose"]))
        # Slacks are added by the recognizer; the brute force knows only contacts.
        if part.position_slack == part.normal_slack == 0.0 and len(part.faces) <= 30:
            break
    unit = part.size / 150.0
    shape = Shape.of(part)
    truth = matrix(random.uniform(-math.pi, math.pi), *(unit * random.uniform(-200, 200) for _ in range(2)))
    error = unit * log_uniform(random, 0.01, largest_error)
    normal_error = math.radians(log_uniform(random, 0.1, 15.0))
    radius = unit * random.uniform(0.5, 3.0) if random.random() < 0.3 else 0.0
    faces = np.flatnonzero(shape.touchable_faces).tolist()
    contacts = []
    for _ in range(count):
        face = random.choice(faces)
        point = shape.starts[face] + random.random() * (shape.ends[face] - shape.starts[face])
        center = truth[:2, :2] @ (point + radius * shape.normals[face]) + truth[:2, 2]
        where, angle = random.uniform(-math.pi, math.pi), random.uniform(-normal_error, normal_error)
        share = 1.0 if random.random() < 1 / 3 else random.random()
        center = center + share * error * np.array([math.cos(where), math.sin(where)])
        normal = (truth[:2, :2] @ matrix(angle, 0, 0)[:2, :2]) @ shape.normals[face]
        known = {} if random.random() < bare else {"normal": normal, "normal_error": normal_error}
        contacts.append(palpate.Contact.from_tip(center, radius, position_error=error, **known))
    return part, contacts


def listed(part, contacts):
    """The assignments that the recognizer lists, as face numbers."""
    found = palpate.recognize([part], contacts, features=["face"], max_hypotheses=100_000)
    assert found.complete and found.interpretation_count_exact
    return {tuple(number for _, number in one.assignment) for one in found.interpretations}


def compare(part, contacts, verdict):
    """One of each that symmetry repeats is listed of all that is sure; nothing is that is not possible."""
    found = listed(part, contacts)
    maps = [faces for _, faces, _ in Shape.of(part).symmetries]
    everywhere = {tuple(faces[face] for face in one) for one in found for faces in maps}
    assert verdict.sure <= everywhere, f"missing {verdict.sure - everywhere}"
    assert everywhere <= verdict.possible, f"invalid {everywhere - verdict.possible}"
    return len(verdict.sure), len(verdict.undecided)


@pytest.mark.parametrize("part_of_ten", range(10))
def test_two_contacts_against_all_assignments_and_rotations(part_of_ten):
    sure = undecided = 0
    for seed in range(100 * part_of_ten, 100 * (part_of_ten + 1)):
        part, contacts = random_case(Random(seed), count=2, largest_error=4.0, bare=0.1)
        counts = compare(part, contacts, decide_pairs(part, contacts))
        sure, undecided = sure + counts[0], undecided + counts[1]
    assert sure > 300
    assert undecided <= 0.005 * sure


@pytest.mark.parametrize("part_of_ten", range(10))
def test_three_and_four_contacts_against_linear_programs(part_of_ten):
    sure = undecided = 0
    for seed in range(20 * part_of_ten, 20 * (part_of_ten + 1)):
        random = Random(10_000 + seed)
        part, contacts = random_case(random, count=random.choice((3, 3, 4)), largest_error=2.0, bare=0.05)
        counts = compare(part, contacts, decide(part, contacts))
        sure, undecided = sure + counts[0], undecided + counts[1]
    assert sure >= 20
    assert undecided <= 0.02 * sure
