"""All planners of space on the same random problems: what they find, at which cost, what holds.

    python -m palpate.experiments.space_planners --problems 210 --parts target/parts --cluster local
    python -m palpate.experiments.space_planners --page docs/planners-space.md

Beside them: many random lines, judged as the planners' are, and the line of the largest expected information
gain among some random ones, as methods choose that know one pose of each hypothesis. Killed and started
again, it goes on where it was. The times, and what `auto` finds within another's, depend on the machine.
"""

from __future__ import annotations

import math
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from palpate.planner_names import PLANNERS_OF

from . import campaign, checked, pages, predictions
from .campaign import Row
from .campaign_space import digest, parts_in
from .experiment import Experiment
from .planning_problems import FAMILIES, Problem, planning_problem
from .rivals import alike
from .solids import Array

NAME = "planners"
PLANNERS = PLANNERS_OF[3]
RIVALS = PLANNERS[1:]
#: Seconds that each planner has for a problem.
MOST_SECONDS = 10.0
#: What a robot cell may wait for a path, seconds.
SOON = 1.0
#: Problems of so many hypotheses count as large.
LARGE = 12
#: The least time that a comparison gives, seconds.
LEAST_SECONDS = 0.02
NUM_RANDOM = 100_000
#: Of the random lines so many are judged: those that may be best, by one pose of each hypothesis, first.
MOST_JUDGED, AT_ONCE = 2_000, 100
#: Among so many random lines one is chosen by information gain.
NUM_INFORMED = 500
#: Poses of each hypothesis at which a path's promise is tried.
NUM_TRIED = 2
ROUNDING = 1e-9


def task(number: int, *, parts: str | None, digest: int, lines: int) -> Row:
    """All planners on one problem."""
    import palpate

    problem = planning_problem(number, parts_in(parts))
    hypotheses, sensor = problem.hypotheses, problem.sensor
    found: Row = {}
    seconds: Row = {}
    paths: dict[str, Any] = {}
    for name in PLANNERS:
        began = time.perf_counter()
        report = palpate.plan_report(hypotheses, sensor, planner=name, time_limit=MOST_SECONDS)
        seconds[name] = round(time.perf_counter() - began, 4)
        paths[name] = report.path
        found[name] = {**_entry(report.path), "why": report.why, **_kept(problem, report.path)}
    prepared = palpate.Lines(hypotheses, sensor)
    random = np.random.default_rng([number, 7])
    drawn = random_lines(random, middle=prepared.middle, radius=prepared.radius, count=lines)
    return {
        "family": problem.family,
        "hypotheses": len(hypotheses),
        "faces": max(len(one.model.faces) for one in hypotheses),
        "tip_radius": sensor.tip_radius,
        "planners": found,
        "random": random_best(prepared, *drawn),
        "informed": informed(problem, prepared, tuple(each[:NUM_INFORMED] for each in drawn)),
        "predictions": _predictions(problem, paths),
        "seconds": {**seconds, "within": _within(problem, found, seconds), "soon": _soon(problem)},
    }


def _predictions(problem: Problem, paths: dict[str, Any]) -> Row:
    """What two planners predict of themselves, and what is so."""
    linearized, decoupled = paths["linearized"], paths["decoupled"]
    random = np.random.default_rng([problem.number, 8])
    return {
        "linearized": predictions.of_linearized(problem.hypotheses, linearized) if linearized else [],
        "decoupled": predictions.of_decoupled(problem.hypotheses, decoupled, random) if decoupled else None,
    }


def _soon(problem: Problem) -> Row:
    """What `auto` finds in a second, and how long that takes."""
    import palpate

    began = time.perf_counter()
    path = palpate.plan(problem.hypotheses, problem.sensor, time_limit=SOON)
    taken = round(time.perf_counter() - began, 4)
    return {"score": None if path is None else path.score, "seconds": taken}


