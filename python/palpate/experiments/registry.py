"""The experiments by the names that `palpate experiment` knows."""

from __future__ import annotations

from palpate.experiments import (
    campaign_loop,
    drill,
    object_pairs,
    random_data,
    rig_control,
    rig_drill,
    rig_sensor,
    rig_solids,
    space_planners,
    standard_points,
    thesis_figures,
)
from palpate.experiments.experiment import Experiment

EXPERIMENTS: dict[str, Experiment] = {
    "table-4.1": standard_points.EXPERIMENT,
    "table-4.2": object_pairs.EXPERIMENT,
    "table-4.3": random_data.EXPERIMENT,
    "table-4.4": drill.EXPERIMENT,
    "figures": thesis_figures.EXPERIMENT,
    **campaign_loop.EXPERIMENTS,
    "planners": space_planners.EXPERIMENT,
    "rig-sensor": rig_sensor.EXPERIMENT,
    "rig-control": rig_control.EXPERIMENT,
    "rig-drill": rig_drill.EXPERIMENT,
    "rig-solids": rig_solids.EXPERIMENT,
}

ALL = "all"


def named(name: str) -> dict[str, Experiment]:
    """The experiment of this name; those of the thesis for `all`.

    Raises:
        ValueError: There is none.
    """
    if name == ALL:
        return {key: one for key, one in EXPERIMENTS.items() if one.of_thesis}
    if name not in EXPERIMENTS:
        known = ", ".join([*EXPERIMENTS, ALL])
        raise ValueError(f"name: no such experiment (got {name!r}); give one of {known}")
    return {name: EXPERIMENTS[name]}
