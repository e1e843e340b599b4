"""The loop: acquire, recognize, plan, touch, recognize anew (thesis 4.1)."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path as FilePath
from typing import Literal

from numpy.typing import ArrayLike

from palpate._core import Contact, Miss, Model, Prior, Sensor
from palpate.loop.entries import Event, start_event
from palpate.loop.journal import Journal, open_log
from palpate.loop.result import Array, Result, Step
from palpate.loop.run import Run, check_told
from palpate.loop.settings import MAX_HYPOTHESES, MAX_TOUCHES, Settings, settings_of
from palpate.planner_names import Planner
from palpate.probe import Probe
from palpate.probe.simulated import point_of


def identify(  # noqa: PLR0917 - the four that every call has
    models: Sequence[Model],
    probe: Probe,
    sensor: Sensor,
    workspace: ArrayLike,
    *,
    prior: Prior | None = None,
    contacts: Sequence[Contact] = (),
    misses: Sequence[Miss] = (),
    blind: int | None = None,
    planner: Planner = "auto",
    stop: Literal["perfect"] | tuple[Literal["unique"], int] | tuple[Literal["share"], float] = "perfect",
    directions: tuple[ArrayLike, float] | None = None,
    margin: float = 1e-3,
    effort: int = 100_000,
    time_limit: float | None = None,
    features: Sequence[str] | None = None,
    max_touches: int = MAX_TOUCHES,
    max_hypotheses: int = MAX_HYPOTHESES,
    until: tuple[float, float] | None = None,
    seed: int = 0,
    unit: str = "mm",
    log: str | FilePath | None = None,
    resume: bool = False,
    told: Callable[[Step], None] | None = None,
) -> Result:
    """Find out by touch which part it is and where: until one hypothesis is left, or no path tells (4.1).

    First contacts come from a binary subdivision of the workspace, until two normals are independent (4.1);
    in space then from moves at what was touched, until three are.
    Then, so long as several hypotheses are left, the tip goes along the path that tells them apart best, and
    all is recognized anew with what it touched, what it missed and what it swept; hypotheses that can't have
    answered one of the guarded moves are dropped. It goes on while a path is certain to tell some apart, else
    while an untried one is expected to leave fewer than n - 0.05 of n.

    If all readings are within their bounds, the tip stays within the path error of its lines, no touch of the
    workspace's perimeter is possible and the true part is among the models, then the truth is among the
    hypotheses that are left, whatever the status. Same input, seed and replies: same run, unless `time_limit`
    cuts the planning short.

    Args:
        models: The parts that it may be. Their unit is that of all lengths.
        probe: What moves and touches; `SimulatedProbe`, or your own `Probe`.
        sensor: Bounds of its readings, for planning; each contact brings its own for recognition. The path
            error must hold for all guarded moves. Zero states none: the position error stands for it.
        workspace: Two opposite corners, shape `(2, d)`, world frame. Its border is free for the tip, and the
            part is within; in space it may reach through sides that no direction of `directions` enters by.
        prior: What is known of the pose beforehand.
        contacts: What was touched before; nothing is acquired then, unless `blind` asks for more.
        misses: What was missed before. One that states no path error has that of the sensor.
        blind: Go on with blind scans until so many contacts (with a normal, if the sensor reads them) are
            had. None: until two normals are independent, or, without normals, until there are four contacts;
            in space three, of a ball after five contacts, and seven.
        planner: As for `plan`; the same for `stop`, `directions`, `margin`, `effort` and `features`.
        stop: As for `plan`.
        directions: As for `plan`; it holds for scans too.
        margin: As for `plan`.
        effort: As for `plan` and `verification_report`, for each path. A promising path that a quick look
            finds is taken at once.
        time_limit: Seconds, for recognition and planning between two touches. A recognition is not cut short;
            if it took as long, nothing is planned and the run ends.
        features: As for `plan`: kinds that a path may touch. A scan may touch any, and is so understood.
        max_touches: So many guarded moves are made at most.
        max_hypotheses: As for `recognize`. Where there are more, blind scans go on.
        until: A length and an angle: the last hypothesis is touched where it was not yet, until no two of
            its poses move a corner further apart and turn more than this, or no such touch is found, or ten
            in a row made the poses no tighter by a hundredth (status `"budget"`).
        seed: Of the planner.
        unit: Of the models, for the log to say.
        log: A file to which each event is written before the next one begins, as JSON lines.
        resume: Go on with the log, if there is one: replies in it are not asked again.
        told: Is called with each guarded move when its reply is understood.

    Returns:
        What is left, and how it came to that. A probe that fails ends the run with the status `"fault"`; no
        exception. So does an exception that it raises on a move, and a reading that can't be of its move.

    Raises:
        ValueError: Bad input, named; an answer that is no reply; a log that is there already, or of another
            run; a tip inside of the workspace at first.
    """
    if not isinstance(probe, Probe):
        raise ValueError(f"probe: must have touch, move and position (got {probe!r}); see palpate.Probe")
    check_told(told)
    settings = settings_of(
        models,
        sensor,
        workspace,
        prior=prior,
        contacts=contacts,
        misses=misses,
        blind=blind,
        planner=planner,
        stop=stop,
        directions=directions,
        margin=margin,
        effort=effort,
        time_limit=time_limit,
        features=features,
        max_touches=max_touches,
        max_hypotheses=max_hypotheses,
        until=until,
        seed=seed,
        unit=unit,
    )
    if log is None:
        return _run(settings, probe, Journal(), known=[], told=told)
    known, file = open_log(FilePath(log), resume=resume)
    with file:
        return _run(settings, probe, Journal(known, file), known=known, told=told)


def _run(
    settings: Settings,
    probe: Probe,
    journal: Journal,
    *,
    known: list[Event],
    told: Callable[[Step], None] | None,
) -> Result:
    position = known[0]["position"] if known else probe.position
    at: Array | None = (
        None if position is None else point_of("probe.position", position, settings.models[0].dimension)
    )
    start = start_event(settings, at, simulation=getattr(probe, "simulation", None))
    as_read = json.loads(json.dumps(start, allow_nan=False))
    for name in known[0] if known else ():
        then, now = known[0][name], as_read.get(name)
        if then != now:
            raise ValueError(
                f"{name}: is not that of the log{_difference(then, now)}; "
                "resume with the same, or begin another log"
            )
    journal.record(start)
    return Run(settings, probe, journal, position=at, told=told).result()


def _difference(then: object, now: object) -> str:
    """Which member differs, if it is short."""
    if not isinstance(then, dict) or not isinstance(now, dict):
        return ""
    name = next((name for name in [*then, *now] if then.get(name) != now.get(name)), "")
    values = [json.dumps(one.get(name)) for one in (then, now)]
    shown = f" (it has {values[0]}, not {values[1]})" if max(map(len, values)) < 60 else ""
    return f": {name} differs{shown}"