def _entry(path: Any) -> Row:
    """A path, or that there is none."""
    if path is None:
        return {"score": None}
    return {"score": path.score, "expected": path.expected_score, "margin": path.margin}


def _within(problem: Problem, found: Row, seconds: Row) -> Row:
    """What `auto` finds in the time of each rival that is quicker; None: nothing."""
    import palpate

    best: Row = {}
    for name in RIVALS:
        if seconds[name] < seconds["auto"] and found[name]["score"] is not None:
            limit = max(LEAST_SECONDS, seconds[name])
            began = time.perf_counter()
            path = palpate.plan(problem.hypotheses, problem.sensor, time_limit=limit)
            taken = round((time.perf_counter() - began) / limit, 3)
            best[name] = {"score": None if path is None else path.score, "share_of_limit": taken}
    return best


def _kept(problem: Problem, path: Any) -> Row:
    """How many simulated readings were made, and how many the path's promise held for.

    The truth is among what a reading leaves, and nothing else is that the path separates from it.
    """
    import palpate

    if path is None:
        return {"readings": 0, "held": 0}
    class_of = {k: set(members) for members in path.classes for k in members}
    readings = held = 0
    for k, hypothesis in enumerate(problem.hypotheses):
        for seed, pose in enumerate(hypothesis.poses.sample(NUM_TRIED, seed=problem.number)):
            probe = palpate.SimulatedProbe(hypothesis.model, pose, problem.sensor, seed=seed, noise="bounds")
            reply = probe.touch(path.start, path.end)
            readings += 1
            if not isinstance(reply, palpate.Hit | palpate.Miss):
                continue
            left = set(path.outcome_of(reply.contact if isinstance(reply, palpate.Hit) else None))
            held += k in left and left <= class_of[k]
    return {"readings": readings, "held": held}


def random_lines(
    random: np.random.Generator, *, middle: Array, radius: float, count: int
) -> tuple[Array, Array]:
    """Directions and points `(count, 3)` of lines through a ball, all equally likely."""
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    aside = random.normal(size=(count, 3))
    aside -= np.sum(aside * directions, axis=1, keepdims=True) * directions
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    return directions, middle + radius * np.sqrt(random.random((count, 1))) * aside


def random_best(prepared: Any, directions: Array, points: Array) -> Row:
    """The best score among lines, of those that may be best."""
    least = prepared.least_scores(directions, points)
    order = np.argsort(least, kind="stable")  # what can't be used comes last
    order = order[np.isfinite(least[order])]
    best, judged = math.inf, 0
    for first in range(0, min(len(order), MOST_JUDGED), AT_ONCE):
        some = order[first : first + AT_ONCE]
        some = some[least[some] < best - ROUNDING]
        if not len(some):
            break
        scores = prepared.scores_through(directions[some], points[some])
        judged += len(some)
        best = min(best, float(np.nanmin(scores, initial=math.inf)))
    return {"score": best if math.isfinite(best) else None, "judged": judged, "may_be_used": len(order)}


def informed(problem: Problem, prepared: Any, lines: tuple[Array, ...]) -> Row:
    """The line whose exact readings, at one pose of each hypothesis, fall into classes of most entropy."""
    directions, points = lines
    poses = [one.world_from_model for one in problem.hypotheses]
    best, chosen = -1.0, 0
    flattest = math.cos(problem.sensor.max_incidence)
    for k in range(len(directions)):
        start = points[k] - 4.0 * prepared.radius * directions[k]
        met = [
            one.model.first_contact(pose, start, directions[k], problem.sensor.tip_radius)
            for one, pose in zip(problem.hypotheses, poses, strict=True)
        ]
        if any(one is not None and -float(one.normal @ directions[k]) < flattest for one in met):
            continue
        gain = _entropy(met, problem.sensor)
        if gain > best + ROUNDING:
            best, chosen = gain, k
    path = prepared.judge_through(directions[chosen], points[chosen])
    usable = path is not None and not path.faults
    return {**_entry(path if usable else None), "nats": best}


