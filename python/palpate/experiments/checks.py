"""One random problem put to the core, and the answer checked against the truth and the oracle."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from random import Random

import numpy as np

from palpate import Hypothesis, Interpretation, Recognition

from .checked import Outcome
from .oracle import Assignment, Evidence, Slack, angle_of, valid, valid_on
from .problems import Problem, matrix, random_problem
from .shapes import Array, Shape, wrap

#: What must not happen, in the order of the table: its counter, and what to call it.
FAULTS = {
    "assignments_lost": "true assignment lost",
    "poses_lost": "true pose outside",
    "valid_poses_lost": "other valid pose outside",
    "invalid_witnesses": "invalid witness",
    "invalid_samples": "invalid sample",
    "falsely_contained": "invalid pose contained",
    "bounds_exceeded": "bound or outline too small",
    "errors": "error",
}

#: The tolerance of the recognizer, relative to the part's size.
TOLERANCE = 1e-6

MOST_LISTED = 3000
MOST_HYPOTHESES = 8
NUM_SAMPLES = 4
NUM_NEIGHBOURS = 4


@dataclass(frozen=True)
class Answer:
    """A problem with its answer, as the checks look at it."""

    problem: Problem
    found: Recognition
    evidence: Evidence
    slack: Slack
    #: Hypotheses of the true model that contain the true pose.
    true: list[Hypothesis]
    #: These, and the first few others.
    looked_at: list[Hypothesis]


def check(seed: int) -> Outcome:
    """Put the problem of this seed to the core and check the answer."""
    problem = random_problem(seed)
    outcome = Outcome(seed, problem.family, FAULTS)
    evidence = problem.evidence()
    truth = problem.world_from_model[None]
    assert valid_on(evidence, truth, problem.assignment, slack=evidence.tolerance(1e-9))[0], (
        f"problem {seed} does not agree with its own truth"
    )
    started = time.perf_counter()
    found = outcome.answer(problem.recognize)
    if found is None:
        return outcome
    answer = _look_at(problem, found, evidence)
    outcome.counts["hypotheses"] += len(found.hypotheses)
    outcome.counts["incomplete"] += not found.complete
    outcome.counts["marginal"] += sum(one.marginal for one in answer.true)
    _check_truth(answer, outcome)
    _check_poses(answer, outcome)
    _check_neighbours(answer, outcome)
    outcome.seconds = time.perf_counter() - started
    return outcome


def _look_at(problem: Problem, found: Recognition, evidence: Evidence) -> Answer:
    truth = problem.world_from_model
    true = [one for one in found.hypotheses if one.model == problem.shape.model and one.poses.contains(truth)]
    others = (one for one in found.hypotheses if one not in true)
    looked_at = true[:MOST_HYPOTHESES] + list(islice(others, MOST_HYPOTHESES))
    return Answer(problem, found, evidence, evidence.tolerance(TOLERANCE), true, looked_at)


def _check_truth(answer: Answer, outcome: Outcome) -> None:
    """The true pose and the true assignment are there, up to symmetry."""
    problem = answer.problem
    outcome.expect(bool(answer.true), "poses_lost")
    if not answer.true and not answer.found.complete:
        return
    images = _images(problem)
    seen = False
    for one in _listed(answer):
        if one.assignment in images:
            motion = problem.shape.symmetries[images.index(one.assignment)][0]
            moved = problem.world_from_model @ np.linalg.inv(motion)
            _check_interpretation(answer, one, outcome)
            # With a prior each image is listed if the prior allows some pose of it, the truth's or not.
            if one.poses.contains(moved):
                return
            seen = True
    if seen:
        outcome.expect(False, "poses_lost", "of the true interpretation")
        return
    # Where assignments are too many to be listed, the pose stands for all that it satisfies.
    listed = all(
        one.interpretation_count_exact and one.interpretation_count < MOST_LISTED
        for one in (answer.true or answer.found.hypotheses)
    )
    if listed:
        outcome.expect(False, "assignments_lost", f"{problem.assignment}")
    else:
        outcome.counts["not_listed"] += 1


def _images(problem: Problem) -> list[Assignment]:
    """The true assignment as each of the model's motions onto itself takes it."""
    return [
        [(kind, faces[number] if kind == "face" else corners[number]) for kind, number in problem.assignment]
        for _, faces, corners in problem.shape.symmetries
    ]


def _listed(answer: Answer) -> Iterator[Interpretation]:
    for one in answer.true:
        yield from islice(one.interpretations, MOST_LISTED)


def _check_interpretation(answer: Answer, one: Interpretation, outcome: Outcome) -> None:
    samples = one.poses.sample(2, seed=answer.problem.seed)
    poses = np.concatenate([[one.poses.witness, one.world_from_model], samples])
    held = valid_on(answer.evidence, poses, one.assignment, slack=answer.slack)
    outcome.expect(bool(held[:2].all()), "invalid_witnesses", f"of {one.assignment}")
    outcome.expect(bool(held[2:].all()), "invalid_samples", f"of {one.assignment}")


