"""`palpate identify`: the closed loop; `palpate replay`: a run once more, from its log."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, cast

import numpy as np

from palpate import Model, Result, load_models, random_contacts
from palpate import identify as identify_part
from palpate import replay as replay_run
from palpate.cli import identify_options, options, plan_options, rig_options
from palpate.cli.console import patiently, results
from palpate.cli.documents import print_document
from palpate.cli.parts import Parts, load_parts, part_notes
from palpate.cli.plan_report import sensor_words
from palpate.cli.probes import SensorFlags, rig, simulated
from palpate.cli.recognize import prior_of
from palpate.cli.rig_options import RigFlags
from palpate.cli.rig_report import draw_rig
from palpate.cli.run_report import Story, check_run_picture, draw_run, print_result, result_document
from palpate.contacts import Evidence, read_contacts
from palpate.loop.reading import read_log, settings_of_log
from palpate.loop.route import Array
from palpate.loop.settings import MAX_TOUCHES
from palpate.probe import Noise
from palpate.rig import Recording, RigProbe, phases_of
from palpate.rotations import vector_of
from palpate.truth import number_of_truth
from palpate.usual import MAX_INCIDENCE_DEG


def identify(
    models: options.Models,
    *,
    probe: identify_options.Probe = "sim",
    truth: identify_options.Truth = None,
    pose: identify_options.Pose = "random",
    noise: identify_options.Noise = None,
    overtravel: identify_options.Overtravel = None,
    position_error: identify_options.ProbePositionError = None,
    normal_error_deg: identify_options.ProbeNormalErrorDeg = None,
    no_normal: identify_options.NoNormal = False,
    max_incidence_deg: plan_options.MaxIncidenceDeg = MAX_INCIDENCE_DEG,
    tip_radius: identify_options.ProbeTipRadius = None,
    path_error: identify_options.ProbePathError = None,
    workspace: plan_options.Workspace = None,
    prior_pose: options.PriorPose = None,
    prior_translation: options.PriorTranslation = None,
    prior_rotation_deg: options.PriorRotationDeg = None,
    on_table: options.OnTable = None,
    features: options.Features = None,
    max_hypotheses: options.MaxHypotheses = None,
    contacts: identify_options.ContactsFile = None,
    drawn: identify_options.Drawn = None,
    blind: identify_options.Blind = None,
    until: identify_options.Until = None,
    max_touches: identify_options.MaxTouches = MAX_TOUCHES,
    planner: plan_options.Planner = "auto",
    stop: plan_options.Stop = "perfect",
    directions: plan_options.Directions = None,
    time_limit: plan_options.TimeLimit = None,
    effort: identify_options.Effort = 100_000,
    seed: plan_options.Seed = 0,
    log: identify_options.Log = None,
    resume: identify_options.Resume = False,
    unit: options.Unit = "mm",
    layers: options.Layers = None,
    flattening: options.Flattening = None,
    position_slack: options.PositionSlack = 0.0,
    normal_slack_deg: options.NormalSlackDeg = 0.0,
    guard_speed: rig_options.GuardSpeed = None,
    free_speed: rig_options.FreeSpeed = None,
    press_force: rig_options.PressForce = None,
    rate_hz: rig_options.RateHz = None,
    without: rig_options.Without = None,
    record: rig_options.Record = None,
    film: rig_options.Film = None,
    plot: identify_options.Plot = None,
    json: options.Json = False,
) -> None:
    """Which part it is and where, by touch: acquire, recognize, plan, touch, recognize anew.

    A workspace not given is about the pose, the prior or the origin: a square of three sizes of the largest
    part, in space a cube of two. That of the rig has 290 × 320 mm, in space a height of 200; there it probes
    from above unless --directions says otherwise.

    Exit code 0: there is an answer, whatever its status; 2: bad input.
    """
    check_run_picture(plot)
    if resume and log is None:
        raise ValueError("--resume: must be given with --log; name the log of the run")
    parts = load_parts(
        models,
        unit=unit,
        layers=layers,
        flattening=flattening,
        position_slack=position_slack,
        normal_slack_deg=normal_slack_deg,
    )
    dimension = parts.dimension
    lying = part_that_lies_there(parts, truth, unit=unit)
    if lying.dimension != dimension:
        raise ValueError(
            f"--truth: {lying.name} has {lying.dimension} dimensions, {parts.models[0].name} has "
            f"{dimension}; name a part with as many"
        )
    degrees = identify_options.normal_error_deg_of(normal_error_deg, no_normal=no_normal)
    felt = SensorFlags(
        position_error, normal_error_deg, not no_normal, max_incidence_deg, tip_radius, path_error
    )
    flags = RigFlags(guard_speed, free_speed, press_force, rate_hz, without, record, film)
    prior = prior_of(
        prior_pose,
        translation=prior_translation,
        rotation_deg=prior_rotation_deg,
        on_table=on_table,
        dimension=dimension,
    )
    given: dict[str, Any] = {
        "workspace": workspace,
        "pose": pose,
        "prior": prior,
        "directions": plan_options.directions_of(directions, dimension),
        "seed": seed,
    }
    if probe == "rig":
        _check_unused(noise=noise, overtravel=overtravel)
        flags.check_files()
        bench = rig(lying, felt, flags, unit=unit, **given)
    else:
        flags.check_unused()
        size = max(model.size for model in [*parts.models, lying])
        bench = simulated(lying, felt, size=size, noise=noise, overtravel=overtravel, **given)
    sensor, area = bench.sensor, bench.workspace
    evidence = Evidence([], [])
    if contacts is not None:
        if drawn is not None:
            raise ValueError(f"--drawn {drawn}: must be given without --contacts; choose one")
        evidence = read_contacts(
            contacts,
            unit=unit,
            position_error=sensor.position_error,
            normal_error_deg=degrees,
            tip_radius=sensor.tip_radius,
            path_error=sensor.path_error or None,
        )
    elif drawn is not None:
        first = random_contacts(
            lying,
            bench.world_from_truth,
            sensor,
            count=drawn,
            seed=seed,
            noise=cast(Noise, noise or "uniform"),
        )
        evidence = Evidence(first, [])
    settings: dict[str, Any] = {
        "prior": prior or evidence.prior,
        "contacts": evidence.contacts,
        "misses": evidence.misses,
        "blind": blind,
        "planner": planner,
        "stop": plan_options.stop_of(stop),
        "directions": bench.directions,
        "effort": effort,
        "time_limit": time_limit,
        "features": None if features is None else tuple(features.split(",")),
        "max_touches": max_touches,
        "until": identify_options.until_of(until),
        "seed": seed,
        "unit": unit,
        "log": log,
        "resume": resume,
    }
    if max_hypotheses is not None:
        settings["max_hypotheses"] = max_hypotheses
    console = results()
    smallest = min(model.size for model in parts.models)
    heading = f"sensor: {sensor_words(sensor, unit=unit)}"
    story = None if json else Story(console, size=smallest, heading=heading)
    result = patiently(
        lambda: identify_part(parts.models, bench.probe, sensor, area, told=story, **settings),
        saying="identifying",
    )
    if story is not None:
        story.begin()
    recording = bench.probe.recording if isinstance(bench.probe, RigProbe) else None
    _show(result, parts, unit=unit, plot=plot, json=json, console=console, recording=recording)
    if not json:
        console.print(_verdict(result, lying, bench.world_from_truth), soft_wrap=True)
    if isinstance(bench.probe, RigProbe):
        for told in draw_rig(result, bench.probe, flags, truth=lying, pose=bench.world_from_truth, unit=unit):
            if not json:
                console.print(told, markup=False)


def replay(
    log: identify_options.LogFile, *, plot: identify_options.Plot = None, json: options.Json = False
) -> None:
    """Tell and draw a run once more, from its log.

    Exit code 0: the log could be read; 2: bad input.
    """
    check_run_picture(plot)
    events = read_log(log)
    settings = settings_of_log(log, events)
    parts = Parts(settings.models, [str(log)] * len(settings.models))
    console = results()
    story = None if json else Story(console, size=min(model.size for model in parts.models))
    result = patiently(lambda: replay_run(log, told=story), saying="replaying")
    _show(result, parts, unit=settings.unit, plot=plot, json=json, console=console)


def _show(
    result: Result,
    parts: Parts,
    *,
    unit: str,
    plot: Path | None,
    json: bool,
    console: Any,
    recording: Recording | None = None,
) -> None:
    phases = None if recording is None else phases_of(result, recording)
    if json:
        print_document(result_document(result, parts.models, unit=unit, phases=phases))
    else:
        size = min(model.size for model in parts.models)
        notes = part_notes(parts, unit=unit)
        print_result(console, result, parts.labels, notes=notes, unit=unit, size=size)
        if phases is not None:
            console.print(
                f"The rig took {phases.initial_data:.0f} s for the initial data and {phases.execution:.0f} s "
                "from there on, simulated."
            )
    console.file.flush()
    if plot is not None:
        drawn = draw_run(result, plot, unit=unit, labels=parts.labels)
        if not json:
            console.print(f"pictures: {plot}" if len(drawn) > 1 else f"picture: {plot}", markup=False)


def _check_unused(**given: Any) -> None:
    """Flags of the other probe."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(
                f"--{name} {value}: is of --probe sim; the rig's errors follow from how it is built: "
                "leave it out"
            )


