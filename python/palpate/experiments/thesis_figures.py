"""The thesis's figures 4.1 to 4.8, 4.10 and 4.12 to 4.16, on the parts drawn anew."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from palpate import (
    AmbiguityTree,
    Contact,
    Hypothesis,
    Path,
    Result,
    plan,
    plan_tree,
    recognize,
    standard_contacts,
)
from palpate.experiments.campaign import Row
from palpate.experiments.drill import BROAD, MEASURED, exemplary
from palpate.experiments.experiment import SEEDS, Experiment, Picture
from palpate.experiments.object_pairs import TWO_UNIQUE, common_contacts
from palpate.experiments.pages import table
from palpate.experiments.thesis_sensor import DRAWN_ANEW, SENSOR, parts, sensor_of
from palpate.parts import DRILL_PARTS, THESIS_OBJECTS

TELEPHONE_OR_BOOT = ("telephone", "boot")
RIGHT, EITHER = ("drill-right",), ("drill-left", "drill-right")
FIRST_LEFT = {RIGHT: 3, EITHER: 4}  # hypotheses that two contacts leave in the runs that are drawn

Drawn = tuple[Figure, dict[str, Any]]


def _objects() -> Drawn:
    from palpate.plots import plot_models

    models = [parts()[name] for name in THESIS_OBJECTS]
    contacts = [standard_contacts(name) for name in THESIS_OBJECTS]
    return plot_models(models, contacts=contacts), {"objects": len(models)}


def _one_object(name: str) -> Callable[[], Drawn]:
    """A perfect path among the interpretations of an object's standard points."""

    def draw() -> Drawn:
        contacts = standard_contacts(name)
        found = recognize([parts()[name]], contacts).hypotheses
        return _among(found, plan(found, sensor_of(**SENSOR)), contacts)

    return draw


def _among(found: list[Hypothesis], path: Path | None, contacts: list[Contact]) -> Drawn:
    from palpate.plots import plot_path

    facts = {"hypotheses": len(found), "classes": 1 if path is None else len(path.classes)}
    return plot_path(found, path, contacts), facts


def _two_objects() -> tuple[list[Hypothesis], list[Contact], AmbiguityTree]:
    """Telephone or boot, with the thesis's search, which stops at two identified."""
    contacts = common_contacts(TELEPHONE_OR_BOOT)
    found = recognize([parts()[name] for name in TELEPHONE_OR_BOOT], contacts).hypotheses
    return found, contacts, plan_tree(found, sensor_of(**SENSOR), planner="ellis", stop=TWO_UNIQUE)


def _tree() -> Drawn:
    from palpate.plots import plot_ambiguity_tree

    found, _, tree = _two_objects()
    return plot_ambiguity_tree(tree), {
        "hypotheses": len(found),
        "paths": sum(n.path is not None for n in tree.nodes),
    }


def _path_of_tree(level: int) -> Callable[[], Drawn]:
    """The first path of this level; as in the thesis, what earlier paths have ruled out is left out."""

    def draw() -> Drawn:
        found, contacts, tree = _two_objects()
        node = next(node for node in tree.nodes if node.level == level and node.path is not None)
        members = [found[number] for number in node.members]
        return _among(members, plan(members, sensor_of(**SENSOR), planner="ellis", stop=TWO_UNIQUE), contacts)

    return draw


def _drill_parts() -> Drawn:
    from palpate.plots import plot_models

    models = [parts()[name] for name in DRILL_PARTS]
    return plot_models(models), {"objects": len(models)}


def _run_of(names: tuple[str, ...], bounds: dict[str, float]) -> Result:
    return exemplary(names, "drill-right", hypotheses=FIRST_LEFT[names], bounds=tuple(bounds.items()))


def _first_path(names: tuple[str, ...], bounds: dict[str, float]) -> Callable[[], Drawn]:
    """The step of the first path, over what the initial data left."""

    def draw() -> Drawn:
        from palpate.plots import plot_run

        result = _run_of(names, bounds)
        step = next(k for k, one in enumerate(result.steps) if one.purpose == "path")
        path = result.steps[step].path
        assert path is not None
        return plot_run(result, step), {"hypotheses": FIRST_LEFT[names], "classes": len(path.classes)}

    return draw


def _final_state(names: tuple[str, ...], bounds: dict[str, float]) -> Callable[[], Drawn]:
    def draw() -> Drawn:
        from palpate.plots import plot_run

        result = _run_of(names, bounds)
        return plot_run(result), {"hypotheses": len(result.hypotheses), "touches": result.touches}

    return draw


