"""`palpate recognize`: every part and pose that explains the contacts of a file."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate import Prior, Recognition
from palpate import recognize as recognize_parts
from palpate.cli import options
from palpate.cli.console import patiently, results
from palpate.cli.documents import print_document, recognition_document
from palpate.cli.parts import Parts, load_parts, part_notes
from palpate.cli.report import print_counters, print_recognition
from palpate.contacts import Evidence, read_contacts


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
    features: options.Features = None,
    max_hypotheses: options.MaxHypotheses = None,
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
    _check_plot(plot, plot_range)
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
    prior = (
        prior_of(prior_pose, translation=prior_translation, rotation_deg=prior_rotation_deg) or evidence.prior
    )
    limit = {} if max_hypotheses is None else {"max_hypotheses": max_hypotheses}
    kinds = None if features is None else tuple(features.split(","))
    try:
        found = patiently(
            lambda: recognize_parts(
                parts.models, evidence.contacts, features=kinds, misses=evidence.misses, prior=prior, **limit
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


def _check_plot(plot: Path | None, plot_range: int | None) -> None:
    """Refuse a picture that can't be made before the search, not after it."""
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


def prior_of(pose: str | None, *, translation: float | None, rotation_deg: float | None) -> Prior | None:
    """The prior of the flags, None if there is none of them."""
    if pose is None:
        for flag, value in (("--prior-translation", translation), ("--prior-rotation-deg", rotation_deg)):
            if value is not None:
                raise ValueError(f"{flag} {value:g}: must be given with --prior-pose; give it as X,Y,DEG")
        return None
    if translation is None:
        raise ValueError(
            "--prior-pose: must be given with --prior-translation; say how far x and y may be from it"
        )
    half_turn_deg = 180.0
    rotation = math.radians(half_turn_deg if rotation_deg is None else rotation_deg)
    return Prior(pose_of(pose, "--prior-pose"), translation=translation, rotation=rotation)


def pose_of(text: str, flag: str) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The pose that a flag has as X,Y,DEG."""
    try:
        x, y, angle_deg = (float(part) for part in text.split(","))
    except ValueError:
        x = y = angle_deg = math.nan
    if not math.isfinite(x + y + angle_deg):
        raise ValueError(f"{flag}: must be three numbers (got {text!r}); give it as X,Y,DEG")
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[cosine, -sine, x], [sine, cosine, y], [0.0, 0.0, 1.0]])
