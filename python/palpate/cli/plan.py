"""`palpate plan`: the next path, or the whole ambiguity tree."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from palpate import (
    AmbiguityTree,
    Hypothesis,
    PlanReport,
    Recognition,
    Sensor,
    plan_report,
    plan_tree,
    projection_space,
)
from palpate import recognize as recognize_parts
from palpate.cli import options, plan_options
from palpate.cli.console import patiently, results
from palpate.cli.documents import print_document, recognition_document
from palpate.cli.parts import Parts, load_parts, part_notes
from palpate.cli.plan_report import print_plan, sensor_words
from palpate.cli.recognize import prior_of, with_place
from palpate.cli.report import print_counters, print_recognition
from palpate.contacts import Evidence, read_contacts
from palpate.plan_json import report_entries, sensor_entry, tree_document

MARGIN = 1e-3  # m, as a share of the largest part: the core's own


@dataclass(frozen=True)
class _Asked:
    """What is to be planned, and for which sensor."""

    parts: Parts
    evidence: Evidence
    found: Recognition
    sensor: Sensor
    unit: str

    @property
    def hypotheses(self) -> list[Hypothesis]:
        return self.found.hypotheses

    @property
    def labels(self) -> list[str]:
        """The part of each hypothesis."""
        return [self.parts.labels[hypothesis.model_number] for hypothesis in self.hypotheses]


@dataclass(frozen=True)
class _Planned:
    """Whichever was asked for."""

    report: PlanReport | None = None
    tree: AmbiguityTree | None = None


@dataclass(frozen=True)
class _Pictures:
    """The files to draw into."""

    path: Path | None
    tree: Path | None
    lines: Path | None
    sheaves: Path | None

    @property
    def files(self) -> list[Path]:
        return [path for path in (self.path, self.tree, self.lines, self.sheaves) if path is not None]


def plan(
    models: options.Models,
    *,
    contacts: options.ContactsFile,
    position_error: options.PositionError = None,
    normal_error_deg: options.NormalErrorDeg = None,
    no_normal: plan_options.NoNormal = False,
    max_incidence_deg: plan_options.MaxIncidenceDeg = 60.0,
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
    avoid_assigned: plan_options.AvoidAssigned = False,
    time_limit: plan_options.TimeLimit = None,
    effort: plan_options.Effort = None,
    seed: plan_options.Seed = 0,
    tree: plan_options.Tree = False,
    method: plan_options.Method = None,
    unit: options.Unit = "mm",
    layers: options.Layers = None,
    flattening: options.Flattening = None,
    position_slack: options.PositionSlack = 0.0,
    normal_slack_deg: options.NormalSlackDeg = 0.0,
    plot: options.Plot = None,
    plot_tree: plan_options.PlotTree = None,
    plot_projection: plan_options.PlotProjection = None,
    plot_sheaves: plan_options.PlotSheaves = None,
    stats: options.Stats = False,
    json: options.Json = False,
) -> None:
    """The next touch: the path that tells the hypotheses apart best, and what each answer would leave.

    The bounds of the next reading are those of the flags; else the largest of the contacts in the file.

    Exit code 0: there is an answer, also where it is that no path tells or none is needed; 2: bad input.
    """
    pictures = _Pictures(plot, plot_tree, plot_projection, plot_sheaves)
    _check_pictures(pictures.files)
    if method is not None and not tree and plot_tree is None:
        raise ValueError(f"--method: {method!r} is of a tree; give --tree or --plot-tree, or leave it out")
    parts = load_parts(
        models,
        unit=unit,
        layers=layers,
        flattening=flattening,
        position_slack=position_slack,
        normal_slack_deg=normal_slack_deg,
    )
    if parts.dimension == 3 and (plot_projection is not None or plot_sheaves is not None):
        flag = "--plot-projection" if plot_projection is not None else "--plot-sheaves"
        raise ValueError(f"{flag}: draws lines of the plane only; leave it out for parts in space")
    evidence = read_contacts(
        contacts,
        unit=unit,
        position_error=position_error,
        normal_error_deg=normal_error_deg,
        tip_radius=tip_radius,
        path_error=path_error,
    )
    prior = prior_of(
        prior_pose,
        translation=prior_translation,
        rotation_deg=prior_rotation_deg,
        on_table=on_table,
        dimension=parts.dimension,
    )
    evidence = replace(evidence, prior=prior or evidence.prior)
    sensor = plan_options.sensor_of(
        evidence.contacts,
        position_error=position_error,
        normal_error_deg=normal_error_deg,
        no_normal=no_normal,
        max_incidence_deg=max_incidence_deg,
        tip_radius=tip_radius,
        path_error=path_error,
        stem=stem,
    )
    kinds = None if features is None else tuple(features.split(","))
    limit: dict[str, Any] = {} if max_hypotheses is None else {"max_hypotheses": max_hypotheses}
    limit["time_limit"] = time_limit
    found = _recognized(parts, evidence, file=contacts, features=kinds, limit=limit)
    asked = _Asked(parts, evidence, found, sensor, unit)
    search: dict[str, Any] = {
        "planner": planner,
        "stop": plan_options.stop_of(stop),
        "workspace": plan_options.workspace_of(workspace, parts.dimension),
        "directions": plan_options.directions_of(directions, parts.dimension),
        "avoid_assigned": avoid_assigned,
        "time_limit": time_limit,
        "effort": effort,
        "seed": seed,
        "features": kinds,
    }
    planned = _planned(
        asked, search, path=not tree, tree=tree or plot_tree is not None, method=method or "greedy"
    )
    console = results()
    if json:
        print_document(_document(asked, planned, tree=tree, planner=planner))
    else:
        _print(console, asked, planned, tree=tree, stats=stats)
    console.file.flush()
    _draw(asked, planned, search, pictures=pictures)
    for path in pictures.files if found.hypotheses and not json else []:
        console.print(f"picture: {path}", markup=False)


def _check_pictures(paths: Sequence[Path]) -> None:
    """Refuse pictures that can't be made before the search, not after it."""
    if paths:
        from palpate.plots.style import check_picture_path

        for path in paths:
            check_picture_path(path)


