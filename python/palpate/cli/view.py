"""`palpate view`: parts, contacts and paths in a browser."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import numpy as np
import typer

from palpate import Model, Prior, Sensor
from palpate.cli import identify_options, options, plan_options
from palpate.cli.console import patiently, results
from palpate.cli.documents import print_document
from palpate.cli.identify import part_that_lies_there
from palpate.cli.parts import Parts, load_parts
from palpate.cli.recognize import pose_of, prior_of
from palpate.contacts import Evidence, read_contacts
from palpate.planner_names import Planner
from palpate.probe import Noise
from palpate.usual import MAX_INCIDENCE_DEG, NORMAL_ERROR_DEG, POSITION_ERROR

if TYPE_CHECKING:
    from palpate.view import Session, Viewer

BESIDE_A_LOG = ("log", "save", "host", "port", "json")

Models = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="MODEL", help="Files, folders or names of bundled parts; none with --log.", show_default=False
    ),
]
Pose = Annotated[
    str | None,
    typer.Option(
        metavar="X,Y,DEG",
        help="Where it lies, in space X,Y,Z,RX,RY,RZ; else at one of the poses that are left, by lot.",
        rich_help_panel="Simulation",
        show_default=False,
    ),
]
ContactsFile = Annotated[
    Path | None,
    typer.Option(
        "--contacts",
        parser=options.contacts_file,
        metavar="FILE",
        help="What was touched before, as for palpate recognize.",
        show_default=False,
    ),
]
LogFile = Annotated[
    Path | None,
    typer.Option(
        "--log",
        metavar="FILE",
        help="A recorded run of palpate identify, move by move; its models and sensor are those of the log.",
        show_default=False,
    ),
]
Save = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Recognize, plan, write one .html file that needs no network, and end.",
        show_default=False,
    ),
]
Host = Annotated[
    str, typer.Option(metavar="ADDRESS", help="Where to listen; 0.0.0.0 lets other machines look, and press.")
]
Port = Annotated[
    int,
    typer.Option(
        parser=options.whole(0, 65535), metavar="N", help="The next free one if it is taken; 0: any."
    ),
]


def view(
    context: typer.Context,
    models: Models = None,
    *,
    contacts: ContactsFile = None,
    log: LogFile = None,
    position_error: options.PositionError = None,
    normal_error_deg: options.NormalErrorDeg = None,
    no_normal: plan_options.NoNormal = False,
    max_incidence_deg: plan_options.MaxIncidenceDeg = MAX_INCIDENCE_DEG,
    tip_radius: options.TipRadius = None,
    path_error: plan_options.PathError = None,
    stem: plan_options.Stem = None,
    prior_pose: options.PriorPose = None,
    prior_translation: options.PriorTranslation = None,
    prior_rotation_deg: options.PriorRotationDeg = None,
    on_table: options.OnTable = None,
    features: options.Features = None,
    max_hypotheses: options.MaxHypotheses = None,
    planner: plan_options.Planner = "auto",
    stop: plan_options.Stop = "perfect",
    workspace: plan_options.Workspace = None,
    directions: plan_options.Directions = None,
    time_limit: plan_options.TimeLimit = None,
    effort: identify_options.Effort = 100_000,
    seed: plan_options.Seed = 0,
    truth: identify_options.Truth = None,
    pose: Pose = None,
    noise: identify_options.Noise = "uniform",
    unit: options.Unit = "mm",
    layers: options.Layers = None,
    flattening: options.Flattening = None,
    position_slack: options.PositionSlack = 0.0,
    normal_slack_deg: options.NormalSlackDeg = 0.0,
    save: Save = None,
    host: Host = "127.0.0.1",
    port: Port = 8080,
    json: options.Json = False,
) -> None:
    """Parts, contacts and paths in a browser: click where a part was touched, recognize, plan, touch, undo.

    Touches are simulated. It prints where to look, and goes on until an interrupt (Ctrl-C).

    Exit code 0: it was shown, or saved; 2: bad input.
    """
    from palpate.view import Session, serve
    from palpate.view.export import check_page_path
    from palpate.view.opening import load_viser

    load_viser()
    if save is not None:
        check_page_path(save)
    console = results()
    if log is not None:
        _check_alone(context)
        session = patiently(lambda: Session.of_log(log), saying="replaying")
    else:
        parts = load_parts(
            models or [],
            unit=unit,
            layers=layers,
            flattening=flattening,
            position_slack=position_slack,
            normal_slack_deg=normal_slack_deg,
        )
        if not parts.models:
            raise ValueError(
                "MODEL: must be given, or --log with a recorded run; name the parts that it may be"
            )
        evidence = _evidence(
            contacts,
            unit=unit,
            bounds={"position_error": position_error, "normal_error_deg": normal_error_deg},
            tip_radius=tip_radius,
            path_error=path_error,
        )
        bounds = {"translation": prior_translation, "rotation_deg": prior_rotation_deg}
        prior = prior_of(prior_pose, **bounds, on_table=on_table, dimension=parts.dimension)
        session = _session(
            parts,
            evidence,
            plan_options.sensor_of(
                evidence.contacts,
                position_error=_usual(position_error, evidence, POSITION_ERROR),
                normal_error_deg=_usual(normal_error_deg, evidence, NORMAL_ERROR_DEG),
                no_normal=no_normal,
                max_incidence_deg=max_incidence_deg,
                tip_radius=tip_radius,
                path_error=path_error,
                stem=stem,
            ),
            prior=prior or evidence.prior,
            features=None if features is None else features.split(","),
            **({} if max_hypotheses is None else {"max_hypotheses": max_hypotheses}),
            planner=cast(Planner, planner),
            stop=plan_options.stop_of(stop),
            workspace=plan_options.workspace_of(workspace, parts.dimension),
            directions=plan_options.directions_of(directions, parts.dimension),
            time_limit=time_limit,
            effort=effort,
            seed=seed,
            truth=_truth(parts, truth, pose, unit=unit),
            noise=cast(Noise, noise),
            unit=unit,
        )
    if save is not None:
        patiently(lambda: _save(session, save), saying="drawing")
        if json:
            print_document(_document(session, {"page": str(save)}))
        else:
            console.print(f"page: {save}", markup=False)
        return

    def told(viewer: Viewer) -> None:
        if json:
            print_document(_document(session, {"url": viewer.url}))
        else:
            console.print(f"the viewer is at {viewer.url} (Ctrl-C ends it)", markup=False, soft_wrap=True)
        console.file.flush()

    viewer = serve(session, host=host, port=port, told=told)
    if viewer.busy:
        os._exit(0)  # what is still being computed would be waited for


def _document(session: Session, where: dict[str, str]) -> dict[str, Any]:
    left = session.state.left
    return {
        "schema": "palpate-view",
        "version": 1,
        **where,
        "hypothesis_count": None if left is None else len(left.hypotheses),
        "complete": None if left is None else left.complete,
    }


def _save(session: Session, path: Path) -> None:
    """What there is to see of it without anyone who presses: it is recognized, and the next path planned."""
    from palpate.view import save_page

    if session.state.left is None and session.state.contacts:
        session.recognize()
        if len(session.state.hypotheses) > 1:
            session.plan()
    save_page(session, path)


def _check_alone(context: typer.Context) -> None:
    """Refuse what a log says itself."""
    for parameter in context.command.params:
        name = str(parameter.name)
        source = context.get_parameter_source(name)
        if name not in BESIDE_A_LOG and source is not None and source.name == "COMMANDLINE":
            shown = "MODEL" if name == "models" else parameter.opts[0]
            raise ValueError(f"{shown}: must be given without --log, which says it itself; leave it out")


def _session(
    parts: Parts, evidence: Evidence, sensor: Sensor, *, prior: Prior | None, **given: Any
) -> Session:
    from palpate.view import Session

    return Session(
        parts.models,
        sensor,
        contacts=evidence.contacts,
        misses=evidence.misses,
        prior=prior,
        labels=parts.labels,
        **given,
    )


def _evidence(contacts: Path | None, *, unit: str, bounds: dict[str, Any], **tip: float | None) -> Evidence:
    return Evidence([], []) if contacts is None else read_contacts(contacts, unit=unit, **bounds, **tip)


def _usual(given: float | None, evidence: Evidence, usual: float) -> float | None:
    """Without contacts, from which a bound could be known, the usual one."""
    return usual if given is None and not evidence.contacts else given


def _truth(
    parts: Parts, name: str | None, pose: str | None, *, unit: str
) -> tuple[Model, np.ndarray[Any, Any]] | None:
    """The part that answers, and where it lies."""
    if pose is None:
        if name is not None:
            raise ValueError(f"--truth {name}: must be given with --pose; say where it lies")
        return None
    model = part_that_lies_there(parts, name, unit=unit)
    return model, pose_of(pose, "--pose", parts.dimension)