def _entropy(met: list[Any], sensor: Any) -> float:
    """Of the classes of first contacts that readings may confuse, in nats."""
    class_of = list(range(len(met)))
    for k, one in enumerate(met):
        for j in range(k):
            if class_of[j] != class_of[k] and alike(met[j], one, sensor):
                old = class_of[k]
                class_of = [class_of[j] if each == old else each for each in class_of]
    shares = np.unique(class_of, return_counts=True)[1] / len(met)
    return -float(shares @ np.log(shares))


def markdown(rows: list[Row]) -> str:
    """The tables."""
    over = [one["share_of_limit"] for row in rows for one in row["seconds"]["within"].values()]
    said = (
        f" Within another's time `auto` took {np.median(over):.2f} times of it in the median." if over else ""
    )
    return "\n\n".join(
        [
            _found(rows),
            _beside(rows),
            _in_a_second(rows),
            _by_family(rows),
            predictions.markdown(rows),
            f"Measured on: {pages.machine()}.{said}",
        ]
    )


def _in_a_second(rows: list[Row]) -> str:
    """What `auto` finds in a second beside what it finds at length."""
    lines = []
    for said, some in (
        ("all problems", rows),
        (f"{LARGE} hypotheses or more", [row for row in rows if row["hypotheses"] >= LARGE]),
        ("parts of 100 faces or more", [row for row in rows if row["faces"] >= 100]),
    ):
        if not some:
            continue
        soon = [row["seconds"]["soon"] for row in some]
        pairs = [
            (row["hypotheses"] if one["score"] is None else one["score"], _score(row, "auto"))
            for row, one in zip(some, soon, strict=True)
        ]
        as_good = sum(mine <= other + ROUNDING for mine, other in pairs)
        more = np.mean(
            [(mine - other) / row["hypotheses"] for (mine, other), row in zip(pairs, some, strict=True)]
        )
        times = [one["seconds"] for one in soon]
        lines.append(
            [said, str(len(some)), pages.share(as_good / len(some)), pages.share(float(more))]
            + [pages.duration(float(each)) for each in (np.median(times), np.max(times))]
        )
    head = [
        "`auto` with a limit of 1 s",
        "problems",
        "as good as with 10 s",
        "leaves more by",
        "time, median",
        "longest",
    ]
    return pages.table(head, lines)


def _found(rows: list[Row]) -> str:
    """What each planner finds, and what that takes."""
    lines = []
    for name in PLANNERS:
        found = [row["planners"][name] for row in rows if row["planners"][name]["score"] is not None]
        left, expected = (_mean_share(rows, name, key) for key in ("score", "expected"))
        perfect = sum(one["score"] <= 1.0 + ROUNDING for one in found)
        times = [row["seconds"][name] for row in rows]
        readings, held = (sum(row["planners"][name][key] for row in rows) for key in ("readings", "held"))
        lines.append(
            [
                f"`{name}`",
                pages.share(len(found) / len(rows)),
                pages.share(perfect / len(rows)),
                pages.share(left),
                pages.share(expected),
                pages.duration(float(np.median(times))),
                pages.duration(float(np.quantile(times, 0.9))),
                f"{held:,} of {readings:,}",
            ]
        )
    head = ["", "a path", "perfect", "left, at most", "left, expected", "time, median", "90 %"]
    return pages.table([*head, "promises held"], lines)


def _mean_share(rows: list[Row], name: str, key: str) -> float:
    """What share of the hypotheses a planner's paths leave, on average; without a path all."""
    shares = []
    for row in rows:
        found = row["planners"][name]
        shares.append(1.0 if found["score"] is None else found[key] / row["hypotheses"])
    return float(np.mean(shares))


