"""Experiments from their names to rows on disk, pictures and a report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate import __version__
from palpate.experiments import campaign
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import Experiment
from palpate.experiments.registry import ALL, named

REPORT = "report.html"


@dataclass(frozen=True)
class Outcome:
    """What became of an experiment."""

    name: str
    experiment: Experiment
    rows: list[Row]
    pictures: list[tuple[Path, str]]
    """Files, and captions in Markdown."""

    @property
    def markdown(self) -> str:
        """Its tables, and what is to be known of them."""
        return self.experiment.table(self.rows)


def conduct(
    name: str, folder: Path, *, problems: int | None = None, seed: int = 0, cluster: str | None = None
) -> list[Outcome]:
    """Compute the experiment of this name, or all; rows and pictures go to the folder.

    Rows that are there already are not computed again.

    Args:
        name: One of `registry.EXPERIMENTS`, or `all`.
        folder: It is made, if need be.
        problems: So many of each kind, where there are random ones; None: as many as each experiment has.
        seed: Which random problems.
        cluster: As for `campaign.run`.

    Raises:
        ValueError: No such experiment; a number of problems where they are fixed; as `campaign.run`.
    """
    chosen = named(name)
    if problems is not None and all(one.repeats is None for one in chosen.values()):
        raise ValueError(f"problems: those of {name} are fixed (got {problems}); leave it out")
    folder.mkdir(parents=True, exist_ok=True)
    return [
        _conduct(key, one, folder, numbers=one.numbers(problems, seed=seed), cluster=cluster)
        for key, one in chosen.items()
    ]


def _conduct(name: str, one: Experiment, folder: Path, *, numbers: range, cluster: str | None) -> Outcome:
    file = folder / f"{name}.jsonl"
    rows = campaign.run(name, one.settings, numbers, one.task, file, cluster=cluster)
    drawn: list[tuple[Path, str]] = []
    for picture in one.pictures(rows):
        path = folder / f"{picture.name}.svg"
        path.write_bytes(picture.svg)
        drawn.append((path, picture.caption))
    return Outcome(name, one, rows, drawn)


def save_report(outcomes: list[Outcome], path: Path) -> None:
    """All tables and pictures as one self-contained page."""
    from palpate.report import Page

    everything = len(outcomes) > 1
    title = "The thesis's experiments" if everything else outcomes[0].experiment.title
    page = Page(title, lead=_lead(everything=everything))
    for outcome in outcomes:
        if everything:
            page.heading(outcome.experiment.title)
        page.text(outcome.markdown)
        if len(outcome.pictures) > 1:
            page.gallery(outcome.pictures)
        for picture, caption in outcome.pictures if len(outcome.pictures) == 1 else ():
            page.picture(picture, caption=caption)
    page.save(path)


def _lead(*, everything: bool) -> str:
    made = f"Made by palpate {__version__}"
    if not everything:
        return f"{made}."
    return (
        "Chapter 4 of R. E. Ellis, *A Tactile Sensing Strategy for Model-Based Object Recognition* "
        "(1987), once more: its tables with its own numbers beside ours, and its figures. The objects "
        f"are drawn anew, since the thesis's outlines are not available. {made} with `palpate experiment "
        f"{ALL}`."
    )
