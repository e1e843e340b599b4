"""One random problem of space put to the core, and the answer checked against the truth and the oracle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .checked import Outcome
from .solid_oracle import Slack, angle_between, missed_by_centers, tolerance, valid
from .solid_particles import Settings, in_ball, rotations, search
from .solid_problems import Problem, for_core, kept_model, random_problem
from .solids import Array, Mask, Solid

#: What must not happen, in the order of the table: its counter, and what to call it.
FAULTS = {
    "truths_lost": "true part lost",
    "poses_lost": "true pose outside",
    "valid_poses_lost": "other valid pose outside",
    "invalid_witnesses": "invalid witness",
    "invalid_samples": "invalid sample",
    "falsely_contained": "invalid pose contained",
    "bounds_exceeded": "bound too small",
    "errors": "error",
}

#: The tolerance of the recognizer, relative to the part's size.
TOLERANCE = 1e-6
#: A pose that is valid by so much more than it must be, relative to the size and in radians, is surely valid.
MARGIN = 2e-6

#: What the core may take for a problem; what it has by then is an answer that is not complete.
MOST_SECONDS = 20

MOST_HYPOTHESES = 6
NUM_SAMPLES = 6
NUM_NEIGHBOURS = 24
#: In one problem of so many all poses are searched, not only near the truth.
SEARCHED = 4
SEARCH = Settings(
    num_places=8000, num_paired=350, num_first=2000, num_particles=800, most_kept=100, num_lowered=8
)


@dataclass(frozen=True)
class Answer:
    """A problem with its answer; `models` are in the order of the problem's solids."""

    problem: Problem
    models: Sequence[Any]
    found: Any

    def of(self, number: int) -> list[Any]:
        """The hypotheses of a model."""
        return [one for one in self.found.hypotheses if one.model.name == self.models[number].name]

    def held(self, number: int, poses: Array, *, sure: bool) -> Mask:
        """Whether the oracle calls poses of a model valid: surely, or at least perhaps; `(p,)`."""
        problem, solid, model = self.problem, self.problem.solids[number], self.models[number]
        # A mesh whose faces were made planar is that much off, and the core allows for it; the normals of its
        # triangles are not known better. So is a part that is nearly symmetric, where a pose stands for its
        # images.
        off = model.position_slack
        missed, turned = (0.0, 0.0) if problem.prior else model.asymmetry
        if sure:
            slack = Slack(-MARGIN * solid.size, -MARGIN, -off)
        else:
            least = tolerance(solid, problem.contacts, TOLERANCE)
            length = off + missed_by_centers((missed, turned), problem.contacts)
            angle = model.normal_slack + turned
            slack = Slack(least.length + 2.0 * length, least.angle + 2.0 * angle, off + missed)
        return valid(
            solid,
            poses,
            problem.contacts,
            slack,
            misses=problem.misses,
            prior=problem.prior,
            kinds=problem.kinds,
        )


def recognized(problem: Problem) -> tuple[Sequence[Any], Any]:
    """The core's models and its answer."""
    from palpate import recognize

    given = for_core(problem, kept_model)
    return given["models"], recognize(**given, time_limit=MOST_SECONDS)


def check(
    seed: int,
    parts: Sequence[Solid] = (),
    recognizer: Callable[[Problem], tuple[Sequence[Any], Any]] = recognized,
) -> Outcome:
    """Put the problem of this seed to the core and check the answer."""
    problem = random_problem(seed, parts)
    outcome = Outcome(seed, problem.family, FAULTS)
    nothing = tolerance(problem.solid, problem.contacts, 1e-9)
    truth = problem.world_from_model[None]
    assert valid(
        problem.solid,
        truth,
        problem.contacts,
        nothing,
        misses=problem.misses,
        prior=problem.prior,
        kinds=problem.kinds,
    )[0], f"problem {seed} does not agree with its own truth"
    answered = outcome.answer(partial(recognizer, problem))
    if answered is None:
        return outcome
    answer = Answer(problem, *answered)
    found = answer.found
    outcome.counts["hypotheses"] += len(found.hypotheses)
    outcome.counts["interpretations"] += int(found.interpretation_count)
    outcome.counts["incomplete"] += not found.complete
    _check_truth(answer, outcome)
    _check_hypotheses(answer, outcome)
    _check_others(answer, outcome)
    return outcome


def _check_truth(answer: Answer, outcome: Outcome) -> None:
    """The true part is among the hypotheses, and the true pose in one of them, up to symmetry."""
    problem = answer.problem
    mine = answer.of(problem.true)
    containing = [one for one in mine if one.poses.contains(problem.world_from_model)]
    outcome.counts["marginal"] += sum(one.marginal for one in containing)
    if containing:
        return
    if not answer.found.complete:
        outcome.counts["incomplete_without_truth"] += 1
        return
    outcome.expect(bool(mine), "truths_lost")
    outcome.expect(not mine, "poses_lost")


