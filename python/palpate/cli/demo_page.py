"""The folder that the demonstration leaves: pictures, the log, and a page that tells it all."""

from __future__ import annotations

import math
import re
from pathlib import Path

from palpate import Hypothesis
from palpate.cli.demo_words import Teller, answer_words, task_words, truth_words
from palpate.cli.documents import excursion_bound, planar
from palpate.cli.run_report import draw_run
from palpate.demo import UNIT, Demonstration, deviation
from palpate.plots.style import at_most
from palpate.report import Page, plain

LOG = "run.jsonl"
PAGE = "palpate-demo.html"
RUN = "run.svg"


def make_ready(folder: Path) -> None:
    """Make the folder, and remove what an earlier demonstration left in it.

    Raises:
        ValueError: It can't be a folder.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"--out: {str(folder)!r} is no folder; name another one")
    if not folder.parent.is_dir():
        raise ValueError(f"--out: there is no folder {str(folder.parent)!r}; make it first")
    folder.mkdir(exist_ok=True)
    for file in folder.iterdir():
        if file.name in (LOG, PAGE, RUN) or re.fullmatch(r"step-\d+\.svg", file.name):
            file.unlink()


def write_folder(shown: Demonstration, folder: Path) -> None:
    """A picture of each step and of the whole, and the page; the log is there."""
    labels = [model.name for model in shown.models]
    pictures = draw_run(shown.result, folder, unit=UNIT, labels=labels)
    page = Page(
        f"Found by touch: {shown.truth.name}", lead=" ".join(map(plain, task_words(len(shown.models))))
    )
    _answer(page, shown)
    _steps(page, shown, pictures)
    _again(page, shown, folder)
    page.save(folder / PAGE)


def _answer(page: Page, shown: Demonstration) -> None:
    from palpate.plots import plot_turning_point

    result = shown.result
    facts: list[tuple[str, object]] = [
        ("guarded moves", result.touches),
        ("answers at most", max((len(step.hypotheses or ()) for step in result.steps), default=0)),
        ("answers left", len(result.hypotheses)),
    ]
    if len(result.hypotheses) == 1:
        found = result.hypotheses[0]
        facts += [
            ("corners within", f"{at_most(excursion_bound(found))} {UNIT}"),
            ("turned within", f"{at_most(math.degrees(found.poses.rotation_bound))}°"),
        ]
    page.facts(facts)
    page.picture(
        plot_turning_point(result, unit=UNIT),
        caption="Where most answers were left, and the end. Parts that fit are drawn over each other. The "
        "way of the tip is solid where it went, dashed where it would have gone. Touches are numbered.",
    )
    page.heading("The answer")
    page.text(" ".join(map(plain, [*answer_words(shown), truth_words(shown)])))
    if shown.truth_number is not None:
        _beside_truth(page, shown, result.hypotheses[shown.truth_number - 1])


def _beside_truth(page: Page, shown: Demonstration, found: Hypothesis) -> None:
    from palpate.plots import plot_pose_range

    way, turn = deviation(found, shown.world_from_truth)
    rows: list[tuple[object, ...]] = [
        (
            name,
            *(f"{planar(pose)[k]:.2f}" for pose in (found.world_from_model, shown.world_from_truth)),
            "",
            "",
        )
        for k, name in enumerate((f"x ({UNIT})", f"y ({UNIT})", "angle (°)"))
    ]
    rows += [
        (f"largest way of a corner ({UNIT})", "", "", f"{way:.2f}", at_most(excursion_bound(found))),
        (
            "turn (°)",
            "",
            "",
            f"{math.degrees(turn):.2f}",
            at_most(math.degrees(found.poses.rotation_bound)),
        ),
    ]
    page.table(
        ["", "found", "hidden truth", "off by", "proved bound"],
        rows,
        caption="The pose of the part. The bounds hold for every pose that fits, hence for the true one.",
    )
    ranges = [(found, "In the end. Dashed: the truth.")]
    known = [s.hypotheses[0] for s in shown.result.steps if s.hypotheses and len(s.hypotheses) == 1]
    if len(known) > 1:
        ranges.insert(0, (known[0], "When the part was known. Faint: poses that fit."))
    page.gallery(
        (plot_pose_range(one, unit=UNIT, world_from_truth=shown.world_from_truth), caption)
        for one, caption in ranges
    )


def _steps(page: Page, shown: Demonstration, pictures: list[Path]) -> None:
    page.heading("Step by step")
    teller = Teller()
    for number, step in enumerate(shown.result.steps, start=1):
        told = teller.tell(step)
        page.heading(f"{number}. {told.what}", level=3)
        page.text(f"{plain(told.why)} {plain(told.met)}")
        page.picture(pictures[number - 1], alt=f"{told.why} {told.met}")
        if told.left:
            page.text(f"**{plain(told.left)}**")


def _again(page: Page, shown: Demonstration, folder: Path) -> None:
    page.heading("The same again")
    page.text("The same run, another part, and the run once more from its log, without a probe:")
    page.code(
        f"palpate demo --part {shown.truth.name} --seed {shown.seed}\n"
        f"palpate demo --seed {shown.seed + 1}\n"
        f"palpate replay {LOG}"
    )
    page.code((folder / LOG).read_text(encoding="utf-8"), summary=f"The log, {LOG}")