def _beside(rows: list[Row]) -> str:
    """`auto` beside each other way."""
    lines = []
    for name in (*RIVALS, "random", "informed"):
        better = worse = behind = 0
        for row in rows:
            mine, other = (_score(row, one) for one in ("auto", name))
            in_time = row["seconds"]["within"].get(name, row["planners"]["auto"])["score"]
            better += mine < other - ROUNDING
            worse += other < mine - ROUNDING
            behind += other < (row["hypotheses"] if in_time is None else in_time) - ROUNDING
        said = {"random": "all random lines", "informed": "most information gain"}.get(name, f"`{name}`")
        same = f"{behind}" if name in RIVALS else ""
        lines.append([said, str(better), str(len(rows) - better - worse), str(worse), same])
    head = ["`auto` and", "`auto` is better", "as good", "worse", "worse, in no more time"]
    return pages.table(head, lines)


def _score(row: Row, name: str) -> float:
    """What the path of a planner or rival leaves; without a path all."""
    score = (row["planners"] | row)[name]["score"]
    return float(row["hypotheses"] if score is None else score)


def _by_family(rows: list[Row]) -> str:
    """Perfect paths of each planner, by family."""
    lines = []
    for family in dict.fromkeys(row["family"] for row in rows):
        some = [row for row in rows if row["family"] == family]
        scores = ([row["planners"][name]["score"] for row in some] for name in PLANNERS)
        perfect = [sum(one is not None and one <= 1.0 + ROUNDING for one in each) for each in scores]
        hypotheses = f"{np.mean([row['hypotheses'] for row in some]):.1f}"
        lines.append([family, str(len(some)), hypotheses, *(str(count) for count in perfect)])
    head = ["perfect paths", "problems", "hypotheses, mean", *(f"`{name}`" for name in PLANNERS)]
    return pages.table(head, lines)


EXPERIMENT = Experiment(
    title="Planners of space",
    task=task,
    table=markdown,
    groups=len(FAMILIES),
    repeats=6,
    settings={"parts": None, "digest": 0, "lines": NUM_RANDOM},
    of_thesis=False,
)


def run(settings: Row, numbers: range, out: Path, *, cluster: str | None, page: Path | None) -> bool:
    """All problems; the tables; whether every promise held."""
    rows = campaign.run(NAME, settings, numbers, task, out / "rows.jsonl", cluster=cluster)
    made = f"{len(rows)} problems, {settings['lines']:,} random lines each.\n\n{markdown(rows)}"
    if page:
        pages.rewrite(page, NAME, made)
    sys.stdout.write(f"{made}\n")
    return all(one["readings"] == one["held"] for row in rows for one in row["planners"].values())


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if every promise held."""
    parser = checked.parser_of(NAME, (__doc__ or "").splitlines()[0], problems=210)
    parser.add_argument(
        "--parts", type=Path, help="folder of public_parts; else only parts that are made here"
    )
    parser.add_argument("--lines", type=int, default=NUM_RANDOM, help=f"random lines each ({NUM_RANDOM})")
    out = Path("out") / NAME
    parser.add_argument("--out", type=Path, default=out, help=f"folder of the results ({out})")
    parser.add_argument("--page", type=Path, help="write the tables of this page anew")
    options = checked.parsed(parser, arguments)
    folder = str(options.parts.resolve()) if options.parts else None
    if folder and not parts_in(folder):
        parser.error(f"--parts: {str(options.parts)!r} has no parts; fetch them with public_parts")
    settings = {"parts": folder, "digest": digest(folder), "lines": options.lines}
    if options.replay is not None:
        sys.stdout.write(f"{task(options.replay, **settings)}\n")
        return 0
    first = options.seed * checked.SEEDS_PER_CAMPAIGN
    numbers = range(first, first + options.problems)
    work = partial(run, settings, numbers, options.out, cluster=options.cluster, page=options.page)
    return checked.ended(parser, work)


if __name__ == "__main__":
    # Under its own name, so that other processes find its functions.
    from palpate.experiments import space_planners

    sys.exit(space_planners.main())
