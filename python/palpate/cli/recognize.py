"""`palpate recognize`: every part and pose that explains the contacts of a file."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate import Prior, Recognition
from palpate import recognize as recognize_parts
from palpate.cli import options
from palpate.cli.console import patiently, results
from palpate.cli.documents import print_document, recognition_document
from palpate.cli.parts import Parts, load_parts, part_notes
from palpate.cli.report import print_counters, print_recognition
from palpate.contacts import Evidence, read_contacts
from palpate.curves import Array
from palpate.rotations import rotation_of

# How the command line has a pose, by the dimension, and what that is in words.
POSE_FORMS = {2: ("X,Y,DEG", "three numbers"), 3: ("X,Y,Z,RX,RY,RZ", "six numbers for parts in space")}


def recognize(
    models: options.Models,
    *,
    contacts: options.ContactsFile,
    position_error: options.PositionError = None,
    normal_error_deg: options.NormalErrorDeg = None,
    tip_radius: options.TipRadius = None,
    path_error: options.PathError = None,
    prior_pose: options.PriorPose = None,
    prior_translation: options.PriorTranslation = None,
    prior_rotation_deg: options.PriorRotationDeg = None,
    on_table: options.OnTable = None,
    features: options.Features = None,
    max_hypotheses: options.MaxHypotheses = None,
    time_limit: options.TimeLimit = None,
    effort: options.Effort = None,
    list_interpretations: options.ListInterpretations = 0,
    unit: options.Unit = "mm",
    layers: options.Layers = None,
    flattening: options.Flattening = None,
    position_slack: options.PositionSlack = 0.0,
    normal_slack_deg: options.NormalSlackDeg = 0.0,
    plot: options.Plot = None,
    plot_range: options.PlotRange = None,
    stats: options.Stats = False,
    json: options.Json = False,
) -> None:
    """Every part and pose that explains the contacts, with bounds.

    What the contact file says goes before the flags of the sensor; a prior given here goes before the file's.

    Exit code 0: there is an answer, also where it is that nothing explains the contacts; 2: bad input.
    """
    _check_plot(plot, plot_range, max_hypotheses)
    parts = load_parts(
        models,
        unit=unit,
        layers=layers,
        flattening=flattening,
        position_slack=position_slack,
        normal_slack_deg=normal_slack_deg,
    )
    evidence = read_contacts(
        contacts,
        unit=unit,
        position_error=position_error,
        normal_error_deg=normal_error_deg,
        tip_radius=tip_radius,
        path_error=path_error,
    )
    bounds = {"translation": prior_translation, "rotation_deg": prior_rotation_deg}
    prior = prior_of(prior_pose, **bounds, on_table=on_table, dimension=parts.dimension) or evidence.prior
    limits = {"max_hypotheses": max_hypotheses, "time_limit": time_limit, "effort": effort}
    given: dict[str, Any] = {name: value for name, value in limits.items() if value is not None}
    kinds = None if features is None else tuple(features.split(","))
    try:
        found = patiently(
            lambda: recognize_parts(
                parts.models, evidence.contacts, features=kinds, misses=evidence.misses, prior=prior, **given
            ),
            saying="recognizing",
        )
    except ValueError as error:
        raise ValueError(with_place(str(error), evidence, file=contacts)) from None
    console = results()
    if json:
        print_document(
            recognition_document(
                found,
                parts.models,
                num_contacts=len(evidence.contacts),
                unit=unit,
                num_listed=list_interpretations,
                stats=stats,
            )
        )
    else:
        print_recognition(
            console,
            found,
            evidence=replace(evidence, prior=prior),
            labels=parts.labels,
            notes=part_notes(parts, unit=unit),
            unit=unit,
            num_listed=list_interpretations,
            flags={"time": "--time-limit", "effort": "--effort"},
            size=max(model.size for model in parts.models),
        )
        if stats:
            print_counters(console, found, parts.labels)
    if plot is not None:
        # After the answer: a picture that fails doesn't take it along.
        console.file.flush()
        _draw(found, evidence, parts, path=plot, number=plot_range, unit=unit)
        if not json:
            console.print(f"picture: {plot}", markup=False)


def with_place(message: str, evidence: Evidence, *, file: Path) -> str:
    """A complaint of `contacts[3]`, as one of the place in the file where that contact stands."""
    about = re.match(r"contacts\[(\d+)\]", message)
    if about is None:
        return message
    place = evidence.places[int(about[1])]
    return f"{file.name}{':' if place.startswith('contacts') else ','} {place}{message[about.end() :]}"


def _check_plot(plot: Path | None, plot_range: int | None, max_hypotheses: int | None) -> None:
    """Refuse a picture that can't be made before the search, not after it, as far as that is known."""
    if plot_range is not None and max_hypotheses is not None and plot_range > max_hypotheses:
        raise ValueError(
            f"--plot-range {plot_range}: no more than --max-hypotheses {max_hypotheses} are returned; "
            "raise it"
        )
    if plot is not None:
        from palpate.plots.style import check_picture_path

        check_picture_path(plot)
    elif plot_range is not None:
        raise ValueError(f"--plot-range {plot_range}: must be given with --plot; name the file to draw to")


