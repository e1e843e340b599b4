"""`palpate identify`: the closed loop; `palpate replay`: a run once more, from its log."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, cast

import numpy as np

from palpate import Model, Result, Sensor, SimulatedProbe, load_models, random_contacts
from palpate import identify as identify_part
from palpate import replay as replay_run
from palpate.cli import identify_options, options, plan_options
from palpate.cli.console import patiently, results
from palpate.cli.documents import print_document
from palpate.cli.parts import Parts, load_parts, part_notes
from palpate.cli.plan_report import sensor_words
from palpate.cli.recognize import pose_of, prior_of
from palpate.cli.run_report import Story, check_run_picture, draw_run, print_result, result_document
from palpate.contacts import Evidence, read_contacts
from palpate.loop.reading import read_log, settings_of_log
from palpate.loop.route import Array, workspace_of
from palpate.loop.settings import MAX_TOUCHES
from palpate.probe import Noise as NoiseName
from palpate.probe import random_pose
from palpate.rotations import vector_of
from palpate.truth import number_of_truth
from palpate.usual import MAX_INCIDENCE_DEG, POSITION_ERROR

ACROSS = {2: 3.0, 3: 2.0}  # the workspace in sizes of the largest part, if it is not given
ROOM = 0.02  # of the part, between it and the border, at a random pose


def identify(
    models: options.Models,
    *,
    probe: identify_options.Probe = "sim",
    truth: identify_options.Truth = None,
    pose: identify_options.Pose = "random",
    noise: identify_options.Noise = "uniform",
    overtravel: identify_options.Overtravel = 0.0,
    position_error: identify_options.PositionError = POSITION_ERROR,
    normal_error_deg: identify_options.NormalErrorDeg = None,
    no_normal: identify_options.NoNormal = False,
    max_incidence_deg: plan_options.MaxIncidenceDeg = MAX_INCIDENCE_DEG,
    tip_radius: identify_options.TipRadius = 0.0,
    path_error: identify_options.PathError = 0.0,
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
    plot: identify_options.Plot = None,
    json: options.Json = False,
) -> None:
    """Which part it is and where, by touch: acquire, recognize, plan, touch, recognize anew.

    A workspace not given is about the pose or the origin: a square of three sizes of the largest part, in
    space a cube of two.

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
    size = max(model.size for model in [*parts.models, lying])
    area = _workspace(workspace, pose, size=size, dimension=dimension)
    normal_error_deg = identify_options.normal_error_deg_of(normal_error_deg, no_normal=no_normal)
    normal_error = None if normal_error_deg is None else math.radians(normal_error_deg)
    sensor = Sensor(position_error, normal_error, math.radians(max_incidence_deg), tip_radius, path_error)
    world_from_truth = _pose(pose, lying, workspace=area, sensor=sensor, seed=seed)
    simulated = SimulatedProbe(
        lying,
        world_from_truth,
        sensor,
        seed=seed,
        noise=cast(NoiseName, noise),
        overtravel=overtravel,
    )
    evidence = Evidence([], [])
    if contacts is not None:
        if drawn is not None:
            raise ValueError(f"--drawn {drawn}: must be given without --contacts; choose one")
        evidence = read_contacts(
            contacts,
            unit=unit,
            position_error=position_error,
            normal_error_deg=normal_error_deg,
            tip_radius=tip_radius,
            path_error=path_error or None,
        )
    elif drawn is not None:
        first = random_contacts(
            lying, world_from_truth, sensor, count=drawn, seed=seed, noise=cast(NoiseName, noise)
        )
        evidence = Evidence(first, [])
    prior = prior_of(
        prior_pose,
        translation=prior_translation,
        rotation_deg=prior_rotation_deg,
        on_table=on_table,
        dimension=dimension,
    )
    settings: dict[str, Any] = {
        "prior": prior or evidence.prior,
        "contacts": evidence.contacts,
        "misses": evidence.misses,
        "blind": blind,
        "planner": planner,
        "stop": plan_options.stop_of(stop),
        "directions": plan_options.directions_of(directions, dimension),
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
        lambda: identify_part(parts.models, simulated, sensor, area, told=story, **settings),
        saying="identifying",
    )
    if story is not None:
        story.begin()
    _show(result, parts, unit=unit, plot=plot, json=json, console=console)
    if not json:
        console.print(_verdict(result, lying, world_from_truth), soft_wrap=True)


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


def _show(result: Result, parts: Parts, *, unit: str, plot: Path | None, json: bool, console: Any) -> None:
    if json:
        print_document(result_document(result, parts.models, unit=unit))
    else:
        size = min(model.size for model in parts.models)
        notes = part_notes(parts, unit=unit)
        print_result(console, result, parts.labels, notes=notes, unit=unit, size=size)
    console.file.flush()
    if plot is not None:
        drawn = draw_run(result, plot, unit=unit, labels=parts.labels)
        if not json:
            console.print(f"pictures: {plot}" if len(drawn) > 1 else f"picture: {plot}", markup=False)


def part_that_lies_there(parts: Parts, name: str | None, *, unit: str) -> Model:
    """The part that lies there."""
    if name is None:
        return parts.models[0]
    named = [model for model in parts.models if model.name == name]
    loaded = named or load_models(name, unit=unit)
    if len(loaded) != 1:
        raise ValueError(f"--truth: {name!r} names {len(loaded)} models; name one")
    return loaded[0]


def _workspace(text: str | None, pose: str, *, size: float, dimension: int) -> Array:
    corners = plan_options.workspace_of(text, dimension)
    if corners is not None:
        return workspace_of(corners, dimension)
    known = pose != "random"
    middle = pose_of(pose, "--pose", dimension)[:-1, -1] if known else np.zeros(dimension)
    half = ACROSS[dimension] / 2 * size
    return np.array([middle - half, middle + half])


def _pose(text: str, model: Model, *, workspace: Array, sensor: Sensor, seed: int) -> Array:
    """That of the flag, or a random one at which the part lies inside of the workspace."""
    if text != "random":
        world_from_model = pose_of(text, "--pose", model.dimension)
        placed = model.vertices @ world_from_model[:-1, :-1].T + world_from_model[:-1, -1]
        if (placed < workspace[0]).any() or (placed > workspace[1]).any():
            raise ValueError(
                f"--pose: {model.name} does not lie within the workspace (got {text}); "
                "give another pose, or a larger --workspace"
            )
        return world_from_model
    random = np.random.default_rng([seed, 1])
    room = ROOM * model.size + 2.0 * sensor.tip_radius + sensor.path_error
    try:
        return random_pose(model, workspace, room=room, random=random)
    except ValueError as error:
        raise ValueError(f"--{error}") from None


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
    kept = number_of_truth(result.hypotheses, truth, world_from_truth) is not None
    return f"the truth: {lies}: {'among what is left' if kept else 'not among what is left'}."
