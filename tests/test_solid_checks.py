"""The campaign of space finds what is wrong: here with recognizers that break one promise each."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from palpate.experiments.random_solids import random_solid
from palpate.experiments.solid_checks import FAULTS, check
from palpate.experiments.solid_oracle import Slack, tolerance, valid
from palpate.experiments.solid_particles import same_place, search
from palpate.experiments.solid_problems import FAMILIES, Bounds, draw_contacts, random_pose, random_problem

SEEDS = range(16)


@dataclass
class Named:
    name: str
    position_slack: float = 0.0
    normal_slack: float = 0.0
    asymmetry: tuple[float, float] = (0.0, 0.0)
    symmetries: np.ndarray = field(default_factory=lambda: np.eye(4)[None])


class Poses:
    """All that the oracle calls valid, if `whole`; else the true pose alone."""

    rotation_bound = 7.0

    def __init__(self, problem, number, *, whole, sampled, bound):
        self.problem, self.number, self.whole, self.bound = problem, number, whole, bound
        self.sampled = problem.world_from_model if sampled is None else sampled
        self.rotation_bound = bound

    def contains(self, pose):
        problem = self.problem
        if not self.whole:
            return np.allclose(pose, problem.world_from_model)
        solid = problem.solids[self.number]
        slack = tolerance(solid, problem.contacts, 1e-7)
        return bool(
            valid(
                solid,
                np.asarray(pose)[None],
                problem.contacts,
                slack,
                misses=problem.misses,
                prior=problem.prior,
                kinds=problem.kinds,
            )[0]
        )

    def sample(self, count, seed=0):
        return np.stack([self.sampled] * count)

    def excursion(self, point):
        return 1e3 * self.bound


@dataclass
class Hypothesis:
    model: Named
    poses: Poses
    world_from_model: np.ndarray
    marginal: bool = False
    proved: bool = True


@dataclass
class Recognition:
    hypotheses: list
    interpretation_count: int = 1
    complete: bool = True


def recognizer(*, lost=False, complete=True, whole=True, moved=0.0, sampled=0.0, bound=7.0, raises=False):
    """One that returns all models with their valid poses, but for what it is told to get wrong."""

    def shifted(pose, by):
        pose = pose.copy()
        pose[:3, 3] += by
        return pose

    def recognize(problem):
        if raises:
            raise ValueError("told to")
        models = [Named(f"{number}-{solid.name}") for number, solid in enumerate(problem.solids)]
        truth = problem.world_from_model
        hypotheses = [
            Hypothesis(
                models[number],
                Poses(problem, number, whole=whole, sampled=shifted(truth, sampled), bound=bound),
                shifted(truth, moved),
            )
            for number in range(len(models))
            if number == problem.true and not lost
        ]
        return models, Recognition(hypotheses, complete=complete)

    return recognize


def faults_of(seeds, **wrong):
    found = set()
    for seed in seeds:
        counts = check(seed, (), recognizer(**wrong)).counts
        found |= {fault for fault in FAULTS if counts[fault]}
    return found


def single(seeds):
    """Problems of one model: the recognizer of these tests knows the true one alone."""
    return [seed for seed in seeds if random_problem(seed).family != "library"]


def test_a_true_answer_has_no_fault():
    assert faults_of(single(SEEDS)) == set()


@pytest.mark.parametrize(
    ("wrong", "fault"),
    [
        ({"lost": True}, "truths_lost"),
        ({"whole": False}, "valid_poses_lost"),
        ({"moved": 30.0}, "invalid_witnesses"),
        ({"sampled": 30.0}, "invalid_samples"),
        ({"moved": 30.0, "bound": 1e-3}, "bounds_exceeded"),
        ({"raises": True}, "errors"),
    ],
)
def test_each_fault_is_found(wrong, fault):
    assert fault in faults_of(single(range(12)), **wrong)


def test_an_incomplete_answer_may_lose_the_truth_but_that_is_counted():
    [seed, *_] = single(SEEDS)
    for lost in (True, False):
        outcome = check(seed, (), recognizer(lost=lost, complete=False))
        assert outcome.counts["incomplete"] == 1
        assert outcome.counts["incomplete_without_truth"] == int(lost)
        assert not outcome.faults


def test_an_incomplete_answer_is_checked_like_any_other():
    wrong = {"moved": 30.0, "sampled": -30.0, "bound": 1e-3}
    found = faults_of(single(range(6)), complete=False, **wrong)
    assert found >= {"invalid_witnesses", "invalid_samples", "bounds_exceeded"}


def test_all_families_occur_and_agree_with_their_truth():
    families = set()
    for seed in range(60):
        problem = random_problem(seed)
        families.add(problem.family)
        held = valid(
            problem.solid,
            problem.world_from_model[None],
            problem.contacts,
            tolerance(problem.solid, problem.contacts, 1e-9),
            misses=problem.misses,
            prior=problem.prior,
            kinds=problem.kinds,
        )
        assert held[0], seed
        assert (problem.family == "no-normals") == (problem.contacts[0].normal is None)
        assert problem.family != "tips" or problem.contacts[0].tip_radius > 0.0
    assert families == set(FAMILIES)


def test_the_same_seed_is_the_same_problem():
    first, second = random_problem(17), random_problem(17)
    assert first.family == second.family
    for one, other in zip(first.contacts, second.contacts, strict=True):
        assert (one.center == other.center).all()


def test_a_search_finds_the_true_place_mostly():
    """It promises nothing but that what it calls valid is; the truth is among its particles in most cases."""
    found = 0
    for seed in range(6):
        random = np.random.default_rng(seed)
        solid = random_solid(random)
        truth = random_pose(random, 100.0)
        contacts = draw_contacts(random, solid, truth, bounds=Bounds(0.5, 0.07), count=6, manners=("around",))
        poses = search(solid, contacts, seed)
        assert valid(solid, poses, contacts, Slack(1e-9, 1e-9)).all()
        particles = search(solid, contacts, seed, only_valid=False)
        found += bool(same_place(solid, particles, truth, within=4.0).any())
    assert found >= 4