def part_that_lies_there(parts: Parts, name: str | None, *, unit: str) -> Model:
    """The part that lies there."""
    if name is None:
        return parts.models[0]
    named = [model for model in parts.models if model.name == name]
    loaded = named or load_models(name, unit=unit)
    if len(loaded) != 1:
        raise ValueError(f"--truth: {name!r} names {len(loaded)} models; name one")
    return loaded[0]


def _verdict(result: Result, truth: Model, world_from_truth: Array) -> str:
    """The simulation knows."""
    place = ", ".join(
        f"{name} {value:.6g}" for name, value in zip("xyz", world_from_truth[:-1, -1], strict=False)
    )
    if truth.dimension == 2:
        turn = f"{math.degrees(math.atan2(world_from_truth[1, 0], world_from_truth[0, 0])):.6g}°"
    else:
        turn = ", ".join(f"{value:.6g}°" for value in np.degrees(vector_of(world_from_truth[:3, :3])))
        turn = f"({turn})"
    lies = f"{truth.name} lies at {place}, turned by {turn}"
    if result.found is None:
        kept = "nothing was recognized"
    elif number_of_truth(result.hypotheses, truth, world_from_truth) is not None:
        kept = "among what is left"
    elif not result.found.complete:
        kept = "not among what was found so far, which is not all that may be left"
    else:
        kept = "not among what is left"
    return f"the truth: {lies}: {kept}."