def _recognized(
    parts: Parts,
    evidence: Evidence,
    *,
    file: Path,
    features: tuple[str, ...] | None,
    limit: dict[str, Any],
) -> Recognition:
    def work() -> Recognition:
        return recognize_parts(
            parts.models,
            evidence.contacts,
            features=features,
            misses=evidence.misses,
            prior=evidence.prior,
            **limit,
        )

    try:
        return patiently(work, saying="recognizing")
    except ValueError as error:
        raise ValueError(with_place(str(error), evidence, file=file)) from None


def _planned(asked: _Asked, search: dict[str, Any], *, path: bool, tree: bool, method: Any) -> _Planned:
    hypotheses, sensor = asked.hypotheses, asked.sensor
    if not hypotheses:
        return _Planned()
    report_work: Callable[[], PlanReport] = lambda: plan_report(hypotheses, sensor, **search)  # noqa: E731
    tree_work: Callable[[], AmbiguityTree] = lambda: plan_tree(  # noqa: E731
        hypotheses, sensor, method=method, **search
    )
    many = f"{len(hypotheses)} hypotheses"
    return _Planned(
        patiently(report_work, saying=f"planning among {many}") if path else None,
        patiently(tree_work, saying=f"growing the tree of {many}") if tree else None,
    )


def _print(console: Console, asked: _Asked, planned: _Planned, *, tree: bool, stats: bool) -> None:
    print_recognition(
        console,
        asked.found,
        evidence=asked.evidence,
        labels=asked.parts.labels,
        notes=part_notes(asked.parts, unit=asked.unit),
        unit=asked.unit,
        size=max(model.size for model in asked.parts.models),
    )
    if stats:
        print_counters(console, asked.found, asked.parts.labels)
    if not asked.hypotheses:
        return
    console.print(f"sensor: {sensor_words(asked.sensor, unit=asked.unit)}", soft_wrap=True)
    if not asked.found.complete:
        console.print(
            "[bold]more may be left than is listed[/bold]: what is said of paths holds for these hypotheses"
        )
    if tree and planned.tree is not None:
        console.print(planned.tree.to_text(), markup=False, soft_wrap=True, end="")
    if planned.report is not None:
        sizes = [hypothesis.model.size for hypothesis in asked.hypotheses]
        print_plan(
            console,
            planned.report,
            asked.labels,
            size=min(sizes),
            margin=MARGIN * max(sizes),
            unit=asked.unit,
            complete=asked.found.complete,
        )
        if stats:
            counts = {"lines judged": planned.report.num_judged, "boxes": planned.report.num_boxes}
            for name, count in {**counts, **(planned.report.counters or {})}.items():
                console.print(f"  {name.replace('_', ' ')}: {count}")


def _document(asked: _Asked, planned: _Planned, *, tree: bool, planner: str) -> dict[str, Any]:
    contacts = len(asked.evidence.contacts)
    found = recognition_document(asked.found, asked.parts.models, num_contacts=contacts, unit=asked.unit)
    given = {"found": found, "sensor": sensor_entry(asked.sensor)}
    if tree and planned.tree is not None:
        return {**tree_document(planned.tree, unit=asked.unit), **given}
    head = {"schema": "palpate-plan", "version": 1, "unit": asked.unit, **given, "planner": planner}
    if planned.report is not None:
        # One of more than were wanted is not solved.
        unsolved = planned.report.why == "solved" and not asked.found.complete
        why = {"why": "incomplete", "proved": False} if unsolved else {}
        return {**head, **report_entries(planned.report), **why}
    nothing = {"path": None, "why": "unexplained", "proved": True, "bound": 0.0}
    return {**head, **nothing, "num_judged": 0, "num_boxes": 0, "counters": None}


def _draw(asked: _Asked, planned: _Planned, search: dict[str, Any], *, pictures: _Pictures) -> None:
    # Loading matplotlib takes longer than most plans: only when a picture is wanted.
    if not asked.hypotheses or not pictures.files:
        return
    from palpate import plots

    tree = planned.tree
    path = planned.report.path if planned.report is not None else tree.root.path if tree else None
    hypotheses, sensor, unit = asked.hypotheses, asked.sensor, asked.unit
    named: dict[str, Any] = {"unit": unit, "part_names": asked.parts.labels}
    if pictures.path is not None:
        shown = {"misses": asked.evidence.misses, "tip_radius": sensor.tip_radius, **named}
        plots.save_figure(plots.plot_path(hypotheses, path, asked.evidence.contacts, **shown), pictures.path)
    if pictures.tree is not None and tree is not None:
        plots.save_figure(plots.plot_ambiguity_tree(tree, unit=unit), pictures.tree)
    if pictures.lines is not None:
        kept = {name: search[name] for name in ("workspace", "directions", "features", "avoid_assigned")}
        work = lambda: plots.plot_lines(hypotheses, sensor, path, unit=unit, **kept)  # noqa: E731
        plots.save_figure(patiently(work, saying="judging lines"), pictures.lines)
    if pictures.sheaves is not None:
        own = {name: value for name, value in search.items() if name != "planner"}
        search_work = lambda: projection_space(hypotheses, sensor, **own)  # noqa: E731
        space = patiently(search_work, saying="searching generators")
        plots.save_figure(plots.plot_projection_space(hypotheses, space, **named), pictures.sheaves)
