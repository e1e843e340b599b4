"""The closed loop: a hidden solid is found by touch.

One of four solids lies in a box, nobody knows where. A simulated probe makes the moves that the loop asks
for, with errors within its bounds; the log of the run is replayed without it.
"""

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import palpate

solids = palpate.load_models(["l-bracket", "rib-plate", "hexagon", "flange"])
sensor = palpate.Sensor(position_error=0.5, normal_error=math.radians(4), max_incidence=math.radians(60))
world_from_plate = np.array([[0, -1, 0, 40], [0, 0, -1, 20], [1, 0, 0, -60], [0, 0, 0, 1.0]])
probe = palpate.SimulatedProbe(solids[1], world_from_plate, sensor, seed=1)
box = [[-180, -180, -180], [180, 180, 180]]


def told(step: palpate.Step) -> None:
    """Each guarded move, once it is understood."""
    left = "" if step.hypotheses is None else f", {len(step.hypotheses)} left"
    print(f"{step.purpose}: {type(step.reply).__name__}{left}")


with TemporaryDirectory() as folder:
    log = Path(folder) / "run.jsonl"
    result = palpate.identify(solids, probe, sensor, box, log=log, told=told)
    again = palpate.replay(log)

(found,) = result.hypotheses
print(result.status, found.model.name, f"after {result.touches} guarded moves")
assert result.status == "solved" and found.model.name == "rib-plate"
assert found.poses.contains(world_from_plate)  # the simulation knows
assert again.touches == result.touches