def _check_poses(answer: Answer, outcome: Outcome) -> None:
    """Witnesses and samples are valid, contained, and within the bounds that the hypothesis states."""
    problem = answer.problem
    shapes: dict[int, tuple[Evidence, Slack]] = {}
    for number, one in enumerate(answer.looked_at):
        if one.model_number not in shapes:
            evidence = Evidence.of(
                Shape.of(one.model), problem.contacts, misses=problem.misses, prior=problem.prior
            )
            shapes[one.model_number] = evidence, evidence.tolerance(TOLERANCE)
        evidence, slack = shapes[one.model_number]
        if not answer.found.complete and one.marginal and not one.poses.contains(one.poses.witness):
            # Kept though the search met its limit, and the answer says so: it has no witness to check.
            outcome.counts["undecided"] += 1
            continue
        samples = one.poses.sample(NUM_SAMPLES, seed=problem.seed)
        poses = np.concatenate([[one.poses.witness, one.world_from_model], samples])
        held = valid(evidence, poses, kinds=problem.kinds, slack=slack)
        outcome.counts["poses_checked"] += len(poses)
        outcome.expect(bool(held[:2].all()), "invalid_witnesses", f"{one!r}")
        outcome.expect(bool(held[2:].all()), "invalid_samples", f"{one!r}")
        outcome.expect(all(map(one.poses.contains, samples)), "invalid_samples", f"not contained in {one!r}")
        first = next(iter(one.interpretations))
        if number < 2:
            _check_first(evidence, first, outcome, slack=slack)
        _check_bounds(answer, one, poses, outcome=outcome)


def _check_first(evidence: Evidence, one: Interpretation, outcome: Outcome, *, slack: Slack) -> None:
    held = valid_on(evidence, one.poses.witness[None], one.assignment, slack=slack)
    outcome.expect(bool(held[0]), "invalid_witnesses", f"of {one.assignment}")


def _check_bounds(answer: Answer, one: Hypothesis, poses: Array, *, outcome: Outcome) -> None:
    """Poses, and the truth in one of its symmetric places, are within the stated bounds and outline."""
    problem = answer.problem
    point = np.asarray(one.model.vertices[problem.seed % len(one.model.vertices)])
    limits = one.poses.rotation_bound, one.poses.excursion(point), one.poses.outline(point)
    places = [poses]
    if one in answer.true:
        motions = problem.shape.symmetries
        places = [np.concatenate([poses, [problem.world_from_model @ motion]]) for motion, *_ in motions]
    rounding = 1e-9 * problem.size + 1e-13 * float(np.abs(poses).max())
    held = any(_within(members, point, limits, rounding=rounding) for members in places)
    outcome.expect(held, "bounds_exceeded", f"{one!r}")


def _within(poses: Array, point: Array, limits: tuple[float, float, Array], *, rounding: float) -> bool:
    rotation_bound, excursion, outline = limits
    angles = np.array([angle_of(pose) for pose in poses])
    turned = np.abs(wrap(angles[:, None] - angles)).max()
    placed = poses[:, :2, :2] @ point + poses[:, :2, 2]
    moved = np.linalg.norm(placed[:, None] - placed, axis=2).max()
    # Seen from 32 directions, no place reaches farther than the outline.
    around = 2.0 * np.pi * np.arange(32) / 32.0
    directions = np.stack([np.cos(around), np.sin(around)])
    beyond = (placed @ directions).max(axis=0) - (outline @ directions).max(axis=0)
    outside = max(moved - excursion, beyond.max())
    return bool(turned <= rotation_bound + 1e-9 and outside <= rounding)


def _check_neighbours(answer: Answer, outcome: Outcome) -> None:
    """Poses near the truth: the valid ones are in some hypothesis; those in a hypothesis are valid."""
    problem = answer.problem
    poses = _neighbours(answer)
    inward = Slack(-1e-9 * problem.size, -1e-9)
    surely = valid(answer.evidence, poses, kinds=problem.kinds, slack=inward)
    perhaps = valid(answer.evidence, poses, kinds=problem.kinds, slack=answer.slack)
    # A hypothesis contains a pose up to symmetry, the prior allows it or not as it is.
    symmetric = len(problem.shape.symmetries) > 1 and problem.prior is not None
    hypotheses = [one for one in answer.found.hypotheses if one.model == problem.shape.model]
    for pose, sure, possible in zip(poses, surely, perhaps, strict=True):
        contained = any(one.poses.contains(pose) for one in hypotheses)
        outcome.counts["neighbours"] += int(sure)
        if sure and answer.found.complete:
            outcome.expect(contained, "valid_poses_lost", f"{pose.tolist()}")
        if contained and not symmetric:
            outcome.expect(bool(possible), "falsely_contained", f"{pose.tolist()}")


def _neighbours(answer: Answer) -> Array:
    """Some poses that differ from the truth by about the bounds of the readings."""
    problem = answer.problem
    random = Random(problem.seed)
    error = problem.contacts[0].position_error
    middle = answer.evidence.centers.mean(axis=0)
    reach = np.linalg.norm(answer.evidence.centers - middle, axis=1).max() + 0.1 * problem.size
    truth = problem.world_from_model
    poses = []
    for _ in range(NUM_NEIGHBOURS):
        far = random.choice((0.3, 1.0, 2.0)) * error
        turn = matrix(random.uniform(-1.0, 1.0) * far / reach, 0.0, 0.0)
        turn[:2, 2] = middle - turn[:2, :2] @ middle + [random.uniform(-far, far), random.uniform(-far, far)]
        poses.append(turn @ truth)
    return np.array(poses)