def _check_hypotheses(answer: Answer, outcome: Outcome) -> None:
    """Witnesses and samples are valid, contained, and within the bounds that the hypothesis states."""
    problem = answer.problem
    for number, model in enumerate(answer.models):
        hypotheses = answer.of(number)[:MOST_HYPOTHESES]
        if not hypotheses:
            continue
        # Of each the witness, then samples.
        poses = [_witness_and_samples(one, problem.seed) for one in hypotheses]
        held = answer.held(number, np.concatenate(poses), sure=False)
        ends = np.cumsum([len(some) for some in poses])
        for one, some, valid_ones in zip(hypotheses, poses, np.split(held, ends[:-1]), strict=True):
            said = f"of {model.name}"
            outcome.counts["poses_checked"] += len(some)
            if not one.proved:
                # Kept so that nothing true is lost; that there is a pose is not said.
                outcome.counts["undecided"] += 1
                continue
            outcome.expect(bool(valid_ones[0]), "invalid_witnesses", said)
            outcome.expect(bool(valid_ones[1:].all()), "invalid_samples", said)
            contained = all(one.poses.contains(pose) for pose in some[1:])
            outcome.expect(contained, "invalid_samples", f"not contained, {said}")
            _check_bounds(problem.solids[number], one, some, outcome=outcome, seed=problem.seed)


def _witness_and_samples(one: Any, seed: int) -> Array:
    samples = np.asarray(one.poses.sample(NUM_SAMPLES, seed=seed)).reshape(-1, 4, 4)
    return np.concatenate([np.asarray(one.world_from_model)[None], samples])


def _check_bounds(solid: Solid, one: Any, poses: Array, *, outcome: Outcome, seed: int) -> None:
    """No two poses are further apart than the bounds say, in rotation and at vertices."""
    turned = angle_between(poses[:, None, :3, :3], poses[None, :, :3, :3]).max()
    outcome.expect(turned <= one.poses.rotation_bound + 1e-7, "bounds_exceeded", f"rotation of {solid.name}")
    rounding = 1e-9 * solid.size + 1e-13 * float(np.abs(poses).max())
    count = len(solid.vertices)
    for point in solid.vertices[[seed % count, (seed // count) % count]]:
        placed = poses[:, :3, :3] @ point + poses[:, :3, 3]
        moved = np.linalg.norm(placed[:, None] - placed, axis=2).max()
        said = f"excursion of {solid.name}"
        outcome.expect(moved <= one.poses.excursion(point) + rounding, "bounds_exceeded", said)


def _check_others(answer: Answer, outcome: Outcome) -> None:
    """Other poses: the surely valid are in some hypothesis; those in a hypothesis are perhaps valid."""
    problem = answer.problem
    for number, solid in enumerate(problem.solids):
        poses = _neighbours(answer) if number == problem.true else np.zeros((0, 4, 4))
        if problem.seed % SEARCHED == 0:
            found = search(
                solid, problem.contacts, problem.seed, SEARCH, prior=problem.prior, kinds=problem.kinds
            )
            outcome.counts["searched"] += len(found)
            poses = np.concatenate([poses, found[:NUM_NEIGHBOURS]])
        if not len(poses):
            continue
        sure, perhaps = (answer.held(number, poses, sure=one) for one in (True, False))
        hypotheses = answer.of(number)
        # A hypothesis contains a pose up to symmetry, the prior allows it or not as it is.
        moved = len(answer.models[number].symmetries) > 1 and bool(problem.prior or problem.misses)
        for pose, surely, possible in zip(poses, sure, perhaps, strict=True):
            contained = any(one.poses.contains(pose) for one in hypotheses)
            outcome.counts["others"] += int(surely)
            if surely and answer.found.complete:
                outcome.expect(contained, "valid_poses_lost", f"of {solid.name}: {pose.tolist()}")
            if contained and not moved:
                outcome.counts["contained"] += 1
                outcome.expect(bool(possible), "falsely_contained", f"of {solid.name}: {pose.tolist()}")


def _neighbours(answer: Answer) -> Array:
    """Poses near the truth and near samples, about as far off as the bounds of the readings allow."""
    problem = answer.problem
    random = np.random.default_rng([problem.seed, 1])
    centers = np.array([one.center for one in problem.contacts])
    middle = centers.mean(axis=0)
    reach = float(np.linalg.norm(centers - middle, axis=1).max()) + 0.05 * problem.solid.size
    far = problem.contacts[0].position_error * random.choice([0.1, 0.3, 1.0, 3.0], size=(NUM_NEIGHBOURS, 1))
    turns = rotations(far / reach * in_ball(random, NUM_NEIGHBOURS))
    truth = problem.world_from_model
    poses = np.broadcast_to(np.eye(4), (NUM_NEIGHBOURS, 4, 4)).copy()
    poses[:, :3, :3] = turns @ truth[:3, :3]
    poses[:, :3, 3] = turns @ (truth[:3, 3] - middle) + middle + far * in_ball(random, NUM_NEIGHBOURS)
    return poses