def _draw(
    found: Recognition, evidence: Evidence, parts: Parts, *, path: Path, number: int | None, unit: str
) -> None:
    # Loading matplotlib takes longer than most recognitions: only when a picture is wanted.
    from palpate.plots import plot_pose_range, plot_recognition, save_figure

    if number is None:
        figure = plot_recognition(
            found, evidence.contacts, misses=evidence.misses, unit=unit, part_names=parts.labels
        )
    elif 1 <= number <= len(found.hypotheses):
        hypothesis = found.hypotheses[number - 1]
        figure = plot_pose_range(hypothesis, evidence.contacts, misses=evidence.misses, unit=unit)
    else:
        count = len(found.hypotheses)
        has = f"give a number from 1 to {count}" if count else "there is none to draw; leave it out"
        raise ValueError(f"--plot-range {number}: no such hypothesis; {has}")
    save_figure(figure, path)


def prior_of(
    pose: str | None,
    *,
    translation: float | None,
    rotation_deg: float | None,
    on_table: str | None = None,
    dimension: int = 2,
) -> Prior | None:
    """The prior of the flags, None if there is none of them."""
    form, _ = POSE_FORMS[dimension]
    if pose is None:
        for flag, value in (
            ("--prior-translation", translation),
            ("--prior-rotation-deg", rotation_deg),
            ("--on-table", on_table),
        ):
            if value is not None:
                shown = value if isinstance(value, str) else f"{value:g}"
                raise ValueError(f"{flag} {shown}: must be given with --prior-pose; give it as {form}")
        return None
    if translation is None:
        near = "x and y" if dimension == 2 else "x, y and z"
        raise ValueError(
            f"--prior-pose: must be given with --prior-translation; say how far {near} may be from it"
        )
    half_turn_deg = 180.0
    rotation = math.radians(half_turn_deg if rotation_deg is None else rotation_deg)
    middle = pose_of(pose, "--prior-pose", dimension)
    if on_table is None:
        return Prior(middle, translation=translation, rotation=rotation)
    if dimension == 2:
        raise ValueError(f"--on-table {on_table}: must be given with parts in space; leave it out")
    height, tilt_deg = map(float, on_table.split(","))
    lying = {"height": height, "tilt": math.radians(tilt_deg)}
    return Prior.on_plane(middle, translation=translation, rotation=rotation, **lying)


def pose_of(text: str, flag: str, dimension: int = 2) -> Array:
    """The pose that a flag has as X,Y,DEG; in space as X,Y,Z,RX,RY,RZ."""
    form, numbers = POSE_FORMS[dimension]
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != len(form.split(",")) or not all(map(math.isfinite, values)):
        raise ValueError(f"{flag}: must be {numbers} (got {text!r}); give it as {form}")
    place, turn = values[:dimension], [math.radians(value) for value in values[dimension:]]
    pose = np.eye(dimension + 1)
    pose[:dimension, dimension] = place
    if dimension == 3:
        pose[:3, :3] = rotation_of(turn)
    else:
        cosine, sine = math.cos(turn[0]), math.sin(turn[0])
        pose[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return pose