FIGURES: dict[str, tuple[str, Callable[[], Drawn]]] = {
    "4.1": ("Object models and initial tactile data used in the experiments", _objects),
    "4.2": ("Path for ambiguous interpretations of the robot gripper", _one_object("robot-hand")),
    "4.3": ("Path for ambiguous interpretations of the hand", _one_object("human-hand")),
    "4.4": ("Path for three ambiguous interpretations of the boot", _one_object("boot")),
    "4.5": ("Path for ambiguous interpretations of the camera", _one_object("camera")),
    "4.6": ("Ambiguity tree for two objects and limited search", _tree),
    "4.7": ("First path for ambiguous interpretations of two objects", _path_of_tree(0)),
    "4.8": ("Second path for ambiguous interpretations of two objects", _path_of_tree(1)),
    "4.10": ("Object models used in the hardware experiments", _drill_parts),
    "4.12": ("Path for the right section of the drill casing", _first_path(RIGHT, BROAD)),
    "4.13": ("First path for the left and right sections of the drill casing", _first_path(EITHER, BROAD)),
    "4.14": ("Final state for the left and right sections of the drill casing", _final_state(EITHER, BROAD)),
    "4.15": ("First path for the right drill casing, low uncertainty", _first_path(RIGHT, MEASURED)),
    "4.16": ("Final state for the right drill casing, low uncertainty", _final_state(RIGHT, MEASURED)),
}

# What the thesis says of the same figure; nothing where it says no number.
PRINTED: dict[str, dict[str, int]] = {
    "4.1": {"objects": 6},
    "4.2": {"hypotheses": 4, "classes": 4},
    "4.3": {"hypotheses": 3, "classes": 3},
    "4.4": {"hypotheses": 3, "classes": 3},
    "4.5": {"hypotheses": 4, "classes": 4},
    "4.6": {"hypotheses": 5, "paths": 2},
    "4.7": {"hypotheses": 5, "classes": 4},
    "4.8": {"hypotheses": 2, "classes": 2},
    "4.10": {"objects": 3},
    "4.12": {"hypotheses": 3, "classes": 3},
    "4.14": {"hypotheses": 1},
    "4.15": {"hypotheses": 3},
    "4.16": {"hypotheses": 1},
}


def task(number: int) -> Row:
    """One figure, drawn."""
    from palpate.plots.style import svg_of

    name = list(FIGURES)[number % SEEDS]
    figure, facts = FIGURES[name][1]()
    return {"figure": name, "facts": facts, "svg": svg_of(figure).decode("utf-8")}


def markdown(rows: list[Row]) -> str:
    """What each figure shows."""
    cells = [
        [
            f"{row['figure']} {FIGURES[row['figure']][0]}",
            _words(PRINTED.get(row["figure"], {})),
            _words(row["facts"]),
        ]
        for row in rows
    ]
    return "\n\n".join(
        [
            f"{DRAWN_ANEW} Figures 4.9 and 4.11 are photographs.",
            table(["figure", "thesis", "ours"], cells),
            "4.2 to 4.5 are perfect paths among the interpretations of the standard points of figure "
            "4.1. 4.6 to 4.8 are of the two contacts that telephone and boot share (table 4.2), by the "
            "thesis's own search, `ellis`, that stops at two identified. 4.12 to 4.14 are of the first "
            "random poses of the right casing at which two contacts leave as many hypotheses as shown "
            "and one path decides, with ±4 mm and ±5°; 4.15 and 4.16 the same with ±0.5 mm and ±1°.",
        ]
    )


def _words(facts: dict[str, int]) -> str:
    singular = {"hypotheses": "hypothesis", "classes": "class", "touches": "touch"}
    return ", ".join(
        f"{count} {singular.get(name, name.removesuffix('s')) if count == 1 else name}"
        for name, count in facts.items()
    )


def pictures(rows: list[Row]) -> list[Picture]:
    """The figures."""
    return [
        Picture(
            f"figure-{row['figure']}",
            row["svg"].encode("utf-8"),
            f"**Figure {row['figure']}.** {FIGURES[row['figure']][0]}, drawn anew.",
        )
        for row in rows
    ]


EXPERIMENT = Experiment(
    title="Figures 4.1 to 4.16",
    task=task,
    table=markdown,
    groups=len(FIGURES),
    pictures=pictures,
)
